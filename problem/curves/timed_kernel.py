"""Compiled kernel of curves q(e), t(e): true peaks of the derivatives in time, for batches."""

from __future__ import annotations

import numpy as np

from .kernel import compiled, roots_in_unit

ROOM = 10
"""Length of work arrays: N_4 of two cubics has fewer than 10 coefficients."""


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
def _largest(a, na, speed, order, turning, turns):  # type: ignore[no-untyped-def]
    """Largest |N/t′²ʳ⁻¹| at both ends and at the places given."""
    top = 0.0
    for i in range(turns + 2):
        e = 0.0 if i == turns else (1.0 if i == turns + 1 else turning[i])
        value = 0.0
        for m in range(na - 1, -1, -1):
            value = value * e + a[m]
        t = speed[0] + e * (speed[1] + e * speed[2])
        value = abs(value) / t ** (2 * order - 1)
        if not value <= top:
            top = value
    return top


@compiled
def batch_peaks(durations, shape, clock, wanted, peaks):  # type: ignore[no-untyped-def]
    """Find the true peaks of v, a, j for many duration vectors.

    ``shape[segment, power, joint]`` are the coefficients of q(e), ``clock[segment, power,
    duration]`` those of t(e) per duration. Peaks are infinite where a duration is not positive
    and finite or t′ is not positive somewhere.
    """
    n, joints = shape.shape[0], shape.shape[2]
    speed = np.empty(3)
    first = np.empty(ROOM)
    second = np.empty(ROOM)
    turning = np.empty(ROOM)
    work = np.empty((ROOM, ROOM))
    for v in range(durations.shape[0]):
        valid = True
        for k in range(n):
            valid = valid and 0.0 < durations[v, k] < np.inf
        peaks[v] = 0.0
        for k in range(n):
            if not valid:
                break
            for m in range(3):
                speed[m] = 0.0
                for i in range(n):
                    speed[m] += (m + 1) * clock[k, m + 1, i] * durations[v, i]
            if not least_speed(speed)[0] > 0.0:
                valid = False
                break
            for j in range(joints):
                for m in range(3):
                    first[m] = (m + 1) * shape[k, m + 1, j]
                count = 3
                highest = 0
                for r in range(3):
                    if wanted[j, r]:
                        highest = r + 1
                for r in range(1, highest + 1):
                    follow = next_numerator(first, count, speed, r, second, work)
                    if wanted[j, r - 1]:
                        turns = roots_in_unit(second[:ROOM].copy(), follow - 1, work, turning)
                        top = _largest(first, count, speed, r, turning, turns)
                        if not top <= peaks[v, j, r - 1]:
                            peaks[v, j, r - 1] = top if top == top else np.inf
                    count = follow
                    for m in range(ROOM):
                        first[m] = second[m]
        if not valid:
            peaks[v] = np.inf
