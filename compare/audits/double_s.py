"""The double S of Biagiotti and Melchiorri (2008), section 3.4, as their algorithm makes it."""

from __future__ import annotations

from itertools import repeat
from math import inf, sqrt

from .axis_profile import AxisProfile, AxisState, Phase, Sizes

_GAMMA = 0.99
"""Factor by which the book shrinks the acceleration until its formulas close: with it, Example 3.11
ends at the printed 6.9641 = 10·0.99³⁶."""
_TRIALS = 10_000
"""Bound of that loop; 0.99¹⁰⁰⁰⁰ is 10⁻⁴⁴."""


def double_s(start: AxisState, finish: AxisState, sizes: Sizes) -> AxisProfile | None:
    """The profile of the algorithm, which is not the shortest where it shrinks the acceleration.

    Parameters
    ----------
    start, finish : AxisState
        Accelerations of 0, velocities within the limit.
    sizes : Sizes
        Finite.

    Returns
    -------
    AxisProfile or None
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
    for _ in repeat(None, _TRIALS):
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
        size *= _GAMMA
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
