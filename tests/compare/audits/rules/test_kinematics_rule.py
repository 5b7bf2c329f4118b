"""TG601: joint angles against positions, on cases built to fit or not, and on the palletiser."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from support.checkout import ROOT
from support.findings import study_of
from support.made_up import ARM, entry, paper, readings, sentence
from trajgap.compare.audits.rules.printed_chain import judge_kinematics
from trajgap.compare.audits.rules.printed_joints import judge_joints
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Basis, ClaimVerdict, Finding, Severity
from trajgap.problem import CaseError
from trajgap.problem.cases.load import load_case

ANGLES = {"a": [10.0, 60.5, -20.25, 55.0], "b": [20.0, 50.0, 120.0, 35.0]}
Points = Sequence[Sequence[str]]
Table = dict[str, Any]
TABLE: Table = ARM | {
    "joints": ["a", "c", "b"],
    "d": [0.3, 0, 0],
    "a": [0, "0.700", "0.400"],
    "alpha": [90, 0, 0],
}
RANGES = {"lower": [0, 0, 0], "upper": [1, 1, 1]}
SLIDING = TABLE | RANGES | {"kinds": ["revolute", "prismatic", "revolute"]}


def positions(third=0.0, elbow=(0.7, 0.4), up=1.0, unit=1000.0):
    """Positions of the end by hand: joint a turns the plane of joints c and b."""
    turn, bend = np.deg2rad(ANGLES["a"]), np.deg2rad(ANGLES["b"])
    first = np.deg2rad(np.broadcast_to(third, 4))
    out = elbow[0] * np.cos(first) + elbow[1] * np.cos(first + bend)
    height = elbow[0] * np.sin(first) + elbow[1] * np.sin(first + bend)
    points = np.stack([out * np.cos(turn), out * np.sin(turn), 0.3 + up * height], axis=1)
    return [[f"{unit * x:.1f}" for x in point] for point in points]


THIRD = [12.0, -40.0, 5.5, 70.0]
PLACES = positions(THIRD)
EXACT = TABLE | {"a": [0, 0.7, 0.4]}
UNSURE = {"alpha_signs": "uncertain"}
MODIFIED = TABLE | {"convention": "modified"}
OTHER_TOO = {"other_conventions": ["standard"]}
ROWS = [[f"{x:.2f}" for x in ANGLES[j]] for j in "ab"]


def column(values: Sequence[object] = THIRD, **keys: str) -> str:
    return entry("columns", id="c", where="Table 1", joint="c", values=list(values), **keys)


def case_text(points: Points, table: Table = TABLE, *parts: str, **keys: Any) -> str:
    """An arm that prints joints a and b, positions of its end, and parts that follow."""
    placed = (
        entry("cartesian", id=f"p{i}", where="Table 2", unit="mm", values=point)
        for i, point in enumerate(points)
    )
    labels = {"labels": ["A", "B", "C", "D"]}
    robot = {"joints": ["a", "b"]} | ({"dh": table} if table else {})
    curve = {"family": "3-5-3"}
    return paper(
        ROWS, *parts, *placed, curve=curve, waypoints=labels, robot=robot, angle="deg", **keys
    )


def findings(text: str) -> list[Finding]:
    return list(judge_kinematics(study_of(text)))


def one(points: Points = PLACES, table: Table = TABLE, *parts: str, **keys: Any) -> Finding:
    (found,) = findings(case_text(points, table, *parts, **keys))
    assert found.rule == "TG601"
    assert found.basis is Basis.KINEMATICS
    inconsistent = found.verdict is ClaimVerdict.INCONSISTENT
    assert found.severity is (Severity.WARNING if inconsistent else Severity.INFO)
    return found


def higher(points: Points, place: int, at: int, by: float) -> Points:
    moved = [list(point) for point in points]
    moved[place][at] = f"{float(moved[place][at]) + by:.1f}"
    return moved


def test_positions_cut_off_accuse_nobody() -> None:
    rows = [[str(int(float(x))) for x in point] for point in PLACES]
    moved = np.subtract(np.array(PLACES, float), np.array(rows, float))
    # Rounding to a millimetre and the digits of the angles explain 1.1 mm.
    assert np.linalg.norm(moved, axis=1).max() > 1.2
    assert one(rows, EXACT, column()).verdict is ClaimVerdict.NOT_CHECKABLE
    assert one(higher(rows, 1, 0, 3), EXACT, column()).verdict is ClaimVerdict.INCONSISTENT


HANGING = positions(THIRD, up=-1.0)
"""The arm hangs down: the twist's sign is the other one."""
LOST = [[*HANGING[0][:2], HANGING[0][2].lstrip("-")], *HANGING[1:]]
"""A minus sign that one coordinate lacks."""
SLIGHTLY = positions(THIRD, elbow=(0.7004, 0.3996))


@pytest.mark.parametrize(
    ("points", "table", "third", "verdict", "said"),
    [
        (PLACES, TABLE, column(), "supported", "angles of joints a, c and b are read in deg."),
        # A joint that is not printed takes what fits.
        (PLACES, TABLE, "", "supported", "joint c may have any value."),
        (higher(PLACES, 2, 1, 30), TABLE, "", "inconsistent", "p0 0.000, p1 0.000, p2 0.0"),
        # Rounding of lengths is not held against a case.
        (SLIGHTLY, TABLE, "", "supported", ""),
        (SLIGHTLY, EXACT, column(), "inconsistent", ""),
        (SLIGHTLY, TABLE, column(), "supported", ""),
        # Signs that may be lost are tried.
        (HANGING, TABLE, column(), "inconsistent", ""),
        (HANGING, TABLE | UNSURE, column(), "not checkable", "With other signs of the twists"),
        ([[x, y, "-900.0"] for x, y, _ in HANGING], TABLE | UNSURE, column(), "inconsistent",
         "For all signs of the twists, the angles and the positions"),
        (LOST, TABLE | UNSURE, column(), "not checkable",
         "no printed position is shown to be out of reach"),
        (LOST, TABLE, column(), "inconsistent", ""),
        # Another admitted convention may fit.
        (PLACES, MODIFIED, column(), "inconsistent", ""),
        (PLACES, MODIFIED | OTHER_TOO, column(), "supported",
         "(standard convention)"),
        (HANGING, MODIFIED | UNSURE | OTHER_TOO, column(), "not checkable",
         "With other signs of the twists"),
        # Axes of the base that are swapped keep the distance from its origin.
        ([[y, x, z] for x, y, z in PLACES], MODIFIED | OTHER_TOO, column(), "inconsistent",
         "m (modified); in the standard convention it may agree."),
        # Nothing to say, or not enough.
        (positions(), {}, "", "not checkable", "but no table of the robot."),
        (positions(), SLIDING, "", "not checkable",
         "joint c slides, and its positions are not printed"),
        (positions(), SLIDING, column([1.0, 2.0, 3.0, 4.0]), "not checkable",
         "the unit of joint c is not that of its kind in the robot's table"),
    ],
)  # fmt: skip
def test_positions_are_held_against_angles(
    points: Points, table: Table, third: str, verdict: str, said: str
) -> None:
    found = one(points, table, third)
    assert found.verdict == verdict
    assert said in found.message
    assert ("signs of the twists" in found.message) <= ("alpha_signs" in table)


def test_positions_may_name_their_way_point() -> None:
    for first, second, verdict in (("D", "B", "supported"), ("B", "D", "inconsistent")):
        text = case_text([PLACES[3], PLACES[1]], TABLE, column())
        for k, label in enumerate((first, second)):
            text = text.replace(f'id = "p{k}"', f'id = "p{k}"\nwaypoint = "{label}"')
        (found,) = findings(text)
        assert found.verdict == verdict


OTHER = [[10.0, 20.0], [60.5, 50.0], [-20.25, 120.0], [55.0, 40.0]]
THREE = {"waypoints": {"waypoint_rows": OTHER[:3]}, "interpolant": {"family": "cubic-spline"}}


def test_problems_with_other_way_points_are_judged_apart() -> None:
    ways = {"waypoints": {"waypoint_rows": OTHER}}
    parts = (entry("problems", id=k, **v) for k, v in (("same", {}), ("other", ways), ("more", {})))
    text = case_text(PLACES, TABLE, *parts, column())
    assert {f.problem: f.verdict for f in findings(text)} == {
        "same": "supported", "other": "inconsistent"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "third", "verdict", "said"),
    [
        ({"units": {"position": "rad"}}, column(), "inconsistent", "are read in rad"),
        (THREE, "", "not checkable", "the numbers of positions and way-points differ"),
    ],
)
def test_each_reading_is_judged(changes: Any, third: str, verdict: str, said: str) -> None:
    text = case_text(PLACES, TABLE, readings(plain={}, other=changes), third)
    found = {f.reading: f for f in findings(text)}
    assert (found["plain"].verdict, found["other"].verdict) == ("supported", verdict)
    assert said in found["other"].message


def test_without_positions_there_is_no_finding() -> None:
    assert findings(case_text([])) == []
    assert list(judge_kinematics(Study(load_case("puma560-mnam-pso-353")))) == []


def test_a_column_has_a_unit_of_its_own_where_joints_have() -> None:
    """The slide at the end of a SCARA arm, printed in a column."""
    kinds = {"joints": ["a", "b", "c"], "kinds": ["revolute", "revolute", "prismatic"]}
    table = ARM | kinds | {"d": [0.3, 0, 0], "a": [0.5, "0.400", 0], "alpha": [0, 0, 0]}
    drop = np.array([5.0, 10.0, 15.0, 20.0])
    first, second = np.deg2rad(ANGLES["a"]), np.deg2rad(ANGLES["b"])
    x = 0.5 * np.cos(first) + 0.4 * np.cos(first + second)
    y = 0.5 * np.sin(first) + 0.4 * np.sin(first + second)
    points = np.stack([1000 * x, 1000 * y, 300 + drop], axis=1)
    shown = [[f"{v:.1f}" for v in point] for point in points]
    units = {"position": ["deg", "deg"]}
    with pytest.raises(CaseError, match=r"columns\[0\].unit: is needed if units.position lists"):
        one(shown, table, column(drop.tolist()), units=units)
    for unit, verdict in (("mm", "supported"), ("cm", "inconsistent")):
        found = one(shown, table, column(drop.tolist(), unit=unit), units=units)
        assert found.verdict == verdict


# Printed equations


def test_equations_are_judged_and_never_held_against_a_paper() -> None:
    """The arm's third joint stands between: its position from joints a, c and b by hand."""
    right = "px = c1*(0.7*c2 + 0.4*c23)"
    for (printed, mended), verdict, said in (
        ((right, None), "supported", "1 of 1 equations hold at every pose tried, as the text has"),
        (("px = s1", right), "not checkable", "Others hold once corrected: (4) with all of it."),
        (("px = s1", "px = c1"), "not checkable", "These do not hold as printed: (4)."),
        (("t1 = atan2(py, px)", "t1 = atan2(pm*py, pm*px)"), "not checkable", "poses as printed"),
    ):
        keys = {"printed": printed} | ({"mended": mended, "mend": "all of it"} if mended else {})
        equation = entry("equations", id="e", where="equation (4)", **keys)
        claim = sentence("holds", "equations")
        study = study_of(case_text([], EXACT, claim, equation))
        (found,) = judge_joints(study)
        assert (found.rule, found.claim, found.verdict) == ("TG603", "holds", verdict)
        assert found.severity is Severity.INFO
        assert said in found.message
        assert ("It is unknown whether" in found.message) == (verdict == "not checkable")


# The palletiser


def distances(reading: str, convention: str) -> list[float]:
    """Smallest distances over joints 2 and 4 in closed form, from the printed digits."""
    case = load_case("irb460-pso-353")
    unit = 1.0 if reading == "rad" else np.pi / 180
    rows = {c.joint: unit * np.array([v.value for v in c.values]) for c in case.columns}
    found = []
    for k, place in enumerate(case.cartesian):
        x, y, z = (v.value for v in place.values)
        first, third = rows["1"][k], rows["3"][k]
        if convention == "modified":
            # A circle of 0.6 m about the elbow, in the plane of x and z.
            around = np.hypot(x - 0.6 * np.cos(first), z + 0.6 * np.sin(first))
            found.append(float(np.hypot(y, around - 0.6)))
        else:
            # A circle of fixed radius about the base, in the vertical plane that joint 1 turns.
            radius = 0.6 * np.sqrt(2 + 2 * np.cos(third))
            along = x * np.cos(first) + y * np.sin(first)
            across = y * np.cos(first) - x * np.sin(first)
            found.append(float(np.hypot(across, np.hypot(along, z) - radius)))
    return found


@pytest.fixture(scope="module")
def palletiser() -> dict[str, Finding]:
    return {f.reading: f for f in judge_kinematics(Study(load_case("irb460-pso-353")))}


@pytest.mark.parametrize("unit", ["rad", "deg"])
def test_the_palletiser_is_inconsistent_under_both_units(palletiser, unit):
    found = palletiser[f"waypoints-{unit}"]
    assert found.problem is None
    assert found.verdict is ClaimVerdict.INCONSISTENT
    assert found.severity is Severity.WARNING
    for convention in ("modified", "standard"):
        part = re.search(rf"(?:positions:|;) (pick [^;]*?) m \({convention} conv", found.message)
        printed = [float(x) for x in re.findall(r"\d\.\d{3}", part[1])]
        expected = distances(unit, convention)
        assert len(printed) == 4
        for shown, exact in zip(printed, expected, strict=True):
            # Never more than is so, and no less than the bounds and three digits leave.
            assert exact - 1.3e-3 < shown <= exact + 1e-9


def test_the_page_prints_these_numbers(palletiser):
    page = (ROOT / "docs/reference/robots.md").read_text("utf-8")
    rows = dict(re.findall(r"^\| ([^|]+?) \| (\d.*) \|$", page, re.MULTILINE))
    for unit in ("rad", "deg"):
        message = palletiser[f"waypoints-{unit}"].message
        for convention in ("modified", "standard"):
            numbers = rows[f"{convention}, {unit}"].split(" | ")
            names = ("pick", "lift", "above place", "place")
            listed = ", ".join(f"{n} {x}" for n, x in zip(names, numbers, strict=True))
            assert f"{listed} m ({convention} convention)" in message
        slack = rows["rounding explains at most"].replace(" | ", ", ")
        assert f"Rounding explains at most {slack} m." in message
    case = load_case("irb460-pso-353")
    third = next(column.values for column in case.columns if column.joint == "3")
    radial = [
        abs(0.6 * np.sqrt(2 + 2 * np.cos(t.value)) - np.linalg.norm([v.value for v in p.values]))
        for t, p in zip(third, case.cartesian, strict=True)
    ]
    said = re.search(r"by\s+([\d.]+), ([\d.]+), ([\d.]+) and ([\d.]+) m, whatever", page)
    np.testing.assert_allclose([float(x) for x in said.groups()], radial, atol=1.1e-3)
