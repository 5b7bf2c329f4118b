"""A lower bound over a box from weights of conditions and equations.

It follows the verifier's arithmetic in floats, and takes off what their rounding may amount to, so
that what is stated here is proved there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ....verify import MIX
from ...enclosure import EPS
from .ranges import Side
from .system import CubicRow, CubicSystem

_ROUNDINGS = 64
"""Roundings of a sum of products of some thousand terms, which numpy adds up in pairs: 30."""


@dataclass(frozen=True, eq=False)
class Target:
    """What is bounded from below: a coordinate (sign 1), its negative (−1), the total, or 0."""

    coordinate: int | None
    sign: int = 1

    def weights(self, system: CubicSystem) -> Array:
        """Its coefficients of the coordinates."""
        out = np.zeros(system.coordinates)
        if self.coordinate is None:
            out[: system.exact.m] = abs(self.sign)
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
    """Σ alone·x + Σ product·y·x + Σ along·y + Σ inverse/T + constant.

    It is scale·target + Σ w·g(y, x) + Σ μ·(M(y)x − b(y)), by its powers: at a feasible point g ≤ 0
    and M(y)x = b(y), so that its least value over the box bounds scale·target from below. The first
    two are exact, since weights are integers below 2²⁶ and coefficients multiples of 2⁻¹³; ``size``
    is the sum of all absolute terms in the others, by largest values.
    """

    alone: Array
    product: Array
    along: Array
    inverse: Array
    constant: float
    size: Array
    least: float


def lagrangian(system: CubicSystem, target: Target, weights: Weights) -> Lagrangian:
    """The weighted sum."""
    exact = system.exact
    alone = np.zeros((exact.joints, exact.size))
    product = np.zeros((exact.joints, *system.linear.shape[:2]))
    along = weights.scale * target.weights(system)
    size, constant, least = np.abs(along), 0.0, 0.0
    for row, w in weights.rows.items():
        own = system.terms(row)
        if row.joint >= 0:
            alone[row.joint] += w * own.alone
            product[row.joint] += w * own.product
        along = along + w * own.along
        size += w * np.abs(own.along)
        constant += w * own.constant
        least += w * abs(own.constant)
    inverse = np.zeros(exact.m)
    for (j, i), w in weights.equations.items():
        alone[j] += w * system.fixed[i]
        product[j] += w * system.linear[:, i]
        if i in exact.moved:
            t = exact.moved[i][0]
            inverse[t] -= w * system.steps[t, j]
    return Lagrangian(alone, product, along, inverse, constant, size, least)


def multiplied(system: CubicSystem, weights: Weights) -> NDArray[np.bool_]:
    """Which products take part, shape (joints, coordinates, unknowns)."""
    return np.asarray(lagrangian(system, NOTHING, weights).product != 0)


def least(
    system: CubicSystem, target: Target, weights: Weights, side: Side, ranges: tuple[Array, Array]
) -> float:
    """Lower bound of weights.scale·target over every feasible point of the box.

    Parameters
    ----------
    system : CubicSystem
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
    sums = lagrangian(system, target, weights)
    low, high = (r.T for r in ranges)
    used = np.abs(sums.alone).sum(axis=1) + np.abs(sums.product).sum(axis=(1, 2)) > 0
    if not (np.isfinite(low[used]).all() and np.isfinite(high[used]).all()):
        return -np.inf
    low, high = np.where(used[:, None], low, 0.0), np.where(used[:, None], high, 0.0)
    top = np.maximum(np.abs(low), np.abs(high))
    lines, along, constant = sums.alone.copy(), sums.along.copy(), sums.constant
    share = weights.mix / MIX
    for part, edge, lower in ((share, low, True), (1.0 - share, high, False)):
        # d·y·x ≥ d·(corner·x + edge·y − corner·edge), exact where x = edge.
        positive = (sums.product > 0) == lower
        corner = np.where(positive, side.low[None, :, None], side.high[None, :, None])
        tilt = sums.product * part * np.where(sums.product != 0, corner, 0.0)
        lines += tilt.sum(axis=1)
        along += (sums.product * part * edge[:, None, :]).sum(axis=(0, 2))
        constant -= float((tilt * edge[:, None, :]).sum())
    constant += float(np.minimum(lines * low, lines * high).sum())
    most = np.einsum("jkv,jv->k", np.abs(sums.product), top) + sums.size
    size = sums.least + float((np.abs(sums.alone) * top).sum())
    size += 3.0 * float(most @ np.maximum(np.abs(side.low), np.abs(side.high)))
    return _over_box(system, along, sums.inverse, constant, side, size)


def _over_box(
    system: CubicSystem, along: Array, inverse: Array, constant: float, side: Side, size: float
) -> float:
    """Least value of along·y + Σ inverse/T + constant, with ρ = h²/T, less what rounding may be."""
    low, high = side.low, side.high
    for h, t, rho in system.exact.rho():
        factor, along[rho] = along[rho], 0.0
        if factor >= 0:
            # h²/T ≥ 2θh − θ²T, for any θ.
            slope = _slope(factor, along, inverse[t], side, h, t)
            along[h] += 2.0 * slope * factor
            along[t] -= slope * slope * factor
        elif low[t] > 0:
            # Convex in h, and largest for the least T: below the chord.
            along[h] += factor * (low[h] + high[h]) / low[t]
            constant -= factor * low[h] * high[h] / low[t]
            size += 3.0 * abs(factor) * high[h] * high[h] / low[t]
        else:
            along[h] += factor  # h²/T ≤ h
    for t in np.flatnonzero(inverse).tolist():
        e = float(inverse[t])
        if low[t] <= 0:
            return -np.inf
        if e > 0:
            # 1/T ≥ 2/τ − T/τ², the tangent at any τ.
            best = np.sqrt(e / along[t]) if along[t] > 0 else high[t]
            place = float(np.clip(best, low[t], high[t]))
            constant += 2.0 * e / place
            along[t] -= e / (place * place)
            size += 2.0 * e / place + e * high[t] / (place * place)
        else:
            constant += e * (1.0 / low[t] + 1.0 / high[t])
            along[t] -= e / (low[t] * high[t])
            size += 3.0 * abs(e) / low[t]
    rest = np.minimum(along * low, along * high)
    return float(constant + rest.sum() - _ROUNDINGS * EPS * size)


def _slope(factor: float, along: Array, inverse: float, side: Side, h: int, t: int) -> float:
    """θ of a good tangent of ρ, of 33: every fourth of those that the verifier tries."""
    if factor == 0 or side.low[t] <= 0:
        return 0.0
    low, high = side.low, side.high
    theta = np.linspace(low[h] / high[t], min(1.0, high[h] / low[t]), 33)
    first, second = along[h] + 2 * theta * factor, along[t] - theta**2 * factor
    value = np.minimum(first * low[h], first * high[h])
    with np.errstate(divide="ignore", invalid="ignore"):
        best = np.where(second > 0, np.sqrt(max(inverse, 0.0) / np.abs(second)), high[t])
    place = np.clip(np.nan_to_num(best, nan=high[t]), low[t], high[t])
    ends = [second * x + inverse / x for x in (low[t], high[t], place)]
    return float(theta[np.argmax(value + np.min(ends, axis=0))])
