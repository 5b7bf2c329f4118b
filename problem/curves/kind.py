"""What every kind of joint curve provides: its declaration, and its exact numbers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .peak import Extremum, PeakGradients
from .polynomials import PERM
from .trajectory import Trajectory

_LONGEST = 1e30
"""Durations, s, beyond which, or below whose reciprocal, ninth powers leave float64's range."""
STEP = 1e-30
"""Complex step of gradients, s: its square is lost in any double, so nothing is truncated."""
Derivatives = tuple[tuple[int, float | tuple[float, ...]], ...]
"""Derivatives ``(order, value)`` prescribed at one break, rad/sᵒʳᵈᵉʳ: one value for all joints, or
one for each where they differ."""


class Timing(StrEnum):
    """How time enters a curve that is given in a parameter e."""

    STRETCHED = "stretched"
    """Each segment separately: time grows linearly in e, so velocity may jump between segments."""
    TIMED = "timed"
    """Time is itself a smooth function of e, or e is time."""


@dataclass(frozen=True, eq=False)
class Enclosed:
    """A trajectory, and a bound on the rounding errors of its extrema.

    Attributes
    ----------
    trajectory : Trajectory
    bound : callable
        Computes `error`, which `fit` does without.
    closer : callable, optional
        Makes the same with a closer bound, at some cost; None if there is none.
    """

    trajectory: Trajectory
    bound: Callable[[], Array]
    closer: Callable[[], Enclosed] | None = None

    @cached_property
    def error(self) -> Array:
        """Bound on that of any extremum of derivative 0 to 4, shape (pieces, 5, joints)."""
        return self.bound()


@dataclass(frozen=True, eq=False)
class Shape:
    """A curve in its parameter, cut into polynomial pieces, before time enters.

    Attributes
    ----------
    segment : ndarray of int, shape (pieces,)
        Segment that a piece belongs to.
    share : ndarray, shape (pieces,)
        Part of the segment's duration that it takes.
    degree : int
    scaled, error : ndarray, shape (pieces, 10, joints)
        Ascending coefficients in the piece's own 0..1, and a bound on their error.
    """

    segment: NDArray[np.int64]
    share: Array
    degree: int
    scaled: Array
    error: Array


@dataclass(frozen=True, eq=False)
class Asked:
    """Which derivatives a batch of duration vectors is asked for.

    Attributes
    ----------
    wanted : ndarray of bool, shape (joints, orders)
        What is needed, of order ``least`` first; the others are returned as 0.
    sides : tuple of float
        0 for the largest size; 1 for the furthest value above 0, −1 for that below, as sizes, and 0
        where there is none.
    least : int
        0 for positions, counted from the first way-point.
    caps : ndarray, shape (joints, orders), optional
        Given if it only matters whether the numbers of a vector stay below these. Each number is
        then on the right side of its cap, unless another of the same vector is beyond its own.
    """

    wanted: NDArray[np.bool_]
    sides: tuple[float, ...] = (0.0,)
    least: int = 1
    caps: Array | None = None

    def room(self, vectors: int) -> Array:
        """Zeros for the answers, shape (batch, sides, joints, orders)."""
        return np.zeros((vectors, len(self.sides), *self.wanted.shape))


class Curve(ABC):
    """The declaration of a curve through way-points, with all that follows from it.

    `Interpolant` is one kind; the B-splines of `uniform` and `clamped` are others. The checker, the
    batch evaluator and the heuristics use only these methods of a curve.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Words for messages."""

    @property
    @abstractmethod
    def segments(self) -> int:
        """Number of durations."""

    @property
    def waypoint_breaks(self) -> tuple[int, ...]:
        """Ends of segments that carry a way-point, in order: all of them unless one is virtual."""
        return tuple(range(self.segments + 1))

    def prescribed_at(self, break_index: int) -> Derivatives:
        """Derivatives prescribed at an end of a segment, from 0; none unless a kind says so."""
        return ()

    @property
    def ends(self) -> tuple[Derivatives, Derivatives]:
        """Derivatives prescribed at the start, and at the end."""
        return self.prescribed_at(0), self.prescribed_at(self.segments)

    @property
    def prescribed_joints(self) -> int | None:
        """Number of joints for which derivatives are prescribed separately; None if all agree."""
        return None

    @property
    def homogeneous(self) -> bool:
        """Whether stretching time maps admissible curves to admissible curves."""
        breaks = range(self.segments + 1)
        return all(value == 0.0 for b in breaks for _, value in self.prescribed_at(b))

    @property
    def polynomial_in_time(self) -> bool:
        """Whether derivatives are polynomials of time on each piece."""
        return True

    @property
    def free(self) -> int:
        """Coefficients of one joint that are left to the optimiser."""
        return 0

    def smooth_shares(self, waypoints: Array) -> Array | None:
        """Proportions of durations with which a curve whose segments are stretched does not jump.

        None if there are none, or the curve has no parameter of its own.
        """
        return None

    def smooth_order(self, break_index: int) -> int:
        """Order up to which derivatives in time agree at an inner break, whatever the durations."""
        return 0

    @abstractmethod
    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """`fit` in extended precision, with a bound on the error of every extremum."""

    def fitted(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Trajectory:
        """`fit` for arrays that are already checked."""
        return self.enclosed(waypoints, durations, nodal).trajectory

    @abstractmethod
    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """Values computed from the way-points for `batch_reach`; the last axis is the joint."""

    @abstractmethod
    def batch_reach(self, values: Array, durations: Array, asked: Asked) -> Array:
        """How far derivatives go, for all t, for a batch of duration vectors.

        The values are those of `motion_values`; durations, s, shape (batch, segments), are infinite
        for vectors that define no curve.

        Returns
        -------
        ndarray, shape (batch, sides, joints, orders)
            rad/sᵒʳᵈᵉʳ.
        """

    def batch_sides(
        self,
        waypoints: Array,
        durations: Array,
        wanted: NDArray[np.bool_],
        nodal: Array | None = None,
    ) -> Array:
        """True peaks on each side.

        Parameters
        ----------
        waypoints : ndarray, shape (way-points, joints)
            rad.
        durations : ndarray, shape (batch, segments)
            s; vectors that define no curve give infinite peaks.
        wanted : ndarray of bool, shape (2, joints, orders)
            Which peaks are needed, below 0 and above; the others are returned as 0.
        nodal : ndarray, shape (free, joints), optional

        Returns
        -------
        ndarray, shape (2, batch, joints, orders)
            Sizes, rad/sᵒʳᵈᵉʳ: of the furthest value below 0, and above; 0 for none.
        """
        values = self.motion_values(waypoints, nodal)
        asked = Asked(np.logical_or(*wanted), (-1.0, 1.0))
        found = self.batch_reach(values, durations, asked).swapaxes(0, 1)
        found[~np.broadcast_to(wanted[:, None], found.shape) & np.isfinite(found)] = 0.0
        return found

    def value_gradients(
        self, waypoints: Array, durations: Array, points: list[Extremum], nodal: Array | None = None
    ) -> PeakGradients:
        """Gradients of the values at fixed places ``s`` of pieces; their own motion is left out.

        At an extremum it does not contribute (envelope theorem).
        """

        def by_waypoints() -> Array:
            # Values are linear in the way-points: those of the curves through unit ones. All
            # joints take part, because the knots of each may cut the pieces of all.
            count, joints = waypoints.shape
            units = np.tile(np.eye(count), joints)
            unit = self.fixed_by(waypoints).fitted(units, durations)
            rows = [
                unit.values(e.segment, slice(count * e.joint, count * (e.joint + 1)), e.order, s)
                for e, s in zip(points, np.array([e.s for e in points]), strict=True)
            ]
            return np.array(rows).reshape(len(points), count)

        by_duration = self.by_durations(waypoints, durations, points)
        return PeakGradients(by_duration, np.empty((len(points), 0)), by_waypoints)

    @abstractmethod
    def by_durations(self, waypoints: Array, durations: Array, points: list[Extremum]) -> Array:
        """The gradients by durations alone, shape (points, segments), without free derivatives."""

    def segment_of(self, durations: Array, point: Extremum) -> int:
        """Segment in which an extremum of a piece lies, from 0: the piece, unless knots differ."""
        return point.segment

    def fixed_by(self, waypoints: Array) -> Curve:
        """The same curve, with all that depends on lengths between way-points fixed as here."""
        return self

    def for_joint(self, waypoints: Array, index: int) -> Curve:
        """The curve of one joint alone, the same as it is among all joints."""
        return self

    def shape(self, waypoints: Array) -> Shape | None:
        """The curve in its parameter, if each segment is stretched in time separately."""
        return None

    def polynomial_form(self) -> Curve:
        """The same curve in the form that is evaluated fastest: itself, unless a kind has two."""
        return self


def fit(
    curve: Curve, waypoints: ArrayLike, durations: ArrayLike, nodal: ArrayLike | None = None
) -> Trajectory:
    """The trajectory that the declaration, the way-points and the durations determine.

    Parameters
    ----------
    curve : Curve
        Declaration.
    waypoints : array_like, shape (way-points, joints)
        Joint angles, rad.
    durations : array_like, shape (segments,)
        Segment durations, s.
    nodal : array_like, shape (free, joints), optional
        Values of the free derivatives, if the declaration leaves some open.

    Returns
    -------
    Trajectory
        Its pieces are the segments, except where a curve has its knots elsewhere.

    Raises
    ------
    TrajgapError
        If shapes disagree, a duration is not positive, or the durations define no curve.
    """
    q = as_waypoints(as_curve(curve), waypoints)
    extra = None if nodal is None else np.asarray(nodal, dtype=np.float64)
    return curve.fitted(q, as_durations(durations, curve.segments), extra)


def merged_values(entries: Derivatives) -> Derivatives:
    """Derivatives at a break, with one number wherever all joints have the same value."""
    found: list[tuple[int, float | tuple[float, ...]]] = []
    for order, value in entries:
        if isinstance(value, Sequence | np.ndarray):
            each = tuple(map(float, value))
            same = len(set(each)) == 1
            found.append((order, each[0] if same else each))
        else:
            found.append((order, value))
    return tuple(found)


def as_curve(given: object) -> Curve:
    """A curve of any kind, or a clear refusal."""
    if not isinstance(given, Curve):
        raise TrajgapError(f"curve: {type(given).__name__} is not a kind of curve known here")
    return given


def as_waypoints(curve: Curve, waypoints: ArrayLike) -> Array:
    """Way-points as a float64 array of the right number of rows, or a clear refusal."""
    q = np.asarray(waypoints, dtype=np.float64)
    wanted = len(curve.waypoint_breaks)
    if q.ndim != 2 or q.shape[0] != wanted:
        raise TrajgapError(
            f"waypoints: {curve.name} with {curve.segments} segments needs {wanted} rows, "
            f"got shape {q.shape}"
        )
    return q


def as_durations(durations: ArrayLike, segments: int) -> Array:
    """Duration vector as a clean float64 array, or a clear refusal.

    Raises
    ------
    TrajgapError
        On a wrong length, NaN, infinite, zero or negative entries, or such that powers overflow.
    """
    try:
        h = np.ascontiguousarray(durations, dtype=np.float64)
    except (TypeError, ValueError):
        raise TrajgapError("durations: not numbers; give seconds, one per segment") from None
    if h.shape != (segments,):
        raise TrajgapError(
            f"durations: expected {segments} (one per segment), got {h.size if h.ndim else 1}"
            + (f" in shape {h.shape}" if h.ndim > 1 else "")
        )
    if not np.isfinite(h).all() or (h <= 0).any():
        raise TrajgapError(f"durations: {h.tolist()} s must all be positive and finite")
    if h.min() < 1 / _LONGEST or h.max() > _LONGEST:
        raise TrajgapError(
            f"durations: {h.tolist()} s must all lie between {1 / _LONGEST:g} and {_LONGEST:g} s"
        )
    return h


def are_durations(h: Array) -> NDArray[np.bool_]:
    """Which vectors of a batch are positive and finite throughout, shape (batch,)."""
    return np.asarray((np.isfinite(h) & (h > 0)).all(axis=1))


def masked(reach: Array, asked: Asked, valid: NDArray[np.bool_]) -> Array:
    """What `Curve.batch_reach` returns, from the numbers that were found, in place.

    Nothing lies on a side of 0 that no value is on; what is not a number, or of vectors that
    define no curve, is infinite.
    """
    np.maximum(reach, 0.0, out=reach)
    reach[np.isnan(reach)] = np.inf
    reach[:, :, ~asked.wanted] = 0.0
    reach[~valid] = np.inf
    return reach


def as_batch(curve: Curve, durations: ArrayLike) -> Array:
    """Duration vectors of a batch as a float64 array, or a clear refusal."""
    h = np.ascontiguousarray(durations, dtype=np.float64)
    if h.ndim != 2 or h.shape[1] != curve.segments:
        raise TrajgapError(
            f"durations: a batch has shape (vectors, {curve.segments}), got {h.shape}"
        )
    # Compiled functions take arrays that may not be written into for another type.
    return h if h.flags.writeable else h.copy()


def value_errors(trajectory: Trajectory, coefficient_error: Array) -> Array:
    """Bound on the error of each derivative's extrema, shape (pieces, 5, joints).

    Coefficient errors, plus the rounding of Horner's scheme, plus that of the place of the
    extremum, where the next derivative vanishes to rounding.
    """
    powers = trajectory.derivatives(0)
    top, size = len(powers), 32 * np.finfo(np.float64).eps * np.abs(powers)
    error = coefficient_error[:, :top].transpose(1, 0, 2)
    # Orders lead: what is asked of all pieces is one order at a time.
    own = np.tensordot(PERM[:top, :5].T, error, axes=1)
    own += np.tensordot(PERM[:top, :5].T + PERM[:top, 1:6].T, size, axes=1)
    # One power after another: those of a table of exponents differ in the last bit.
    own /= np.stack([trajectory.durations**r for r in range(5)])[:, :, None]
    return own.transpose(1, 0, 2)
