"""Curves that may jump where the limits forbid it, and what keeps them from it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, differential_evolution, fsolve, minimize_scalar
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.closed_forms import joined
from trajgap.nlp.optimum.feasibility import forbidden_jumps
from trajgap.nlp.optimum.jumps import as_answer, same_motions, smoother
from trajgap.problem import (
    Array,
    Curve,
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    fit,
    piecewise,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)

REST, STILL = ((1, 0.0),), ((1, 0.0), (2, 0.0))
Q = np.array([[0.31, -0.72], [1.43, 0.38], [0.64, 1.17], [-0.55, 0.93]])
SPEEDS, BENDS, JERKS = np.array([1.1, 0.9]), np.array([2.1, 2.4]), np.array([6.3, 4.7])
FREE_SPEEDS = piecewise((3, 3, 3), 1, REST)
"""Two speeds at the via-points are free, and acceleration may jump there."""


def free_speeds(curve: Interpolant = FREE_SPEEDS, jerk: Array = JERKS, columns: int = 2) -> Problem:
    return Problem(Q[:, :columns], Limits(SPEEDS[:columns], BENDS[:columns], jerk[:columns]), curve)


def clamped(h: Array, q: Array) -> CubicSpline:
    """The C2 cubic spline from rest to rest: of cubics without a jump there is no other."""
    return CubicSpline(np.append(0.0, np.cumsum(h)), q, bc_type="clamped")


def tight_total(h: Array, q: Array, v: float, a: float, j: float) -> float:
    """Total of that spline, stretched until it is tight.

    Speed is largest where the acceleration is 0, else at an end of a piece.
    """
    c3, c2, c1, _ = clamped(h, q).c
    s = np.stack([np.zeros(h.size), np.clip(-c2 / (3 * np.where(c3 == 0, 1e-300, c3)), 0, h), h])
    needs = (
        np.abs(3 * c3 * s**2 + 2 * c2 * s + c1).max() / v,
        (np.abs(6 * c3 * s + 2 * c2).max() / a) ** (1 / 2),
        (np.abs(6 * c3).max() / j) ** (1 / 3),
    )
    return float(h.sum() * max(needs))


def spline_total(logs: Array, columns: int) -> float:
    h = np.exp(np.append(0.0, logs))
    limits = list(zip(SPEEDS, BENDS, JERKS, strict=True))
    return max(tight_total(h, Q[:, k], *limits[k]) for k in range(columns))


@pytest.mark.parametrize("columns", [1, 2])
def test_free_speeds_under_jerk_limits_give_the_spline(columns: int) -> None:
    problem = free_speeds(columns=columns)
    solution = solve(problem)
    assert solution.status is Status.CONVERGED
    assert solution.problem is problem
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
    # Brute force over the cubic splines of scipy, whose acceleration does not jump.
    brute = differential_evolution(
        spline_total, [(-3.0, 3.0)] * 2, args=(columns,), rng=1, tol=1e-10, popsize=20
    )
    assert solution.total_time == pytest.approx(brute.fun, rel=1e-5)
    # The free values are the speeds of that spline.
    spline = replace(problem, curve=cubic_spline(3))
    moved = fit(spline.curve, spline.waypoints, solution.durations)
    speeds = [[moved.derivative(b, j, 1)[0] for j in range(columns)] for b in (1, 2)]
    np.testing.assert_allclose(solution.nodal, speeds, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("curve", "same"),
    [
        (piecewise((4, 3, 4), 1, STILL), piecewise((4, 3, 4), 2, STILL)),
        (piecewise((5, 3, 5), 1, (*STILL, (3, 0.0))), piecewise((5, 3, 5), 2, (*STILL, (3, 0.0)))),
    ],
    ids=["4-3-4", "5-3-5"],
)
def test_higher_degrees(curve: Interpolant, same: Interpolant) -> None:
    solution, other = solve(free_speeds(curve)), solve(free_speeds(same))
    assert solution.status is other.status is Status.CONVERGED
    assert solution.total_time == pytest.approx(other.total_time, rel=1e-12)
    assert solution.found
    assert check(free_speeds(curve), solution.durations, solution.nodal).verdict is Verdict.PASS


def test_without_a_jerk_limit_acceleration_may_jump() -> None:
    free = np.full(2, np.inf)
    assert smoother(free_speeds(jerk=free)) is None
    assert solve(free_speeds(jerk=free)).total_time < solve(free_speeds()).total_time * 0.999


def test_a_joint_without_a_jerk_limit_makes_it_feasible_only() -> None:
    some = free_speeds(jerk=np.array([6.3, np.inf]))
    assert not same_motions(some)
    solution = solve(some)
    assert solution.status is Status.FEASIBLE
    assert "kept as smooth as the others" in str(solution.why)
    assert check(some, solution.durations, solution.nodal).verdict is Verdict.PASS
    # A joint that stands still is smooth by itself.
    still = replace(some, waypoints=np.column_stack([Q[:, 0], np.full(4, 0.3)]))
    assert same_motions(still)
    assert solve(still).status is Status.CONVERGED


def test_known_motions_and_starts_go_with_it() -> None:
    problem = free_speeds()
    best = solve(problem)
    slow = np.array(best.durations) * 1.5
    earlier = {"known": best.durations[None], "known_nodal": best.nodal[None]}
    known = solve(problem, initial=slow, starts=1, **earlier)
    assert known.total_time <= best.total_time * (1 + 1e-9)
    assert solve(problem, initial=slow, known=slow).total_time < slow.sum()


def test_infeasible_is_a_proof_for_the_first_problem_where_the_motions_are_the_same() -> None:
    short = np.full(3, 0.4)
    proved = solve(replace(free_speeds(), duration_upper=short))
    assert proved.status is Status.INFEASIBLE
    some = replace(free_speeds(jerk=np.array([6.3, np.inf])), duration_upper=np.full(3, 2.0))
    smooth = smoother(some)
    assert smooth is not None
    found = replace(solve(smooth), status=Status.INFEASIBLE, vector=None, why="not this one")
    assert as_answer(some, found) is None
    alike = replace(free_speeds(), duration_upper=np.full(3, 2.0))
    answer = as_answer(alike, found)
    assert answer.problem is alike


@pytest.mark.parametrize(
    "curve",
    [three_five_three(), piecewise((3, 3, 3), 1, STILL), piecewise((3, 2, 3), 1, REST)],
    ids=["determined", "determined and jumping", "too few coefficients"],
)
def test_nothing_to_raise(curve: Interpolant) -> None:
    assert smoother(free_speeds(curve)) is None


TURNING = Problem(
    np.array([[1302.26], [52.133], [58.6694]]),
    Limits(4118.4, joints=1),
    piecewise((1, 1), 0, ()),
    [0.2874992984580243, 0.604646646043441],
    [0.3042336391316181, 0.659779283964719],
)
"""Straight there and back: the velocity changes its sign at the way-point."""
UNEQUAL = Problem(
    np.array([[0.0944701], [-0.0249676], [0.299409]]),
    Limits(jerk=6.04733, joints=1),
    rest_to_rest(2, 3),
    [1.4611078233479549, 1.016999735848937],
    [1.7035952883424936, 1.0914763609431977],
)
"""The acceleration agrees where h₂/h₁ = √(0.324/0.119), which the bounds exclude."""


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (TURNING, "the velocity of joint 1 jumps at way-point 2 for any durations"),
        (UNEQUAL, "without a jump of acceleration of joint 1 segment 2 takes at least 2.40788 s"),
    ],
)
def test_a_jump_that_no_durations_avoid_is_a_proof(problem: Problem, reason: str) -> None:
    solution = solve(problem)
    assert solution.status is Status.INFEASIBLE
    assert reason in str(solution.why)
    # A second route: of a grid over the bounds every motion jumps, though many keep the limits.
    sides = np.linspace(problem.duration_lower, problem.duration_upper, 7).T
    grid = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    verdicts = [check(problem, h) for h in grid]
    assert all(one.verdict is not Verdict.PASS for one in verdicts)
    assert any(one.limits is Verdict.PASS for one in verdicts)
    way = np.abs(np.diff(problem.waypoints[:, 0]))
    if problem is UNEQUAL:
        least = problem.duration_lower[0] * np.sqrt(way[1] / way[0])
        assert least == pytest.approx(2.40788, rel=1e-5)


def test_a_still_segment_beside_a_moving_one_jumps() -> None:
    problem = Problem(np.array([[0.2], [0.2], [1.0]]), Limits(1.0, 2.0, 3.0), rest_to_rest(2, 3))
    assert joined(problem) == "the acceleration of joint 1 jumps at way-point 2 for any durations"
    two = Problem([[0.2, 1.0], [0.5, 1.4], [1.0, 1.7]], Limits(1.0), piecewise((1, 1), 0, ()))
    assert "the velocity of joint 2 jumps at way-point 2" in str(joined(two))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("curve", "power"), [(piecewise((1, 1, 1), 0, ()), 1.0), (rest_to_rest(3, 3), 0.5)]
)
def test_the_least_durations_without_a_jump(curve: Interpolant, power: float, seed: int) -> None:
    """h ∝ |Δq| keeps the velocity of straight segments, h ∝ √|Δq| the acceleration of cubics."""
    generator = np.random.default_rng(seed)
    way = generator.uniform(0.2, 2.0, 3)
    sign = 1.0 if power == 1.0 else -1.0
    q = 0.7 + np.concatenate([[0.0], np.cumsum(way * sign ** np.arange(3))])
    limits = Limits(1.3, joints=1) if power == 1.0 else Limits(1.3, 2.0, 5.0, joints=1)
    lower = generator.uniform(0.0, 1.0, 3)
    problem = Problem(q, limits, curve, lower)
    h = way**power
    tight = h * check(problem, h / h.min()).stretch / h.min()
    expected = tight * max(1.0, (lower / tight).max())
    solution = solve(problem)
    assert solution.status is Status.CONVERGED
    assert check(problem, solution.durations).verdict is Verdict.PASS
    assert solution.durations == pytest.approx(expected, rel=1e-8)


def test_curves_without_such_ratios_are_left_to_the_search() -> None:
    q = np.array([[0.0], [1.0], [0.4]])
    assert joined(Problem(q, Limits(1.0, 2.0, joints=1), rest_to_rest(2, 3))) is None
    assert joined(Problem(q, Limits(1.0, 2.0, 9.0, joints=1), rest_to_rest(2, 5))) is None
    assert joined(Problem(q, Limits(1.0, 2.0, 9.0, joints=1), cubic_spline(2))) is None


DETERMINED = piecewise((3, 3, 3), 1, ((1, 0.0), (2, 0.0)))
"""Twelve conditions for twelve coefficients; acceleration may jump at both via-points."""
ON = np.array([-0.844, 0.002, 0.615, 1.043])
TURNING_BACK = np.array([0.741, 0.493, 1.137, 1.554])
V, A, J = 1.1, 2.1, 6.3


def determined(q: Array, curve: Curve = DETERMINED, jerk: float = J, **bounds: Array) -> Problem:
    q = q.reshape(4, -1)
    return Problem(q, Limits(V, A, jerk, joints=q.shape[1]), curve, **bounds)


def end_accelerations(ratios: Array, q: Array) -> Array:
    """Of the C2 cubic spline at rest in velocity: without a jump they must be 0 as well."""
    h = np.exp(np.append(0.0, np.clip(ratios, -8.0, 8.0)))
    return np.asarray(clamped(h, q)([0.0, h.sum()], 2)) * h[[0, -1]] ** 2


def brute_totals(q: Array) -> list[float]:
    """Totals of all motions without a jump that a grid of starts leads to, by scipy's splines."""
    totals: list[float] = []
    for first in np.linspace(-4, 4, 5):
        for second in np.linspace(-4, 4, 5):
            ratios, _, ended, _ = fsolve(
                end_accelerations, [first, second], args=(q,), full_output=True, xtol=1e-13
            )
            if ended != 1 or np.abs(end_accelerations(ratios, q)).max() > 1e-9:
                continue
            if np.abs(ratios).max() > 5:
                continue  # where a duration vanishes everything does
            h = np.exp(np.append(0.0, ratios))
            totals.append(tight_total(h, q, V, A, J))
    return totals


def test_a_motion_without_a_jump_is_found_where_there_is_one() -> None:
    problem = determined(ON)
    solution = solve(problem)
    assert solution.status is Status.FEASIBLE
    assert "at which the motion does not jump" in str(solution.why)
    assert check(problem, solution.durations).verdict is Verdict.PASS
    assert solution.total_time == pytest.approx(min(brute_totals(ON)), rel=1e-6)


def test_none_is_found_where_brute_force_has_none() -> None:
    assert brute_totals(TURNING_BACK) == []
    solution = solve(determined(TURNING_BACK))
    assert solution.status is Status.NONE_FOUND
    assert "jumps" in str(solution.why)


@cache
def without_a_jump() -> Array:
    """The only durations of that one joint, which two tests look at."""
    return solve(determined(ON)).durations


def test_bounds_on_the_durations_hold() -> None:
    free = without_a_jump()
    low = np.array([0.0, 2.0 * free[1], 0.0])
    longer = solve(determined(ON, duration_lower=low)).durations
    np.testing.assert_allclose(longer, 2.0 * free, rtol=1e-6)
    short = solve(determined(ON, duration_upper=0.97 * free))
    assert short.status is Status.NONE_FOUND


def test_proportional_joints_share_the_ratios() -> None:
    both = determined(np.column_stack([ON, 0.5 - 0.4 * ON]))
    np.testing.assert_allclose(solve(both).durations, without_a_jump(), rtol=1e-6)
    other = determined(np.column_stack([ON, TURNING_BACK]))
    assert solve(other).status is Status.NONE_FOUND


@pytest.mark.parametrize(
    ("problem", "places"),
    [
        (determined(ON, cubic_spline(3)), []),
        (determined(ON), [(1, 2, 0), (2, 2, 0)]),
        (determined(ON, jerk=np.inf), []),
        (determined(ON, piecewise((1, 3, 3), 0, ())), [(b, r, 0) for b in (1, 2) for r in (1, 2)]),
        (determined(np.full(4, 0.3)), []),
        (determined(ON, uniform_cubic_b_spline(4, "timed")), []),
        (determined(ON, rest_to_rest(3, 5)), []),
    ],
    ids=["smooth", "acceleration", "no jerk limit", "velocity", "still", "B-spline", "rest"],
)
def test_jumps_that_limits_forbid(problem: Problem, places: list[tuple[int, int, int]]) -> None:
    assert forbidden_jumps(problem) == places


def test_an_acceleration_that_is_prescribed_is_no_obstacle() -> None:
    """Its motions cannot be stretched: the NLP holds them by its equations alone."""
    problem = determined(ON, piecewise((3, 3, 3), 1, ((1, 0.0), (2, 0.3)), finish=STILL))
    solution = solve(problem)
    assert solution.status is Status.FEASIBLE
    assert check(problem, solution.durations).verdict is Verdict.PASS


TOO_FEW = piecewise((3, 2, 3), 1, ((1, 0.0),))
ONWARDS = np.array([0.21, 0.9, 1.34, 1.87])


def mismatch(h: Array, q: Array) -> float:
    """Jerk of the spline in the middle, where a piece of degree 2 has none."""
    return float(clamped(h, q).c[0, 1] * h[1] ** 3)


def brute_total(q: Array) -> float:
    """Least total over a grid of one ratio, and all ratios of the last that go with it, refined."""
    thirds = np.exp(np.linspace(-4.0, 4.0, 81))

    def total(log_second: float) -> float:
        def off(third: float) -> float:
            return mismatch(np.array([1.0, np.exp(log_second), third]), q)

        values = np.array([off(third) for third in thirds])
        roots = [
            brentq(off, thirds[i], thirds[i + 1], xtol=1e-15)
            for i in np.flatnonzero(values[:-1] * values[1:] < 0)
        ]
        found = [np.array([1.0, np.exp(log_second), x]) for x in roots]
        return min((tight_total(h, q, V, A, J) for h in found), default=np.inf)

    grid = np.linspace(-3.0, 3.0, 31)
    found = [total(x) for x in grid]
    best, step = grid[int(np.argmin(found))], float(grid[1] - grid[0])
    near = minimize_scalar(total, bounds=(best - step, best + step), options={"xatol": 1e-10})
    return min(float(near.fun), min(found))


def test_the_shortest_motion_without_a_jump_is_found() -> None:
    problem = determined(ONWARDS, TOO_FEW)
    solution = solve(problem)
    assert solution.status is Status.FEASIBLE
    assert "at which the motion does not jump" in str(solution.why)
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
    assert solution.found
    h = solution.durations
    assert mismatch(h, ONWARDS) == pytest.approx(0.0, abs=1e-8)
    assert tight_total(h, ONWARDS, V, A, J) == pytest.approx(h.sum(), rel=1e-8)
    assert solution.total_time == pytest.approx(brute_total(ONWARDS), rel=1e-6)


def test_more_equations_than_ratios_are_named() -> None:
    q = np.column_stack([ONWARDS, ONWARDS**2, np.sqrt(ONWARDS)])
    solution = solve(determined(q, TOO_FEW))
    assert solution.status is Status.NONE_FOUND
    assert "2 ratios of durations would have to satisfy 3 equations" in str(solution.why)
