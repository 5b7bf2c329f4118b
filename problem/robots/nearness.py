"""How near the end of a chain can come to a point while some joints are held: both bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .chain import Chain, end_positions
from .inverse import inverse_kinematics

_MOST_BOXES = 400_000
"""Boxes held at once, to bound the memory: the bound so far is returned then, and holds."""


@dataclass(frozen=True, eq=False)
class Proximity:
    """Bounds on the smallest distance between the end and a point."""

    lower: float
    upper: float
    """m. The lower one holds for all values of the free joints; the upper one is attained."""
    joints: Array
    """Shape (joints,). Where ``upper`` is attained."""


def proximity(
    chain: Chain,
    point: ArrayLike,
    held: ArrayLike,
    *,
    radial: bool = False,
    tolerance: float | None = None,
) -> Proximity:
    """Bound the smallest distance of the end from a point over the joints that are free.

    Boxes of joint values are halved and dropped by a Lipschitz bound: while joint j moves by δ,
    the end moves by at most ``chain.arms[j]``·|δ|.

    Parameters
    ----------
    point : array_like, shape (3,)
        Position in the base, m.
    held : array_like, shape (joints,)
        Values of the joints that are held, rad (m where a joint slides); NaN for the free ones,
        which range over `Chain.span`. Held values need not keep the bounds.
    radial : bool
        Compare distances from the base's origin only, as if the axes of the base could be turned or
        mirrored.
    tolerance : float, optional
        Wanted difference of the bounds, m; a ten-thousandth of the reach by default. With many
        free joints the search may stop before.

    Raises
    ------
    TrajgapError
        If a shape is wrong, the point is not finite, or a free joint slides without bounds.
    """
    goal, given = np.asarray(point, dtype=np.float64), np.asarray(held, dtype=np.float64)
    if goal.shape != (3,) or not np.isfinite(goal).all():
        raise TrajgapError("point: is not a finite position; give three numbers, m")
    if given.shape != (chain.joints,) or np.isinf(given).any():
        raise TrajgapError(
            f"held: shape {given.shape} for {chain.joints} joints; give one number each, NaN for "
            "a free joint"
        )
    free = np.isnan(given)
    kept = chain.with_bounds(np.where(free, chain.lower, given), np.where(free, chain.upper, given))
    lower, upper = kept.span()
    width = tolerance if tolerance is not None else 1e-4 * kept.reach

    def distance(q: Array) -> Array:
        ends = end_positions(kept, q)
        if radial:
            return np.asarray(np.abs(np.linalg.norm(ends, axis=-1) - np.linalg.norm(goal)))
        return np.asarray(np.linalg.norm(ends - goal, axis=-1))

    bound, best = _bisect(distance, kept.arms, lower, upper, width)
    reached = float(distance(best))
    if 0 < reached <= width and not radial:
        # Too near for the boxes to tell from a hit; the best centre is the first start.
        close = inverse_kinematics(kept, goal, 0, guess=best, starts=4)
        if distance(close.joints) < reached:
            best, reached = close.joints, float(distance(close.joints))
    return Proximity(min(bound, reached), reached, best)


def _bisect(
    distance_at: Callable[[Array], Array],
    arms: Array,
    lower: Array,
    upper: Array,
    tolerance: float,
) -> tuple[float, Array]:
    """Lower bound of the distance over a box, and the nearest point that was met."""
    centres, halves = ((lower + upper) / 2)[None], ((upper - lower) / 2)[None]
    nearest, best = np.inf, centres[0]
    while True:
        distance = distance_at(centres)
        at = int(np.argmin(distance))
        if distance[at] < nearest:
            nearest, best = float(distance[at]), centres[at].copy()
        moves = arms * halves
        bounds = distance - moves.sum(axis=1)
        alive: NDArray[np.bool_] = bounds < nearest - tolerance
        if not alive.any():
            return max(0.0, nearest - tolerance), best
        if 2 * int(alive.sum()) > _MOST_BOXES:
            return max(0.0, float(bounds.min())), best
        centres, halves, moves = centres[alive], halves[alive], moves[alive]
        rows, widest = np.arange(len(centres)), moves.argmax(axis=1)
        halves = halves.copy()
        halves[rows, widest] /= 2
        shift = np.zeros_like(halves)
        shift[rows, widest] = halves[rows, widest]
        centres, halves = (
            np.concatenate([centres - shift, centres + shift]),
            np.tile(halves, (2, 1)),
        )
