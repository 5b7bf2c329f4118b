"""Solve the exact NLP from several starts, track every extremum, and judge the answer."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..problem import Interpolant, Problem, Verdict, check, fit
from ..problem.peak import critical_points
from ..problem.spline import coefficient_gradient, layout, right_hand_sides
from ..problem.trajectory import Trajectory
from .feasibility import impossible
from .formulation import (
    Form,
    Formulation,
    Structure,
    build,
    interior_slots,
    pack_parameters,
)
from .kkt import kkt
from .polish import polish
from .solution import Solution, Status
from .starts import equal_start, first_nodal, screened_starts

STARTS = 4
SAME = 1e-6
"""Relative difference below which two totals count as the same."""
FLOORS = (1e-3, 1e-4)
"""Smallest durations tried, relative to the mean, where the case sets no lower bound."""
KKT_TOLERANCE = 1e-8
POLISHED = 1e-11
"""KKT residual above which an answer is sharpened by Newton steps on its active set."""
_PASSES = 25


@dataclass(frozen=True, eq=False)
class Compiled:
    """A formulation with its solvers: cold from a start, warm from a neighbouring solution."""

    formulation: Formulation
    cold: Any
    warm: Any
    build_seconds: float


def _options(warm: bool) -> dict[str, Any]:
    options: dict[str, Any] = {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-9,
        "ipopt.constr_viol_tol": 1e-10,
        "ipopt.dual_inf_tol": 1e-8,
        "ipopt.compl_inf_tol": 1e-9,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.honor_original_bounds": "yes",
        "ipopt.acceptable_iter": 0,
        "ipopt.max_iter": 300,
        "ipopt.mu_strategy": "monotone",
    }
    if warm:
        options |= {
            "ipopt.tol": 1e-12,
            "ipopt.constr_viol_tol": 1e-12,
            "ipopt.compl_inf_tol": 1e-12,
            "ipopt.max_iter": 60,
            "ipopt.warm_start_init_point": "yes",
            "ipopt.warm_start_bound_push": 1e-9,
            "ipopt.warm_start_bound_frac": 1e-9,
            "ipopt.warm_start_slack_bound_push": 1e-9,
            "ipopt.warm_start_slack_bound_frac": 1e-9,
            "ipopt.warm_start_mult_bound_push": 1e-9,
            "ipopt.mu_init": 1e-7,
            "ipopt.nlp_scaling_method": "none",
        }
    return options


@lru_cache(maxsize=64)
def compiled(structure: Structure) -> Compiled:
    """Build a structure and its solvers once; later problems of the same shape reuse them."""
    began = time.perf_counter()
    f = build(structure)
    nlp = {
        "x": f.variables,
        "p": f.parameters,
        "f": f.objective,
        "g": ca.vertcat(f.equalities, f.inequalities),
    }
    cold = ca.nlpsol("cold", "ipopt", nlp, _options(False))
    warm = ca.nlpsol("warm", "ipopt", nlp, _options(True))
    return Compiled(f, cold, warm, time.perf_counter() - began)


def best_form(interpolant: Interpolant, joints: int) -> Form:
    """Reduced where few coefficients are eliminated, lifted otherwise (benchmarks/nlp_forms.py)."""
    small = layout(interpolant).unknowns <= 24 and interpolant.free * joints <= 6
    return Form.REDUCED if small else Form.LIFTED


def structure_of(problem: Problem, form: Form | None = None) -> Structure:
    """The shape of a problem's NLP: curve, joints, and which derivatives are limited."""
    limits = problem.limits.derivatives
    usable = np.isfinite(limits) & (limits > 0)
    orders = tuple(r for r in (1, 2, 3) if usable[:, r - 1].any())
    if problem.limits.limits_position:
        orders = (0, *orders)
    joints = problem.waypoints.shape[1]
    chosen = form or best_form(problem.interpolant, joints)
    return Structure(problem.interpolant, joints, orders, chosen)


@dataclass(frozen=True, eq=False)
class _Scaled:
    """The problem in units in which durations and angles are of order one."""

    problem: Problem
    time_unit: float
    angle_unit: NDArray[np.float64]
    values: NDArray[np.float64]
    inverse_limits: NDArray[np.float64]
    position: NDArray[np.float64]


def _scaled(problem: Problem, formulation: Formulation, time_unit: float) -> _Scaled:
    interpolant = problem.interpolant
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
    limits = problem.limits.derivatives * time_unit ** np.arange(1, 4) / angle[:, None]
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
    return _Scaled(problem, time_unit, angle, values * units, inverse.T, position)


def _slots(
    formulation: Formulation, trajectory: Trajectory | None
) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
    """Places and Newton weights of the moving slots; on a grid without a trajectory."""
    interpolant = formulation.structure.interpolant
    joints = formulation.structure.joints
    assigned: dict[tuple[int, int, int], tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
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


def _follow(
    a: NDArray[np.float64], places: NDArray[np.float64], weights: NDArray[np.float64]
) -> None:
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


def _bounds(
    problem: Problem, formulation: Formulation, time_unit: float, floor: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    size = formulation.sizes["variables"]
    n, joints = problem.segments, problem.waypoints.shape[1]
    low, high = np.full(size, -np.inf), np.full(size, np.inf)
    low[:n] = np.maximum(problem.duration_lower, floor) / time_unit
    high[:n] = np.maximum(problem.duration_upper / time_unit, low[:n])
    if formulation.structure.form is Form.LIFTED:
        for p in range(max(problem.interpolant.degrees) + 1):
            for k, d in enumerate(problem.interpolant.degrees):
                if p > d:
                    at = n + p * n * joints + k + n * np.arange(joints)
                    low[at] = high[at] = 0.0
    return low, high


def _unpack(
    problem: Problem, formulation: Formulation, scaled: _Scaled, x: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Durations (s) and free nodal derivatives (rad, s) of a vector of variables."""
    interpolant, n = problem.interpolant, problem.segments
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
    trajectory = Trajectory(None, h, c, interpolant.degrees)  # type: ignore[arg-type]
    nodal = np.empty((interpolant.free, joints))
    for i, (b, order) in enumerate(interpolant.free_derivatives):
        for j in range(joints):
            side = trajectory.derivative(min(b, n - 1), j, order)
            nodal[i, j] = side[0] if b < n else side.sum()
    return h, nodal


@dataclass(frozen=True, eq=False)
class _Local:
    durations: NDArray[np.float64]
    nodal: NDArray[np.float64] | None
    total: float
    converged: bool
    feasible: bool
    iterations: int


def _run(
    solver: Any,
    formulation: Formulation,
    x: NDArray[np.float64],
    p: NDArray[np.float64],
    bounds: tuple[NDArray[np.float64], NDArray[np.float64]],
    duals: tuple[Any, Any] | None = None,
) -> tuple[NDArray[np.float64], tuple[Any, Any], bool, int]:
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
    result = solver(**arguments)
    stats = solver.stats()
    x = np.asarray(result["x"]).ravel()
    return x, (result["lam_g"], result["lam_x"]), bool(stats["success"]), int(stats["iter_count"])


def _local(
    problem: Problem, build_: Compiled, start: NDArray[np.float64], floor: float
) -> tuple[NDArray[np.float64], _Scaled, bool, int]:
    """Solve on the coarse grid of slots from one start."""
    f = build_.formulation
    unit = float(start.mean())
    scaled = _scaled(problem, f, unit)
    bounds = _bounds(problem, f, unit, floor)
    places, weights = _slots(f, None)
    p = pack_parameters(f, scaled.values, scaled.inverse_limits, scaled.position, places, weights)
    h = np.clip(start, bounds[0][: start.size] * unit, bounds[1][: start.size] * unit)
    first = _pack(problem, f, scaled, h, first_nodal(problem))
    x, _, success, iterations = _run(build_.cold, f, first, p, bounds)
    return x, scaled, success, iterations


def _merit(
    problem: Problem, h: NDArray[np.float64], nodal: NDArray[np.float64] | None
) -> tuple[float, NDArray[np.float64], NDArray[np.float64] | None]:
    """Exact total after repair by stretching, or a penalty where stretching does not repair."""
    verdict = check(problem, h, nodal)
    total = float(h.sum())
    if verdict.max_violation <= 0.0:
        return total, h, nodal
    if verdict.feasible_time is None:
        return total * (1.0 + 10.0 * verdict.max_violation), h, nodal
    if problem.interpolant.free and nodal is not None:
        orders = np.array([r for _, r in problem.interpolant.free_derivatives])[:, None]
        nodal = nodal / verdict.stretch**orders
    return verdict.feasible_time, h * verdict.stretch, nodal


def _track(
    problem: Problem, build_: Compiled, x: NDArray[np.float64], scaled: _Scaled, floor: float
) -> _Local:
    """Put the slots on the true extrema and solve again, inside a trust region, until they stay.

    Every step is judged by the exact repaired total, so that a slot that lost its extremum costs
    a smaller step and never a worse answer; all extrema are found anew before each solve.
    """
    f = build_.formulation
    n = problem.segments
    wide = _bounds(problem, f, scaled.time_unit, floor)
    h, nodal = _unpack(problem, f, scaled, np.clip(x, *wide))
    merit, h, nodal = _merit(problem, h, nodal)
    x = _pack(problem, f, scaled, h, nodal)
    radius, step, iterations, converged, duals = 0.5, np.inf, 0, False, None
    for _ in range(_PASSES):
        trajectory = fit(problem.interpolant, problem.waypoints, h, nodal)
        c = trajectory.scaled / scaled.angle_unit
        places, weights = _slots(f, replace(trajectory, scaled=c))
        p = pack_parameters(
            f, scaled.values, scaled.inverse_limits, scaled.position, places, weights
        )
        low, high = wide[0].copy(), wide[1].copy()
        room = radius * np.maximum(np.abs(x), np.where(np.arange(x.size) < n, 0.0, 1.0))
        held = slice(None) if problem.interpolant.free else slice(n)
        low[held] = np.maximum(low[held], (x - room)[held])
        high[held] = np.minimum(high[held], (x + 2.0 * room)[held])
        near = duals is not None and step < 1e-2
        x_new, new_duals, success, count = _run(
            build_.warm if near else build_.cold, f, x, p, (low, high), duals if near else None
        )
        iterations += count
        if not success and near:
            x_new, new_duals, success, count = _run(build_.cold, f, x, p, (low, high))
            iterations += count
        moved = float(np.abs(x_new[:n] / x[:n] - 1.0).max())
        h_new, nodal_new = _unpack(problem, f, scaled, x_new)
        merit_new, h_new, nodal_new = _merit(problem, h_new, nodal_new)
        if merit_new < merit * (1.0 + 1e-13):
            x = _pack(problem, f, scaled, h_new, nodal_new)
            h, nodal, merit, duals, step = h_new, nodal_new, merit_new, new_duals, moved
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
    return _Local(h, nodal, float(h.sum()), converged, verdict.verdict is Verdict.PASS, iterations)


def _pack(
    problem: Problem,
    formulation: Formulation,
    scaled: _Scaled,
    h: NDArray[np.float64],
    nodal: NDArray[np.float64] | None,
) -> NDArray[np.float64]:
    """Variables of a formulation at given durations and free nodal derivatives."""
    interpolant = problem.interpolant
    free = np.zeros((0, problem.waypoints.shape[1])) if nodal is None else nodal
    if formulation.structure.form is Form.REDUCED:
        units = np.array([scaled.time_unit**r for _, r in interpolant.free_derivatives])
        start = free * units[:, None] / scaled.angle_unit
        return np.concatenate([h / scaled.time_unit, start.ravel("F")])
    trajectory = fit(interpolant, problem.waypoints, h, nodal)
    top = max(interpolant.degrees) + 1
    parts = [(trajectory.scaled[:, p] / scaled.angle_unit).ravel("F") for p in range(top)]
    return np.concatenate([h / scaled.time_unit, *parts])


def solve(
    problem: Problem,
    *,
    starts: int = STARTS,
    seed: int = 0,
    initial: ArrayLike | None = None,
    form: Form | None = None,
) -> Solution:
    """Best known total time of a problem with shared durations, from an exact NLP.

    Parameters
    ----------
    problem : Problem
        Its coupling is not looked at: durations are shared by all joints of the problem. See
        `solve_per_joint` for the other procedure.
    starts : int
        Number of starts: equal durations first, then screened random ones.
    seed : int
        Seed of the random starts.
    initial : array_like, shape (starts, segments), optional
        Starts to use instead, s.
    form : Form, optional
        Reduced or lifted; by default the faster one for the size.

    Returns
    -------
    Solution
        Never raises for a problem without answer: the status says so.

    Raises
    ------
    TrajgapError
        If ``initial`` has the wrong shape.
    """
    reason = impossible(problem)
    if reason is not None:
        return Solution(problem, Status.INFEASIBLE, reason)
    idle = idle_segments(problem)
    if idle:
        return _with_idle(problem, idle, starts, seed, initial, form)
    return _solve_moving(problem, starts, seed, initial, form)


def _solve_moving(
    problem: Problem, starts: int, seed: int, initial: ArrayLike | None, form: Form | None
) -> Solution:
    """`solve` for a problem without idle segments."""
    build_ = compiled(structure_of(problem, form))
    began = time.perf_counter()
    generator = np.random.default_rng(seed)
    points = (
        screened_starts(problem, starts, generator)
        if initial is None
        else np.atleast_2d(np.asarray(initial, dtype=np.float64))
    )
    mean = float(equal_start(problem).mean())
    solution, coarser = None, None
    for share in FLOORS:
        floor = share * mean
        found = _multistart(problem, build_, points, floor)
        solution = _judged(problem, found, floor, len(points))
        if solution.status is Status.FEASIBLE and build_.formulation.structure.form is Form.REDUCED:
            # Eliminating across very unequal durations loses digits; the lifted form does not.
            lifted = compiled(structure_of(problem, Form.LIFTED))
            found += _multistart(problem, lifted, points, floor)
            solution = _judged(problem, found, floor, len(points))
        if solution.status is not Status.NOT_ATTAINED:
            break
        if coarser is not None:
            solution = _approached(coarser, solution)
        coarser = solution
        assert solution.durations is not None
        points = np.vstack([solution.durations, points])
    assert solution is not None
    return replace(
        solution,
        build_seconds=build_.build_seconds,
        solve_seconds=time.perf_counter() - began,
    )


def _multistart(
    problem: Problem, build_: Compiled, points: NDArray[np.float64], floor: float
) -> list[_Local]:
    """Local optima of all starts; a coarse solution that was tracked before is not tracked again."""
    tracked: list[tuple[NDArray[np.float64], _Local]] = []
    found: list[_Local] = []
    for start in points:
        x, scaled, success, iterations = _local(problem, build_, start, floor)
        coarse, _ = _unpack(problem, build_.formulation, scaled, x)
        known = [
            local
            for h, local in tracked
            if np.abs(h - coarse).max() <= 1e-6 * coarse.sum() and local.feasible
        ]
        local = known[0] if known else _track(problem, build_, x, scaled, floor)
        if success and not known:
            tracked.append((coarse, local))
        merit, _, _ = _merit(problem, start, first_nodal(problem))
        if merit < local.total:
            # The coarse solve left the start's basin for a worse one: descend from the start.
            first = _pack(problem, build_.formulation, scaled, start, first_nodal(problem))
            direct = _track(problem, build_, first, scaled, floor)
            local = min(local, direct, key=lambda one: one.total)
        found.append(replace(local, iterations=local.iterations + iterations))
    return found


def _judged(problem: Problem, found: list[_Local], floor: float, starts: int) -> Solution:
    """The best answer that the checker passes, with its optimality conditions."""
    iterations = sum(local.iterations for local in found)
    feasible = [local for local in found if local.feasible]
    if not feasible:
        return Solution(
            problem,
            *_nothing_found(problem, found),
            starts=starts,
            iterations=iterations,
        )
    best = min(feasible, key=lambda local: local.total)
    durations, report = best.durations, kkt(problem, best.durations, best.nodal)
    if report.residual > POLISHED:
        durations, report = polish(problem, durations, report)
    status = Status.OPTIMAL if report.residual <= KKT_TOLERANCE else Status.FEASIBLE
    why = None if status is Status.OPTIMAL else f"KKT residual {report.residual:.1e}"
    shrinking = _at_floor(problem, durations, floor)
    if shrinking:
        status = Status.NOT_ATTAINED
        names = ", ".join(str(k + 1) for k in shrinking)
        why = f"the total falls as the duration of segment {names} goes to 0"
    return Solution(
        problem,
        status,
        why,
        durations=durations,
        nodal=best.nodal,
        check=check(problem, durations, best.nodal),
        kkt_residual=report.residual,
        active=report.active,
        starts=starts,
        starts_at_best=sum(local.total <= best.total * (1 + SAME) for local in feasible),
        iterations=iterations,
        totals=tuple(local.total if local.feasible else float("inf") for local in found),
    )


def _at_floor(problem: Problem, durations: NDArray[np.float64], floor: float) -> list[int]:
    return np.flatnonzero((problem.duration_lower == 0) & (durations <= 1.01 * floor)).tolist()


def idle_segments(problem: Problem) -> list[int]:
    """Segments in which nothing moves and whose duration nothing else depends on."""
    if problem.interpolant.free:
        return []
    h = equal_start(problem)
    trajectory = fit(problem.interpolant, problem.waypoints, h)
    gradient = coefficient_gradient(problem.interpolant, problem.waypoints, h).durations
    still = np.abs(trajectory.scaled[:, 1:]).max(axis=(1, 2)) <= 1e-14
    apart = np.abs(gradient * h[:, None, None, None]).max(axis=(1, 2, 3)) <= 1e-14
    return np.flatnonzero(still & apart).tolist()


def _with_idle(
    problem: Problem,
    idle: list[int],
    starts: int,
    seed: int,
    initial: ArrayLike | None,
    form: Form | None,
) -> Solution:
    """Solve with idle segments held at an ordinary duration, then give them their least one."""
    held = equal_start(problem)
    low, high = problem.duration_lower.copy(), problem.duration_upper.copy()
    low[idle] = high[idle] = held[idle]
    if len(idle) == problem.segments:
        h, solution = low.copy(), Solution(problem, Status.OPTIMAL)
    else:
        core = replace(problem, duration_lower=low, duration_upper=high)
        solution = _solve_moving(core, starts, seed, initial, form)
        if solution.durations is None:
            return replace(solution, problem=problem)
        h = solution.durations.copy()
    h[idle] = problem.duration_lower[idle]
    vanishing = [k for k in idle if h[k] == 0]
    infimum = float(h.sum()) if vanishing else None
    h[vanishing] = FLOORS[-1] * held.mean()
    report = kkt(problem, h)
    answer = replace(
        solution,
        problem=problem,
        durations=h,
        check=check(problem, h),
        kkt_residual=report.residual,
        active=report.active,
    )
    if not vanishing:
        return answer
    names = ", ".join(str(k + 1) for k in vanishing)
    return replace(
        answer,
        status=Status.NOT_ATTAINED,
        why=f"nothing moves in segment {names}: the total falls as its duration goes to 0",
        infimum=infimum,
        kkt_residual=solution.kkt_residual,
        active=solution.active,
    )


def _nothing_found(problem: Problem, found: list[_Local]) -> tuple[Status, str]:
    worst = min(
        (check(problem, local.durations, local.nodal).max_violation for local in found),
        default=float("inf"),
    )
    limits = problem.limits
    stretchable = (
        np.isinf(problem.duration_upper).all()
        and problem.interpolant.homogeneous
        and not limits.limits_position
        and (limits.derivatives > 0).all()
    )
    if stretchable:
        return Status.FAILED, "the solver reached no feasible point, though stretching gives one"
    return (
        Status.INFEASIBLE,
        f"no feasible durations found from {len(found)} starts; the least excess over a limit was "
        f"{worst:.3g} (relative). This is local evidence, not a proof",
    )


def _approached(coarser: Solution, finer: Solution) -> Solution:
    """The infimum by extrapolating the totals at two floors to 0."""
    ratio = FLOORS[1] / FLOORS[0]
    slope = (coarser.total_time - finer.total_time) / (1.0 - ratio)
    infimum = max(0.0, finer.total_time - slope * ratio)
    return replace(finer, infimum=infimum)
