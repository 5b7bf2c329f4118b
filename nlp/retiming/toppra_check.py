"""TOPPRA on the path of a trajectory: how much a better timing of the same curve could win."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, Limits, Trajectory, TrajgapError, extrema
from .grid import measure, sample
from .path import jump, pieces

GRIDPOINTS = (500, 1000, 2000)
"""Three sizes, each twice the last, to fit the order of the grid's error."""


@dataclass(frozen=True, eq=False)
class Retiming:
    """Time-optimal durations of a trajectory's path under velocity and acceleration limits only.

    Attributes
    ----------
    applicable : bool
        False if there is nothing to compare with; `why` gives the reason.
    why : str or None
        Why it is not applicable, or why the inequality is not asserted.
    trajectory_time : float
        Duration of the trajectory, s.
    gridpoints : tuple of int
        Cells of each piece of up to five segments (longer ones in proportion), one entry per
        grid size.
    durations : tuple of float
        Time-optimal duration on each grid, s; empty if not applicable.
    order : float or None
        Fitted order of convergence in the cell size; None if the durations agree to within the
        solver's accuracy, or do not converge in one direction.
    extrapolated : float or None
        Duration extrapolated to an infinitely fine grid, s.
    error : float or None
        Estimate of its error, s.
    cuts : tuple of float
        Times on the trajectory at which all joints stand still, s; path speed 0 is imposed there.
    inequality_holds : bool or None
        Whether ``extrapolated <= trajectory_time + error``. None if it need not hold.
    """

    applicable: bool
    why: str | None
    trajectory_time: float
    gridpoints: tuple[int, ...]
    durations: tuple[float, ...] = ()
    order: float | None = None
    extrapolated: float | None = None
    error: float | None = None
    cuts: tuple[float, ...] = ()
    inequality_holds: bool | None = None

    def __str__(self) -> str:
        if not self.applicable or self.extrapolated is None:
            return f"TOPPRA on this path: not applicable, {self.why}"
        grids = ", ".join(
            f"{d:.6f} s ({n})" for n, d in zip(self.gridpoints, self.durations, strict=True)
        )
        order = "none" if self.order is None else f"{self.order:.2f}"
        holds = {True: "holds", False: "does not hold", None: f"not asserted: {self.why}"}
        return "\n".join(
            [
                f"TOPPRA on this path {self.extrapolated:.6f} s ± {self.error:.1e} s, "
                "velocity and acceleration limits only",
                f"trajectory          {self.trajectory_time:.6f} s",
                f"grids               {grids}, fitted order {order}",
                f"standstills         {', '.join(f'{t:.4f}' for t in self.cuts) or 'none'} s",
                f"one-sided           {holds[self.inequality_holds]}",
            ]
        )


def retime(
    trajectory: Trajectory,
    limits: Limits,
    *,
    gridpoints: Sequence[int] = GRIDPOINTS,
    end_speeds: tuple[float, float] | None = None,
) -> Retiming:
    """Time-optimal duration of the path that a trajectory follows.

    Parameters
    ----------
    trajectory : Trajectory
        Shared by all joints.
    limits : Limits
        Velocity and acceleration limits count; position is fixed by the path.
    gridpoints : three ints, ascending
        Cells of each piece of up to five segments; longer ones take more in proportion.
    end_speeds : tuple of float, optional
        Path speeds at the two ends, rad/s; by default those of the trajectory.

    Returns
    -------
    Retiming
        Never raises for a trajectory to which it does not apply; `applicable` is then False.

    Raises
    ------
    TrajgapError
        If ``gridpoints``, ``end_speeds`` or the number of joints make no sense.

    Notes
    -----
    Pham & Pham, "A new approach to time-optimal path parameterization based on reachability
    analysis", IEEE Trans. Robotics 34(3), 2018; constraints in the interpolation scheme.
    """
    cells = tuple(int(n) for n in gridpoints)
    if len(cells) != 3 or not 2 <= cells[0] < cells[1] < cells[2]:
        raise TrajgapError(f"gridpoints: expected three ascending numbers from 2, got {cells}")
    if end_speeds is not None and not all(np.isfinite(v) and v >= 0 for v in end_speeds):
        raise TrajgapError(f"end_speeds: expected two speeds of 0 or more, got {end_speeds}")
    if limits.joints != trajectory.joints:
        raise TrajgapError(
            f"limits: given for {limits.joints} joints, trajectory has {trajectory.joints}"
        )
    total = trajectory.total_time
    path = trajectory.path
    reason = not_applicable(path, limits)
    if reason is not None:
        return Retiming(False, reason, total, cells)
    worst, stretch = excess(trajectory, limits)
    parts, cuts = pieces(path)
    given = end_speeds
    if path is not trajectory:  # its parameter grows evenly, and its end speeds are others
        given = end_speeds or _end_speeds(trajectory)
    from .toppra_piece import optimal_speeds  # toppra takes a second to import

    durations = np.zeros(3)
    for i, piece in enumerate(parts):
        graded = measure(piece)
        prescribed = prescribed_ends(given, i, len(parts))
        for level, n in enumerate(cells):
            sampled = sample(piece, graded, n)
            ends = sampled.end_speeds(prescribed)
            # No joint with a limit moves far enough to count: any scale will do.
            expected = (stretch or 1.0) * piece.duration
            found = optimal_speeds(sampled, limits.velocity, limits.acceleration, ends, expected)
            if found is None:
                why = f"TOPPRA found no parametrisation of piece {i + 1} on {n} cells"
                return Retiming(False, why, total, cells, cuts=cuts)
            durations[level] += found[0]
    order, extrapolated, error = extrapolate(cells, durations)
    if end_speeds is not None:
        reason = "the end speeds are not the trajectory's"
    elif worst > 1.0 + 1e-9:
        reason = f"the trajectory exceeds a limit itself (ratio {worst:.6g})"
    elif error > 0.05 * extrapolated:
        reason = f"the grids are too coarse (error estimate {error:.2g} s)"
    holds = extrapolated <= total + error if reason is None else None
    return Retiming(
        True,
        reason,
        total,
        cells,
        tuple(float(d) for d in durations),
        order,
        extrapolated,
        error,
        cuts,
        holds,
    )


def _end_speeds(trajectory: Trajectory) -> tuple[float, float]:
    """Path speeds of a trajectory at its two ends, rad/s."""
    first, last = np.linalg.norm(trajectory([0.0, trajectory.total_time], order=1), axis=1)
    return float(first), float(last)


def prescribed_ends(
    end_speeds: tuple[float, float] | None, piece: int, count: int
) -> tuple[float | None, float | None]:
    """Path speeds prescribed at the two ends of one piece of several."""
    if end_speeds is None:
        return None, None
    return end_speeds[0] if piece == 0 else None, end_speeds[1] if piece == count - 1 else None


def not_applicable(trajectory: Trajectory, limits: Limits) -> str | None:
    """The reason why TOPPRA says nothing about a trajectory, or None."""
    moving = _moving(trajectory)
    if not moving.any():
        return "nothing moves"
    if limits.braking.any():
        return "deceleration has a limit of its own, and paths are re-timed within one size only"
    if limits.uneven:
        return (
            "the two sides of a limit differ in size, and paths are re-timed only within equal ones"
        )
    higher = limits.limited[moving][:, 2:].any(axis=0)
    if higher.any():
        highest = limits.quantities[2 + int(np.argmax(higher))]
        return f"{highest} is limited, but TOPPRA handles velocity and acceleration limits only"
    if np.isinf(limits.acceleration[moving]).all():
        return "no acceleration is limited, so the speed along the path could jump"
    for name, values in (("velocity", limits.velocity), ("acceleration", limits.acceleration)):
        stuck = np.flatnonzero(moving & (values == 0))
        if stuck.size:
            return f"joint {stuck[0] + 1} moves, but its {name} limit is 0"
    return jump(trajectory)


def _moving(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Joints that move by more than the rounding of their positions."""
    size = np.abs(trajectory.scaled).max(axis=(0, 1))
    return np.asarray(np.abs(trajectory.scaled[:, 1:]).max(axis=(0, 1)) > 1e-13 * size)


def excess(trajectory: Trajectory, limits: Limits) -> tuple[float, float]:
    """Largest ratio to a velocity or acceleration limit, and the stretch that makes it tight."""
    ratios = np.zeros((trajectory.joints, 2))
    for j in np.flatnonzero(_moving(trajectory)).tolist():
        for r, limit in enumerate((limits.velocity[j], limits.acceleration[j])):
            peak = max(abs(e.value) for e in extrema(trajectory, j, r + 1))
            ratios[j, r] = peak / limit if peak > 0 else 0.0
    return float(ratios.max()), float(max(ratios[:, 0].max(), np.sqrt(ratios[:, 1].max())))


def extrapolate(cells: Sequence[int], durations: Array) -> tuple[float | None, float, float]:
    """Order p, limit and error estimate of T(n) = T + C n⁻ᵖ through three durations.

    Where the three do not show one order between 1/4 and 4, the order is None, the limit is
    taken at first order, and the error covers everything seen.
    """
    first, second = float(durations[0] - durations[1]), float(durations[1] - durations[2])
    last = float(durations[2])
    # Tolerances of TOPPRA's programs, and what stopping at a very sharp turn may cost.
    noise = 1e-5 * last
    n = np.asarray(cells, dtype=np.float64) / cells[2]

    def mismatch(p: float) -> float:
        both = (n[0] ** -p - n[1] ** -p) * second - (n[1] ** -p - 1.0) * first
        return float(both / abs(second))

    if max(abs(first), abs(second)) <= noise:
        return None, last, noise + abs(first) + abs(second)
    if second == 0.0 or mismatch(0.25) * mismatch(4.0) > 0 or first * second < 0:
        limit = last - second / (1.0 / n[1] - 1.0)
        return None, float(limit), noise + abs(first) + abs(second)
    from scipy.optimize import brentq  # a quarter of a second, and few need it

    order = float(brentq(mismatch, 0.25, 4.0))
    limit = last - second / (float(n[1]) ** -order - 1.0)
    return order, limit, noise + abs(limit - last)
