"""Compiled: the curve, its extrema and their curvature, by log durations.

Signs and signs of indices are written out, since a compiled loop costs less than a call.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...problem.curves import compiler

NEAR = 0.3
"""Extrema below this share of their limit are left out: no step of a trust region reaches it."""
KERNELS = ("newton_curve.py", "newton_kernel.py", "newton_program.py")
"""Every file of compiled functions here: they call each other, so they share a stamp."""
compiled = compiler(*(Path(__file__).with_name(name) for name in KERNELS))
"""Compiles a function of one of these files."""


@compiled
def _bracketed_root(a, degree, low, high, value_low):  # type: ignore[no-untyped-def]
    """Root of a monotone piece: Newton steps, bisection where they leave the bracket."""
    s = 0.5 * (low + high)
    for _ in range(100):
        value = a[degree]
        slope = 0.0
        for i in range(degree - 1, -1, -1):
            slope = slope * s + value
            value = value * s + a[i]
        if value == 0.0:
            return s
        if (value > 0.0) == (value_low > 0.0):
            low = s
        else:
            high = s
        step = s - value / slope  # infinite or NaN where flat: then outside the bracket
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - s) <= 1e-16 or step in (low, high):
            return step
        s = step
    return s


@compiled
def roots_in_unit(a, degree, work, roots):  # type: ignore[no-untyped-def]
    """Sign changes of a polynomial in the open unit interval, ascending; returns their number.

    The roots of each derivative cut the interval into pieces on which the next lower one is
    monotone, from the linear one upwards. ``work`` has room for the derivatives, ``(10, 10)``.
    """
    while degree > 0 and a[degree] == 0.0:
        degree -= 1
    for i in range(degree + 1):
        work[degree, i] = a[i]
    for d in range(degree, 1, -1):
        for i in range(d):
            work[d - 1, i] = (i + 1) * work[d, i + 1]
    count = 0
    for d in range(1, degree + 1):
        p = work[d]
        found, low, value_low = 0, 0.0, p[0]
        # roots[k] is read before roots[found], found <= k, is written: no break is lost.
        for k in range(count + 1):
            high = roots[k] if k < count else 1.0
            value_high = p[d]
            for i in range(d - 1, -1, -1):
                value_high = value_high * high + p[i]
            if value_low == 0.0:
                if low > 0.0:
                    roots[found] = low
                    found += 1
            elif value_high != 0.0 and (value_low > 0.0) != (value_high > 0.0):
                roots[found] = _bracketed_root(p, d, low, high, value_low)
                found += 1
            low = high
            value_low = value_high
        count = found
    return count


@compiled
def curve_at(  # type: ignore[no-untyped-def]
    z, values, kinds, breaks, orders, degrees, column, perm, inverse, x, slopes, sloped, a, right
):
    """Coefficients ``x[segment, power, joint]``, the inverse of their system, and their slopes.

    ``slopes[l, segment, power, joint]`` are derivatives by the log duration l, where ``sloped``.
    The rows are those of `fit_coefficients`. Returns whether the system is regular.
    """
    n, joints, unknowns = degrees.size, values.shape[1], inverse.shape[0]
    for e in range(unknowns):
        for m in range(2 * unknowns):
            a[e, m] = 0.0
        for m in range((n + 1) * joints):
            right[e, m] = 0.0
    e = 0
    for row in range(kinds.size):
        kind, b, r = kinds[row], breaks[row], orders[row]
        k = b if kind == 1 else b - 1
        if kind == 1:
            for j in range(joints):
                x[k, r, j] = values[row, j] * math.exp(r * z[k]) / perm[r, r]
                for m in range(n):
                    slopes[m, k, r, j] = r * x[k, r, j] if m == k else 0.0
            continue
        scale = 1.0
        if kind == 0:
            for j in range(joints):
                given = values[row, j] * math.exp(r * z[k])
                right[e, j] = given
                right[e, (k + 1) * joints + j] = r * given
        elif r <= degrees[b]:
            ratio = math.exp(r * (z[k] - z[b]))
            scale = 1.0 / max(1.0, ratio)
            other = perm[r, r] * ratio * scale
            if column[b, r] >= 0:
                a[e, column[b, r]] = -other
            else:
                for j in range(joints):
                    right[e, j] += other * x[b, r, j]
                    for m in range(n):
                        right[e, (m + 1) * joints + j] += other * slopes[m, b, r, j]
        for p in range(r, degrees[k] + 1):
            weight = perm[p, r] * scale
            if column[k, p] >= 0:
                a[e, column[k, p]] += weight
            else:
                for j in range(joints):
                    right[e, j] -= weight * x[k, p, j]
                    for m in range(n):
                        right[e, (m + 1) * joints + j] -= weight * slopes[m, k, p, j]
        a[e, unknowns + e] = 1.0
        e += 1
    for c in range(unknowns):
        top = c
        for i in range(c + 1, unknowns):
            if abs(a[i, c]) > abs(a[top, c]):
                top = i
        if not abs(a[top, c]) > 1e-300:
            return False
        if top != c:
            for m in range(2 * unknowns):
                a[c, m], a[top, m] = a[top, m], a[c, m]
        pivot = 1.0 / a[c, c]
        for m in range(c, 2 * unknowns):
            a[c, m] *= pivot
        for i in range(unknowns):
            factor = a[i, c]
            if i != c and factor != 0.0:
                for m in range(c, 2 * unknowns):
                    a[i, m] -= factor * a[c, m]
    for i in range(unknowns):
        for e in range(unknowns):
            inverse[i, e] = a[i, unknowns + e]
    for k in range(n):
        for p in range(degrees[k] + 1):
            c = column[k, p]
            for j in range(joints if c >= 0 else 0):
                total = 0.0
                for e in range(unknowns):
                    total += inverse[c, e] * right[e, j]
                x[k, p, j] = total
                if not abs(total) < np.inf:
                    return False
    if not sloped:
        return True
    e = 0
    for row in range(kinds.size):
        kind, b, r = kinds[row], breaks[row], orders[row]
        if kind == 1:
            continue
        if kind == 2 and 0 < r <= degrees[b]:
            k = b - 1
            ratio = math.exp(r * (z[k] - z[b]))
            other = r * perm[r, r] * ratio / max(1.0, ratio)
            for j in range(joints):
                right[e, (k + 1) * joints + j] += other * x[b, r, j]
                right[e, (b + 1) * joints + j] -= other * x[b, r, j]
        e += 1
    for k in range(n):
        for p in range(degrees[k] + 1):
            c = column[k, p]
            for m in range(n if c >= 0 else 0):
                for j in range(joints):
                    total = 0.0
                    for e in range(unknowns):
                        total += inverse[c, e] * right[e, (m + 1) * joints + j]
                    slopes[m, k, p, j] = total
    return True


@compiled
def rows_at(  # type: ignore[no-untyped-def]
    z, degrees, smooth, inverse_limits, ranges, span, perm, x, slopes, sloped,
    excess, gradient, place, s_of, near, work,
):  # fmt: skip
    """Every extremum near its limit: excess, gradient, and (joint, order, segment, side, inside).

    Returns the number of rows, and the largest excess of a derivative and of a position.
    """
    n, joints = degrees.size, x.shape[2]
    a, turn, roots = work[10], work[11], work[12]
    count, worst, outside = 0, -np.inf, -np.inf
    for j in range(joints):
        for r in range(4):
            ranged = ranges[0, j] > -np.inf or ranges[1, j] < np.inf
            if (r > 0 and inverse_limits[j, r - 1] == 0.0) or (r == 0 and not ranged):
                continue
            for k in range(n):
                d = degrees[k] - r
                if d < 0:
                    continue
                for i in range(d + 1):
                    a[i] = perm[i + r, r] * x[k, i + r, j]
                found = 0
                if d >= 2:
                    for i in range(d):
                        turn[i] = (i + 1) * a[i + 1]
                    found = roots_in_unit(turn, d - 1, work, roots)
                inner = found
                if r > 0:
                    roots[found] = 1.0
                    found += 1
                    if k == 0 or smooth[k] < r:
                        roots[found] = 0.0
                        found += 1
                for i in range(found):
                    s = roots[i]
                    value = a[d]
                    for p in range(d - 1, -1, -1):
                        value = value * s + a[p]
                    for side in range(2 if r == 0 else 1):
                        if r > 0:
                            size = abs(value) * inverse_limits[j, r - 1] * math.exp(-r * z[k])
                            if not size > near:
                                continue
                            over = math.log(size) / r
                            worst = max(worst, over)
                        else:
                            over = value - ranges[1, j] if side == 1 else ranges[0, j] - value
                            over /= span[j]
                            if not over > NEAR - 1.0:
                                continue
                            outside = max(outside, over)
                        if not sloped or count == excess.size:
                            continue
                        excess[count] = over
                        scale = 1.0 / (r * value) if r > 0 else (2.0 * side - 1.0) / span[j]
                        for m in range(n):
                            slope = 0.0
                            for p in range(d, -1, -1):
                                slope = slope * s + perm[p + r, r] * slopes[m, k, p + r, j]
                            gradient[count, m] = slope * scale
                        if r > 0:
                            gradient[count, k] -= 1.0
                        place[count, 0], place[count, 1], place[count, 2] = j, r, k
                        place[count, 3], place[count, 4] = side, 1 if i < inner else 0
                        s_of[count] = s
                        count += 1
    return count, worst, outside


@compiled
def add_curvature(  # type: ignore[no-untyped-def]
    z, j, r, k, side, inside, s, weight, values, kinds, breaks, orders, degrees, column, perm,
    span, inverse, x, slopes, hessian, adjoint, own, first, moving, second,
):  # fmt: skip
    """Add ``weight`` times the second derivatives of one extremum's excess by log durations.

    With P = w·x at the place s, P_lm = w·x_lm − P_sl P_sm/P_ss where s is stationary; x_lm solves
    the system with right-hand sides known to second order, and only w A⁻¹ times them is needed.
    """
    n, unknowns, d = degrees.size, inverse.shape[0], degrees[k]
    value, bend = 0.0, 0.0
    for e in range(unknowns):
        adjoint[e] = 0.0
    for i in range(n):
        first[i], moving[i] = 0.0, 0.0
        for m in range(n):
            second[i, m] = 0.0
    power, before, twice = 1.0, 0.0, 0.0  # s^i, its first and its second derivative
    for p in range(r, d + 1):
        i = p - r
        own[p] = perm[p, r] * power
        by_s = perm[p, r] * before
        value += own[p] * x[k, p, j]
        bend += perm[p, r] * twice * x[k, p, j]
        for m in range(n):
            first[m] += own[p] * slopes[m, k, p, j]
            moving[m] += by_s * slopes[m, k, p, j]
        c = column[k, p]
        if c >= 0:
            for e in range(unknowns):
                adjoint[e] += own[p] * inverse[c, e]
        else:
            second[k, k] += own[p] * p * p * x[k, p, j]
        twice = i * (i + 1) * s ** (i - 1) if i >= 1 else 0.0
        before = (i + 1) * power
        power *= s
    e = 0
    for row in range(kinds.size):
        kind, b, q = kinds[row], breaks[row], orders[row]
        if kind == 1:
            continue
        mu, u = adjoint[e], b - 1
        e += 1
        if mu == 0.0:
            continue
        scale = 1.0
        if kind == 0:
            second[u, u] += mu * q * q * values[row, j] * math.exp(q * z[u])
        elif q <= degrees[b]:
            ratio = math.exp(q * (z[u] - z[b]))
            scale = 1.0 / max(1.0, ratio)
            other = mu * perm[q, q] * ratio * scale
            y = x[b, q, j]
            if column[b, q] < 0:
                second[b, b] += other * q * q * y
            curved = other * q * q * y
            second[u, u] += curved
            second[b, b] += curved
            second[u, b] -= curved
            second[b, u] -= curved
            for m in range(n):
                along = other * q * slopes[m, b, q, j]
                second[u, m] += along
                second[m, u] += along
                second[b, m] -= along
                second[m, b] -= along
        for p in range(q, degrees[u] + 1):
            if column[u, p] < 0:
                second[u, u] -= mu * perm[p, q] * scale * p * p * x[u, p, j]
    stationary = inside == 1 and abs(bend) > 1e-9 * abs(value)
    for i in range(n):
        for m in range(n):
            if stationary:
                second[i, m] -= moving[i] * moving[m] / bend
            if r > 0:
                part = second[i, m] / (r * value) - first[i] * first[m] / (r * value * value)
            else:
                part = (2.0 * side - 1.0) * second[i, m] / span[j]
            hessian[i, m] += weight * part
