"""The second side of the TOPPRA check: the same fixed path as an NLP in squared path speed."""

from __future__ import annotations

import casadi as ca
import numpy as np
from trajgap.nlp.retiming.grid import SampledPath, measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.nlp.retiming.toppra_check import excess, not_applicable, prescribed_ends
from trajgap.problem import Array, Limits, Trajectory, TrajgapError


def path_nlp_duration(
    trajectory: Trajectory,
    limits: Limits,
    cells: int = 500,
    end_speeds: tuple[float, float] | None = None,
) -> float:
    """Time-optimal duration of a trajectory's path, by IPOPT instead of reachable sets.

    Parameters
    ----------
    trajectory : Trajectory
    limits : Limits
        Velocity and acceleration limits count.
    cells : int
        Cells of each piece of up to five segments; the grid is that of `retime`.
    end_speeds : tuple of float, optional
        Path speeds at the two ends, rad/s; by default those of the trajectory.

    Returns
    -------
    float
        Duration, s.

    Raises
    ------
    TrajgapError
        If TOPPRA does not apply to the trajectory, or IPOPT does not converge.

    Notes
    -----
    With x = ṡ² piecewise linear in s the time Σ 2Δs/(√xᵢ + √xᵢ₊₁) is convex in x and every limit
    is linear, so that a local minimum is the minimum (Verscheure et al., IEEE T-AC 54(10), 2009,
    eq. 34–36). It agrees with TOPPRA on the same grid if both solvers are right; about the grid
    and the path it says nothing.
    """
    reason = not_applicable(trajectory, limits)
    if reason is not None:
        raise TrajgapError(f"path NLP: not applicable, {reason}")
    _, stretch = excess(trajectory, limits)
    parts, _ = pieces(trajectory)
    total = 0.0
    for i, piece in enumerate(parts):
        path = sample(piece, measure(piece), cells)
        ends = path.end_speeds(prescribed_ends(end_speeds, i, len(parts)))
        total += _piece_duration(path, limits, ends, stretch)
    return total


def _piece_duration(
    path: SampledPath, limits: Limits, ends: tuple[float, float], stretch: float
) -> float:
    # Units in which the trajectory, stretched until it is tight, has speeds of order one and
    # every unknown starts at 1: at rest ends x spans many orders of magnitude.
    length, time_unit = float(path.s[-1]), stretch * path.duration
    own = (path.speed / stretch * time_unit / length) ** 2
    scale = np.maximum(own[1:-1], 1e-12)
    first, last = (np.array(ends) * time_unit / length) ** 2
    z = ca.MX.sym("z", scale.size)
    x = ca.vertcat(first, ca.DM(scale) * z, last)
    step = np.diff(path.s) / length
    duration = ca.sum1(2.0 * ca.DM(step) / (ca.sqrt(x[:-1]) + ca.sqrt(x[1:])))
    some = path.moving & np.isfinite(limits.acceleration)
    room = limits.acceleration[some] * time_unit**2 / length
    tangent = path.tangent[:, some] / room
    before, after = (q[:, some] * length / room for q in (path.before, path.after))
    u = (x[1:] - x[:-1]) / ca.DM(2.0 * step)
    rows = []
    for j in range(tangent.shape[1]):
        rows.append(ca.DM(tangent[:-1, j]) * u + ca.DM(after[:-1, j]) * x[:-1])
        rows.append(ca.DM(tangent[1:, j]) * u + ca.DM(before[1:, j]) * x[1:])
    upper = _squared_speed_limits(path, limits, time_unit / length)[1:-1] / scale
    options = {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-9,
        "ipopt.max_iter": 500,
    }
    solver = ca.nlpsol("path", "ipopt", {"x": z, "f": duration, "g": ca.vertcat(*rows)}, options)
    found = solver(x0=np.minimum(0.9, upper), lbx=0.0, ubx=upper, lbg=-1.0, ubg=1.0)
    if not solver.stats()["success"]:
        raise TrajgapError(f"path NLP: IPOPT ended with {solver.stats()['return_status']}")
    return float(found["f"]) * time_unit


def _squared_speed_limits(path: SampledPath, limits: Limits, unit: float) -> Array:
    moving = path.moving
    with np.errstate(divide="ignore"):
        speed = (limits.velocity[moving] * unit / np.abs(path.tangent[:, moving])).min(axis=1)
    return np.asarray(speed**2)
