"""The twenty C4 quintic problems of the benchmarks, and how surely they are solved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.benchmarks import loaded
from support.checkout import ROOT
from trajgap.nlp import Status, random_starts, solve
from trajgap.nlp.optimum.starts import SETTLED_SEGMENTS, equal_start, settled
from trajgap.problem import (
    Limits,
    Problem,
    Verdict,
    cubic_spline,
    evaluate,
    load_case,
    piecewise,
    quintic_spline,
)

QUINTIC = loaded("quintic_instances")
STEPS, INSTANCES = QUINTIC.STEPS, QUINTIC.instances()


def test_twenty_problems_of_seven_segments_and_six_joints() -> None:
    assert len(INSTANCES) == 20
    again = QUINTIC.instances()
    assert len({p.name for p in INSTANCES}) == 20
    _, limits, _, _ = load_case("z1-woa-bspline").statement("b-spline", "v-deg-a-deg").data()
    for k, (problem, same) in enumerate(zip(INSTANCES, again, strict=True)):
        np.testing.assert_array_equal(problem.waypoints, same.waypoints)
        assert problem.curve == quintic_spline(7)
        np.testing.assert_allclose(
            problem.limits.derivatives[:, :2], limits.derivatives[:, :2], rtol=1e-15
        )
        assert not np.isfinite(problem.limits.jerk).any()
        steps = np.abs(np.diff(problem.waypoints, axis=0))
        assert steps.shape == (7, 6)
        assert 0.9 * STEPS[k // 5] < steps.max() <= STEPS[k // 5]


def page() -> dict[str, list[str]]:
    """Rows of the page's table by the name of the problem."""
    text = (ROOT / "docs" / "reference" / "interpolants.md").read_text()
    lines = [line.strip("|").split("|") for line in text.splitlines() if line.startswith("| step")]
    return {cells[0].strip(): [cell.strip() for cell in cells[1:]] for cells in lines}


def test_the_page_lists_every_problem_and_its_totals_are_not_below_what_a_bound_allows() -> None:
    rows = page()
    assert list(rows) == [p.name for p in INSTANCES]
    near, default = [], 0
    for problem in INSTANCES:
        _, best, single, *_, last = rows[problem.name]
        mean_speed = (np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity).max(1)
        assert mean_speed.sum() < float(best) < float(equal_start(problem).sum())
        hits, count = map(int, single.split(" of "))
        assert count == 20
        near.append(hits)
        default += last == "yes"
    assert np.median(near) >= 15
    assert default >= 19


def found_from(problem: Problem, count: int, seed: int) -> tuple[float, np.ndarray, int]:
    """Total of the default call, totals of single starts, and neighbours that are shorter."""
    usual = solve(problem)
    assert usual.status is Status.OPTIMAL
    quantities, best, *_ = page()[problem.name]
    assert usual.total_time == pytest.approx(float(best), abs=6e-7)
    assert sorted({a.quantity for a in usual.active}) == quantities.split(", ")
    assert usual.check.verdict is Verdict.PASS
    starts = random_starts(problem, count, np.random.default_rng(seed))
    totals = np.array([solve(problem, initial=start).total_time for start in starts])
    rng = np.random.default_rng(seed)
    widths = np.geomspace(1e-4, 1.0, 6000)[:, None]
    near = usual.durations * np.exp(widths * rng.standard_normal((6000, 7)))
    repaired = near.sum(axis=1) * evaluate(problem, near).stretch
    return usual.total_time, totals, int((repaired < usual.total_time * (1 - 1e-9)).sum())


def test_single_starts_and_the_default_reach_the_same_total() -> None:
    usual, totals, shorter = found_from(INSTANCES[15], 4, 8)
    assert (totals <= usual * (1 + 1e-6)).all()
    assert usual <= totals.min() * (1 + 1e-6)
    assert shorter == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", [3, 11, 19])
def test_of_20_starts_at_least_15_reach_the_best(number: int) -> None:
    usual, totals, shorter = found_from(INSTANCES[number], 20, 9)
    best = min(usual, totals.min())
    assert (totals <= best * (1 + 1e-6)).sum() >= 15
    assert usual <= best * (1 + 1e-6)
    assert shorter == 0


def repaired(problem: Problem, start: np.ndarray) -> float:
    return float(start.sum() * evaluate(problem, start[None]).stretch[0])


@pytest.mark.parametrize("number", [0, 7, 14])
def test_a_settled_start_is_shorter_tight_and_always_the_same(number: int) -> None:
    problem = INSTANCES[number]
    for start in random_starts(problem, 5, np.random.default_rng(number)):
        near = settled(problem, start)
        assert near.sum() < repaired(problem, start)
        assert evaluate(problem, near[None]).stretch[0] == pytest.approx(1.0, rel=1e-9)
        np.testing.assert_array_equal(settled(problem, start), near)


def test_a_settled_start_keeps_the_bounds() -> None:
    base = equal_start(INSTANCES[4])
    low, high = 0.7 * base, 1.6 * base
    problem = replace(INSTANCES[4], duration_lower=low, duration_upper=high)
    for start in random_starts(problem, 3, np.random.default_rng(1)):
        near = settled(problem, start)
        assert (low <= near).all()
        assert (near <= high).all()


def test_starts_that_trials_cannot_settle_stay_as_they_are() -> None:
    many = SETTLED_SEGMENTS + 1
    q = np.cumsum(np.random.default_rng(2).uniform(-1, 1, (many + 1, 2)), axis=0)
    large = Problem(q, Limits(1.0, 2.0), cubic_spline(many))
    free = Problem(q[:4], Limits(1.0, 2.0), piecewise((5, 5, 5), 2))
    single = Problem(q[:2], Limits(1.0, 2.0), cubic_spline(1))
    for problem in (large, free, single):
        start = np.linspace(0.5, 1.5, problem.segments)
        np.testing.assert_array_equal(settled(problem, start), start)
