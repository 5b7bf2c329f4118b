"""The uniform cubic B-spline of irb1600, in two readings of time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .kind import STEP, Curve, Enclosed, Shape, as_batch, masked
from .peak import Extremum, PeakGradients
from .polynomials import MAX_COEFFICIENTS
from .stretched import StretchedCurve, Timing
from .timed import clocked_reach, enclosed_with_clock, runs_forwards, value_at
from .uniform_matrices import clock_matrix, shape_matrix


@lru_cache(maxsize=16)
def _nodes(waypoints: int, natural: bool) -> Array:
    """The clock's matrix in float64."""
    return np.asarray(clock_matrix(waypoints, natural), dtype=np.float64)


@dataclass(frozen=True)
class UniformBSpline(Curve):
    """What both readings declare: the number of way-points, and nothing else.

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
        n, joints = self.segments, waypoints.shape[1]
        wide = waypoints.astype(np.longdouble)
        exact = matrix @ wide
        epsilon = np.finfo(np.longdouble).eps * (self.waypoints + 4)
        scaled, error = np.zeros((2, n, MAX_COEFFICIENTS, joints))
        scaled[:, :4] = exact
        error[:, :4] = epsilon * (np.abs(matrix) @ np.abs(wide))
        error += np.finfo(np.float64).eps * np.abs(scaled)
        by_waypoint = np.zeros((n, MAX_COEFFICIENTS, self.waypoints))
        by_waypoint[:, :4] = matrix
        return Shape(
            segment=np.arange(n),
            share=np.ones(n),
            degree=3,
            scaled=scaled,
            error=error,
            by_waypoint=np.broadcast_to(by_waypoint, (joints, *by_waypoint.shape)),
        )


@dataclass(frozen=True)
class TimedUniformBSpline(UniformBSpline):
    """Uniform cubic B-splines q(e) through the way-points and t(e) through the time nodes.

    Source: `irb1600-ga-cubic-bspline`, (1) to (3), with the t″ that (7) carries. C2 in time where
    dt/de > 0, which not every set of durations gives. How time ends is not printed: closed as the
    joints are, q″ = ±2q′ and t″ = ±2t′ at the ends, so that the acceleration is 0 there and the
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

    def batch_reach(
        self,
        values: Array,
        durations: Array,
        wanted: NDArray[np.bool_],
        sides: tuple[float, ...],
        least: int = 1,
    ) -> Array:
        """Of all pieces at once."""
        nodes = _nodes(self.waypoints, self.natural_clock)
        clocks, valid = runs_forwards(nodes, as_batch(self, durations))
        found = np.zeros((len(clocks), len(sides), *wanted.shape))
        if wanted.any():
            found[valid] = clocked_reach(values, clocks[valid], wanted, sides, least)
        return masked(found, wanted, valid)

    def value_gradients(
        self,
        waypoints: Array,
        durations: Array,
        points: list[Extremum],
        nodal: Array | None = None,
    ) -> PeakGradients:
        """By complex steps: every number is a rational function of durations and way-points."""
        matrix = shape_matrix(self.waypoints).astype(np.float64)
        nodes = self.clock.astype(np.float64)
        scaled, clock = matrix @ waypoints, nodes @ durations
        by_duration = np.empty((len(points), self.segments))
        by_waypoint = np.empty((len(points), self.waypoints))
        for i, e in enumerate(points):
            q, t = scaled[e.segment, :, e.joint], clock[e.segment]
            steps = t + 1j * STEP * nodes[e.segment].T
            by_duration[i] = value_at(q, steps, e).imag / STEP
            # The numerators are linear in q.
            by_waypoint[i] = value_at(matrix[e.segment].T, t, e)
        return PeakGradients(by_duration, by_waypoint, np.empty((len(points), 0)))


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
        Of a timed one: as in `TimedUniformBSpline`.

    Raises
    ------
    TrajgapError
        If the word is another, if a stretched clock shall be natural, or if there are fewer than
        two way-points.
    """
    if time not in tuple(Timing):
        raise TrajgapError(f"interpolant.time: {time!r} is unknown; use stretched or timed")
    if Timing(time) is Timing.TIMED:
        return TimedUniformBSpline(waypoints, natural_clock)
    if natural_clock:
        raise TrajgapError("interpolant.time_ends: goes with time = 'timed' alone; leave it out")
    return StretchedUniformBSpline(waypoints)
