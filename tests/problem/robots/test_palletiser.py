"""The palletiser of irb460-pso-353: its printed transforms, its printed inverse, straight moves.

Transforms and equations are typed from the paper's section 2 alone, as scalars.
"""

import re
from math import acos, atan2, cos, pi, sin, sqrt

import numpy as np
import pytest
from trajgap.problem import (
    Chain,
    Convention,
    TrajgapError,
    check_equation,
    closed_form_inverse,
    forward_kinematics,
    inverse_kinematics,
    load_case,
    load_robot,
)

ARM = load_robot("irb460")
RNG = np.random.default_rng(17)
ANY = RNG.uniform(-pi, pi, (60, 5))


def printed_pose(t1: float, t2: float, t3: float, t4: float, t5: float) -> np.ndarray:
    """Equation (1), from the five matrices that the paper prints, a2 = a3 = 0.6 m.

    The text has -c5 in the first entry of the last one, with which it is not a rotation.
    """
    c1, s1, c2, s2, c3, s3 = cos(t1), sin(t1), cos(t2), sin(t2), cos(t3), sin(t3)
    c4, s4, c5, s5 = cos(t4), sin(t4), cos(t5), sin(t5)
    pose = np.eye(4)
    for rows in (
        [[c1, -s1, 0, 0], [s1, c1, 0, 0], [0, 0, 1, 0]],
        [[c2, -s2, 0, 0], [0, 0, 1, 0], [-s2, -c2, 0, 0]],
        [[c3, -s3, 0, 0.6], [s3, c3, 0, 0], [0, 0, 1, 0]],
        [[c4, -s4, 0, 0.6], [s4, c4, 0, 0], [0, 0, 1, 0]],
        [[c5, -s5, 0, 0], [0, 0, -1, 0], [s5, c5, 0, 0]],
    ):
        pose = pose @ np.array([*rows, [0, 0, 0, 1]])
    return pose


def inverse_by_hand(pose: np.ndarray, away: bool, bend: float) -> list[float]:
    """One branch, scalar by scalar: θ₁ faces the end or not, θ₃ has the sign of ``bend``."""
    px, py, pz = (float(x) for x in pose[:3, 3])
    t1 = atan2(-py, -px) if away else atan2(py, px)
    c1, s1 = cos(t1), sin(t1)
    out = c1 * px + s1 * py
    t3 = bend * acos((out**2 + pz**2 - 0.6**2 - 0.6**2) / (2 * 0.6 * 0.6))
    t2 = atan2(-pz, out) - atan2(0.6 * sin(t3), 0.6 + 0.6 * cos(t3))
    whole = atan2(c1 * pose[0, 2] + s1 * pose[1, 2], pose[2, 2])
    sine, cosine = c1 * pose[1, 0] - s1 * pose[0, 0], c1 * pose[1, 1] - s1 * pose[0, 1]
    return [t1, t2, t3, whole - t2 - t3, atan2(sine, cosine)]


def turned(q: object) -> np.ndarray:
    """Angles up to whole turns."""
    return np.exp(1j * np.asarray(q, dtype=float))


def test_the_shipped_robot_is_the_one_of_the_printed_transforms() -> None:
    printed = np.array([printed_pose(*q) for q in ANY])
    np.testing.assert_allclose(forward_kinematics(ARM, ANY), printed, rtol=0, atol=1e-14)
    # By the header's other reading no joint leaves the plane y = 0.
    other = load_robot("irb460", convention=Convention.MODIFIED)
    assert np.abs(forward_kinematics(other, ANY)[:, 1, 3]).max() < 1e-15
    assert np.abs(printed[:, 1, 3]).max() > 0.5


def test_the_closed_form_has_every_branch_and_no_other() -> None:
    for q in ANY:
        pose = printed_pose(*q)
        found = closed_form_inverse(ARM, pose)
        by_hand = [inverse_by_hand(pose, a, b) for a in (False, True) for b in (-1.0, 1.0)]
        np.testing.assert_allclose(turned(found), turned(by_hand), rtol=0, atol=1e-7)
        assert np.abs(turned(found) - turned(q)).max(axis=1).min() < 1e-7
        np.testing.assert_allclose([printed_pose(*row) for row in found], [pose] * 4, atol=1e-12)
        assert ((-pi < found) & (found <= pi)).all()
        searched = inverse_kinematics(ARM, pose, 3, guess=found[2]).joints
        np.testing.assert_allclose(turned(searched), turned(found[2]), rtol=0, atol=1e-6)


def test_bounds_and_orientations_leave_branches_out() -> None:
    pose = printed_pose(0.3, -0.9, 1.1, -0.2, 0.5)
    held = ARM.with_bounds(np.full(5, -1.0), np.full(5, 1.2))
    np.testing.assert_allclose(closed_form_inverse(held, pose), [[0.3, -0.9, 1.1, -0.2, 0.5]])
    askew = pose.copy()
    askew[:3, :3] = printed_pose(0.9, -0.9, 1.1, 0.4, 0.5)[:3, :3]
    assert closed_form_inverse(ARM, askew).shape == (0, 5)
    far = pose.copy()
    far[0, 3] += 2.0
    assert closed_form_inverse(ARM, far).shape == (0, 5)
    # Above its base the arm faces where its orientation says.
    above = printed_pose(0.4, -pi / 2 - 0.5, 1.0, 0.3, 0.2)
    assert np.hypot(*above[:2, 3]) < 1e-12
    assert len(closed_form_inverse(ARM, above)) == 4


def test_it_lands_on_every_printed_position() -> None:
    """Table 2, wrist level: each position is within reach, and joint 3 is at 60° there."""
    for place in load_case("irb460-pso-353").cartesian:
        level = np.eye(4)
        level[:3, 3] = [number.value for number in place.values]
        for found in (*closed_form_inverse(ARM, level), inverse_kinematics(ARM, level, 1).joints):
            np.testing.assert_allclose(printed_pose(*found), level, rtol=0, atol=2e-9)
            assert abs(found[2]) == pytest.approx(pi / 3, abs=2e-4)
    assert len(closed_form_inverse(ARM, level)) == 4


# The printed equations


def test_each_printed_equation_is_judged() -> None:
    """Which of (2) to (17) hold, found again with scalars from the paper's own transforms."""
    case = load_case("irb460-pso-353")
    found = {e.id.removeprefix("equation-"): e for e in case.document.equations}
    assert [int(n) for n in found] == list(range(2, 18))
    as_printed = {n for n, e in found.items() if check_equation(ARM, e.printed).holds}
    assert as_printed == {"4", "6", "11"}
    assert 0.4 < check_equation(ARM, found["5"].printed).share < 0.6
    for number, equation in found.items():
        assert (equation.mended is None) == (number in as_printed)
        if equation.mended is not None:
            assert check_equation(ARM, equation.mended).holds, number
    for q in ANY:
        t1, t2, t3, t4, t5 = q
        pose = printed_pose(*q)
        (n, o, a, p), r = pose[:3].T, pose
        c1, s1, c2, s2, s23, c23 = cos(t1), sin(t1), cos(t2), sin(t2), sin(t2 + t3), cos(t2 + t3)
        out = c1 * p[0] + s1 * p[1]
        both_sides = [
            (out, c23 * 0.6 + c2 * 0.6),  # (7), a plus sign
            (p[2], -(s23 * 0.6 + s2 * 0.6)),  # (8), brackets
            (s23 * out + c23 * p[2] - 0.6 * sin(t3), 0.0),  # (12), a term
            (c23 * out - s23 * p[2] - 0.6 * cos(t3), 0.6),  # (13), a sign and a term
            (c23 * (c1 * r[0, 2] + s1 * r[1, 2]) - s23 * r[2, 2], sin(t4)),  # (15)
            (s23 * (c1 * r[0, 2] + s1 * r[1, 2]) + c23 * r[2, 2], cos(t4)),  # (16)
        ]
        k, reach = (0.36 - out**2 - 0.36 - p[2] ** 2) / 1.2, sqrt(out**2 + p[2] ** 2)
        assert -c2 * out + s2 * p[2] == pytest.approx(k, abs=1e-12)  # (9)
        seconds = [atan2(k, x * sqrt(reach**2 - k**2)) + atan2(out, p[2]) for x in (1, -1)]
        assert np.abs(turned(seconds) - turned(t2)).min() < 1e-6  # (10)
        assert o[2] * cos(t5) == pytest.approx(-n[2] * sin(t5), abs=1e-12)  # (4)
        assert a[2] == pytest.approx(cos(t2 + t3 + t4), abs=1e-12)
        for left, right in both_sides:
            assert left == pytest.approx(right, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("px + py", "'px + py' is not an equation; write left = right"),
        ("px = " + "1 + " * 200 + "1", "is not an equation; write left = right, in at most 400"),
        ("px = py +", "'py +' is not an expression; see check_equation"),
        ("px = t6", "'t6' is not a name of this robot; see check_equation"),
        ("px = open(py)", "'open(py)' is not supported; see check_equation"),
        ("px = 'a'", "\"'a'\" is not supported; see check_equation"),
        ("T @ px = T", "'T @ px' mixes numbers and transforms; compare like with like"),
        ("T = px", "equations: a number is compared with a transform; compare like with like"),
    ],
)
def test_what_is_no_equation(text: str, message: str) -> None:
    with pytest.raises(TrajgapError, match=re.escape(message)):
        check_equation(ARM, text, samples=7)


def test_robots_that_they_are_not_of() -> None:
    other = load_robot("irb460", convention=Convention.MODIFIED)
    words = "closed form: applies to a palletiser with five revolute"
    with pytest.raises(TrajgapError, match=words):
        closed_form_inverse(other, np.eye(4))
    with pytest.raises(TrajgapError, match=re.escape("target: is a point; give a (4, 4) pose")):
        closed_form_inverse(ARM, [0.5, 0.2, 0.1])
    slide = Chain(Convention.STANDARD, [0.5], [0], [0], kinds=("prismatic",), lower=[0], upper=[1])
    words = "equations: apply only to chains of fewer than ten joints"
    with pytest.raises(TrajgapError, match=words):
        check_equation(slide, "px = 0")
    with pytest.raises(TrajgapError, match="'craig' is not a valid Convention"):
        load_robot("irb460", convention="craig")
