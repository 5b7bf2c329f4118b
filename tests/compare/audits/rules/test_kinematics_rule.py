"""TG601: joint angles against positions, on cases built to fit or not, and on the palletiser."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support.checkout import ROOT
from trajgap.compare.audits.rules import GROUPS, RULES
from trajgap.compare.audits.rules.printed_chain import judge_kinematics
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Basis, ClaimVerdict, Finding, Severity
from trajgap.problem import CaseError
from trajgap.problem.cases.load import load_case, parse_case
from trajgap.problem.printed import Printed

ANGLES = {"a": [10.0, 60.5, -20.25, 55.0], "b": [20.0, 50.0, 120.0, 35.0]}
TABLE = """
[robot.dh]
convention = "standard"
length_unit = "m"
angle_unit = "deg"
joints = ["a", "c", "b"]
d = [0.3, 0, 0]
a = [0, "0.700", "0.400"]
alpha = [90, 0, 0]
"""


def positions(third=0.0, elbow=(0.7, 0.4), up=1.0, unit=1000.0):
    """Positions of the end by hand: joint a turns the plane of joints c and b."""
    turn, bend = np.deg2rad(ANGLES["a"]), np.deg2rad(ANGLES["b"])
    first = np.deg2rad(np.broadcast_to(third, 4))
    out = elbow[0] * np.cos(first) + elbow[1] * np.cos(first + bend)
    height = elbow[0] * np.sin(first) + elbow[1] * np.sin(first + bend)
    points = np.stack([out * np.cos(turn), out * np.sin(turn), 0.3 + up * height], axis=1)
    return [[f"{unit * x:.1f}" for x in point] for point in points]


def case_text(points, table: str = TABLE, column: str = "", readings: str = "") -> str:
    rows = [[f"{x:.2f}" for x in ANGLES[j]] for j in "ab"]
    text = f"""
format = 1
id = "arm"
title = "arm"
[source]
year = 2001
[robot]
name = "arm"
joints = ["a", "b"]
{table}
[units]
position = "deg"
[waypoints]
labels = ["A", "B", "C", "D"]
joint_rows = {rows}
[interpolant]
family = "3-5-3"
{readings}{column}
"""
    for i, point in enumerate(points):
        text += f'[[cartesian]]\nid = "p{i}"\nwhere = "Table 2"\nunit = "mm"\nvalues = {point}\n'
    return text


def findings(text: str) -> list[Finding]:
    return list(judge_kinematics(Study(parse_case(text, "arm.toml"))))


def column(values) -> str:
    return f'[[columns]]\nid = "c"\nwhere = "Table 1"\njoint = "c"\nvalues = {values}\n'


def one(text: str) -> Finding:
    (found,) = findings(text)
    assert found.rule == "TG601"
    assert found.basis is Basis.KINEMATICS
    assert found.severity is not Severity.ERROR
    return found


def test_a_consistent_case_is_supported():
    third = [12.0, -40.0, 5.5, 70.0]
    found = one(case_text(positions(third), column=column([f"{x:.1f}" for x in third])))
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert found.severity is Severity.INFO
    assert found.message.startswith("The end meets every printed position within")
    assert "The angles of joints a, c and b are read in deg." in found.message


def test_joints_that_are_not_printed_take_what_fits():
    found = one(case_text(positions([12.0, -40.0, 5.5, 70.0])))
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "joints a and b are read in deg; joint c may have any value." in found.message


def test_one_wrong_position_is_inconsistent():
    points = positions([12.0, -40.0, 5.5, 70.0])
    points[2][1] = f"{float(points[2][1]) + 30:.1f}"
    found = one(case_text(points))
    assert found.verdict is ClaimVerdict.INCONSISTENT
    assert found.severity is Severity.WARNING
    assert (
        "The end then comes no nearer to the printed positions than p0 0.000, p1 0.000, p2 0.0"
        in (found.message)
    )
    assert "signs of the twists" not in found.message


def test_rounding_is_not_held_against_a_case():
    points = positions([12.0, -40.0, 5.5, 70.0], elbow=(0.7004, 0.3996))
    assert one(case_text(points)).verdict is ClaimVerdict.SUPPORTED
    exact = TABLE.replace('"0.700", "0.400"', "0.7, 0.4")
    third = column([12, -40, 5.5, 70])
    assert one(case_text(points, exact, third)).verdict is ClaimVerdict.INCONSISTENT
    assert one(case_text(points, TABLE, third)).verdict is ClaimVerdict.SUPPORTED


def test_each_reading_of_the_unit_is_judged():
    readings = (
        '[[readings]]\nid = "deg"\nwhy = "a"\n'
        '[[readings]]\nid = "rad"\nwhy = "b"\nunits = { position = "rad" }\n'
    )
    third = [12.0, -40.0, 5.5, 70.0]
    text = case_text(positions(third), readings=readings, column=column(third))
    by_reading = {f.reading: f for f in findings(text)}
    assert by_reading["deg"].verdict is ClaimVerdict.SUPPORTED
    assert by_reading["rad"].verdict is ClaimVerdict.INCONSISTENT
    assert "are read in rad" in by_reading["rad"].message


def test_signs_that_may_be_lost_are_tried():
    # The arm hangs down: the twist's sign is the other one.
    points = positions([12.0, -40.0, 5.5, 70.0], up=-1.0)
    third = column([12, -40, 5.5, 70])
    certain = one(case_text(points, TABLE, third))
    assert certain.verdict is ClaimVerdict.INCONSISTENT
    found = one(case_text(points, TABLE + 'alpha_signs = "uncertain"\n', third))
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert found.severity is Severity.INFO
    assert "With other signs of the twists, which the text may have lost, the end meets" in (
        found.message
    )
    wrong = [[x, y, "-900.0"] for x, y, _ in points]
    neither = one(case_text(wrong, TABLE + 'alpha_signs = "uncertain"\n', third))
    assert neither.verdict is ClaimVerdict.INCONSISTENT
    assert "Whatever signs the twists, the angles and the positions have" in neither.message
    # A minus sign that one coordinate lacks explains the distance, so that nothing is decided.
    lost = [[*points[0][:2], str(points[0][2]).lstrip("-")], *points[1:]]
    assert lost != points
    unsigned = one(case_text(lost, TABLE + 'alpha_signs = "uncertain"\n', third))
    assert unsigned.verdict is ClaimVerdict.NOT_CHECKABLE
    assert (
        "which the text may have lost, no printed position is shown to be out of reach"
        in unsigned.message
    )
    assert one(case_text(lost, TABLE, third)).verdict is ClaimVerdict.INCONSISTENT


def test_another_admitted_convention_may_fit():
    third = column([12, -40, 5.5, 70])
    modified = TABLE.replace('"standard"', '"modified"')
    points = positions([12.0, -40.0, 5.5, 70.0])
    assert one(case_text(points, modified, third)).verdict is ClaimVerdict.INCONSISTENT
    both = modified + 'other_conventions = ["standard"]\n'
    found = one(case_text(points, both, third))
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "(standard convention)" in found.message


def test_positions_may_name_their_way_point():
    third = [12.0, -40.0, 5.5, 70.0]
    points = positions(third)
    text = case_text([points[3], points[1]], column=column([f"{x:.1f}" for x in third]))
    text = text.replace('id = "p0"', 'id = "p0"\nwaypoint = "D"').replace(
        'id = "p1"', 'id = "p1"\nwaypoint = "B"'
    )
    assert one(text).verdict is ClaimVerdict.SUPPORTED
    swapped = text.replace('"D"\nwhere', '"x"\nwhere').replace('"B"\nwhere', '"D"\nwhere')
    swapped = swapped.replace('"x"\nwhere', '"B"\nwhere')
    assert one(swapped).verdict is ClaimVerdict.INCONSISTENT


def test_problems_with_other_way_points_are_judged_apart():
    third = [12.0, -40.0, 5.5, 70.0]
    rows = [[10.0, 20.0], [60.5, 50.0], [-20.25, 120.0], [55.0, 40.0]]
    problems = (
        '[[problems]]\nid = "same"\n'
        f'[[problems]]\nid = "other"\nwaypoints = {{ waypoint_rows = {rows} }}\n'
        '[[problems]]\nid = "again"\n'
    )
    text = case_text(positions(third), readings=problems, column=column(third))
    by_problem = {f.problem: f.verdict for f in findings(text)}
    assert by_problem == {
        "same": ClaimVerdict.SUPPORTED,
        "other": ClaimVerdict.INCONSISTENT,
    }


# Nothing to say, or not enough


def test_without_positions_there_is_no_finding():
    assert findings(case_text([])) == []
    assert list(judge_kinematics(Study(load_case("puma560-mnam-pso-353")))) == []


def test_without_a_table_it_is_not_checkable():
    found = one(case_text(positions(), table=""))
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert found.message == "Positions of the end are printed, but no table of the robot."


def test_a_sliding_joint_that_is_not_printed_leaves_nothing_to_check():
    table = (
        TABLE
        + 'kinds = ["revolute", "prismatic", "revolute"]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n'
    )
    found = one(case_text(positions(), table))
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "joint c slides, and its positions are not printed" in found.message


def test_angles_of_a_joint_that_slides_are_not_taken_for_metres():
    table = (
        TABLE
        + 'kinds = ["revolute", "prismatic", "revolute"]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n'
    )
    found = one(case_text(positions(), table, column([1.0, 2.0, 3.0, 4.0])))
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "the unit of joint c is not that of its kind in the robot's table" in found.message


def test_a_column_has_a_unit_of_its_own_where_joints_have():
    """The slide at the end of a SCARA arm, printed in a column."""
    table = """
[robot.dh]
convention = "standard"
length_unit = "m"
angle_unit = "deg"
joints = ["a", "b", "c"]
kinds = ["revolute", "revolute", "prismatic"]
d = [0.3, 0, 0]
a = [0.5, "0.400", 0]
alpha = [0, 0, 0]
"""
    drop = np.array([5.0, 10.0, 15.0, 20.0])
    first, second = np.deg2rad(ANGLES["a"]), np.deg2rad(ANGLES["b"])
    x = 0.5 * np.cos(first) + 0.4 * np.cos(first + second)
    y = 0.5 * np.sin(first) + 0.4 * np.sin(first + second)
    points = np.stack([1000 * x, 1000 * y, 300 + drop], axis=1)
    text = case_text(
        [[f"{v:.1f}" for v in point] for point in points], table, column(drop.tolist())
    )
    text = text.replace('position = "deg"', 'position = ["deg", "deg"]')
    with pytest.raises(CaseError, match=r"columns\[0\].unit: is needed where units.position lists"):
        one(text)
    fits = one(text.replace('joint = "c"', 'joint = "c"\nunit = "mm"'))
    assert fits.verdict is ClaimVerdict.SUPPORTED
    assert one(text.replace('joint = "c"', 'joint = "c"\nunit = "cm"')).verdict is (
        ClaimVerdict.INCONSISTENT
    )


def test_a_reading_with_other_way_points_is_not_checkable():
    points = [[10.0, 20.0], [60.5, 50.0], [-20.25, 120.0]]
    readings = (
        '[[readings]]\nid = "four"\nwhy = "a"\n[[readings]]\nid = "three"\nwhy = "b"\n'
        f'waypoints = {{ waypoint_rows = {points} }}\ninterpolant = {{ family = "cubic-spline" }}\n'
    )
    third = [12.0, -40.0, 5.5, 70.0]
    by_reading = {f.reading: f for f in findings(case_text(positions(third), readings=readings))}
    assert by_reading["four"].verdict is ClaimVerdict.SUPPORTED
    assert by_reading["three"].verdict is ClaimVerdict.NOT_CHECKABLE
    assert "the numbers of positions and way-points differ" in by_reading["three"].message


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
        part = re.search(rf"(?:than|;) (pick [^;]*?) m \({convention} convention\)", found.message)
        printed = [float(x) for x in re.findall(r"\d\.\d{3}", part[1])]
        expected = distances(unit, convention)
        assert len(printed) == 4
        for shown, exact in zip(printed, expected, strict=True):
            # Never more than is so, and no less than the bounds and three digits leave.
            assert exact - 1.3e-3 < shown <= exact + 1e-9


def test_the_page_prints_these_numbers(palletiser):
    page = (ROOT / "docs" / "reference" / "robots.md").read_text(encoding="utf-8")
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


def test_the_rule_is_registered_and_documented():
    assert "TG601" in {rule.id for rule in RULES}
    assert judge_kinematics in [group.judge for group in GROUPS]
    assert "| TG601 |" in (ROOT / "docs" / "explanation" / "verdicts.md").read_text(
        encoding="utf-8"
    )


def test_printed_positions_lie_at_the_reach_of_one_elbow_angle():
    # All four at 0.6·√3 from the base within their rounding: cos θ3 = 1/2 in the standard reading.
    for place in load_case("irb460-pso-353").cartesian:
        squares = [v.value**2 for v in place.values]
        slack = sum((v.upper - v.lower) for v in place.values if isinstance(v, Printed))
        assert abs(np.sqrt(sum(squares)) - 0.6 * np.sqrt(3)) <= slack + 1e-9
