"""Local optimum by the NLP: rounds of IPOPT, with rows at the extrema of the motion before.

The first round has rows at all extrema inside pieces, each later one at those of the motion before
it that come near their limit; an exact search over all pieces says where they are, so no
sampled place decides. A row continues from round to round as the extremum that it follows. Without
rows below a fifth of their limit in the first round, quintics often leave the region in which the
others mean anything.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...problem import TOLERANCE, Array, CurveError, Problem, as_piecewise, fit
from ...problem.checks import worst_ratios
from ...problem.curves import Trajectory
from ..clock import seconds_left, time_up
from .decided import Local
from .limit_rows import NEAR, near_limits
from .optimality import KKT, KKT_TOLERANCE, kkt, sparse_kkt
from .pieces import Indices, Rows, ca
from .program import Program
from .starts import DENSE, equal_start, slowed

FLAT = (1e-6, 1e-2)
"""Second derivative by the piece's parameter, in shares of the limit, below which a row stays at
its place: to follow an extremum of which rounding decides where it is keeps rounds from settling.
With 1e-7 or 1e-5 some do not either. It grows tenfold, to the second number, where limits are kept
and the conditions of an optimum are not met: multipliers of rows that follow a vague extremum are
vague."""
AWAY = 0.02
"""Share of its piece from which an extremum has gone, not moved."""
ROUNDS = 12
"""Most rounds of one attempt; three to six suffice where any number does."""
CHANGED = 3.0
"""Factor by which a round changes a duration at most: the extrema of a motion far away are others,
and without a bound some quintics leave for motions of which the rows say nothing. Its square root
after each failure, three of which a search survives."""


STAGES = ((1e-2, 1e-2), (1e-5, 1e-3), (1e-10, 1e-10), (1e-11, 1e-11))
"""IPOPT's tolerance, and the barrier at which it begins, in the first round, the second, the third
and the later ones. The first rows are not the last: with 1e-3 and 1e-6 a thousand quintic segments
take half as long again. IPOPT's own barrier of 0.1 costs quintics half as many iterations again,
and the later rows hardly move. The last tolerance is for short segments, whose high derivatives
carry a small residual far: to 8e-7 of the total at 1e-9."""
JUDGED_FROM = len(STAGES) - 2
"""Round, counted from 0, from which the answer is judged: its tolerance is that of an answer."""
FAILURES = 3
"""Rounds without success after which a search is given up; each begins again from the best motion
with rows at all its extrema."""
IPOPT_OPTIONS = {
    "print_time": False,
    "show_eval_warnings": False,  # the status says where a function is not defined
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": 250,  # what settles takes 10 to 60, seldom up to 170
    "ipopt.bound_relax_factor": 0.0,  # its default moves limits outwards by 1e-8
    "ipopt.honor_original_bounds": "yes",
    "ipopt.acceptable_iter": 0,  # "acceptable" answers are none here
    "ipopt.mu_strategy": "monotone",
    # MUMPS as it takes a band best: approximate minimum degree, and no scaling. To permute by the
    # size of values takes longer than to factorise, and grows faster than the number of segments.
    "ipopt.mumps_permuting_scaling": 0,
    "ipopt.mumps_scaling": 0,
    "ipopt.mumps_pivot_order": 0,
}
"""Options of IPOPT in every round."""
PUSHES = [f"ipopt.warm_start_{name}_push" for name in ("bound", "slack_bound", "mult_bound")] + [
    f"ipopt.warm_start_{name}_frac" for name in ("bound", "slack_bound")
]
"""Options of how far from bounds a later round begins."""
SHORTEST = 0.05
"""Seconds that a call of IPOPT has at least: its limit must be positive."""

Motion = tuple[Array, Array | None]
"""Durations, s, and free derivatives, where the declaration leaves some."""


def build(problem: Problem) -> Program:
    """The exact NLP of a problem, not solved: ``print(build(problem))`` lists its parts.

    Returns
    -------
    Program
        With its `variables`, `equalities`, `bounds` and the rows of `at_places`.

    Raises
    ------
    TrajgapError
        If no NLP is known for the kind of curve.
    """
    return Program(problem, float(equal_start(problem).mean()), np.zeros(problem.segments))


def near_rows(program: Program, trajectory: Trajectory, near: float, flat: float = FLAT[0]) -> Rows:
    """Rows at all extrema inside pieces that come near their limit, with their weights.

    ``near`` is the share of its limit from which an extremum has a row, as in `near_limits`;
    ``flat`` the second derivative, as in `FLAT`, below which a row stays at its place.
    """
    places, _, sign, *_ = near_limits(program.problem, trajectory, near)
    bend = program.slope(trajectory, places, 2)
    size = program.sides.scale[places.joint, np.maximum(places.order, 1) - 1]
    own, wider = program.pieces.own_places(trajectory, places)
    bend = bend * wider**2
    stays = np.abs(bend) < flat * np.where(places.order == 0, 1.0, size)
    weight = np.where(stays, 0.0, 1.0 / np.where(stays, 1.0, bend))
    table = np.column_stack([places.joint, own.segment, places.order, own.s, sign, weight])
    return Rows(table[(places.s > 0.0) & (places.s < 1.0)])


def grid_rows(program: Program) -> Rows:
    """Rows at fixed places inside every piece, on both sides of every limit.

    Each is a condition that every motion within the limits meets. Where derivatives are free a
    motion changes so much between rounds that its last extrema alone say too little.
    """
    found = [
        (j, k, r, i / (d - r + 2), sign, 0.0)
        for k, d in enumerate(program.degrees.tolist())
        for r in range(min(1 + program.sides.orders.size, d))
        for i in range(1, d - r + 2)  # more than its turning points
        for j in range(program.joints)
        for sign in (1.0, -1.0)
    ]
    rows = Rows(np.array(found))
    return Rows(rows.table[np.isfinite(program.rooms(rows.places, rows.sign))])


def _nearest(rows: Rows, to: Rows) -> tuple[Indices, Array]:
    """For each of some rows the nearest one of others, and its distance; inf of another limit."""
    if not to.sign.size:
        return np.zeros(rows.sign.size, dtype=np.int64), np.full(rows.sign.size, np.inf)
    joints = 1 + max(int(these.table[:, 0].max(initial=0)) for these in (rows, to))
    lines = []  # one line for all limits of all pieces, each 2 long
    for joint, piece, order, s, sign, _ in (rows.table.T, to.table.T):
        lines.append(2.0 * (((piece * 5 + order) * 2 + (sign > 0)) * joints + joint) + s)
    points = np.sort(lines[1])
    ahead = np.searchsorted(points, lines[0])
    before, after = (points[np.clip(at, 0, points.size - 1)] for at in (ahead - 1, ahead))
    away = np.minimum(np.abs(lines[0] - before), np.abs(lines[0] - after))
    chosen = np.where(np.abs(lines[0] - before) <= np.abs(lines[0] - after), ahead - 1, ahead)
    number = np.argsort(lines[1], kind="stable")[np.clip(chosen, 0, points.size - 1)]
    return number, np.where(away < 1.0, away, np.inf)


def beside(rows: Rows, others: Rows) -> Rows:
    """Rows, and beside them others that stay at their places, away from the nearest one."""
    gone = others.table[_nearest(others, rows)[1] > AWAY]
    gone = np.column_stack([gone[:, :5], np.zeros(len(gone))])
    return Rows(np.vstack([rows.table, gone]))


def carried(before: Rows, duals: Array, rows: Rows) -> Array:
    """Multipliers of new rows: each old one goes to the nearest row of its limit and piece."""
    out = np.zeros(rows.sign.size)
    to, away = _nearest(before, rows)
    there = np.isfinite(away)
    np.add.at(out, to[there], duals[there])
    return out


@dataclass(eq=False)
class RoundState:
    """Where the rounds stand: variables in the program's units, and multipliers.

    Those of the variables' bounds (None before the first round), of what the program states in
    every round, and of its rows.
    """

    x: Array
    bounds: Array | None
    stated: Array
    rows: Array


def begun(program: Program, motion: Motion) -> tuple[RoundState, Rows]:
    """At a motion, with no multipliers yet and rows at all its extrema."""
    trajectory = fit(program.problem.curve, program.problem.waypoints, *motion)
    state = RoundState(program.pack(trajectory, motion[0]), None, np.zeros(0), np.zeros(0))
    return state, rows_of(program, trajectory, 0.0, FLAT[0])


def rows_of(program: Program, trajectory: Trajectory, near: float, flat: float) -> Rows:
    """Rows at extrema, and at fixed places where the declaration leaves derivatives free."""
    rows = near_rows(program, trajectory, near, flat)
    return beside(rows, grid_rows(program)) if program.problem.curve.free else rows


def solve_round(
    program: Program,
    rows: Rows,
    state: RoundState,
    stage: tuple[float, float],
    box: tuple[Array, Array],
) -> tuple[bool, int, float]:
    """One call of IPOPT, from a state to the next: success, iterations, and seconds of building.

    No duration leaves the ``box`` (s): rows say nothing of motions far from theirs.
    """
    began = time.perf_counter()
    tolerance, barrier = stage
    expressions, least, most = constraints(program, rows)
    nlp = {"x": program.variables, "f": ca.sum1(program.durations), "g": expressions}
    options = IPOPT_OPTIONS | {
        "ipopt.mu_init": barrier,
        "ipopt.tol": tolerance,
        "ipopt.constr_viol_tol": tolerance,
        "ipopt.dual_inf_tol": 10.0 * tolerance,
        "ipopt.compl_inf_tol": tolerance,
    }
    left = seconds_left()
    if left < math.inf:  # each round's solver is its own, so no limit is shared
        options["ipopt.max_wall_time"] = max(left, SHORTEST)
    low, high = program.bounds()
    n = program.segments
    low[:n], high[:n] = (np.clip(side / program.unit, low[:n], high[:n]) for side in box)
    given = {"x0": np.clip(state.x, low, high), "lbx": low, "ubx": high, "lbg": least, "ubg": most}
    if state.bounds is not None:
        options["ipopt.warm_start_init_point"] = "yes"
        # Begun nearer to bounds than 1e-9, the last rounds take twice as many iterations.
        options |= dict.fromkeys(PUSHES, max(tolerance, 1e-9))
        given["lam_x0"], given["lam_g0"] = state.bounds, np.append(state.stated, state.rows)
    solver = ca.nlpsol("round", "ipopt", nlp, options)
    build = time.perf_counter() - began
    result = solver(**given)
    stats = solver.stats()
    state.x, state.bounds, duals = (
        np.asarray(result[name]).ravel() for name in ("x", "lam_x", "lam_g")
    )
    state.stated, state.rows = np.split(duals, [duals.size - rows.sign.size])
    return bool(stats["success"]), int(stats["iter_count"]), build


def constraints(program: Program, rows: Rows) -> tuple[Any, Array, Array]:
    """What a program states, and its rows after that, with the bounds that they lie between."""
    stated, low, high = program.stated()
    upper, room = rows.sign > 0, program.rooms(rows.places, rows.sign)
    return (
        ca.vertcat(stated, program.at_places(rows.places, rows.weight)),
        np.append(low, np.where(upper, -np.inf, room)),
        np.append(high, np.where(upper, room, np.inf)),
    )


def program_search(
    problem: Problem, start: Array, floor: Array, nodal: Array | None = None
) -> Local | None:
    """A local optimum from a start, or how far the rounds came; None if they came nowhere.

    The curve is of any kind that an NLP is known for. Start and floor, the least durations, are in
    s; free derivatives go with the start where the declaration leaves some. The end has its
    optimality conditions where the last round kept the limits.
    """
    began = time.perf_counter()
    program = Program(problem, float(start.mean()), floor)
    if program.equalities.numel() > program.variables.numel():
        return None  # such as more jumps that are forbidden than durations can avoid
    state, rows = begun(program, (start, nodal))
    build, iterations = time.perf_counter() - began, 0
    best: tuple[Motion, KKT] | None = None
    rough: Motion | None = None
    turn = failures = done = 0
    flat = FLAT[0]
    while done < ROUNDS and not (iterations and time_up()):
        done += 1
        before = state.x[: problem.segments] * program.unit
        factor = CHANGED ** (0.5**failures)
        stage = STAGES[min(turn, len(STAGES) - 1)]
        box = (before / factor, before * factor)
        success, count, seconds = solve_round(program, rows, state, stage, box)
        iterations, build = iterations + count, build + seconds
        motion = program.motion(state.x)
        trajectory, excess = _fitted(problem, motion)
        if trajectory is not None:
            longer = within(problem, motion, excess)
            rough = longer if rough is None or longer[0].sum() < rough[0].sum() else rough
        if not success and turn > JUDGED_FROM:
            break  # rounding allows no more
        if not success or trajectory is None:
            failures += 1
            if failures > FAILURES:
                break
            turn = done = 0
            state, rows = begun(program, rough or (start, nodal))
            continue
        if turn and excess <= TOLERANCE:  # a stretch, which costs as much, repairs it
            report = _report(program, longer, trajectory, rows, state)
            # A round with an eased tolerance leaves its barrier's gap: 1.6e-7 of a total was seen.
            if best is None or turn == JUDGED_FROM or report.residual < best[1].residual:
                best = longer, report
            if turn >= JUDGED_FROM:
                if report.residual <= KKT_TOLERANCE:
                    break
                flat = min(FLAT[1], 10.0 * flat)
        # Where a derivative is all but constant its extremum jumps through the whole piece.
        # Without rows at the places where it was, rounds go on in a circle.
        # On the central path a multiplier times its slack is the barrier: the larger one tells.
        loaded = np.abs(state.rows) > math.sqrt(stage[0])
        following = beside(rows_of(program, trajectory, NEAR, flat), Rows(rows.table[loaded]))
        state.rows, rows, turn = carried(rows, state.rows, following), following, turn + 1
    if rough is None:
        return None
    (h, values), found = best or (rough, None)
    settled = found is not None and found.residual <= KKT_TOLERANCE
    end = Local.of(problem, h, values, converged=settled)
    return replace(end, iterations=iterations, report=found, build_seconds=build)


def _fitted(problem: Problem, motion: Motion) -> tuple[Trajectory | None, float]:
    """The trajectory, if there is one, and its excess over limits of derivatives, as a stretch."""
    h, nodal = motion
    if not (np.isfinite(h).all() and (h > 0).all()):
        return None, np.inf
    try:
        trajectory = fit(problem.curve, problem.waypoints, h, nodal)
    except CurveError:
        return None, np.inf
    excess = float(worst_ratios(problem, trajectory).max()) - 1.0
    return (trajectory if np.isfinite(excess) else None), excess


def _report(
    program: Program, motion: Motion, trajectory: Trajectory, rows: Rows, state: RoundState
) -> KKT:
    """Optimality conditions: at the multipliers of the round, or dense ones of few segments."""
    problem, (h, nodal) = program.problem, motion
    curve = problem.curve
    if as_piecewise(curve) is None or curve.free or problem.segments <= DENSE:
        return kkt(problem, h, nodal)
    assert state.bounds is not None
    moved = program.followed(trajectory, rows)
    return sparse_kkt(problem, h, *program.priced(state.bounds, state.stated, moved, state.rows))


def within(problem: Problem, motion: Motion, excess: float) -> Motion:
    """A motion stretched by its excess over the limits, where a stretch repairs that."""
    h, nodal = motion
    if not (problem.curve.homogeneous and excess > 0.0):
        return motion
    factor = 1.0 + excess
    longer = np.clip(h * factor, problem.duration_lower, problem.duration_upper)
    return longer, None if nodal is None else slowed(problem, nodal, factor)
