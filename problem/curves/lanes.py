"""Batches as numpy handles them, all lanes by one operation, where `kernel` is not compiled yet.

Line by line the compiled functions of the same names, with the same operations in the same order:
both give the same bits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .kernel import MAX_COEFFICIENTS, SETTLED

_LANES = 4096
"""Polynomials handled side by side: numpy's own share of the time is small from here on."""


def batch_peaks(
    durations: Array,
    values: Array,
    kinds: NDArray[np.int64],
    breaks: NDArray[np.int64],
    orders: NDArray[np.int64],
    degrees: NDArray[np.int64],
    column: NDArray[np.int64],
    lower: int,
    upper: int,
    perm: Array,
    wanted: NDArray[np.bool_],
    side: float,
    peaks: Array,
) -> None:
    """Find the true peaks of the wanted derivatives; arguments and ``peaks`` as compiled."""
    block = max(1, _LANES // values.shape[1])
    rows = (values, kinds, breaks, orders, degrees, column, int(lower), int(upper), perm)
    with np.errstate(all="ignore"):
        for first in range(0, len(durations), block):
            h = durations[first : first + block].T
            valid = np.logical_and.reduce((h > 0.0) & (h < np.inf))
            h = np.where(valid, h, 1.0)
            found = peaks[first : first + block]
            found[...] = np.where(valid, 0.0, np.inf)[:, None, None]
            scaled = _fitted(h, *rows)
            for r in range(1, 4):
                asked = wanted[:, r - 1]
                for k in range(len(degrees) if asked.any() else 0):
                    if degrees[k] >= r:
                        _raise_peaks(scaled[k], h[k], int(degrees[k]), r, perm, asked, side, found)


def leading_peaks(
    durations: Array,
    values: Array,
    kinds: NDArray[np.int64],
    breaks: NDArray[np.int64],
    orders: NDArray[np.int64],
    degrees: NDArray[np.int64],
    column: NDArray[np.int64],
    lower: int,
    upper: int,
    perm: Array,
    wanted: NDArray[np.bool_],
    ceilings: Array,
    floor: float,
    peaks: Array,
) -> None:
    """Find all true peaks, those that lead among them; arguments as compiled."""
    rows = (values, kinds, breaks, orders, degrees, column, lower, upper, perm)
    batch_peaks(durations, *rows, wanted, 0.0, peaks)


def fit_coefficients(
    h: Array,
    vectors: int,
    values: Array,
    kinds: NDArray[np.int64],
    breaks: NDArray[np.int64],
    orders: NDArray[np.int64],
    degrees: NDArray[np.int64],
    column: NDArray[np.int64],
    lower: int,
    upper: int,
    perm: Array,
    system: Array,
    right: Array,
    out: Array,
) -> None:
    """Fit the coefficients of all joints; arguments and ``out`` as compiled, no room needed."""
    rows = (values, kinds, breaks, orders, degrees, column, lower, upper, perm)
    with np.errstate(all="ignore"):
        out[...] = _fitted(h, *rows).reshape(out.shape)


def _raise_peaks(
    scaled: Array,
    duration: Array,
    degree: int,
    r: int,
    perm: Array,
    asked: NDArray[np.bool_],
    side: float,
    peaks: Array,
) -> None:
    """Raise ``peaks`` to those of derivative ``r`` on one segment."""
    a = perm[r : degree + 1, r][:, None, None] * scaled[r : degree + 1]
    rate = 1.0 / duration
    power = rate
    for _ in range(r - 1):
        power = power * rate
    top = (_lane_peaks(a, degree - r, perm, side) * power).T
    before = peaks[:, :, r - 1]
    higher = asked & ~(top <= before)
    before[higher] = np.where(top == top, top, np.inf)[higher]


def _fitted(
    h: Array,
    values: Array,
    kinds: NDArray[np.int64],
    breaks: NDArray[np.int64],
    orders: NDArray[np.int64],
    degrees: NDArray[np.int64],
    column: NDArray[np.int64],
    lower: int,
    upper: int,
    perm: Array,
) -> Array:
    """Coefficients of all joints, shape (segments, 10, joints, vectors)."""
    joints, vectors, unknowns = values.shape[1], h.shape[1], int(column.max()) + 1
    system = np.zeros((unknowns, 2 * lower + upper + 1, vectors))
    right = np.empty((unknowns, joints, vectors))
    out = np.zeros((len(degrees), MAX_COEFFICIENTS, joints, vectors))

    def add(e: int, k: int, p: int, weight: Array, factor: float) -> None:
        if column[k, p] >= 0:
            system[e, column[k, p] - e + lower] += factor * weight
        else:
            right[e] -= factor * weight * out[k, p]

    e = 0
    for row in range(len(kinds)):
        kind, b, r = int(kinds[row]), int(breaks[row]), int(orders[row])
        k = b if kind == 1 else b - 1
        weight, power = np.ones(vectors), np.ones(vectors)
        for _ in range(r if kind < 2 else 0):
            power = power * h[k]
        if kind == 1:
            out[k, r] = values[row][:, None] * power / perm[r, r]
            continue
        right[e] = values[row][:, None] * power
        for _ in range(r if kind == 2 else 0):
            weight = weight * np.minimum(1.0, h[b] / h[k])
            power = power * np.minimum(1.0, h[k] / h[b])
        if kind == 2 and r <= degrees[b]:
            add(e, b, r, power, -perm[r, r])
        for p in range(r, int(degrees[k]) + 1):
            add(e, k, p, weight, perm[p, r])
        e += 1
    _solve(system, right, lower, upper)
    for k, degree in enumerate(degrees):
        for p in range(degree + 1):
            if column[k, p] >= 0:
                out[k, p] = right[column[k, p]]
    return out


def _solve(system: Array, right: Array, lower: int, upper: int) -> None:
    """Banded elimination with partial pivoting, in place; the answer stands in ``right``."""
    unknowns = len(system)
    for c in range(unknowns):
        last = min(c + lower, unknowns - 1)
        size = min(c + lower + upper, unknowns - 1) - c + 1
        pivot = system[c, lower : lower + size]
        for i in range(c + 1, last + 1):
            other = system[i, c - i + lower : c - i + lower + size]
            swap = np.abs(other[0]) > np.abs(pivot[0])
            if swap.any():
                pivot[...], other[...] = np.where(swap, other, pivot), np.where(swap, pivot, other)
                one, two = right[c], right[i]
                right[c], right[i] = np.where(swap, two, one), np.where(swap, one, two)
        for i in range(c + 1, last + 1):
            other = system[i, c - i + lower : c - i + lower + size]
            weight = other[0] / pivot[0]
            other[1:] -= weight * pivot[1:]
            right[i] -= weight * right[c]
    for c in range(unknowns - 1, -1, -1):
        for m in range(c + 1, min(c + lower + upper, unknowns - 1) + 1):
            right[c] -= system[c, m - c + lower] * right[m]
        right[c] /= system[c, lower]


def _lane_horner(a: Array, order: int, degree: int, perm: Array, s: Array) -> tuple[Array, Array]:
    """Derivative ``order`` of every lane's polynomial at ``s``, and its slope."""
    value, slope = perm[degree, order] * a[degree], np.zeros(s.shape)
    for i in range(degree - 1, order - 1, -1):
        slope = slope * s + value
        value = value * s + perm[i, order] * a[i]
    return value, slope


def _lane_turns(a: Array, order: int, perm: Array) -> list[Array]:
    """Both roots of the quadratic derivative ``order``, ascending; 0 stands for one outside."""
    c = perm[order, order] * a[order]
    b = 0.5 * perm[order + 1, order] * a[order + 1]
    q = perm[order + 2, order] * a[order + 2]
    d = b * b - q * c
    root = np.sqrt(np.where(d > 0.0, d, 0.0))
    z = -(b + np.where(b >= 0.0, root, -root))
    one, other = z / q, c / z
    one = np.where((one > 0.0) & (one < 1.0), one, 0.0)
    other = np.where((other > 0.0) & (other < 1.0), other, 0.0)
    return [np.where(one < other, one, other), np.where(one < other, other, one)]


def _lane_level(a: Array, order: int, degree: int, perm: Array, cuts: list[Array]) -> list[Array]:
    """From the roots of one derivative to those of the next lower, one more of them."""
    found, low = [], np.zeros(a[0].shape)
    start = perm[order, order] * a[order]
    for cut in (*cuts, np.ones(a[0].shape)):
        high = cut
        end, _ = _lane_horner(a, order, degree, perm, high)
        crosses = ((start < 0.0) != (end < 0.0)) & (start != 0.0) & (end != 0.0)
        s = np.where(crosses, low + (high - low) * (start / (start - end)), low)
        moved = np.where(crosses, 1.0, 0.0)
        for _ in range(100):
            value, slope = _lane_horner(a, order, degree, perm, s)
            before = (value < 0.0) == (start < 0.0)
            low, high = np.where(before, s, low), np.where(before, high, s)
            step = s - value / slope
            step = np.where((low < step) & (step < high), step, 0.5 * (low + high))
            step = np.where(moved > SETTLED, step, s)
            moved, s = np.abs(step - s), step
            if not (moved > SETTLED).any():
                break
        found.append(s)
        low, start = cut, end
    return found


def _lane_peaks(a: Array, degree: int, perm: Array, side: float) -> Array:
    """Largest absolute value on [0, 1] of the polynomials ``a[power]``, or that to one side."""

    def sized(value: Array) -> Array:
        return np.abs(value) if side == 0.0 else side * value

    end = np.zeros(a[0].shape)
    for i in range(degree + 1):
        end = end + a[i]
    peak = np.where(sized(a[0]) >= sized(end), sized(a[0]), sized(end))
    cuts: list[Array] = []
    if degree == 2:
        turn = -0.5 * a[1] / a[2]
        cuts = [np.where((turn > 0.0) & (turn < 1.0), turn, 0.0)]
    elif degree > 2:
        cuts = _lane_turns(a, degree - 2, perm)
    for order in range(degree - 3, 0, -1):
        cuts = _lane_level(a, order, degree, perm, cuts)
    for cut in cuts:
        value = sized(_lane_horner(a, 0, degree, perm, cut)[0])
        peak = np.where(value > peak, value, peak)
    return np.asarray(peak)
