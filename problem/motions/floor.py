"""A proven floor of the time between standstills: no motion within the limits is shorter."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..arrays import Array
from .joint_limits import JointLimits
from .motion import Motion


@dataclass(frozen=True)
class Floor:
    """The shortest time between the standstills of a motion, over every curve."""

    time: float
    """s; proven: no motion within the limits that stands still at the same places is shorter."""
    stops: int
    """Standstills of all joints, start and end included."""
    waiting: float
    """Time that the motion stands still, s; the floor does not include it."""
    above: float
    """(T − time)/time of the judged motion."""

    def __str__(self) -> str:
        return (
            f"{self.time:.6f} s for any motion between the {self.stops} standstills, whatever its "
            f"path ({100 * self.above:.1f} % above it)"
        )


def shortest(distance: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time of one joint from rest to rest, also with jerk limits (at rest a = 0).

    The optimal profile speeds up and slows down symmetrically; its top speed v follows from the
    distance, v·t(v) = d with t(v) = v/A + A/J, or 2√(v/J) where A is not reached.

    Parameters
    ----------
    distance, velocity, acceleration, jerk : float
        rad, rad/s, rad/s², rad/s³; limits may be inf.

    Returns
    -------
    float
        s.

    Examples
    --------
    >>> shortest(1.0, math.inf, 4.0, math.inf)
    1.0
    >>> round(shortest(1.0, math.inf, math.inf, 32.0), 12)
    1.0
    """
    d = abs(distance)
    if d == 0.0:
        return 0.0
    if min(velocity, acceleration, jerk) == 0.0:
        return math.inf

    def ramp(v: float) -> float:
        if v * jerk >= acceleration * acceleration or math.isinf(jerk):
            return v / acceleration + (0.0 if math.isinf(jerk) else acceleration / jerk)
        return 2.0 * math.sqrt(v / jerk)

    if not math.isinf(velocity) and velocity * ramp(velocity) <= d:
        return d / velocity + ramp(velocity)
    if math.isinf(acceleration) and math.isinf(jerk):
        return 0.0 if math.isinf(velocity) else d / velocity
    if math.isinf(jerk):
        return 2.0 * math.sqrt(d / acceleration)
    v = (d * math.sqrt(jerk) / 2.0) ** (2.0 / 3.0)
    if v * jerk > acceleration * acceleration:
        ratio = acceleration * acceleration / jerk
        v = 0.5 * (math.sqrt(ratio * ratio + 4.0 * d * acceleration) - ratio)
        return 2.0 * (v / acceleration + acceleration / jerk)
    return 4.0 * math.sqrt(v / jerk)


def least_time(
    motion: Motion, limits: JointLimits, standing: Array
) -> tuple[Floor | None, str | None]:
    """The floor of a motion's time, or why there is none.

    Its way-points are the ends, and the breaks in between at which every joint stands still: what
    lies between is the planner's choice, so a faster motion need not pass it.

    Parameters
    ----------
    limits : JointLimits
        Of two sides the larger one counts, which can only lower the floor.
    standing : ndarray, shape (joints,)
        Speed below which each joint stands, rad/s.
    """
    starts, ends = motion.at_ends(1)
    speed = np.vstack([np.abs(starts), np.abs(ends[-1:])])
    speed[1:-1] = np.maximum(speed[1:-1], np.abs(ends[:-1]))
    still = np.asarray((speed <= standing).all(axis=1))
    if not (still[0] and still[-1]):
        which = "start" if not still[0] else "end"
        return None, f"it is not shown that the motion {which}s at rest, so its ends set no floor"
    sizes = np.maximum(np.abs(limits.lower[:, 1:]), np.abs(limits.upper[:, 1:]))
    braking = np.isfinite(limits.deceleration)
    sizes[braking, 1] = np.maximum(sizes[braking, 1], limits.deceleration[braking])
    if not np.isfinite(sizes).any():
        return None, "only positions are limited"
    begun, ended = motion.at_ends(2)
    at = np.nonzero(still)[0]
    places = np.vstack([motion.scaled[:, 0], motion.scaled[-1:].sum(axis=1)])
    doubt = np.vstack([motion.error[:, 0], motion.error[-1:, 0]])
    total, waiting = 0.0, 0.0
    for a, b in pairwise(at):
        # What noise may take off the way lowers the floor.
        ways = np.maximum(np.abs(places[b] - places[a]) - doubt[b] - doubt[a], 0.0)
        calm = _calm(begun[a], sizes[:, 1]) and _calm(ended[b - 1], sizes[:, 1])
        # With acceleration at a standstill the profile with jerk limits is not the shortest.
        jerks = sizes[:, 2] if calm else np.full(len(ways), np.inf)
        each = [
            shortest(d, v, acc, jerk)
            for d, (v, acc), jerk in zip(ways, sizes[:, :2], jerks, strict=True)
        ]
        total += max(each)
        if not motion.scaled[a:b, 1:].any():
            waiting += float(motion.breaks[b] - motion.breaks[a])
    total *= 1.0 - 1e-12  # more than the closed form is rounded by
    if not 0.0 < total < math.inf:
        return None, "nothing moves between the standstills" if total == 0.0 else (
            "a joint that must stand still moves"
        )
    return Floor(total, len(at), waiting, motion.total_time / total - 1.0), None


def _calm(acceleration: Array, limits: Array) -> bool:
    """Whether no joint is accelerated, to a millionth of its limit or of the largest one seen."""
    size = np.where(np.isfinite(limits) & (limits > 0), limits, np.abs(acceleration).max())
    return bool((np.abs(acceleration) <= 1e-6 * size).all())
