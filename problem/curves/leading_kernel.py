"""Compiled kernel of piecewise polynomials: the peaks that decide, and bounds of all others."""

from __future__ import annotations

import numpy as np

from .kernel import LANES, MAX_COEFFICIENTS, compiled, fit_coefficients, lane_peaks, take_durations

BEYOND_ROUNDING = 1e-12
"""Share of a polynomial's coefficients that is added to a bound: a thousand times the rounding of
bound and peak, and far below what any bound is loose by."""
MARGIN = 1e-9
"""Share by which a bound must stay below what another peak has: roots and quotients round less."""


@compiled
def _bounds(a, degree, perm, lanes, room, end, low, high):  # type: ignore[no-untyped-def]
    """Sizes that the peaks of ``a[power, lane]`` on [0, 1] are not below, and not above.

    The ends, summed as `lane_peaks` sums them, and the largest Bernstein coefficient.
    """
    for x in range(lanes):
        end[x] = 0.0
        low[x] = abs(a[0, x])
        high[x] = 0.0
    for i in range(degree + 1):
        share = perm[i, i] / perm[degree, i]
        for x in range(lanes):
            end[x] += a[i, x]
            high[x] += abs(a[i, x])
            room[i, x] = share * a[i, x]
    for x in range(lanes):
        low[x] = low[x] if low[x] >= abs(end[x]) else abs(end[x])
        high[x] = BEYOND_ROUNDING * high[x]
        end[x] = low[x]
    for step in range(1, degree + 1):
        for i in range(degree, step - 1, -1):
            for x in range(lanes):
                room[i, x] += room[i - 1, x]
    for i in range(1, degree):
        for x in range(lanes):
            end[x] = end[x] if end[x] >= abs(room[i, x]) else abs(room[i, x])
    for x in range(lanes):
        high[x] += end[x]


@compiled
def _rooted(ratio, order):  # type: ignore[no-untyped-def]
    """Stretch of all durations that makes a ratio of this derivative 1."""
    return ratio if order == 1 else (np.sqrt(ratio) if order == 2 else np.cbrt(ratio))


@compiled
def leading_peaks(  # type: ignore[no-untyped-def]
    durations, values, kinds, breaks, orders, degrees, column, lower, upper, perm, wanted,
    ceilings, floor, peaks,
):  # fmt: skip
    """Find those peaks of each vector that lead; the others may come out too small.

    A vector's stretch is the largest of ``(peak / ceilings[joint, order − 1])^(1 / order)``; it is
    as if all peaks were true wherever it is above ``floor``, and not above it otherwise. The rest
    as in `kernel.batch_peaks`, whose bits the peaks have that are found. Lanes are looked at once
    by their bounds, and those that may lead are gathered side by side.
    """
    n, joints, unknowns = degrees.size, values.shape[1], column.max() + 1
    block = min(max(1, LANES // joints), durations.shape[0])
    h = np.empty((n, block))
    system = np.empty((unknowns, 2 * lower + upper + 1, block))
    right = np.empty((unknowns, joints * block))
    scaled = np.empty((n, MAX_COEFFICIENTS, joints * block))
    a = np.empty((MAX_COEFFICIENTS, joints * block))
    cuts = np.empty((MAX_COEFFICIENTS, joints * block))
    peak = np.empty(joints * block)
    tops = np.empty((3, n, joints * block))
    rates = np.empty((3, n, block))
    least = np.empty(block)
    chosen = np.empty(joints * block, np.int64)
    room = np.empty((8, joints * block))
    state = (room[0], room[1], room[2], room[3], room[4], room[5], room[6], room[7])
    for first in range(0, durations.shape[0], max(1, block)):
        vectors = min(block, durations.shape[0] - first)
        for v in range(vectors):
            peaks[first + v] = 0.0 if take_durations(durations[first + v], h, v) else np.inf
            least[v] = floor
        fit_coefficients(
            h, vectors, values, kinds, breaks, orders, degrees, column, lower, upper, perm,
            system, right, scaled,
        )  # fmt: skip
        for r in range(1, 4):
            if not wanted[:, r - 1].any():
                continue
            for k in range(n):
                degree = degrees[k] - r
                if degree < 0:
                    continue
                for v in range(vectors):
                    rate = 1.0 / h[k, v]
                    for _ in range(r - 1):
                        rate *= 1.0 / h[k, v]
                    rates[r - 1, k, v] = rate
                for i in range(degree + 1):
                    for x in range(joints * vectors):
                        a[i, x] = perm[i + r, r] * scaled[k, i + r, x]
                _bounds(a, degree, perm, joints * vectors, cuts, room[0], peak, tops[r - 1, k])
                for j in range(joints if degree > 0 else 0):
                    for v in range(vectors if wanted[j, r - 1] else 0):
                        top = peak[j * vectors + v] * rates[r - 1, k, v]
                        if top > peaks[first + v, j, r - 1]:
                            peaks[first + v, j, r - 1] = top
            for j in range(joints):
                ceiling = ceilings[j, r - 1] if wanted[j, r - 1] else 0.0
                for v in range(vectors if ceiling > 0.0 else 0):
                    stretch = _rooted(peaks[first + v, j, r - 1] / ceiling, r)
                    least[v] = max(least[v], stretch)
        for r in range(3, 0, -1):
            for k in range(n if wanted[:, r - 1].any() else 0):
                degree = degrees[k] - r
                if degree < 0:
                    continue
                count = 0
                for j in range(joints):
                    for v in range(vectors if wanted[j, r - 1] else 0):
                        x = j * vectors + v
                        below = ceilings[j, r - 1] * (1.0 - MARGIN)
                        for _ in range(r):
                            below *= least[v]
                        # What is not a number is looked at.
                        if not tops[r - 1, k, x] * rates[r - 1, k, v] < below:
                            chosen[count] = x
                            count += 1
                if count == 0:
                    continue
                for i in range(degree + 1):
                    for c in range(count):
                        a[i, c] = perm[i + r, r] * scaled[k, i + r, chosen[c]]
                lane_peaks(a, degree, perm, count, cuts, state, 0.0, peak)
                for c in range(count):
                    j, v = chosen[c] // vectors, chosen[c] % vectors
                    top = peak[c] * rates[r - 1, k, v]
                    if not top <= peaks[first + v, j, r - 1]:
                        peaks[first + v, j, r - 1] = top if top == top else np.inf
                    if ceilings[j, r - 1] > 0.0:
                        stretch = _rooted(peaks[first + v, j, r - 1] / ceilings[j, r - 1], r)
                        least[v] = max(least[v], stretch)
