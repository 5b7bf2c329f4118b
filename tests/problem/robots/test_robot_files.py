"""Robots as data: tables of shipped files and case files, and one line for what is wrong."""

import json
import math
import re
import tomllib
from fractions import Fraction

import jsonschema
import numpy as np
import pytest
from support.case_texts import BASE
from support.checkout import ROOT
from support.refusals import Refusal, each_refusal
from trajgap.problem.cases.data_files import load_robot, parse_robot, robot_file, robot_ids
from trajgap.problem.cases.load import load_case, parse_case
from trajgap.problem.cases.schema import case_schema
from trajgap.problem.errors import CaseError, TrajgapError
from trajgap.problem.printed.rounded import Printed
from trajgap.problem.robots.chain import Convention, JointKind, forward_kinematics
from trajgap.problem.robots.dh import DhTable, PiMultiple, read_angle

ROBOTS = ROOT / "problem/robots"

TABLE = """
where = "Table 9"
convention = "modified"
length_unit = "mm"
angle_unit = "deg"
d = [0, "120", 0]
a = [0, 0, "35.0"]
alpha = [0, "-90", 90]
lower = ["-10", -20, "-inf"]
upper = ["10", 20, inf]
"""
ROBOT = f'format = 1\nid = "arm"\nname = "arm"\n[source]\nyear = 1999\n[dh]{TABLE}'


def changed(text: str, old: str, new: str) -> str:
    assert old in text, old
    return text.replace(old, new, 1)


def with_table(case: str = BASE, table: str = TABLE, extra: str = "") -> str:
    labels = 'joints = ["a", "c", "b"]'
    text = changed(case, "[units]", f"[robot.dh]\n{labels}{table}\n[units]")
    return text + extra


CARTESIAN = "".join(
    f'\n[[cartesian]]\nid = "p{i}"\nwhere = "Table 3"\nunit = "mm"\nvalues = [{i}, 20, "3.5"]\n'
    for i in range(4)
)
COLUMN = '\n[[columns]]\nid = "c"\nwhere = "Table 3"\njoint = "c"\nvalues = ["1.5", 2, 3, 4]\n'


# What a table means


def test_units_and_bounds():
    chain = load_case_text(with_table()).chain()
    np.testing.assert_allclose(chain.d, [0, 0.120, 0], rtol=1e-15)
    np.testing.assert_allclose(chain.a, [0, 0, 0.035], rtol=1e-15)
    np.testing.assert_allclose(chain.alpha, np.deg2rad([0, -90, 90]), rtol=1e-15)
    np.testing.assert_allclose(chain.lower, [*np.deg2rad([-10, -20]), -np.inf], rtol=1e-15)
    np.testing.assert_allclose(chain.upper, [*np.deg2rad([10, 20]), np.inf], rtol=1e-15)
    assert chain.labels == ("a", "c", "b")
    assert chain.convention is Convention.MODIFIED
    assert chain.name == "arm"


def load_case_text(text: str):
    return parse_case(text, "base.toml")


def test_sliding_joints_have_bounds_in_lengths():
    table = (
        TABLE + 'kinds = ["prismatic", "revolute", "revolute"]\ntheta_offset = [90, "-45.5", 0]\n'
    )
    chain = parse_robot(changed(ROBOT, TABLE, table), "arm").dh.chain()
    assert chain.kinds[0] is JointKind.PRISMATIC
    np.testing.assert_allclose([chain.lower[0], chain.upper[0]], [-0.010, 0.010], rtol=1e-15)
    np.testing.assert_allclose(chain.theta_offset, np.deg2rad([90, -45.5, 0]), rtol=1e-15)
    assert chain.labels == ("1", "2", "3")


def test_twists_may_be_flipped_and_other_conventions_tried():
    dh = load_case_text(with_table()).dh
    assert dh.twisted == (1, 2)
    np.testing.assert_allclose(dh.chain(flipped=(1,)).alpha, np.deg2rad([0, 90, 90]), rtol=1e-15)
    assert dh.chain(convention=Convention.STANDARD).convention is Convention.STANDARD
    # A half turn is the same in either direction.
    table = TABLE.replace('"-90", 90', '"180", -180')
    assert parse_robot(changed(ROBOT, TABLE, table), "arm").dh.twisted == ()


@pytest.mark.parametrize(
    ("text", "factor"),
    [
        ("π", Fraction(1)),
        ("-π/2", Fraction(-1, 2)),
        ("− π / 2", Fraction(-1, 2)),
        ("+3π/4", Fraction(3, 4)),
        ("2pi", Fraction(2)),
        (" pi/3 ", Fraction(1, 3)),
    ],
)
def test_multiples_of_pi(text, factor):
    angle = read_angle(text)
    assert isinstance(angle, PiMultiple)
    assert angle.factor == factor
    assert angle.value == pytest.approx(float(factor) * math.pi, rel=1e-15)
    assert read_angle(angle) is angle


def test_other_angles_are_numbers():
    assert read_angle("1.5708") == Printed("1.5708")
    assert read_angle(90).exact
    words = "'tau' is not a finite decimal number; write the printed"
    with pytest.raises(TrajgapError, match=words):
        read_angle("tau")


def test_rounding_is_no_less_than_any_rounded_table_shows():
    robot = robot_file("z1")
    chain = robot.dh.chain()
    bound = robot.dh.rounding(chain)
    # Four lengths at half of 1e-4 m and one at half of 1e-4 m; right angles are exact.
    assert bound == pytest.approx(5 * 0.5e-4, rel=1e-9)
    rng = np.random.default_rng(2)
    q = rng.uniform(-3, 3, (50, 6))
    text = (ROBOTS / "z1.toml").read_text("utf-8")
    other = text.replace('"0.1305"', "0.13054").replace('"0.2253"', "0.22526")
    other = other.replace('"0.0720"', "0.07204")
    moved = parse_robot(other, "z1").dh.chain()
    ends = [forward_kinematics(c, q)[:, :3, 3] for c in (chain, moved)]
    far = np.linalg.norm(ends[0] - ends[1], axis=1).max()
    assert 0.5e-4 < far <= bound
    rounded = parse_robot(ROBOT, "arm")
    # 120 ± 0.5, 35.0 ± 0.05 mm; -90 ± 0.5° swings at most the reach.
    half = math.radians(0.5)
    expected = 0.5e-3 + 0.05e-3 + rounded.dh.chain().reach * half
    assert rounded.dh.rounding(rounded.dh.chain()) == pytest.approx(expected, rel=1e-9)


# Shipped robots


def test_shipped_robots():
    assert robot_ids() == ("irb1600", "irb460", "puma560", "z1")
    for robot_id in robot_ids():
        robot = robot_file(robot_id)
        assert robot.id == robot_id
        assert robot.source.note
        assert load_robot(robot_id).name == robot.name
        path = ROBOTS / f"{robot_id}.toml"
        assert robot_file(path) == robot
        assert load_robot(str(path)).labels == load_robot(robot_id).labels


# Case files


def test_case_with_positions_and_joints():
    case = load_case_text(with_table(extra=CARTESIAN + COLUMN))
    assert [c.id for c in case.cartesian] == ["p0", "p1", "p2", "p3"]
    assert case.columns[0].joint == "c"
    assert case.dh is case.document.robot.dh
    assert load_case_text(BASE).dh is None
    assert load_case_text(BASE).chain() is None
    assert load_case_text(BASE + COLUMN).columns[0].joint == "c"


def test_a_shipped_model_instead_of_a_table():
    # Joints of the base case are a and b; a model has its own labels.
    text = changed(BASE, 'joints = ["a", "b"]', 'joints = ["1", "3"]\nmodel = "puma560"')
    text = changed(text, 'joints = ["b"]', 'joints = ["3"]').replace('joint = "b"', 'joint = "3"')
    case, irb = load_case_text(text), load_case("irb460-pso-353")
    assert case.chain().labels == ("1", "2", "3", "4", "5", "6")
    assert case.dh == robot_file("puma560").dh
    assert irb.chain().name == "IRB 460"
    assert irb.chain(Convention.STANDARD).convention is Convention.STANDARD


def test_the_schema_accepts_a_table_and_dumps_it_again():
    text = with_table(extra=CARTESIAN + COLUMN).replace('"-90", 90', '"-90", "90.0"')
    raw = json.loads(json.dumps(tomllib.loads(text.replace("inf]", "'inf']"))))
    validator = jsonschema.Draft202012Validator(case_schema())
    validator.validate(raw)
    for old, new in (('"modified"', '"craig"'), ('"mm"', '"inch"'), ('"uncertain"', '"lost"')):
        broken = json.dumps(raw | {"robot": raw["robot"]}).replace(old, new)
        if broken != json.dumps(raw):
            with pytest.raises(jsonschema.ValidationError):
                validator.validate(json.loads(broken))
    document = load_case_text(text).document
    dumped = document.model_dump(mode="json", exclude_unset=True)
    assert dumped["robot"]["dh"]["alpha"] == [0, "-90", "90.0"]
    assert type(document).model_validate(json.loads(json.dumps(dumped))) == document
    in_rad = DhTable.model_validate(
        {"convention": "standard", "length_unit": "m", "angle_unit": "rad",
         "d": [0], "a": [1], "alpha": ["-π/2"]}
    )  # fmt: skip
    assert in_rad.model_dump(mode="json")["alpha"] == ["-π/2"]


@each_refusal("table")
def test_each_fault_has_its_line(one: Refusal) -> None:
    text = with_table(extra=CARTESIAN + COLUMN)
    one.said_by(lambda: load_case_text(one.text(text)), "base.toml: ")


@each_refusal("robot")
def test_faults_of_a_robot_file(one: Refusal) -> None:
    one.said_by(lambda: parse_robot(one.text(ROBOT), "arm"), "arm: ")


def test_positions_name_labels_that_exist():
    text = CARTESIAN
    for i, label in enumerate("ABCD"):
        text = text.replace(f'id = "p{i}"', f'id = "p{i}"\nwaypoint = "{label}"')
    load_case_text(with_table(extra=text))
    words = re.escape("cartesian[3].waypoint: 'E' is not a label of a")
    with pytest.raises(CaseError, match=words):
        load_case_text(with_table(extra=text.replace('"D"', '"E"')))


def test_unknown_robots():
    for source, message in (
        ("puma", "neither a shipped robot nor a file; did you mean 'puma560'?"),
        ("no.toml", "no such file; check the path"),
    ):
        with pytest.raises(CaseError, match=f"^{re.escape(f'{source}: {message}')}$"):
            load_robot(source)


def test_unknown_model():
    text = changed(BASE, 'name = "arm"', 'name = "arm"\nmodel = "puma-560"')
    message = "base.toml: robot.model: no robot 'puma-560' is shipped; did you mean 'puma560'?"
    with pytest.raises(CaseError, match=f"^{re.escape(message)}$"):
        load_case_text(text)
