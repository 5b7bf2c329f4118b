"""Blocks of case files: units of joints, limits by side, ratios of durations, straight lines."""

import tomllib
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.case_texts import BASE, SCARA, case_text, scara
from support.refusals import Refusal, each_refusal
from trajgap.problem import (
    CaseError,
    Problem,
    compare_transcriptions,
    ctraj,
    forward_kinematics,
    load_robot,
    parse_case,
    scaffold,
)
from trajgap.problem.cases import Digits, ratio_words

POSITION = 'position = ["deg", "deg", "mm"]'


def test_each_joint_is_read_in_its_unit():
    problem = scara().problem()
    assert problem.linear == (False, False, True)
    assert problem.waypoints[1] == pytest.approx([np.radians(60.1), np.radians(15.2), 0.085])
    assert problem.limits.velocity == pytest.approx([np.pi, np.radians(150), 0.12], rel=1e-15)
    assert problem.limits.acceleration[2] == 0.5
    assert problem.limits.position_upper == pytest.approx([np.radians(150), np.radians(140), 0.150])
    # A reading gives its whole list.
    other = scara().problem(None, "deg-s").limits
    assert other.velocity == pytest.approx([np.radians(30), np.radians(150), 0.12])
    assert scara().labels["deg-s"] == "velocities in °/s and mm/s"


def test_a_problem_of_some_joints_keeps_listing_all():
    """And its one value needs no list."""
    header = '[[problems]]\nid = "slide"\njoints = ["d3"]\n\n[[readings]]\nid = "rpm"\n'
    claim = 'derivative = "velocity"\njoint = "d3"\nvalue = "0.2332"'
    value = 'derivative = "velocity"\nvalue = "233.2"'
    case = scara(('[[readings]]\nid = "rpm"\n', header), (claim, value))
    problem = case.problem()
    assert (problem.joints, problem.linear) == (("d3",), (True,))
    assert problem.limits.velocity == pytest.approx([0.12])
    value = case.statement().si(case.claim("slide-velocity").printed[0], "velocity").value
    assert value == pytest.approx(0.2332)


def test_prescribed_ends_are_in_the_unit_of_their_joint():
    ends = 'family = "cubic-spline"\nend_derivatives = [[3, 10, 20]]'
    ((order, start),) = scara(('family = "cubic-spline"', ends)).statement().curve().ends[0]
    assert order == 1
    assert start == pytest.approx((np.pi / 10, np.radians(10), 0.02))


@each_refusal("scara")
def test_each_refusal_has_its_line(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(SCARA), "scara.toml"), "scara.toml: ")


def test_instances_need_steps_that_a_sliding_joint_has():
    block = (
        '[[families]]\nid = "f"\nclaim = "durations"\nwhy = "w"\nkind = "joint"\nsteps = [1]\n'
        "instances = 1\n\n"
    )
    with pytest.raises(CaseError, match=r'families\[0\].kind: "joint" measures a step as an angle'):
        scara(('[[cartesian]]\nid = "a"', block + '[[cartesian]]\nid = "a"'))


def test_chords_of_each_joint_and_chords_of_one_kind_are_taken():
    curve = (
        'family = "clamped-b-spline"\ndegree = 5\nknots = "averaged-continued"\nparameters = "{}"'
    )
    statement = scara(('family = "cubic-spline"', curve.format("joint-chord"))).statement()
    chord = statement.declaration.model_copy(update={"parameters": "chord"})
    turning = replace(statement, joints=(0, 1), declaration=chord)
    assert turning.curve().parameters == "chord"
    with pytest.raises(CaseError, match='"chord" adds angles and lengths'):
        replace(statement, joints=(1, 2), declaration=chord).curve()


def test_new_takes_a_unit_for_each_joint(tmp_path):
    table = tmp_path / "t.csv"
    table.write_text("q1,q2,d3\n10.5,-20,12\n60.1,15,85\n")
    units = {"position": "deg,rad,mm", "velocity": "rpm, rad/s, m/min"}
    text = scaffold(table, units, velocity="30,2,7.2", family="cubic-spline")
    assert tomllib.loads(text)["units"]["velocity"] == ["rpm", "rad/s", "m/min"]
    limits = parse_case(text, "new.toml").problem().limits
    assert limits.velocity == pytest.approx([np.pi, 2.0, 0.12])
    with pytest.raises(CaseError, match=r"^units.position: 2 units for 3 joints"):
        scaffold(table, units | {"position": "deg,mm"}, velocity="30,2,7.2")
    with pytest.raises(CaseError, match=r"^units.time: 's,ms' are several units of time; give one"):
        scaffold(table, units | {"time": "s,ms"}, velocity="30,2,7.2")


def test_a_list_of_one_unit_is_that_unit():
    """One limit then serves all joints, as it does without the list."""
    text = case_text("waypoint_rows = [[5, 10], [30, -20]]", 'family = "rest-to-rest"\ndegree = 5')
    text = text.replace('velocity = "deg/s"', 'velocity = "rpm"')
    listed = text.replace('"deg"', '["deg", "deg"]').replace('"rpm"', '["rpm", "rpm"]')
    one, other = (parse_case(each, "small.toml").problem() for each in (text, listed))
    assert np.array_equal(other.waypoints, one.waypoints)
    assert other.limits.velocity == pytest.approx([np.pi / 3] * 2, rel=1e-15)


PAIRED = BASE.replace('velocity = [100, "95.0"]', 'velocity = [["-90.0", "100.0"], 95]').replace(
    "acceleration = 60", "acceleration = [[-inf, 60], [-40, 40]]"
)


@pytest.mark.parametrize(
    ("digits", "velocity", "loose"),
    [
        (None, [[-90, -95], [100, 95]], 1e-14),
        (Digits.TIGHTEST, [[-89.95, -95], [99.95, 95]], 1e-12),
        (Digits.LOOSEST, [[-90.05, -95], [100.05, 95]], 1e-12),
        (Digits.LOOSEST_CUT, [[-90.1, -95], [100.1, 95]], 1e-6),
    ],
)
def test_each_side_has_its_own_digits(digits, velocity, loose) -> None:
    statement = parse_case(PAIRED, "f").statement("one", "plain")
    limits = (statement.problem() if digits is None else statement.problem(digits)).limits
    np.testing.assert_allclose(np.degrees(limits.ends("velocity")), velocity, rtol=loose)
    ends = [[-np.inf, -40], [60, 40]]
    np.testing.assert_allclose(np.degrees(limits.ends("acceleration")), ends, rtol=1e-14)


CASE = case_text(
    "waypoint_rows = [[0, 10], [30, 50], [90, 130]]",
    'family = "cubic-spline"',
    more="""
[durations]
lower = 0
ratios = RATIOS

[[problems]]
id = "first"

[[problems]]
id = "second"
joints = ["b"]
durations = { ratios = [2, "1.50"] }

[[readings]]
id = "total-chosen"
why = "one factor"

[[readings]]
id = "each-chosen"
why = "shortest"
durations = { ratios = "free" }
""",
)


def case(ratios: str, text: str = CASE):
    return parse_case(text.replace("RATIOS", ratios), "made-up.toml")


@pytest.mark.parametrize(
    ("ratios", "shares", "loose"),
    [
        ('"chord"', [1 / 3, 2 / 3], False),
        ('"equal"', [0.5, 0.5], False),
        ("[3, 1]", [0.75, 0.25], False),
        ('["3.0", 1]', [0.75, 0.25], True),
        ('"free"', None, False),
    ],
)
def test_readings_are_laid_over_problems_over_the_file(ratios, shares, loose) -> None:
    one = case(ratios)
    first = one.problem("first", "total-chosen")
    if shares is None:
        assert first.ratios is None
    else:
        np.testing.assert_allclose(first.shares, shares, rtol=1e-12)
    assert one.statement("first", "total-chosen").loose_ratios is loose
    np.testing.assert_allclose(one.problem("second", "total-chosen").shares, [4 / 7, 3 / 7])
    assert one.statement("second", "total-chosen").loose_ratios
    for pid in ("first", "second"):
        assert one.problem(pid, "each-chosen").ratios is None
        assert not one.statement(pid, "each-chosen").loose_ratios


def test_chord_lengths_are_those_of_the_joints_that_take_part() -> None:
    text = CASE.replace("[30, 50]", '["30", 40]')
    own = case('"chord"', text.replace('ratios = [2, "1.50"]', 'ratios = "chord"'))
    together, alone = (own.problem(pid, "total-chosen").shares for pid in ("first", "second"))
    lengths = np.hypot([30, 60], [30, 90])
    np.testing.assert_allclose(together, lengths / lengths.sum())
    np.testing.assert_allclose(alone, [0.25, 0.75])
    # The angle of the other joint is a printed number, those of this one are exact.
    assert own.statement("first", "total-chosen").loose_ratios
    assert not own.statement("second", "total-chosen").loose_ratios


@each_refusal("ratios")
def test_what_is_no_ratio_is_refused(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(CASE), "ratios.toml"), "ratios.toml: ")


def test_neighbours_that_coincide_have_no_chord() -> None:
    with pytest.raises(CaseError, match=r"durations\.ratios: .*way-points 2 and 3, which coincide"):
        case('"chord"', CASE.replace("[90, 130]", "[30, 50]"))


@pytest.mark.parametrize(
    ("text", "old", "new", "field"),
    [
        (SCARA, POSITION, 'position = ["deg", "rad", "mm"]', "units.position[1]"),
        (PAIRED, '"-90.0"', '"-91.0"', "limits.velocity[0][0]"),
        (CASE, "RATIOS", '[1, "2.0"]', "durations.ratios[1]"),
    ],
)
def test_transcriptions_differ_where_one_number_or_unit_does(text, old, new, field) -> None:
    one, other = (
        parse_case(text.replace(old, x).replace("RATIOS", "[1, 2]"), "f") for x in (old, new)
    )
    assert compare_transcriptions(one, one) == []
    assert [found.field for found in compare_transcriptions(one, other)] == [field]


def test_readings_are_called_by_their_ratios() -> None:
    assert ratio_words((1,) * 7) == "durations in the ratios as listed"
    # Where problems say it, a reading that is silent says nothing of its own.
    assert "total-chosen" in case('"equal"').labels["total-chosen"]


FIRST = [0.1, -0.6, 0.4, 0.2, 0.5, 0.1]
LAST = [0.3, -0.5, 0.3, 0.2, 0.4, 0.2]


def line_text(first: object = FIRST, last: object = LAST, unit: str = "rad") -> str:
    return case_text(
        f"line = {{ first = {first}, last = {last}, points = 4 }}",
        'family = "3-5-3"',
        joints="1 2 3 4 5 6",
        robot='model = "puma560"',
        unit=unit,
    )


@cache
def line_problem() -> Problem:
    return parse_case(line_text(), "line.toml").problem()


def test_its_waypoints_are_those_of_ctraj() -> None:
    problem = line_problem()
    arm = load_robot("puma560")
    poses = forward_kinematics(arm, np.array([FIRST, LAST]))
    line = ctraj(arm, *poses, 4, guess=FIRST)
    np.testing.assert_allclose(problem.waypoints, line.waypoints, atol=1e-9)
    np.testing.assert_array_equal(problem.waypoints[[0, -1]], [FIRST, LAST])


def test_its_angles_are_in_the_unit_of_the_file() -> None:
    degrees = [np.rad2deg(ends).tolist() for ends in (FIRST, LAST)]
    case = parse_case(line_text(*degrees, unit="deg"), "line.toml")
    statement = case.statement()
    np.testing.assert_allclose(statement.problem().waypoints, line_problem().waypoints, atol=1e-9)
    assert statement.complete
    assert statement.waypoints is case.statement().waypoints  # computed once


@each_refusal("line")
def test_lines_that_are_refused(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(line_text()), "line.toml"), "line.toml: ")
