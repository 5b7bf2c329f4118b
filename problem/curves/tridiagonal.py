"""Long C2 cubic splines from their velocities at the breaks: one tridiagonal system, and its bound.

With s = Δq/h, half of h times the acceleration of a segment is −A at its start, B at its end,

    A = 2v₀ + v₁ − 3s,    B = v₀ + 2v₁ − 3s,

so that the acceleration is continuous at a break where r = B/h + A/h' = 0, h' of the segment after
it. An end that prescribes an acceleration a has A/h + a/2 = 0 at the start, B/h − a/2 = 0 at the
finish; one that prescribes a velocity has no such row. As a system in v the rows T are symmetric,
with 2/h + 2/h' on the diagonal, twice the sum of the other entries 1/h and 1/h'. So T is regular.

Bound. Velocities v̂ leave r̂ = T(v̂ − v). Let M be T with −1/h beside the diagonal. Its rows are
dominated by the diagonal too, so M⁻¹ ≥ 0, and M|v̂ − v| ≤ |r̂| row by row. Hence
|v̂ − v| ≤ w = M⁻¹ρ for any ρ ≥ |r̂|. The solution w is found with sums of one sign alone but for the
pivots p' = 2/h + 2/h' − 1/(h²p), where p ≥ 2/h is the last one, so p' ≥ 3/(2h) + 2/h'. A
relative error of p enters p' by a third at most; pivots are known to 8 spacings at 1, and w to 25
of them for each row. A thousandth more on ρ covers this and the rounding of all bounds, for any
number of rows that has room in memory.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, over_rows
from .kind import Derivatives, Enclosed, value_errors
from .trajectory import Trajectory

_EPS = float(np.finfo(np.float64).eps)
"""Spacing of float64 at 1: twice the largest relative rounding of one operation."""
_MORE = 1.001
"""Covers the rounding of bounds."""
_FAR = 1e9
"""Durations, s, between whose reciprocal and which powers neither overflow nor underflow."""
_NO_SPEED = 1e-250
"""Speed, rad/s, of a joint that stands still: far below any angle."""
_NOUGHT = 1e-30
"""Share of a joint's largest speed that is added to local ones: what underflows is below it."""


def tridiagonal_fit(ends: tuple[Derivatives, Derivatives], q: Array, h: Array) -> Enclosed | None:
    """A C2 cubic spline in float64 with a bound on its error.

    The ends give one derivative each, of order 1 or 2; None of one segment, of durations beyond the
    analysis, and where numbers overflow.
    """
    from scipy.linalg.lapack import dptsv  # a quarter of a second, and few need it

    if h.size < 2 or h.min() < 1.0 / _FAR or h.max() > _FAR:
        return None
    per, length = 1.0 / h, h[:, None]
    rate = per[:, None]
    s = np.diff(q, axis=0) / length
    diagonal, beside = np.zeros(h.size + 1), per.copy()
    diagonal[:-1] += 2.0 * per
    diagonal[1:] += 2.0 * per
    right = np.zeros(q.shape)
    thrice = 3.0 * s
    right[:-1] += rate * thrice
    right[1:] += rate * thrice
    sides = []
    for ((order, value),), b, sign in zip(ends, (0, -1), (-0.5, 0.5), strict=True):
        given = np.broadcast_to(value, q.shape[1])
        if order == 2:
            right[b] += sign * given
        else:  # a row of its own, whose solution is exact
            right[1 if b == 0 else -2] -= rate[b] * given
            diagonal[b], beside[b], right[b] = 1.0, 0.0, given
        sides.append((order, b, sign * given))
    v = np.ascontiguousarray(dptsv(diagonal, beside, right)[2])
    v0, v1 = v[:-1], v[1:]
    start, end = 2.0 * v0 + v1 - thrice, v0 + 2.0 * v1 - thrice
    left = np.zeros(q.shape)
    left[:-1] += rate * start
    left[1:] += rate * end
    for order, b, half in sides:
        left[b] = left[b] - half if order == 2 else 0.0
    # Sizes of all joints together, as shares of each one's largest speed: of v, of s, of all terms
    # of A and B, which round by two spacings of these and in the residual by six, and of that.
    sizes_v, sizes_s = np.abs(v), np.abs(s)
    speed = np.maximum(over_rows(np.maximum, sizes_v), over_rows(np.maximum, sizes_s)) + _NO_SPEED
    at_breaks, slopes = sizes_v @ (1.0 / speed), sizes_s @ (1.0 / speed)
    a0, a1 = at_breaks[:-1], at_breaks[1:]
    terms = 2.0 * (a0 + a1) + 3.0 * slopes + _NOUGHT
    rounding = 8.0 * _EPS * terms
    excess = np.abs(left) @ (1.0 / speed)
    excess[:-1] += per * rounding
    excess[1:] += per * rounding
    excess[[b for order, b, _ in sides if order == 1]] = 0.0
    w = dptsv(diagonal, -beside, _MORE * excess)[2]
    if not (np.isfinite(w).all() and np.isfinite(speed).all()):
        return None
    scaled = np.empty((4, *s.shape))
    scaled[0], scaled[1], scaled[2] = q[:-1], length * v0, -length * start
    scaled[3] = length * (v0 + v1 - 2.0 * s)
    # What is true of one joint with these sizes is true of each, times its speed. Errors of both
    # velocities move the velocity between by no more than the larger one, the position by at most
    # s(1 − s)² ≤ 4/27 of h times each.
    none, both, larger = np.zeros(h.size), w[:-1] + w[1:], np.maximum(w[:-1], w[1:])
    sizes = h * np.array([none, a0, 2.0 * a0 + a1 + 3.0 * slopes, a0 + a1 + 2.0 * slopes])
    errors = h * np.array([none, rounding, rounding, rounding])
    moved = np.array(
        [h * both / 6.0, larger, 2.0 * per * (both + larger), 6.0 * per**2 * both, none]
    )
    degrees = (3,) * h.size
    bounds = value_errors(Trajectory(h, sizes.T[:, :, None], degrees), errors.T[:, :, None])
    error = _MORE * (bounds + moved.T[:, :, None]) * speed
    error[:, 0] += 32.0 * _EPS * np.abs(q[:-1])
    return Enclosed(Trajectory(h, scaled.transpose(1, 0, 2), degrees), lambda: error)
