"""Exact extrema of a trajectory's derivatives: every local one, with its place and size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, over_rows
from .polynomials import LOOSE, bernstein
from .trajectory import Trajectory


@dataclass(frozen=True)
class Extremum:
    """One local extremum of a derivative of one joint.

    Attributes
    ----------
    joint, segment : int
        Indices from 0; the segment is a piece of the trajectory, and a segment between
        way-points except where a curve has its knots elsewhere.
    order : int
        Derivative: 0 position, 1 velocity, 2 acceleration, 3 jerk, 4 snap.
    s : float
        Place in its own parameter, 0..1.
    time : float
        Place in time, s.
    value : float
        Signed value, rad/sᵒʳᵈᵉʳ.
    """

    joint: int
    segment: int
    order: int
    s: float
    time: float
    value: float


@dataclass(frozen=True, eq=False)
class PeakGradients:
    """Gradients of the values of some extrema.

    Attributes
    ----------
    durations : ndarray, shape (extrema, segments)
        d value / d duration.
    nodal : ndarray, shape (extrema, free)
        d value / d free derivative of the extremum's own joint.
    by_waypoints : callable
        Computes `waypoints` on request: searches over durations do not need it, and for long
        B-splines it takes hundreds of times as long as the rest.
    """

    durations: Array
    nodal: Array
    by_waypoints: Callable[[], Array]

    @cached_property
    def waypoints(self) -> Array:
        """D value / d way-point of the extremum's own joint, shape (extrema, way-points)."""
        return self.by_waypoints()


def extrema(trajectory: Trajectory, joint: int, order: int) -> list[Extremum]:
    """Ends and interior turning points of one derivative of one joint, in order of time.

    Parameters
    ----------
    trajectory : Trajectory
    joint : int
        Index from 0.
    order : int
        0 position, 1 velocity, 2 acceleration, 3 jerk, 4 snap.

    Returns
    -------
    list of Extremum
        The largest absolute value over all t is among them.
    """
    places, values = (found[:, :, joint].T for found in trajectory.turns(order))
    known = ~np.isnan(places)
    pieces, s = np.nonzero(known)[0], places[known]
    columns = pieces, s, trajectory.times(pieces, s), values[known]
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return [Extremum(joint, k, order, s, time, value) for k, s, time, value in rows]


@dataclass(frozen=True, eq=False)
class Furthest:
    """The least and the largest value of one derivative of every joint.

    Attributes
    ----------
    order : int
    pieces, places, values : ndarray, shape (2, joints)
        Of the least and of the largest value; the first in time where several are equal. What is
        not a number is both.
    inner : ndarray, shape (2, joints)
        What some value surely reaches, errors included.
    outer : ndarray, shape (2, joints)
        What no value is beyond.
    """

    order: int
    pieces: NDArray[np.int64]
    places: Array
    values: Array
    inner: Array
    outer: Array

    def at(self, trajectory: Trajectory, side: int, joint: int) -> Extremum:
        """The least value, side 0, or the largest, side 1, of a joint."""
        k, s = int(self.pieces[side, joint]), float(self.places[side, joint])
        time = float(trajectory.times(k, np.array(s)))
        return Extremum(joint, k, self.order, s, time, float(self.values[side, joint]))


def furthest(trajectory: Trajectory, order: int, errors: Array) -> Furthest:
    """How far a derivative goes to both sides, for all t.

    The errors are bounds on those of any extremum on a piece, shape (pieces, joints).
    """
    pieces = np.arange(len(trajectory.durations))
    if trajectory.polynomial_in_time:
        pieces = _reaching(trajectory, order, errors)
    places, values = trajectory.turns(order, pieces)
    none, near = np.isnan(places), errors[pieces]
    # By time: pieces first, places of one after another.
    shape = (places.shape[0] * pieces.size, trajectory.joints)
    places = places.transpose(1, 0, 2).reshape(shape)
    joint, found = np.arange(trajectory.joints), []
    for sign in (-1.0, 1.0):
        sized = [np.where(none, -np.inf, sign * values + blur) for blur in (0.0, -near, near)]
        at = sized[0].transpose(1, 0, 2).reshape(shape).argmax(axis=0)
        piece, place = at // len(values), at % len(values)
        ends = [sign * one.max(axis=(0, 1)) for one in sized[1:]]
        found.append((pieces[piece], places[at, joint], values[place, piece, joint], *ends))
    return Furthest(order, *(np.array(part) for part in zip(*found, strict=True)))


def _reaching(trajectory: Trajectory, order: int, errors: Array) -> NDArray[np.int64]:
    """Pieces that may have the least or largest value of a joint, or one that counts with errors.

    Bernstein coefficients bound a polynomial; a piece that stays within what the ends of others
    surely have, with errors on both sides, is left out.
    """
    a = trajectory.derivatives(order)
    start, end, sizes = trajectory.edges(order)
    room = LOOSE * sizes + errors
    low, high = np.minimum(start, end), np.maximum(start, end)
    least = over_rows(np.minimum, low + room)
    most = over_rows(np.maximum, high - room)
    if len(a) > 2:
        inner = bernstein(a)[1:-1]
        low, high = np.minimum(low, inner.min(axis=0)), np.maximum(high, inner.max(axis=0))
    inside = (low - room > least) & (high + room < most)
    return np.flatnonzero(~inside.all(axis=1))
