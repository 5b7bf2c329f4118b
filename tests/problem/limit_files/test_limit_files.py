"""Limits from flags, MoveIt and URDF: what each field means, and which source counts."""

import math

import numpy as np
import pytest
from support.refusals import Refusal, each_refusal
from trajgap.problem import CaseError, TrajgapError
from trajgap.problem.limit_files import StatedLimits, limits_of_flags, merge, read_limits
from trajgap.problem.motions import JointLimits, unstated_words

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
    path.write_text(text, "utf-8")
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
    assert stated.ranges["wheel"] == {
        "velocity": (-4.0, 4.0),
        "position": (-math.inf, math.inf),  # the format says that it has none
    }
    assert stated.ranges["slide"] == {"position": (0.0, 0.4), "velocity": (-0.5, 0.5)}


@pytest.mark.parametrize("size", ["6.5", "-6.5"])
def test_a_deceleration_has_either_sign(tmp_path, size):
    """That of Pilz's planner is negative, that of ros2_control positive."""
    text = f"joint_limits:\n  turn: {{has_deceleration_limits: true, max_deceleration: {size}}}\n"
    stated = read_limits(write(tmp_path, "joint_limits.yaml", text))
    assert stated.ranges["turn"] == {"deceleration": (-6.5, 6.5)}


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


@pytest.mark.parametrize("seed", range(40))
def test_of_sources_that_state_the_same_limit_the_first_counts(seed):
    """Random limits, and what each joint has by hand."""
    rng, joints = np.random.default_rng(seed), ("wheel", "turn")
    factors = np.array([math.pi / 180, 1.0])
    words = ("position", "velocity", "acceleration", "deceleration", "jerk")
    stated = []
    for name in ("flags", "file", "arm"):
        own = {j: {w: rng.uniform(1, 9) for w in words if rng.random() < 0.5} for j in joints}
        if name == "flags":
            own = {j: {w: own["turn"][w] for w in own["turn"]} for j in joints}
            given = {w: f"{x!r},{x!r}" for w, x in own["turn"].items()}
            stated.append((limits_of_flags(given, joints, factors), own, factors))
        else:
            ranges = {j: {w: (-x, x) for w, x in own[j].items()} for j in joints}
            stated.append((StatedLimits(name, ranges), own, np.ones(2)))
    found = merge(joints, [source for source, *_ in stated])
    for k, joint in enumerate(joints):
        has, source = {}, {}
        for one, own, scale in stated:
            # An acceleration without a deceleration is meant of both.
            both = "acceleration" in has
            for word, value in own[joint].items():
                if word not in has and not (word == "deceleration" and both):
                    has[word], source[word] = value * scale[k], one.source
        for r, word in enumerate(w for w in words if w != "deceleration"):
            size = has.get(word, math.inf)
            assert (found.lower[k, r], found.upper[k, r]) == pytest.approx((-size, size))
        assert found.deceleration[k] == pytest.approx(has.get("deceleration", math.inf))
        assert all(found.source(joint, word) == source.get(word, "given") for word in words)


def test_a_limit_that_is_said_not_to_be_counts_too(tmp_path):
    written = (("l.yaml", YAML), ("arm.urdf", ARM))
    sources = [read_limits(write(tmp_path, name, text)) for name, text in written]
    limits = merge(("wheel", "turn"), sources)
    assert limits.upper.tolist() == [[8.5, 4.0, math.inf, math.inf], [2.0, 2.5, math.inf, 50.0]]
    assert limits.source("turn", "acceleration").endswith("l.yaml")
    assert limits.deceleration.tolist() == [math.inf, math.inf]


def test_flags_give_one_side_or_both():
    given = {"velocity": "90,-1:2", "position": "-45:90,3", "jerk": "inf,2", "deceleration": None}
    found = merge(("a", "b"), [limits_of_flags(given, ("a", "b"), np.array([2.0, 1.0]))])
    np.testing.assert_allclose(found.lower[:, :2], [[-90, -180], [-3, -1]])
    np.testing.assert_allclose(found.upper[:, :2], [[180, 180], [3, 2]])
    assert found.upper[:, 3].tolist() == [math.inf, 2.0]


@each_refusal("limits")
def test_one_clear_line(tmp_path, one: Refusal):
    path = write(tmp_path, one.name, one.text(ARM if one.section == "arm" else ""))
    one.said_by(lambda: read_limits(path), str(path) + "…")


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (ARM[:300], "not valid XML"),
        ("", "not valid XML"),
        ("<robot>" + "<a>" * 9999, "nested too deeply"),
    ],
)
def test_what_is_cut_or_too_deep(tmp_path, text, wanted):
    path = write(tmp_path, "arm.urdf", text)
    with pytest.raises(CaseError, match=wanted):
        read_limits(path)


def test_a_range_of_acceleration_has_no_deceleration_beside_it():
    ranges = limits_of_flags({"acceleration": "-1:2"}, ("turn",), np.ones(1))
    only = limits_of_flags({"deceleration": "3"}, ("turn",), np.ones(1))
    with pytest.raises(CaseError, match="two-sided"):
        merge(("turn",), [only, ranges])


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ({"velocity": "1,2,3"}, "3 limits for 2 joints"),
        ({"velocity": ""}, "0 limits for 2"),
        ({"jerk": "fast"}, "'fast' is not a number; give 6, or -1:2"),
        ({"jerk": "nan"}, "'nan' is not a number"),
        ({"jerk": "1_000"}, "'1_000' is not a number"),
        ({"jerk": "1e400"}, "'1e400' is beyond the range of float64"),
        ({"jerk": "1e101"}, "is beyond 1e.100"),
        ({"jerk": "1:2:3"}, "is not a limit"),
        ({"velocity": "-1"}, "is negative"),
        ({"deceleration": "-1:1"}, "is a range"),
        ({"velocity": "1:2"}, "excludes 0"),
    ],
)
def test_flags_that_are_none(given, wanted):
    with pytest.raises(CaseError, match=wanted):
        limits_of_flags(given, ("a", "b"), np.ones(2))


@pytest.mark.parametrize(
    ("files", "joints", "wanted"),
    [
        # A name that no file knows.
        (["arm.urdf"], ("turn", "wheel_"), r"arm.urdf: wheel_: .*did you mean 'wheel'\?"),
        (
            ["arm.urdf"],
            ("turn", "x"),
            "x: is not a joint with limits there; rename it or add it; known: wheel, slide",
        ),
        (["arm.urdf"], ("turm", "slyde"), "turm: .*'turn'.*; also slyde: .*'slide'"),
        (["arm.urdf"], ("turn", "finger"), "finger: is not a joint with limits there"),  # it mimics
        (["flags", "arm.urdf"], ("turn", "wheel_"), "did you mean 'wheel'"),
        # The file that counts first misspells what the other one knows.
        (["misspelt.yaml", "arm.urdf"], ("turn", "wheel"), r"misspelt.yaml: turn: .*'turm'"),
        (["two_arms.yaml", "arm.urdf"], ("turn", "wheel"), "two_arms.yaml: turn: is not a joint"),
        (["l.yaml", "arm.urdf"], ("turn", "wheel", "slide"), None),  # it need not name all
        (["two_arms.yaml"], ("right_1",), None),
        (["flags"], ("whatever",), None),
    ],
)
def test_a_joint_whose_limits_stand_under_another_name(tmp_path, files, joints, wanted):
    texts = {
        "arm.urdf": ARM,
        "l.yaml": YAML,
        "misspelt.yaml": YAML.replace("turn:", "turm:"),
        "two_arms.yaml": "joint_limits: {left_1: {max_velocity: 1}, right_1: {}}\n",
    }
    sources = [
        limits_of_flags({"velocity": "1"}, joints, np.ones(len(joints)))
        if name == "flags"
        else read_limits(write(tmp_path, name, texts[name]))
        for name in files
    ]
    if wanted is None:
        assert merge(joints, sources).joints == joints
        return
    with pytest.raises(CaseError, match=wanted):
        merge(joints, sources)


def test_what_is_unstated_is_known_and_goes_into_no_problem(tmp_path):
    joints = ("wheel", "turn")
    urdf = read_limits(write(tmp_path, "arm.urdf", ARM))
    found = urdf.for_joints(joints)
    assert found.unstated == (("wheel", "acceleration"), ("wheel", "jerk"))
    words = "acceleration and jerk of joint wheel, no limit stated"
    assert unstated_words(found.unstated, joints) == words
    for name in ("symmetric", "two_sided"):
        with pytest.raises(TrajgapError, match="acceleration of joint wheel: no limit is stated"):
            getattr(found, name)
    said = limits_of_flags({"acceleration": "inf,8", "jerk": "inf"}, joints, np.ones(2))
    full = merge(joints, [said, urdf])
    assert full.unstated == ()
    np.testing.assert_array_equal(full.symmetric.acceleration, [math.inf, 8.0])
    # A quantity that no joint has is not part of the problem.
    one = merge(joints, [limits_of_flags({"velocity": "2,3"}, joints, np.ones(2))])
    np.testing.assert_array_equal(one.two_sided.velocity, [2.0, 3.0])
    both = JointLimits.from_values(joints, velocity=2.0, jerk=math.inf)
    assert {quantity for _, quantity in both.unstated} == {"position", "acceleration"}
    assert JointLimits.of(full.symmetric, joints).unstated == ()


@pytest.mark.parametrize(
    ("lacking", "wanted"),
    [
        ({}, ""),
        ({"a": "pvaj"}, "joint a, no limit stated"),
        ({"a": "pvaj", "b": "aj", "c": "aj"}, "joint a; acceleration and jerk, no limit stated"),
        ({"a": "j", "b": "j", "c": "j"}, "jerk, no limit stated"),
        ({"a": "pvaj", "c": "pvaj", "b": "p"}, "joints a and c; position, no limit stated"),
        (
            {"a": "paj", "b": "j", "c": "j"},
            "jerk; position and acceleration of joint a, no limit stated",
        ),
        ({"a": "v", "c": "v"}, "velocity of joints a and c, no limit stated"),
        ({"a": "pvaj", "b": "pvaj", "c": "pvaj"}, "joints a, b and c, no limit stated"),
    ],
)
def test_what_is_unstated_in_words(lacking, wanted):
    words = {"p": "position", "v": "velocity", "a": "acceleration", "j": "jerk"}
    unstated = [(joint, words[sign]) for joint, signs in lacking.items() for sign in signs]
    assert unstated_words(unstated, ("a", "b", "c")) == wanted
