"""Derivatives at the ends that differ between both ends and between joints."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BPoly, CubicSpline
from trajgap.problem import (
    Array,
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    extrema,
    fit,
    keeps_limits,
    peak_gradients,
    piecewise,
    quintic_spline,
)

WAYPOINTS = np.array([[0.3, -1.0, 2.1], [0.9, -0.55, 2.6], [0.2, 0.35, 1.4], [-0.45, 0.1, 1.9]])
FIRST, LAST = (0.5, -0.2, 0.0), (-0.3, 0.4, 0.7)
"""Velocities at the start and at the finish, rad/s: no two of a joint alike."""
CLAMPED = cubic_spline(3, ((1, FIRST),), finish=((1, LAST),))
QUINTIC = quintic_spline(3, ((1, FIRST), (2, LAST)), ((1, LAST), (2, (0.0, 1.1, -0.6))))
MIXED = cubic_spline(3, ((1, FIRST),), ((2, (0.0, 1.1, -0.6)),))
H = np.array([0.8, 1.3, 0.7])
TIMES = np.concatenate([[0.0], np.cumsum(H)])
LIMITS = Limits([1.5, 1.8, 2.4], [6.0, 7.0, 9.0])


def sampled(curve: Interpolant, order: int, h: Array = H) -> Array:
    places = np.linspace(1e-6, h.sum() - 1e-6, 101)
    return fit(curve, WAYPOINTS, h)(places, order)


@pytest.mark.parametrize(
    ("curve", "ends"),
    [
        (CLAMPED, ((1, FIRST), (1, LAST))),
        (MIXED, ((1, FIRST), (2, (0.0, 1.1, -0.6)))),
        (cubic_spline(3, ((2, LAST),), ((1, FIRST),)), ((2, LAST), (1, FIRST))),
        (cubic_spline(3, ((1, 0.4),), ((1, -0.9),)), ((1, (0.4,) * 3), (1, (-0.9,) * 3))),
    ],
)
def test_a_cubic_spline_is_scipys(curve: Interpolant, ends: tuple[object, object]) -> None:
    theirs = CubicSpline(TIMES, WAYPOINTS, bc_type=ends)
    places = np.linspace(1e-6, H.sum() - 1e-6, 101)
    for order in range(3):
        np.testing.assert_allclose(sampled(curve, order), theirs(places, order), atol=1e-12)
    single = fit(curve.for_joint(WAYPOINTS, 1), WAYPOINTS[:, 1:2], H)
    np.testing.assert_allclose(single(places)[:, 0], theirs(places)[:, 1], atol=1e-13)


def test_one_polynomial_is_hermites() -> None:
    start = ((1, FIRST), (2, (1.0, -0.5, 0.3)))
    curve = piecewise((5,), 2, start, finish=((1, LAST), (2, 0.2)))
    q = WAYPOINTS[:2]
    given = [np.array([q[0], FIRST, (1.0, -0.5, 0.3)]), np.array([q[1], LAST, (0.2,) * 3])]
    theirs = BPoly.from_derivatives([0.0, 1.4], given)
    places = np.linspace(0.0, 1.4, 51)
    np.testing.assert_allclose(fit(curve, q, [1.4])(places), theirs(places), atol=1e-12)


@pytest.mark.parametrize("curve", [CLAMPED, QUINTIC, MIXED])
def test_reversal_swaps_the_ends(curve: Interpolant) -> None:
    """Backwards in time velocities turn round and accelerations do not."""

    def turned(at: tuple[tuple[int, object], ...]) -> tuple[tuple[int, object], ...]:
        return tuple((r, tuple((-1) ** r * np.broadcast_to(v, 3))) for r, v in at)

    first, last = curve.ends
    back = piecewise(curve.degrees, curve.continuity[0], turned(last), finish=turned(first))
    problem = Problem(WAYPOINTS, LIMITS, curve)
    reversed_ = Problem(WAYPOINTS[::-1], LIMITS, back)
    np.testing.assert_allclose(
        evaluate(reversed_, H[None, ::-1]).ratios, evaluate(problem, H[None]).ratios, rtol=1e-10
    )
    one, other = check(problem, H), check(reversed_, H[::-1])
    assert one.stretch == pytest.approx(other.stretch, rel=1e-10)


@pytest.mark.parametrize("curve", [CLAMPED, QUINTIC, MIXED])
def test_slower_time_divides_what_is_prescribed(curve: Interpolant) -> None:
    c = 3.7

    def slowed(at: tuple[tuple[int, object], ...]) -> tuple[tuple[int, object], ...]:
        return tuple((r, tuple(np.broadcast_to(v, 3) / c**r)) for r, v in at)

    ends = tuple(map(slowed, curve.ends))
    slow = piecewise(curve.degrees, curve.continuity[0], ends[0], finish=ends[1])
    np.testing.assert_allclose(
        fit(slow, WAYPOINTS, c * H)(c * TIMES[1:3] * 0.9, 1) * c,
        fit(curve, WAYPOINTS, H)(TIMES[1:3] * 0.9, 1),
        rtol=1e-10,
    )
    # Without that it is another path, and no stretch is said to repair it.
    found = check(Problem(WAYPOINTS, Limits(0.3, joints=3), curve), H)
    assert found.verdict is Verdict.VIOLATED
    assert found.feasible_time is None
    assert found.feasible_why == "a prescribed end derivative is not 0; stretching would change it"


@pytest.mark.parametrize("curve", [CLAMPED, QUINTIC, MIXED])
def test_the_batch_and_each_joint_alone_agree_with_the_checker(curve: Interpolant) -> None:
    problem = Problem(WAYPOINTS, LIMITS, curve)
    h = np.exp(np.random.default_rng(2).uniform(-1.0, 1.0, (60, 3)))
    found = evaluate(problem, h)
    kept = keeps_limits(problem, h, 5e-10)
    assert 0 < kept.sum() < 60
    for one, inside in zip(h, kept, strict=True):
        assert inside == (check(problem, one).verdict is Verdict.PASS)
    for j in range(3):
        alone = problem.joint(j)
        assert alone.curve.prescribed_joints is None
        np.testing.assert_allclose(
            evaluate(alone, h).ratios[:, 0], found.ratios[:, j], rtol=1e-10, atol=1e-13
        )


@pytest.mark.parametrize("curve", [CLAMPED, QUINTIC, MIXED])
def test_gradients_are_differences(curve: Interpolant) -> None:
    problem, step = Problem(WAYPOINTS, LIMITS, curve), 1e-5
    points = [
        e for j in range(3) for r in range(4) for e in extrema(fit(curve, WAYPOINTS, H), j, r)
    ]
    mine = peak_gradients(problem, H, points).durations

    def values(h: Array) -> Array:
        motion = fit(curve, WAYPOINTS, h)
        at = [motion.values(e.segment, e.joint, e.order, np.array([e.s])) for e in points]
        return np.array(at)[:, 0]

    for k in range(3):
        change = step * np.eye(3)[k]
        slope = (values(H + change) - values(H - change)) / (2 * step)
        np.testing.assert_allclose(mine[:, k], slope, rtol=1e-5, atol=1e-5)


def test_joints_that_agree_share_one_value() -> None:
    same = cubic_spline(3, ((1, (0.5, 0.5, 0.5)),), ((1, [0.0, 0.0, 0.0]),))
    assert same == cubic_spline(3, ((1, 0.5),), ((1, 0.0),))
    assert same.prescribed_joints is None
    rest = cubic_spline(3, ((1, (0.0, 0.0)),))
    assert rest == cubic_spline(3)
    assert rest.homogeneous
    assert (CLAMPED.prescribed_joints, CLAMPED.homogeneous) == (3, False)
    assert hash(CLAMPED) == hash(replace(CLAMPED))


def test_names_say_what_is_given_where() -> None:
    assert CLAMPED.name == "C2 cubic spline with velocity given at the ends"
    assert MIXED.name == (
        "C2 cubic spline with velocity given at the start, acceleration at the finish"
    )
    assert cubic_spline(2, ((1, 0.0),), ((1, 0.0),)).name == "clamped C2 cubic spline"


def test_numbers_of_joints_have_to_agree() -> None:
    with pytest.raises(TrajgapError, match="for 3 joints, way-points are given for 2"):
        Problem(WAYPOINTS[:, :2], Limits(1.0, joints=2), CLAMPED)
    with pytest.raises(TrajgapError, match="for 3 joints, the way-points have 2"):
        fit(CLAMPED, WAYPOINTS[:, :2], H)
    with pytest.raises(TrajgapError, match="given for 2 and for 3 joints; give one value"):
        cubic_spline(3, ((1, FIRST),), ((1, (0.1, 0.2)),))
    with pytest.raises(TrajgapError, match="values must be finite"):
        cubic_spline(3, ((1, (0.1, np.nan)),))
