"""Compiled kernels: banded spline systems and the true extrema of polynomials on [0, 1]."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numba
import numpy as np

MAX_COEFFICIENTS = 10


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    try:
        jitted = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # no writable place for the cache: compile in memory
        jitted = numba.njit(nogil=True, error_model="numpy")(function)
    return cast(Callable[..., Any], jitted)


def _bernstein() -> np.ndarray[Any, np.dtype[np.float64]]:
    table = np.zeros((MAX_COEFFICIENTS,) * 3)
    for d in range(MAX_COEFFICIENTS):
        binomial = [1.0]
        for i in range(d):
            binomial.append(binomial[-1] * (d - i) / (i + 1))
        for j in range(d + 1):
            c = 1.0
            for i in range(j + 1):
                table[d, j, i] = c / binomial[i]
                c = c * (j - i) / (i + 1)
    return table


BERNSTEIN = _bernstein()


@_compiled
def horner(a, degree, s):  # type: ignore[no-untyped-def]
    """Value of the polynomial with ascending coefficients ``a`` at ``s``."""
    value = a[degree]
    for i in range(degree - 1, -1, -1):
        value = value * s + a[i]
    return value


@_compiled
def _quadratic_roots(c, b, a, roots):  # type: ignore[no-untyped-def]
    """Roots of ``a s² + b s + c`` in the open unit interval, ascending; returns their number."""
    count = 0
    if a == 0.0:
        if b != 0.0:
            s = -c / b
            if 0.0 < s < 1.0:
                roots[0] = s
                count = 1
        return count
    discriminant = b * b - 4.0 * a * c
    if discriminant < 0.0:
        return 0
    q = -0.5 * (b + (np.sqrt(discriminant) if b >= 0.0 else -np.sqrt(discriminant)))
    s1 = q / a
    s2 = c / q if q != 0.0 else s1
    low, high = min(s1, s2), max(s1, s2)
    if 0.0 < low < 1.0:
        roots[count] = low
        count += 1
    if 0.0 < high < 1.0 and high != low:
        roots[count] = high
        count += 1
    return count


@_compiled
def _bracketed_root(a, degree, low, high, value_low):  # type: ignore[no-untyped-def]
    """Root of a monotone piece on ``[low, high]``: Newton steps, bisection where they leave it."""
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
        step = s - value / slope if slope != 0.0 else low
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - s) <= 1e-16 or step == low or step == high:
            return step
        s = step
    return s


@_compiled
def roots_in_unit(a, degree, work, roots):  # type: ignore[no-untyped-def]
    """Sign changes of a polynomial in the open unit interval, ascending; returns their number.

    The roots of each derivative cut the interval into pieces on which the next lower one is
    monotone, from the quadratic upwards. ``work`` has room for the derivatives, ``(10, 10)``.
    """
    while degree > 0 and a[degree] == 0.0:
        degree -= 1
    if degree == 0:
        return 0
    if degree == 1:
        return _quadratic_roots(a[0], a[1], 0.0, roots)
    if degree == 2:
        return _quadratic_roots(a[0], a[1], a[2], roots)
    for i in range(degree + 1):
        work[degree, i] = a[i]
    for d in range(degree, 2, -1):
        for i in range(d):
            work[d - 1, i] = (i + 1) * work[d, i + 1]
    count = _quadratic_roots(work[2, 0], work[2, 1], work[2, 2], roots)
    for d in range(3, degree + 1):
        p = work[d]
        found = 0
        low = 0.0
        value_low = p[0]
        # A piece yields at most one root and its upper break is read before roots[found],
        # found <= k, is written: the breaks of the level below are never lost.
        for k in range(count + 1):
            high = roots[k] if k < count else 1.0
            value_high = horner(p, d, high)
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


@_compiled
def _piece_peak(a, degree, floor, table, derivative, work, roots):  # type: ignore[no-untyped-def]
    """Largest absolute value on [0, 1], or ``floor`` if the Bernstein hull shows it is higher."""
    end = 0.0
    for i in range(degree + 1):
        end += a[i]
    peak = max(floor, abs(a[0]), abs(end))
    if degree < 2:
        return peak
    hull = 0.0
    for j in range(1, degree):
        b = 0.0
        for i in range(j + 1):
            b += table[degree, j, i] * a[i]
        hull = max(hull, abs(b))
    if hull <= peak:
        return peak
    for i in range(degree):
        derivative[i] = (i + 1) * a[i + 1]
    count = roots_in_unit(derivative, degree - 1, work, roots)
    for k in range(count):
        peak = max(peak, abs(horner(a, degree, roots[k])))
    return peak


@_compiled
def fit_coefficients(  # type: ignore[no-untyped-def]
    h, values, kinds, breaks, orders, degrees, column, lower, upper, perm, system, right, out
):
    """Coefficients in s = (t − t_k)/h_k of all joints, by a banded elimination with pivoting.

    ``values[row, joint]`` are the right-hand sides (way-points and prescribed derivatives);
    ``column[segment, power]`` is the unknown's index, or −1 where a row gives it at once;
    ``perm[p, r]`` = p!/(p − r)!. ``out`` has shape (segment, power, joint). Returns False if the
    system is singular.
    """
    joints = values.shape[1]
    unknowns = system.shape[0]
    system[:] = 0.0
    out[:] = 0.0
    for row in range(kinds.size):
        if kinds[row] == 1:
            k, r = breaks[row], orders[row]
            scale = h[k] ** r / perm[r, r]
            for j in range(joints):
                out[k, r, j] = values[row, j] * scale
    equation = 0
    for row in range(kinds.size):
        if kinds[row] == 1:
            continue
        b, r = breaks[row], orders[row]
        k = b - 1
        left, own = 1.0, 0.0
        if kinds[row] == 0:
            scale = h[k] ** r
            for j in range(joints):
                right[equation, j] = values[row, j] * scale
        else:
            rho = h[k] / h[b]
            if rho > 1.0:
                left = (1.0 / rho) ** r
                own = perm[r, r]
            else:
                own = rho**r * perm[r, r]
            for j in range(joints):
                right[equation, j] = 0.0
            if r <= degrees[b]:
                if column[b, r] >= 0:
                    system[equation, column[b, r]] -= own
                else:
                    for j in range(joints):
                        right[equation, j] += own * out[b, r, j]
        for p in range(r, degrees[k] + 1):
            weight = left * perm[p, r]
            if column[k, p] >= 0:
                system[equation, column[k, p]] += weight
            else:
                for j in range(joints):
                    right[equation, j] -= weight * out[k, p, j]
        equation += 1
    for c in range(unknowns):
        last = min(c + lower, unknowns - 1)
        width = min(c + lower + upper, unknowns - 1)
        pivot = c
        for i in range(c + 1, last + 1):
            if abs(system[i, c]) > abs(system[pivot, c]):
                pivot = i
        if not abs(system[pivot, c]) > 0.0:
            return False
        if pivot != c:
            for i in range(c, width + 1):
                system[c, i], system[pivot, i] = system[pivot, i], system[c, i]
            for j in range(joints):
                right[c, j], right[pivot, j] = right[pivot, j], right[c, j]
        inverse = 1.0 / system[c, c]
        for i in range(c + 1, last + 1):
            factor = system[i, c] * inverse
            if factor != 0.0:
                for m in range(c + 1, width + 1):
                    system[i, m] -= factor * system[c, m]
                for j in range(joints):
                    right[i, j] -= factor * right[c, j]
    for c in range(unknowns - 1, -1, -1):
        width = min(c + lower + upper, unknowns - 1)
        inverse = 1.0 / system[c, c]
        for j in range(joints):
            value = right[c, j]
            for m in range(c + 1, width + 1):
                value -= system[c, m] * right[m, j]
            right[c, j] = value * inverse
    for k in range(degrees.size):
        for p in range(degrees[k] + 1):
            if column[k, p] >= 0:
                for j in range(joints):
                    out[k, p, j] = right[column[k, p], j]
    return True


@_compiled
def batch_peaks(  # type: ignore[no-untyped-def]
    durations, values, kinds, breaks, orders, degrees, column, lower, upper, perm, table,
    wanted, peaks,
):
    """True peaks of the wanted derivatives for many duration vectors.

    ``wanted[joint, order − 1]`` selects; ``peaks[vector, joint, order − 1]`` receives the largest
    absolute value over all t, infinite where a duration is not positive and finite.
    """
    n = degrees.size
    joints = values.shape[1]
    unknowns = 0
    for k in range(n):
        for p in range(degrees[k] + 1):
            unknowns = max(unknowns, column[k, p] + 1)
    system = np.empty((unknowns, unknowns))
    right = np.empty((unknowns, joints))
    out = np.empty((n, MAX_COEFFICIENTS, joints))
    a = np.empty(MAX_COEFFICIENTS)
    derivative = np.empty(MAX_COEFFICIENTS)
    work = np.empty((MAX_COEFFICIENTS, MAX_COEFFICIENTS))
    roots = np.empty(MAX_COEFFICIENTS)
    for v in range(durations.shape[0]):
        h = durations[v]
        valid = True
        for k in range(n):
            valid = valid and h[k] > 0.0 and h[k] < np.inf
        if valid:
            valid = fit_coefficients(
                h, values, kinds, breaks, orders, degrees, column, lower, upper, perm,
                system, right, out,
            )
        if not valid:
            peaks[v] = np.inf
            continue
        for j in range(joints):
            for r in range(1, 4):
                if not wanted[j, r - 1]:
                    peaks[v, j, r - 1] = 0.0
                    continue
                peak = 0.0
                for k in range(n):
                    d = degrees[k] - r
                    if d < 0:
                        continue
                    scale = (1.0 / h[k]) ** r
                    for i in range(d + 1):
                        a[i] = out[k, i + r, j] * perm[i + r, r] * scale
                    peak = _piece_peak(a, d, peak, table, derivative, work, roots)
                peaks[v, j, r - 1] = peak
