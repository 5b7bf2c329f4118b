"""Compiled kernel of curves q(e), t(e): true peaks of the derivatives in time, for batches."""

from __future__ import annotations

import numpy as np

from .kernel import compiled, roots_in_unit

ROOM = 10
"""Length of work arrays: N_4 of two cubics has fewer than 10 coefficients."""
_BEYOND_ROUNDING = 1e-12
"""Relative margin by which a bound must decide: far above what rounding moves in ten terms, so that
what is left out by it would not have changed one bit."""


@compiled
def _times(a, na, b, nb, out):  # type: ignore[no-untyped-def]
    """Product of two polynomials with ``na`` and ``nb`` coefficients; returns their number."""
    for i in range(na + nb - 1):
        out[i] = 0.0
    for i in range(na):
        for k in range(nb):
            out[i + k] += a[i] * b[k]
    return na + nb - 1


@compiled
def next_numerator(a, na, speed, order, out, work):  # type: ignore[no-untyped-def]
    """From N with dʳq/dtʳ = N/t′²ʳ⁻¹ to that of order r + 1: N′ t′ − (2r − 1) N t″.

    ``speed`` holds the three coefficients of t′. The leading term cancels for r = 1 and cubics.
    """
    for i in range(ROOM):
        out[i] = 0.0
    if na > 1:
        for i in range(1, na):
            work[0, i - 1] = i * a[i]
        n = _times(work[0], na - 1, speed, 3, work[1])
        for i in range(n):
            out[i] += work[1, i]
    work[0, 0] = speed[1]
    work[0, 1] = 2.0 * speed[2]
    n = _times(a, na, work[0], 2, work[1])
    for i in range(n):
        out[i] -= (2.0 * order - 1.0) * work[1, i]
    return 3 if order == 1 else n


@compiled
def least_speed(speed):  # type: ignore[no-untyped-def]
    """Smallest value on [0, 1] of the quadratic t′, with its place."""
    best, at = speed[0], 0.0
    end = speed[0] + speed[1] + speed[2]
    if end < best:
        best, at = end, 1.0
    if speed[2] > 0.0:
        turn = -0.5 * speed[1] / speed[2]
        if 0.0 < turn < 1.0:
            value = speed[0] + turn * (speed[1] + turn * speed[2])
            if value < best:
                best, at = value, turn
    return best, at


@compiled
def _power(x, n):  # type: ignore[no-untyped-def]
    """xⁿ for n ≥ 1 by squaring, as compiled code has it: Python's own ** rounds otherwise."""
    result = 1.0
    while n > 0:
        if n % 2 == 1:
            result *= x
        x *= x
        n //= 2
    return result


@compiled
def _bounded(a, b, c, room, first, last, least, power):  # type: ignore[no-untyped-def]
    """Numbers that the peak of |a + b e + c e²| / t′ⁿ on a piece is not below, and not above.

    ``first``, ``last`` and ``least`` are reciprocals of t′ at both ends and where it is smallest.
    """
    start, end = abs(a), abs(a + b + c)
    low = (start - room) * _power(first, power)
    other = (end - room) * _power(last, power)
    low = low if low >= other else other
    top = abs(a + 0.5 * b)  # with both ends the Bernstein coefficients
    top = top if top >= start else start
    top = top if top >= end else end
    high = (top + room) * _power(least, power)
    return low * (1.0 - _BEYOND_ROUNDING), high * (1.0 + _BEYOND_ROUNDING)


@compiled
def _bounds(shape, speeds, inverse, k, j, order):  # type: ignore[no-untyped-def]
    """Numbers that the peak of order 1 or 2 on a piece is not below, and not above."""
    a, b, c = shape[k, 1, j], 2.0 * shape[k, 2, j], 3.0 * shape[k, 3, j]
    first, last, least = inverse[k, 0], inverse[k, 1], inverse[k, 2]
    if order == 1:
        room = _BEYOND_ROUNDING * (abs(a) + abs(b) + abs(c))
        return _bounded(a, b, c, room, first, last, least, 1)
    s, t, u = speeds[k, 0], speeds[k, 1], speeds[k, 2]
    size = (abs(a) + abs(b) + abs(c)) * (abs(s) + abs(t) + abs(u))
    room = 8.0 * _BEYOND_ROUNDING * size
    # N_2 = q″t′ − q′t″, a quadratic for two cubics
    a, b, c = b * s - a * t, 2.0 * (c * s - a * u), c * t - b * u
    return _bounded(a, b, c, room, first, last, least, 3)


@compiled
def _largest(a, na, speed, order, turning, turns):  # type: ignore[no-untyped-def]
    """Largest |N/t′²ʳ⁻¹| at both ends and at the places given."""
    top = 0.0
    for i in range(turns + 2):
        e = 0.0 if i == turns else (1.0 if i == turns + 1 else turning[i])
        value = 0.0
        for m in range(na - 1, -1, -1):
            value = value * e + a[m]
        t = speed[0] + e * (speed[1] + e * speed[2])
        value = abs(value) / _power(t, 2 * order - 1)
        if not value <= top:
            top = value
    return top


@compiled
def _all_speeds(rates, durations, speeds):  # type: ignore[no-untyped-def]
    """Coefficients of t′ on every piece, and its least value; whether that is positive on all."""
    for k in range(rates.shape[0]):
        for m in range(3):
            speed = 0.0
            for i in range(durations.size):
                speed += rates[k, m, i] * durations[i]
            speeds[k, m] = speed
        speeds[k, 3] = least_speed(speeds[k])[0]
        if not speeds[k, 3] > 0.0:
            return False
    return True


@compiled
def batch_peaks(durations, shape, clock, wanted, low, high, peaks):  # type: ignore[no-untyped-def]
    """Find the true peaks of v, a, j for many duration vectors.

    ``shape[segment, power, joint]`` are the coefficients of q(e), ``clock[segment, power,
    duration]`` those of t(e) per duration. Peaks are infinite where a duration is not positive
    and finite or t′ is not positive somewhere. A piece whose velocity and acceleration provably
    stay below what another piece has at one of its ends is not looked at further.

    Velocities and accelerations below ``low[joint, order − 1]`` may come out too small, a vector
    with one above ``high`` may come out infinite in all: 0 and infinity for true peaks.
    """
    n, joints = shape.shape[0], shape.shape[2]
    rates = np.empty((n, 3, clock.shape[2]))
    for m in range(3):
        rates[:, m] = (m + 1) * clock[:, m + 1]
    speeds = np.empty((n, 4))
    inverse = np.empty((n, 3))
    floors = np.empty((joints, 2))
    tops = np.empty((joints, 2, n))
    open_ = np.ones(3, np.bool_)
    first = np.empty(ROOM)
    second = np.empty(ROOM)
    turning = np.empty(ROOM)
    work = np.empty((ROOM, ROOM))
    for v in range(durations.shape[0]):
        valid = True
        for k in range(n):
            valid = valid and 0.0 < durations[v, k] < np.inf
        if not (valid and _all_speeds(rates, durations[v], speeds)):
            peaks[v] = np.inf
            continue
        for k in range(n):
            inverse[k, 0] = 1.0 / speeds[k, 0]
            inverse[k, 1] = 1.0 / (speeds[k, 0] + speeds[k, 1] + speeds[k, 2])
            inverse[k, 2] = 1.0 / speeds[k, 3]
        kept = True
        for j in range(joints):
            for r in range(1, 3):
                floor = low[j, r - 1]
                for k in range(n if kept and wanted[j, r - 1] else 0):
                    least, tops[j, r - 1, k] = _bounds(shape, speeds, inverse, k, j, r)
                    floor = floor if floor >= least else least
                floors[j, r - 1] = floor
                kept = kept and not floor > high[j, r - 1]
        peaks[v] = 0.0 if kept else np.inf
        for j in range(joints):
            for k in range(n if kept else 0):
                open_[0] = wanted[j, 0] and not tops[j, 0, k] < floors[j, 0]
                open_[1] = wanted[j, 1] and not tops[j, 1, k] < floors[j, 1]
                highest = 3 if wanted[j, 2] else (2 if open_[1] else (1 if open_[0] else 0))
                if highest == 0:
                    continue
                speed = speeds[k]
                for m in range(3):
                    first[m] = (m + 1) * shape[k, m + 1, j]
                count = 3
                for r in range(1, highest + 1):
                    follow = next_numerator(first, count, speed, r, second, work)
                    if open_[r - 1]:
                        turns = roots_in_unit(second, follow - 1, work, turning)
                        top = _largest(first, count, speed, r, turning, turns)
                        if not top <= peaks[v, j, r - 1]:
                            peaks[v, j, r - 1] = top if top == top else np.inf
                        kept = kept and not top > high[j, r - 1]
                    count = follow
                    for m in range(count):
                        first[m] = second[m]
