"""Compiled kernels: banded spline systems and the true extrema of polynomials on [0, 1].

Two root finders, written apart and compared in the tests: `roots_in_unit` takes one polynomial, for
the checker; for batches a lane is one joint of one duration vector, and the loops over lanes become
vector instructions. No lane looks at another: order, blocks and threads do not change a bit.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .compilation import by_elements, compiler

MAX_COEFFICIENTS = 10
"""Coefficients of degree 9, the highest that a declaration may have."""
LANES = 192
"""Polynomials handled side by side: loops of that length vectorise, and a block fits a cache."""
SETTLED = 1e-6
"""Newton step below which a lane rests: the next error is its square, 1e-12, and a peak's error
the square of that of its place."""
KERNELS = (
    "kernel.py",
    "banded.py",
    "clamped_kernel.py",
    "leading_kernel.py",
    "piece_kernel.py",
    "pieces.py",
    "range_kernel.py",
    "timed_kernel.py",
)
"""Every file of compiled functions here: they call each other, so they share a stamp."""
compiled = compiler(*(Path(__file__).with_name(name) for name in KERNELS))
"""Compiles a function of one of these files."""


@by_elements()
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


@by_elements("roots")
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
def _add_term(  # type: ignore[no-untyped-def]
    system, right, out, equation, place, k, p, weight, factor, joints, vectors
):
    """Add ``factor · weight`` times coefficient (k, p); it is known where its place is negative."""
    for v in range(vectors if place >= 0 else 0):
        system[equation, place, v] += factor * weight[v]
    for j in range(joints if place < 0 else 0):
        for v in range(vectors):
            x = j * vectors + v
            right[equation, x] -= factor * weight[v] * out[k, p, x]


@compiled
def _raise_pivot(  # type: ignore[no-untyped-def]
    system, right, c, i, lower, width, joints, vectors, swap
):
    """Swap equations ``c`` and ``i`` where that makes the pivot of column ``c`` larger."""
    count = 0
    for v in range(vectors):
        swap[v] = abs(system[i, c - i + lower, v]) > abs(system[c, lower, v])
        count += 1 if swap[v] else 0
    if count == 0:
        return
    for m in range(c, width + 1):
        for v in range(vectors):
            one, other = system[c, m - c + lower, v], system[i, m - i + lower, v]
            system[c, m - c + lower, v] = other if swap[v] else one
            system[i, m - i + lower, v] = one if swap[v] else other
    for j in range(joints):
        for v in range(vectors):
            one, other = right[c, j * vectors + v], right[i, j * vectors + v]
            right[c, j * vectors + v] = other if swap[v] else one
            right[i, j * vectors + v] = one if swap[v] else other


@compiled
def fit_coefficients(  # type: ignore[no-untyped-def]
    h, vectors, values, kinds, breaks, orders, degrees, column, lower, upper, perm,
    system, right, out,
):  # fmt: skip
    """Fit the coefficients in s = (t − t_k)/h_k of all joints for vectors ``h[segment, vector]``.

    A banded elimination with partial pivoting. ``values[row, joint]`` are the right-hand sides
    (way-points and prescribed derivatives); ``column[segment, power]`` is the unknown's index, or
    −1 where a row gives it at once; ``perm[p, r]`` = p!/(p − r)!. ``out`` has shape (segment,
    power, lane = joint · vectors + vector); it is not finite where the system is singular.
    """
    joints, unknowns = values.shape[1], system.shape[0]
    weight, power, swap = np.empty(vectors), np.empty(vectors), np.empty(vectors, np.bool_)
    system[:] = 0.0
    e = 0
    for row in range(kinds.size):  # at each break: left values, right values, matches
        kind, b, r = kinds[row], breaks[row], orders[row]
        k = b if kind == 1 else b - 1
        for v in range(vectors):
            weight[v], power[v] = 1.0, 1.0
        for _ in range(r if kind < 2 else 0):
            for v in range(vectors):
                power[v] *= h[k, v]
        for j in range(joints):
            for v in range(vectors):
                if kind == 1:
                    out[k, r, j * vectors + v] = values[row, j] * power[v] / perm[r, r]
                else:
                    right[e, j * vectors + v] = values[row, j] * power[v]
        if kind == 1:
            continue
        for _ in range(r if kind == 2 else 0):
            for v in range(vectors):
                weight[v] *= min(1.0, h[b, v] / h[k, v])
                power[v] *= min(1.0, h[k, v] / h[b, v])
        if kind == 2 and r <= degrees[b]:
            place = column[b, r] - e + lower if column[b, r] >= 0 else -1
            _add_term(system, right, out, e, place, b, r, power, -perm[r, r], joints, vectors)
        for p in range(r, degrees[k] + 1):
            place = column[k, p] - e + lower if column[k, p] >= 0 else -1
            _add_term(system, right, out, e, place, k, p, weight, perm[p, r], joints, vectors)
        e += 1
    for c in range(unknowns):
        last = min(c + lower, unknowns - 1)
        width = min(c + lower + upper, unknowns - 1)
        for i in range(c + 1, last + 1):
            _raise_pivot(system, right, c, i, lower, width, joints, vectors, swap)
        for i in range(c + 1, last + 1):
            for v in range(vectors):
                weight[v] = system[i, c - i + lower, v] / system[c, lower, v]
            for m in range(c + 1, width + 1):
                for v in range(vectors):
                    system[i, m - i + lower, v] -= weight[v] * system[c, m - c + lower, v]
            for j in range(joints):
                for v in range(vectors):
                    right[i, j * vectors + v] -= weight[v] * right[c, j * vectors + v]
    for c in range(unknowns - 1, -1, -1):
        for j in range(joints):
            for m in range(c + 1, min(c + lower + upper, unknowns - 1) + 1):
                for v in range(vectors):
                    known = right[m, j * vectors + v]
                    right[c, j * vectors + v] -= system[c, m - c + lower, v] * known
            for v in range(vectors):
                right[c, j * vectors + v] /= system[c, lower, v]
    for k in range(degrees.size):
        for p in range(degrees[k] + 1):
            for x in range(joints * vectors if column[k, p] >= 0 else 0):
                out[k, p, x] = right[column[k, p], x]


@compiled
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


@compiled
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


@compiled
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
                step = step if moved[x] > SETTLED else here
                change = abs(step - here)
                low[x], high[x], s[x], moved[x] = lo, hi, step, change
                busy += 1 if change > SETTLED else 0
            if busy == 0:
                break
        for x in range(lanes):
            low[x] = cuts[piece, x]
            start[x] = end[x]
            cuts[piece, x] = s[x]


@compiled
def lane_peaks(a, degree, perm, lanes, cuts, state, side, peak):  # type: ignore[no-untyped-def]
    """Largest absolute value on [0, 1] of the polynomials ``a[power, lane]``.

    With ``side`` 1 the largest value instead, with −1 that of the polynomials' negatives.
    """
    for x in range(lanes):
        end = 0.0
        for i in range(degree + 1):
            end += a[i, x]
        if side == 0.0:
            peak[x] = abs(a[0, x]) if abs(a[0, x]) >= abs(end) else abs(end)
        else:
            peak[x] = side * a[0, x] if side * a[0, x] >= side * end else side * end
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
        if side == 0.0:
            for x in range(lanes):
                peak[x] = abs(value[x]) if abs(value[x]) > peak[x] else peak[x]
        else:
            for x in range(lanes):
                peak[x] = side * value[x] if side * value[x] > peak[x] else peak[x]


@compiled
def take_durations(durations, h, v):  # type: ignore[no-untyped-def]
    """Put one vector into ``h[:, v]``; ones, and false, unless all are positive and finite."""
    valid = True
    for k in range(durations.size):
        valid = valid and 0.0 < durations[k] < np.inf
    for k in range(durations.size):
        h[k, v] = durations[k] if valid else 1.0
    return valid


@compiled
def batch_peaks(  # type: ignore[no-untyped-def]
    durations, values, kinds, breaks, orders, degrees, column, lower, upper, perm, wanted, side,
    peaks,
):  # fmt: skip
    """Find the true peaks of the wanted derivatives for many duration vectors.

    ``wanted[joint, order − 1]`` selects; ``peaks[vector, joint, order − 1]`` receives the largest
    absolute value over all t, infinite where a duration is not positive and finite or the value
    overflows. With ``side`` 1 or −1 it receives the furthest value above 0, or below, as a size; 0
    where there is none.
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
    room = np.empty((8, joints * block))
    state = (room[0], room[1], room[2], room[3], room[4], room[5], room[6], room[7])
    for first in range(0, durations.shape[0], max(1, block)):
        vectors = min(block, durations.shape[0] - first)
        for v in range(vectors):
            peaks[first + v] = 0.0 if take_durations(durations[first + v], h, v) else np.inf
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
                for i in range(degree + 1):
                    for x in range(joints * vectors):
                        a[i, x] = perm[i + r, r] * scaled[k, i + r, x]
                lane_peaks(a, degree, perm, joints * vectors, cuts, state, side, peak)
                for v in range(vectors):
                    rate = 1.0 / h[k, v]
                    for _ in range(r - 1):
                        rate *= 1.0 / h[k, v]
                    for j in range(joints):
                        top = peak[j * vectors + v] * rate
                        if wanted[j, r - 1] and not top <= peaks[first + v, j, r - 1]:
                            peaks[first + v, j, r - 1] = top if top == top else np.inf
