"""Many polynomials on [0, 1] at once: their derivatives, values and sign changes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array

Numbers = NDArray[Any]
"""Real or complex, of any precision, or objects: gradients are taken by complex steps."""
MAX_COEFFICIENTS = 10
"""Coefficients of degree 9, the highest that a declaration may have."""
PERM = np.array(
    [[float(math.perm(p, r)) for r in range(MAX_COEFFICIENTS)] for p in range(MAX_COEFFICIENTS)]
)
"""PERM[p, r] = p!/(p − r)!: the factor of sᵖ⁻ʳ in the r-th derivative of sᵖ."""
CAPPED = 1e-9
"""Share of a cap within which a value is found to its last bit: far above the rounding of both."""
LOOSE = 1e-12
"""Share of a polynomial's terms that is added to a bound: far above the rounding of ten of them, so
what is left out by it would not have changed one bit."""
Clock = tuple[Array, int, Array]
"""Of derivatives N_r/t′²ʳ⁻¹: t, r, and the least t′ of each piece."""
_SETTLED = 2.0**-52
"""Step after which a root in the unit interval is known to the last bit: the spacing at 1."""


def derived(a: Numbers, order: int) -> Numbers:
    """Coefficients of a derivative by s; ascending powers lead, and one at least is left."""
    if order >= len(a):
        return np.zeros((1, *a.shape[1:]))
    factor = PERM[order : len(a), order]
    return np.asarray(factor.reshape(-1, *[1] * (a.ndim - 1)) * a[order:])


def derivative_rows(s: Array, order: NDArray[np.int64]) -> Array:
    """Weights of ten coefficients in derivatives by s at many places, shape (places, 10)."""
    left = np.arange(MAX_COEFFICIENTS) - order[:, None]
    powers = np.where(left >= 0, s[:, None] ** np.maximum(left, 0), 0.0)
    return np.asarray(powers * PERM[:, order].T)


def valued(a: Numbers, s: float | Array) -> Numbers:
    """Values at places, by Horner's scheme; powers lead, the other axes are broadcast."""
    value = a[-1] + 0.0 * s
    for coefficient in a[-2::-1]:
        value = value * s + coefficient
    return np.asarray(value)


def in_time(numerator: Numbers, speed: Numbers, order: int, places: float | Array) -> Numbers:
    """Derivative in time, N_r/t′²ʳ⁻¹, at places; powers lead in both, then places do."""
    return np.asarray(valued(numerator, places) / valued(speed, places) ** (2 * order - 1))


def following(numerator: Numbers, clock: Numbers, order: int, sign: int = -1) -> Numbers:
    """N_{r+1} of derivatives in time from N_r and t(e): N_r′ t′ − (2r − 1) N_r t″.

    Powers lead. With a sign of + the terms are added, which bounds what was summed if the
    coefficients are absolute ones.
    """
    speed, bend = derived(clock, 1), derived(clock, 2)
    found = sign * (2 * order - 1) * _product(numerator, bend)
    found += _product(derived(numerator, 1), speed)
    # The leading terms of q″t′ and q′t″ cancel for two cubics.
    return np.asarray(found[:3] if order == 1 and sign < 0 else found)


def _product(a: Numbers, b: Numbers) -> Numbers:
    shape = len(a) + len(b) - 1, *np.broadcast_shapes(a.shape[1:], b.shape[1:])
    out = np.zeros(shape, dtype=np.result_type(a, b))
    for k in range(len(b)):
        out[k : k + len(a)] += a * b[k : k + 1]
    return out


def bernstein(a: Array) -> Array:
    """Bernstein coefficients on [0, 1]: the values lie between the least and the largest of them.

    The first and the last are the values at both ends. Ascending powers lead.
    """
    degree = len(a) - 1
    share = [[math.comb(j, i) / math.comb(degree, i) for i in range(len(a))] for j in range(len(a))]
    return np.tensordot(np.array(share), a, axes=1)


def tops(a: Array, side: float, clock: Clock | None = None, caps: Array | None = None) -> Array:
    """Largest values on [0, 1] over several pieces, found where bounds leave them open.

    From ascending coefficients, shape (powers, batch, pieces, joints), for each vector of the batch
    and joint; a side is one of `Asked.sides`. With a clock, of derivatives in time N_r/t′²ʳ⁻¹. Caps
    are those of one order of `Asked.caps`.
    """

    def sized(value: Array) -> Array:
        return np.abs(value) if side == 0.0 else side * value

    least = np.array(1.0)
    if clock is None:
        edges = np.stack([a[0], a.sum(axis=0)])
    else:
        time, order, slowest = clock
        least = slowest ** (2 * order - 1)
        edges = in_time(a, derived(time, 1), order, np.array([0.0, 1.0]).reshape(2, 1, 1, 1))
    # One axis is gone through far quicker than two.
    found = sized(edges).max(axis=0).max(axis=1)
    bound = sized(bernstein(a)).max(axis=0) + LOOSE * np.abs(a).sum(axis=0)
    open_ = ~(bound < found[:, None] * least) | ~(found[:, None] >= 0.0)
    if caps is not None:
        open_ &= ~(bound < (1.0 - CAPPED) * caps * least)
        open_ &= ~beyond(found, caps)[:, None, None]
    part = np.broadcast_to(a, (len(a), *open_.shape))[:, open_]
    if clock is None:
        places = roots_in_unit(derived(part, 1))
        values = valued(part, places)
    else:
        time = np.broadcast_to(time, (len(time), *open_.shape))[:, open_]
        places = roots_in_unit(following(part, time, order))
        values = in_time(part, derived(time, 1), order, places)
    inner = np.where(np.isnan(places), -np.inf, sized(values))
    vector, _, joint = np.nonzero(open_)
    np.maximum.at(found, (vector, joint), inner.max(axis=0, initial=-np.inf))
    return np.asarray(found)


def beyond(found: Array, caps: Array) -> NDArray[np.bool_]:
    """Which vectors have a value beyond its cap; shapes (batch, joints) and (joints,)."""
    return np.asarray((found > (1.0 + CAPPED) * caps).any(axis=1))


def roots_in_unit(a: Array) -> Array:
    """Places in (0, 1) at which polynomials change their sign.

    The roots of each derivative cut the interval into pieces on which the next lower one is
    monotone, from the quadratic one upwards. On such a piece a root is bracketed, and found to the
    last bits of float64: Newton's steps, bisection where they leave the bracket. Nothing is
    sampled.

    Parameters
    ----------
    a : ndarray, shape (powers, ...)
        Ascending coefficients.

    Returns
    -------
    ndarray, shape (powers − 1, ...)
        Ascending along the first axis; NaN if there are fewer.
    """
    degree, flat = len(a) - 1, a.reshape(len(a), -1)
    with np.errstate(all="ignore"):
        if degree < 2:
            places = -flat[:degree] / flat[degree]
            known = (places > 0.0) & (places < 1.0)
        else:
            places, known = _turns(derived(flat, degree - 2))
        for order in range(degree - 3, -1, -1):
            places, known = _next_level(derived(flat, order), places)
    return np.where(known, places, np.nan).reshape(degree, *a.shape[1:])


def _turns(a: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Both roots of quadratics, ascending, and which of them are sign changes in (0, 1).

    0 stands for one outside, and is a cut that does no harm.
    """
    c, b, q = a[0], 0.5 * a[1], a[2]
    square = b * b - q * c
    root = np.sqrt(np.maximum(square, 0.0))
    z = -(b + np.where(b >= 0.0, root, -root))  # no cancellation
    both = np.stack([z / q, c / z])
    both = np.sort(np.where((both > 0.0) & (both < 1.0), both, 0.0), axis=0)
    return both, (both > 0.0) & (square > 0.0)


def _next_level(a: Array, cuts: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Roots of polynomials that are monotone between ascending cuts, one more than cuts.

    Where a piece has none its lower end stands for it, and is not a sign change.
    """
    edge = np.zeros((1, cuts.shape[1]))
    ends = np.concatenate([edge, cuts, edge + 1.0])
    values = valued(a[:, None], ends)
    low, high, start, end = ends[:-1], ends[1:], values[:-1], values[1:]
    crosses = ((start < 0.0) != (end < 0.0)) & (start != 0.0) & (end != 0.0)
    # A root that is a cut too, to the last bit; equal cuts count once.
    touches = (start == 0.0) & (low > 0.0) & (low < high)
    places = low.copy()
    if crosses.any():
        chord = low + (high - low) * (start / (start - end))
        lane = np.nonzero(crosses)[1]
        bracket = (low[crosses], high[crosses], chord[crosses], start[crosses] < 0.0)
        places[crosses] = _bracketed(a[:, lane], *bracket)
    return places, crosses | touches


def _bracketed(a: Array, low: Array, high: Array, s: Array, rising: NDArray[np.bool_]) -> Array:
    """The root of each polynomial in its bracket, begun at ``s``."""
    found, active = s.copy(), np.arange(s.size)
    noise = _SETTLED * np.abs(a).sum(axis=0)
    for _ in range(100):
        value, slope = a[-1], np.zeros(s.size)
        for coefficient in a[-2::-1]:
            slope = slope * s + value
            value = value * s + coefficient
        before = (value < 0.0) == rising
        low, high = np.where(before, s, low), np.where(before, high, s)
        step = s - value / slope  # infinite or NaN where flat: then outside the bracket
        step = np.where((low < step) & (step < high), step, 0.5 * (low + high))
        step = np.where(np.abs(value) <= noise, s, step)
        found[active] = step
        busy = np.abs(step - s) > _SETTLED
        if not busy.any():
            break
        a, active, noise = a[:, busy], active[busy], noise[busy]
        low, high, s, rising = low[busy], high[busy], step[busy], rising[busy]
    return found
