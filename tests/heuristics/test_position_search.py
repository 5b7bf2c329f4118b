"""Searches under position limits: judged between way-points too, not repaired by a stretch."""

from dataclasses import replace

import numpy as np
import pytest
from support.positions import CURVES, SWINGING, limited
from support.uneven import CURVES as UNEVEN
from support.uneven import uneven_problem
from trajgap.heuristics import (
    PSO,
    DeathPenalty,
    Run,
    Stretch,
    find_optimizer,
    run,
    run_within,
    search_box,
    uniform_rescaling,
)
from trajgap.heuristics.repair import compile_judge
from trajgap.nlp import Status, solve
from trajgap.problem import (
    Array,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    evaluate,
)
from trajgap.problem.curves import kernel

SWARM = PSO(particles=20, iterations=60, position_initial=(0.2, 4.0))


def drawn(problem: Problem, count: int) -> Array:
    return np.random.default_rng(5).uniform(0.3, 4.0, (count, problem.segments))


QUESTIONS = {name: limited(curve, 0.1) for name, curve in CURVES.items()} | {
    f"{curve}, sides that differ": replace(uneven_problem(curve), duration_upper=np.full(3, 5.0))
    for curve in UNEVEN
}


@pytest.mark.parametrize("name", QUESTIONS)
@pytest.mark.parametrize("penalty", [np.inf, 1e6])
def test_the_penalty_falls_where_the_checker_finds_a_violation(name: str, penalty: float) -> None:
    problem = QUESTIONS[name]
    h = drawn(problem, 24)
    fitness = DeathPenalty(problem, penalty)(h)
    kept = [check(problem, one).limits is Verdict.PASS for one in h]
    np.testing.assert_array_equal(fitness, np.where(kept, h.sum(axis=1), penalty))
    assert name in CURVES or 0 < sum(kept) < len(h)


@pytest.mark.parametrize("shorten", [False, True])
def test_a_stretch_repairs_what_the_checker_says_it_does(shorten: bool) -> None:
    problem = replace(SWINGING, duration_lower=0.0, duration_upper=np.inf)
    h = 0.3 * drawn(problem, 60)
    judge = Stretch(problem, shorten=shorten)
    found = [check(problem, one) for one in h]
    times = [f.tight_time if shorten else f.feasible_time for f in found]
    fitness = judge(h)
    np.testing.assert_allclose(fitness, [np.inf if t is None else t for t in times], rtol=1e-12)
    beyond = np.isinf(fitness)
    assert 5 <= (~beyond).sum() <= 55
    np.testing.assert_array_equal(judge.decode(h)[beyond], h[beyond])
    for one in judge.decode(h)[~beyond]:
        assert check(problem, one).verdict is Verdict.PASS


def test_where_no_motion_stays_within_nothing_is_feasible() -> None:
    """A way-point beyond its limit: `solve` proves that there is none."""
    limits = SWINGING.limits.with_positions([-np.inf] * 2, [0.5, np.inf])
    problem = replace(SWINGING, limits=limits)
    assert solve(problem).status is Status.INFEASIBLE
    for handling in ("death-penalty", "stretch", "rescale"):
        found: Run = run(SWARM, problem, 2, 10, handling)
        assert not found.feasible
        assert found.reported_time == np.inf
        np.testing.assert_array_equal(found.durations, found.position)


def test_equal_durations_that_swing_too_far_are_no_baseline() -> None:
    tight = limited(cubic_spline(3), 0.001)
    assert (evaluate(tight, np.ones((1, 3))).positions[0] > 1).any()
    with pytest.raises(
        TrajgapError, match=r"equal durations lead joint \d beyond a position limit; no uniform"
    ):
        uniform_rescaling(tight)
    with pytest.raises(
        TrajgapError, match=r"no upper bound .* beyond a position limit; .*; give them one"
    ):
        search_box(replace(tight, duration_upper=np.inf))
    np.testing.assert_array_equal(search_box(tight).upper, [6.0, 6.0, 6.0])
    one = run_within(find_optimizer("rescale"), tight, 0, 100)
    assert one.reported_time == np.inf


def test_processes_find_every_kernel_compiled() -> None:
    """Ones break a limit of velocity here: a penalty alone would not look at positions."""
    problem = limited(cubic_spline(3), 0.3, Limits(0.1, joints=3))
    compile_judge(problem)
    before = list(kernel.batch_peaks.signatures)
    assert before
    DeathPenalty(problem)(np.ones((2, 3)))
    _ = evaluate(problem, np.ones((2, 3))).positions
    assert kernel.batch_peaks.signatures == before
