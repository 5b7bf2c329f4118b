"""The interval of answers that no boxes are searched for: long splines, and kinds without a proof.

Independent truths: best motions over any curve of another solver, closed forms, mean velocities.
"""

from dataclasses import replace

import numpy as np
import pytest
from support.retimed import rest_to_rest_time
from trajgap.nlp import Evidence, Status, exact_problem, printed_problem, solve
from trajgap.nlp.proofs.any_curve import at_once, bound_at_once
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.certifiers import certify
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline,
    cubic_spline_virtual,
    load_case,
    piecewise,
    quintic_spline,
    uniform_cubic_b_spline,
)
from trajgap.verify import Subject


def long_walk(seed: int, curve=cubic_spline) -> Problem:
    rng = np.random.default_rng(seed)
    n, joints = int(rng.integers(13, 18)), int(rng.integers(1, 4))
    q = 0.7 + np.cumsum(rng.normal(size=(n + 1, joints)), axis=0)
    limits = Limits(*(rng.uniform(low, 4 * low, joints).tolist() for low in (1.0, 2.0, 9.0)))
    return Problem(q, limits, curve(n))


def best_of_any_curve(problem: Problem) -> float:
    """The best motion within velocities and accelerations that a local solver finds, s."""
    limits = problem.limits
    own = Limits(limits.velocity.tolist(), limits.acceleration.tolist())
    return estimate_any_curve(replace(problem, limits=own)).total_time


@pytest.mark.parametrize("curve", [cubic_spline, quintic_spline])
@pytest.mark.parametrize("seed", [1, *(pytest.param(s, marks=pytest.mark.slow) for s in range(20))])
def test_no_motion_of_another_solver_is_shorter(curve, seed):
    problem = long_walk(seed, curve)
    found, best = solve(problem), best_of_any_curve(problem)
    assert 0.85 * best < found.lower_bound <= best <= found.total_time
    assert found.status is not Status.OPTIMAL
    assert found.evidence is not Evidence.CERTIFIED
    assert solve(problem).lower_bound == found.lower_bound


def test_a_certificate_over_any_curve_contains_it():
    problem = long_walk(3)
    found = solve(problem)
    proved = certify(problem, subject=Subject.ANY, gap=0.1, boxes=1)
    assert proved.verdict.proves
    assert found.lower_bound <= float(proved.lower) * (1 + 1e-9)


def test_onwards_it_is_the_time_of_a_trapezoid():
    way = np.linspace(0.2, 9.2, 15)[:, None]
    found = solve(Problem(way, Limits(1.5, 2.0), cubic_spline(14)))
    least = rest_to_rest_time(9.0, 1.5, 2.0)
    assert 0.97 * least < found.lower_bound <= least < found.total_time


def test_within_velocities_alone_it_is_the_sum_of_the_mean_ones():
    problem = replace(long_walk(4), limits=Limits([1.3, 2.1, 0.8]))
    ways = np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity
    assert solve(problem).lower_bound == pytest.approx(ways.max(axis=1).sum(), rel=1e-12)


def test_speeds_at_the_ends_count():
    way = np.linspace(0.2, 9.2, 15)[:, None]
    limits = Limits(1.5, 0.5)
    moving = cubic_spline(14, ((1, 1.5),), ((1, 1.5),))
    found = [solve(Problem(way, limits, curve)) for curve in (cubic_spline(14), moving)]
    assert found[1].lower_bound == pytest.approx(9.0 / 1.5, rel=1e-9)
    assert found[0].lower_bound > 1.2 * found[1].lower_bound


def test_parts_prove_a_little_less_than_the_whole(monkeypatch):
    problem = long_walk(5)
    exact, found = exact_problem(problem), solve(problem)
    times = np.concatenate([[0.0], found.durations.cumsum()])
    speeds = found.trajectory(times, 1)
    whole = bound_at_once(exact, np.diff(times), speeds)
    monkeypatch.setattr(at_once, "_PART", 5)
    parts = bound_at_once(exact, np.diff(times), speeds)
    assert 0.8 * whole < parts < whole


@pytest.mark.parametrize(
    "problem",
    [
        Problem([[0.1], [0.9], [0.4], [1.7]], Limits(1.0, 3.0), uniform_cubic_b_spline(4, "timed")),
        Problem([[0.1], [0.9], [0.4], [1.7]], Limits(1.0, 3.0), piecewise((5, 5, 5), 2, ((1, 0),))),
        Problem(long_walk(6).waypoints, long_walk(6).limits, cubic_spline_virtual(16)),
    ],
)
def test_a_curve_without_a_kind_of_proof_has_one_too(problem):
    found = solve(problem)
    assert 0.3 * found.total_time < found.lower_bound <= best_of_any_curve(problem)


def test_an_infimum_has_one():
    still = Problem([[0.0], [1.0], [1.0], [2.5]], Limits(2.0), cubic_spline(3))
    found = solve(still)
    assert found.infimum is not None
    assert found.lower_bound == pytest.approx(2.5 / 2.0, rel=1e-12)


def test_the_unit_of_the_printed_numbers_changes_nothing():
    case, reading = load_case("irb1600-ga-cubic-bspline"), "angles-deg-v-deg-a-deg-timed"
    statement = case.statement("nine-segments", reading)
    assert statement.unit("position", 0) == "deg"
    exact, problem = printed_problem(statement), statement.problem()
    found = solve(problem, exact=exact), solve(problem)
    assert found[0].lower_bound == pytest.approx(found[1].lower_bound, rel=1e-9)


def test_what_nothing_bounds_has_none():
    problem = replace(long_walk(7), limits=Limits(jerk=9.0, joints=len(long_walk(7).joints)))
    found = solve(problem)
    assert (found.found, found.lower_bound) == (True, None)
