"""Compiled kernel of clamped B-splines: true peaks for batches of duration vectors."""

from __future__ import annotations

import numpy as np

from .kernel import compiled, roots_in_unit

ROOM = 10
"""Length of work arrays: the largest number of coefficients that `roots_in_unit` takes."""


@compiled
def span_basis(knots, degree, piece, basis, work):  # type: ignore[no-untyped-def]
    """Powers of the basis functions that live on one span, ``basis[function, power]``.

    Cox–de Boor (2) on polynomials in the span's own 0..1, order by order.
    """
    at = degree + piece
    start, width = knots[at], knots[at + 1] - knots[at]
    basis[:] = 0.0
    basis[0, 0] = 1.0
    for q in range(1, degree + 1):
        work[:] = 0.0
        for a in range(q):
            i = at - q + 1 + a
            left, right = knots[i], knots[i + q]
            for m in range(q):
                c = basis[a, m] / (right - left)
                work[a + 1, m] += (start - left) * c
                work[a + 1, m + 1] += width * c
                work[a, m] += (right - start) * c
                work[a, m + 1] -= width * c
        basis[:] = work


@compiled
def _solved(matrix, right):  # type: ignore[no-untyped-def]
    """Solve in place by elimination with partial pivoting; False if a pivot vanishes."""
    n = matrix.shape[0]
    for c in range(n):
        pivot = c
        for i in range(c + 1, n):
            if abs(matrix[i, c]) > abs(matrix[pivot, c]):
                pivot = i
        if not abs(matrix[pivot, c]) > 1e-13:
            return False
        if pivot != c:
            for k in range(n):
                matrix[c, k], matrix[pivot, k] = matrix[pivot, k], matrix[c, k]
            for j in range(right.shape[1]):
                right[c, j], right[pivot, j] = right[pivot, j], right[c, j]
        for i in range(c + 1, n):
            factor = matrix[i, c] / matrix[c, c]
            if factor != 0.0:
                for k in range(c + 1, n):
                    matrix[i, k] -= factor * matrix[c, k]
                for j in range(right.shape[1]):
                    right[i, j] -= factor * right[c, j]
    for c in range(n - 1, -1, -1):
        for j in range(right.shape[1]):
            for k in range(c + 1, n):
                right[c, j] -= matrix[c, k] * right[k, j]
            right[c, j] /= matrix[c, c]
    return True


@compiled
def _end_rows(bases, orders, matrix, row):  # type: ignore[no-untyped-def]
    """Rows of the end conditions, scaled to a largest entry of 1."""
    pieces, degree = bases.shape[0], bases.shape[1] - 1
    for x in range(orders.size):
        r = orders[x]
        for side in range(2):
            top = 0.0
            for a in range(degree + 1):
                value = 0.0
                if side == 0:
                    value = bases[0, a, r]
                else:
                    for m in range(r, degree + 1):
                        term = bases[pieces - 1, a, m]
                        for i in range(r):
                            term *= m - i
                        value += term
                matrix[row, (pieces - 1) * side + a] = value
                top = max(top, abs(value))
            for a in range(degree + 1):
                matrix[row, (pieces - 1) * side + a] /= top
            row += 1


@compiled
def _curve(times, knots, degree, orders, right, bases, work, matrix):  # type: ignore[no-untyped-def]
    """Control points into ``right``; False where the way-points do not determine them."""
    pieces = bases.shape[0]
    for p in range(pieces):
        if not knots[degree + p + 1] > knots[degree + p]:
            return False
        span_basis(knots, degree, p, bases[p], work)
    matrix[:] = 0.0
    p = 0
    for w in range(times.size):
        while p < pieces - 1 and knots[degree + p + 1] <= times[w]:
            p += 1
        s = (times[w] - knots[degree + p]) / (knots[degree + p + 1] - knots[degree + p])
        for a in range(degree + 1):
            value = 0.0
            for m in range(degree, -1, -1):
                value = value * s + bases[p, a, m]
            matrix[w, p + a] = value
    _end_rows(bases, orders, matrix, times.size)
    return _solved(matrix, right)


@compiled
def _peaks(knots, degree, bases, control, wanted, side, top):  # type: ignore[no-untyped-def]
    """Largest absolute derivatives of each column of ``control``."""
    a, derivative = np.empty(ROOM), np.empty(ROOM)
    roots, work = np.empty(ROOM), np.empty((ROOM, ROOM))
    for p in range(bases.shape[0]):
        width = knots[degree + p + 1] - knots[degree + p]
        for j in range(control.shape[1]):
            for m in range(degree + 1):
                a[m] = 0.0
                for f in range(degree + 1):
                    a[m] += bases[p, f, m] * control[p + f, j]
            n = degree
            for r in range(3):
                for m in range(n):
                    a[m] = (m + 1) * a[m + 1] / width
                n -= 1
                if not wanted[j, r]:
                    continue
                for m in range(n):
                    derivative[m] = (m + 1) * a[m + 1]
                turns = roots_in_unit(derivative, n - 1, work, roots) if n > 0 else 0
                for i in range(turns + 2):
                    s = 0.0 if i == turns else (1.0 if i == turns + 1 else roots[i])
                    value = 0.0
                    for m in range(n, -1, -1):
                        value = value * s + a[m]
                    value = abs(value) if side == 0.0 else side * value
                    if not value <= top[j, r]:
                        top[j, r] = value if value == value else np.inf


@compiled
def _timed(durations, v, times):  # type: ignore[no-untyped-def]
    """Times of the way-points; False where a duration is not positive and finite."""
    valid, count = True, times.size
    times[0] = 0.0
    for k in range(count - 1):
        valid = valid and 0.0 < durations[v, k] < np.inf
        times[k + 1] = times[k] + durations[v, k]
    return valid and 0.0 < times[count - 1] < np.inf


@compiled
def _placed(waypoints, times, average, fractions, g, degree, knots, right):  # type: ignore[no-untyped-def]
    """Knots of group ``g``, and its way-points, counted from the first, into ``right``."""
    inner, columns, total = average.shape[0], right.shape[1], times[times.size - 1]
    for i in range(degree + 1):
        knots[i] = 0.0
        knots[inner + degree + 1 + i] = total
    for i in range(inner):
        knot = 0.0
        for w in range(times.size):
            place = fractions[g, w] * total if fractions.shape[0] > 0 else times[w]
            knot += average[i, w] * place
        knots[degree + 1 + i] = knot
    right[:] = 0.0
    for w in range(times.size):
        for j in range(columns):
            right[w, j] = waypoints[w, g * columns + j] - waypoints[0, g * columns + j]


@compiled
def _ranges(bases, control, wanted, found):  # type: ignore[no-untyped-def]
    """Least and largest values of each wanted column of ``control``."""
    degree = bases.shape[1] - 1
    a, derivative = np.empty(ROOM), np.empty(ROOM)
    roots, work = np.empty(ROOM), np.empty((ROOM, ROOM))
    for j in range(control.shape[1]):
        found[j] = 0.0
        if not wanted[j]:
            continue
        low, high = np.inf, -np.inf
        for p in range(bases.shape[0]):
            for m in range(degree + 1):
                a[m] = 0.0
                for f in range(degree + 1):
                    a[m] += bases[p, f, m] * control[p + f, j]
            for m in range(degree):
                derivative[m] = (m + 1) * a[m + 1]
            turns = roots_in_unit(derivative, degree - 1, work, roots)
            for i in range(turns + 2):
                s = 0.0 if i == turns else (1.0 if i == turns + 1 else roots[i])
                value = 0.0
                for m in range(degree, -1, -1):
                    value = value * s + a[m]
                if not value >= low:
                    low = value if value == value else -np.inf
                if not value <= high:
                    high = value if value == value else np.inf
        found[j, 0], found[j, 1] = low, high


@compiled
def batch_peaks(  # type: ignore[no-untyped-def]
    durations, waypoints, average, fractions, degree, orders, wanted, side, peaks
):
    """Find the true peaks of |v|, |a|, |j| for many duration vectors.

    ``average[inner knot, way-point]`` places the knots by the times where ``fractions`` has no
    row; else row g places those of joint g, or the one row those of all joints. ``side`` as in
    `kernel.batch_peaks`.
    """
    count, inner = durations.shape[1] + 1, average.shape[0]
    pieces, joints = inner + 1, waypoints.shape[1]
    size = inner + degree + 1
    groups = max(1, fractions.shape[0])
    columns = joints // groups
    times = np.empty(count)
    knots = np.empty(inner + 2 * degree + 2)
    bases = np.empty((pieces, degree + 1, degree + 1))
    work = np.empty((degree + 1, degree + 1))
    matrix = np.empty((size, size))
    right = np.empty((size, columns))
    for v in range(durations.shape[0]):
        valid = _timed(durations, v, times)
        peaks[v] = 0.0
        for g in range(groups if valid else 0):
            _placed(waypoints, times, average, fractions, g, degree, knots, right)
            valid = _curve(times, knots, degree, orders, right, bases, work, matrix)
            if not valid:
                break
            part = slice(g * columns, (g + 1) * columns)
            _peaks(knots, degree, bases, right, wanted[part], side, peaks[v, part])
        if not valid:
            peaks[v] = np.inf


@compiled
def batch_ranges(  # type: ignore[no-untyped-def]
    durations, waypoints, average, fractions, degree, orders, wanted, ranges
):
    """Find the least and the largest positions for many duration vectors.

    ``ranges[vector, joint, side]`` receives them for each ``wanted[joint]``, counted from the first
    way-point; −inf and inf where the durations define no curve. The rest as in `batch_peaks`.
    """
    count, inner = durations.shape[1] + 1, average.shape[0]
    size = inner + degree + 1
    groups = max(1, fractions.shape[0])
    columns = waypoints.shape[1] // groups
    times = np.empty(count)
    knots = np.empty(inner + 2 * degree + 2)
    bases = np.empty((inner + 1, degree + 1, degree + 1))
    work = np.empty((degree + 1, degree + 1))
    matrix = np.empty((size, size))
    right = np.empty((size, columns))
    for v in range(durations.shape[0]):
        valid = _timed(durations, v, times)
        for g in range(groups if valid else 0):
            _placed(waypoints, times, average, fractions, g, degree, knots, right)
            valid = _curve(times, knots, degree, orders, right, bases, work, matrix)
            if not valid:
                break
            part = slice(g * columns, (g + 1) * columns)
            _ranges(bases, right, wanted[part], ranges[v, part])
        if not valid:
            ranges[v, :, 0] = -np.inf
            ranges[v, :, 1] = np.inf
