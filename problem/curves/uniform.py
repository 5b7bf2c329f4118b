"""The uniform cubic B-spline of irb1600: exact matrices, and curves in two readings of time."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .kind import STEP, Asked, Curve, Enclosed, Shape, Timing, as_batch, masked
from .peak import Extremum
from .stretched import StretchedCurve
from .timed import clocked_reach, combined, enclosed_with_clock, runs_forwards, values_at

_SIXTH = Fraction(1, 6)
"""Weight of either neighbour in (2); exact, so the matrices are."""


@lru_cache(maxsize=64)
def vertex_matrix(waypoints: int, natural: bool = False) -> tuple[tuple[Fraction, ...], ...]:
    """Control vertices as exact combinations of the way-points, (m + 2) rows of m numbers.

    (V_{i−1} + 4 V_i + V_{i+1})/6 = W_i (2) with V_1 = V_0 and V_{m+1} = V_m (3). Rows sum to 1;
    the sum of the absolute values of a row is at most 3, because the diagonal of the system exceeds
    the rest of its row by at least 2/6. A natural curve has no curvature at its ends instead of
    (3): V_0 − 2 V_1 + V_2 = 0, so V_1 = W_0 by (2), and the same at the other end.
    """
    m = waypoints
    end = Fraction(1) if natural else 5 * _SIXTH
    diagonal = [end, *([4 * _SIXTH] * (m - 2)), end]
    rows = np.eye(m, dtype=int) * Fraction(1)

    def beside(i: int) -> Fraction:
        """Weight of a neighbour in row i."""
        return Fraction(0) if natural and i in (0, m - 1) else _SIXTH

    for i in range(1, m):
        factor = beside(i) / diagonal[i - 1]
        diagonal[i] -= factor * beside(i - 1)
        rows[i] -= factor * rows[i - 1]
    rows[-1] /= diagonal[-1]
    for i in range(m - 2, -1, -1):
        rows[i] = (rows[i] - beside(i) * rows[i + 1]) / diagonal[i]
    first, last = rows[0], rows[-1]
    if natural:
        first, last = 2 * rows[0] - rows[1], 2 * rows[-1] - rows[-2]
    return tuple(map(tuple, (first, *rows, last)))


@lru_cache(maxsize=64)
def shape_matrix(waypoints: int, natural: bool = False) -> NDArray[np.longdouble]:
    """Coefficients in e of each segment as combinations of the way-points.

    Shape (segments, 4, way-points): exact rational numbers, rounded once.
    """
    v = np.array(vertex_matrix(waypoints, natural))
    # The four basis functions of (1) in powers of e.
    basis = np.array([(1, 4, 1, 0), (-3, 0, 3, 0), (3, -6, 3, 0), (-1, 3, -3, 1)]) * _SIXTH
    exact = np.array([basis @ v[k : k + 4] for k in range(waypoints - 1)])
    high = exact.astype(np.float64)
    low = exact - np.vectorize(Fraction, otypes=[object])(high)
    matrix: NDArray[np.longdouble] = high.astype(np.longdouble) + low.astype(np.float64)
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=64)
def clock_matrix(waypoints: int, natural: bool = False) -> NDArray[np.longdouble]:
    """Coefficients in e of t on each segment as combinations of the durations.

    Shape (segments, 4, segments); the nodes of time are those of `shape_matrix`.
    """
    nodes = shape_matrix(waypoints, natural)
    # Node i is the sum of the durations before it.
    matrix = np.cumsum(nodes[:, :, :0:-1], axis=2)[:, :, ::-1]
    matrix.setflags(write=False)
    return matrix


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
    return np.asarray(np.array(vertex_matrix(q.shape[0])).astype(np.float64) @ q)


@dataclass(frozen=True)
class UniformBSpline(Curve):
    """What both readings declare: the number of way-points, and nothing else.

    Parameters
    ----------
    waypoints : int
        Number of way-points, at least 2.
    """

    waypoints: int
    words: ClassVar[str]

    def __post_init__(self) -> None:
        if self.waypoints < 2:
            raise TrajgapError("interpolant: at least two way-points are needed")

    @property
    def name(self) -> str:
        """Words for messages."""
        return f"uniform cubic B-spline, {self.words}"

    @property
    def segments(self) -> int:
        """Number of segments, one less than way-points."""
        return self.waypoints - 1


class StretchedUniformBSpline(UniformBSpline, StretchedCurve):
    """Uniform cubic B-spline in e, with time linear in e within each segment.

    Source: `irb1600-ga-cubic-bspline`, (1) to (3), with t″ = 0 in (7). C2 in e; in time the
    velocity jumps wherever the durations of neighbours differ and the joint moves.
    """

    words = "segments stretched in time"

    def shape(self, waypoints: Array) -> Shape:
        """One cubic a segment, from exact rational numbers."""
        matrix = shape_matrix(self.waypoints)
        pieces = np.arange(self.segments)
        return Shape(pieces, np.ones(pieces.size), 3, *combined(matrix, waypoints))


@dataclass(frozen=True)
class TimedUniformBSpline(UniformBSpline):
    """Uniform cubic B-splines q(e) through the way-points and t(e) through the time nodes.

    Source: `irb1600-ga-cubic-bspline`, (1) to (3), with the t″ that (7) carries. C2 in time where
    dt/de > 0, which not every set of durations gives. How time ends is not printed: closed as the
    joints are, q″ = ±2q′ and t″ = ±2t′ at the ends, so the acceleration is 0 there and the
    velocity is not; with natural ends t″ = 0, and neither is 0.

    Parameters
    ----------
    natural_clock : bool
        Whether t″ is 0 at both ends, instead of equal control vertices of time.
    """

    natural_clock: bool = False
    words = "time a B-spline too"

    @property
    def name(self) -> str:
        """Words for messages; they tell both ends of time apart."""
        return f"{super().name}{', with natural ends of time' if self.natural_clock else ''}"

    @property
    def clock(self) -> NDArray[np.longdouble]:
        """Coefficients in e of t on each segment, as combinations of the durations."""
        return clock_matrix(self.waypoints, self.natural_clock)

    @property
    def polynomial_in_time(self) -> bool:
        """Not where time is a spline too."""
        return False

    def smooth_order(self, break_index: int) -> int:
        """C2 at every break."""
        return 2

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """From exact rational matrices; a `CurveError` where time would run backwards."""
        q, t = shape_matrix(self.waypoints), self.clock
        return enclosed_with_clock(q, t, waypoints, durations)

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """Coefficients of q(e), positions counted from the first way-point."""
        matrix = shape_matrix(self.waypoints)
        return np.asarray(matrix @ (waypoints - waypoints[0]), dtype=np.float64)

    def batch_reach(self, values: Array, durations: Array, asked: Asked) -> Array:
        """Compute it for all pieces at once."""
        nodes = self.clock.astype(np.float64)
        clocks, valid = runs_forwards(nodes, as_batch(self, durations))
        found = asked.room(valid.size)
        if asked.wanted.any():
            found[valid] = clocked_reach(values, clocks[:, valid], asked)
        return masked(found, asked, valid)

    def by_durations(self, waypoints: Array, durations: Array, points: list[Extremum]) -> Array:
        """Computed by complex steps: every number is a rational function of the durations."""
        scaled = shape_matrix(self.waypoints).astype(np.float64) @ waypoints
        nodes = self.clock.astype(np.float64)
        marks = [(e.segment, e.joint, e.order) for e in points]
        piece, joint, orders = np.array(marks, dtype=np.int64).reshape(-1, 3).T
        q = scaled[piece, :, joint].T[:, :, None]
        t = ((nodes @ durations)[piece, :, None] + 1j * STEP * nodes[piece]).transpose(1, 0, 2)
        places = np.array([e.s for e in points])[:, None]
        found = np.empty((len(points), self.segments))
        for order in set(orders.tolist()):
            own = orders == order
            moved = values_at(q[:, own], t[:, own], order, places[own])
            found[own] = moved.imag / STEP
        return found


def uniform_cubic_b_spline(
    waypoints: int, time: Timing | str, natural_clock: bool = False
) -> StretchedUniformBSpline | TimedUniformBSpline:
    """Uniform cubic B-spline through a number of way-points.

    Parameters
    ----------
    waypoints : int
    time : Timing or str
        "stretched" or "timed".
    natural_clock : bool
        For a timed curve, as in `TimedUniformBSpline`.

    Raises
    ------
    TrajgapError
        If the word is unknown, if a stretched clock is to be natural, or if there are fewer than
        two way-points.
    """
    if time not in tuple(Timing):
        raise TrajgapError(f"interpolant.time: {time!r} is unknown; use stretched or timed")
    if Timing(time) is Timing.TIMED:
        return TimedUniformBSpline(waypoints, natural_clock)
    if natural_clock:
        raise TrajgapError("interpolant.time_ends: goes with time = 'timed' alone; leave it out")
    return StretchedUniformBSpline(waypoints)
