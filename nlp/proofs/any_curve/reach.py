"""What a joint with velocity and acceleration limits reaches in a given time, exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


def furthest(
    v0: NDArray[np.float64],
    v1: NDArray[np.float64],
    h: NDArray[np.float64],
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Largest displacement in time ``h`` from velocity ``v0`` to ``v1``; −inf if impossible.

    Every admissible v(t) lies below min(v0 + A t, v1 + A (h − t), V), which is itself admissible
    if |v1 − v0| ≤ A h: its integral is D(p) = p h − (p − v0)²/2A − (p − v1)²/2A at
    p = min(V, (v0 + v1 + A h)/2), where D is largest over p ≤ V.

    Parameters
    ----------
    v0, v1, h, velocity, acceleration : ndarrays that broadcast
        rad/s, s, rad/s, rad/s²; the acceleration limit finite, the velocity limit inf for none.

    Returns
    -------
    ndarray
        Displacement, rad.
    """
    p = np.minimum(velocity, (v0 + v1 + acceleration * h) / 2.0)
    reach = p * h - ((p - v0) ** 2 + (p - v1) ** 2) / (2.0 * acceleration)
    possible = (np.abs(v0) <= velocity) & (np.abs(v1) <= velocity)
    possible &= np.abs(v1 - v0) <= acceleration * h
    return np.asarray(np.where(possible, reach, -np.inf), dtype=np.float64)


def reachable(
    displacement: NDArray[np.float64],
    v0: NDArray[np.float64],
    v1: NDArray[np.float64],
    h: NDArray[np.float64],
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Whether some C1 motion within the limits makes this displacement in exactly this time.

    Admissible motions form a convex set, so every displacement between the least and the largest
    is reached by a mixture of the two.
    """
    up = furthest(v0, v1, h, velocity, acceleration)
    down = -furthest(-v0, -v1, h, velocity, acceleration)
    return np.asarray((down <= displacement) & (displacement <= up))


@dataclass(frozen=True, eq=False)
class Profile:
    """A piecewise linear velocity of one joint in one segment.

    Attributes
    ----------
    time, velocity : ndarray, shape (corners,)
        s from the start of the segment, rad/s.
    """

    time: NDArray[np.float64]
    velocity: NDArray[np.float64]

    @property
    def displacement(self) -> float:
        """Integral of the velocity, rad."""
        return float(np.trapezoid(self.velocity, self.time))

    def position_range(self) -> tuple[float, float]:
        """Least and largest displacement on the way, rad."""
        steps = np.diff(self.time)
        v = self.velocity
        ends = np.concatenate([[0.0], np.cumsum((v[:-1] + v[1:]) / 2 * steps)])
        turning = v[:-1] * v[1:] < 0
        # Where the velocity crosses 0 linearly, a triangle of height v0 has been covered.
        share = np.where(turning, v[:-1] / np.where(turning, v[:-1] - v[1:], 1.0), 0.0)
        places = np.concatenate([ends, ends[:-1] + v[:-1] * share * steps / 2])
        return float(places.min()), float(places.max())


def profile(
    displacement: float, v0: float, v1: float, h: float, velocity: float, acceleration: float
) -> Profile:
    """The mixture of the two extreme motions that makes a reachable displacement.

    Parameters
    ----------
    displacement, v0, v1, h, velocity, acceleration : float
        As in `reachable`.

    Returns
    -------
    Profile
        Within the limits, from ``v0`` to ``v1`` in time ``h``.
    """
    corners = set()
    peaks = []
    for sign in (1.0, -1.0):
        a, b = sign * v0, sign * v1
        peak = min(velocity, (a + b + acceleration * h) / 2.0)
        peaks.append(peak)
        corners |= {(peak - a) / acceleration, h - (peak - b) / acceleration}
    time = np.array([0.0, *sorted({t for t in corners if 0.0 < t < h}), h])
    extreme = [
        sign
        * np.minimum.reduce(
            [
                sign * v0 + acceleration * time,
                sign * v1 + acceleration * (h - time),
                np.full(time.size, peak),
            ]
        )
        for sign, peak in zip((1.0, -1.0), peaks, strict=True)
    ]
    up, down = (float(np.trapezoid(v, time)) for v in extreme)
    share = min(1.0, max(0.0, (displacement - down) / (up - down))) if up > down else 0.0
    return Profile(time, share * extreme[0] + (1.0 - share) * extreme[1])
