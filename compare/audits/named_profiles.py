"""Profiles by their names: the shortest of one axis, those that are longer, and times from rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import repeat
from math import cbrt, copysign, inf, pi, sqrt

import numpy as np
from scipy.optimize import brentq

from ...problem import Array
from .axis_profile import AxisProfile, AxisState, Phase, Sizes, shortest_s_curve, shortest_trapezoid
from .rounding import FEW_ROUNDINGS


def double_s(start: AxisState, finish: AxisState, sizes: Sizes) -> AxisProfile | None:
    """The profile of the algorithm, which is not the shortest where it shrinks the acceleration.

    Its ends have no acceleration and velocities within the limit, and its sizes are finite. It is
    None if the algorithm has no answer.

    Notes
    -----
    With h, v₀ and v₁ the way and the velocities at the ends, seen so that h > 0. If the velocity
    reaches V, speeding up takes T_a = 2√((V − v₀)/J), or A/J + (V − v₀)/A where A is reached, and
    slowing down T_d alike. Else A is reached on both sides, with Δ = A⁴/J² + 2(v₀² + v₁²) +
    A(4h − 2(A/J)(v₀ + v₁)): T_a = (A²/J − 2v₀ + √Δ)/(2A), and T_d with v₁. While T_a or T_d is
    shorter than 2A/J, A is shrunk. If one of them falls below 0 it is left out, and the other is
    2h/(v₀ + v₁).
    """
    way, top, jerk = finish.position - start.position, sizes.velocity, sizes.jerk
    if way < 0.0:
        mirror = double_s(start.mirrored(), finish.mirrored(), sizes)
        return None if mirror is None else mirror.mirrored()
    v0, v1 = start.velocity, finish.velocity
    if way == 0.0 or max(abs(v0), abs(v1)) > top or inf in (top, sizes.acceleration):
        return None
    ramps, lengths = zip(*(_to_speed(top - v, sizes) for v in (v0, v1)), strict=True)
    cruise = (way - sum((top + v) / 2.0 * t for v, t in zip((v0, v1), lengths, strict=True))) / top
    if cruise > 0.0:
        return _of_parts(start, (*lengths,), (*ramps,), cruise, jerk)
    size = sizes.acceleration
    for _ in repeat(None, 10_000):  # 0.99¹⁰⁰⁰⁰ is 10⁻⁴⁴
        ramp = size / jerk
        root = (
            size**4 / jerk**2 + 2.0 * (v0**2 + v1**2) + size * (4.0 * way - 2.0 * ramp * (v0 + v1))
        )
        if root < 0.0:
            return None
        both = [(size * ramp - 2.0 * v + sqrt(root)) / (2.0 * size) for v in (v0, v1)]
        if min(both) < 0.0:
            return _one_sided(start, way, v1, jerk, falling=both[0] < 0.0)
        if min(both) >= 2.0 * ramp:
            return _of_parts(start, (*both,), (ramp, ramp), 0.0, jerk)
        # With the book's factor, its Example 3.11 ends at the printed 6.9641 = 10·0.99³⁶.
        size *= 0.99
    return None


def _to_speed(change: float, sizes: Sizes) -> tuple[float, float]:
    """Time of the jerk, and of the whole change of velocity from rest of the acceleration to it."""
    if change * sizes.jerk < sizes.acceleration**2:
        ramp = sqrt(max(0.0, change) / sizes.jerk)
        return ramp, 2.0 * ramp
    ramp = sizes.acceleration / sizes.jerk
    return ramp, ramp + change / sizes.acceleration


def _one_sided(
    start: AxisState, way: float, last: float, jerk: float, falling: bool
) -> AxisProfile | None:
    """Equations 3.38 and 3.39 of the book: the velocity changes once, over the whole way."""
    total = start.velocity + last
    change = (last - start.velocity) * (1.0 if falling else -1.0)
    inside = jerk * (jerk * way**2 + total**2 * change)
    if total <= 0.0 or inside < 0.0:
        return None
    length, ramp = 2.0 * way / total, (jerk * way - sqrt(inside)) / (jerk * total)
    if falling:
        return _of_parts(start, (0.0, length), (0.0, ramp), 0.0, jerk)
    return _of_parts(start, (length, 0.0), (ramp, 0.0), 0.0, jerk)


def _of_parts(
    start: AxisState,
    lengths: tuple[float, ...],
    ramps: tuple[float, ...],
    cruise: float,
    jerk: float,
) -> AxisProfile:
    """Seven phases: ramp, constant acceleration and ramp on both sides of the cruise."""
    phases: list[Phase] = []
    for sign, length, ramp in zip((1.0, -1.0), lengths, ramps, strict=True):
        peak = sign * ramp * jerk
        phases += [
            Phase(ramp, 0.0, sign * jerk),
            Phase(length - 2.0 * ramp, peak),
            Phase(ramp, peak, -sign * jerk),
        ]
        if sign > 0.0:
            phases.append(Phase(cruise, 0.0))
    return AxisProfile(start, tuple(phases))


def jerk_impulses(start: AxisState, finish: AxisState, sizes: Sizes) -> AxisProfile | None:
    """The profile of Riboli et al. (2023, equations 76 to 98) with a plateau speed.

    The acceleration at the start lasts until an impulse of jerk takes it to 0 at the speed of the
    plateau; from there an impulse leads to the acceleration at the finish, which lasts. Where an
    end has another speed and no acceleration, an impulse to the limit of acceleration is added.

    Its phases have the mean jerk of each impulse: times, velocities and accelerations where phases
    meet are right, and positions are not.

    Parameters
    ----------
    sizes : Sizes
        Its jerk is the peak of the impulses, its `own` the plateau.

    Returns
    -------
    AxisProfile or None
        None if a phase would take less than no time, or if there is no limit to ramp up to.
    """
    speed = sizes.own
    ramped = any(end.acceleration == 0.0 and end.velocity != speed for end in (start, finish))
    if not speed or (ramped and sizes.acceleration == inf):
        return None
    first, there = _to_plateau(start.velocity, start.acceleration, speed, sizes)
    # Backwards in time velocities change their sign, and accelerations do not.
    last, back = _to_plateau(-finish.velocity, finish.acceleration, -speed, sizes)
    cruise = (finish.position - start.position - there + back) / speed
    ended = [Phase(p.time, p.acceleration + p.jerk * p.time, -p.jerk) for p in reversed(last)]
    phases = (*first, Phase(cruise, 0.0), *ended)
    least = FEW_ROUNDINGS * sum(abs(one.time) for one in phases)
    return AxisProfile(start, phases) if min(p.time for p in phases) >= -least else None


def _to_plateau(
    velocity: float, acceleration: float, speed: float, sizes: Sizes
) -> tuple[list[Phase], float]:
    """Phases from a state to a speed that is kept, and their way."""
    # The impulse 64 t³(1 − t)³ has the mean 16/35 from 0 to 1, and its largest value is 1.
    jerk, phases, way = (16.0 / 35.0) * sizes.jerk, [], 0.0

    def impulse(end: float) -> None:
        nonlocal velocity, acceleration, way
        change = end - acceleration
        time = abs(change) / jerk
        phases.append(Phase(time, acceleration, copysign(jerk, change)))
        # While such an impulse raises the acceleration from 0 to 1 in the time 1, the way is 5/36.
        way += time * (velocity + time * (acceleration / 2.0 + change * (5.0 / 36.0)))
        velocity += time * (acceleration + end) / 2.0
        acceleration = end

    if acceleration == 0.0 and velocity != speed:
        impulse(copysign(sizes.acceleration, speed - velocity))
    if acceleration != 0.0:
        left = speed - velocity - acceleration * abs(acceleration) / (2.0 * jerk)
        time = left / acceleration
        phases.append(Phase(time, acceleration))
        way += time * (velocity + time * acceleration / 2.0)
        velocity += time * acceleration
        impulse(0.0)
    return phases, way


SHORTEST: dict[str, Callable[[AxisState, AxisState, Sizes], AxisProfile | None]] = {
    "trapezoidal": shortest_trapezoid,
    "s-curve": shortest_s_curve,
    "biagiotti-melchiorri": double_s,
    "jerk-impulses": jerk_impulses,
}
"""The motion of one axis between two states by the name of its profile."""
ALGORITHM = "biagiotti-melchiorri"
"""The profile of an algorithm that is set beside the shortest within the same limits."""
PRESCRIBED = "jerk-impulses"
"""The profile that its numbers determine, whatever is shorter."""
NOT_SHORTEST = {
    "biagiotti-melchiorri": "{} of Biagiotti and Melchiorri's algorithm",
    "fourth-order": "fourth-order {}",
    "jerk-impulses": "{} of jerk impulses",
}
"""Profiles than which a motion within the same limits may be shorter, as sentences call them."""


def profile_called(profiles: Sequence[str], noun: str = "profile") -> str:
    """What a sentence calls some profiles, after "the"; the noun may be plural."""
    shortest = [one for one in profiles if one not in NOT_SHORTEST]
    said = [f"shortest {' or '.join(shortest)} {noun}"] if shortest else []
    others = [NOT_SHORTEST[one].format(noun) for one in profiles if one in NOT_SHORTEST]
    return " or ".join(said + others)


# --- times from rest to rest ----------------------------------------------------------------------


def trapezoidal(way: float, *limits: float) -> float:
    """Shortest time (s) within limits of velocity and acceleration; the fourth is of braking."""
    found = shortest_trapezoid(AxisState(0.0), AxisState(way), Sizes(*limits))
    return inf if found is None else found.total_time


def s_curve(way: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time (s) with a jerk that is constant in at most seven phases."""
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
    """Shortest time (s) in seven phases whose jerk is a half sine on each ramp.

    Notes
    -----
    On a ramp of length τ the jerk is J sin(πt/τ), and the acceleration changes by ∫ = 2Jτ/π, as by
    a constant jerk of 2J/π. It is (Jτ/π)(1 − cos(πt/τ)), which with its mirror image about the
    middle of the ramp sums to the whole change, as a straight line does: velocity changes by the
    same amount over the ramp. Both profiles are mirror images about the middle of each half and of
    the whole, so the ways are half of velocity times time in both. The shortest total is that
    of the S-curve within 2/π of the jerk limit.
    """
    return s_curve(way, velocity, acceleration, 2.0 / pi * jerk)


def fourth_order(
    way: float, velocity: float, acceleration: float, jerk: float, snap: float
) -> float:
    """Time (s) in at most fifteen phases of constant snap, a mirror image of itself.

    A little longer than the shortest motion within the limits, which has more phases.

    Notes
    -----
    The velocity rises to v as the position of an S-curve does, whose limits are those of the next
    derivatives, in the time T(v). Its rise is the mirror image of itself about its middle, so
    it takes the way v·T(v)/2, and slowing down as much. The whole is v·T(v) and the cruise.
    """

    def rising(speed: float) -> float:
        return s_curve(speed, acceleration, jerk, snap)

    if velocity < inf and velocity * rising(velocity) <= way:
        return rising(velocity) + way / velocity
    # At least 4 cbrt(v/(2 snap)) pass for a rise, so v·T(v) exceeds the way at twice the speed
    # at which it would be equal then.
    above = min(velocity, 2.0 * (way * cbrt(2.0 * snap) / 4.0) ** 0.75)
    close = 4.0 * float(np.finfo(float).eps)  # the least that `brentq` takes
    speed = float(brentq(lambda v: v * rising(v) - way, 0.0, above, xtol=close * above, rtol=close))
    return 2.0 * rising(speed)


RESTING: dict[str, Callable[..., float]] = {
    "trapezoidal": trapezoidal,
    "s-curve": s_curve,
    "sine-jerk": sine_jerk,
    "fourth-order": fourth_order,
}
"""Times of profiles from rest to rest: longer for longer ways, shorter for larger limits."""


def resting_total(profile: str, ways: Array, limits: Array, straight: bool = False) -> float:
    """Total (s) through way-points at rest.

    Each segment takes as long as its slowest joint needs. On a straight line joint j moves by
    way_j·s(t), while s goes from 0 to 1 by the profile, so the derivatives of s keep the
    smallest limit_j/way_j over the joints that move.

    Parameters
    ----------
    ways : ndarray, shape (segments, joints)
        rad, not negative.
    limits : ndarray, shape (joints, 3) or (joints, 4)
        Of velocity, acceleration and jerk, and of deceleration or of snap.
    """
    total = 0.0
    for row in ways:
        each = list(zip(row, limits, strict=True))
        if straight and row.any():
            moving = row > 0.0
            each = [(1.0, (limits[moving] / row[moving, None]).min(axis=0))]
        total += max(_time(profile, float(way), own) for way, own in each)
    return total


def _time(profile: str, way: float, limits: Array) -> float:
    """Time of one segment, infinite if a joint moves whose limit is 0."""
    if way == 0.0:
        return 0.0
    if not (limits > 0.0).all():
        return inf
    known = limits if profile in ("trapezoidal", "fourth-order") else limits[:3]
    return RESTING[profile](way, *map(float, known))
