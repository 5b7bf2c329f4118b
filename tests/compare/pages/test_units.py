"""Numbers on pages: the paper's unit first, SI in brackets."""

from math import radians

from trajgap.compare.pages.units import both_units
from trajgap.problem import load_case


def test_the_papers_unit_comes_first() -> None:
    statement = load_case("irb460-pso-353").statement("limit-80", "waypoints-rad")
    shown = both_units(statement, "velocity", [radians(80), radians(-12.5)], ".6g")
    assert shown == "80, -12.5 °/s (1.39626, -0.218166 rad/s)"
    # A quantity whose unit the paper does not print, or prints in SI, stands alone.
    assert both_units(statement, "acceleration", [2.5], ".6g") == "2.5 rad/s²"
    assert both_units(statement, "position", [0.5], ".6g") == "0.5 rad"
