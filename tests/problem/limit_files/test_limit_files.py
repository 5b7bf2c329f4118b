"""Limits from flags, MoveIt and URDF: what each field means, and which source counts."""

import math

import numpy as np
import pytest
from trajgap.problem import CaseError
from trajgap.problem.limit_files import limits_of_flags, merge, read_limits

ARM = """<?xml version="1.0"?>
<robot name="arm" version="1.2">
  <link name="base"/>
  <joint name="turn" type="revolute">
    <parent link="base"/>
    <limit lower="-1.5" upper="2" velocity="3" effort="9" acceleration="8"
           deceleration="12" jerk="90"/>
  </joint>
  <joint name="wheel" type="continuous"><limit velocity="4" effort="1"/></joint>
  <joint name="slide" type="prismatic"><limit upper="0.4" velocity="0.5" effort="1"/></joint>
  <joint name="bolt" type="fixed"/>
  <joint name="finger" type="prismatic">
    <limit lower="0" upper="1" velocity="1"/><mimic joint="slide"/></joint>
  <transmission name="t"><joint name="turn"><limit lower="7"/></joint></transmission>
</robot>
"""
YAML = """# MoveIt
default_velocity_scaling_factor: 0.1
joint_limits:
  turn:
    has_velocity_limits: true
    max_velocity: 2.5
    has_acceleration_limits: false
    max_acceleration: 0
    has_jerk_limits: true
    max_jerk: 50.0
  wheel: {has_position_limits: true, min_position: -9, max_position: 8.5}
"""


def write(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_urdf(tmp_path):
    stated = read_limits(write(tmp_path, "arm.urdf", ARM))
    assert set(stated.ranges) == {"turn", "wheel", "slide"}
    assert stated.ranges["turn"] == {
        "position": (-1.5, 2.0),
        "velocity": (-3.0, 3.0),
        "acceleration": (-8.0, 8.0),
        "deceleration": (-12.0, 12.0),
        "jerk": (-90.0, 90.0),
    }
    assert stated.ranges["wheel"] == {"velocity": (-4.0, 4.0)}
    assert stated.ranges["slide"] == {"position": (0.0, 0.4), "velocity": (-0.5, 0.5)}


def test_a_moveit_file(tmp_path):
    stated = read_limits(write(tmp_path, "joint_limits.yaml", YAML))
    assert stated.ranges["turn"] == {
        "velocity": (-2.5, 2.5),
        "acceleration": (-math.inf, math.inf),
        "jerk": (-50.0, 50.0),
    }
    assert stated.ranges["wheel"] == {"position": (-9.0, 8.5)}
    wrapped = "/**:\n  ros__parameters:\n    robot_description_planning:\n"
    inner = YAML[YAML.index("joint_limits:") :]
    wrapped += "".join(f"      {line}\n" for line in inner.splitlines())
    assert read_limits(write(tmp_path, "w.yaml", wrapped)).ranges == stated.ranges


def test_flag_before_file_before_urdf(tmp_path):
    joints = ("wheel", "turn")
    sources = [
        limits_of_flags({"velocity": "1.5", "jerk": "inf,20"}, joints, np.ones(2)),
        read_limits(write(tmp_path, "l.yaml", YAML)),
        read_limits(write(tmp_path, "arm.urdf", ARM)),
    ]
    limits = merge(joints, sources)
    assert limits.upper[:, 1].tolist() == [1.5, 1.5]
    assert limits.upper[:, 2].tolist() == [math.inf, math.inf]  # the file says: no limit
    assert limits.upper[:, 3].tolist() == [math.inf, 20.0]
    assert limits.lower[:, 0].tolist() == [-9.0, -1.5]
    said = {key: source.rpartition("/")[2] for key, source in limits.sources.items()}
    assert said["turn", "velocity"] == "flags"
    assert said["turn", "acceleration"] == "l.yaml"
    assert said["turn", "position"] == "arm.urdf"
    assert limits.source("wheel", "acceleration") == "given"
    # An acceleration without a deceleration is meant of both.
    assert limits.deceleration.tolist() == [math.inf, math.inf]
    alone = merge(("turn",), sources[2:])
    assert (alone.upper[0, 2], alone.deceleration[0]) == (8.0, 12.0)


def test_flags_in_the_units_of_the_file():
    given = {"velocity": "90,-1:2", "position": "-45:90,3", "deceleration": None}
    factors = np.array([math.pi / 180, 1.0])
    found = merge(("a", "b"), [limits_of_flags(given, ("a", "b"), factors)])
    np.testing.assert_allclose(found.upper[:, 1], [math.pi / 2, 2.0])
    np.testing.assert_allclose(found.lower[:, 1], [-math.pi / 2, -1.0])
    np.testing.assert_allclose(found.lower[:, 0], [-math.pi / 4, -3.0])


BOMB = (
    '<!DOCTYPE r [<!ENTITY a "aaaa">'
    + "".join(f'<!ENTITY b{k} "&a;&a;&a;&a;">' for k in range(9))
    + "]><robot><joint name='&b8;'/></robot>"
)

FAULTS = {
    "bomb.urdf": (BOMB, "declares a document type"),
    "external.urdf": ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot/>', "document type"),
    "other.urdf": ("<sdf/>", "begins with <sdf>"),
    "cut.urdf": (ARM[:300], "not valid XML"),
    "empty.urdf": ("", "not valid XML"),
    "none.urdf": ("<robot/>", "has no joint that moves"),
    "xacro.urdf": (ARM.replace('velocity="3"', 'velocity="${v}"'), "run xacro first"),
    "nan.urdf": (
        ARM.replace('velocity="3"', 'velocity="nan"'),
        "velocity: 'nan' is no number",
    ),
    "minus.urdf": (ARM.replace('velocity="3"', 'velocity="-3"'), "is negative"),
    "twice.urdf": (ARM.replace('name="wheel"', 'name="turn"'), "occurs twice"),
    "nameless.urdf": (ARM.replace('name="wheel"', ""), "has no name"),
    "crossed.urdf": (ARM.replace('upper="2"', 'upper="-2"'), "lies above"),
    "norange.urdf": (ARM.replace('lower="-1.5" upper="2"', ""), "no lower and upper"),
    "deep.urdf": ("<robot>" + "<a>" * 9999, "nested too deeply"),
    "encoded.urdf": ('<?xml version="1.0" encoding="what"?><robot/>', "encoding"),
    "plain.yaml": ("a: 1\n", "joint_limits: is missing"),
    "list.yaml": ("- 1\n", "joint_limits: is missing"),
    "void.yaml": ("joint_limits: {}\n", "holds no joint"),
    "block.yaml": ("joint_limits: {a: 3}\n", "is no block"),
    "flag.yaml": ("joint_limits: {a: {has_jerk_limits: 1}}\n", "neither true nor false"),
    "word.yaml": ("joint_limits: {a: {max_velocity: fast}}\n", "'fast' is no number"),
    "less.yaml": ("joint_limits: {a: {max_velocity: -1}}\n", "is negative"),
    "nan.yaml": ("joint_limits: {a: {max_velocity: .nan}}\n", "is NaN"),
    "lacks.yaml": ("joint_limits: {a: {has_velocity_limits: true}}\n", "max_velocity: is missing"),
    "range.yaml": (
        "joint_limits: {a: {has_position_limits: true, min_position: 1}}\n",
        "needs min_position and max_position",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_one_clear_line(tmp_path, name):
    text, wanted = FAULTS[name]
    path = write(tmp_path, name, text)
    with pytest.raises(CaseError) as caught:
        read_limits(path)
    assert wanted in str(caught.value)
    assert str(caught.value).startswith(str(path))


def test_a_source_of_another_robot_is_refused(tmp_path):
    stated = read_limits(write(tmp_path, "arm.urdf", ARM))
    with pytest.raises(CaseError, match=r"names none of the joints turm; did you mean 'turn'\?"):
        stated.for_joints(("turm",))
    ranges = limits_of_flags({"acceleration": "-1:2"}, ("turn",), np.ones(1))
    only = limits_of_flags({"deceleration": "3"}, ("turn",), np.ones(1))
    with pytest.raises(CaseError, match="two-sided"):
        merge(("turn",), [only, ranges])


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ({"velocity": "1,2,3"}, "3 limits for 2 joints"),
        ({"velocity": ""}, "0 limits for 2"),
        ({"jerk": "fast"}, "'fast' is no limit"),
        ({"jerk": "nan"}, "'nan' is no limit"),
        ({"jerk": "1:2:3"}, "is no limit"),
        ({"velocity": "-1"}, "is negative"),
        ({"deceleration": "-1:1"}, "is a range"),
        ({"velocity": "1:2"}, "leaves out 0"),
    ],
)
def test_flags_that_are_none(given, wanted):
    with pytest.raises(CaseError, match=wanted):
        limits_of_flags(given, ("a", "b"), np.ones(2))
