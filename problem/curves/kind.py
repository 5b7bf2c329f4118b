"""Any kind of joint curve: what it declares, and the functions that each kind registers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from . import spline
from .interpolant import Interpolant
from .peak import Extremum
from .spline import PERM
from .trajectory import Trajectory


class Curve(Protocol):
    """What every declaration of a curve through way-points says about itself.

    `Interpolant` is one; the B-splines of `uniform` and `clamped` are others. A kind takes part in
    `check`, `evaluate`, `solve` and the heuristics by registering with the functions of this
    module; nothing else asks for its type.
    """

    @property
    def name(self) -> str:
        """Words for messages."""

    @property
    def segments(self) -> int:
        """Number of durations."""

    @property
    def waypoint_breaks(self) -> tuple[int, ...]:
        """Ends of segments that carry a way-point, in order, from 0 to ``segments``."""

    @property
    def homogeneous(self) -> bool:
        """Whether stretching time maps admissible curves to admissible curves."""

    @property
    def free(self) -> int:
        """Coefficients of one joint that are left to the optimiser."""


@dataclass(frozen=True, eq=False)
class Enclosed:
    """A trajectory, and a bound on the rounding errors of its extrema.

    Attributes
    ----------
    trajectory : Trajectory
    error : ndarray, shape (pieces, 4, joints)
        Bound on the error of any extremum of derivative 0 to 3 on a piece.
    """

    trajectory: Trajectory
    error: Array


def _unknown(curve: object) -> TrajgapError:
    return TrajgapError(f"interpolant: {type(curve).__name__} is no kind of curve known here")


@singledispatch
def fit(curve: Curve, waypoints: Array, durations: Array, nodal: Array | None = None) -> Trajectory:
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
        Values of the free derivatives where the declaration leaves some open.

    Returns
    -------
    Trajectory
        Its pieces are the segments, except where a curve has its knots elsewhere.

    Raises
    ------
    TrajgapError
        If shapes disagree, a duration is not positive, or the durations define no curve.
    """
    raise _unknown(curve)


@singledispatch
def enclosed(
    curve: Curve, waypoints: Array, durations: Array, nodal: Array | None = None
) -> Enclosed:
    """`fit` in extended precision, with a bound on the error of every extremum."""
    raise _unknown(curve)


@singledispatch
def motion_values(curve: Curve, waypoints: Array, nodal: Array | None = None) -> Array:
    """What `batch_peaks` needs to know of the way-points; its last axis is the joint."""
    raise _unknown(curve)


@singledispatch
def batch_peaks(curve: Curve, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
    """True peaks of |v|, |a|, |j| for a batch of duration vectors.

    Parameters
    ----------
    curve : Curve
    values : ndarray
        From `motion_values`.
    durations : ndarray, shape (batch, segments)
        s; vectors that define no curve give infinite peaks.
    wanted : ndarray of bool, shape (joints, 3)
        Which peaks are needed; the others are returned as 0.

    Returns
    -------
    ndarray, shape (batch, joints, 3)
        rad/s, rad/s², rad/s³.
    """
    raise _unknown(curve)


@dataclass(frozen=True, eq=False)
class PeakGradients:
    """Gradients of the values of some extrema.

    Attributes
    ----------
    durations : ndarray, shape (extrema, segments)
        d value / d duration.
    waypoints : ndarray, shape (extrema, way-points)
        d value / d way-point of the extremum's own joint.
    nodal : ndarray, shape (extrema, free)
        d value / d free derivative of the extremum's own joint.
    """

    durations: Array
    waypoints: Array
    nodal: Array


@singledispatch
def value_gradients(
    curve: Curve,
    waypoints: Array,
    durations: Array,
    points: list[Extremum],
    nodal: Array | None = None,
) -> PeakGradients:
    """Gradients of the values at fixed places ``s`` of pieces; the place's own motion is left out.

    At an extremum it does not contribute (envelope theorem).
    """
    raise _unknown(curve)


@singledispatch
def for_joint(curve: Curve, waypoints: Array, index: int) -> Curve:
    """The curve of one joint alone, the same as it is among all joints."""
    return curve


@singledispatch
def segment_of(curve: Curve, durations: Array, point: Extremum) -> int:
    """Segment between way-points in which an extremum of a piece lies, from 0."""
    return point.segment


Ends = tuple[tuple[tuple[int, float], ...], tuple[tuple[int, float], ...]]


@singledispatch
def end_conditions(curve: Curve) -> Ends:
    """Derivatives ``(order, value)`` prescribed at the start, and at the end."""
    return (), ()


@singledispatch
def smooth_order(curve: Curve, break_index: int) -> int:
    """Order up to which derivatives in time agree at an inner break, whatever the durations."""
    return 0


def value_errors(trajectory: Trajectory, coefficient_error: Array) -> Array:
    """Bound on the error of each derivative's extrema, shape (pieces, 4, joints).

    Coefficient errors, plus the rounding of Horner's scheme, plus that of the place of the
    extremum, where the next derivative vanishes to rounding.
    """
    size = 32 * np.finfo(np.float64).eps * np.abs(trajectory.scaled)
    errors = np.zeros((size.shape[0], 4, size.shape[2]))
    for r in range(4):
        own = np.einsum("p,kpj->kj", PERM[:, r], coefficient_error + size)
        place = np.einsum("p,kpj->kj", PERM[:, r + 1], size)
        errors[:, r] = (own + place) / trajectory.durations[:, None] ** r
    return errors


def derivative_row(s: float, order: int) -> Array:
    """Weights of the scaled coefficients in d^order/ds^order at ``s``."""
    powers = np.arange(PERM.shape[0])
    row = np.where(powers >= order, s ** np.maximum(powers - order, 0), 0.0)
    return np.asarray(PERM[:, order] * row)


fit.register(Interpolant, spline.fit)
motion_values.register(Interpolant, spline.motion_values)
batch_peaks.register(Interpolant, spline.batch_peaks)


@enclosed.register
def _(
    curve: Interpolant, waypoints: Array, durations: Array, nodal: Array | None = None
) -> Enclosed:
    scaled, error = spline.refined_coefficients(curve, waypoints, durations, nodal)
    trajectory = spline.trajectory_from_scaled(scaled, curve.degrees, durations)
    return Enclosed(trajectory, value_errors(trajectory, error))


@end_conditions.register
def _(curve: Interpolant) -> Ends:
    return curve.prescribed[0], curve.prescribed[-1]


@smooth_order.register
def _(curve: Interpolant, break_index: int) -> int:
    return curve.continuity[break_index - 1]


@value_gradients.register
def _(
    curve: Interpolant,
    waypoints: Array,
    durations: Array,
    points: list[Extremum],
    nodal: Array | None = None,
) -> PeakGradients:
    g = spline.coefficient_gradient(curve, waypoints, durations, nodal)
    by_duration = np.empty((len(points), curve.segments))
    by_waypoint = np.empty((len(points), waypoints.shape[0]))
    by_nodal = np.empty((len(points), curve.free))
    for i, e in enumerate(points):
        basis = derivative_row(e.s, e.order) / durations[e.segment] ** e.order
        by_duration[i] = g.durations[:, e.segment, :, e.joint] @ basis
        by_duration[i, e.segment] -= e.order * e.value / durations[e.segment]
        by_waypoint[i] = g.waypoints[:, e.segment] @ basis
        by_nodal[i] = g.nodal[:, e.segment] @ basis
    return PeakGradients(by_duration, by_waypoint, by_nodal)
