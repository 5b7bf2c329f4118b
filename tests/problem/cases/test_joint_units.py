"""Units of each joint in case files: what is read, and each refusal in its line."""

import csv
import io
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from support.case_texts import case_text
from support.refusals import Refusal, each_refusal
from support.scara import SCARA, scara
from trajgap.problem import CaseError, scaffold
from trajgap.problem.cases import compare_transcriptions, parse_case

POSITION = 'position = ["deg", "deg", "mm"]'
VELOCITY = 'velocity = ["rpm", "deg/s", "mm/s"]'
ACCELERATION = 'acceleration = ["deg/s^2", "deg/s^2", "m/s^2"]'


def test_each_joint_is_read_in_its_unit():
    problem = scara().problem()
    assert problem.linear == (False, False, True)
    assert problem.waypoints[1] == pytest.approx([np.radians(60.1), np.radians(15.2), 0.085])
    assert problem.limits.velocity == pytest.approx([np.pi, np.radians(150), 0.12], rel=1e-15)
    assert problem.limits.acceleration[2] == 0.5
    assert problem.limits.position_upper == pytest.approx([np.radians(150), np.radians(140), 0.150])


def test_a_reading_gives_its_whole_list():
    problem = scara().problem(None, "deg-s")
    assert problem.limits.velocity == pytest.approx([np.radians(30), np.radians(150), 0.12])
    assert scara().labels["deg-s"] == "velocities in °/s and mm/s"


def test_a_problem_of_some_joints_keeps_listing_all():
    header = '[[problems]]\nid = "slide"\njoints = ["d3"]\n\n[[readings]]\nid = "rpm"\n'
    problem = scara(('[[readings]]\nid = "rpm"\n', header)).problem()
    assert (problem.joints, problem.linear) == (("d3",), (True,))
    assert problem.limits.velocity == pytest.approx([0.12])


def test_one_number_serves_joints_of_one_unit():
    """The slide alone: its one value needs no list."""
    header = '[[problems]]\nid = "slide"\njoints = ["d3"]\n\n[[readings]]\nid = "rpm"\n'
    claim = 'derivative = "velocity"\njoint = "d3"\nvalue = "0.2332"'
    case = scara(
        ('[[readings]]\nid = "rpm"\n', header),
        (claim, 'derivative = "velocity"\nvalue = "233.2"'),
    )
    assert case.measured(case.claim("slide-velocity").printed[0], "velocity").value == (
        pytest.approx(0.2332)
    )


def test_prescribed_ends_are_in_the_unit_of_their_joint():
    case = scara(
        ('family = "cubic-spline"', 'family = "cubic-spline"\nend_derivatives = [[3, 10, 20]]'),
        ('[[claims]]\nid = "rest"', '[[claims]]\nid = "rest"\ntext = "at rest"'),
    )
    ((order, start),) = case.statement().curve().prescribed_at(0)
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


def test_transcriptions_differ_where_a_unit_does():
    other = scara((POSITION, 'position = ["deg", "rad", "mm"]'))
    (found,) = compare_transcriptions(scara(), other)
    assert (found.field, found.first, found.second) == ("units.position[1]", '"deg"', '"rad"')


def test_new_takes_a_unit_for_each_joint(tmp_path):
    table = tmp_path / "t.csv"
    stream = io.StringIO()
    csv.writer(stream).writerows([["q1", "q2", "d3"], ["10.5", "-20", "12"], ["60.1", "15", "85"]])
    table.write_text(stream.getvalue())
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
