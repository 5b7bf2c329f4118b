"""Case files written from a table of way-points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.refusals import Refusal, each_refusal
from trajgap.problem.cases.literature import LITERATURE
from trajgap.problem.cases.load import parse_case
from trajgap.problem.cases.scaffolding import scaffold
from trajgap.problem.errors import CaseError

RAD = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s^2"}


@pytest.fixture
def table(tmp_path):
    def write(text):
        path = tmp_path / "My table 1.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
        return path

    return write


def test_a_labelled_table(table):
    path = table("point;q1;q2\nA;0.50;−1\n\nB;1;2\nC;1.25;0.3\nD;0;0\n")
    text = scaffold(path, RAD, velocity="6", acceleration=".5")
    case = parse_case(text, "x")
    assert case.id == "my-table-1"
    assert case.robot.joints == ("q1", "q2")
    assert case.document.waypoints.labels == ("A", "B", "C", "D")
    assert [n.text for n in case.document.waypoints.points[0]] == ["0.50", "-1"]
    problem = case.problem()
    np.testing.assert_array_equal(problem.waypoints, [[0.5, -1], [1, 2], [1.25, 0.3], [0, 0]])
    np.testing.assert_array_equal(problem.limits.velocity, [6, 6])
    np.testing.assert_array_equal(problem.limits.acceleration, [0.5, 0.5])
    assert problem.curve.degrees == (3, 5, 3)
    assert "trajgap" not in text
    assert '# jerk = "rad/s^3"' in text


def test_a_plain_table_in_degrees(table):
    path = table("1\t2\t3\n10\t20\t30\n40\t50\t60\n")
    case = parse_case(scaffold(path, {"position": "deg", "time": "ms"}, case_id="mine"), "x")
    assert case.id == "mine"
    np.testing.assert_allclose(case.problem().waypoints[1], np.deg2rad([40, 50, 60]), rtol=1e-15)
    assert case.problem().curve.degrees == (3,)


def test_the_family_can_be_chosen(table):
    path = table("a\n1\n2\n3\n")
    case = parse_case(scaffold(path, {"position": "rad"}, family="quintic-spline"), "x")
    assert case.problem().curve.degrees == (5, 5)


def test_a_gap_in_the_last_line_end_does_not_matter(table):
    assert scaffold(table("a,b\r\n1,2\r\n3,4"), RAD) == scaffold(table("a,b\n1,2\n3,4\n"), RAD)


@pytest.mark.parametrize(
    ("text", "joints", "labels"),
    [
        ("q1 q2\n10 20\n30  40\n", ("q1", "q2"), ("1", "2")),
        ("q1\tq2\n10\t20\n30\t40\n", ("q1", "q2"), ("1", "2")),
        ("where;q1;q2\nA;10;20\nB;30;40\n", ("q1", "q2"), ("A", "B")),
        ("P q1 q2\nP1 10 20\nP2 30 40\n", ("q1", "q2"), ("P1", "P2")),
        ("No.,q1,q2\n1,10,20\n2,30,40\n", ("q1", "q2"), ("1", "2")),
        ("joint,A,B\nq1,10,30\nq2,20,40\n", ("q1", "q2"), ("A", "B")),
        ("Joint 1 2\nq1 10 30\nq2 20 40\n", ("q1", "q2"), ("1", "2")),
        ("point,1,2\nA,10,20\nB,30,40\n", ("1", "2"), ("A", "B")),
        ("1,2\n10,20\n30,40\n", ("1", "2"), ("1", "2")),
    ],
)
def test_tables_of_many_forms_hold_the_same_way_points(table, text, joints, labels):
    said = []
    path = table(text)
    case = parse_case(scaffold(path, {"position": "deg"}, warn=said.append), "x")
    assert (case.robot.joints, case.document.waypoints.labels) == (joints, labels)
    np.testing.assert_array_equal(
        np.rad2deg(case.problem().waypoints).round(9), [[10, 20], [30, 40]]
    )
    # Numbers in their order are names, or a way-point whose header is missing.
    warned = (
        f"{path}: line 1 is taken for the names of the joints, 1, 2; if these are a way-point, "
    )
    assert said == ([warned + "put a header above it"] if text.startswith("1") else [])


names = st.text(st.characters(codec="utf-8", exclude_characters=",;\t\r\n"), min_size=1)
numbers = st.decimals(-999, 999, places=3).map(str)


@given(st.lists(names, min_size=1, max_size=4), st.data())
def test_what_is_written_loads_or_the_table_is_refused(tmp_path_factory, joints, data):
    path = tmp_path_factory.mktemp("t") / "t.csv"
    rows = [[data.draw(numbers) for _ in joints] for _ in range(3)]
    lines = ["point," + ",".join(joints), *(f"p{k}," + ",".join(r) for k, r in enumerate(rows))]
    path.write_text("\n".join(lines), encoding="utf-8", newline="")
    try:
        case = parse_case(scaffold(path, RAD), "x")
    except CaseError as error:
        assert str(error).startswith(f"{path}: ")  # noqa: PT017
        return
    np.testing.assert_array_equal(case.problem().waypoints, np.array(rows, dtype=float))
    assert [j.strip() for j in joints] == list(case.robot.joints)


@each_refusal("tables")
def test_tables_that_are_refused(table, one: Refusal):
    path = table(one.text(""))
    one.said_by(lambda: scaffold(path, RAD), f"{path}: ")


@pytest.mark.parametrize(
    ("units", "options", "reason"),
    [
        ({}, {}, "units.position: is missing; give one of rad, deg, m, cm, mm"),
        ({"position": "rad"}, {"jerk": "9"}, "units.jerk: is missing; give one of rad/s^3"),
        ({"position": "rad/s"}, {}, "units.position: 'rad/s' measures velocity, not position"),
        ({"angle": "rad", "position": "rad"}, {}, "units.angle: no such quantity; known:"),
        (RAD, {"velocity": "-6"}, "velocity: -6 is negative; give 0 or more"),
        (
            RAD,
            {"velocity": "six"},
            "velocity: 'six' is not a finite decimal number; "
            'write the printed digits alone, such as "0.660"',
        ),
        (RAD, {"case_id": "My case"}, "case_id: 'My case' is not an id; use lower-case letters"),
        (RAD, {"family": "3-5-3"}, "family: 3-5-3 polynomials of 3 segments passes 4 way-points"),
    ],
)
def test_options_that_are_refused(table, units, options, reason):
    path = table("a,b\n1,2\n3,4\n")
    with pytest.raises(CaseError) as caught:
        scaffold(path, units, **options)
    assert str(caught.value).startswith(reason)


def test_tables_that_cannot_be_read(table, tmp_path):
    with pytest.raises(CaseError, match="is a binary file; a UTF-8 text file is needed"):
        scaffold(table(b"a,b\n\x00,1"), RAD)
    with pytest.raises(CaseError, match=r"none\.csv: no such file; check the path"):
        scaffold(tmp_path / "none.csv", RAD)


def points(count):
    return "1,2\n" + "".join(f"0.{k}1,{k % 3}.5\n" for k in range(count))


@pytest.mark.parametrize("name", LITERATURE)
def test_every_name_of_the_literature_declares_a_curve(table, name):
    text = scaffold(table(points(4)), RAD, family=name, velocity="6", acceleration="8")
    assert f"# what papers call {name}" in text
    assert parse_case(text, "x").problem().curve.segments >= 3


def test_what_papers_call_curves_has_their_degrees_and_ends(table):
    path = table(points(4))

    def curve(name):
        return parse_case(scaffold(path, RAD, family=name), "x").problem().curve

    assert curve("4-3-4").degrees == (4, 3, 4)
    assert curve("quintic-b-spline").degrees == (5, 5, 5)
    assert curve("septic-polynomials").degrees == (7, 7, 7)
    assert curve("natural-cubic").prescribed == (((2, 0.0),), (), (), ((2, 0.0),))
    assert curve("clamped-cubic").prescribed == (((1, 0.0),), (), (), ((1, 0.0),))


def test_a_default_without_a_shortest_motion_is_not_one(table):
    path = table(points(5))
    assert 'family = "cubic-spline-virtual"' in scaffold(path, RAD | {"jerk": "rad/s^3"}, jerk="9")
    text = scaffold(path, RAD, acceleration="8")
    assert 'family = "cubic-spline"  # cubic-spline-virtual has no shortest motion' in text


def test_a_curve_without_a_shortest_motion_is_written_with_what_it_takes(table):
    text = scaffold(table(points(5)), RAD, family="quintic-spline-virtual")
    assert "# no motion is the shortest unless [durations] has a lower bound" in text
    assert parse_case(text, "x").problem().segments == 6


def test_a_unit_without_a_limit_is_written_for_printed_peaks(table):
    text = scaffold(table(points(4)), RAD)
    assert (parse_case(text, "x").document.units.velocity, "# jerk" in text) == ("rad/s", True)


def test_durations_without_decimals_carry_what_they_may_be(table):
    text = scaffold(table(points(4)), RAD, durations="1,2.0,3")
    assert '"3"]  # "1" may be 0.5 to 1.5; no quotes: exact' in text
    assert "no quotes" not in scaffold(table(points(4)), RAD, durations="1.0,2.0,3.0")


def test_limits_of_each_joint_and_printed_times_are_taken_as_given(table):
    text = scaffold(
        table(points(4)),
        RAD,
        velocity="6, 5.50",
        durations="0.910, 1.35,1.10",
        total="3.36",
        where="Table 2",
    )
    case = parse_case(text, "x")
    np.testing.assert_array_equal(case.problem().limits.velocity, [6, 5.5])
    (claim,) = case.claims
    assert [d.text for d in claim.durations] == ["0.910", "1.35", "1.10"]
    assert claim.total.text == "3.36"
    (alone,) = parse_case(scaffold(table(points(4)), RAD, total="3.36", where="x"), "x").claims
    assert (alone.quantity, alone.value.text) == ("total_time", "3.36")


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"velocity": "1,2,3"}, "velocity: lists 3 numbers for 2 joints; give one for all, or one"),
        ({"durations": "1,x,2"}, "durations: 'x' is not a finite decimal number"),
        ({"family": "clamped"}, "family: 'clamped' is not known; did you mean clamped-b-spline"),
        ({"durations": "1,2"}, "durations: lists 2 numbers, and the curve has 3 segments; give"),
        (
            {"durations": "1,2,3,4", "family": "rest-to-rest", "degree": 5, "where": "x"},
            "durations: lists 4 numbers, and the curve has 3 segments; give one for each",
        ),
        ({"family": "bezier"}, "family: 'bezier' is not known; use one of 3-5-3"),
        ({"family": "rest-to-rest"}, "degree: is missing"),
    ],
)
def test_new_options_that_are_refused(table, options, reason):
    path = table(points(4))
    with pytest.raises(CaseError) as caught:
        scaffold(path, RAD, **options)
    assert str(caught.value).startswith(reason)


def test_all_faults_of_table_and_arguments_are_named_at_once(table):
    path = table("a,b\n1,x\n3\n")
    with pytest.raises(CaseError) as caught:
        scaffold(path, {}, family="bezier", velocity="6", jerk="1,2,3", durations="y")
    assert str(caught.value).startswith(f"{path}: line 2, column 2: 'x' is not a finite")
    fields = [field for field, _ in caught.value.faults]
    assert fields == [
        "line 2, column 2",
        "line 3",
        "units.position",
        "units.velocity",
        "units.jerk",
        "durations",
        "jerk",
        "family",
    ]


@pytest.mark.parametrize(
    ("unit", "rows", "written", "remark"),
    [
        ("deg", "-10,90\n60,0\n", [["-10", "90"], ["60", "0"]], "settings and meant exactly"),
        ("rad", "1,0\n2,-3\n", [["1", "0"], ["2", "-3"]], "settings and meant exactly"),
        ("deg", "12.5,0\n−35,7.0\n", [['"12.5"', "0"], ["-35", '"7.0"']], "settings and meant"),
        ("deg", "37,90\n112,0\n", [['"37"', '"90"'], ['"112"', '"0"']], '"37" may be 36.5 to'),
        ("rad", "0.50,1.00\n2.10,0.00\n", [['"0.50"', '"1.00"'], ['"2.10"', '"0.00"']], None),
    ],
)
def test_settings_are_bare_and_what_may_be_rounded_is_quoted(table, unit, rows, written, remark):
    """Quotes are an interval: -10 degrees in quotes would be all from -10.5 to -9.5 degrees."""
    text = scaffold(table("a,b\n" + rows), {"position": unit}, family="cubic-spline")
    assert [f"  [{', '.join(row)}]," in text for row in written] == [True, True]
    bare = [[not number.startswith('"') for number in row] for row in written]
    points = parse_case(text, "x").document.waypoints.points
    assert [[number.exact for number in row] for row in points] == bare
    assert ("exact" in text.split("[waypoints]")[1].split("[limits]")[0]) == (remark is not None)
    assert remark is None or remark in text
