"""The shortest profile of one axis between two states: constant acceleration, or constant jerk."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import dropwhile
from math import cbrt, copysign, inf, isfinite, sqrt
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from .rounding import FEW_ROUNDINGS, ROUNDING


class AxisState(NamedTuple):
    """Position, velocity and acceleration of an axis, rad and s."""

    position: float
    velocity: float = 0.0
    acceleration: float = 0.0

    def mirrored(self) -> AxisState:
        """The state seen from the other side."""
        return AxisState(-self.position, -self.velocity, -self.acceleration)


class Sizes(NamedTuple):
    """Limits of an axis on both sides, rad and s; may be infinite."""

    velocity: float
    acceleration: float
    jerk: float
    own: float | None = None
    """What the profile alone has: a limit of the acceleration while the speed falls, or the
    velocity of a plateau."""

    @property
    def braking(self) -> float:
        """Largest acceleration against the velocity."""
        return self.acceleration if self.own is None else self.own


class Phase(NamedTuple):
    """A time in which the jerk is constant: its length, and acceleration and jerk at its start."""

    time: float
    acceleration: float
    jerk: float = 0.0


@dataclass(frozen=True)
class AxisProfile:
    """A motion of one axis in phases of constant jerk."""

    start: AxisState
    phases: tuple[Phase, ...]

    @property
    def total_time(self) -> float:
        """Its length, s."""
        return sum(phase.time for phase in self.phases)

    def at(self, time: float) -> AxisState:
        """The state at a time from the start, s; where the acceleration jumps, that before."""
        position, velocity, acceleration = self.start
        left = time
        for phase in self.phases:
            acceleration, jerk = phase.acceleration, phase.jerk
            t = max(0.0, min(phase.time, left))
            position += t * (velocity + t * (acceleration / 2.0 + t * jerk / 6.0))
            velocity += t * (acceleration + t * jerk / 2.0)
            acceleration += t * jerk
            left -= phase.time
            if left <= 0.0:
                break
        return AxisState(position, velocity, acceleration)

    @property
    def corners(self) -> tuple[AxisState, ...]:
        """The states where phases meet, and where velocity or position turns within one."""
        found = [self.start]
        for phase in self.phases:
            own = AxisProfile(found[-1], (phase,))
            turns = np.roots([phase.jerk / 2.0, phase.acceleration, found[-1].velocity])
            times = [float(t.real) for t in turns if t.imag == 0.0]
            if phase.jerk:
                times.append(-phase.acceleration / phase.jerk)
            times = [t for t in sorted(times) if 0.0 < t < phase.time]
            found += [own.at(t) for t in (*times, phase.time)]
        return tuple(found)

    def then(self, other: AxisProfile) -> AxisProfile:
        """The motion, and after it another that starts where it ends."""
        return AxisProfile(self.start, (*self.phases, *other.phases))

    def mirrored(self) -> AxisProfile:
        """The motion seen from the other side."""
        phases = tuple(Phase(p.time, -p.acceleration, -p.jerk) for p in self.phases)
        return AxisProfile(self.start.mirrored(), phases)


def shortest_trapezoid(start: AxisState, finish: AxisState, sizes: Sizes) -> AxisProfile | None:
    """The shortest of `trapezoids`; None if no motion keeps the limits."""
    return min(trapezoids(start, finish, sizes), key=_length, default=None)


def _length(profile: AxisProfile) -> float:
    return profile.total_time


def trapezoids(
    start: AxisState, finish: AxisState, sizes: Sizes, total: float | None = None
) -> list[AxisProfile]:
    """The motions of limited acceleration that come farthest in their time, on either side.

    The velocity rises to one value v, stays and falls, or the other way round. Rising through dv
    takes the way v dv/a with a = A where the speed grows and a = D where it falls, so rising
    from u to v takes g(v) − g(u), and falling from v to w takes g(−v) − g(−w), where g(v) is
    v²/(2A) for positive v and v²/(2D) for others. Accelerations of the states do not count.

    Parameters
    ----------
    sizes : Sizes
        A start above the velocity limit is braked into it first.
    total : float or None
        If given, the motions take this time (s) and end elsewhere; otherwise they end at the goal.
    """
    top = sizes.velocity
    if abs(finish.velocity) > top:
        return []
    if abs(start.velocity) > top:
        first = _ramp(start, copysign(top, start.velocity), sizes)
        left = None if total is None else total - first.total_time
        return [first.then(one) for one in trapezoids(first.at(inf), finish, sizes, left)]
    change = _ramp(start, finish.velocity, sizes).total_time
    slack = 0.0 if total is None else total - change
    if slack < -FEW_ROUNDINGS * change:
        return []
    found = []
    for sign in (1.0, -1.0):
        begin, last = _seen(start, finish, sign)
        least = max(begin.velocity, last.velocity)
        if total is None:
            peaks = _speed(begin, last, sizes)
        else:
            # A higher peak takes longer by its distance over A and over D, whatever its sign.
            pace = 1.0 / sizes.acceleration + 1.0 / sizes.braking
            peak = min(top, least + max(0.0, slack) / pace) if pace else top
            peaks = [(peak, max(0.0, slack - (peak - least) * pace))]
        for peak, cruise in peaks:
            rising = _ramp(begin, peak, sizes)
            held = rising.then(AxisProfile(rising.at(inf), (Phase(cruise, 0.0),)))
            one = held.then(_ramp(held.at(inf), last.velocity, sizes))
            found.append(one if sign > 0.0 else one.mirrored())
    return found


def _speed(start: AxisState, finish: AxisState, sizes: Sizes) -> list[tuple[float, float]]:
    """Largest velocity of the motion to the goal that rises first, and how long it lasts.

    The list is empty if there is none. Of two such motions it is the longer one: from the time of
    the other one on, the axis cannot arrive.
    """

    def way(velocity: float) -> float:
        size = sizes.acceleration if velocity > 0.0 else sizes.braking
        return velocity**2 / (2.0 * size) if velocity else 0.0

    parts = (finish.position - start.position, way(start.velocity), way(-finish.velocity))
    needed = sum(parts)
    if needed < -FEW_ROUNDINGS * max(map(abs, parts)):
        return []
    bend = 1.0 / (2.0 * sizes.acceleration) + 1.0 / (2.0 * sizes.braking)
    least, top = max(start.velocity, finish.velocity), sizes.velocity
    if bend * top**2 < needed:
        return [(top, (needed - top**2 * bend) / top)]
    room = FEW_ROUNDINGS * max(abs(start.velocity), abs(finish.velocity))
    peak = sqrt(max(needed, 0.0) / bend) if bend else 0.0
    return [(max(peak, least), 0.0)] if peak >= least - room else []


def _ramp(start: AxisState, velocity: float, sizes: Sizes) -> AxisProfile:
    """Change of the velocity alone: the speed falls to 0 first where the sign changes."""
    now, phases = start.velocity, []
    up = copysign(1.0, velocity - now)
    if now * up < 0.0:
        turn = min(0.0, velocity * up) * up
        phases.append(Phase(abs(turn - now) / sizes.braking, up * sizes.braking))
        now = turn
    if velocity != now:
        phases.append(Phase(abs(velocity - now) / sizes.acceleration, up * sizes.acceleration))
    return AxisProfile(start, tuple(phases))


def shortest_s_curve(start: AxisState, finish: AxisState, sizes: Sizes) -> AxisProfile | None:
    """The shortest of `s_curves`; None if there is none."""
    return min(s_curves(start, finish, sizes), key=_length, default=None)


def s_curves(
    start: AxisState, finish: AxisState, sizes: Sizes, total: float | None = None
) -> list[AxisProfile]:
    """The motions of limited jerk that come farthest in their time, on either side.

    The jerk is at its limit or 0. Either the velocity reaches its limit, and then the motion goes
    to that speed as fast as it can, keeps it and leaves it as fast as it can; or the acceleration
    rises to a peak p, falls to a trough m and rises to its last value, or the other way round, and
    stays a while at p or m where that is at the limit. The shortest motion is one of them.

    Parameters
    ----------
    sizes : Sizes
        Finite jerk. A start outside the limits of velocity or acceleration, or on the way out of
        them, is braked into them first, as far as it does not leave them on the other side.
    total : float or None
        If given, the motions take this time (s) and end elsewhere; otherwise they end at the goal.

    Returns
    -------
    list of AxisProfile
        Empty if no motion was found: none keeps the limits, or one would leave them on the other
        side while it is braked into them.
    """
    way = finish.position - start.position
    unit = max(
        cbrt(abs(way) / sizes.jerk),
        *(sqrt(abs(state.velocity) / sizes.jerk) for state in (start, finish)),
        *(abs(state.acceleration) / sizes.jerk for state in (start, finish)),
        0.0 if total is None else total,
    )
    if unit == 0.0:
        return [AxisProfile(start, ())]
    # In units of time and way in which the jerk limit is 1 and no state is larger than 1.
    scale = (sizes.jerk * unit**3, sizes.jerk * unit**2, sizes.jerk * unit)
    first = AxisState(0.0, start.velocity / scale[1], start.acceleration / scale[2])
    last = AxisState(way / scale[0], finish.velocity / scale[1], finish.acceleration / scale[2])
    top, most = sizes.velocity / scale[1], sizes.acceleration / scale[2]
    # An acceleration at the end began at 0 with a velocity nearer to the other limit.
    earlier = last.velocity - copysign(last.acceleration**2 / 2.0, last.acceleration)
    if max(abs(last.velocity), abs(earlier)) > top + FEW_ROUNDINGS:
        return []
    if abs(last.acceleration) > most + FEW_ROUNDINGS:
        return []
    braked = _braked(first, top, most)
    begin = braked.at(inf)
    left = None if total is None else total / unit - braked.total_time
    found = [
        braked.then(one if sign > 0.0 else one.mirrored())
        for sign in (1.0, -1.0)
        for one in _candidates(*_seen(begin, last, sign), top, most, left)
        if _keeps(one, _seen(begin, last, sign)[1], top, most, left)
    ]
    return [
        AxisProfile(
            start,
            tuple(
                Phase(p.time * unit, p.acceleration * scale[2], p.jerk * sizes.jerk)
                for p in one.phases
                if p.time > 0.0
            ),
        )
        for one in found
    ]


def _seen(start: AxisState, finish: AxisState, sign: float) -> tuple[AxisState, AxisState]:
    return (start, finish) if sign > 0.0 else (start.mirrored(), finish.mirrored())


def _braked(first: AxisState, top: float, most: float) -> AxisProfile:
    """What comes before the first state within the limits and not on the way out, jerk 1."""
    for sign in (1.0, -1.0):
        acceleration = sign * first.acceleration
        if acceleration > most + FEW_ROUNDINGS:
            eased = AxisProfile(first, (Phase(acceleration - most, first.acceleration, -sign),))
            return eased.then(_braked(eased.at(inf), top, most))
    for sign in (1.0, -1.0):
        velocity, acceleration = sign * first.velocity, sign * first.acceleration
        # An acceleration that goes to 0 changes the velocity by half its square.
        ahead = velocity + abs(acceleration) * acceleration / 2.0
        if max(velocity, ahead) > top + FEW_ROUNDINGS and ahead > -top - FEW_ROUNDINGS:
            # It falls until v + a t − t²/2 = top, or stays where it is at its own limit; but not
            # so far that it would pass −top before it is 0 again.
            within = sqrt(max(0.0, acceleration**2 + 2.0 * (velocity - top)))
            back = sqrt(max(0.0, acceleration**2 / 2.0 + velocity + top))
            until = acceleration + min(within, back)
            fall = min(until, acceleration + most)
            left = velocity + fall * (acceleration - fall / 2.0) - top
            held = min(left, left + 2.0 * top - most**2 / 2.0) / most if fall < until else 0.0
            phases = (
                Phase(fall, first.acceleration, -sign),
                Phase(max(0.0, held), first.acceleration - sign * fall),
            )
            return AxisProfile(first, phases)
    return AxisProfile(first, ())


def _change(start: AxisState, velocity: float, acceleration: float, most: float) -> AxisProfile:
    """The fastest change of velocity and acceleration, jerk 1.

    The acceleration rises to p and falls, or the other way round. Rising from a to p and falling
    to b changes the velocity by p² − (a² + b²)/2.
    """
    _, v, a = start
    direct = (acceleration**2 - a**2) / 2.0 * copysign(1.0, acceleration - a)
    sign = 1.0 if velocity - v >= direct else -1.0
    square = max(0.0, sign * (velocity - v) + (a**2 + acceleration**2) / 2.0)
    peak = min(sqrt(square), most)
    held = (square - peak**2) / peak if peak > 0.0 else 0.0
    peak = max(peak, sign * a, sign * acceleration)
    return AxisProfile(
        start,
        (
            Phase(peak - sign * a, a, sign),
            Phase(held, sign * peak),
            Phase(peak - sign * acceleration, sign * peak, -sign),
        ),
    )


def _candidates(
    start: AxisState, finish: AxisState, top: float, most: float, total: float | None
) -> Iterator[AxisProfile]:
    """The motions that go to the largest velocity, or whose acceleration rises first, jerk 1."""
    if isfinite(top):
        first = _change(start, top, 0.0, most)
        leaving = _change(AxisState(0.0, top), finish.velocity, finish.acceleration, most)
        if total is None:
            left = finish.position - first.at(inf).position - leaving.at(inf).position
            time = left / top if top > 0.0 else -inf
        else:
            time = total - first.total_time - leaving.total_time
        cruise = AxisProfile(first.at(inf), (Phase(time, 0.0),))
        yield first.then(cruise).then(leaving)
    for peak, held, trough, kept in _peaks(start, finish, most, total):
        yield AxisProfile(
            start,
            (
                Phase(peak - start.acceleration, start.acceleration, 1.0),
                Phase(held, peak),
                Phase(peak - trough, peak, -1.0),
                Phase(kept, trough),
                Phase(finish.acceleration - trough, trough, 1.0),
            ),
        )


def _peaks(
    start: AxisState, finish: AxisState, most: float, total: float | None
) -> Iterator[tuple[float, float, float, float]]:
    """Peak of the acceleration, the time there, its trough and the time there, at velocity 1.

    With e = v − a²/2 at both ends and K = e₁ − e₀ the velocity asks for p² − m² = K where nothing
    is held. The way is then C + u³/4 + (e₀ + e₁)u − K²/(4u) with u = p − m, p + m = K/u and
    C = v₁a₁ − a₁³/3 − v₀a₀ + a₀³/3. A time h at the limit A adds A·h to p² or m². The time is
    2u + a₁ − a₀ and h.
    """
    (place, v0, a0), (goal, v1, a1) = start, finish
    e0, e1 = v0 - a0**2 / 2.0, v1 - a1**2 / 2.0
    square = e1 - e0
    way = goal - place - (v1 * a1 - a1**3 / 3.0) + (v0 * a0 - a0**3 / 3.0)
    if total is None:
        steps = list(_roots([-(square**2), -4.0 * way, 4.0 * (e0 + e1), 0.0, 1.0]))
    else:
        steps = [(total + a0 - a1) / 2.0]
    for u in steps:
        if u > 0.0:
            yield (square / u + u) / 2.0, 0.0, (square / u - u) / 2.0, 0.0
    if not (isfinite(most) and most > 0.0):
        return
    x = Polynomial([0.0, 1.0])
    held: Sequence[tuple[Polynomial | float, ...]] = (
        (most, (square + x**2 - most**2) / most, x, 0.0),
        (x, 0.0, -most, (x**2 - square - most**2) / most),
        (most, x, -most, x - square / most),
    )
    for peak, high, trough, low in held:
        lengths = (peak - a0, high, peak - trough, low, a1 - trough)
        if total is None:
            miss, velocity = Polynomial([place - goal]), Polynomial([v0])
            states = zip(lengths, (a0, peak, peak, trough, trough), (1, 0, -1, 0, 1), strict=True)
            for t, a, jerk in states:
                miss = miss + t * (velocity + t * (a / 2.0 + t * jerk / 6.0))
                velocity = velocity + t * (a + t * jerk / 2.0)
        else:
            miss = Polynomial([-total])
            for t in lengths:
                miss = miss + t
        for root in _roots(list(miss.coef)):
            yield tuple(  # type: ignore[misc]
                one(root) if isinstance(one, Polynomial) else one
                for one in (peak, high, trough, low)
            )


def _roots(coefficients: Sequence[float]) -> Iterator[float]:
    """Real parts of the roots that may be real, the lowest power first, after a Newton step."""
    polynomial = Polynomial(np.trim_zeros(np.array(coefficients), "b"))
    slope = polynomial.deriv()
    for root in polynomial.roots():
        # Two roots that meet are found off the real line by the root of the rounding.
        if abs(root.imag) > 1e-5 * (1.0 + abs(root.real)):
            continue
        x = float(root.real)
        for _ in range(2):
            bend = float(slope(x))
            step = float(polynomial(x)) / bend if bend else 0.0
            x -= step if abs(step) < 1e-5 * (1.0 + abs(x)) else 0.0
        yield x


def _keeps(
    profile: AxisProfile, finish: AxisState, top: float, most: float, total: float | None
) -> bool:
    """Whether a motion reaches the last state within the limits, where all sizes are about 1.

    It may miss by more than a quartic's roots are rounded by. Where its time is given, its last
    position is not. A velocity that starts above its limit may be so until it is first within.
    """
    if any(phase.time < -ROUNDING for phase in profile.phases):
        return False
    corners = profile.corners
    missed = np.abs(np.subtract(corners[-1], finish))[0 if total is None else 1 :].max()
    return bool(
        missed <= ROUNDING
        and not any(dropwhile(bool, (abs(one.velocity) > top + ROUNDING for one in corners)))
        and all(abs(one.acceleration) <= most + ROUNDING for one in corners)
    )
