"""A rigorous lower bound of the worst ratio over a box of durations and way-points."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...problem import QUANTITIES, Array, Curve, Interpolant, Problem
from ...problem.curves import StretchedUniformBSpline, TimedUniformBSpline
from .balls import EPS, Ball, enclose_spline, place_basis, quotient_power, raised
from .places import LimitRows, linear_program, rows_at
from .uniform import Centred, centred_stretched, centred_timed

MOST_BOXES = 100
"""Boxes after which a bisection gives up: the bound so far holds, and may not decide."""
_NAMES = ("position", *QUANTITIES)
"""Words for derivative orders 0 to 3."""


@dataclass(frozen=True)
class Place:
    """Where a limit is exceeded all over a box.

    Where several places share the proof, because easing one of them tightens another, this is the
    one that carries most of it.

    Attributes
    ----------
    joint : str or None
        Joint label; None for a segment duration outside its bounds.
    quantity : str
        "position", "velocity", "acceleration", "jerk" or "duration".
    segment : int
        Segment, from 0.
    s : float or None
        Place in the segment's own parameter, 0..1; None for a duration, and where only the mean
        speed between two way-points is known to be too high.
    lower_bound : float
        Rigorous lower bound of the worst ratio over the box.
    """

    joint: str | None
    quantity: str
    segment: int
    s: float | None
    lower_bound: float


@dataclass(frozen=True, eq=False)
class _MeanValue:
    """The rows' derivatives f over a box: f(centre) + by_duration·Δh + by_waypoint·Δq, in balls."""

    rows: LimitRows
    joint: NDArray[np.int64]
    value: Ball
    by_duration: Ball
    by_waypoint: Ball
    amplitude: Array
    radius: Array
    waypoint_radius: Array

    def forced(self, weights: Array) -> Array:
        """Lower bounds of t from sums of rows with ``weights`` ≥ 0, shape (sums, rows).

        t ≥ (Σ μ sign f − Σ μ offset)/Σ μ width holds whatever μ is; a sum whose right-hand side
        isn't positive forces nothing.
        """
        signed = Ball.exact(weights * self.rows.sign)
        plain = Ball.exact(weights)
        error = 2.0 * EPS * (np.abs(self.rows.offset) + self.rows.width)
        total = signed @ self.value - plain @ Ball(self.rows.offset, error)
        sway = raised((signed @ self.by_duration).magnitude() @ self.radius, self.radius.size)
        for j in np.unique(self.joint):
            part = Ball.exact(np.where(self.joint == j, signed.mid, 0.0))
            radius = self.waypoint_radius[:, j]
            sway = sway + (part @ self.by_waypoint).magnitude() @ radius
        sway = raised(sway, self.waypoint_radius.size + 2)
        low = np.nextafter(total.least() - sway, -np.inf)
        width = (plain @ Ball.exact(self.rows.width)).magnitude()
        return np.where(low > 0.0, np.nextafter(low / width, -np.inf), -np.inf)

    def moves_where_it_must_not(self) -> NDArray[np.bool_]:
        """LimitRows with limit 0 whose derivative is not 0 anywhere in the box, beyond rounding.

        The relative slack of 1e-9 exceeds the few roundings of this sum by far.
        """
        sway = self.by_duration.magnitude() @ self.radius
        sway += (self.by_waypoint.magnitude() * self.waypoint_radius.T[self.joint]).sum(axis=1)
        low = np.abs(self.value.mid) - self.value.rad - sway * (1.0 + 1e-9)
        derivative = np.array([e.order > 0 for e in self.rows.points])
        found: NDArray[np.bool_] = low > 1e-9 * self.amplitude
        found &= derivative & (self.rows.width == 0.0)
        return found


def _mean_value(problem: Problem, h: Ball, q: Ball, more: LimitRows | None) -> _MeanValue | None:
    """Enclose f and its gradient.

    By the durations the gradient holds over all of the box; by the way-points, in which f is
    linear for fixed durations, it is needed at the central durations only.
    """
    enclose = _ENCLOSURES.get(type(problem.curve))
    return None if enclose is None else enclose(problem, h, q, more)


def _polynomial_mean_value(
    problem: Problem, h: Ball, q: Ball, more: LimitRows | None
) -> _MeanValue | None:
    curve = problem.piecewise
    still = Ball.exact(h.mid)
    at_centre = enclose_spline(curve, still, Ball.exact(q.mid))
    over_box = enclose_spline(curve, h, q)
    if at_centre is None or over_box is None:
        return None
    rows = rows_at(replace(problem, waypoints=q.mid), h.mid)
    rows = rows if more is None else rows + more
    count = len(rows.points)
    if count == 0:
        return None
    each = np.arange(count)
    joint = np.array([e.joint for e in rows.points])
    segment = np.array([e.segment for e in rows.points])
    order = np.array([e.order for e in rows.points])
    basis = place_basis(curve, segment, order, np.array([e.s for e in rows.points]))
    one = Ball.exact(np.ones(count))
    scale = quotient_power(one, still[segment], order)
    value = (basis @ at_centre.coefficients)[each, joint] * scale
    amplitude = np.abs(basis.mid) @ np.abs(at_centre.coefficients.mid)
    by_waypoint = (basis @ at_centre.by_waypoint) * scale.reshape(-1, 1)
    scale = quotient_power(one, h[segment], order)
    size, n, joints = over_box.by_duration.mid.shape
    moved = (basis @ over_box.by_duration.reshape(size, n * joints)).reshape(count, n, joints)
    # f = φ·c/hʳ: the segment's own duration also enters by hʳ.
    fade = quotient_power(one, h[segment], np.ones_like(order)) * Ball.exact(order.astype(float))
    fade = fade * (basis @ over_box.coefficients)[each, joint]
    own = Ball.exact((segment[:, None] == np.arange(n)).astype(float))
    by_duration = (moved[each, :, joint] - own * fade.reshape(-1, 1)) * scale.reshape(-1, 1)
    return _MeanValue(
        rows,
        joint,
        value,
        by_duration,
        by_waypoint,
        amplitude[each, joint] * scale.mid,
        h.rad,
        q.rad,
    )


def _uniform_mean_value(
    centred: Callable[..., Centred],
    highest: int,
    problem: Problem,
    h: Ball,
    q: Ball,
    more: LimitRows | None,
) -> _MeanValue | None:
    rows = rows_at(replace(problem, waypoints=q.mid), h.mid)
    rows = rows if more is None else rows + more
    order = np.array([e.order for e in rows.points], dtype=np.int64)
    rows = rows.pick(np.flatnonzero((order >= 1) & (order <= highest)))
    if not rows.points:
        return None
    joint = np.array([e.joint for e in rows.points])
    segment = np.array([e.segment for e in rows.points])
    order = np.array([e.order for e in rows.points])
    place = np.array([e.s for e in rows.points])
    form = centred(len(q.mid), joint, segment, order, place, h, q)
    return _MeanValue(
        rows,
        joint,
        form.value,
        form.by_duration,
        form.by_waypoint,
        form.amplitude,
        h.rad,
        q.rad,
    )


def _timed_mean_value(
    problem: Problem, h: Ball, q: Ball, more: LimitRows | None
) -> _MeanValue | None:
    curve = problem.curve
    assert isinstance(curve, TimedUniformBSpline)
    centred = partial(centred_timed, natural=curve.natural_clock)
    return _uniform_mean_value(centred, 2, problem, h, q, more)


_ENCLOSURES: dict[
    type[Curve], Callable[[Problem, Ball, Ball, LimitRows | None], _MeanValue | None]
] = {
    Interpolant: _polynomial_mean_value,
    StretchedUniformBSpline: partial(_uniform_mean_value, centred_stretched, 3),
    TimedUniformBSpline: _timed_mean_value,
}
"""Kinds of curve whose derivatives are enclosed over a box, with the highest order that is; of any
other kind only the mean speed is known."""


@dataclass(frozen=True, eq=False)
class Bound:
    """A rigorous lower bound of the worst ratio over the durations of a box.

    Attributes
    ----------
    lower, upper : ndarray, shape (segments,)
        The box, s.
    value : float
        −inf if nothing was proved.
    place : Place or None
        The place that carries most of the proof.
    split : int
        The duration whose halving promises most.
    """

    lower: Array
    upper: Array
    value: float
    place: Place | None
    split: int


def bound_ratio(
    problem: Problem, lower: Array, upper: Array, waypoints: Ball, more: LimitRows | None = None
) -> Bound:
    """Bound the worst ratio from below over a box of durations and a ball of way-points.

    A linear program over the centred form proposes how to weigh the places; its answer is not
    trusted, but evaluated again in ball arithmetic (as Neumaier and Shcherbina, Math. Program. 99,
    2004, do for linear bounds). The limits themselves are taken as exact.

    Parameters
    ----------
    problem : Problem
        Its way-points are not used.
    lower, upper : ndarray, shape (segments,)
        Durations, s.
    waypoints : Ball, shape (way-points, joints)
        rad.
    more : LimitRows, optional
        Further places, beside the extrema at the centre.

    Returns
    -------
    Bound
    """
    h = Ball.between(lower, upper)
    coarse = _mean_speed(problem, lower, upper, waypoints)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        form = _mean_value(problem, h, waypoints, more)
        if form is None:
            return coarse
        fine = _best(problem, lower, upper, form)
    return fine if fine.value >= coarse.value else replace(coarse, split=fine.split)


def _mean_speed(problem: Problem, lower: Array, upper: Array, waypoints: Ball) -> Bound:
    """Bound from the mean speed between way-points, which some instant attains; any box will do."""
    breaks = problem.curve.waypoint_breaks
    most = problem.limits.widest[:, 0]
    speed = np.where(most > 0.0, most, np.inf)
    value, place = -np.inf, None
    for w in range(len(breaks) - 1):
        time = upper[breaks[w] : breaks[w + 1]].sum() * (1.0 + problem.segments * EPS)
        travel = waypoints[w + 1] - waypoints[w]
        way = np.abs(travel.mid) - travel.rad
        # Four roundings: the way, the product, the quotient and this factor.
        ratio = way / (time * speed) * (1.0 - 4.0 * EPS)
        j = int(np.argmax(ratio))
        if ratio[j] > max(value, 0.0):
            value = float(ratio[j])
            place = Place(problem.joints[j], "velocity", breaks[w], None, value)
    return Bound(lower, upper, value, place, int(np.argmax((upper - lower) / upper)))


def _best(problem: Problem, lower: Array, upper: Array, form: _MeanValue) -> Bound:
    rows = form.rows
    count = len(rows.points)
    alone = form.forced(np.eye(count))
    alone[rows.width == 0.0] = -np.inf
    alone[form.moves_where_it_must_not()] = np.inf
    alone[np.isnan(alone)] = -np.inf
    top = int(np.argmax(alone))
    value, weights = float(alone[top]), np.eye(count)[top]
    some = np.flatnonzero(rows.width > 0.0)
    remainder = form.by_duration.rad * form.radius
    wide = form.radius.any() or form.waypoint_radius.any()
    if value < np.inf and some.size and wide:
        found = _weights(form, some, remainder)
        if found is not None:
            shared = float(form.forced(found[None, :])[0])
            if shared > value:
                value, weights = shared, found
    heavy = int(np.argmax(weights * rows.width)) if value < np.inf else top
    e = rows.points[heavy]
    place = Place(problem.joints[e.joint], _NAMES[e.order], e.segment, e.s, value)
    loss = np.where(np.isfinite(remainder), remainder, 0.0)
    return Bound(lower, upper, value, place, int(np.argmax(weights @ loss)))


def _weights(form: _MeanValue, some: NDArray[np.int64], remainder: Array) -> Array | None:
    """Weights of the rows from the linear program; durations and way-points in units of radii.

    Row i asks for t ≥ (sign_i f_i − offset_i)/width_i, f_i in centred form. With x = (Δh, Δq) in
    units of the radii, |x| ≤ 1, and the radius of ∂f_i/∂h taken off as ``remainder``,

        t ≥ min over |x| ≤ 1 of max_i (level_i + slope_i·x).

    The program's multipliers λ ≥ 0, Σλ = 1, give Σ λ_i level_i − |Σ λ_i slope_i|₁, and `forced`
    takes μ_i = λ_i/width_i.
    """
    rows = form.rows.pick(some)
    width = rows.width[:, None]
    sign = rows.sign[:, None]
    level = rows.sign * form.value.mid[some] - rows.offset - remainder[some].sum(axis=1)
    by_duration = sign * form.by_duration.mid[some] * form.radius / width
    points, joints = form.waypoint_radius.shape
    by_waypoint = np.zeros((some.size, joints, points))
    own = form.joint[some]
    by_waypoint[np.arange(some.size), own] = (
        sign * form.by_waypoint.mid[some] * form.waypoint_radius.T[own] / width
    )
    slope = np.hstack([by_duration, by_waypoint.reshape(some.size, -1)])
    level = level / rows.width
    if not (np.isfinite(level).all() and np.isfinite(slope).all()):
        return None
    slope = slope[:, slope.any(axis=0)]
    edge = np.ones(slope.shape[1])
    solved = linear_program(level, slope, -edge, edge)
    if solved is None:
        return None
    weights = np.zeros(form.rows.width.size)
    weights[some] = solved[1] / rows.width
    return weights


def bound_by_bisection(
    problem: Problem, root: Bound, waypoints: Ball, target: float, more: LimitRows | None = None
) -> Bound:
    """Bisect the durations, the weakest box first, until the bound exceeds ``target``.

    Parameters
    ----------
    problem, waypoints, more
        As in `bound`.
    root : Bound
        The whole box.
    target : float
        Ratio to exceed.

    Returns
    -------
    Bound
        Of the weakest box that is left, valid for the whole of ``root``; after `MOST_BOXES` boxes
        it may not have reached the target.
    """
    heap: list[tuple[float, int, Bound]] = [(root.value, 0, root)]
    for number in range(0, MOST_BOXES, 2):
        weakest = heap[0][2]
        m = weakest.split
        cut = 0.5 * (weakest.lower[m] + weakest.upper[m])
        if weakest.value > target or not weakest.lower[m] < cut < weakest.upper[m]:
            break
        heapq.heappop(heap)
        for side in range(2):
            lower, upper = weakest.lower.copy(), weakest.upper.copy()
            (upper if side == 0 else lower)[m] = cut
            half = bound_ratio(problem, lower, upper, waypoints, more)
            if half.value < weakest.value:
                half = replace(half, value=weakest.value, place=weakest.place)
            heapq.heappush(heap, (half.value, number + side + 1, half))
    return heap[0][2]
