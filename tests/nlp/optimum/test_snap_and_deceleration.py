"""Limits of snap, and of deceleration by itself: closed forms, mirrors, and another solver."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize
from trajgap.nlp import certify, problem_seal, solve as proved_too
from trajgap.nlp.optimum import Status, exact_rows, solve
from trajgap.problem import (
    Array,
    Curve,
    Limits,
    Problem,
    Verdict,
    check,
    curves,
    evaluate,
    fit,
    keeps_limits,
)

CURVES = (curves.three_five_three(), curves.cubic_spline(3), curves.quintic_spline(3))
APART = Limits([4.0, 5.0], [6.0, 5.0], [90.0, 80.0], deceleration=[4.0, 8.0])
SNAP = Limits([4.0, 5.0], [6.0, 5.0], [40.0, 50.0], snap=[170.0, 230.0])
FREE = curves.piecewise((5,) * 3, 2, ((1, 0.0), (2, 0.0)))
"""Quintics whose jerk may jump."""


def walk(seed: int, limits: Limits, curve: Curve) -> Problem:
    """Way-points away from 0, of two joints."""
    steps = np.random.default_rng(seed).normal(0.0, 1.0, (curve.segments + 1, 2))
    return Problem(3.7 + steps.cumsum(axis=0), limits, curve)


def sampled(problem: Problem, h: Array) -> Array:
    """Largest ratios to limits, each by its root, at many times between the breaks."""
    motion = fit(problem.curve, problem.waypoints, h).polynomial
    t = np.concatenate([np.linspace(a, b, 402)[1:-1] for a, b in pairwise(motion.x)])
    v, a, j, s = (motion(t, r) for r in (1, 2, 3, 4))
    limits = problem.limits
    size = limits.ends("acceleration")[1]
    braking = np.where(limits.braking, limits.deceleration, size)
    shares = v / limits.velocity, a / np.where(v * a > 0, size, braking), j / limits.jerk
    every = zip((1, 2, 3, 4), (*shares, s / limits.snap), strict=True)
    return np.array([np.abs(share).max(axis=0) ** (1.0 / r) for r, share in every]).ravel()


def test_a_septic_takes_the_fourth_root_of_its_peak_snap() -> None:
    # 4-5-6-7: the snap is d/h⁴ (840 − 10080 s + 25200 s² − 16800 s³), largest at both ends.
    problem = walk(1, Limits(snap=[50.0, 20.0]), curves.rest_to_rest(3, 7))
    ways = np.abs(np.diff(problem.waypoints, axis=0))
    h = (840.0 * ways / problem.limits.snap).max(axis=1) ** 0.25
    found = solve(problem)
    np.testing.assert_allclose(found.durations, h, rtol=1e-8)
    assert {one.quantity for one in found.active} == {"snap"}
    both = evaluate(problem, np.stack([h, 2.0 * h]))
    np.testing.assert_allclose(both.ratios[1, :, 3], both.ratios[0, :, 3] / 16.0)
    np.testing.assert_allclose(both.stretch, [1.0, 0.5])
    assert keeps_limits(problem, np.stack([h, 0.999 * h]), 1e-9).tolist() == [True, False]


@pytest.mark.parametrize("limits", [APART, SNAP], ids=["deceleration", "snap"])
@pytest.mark.parametrize("seed", range(4))
def test_another_solver_on_samples_finds_nothing_shorter(limits: Limits, seed: int) -> None:
    problem = walk(seed, limits, curves.quintic_spline(3) if limits is SNAP else CURVES[seed % 3])
    found = solve(problem)
    assert (found.status, check(problem, found.durations).verdict) == ("converged", Verdict.PASS)
    assert 1 - 5e-3 < sampled(problem, found.durations).max() <= 1 + 1e-9
    for scale in (1.1, 1.5):
        start = np.log(scale * found.durations)
        other = minimize(
            lambda z: np.exp(z).sum(),
            start,
            method="SLSQP",
            bounds=[(z - 1.0, z + 1.0) for z in start],
            constraints={"type": "ineq", "fun": lambda z: 1.0 - sampled(problem, np.exp(z))},
        )
        assert other.fun < scale * found.total_time
        if sampled(problem, np.exp(other.x)).max() <= 1 + 1e-6:
            assert other.fun >= found.total_time * (1 - 3e-3)


@pytest.mark.parametrize("seed", range(3))
def test_backwards_in_time_acceleration_and_deceleration_are_exchanged(seed: int) -> None:
    problem = walk(seed, APART, CURVES[seed])
    h, sizes = np.array([0.9, 0.7, 1.1]), APART.ends("acceleration")[1]
    turned = Limits(APART.velocity, APART.deceleration, APART.jerk, deceleration=sizes)
    back = replace(problem, waypoints=problem.waypoints[::-1], limits=turned)
    assert solve(back).total_time == pytest.approx(solve(problem).total_time, rel=1e-7)
    # Rows at roots of the speed move with them.
    rows = exact_rows(problem, h)
    assert rows.braking.any()
    for k, one in enumerate(1e-6 * np.eye(3)):
        ends = [exact_rows(problem, h * np.exp(sign * one)) for sign in (1.0, -1.0)]
        for i, slope in enumerate(rows.gradient[:, k]):
            up, down = (end.excess[end.twin(rows, i)] for end in ends)
            assert (up - down) / 2e-6 == pytest.approx(slope, rel=1e-5, abs=1e-5)


def test_a_curve_whose_jerk_jumps_keeps_no_limit_of_snap() -> None:
    cubic, stops = (walk(2, SNAP, c) for c in (curves.cubic_spline(3), curves.rest_to_rest(3, 5)))
    found = check(cubic, [9.0, 9.0, 9.0])
    assert (found.verdict, found.limits) == (Verdict.DISCONTINUOUS, Verdict.PASS)
    assert {jump.order for jump in found.jumps} == {3}
    assert check(replace(cubic, limits=APART), [9.0, 9.0, 9.0]).verdict is Verdict.PASS
    found = solve(stops)
    assert found.status is Status.INFEASIBLE
    assert found.why == "the jerk of joint 1 jumps at way-point 2 for any durations"
    assert solve(cubic).status is Status.NONE_FOUND
    free = solve(walk(2, SNAP, FREE))
    assert free.status is Status.CONVERGED
    assert check(free.problem, free.durations, free.nodal).verdict is Verdict.PASS


@pytest.mark.parametrize("curve", [FREE, curves.quintic_spline(25)], ids=["free", "many segments"])
def test_where_the_nlp_answers_the_smaller_size_counts_and_is_named(curve: Curve) -> None:
    problem = walk(4, APART, curve)
    found, narrow = solve(problem), solve(replace(problem, limits=APART.narrow))
    assert found.status is Status.FEASIBLE
    assert found.total_time == pytest.approx(narrow.total_time, rel=1e-9)
    assert "acceleration and deceleration were both kept within the smaller" in str(found.why)


@pytest.mark.parametrize(("limits", "said"), [(APART, "deceleration"), (SNAP, "snap")])
def test_what_is_proved_leaves_the_limit_out_and_says_so(limits: Limits, said: str) -> None:
    problem = walk(5, limits, curves.rest_to_rest(3, 7))
    proof = certify(problem)
    assert (proof.problem.relaxed, proof.upper, proof.durations) == ((said,), None, None)
    assert proof.verdict is not None
    assert (proof.verdict.proves, proof.verdict.upper) == (True, None)
    wide = Limits(limits.velocity, limits.sides[1, :, 1], limits.jerk)
    relaxed = replace(problem, limits=wide)
    least = certify(relaxed)
    assert proof.lower == least.lower > 0
    assert problem_seal(problem) != problem_seal(relaxed)
    found = proved_too(problem)
    assert found.status is Status.CONVERGED
    assert found.lower_bound == pytest.approx(float(least.lower))
    assert found.why == f"the lower bound is proved without the limits of {said}"
