"""Ranges that the unknowns of a C2 cubic spline keep to while the durations are in a box.

The verifier computes them in rational numbers. These floats follow it, and are wider by `_SPARE`:
what the search relies on is proved by whoever judges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....problem import Array
from ...enclosure import EPS
from .system import CubicSystem

_ROUNDS = 6
"""Of narrowing by the equations: as many as the verifier makes, which could not follow more."""
_SPARE = 1e-8
"""Relative widening: the verifier's own enclosure need not be a hair tighter than this one."""


@dataclass(frozen=True, eq=False)
class Side:
    """Box of all coordinates, both ρ included, shape (coordinates,)."""

    low: Array
    high: Array


def with_rho(system: CubicSystem, low: Array, high: Array) -> Side:
    """Sides of ρ = h²/T beside those of h and T, rounded outward."""
    below, above = list(low), list(high)
    for h, t, _ in system.exact.rho():
        below.append(low[h] * low[h] / high[t] * (1 - 4 * EPS))
        most = high[h] * high[h] / low[t] if low[t] > 0 else np.inf
        above.append(min(most, high[h]) * (1 + 4 * EPS))
    return Side(np.array(below), np.array(above))


def a_priori(system: CubicSystem, side: Side) -> tuple[Array, Array]:
    """Ranges from the limits alone: Markov's inequality, and jerk since a rest of a.

    Returns
    -------
    low, high : ndarray, shape (unknowns, joints)
        Infinite where nothing is known.
    """
    exact = system.exact
    n, m = exact.n, exact.m
    shortest, longest = np.zeros(n), np.zeros(n)
    for k in range(n):
        for c, x in exact.lengths[k].items():
            shortest[k] += x * (side.low[c] if x > 0 else side.high[c])
            longest[k] += x * (side.high[c] if x > 0 else side.low[c])
    reach = np.zeros(n + 1)
    reach[:n] = np.maximum(shortest, 0.0)
    reach[1:] = np.maximum(reach[1:], shortest)
    if exact.virtual:
        # One of the two pieces of such a span is at least half of it.
        reach[1] = max(reach[1], side.low[0] / 2)
        reach[n - 1] = max(reach[n - 1], side.low[m - 1] / 2)
    since = np.concatenate([[0.0], np.cumsum(longest)])
    until = since[-1] - since
    high = np.full((exact.size, exact.joints), np.inf)
    for j, (v, a) in enumerate(system.fastest):
        with np.errstate(divide="ignore", invalid="ignore"):
            # A parabola within ±v on a piece of length h has a slope of at most 8v/h (Markov).
            slope = np.where(reach > 0, 8 * v / reach, np.inf)
        bound = np.minimum(a, slope)
        jerk = exact.limits[j][2]
        for order, span in ((exact.ends[0], since), (exact.ends[1], until)):
            if order != 1 and jerk is not None:
                bound = np.minimum(bound, float(jerk) * span)
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
    moving, size = system.moving, system.exact.size
    centre = 0.5 * (side.low + side.high)
    half = np.maximum(side.high - centre, centre - side.low)
    spans = np.flatnonzero(moving)
    if (side.low[spans] <= 0).any():
        return low, high
    matrix = system.fixed + np.tensordot(centre, system.linear, 1)
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return low, high
    if not np.isfinite(inverse).all():
        return low, high
    at, force = system.which[spans], system.steps[spans]
    right = np.zeros((size, system.exact.joints))
    right[at] = force / centre[spans, None]
    middle = inverse @ right
    # What rounding may amount to, where the matrix is almost singular, stands beside each part.
    rough = size * EPS * np.abs(inverse)
    offset = np.abs(inverse @ (right - matrix @ middle))
    offset += rough @ (np.abs(right) + np.abs(matrix) @ np.abs(middle))
    first = np.zeros((system.coordinates, *middle.shape))
    for end in (side.low, side.high):
        # 1/T − 1/c = −(T − c)/(cT), with T at either end.
        slope = system.linear @ middle
        slope[spans, at] += force / (centre[spans] * end[spans])[:, None]
        first = np.maximum(first, np.abs(inverse @ slope) + rough @ np.abs(slope))
    offset += np.tensordot(half, first, 1)
    change = np.abs(np.eye(size) - inverse @ matrix) + rough @ np.abs(matrix)
    change += np.tensordot(half, np.abs(inverse @ system.linear), 1)
    known = np.isfinite(high).all(axis=0)
    middle, offset = middle[:, known], offset[:, known]
    low, high = low.copy(), high.copy()
    for _ in range(_ROUNDS if known.any() else 0):
        radius = np.maximum(np.abs(low[:, known] - middle), np.abs(high[:, known] - middle))
        reach = (offset + change @ radius) * (1 + _SPARE) + _SPARE * np.abs(middle)
        low[:, known] = np.maximum(low[:, known], middle - reach)
        high[:, known] = np.minimum(high[:, known], middle + reach)
    return None if (low > high).any() else (low, high)
