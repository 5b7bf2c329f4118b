"""The NLP of the B-splines beside closed forms and identities."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from support.b_splines import clamped, uniform
from trajgap.nlp import Status, random_starts, solve_per_joint
from trajgap.nlp.optimum import solve
from trajgap.problem import Limits, Verdict, check, curves, evaluate, load_case
from trajgap.problem.curves import solve_in_closed_form

POLISH = "irb1600-ga-cubic-bspline"
BEST = {
    "angles-rad-v-rad-a-rad": (4.852456649, 4.038082213),
    "angles-rad-v-rad-a-deg": (36.730173546, 30.565849671),
    "angles-rad-v-deg-a-rad": (20.323474354, 17.781591382),
    "angles-rad-v-deg-a-deg": (38.661154288, 33.725471244),
    "angles-deg-v-rad-a-rad": (0.641062463, 0.533474715),
    "angles-deg-v-rad-a-deg": (4.852456649, 4.038082213),
    "angles-deg-v-deg-a-rad": (0.674764435, 0.588620515),
    "angles-deg-v-deg-a-deg": (4.852456649, 4.038082213),
}
"""Best known totals, s: stretched (closed form) and timed (found from 4 starts)."""
UNITS = tuple(BEST)


@pytest.mark.parametrize("units", UNITS)
def test_the_stretched_optimum_is_found_by_the_solver_from_afar(units: str) -> None:
    """A stretch of the start as a whole, all that happens beside the NLP, stays far above."""
    problem = load_case(POLISH).problem(reading_id=f"{units}-stretched")
    expected = solve_in_closed_form(problem.curve, problem.waypoints, problem.limits.derivatives)
    total = expected.sum()
    assert total == pytest.approx(BEST[units][0], abs=1e-9)
    start = random_starts(problem, 1, np.random.default_rng(11))
    stretched = float(start.sum() * evaluate(problem, start).stretch[0])
    assert stretched > 1.5 * total
    solution = solve(problem, initial=start)
    assert solution.iterations > 3
    assert solution.status is Status.CONVERGED
    np.testing.assert_allclose(solution.durations, expected, rtol=1e-8)
    assert solution.total_time == pytest.approx(total, rel=1e-9, abs=0)
    assert solution.check.verdict is Verdict.DISCONTINUOUS
    assert solution.check.limits is Verdict.PASS
    assert "jumps of velocity between them" in str(solution.why)


def test_timed_optimum_of_the_polishing_paper_in_one_unit() -> None:
    problem = load_case(POLISH).problem(reading_id="angles-rad-v-rad-a-rad-timed")
    solution = solve(problem, starts=2)
    assert solution.status is Status.CONVERGED
    assert solution.total_time == pytest.approx(BEST["angles-rad-v-rad-a-rad"][1], abs=2e-9)
    assert solution.check.verdict is Verdict.PASS
    assert solution.check.max_violation <= 1e-12
    assert solution.kkt_residual <= 1e-8
    # One unit throughout is one question in two units.
    degrees = load_case(POLISH).problem(reading_id="angles-deg-v-deg-a-deg-timed")
    assert evaluate(degrees, solution.durations[None]).stretch[0] == pytest.approx(1, rel=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("units", UNITS)
def test_timed_optimum_under_every_unit_reading_from_random_starts(units: str) -> None:
    problem = load_case(POLISH).problem(reading_id=f"{units}-timed")
    starts = random_starts(problem, 6, np.random.default_rng(7))
    solution = solve(problem, initial=starts)
    least = min(solve(problem).total_time, solution.total_time)
    assert least == pytest.approx(BEST[units][1], abs=2e-9)


@pytest.mark.parametrize(
    "kind",
    [
        (3, "averaged-continued", "times", "timed"),
        (5, "averaged-continued", "chord", "timed"),
        (4, "averaged-continued", "joint-chord", "timed"),
        (5, "averaged-continued", "chord", "stretched"),
    ],
    ids=lambda k: "-".join(map(str, k)),
)
def test_clamped_splines_are_solved_to_a_kkt_point(kind) -> None:
    problem, _ = clamped(kind, 21, count=5, joints=2)
    solution = solve(problem, starts=2)
    assert solution.status is Status.CONVERGED
    assert solution.check.limits is Verdict.PASS
    assert solution.kkt_residual <= 1e-8
    if kind[3] == "stretched":
        wanted = solve_in_closed_form(problem.curve, problem.waypoints, problem.limits.derivatives)
        assert solution.total_time == pytest.approx(wanted.sum(), rel=1e-9)
        return
    # No nearby durations, stretched until they keep the limits, are shorter.
    rng = np.random.default_rng(3)
    near = solution.durations * np.exp(0.02 * rng.standard_normal((4000, 4)))
    repaired = near.sum(axis=1) * evaluate(problem, near).stretch
    assert repaired.min() >= solution.total_time * (1 - 1e-9)


@pytest.mark.parametrize("time", ["stretched", pytest.param("timed", marks=pytest.mark.slow)])
def test_bounds_positions_and_impossible_limits(time: str) -> None:
    problem, _ = uniform(time, 34, count=4, joints=2)
    free = solve(problem, starts=2)
    low = 1.2 * float(free.durations[1])
    held = solve(replace(problem, duration_lower=[0.0, low, 0.0]), starts=2)
    assert held.durations[1] == pytest.approx(low, rel=1e-9)
    assert held.status is Status.CONVERGED
    zero = solve(replace(problem, limits=Limits([0.0, 1.0])))
    assert zero.status is Status.INFEASIBLE
    assert "joint 1 moves, but its velocity limit is 0" in str(zero.why)
    short = solve(replace(problem, duration_upper=0.02))
    assert short.status is Status.INFEASIBLE
    wide = Limits(*problem.limits.derivatives.T, -20.0, 20.0)
    found = solve(replace(problem, limits=wide), starts=2)
    assert found.total_time == pytest.approx(free.total_time, rel=1e-8)


def test_each_joint_by_itself() -> None:
    problem, _ = uniform("timed", 35, count=4, joints=2)
    answer = solve_per_joint(problem, solver=partial(solve, starts=2))
    assert answer.status is Status.CONVERGED
    assert not answer.ranges
    assert "piecewise polynomials only" in str(answer.why)
    longest = np.max([s.durations for s in answer.joints], axis=0)
    np.testing.assert_allclose(answer.durations, longest)


def test_a_b_spline_with_knots_at_the_way_points_is_solved_as_a_polynomial_spline() -> None:
    problem, _ = clamped((5, "waypoints", "times", "timed"), count=5)
    solution = solve(problem)
    spline = solve(replace(problem, curve=curves.quintic_spline(4)))
    assert solution.status is spline.status is Status.CONVERGED
    assert solution.problem is problem
    assert solution.check.peaks == check(problem, solution.durations).peaks
    assert solution.total_time == pytest.approx(spline.total_time, rel=1e-12)
