"""Balls (midpoint and radius) that rounding cannot leave, and a spline's coefficients over a box.

Error argument. u = 2⁻⁵³ is the unit roundoff, EPS = 2u. A sum of products with m roundings on any
path has a relative error below m·EPS/2·(1 + m·EPS) < m·EPS of the same sum over absolute values,
in any order of summation and with or without fused multiply-adds (Higham, Accuracy and Stability
of Numerical Algorithms, 2002, section 3.1), so any conventional BLAS serves. Radii are sums of
products of non-negative numbers; `raised` multiplies such a result by 1 + (m + 4)·EPS, which covers
its m roundings and those of the multiplication itself. What underflow loses is below
m·2⁻¹⁰²² < TINY, which every radius receives. An overflow or an invalid operation ends in inf or NaN
and fails every comparison that could prove something.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, Interpolant
from ...problem.curves import PERM, ConditionKind, right_hand_sides

EPS = float(np.finfo(np.float64).eps)
"""Spacing of float64 at 1, 2u: see the error argument above."""
TINY = 1e-300
"""Above all that underflow can lose in one expression: see the error argument above."""


def raised(value: Array, roundings: int) -> Array:
    """Upper bound of a non-negative result that at most ``roundings`` roundings led to."""
    return value * (1.0 + (roundings + 4) * EPS) + TINY


@dataclass(frozen=True, eq=False)
class Ball:
    """Every array within ``rad`` of ``mid``, entry by entry (Rump, BIT 39, 1999, section 2).

    Attributes
    ----------
    mid, rad : ndarray
        Same shape; ``rad`` is not negative.
    """

    mid: Array
    rad: Array

    @classmethod
    def exact(cls, value: Array) -> Ball:
        """Ball of radius 0."""
        return cls(value, np.zeros_like(value))

    @classmethod
    def between(cls, lower: Array, upper: Array) -> Ball:
        """Smallest ball that holds both ends, up to rounding; exact where they are equal."""
        mid = np.where(lower == upper, lower, 0.5 * (lower + upper))
        rad = np.maximum(upper - mid, mid - lower)
        return cls(mid, np.where(lower == upper, 0.0, raised(rad, 1)))

    def __add__(self, other: Ball) -> Ball:
        mid = self.mid + other.mid
        return Ball(mid, raised(self.rad + other.rad + EPS * np.abs(mid), 3))

    def __sub__(self, other: Ball) -> Ball:
        return self + Ball(-other.mid, other.rad)

    def __mul__(self, other: Ball) -> Ball:
        size, factor = np.abs(self.mid), np.abs(other.mid)
        spread = size * (other.rad + EPS * factor) + self.rad * (factor + other.rad)
        return Ball(self.mid * other.mid, raised(spread, 5))

    def __matmul__(self, other: Ball) -> Ball:
        size, factor = np.abs(self.mid), np.abs(other.mid)
        # Products with an exact 0 and sums with them are exact: they cause no rounding.
        used = (size > 0.0) | (self.rad > 0.0)
        terms = int(np.count_nonzero(used, axis=-1).max(initial=0))
        spread = size @ (other.rad + (terms + 1) * EPS * factor) + self.rad @ (factor + other.rad)
        return Ball(self.mid @ other.mid, raised(spread, terms + 6))

    def __getitem__(self, index: Any) -> Ball:
        return Ball(self.mid[index], self.rad[index])

    def reshape(self, *shape: int) -> Ball:
        """The same ball in another shape."""
        return Ball(self.mid.reshape(shape), self.rad.reshape(shape))

    def magnitude(self) -> Array:
        """Upper bound of the absolute value."""
        return raised(np.abs(self.mid) + self.rad, 1)

    def least(self) -> Array:
        """Lower bound of every member."""
        return np.nextafter(self.mid - self.rad, -np.inf)


def _power(base: Array, exponents: NDArray[np.int64]) -> Array:
    """``base`` to small powers by multiplication alone: at most exponent − 1 roundings."""
    result = np.ones(np.broadcast_shapes(base.shape, exponents.shape))
    for r in range(1, int(exponents.max(initial=0)) + 1):
        result = np.where(exponents >= r, result * base, result)
    return result


def quotient_power(numerator: Ball, denominator: Ball, exponents: NDArray[np.int64]) -> Ball:
    """(numerator / denominator)ʳ of positive balls; it is monotone in both.

    Ends of the balls carry one rounding each, the quotient one, the power r − 1: 4r in all.
    """
    slack = (4 * exponents + 4) * EPS
    low = (numerator.mid - numerator.rad) / (denominator.mid + denominator.rad)
    high = (numerator.mid + numerator.rad) / (denominator.mid - denominator.rad)
    return Ball.between(
        _power(low, exponents) * (1.0 - slack), _power(high, exponents) * (1.0 + slack)
    )


@dataclass(frozen=True, eq=False)
class SplineEnclosure:
    """Scaled coefficients, all segments in one axis, over a box of durations and way-points.

    Attributes
    ----------
    coefficients : Ball, shape (coefficients, joints)
        In s = (t − t_k)/h_k, ascending, segment after segment.
    by_duration : Ball, shape (coefficients, segments, joints)
        Their derivatives by the durations.
    by_waypoint : Ball, shape (coefficients, way-points)
        Derivatives of one joint's coefficients by its own way-points.
    """

    coefficients: Ball
    by_duration: Ball
    by_waypoint: Ball


@dataclass(frozen=True, eq=False)
class _System:
    """A x = r for all matrices of a ball, preconditioned, proved regular.

    With R ≈ A⁻¹ and E ≥ |I − R A| over the ball, x − x̃ = (I − (I − R A))⁻¹ R (r − A x̃), hence
    |x − x̃| ≤ (I − E)⁻¹ d for d ≥ |R (r − A x̃)|, if E w ≤ ρ w for some w > 0 and ρ < 1. Then
    I − E has a non-negative inverse, so every y with (I − E) y ≥ d is an upper bound.
    """

    matrix: Ball
    inverse: Ball
    defect: Array
    weight: Array
    contraction: float

    def solve(self, right: Ball) -> Ball:
        """Ball of every solution for right-hand sides of shape (rows, ...)."""
        flat = right.reshape(right.mid.shape[0], -1)
        x = self.inverse.mid @ flat.mid
        x = x + self.inverse.mid @ (flat.mid - self.matrix.mid @ x)
        d = (self.inverse @ (flat - self.matrix @ Ball.exact(x))).magnitude()
        size = d.shape[0]
        y = np.maximum(np.linalg.solve(np.eye(size) - self.defect, d), 0.0)
        missing = raised(d + self.defect @ y, size + 1) - y
        # One rounding each in the difference, the quotients and the product.
        share = np.maximum((missing / self.weight[:, None]).max(axis=0), 0.0)
        share = share / (1.0 - self.contraction) * (1.0 + 8.0 * EPS)
        return Ball(x, raised(y + share * self.weight[:, None], 2)).reshape(*right.mid.shape)


def _system(matrix: Ball) -> _System | None:
    size = matrix.mid.shape[0]
    try:
        inverse = Ball.exact(np.asarray(np.linalg.inv(matrix.mid), dtype=np.float64))
        defect = (Ball.exact(np.eye(size)) - inverse @ matrix).magnitude()
        weight = np.asarray(np.linalg.solve(np.eye(size) - defect, np.ones(size)), np.float64)
    except np.linalg.LinAlgError:
        return None
    if not (np.isfinite(weight).all() and (weight > 0.0).all()):
        return None
    contraction = float((raised(defect @ weight, size) / weight).max()) * (1.0 + 4.0 * EPS)
    if not contraction < 1.0 - 1e-6:
        return None
    return _System(matrix, inverse, defect, weight, contraction)


def enclose_spline(
    interpolant: Interpolant, durations: Ball, waypoints: Ball
) -> SplineEnclosure | None:
    """Enclose the coefficients and their derivatives over all durations and way-points of a box.

    Parameters
    ----------
    interpolant : Interpolant
        A determined declaration.
    durations : Ball, shape (segments,)
        Positive throughout, s.
    waypoints : Ball, shape (way-points, joints)
        Angles, rad.

    Returns
    -------
    SplineEnclosure or None
        None if a duration may be 0, or if the box is too wide to prove the linear system regular
        all over it.

    Notes
    -----
    Preconditioning by the inverse of the midpoint (Rump, Acta Numerica 19, 2010, section 10.4);
    the duration ratios of a `MATCH` row are the only entries that are not integers.
    """
    if not (durations.mid - durations.rad > 0.0).all():
        return None
    plan = interpolant.layout
    n, joints = interpolant.segments, waypoints.mid.shape[1]
    size = plan.kinds.size
    columns, factors = plan.entries
    entries = Ball.exact(plan.dense(factors.astype(float)))
    match, slot = plan.links
    after, order, column = plan.breaks[match], plan.orders[match], columns[match, slot]
    link = quotient_power(durations[after - 1], durations[after], order)
    link = link * Ball.exact(factors[match, slot].astype(float))
    entries.mid[match, column], entries.rad[match, column] = link.mid, link.rad
    system = _system(entries)
    if system is None:
        return None

    rows = np.flatnonzero(plan.kinds != ConditionKind.MATCH)
    own = plan.segment[rows]
    values = Ball.exact(right_hand_sides(interpolant, waypoints.mid, None))
    at = plan.waypoint >= 0
    values.rad[at] = waypoints.rad[plan.waypoint[at]]
    one = Ball.exact(np.ones(n))
    factor = quotient_power(durations[own], one[own], plan.orders[rows])
    plain = plan.orders[rows] == 0
    factor.mid[plain], factor.rad[plain] = 1.0, 0.0
    given = factor.reshape(-1, 1) * values[rows]
    right = Ball.exact(np.zeros((size, joints)))
    right.mid[rows], right.rad[rows] = given.mid, given.rad
    coefficients = system.solve(right)

    # A ∂c = ∂F v − ∂A c: each row touches the durations of one or two segments.
    inverse = quotient_power(one, durations, np.ones(n, dtype=np.int64))
    change = Ball.exact(np.zeros((size, n, joints)))
    rate = Ball.exact(plan.orders[rows].astype(float)) * inverse[own]
    slope = rate.reshape(-1, 1) * given
    change.mid[rows, own], change.rad[rows, own] = slope.mid, slope.rad
    pull = Ball.exact(order.astype(float)).reshape(-1, 1) * (
        link.reshape(-1, 1) * coefficients[column]
    )
    for segment, sign in ((after - 1, -1.0), (after, 1.0)):
        slope = pull * inverse[segment].reshape(-1, 1)
        change.mid[match, segment], change.rad[match, segment] = sign * slope.mid, slope.rad

    one_hot = (plan.waypoint[:, None] == np.arange(waypoints.mid.shape[0])).astype(float)
    return SplineEnclosure(coefficients, system.solve(change), system.solve(Ball.exact(one_hot)))


def place_basis(
    interpolant: Interpolant, segment: NDArray[np.int64], order: NDArray[np.int64], s: Array
) -> Ball:
    """LimitRows φ with φ·c = the derivative by s, of the given order, at fixed places.

    Parameters
    ----------
    interpolant : Interpolant
    segment, order : ndarray of int, shape (places,)
        Segment from 0 and derivative order.
    s : ndarray, shape (places,)
        Place in the segment, 0..1, taken as exact.

    Returns
    -------
    Ball, shape (places, coefficients)
    """
    degrees = np.array(interpolant.degrees)
    first = np.concatenate([[0], np.cumsum(degrees + 1)])
    basis = Ball.exact(np.zeros((s.size, int(first[-1]))))
    for i, (k, r) in enumerate(zip(segment, order, strict=True)):
        for p in range(r, degrees[k] + 1):
            value = PERM[p, r] * math.prod([float(s[i])] * int(p - r))
            basis.mid[i, first[k] + p] = value
            basis.rad[i, first[k] + p] = 12.0 * EPS * value + TINY
    return basis
