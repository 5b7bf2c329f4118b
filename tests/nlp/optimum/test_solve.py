"""Optima of small problems: closed forms, other routes, printed times, and their conditions."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.shipped_problems import COVERED_PROBLEMS
from trajgap.nlp import Solution, Status, kkt, random_starts, shipped
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.basins import EVOLUTION
from trajgap.nlp.optimum.optimality import sharpened, sparse_kkt
from trajgap.problem import Limits, Problem, TrajgapError, Verdict, check, curves, load_case
from trajgap.problem.curves.adjoint import Places

PUMA = "puma560-mnam-pso-353"


def puma(reading: str = "durations-at-least-0.3") -> Problem:
    return load_case(PUMA).problem(reading_id=reading)


def test_every_random_start_reaches_the_shared_puma_optimum() -> None:
    problem = puma()
    starts = random_starts(problem, 8, np.random.default_rng(20260101))
    solution = solve(problem, initial=starts)
    best = min(solution.totals)
    assert solution.status is Status.CONVERGED
    assert all(total <= best * (1 + 1e-6) for total in solution.totals)
    assert solution.starts_at_best == solution.starts == 8
    assert solution.check.verdict is Verdict.PASS
    assert solution.check.max_violation <= 1e-9
    assert solution.kkt_residual <= 1e-8


@pytest.mark.parametrize("joint", [None, *range(6)])
@pytest.mark.parametrize("reading", ["durations-at-least-0.3", "durations-positive"])
def test_puma_optima_lie_in_their_certified_intervals(reading: str, joint: int | None) -> None:
    """Which the verifier proves with the standard library, to 1e-6 of the total."""
    problem, name = puma(reading), f"{PUMA}.six-joints.{reading}"
    if joint is not None:
        problem, name = problem.joint(joint), f"{name}.joint-{joint + 1}"
    claim = shipped(COVERED_PROBLEMS[name])["claim"]
    lower, upper = (float(Fraction(claim[side])) for side in ("lower", "upper"))
    assert lower * (1 - 1e-9) <= solve(problem).total_time <= upper * (1 + 1e-9)


def test_a_segment_without_motion_is_named_and_its_infimum_is_the_rest() -> None:
    q = np.array([[0.3, 1.0], [0.9, 0.2], [0.9, 0.2], [1.4, 0.8]])
    limits = Limits([1.0, 1.5], [3.0, 4.0])
    solution = solve(Problem(q, limits, curves.rest_to_rest(3, 5)))
    parts = [
        solve(Problem(q[i : i + 2], limits, curves.rest_to_rest(1, 5))).total_time for i in (0, 2)
    ]
    assert solution.status is Status.NOT_ATTAINED
    assert solution.why is not None
    assert "segment 2" in solution.why
    assert solution.infimum == pytest.approx(sum(parts), rel=1e-9)
    bounded = solve(Problem(q, limits, curves.rest_to_rest(3, 5), [0.0, 0.25, 0.0]))
    assert bounded.status is Status.CONVERGED
    assert bounded.total_time == pytest.approx(sum(parts) + 0.25, rel=1e-9)


@pytest.mark.parametrize("joints", [1, 2])
def test_a_still_first_segment_of_any_angle_is_named(joints: int) -> None:
    q = np.array([[0.3, 1.0], [0.3, 1.0], [0.9, 0.5], [1.4, 0.8]])[:, :joints]
    solution = solve(Problem(q, Limits(1.0, 3.0, joints=joints), curves.three_five_three()))
    assert solution.status is Status.NOT_ATTAINED
    assert solution.infimum < solution.total_time
    assert "the duration of segment 1 goes to 0" in solution.why


ZIGZAG = np.array([[0.3], [0.9], [0.1], [1.4]])


@pytest.mark.parametrize(
    "problem",
    [
        Problem(ZIGZAG, Limits(), curves.three_five_three()),
        Problem(np.full((4, 2), 0.7), Limits(1.0, 2.0), curves.three_five_three()),
        Problem([[0.4], [0.4]], Limits(1.0, 2.0), curves.uniform_cubic_b_spline(2, "stretched")),
        Problem(ZIGZAG, Limits(), curves.cubic_spline(3), ratios="equal"),
        Problem(np.zeros((3, 1)), Limits(1.0), curves.cubic_spline(2), ratios="equal"),
    ],
)
def test_nothing_that_moves_or_nothing_that_limits_has_infimum_zero(problem: Problem) -> None:
    answer = solve(problem)
    assert answer.status is Status.NOT_ATTAINED
    assert answer.infimum == pytest.approx(0, abs=1e-9)
    assert answer.best == answer.infimum
    assert answer.boundless is not None or problem.ratios is None
    bounded = solve(replace(problem, duration_lower=0.3))
    assert bounded.total_time == pytest.approx(0.3 * problem.segments)


def test_a_joint_that_must_not_move_and_does_not_is_no_obstacle() -> None:
    q = np.array([[0.3, 1.0], [0.9, 1.0], [0.5, 1.0], [1.4, 1.0]])
    alone = solve(Problem(q[:, :1], Limits(1.0, 3.0), curves.three_five_three()))
    both = solve(Problem(q, Limits([1.0, 0.0], [3.0, 0.0]), curves.three_five_three()))
    assert both.status is Status.CONVERGED
    assert both.total_time == pytest.approx(alone.total_time, rel=1e-9)


def test_starts_of_the_wrong_length_or_number_are_refused() -> None:
    with pytest.raises(TrajgapError, match="starts: must be 1 or more, got 0"):
        solve(puma(), starts=0)
    for seconds in (-1.0, np.nan):
        with pytest.raises(TrajgapError, match=f"seconds: must not be below 0, got {seconds}"):
            solve(puma(), seconds=seconds)
    with pytest.raises(TrajgapError, match=r"initial: expected shape \(starts, 3\)"):
        solve(puma(), initial=[[1.0, 1.0]])


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_what_a_bound_on_a_duration_costs_is_a_difference_of_totals(side: str) -> None:
    problem = Problem(Q, LIMITS, curves.three_five_three())
    free = solve(problem).durations
    bound = np.zeros(3) if side == "lower" else np.full(3, 9.0)
    bound[1] = free[1] * (1.2 if side == "lower" else 0.9)

    def bounded(factor: float) -> Solution:
        return solve(replace(problem, **{f"duration_{side}": bound * factor}))

    (wall,) = [a for a in bounded(1.0).active if a.quantity == "duration"]
    step = 1e-4
    slope = (bounded(1 + step).total_time - bounded(1 - step).total_time) / (2 * step)
    assert wall.segment == 1
    assert wall.multiplier == pytest.approx(abs(slope), rel=1e-4)
    assert wall.sensitivity == pytest.approx(0.1 * slope, rel=1e-4)


def test_a_limit_reached_at_a_break_belongs_to_the_segment_before() -> None:
    """Both segments reach it there: by the banded conditions as by the dense ones."""
    problem = Problem([[0.0], [1.0], [2.0]], Limits(1.0, 9.0), curves.cubic_spline(2))
    durations = np.array([1.5, 1.5])  # by symmetry the speed is largest at the break
    one, none = np.zeros(1, dtype=np.int64), np.zeros(1)
    places = Places(one, one + 1, one + 1, none)
    found = sparse_kkt(problem, durations, places, np.array([1.0]), np.zeros(2))
    assert [(a.segment, a.time) for a in found.active] == [(0, 1.5)]
    assert [a.segment for a in kkt(problem, durations).active] == [0]


def test_the_grid_of_ratios_is_the_same_when_time_runs_backwards() -> None:
    for segments in (2, 3):
        axis = EVOLUTION.axis(segments)
        assert np.ptp(axis) > 8
        np.testing.assert_allclose(axis, -axis[::-1])


Q = np.array([[0.2, -1.0, 0.7], [0.9, 0.3, 0.1], [0.4, 1.1, -0.8], [1.3, 0.6, 0.2]])
LIMITS = Limits([1.5, 2.0, 1.0], [4.0, 6.0, 5.0], [30.0, 50.0, 40.0])


def test_only_an_optimum_has_a_small_residual() -> None:
    problem = Problem(Q, LIMITS, curves.three_five_three())
    best = solve(problem).durations
    assert kkt(problem, best).residual <= 1e-10
    assert kkt(problem, best * 1.01).residual > 0.1
    assert kkt(problem, best * 0.999).residual > 1e-4
    other = best * np.array([1.05, 1.0, 1.0])
    assert kkt(problem, other * check(problem, other).stretch).residual > 1e-2


def test_newton_sharpens() -> None:
    problem = Problem(Q, LIMITS, curves.three_five_three())
    best = solve(problem).durations
    blurred = best * (1 + 1e-9)
    sharp = sharpened(problem, blurred)
    assert kkt(problem, blurred).residual > 1e-10
    assert kkt(problem, sharp).residual <= 1e-11
    assert sharp == pytest.approx(best, rel=1e-7)


def test_free_derivatives_cost_no_time_and_enter_the_conditions() -> None:
    problem = Problem(Q, LIMITS, curves.piecewise((5, 5, 5), 2))
    solution = solve(problem)
    assert solution.status is Status.CONVERGED
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
    assert solution.total_time < solve(Problem(Q, LIMITS, curves.three_five_three())).total_time
    assert solution.kkt_residual <= 1e-8
    shifted = solution.nodal + np.array([[0.05], [0.0], [0.0], [0.0]])
    assert kkt(problem, solution.durations, shifted).residual > 1e-3
