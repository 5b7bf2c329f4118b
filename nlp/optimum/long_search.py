"""Local optimum of a problem of many segments: limits where they matter, found again until none is.

Rounds of IPOPT on `LongProgram`. The first has rows at the interior extrema of its start, each
later one at those of the motion before it that come near their limit; an exact search over all
pieces says where they are, so that no sampled place decides.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...problem import Array, Problem, check, evaluate, fit
from ...problem.curves import Places, Trajectory, near_extrema
from .clock import seconds_left, time_up
from .ipopt import ipopt_options
from .judgement import KKT_TOLERANCE
from .long_formulation import Indices, LongProgram, Rows
from .long_optimality import LongKKT, Multipliers, along, long_kkt
from .starts import equal_start
from .symbolic import ca

ROUNDS = 12
"""Most rounds; three or four suffice where any number does."""
FAILURES = 2
"""Rounds without success after which a search is given up; each begins again from the best motion
with rows at all its extrema."""
ITERATIONS = 150
"""IPOPT's most iterations in a round: what settles takes 10 to 60."""
EVERY = 0.0
"""All interior extrema have rows at first: without those below a fifth of their limit, quintics
often leave the region in which the others mean anything."""
NEAR = 0.5
"""Share from which one has a row later: what grows beyond its limit meanwhile is found next. With
0.7 a round of quintics fails now and then."""
POSITION_NEAR = 0.3
"""Distance to a position limit, in the joint's span, from which an extremum has a row."""
SETTLED = 2e-9
"""Excess over a limit at which the rounds end: a stretch, which costs as much, repairs it."""
TOLERANCES = (1e-3, 1e-6, 1e-9)
"""IPOPT's tolerances in the first round, the second and the later ones: the first rows are not the
last."""
BARRIERS = (1e-2, 1e-3, 1e-7)
"""Barriers at which those rounds begin: IPOPT's own 0.1 costs quintics half as many iterations
again, and the later rows hardly move."""
PASSES = 4
"""Stretches of single segments; more change little."""
STEP, DAMPING = (0.8, 3.0), 0.7
"""Least and largest factor of a stretch, and its power: neighbours are stretched by it too."""
ABSOLUTE = ("ipopt.constr_viol_tol", "ipopt.dual_inf_tol", "ipopt.compl_inf_tol")
"""What IPOPT demands beside its tolerance: eased where that is."""
SHORTEST = 0.05
"""Seconds that a call of IPOPT has at least: its limit must be positive."""
DWELL = 1.2
"""Share by which a segment is first given more than its way takes at the velocity limit."""
TURN = 8.0
"""Starts have h² = 8|Δq|/A: rest to rest takes 4 at least, a spline's overshoot some more; at 5 the
first round of quintics takes up to twice as many iterations."""
LEAST = 0.3
"""Of the mean duration, the least at the start: neighbours share their accelerations."""


@dataclass(frozen=True, eq=False)
class LongLocal:
    """The end of a search, with its optimality conditions.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    kkt : LongKKT or None
        None where the rounds ended before the limits were kept; the durations, stretched, keep
        them.
    iterations : int
    build_seconds : float
    """

    durations: Array
    kkt: LongKKT | None
    iterations: int
    build_seconds: float


def way_start(problem: Problem) -> Array:
    """Durations after the way of each segment, each stretched by what it and its neighbours exceed.

    Not by what the worst of all exceeds: among many segments one is always far worse than most.
    """
    way = np.abs(np.diff(problem.waypoints, axis=0))
    velocity, acceleration = problem.limits.velocity, problem.limits.acceleration
    with np.errstate(divide="ignore", invalid="ignore"):
        fast = np.where(way > 0, DWELL * way / velocity, 0.0).max(axis=1)
        turn = np.sqrt(np.where(way > 0, TURN * way / acceleration, 0.0)).max(axis=1)
    breaks = np.array(problem.curve.waypoint_breaks)
    parts = np.diff(breaks)
    h = np.repeat(np.maximum(fast, turn) / parts, parts)
    if not (np.isfinite(h).all() and h.mean() > 0):
        return equal_start(problem)
    h = np.maximum(h, LEAST * h.mean())
    for _ in range(PASSES):
        worst = _worst_ratios(problem, h)
        beside = np.maximum(np.append(worst[1:], 0.0), np.append(0.0, worst[:-1]))
        h = h * np.clip(np.maximum(worst, beside), *STEP) ** DAMPING
    if not np.isfinite(h).all():
        return equal_start(problem)
    return np.asarray(np.clip(h, problem.duration_lower, problem.duration_upper))


def _worst_ratios(problem: Problem, h: Array) -> Array:
    """By how much each segment would have to be stretched, were it alone."""
    trajectory = fit(problem.curve, problem.waypoints, h)
    worst = np.zeros(h.size)
    for (j, i), limit in np.ndenumerate(problem.limits.derivatives):
        if np.isfinite(limit) and limit > 0:
            k, _, value = near_extrema(trajectory, j, i + 1, 0.0, 0.0)
            np.maximum.at(worst, k, (np.abs(value) / limit) ** (1.0 / (i + 1)))
    return worst


def _excess(problem: Problem, h: Array) -> float:
    """Relative excess over the limits, as a stretch: what `evaluate` says, of long motions sooner."""
    limits = problem.limits.derivatives
    if (limits == 0.0).any():
        return float(evaluate(problem, h[None]).stretch[0]) - 1.0
    return float(_worst_ratios(problem, h).max()) - 1.0


def _lines(rows: Rows, joints: int) -> Array:
    """Rows as points on a line: places of different limits are more than 1 apart."""
    at = rows.places
    key = ((at.segment * 4 + at.order) * 2 + (rows.sign > 0)) * joints + at.joint
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
    if not (before.sign.size and rows.sign.size):
        return out
    joints = 1 + max(int(these.places.joint.max()) for these in (before, rows))
    old, new = (_lines(these, joints) for these in (before, rows))
    to, back = _nearest(old, new), _nearest(new, old)
    same = (back[to] == np.arange(new.size)) & (np.abs(old[to] - new) < 1.0)
    out[same] = duals[to[same]]
    return out


def near_rows(program: LongProgram, trajectory: Trajectory, near: float) -> Rows:
    """Rows at all extrema inside segments that come near their limit, with their weights."""
    problem = program.problem
    found: list[tuple[Array | Indices, ...]] = []
    for j in range(program.joints):
        for r in (0, 1, 2, 3):
            if r > 0:
                limit = float(program.limits[j, r - 1]) * program.angle[j] / program.unit**r
                low, high = (-near * limit, near * limit) if limit < np.inf else (-limit, limit)
            else:
                room = POSITION_NEAR * float(np.ptp(problem.waypoints[:, j]))
                low = float(problem.limits.position_lower[j]) + room
                high = float(problem.limits.position_upper[j]) - room
            if program.top - r < 2 or not (np.isfinite(low) or np.isfinite(high)):
                continue
            k, s, value = near_extrema(trajectory, j, r, low, high)
            inner = (s > 0.0) & (s < 1.0)
            k, s, value = k[inner], s[inner], value[inner]
            sides = [value >= high, value <= low] if r == 0 else [value > 0.0, value <= 0.0]
            for side, which in zip(sides, (1.0, -1.0), strict=True):
                at = np.flatnonzero(side)
                whole = (np.full(at.size, j), k[at], np.full(at.size, r))
                found.append((*whole, s[at], np.full(at.size, which)))
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return Rows(Places(none, none, none, np.zeros(0)), np.zeros(0), np.zeros(0))
    joint, segment, order, place, sign = (np.concatenate([f[i] for f in found]) for i in range(5))
    places = Places(joint, segment, order, place)
    at = program.order_of_rows(places)
    places = Places(joint[at], segment[at], order[at], place[at])
    return Rows(places, sign[at], _newton_weights(program, trajectory, places))


def _newton_weights(program: LongProgram, trajectory: Trajectory, places: Places) -> Array:
    """1/f″ of f, a derivative in units of order one as a function of s; 0 where f is flat."""
    curvature = along(trajectory, places, 2)
    rate = (program.unit / trajectory.durations[places.segment]) ** places.order
    curvature = curvature * rate / program.angle[places.joint]
    flat = np.abs(curvature) < 1e-9 * np.abs(curvature).max(initial=1.0)
    return np.where(flat, 0.0, 1.0 / np.where(flat, 1.0, curvature))


def _cap() -> float | None:
    """What is left of the time, s: each round's solver is its own, so that no cap is shared."""
    left = seconds_left()
    return None if left == math.inf else max(left, SHORTEST)


def _options(turn: int, cap: float | None) -> dict[str, Any]:
    stage = min(turn, 2)
    tolerance = TOLERANCES[stage]
    usual = ipopt_options(warm=False, cap=cap)
    eased = {key: max(tolerance, usual[key]) for key in ABSOLUTE} if stage < 2 else {}
    options = (
        usual
        | eased
        | {
            "ipopt.max_iter": ITERATIONS,
            "ipopt.mu_init": BARRIERS[stage],
            "ipopt.tol": tolerance,
        }
    )
    if turn == 0:
        return options
    push = 1e-5 if turn == 1 else 1e-9
    names = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    return options | {
        "ipopt.warm_start_init_point": "yes",
        **{f"ipopt.warm_start_{name}": push for name in names},
    }


@dataclass(eq=False)
class _State:
    """Where the rounds stand: variables, and the multipliers of what stays from round to round."""

    x: Array
    bounds: Array | None
    equalities: Array
    ends: Array
    rows: Array


def _fresh(program: LongProgram, h: Array, trajectory: Trajectory) -> _State:
    """At a motion, with no multipliers yet."""
    given, ends = program.equalities.numel(), program.ends.s.size
    return _State(program.pack(h, trajectory.scaled), None, np.zeros(given), np.zeros(ends), np.zeros(0))


def _round(
    program: LongProgram, rows: Rows, state: _State, turn: int
) -> tuple[Array, bool, int, float]:
    """One call of IPOPT: the rows' multipliers, success, iterations, and seconds of building."""
    began = time.perf_counter()
    ends = program.ends
    expressions = [
        program.equalities,
        program.at_places(ends, np.zeros(ends.s.size)),
        program.at_places(rows.places, rows.weight),
    ]
    nlp = {"x": program.variables, "f": ca.sum1(program.durations), "g": ca.vertcat(*expressions)}
    solver = ca.nlpsol("many", "ipopt", nlp, _options(turn, _cap()))
    build = time.perf_counter() - began
    low, high = program.bounds()
    room, upper = program.rooms(rows.places, rows.sign), rows.sign > 0
    one, zero = np.ones(ends.s.size), np.zeros(state.equalities.size)
    arguments = {
        "x0": np.clip(state.x, low, high),
        "lbx": low,
        "ubx": high,
        "lbg": np.concatenate([zero, -one, np.where(upper, -np.inf, room)]),
        "ubg": np.concatenate([zero, one, np.where(upper, room, np.inf)]),
    }
    if state.bounds is not None:
        arguments["lam_x0"] = state.bounds
        duals = [state.equalities, state.ends, state.rows]
        arguments["lam_g0"] = np.concatenate(duals)
    result = solver(**arguments)
    stats = solver.stats()
    state.x, state.bounds = (np.asarray(result[name]).ravel() for name in ("x", "lam_x"))
    cuts = [zero.size, zero.size + one.size]
    state.equalities, state.ends, duals_ = np.split(np.asarray(result["lam_g"]).ravel(), cuts)
    return duals_, bool(stats["success"]), int(stats["iter_count"]), build


def _multipliers(program: LongProgram, rows: Rows, state: _State, of_rows: Array) -> Multipliers:
    """What a round leaves, in seconds."""
    at_left, number = program.left_places()
    assert state.bounds is not None
    parts = (at_left, program.ends, rows.places)
    joint, segment, order, s = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("joint", "segment", "order", "s")
    )
    # A bound on a variable is no share of its limit, as the rows are.
    shares = program.limits[at_left.joint, np.maximum(at_left.order, 1) - 1]
    left = state.bounds[number] * np.where(at_left.order == 0, 1.0, shares)
    limits = np.concatenate([left, state.ends, of_rows])
    angle = np.where(order == 0, program.angle[joint], 1.0)
    return Multipliers(
        Places(joint, segment, order, s),
        limits * program.unit / angle,
        state.bounds[: program.degrees.size],
    )


def long_search(problem: Problem, start: Array, floor: Array, until: float) -> LongLocal | None:
    """A local optimum from a start, or how far the rounds came; None where they came nowhere.

    Parameters
    ----------
    problem : Problem
        With a determined piecewise polynomial.
    start : ndarray, shape (segments,)
        s.
    floor : ndarray, shape (segments,)
        Least durations, s.
    until : float
        Reading of the monotonic clock after which no further round is begun.

    Returns
    -------
    LongLocal or None
    """
    began = time.perf_counter()
    program = LongProgram(problem, float(start.mean()), floor)
    trajectory = fit(problem.curve, problem.waypoints, start)
    state = _fresh(program, start, trajectory)
    rows = near_rows(program, trajectory, EVERY)
    build, iterations = time.perf_counter() - began, 0
    local: LongLocal | None = None
    rough: Array | None = None
    turn = failures = 0
    for _ in range(ROUNDS):
        if iterations and (time_up() or time.monotonic() > until):
            break
        duals, success, count, seconds = _round(program, rows, state, turn)
        iterations, build = iterations + count, build + seconds
        h = state.x[: problem.segments] * program.unit
        whole = bool(np.isfinite(h).all() and (h > 0).all())
        excess = _excess(problem, h) if whole else np.inf
        if np.isfinite(excess):
            longer = _within(problem, h, excess)
            rough = longer if rough is None or longer.sum() < rough.sum() else rough
        if not (success and np.isfinite(excess)):
            failures += 1
            if failures > FAILURES:
                break
            turn, back = 0, start if rough is None else rough
            trajectory = fit(problem.curve, problem.waypoints, back)
            state = _fresh(program, back, trajectory)
            rows = near_rows(program, trajectory, EVERY)
            continue
        trajectory = fit(problem.curve, problem.waypoints, h)
        if turn and excess <= SETTLED:
            violation = check(problem, longer).max_violation
            kkt = long_kkt(problem, longer, _multipliers(program, rows, state, duals), violation)
            if local is None or local.kkt is None or kkt.residual < local.kkt.residual:
                local = LongLocal(longer, kkt, iterations, build)
            # A round with an eased tolerance leaves its barrier's gap: 1.6e-7 of a total was seen.
            if kkt.residual <= KKT_TOLERANCE and turn >= len(TOLERANCES) - 1:
                break
        before, rows = rows, near_rows(program, trajectory, NEAR)
        state.rows, turn = carried(before, duals, rows), turn + 1
    if local is None and rough is not None:
        local = LongLocal(rough, None, iterations, build)
    return local


def _within(problem: Problem, h: Array, excess: float) -> Array:
    """Durations stretched by what they exceed their limits, where a stretch repairs that."""
    if not (problem.curve.homogeneous and excess > 0.0):
        return h
    return np.asarray(np.clip(h * (1 + excess), problem.duration_lower, problem.duration_upper))
