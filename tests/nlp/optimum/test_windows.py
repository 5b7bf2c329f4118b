"""Windows of long problems: the same program in parts, the same optimum when joined."""

import itertools
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from support.long_problems import LIMITS, long_curves, long_problem
from trajgap.nlp import Status
from trajgap.nlp.optimum import search as search_module
from trajgap.nlp.optimum import solve, windows
from trajgap.nlp.optimum.limit_rows import Rows
from trajgap.nlp.optimum.program import Program
from trajgap.nlp.optimum.rows import carried, near_rows, with_loaded
from trajgap.nlp.optimum.search import program_search
from trajgap.nlp.optimum.starts import way_start, worst_ratios
from trajgap.nlp.optimum.windows import Joined, joined_windows, spans
from trajgap.problem import (
    Interpolant,
    Problem,
    check,
    cubic_spline_virtual,
    evaluate,
    fit,
)
from trajgap.problem.curves import Places, Trajectory

SEGMENTS = 40
CURVES = long_curves(SEGMENTS)


def problem_of(curve: Interpolant) -> Problem:
    return long_problem(curve, 11, LIMITS.with_positions(-30.0, [20.0, np.inf]))


@pytest.fixture
def small_windows(monkeypatch: pytest.MonkeyPatch) -> list[Joined | None]:
    """Windows of some 13 segments, and what they leave."""
    monkeypatch.setattr(search_module, "FEWEST", SEGMENTS)
    monkeypatch.setattr(windows, "WIDTH", 13)
    monkeypatch.setattr(windows, "OVERLAP", 4)
    seen: list[Joined | None] = []

    def watched(program: Program, trajectory: Trajectory, floor: np.ndarray) -> Joined | None:
        seen.append(joined_windows(program, trajectory, floor))
        return seen[-1]

    monkeypatch.setattr(search_module, "joined_windows", watched)
    return seen


@pytest.mark.parametrize("name", CURVES)
def test_joined_windows_end_at_the_optimum_of_the_whole(
    name: str, small_windows: list[Joined | None]
) -> None:
    problem = problem_of(CURVES[name])
    answer = solve(problem)
    assert [joined is None for joined in small_windows] == [False]
    floor = np.full(problem.segments, 1e-4)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search_module, "FEWEST", SEGMENTS + 1)
        whole = program_search(problem, way_start(problem), floor)
    assert len(small_windows) == 1
    assert answer.status is Status.CONVERGED
    assert answer.kkt_residual <= 1e-8
    assert answer.total_time == pytest.approx(float(whole.durations.sum()), rel=1e-8)
    (joined, *_) = small_windows
    h = joined.state.x[: problem.segments] * float(way_start(problem).mean())
    assert h.sum() == pytest.approx(answer.total_time, rel=0.01)
    assert check(problem, h).stretch < 1.3
    assert joined.duals.size == joined.rows.sign.size
    assert (joined.duals * joined.rows.sign >= -1e-6).all()


@pytest.mark.parametrize("name", CURVES)
def test_a_window_is_a_part_of_the_whole_program(name: str) -> None:
    problem = problem_of(CURVES[name])
    h = way_start(problem) * np.random.default_rng(1).uniform(0.8, 1.3, SEGMENTS)
    motion, unit, floor = fit(problem.curve, problem.waypoints, h), float(h.mean()), np.zeros(40)
    whole = Program(problem, unit, floor)
    x, labels = whole.pack(motion, h), whole.labels()
    assert all(np.unique(some).size == some.size for some in labels)
    assert labels[1].size == whole.equalities.numel()
    for span in ((0, 15), (11, 29), (26, SEGMENTS)):
        own = slice(*span)
        part = Program(problem, unit, floor, span, motion)
        cut = Trajectory(h[own], motion.scaled[own], motion.degrees[own])
        mine = part.pack(cut, cut.durations)
        numbers = dict(zip(labels[0].tolist(), x.tolist(), strict=True))
        assert [numbers[at] for at in part.labels()[0].tolist()] == mine.tolist()
        assert np.isin(part.labels()[1], labels[1]).mean() > 0.8
        back = part.trajectory(mine)
        np.testing.assert_allclose(back.durations, cut.durations, rtol=1e-14)
        width = back.scaled.shape[1]
        np.testing.assert_allclose(back.scaled, cut.scaled[:, :width], rtol=1e-12, atol=1e-13)
        ends = part.at_places(part.ends, np.zeros(part.ends.s.size))
        equal, last = ca.Function("f", [part.variables], [part.equalities, ends])(mine)
        np.testing.assert_allclose(np.asarray(equal), 0.0, atol=1e-9)
        low, high = part.bounds()
        assert (low <= high).all()
        # What a cut gives is what the motion has there.
        given = low == high
        np.testing.assert_allclose(mine[given], low[given], rtol=1e-9, atol=1e-9)
        assert last.numel() >= (2 if span[1] < SEGMENTS and name != "quintic" else 0)


def test_windows_cover_all_segments_and_end_at_waypoints() -> None:
    problem = problem_of(cubic_spline_virtual(SEGMENTS - 1))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(windows, "WIDTH", 9)
        patch.setattr(windows, "OVERLAP", 3)
        found = list(spans(problem))
    assert len(found) > 3
    owns = [own for _, own in found]
    assert owns[0][0] == 0
    assert owns[-1][1] == problem.segments
    assert all(a[1] == b[0] for a, b in itertools.pairwise(owns))
    breaks = set(problem.curve.waypoint_breaks)
    for span, own in found:
        assert {*span, *own} <= breaks
        assert span[0] <= own[0] < own[1] <= span[1]
        assert span[1] - own[1] in ({0} if own[1] == problem.segments else {2, 3, 4})


def test_a_window_that_fails_begins_slower_and_then_the_whole_is_searched(
    small_windows: list[Joined | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = problem_of(CURVES["cubic"])
    total = solve(problem).total_time
    solved, tried = windows._solved, []

    def failing(limit: int) -> None:
        tried.clear()

        def some(part: Program, state: object, own: slice) -> object:
            tried.append(float(state.x[: part.segments].sum()))  # type: ignore[attr-defined]
            ended = solved(part, state, own)  # type: ignore[arg-type]
            return replace(ended, success=len(tried) > limit)

        monkeypatch.setattr(windows, "_solved", some)

    failing(1)
    assert solve(problem).total_time == pytest.approx(total, rel=1e-8)
    assert tried[1] == pytest.approx(1.2 * tried[0], rel=1e-9)
    assert len(tried) == 4
    assert small_windows[-1] is not None
    failing(9)
    assert solve(problem).total_time == pytest.approx(total, rel=1e-6)
    assert len(tried) == 3
    assert small_windows[-1] is None


def test_time_that_ends_between_windows_and_after_them(
    small_windows: list[Joined | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = problem_of(CURVES["quintic"])
    start, floor = way_start(problem), np.full(SEGMENTS, 1e-4)
    with monkeypatch.context() as early:
        early.setattr(windows, "time_up", lambda: True)
        assert program_search(problem, start, floor) is not None
    assert small_windows == [None]
    monkeypatch.setattr(search_module, "time_up", lambda: True)
    late = program_search(problem, start, floor)
    assert small_windows[-1] is not None
    assert late.report is None
    assert check(problem, late.durations).max_violation <= 1e-9


def test_multipliers_go_to_the_rows_that_continue_theirs() -> None:
    def rows(*places: tuple[int, int, int, float, float]) -> Rows:
        j, k, r, s, sign = (np.array(column) for column in zip(*places, strict=True))
        return Rows(Places(j, k, r, s), sign, np.zeros(len(places)))

    before = rows((0, 3, 1, 0.2, 1.0), (0, 3, 1, 0.8, 1.0), (1, 3, 1, 0.5, 1.0), (0, 4, 2, 0.9, -1))
    duals = np.array([1.0, 2.0, 3.0, 4.0])
    after = rows(
        (0, 3, 1, 0.75, 1.0), (0, 3, 1, 0.95, 1.0), (0, 3, 1, 0.75, -1.0), (1, 3, 2, 0.5, 1.0),
        (0, 4, 2, 0.1, -1), (0, 5, 2, 0.9, -1), (1, 3, 1, 0.51, 1.0),
    )  # fmt: skip
    assert carried(before, duals, after).tolist() == [2.0, 0.0, 0.0, 0.0, 4.0, 0.0, 3.0]
    none = rows((0, 0, 1, 0.5, 1.0))
    none = replace(none, sign=none.sign[:0], places=Places(*(np.zeros(0, int),) * 3, np.zeros(0)))
    assert carried(none, np.zeros(0), after).tolist() == [0.0] * 7
    assert carried(before, duals, none).size == 0


def test_a_row_with_a_multiplier_stays_until_an_extremum_is_beside_it() -> None:
    problem = problem_of(CURVES["cubic"])
    program = Program(problem, 1.0, np.zeros(SEGMENTS))

    def rows(*places: tuple[int, int, float, float]) -> Rows:
        k, r, s, sign = (np.array(column) for column in zip(*places, strict=True))
        return Rows(Places(np.zeros_like(k), k, r, s), sign, np.full(len(places), 0.5))

    before = rows((1, 1, 0.2, 1.0), (3, 1, 0.2, 1.0), (4, 1, 0.2, 1.0), (5, 1, 0.2, -1.0))
    now = rows((0, 1, 0.9, 1.0), (3, 1, 0.21, 1.0), (4, 1, 0.7, 1.0), (5, 1, 0.2, 1.0))
    duals = np.array([2e-3, 2e-3, 2e-3, -2e-3])
    found = with_loaded(program, before, duals, now, 1e-3)
    rows_found = zip(found.places.segment, found.places.s, found.sign, found.weight, strict=True)
    assert sorted(tuple(map(float, one)) for one in rows_found) == [
        (0, 0.9, 1, 0.5), (1, 0.2, 1, 0), (3, 0.21, 1, 0.5), (4, 0.2, 1, 0), (4, 0.7, 1, 0.5),
        (5, 0.2, -1, 0), (5, 0.2, 1, 0.5),
    ]  # fmt: skip
    assert with_loaded(program, before, duals, now, 1e-2) is now


def test_the_excess_is_that_of_the_batch_evaluator() -> None:
    for name, curve in CURVES.items():
        problem = problem_of(curve)
        h = way_start(problem) * np.random.default_rng(2).uniform(0.5, 1.1, SEGMENTS)
        stretch = float(evaluate(problem, h[None]).stretch[0])
        worst = worst_ratios(problem, fit(curve, problem.waypoints, h)).max()
        assert worst == pytest.approx(stretch, rel=1e-9), name
    program = Program(problem, 1.0, np.zeros(SEGMENTS))
    assert near_rows(program, fit(problem.curve, problem.waypoints, h), 0.0).sign.size > 10
