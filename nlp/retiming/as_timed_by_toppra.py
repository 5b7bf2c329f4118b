"""The motion that TOPPRA makes of a trajectory's path, so it can be written and checked."""

from __future__ import annotations

import numpy as np

from ...problem import Array, Limits, Trajectory, TrajgapError
from ...problem.motions import Interpolation, Motion, Samples, interpolated
from .grid import measure, sample
from .path import pieces
from .toppra_check import GRIDPOINTS, excess, not_applicable


def retimed_motion(
    trajectory: Trajectory,
    limits: Limits,
    joints: tuple[str, ...] = (),
    cells: int = GRIDPOINTS[-1],
) -> Motion:
    """The fastest motion on a path under velocity and acceleration limits, as TOPPRA finds it.

    Between grid points the path speed's square is linear in arc length, as in TOPPRA; the motion is
    given by cubic Hermite polynomials between grid points, whose acceleration may exceed the limits
    by an error of the order of the grid; `check_motion` gives the amount.

    Parameters
    ----------
    trajectory : Trajectory
        Its path and its path speeds at the two ends are used.
    limits : Limits
        Velocity and acceleration.
    joints : tuple of str, optional
        Labels.
    cells : int
        Number of cells of each piece between standstills, of up to five segments; by default the
        finest grid of the comparison.

    Returns
    -------
    Motion

    Raises
    ------
    TrajgapError
        If TOPPRA does not apply, or finds nothing on this grid.
    """
    reason = not_applicable(trajectory, limits)
    if reason is not None:
        raise TrajgapError(f"TOPPRA on this path: not applicable, {reason}")
    from .toppra_piece import optimal_speeds  # toppra takes a second to import

    _, stretch = excess(trajectory, limits)
    parts, _ = pieces(trajectory)
    times = [0.0]
    positions: list[Array] = []
    velocities: list[Array] = []
    for number, piece in enumerate(parts, 1):
        path = sample(piece, measure(piece), cells)
        expected = (stretch or 1.0) * piece.duration
        found = optimal_speeds(
            path, limits.velocity, limits.acceleration, path.end_speeds(), expected
        )
        if found is None:
            raise TrajgapError(
                f"TOPPRA found no parametrisation of piece {number} on {cells} cells"
            )
        speeds = found[1]
        if (speeds[1:] + speeds[:-1] <= 0).any():
            raise TrajgapError(f"TOPPRA stops inside piece {number}; choose other limits")
        steps = 2.0 * np.diff(path.s) / (speeds[1:] + speeds[:-1])
        skip = 1 if positions else 0  # a standstill ends one piece and begins the next
        times += (times[-1] + np.cumsum(steps)).tolist()
        positions.append(path.position[skip:])
        velocities.append((path.tangent * speeds[:, None])[skip:])
    samples = Samples(
        joints, np.array(times), np.concatenate(positions), np.concatenate(velocities)
    )
    return interpolated(samples, Interpolation.CUBIC)
