"""Rounds of IPOPT on a program: its rows at extrema near their limits, and one call on them.

A round begins where another ended: each row continues the one whose extremum it follows.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, extrema
from ...problem.curves import Places, Trajectory, near_extrema
from .clock import seconds_left
from .limit_rows import Indices, Rows
from .optimality import Multipliers
from .program import Program
from .spline_program import SplineProgram
from .symbolic import ca

EVERY = 0.0
"""All interior extrema have rows at first: without those below a fifth of their limit, quintics
often leave the region in which the others mean anything."""
NEAR = 0.5
"""Share from which one has a row later: what grows beyond its limit meanwhile is found next. With
0.7 a round of quintics fails now and then."""
FLAT = 1e-6
"""Second derivative by the segment's parameter, in shares of the limit, below which a row stays at
its place: to follow an extremum of which rounding decides where it is keeps rounds from settling.
With 1e-7 or 1e-5 some do not either."""
AWAY = 0.02
"""Share of its segment from which an extremum has gone, not moved."""
SPARSER = 0.1
"""Share of a segment around an extremum in which no fixed place is needed: half of what fixed
places of a quintic's acceleration lie apart."""
POSITION_NEAR = 0.3
"""Distance to a position limit, in the joint's span, from which an extremum has a row."""


AnyProgram = Program | SplineProgram
"""The NLP of a declared curve, or of a B-spline."""


@dataclass(frozen=True, eq=False)
class Constraints:
    """What a program states: expressions, and the bounds that they lie between.

    In this order: the equalities, the rows at right ends, and the rows that follow extrema.
    """

    expressions: Any
    low: Array
    high: Array
    cuts: tuple[int, int]
    """Numbers of the first row at an end, and of the first that follows an extremum."""


def constraints(program: AnyProgram, rows: Rows) -> Constraints:
    """The equalities and limits of a program with its rows."""
    ends, upper = program.ends, rows.sign > 0
    at_ends = [program.rooms(ends, np.full(ends.s.size, sign)) for sign in (-1.0, 1.0)]
    room = program.rooms(rows.places, rows.sign)
    zero = np.zeros(program.equalities.numel())
    expressions = [
        program.equalities,
        program.at_places(ends, np.zeros(ends.s.size)),
        program.at_places(rows.places, rows.weight),
    ]
    return Constraints(
        ca.vertcat(*expressions),
        np.concatenate([zero, at_ends[0], np.where(upper, -np.inf, room)]),
        np.concatenate([zero, at_ends[1], np.where(upper, room, np.inf)]),
        (zero.size, zero.size + ends.s.size),
    )


def _lines(rows: Rows, joints: int) -> Array:
    """Rows as points on a line: places of different limits are more than 1 apart."""
    at = rows.places
    key = ((at.segment * 5 + at.order) * 2 + (rows.sign > 0)) * joints + at.joint
    return 2.0 * key + at.s


def _nearest(points: Array, to: Array) -> Indices:
    """Number of the nearest of some points to each of others."""
    order = np.argsort(points, kind="stable")
    ahead = np.clip(np.searchsorted(points[order], to), 1, points.size - 1)
    a, b = order[ahead - 1], order[ahead]
    return np.asarray(np.where(np.abs(points[a] - to) <= np.abs(points[b] - to), a, b))


def carried(before: Rows, duals: Array, rows: Rows) -> Array:
    """Multipliers of new rows: each that of the old row that it continues, else zero.

    A row continues the nearest one of the same side of the same limit in the same segment, if it is
    the nearest to that one too.
    """
    out = np.zeros(rows.sign.size)
    if before.sign.size < 2 or rows.sign.size < 2:
        return out
    joints = 1 + max(int(these.places.joint.max()) for these in (before, rows))
    old, new = (_lines(these, joints) for these in (before, rows))
    to, back = _nearest(old, new), _nearest(new, old)
    same = (back[to] == np.arange(new.size)) & (np.abs(old[to] - new) < 1.0)
    out[same] = duals[to[same]]
    return out


def picked(rows: Rows, at: Indices | NDArray[np.bool_]) -> Rows:
    """Some rows, by a mask or by their numbers."""
    p = rows.places
    places = Places(p.joint[at], p.segment[at], p.order[at], p.s[at])
    return Rows(places, rows.sign[at], rows.weight[at])


def together(parts: list[Rows]) -> Rows:
    """Rows of several parts, one after the other."""
    joint, segment, order, s = (
        np.concatenate([getattr(rows.places, name) for rows in parts])
        for name in ("joint", "segment", "order", "s")
    )
    sign, weight = (
        np.concatenate([getattr(rows, n) for rows in parts]) for n in ("sign", "weight")
    )
    return Rows(Places(joint, segment, order, s), sign, weight)


def with_loaded(program: AnyProgram, before: Rows, duals: Array, rows: Rows, loaded: float) -> Rows:
    """Rows, and with them the old ones with a multiplier whose extremum is gone, at their places.

    Where a derivative is all but constant its extremum jumps through the whole segment. Without
    rows at the places where it was, rounds go on in a circle.

    Parameters
    ----------
    program : Program or SplineProgram
    before : Rows
        Of a round that is over.
    duals : ndarray
        Their multipliers.
    rows : Rows
        At the extrema of the motion that it found.
    loaded : float
        Multiplier from which a row of that round was active.
    """
    return beside(program, rows, picked(before, np.abs(duals) > loaded), AWAY)


def beside(program: AnyProgram, rows: Rows, others: Rows, away: float) -> Rows:
    """Rows, and beside them others at their places that are further away from the nearest one.

    Parameters
    ----------
    program : Program or SplineProgram
    rows, others : Rows
    away : float
        Share of a segment.
    """
    if others.sign.size and rows.sign.size > 1:
        old, new = (_lines(these, program.joints) for these in (others, rows))
        others = picked(others, np.abs(new[_nearest(new, old)] - old) > away)
    if not others.sign.size:
        return rows
    both = together([rows, replace(others, weight=np.zeros(others.sign.size))])
    return picked(both, program.order_of_rows(both.places))


def grid_rows(program: Program) -> Rows:
    """Rows at fixed places inside every segment, on both sides of every limit.

    Each is a condition that every motion within the limits meets. Where derivatives are free a
    motion changes so much between rounds that its last extrema alone say too little.
    """
    found = []
    for r in (0, 1, 2, 3):
        for k, degree in enumerate(program.degrees.tolist()):
            if degree <= r:
                continue
            count = degree - r + 1  # more than its turning points
            for s in np.arange(1, count + 1) / (count + 1):
                found += [(j, k, r, s, x) for j in range(program.joints) for x in (1.0, -1.0)]
    columns = np.array(found, dtype=np.float64).reshape(-1, 5).T
    joint, segment, order = columns[:3].astype(np.int64)
    rows = Rows(Places(joint, segment, order, columns[3]), columns[4], np.zeros(joint.size))
    room = program.rooms(rows.places, rows.sign)
    rows = picked(rows, np.isfinite(room))
    return picked(rows, program.order_of_rows(rows.places))


def near_rows(program: AnyProgram, trajectory: Trajectory, near: float, flat: float = FLAT) -> Rows:
    """Rows at all extrema inside segments that come near their limit, with their weights.

    Parameters
    ----------
    program : Program or SplineProgram
    trajectory : Trajectory
    near : float
        Share of its limit from which an extremum has a row.
    flat : float
        Second derivative, as in `FLAT`, below which a row stays at its place.
    """
    found: list[tuple[Array | Indices, ...]] = []
    for j in range(program.joints):
        for r in (0, 1, 2, 3):
            low, high = _thresholds(program, j, r, near)
            if program.top - r < 2 or not (np.isfinite(low) or np.isfinite(high)):
                continue
            k, s, value = _extrema(trajectory, j, r, low, high)
            inner = (s > 0.0) & (s < 1.0)
            k, s, value = k[inner], s[inner], value[inner]
            sides = (value > 0.0, value <= 0.0) if low == high else (value >= high, value <= low)
            for side, which in zip(sides, (1.0, -1.0), strict=True):
                at = np.flatnonzero(side)
                whole = (np.full(at.size, j), k[at], np.full(at.size, r))
                found.append((*whole, s[at], np.full(at.size, which)))
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return Rows(Places(none, none, none, np.zeros(0)), np.zeros(0), np.zeros(0))
    joint, segment, order, place, sign = (np.concatenate([f[i] for f in found]) for i in range(5))
    at = program.order_of_rows(Places(joint, segment, order, place))
    places = Places(joint[at], segment[at], order[at], place[at])
    return program.rows_at(trajectory, places, sign[at], flat)


def _thresholds(program: AnyProgram, j: int, r: int, near: float) -> tuple[float, float]:
    """Values from which an extremum has a row on the lower side, and on the upper one."""
    limits = program.problem.limits
    if r == 0:
        room = POSITION_NEAR * float(np.ptp(program.problem.waypoints[:, j]))
        return float(limits.position_lower[j]) + room, float(limits.position_upper[j]) - room
    scale = float(program.sides.scale[j, r - 1])
    if np.isinf(scale):
        return -np.inf, np.inf
    size = scale * float(program.angle[j]) / program.unit**r
    edges = size * program.sides.low[j, r - 1], size * program.sides.high[j, r - 1]
    found = []
    for edge, away in zip(edges, (1.0, -1.0), strict=True):
        if np.isinf(edge):
            found.append(edge)
        elif edge == 0.0:  # an extremum counts as near it in shares of the larger side
            found.append(away * (1.0 - near) * size)
        else:
            found.append(near * edge)
    return float(found[0]), float(found[1])


def _extrema(
    trajectory: Trajectory, j: int, r: int, low: float, high: float
) -> tuple[Indices, Array, Array]:
    """Pieces, places and values of the extrema at most at ``low`` or at least at ``high``."""
    if trajectory.polynomial_in_time:
        return near_extrema(trajectory, j, r, low, high)
    found = [e for e in extrema(trajectory, j, r) if e.value <= low or e.value >= high]
    segment = np.array([e.segment for e in found], dtype=np.int64)
    return segment, np.array([e.s for e in found]), np.array([e.value for e in found])


ITERATIONS = 250
"""IPOPT's most iterations in a round: what settles takes 10 to 60, seldom up to 170."""
TOLERANCES = (1e-2, 1e-5, 1e-9, 1e-11)
"""IPOPT's tolerances in the first round, the second, the third and the later ones: the first rows
are not the last: with 1e-3 and 1e-6 a thousand quintic segments take half as long again. The last
one is for short segments, whose high derivatives carry a small residual far: to 8e-7 of the total
where the third was reached."""
BARRIERS = (1e-2, 1e-3, 1e-9, 1e-11)
"""Barriers at which those rounds begin: IPOPT's own 0.1 costs quintics half as many iterations
again, and the later rows hardly move."""
SHORTEST = 0.05
"""Seconds that a call of IPOPT has at least: its limit must be positive."""
OPTIONS = {
    "print_time": False,
    "show_eval_warnings": False,  # the status says where a function is not defined
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": ITERATIONS,
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


def _options(turn: int) -> dict[str, Any]:
    stage = min(turn, len(TOLERANCES) - 1)
    tolerance = TOLERANCES[stage]
    options = OPTIONS | {
        "ipopt.mu_init": BARRIERS[stage],
        "ipopt.tol": tolerance,
        "ipopt.constr_viol_tol": tolerance if stage < 2 else 0.1 * tolerance,
        "ipopt.dual_inf_tol": 10.0 * tolerance,
        "ipopt.compl_inf_tol": tolerance,
    }
    left = seconds_left()
    if left < math.inf:  # each round's solver is its own, so that no limit is shared
        options["ipopt.max_wall_time"] = max(left, SHORTEST)
    if turn == 0:
        return options
    push = 1e-5 if turn == 1 else 1e-9
    names = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    return options | {
        "ipopt.warm_start_init_point": "yes",
        **{f"ipopt.warm_start_{name}": push for name in names},
    }


@dataclass(eq=False)
class RoundState:
    """Where the rounds stand: variables, and the multipliers of what stays from round to round."""

    x: Array
    bounds: Array | None
    equalities: Array
    ends: Array
    rows: Array


def fresh(program: AnyProgram, x: Array) -> RoundState:
    """At a motion, with no multipliers yet."""
    given, ends = program.equalities.numel(), program.ends.s.size
    return RoundState(x, None, np.zeros(given), np.zeros(ends), np.zeros(0))


def solve_round(
    program: AnyProgram,
    rows: Rows,
    state: RoundState,
    turn: int,
    box: tuple[Array, Array],
) -> tuple[Array, bool, int, float]:
    """One call of IPOPT: the rows' multipliers, success, iterations, and seconds of building.

    No duration leaves the ``box`` (s): rows say nothing of motions far from theirs.
    """
    began = time.perf_counter()
    stated = constraints(program, rows)
    nlp = {"x": program.variables, "f": ca.sum1(program.durations), "g": stated.expressions}
    solver = ca.nlpsol("round", "ipopt", nlp, _options(turn))
    build = time.perf_counter() - began
    low, high = program.bounds()
    n = program.segments
    least, most = (np.clip(side / program.unit, low[:n], high[:n]) for side in box)
    low[:n], high[:n] = least, most
    arguments = {
        "x0": np.clip(state.x, low, high),
        "lbx": low,
        "ubx": high,
        "lbg": stated.low,
        "ubg": stated.high,
    }
    if state.bounds is not None:
        arguments["lam_x0"] = state.bounds
        duals = [state.equalities, state.ends, state.rows]
        arguments["lam_g0"] = np.concatenate(duals)
    result = solver(**arguments)
    stats = solver.stats()
    state.x, state.bounds = (np.asarray(result[name]).ravel() for name in ("x", "lam_x"))
    state.equalities, state.ends, duals_ = np.split(
        np.asarray(result["lam_g"]).ravel(), stated.cuts
    )
    return duals_, bool(stats["success"]), int(stats["iter_count"]), build


def multipliers(program: Program, rows: Rows, state: RoundState, of_rows: Array) -> Multipliers:
    """What a round of all segments leaves, in seconds."""
    at_left, number = program.left_places()
    assert state.bounds is not None
    parts = (at_left, program.ends, rows.places)
    joint, segment, order, s = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("joint", "segment", "order", "s")
    )
    # A bound on a variable is no share of its limit, as the rows are.
    shares = program.sides.scale[at_left.joint, np.maximum(at_left.order, 1) - 1]
    left = state.bounds[number] * np.where(at_left.order == 0, 1.0, shares)
    limits = np.concatenate([left, state.ends, of_rows])
    angle = np.where(order == 0, program.angle[joint], 1.0)
    return Multipliers(
        Places(joint, segment, order, s),
        np.concatenate([np.zeros(s.size - rows.weight.size, dtype=bool), rows.weight != 0.0]),
        limits * program.unit / angle,
        state.bounds[: program.degrees.size],
    )
