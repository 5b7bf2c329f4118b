"""The plan of the house: no circle of imports, and a picture that is not stale."""

from house.plan import arrows, circle, drawn, with_picture
from support.checkout import ROOT


def test_no_modules_import_each_other_in_a_loop() -> None:
    assert circle() == []


def test_the_picture_in_contributing_is_drawn_from_the_imports() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert page == with_picture(page), "run `python tests/house/plan.py --write`"
    assert drawn().count("subgraph") == 5


def test_the_plan_sees_imports_through_faces() -> None:
    own = arrows()["trajgap.nlp.optimum.solver"]
    assert "trajgap.problem.checks.checker" in own  # `from ...problem import check`
    assert "trajgap.nlp.optimum.basins" in own
    assert "trajgap.nlp.optimum.solver" not in own
