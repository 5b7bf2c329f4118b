"""Limits that may exclude a box of durations, and their weights by a small simplex: proposals."""

from __future__ import annotations

import numpy as np

from ....verify import QUINTIC_PLACES
from .nodal import BASIS, compiled, place

MOST = 40
"""Rows that take part in a box: below `MOST_LIMITS` of a leaf, and the table stays small."""
_GRID = 9
"""Places where a derivative is scanned: it has at most three extrema inside a segment."""


def derivative_table() -> np.ndarray:
    """``table[order, i, p]``: coefficient of s**p in derivative ``order`` of basis function i."""
    table = np.zeros((4, 5, 6))
    table[0] = BASIS
    for order in range(1, 4):
        for p in range(5):
            table[order, :, p] = (p + 1) * table[order - 1, :, p + 1]
    return table


TABLE = derivative_table()
"""Computed once: compiled functions take it as a constant."""


@compiled
def row_shape(order, sign, spot, shape):  # type: ignore[no-untyped-def]
    """Fill ``shape`` (step, v0, v1, a0, a1) of a derivative at spot/QUINTIC_PLACES."""
    s = spot / QUINTIC_PLACES
    for i in range(5):
        v = 0.0
        for p in range(5, -1, -1):
            v = v * s + TABLE[order, i, p]
        shape[i] = sign * v


@compiled
def _peak(poly, sign, start):  # type: ignore[no-untyped-def]
    """Newton steps from a grid point to the extremum beside it, kept within one cell and [0, 1]."""
    low, high = max(0.0, start - 1.0 / (_GRID - 1)), min(1.0, start + 1.0 / (_GRID - 1))
    s = start
    for _ in range(3):  # from less than an eighth of a segment away
        rise, bend = 0.0, 0.0
        for p in range(5, 0, -1):
            rise = rise * s + p * poly[p]
        for p in range(5, 1, -1):
            bend = bend * s + p * (p - 1) * poly[p]
        rise, bend = sign * rise, sign * bend
        newton = min(max(s - rise / bend, low), high)
        s = newton if bend < 0.0 else high if rise > 0.0 else low
    return s


@compiled
def candidates(  # type: ignore[no-untyped-def]
    n, joints, r, step, limits, x0, slope, ids, value, gradient, shapes, norms
):
    """Collect the rows highest at the centre, relative to their limits; returns their number.

    ``ids[i]`` = (segment, joint, order, sign, place); ``value`` and ``gradient`` (by r) are those
    of (row − limit·r**power)/norm with norm = limit·r**power at the centre.
    """
    count = 0
    y = np.empty(5)
    curve, poly = np.empty(_GRID), np.empty(6)
    shape = np.empty(5)
    for j in range(joints):
        for k in range(n):
            y[0] = r[k] * r[k] * step[k, j]
            for a in range(4):
                i = place(k, a, n)
                y[a + 1] = 0.0 if i < 0 else x0[j, i] * (r[k] if a < 2 else 1.0)
            for order in range(1, 4):
                if not np.isfinite(limits[j, order - 1]):
                    continue
                power = 2 - order
                norm = limits[j, order - 1]
                norm = norm * r[k] if power == 1 else norm / r[k] if power == -1 else norm
                for p in range(6):
                    poly[p] = 0.0
                    for i in range(5):
                        poly[p] += TABLE[order, i, p] * y[i]
                for g in range(_GRID):
                    s = g / (_GRID - 1.0)
                    v = 0.0
                    for p in range(5, -1, -1):
                        v = v * s + poly[p]
                    curve[g] = v / norm
                for g in range(_GRID):
                    sign = 1.0 if curve[g] >= 0.0 else -1.0
                    here = sign * curve[g]
                    before = sign * curve[g - 1] if g > 0 else -np.inf
                    after = sign * curve[g + 1] if g < _GRID - 1 else -np.inf
                    if here < before or here <= after:
                        continue
                    s = _peak(poly, sign, g / (_GRID - 1.0))
                    spot = int(np.rint(s * QUINTIC_PLACES))
                    row_shape(order, sign, spot, shape)
                    v = 0.0
                    for i in range(5):
                        v += shape[i] * y[i]
                    v = v / norm - 1.0
                    at = min(count, MOST - 1)
                    if count == MOST and v <= value[at]:
                        continue
                    while at > 0 and value[at - 1] < v:
                        value[at] = value[at - 1]
                        ids[at] = ids[at - 1]
                        shapes[at] = shapes[at - 1]
                        norms[at] = norms[at - 1]
                        at -= 1
                    value[at], norms[at] = v, norm
                    ids[at, 0], ids[at, 1], ids[at, 2] = k, j, order
                    ids[at, 3], ids[at, 4] = int(sign), spot
                    shapes[at] = shape
                    count = min(count + 1, MOST)
    for c in range(count):
        k, j, order = ids[c, 0], ids[c, 1], ids[c, 2]
        for m in range(n):
            v = 0.0
            for a in range(4):
                i = place(k, a, n)
                if i >= 0:
                    v += shapes[c, a + 1] * slope[j, m, i] * (r[k] if a < 2 else 1.0)
            gradient[c, m] = v
        v = 2.0 * r[k] * shapes[c, 0] * step[k, j]
        for a in range(2):
            i = place(k, a, n)
            if i >= 0:
                v += shapes[c, a + 1] * x0[j, i]
        v -= (2 - order) * norms[c] / r[k]
        gradient[c, k] += v
        for m in range(n):
            gradient[c, m] /= norms[c]
    return count


@compiled
def simplex(n, count, value, gradient, r, e, total, weight):  # type: ignore[no-untyped-def]
    """Weights w ≥ 0 of sum 1 and tau that maximise the least linearised sum over the box.

    That is Σ w_i value_i + tau·(Σ 1/r − total) − Σ_k |Σ w_i gradient_ik − tau/r_k²|·e_k, where the
    absolute values are the sums of two variables whose difference the table holds.

    Returns (that least sum, tau). Stops early after a number of pivots: any weights are valid.
    """
    wide = count + 2 + 2 * n
    table = np.zeros((n + 1, wide + 1))
    cost = np.zeros(wide)
    spare = -total
    for k in range(n):
        spare += 1.0 / r[k]
    best = 0
    top = -np.inf
    for i in range(count):
        cost[i] = value[i]
        low = value[i]
        for k in range(n):
            table[k, i] = gradient[i, k] * e[k]
            low -= abs(table[k, i])
        table[n, i] = 1.0
        if low > top:
            top, best = low, i
    cost[count], cost[count + 1] = spare, -spare
    for k in range(n):
        table[k, count] = -e[k] / (r[k] * r[k])
        table[k, count + 1] = -table[k, count]
        table[k, count + 2 + 2 * k] = -1.0
        table[k, count + 3 + 2 * k] = 1.0
        cost[count + 2 + 2 * k] = -1.0
        cost[count + 3 + 2 * k] = -1.0
    table[n, wide] = 1.0
    basis = np.empty(n + 1, np.int64)
    basis[n] = best
    for k in range(n):
        f = table[k, best]
        for c in range(wide + 1):
            table[k, c] -= f * table[n, c]
        basis[k] = count + 3 + 2 * k
        if table[k, wide] < 0.0:
            basis[k] = count + 2 + 2 * k
            for c in range(wide + 1):
                table[k, c] = -table[k, c]
    gain = np.empty(wide)
    for _ in range(60):  # a guard: any weights are valid
        enter, most = -1, 1e-9  # what wins less is lost in rounding
        for c in range(wide):
            gain[c] = cost[c]
        for q in range(n + 1):
            f = cost[basis[q]]
            if f != 0.0:
                for c in range(wide):
                    gain[c] -= f * table[q, c]
        for c in range(wide):
            if gain[c] > most:
                most, enter = gain[c], c
        if enter < 0:
            break
        leave, ratio = -1, np.inf
        for q in range(n + 1):
            if table[q, enter] > 1e-11 and table[q, wide] / table[q, enter] < ratio:
                leave, ratio = q, table[q, wide] / table[q, enter]
        if leave < 0:
            break
        f = table[leave, enter]
        for c in range(wide + 1):
            table[leave, c] /= f
        for q in range(n + 1):
            f = table[q, enter]
            if q != leave and f != 0.0:
                for c in range(wide + 1):
                    table[q, c] -= f * table[leave, c]
        basis[leave] = enter
    least, tau = 0.0, 0.0
    for c in range(count):
        weight[c] = 0.0
    for q in range(n + 1):
        least += cost[basis[q]] * table[q, wide]
        if basis[q] < count:
            weight[basis[q]] = table[q, wide]
        elif basis[q] == count:
            tau += table[q, wide]
        elif basis[q] == count + 1:
            tau -= table[q, wide]
    return least, tau
