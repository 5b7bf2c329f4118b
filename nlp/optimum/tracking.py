"""Place the slots of a formulation on the true extrema, and follow them to an optimum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from ...problem import Array, Interpolant, Problem, Verdict, check, fit
from ...problem.curves import Trajectory, critical_points, right_hand_sides
from .clock import time_up
from .formulation import (
    Form,
    Formulation,
    interior_slots,
    pack_parameters,
)
from .ipopt import Compiled
from .solver_calls import solved_before
from .starts import first_nodal

_PASSES = 40
"""Solves from one start: a bound against endless shrinking of the trust region."""
_PATIENCE = 8
"""Passes without a gain after which a start is given up."""


@dataclass(frozen=True, eq=False)
class Scaled:
    """The problem in units in which durations and angles are of order one."""

    problem: Problem
    time_unit: float
    angle_unit: Array
    values: Array
    inverse_limits: Array
    position: Array


def scaled_problem(problem: Problem, formulation: Formulation, time_unit: float) -> Scaled:
    """Row values, limits and position bounds of a problem in units of order one."""
    interpolant = problem.piecewise
    joints = problem.waypoints.shape[1]
    span = np.ptp(problem.waypoints, axis=0)
    angle = np.where(span > 0, span, 1.0)
    if formulation.structure.form is Form.REDUCED:
        rows = interpolant.completed().rows if interpolant.free else interpolant.rows
        zeros = np.zeros((interpolant.free, joints))
        values = right_hand_sides(interpolant, problem.waypoints, zeros)
    else:
        rows = interpolant.rows
        given = [dict(e) for e in interpolant.prescribed]
        place = {b: i for i, b in enumerate(interpolant.waypoint_breaks)}
        values = np.array(
            [
                problem.waypoints[place[r.at]]
                if r.order == 0 and r.at in place
                else np.full(joints, given[r.at].get(r.order, 0.0))
                for r in rows
            ]
        )
    units = np.array([time_unit**r.order for r in rows])[:, None] / angle
    # Upper limits before lower ones where they differ, as `formulation.build` takes them.
    sides = problem.limits.sides[::-1] if problem.limits.uneven else problem.limits.sides[:1]
    limits = np.concatenate(list(sides * time_unit ** np.arange(1, 4) / angle[:, None]), axis=1)
    usable = np.isfinite(limits) & (limits > 0)
    inverse = np.where(usable, 1.0 / np.where(usable, limits, 1.0), 0.0)
    low, high = problem.limits.position_lower, problem.limits.position_upper
    position = np.array(
        [
            np.where(np.isfinite(low), low, 0.0) / angle,
            np.where(np.isfinite(high), high, 0.0) / angle,
            np.isfinite(low).astype(float),
            np.isfinite(high).astype(float),
        ]
    )
    return Scaled(problem, time_unit, angle, values * units, inverse.T, position)


def place_slots(
    formulation: Formulation, trajectory: Trajectory | None
) -> tuple[list[Array], list[Array]]:
    """Places and Newton weights of the moving slots; on a grid without a trajectory."""
    interpolant = formulation.structure.interpolant
    joints = formulation.structure.joints
    assigned: dict[tuple[int, int, int], tuple[Array, Array]] = {}
    for r in formulation.structure.orders:
        for k, degree in enumerate(interpolant.degrees):
            count = interior_slots(degree - r)
            if count == 0:
                continue
            grid = np.arange(1, count + 1) / (count + 1)
            for j in range(joints):
                places, weights = grid.copy(), np.zeros(count)
                if trajectory is not None:
                    a = trajectory.scaled[k, : degree + 1, j]
                    for _ in range(r):
                        a = a[1:] * np.arange(1, a.size)
                    _follow(a, places, weights)
                assigned[r, k, j] = places, weights
    place_list, weight_list = [], []
    for group in formulation.groups:
        if group.place is not None:
            continue
        both = np.array(
            [
                [[part[group.slot] for part in assigned[group.order, k, j]] for j in range(joints)]
                for k in group.segments
            ]
        )
        place_list.append(both[:, :, 0])
        weight_list.append(both[:, :, 1])
    return place_list, weight_list


def _follow(a: Array, places: Array, weights: Array) -> None:
    """Move the nearest free slot onto each turning point of the polynomial ``a``."""
    polynomial = np.polynomial.polynomial
    turning = critical_points(a)
    if turning.size == 0:
        return
    curvature = polynomial.polyval(turning, polynomial.polyder(a, 2))
    size = float(np.abs(a[1:]).sum())
    free = list(range(places.size))
    order = np.argsort(-np.abs(polynomial.polyval(turning, a)))
    for i in order:
        slot = min(free, key=lambda m: abs(places[m] - turning[i]))
        free.remove(slot)
        places[slot] = turning[i]
        if abs(curvature[i]) > 1e-3 * size:
            weights[slot] = 1.0 / curvature[i]


def variable_bounds(
    problem: Problem, formulation: Formulation, time_unit: float, floor: float
) -> tuple[Array, Array]:
    """Bounds on the variables; durations stay above ``floor`` (s), padded powers are held at 0."""
    size = formulation.sizes["variables"]
    n, joints = problem.segments, problem.waypoints.shape[1]
    low, high = np.full(size, -np.inf), np.full(size, np.inf)
    low[:n] = np.maximum(problem.duration_lower, floor) / time_unit
    high[:n] = np.maximum(problem.duration_upper / time_unit, low[:n])
    if formulation.structure.form is Form.LIFTED:
        for p in range(max(problem.piecewise.degrees) + 1):
            for k, d in enumerate(problem.piecewise.degrees):
                if p > d:
                    at = n + p * n * joints + k + n * np.arange(joints)
                    low[at] = high[at] = 0.0
    return low, high


def unpack(
    problem: Problem, formulation: Formulation, scaled: Scaled, x: Array
) -> tuple[Array, Array | None]:
    """Durations (s) and free nodal derivatives (rad, s) of a vector of variables."""
    interpolant, n = problem.piecewise, problem.segments
    joints = problem.waypoints.shape[1]
    h = x[:n] * scaled.time_unit
    if not interpolant.free:
        return h, None
    if formulation.structure.form is Form.REDUCED:
        nodal = x[n:].reshape((interpolant.free, joints), order="F")
        orders = np.array([r for _, r in interpolant.free_derivatives])[:, None]
        return h, nodal * scaled.angle_unit / scaled.time_unit**orders
    top = max(interpolant.degrees) + 1
    c = x[n:].reshape((top, joints, n)).transpose(2, 0, 1) * scaled.angle_unit
    return h, free_values(interpolant, Trajectory(h, c, interpolant.degrees))


def free_values(interpolant: Interpolant, trajectory: Trajectory) -> Array:
    """What a trajectory gives the free derivatives of a declaration with the same breaks.

    Parameters
    ----------
    interpolant : Interpolant
    trajectory : Trajectory

    Returns
    -------
    ndarray, shape (free, joints)
    """
    n, joints = interpolant.segments, trajectory.scaled.shape[2]
    nodal = np.empty((interpolant.free, joints))
    for i, (b, order) in enumerate(interpolant.free_derivatives):
        for j in range(joints):
            side = trajectory.derivative(min(b, n - 1), j, order)
            nodal[i, j] = side[0] if b < n else side.sum()
    return nodal


@dataclass(frozen=True, eq=False)
class Local:
    """Where one start ended."""

    durations: Array
    nodal: Array | None
    total: float
    converged: bool
    feasible: bool
    iterations: int
    tight: tuple[Array, Array | None] | None = None
    """What was moved inside its limits so that rounding errors do not decide, if anything was."""


class Sized(Protocol):
    """An NLP that can tell how large it is."""

    @property
    def sizes(self) -> dict[str, int]:
        """Number of variables, equalities and inequalities."""


def run(
    solver: Any,
    formulation: Sized,
    x: Array,
    p: Array,
    bounds: tuple[Array, Array],
    duals: tuple[Any, Any] | None = None,
) -> tuple[Array, tuple[Any, Any], bool, int]:
    """Call a solver once: variables, multipliers, success, iterations.

    Inside of `kept_calls` one that was made before has its answer.
    """
    sizes = formulation.sizes
    low = np.concatenate([np.zeros(sizes["equalities"]), np.full(sizes["inequalities"], -np.inf)])
    arguments: dict[str, Any] = {
        "x0": np.clip(x, *bounds),
        "p": p,
        "lbx": bounds[0],
        "ubx": bounds[1],
        "lbg": low,
        "ubg": np.zeros(low.size),
    }
    if duals is not None:
        arguments |= {"lam_g0": duals[0], "lam_x0": duals[1]}

    def called() -> tuple[Array, tuple[Any, Any], bool, int]:
        result = solver(**arguments)
        stats = solver.stats()
        found = np.asarray(result["x"]).ravel()
        found.setflags(write=False)
        multipliers = (result["lam_g"], result["lam_x"])
        return found, multipliers, bool(stats["success"]), int(stats["iter_count"])

    first = [np.asarray(part).ravel() for part in duals or ()]
    given = (arguments["x0"], p, *bounds, *first)
    return solved_before(solver, given, called, lambda answer: answer[2])


def solve_coarse(
    problem: Problem, build_: Compiled, start: Array, floor: float
) -> tuple[Array, Scaled, bool, int]:
    """Solve on the coarse grid of slots from one start."""
    f = build_.formulation
    unit = float(start.mean())
    scaled = scaled_problem(problem, f, unit)
    bounds = variable_bounds(problem, f, unit, floor)
    places, weights = place_slots(f, None)
    p = pack_parameters(scaled.values, scaled.inverse_limits, scaled.position, places, weights)
    h = np.clip(start, bounds[0][: start.size] * unit, bounds[1][: start.size] * unit)
    first = pack(problem, f, scaled, h, first_nodal(problem))
    if time_up():
        return first, scaled, False, 0
    x, _, success, iterations = run(build_.cold, f, first, p, bounds)
    return x, scaled, success, iterations


def merit(problem: Problem, h: Array, nodal: Array | None) -> tuple[float, Array, Array | None]:
    """Exact total after repair by stretching, or a penalty where stretching does not repair."""
    verdict = check(problem, h, nodal)
    total = float(h.sum())
    if verdict.max_violation <= 0.0:
        return total, h, nodal
    if verdict.feasible_time is None:
        return total * (1.0 + 10.0 * verdict.max_violation), h, nodal
    factor = max(1.0, verdict.stretch)
    if problem.curve.free and nodal is not None:
        orders = np.array([r for _, r in problem.piecewise.free_derivatives])[:, None]
        nodal = nodal / factor**orders
    return verdict.feasible_time, h * factor, nodal


def track(problem: Problem, build_: Compiled, x: Array, scaled: Scaled, floor: float) -> Local:
    """Put the slots on the true extrema and solve again, inside a trust region, until they stay.

    Every step is judged by the exact repaired total, so that a slot that lost its extremum costs
    a smaller step and never a worse answer; all extrema are found anew before each solve.
    """
    f = build_.formulation
    n = problem.segments
    wide = variable_bounds(problem, f, scaled.time_unit, floor)
    h, nodal = unpack(problem, f, scaled, np.clip(x, *wide))
    best, h, nodal = merit(problem, h, nodal)
    x = pack(problem, f, scaled, h, nodal)
    radius, step, iterations, converged, duals = 0.5, np.inf, 0, False, None
    stale = 0
    for _ in range(_PASSES):
        if time_up():
            break
        trajectory = fit(problem.curve, problem.waypoints, h, nodal)
        c = trajectory.scaled / scaled.angle_unit
        places, weights = place_slots(f, replace(trajectory, scaled=c))
        p = pack_parameters(scaled.values, scaled.inverse_limits, scaled.position, places, weights)
        low, high = wide[0].copy(), wide[1].copy()
        room = radius * np.maximum(np.abs(x), np.where(np.arange(x.size) < n, 0.0, 1.0))
        held = slice(None) if problem.curve.free else slice(n)
        low[held] = np.clip((x - room)[held], low[held], high[held])
        high[held] = np.clip((x + 2.0 * room)[held], low[held], high[held])
        near = duals is not None and step < 1e-2
        x_new, new_duals, success, count = run(
            build_.warm if near else build_.cold, f, x, p, (low, high), duals if near else None
        )
        iterations += count
        if not success and near:
            x_new, new_duals, success, count = run(build_.cold, f, x, p, (low, high))
            iterations += count
        moved = float(np.abs(x_new[:n] / x[:n] - 1.0).max())
        h_new, nodal_new = unpack(problem, f, scaled, x_new)
        total, h_new, nodal_new = merit(problem, h_new, nodal_new)
        stale = 0 if total < best * (1.0 - 1e-7) else stale + 1
        if stale > _PATIENCE:
            break
        if total < best * (1.0 + 1e-13):
            x = pack(problem, f, scaled, h_new, nodal_new)
            h, nodal, best, duals, step = h_new, nodal_new, total, new_duals, moved
            radius = min(0.5, 2.0 * radius)
            if success and moved < 1e-9:
                converged = True
                break
        else:
            if moved < 1e-7:
                converged = success
                break
            shift = float((np.abs(x_new - x) / np.maximum(np.abs(x), 1.0)).max())
            radius, step, duals = 0.25 * min(radius, max(moved, shift)), moved, None
    verdict = check(problem, h, nodal)
    return Local(h, nodal, float(h.sum()), converged, verdict.verdict is Verdict.PASS, iterations)


def pack(
    problem: Problem,
    formulation: Formulation,
    scaled: Scaled,
    h: Array,
    nodal: Array | None,
) -> Array:
    """Variables of a formulation at given durations and free nodal derivatives."""
    interpolant = problem.piecewise
    free = np.zeros((0, problem.waypoints.shape[1])) if nodal is None else nodal
    if formulation.structure.form is Form.REDUCED:
        units = np.array([scaled.time_unit**r for _, r in interpolant.free_derivatives])
        start = free * units[:, None] / scaled.angle_unit
        return np.concatenate([h / scaled.time_unit, start.ravel("F")])
    trajectory = fit(interpolant, problem.waypoints, h, nodal)
    top = max(interpolant.degrees) + 1
    parts = [(trajectory.scaled[:, p] / scaled.angle_unit).ravel("F") for p in range(top)]
    return np.concatenate([h / scaled.time_unit, *parts])
