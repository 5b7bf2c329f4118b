"""Newton descents on exact extrema: their parts, and their answers beside those of IPOPT."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from support.small_problems import FAMILIES, small_problem
from trajgap.nlp import Solution, Status, kkt
from trajgap.nlp.optimum import newton_curve, newton_program, solve, solver
from trajgap.nlp.optimum.descent import least_point
from trajgap.nlp.optimum.limit_rows import exact_rows
from trajgap.nlp.optimum.newton import Descents, covered, settled_quickly
from trajgap.problem import (
    Array,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    load_case,
    piecewise,
)

FLOOR = 1e-4
"""Floor of the durations, relative to the usual ones, as `solve` asks for it."""
EDGE = 1e-3
"""Places this near to an end may be rounding: the cube root of it, where jerk is 0 there too."""
TOTALS = 2e-7
"""Relative difference of two totals that both ways may have: the tracked NLP stops at 1e-7."""


def _quick(problem: Problem) -> Solution:
    found = settled_quickly(problem, 4, 0, FLOOR)
    assert found is not None
    return found


def _tracked(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> Solution:
    """The answer of `solve` without the Newton descents."""
    with monkeypatch.context() as patch:
        patch.setattr(solver, "settled_quickly", lambda *_: None)
        return solver.solve(problem)


def _total(problem: Problem, z: Array) -> tuple[float, Array, Array, Array]:
    """One weighted sum of all excesses near z with slopes and curvature, by the kernel's parts."""
    descents = Descents(problem)
    (
        values, kinds, breaks, orders, degrees, column, smooth, inverse_limits, ranges, span, perm,
        places, _, system, right, work, *_,
    ) = descents.arrays  # fmt: skip
    x, slopes, inverse, excess, gradient, s_of, place = places
    n = z.size
    with np.errstate(all="ignore"):
        assert newton_curve.curve_at(
            z, values, kinds, breaks, orders, degrees, column, perm, inverse, x, slopes, True,
            system, right,
        )  # fmt: skip
        count, _, _ = newton_curve.rows_at(
            z, degrees, smooth, inverse_limits, ranges, span, perm, x, slopes, True,
            excess, gradient, place, s_of, 0.3, work,
        )  # fmt: skip
        # At rest a position turns within rounding of the end, or not: neither matters.
        real = (place[:count, 4] == 0) | ((s_of[:count] > EDGE) & (s_of[:count] < 1 - EDGE))
        weights = np.where(real, 1.0 + 0.1 * place[:count, 2] + 0.3 * place[:count, 1], 0.0)
        hessian = np.zeros((n, n))
        for i in range(count):
            newton_curve.add_curvature(
                z, *place[i], s_of[i], weights[i], values, kinds, breaks, orders, degrees, column,
                perm, span, inverse, x, slopes, hessian, np.zeros(inverse.shape[0]), np.zeros(10),
                np.zeros(n), np.zeros(n), np.zeros((n, n)),
            )  # fmt: skip
    sum_ = float(weights @ excess[:count])
    return sum_, weights @ gradient[:count], hessian, np.sort(excess[:count][real])


@pytest.mark.parametrize("family", FAMILIES)
def test_slopes_and_curvature_are_those_of_the_exact_excesses(family: str) -> None:
    problem = small_problem(family, 3)
    n = problem.segments
    wide = np.ptp(problem.waypoints, axis=0)
    ranged = replace(
        problem.limits,
        position_lower=problem.waypoints.min(axis=0) - 0.1 * wide,
        position_upper=problem.waypoints.max(axis=0) + 0.1 * wide,
    )
    problem = replace(problem, limits=ranged)
    z = np.random.default_rng(5).normal(0.0, 0.3, n)
    _, slope, hessian, excess = _total(problem, z)
    rows = exact_rows(problem, np.exp(z))
    inner = [not 0.0 < e.s < 1.0 or EDGE < e.s < 1.0 - EDGE for e in rows.points]
    assert excess == pytest.approx(np.sort(rows.excess[inner]), abs=1e-10)
    step = 1e-5
    for k in range(n):
        move = np.eye(n)[k] * step
        ahead, behind = _total(problem, z + move), _total(problem, z - move)
        assert len(ahead[3]) == len(behind[3]) == len(excess)
        assert slope[k] == pytest.approx((ahead[0] - behind[0]) / (2 * step), abs=1e-6)
        along = (ahead[1] - behind[1]) / (2 * step)
        assert hessian[k] == pytest.approx(along, rel=1e-5, abs=1e-5)


def test_the_quadratic_program_is_that_of_non_negative_least_squares() -> None:
    generator = np.random.default_rng(11)
    unlike = 0
    for size in (2, 4, 7):
        for _ in range(12):
            half = generator.normal(size=(size, size))
            hessian, slope = half @ half.T + 0.1 * np.eye(size), generator.normal(size=size)
            rows, room = generator.normal(size=(3 * size, size)), generator.normal(size=3 * size)
            wanted = least_point(hessian, slope, rows, room)
            step, weights = np.empty(size), np.empty(3 * size)
            line = [np.empty(size) for _ in range(4)]
            found = newton_program.least_step(
                np.linalg.inv(hessian), slope, rows, room, 3 * size, step, weights,
                np.empty(size, dtype=np.int64), line[0], np.empty((size, size)), line[1],
                np.empty((size, size + 1)), line[2], line[3],
            )  # fmt: skip
            if wanted is None:
                unlike += found
                continue
            assert found
            assert step == pytest.approx(wanted[0], rel=1e-6, abs=1e-8)
            assert weights == pytest.approx(wanted[1], rel=1e-5, abs=1e-7)
    assert unlike <= 2  # least squares give up a little earlier where rows contradict each other


@pytest.mark.parametrize(
    ("seeds", "least"),
    [(range(2), 0), pytest.param(range(100, 150), 40, marks=pytest.mark.slow)],
)
@pytest.mark.parametrize("family", FAMILIES)
def test_answers_are_those_of_the_tracked_nlp(
    family: str, seeds: range, least: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    settled = 0
    for seed in seeds:
        problem = small_problem(family, seed)
        quick = settled_quickly(problem, 4, 0, FLOOR)
        if quick is None:
            continue
        settled += 1
        assert quick.kkt_residual <= 1e-8
        assert check(problem, quick.durations).verdict is Verdict.PASS
        other = _tracked(problem, monkeypatch)
        assert quick.total_time <= other.best * (1 + TOTALS), seed
        assert quick.status is Status.CONVERGED or other.status is not Status.CONVERGED
    assert settled >= least


def test_most_small_problems_settle() -> None:
    settled = [
        settled_quickly(small_problem(family, seed), 4, 0, FLOOR) is not None
        for family in FAMILIES
        for seed in range(4)
    ]
    assert sum(settled) >= 17


def test_the_published_optimum_is_found_from_every_start() -> None:
    problem = load_case("puma560-mnam-pso-353").problem()
    answer = _quick(problem)
    assert answer.total_time == pytest.approx(3.296696331740577, rel=1e-12)
    assert answer.starts_at_best == answer.starts == 4
    assert answer.durations is not None
    assert kkt(problem, answer.durations).residual <= 1e-13


def _shrinking() -> Problem:
    """Nothing holds the first segment's duration away from 0: the infimum is not attained."""
    q = np.array([[0.0], [0.0], [1.0], [2.0]])
    return Problem(q, Limits(1.0, joints=1), cubic_spline(3, ends=((2, 0.0),)))


@pytest.mark.parametrize(
    ("problem", "applies"),
    [
        (Problem(np.zeros((3, 1)), Limits(1.0), cubic_spline(2)), False),
        (Problem([[0.0], [1.0]], Limits(0.0), piecewise((5,))), False),
        (Problem([[0.0], [1.0]], Limits(1.0), piecewise((3,), ends=((1, 0.5),))), False),
        (Problem([[0.0], [1.0]], Limits(1.0), piecewise((7,))), False),
        (Problem(np.eye(10), Limits(1.0), cubic_spline(9)), False),
        (Problem([[0.0], [1.0]], Limits(1.0), piecewise((5,))), True),
    ],
    ids=["still", "held", "moving end", "free", "long", "one segment"],
)
def test_what_it_covers(problem: Problem, applies: bool) -> None:
    assert covered(problem) is applies
    assert (settled_quickly(problem, 4, 0, FLOOR) is not None) is applies


def test_what_does_not_settle_goes_to_the_other_ways() -> None:
    for problem in (
        _shrinking(),
        replace(small_problem("3-5-3", 1), duration_lower=0.0, duration_upper=0.1),
    ):
        assert covered(problem)
        assert settled_quickly(problem, 4, 0, FLOOR) is None
        assert solve(problem).status in (
            Status.NOT_ATTAINED,
            Status.INFEASIBLE,
            Status.NONE_FOUND,
        )


SMALL = """
import sys
from trajgap.nlp import solve, solve_per_joint
from trajgap.problem import Limits, Problem, three_five_three
one = Problem([[0], [1], [0.5], [2]], Limits(1, 2), three_five_three())
assert solve(one).status == "optimal"
problem = Problem([[0, 1], [1, 0.3], [0.5, -0.4], [2, 0]], Limits(1, 2), three_five_three())
assert solve_per_joint(problem).ranges
print(*sorted({"casadi", "matplotlib", "toppra"} & set(sys.modules)))
"""


def test_a_small_problem_and_its_ranges_need_neither_casadi_nor_pictures() -> None:
    command = [sys.executable, "-c", SMALL]
    said = subprocess.run(command, capture_output=True, text=True, check=True)
    assert said.stdout.strip() == ""
