"""Objectives: the death penalty and the repair by stretch, judged by the checker at every edge."""

from dataclasses import replace

import numpy as np
import pytest
from support.positions import CURVES, SWINGING, limited
from support.two_joints import WAYPOINTS, WITH_JERK, two_joints
from support.uneven import CURVES as UNEVEN, uneven_problem
from trajgap.heuristics import (
    PSO,
    Counted,
    DeathPenalty,
    Stretch,
    find_optimizer,
    run,
    run_per_joint,
    run_within,
    search_box,
    uniform_rescaling,
)
from trajgap.heuristics.repair import compile_judge, judge_of
from trajgap.nlp import Status, solve
from trajgap.problem import Array, Limits, Problem, TrajgapError, Verdict, check, curves, evaluate
from trajgap.problem.checks.checker import TOLERANCE
from trajgap.problem.curves import kernel


def problem_with(**changes: object) -> Problem:
    bounds = {"duration_lower": [0.2, 0.3, 0.1], "duration_upper": [2.0, 3.0, 2.5]}
    return two_joints(**{"limits": WITH_JERK, **bounds, **changes})


def wide(**changes: object) -> Problem:
    return problem_with(**{"duration_lower": 0.1, "duration_upper": 9.0, **changes})


def test_an_answer_at_the_edge_of_the_tolerance_passes_the_checker() -> None:
    problem = problem_with(limits=Limits(5.0, 8.0, joints=2))
    h = np.array([[0.9, 1.2, 0.7]])
    tight = h * evaluate(problem, h).stretch[0]
    # Acceleration scales with the inverse square: half of the tolerance is a quarter in time.
    at_edge = tight * (1 - TOLERANCE / 4 * (1 - 1e-4))
    assert np.isfinite(DeathPenalty(problem)(at_edge)[0])
    assert check(problem, at_edge[0]).verdict == "pass"
    assert DeathPenalty(problem)(tight * (1 - TOLERANCE))[0] == np.inf


@pytest.mark.parametrize("penalty", [np.inf, 1e6])
@pytest.mark.parametrize(
    ("judge", "durations"),
    [
        *((DeathPenalty, h) for h in ([0.19, 1.5, 1.5], [1.5, 0.29, 1.5], [1.5, 1.5, 2.51])),
        # No stretch mends these: less than the least, or more than the most, in another segment.
        *((Stretch, h) for h in ([1.5, 9.01, 1.5], [0.05, 1.5, 1.5], [1e-3, 1e-3, 0.5])),
        *(
            (judge, h)
            for judge in (DeathPenalty, Stretch)
            for h in ([0.0, 1.5, 1.5], [-1.5, 1.5, 1.5], [np.nan, 1.5, 1.5], [1.5, np.inf, 1.5])
        ),
    ],
)
def test_out_of_bounds_is_infeasible(judge: type, durations: list[float], penalty: float) -> None:
    objective = judge((problem_with if judge is DeathPenalty else wide)(), penalty)
    batch = np.array([durations, [1.9, 1.9, 1.9]])
    np.testing.assert_array_equal(objective(batch), [penalty, 1.9 + 1.9 + 1.9])
    np.testing.assert_array_equal(objective.decode(batch), batch)


@pytest.mark.parametrize("judge", [DeathPenalty, Stretch])
def test_limits_and_bounds_themselves_are_within(judge: type) -> None:
    problem = problem_with(duration_lower=[1.5, 1.5, 1.5], duration_upper=[1.5, 2.0, 2.5])
    batch = np.array([[1.5, 1.5, 1.5], [1.5, 2.0, 2.5]])
    np.testing.assert_array_equal(judge(problem)(batch), [4.5, 6.0])
    # They keep the limits too, and no stretch makes up for what the bounds ask.
    np.testing.assert_array_equal(judge(problem)(batch - [0.0, 0.0, 1.01]), [np.inf, np.inf])
    # From rest to rest no position lies beyond those of the way-points.
    q = WAYPOINTS
    ranged = WITH_JERK.with_positions(q.min(axis=0), q.max(axis=0))
    problem = wide(curve=curves.rest_to_rest(3, 5), limits=ranged)
    np.testing.assert_array_equal(judge(problem)(np.full((1, 3), 2.5)), [7.5])


def test_zero_is_no_duration() -> None:
    still = Problem(np.zeros((4, 1)), Limits(1.0), curves.three_five_three())
    batch = np.array([[0.0, 1.0, 1.0], [1e-3, 1.0, 1.0]])
    np.testing.assert_array_equal(DeathPenalty(still)(batch), [np.inf, 2.001])


@pytest.mark.parametrize("judge", [DeathPenalty, Stretch])
@pytest.mark.parametrize(
    ("penalty", "said"),
    [
        *((bad, r"penalty: must be positive, got .*inf is allowed") for bad in (0.0, -1.0, np.nan)),
        (7.5, r"penalty: 7.5 does not exceed .* of 7.5 s; raise it"),
    ],
)
def test_a_penalty_is_above_every_admissible_total(judge: type, penalty: float, said: str) -> None:
    with pytest.raises(TrajgapError, match=said):
        judge(problem_with(), penalty)
    judge(problem_with(), 7.6)
    judge(problem_with(duration_upper=0.3), 0.95)  # 3 · 0.3 s at most
    free = curves.piecewise((5, 5, 5), 2, ((1, 0.0), (2, 0.0)))
    with pytest.raises(TrajgapError, match=r"leaves 4 derivatives per joint free.*prescribe them"):
        judge(problem_with(curve=free))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([1.0], r"expected 2 values .* got shape \(1,\)"),
        ([[1.0], [2.0]], r"expected 2 values .* got shape \(2, 1\)"),
        ([1.0, np.nan], "returned NaN; return inf for infeasible positions"),
    ],
)
def test_an_objective_returns_one_number_each(values: list[object], said: str) -> None:
    counted = Counted(lambda _: np.array(values))
    with pytest.raises(TrajgapError, match=said):
        counted(np.ones((2, 3)))


def test_fixed_ratios_leave_nothing_to_search() -> None:
    problem = Problem([[0.0], [0.5], [1.5]], Limits(1.0), curves.cubic_spline(2), ratios="equal")
    said = "ratios: the durations have fixed ratios, so the total is the only unknown"
    for refused in (
        lambda: DeathPenalty(problem),
        lambda: Stretch(problem),
        lambda: run(PSO(), problem, seed=1),
        lambda: run_per_joint(PSO(), problem, seed=1),
    ):
        with pytest.raises(TrajgapError, match=said):
            refused()
    with pytest.raises(TrajgapError, match="uniform rescaling: the durations have fixed ratios"):
        uniform_rescaling(problem)


@pytest.mark.parametrize("shorten", [False, True])
@pytest.mark.parametrize("problem", [wide(), SWINGING], ids=["jerk", "position"])
def test_fitness_is_what_the_checker_calls_feasible_and_tight_time(
    problem: Problem, shorten: bool
) -> None:
    """Where a joint swings beyond a position limit, no stretch repairs it."""
    problem = replace(problem, duration_lower=0.0, duration_upper=np.inf)
    rng = np.random.default_rng(5)
    h = rng.uniform(0.5, 1.5, (60, 3)) * np.exp(rng.uniform(-1.0, 2.0, (60, 1)))
    judge, penal = Stretch(problem, shorten=shorten), DeathPenalty(problem)(h)
    found = [check(problem, one) for one in h]
    times = [f.tight_time if shorten else f.feasible_time for f in found]
    fitness, decoded = judge(h), judge.decode(h)
    np.testing.assert_allclose(fitness, [np.inf if t is None else t for t in times], rtol=1e-12)
    kept = np.array([f.verdict is Verdict.PASS for f in found])
    assert 5 < kept.sum() < 55
    np.testing.assert_array_equal(np.isfinite(penal), kept)
    beyond = np.isinf(fitness)
    assert (5 <= beyond.sum() <= 55) == problem.limits.limits_position
    # What keeps the limits, and what nothing mends, is not touched.
    alone = beyond if shorten else beyond | kept
    np.testing.assert_array_equal(decoded[alone], h[alone])
    np.testing.assert_array_equal(fitness[alone], penal[alone])
    for one in decoded[~alone]:
        after = check(problem, one)
        assert after.verdict is Verdict.PASS
        assert after.worst is not None
        assert after.worst.ratio == pytest.approx(1.0, abs=1e-12)


def test_a_stretch_may_lift_a_duration_over_its_lower_bound() -> None:
    problem = wide(duration_lower=0.3)
    h = np.array([[0.2, 0.25, 0.2]])
    assert DeathPenalty(problem)(h)[0] == np.inf
    decoded = Stretch(problem).decode(h)
    assert (decoded >= 0.3).all()
    assert Stretch(problem)(h)[0] == decoded.sum()


@pytest.mark.parametrize(("limits", "shorten"), [([5.0, 0.0], False), ([np.inf, np.inf], True)])
def test_what_has_no_scale(limits: list[float], shorten: bool) -> None:
    """A joint that moves with limit 0 has none that is long enough, no limit none that is short."""
    objective = Stretch(wide(limits=Limits(limits), duration_lower=0.0), shorten=shorten)
    assert objective(np.full((1, 3), 1.5))[0] == np.inf


def test_a_prescribed_derivative_cannot_be_stretched() -> None:
    problem = wide(curve=curves.cubic_spline(3, ((1, 0.5),)))
    DeathPenalty(problem)
    with pytest.raises(TrajgapError, match=r"^stretch: a prescribed .* use the death penalty"):
        Stretch(problem)


def test_handlings_by_name() -> None:
    kinds = {name: judge_of(wide(), np.inf, name) for name in ("stretch", "rescale")}
    assert [isinstance(one, Stretch) and one.shorten for one in kinds.values()] == [False, True]
    assert isinstance(judge_of(wide(), np.inf, "death-penalty"), DeathPenalty)
    with pytest.raises(TrajgapError, match=r"^objective: 'streched' is unknown; .*'stretch'"):
        run(PSO(), wide(), 0, 1, objective="streched")


@pytest.mark.parametrize(
    "limits",
    [Limits(3.0, joints=2), Limits([6.0, 5.0], [8.0, 9.0]), Limits(6.0, 8.0, [25.0, 30.0])],
    ids=["v", "va", "vaj"],
)
def test_equal_durations_at_the_limit(limits: Limits) -> None:
    durations = uniform_rescaling(two_joints(limits))
    np.testing.assert_array_equal(durations, durations[0])
    found = check(two_joints(limits), durations)
    assert found.verdict is Verdict.PASS
    assert found.worst is not None
    assert found.worst.ratio == pytest.approx(1.0, abs=1e-12)
    tight = check(two_joints(limits), [0.7, 0.7, 0.7]).tight_time
    assert durations.sum() == pytest.approx(tight, rel=1e-12)


@pytest.mark.parametrize("limits", [Limits(6.0, 8.0, joints=2), Limits(joints=2)])
def test_set_to_lower_bounds(limits: Limits) -> None:
    bounds = np.array([2.0, 2.5, 3.0])
    durations = uniform_rescaling(two_joints(limits, duration_lower=bounds))
    np.testing.assert_array_equal(durations, bounds)


def test_set_to_an_upper_bound_that_costs_nothing() -> None:
    waypoints = np.array([0.4, 0.5, 0.50001, 1.6])
    problem = Problem(waypoints, Limits(1.0), curves.three_five_three())
    equal = uniform_rescaling(problem)
    cap = 0.9 * equal[0]
    capped = Problem(waypoints, Limits(1.0), curves.three_five_three(), 0.0, [cap, 9.0, 9.0])
    np.testing.assert_array_equal(uniform_rescaling(capped), [cap, equal[1], equal[2]])


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (two_joints(Limits(6.0, 8.0, joints=2), duration_upper=0.8), "bounds is violated; no"),
        (two_joints(Limits(6.0, 8.0, position_upper=0.5, joints=2)), "joint 1 beyond a position"),
        (two_joints(Limits([0.0, 3.0])), "a joint with limit 0 moves"),
        (two_joints(Limits(joints=2)), "nothing moves or nothing is limited"),
        (two_joints(curve=curves.cubic_spline(3, ((1, 0.5),))), "a prescribed derivative is not 0"),
    ],
)
def test_what_has_no_uniform_rescaling(problem: Problem, said: str) -> None:
    with pytest.raises(TrajgapError, match=said):
        uniform_rescaling(problem)


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


def test_where_no_motion_stays_within_nothing_is_feasible() -> None:
    """A way-point beyond its limit: `solve` proves that there is none."""
    limits = SWINGING.limits.with_positions([-np.inf] * 2, [0.5, np.inf])
    problem = replace(SWINGING, limits=limits)
    assert solve(problem).status is Status.INFEASIBLE
    for handling in ("death-penalty", "stretch", "rescale"):
        found = run(SWARM, problem, 2, 10, handling)
        assert not found.feasible
        assert found.reported_time == np.inf
        np.testing.assert_array_equal(found.durations, found.position)


def test_equal_durations_that_swing_too_far_are_no_baseline() -> None:
    tight = limited(curves.cubic_spline(3), 0.001)
    with pytest.raises(
        TrajgapError, match=r"no upper bound .* joint \d beyond a position limit, .*; give them"
    ):
        search_box(replace(tight, duration_upper=np.inf))
    np.testing.assert_array_equal(search_box(tight).upper, [6.0, 6.0, 6.0])
    one = run_within(find_optimizer("rescale"), tight, 0, 100)
    assert one.reported_time == np.inf


def test_processes_find_every_kernel_compiled() -> None:
    """Ones break a limit of velocity here: a penalty alone would not look at positions."""
    problem = limited(curves.cubic_spline(3), 0.3, Limits(0.1, joints=3))
    compile_judge(problem)
    before = list(kernel.batch_peaks.signatures)
    assert before
    DeathPenalty(problem)(np.ones((2, 3)))
    _ = evaluate(problem, np.ones((2, 3))).positions
    assert kernel.batch_peaks.signatures == before
