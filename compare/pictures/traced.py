"""A curve as points to draw, and the stretches of time in which it lies beyond its limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from ...problem import TOLERANCE, Array, Trajectory, extrema

POINTS = 480
"""Points of a curve of many segments, extrema apart: more than a panel has pixels."""
HUGE = 1e300
"""What stands for an error of which nothing is known: beyond every limit."""
Stretches = Sequence[tuple[float, float]]
"""Starts and ends, s."""


def sampled(trajectory: Trajectory, column: int, order: int) -> tuple[Array, Array]:
    """Times and values, with the exact extrema among them and a gap where the curve jumps.

    Shape (samples,): s and rad/sᵒʳᵈᵉʳ (m/sᵒʳᵈᵉʳ of a joint that slides); a value is NaN at a jump.
    If there are more pieces than a panel has pixels, only the exact extrema. `column, order`: joint
    and derivative.
    """
    if len(trajectory.durations) > POINTS:
        places, found = (one[:, :, column] for one in trajectory.turns(order))
        clock = trajectory.times(np.arange(places.shape[1]), places)
        known = ~np.isnan(found.T)
        return thinned(clock.T[known], found.T[known])
    times: list[Array] = []
    values: list[Array] = []
    count = max(8, min(48, POINTS // len(trajectory.durations)))
    turning = extrema(trajectory, column, order)
    scale = max(abs(e.value) for e in turning) or 1.0
    for k, start in enumerate(trajectory.breaks[:-1]):
        own = [e.s for e in turning if e.segment == k]
        s = np.unique(np.concatenate([np.linspace(0.0, 1.0, count + 1), own]))
        v = trajectory.values(k, column, order, s)
        if values and abs(values[-1][-1] - v[0]) > 1e-6 * scale:
            times.append(np.array([start]))
            values.append(np.array([np.nan]))
        times.append(trajectory.times(k, s))
        values.append(v)
    return np.concatenate(times), np.concatenate(values)


def thinned(times: Array, values: Array) -> tuple[Array, Array]:
    """The least and the largest of the values that share a pixel, in order of time."""
    if values.size <= 2 * POINTS:
        return times, values
    edges = np.linspace(0, values.size, POINTS + 1).astype(np.int64)
    kept = [
        place
        for first, last in pairwise(edges.tolist())
        for place in (
            first + int(values[first:last].argmin()),
            first + int(values[first:last].argmax()),
        )
    ]
    at = np.unique([0, *kept, values.size - 1])
    return times[at], values[at]


def beyond(
    trajectory: Trajectory,
    column: int,
    order: int,
    low: float,
    high: float,
    slack: Array | float | None = None,
    braking: float = np.inf,
) -> Stretches:
    """Stretches of time in which a derivative lies beyond its limits, from exact crossings.

    Start and end, s; stretches that touch are joined. If there are more pieces than pixels, pieces
    shorter than a pixel count in whole, and shorter gaps are closed. `column, order`: joint and
    derivative. `low, high`: limits in rad/sᵒʳᵈᵉʳ or m/sᵒʳᵈᵉʳ. `slack`: shape (pieces,), an excess
    up to this does not count; by default the checker's relative tolerance. A negative one counts
    what stays within the limits by less than its size. `braking`: limit of an acceleration while
    the speed falls, where it has one of its own.
    """
    durations, total = trajectory.durations, trajectory.total_time
    if slack is None:
        slack = TOLERANCE * max((abs(x) for x in (low, high) if np.isfinite(x)), default=0.0)
    # Where nothing is known of an error, infinity less infinity would be no number.
    slacks = np.broadcast_to(np.clip(slack, -HUGE, HUGE), durations.shape)
    values = trajectory.turns(order)[1][:, :, column]
    lowest, highest = np.nanmin(values, axis=0), np.nanmax(values, axis=0)
    some = (lowest < max(low, -braking) - slacks) | (highest > min(high, braking) + slacks)
    pixel = total / POINTS if len(durations) > POINTS else 0.0

    def held(k: int, place: float) -> tuple[float, float]:
        """The range on a piece, around a place between roots of the speed."""
        if np.isinf(braking):
            return low - slacks[k], high + slacks[k]
        forth = trajectory.values(k, column, 1, np.array([place]))[0] >= 0
        least, most = (-braking, high) if forth else (low, braking)
        return least - slacks[k], most + slacks[k]

    found: list[tuple[float, float]] = []
    for k in np.nonzero(some)[0].tolist():
        if durations[k] < pixel:
            least, most = held(k, 0.5)
            if lowest[k] < least or highest[k] > most:
                found.append((float(trajectory.breaks[k]), float(trajectory.breaks[k + 1])))
            continue
        sides = np.array([low, -braking]) - slacks[k], np.array([high, braking]) + slacks[k]
        levels = [
            trajectory.level(k, column, order, x)
            for x in np.unique(sides).tolist()
            if np.isfinite(x)
        ]
        if np.isfinite(braking):
            levels.append(trajectory.level(k, column, 1, 0.0))
        for s0, s1 in pairwise([0.0, *sorted(_roots(levels)), 1.0]):
            middle = (s0 + s1) / 2
            least, most = held(k, middle)
            value = float(trajectory.values(k, column, order, np.array([middle]))[0])
            if s1 > s0 and not least <= value <= most:
                t0, t1 = map(float, trajectory.times(k, np.array([s0, s1])))
                found.append((t0, t1))
    return joined_stretches(found, max(pixel, 1e-12 * total))


def _roots(polynomials: Sequence[Array]) -> Iterator[float]:
    """Places in (0, 1) at which any of some polynomials vanishes."""
    for one in polynomials:
        # Leading coefficients that are lost in the digits of the others would divide them.
        told = np.nonzero(np.abs(one) > 1e-16 * np.abs(one).max())[0]
        powers = one[: told[-1] + 1] if told.size else one[:0]
        for root in np.polynomial.polynomial.polyroots(powers) if powers.size else ():
            if abs(root.imag) < 1e-9 and 0 < root.real < 1:
                yield float(root.real)


def joined_stretches(found: Stretches, gap: float) -> Stretches:
    """Stretches in order of time, those joined that are at most a gap apart, s."""
    joined: list[tuple[float, float]] = []
    for start, end in found:
        if joined and start - joined[-1][1] <= gap:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((start, end))
    return joined


def without(stretches: Stretches, others: Stretches, least: float) -> Stretches:
    """What others leave of stretches, both in order of time.

    `least`: what is left beside another stretch counts if it is longer than this, s.
    """
    left: list[tuple[float, float]] = []
    for start, end in stretches:
        at = start
        inner = [one for one in others if one[1] >= start and one[0] <= end]
        for first, last in inner:
            left += [(at, first)] if first - at > least else []
            at = max(at, last)
        left += [(at, end)] if end - at > least or not inner else []
    return left
