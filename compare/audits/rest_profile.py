"""Shortest profiles from rest to rest, in closed form, for several joints together."""

from __future__ import annotations

from collections.abc import Callable
from math import cbrt, inf, pi, sqrt

import numpy as np
from scipy.optimize import brentq

from ...problem import Array


def trapezoidal(
    way: float, velocity: float, acceleration: float, jerk: float, deceleration: float | None = None
) -> float:
    """Shortest time from rest to rest with constant acceleration, constant speed and braking.

    Parameters
    ----------
    way : float
        rad, not negative.
    velocity, acceleration : float
        Limits, rad/s and rad/s²; may be infinite.
    jerk : float
        Not read: the acceleration jumps.
    deceleration : float, optional
        Limit of braking, rad/s²; as of speeding up if absent.

    Returns
    -------
    float
        s.
    """
    if way == 0.0:
        return 0.0
    braking = acceleration if deceleration is None else deceleration
    if acceleration == inf == braking:
        return way / velocity
    # Both ramps, v/A + v/D long, pass half of v times that; 2/(1/A + 1/D) is A where both are A.
    mean = acceleration
    if braking != acceleration:
        mean = 2.0 / (1.0 / acceleration + 1.0 / braking)
    if way * mean <= velocity**2:
        return 2.0 * sqrt(way / mean)
    return way / velocity + velocity / mean


def s_curve(way: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time from rest to rest with a jerk that is constant in at most seven phases.

    Parameters
    ----------
    way : float
        rad, not negative.
    velocity, acceleration, jerk : float
        Limits, rad/s, rad/s² and rad/s³; may be infinite.

    Returns
    -------
    float
        s.
    """
    if way == 0.0 or jerk == inf:
        return trapezoidal(way, velocity, acceleration, jerk)
    # Time to the full speed and back takes `speeding` each, and half of speed times that as way.
    if velocity * jerk >= acceleration**2:
        speeding = velocity / acceleration + acceleration / jerk
    else:
        speeding = 2.0 * sqrt(velocity / jerk)
    if way >= velocity * speeding:
        return speeding + way / velocity
    if way * jerk**2 >= 2.0 * acceleration**3:
        ramp = acceleration / jerk
        return ramp + sqrt(ramp**2 + 4.0 * way / acceleration)
    return 4.0 * cbrt(way / (2.0 * jerk))


def sine_jerk(way: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time from rest to rest in seven phases whose jerk is a half sine on each ramp.

    Parameters
    ----------
    way : float
        rad, not negative.
    velocity, acceleration, jerk : float
        Limits, rad/s, rad/s² and rad/s³; may be infinite.

    Returns
    -------
    float
        s.

    Notes
    -----
    On a ramp of length τ the jerk is J sin(πt/τ), and the acceleration changes by ∫ = 2Jτ/π, as by
    a constant jerk of 2J/π. It is (Jτ/π)(1 − cos(πt/τ)), which with its mirror image about the
    middle of the ramp sums to the whole change, as a straight line does: velocity changes by the
    same amount over the ramp. Both profiles are mirror images about the middle of each half and of
    the whole, so that the ways are half of velocity times time in both. With phases of equal length
    they have the same peaks of velocity and acceleration and the same way. The shortest total is
    that of the S-curve within 2/π of the jerk limit.
    """
    return s_curve(way, velocity, acceleration, 2.0 / pi * jerk)


def fourth_order(
    way: float, velocity: float, acceleration: float, jerk: float, snap: float
) -> float:
    """Time from rest to rest in at most fifteen phases of constant snap, a mirror image of itself.

    A little longer than the shortest motion within the limits, which has more phases.

    Parameters
    ----------
    way : float
        rad, not negative.
    velocity, acceleration, jerk, snap : float
        Limits, rad/s to rad/s⁴; jerk and snap finite.

    Returns
    -------
    float
        s.

    Notes
    -----
    The velocity rises to v as the position of an S-curve does, whose limits are those of the next
    derivatives, in the time T(v). Its rise is the mirror image of itself about its middle, so that
    it takes the way v·T(v)/2, and slowing down as much. The whole is v·T(v) and the cruise.
    """
    if way == 0.0:
        return 0.0

    def rising(speed: float) -> float:
        return s_curve(speed, acceleration, jerk, snap)

    if velocity < inf and velocity * rising(velocity) <= way:
        return rising(velocity) + way / velocity
    # At least 4 cbrt(v/(2 snap)) pass for a rise, so that v·T(v) exceeds the way at twice the speed
    # at which it would be equal then.
    above = min(velocity, 2.0 * (way * cbrt(2.0 * snap) / 4.0) ** 0.75)
    speed = float(brentq(lambda v: v * rising(v) - way, 0.0, above, xtol=_RTOL * above, rtol=_RTOL))
    return 2.0 * rising(speed)


_RTOL = 4.0 * float(np.finfo(float).eps)
"""The smallest relative tolerance of a root that `scipy` takes."""
PROFILES: dict[str, Callable[..., float]] = {
    "trapezoidal": trapezoidal,
    "s-curve": s_curve,
    "sine-jerk": sine_jerk,
    "fourth-order": fourth_order,
}
"""The time of each profile: longer for a longer way, shorter for larger limits."""


def shortest(profile: str, ways: Array, limits: Array) -> float:
    """Shortest total through way-points at rest, each segment as long as its slowest joint needs.

    Parameters
    ----------
    profile : str
        A key of `PROFILES`.
    ways : ndarray, shape (segments, joints)
        rad, not negative.
    limits : ndarray, shape (joints, 3) or (joints, 4)
        Of velocity, acceleration and jerk, and of deceleration or of snap.

    Returns
    -------
    float
        s.
    """
    each = [
        [_time(profile, float(w), own) for w, own in zip(row, limits, strict=True)] for row in ways
    ]
    return float(np.max(each, axis=1).sum())


def shortest_straight(profile: str, ways: Array, limits: Array) -> float:
    """Shortest total where all joints follow one time law, on a straight line in each segment.

    Joint j moves by way_j·s(t) while s goes from 0 to 1 by the profile, so that the derivatives of
    s keep the smallest limit_j/way_j over the joints that move.

    Parameters
    ----------
    profile : str
        A key of `PROFILES`.
    ways : ndarray, shape (segments, joints)
        rad, not negative.
    limits : ndarray, shape (joints, 3) or (joints, 4)
        Of velocity, acceleration and jerk, and of deceleration or of snap.

    Returns
    -------
    float
        s.
    """
    total = 0.0
    for row in ways:
        moving = row > 0.0
        if moving.any():
            total += _time(profile, 1.0, (limits[moving] / row[moving, None]).min(axis=0))
    return total


def _time(profile: str, way: float, limits: Array) -> float:
    """Time of one segment, infinite where a joint moves that must not."""
    if way > 0.0 and not (limits > 0.0).all():
        return inf
    known = limits if profile in ("trapezoidal", "fourth-order") else limits[:3]
    return PROFILES[profile](way, *map(float, known))
