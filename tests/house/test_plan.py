"""The plan of the house: no circle of imports, few floors, and a picture that is not stale."""

from house.plan import arrows, circle, drawn, floors, room, with_picture
from support.checkout import ROOT

HIGHEST = 8
"""Floors of a folder: more, and a reader has lost the first when the last is reached."""


def test_no_modules_import_each_other_in_a_loop() -> None:
    assert circle() == []


def test_every_folder_is_a_few_floors_high() -> None:
    rooms = {room(one).replace("/", ".") for one in arrows() if "/" in room(one)}
    assert {one: floors(one) for one in rooms if floors(one) > HIGHEST} == {}


def test_the_picture_in_contributing_is_drawn_from_the_imports() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert page == with_picture(page), "run `python tests/house/plan.py --write`"
    assert drawn().count("subgraph") == 5


def test_the_plan_sees_imports_through_faces() -> None:
    own = arrows()["trajgap.nlp.optimum.solver"]
    assert "trajgap.problem.checker" in own  # `from ...problem import check`
    assert "trajgap.nlp.optimum.basins" in own
    assert "trajgap.nlp.optimum.solver" not in own
