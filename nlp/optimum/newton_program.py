"""Compiled: the quadratic program of a Newton step, set up and solved.

The program of `descent` once more, written apart for a compiler: the tests compare the two.
"""

from __future__ import annotations

import math

import numpy as np

from .newton_curve import compiled


@compiled
def inverted(hessian, factor, out):  # type: ignore[no-untyped-def]
    """Inverse of a positive definite matrix by Cholesky; false if it is not clearly one."""
    size = hessian.shape[0]
    top = 0.0
    for i in range(size):
        top = max(top, abs(hessian[i, i]))
    for i in range(size):
        for m in range(i + 1):
            total = hessian[i, m]
            for k in range(m):
                total -= factor[i, k] * factor[m, k]
            if i == m:
                if not total > 1e-9 * top:
                    return False
                factor[i, i] = math.sqrt(total)
            else:
                factor[i, m] = total / factor[m, m]
    for c in range(size):
        for i in range(size):
            total = 1.0 if i == c else 0.0
            for k in range(i):
                total -= factor[i, k] * out[k, c]
            out[i, c] = total / factor[i, i]
        for i in range(size - 1, -1, -1):
            total = out[i, c]
            for k in range(i + 1, size):
                total -= factor[k, i] * out[k, c]
            out[i, c] = total / factor[i, i]
    return True


@compiled
def least_step(  # type: ignore[no-untyped-def]
    inverse, slope, rows, room, count, step, weights, active, held, image, turned, gram, dual, move
):
    """Least ½dᵀHd + gᵀd with Ad ≤ b, by the dual method of Goldfarb and Idnani (1983).

    ``step`` and ``weights`` (multipliers of the rows) receive the answer; false where none is.
    """
    size = slope.size
    for i in range(count):
        weights[i] = 0.0
    for i in range(size):
        total = 0.0
        for m in range(size):
            total -= inverse[i, m] * slope[m]
        step[i] = total
    taken = 0
    for _ in range(50 * size):
        worst, row = 1e-13, -1
        for i in range(count):
            over = -room[i]
            for m in range(size):
                over += rows[i, m] * step[m]
            over /= 1.0 + abs(room[i])
            if over > worst:
                worst, row = over, i
        if row < 0:
            for i in range(taken):
                weights[active[i]] = held[i]
            return True
        fresh = 0.0
        for i in range(taken):
            if active[i] == row:
                return False
        while True:
            for i in range(size):
                turned[i] = 0.0
                for m in range(size):
                    turned[i] += inverse[i, m] * rows[row, m]
            for c in range(taken):
                for i in range(taken):
                    gram[c, i] = 0.0
                    for m in range(size):
                        gram[c, i] += rows[active[c], m] * image[i, m]
                gram[c, taken] = 0.0
                for m in range(size):
                    gram[c, taken] += rows[active[c], m] * turned[m]
            for c in range(taken):  # symmetric and positive: no pivoting
                if not gram[c, c] > 0.0:
                    return False
                for i in range(c + 1, taken):
                    factor = gram[i, c] / gram[c, c]
                    for m in range(c, taken + 1):
                        gram[i, m] -= factor * gram[c, m]
            for c in range(taken - 1, -1, -1):
                dual[c] = gram[c, taken]
                for i in range(c + 1, taken):
                    dual[c] -= gram[c, i] * dual[i]
                dual[c] /= gram[c, c]
            bend, plain, over = 0.0, 0.0, -room[row]
            for i in range(size):
                move[i] = -turned[i]
                for c in range(taken):
                    move[i] += dual[c] * image[c, i]
                bend -= rows[row, i] * move[i]
                plain += rows[row, i] * turned[i]
                over += rows[row, i] * step[i]
            longest, leaving = np.inf, -1
            for c in range(taken):
                if dual[c] > 1e-14 and held[c] / dual[c] < longest:
                    longest, leaving = held[c] / dual[c], c
            full = over / bend if bend > 1e-12 * plain and taken < size else np.inf
            if longest == np.inf and full == np.inf:
                return False
            length = min(longest, full)
            if full < np.inf:
                for i in range(size):
                    step[i] += length * move[i]
            for c in range(taken):
                held[c] -= length * dual[c]
            fresh += length
            if full <= longest:
                active[taken], held[taken] = row, fresh
                for i in range(size):
                    image[taken, i] = turned[i]
                taken += 1
                break
            taken -= 1
            for c in range(leaving, taken):
                active[c], held[c] = active[c + 1], held[c + 1]
                for i in range(size):
                    image[c, i] = image[c + 1, i]
    return False


@compiled
def filled(z, low, high, radius, count, excess, gradient, rows, room):  # type: ignore[no-untyped-def]
    """Rows of the quadratic program: limits less the elastic part, box and trust region."""
    n = z.size
    for i in range(count):
        for m in range(n):
            rows[i, m] = gradient[i, m]
        rows[i, n] = -1.0
        room[i] = -excess[i]
    total = count
    for k in range(n):
        for sign in (1.0, -1.0):
            for m in range(n + 1):
                rows[total, m] = 0.0
            rows[total, k] = sign
            wall = high[k] - z[k] if sign > 0 else z[k] - low[k]
            room[total] = max(0.0, min(wall, radius))
            total += 1
    for m in range(n):
        rows[total, m] = 0.0
    rows[total, n], room[total] = -1.0, 0.0
    return total + 1
