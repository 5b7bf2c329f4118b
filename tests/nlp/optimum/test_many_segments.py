"""Many segments: the sparse search beside the tracked NLP, identities, every status."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.samples import long_curves, long_problem
from trajgap.nlp import Solution, Status
from trajgap.nlp.optimum import rounds, solve, solver
from trajgap.nlp.optimum.closed_forms import CUT_SHORT
from trajgap.nlp.optimum.pieces import Rows
from trajgap.nlp.optimum.program import Program
from trajgap.nlp.optimum.rounds import beside, carried, near_rows, program_search
from trajgap.nlp.optimum.starts import way_start
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    extrema,
    fit,
    quintic_spline,
)
from trajgap.problem.checks import worst_ratios

SEGMENTS = 26


CURVES = long_curves(SEGMENTS)


@cache
def solved(name: str) -> Solution:
    return solve(long_problem(CURVES[name]))


@pytest.mark.parametrize("sparsely", [True, False])
@pytest.mark.parametrize("shift", [5.0, -0.5])
def test_sensitivities_of_position_limits_are_differences_of_totals(
    monkeypatch: pytest.MonkeyPatch, shift: float, sparsely: bool
) -> None:
    if sparsely:
        monkeypatch.setattr(solver, "SPARSE", 9)
    q = np.array([[0.0], [1.0], [0.95], [0.2], [0.25], [1.0], [0.9], [0.0], [0.1], [0.7]]) + shift
    low, high = np.array([shift - 0.003]), np.array([shift + 1.003])
    limits = Limits(3.0, 5.0, position_lower=low, position_upper=high)
    problem = Problem(q, limits, cubic_spline(9))
    answer = solve(problem)
    assert answer.status is Status.CONVERGED
    step = 1e-5
    for changed, edge in (
        (limits.with_positions(low, high + step * np.abs(high)), shift + 1.003),
        (limits.with_positions(low - step * np.abs(low), high), shift - 0.003),
    ):
        wider = solve(Problem(q, changed, problem.curve)).total_time
        trajectory = fit(problem.curve, q, np.asarray(answer.durations))
        found = [
            a.sensitivity
            for a in answer.active
            if a.quantity == "position" and abs(trajectory(np.array([a.time]))[0, 0] - edge) < 1e-5
        ]
        assert sum(found) == pytest.approx(0.1 * (wider - answer.total_time) / step, rel=1e-2)


def one_joint(curve: Interpolant, seed: int) -> Problem:
    """Way-points of a random walk of uneven limits: here and there it runs at its velocity limit.

    Over two or three segments the velocity is all but constant there: its extremum is anywhere.
    """
    rng = np.random.default_rng(seed)
    q = np.cumsum(rng.uniform(-1, 1, (curve.segments + 1, 1)), axis=0)
    limits = [np.exp(rng.uniform(*np.log(pair), 1)) for pair in ((0.5, 3), (1, 10), (5, 80))]
    return Problem(q, Limits(*limits), curve)


PLATEAUS = [
    pytest.param(cubic_spline(60), 0, id="60 cubic segments"),
    pytest.param(cubic_spline(190), 2, id="190 cubic segments"),
    pytest.param(cubic_spline(199), 0, id="199 cubic segments"),
    pytest.param(cubic_spline(250), 1, id="250 cubic segments"),
    pytest.param(quintic_spline(40), 0, id="40 quintic segments"),
]


@pytest.mark.parametrize(("curve", "seed"), PLATEAUS)
def test_a_plateau_at_the_velocity_limit_ends_no_search(curve: Interpolant, seed: int) -> None:
    problem = one_joint(curve, seed)
    answer = program_search(problem, way_start(problem), np.full(curve.segments, 1e-5))
    assert answer.report.residual <= 1e-8
    assert check(problem, answer.durations).verdict is Verdict.PASS
    mirrored = Problem(problem.waypoints[::-1], problem.limits, curve)
    total = solve(mirrored).total_time
    assert total == pytest.approx(float(answer.durations.sum()), rel=1e-7)


def test_bounds_on_durations_and_positions_are_kept_and_priced() -> None:
    curve, free = CURVES["cubic"], solved("cubic")
    assert free.found
    trajectory = fit(curve, long_problem(curve).waypoints, free.durations)
    top = max(extrema(trajectory, 1, 0), key=lambda e: e.value)
    highest = float(long_problem(curve).waypoints[:, 1].max())
    edge = max(top.value - 1e-3, highest + 1e-4)
    limits = Limits([1.5, 3.0], [6.0, 15.0], [np.inf, 90.0], -np.inf, [np.inf, edge])
    lower = np.zeros(SEGMENTS)
    lower[7] = 1.3 * free.durations[7]
    problem = long_problem(curve, limits=limits, duration_lower=lower)
    answer = solve(problem)
    assert answer.status is Status.CONVERGED
    assert answer.found
    assert answer.check.verdict is Verdict.PASS
    assert answer.total_time > free.total_time
    walls = [a for a in answer.active if a.quantity == "duration"]
    assert [a.segment for a in walls] == [7]
    longer = lower.copy()
    longer[7] *= 1.0001
    more = solve(long_problem(curve, limits=limits, duration_lower=longer))
    slope = (more.total_time - answer.total_time) / np.log(1.0001)
    assert walls[0].multiplier == pytest.approx(slope, rel=1e-3)


def test_a_known_motion_is_never_lost() -> None:
    problem, answer = long_problem(CURVES["cubic"]), solved("cubic")
    slow = solve(problem, known=answer.durations[None] * 1.01)
    assert slow.total_time == pytest.approx(answer.total_time, rel=1e-9)
    stopped = solve(problem, known=answer.durations[None], seconds=0.0)
    assert stopped.total_time <= answer.total_time * (1 + 1e-9)


def test_out_of_time_the_best_motion_so_far_is_the_answer() -> None:
    problem = long_problem(CURVES["quintic"])
    answer = solve(problem, seconds=0.0)
    assert answer.status is Status.FEASIBLE
    assert answer.check.verdict is Verdict.PASS
    ended = "the search ended before it met the conditions of an optimum"
    assert answer.why == f"{ended}; {CUT_SHORT}"


def test_a_failed_round_begins_again_from_the_best_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, total = long_problem(CURVES["cubic"]), solved("cubic").total_time
    round_ = rounds.solve_round
    calls: list[tuple[float, float]] = []

    def failing(
        program: Program, rows: Rows, state: object, stage: tuple[float, float], within: object
    ) -> tuple[bool, int, float]:
        success, count, seconds = round_(program, rows, state, stage, within)  # type: ignore[arg-type]
        calls.append(stage)
        return success and len(calls) != 2, count, seconds

    monkeypatch.setattr(rounds, "solve_round", failing)
    again = solve(problem)
    assert calls[:4] == [*rounds.STAGES[:2]] * 2
    assert again.status is Status.CONVERGED
    # From another start it may end at a neighbouring optimum: these two are 1.6e-7 apart.
    assert again.total_time == pytest.approx(total, rel=1e-6)


def rows(*places: tuple[int, int, int, float, float]) -> Rows:
    return Rows(np.column_stack([np.array(places).reshape(-1, 5), np.full(len(places), 0.5)]))


def test_multipliers_go_to_the_rows_that_continue_theirs() -> None:
    before = rows((0, 3, 1, 0.2, 1.0), (0, 3, 1, 0.8, 1.0), (1, 3, 1, 0.5, 1.0), (0, 4, 2, 0.9, -1))
    duals = np.array([1.0, 2.0, 3.0, 4.0])
    after = rows(
        (0, 3, 1, 0.75, 1.0), (0, 3, 1, 0.15, 1.0), (0, 3, 1, 0.75, -1.0), (1, 3, 2, 0.5, 1.0),
        (0, 4, 2, 0.1, -1), (0, 5, 2, 0.9, -1), (1, 3, 1, 0.51, 1.0), (0, 3, 1, 0.95, 1.0),
    )  # fmt: skip
    assert carried(before, duals, after).tolist() == [2.0, 1.0, 0.0, 0.0, 4.0, 0.0, 3.0, 0.0]
    # One that took two places hands on what both had.
    assert carried(before, duals, rows((0, 3, 1, 0.6, 1.0))).tolist() == [3.0]
    assert carried(rows(), np.zeros(0), after).tolist() == [0.0] * 8
    assert carried(before, duals, rows()).size == 0


def test_a_row_stays_until_an_extremum_is_beside_it() -> None:
    before = rows((0, 1, 1, 0.2, 1.0), (0, 3, 1, 0.2, 1.0), (0, 4, 1, 0.2, 1.0), (0, 5, 1, 0.2, -1))
    now = rows((0, 0, 1, 0.9, 1.0), (0, 3, 1, 0.21, 1.0), (0, 4, 1, 0.7, 1.0), (0, 5, 1, 0.2, 1.0))
    found = beside(now, before)
    assert found.table[:4].tolist() == now.table.tolist()
    assert found.table[4:, [1, 3, 4]].tolist() == [[1, 0.2, 1], [4, 0.2, 1], [5, 0.2, -1]]
    assert not found.weight[4:].any()
    assert beside(rows(), before).sign.size == 4


def test_the_excess_is_that_of_the_batch_evaluator() -> None:
    for name, curve in CURVES.items():
        problem = long_problem(curve)
        h = way_start(problem) * np.random.default_rng(2).uniform(0.5, 1.1, SEGMENTS)
        stretch = float(evaluate(problem, h[None]).stretch[0])
        worst = worst_ratios(problem, fit(curve, problem.waypoints, h)).max()
        assert worst == pytest.approx(stretch, rel=1e-9), name
        # No stretch repairs what exceeds a side of 0: as if nothing limited it.
        found = []
        for side in (0.0, np.inf):
            sides = np.array(problem.limits.sides)
            sides[0, 0, 1] = side
            one = replace(problem, limits=problem.limits.with_sides(sides))
            found.append(worst_ratios(one, fit(curve, problem.waypoints, h)).tolist())
        assert found[0] == found[1], name
    program = Program(problem, 1.0, np.zeros(SEGMENTS))
    assert near_rows(program, fit(problem.curve, problem.waypoints, h), 0.0).sign.size > 10
