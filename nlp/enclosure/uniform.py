"""Derivatives of the uniform cubic B-splines over a box of durations and way-points, in balls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...problem import Array
from ...problem.curves import (
    PERM,
    clock_matrix,
    shape_matrix,
)
from .balls import EPS, Ball, quotient_power

_POWERS = 4
"""Coefficients of a cubic."""


@dataclass(frozen=True, eq=False)
class Centred:
    """Values of some derivatives at fixed places, and their gradients.

    Attributes
    ----------
    value : Ball, shape (rows,)
        At the central durations and way-points.
    by_duration : Ball, shape (rows, segments)
        Over all of the box.
    by_waypoint : Ball, shape (rows, way-points)
        At the central durations, in which the value is linear.
    amplitude : ndarray, shape (rows,)
        Sums of the absolute terms.
    """

    value: Ball
    by_duration: Ball
    by_waypoint: Ball
    amplitude: Array


def centred_stretched(
    waypoints: int,
    joint: NDArray[np.int64],
    segment: NDArray[np.int64],
    order: NDArray[np.int64],
    s: Array,
    h: Ball,
    q: Ball,
) -> Centred:
    """Enclose derivatives of given orders and joints at places ``s`` of segments.

    Parameters
    ----------
    waypoints : int
        Number of way-points.
    joint, segment, order : ndarray of int, shape (rows,)
    s : ndarray, shape (rows,)
    h : Ball, shape (segments,)
        s, positive.
    q : Ball, shape (way-points, joints)
        rad.

    Returns
    -------
    Centred
    """
    middle = Ball.exact(q.mid)
    still = Ball.exact(h.mid)
    shape = _at(shape_matrix(waypoints), segment, order, s)
    one = Ball.exact(np.ones(s.size))
    scale = quotient_power(one, still[segment], order)
    value = _own(shape @ middle, joint) * scale
    # f = D/hʳ: only the segment's own duration enters.
    over = _own(shape @ q, joint) * quotient_power(one, h[segment], order + 1)
    own = (segment[:, None] == np.arange(waypoints - 1)) * -order[:, None].astype(float)
    amplitude = np.abs(_own(Ball.exact(np.abs(shape.mid) @ np.abs(q.mid)), joint).mid)
    return Centred(
        value,
        Ball.exact(own) * over.reshape(-1, 1),
        shape * scale.reshape(-1, 1),
        amplitude * scale.mid,
    )


def centred_timed(
    waypoints: int,
    joint: NDArray[np.int64],
    segment: NDArray[np.int64],
    order: NDArray[np.int64],
    s: Array,
    h: Ball,
    q: Ball,
    natural: bool = False,
) -> Centred:
    """`centred_stretched` for time that is a B-spline too; velocity and acceleration only."""
    middle = Ball.exact(q.mid)
    still = Ball.exact(h.mid)
    first, second = (
        _at(shape_matrix(waypoints), segment, np.full_like(order, r), s) for r in (1, 2)
    )
    clock = clock_matrix(waypoints, natural)
    rate, bend = (_at(clock, segment, np.full_like(order, r), s) for r in (1, 2))
    twice = order == 2
    value = _in_time(first @ middle, second @ middle, rate @ still, bend @ still, joint, twice)
    by_waypoint = _by_waypoint(first, second, rate @ still, bend @ still, twice)
    by_duration = _by_duration(
        _own(first @ q, joint), _own(second @ q, joint), rate, bend, rate @ h, bend @ h, twice
    )
    terms = np.abs(by_waypoint.mid) @ np.abs(q.mid)
    return Centred(value, by_duration, by_waypoint, terms[np.arange(s.size), joint])


def _at(
    matrix: NDArray[np.longdouble], segment: NDArray[np.int64], order: NDArray[np.int64], s: Array
) -> Ball:
    """Derivatives in e at the places, as combinations of way-points or durations."""
    powers = np.arange(_POWERS)
    exponent = powers - order[:, None]
    raw = np.where(exponent >= 0, s[:, None] ** np.maximum(exponent, 0), 0.0)
    basis = PERM[:_POWERS, order].T * raw
    weights = Ball(basis, 6.0 * EPS * np.abs(basis))
    narrow = matrix[segment].astype(np.float64)
    found = Ball(narrow, EPS * np.abs(narrow))
    total = weights[:, 0].reshape(-1, 1) * found[:, 0]
    for m in range(1, _POWERS):
        total = total + weights[:, m].reshape(-1, 1) * found[:, m]
    return total


def _own(values: Ball, joint: NDArray[np.int64]) -> Ball:
    return values[np.arange(joint.size), joint]


def _power(base: Ball, exponent: int) -> Ball:
    result = base
    for _ in range(exponent - 1):
        result = result * base
    return result


def _over(numerator: Ball, speed: Ball, exponent: int) -> Ball:
    """``numerator`` over a power of the speed dt/de, which must stay positive."""
    one = Ball.exact(np.ones_like(speed.mid))
    fair = speed.mid - speed.rad > 0.0
    safe = Ball(np.where(fair, speed.mid, np.nan), speed.rad)
    inverse = quotient_power(one, safe, np.ones(speed.mid.shape, dtype=np.int64))
    factor = _power(inverse, exponent)
    return numerator * factor.reshape(-1, *([1] * (numerator.mid.ndim - 1)))


def _chosen(twice: NDArray[np.bool_], two: Ball, one: Ball) -> Ball:
    which = twice.reshape(-1, *([1] * (two.mid.ndim - 1)))
    return Ball(np.where(which, two.mid, one.mid), np.where(which, two.rad, one.rad))


def _in_time(
    first: Ball,
    second: Ball,
    speed: Ball,
    bend: Ball,
    joint: NDArray[np.int64],
    twice: NDArray[np.bool_],
) -> Ball:
    """Velocity q′/t′, or acceleration (q″t′ − q′t″)/t′³."""
    a, b = _own(first, joint), _own(second, joint)
    return _chosen(twice, _over(b * speed - a * bend, speed, 3), _over(a, speed, 1))


def _by_waypoint(
    first: Ball, second: Ball, speed: Ball, bend: Ball, twice: NDArray[np.bool_]
) -> Ball:
    t, u = speed.reshape(-1, 1), bend.reshape(-1, 1)
    return _chosen(twice, _over(second * t - first * u, speed, 3), _over(first, speed, 1))


def _by_duration(
    a: Ball, b: Ball, rate: Ball, bend_rate: Ball, speed: Ball, bend: Ball, twice: NDArray[np.bool_]
) -> Ball:
    """Gradients of q′/t′ and (q″t′ − q′t″)/t′³ by the durations, which t′ and t″ are linear in."""
    p, r = a.reshape(-1, 1), b.reshape(-1, 1)
    minus = Ball.exact(np.full((1, 1), -1.0))
    three = Ball.exact(np.full((1, 1), -3.0))
    numerator = (b * speed - a * bend).reshape(-1, 1)
    two = _over(r * rate - p * bend_rate, speed, 3) + _over(three * numerator * rate, speed, 4)
    return _chosen(twice, two, _over(minus * p * rate, speed, 2))
