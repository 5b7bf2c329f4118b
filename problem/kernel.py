"""Compiled kernels: banded spline systems and the true extrema of polynomials on [0, 1].

Two root finders, written apart and compared in the tests: `roots_in_unit` takes one polynomial, for
the checker; the lanes take every joint of a block of duration vectors, in loops that become vector
instructions. No lane looks at another: a batch's order, blocks and threads do not change a bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numba
import numpy as np

MAX_COEFFICIENTS = 10
_LANES = 96
_SETTLED = 1e-8


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    try:
        jitted = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # no writable place for the cache: compile in memory
        jitted = numba.njit(nogil=True, error_model="numpy")(function)
    return cast(Callable[..., Any], jitted)


@_compiled
def horner(a, degree, s):  # type: ignore[no-untyped-def]
    """Value of the polynomial with ascending coefficients ``a`` at ``s``."""
    value = a[degree]
    for i in range(degree - 1, -1, -1):
        value = value * s + a[i]
    return value


@_compiled
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


@_compiled
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
        for m in range(c + 1, width + 1):
            factor = system[c, m]
            if factor != 0.0:
                for j in range(joints):
                    right[c, j] -= factor * right[m, j]
        for j in range(joints):
            right[c, j] *= inverse
    for k in range(degrees.size):
        for p in range(degrees[k] + 1):
            if column[k, p] >= 0:
                for j in range(joints):
                    out[k, p, j] = right[column[k, p], j]
    return True


@_compiled
def _lane_horner(a, order, degree, perm, lanes, s, value, slope):  # type: ignore[no-untyped-def]
    """Evaluate derivative ``order`` of every lane's polynomial at ``s[lane]``, and its slope."""
    top = perm[degree, order]
    for x in range(lanes):
        value[x] = top * a[degree, x]
        slope[x] = 0.0
    for i in range(degree - 1, order - 1, -1):
        factor = perm[i, order]
        for x in range(lanes):
            slope[x] = slope[x] * s[x] + value[x]
            value[x] = value[x] * s[x] + factor * a[i, x]


@_compiled
def _lane_turns(a, order, perm, lanes, cuts):  # type: ignore[no-untyped-def]
    """Both roots of the quadratic derivative ``order``, ascending; 0 stands for one outside."""
    f0, f1, f2 = perm[order, order], 0.5 * perm[order + 1, order], perm[order + 2, order]
    for x in range(lanes):
        c = f0 * a[order, x]
        b = f1 * a[order + 1, x]
        q = f2 * a[order + 2, x]
        d = b * b - q * c
        root = np.sqrt(d if d > 0.0 else 0.0)
        z = -(b + (root if b >= 0.0 else -root))
        one = z / q
        other = c / z
        one = one if 0.0 < one < 1.0 else 0.0
        other = other if 0.0 < other < 1.0 else 0.0
        cuts[0, x] = one if one < other else other
        cuts[1, x] = other if one < other else one


@_compiled
def _lane_level(a, order, degree, perm, lanes, count, cuts, state):  # type: ignore[no-untyped-def]
    """From the roots of one derivative, ``cuts[:count]``, to those of the next lower, ``order``.

    Between cuts it is monotone: one root, or none and the piece's lower end stands for it; every
    lane has ``count + 1`` cuts then. Newton from the chord's zero, bisection where it leaves the
    bracket; a lane rests once Newton's next error drowns in the polynomial's rounding.
    """
    s, low, high, start, end, moved, value, slope = state
    for x in range(lanes):
        low[x] = 0.0
        start[x] = perm[order, order] * a[order, x]
    for piece in range(count + 1):
        for x in range(lanes):
            high[x] = cuts[piece, x] if piece < count else 1.0
        _lane_horner(a, order, degree, perm, lanes, high, end, slope)
        for x in range(lanes):
            f, g = start[x], end[x]
            crosses = ((f < 0.0) != (g < 0.0)) & (f != 0.0) & (g != 0.0)
            chord = low[x] + (high[x] - low[x]) * (f / (f - g))
            s[x] = chord if crosses else low[x]
            moved[x] = 1.0 if crosses else 0.0
            cuts[piece, x] = high[x]
        for _ in range(100):
            _lane_horner(a, order, degree, perm, lanes, s, value, slope)
            busy = 0
            for x in range(lanes):
                here = s[x]
                before = (value[x] < 0.0) == (start[x] < 0.0)
                lo = here if before else low[x]
                hi = high[x] if before else here
                step = here - value[x] / slope[x]
                step = step if lo < step < hi else 0.5 * (lo + hi)
                step = step if moved[x] > _SETTLED else here
                change = abs(step - here)
                low[x], high[x], s[x], moved[x] = lo, hi, step, change
                busy += 1 if change > _SETTLED else 0
            if busy == 0:
                break
        for x in range(lanes):
            low[x] = cuts[piece, x]
            start[x] = end[x]
            cuts[piece, x] = s[x]


@_compiled
def _lane_peaks(a, degree, perm, lanes, cuts, state, peak):  # type: ignore[no-untyped-def]
    """Largest absolute value on [0, 1] of the polynomials ``a[power, lane]``."""
    for x in range(lanes):
        end = 0.0
        for i in range(degree + 1):
            end += a[i, x]
        peak[x] = abs(a[0, x]) if abs(a[0, x]) >= abs(end) else abs(end)
        if degree == 2:
            turn = -0.5 * a[1, x] / a[2, x]
            cuts[0, x] = turn if 0.0 < turn < 1.0 else 0.0
    if degree > 2:
        _lane_turns(a, degree - 2, perm, lanes, cuts)
    for order in range(degree - 3, 0, -1):
        _lane_level(a, order, degree, perm, lanes, degree - 1 - order, cuts, state)
    value, slope = state[6], state[7]
    for piece in range(degree - 1):
        _lane_horner(a, 0, degree, perm, lanes, cuts[piece], value, slope)
        for x in range(lanes):
            peak[x] = abs(value[x]) if abs(value[x]) > peak[x] else peak[x]


@_compiled
def batch_peaks(  # type: ignore[no-untyped-def]
    durations, values, kinds, breaks, orders, degrees, column, lower, upper, perm, wanted, peaks
):
    """Find the true peaks of the wanted derivatives for many duration vectors.

    ``wanted[joint, order − 1]`` selects; ``peaks[vector, joint, order − 1]`` receives the largest
    absolute value over all t, infinite where a duration is not positive and finite or the value
    overflows. A lane is one joint of one vector.
    """
    n, joints, unknowns = degrees.size, values.shape[1], column.max() + 1
    block = max(1, _LANES // joints)
    room = block * joints
    system = np.empty((unknowns, unknowns))
    right = np.empty((unknowns, joints))
    out = np.empty((n, MAX_COEFFICIENTS, joints))
    scaled = np.empty((n, MAX_COEFFICIENTS, room))
    a = np.empty((MAX_COEFFICIENTS, room))
    cuts = np.empty((MAX_COEFFICIENTS, room))
    peak = np.empty(room)
    e = np.empty((8, room))
    state = (e[0], e[1], e[2], e[3], e[4], e[5], e[6], e[7])
    for first in range(0, durations.shape[0], block):
        vectors = min(block, durations.shape[0] - first)
        lanes = vectors * joints
        for b in range(vectors):
            h = durations[first + b]
            valid = True
            for k in range(n):
                valid = valid and h[k] > 0.0 and h[k] < np.inf
            if valid:
                valid = fit_coefficients(
                    h, values, kinds, breaks, orders, degrees, column, lower, upper, perm,
                    system, right, out,
                )  # fmt: skip
            for k in range(n):
                for p in range(degrees[k] + 1):
                    for j in range(joints):
                        scaled[k, p, b * joints + j] = out[k, p, j] if valid else 0.0
            peaks[first + b] = 0.0 if valid else np.inf
        for r in range(1, 4):
            if not wanted[:, r - 1].any():
                continue
            for k in range(n):
                degree = degrees[k] - r
                if degree < 0:
                    continue
                for i in range(degree + 1):
                    for x in range(lanes):
                        a[i, x] = perm[i + r, r] * scaled[k, i + r, x]
                _lane_peaks(a, degree, perm, lanes, cuts, state, peak)
                for b in range(vectors):
                    rate = (1.0 / durations[first + b, k]) ** r
                    for j in range(joints):
                        top = peak[b * joints + j] * rate
                        if wanted[j, r - 1] and not top <= peaks[first + b, j, r - 1]:
                            peaks[first + b, j, r - 1] = top if top == top else np.inf
