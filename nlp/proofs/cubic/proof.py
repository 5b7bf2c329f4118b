"""A lower bound over a box from weights of conditions and equations, rounded outward."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ...enclosure import EPS, Ball, raised
from .ranges import Side, matrices
from .system import CubicRow, CubicSystem

MIX = 32
"""Shares of a product's two bounds are multiples of 1/MIX."""
_SLOPES = 33
"""Tangents of ρ = h²/T that are tried: the best one misses it by T·(1/64)² at most."""


@dataclass(frozen=True, eq=False)
class Target:
    """What is bounded from below: a coordinate (sign 1), its negative (−1), the total, or 0."""

    coordinate: int | None
    sign: int = 1

    def weights(self, system: CubicSystem) -> Array:
        """Its coefficients of the coordinates."""
        out = np.zeros(system.coordinates)
        if self.coordinate is None:
            out[: system.spans] = abs(self.sign)
        else:
            out[self.coordinate] = self.sign
        return out


TOTAL, NOTHING = Target(None), Target(None, 0)
"""What raises a floor, and what shows that a box is empty."""


@dataclass(frozen=True, eq=False)
class Weights:
    """Integers that prove a bound.

    Attributes
    ----------
    scale : int
        Weight of the target.
    rows : dict
        Of conditions, not negative.
    equations : dict
        Of (joint, equation), any sign.
    mix : ndarray of int, shape (joints, coordinates, unknowns)
        Share, in 1/MIX, of the bound of a product that is exact where the unknown is lowest.
    """

    scale: int
    rows: dict[CubicRow, int]
    equations: dict[tuple[int, int], int]
    mix: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Lagrangian:
    """Σ alone·x + Σ product·y·x + along·y + Σ inverse/T + constant; the first two are exact.

    It is scale·target + Σ w·g(y, x) + Σ μ·(M(y)x − b(y)), by its powers: at a feasible point g ≤ 0
    and M(y)x = b(y), so that its least value over the box bounds scale·target from below.
    """

    alone: Array
    product: Array
    along: Ball
    inverse: Ball
    constant: Ball


@lru_cache(maxsize=4096)
def _row(system: CubicSystem, row: CubicRow, cap: Fraction) -> tuple[Array, Array, Array, float]:
    """Dense terms of a condition: alone, product, along, constant."""
    terms = system.row(row, cap)
    alone = np.zeros(system.unknowns)
    product = np.zeros((system.coordinates, system.unknowns))
    along = np.zeros(system.coordinates)
    for v, x in terms.by.items():
        alone[v] = x
    for (k, v), x in terms.product.items():
        product[k, v] = x
    for k, value in terms.along.items():
        along[k] = float(value)
    return alone, product, along, float(terms.constant)


def lagrangian(system: CubicSystem, cap: Fraction, target: Target, weights: Weights) -> Lagrangian:
    """The weighted sum.

    Weights are integers below 2²⁶ and coefficients of unknowns multiples of 1/(2·PLACES²), so that
    sums of those are exact in floats.
    """
    alone = np.zeros((system.joints, system.unknowns))
    product = np.zeros((system.joints, system.coordinates, system.unknowns))
    along = weights.scale * target.weights(system)
    around, constant, about = np.zeros(system.coordinates), 0.0, 0.0
    for row, w in weights.rows.items():
        a, p, y, c = _row(system, row, cap)
        if row.joint >= 0:
            alone[row.joint] += w * a
            product[row.joint] += w * p
        along = along + w * y
        constant += w * c
        around += w * np.abs(y)
        about += w * abs(c)
    fixed, linear, steps, which = matrices(system)
    inverse, size = np.zeros(system.spans), np.zeros(system.spans)
    of = {int(i): t for t, i in enumerate(which) if i >= 0}
    for (j, i), w in weights.equations.items():
        alone[j] += w * fixed[i]
        product[j] += w * linear[:, i]
        if i in of:
            inverse[of[i]] -= w * steps.mid[of[i], j]
            size[of[i]] += abs(w) * abs(steps.mid[of[i], j])
    # Each term carries at most 8 roundings, each sum one for every term.
    terms = len(weights.rows) + len(weights.equations) + 8
    error = 8 * EPS * terms
    around += np.abs(weights.scale * target.weights(system))
    return Lagrangian(
        alone,
        product,
        Ball(along, raised(error * around, 2)),
        Ball(inverse, raised(error * size, 2)),
        Ball(np.array(constant), raised(np.array(error * about), 2)),
    )


def multiplied(system: CubicSystem, weights: Weights) -> NDArray[np.bool_]:
    """Which products take part, shape (joints, coordinates, unknowns)."""
    return np.asarray(lagrangian(system, Fraction(0), NOTHING, weights).product != 0)


def least(
    system: CubicSystem,
    cap: Fraction,
    target: Target,
    weights: Weights,
    side: Side,
    ranges: tuple[Array, Array],
) -> float:
    """Lower bound of weights.scale·target over every feasible point of the box.

    Parameters
    ----------
    system : CubicSystem
    cap : Fraction
        The total is below it.
    target : Target
    weights : Weights
    side : Side
        Box of the coordinates.
    ranges : tuple of ndarray, shape (unknowns, joints)
        Of the unknowns.

    Returns
    -------
    float
        −inf if the weights prove nothing.
    """
    sums = lagrangian(system, cap, target, weights)
    low, high = (r.T for r in ranges)
    used = np.abs(sums.alone).sum(axis=1) + np.abs(sums.product).sum(axis=(1, 2)) > 0
    if not (np.isfinite(low[used]).all() and np.isfinite(high[used]).all()):
        return -np.inf
    low, high = np.where(used[:, None], low, 0.0), np.where(used[:, None], high, 0.0)
    d, lines = sums.product, Ball.exact(sums.alone)
    along, constant = sums.along, sums.constant
    share = weights.mix / MIX
    for part, edge, lower in ((share, low, True), (1.0 - share, high, False)):
        # d·y·x ≥ d·(corner·x + edge·y − corner·edge), exact where x = edge.
        corner = np.where((d > 0) == lower, side.low[None, :, None], side.high[None, :, None])
        weight = np.where(d != 0, d * part, 0.0)
        tilt = Ball.exact(weight) * Ball.exact(np.where(d != 0, corner, 0.0))
        lines = lines + _sum(tilt, 1)
        shift = tilt * Ball.exact(edge[:, None, :])
        constant = constant - _sum(_sum(_sum(shift, 2), 1), 0)
        along = along + _sum(_sum(Ball.exact(weight) * Ball.exact(edge[:, None, :]), 2), 0)
    ends = np.minimum((lines * Ball.exact(low)).least(), (lines * Ball.exact(high)).least())
    constant = constant + _sum(_sum(Ball.exact(ends), 1), 0)
    return _over_box(system, along, sums.inverse, constant, side)


def _sum(ball: Ball, axis: int) -> Ball:
    mid = ball.mid.sum(axis=axis)
    terms = ball.mid.shape[axis]
    spread = ball.rad.sum(axis=axis) + terms * EPS * np.abs(ball.mid).sum(axis=axis)
    return Ball(mid, raised(spread, terms + 3))


def _over_box(system: CubicSystem, along: Ball, inverse: Ball, constant: Ball, side: Side) -> float:
    """Least value of along·y + Σ inverse/T + constant, with ρ = h²/T."""
    mid, rad = along.mid.copy(), along.rad.copy()
    low, high = side.low, side.high
    for h, t, rho in system.curved:
        # ρ ≥ 0, so the least of its possible factors serves for all of them.
        factor = Ball.exact(np.array(np.nextafter(mid[rho] - rad[rho], -np.inf)))
        mid[rho] = rad[rho] = 0.0
        if factor.mid >= 0:
            # h²/T ≥ 2θh − θ²T, for any θ.
            slope = _slope(float(factor.mid), mid, float(inverse.mid[t]), side, h, t)
            terms = [(h, 2.0 * slope), (t, -slope * slope)]
        elif low[t] > 0:
            # Convex in h, and largest for the least T: below the chord.
            total = Ball.exact(np.array(low[h])) + Ball.exact(np.array(high[h]))
            over = 1.0 / low[t]
            chord = factor * total * Ball(np.array(over), np.array(2 * EPS * over))
            add = Ball(mid[[h]], rad[[h]]) + chord.reshape(1)
            mid[h], rad[h] = add.mid[0], add.rad[0]
            rest = factor * Ball.exact(np.array(low[h])) * Ball.exact(np.array(high[h]))
            constant = constant - rest * Ball(np.array(over), np.array(2 * EPS * over))
            terms = []
        else:
            terms = [(h, 1.0)]  # h²/T ≤ h
        for c, x in terms:
            exact = Ball(np.array([x]), np.array([2 * EPS * abs(x)]))
            add = Ball(mid[[c]], rad[[c]]) + factor.reshape(1) * exact
            mid[c], rad[c] = add.mid[0], add.rad[0]
    for t in range(system.spans):
        factor_low = float(np.nextafter(inverse.mid[t] - inverse.rad[t], -np.inf))
        if factor_low == 0.0 or (inverse.mid[t] == 0.0 and inverse.rad[t] < 1e-290):
            continue
        if low[t] <= 0:
            return -np.inf
        e = Ball.exact(np.array([factor_low]))
        if factor_low > 0:
            # 1/T ≥ 2/τ − T/τ², the tangent at any τ.
            best = np.sqrt(factor_low / mid[t]) if mid[t] > 0 else high[t]
            place = float(np.clip(best, low[t], high[t]))
            value, tilt = 2.0 / place, -1.0 / (place * place)
        else:
            value = (low[t] + high[t]) / (low[t] * high[t])
            tilt = -1.0 / (low[t] * high[t])
        add = Ball(mid[[t]], rad[[t]]) + e * Ball(np.array([tilt]), np.array([8 * EPS * abs(tilt)]))
        mid[t], rad[t] = add.mid[0], add.rad[0]
        constant = constant + (e * Ball(np.array([value]), np.array([8 * EPS * value]))).reshape()
    rest = Ball(mid, rad)
    ends = np.minimum(
        (rest * Ball.exact(low)).least(),
        (rest * Ball.exact(high)).least(),
    )
    return float((constant + _sum(Ball.exact(ends), 0)).least())


def _slope(factor: float, along: Array, inverse: float, side: Side, h: int, t: int) -> float:
    """θ of a good tangent of ρ."""
    if factor == 0 or side.low[t] <= 0:
        return 0.0
    low, high = side.low, side.high
    theta = np.linspace(low[h] / high[t], min(1.0, high[h] / low[t]), _SLOPES)
    first, second = along[h] + 2 * theta * factor, along[t] - theta**2 * factor
    value = np.minimum(first * low[h], first * high[h])
    with np.errstate(divide="ignore", invalid="ignore"):
        best = np.where(second > 0, np.sqrt(max(inverse, 0.0) / np.abs(second)), high[t])
    place = np.clip(np.nan_to_num(best, nan=high[t]), low[t], high[t])
    ends = [second * x + inverse / x for x in (low[t], high[t], place)]
    return float(theta[np.argmax(value + np.min(ends, axis=0))])
