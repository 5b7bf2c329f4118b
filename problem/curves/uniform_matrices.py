"""The uniform cubic B-spline of irb1600 in exact numbers: control vertices from way-points."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array

_SIXTH = Fraction(1, 6)
"""Weight of either neighbour in (2); exact, so that the matrices are."""


@lru_cache(maxsize=64)
def vertex_matrix(waypoints: int, natural: bool = False) -> tuple[tuple[Fraction, ...], ...]:
    """Control vertices as exact combinations of the way-points, (m + 2) rows of m numbers.

    (V_{i−1} + 4 V_i + V_{i+1})/6 = W_i (2) with V_1 = V_0 and V_{m+1} = V_m (3). Rows sum to 1;
    the sum of the absolute values of a row is at most 3, since the diagonal of the system exceeds
    the rest of its row by at least 2/6. A natural curve has no curvature at its ends instead of
    (3): V_0 − 2 V_1 + V_2 = 0, so that V_1 = W_0 by (2), and the same at the other end.
    """
    m = waypoints
    end = Fraction(1) if natural else 5 * _SIXTH
    diagonal = [end, *([4 * _SIXTH] * (m - 2)), end]
    rows = [[Fraction(int(i == k)) for k in range(m)] for i in range(m)]

    def beside(i: int) -> Fraction:
        """Weight of a neighbour in row i."""
        return Fraction(0) if natural and i in (0, m - 1) else _SIXTH

    for i in range(1, m):
        factor = beside(i) / diagonal[i - 1]
        diagonal[i] -= factor * beside(i - 1)
        rows[i] = [a - factor * b for a, b in zip(rows[i], rows[i - 1], strict=True)]
    for i in range(m - 1, -1, -1):
        above = rows[i + 1] if i + 1 < m else [Fraction(0)] * m
        rows[i] = [(a - beside(i) * b) / diagonal[i] for a, b in zip(rows[i], above, strict=True)]
    first, last = rows[0], rows[-1]
    if natural:
        first = [2 * a - b for a, b in zip(rows[0], rows[1], strict=True)]
        last = [2 * a - b for a, b in zip(rows[-1], rows[-2], strict=True)]
    return tuple(map(tuple, (first, *rows, last)))


@lru_cache(maxsize=64)
def shape_matrix(waypoints: int, natural: bool = False) -> NDArray[np.longdouble]:
    """Coefficients in e of each segment as combinations of the way-points.

    Parameters
    ----------
    waypoints : int
    natural : bool
        As in `vertex_matrix`.

    Returns
    -------
    ndarray of longdouble, shape (segments, 4, way-points)
        Exact rational numbers, rounded once.
    """
    v = vertex_matrix(waypoints, natural)

    def combined(k: int, weights: Sequence[int], divisor: int) -> list[Fraction]:
        rows = [v[k + i] for i in range(4)]
        return [
            sum((w * row[i] for w, row in zip(weights, rows, strict=True)), Fraction(0)) / divisor
            for i in range(waypoints)
        ]

    # The four basis functions of (1) in powers of e.
    blocks = [((1, 4, 1, 0), 6), ((-1, 0, 1, 0), 2), ((1, -2, 1, 0), 2), ((-1, 3, -3, 1), 6)]
    matrix = np.array(
        [
            [[_wide(x) for x in combined(k, weights, d)] for weights, d in blocks]
            for k in range(waypoints - 1)
        ]
    )
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=64)
def clock_matrix(waypoints: int, natural: bool = False) -> NDArray[np.longdouble]:
    """Coefficients in e of t on each segment as combinations of the durations.

    Parameters
    ----------
    waypoints : int
    natural : bool
        As in `vertex_matrix`, for the time nodes.

    Returns
    -------
    ndarray of longdouble, shape (segments, 4, segments)
    """
    nodes = shape_matrix(waypoints, natural)
    # Node i is the sum of the durations before it.
    matrix = np.cumsum(nodes[:, :, :0:-1], axis=2)[:, :, ::-1]
    matrix.setflags(write=False)
    return matrix


def _wide(x: Fraction) -> np.longdouble:
    high = float(x)
    return np.longdouble(high) + np.longdouble(float(x - Fraction(high)))


def control_vertices(waypoints: ArrayLike) -> Array:
    """Control vertices of the uniform cubic B-spline through way-points.

    Source: `irb1600-ga-cubic-bspline`, (2) and (3).

    Parameters
    ----------
    waypoints : array_like, shape (m, joints)
        In any unit.

    Returns
    -------
    ndarray, shape (m + 2, joints)
        In the same unit.
    """
    q = np.asarray(waypoints, dtype=np.float64)
    matrix = np.array([[float(x) for x in row] for row in vertex_matrix(q.shape[0])])
    return np.asarray(matrix @ q)
