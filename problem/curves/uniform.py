"""The uniform cubic B-spline of irb1600: control vertices from way-points, two readings of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError

_SIXTH = Fraction(1, 6)


class Timing(StrEnum):
    """How time enters a curve that is given in a parameter e."""

    STRETCHED = "stretched"
    """Each segment by itself: time grows linearly in e, so velocity may jump between segments."""
    TIMED = "timed"
    """Time is itself a smooth function of e, or e is time."""


@dataclass(frozen=True)
class StretchedUniformBSpline:
    """Uniform cubic B-spline in e, with time linear in e within each segment.

    Source: `irb1600-ga-cubic-bspline`, (1) to (3), with t″ = 0 in (7). C2 in e; in time the
    velocity jumps wherever the durations of neighbours differ and the joint moves.

    Parameters
    ----------
    waypoints : int
        Number of way-points, at least 2.

    Raises
    ------
    TrajgapError
        If there are fewer than two way-points.
    """

    waypoints: int

    def __post_init__(self) -> None:
        _at_least_two(self.waypoints)

    @property
    def name(self) -> str:
        """Words for messages."""
        return "uniform cubic B-spline, segments stretched in time"

    @property
    def segments(self) -> int:
        """Number of segments, one less than way-points."""
        return self.waypoints - 1

    @property
    def waypoint_breaks(self) -> tuple[int, ...]:
        """Every break carries a way-point."""
        return tuple(range(self.waypoints))

    @property
    def homogeneous(self) -> bool:
        """Always: nothing but positions is prescribed."""
        return True

    @property
    def free(self) -> int:
        """Nothing is left open."""
        return 0


@dataclass(frozen=True)
class TimedUniformBSpline:
    """Uniform cubic B-splines q(e) through the way-points and t(e) through the time nodes.

    Source: `irb1600-ga-cubic-bspline`, (1) to (3), with the t″ that (7) carries: time closed at
    both ends as the joints are. C2 in time where dt/de > 0, which not every set of durations
    gives. The closing makes q″ = ±2q′ and t″ = ±2t′ at the ends: the acceleration is 0 there
    and the velocity is not.

    Parameters
    ----------
    waypoints : int
        Number of way-points, at least 2.

    Raises
    ------
    TrajgapError
        If there are fewer than two way-points.
    """

    waypoints: int

    def __post_init__(self) -> None:
        _at_least_two(self.waypoints)

    @property
    def name(self) -> str:
        """Words for messages."""
        return "uniform cubic B-spline, time a B-spline too"

    @property
    def segments(self) -> int:
        """Number of segments, one less than way-points."""
        return self.waypoints - 1

    @property
    def waypoint_breaks(self) -> tuple[int, ...]:
        """Every break carries a way-point."""
        return tuple(range(self.waypoints))

    @property
    def homogeneous(self) -> bool:
        """Always: nothing but positions is prescribed."""
        return True

    @property
    def free(self) -> int:
        """Nothing is left open."""
        return 0


def _at_least_two(waypoints: int) -> None:
    if waypoints < 2:
        raise TrajgapError("interpolant: at least two way-points are needed")


def uniform_cubic_b_spline(
    waypoints: int, time: Timing | str
) -> StretchedUniformBSpline | TimedUniformBSpline:
    """Uniform cubic B-spline through a number of way-points.

    Parameters
    ----------
    waypoints : int
    time : Timing or str
        "stretched" or "timed".

    Raises
    ------
    TrajgapError
        If the word is another, or there are fewer than two way-points.
    """
    if time not in tuple(Timing):
        raise TrajgapError(f"interpolant.time: {time!r} is unknown; use stretched or timed")
    if Timing(time) is Timing.STRETCHED:
        return StretchedUniformBSpline(waypoints)
    return TimedUniformBSpline(waypoints)


@lru_cache(maxsize=64)
def vertex_matrix(waypoints: int) -> tuple[tuple[Fraction, ...], ...]:
    """Control vertices as exact combinations of the way-points, (m + 2) rows of m numbers.

    (V_{i−1} + 4 V_i + V_{i+1})/6 = W_i (2) with V_1 = V_0 and V_{m+1} = V_m (3). Rows sum to 1;
    the sum of the absolute values of a row is at most 3, since the diagonal of the system exceeds
    the rest of its row by at least 2/6.
    """
    m = waypoints
    _at_least_two(m)
    end = 5 * _SIXTH
    diagonal = [end, *([4 * _SIXTH] * (m - 2)), end]
    rows = [[Fraction(int(i == k)) for k in range(m)] for i in range(m)]
    for i in range(1, m):
        factor = _SIXTH / diagonal[i - 1]
        diagonal[i] -= factor * _SIXTH
        rows[i] = [a - factor * b for a, b in zip(rows[i], rows[i - 1], strict=True)]
    for i in range(m - 1, -1, -1):
        above = rows[i + 1] if i + 1 < m else [Fraction(0)] * m
        rows[i] = [(a - _SIXTH * b) / diagonal[i] for a, b in zip(rows[i], above, strict=True)]
    return tuple(map(tuple, (rows[0], *rows, rows[-1])))


@lru_cache(maxsize=64)
def shape_matrix(waypoints: int) -> NDArray[np.longdouble]:
    """Coefficients in e of each segment as combinations of the way-points.

    Returns
    -------
    ndarray of longdouble, shape (segments, 4, way-points)
        Exact rational numbers, rounded once.
    """
    v = vertex_matrix(waypoints)

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
def clock_matrix(waypoints: int) -> NDArray[np.longdouble]:
    """Coefficients in e of t on each segment as combinations of the durations.

    Returns
    -------
    ndarray of longdouble, shape (segments, 4, segments)
    """
    nodes = shape_matrix(waypoints)
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
