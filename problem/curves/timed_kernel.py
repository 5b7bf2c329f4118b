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
def _at_least_at_most(shape, speeds, k, j, order, least):  # type: ignore[no-untyped-def]
    """Numbers that the peak of order 1 or 2 on a piece is not below, or not above."""
    a, b, c = shape[k, 1, j], 2.0 * shape[k, 2, j], 3.0 * shape[k, 3, j]
    s, t, u = speeds[k, 0], speeds[k, 1], speeds[k, 2]
    first, last = s, s + t + u
    room = 0.0
    if order == 2:  # N_2 = q″t′ − q′t″, a quadratic for two cubics
        size = (abs(a) + abs(b) + abs(c)) * (abs(s) + abs(t) + abs(u))
        a, b, c = b * s - a * t, 2.0 * (c * s - a * u), c * t - b * u
        room = 8.0 * _BEYOND_ROUNDING * size
    else:
        room = _BEYOND_ROUNDING * (abs(a) + abs(b) + abs(c))
    if least:
        power = 2 * order - 1
        value = max(
            (abs(a) - room) / _power(first, power), (abs(a + b + c) - room) / _power(last, power)
        )
        return value * (1.0 - _BEYOND_ROUNDING)
    top = max(abs(a), abs(a + b + c), abs(a + 0.5 * b)) + room  # Bernstein coefficients
    return top / _power(speeds[k, 3], 2 * order - 1) * (1.0 + _BEYOND_ROUNDING)


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
def _all_speeds(clock, durations, speeds):  # type: ignore[no-untyped-def]
    """Coefficients of t′ on every piece, and its least value; whether that is positive on all."""
    for k in range(clock.shape[0]):
        for m in range(3):
            speeds[k, m] = 0.0
            for i in range(durations.size):
                speeds[k, m] += (m + 1) * clock[k, m + 1, i] * durations[i]
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
    speeds = np.empty((n, 4))
    floor = np.empty(2)
    open_ = np.empty(3, np.bool_)
    first = np.empty(ROOM)
    second = np.empty(ROOM)
    turning = np.empty(ROOM)
    work = np.empty((ROOM, ROOM))
    for v in range(durations.shape[0]):
        valid = True
        for k in range(n):
            valid = valid and 0.0 < durations[v, k] < np.inf
        if not (valid and _all_speeds(clock, durations[v], speeds)):
            peaks[v] = np.inf
            continue
        peaks[v] = 0.0
        for j in range(joints):
            for r in range(2):
                floor[r] = low[j, r]
            for r in range(1, 3):
                for k in range(n if wanted[j, r - 1] else 0):
                    value = _at_least_at_most(shape, speeds, k, j, r, True)
                    floor[r - 1] = max(floor[r - 1], value)
                if floor[r - 1] > high[j, r - 1]:
                    valid = False
            if not valid:
                peaks[v] = np.inf
                break
            for k in range(n):
                highest = 0
                for r in range(1, 4):
                    below = r < 3 and wanted[j, r - 1]
                    below = (
                        below and _at_least_at_most(shape, speeds, k, j, r, False) < floor[r - 1]
                    )
                    open_[r - 1] = wanted[j, r - 1] and not below
                    if open_[r - 1]:
                        highest = r
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
                    count = follow
                    for m in range(count):
                        first[m] = second[m]
