"""Ranges that the unknowns of a C2 cubic spline keep to while the durations are in a box."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from ....problem import Array
from ...enclosure import EPS, Ball, raised
from .system import CubicSystem

_ROUNDS = 6
"""Of narrowing by the equations: as many as the verifier makes, which could not follow more."""
_SPARE = 1e-8
"""Relative widening: the verifier's own enclosure need not be a hair tighter than this one."""


@dataclass(frozen=True, eq=False)
class Side:
    """Box of all coordinates, both ρ included, shape (coordinates,); its ends are floats."""

    low: Array
    high: Array


def with_rho(system: CubicSystem, low: Array, high: Array) -> Side:
    """Sides of ρ = h²/T beside those of h and T, rounded outward."""
    below, above = list(low), list(high)
    for h, t, _ in system.curved:
        below.append(low[h] * low[h] / high[t] * (1 - 4 * EPS))
        most = high[h] * high[h] / low[t] if low[t] > 0 else np.inf
        above.append(min(most, high[h]) * (1 + 4 * EPS))
    return Side(np.array(below), np.array(above))


def _upward(value: Fraction | None) -> float:
    return np.inf if value is None else float(value) * (1 + 2 * EPS)


def implied(system: CubicSystem, cap: Fraction) -> list[tuple[float, float]]:
    """Bounds of |v| and |a| that hold whatever the durations, per joint; inf where there is none.

    The acceleration vanishes somewhere: at an end, or, if v is 0 at both, in between. With the
    total below the cap L this gives |a| ≤ jerk limit·L, and |v| ≤ a·L if the spline stands at an
    end, half of that if it stands at both. Where |a| is α, it stays above α − jerk limit·|t − t*|
    until it vanishes or an end with v = 0 comes: 2·velocity limit ≥ α²/jerk limit.
    """
    still = sum(order != 2 for order in system.ends[:2])
    out = []
    for velocity, acceleration, jerk in system.limits:
        v, a = _upward(velocity), _upward(acceleration)
        a = min(a, _upward(jerk) * float(cap) * (1 + 4 * EPS))
        a = min(a, math.sqrt(2 * v * _upward(jerk)) * (1 + 8 * EPS))
        if still:
            v = min(v, a * float(cap) / still * (1 + 4 * EPS))
        out.append((v, a))
    return out


def a_priori(system: CubicSystem, side: Side, cap: Fraction) -> tuple[Array, Array]:
    """Ranges from the limits alone.

    Parameters
    ----------
    system : CubicSystem
    side : Side
    cap : Fraction

    Returns
    -------
    low, high : ndarray, shape (unknowns, joints)
        Infinite where nothing is known.
    """
    n, m = system.pieces, system.spans
    shortest, longest = np.zeros(n), np.zeros(n)
    for k in range(n):
        for c, x in system.piece(k).items():
            shortest[k] += x * (side.low[c] if x > 0 else side.high[c])
            longest[k] += x * (side.high[c] if x > 0 else side.low[c])
    reach = np.zeros(n + 1)
    reach[:n] = np.maximum(shortest, 0.0)
    reach[1:] = np.maximum(reach[1:], shortest)
    if system.virtual:
        # One of the two pieces of such a span is at least half of it.
        reach[1] = max(reach[1], side.low[0] / 2)
        reach[n - 1] = max(reach[n - 1], side.low[m - 1] / 2)
    since = np.concatenate([[0.0], np.cumsum(longest)])
    until = since[-1] - since
    high = np.full((system.unknowns, system.joints), np.inf)
    for j, (v, a) in enumerate(implied(system, cap)):
        with np.errstate(divide="ignore", invalid="ignore"):
            # A parabola within ±v on a piece of length h has a slope of at most 8v/h (Markov).
            slope = np.where(reach > 0, 8 * v / reach, np.inf)
        bound = np.minimum(a, slope)
        jerk = _upward(system.limits[j][2])
        for order, span in ((system.ends[0], since), (system.ends[1], until)):
            if order != 1 and np.isfinite(jerk):
                bound = np.minimum(bound, jerk * span)
        high[: n + 1, j], high[n + 1 :, j] = bound, v
    high = high * (1 + _SPARE)
    return -high, high


def narrowed(
    system: CubicSystem, side: Side, low: Array, high: Array
) -> tuple[Array, Array] | None:
    """Narrow the ranges by the equations (Krawczyk, preconditioned at the centre of the box).

    M(y)x = b(y) and M(c)x̃ ≈ b(c), Y ≈ M(c)⁻¹ give x − x̃ = Y(b(c) − M(c)x̃) +
    Y(b(y) − b(c) − Σ dy_k B_k x̃) + (I − Y M(c) − Σ dy_k Y B_k)(x − x̃).

    Parameters
    ----------
    system : CubicSystem
    side : Side
    low, high : ndarray, shape (unknowns, joints)
        Ranges known so far.

    Returns
    -------
    tuple of ndarray or None
        None if the ranges are disjoint from the equations: the box is empty.
    """
    fixed, linear, steps, which = matrices(system)
    centre = 0.5 * (side.low + side.high)
    half = raised(np.maximum(side.high - centre, centre - side.low), 2)
    m = system.spans
    moving = which >= 0
    if (moving & (side.low[:m] <= 0)).any():
        return low, high
    matrix = Ball.exact(fixed)
    for k, c in enumerate(centre):
        matrix = matrix + Ball.exact(linear[k]) * Ball.exact(np.full((1, 1), c))
    try:
        inverse: Array = np.asarray(np.linalg.inv(matrix.mid), dtype=np.float64)
    except np.linalg.LinAlgError:
        return low, high
    if not np.isfinite(inverse).all():
        return low, high
    y = Ball.exact(inverse)
    lengths, ends = centre[:m][moving], (side.low[:m][moving], side.high[:m][moving])
    right = Ball.exact(np.zeros((system.unknowns, system.joints)))
    at = which[moving]
    value = steps[moving] * Ball.exact((1.0 / lengths)[:, None])
    # One rounding in the quotient, a few in the products below: all relative.
    value = Ball(value.mid, raised(value.rad + 8 * EPS * np.abs(value.mid), 2))
    right.mid[at], right.rad[at] = value.mid, value.rad
    middle = Ball.exact(inverse @ right.mid)
    offset = (y @ (right - matrix @ middle)).magnitude()
    # 1/T − 1/c = −(T − c)ψ with ψ between 1/(c·high) and 1/(c·low).
    rate = Ball.between(
        (1.0 / (lengths * ends[1])) * (1 - 4 * EPS), (1.0 / (lengths * ends[0])) * (1 + 4 * EPS)
    )
    slope = Ball.exact(linear) @ middle
    pull = steps[moving] * rate.reshape(-1, 1)
    spans = np.flatnonzero(moving)
    added = Ball(slope.mid[spans, at], slope.rad[spans, at]) + pull
    slope.mid[spans, at], slope.rad[spans, at] = added.mid, added.rad
    first = (y @ slope).magnitude()
    offset = raised(offset + np.tensordot(half, first, 1), half.size + 2)
    spread = (y @ Ball.exact(linear)).magnitude()
    defect = (Ball.exact(np.eye(system.unknowns)) - y @ matrix).magnitude()
    change = raised(defect + np.tensordot(half, spread, 1), half.size + system.unknowns + 2)
    for _ in range(_ROUNDS):
        known = np.isfinite(high).all(axis=0)
        if not known.any():
            break
        radius = np.maximum(np.abs(low - middle.mid), np.abs(high - middle.mid))[:, known]
        reach = raised(offset[:, known] + change @ raised(radius, 1), system.unknowns + 2)
        reach = reach * (1 + _SPARE) + _SPARE * np.abs(middle.mid[:, known])
        below, above = middle.mid[:, known] - reach, middle.mid[:, known] + reach
        low, high = low.copy(), high.copy()
        low[:, known] = np.maximum(low[:, known], np.nextafter(below, -np.inf))
        high[:, known] = np.minimum(high[:, known], np.nextafter(above, np.inf))
    return None if (low > high).any() else (low, high)


@lru_cache(maxsize=8)
def matrices(system: CubicSystem) -> tuple[Array, Array, Ball, Array]:
    """M(y) = fixed + Σ y_k linear[k]; 6·displacements with sign, and the equation they stand in.

    Returns
    -------
    fixed : ndarray, shape (unknowns, unknowns)
    linear : ndarray, shape (coordinates, unknowns, unknowns)
    steps : Ball, shape (spans, joints)
    which : ndarray of int, shape (spans,)
        −1 where nothing moves.
    """
    size = system.unknowns
    fixed = np.zeros((size, size))
    linear = np.zeros((system.coordinates, size, size))
    which = np.full(system.spans, -1)
    mid = np.zeros((system.spans, system.joints))
    for i, (terms, moved) in enumerate(system.equations()):
        for v, x in terms.by.items():
            fixed[i, v] = x
        for (k, v), x in terms.product.items():
            linear[k, i, v] = x
        if moved is not None:
            t, sign = moved
            mid[t] = [6 * sign * float(x) for x in system.steps[t]]
            if any(system.steps[t]):
                which[t] = i
    return fixed, linear, Ball(mid, 4 * EPS * np.abs(mid)), which
