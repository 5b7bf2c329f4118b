"""Knot vectors and parameters as case files print them: read, scaled, and refused in one line."""

from __future__ import annotations

import pytest
from trajgap.problem import Case, CaseError, ClampedBSpline, parse_case

HEAD = """
format = 1
id = "knots"
title = "Printed knots"
[source]
title = "none"
[robot]
name = "arm"
joints = ["a", "b"]
[units]
position = "deg"
velocity = "deg/s"
time = "s"
[waypoints]
waypoint_rows = [[10, -50], [50, -30], [12, 20], [-25, 6]]
[limits]
velocity = [63, 97]
[interpolant]
"""
GIVEN = 'family = "clamped-b-spline"\ndegree = 4\nknots = "given"\n'
TIMED = f'{GIVEN}parameters = "times"\n'
STRETCHED = f'{GIVEN}parameters = "given"\ntime = "stretched"\n'
WHOLE = "knot_vector = [0, 0, 0, 0, 0, 2.5, 5, 8, 10, 10, 10, 10, 10]\n"
VALUES = "parameter_values = [0, 3, 6.5, 10]\n"


def case(interpolant: str, more: str = "") -> Case:
    return parse_case(f"{HEAD}{interpolant}\n{more}", "knots.toml")


def test_the_whole_vector_is_read_on_its_own_scale() -> None:
    timed = case(TIMED + WHOLE).problem().curve
    whole = (0, 0, 0, 0, 0, 0.25, 0.5, 0.8, 1, 1, 1, 1, 1)
    assert timed == ClampedBSpline(4, 4, "given", "times", knot_vector=whole)
    assert timed.name == "clamped B-spline of degree 4, printed knots"
    stretched = case(STRETCHED + WHOLE + VALUES).problem().curve
    assert stretched == ClampedBSpline(
        4, 4, "given", "given", "stretched", (1, 2), ((0, 0.3, 0.65, 1),), whole
    )
    assert stretched.name.endswith("printed knots of printed parameters, stretched in time")


def test_printed_parameters_place_averaged_knots_too() -> None:
    written = f'{GIVEN}parameters = "given"\n{VALUES}'.replace('"given"', '"averaged-continued"', 1)
    for more, time in (("", "timed"), ('time = "stretched"\n', "stretched")):
        assert case(written + more).problem().curve == ClampedBSpline(
            4, 4, "averaged-continued", "given", time, (1, 2), ((0, 0.3, 0.65, 1),)
        )


@pytest.mark.parametrize(
    ("written", "loose"),
    [
        (TIMED + WHOLE, ""),
        (TIMED + WHOLE.replace("2.5", '"2.5"'), "Knots"),
        (STRETCHED + WHOLE + VALUES, ""),
        (STRETCHED + WHOLE + VALUES.replace("6.5", '"6.5"'), "Parameters of way-points"),
        (
            STRETCHED + WHOLE.replace(" 8,", ' "8.0",') + VALUES.replace("3,", '"3.0",'),
            "Knots and parameters of way-points",
        ),
    ],
)
def test_printed_digits_are_intervals(written: str, loose: str) -> None:
    statement = case(written).statement("main", "as-printed")
    assert (statement.declaration.loose, statement.loose_ends) == (loose, bool(loose))


@pytest.mark.parametrize(
    ("written", "message"),
    [
        (TIMED, '.knot_vector: is missing; knots = "given" needs it'),
        (STRETCHED + WHOLE, '.parameter_values: is missing; parameters = "given" needs it'),
        (TIMED + WHOLE + VALUES, '.parameter_values: is for parameters = "given"; leave it out'),
        (TIMED.replace('"given"', '"waypoints"') + WHOLE, '.knot_vector: is for knots = "given"'),
        (TIMED + WHOLE.replace("2.5", "6"), ".knot_vector[6]: 5 follows 6, but must not be"),
        (STRETCHED + WHOLE + VALUES.replace("6.5", "3.0"), ".parameter_values[2]: 3.0 follows 3"),
        (STRETCHED + WHOLE + VALUES.replace("10", "1"), ".parameter_values[3]: 1 follows 6.5"),
        (
            STRETCHED + WHOLE + "parameter_values = [0, 0.3, 0.6, 1]\n",
            ".parameter_values: run from 0 to 1, but knot_vector from 0 to 10; give both on one "
            "scale",
        ),
        (
            STRETCHED + WHOLE + "parameter_values = [0, 5, 10]\n",
            ": parameter_values: 3 numbers for 4 way-points; give one each",
        ),
        (TIMED + "knot_vector = [1, 1, 1]\n", ".knot_vector: has one number alone, repeated"),
        (TIMED + "knot_vector = [0, 2.5, 5, 8, 10]\n", ": knot_vector: has 5 knots, but degree 4"),
        (TIMED + WHOLE.replace("8, ", ""), ": clamped B-spline of degree 4, printed knots:"),
        (f'{GIVEN}parameters = "chord"\n{WHOLE}', ': parameters: where knots are "given" and'),
        ('family = "quintic-spline"\n' + WHOLE, ".knot_vector: does not go with family"),
    ],
)
def test_each_fault_has_its_line(written: str, message: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(written)
    assert str(caught.value).startswith(f"knots.toml: interpolant{message}")


def test_readings_are_called_by_what_is_printed() -> None:
    readings = "".join(
        f'[[readings]]\nid = "{name}"\nwhy = "It is admitted."\n[readings.interpolant]\n{block}\n'
        for name, block in (
            ("timed", TIMED + WHOLE),
            ("stretched", STRETCHED + WHOLE + VALUES),
        )
    )
    assert case('family = "quintic-spline"', readings).labels == {
        "timed": "way-points at the times",
        "stretched": "way-points at printed parameters, each segment stretched in time by itself",
    }
