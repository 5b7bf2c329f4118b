"""The clamped B-spline of z1: degree, knots and parameters, with its conditions counted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from . import clamped_kernel
from .clamped_fit import clamped_enclosed, clamped_gradients, clamped_shape
from .clamped_knots import (
    Fractions,
    Knots,
    Parameters,
    average_matrix,
    count_inner_knots,
    fractions_of,
    inner_fractions,
    nearest_reading,
    outside_support,
)
from .compilation import Deferred
from .condition import counts_in_words
from .families import piecewise, quintic_spline
from .kind import Curve, Derivatives, Enclosed, PeakGradients, Shape, as_batch
from .peak import Extremum
from .stretched import StretchedCurve, Timing

_peaks_of_many = Deferred(clamped_kernel.batch_peaks, 12.0)
"""True peaks of a batch; compiling it takes eleven to twelve seconds."""
_ranges_of_many = Deferred(clamped_kernel.batch_ranges, 8.0)
"""Positions of a batch; compiling it takes six to ten seconds."""


@dataclass(frozen=True)
class ClampedBSpline(StretchedCurve):
    """Clamped B-spline through the way-points at rest at both ends.

    Source: `z1-woa-bspline`, (1) to (12); (3) puts the way-points at the times.

    Parameters
    ----------
    waypoints : int
        Number of way-points, at least 2.
    degree : int
        p, 3 to 7; z1 does not print it.
    knots : Knots or str
    parameters : Parameters or str
        What the knots are placed by. With chords the inner knots lie at fixed fractions of the
        total time.
    time : Timing or str
        "timed": e is time, the way-points are passed where the durations say. "stretched": the
        way-points sit at the parameters themselves and each segment is stretched in time by
        itself, so that velocity may jump; with parameters from the times there is no difference,
        and it is refused.
    end_orders : tuple of int
        Derivatives that are 0 at both ends.
    fractions : tuple, optional
        Parameters from 0 to 1 to use instead of the chords of the way-points, one tuple for all
        joints or one for each; the printed ones where ``parameters`` is "given".
    knot_vector : tuple of float
        All knots as printed, on any scale, where ``knots`` is "given": degree + 1 equal ones at
        each end, each inner one once.

    Raises
    ------
    TrajgapError
        If a word is unknown, or the conditions do not determine the control points.

    Notes
    -----
    The way-points and end conditions are W + 2c conditions (c end orders) on as many control
    points as there are inner knots plus p + 1. Knots at the way-points: W − 1 + p, so that p = 5
    is determined for v = a = 0, the C4 quintic spline. Averaged as printed: W, so that no
    degree leaves room for end conditions. Averaged with the index continued: W + 2c, any degree.
    """

    waypoints: int
    degree: int
    knots: Knots = Knots.WAYPOINTS
    parameters: Parameters = Parameters.TIMES
    time: Timing = Timing.TIMED
    end_orders: tuple[int, ...] = (1, 2)
    fractions: Fractions | None = None
    knot_vector: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for field, words in (("knots", Knots), ("parameters", Parameters), ("time", Timing)):
            given = getattr(self, field)
            if given not in tuple(words):
                raise TrajgapError(
                    f"interpolant.{field}: {given!r} is unknown; use one of {', '.join(words)}"
                )
            object.__setattr__(self, field, words(given))
        object.__setattr__(self, "knot_vector", tuple(map(float, self.knot_vector)))
        if self.waypoints < 2:
            raise TrajgapError("interpolant: at least two way-points are needed")
        if not 3 <= self.degree <= 7:
            raise TrajgapError(f"interpolant.degree: must lie in 3..7, got {self.degree}")
        if any(not 1 <= r < self.degree for r in self.end_orders) or len(
            set(self.end_orders)
        ) != len(self.end_orders):
            raise TrajgapError(
                "interpolant.end_orders: orders must be distinct and lie in 1..degree − 1"
            )
        if self.time is Timing.STRETCHED and self.parameters is Parameters.TIMES:
            raise TrajgapError(
                "interpolant.time: parameters from the times are times already; "
                "leave stretched out, or take the parameters from chords"
            )
        self._check_numbers()
        if self.inner_knots < 0:
            raise TrajgapError(
                f"interpolant {self.name}: degree {self.degree} needs at least "
                f"{self.waypoints - self.inner_knots} way-points; lower the degree"
            )
        if self.free:
            word = "over" if self.free < 0 else "under"
            nearest = nearest_reading(self.knots, self.degree, self.end_orders)
            if self.knots is Knots.GIVEN:
                whole = self.conditions + self.degree + 1
                nearest = (
                    f"{whole} knots in all determine it, and {len(self.knot_vector)} are given"
                )
            raise TrajgapError(
                f"interpolant {self.name}: {word}-determined, "
                f"{counts_in_words(self.conditions, self.control_points, 'control points')}; "
                f"{nearest}"
            )
        for row in self.fractions or ():
            if len(row) != self.waypoints or row[0] != 0.0 or row[-1] != 1.0:
                raise TrajgapError(
                    f"interpolant.fractions: expected {self.waypoints} numbers from 0 to 1"
                )
        if self.knots is Knots.GIVEN and self._stretched:
            self._check_passing()

    def _check_numbers(self) -> None:
        """Find out whether what is printed of knots and parameters is there, and goes together."""
        given = self.knots is Knots.GIVEN
        if given != bool(self.knot_vector):
            raise TrajgapError(
                'interpolant.knot_vector: is missing where knots are "given"; name all of them'
                if given
                else 'interpolant.knot_vector: is for knots that are "given"; leave it out'
            )
        if self.parameters is Parameters.GIVEN and not self.fractions:
            raise TrajgapError(
                'interpolant.fractions: are missing where parameters are "given"; give one for '
                "each way-point"
            )
        for row in self.fractions or ():
            if any(not a < b for a, b in pairwise(row)):
                raise TrajgapError("interpolant.fractions: each must be larger than the one before")
        fitting = Parameters.GIVEN if self._stretched else Parameters.TIMES
        if given and self.parameters is not fitting:
            where = "printed parameters" if self._stretched else "the times"
            raise TrajgapError(
                f'interpolant.parameters: where knots are "given" and time is "{self.time}", '
                f'way-points are passed at {where}; write "{fitting}"'
            )

    def _check_passing(self) -> None:
        """Find out whether a spline with the printed knots passes the printed parameters."""
        p, rest = self.degree, len(self.end_orders)
        inner = inner_fractions(self.knot_vector, p)
        knots = np.concatenate([np.zeros(p + 1), inner, np.ones(p + 1)])
        for row in self.fractions or ():
            sites = np.concatenate([np.zeros(rest), row, np.ones(rest)])
            outside = outside_support(knots, sites, p)
            if outside is not None:
                low, high = knots[outside], knots[outside + p + 1]
                raise TrajgapError(
                    f"interpolant.knot_vector: no curve passes way-point {outside - rest}, whose "
                    f"parameter {sites[outside]:g} (of 0 to 1) does not lie between the knots "
                    f"{low:g} and {high:g} (Schoenberg and Whitney); correct knots or parameters"
                )

    @property
    def name(self) -> str:
        """Words for messages."""
        where = {
            Knots.WAYPOINTS: "knots at the way-points",
            Knots.AVERAGED: "averaged knots",
            Knots.CONTINUED: "averaged knots, index continued",
            Knots.GIVEN: "printed knots",
        }[self.knots]
        source = {
            Parameters.TIMES: "",
            Parameters.CHORD: " of chord parameters",
            Parameters.JOINT_CHORD: " of each joint's chord parameters",
            Parameters.GIVEN: " of printed parameters",
        }[self.parameters]
        stretched = ", stretched in time" if self.time is Timing.STRETCHED else ""
        return f"clamped B-spline of degree {self.degree}, {where}{source}{stretched}"

    @property
    def segments(self) -> int:
        """Number of segments, one less than way-points."""
        return self.waypoints - 1

    def prescribed_at(self, break_index: int) -> Derivatives:
        """Rest at both ends."""
        ends = break_index in (0, self.segments)
        return tuple((r, 0.0) for r in self.end_orders) if ends else ()

    def smooth_order(self, break_index: int) -> int:
        """The spline's own, unless every segment is stretched by itself."""
        return 0 if self.time is Timing.STRETCHED else self.degree - 1

    def smooth_shares(self, waypoints: Array) -> Array | None:
        """Those of the parameters, where all joints have the same ones."""
        rows = fractions_of(self, waypoints) if self._stretched else None
        return None if rows is None or len(rows) > 1 else np.diff(rows[0])

    @property
    def inner_knots(self) -> int:
        """Number of inner knots; negative if there are too few way-points."""
        if self.knots is Knots.GIVEN:
            return len(inner_fractions(self.knot_vector, self.degree))
        return count_inner_knots(self.knots, self.waypoints, self.degree, self.end_orders)

    @property
    def control_points(self) -> int:
        """Number of control points."""
        return self.inner_knots + self.degree + 1

    @property
    def conditions(self) -> int:
        """Way-points and end conditions."""
        return self.waypoints + 2 * len(self.end_orders)

    @property
    def free(self) -> int:
        """Control points less conditions: 0 for every declaration that can be made."""
        return self.control_points - self.conditions

    @property
    def _stretched(self) -> bool:
        return self.time is Timing.STRETCHED

    def fixed_by(self, waypoints: Array) -> ClampedBSpline:
        """The curve with the chord parameters of these way-points as its `fractions`."""
        return replace(self, fractions=fractions_of(self, waypoints))

    def for_joint(self, waypoints: Array, index: int) -> ClampedBSpline:
        """The curve of one joint: chords of the joint vector stay those of all joints."""
        fixed = self.fixed_by(waypoints)
        if fixed.fractions is None or len(fixed.fractions) == 1:
            return fixed
        return replace(fixed, fractions=(fixed.fractions[index],))

    def polynomial_form(self) -> Curve:
        """The C(p−1) spline of degree p, which inner knots at the way-points' times make it."""
        if self.knots is not Knots.WAYPOINTS or self.parameters is not Parameters.TIMES:
            return self
        if (self.degree, self.end_orders) == (5, (1, 2)):
            return quintic_spline(self.segments)
        ends = tuple((order, 0.0) for order in self.end_orders)
        return piecewise((self.degree,) * self.segments, self.degree - 1, ends)

    def shape(self, waypoints: Array) -> Shape | None:
        """The curve in its parameter where it is stretched."""
        return clamped_shape(self, waypoints) if self._stretched else None

    def segment_of(self, durations: Array, point: Extremum) -> int:
        """Segment by time: pieces end at knots."""
        inner = np.cumsum(durations)[:-1]
        return int(np.searchsorted(inner, point.time, side="left"))

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """Solved in extended precision, as `clamped_system.interpolated` bounds it."""
        if self._stretched:
            return super().enclosed(waypoints, durations)
        return clamped_enclosed(self, waypoints, durations)

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """The way-points themselves, unless stretched."""
        return super().motion_values(waypoints) if self._stretched else waypoints

    def batch_peaks(self, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
        """True peaks by the compiled kernel."""
        if self._stretched:
            return super().batch_peaks(values, durations, wanted)
        return self._peaks(values, durations, wanted, 0.0)

    def batch_sides(
        self,
        waypoints: Array,
        durations: Array,
        wanted: NDArray[np.bool_],
        nodal: Array | None = None,
    ) -> Array:
        """True peaks to each side by the compiled kernel."""
        if self._stretched:
            return super().batch_sides(waypoints, durations, wanted)
        sides = zip(wanted, (-1.0, 1.0), strict=True)
        return np.stack([self._peaks(waypoints, durations, part, sign) for part, sign in sides])

    def range_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """The way-points themselves, unless stretched."""
        return super().range_values(waypoints) if self._stretched else waypoints

    def batch_ranges(self, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
        """Least and largest positions by the compiled kernel."""
        if self._stretched:
            return super().batch_ranges(values, durations, wanted)
        h = as_batch(self, durations)
        ranges = np.empty((h.shape[0], values.shape[1], 2))
        _ranges_of_many(h, *self._placed(values), wanted, ranges)
        return ranges

    def _peaks(
        self, values: Array, durations: Array, wanted: NDArray[np.bool_], side: float
    ) -> Array:
        h = as_batch(self, durations)
        peaks = np.empty((h.shape[0], values.shape[1], 3))
        _peaks_of_many(h, *self._placed(values), wanted, side, peaks)
        return peaks

    def _placed(self, waypoints: Array) -> tuple[Array, Array, Array, int, NDArray[np.int64]]:
        """What the kernel asks for of way-points and declaration."""
        average, orders = _plan(self)
        rows = fractions_of(self, waypoints)
        fractions = np.empty((0, self.waypoints)) if rows is None else np.array(rows)
        # A copy may be written into: one type of array, for which the kernel is compiled once.
        return np.array(waypoints, order="C"), average, fractions, self.degree, orders

    def value_gradients(
        self,
        waypoints: Array,
        durations: Array,
        points: list[Extremum],
        nodal: Array | None = None,
    ) -> PeakGradients:
        """By complex steps in the durations; by the way-points with knots and parameters held."""
        if self._stretched:
            return super().value_gradients(waypoints, durations, points)
        return clamped_gradients(self, waypoints, durations, points)


@lru_cache(maxsize=64)
def _plan(curve: ClampedBSpline) -> tuple[Array, NDArray[np.int64]]:
    """What the kernel needs of a declaration; a swarm asks for the same one thousands of times."""
    return average_matrix(curve), np.array(curve.end_orders, dtype=np.int64)
