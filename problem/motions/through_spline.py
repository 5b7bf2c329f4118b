"""The C2 cubic spline through samples, with bounds on what noise and rounding may change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .motion import EPS, Motion, derivative_terms
from .samples import Samples

_FINE = np.longdouble
"""For residuals; where it is no finer than float64 its own epsilon makes the bounds wider."""
_TINY = float(np.finfo(_FINE).eps)
"""Spacing of that type at 1."""
_Numbers = NDArray[np.floating]
"""Float64 or that type."""


@dataclass(frozen=True, eq=False)
class _Rows:
    """A tridiagonal matrix by rows: left, own and right entry, each of shape (rows,)."""

    left: _Numbers
    own: _Numbers
    right: _Numbers

    def times(self, x: _Numbers) -> _Numbers:
        found = self.own * x
        found[1:] += self.left[1:] * x[:-1]
        found[:-1] += self.right[:-1] * x[1:]
        return np.asarray(found)

    def solve(self, b: _Numbers) -> Array:
        from scipy.linalg import solve_banded

        n = len(self.own)
        packed = np.zeros((3, n))
        packed[0, 1:], packed[1], packed[2, :-1] = self.right[:-1], self.own, self.left[1:]
        return np.asarray(solve_banded((1, 1), packed, b.astype(np.float64), check_finite=False))


@dataclass(frozen=True, eq=False)
class _Times:
    """Durations and what follows from them alone."""

    h: _Numbers
    off: Array
    """What each duration may be off by."""
    least: Array
    whole: _Numbers
    """Of each two neighbouring durations the sum."""
    whole_off: Array
    whole_least: Array
    share: _Numbers
    """The first of the two durations over their sum."""
    share_off: Array
    ratio: tuple[np.floating, np.floating]
    """First duration over the second one, last over the one before."""
    ratio_off: tuple[float, float]
    rows: _Rows
    bound: _Rows | None
    """Diagonal less and others more than in any true matrix; None if its rows do not dominate."""


def not_a_knot_spline(samples: Samples) -> Motion:
    """The C2 cubic spline through the positions, not-a-knot ends, as scipy's ``CubicSpline``.

    **System.** The second derivatives M at the inner samples solve, with h the durations,
    μₖ = hₖ₋₁/(hₖ₋₁ + hₖ) and dₖ the slope of chord k,

        μₖ Mₖ₋₁ + 2 Mₖ + (1 − μₖ) Mₖ₊₁ = gₖ = 6 (dₖ − dₖ₋₁)/(hₖ₋₁ + hₖ),

    where not-a-knot says M₀ = M₁ + ρ (M₁ − M₂), ρ = h₀/h₁, which makes the first row
    (2 + ρ) M₁ + (1 − ρ) M₂ = g₁, and the last one alike. In each row the diagonal exceeds the sum
    of the others by 1 or more, so the inverse is at most 1 in the maximum norm.

    **Bounds.** Let A* M* = g* be the system of the true samples, which are at times and positions
    off by what `Samples` says, and M a computed solution. Then A* (M* − M) = (g* − g) −
    (A* − A) M + (g − A M), of which each row is bounded: the last term by a residual in extended
    precision, and (A* − A) M by |μ* − μ| |Mₖ₊₁ − Mₖ₋₁|, for the two weights sum to 1. Let C have
    the least diagonal and the largest others, negative, that A* can have: C is an M-matrix as long
    as its rows dominate, and C e ≥ b ≥ 0 then implies |M* − M| ≤ e (Ostrowski 1937; Varah 1975
    for the norm). Such an e is solved for and checked row by row.

    On a piece the curve is the chord plus h²/6 times cubics of M, whose derivatives in s reach
    3/4, 3, 6 and 6: position is off by ε + h² e/8, velocity by the error of the chord's slope plus
    h e/2, acceleration by e, and jerk by the sum of both ends' e over h, each with what the
    duration changes beside it. The outer two pieces at either end are one cubic, and so have one
    jerk.

    Raises
    ------
    TrajgapError
        If there are fewer than 4 samples.
    """
    if samples.time.size < 4:
        raise TrajgapError("interpolation spline: needs 4 samples or more; state another")
    q, doubt = samples.position, samples.error(0)
    pieces, count = q.shape[0] - 1, q.shape[1]
    scaled, error = np.empty((pieces, 4, count)), np.empty((pieces, 4, count))
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        clock = _times(samples.time, samples.time_error)
        for j in range(count):
            _fill(clock, q[:, j], doubt[:, j], scaled[:, :, j], error[:, :, j])
    return Motion(
        samples.joints,
        samples.time,
        scaled,
        np.where(np.isnan(error), np.inf, error),
        "the C2 cubic spline through the samples (not-a-knot ends)",
        2,
        samples.assumed,
        samples.advice,
    )


def _times(time: Array, doubt: Array) -> _Times:
    fine = time.astype(_FINE)
    h = np.diff(fine)
    off = doubt[1:] + doubt[:-1]
    least = np.maximum((h - off).astype(np.float64), 0.0)
    whole = h[1:] + h[:-1]
    whole_off = doubt[2:] + doubt[:-2]
    whole_least = np.maximum((whole - whole_off).astype(np.float64), 0.0)
    share = h[:-1] / whole
    share_off = (off[:-1] + share * whole_off).astype(np.float64) / whole_least
    ratio = (h[0] / h[1], h[-1] / h[-2])
    ratio_off = (
        float((off[0] + ratio[0] * off[1]) / least[1]),
        float((off[-1] + ratio[1] * off[-2]) / least[-2]),
    )
    left, own, right = share.copy(), np.full(share.size, _FINE(2)), 1 - share
    own[0], right[0] = 2 + ratio[0], 1 - ratio[0]
    own[-1], left[-1] = 2 + ratio[1], 1 - ratio[1]
    left[0] = right[-1] = 0
    lacking = np.zeros(share.size)
    beside = [np.abs(one).astype(np.float64) + share_off for one in (left, right)]
    for end, one in ((0, 1), (-1, 0)):
        beside[one][end] = float(abs((right, left)[end][end])) + ratio_off[end]
        beside[1 - one][end] = 0.0
        lacking[end] = ratio_off[end]
    # Entries are rounded to float64: outwards.
    narrow = 8 * EPS
    own_least = (1 - narrow) * own.astype(np.float64) - lacking
    bound = _Rows(-(1 + narrow) * beside[0], own_least, -(1 + narrow) * beside[1])
    dominates = bound.own + bound.left + bound.right > narrow * bound.own
    return _Times(
        h, off, least, whole, whole_off, whole_least, share, share_off, ratio, ratio_off,
        _Rows(left, own, right), bound if bool(dominates.all()) else None,
    )  # fmt: skip


def _fill(clock: _Times, q: Array, doubt: Array, scaled: Array, error: Array) -> None:
    """Coefficients and error bounds of one joint."""
    h, least = clock.h, clock.least
    fine = q.astype(_FINE)
    step = np.diff(fine)
    slope = step / h
    right = 6 * np.diff(slope) / clock.whole
    inner = clock.rows.solve(right).astype(_FINE)
    for _ in range(3):  # each gains some twelve digits, and fewer remain
        inner = inner + clock.rows.solve(right - clock.rows.times(inner))
    # What the data change in the right-hand side and in the matrix.
    slope_off = (doubt[1:] + doubt[:-1] + np.abs(slope) * clock.off) / least
    shares = np.abs(slope[1:]) + np.abs(slope[:-1])
    right_off = 6 * (slope_off[1:] + slope_off[:-1]) + np.abs(right) * clock.whole_off
    right_off = (right_off + 64 * _TINY * shares) / clock.whole_least
    ends = (inner[0] - inner[1], inner[-1] - inner[-2])
    turn = np.zeros(inner.size)
    turn[1:-1] = clock.share_off[1:-1] * np.abs(inner[2:] - inner[:-2])
    turn[0] += clock.ratio_off[0] * abs(ends[0])
    turn[-1] += clock.ratio_off[1] * abs(ends[1])
    left = np.abs(right - clock.rows.times(inner))
    sizes = _Rows(*(np.abs(one) for one in (clock.rows.left, clock.rows.own, clock.rows.right)))
    left = left + 16 * _TINY * (sizes.times(np.abs(inner)) + np.abs(right))
    bent = _bounded(clock.bound, (left + right_off + turn).astype(np.float64))
    bending = np.concatenate(
        [[inner[0] + clock.ratio[0] * ends[0]], inner, [inner[-1] + clock.ratio[1] * ends[1]]]
    )
    outer = [
        bent[i] * (1 + ratio + off)
        + bent[k] * (ratio + off)
        + off * abs(end)
        + 16 * _TINY * ((1 + ratio) * abs(inner[i]) + ratio * abs(inner[k]))
        for i, k, ratio, off, end in zip(
            (0, -1), (1, -2), clock.ratio, clock.ratio_off, ends, strict=True
        )
    ]
    bent = np.concatenate([[float(outer[0])], bent, [float(outer[1])]])
    bent = (1.0 + 1e-9) * bent  # more than bounds are rounded by
    first, last = bending[:-1], bending[1:]
    for power, one in enumerate(
        (
            fine[:-1],
            step - h * h * (2 * first + last) / 6,
            h * h * first / 2,
            h * h * (last - first) / 6,
        )
    ):
        scaled[:, power] = one
    most = np.maximum(bent[1:], bent[:-1])
    size = np.maximum(np.abs(first), np.abs(last))
    long = h + clock.off
    jerk = np.abs(last - first)
    error[:, 0] = (
        np.maximum(doubt[1:], doubt[:-1]) + (long * long * most + (long * long - h * h) * size) / 8
    )
    error[:, 1] = slope_off + (long * most + clock.off * size) / 2
    error[:, 2] = most
    error[:, 3] = (bent[1:] + bent[:-1]) / least + jerk * (1 / least - 1 / h)
    for outer_piece, beside in ((0, 1), (-1, -2)):
        error[outer_piece, 3] = min(error[outer_piece, 3], error[beside, 3])
    # Coefficients are rounded, in extended precision from these terms and then to float64.
    rounded = 16 * _TINY * (np.abs(fine[:-1]) + np.abs(step) + h * h * size)
    terms = derivative_terms(scaled[:, :, None], h.astype(np.float64))[:, :, 0]
    for r in range(4):
        error[:, r] = (1.0 + 1e-9) * (error[:, r] + 4 * EPS * terms[:, r] + 12 * rounded / h**r)


def _bounded(bound: _Rows | None, excess: Array) -> Array:
    """A vector e with C e ≥ excess, checked row by row; inf if there is none."""
    nothing = np.full(excess.size, np.inf)
    if bound is None or not np.isfinite(excess).all():
        return nothing
    # A thousandth more than asked: rounding leaves it a bound, which is checked below, where
    # neighbouring durations differ a millionfold.
    found = bound.solve(1.001 * excess + 1e-300)
    sizes = _Rows(-bound.left, bound.own, -bound.right).times(np.abs(found))
    kept = bound.times(found) - 8 * EPS * sizes >= excess
    return found if bool(kept.all() and (found >= 0).all()) else nothing
