"""The shortest time along a path by a convex program in the square of the path speed."""

from __future__ import annotations

import numpy as np

from ...problem import Limits, Trajectory
from .grid import SampledPath, measure, sample
from .path import pieces
from .toppra_check import prescribed_ends

CELLS = 250
"""Cells of each piece of up to five segments; longer ones take more in proportion, to `_MOST`."""
_MOST = 4000
"""Largest number of cells of a piece: the program then takes about a second."""


def shortest_by_squares(
    trajectory: Trajectory, limits: Limits, end_speeds: tuple[float, float]
) -> float | None:
    """Least time along the path of a trajectory, within limits of velocity and acceleration.

    With b the square of the path speed, linear in arc length s on each cell, b′/2 is the
    acceleration along the path, and

        q′² b ≤ V²  at the points,   |q′ b′/2 + q″ b| ≤ A  in the middle of the cells,

    are linear in b, while the time Σ 2Δs/(√b₀ + √b₁) is convex: the only optimum is found.

    Parameters
    ----------
    limits : Limits
        Of velocity and acceleration, equal on both sides; jerk does not count.
    end_speeds : tuple of float
        Path speeds at the two ends, rad/s.

    Returns
    -------
    float or None
        s; None where IPOPT finds none.
    """
    parts, _ = pieces(trajectory.path)
    total = 0.0
    for i, piece in enumerate(parts):
        cells = min(CELLS, 5 * _MOST // max(5, len(piece.stretches)))
        path = sample(piece, measure(piece), cells)
        ends = path.end_speeds(prescribed_ends(end_speeds, i, len(parts)))
        time = _piece(path, limits, ends)
        if time is None:
            return None
        total += time
    return total


def _piece(path: SampledPath, limits: Limits, ends: tuple[float, float]) -> float | None:
    import casadi as ca  # few need it, and it takes a while

    steps = np.diff(path.s) / path.s[-1]
    unit = path.s[-1] / path.duration
    # In path lengths and trajectory times.
    tangent = path.tangent
    bend = (path.after[:-1] + path.before[1:]) / 2.0 * path.s[-1]
    middle = (tangent[:-1] + tangent[1:]) / 2.0
    with np.errstate(divide="ignore"):
        top = (np.abs(limits.velocity / unit / tangent) ** 2).min(axis=1)
    top = np.minimum(top, 1e6)
    first, last = (min((v / unit) ** 2, cap) for v, cap in zip(ends, top[[0, -1]], strict=True))
    inner = ca.SX.sym("b", top.size - 2)
    b = ca.vertcat(first, inner, last)
    slope, mean = (b[1:] - b[:-1]) / (2.0 * steps), (b[1:] + b[:-1]) / 2.0
    rows = [
        (ca.DM(middle[:, j]) * slope + ca.DM(bend[:, j]) * mean) / (cap * path.s[-1] / unit**2)
        for j, cap in enumerate(limits.acceleration)
        if np.isfinite(cap)
    ]
    g = ca.vertcat(*rows)
    roots = ca.sqrt(b)
    time = ca.sum1(2.0 * ca.DM(steps) / (roots[1:] + roots[:-1]))
    solver = ca.nlpsol("squares", "ipopt", {"x": inner, "f": time, "g": g}, _QUIET)
    found = solver(x0=0.1 * top[1:-1], lbx=0.0, ubx=top[1:-1], lbg=-1.0, ubg=1.0)
    return float(found["f"]) * path.duration if solver.stats()["success"] else None


_QUIET = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.max_iter": 500}
"""Options of IPOPT."""
