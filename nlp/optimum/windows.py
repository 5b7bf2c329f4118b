"""A start for very many segments from windows: solved one by one, joined with their multipliers.

Segments far apart hardly know of each other. A window takes the iterations that it needs; in one
program of all segments each of them waits for the most irregular one, and where IPOPT fails at one
place, all is lost. The joined motion is no answer: the search begins its last rounds there.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...problem import Array, Problem
from ...problem.curves import Trajectory
from .clock import time_up
from .limit_rows import Rows
from .program import LABELS, Indices, Program
from .rounds import RoundState, fresh, solve_round
from .rows import EVERY, NEAR, carried, near_rows, picked, together
from .starts import worst_ratios

FEWEST = 200
"""Segments from which there are windows: cubics of 200 are as quick in one, quintics take twice as
long."""
WIDTH = 100
"""Segments of a window, about: with 50 all splines take a sixth longer, with 200 quintics do."""
OVERLAP = 10
"""Segments beyond its own that a window has on both sides: of a derivative that is given at the end
of an even spline 2e-6 arrives where its own begin, 2e-4 of a quintic one."""
ROUNDS = 4
"""Most rounds of a window; the later rounds of all segments find what is left."""
ROUGH = 1e-3
"""Excess over a limit at which a window ends. With 1e-2 the rounds of all segments take four times
as many iterations for quintics; with 1e-4 the windows take longer than that saves."""
SHRUNK = 0.3
"""Share of its first duration that a segment keeps at least in the first round: without it a
derivative of a quintic explodes now and then, and IPOPT does not find back."""
SLOWER = (1.0, 1.2, 1.5)
"""Stretches, in turn, of the motion that just keeps its limits in a window: where that begins."""


@dataclass(frozen=True, eq=False)
class Joined:
    """What windows leave: a state of all segments, the rows of all windows and their multipliers.

    Attributes
    ----------
    state : RoundState
    rows : Rows
    duals : ndarray
    iterations : int
    build_seconds : float
    """

    state: RoundState
    rows: Rows
    duals: Array
    iterations: int
    build_seconds: float


@dataclass(frozen=True, eq=False)
class _Ended:
    """The end of one window, with places counted from its first segment."""

    success: bool
    rows: Rows
    duals: Array
    iterations: int
    build_seconds: float


def spans(problem: Problem) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    """Segments of each window, those that it shares with its neighbours included, and its own."""
    breaks = np.array(problem.curve.waypoint_breaks)
    total = problem.segments
    wanted = np.linspace(0, total, max(1, round(total / WIDTH)) + 1)
    for first, last in itertools.pairwise(np.unique(_at_waypoints(breaks, wanted)).tolist()):
        low, high = _at_waypoints(breaks, np.array([first - OVERLAP, last + OVERLAP])).tolist()
        yield (low, high), (first, last)


def _at_waypoints(breaks: Indices, wanted: Array) -> Indices:
    """The breaks with a way-point nearest to some numbers."""
    return np.asarray(breaks[np.abs(breaks - np.asarray(wanted)[:, None]).argmin(axis=1)])


def joined_windows(program: Program, trajectory: Trajectory, floor: Array) -> Joined | None:
    """Windows solved and put together; None where time is up before, or one is not solved.

    Parameters
    ----------
    program : Program
        Of all segments.
    trajectory : Trajectory
        Near which windows start.
    floor : ndarray, shape (segments,)
        Least durations, s.

    Returns
    -------
    Joined or None
    """
    state = fresh(program, program.pack(trajectory, trajectory.durations))
    state.bounds = np.zeros(state.x.size)
    worst = worst_ratios(program.problem, trajectory)
    variables, equalities, right_ends = (
        _Numbered(labels, program.joints) for labels in program.labels()
    )
    found: list[tuple[Rows, Array]] = []
    iterations, build = 0, 0.0
    for span, own in spans(program.problem):
        keeps = max(1.0, float(worst[slice(*span)].max()))
        for more in SLOWER:
            if time_up():
                return None
            began = time.perf_counter()
            slower = replace(trajectory, durations=trajectory.durations * keeps * more)
            part = Program(program.problem, program.unit, floor, span, slower)
            here = fresh(part, part.pack(_cut(slower, span), slower.durations[slice(*span)]))
            build += time.perf_counter() - began
            ended = _solved(part, here, slice(own[0] - span[0], own[1] - span[0]))
            iterations, build = iterations + ended.iterations, build + ended.build_seconds
            if ended.success:
                break
        else:
            return None
        of_variables, of_equalities, of_ends = part.labels()
        assert here.bounds is not None
        for into, values, numbered, labels in (
            (state.x, here.x, variables, of_variables),
            (state.bounds, here.bounds, variables, of_variables),
            (state.equalities, here.equalities, equalities, of_equalities),
            (state.ends, here.ends, right_ends, of_ends),
        ):
            mine, at = numbered.find(labels, own)
            into[at] = values[mine]
        found.append(_own_rows(ended, span[0], own))
    parts = [rows for rows, _ in found]
    return Joined(state, together(parts), np.concatenate([d for _, d in found]), iterations, build)


class _Numbered:
    """Entries of the program of all segments, found by their labels."""

    def __init__(self, labels: Indices, joints: int) -> None:
        self._order = np.argsort(labels, kind="stable")
        self._sorted, self._stride = labels[self._order], LABELS * joints

    def find(self, labels: Indices, own: tuple[int, int]) -> tuple[Indices, Indices]:
        """Which of some labels are of certain segments and have an entry, and where that is."""
        segment, place = labels // self._stride, np.searchsorted(self._sorted, labels)
        mine = (own[0] <= segment) & (segment < own[1]) & (place < self._sorted.size)
        mine[mine] = self._sorted[place[mine]] == labels[mine]
        return np.flatnonzero(mine), self._order[place[mine]]


def _cut(trajectory: Trajectory, span: tuple[int, int]) -> Trajectory:
    own = slice(*span)
    return Trajectory(trajectory.durations[own], trajectory.scaled[own], trajectory.degrees[own])


def _solved(part: Program, state: RoundState, own: slice) -> _Ended:
    """Rounds until a window's own segments nearly keep their limits."""
    motion = part.trajectory(state.x)
    rows = near_rows(part, motion, EVERY)
    # Places that follow their extremum lead astray as long as the motion changes much.
    rows = replace(rows, weight=np.zeros(rows.sign.size))
    box = (SHRUNK * motion.durations, np.full(motion.durations.size, np.inf))
    iterations, build = 0, 0.0
    for turn in range(ROUNDS):
        # The first two tolerances and barriers: the last ones are for rows that hardly change.
        duals, success, count, seconds = solve_round(part, rows, state, min(turn, 1), box)
        iterations, build = iterations + count, build + seconds
        motion = part.trajectory(state.x)
        success = success and bool((motion.durations > 0).all())
        last = not success or turn + 1 == ROUNDS
        if last or (turn and worst_ratios(part.problem, motion)[own].max() <= 1 + ROUGH):
            break
        box = (np.zeros(motion.durations.size), box[1])
        before, rows = rows, near_rows(part, motion, NEAR)
        state.rows = carried(before, duals, rows)
    return _Ended(success, rows, duals, iterations, build)


def _own_rows(ended: _Ended, first: int, own: tuple[int, int]) -> tuple[Rows, Array]:
    """Rows of a window's own segments, counted from the first of all, and their multipliers."""
    rows, at = ended.rows, ended.rows.places
    segment = at.segment + first
    mine = (own[0] <= segment) & (segment < own[1])
    whole = replace(rows, places=replace(at, segment=segment))
    return picked(whole, mine), ended.duals[mine]
