"""Compiled kernel of declared curves: banded systems and true peaks, for populations.

A lane is one joint of one duration vector, and the loops over lanes become vector instructions. No
lane looks at another: order, blocks and threads do not change a bit. The root finder is that of
`polynomials`, written for lanes that rest at different steps; the tests compare both.

What is asked of one curve is array code. What loops over a population, over the rows of a long
system or over the boxes of a proof is compiled at its first call, and lies on disk for the next
process. Nothing is interpreted meanwhile, so no loop stops in its middle. Modules import this one
in the function that needs it, because numba takes a while.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .polynomials import MAX_COEFFICIENTS

Function = Callable[..., Any]

LANES = 320
"""Polynomials handled side by side: the loop over them vectorises, and a block fits a cache. Half
and twice as many take a tenth to a quarter longer. Vectors come in eights, as registers do."""
SETTLED = 1e-6
"""Newton step below which a lane rests: the next error is its square, 1e-12, and a peak's error
the square of that of its place."""
KERNELS = ("kernel.py", "blocks.py")
"""Every file of compiled functions here: they share a stamp."""


def compiler(*sources: Path) -> Callable[[Function], Function]:
    """Make a decorator for functions to be compiled, and cached where there is a writable place.

    numba's cache looks at the file of the function alone, so a function would go on calling an
    old callee from another file. Functions that call each other are compiled by one decorator, and
    the hash of all their files stands in their names: ``sources`` are these files.
    """
    import numba

    stamp = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]

    def compiled(function: Function) -> Function:
        function.__qualname__ = f"{function.__qualname__}_{stamp}"
        try:
            made = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
        except RuntimeError:  # no writable place for the cache: compile in memory
            made = numba.njit(nogil=True, error_model="numpy")(function)
        return made

    return compiled


compiled = compiler(*(Path(__file__).with_name(name) for name in KERNELS))
"""Compiles a function of one of these files."""


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
    h, vectors, values, kinds, breaks, orders, columns, factors, unknown, first, lower, upper,
    system, right, out,
):  # fmt: skip
    """Fit the coefficients in s = (t − t_k)/h_k of all joints for vectors ``h[segment, vector]``.

    A banded elimination with partial pivoting of the rows that `Conditions` states, an entry across
    a break and its row both scaled down where h_{b−1}/h_b is large. ``values[row, joint]`` are the
    right-hand sides; ``unknown[column]`` is −1 where a row gives a coefficient at once. ``out`` has
    shape (coefficient, lane = joint · vectors + vector); it is not finite where the system is
    singular.
    """
    joints, unknowns = values.shape[1], system.shape[0]
    weight, power, swap = np.empty(vectors), np.empty(vectors), np.empty(vectors, np.bool_)
    system[:] = 0.0
    e = 0
    for row in range(kinds.size):
        kind, b, c = kinds[row], breaks[row], columns[row, 0]
        k = b if kind == 1 else b - 1
        weight[:] = 1.0
        power[:] = 1.0
        for _ in range(orders[row]):
            if kind == 2:
                for v in range(vectors):
                    weight[v] *= min(1.0, h[b, v] / h[k, v])
                    power[v] *= min(1.0, h[k, v] / h[b, v])
            else:
                for v in range(vectors):
                    power[v] *= h[k, v]
        for j in range(joints):
            for v in range(vectors):
                given = values[row, j] * power[v]
                if kind == 1:
                    out[c, j * vectors + v] = given / factors[row, 0]
                else:
                    right[e, j * vectors + v] = given
        if kind == 1:
            continue
        for m in range(columns.shape[1]):
            c, factor = columns[row, m], factors[row, m]
            scale = power if kind == 2 and c >= first[b] else weight
            if factor == 0.0:
                continue
            for v in range(vectors if unknown[c] >= 0 else 0):
                system[e, unknown[c] - e + lower, v] = factor * scale[v]
            for j in range(joints if unknown[c] < 0 else 0):
                for v in range(vectors):
                    right[e, j * vectors + v] -= factor * scale[v] * out[c, j * vectors + v]
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
    for c in range(unknown.size):
        for x in range(joints * vectors if unknown[c] >= 0 else 0):
            out[c, x] = right[unknown[c], x]


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
def _lane_value(a, order, degree, perm, lanes, s, value):  # type: ignore[no-untyped-def]
    """Evaluate derivative ``order`` of every lane's polynomial at ``s[lane]``."""
    for x in range(lanes):
        value[x] = perm[degree, order] * a[degree, x]
    for i in range(degree - 1, order - 1, -1):
        for x in range(lanes):
            value[x] = value[x] * s[x] + perm[i, order] * a[i, x]


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
        _lane_value(a, order, degree, perm, lanes, high, end)
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
def _lane_reach(a, degree, perm, lanes, cuts, state, least, most):  # type: ignore[no-untyped-def]
    """Least and largest value of the polynomials ``a[power, lane]`` on [0, 1]."""
    value = state[6]
    for x in range(lanes):
        end = 0.0
        for i in range(degree + 1):
            end += a[i, x]
        least[x] = a[0, x] if a[0, x] <= end else end
        most[x] = a[0, x] if a[0, x] >= end else end
    if degree == 2:
        for x in range(lanes):
            turn = -0.5 * a[1, x] / a[2, x]
            cuts[0, x] = turn if 0.0 < turn < 1.0 else 0.0
    if degree > 2:
        _lane_turns(a, degree - 2, perm, lanes, cuts)
    for order in range(degree - 3, 0, -1):
        _lane_level(a, order, degree, perm, lanes, degree - 1 - order, cuts, state)
    for piece in range(degree - 1):
        _lane_value(a, 0, degree, perm, lanes, cuts[piece], value)
        for x in range(lanes):
            least[x] = value[x] if value[x] < least[x] else least[x]
            most[x] = value[x] if value[x] > most[x] else most[x]


@compiled
def batch_peaks(  # type: ignore[no-untyped-def]
    durations, values, kinds, breaks, orders, columns, factors, unknown, first, lower, upper, perm,
    wanted, least, sides, peaks,
):  # fmt: skip
    """Find the true peaks of the wanted derivatives for many duration vectors.

    ``wanted[joint, i]`` selects derivative ``least + i``, whose largest absolute value over all t
    ``peaks[vector, side, joint, i]`` gets where ``sides[side]`` is 0. Where that is 1 or −1, it
    gets the furthest value above 0, or below, as a size, and 0 where there is none. It is infinite
    where a duration is not positive and finite, or the value overflows.
    """
    n, joints, unknowns = first.size - 1, values.shape[1], 0
    for c in range(unknown.size):  # `max` takes a third of a second to compile
        unknowns += 1 if unknown[c] >= 0 else 0
    block = LANES // joints
    block = min(max(1, block - block % 8), durations.shape[0])
    h = np.empty((n, block))
    system = np.empty((unknowns, 2 * lower + upper + 1, block))
    right = np.empty((unknowns, joints * block))
    scaled = np.empty((first[n], joints * block))
    a = np.empty((MAX_COEFFICIENTS, joints * block))
    cuts = np.empty((MAX_COEFFICIENTS, joints * block))
    low, high, rate = np.empty(joints * block), np.empty(joints * block), np.empty(block)
    best = np.empty((2, joints * block))
    room = np.empty((8, joints * block))
    state = (room[0], room[1], room[2], room[3], room[4], room[5], room[6], room[7])
    for start in range(0, durations.shape[0], max(1, block)):
        vectors = min(block, durations.shape[0] - start)
        lanes = joints * vectors
        for v in range(vectors):
            valid = True
            for k in range(n):
                valid = valid and 0.0 < durations[start + v, k] < np.inf
            for k in range(n):
                h[k, v] = durations[start + v, k] if valid else 1.0
            peaks[start + v] = 0.0 if valid else np.inf
        fit_coefficients(
            h, vectors, values, kinds, breaks, orders, columns, factors, unknown, first, lower,
            upper, system, right, scaled,
        )  # fmt: skip
        for i in range(wanted.shape[1]):
            r = least + i
            if not wanted[:, i].any():
                continue
            best[:] = 0.0
            for k in range(n):
                degree = first[k + 1] - first[k] - 1 - r
                if degree < 0:
                    continue
                for p in range(degree + 1):
                    for x in range(lanes):
                        a[p, x] = perm[p + r, r] * scaled[first[k] + p + r, x]
                for v in range(vectors):
                    rate[v] = 1.0
                for _ in range(r):
                    for v in range(vectors):
                        rate[v] *= 1.0 / h[k, v]
                _lane_reach(a, degree, perm, lanes, cuts, state, low, high)
                for j in range(joints):
                    for v in range(vectors):
                        x = j * vectors + v
                        one, other = -low[x] * rate[v], high[x] * rate[v]
                        one = one if one == one else np.inf
                        other = other if other == other else np.inf
                        best[0, x] = one if one > best[0, x] else best[0, x]
                        best[1, x] = other if other > best[1, x] else best[1, x]
            for v in range(vectors):
                for j in range(joints):
                    one, other = best[0, j * vectors + v], best[1, j * vectors + v]
                    for side in range(sides.size):
                        top = max(one, other) if sides[side] == 0.0 else one
                        top = other if sides[side] > 0.0 else top
                        if wanted[j, i] and top > peaks[start + v, side, j, i]:
                            peaks[start + v, side, j, i] = top
