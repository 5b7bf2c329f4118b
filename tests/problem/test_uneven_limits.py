"""Limits whose two sides differ: what they hold, and how motions are judged by each side."""

import pickle

import numpy as np
import pytest
from support.uneven import CURVES, LIMITS, WAYPOINTS, mirrored, sampled_ratios, uneven_problem
from trajgap.problem import (
    Curve,
    Limits,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    clamped_readings,
    cubic_spline,
    evaluate,
    keeps_limits,
    piecewise,
    reachable_total,
    rest_to_rest,
    uniform_cubic_b_spline,
)

DURATIONS = np.array([0.7, 1.3, 0.9])


def test_pairs_are_kept_by_side() -> None:
    limits = Limits(2.0, [[-15, 10], [-3, 3]], joints=2)
    assert limits.uneven
    assert limits.is_uneven("acceleration")
    assert not limits.is_uneven("velocity")
    np.testing.assert_array_equal(limits.sides[:, :, 1], [[15, 3], [10, 3]])
    np.testing.assert_array_equal(limits.ends("acceleration"), [[-15, -3], [10, 3]])
    np.testing.assert_array_equal(limits.widest, [[2, 15, np.inf], [2, 3, np.inf]])
    np.testing.assert_array_equal(limits.hull.derivatives, limits.widest)
    np.testing.assert_array_equal(limits.velocity, [2, 2])
    np.testing.assert_array_equal(limits.joint(0).sides, limits.sides[:, :1])
    assert not limits.joint(1).uneven
    again = pickle.loads(pickle.dumps(limits))
    np.testing.assert_array_equal(again.sides, limits.sides)
    assert "-15" in repr(limits)


def test_equal_pairs_are_sizes() -> None:
    pairs = Limits(acceleration=[[-4, 4], [-3, 3]])
    assert not pairs.uneven
    np.testing.assert_array_equal(pairs.acceleration, [4, 3])
    assert pairs.hull is pairs


def test_one_pair_serves_every_joint() -> None:
    problem = Problem(WAYPOINTS, Limits(acceleration=[[-15, 10]]), cubic_spline(3))
    np.testing.assert_array_equal(problem.limits.ends("acceleration"), [[-15, -15], [10, 10]])
    assert not problem.hull.limits.uneven


def test_what_knows_sizes_alone_meets_an_error() -> None:
    for name in ("velocity", "acceleration", "jerk", "derivatives"):
        with pytest.raises(TrajgapError, match="differ in size"):
            getattr(LIMITS, name)


@pytest.mark.parametrize(
    ("pair", "message"),
    [([[1, 2]], "1 to 2 leaves out 0"), ([[-2, -1]], "leaves out 0"), ([[np.nan, 1]], "is NaN")],
)
def test_pairs_refuse(pair: list[list[float]], message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        Limits(velocity=pair)


@pytest.mark.parametrize("curve", CURVES)
def test_each_side_is_judged_at_all_times(curve: str) -> None:
    problem = uneven_problem(curve)
    ratios = evaluate(problem, DURATIONS[None]).ratios
    dense = sampled_ratios(problem, DURATIONS, 4001).max()
    assert ratios.max() == pytest.approx(dense, rel=1e-5)
    found = check(problem, DURATIONS)
    assert found.worst is not None
    assert found.worst.ratio == pytest.approx(dense, rel=1e-5)
    assert found.stretch == pytest.approx(evaluate(problem, DURATIONS[None]).stretch[0], rel=1e-9)
    for peak in found.peaks:
        j, r = (
            problem.joints.index(str(peak.joint)),
            ("velocity", "acceleration", "jerk").index(peak.quantity),
        )
        assert peak.ratio == pytest.approx(ratios[0, j, r], rel=1e-9)
        assert peak.limit == problem.limits.sides[int(peak.value > 0), j, r]


@pytest.mark.parametrize("curve", CURVES)
def test_a_mirror_swaps_the_sides(curve: str) -> None:
    problem = uneven_problem(curve)
    one, other = check(problem, DURATIONS), check(mirrored(problem), DURATIONS)
    assert [p.ratio for p in one.peaks] == [p.ratio for p in other.peaks]
    assert [p.value for p in one.peaks] == [-p.value for p in other.peaks]
    # Without the swap they differ, so that the sides are looked at.
    wrong = Problem(-problem.waypoints, problem.limits, problem.curve)
    assert check(wrong, DURATIONS).stretch != pytest.approx(one.stretch, rel=1e-3)


@pytest.mark.parametrize("curve", CURVES)
def test_joints_and_time_units_do_not_matter(curve: str) -> None:
    problem = uneven_problem(curve)
    turned = Problem(WAYPOINTS[:, ::-1], LIMITS.with_sides(LIMITS.sides[:, ::-1]), problem.curve)
    np.testing.assert_array_equal(
        evaluate(turned, DURATIONS[None]).ratios, evaluate(problem, DURATIONS[None]).ratios[:, ::-1]
    )
    slow = problem.limits.with_sides(problem.limits.sides / 4.0 ** np.arange(1, 4))
    again = check(Problem(WAYPOINTS, slow, problem.curve), 4.0 * DURATIONS)
    assert again.stretch == pytest.approx(check(problem, DURATIONS).stretch, rel=1e-9)


def test_the_wrong_side_is_a_violation() -> None:
    """1 rad from rest to rest by a cubic in 1 s: |a| = 6 at both ends, + first and − last."""
    line, curve = np.array([[0.0], [1.0]]), rest_to_rest(1, 3)
    for pair, verdict in (
        ([-6.1, 6.1], Verdict.PASS),
        ([-5.9, 6.1], Verdict.VIOLATED),
        ([-6.1, 5.9], Verdict.VIOLATED),
        ([-np.inf, 6.1], Verdict.PASS),
        ([-5.9, np.inf], Verdict.VIOLATED),
    ):
        problem = Problem(line, Limits(acceleration=[pair]), curve)
        found = check(problem, [1.0])
        assert found.verdict is verdict
        assert keeps_limits(problem, np.array([[1.0]]), 1e-9)[0] == (verdict is Verdict.PASS)
    assert found.worst is not None
    assert (found.worst.limit, found.worst.value) == (5.9, pytest.approx(-6.0))


def test_a_side_of_zero_forbids_that_side_alone() -> None:
    rising, curve = np.array([[0.0], [1.0]]), rest_to_rest(1, 3)
    forward = Limits(velocity=[[0, 2]])
    assert check(Problem(rising, forward, curve), [1.0]).verdict is Verdict.PASS
    back = check(Problem(-rising, forward, curve), [1.0])
    assert back.verdict is Verdict.VIOLATED
    assert back.feasible_time is None
    assert not keeps_limits(Problem(-rising, forward, curve), np.array([[1.0]]), 1e-9)[0]
    free = Limits(velocity=[[-np.inf, 2]])
    unlimited = check(Problem(-rising, free, curve), [1e-3])
    assert unlimited.verdict is Verdict.PASS
    assert unlimited.peaks[0].ratio == 0.0
    # At -1 rad/s all the way, nothing lies on the limited side.
    steady = check(Problem(-rising, free, piecewise((1,), 0, ())), [1.0])
    assert (steady.verdict, steady.peaks[0].ratio) == (Verdict.PASS, 0.0)


@pytest.mark.parametrize("kind", ["clamped", "timed"])
def test_other_kernels_know_both_sides(kind: str) -> None:
    curve: Curve = uniform_cubic_b_spline(4, Timing.TIMED)
    if kind == "clamped":
        known = (one for one in clamped_readings(4) if one.time is Timing.TIMED)
        curve = next(one.curve for one in known if one.curve is not None)
    problem = Problem(WAYPOINTS, LIMITS, curve)
    h = np.vstack([DURATIONS, 1.7 * DURATIONS, [np.nan, 1.0, 1.0]])
    ratios = evaluate(problem, h).ratios
    assert ratios[0].max() == pytest.approx(sampled_ratios(problem, h[0], 2001).max(), rel=1e-4)
    worst = check(problem, h[1]).worst
    assert worst is not None
    assert worst.ratio == pytest.approx(ratios[1].max(), rel=1e-9)
    assert np.isinf(ratios[2]).all()


def test_a_box_of_waypoints_is_reached_within_both_sides() -> None:
    problem = uneven_problem("cubic")
    total = reachable_total(problem, DURATIONS, WAYPOINTS - 1e-3, WAYPOINTS + 1e-3)
    assert total is not None
    for seed in range(5):
        q = WAYPOINTS + np.random.default_rng(seed).uniform(-1e-3, 1e-3, WAYPOINTS.shape)
        moved = Problem(q, LIMITS, problem.curve)
        assert check(moved, DURATIONS * total / DURATIONS.sum()).verdict is Verdict.PASS
