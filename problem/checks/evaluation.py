"""True peak ratios of many duration vectors at once, and what follows for a box of way-points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..curves import Asked, Extremum, PeakGradients, Trajectory, as_durations
from ..errors import TrajgapError
from ..limits import USUAL, Limits, half_range
from ..problem import Problem
from .checker import TOLERANCE
from .one_sided import one_sided_sizes


@dataclass(frozen=True, eq=False)
class Evaluation:
    """True peak ratios of a batch of duration vectors."""

    ratios: Array
    """Shape (batch, joints, orders); max over t of |v|/V, |a|/A, |j|/J and, if it is limited, of
    snap, each by the limit on its side; 0 where there is no limit, inf if a duration is not
    positive and finite."""
    _reach: Callable[[], Array] | None = field(default=None, repr=False)

    @property
    def positions_limited(self) -> bool:
        """Whether some joint has a position limit."""
        return self._reach is not None

    @cached_property
    def positions(self) -> Array:
        """How far each joint goes towards its position limits, shape (batch, joints).

        As `Peak.ratio`: 1 at a limit, above 1 beyond it; −inf if there is none. No uniform
        stretch changes it where the curve is homogeneous, and `stretch` leaves it out. Computed
        on first use.
        """
        return np.full(self.ratios.shape[:2], -np.inf) if self._reach is None else self._reach()

    @cached_property
    def stretch(self) -> Array:
        """c* of each vector, shape (batch,)."""
        ratios = self.ratios
        top = ratios[:, 0].copy()
        for j in range(1, ratios.shape[1]):  # far quicker than max() along a middle axis
            np.maximum(top, ratios[:, j], out=top)
        return _stretch(top)


def _stretch(ratios: Array) -> Array:
    """The largest of the r-th roots of ratios, the last axis by order from 1."""
    found = np.maximum(ratios[..., 0], np.maximum(np.sqrt(ratios[..., 1]), np.cbrt(ratios[..., 2])))
    for r in range(USUAL, ratios.shape[-1]):
        found = np.maximum(found, ratios[..., r] ** (1.0 / (r + 1)))
    return np.asarray(found)


_Question = tuple[Array, Array, Asked, bool]
"""Values, limits, which peaks are wanted, and whether no quotient of them can be undefined."""


def _ratios(problem: Problem, question: _Question, durations: Array) -> Array:
    """Peaks by their limits."""
    values, limits, asked, plain = question
    peaks = problem.curve.batch_reach(values, durations, asked)[:, 0]
    if plain:
        peaks /= limits
        return peaks
    with np.errstate(invalid="ignore", divide="ignore"):
        peaks /= limits
    peaks[np.isnan(peaks)] = 0.0  # 0/0 is kept
    return peaks


def evaluate(problem: Problem, durations: ArrayLike, nodal: ArrayLike | None = None) -> Evaluation:
    """Exact peak ratios for many duration vectors at once, and how far positions go.

    Parameters
    ----------
    durations : array_like, shape (batch, segments)
        Duration vectors, s.
    nodal : array_like, shape (free, joints), optional
        Free derivatives, the same for every vector.

    Raises
    ------
    TrajgapError
        If the shape is not (batch, segments).
    """
    try:
        h = np.asarray(durations, dtype=np.float64)
    except (TypeError, ValueError):
        raise TrajgapError("durations: not numbers; give seconds, (batch, segments)") from None
    extra = None if nodal is None else np.asarray(nodal, dtype=np.float64)
    asked = _positions_asked(problem) if extra is None else _asked_of(problem, extra)
    reach = None if asked is None else partial(_reached, problem, asked, h.copy())
    if problem.limits.uneven:
        return Evaluation(_uneven_ratios(problem, h, extra), reach)
    question = _fixed_question(problem) if extra is None else _question(problem, extra)
    return Evaluation(_ratios(problem, question, h), reach)


def keeps_limits(problem: Problem, durations: Array, tolerance: float) -> NDArray[np.bool_]:
    """Whether each of many duration vectors keeps every limit, as `evaluate` says.

    Parameters
    ----------
    durations : ndarray, shape (batch, segments)
        s.
    tolerance : float
        Relative excess over a limit that still counts as keeping it.

    Returns
    -------
    ndarray of bool, shape (batch,)
        The condition of a death penalty.
    """
    if problem.limits.uneven:
        ratios = _uneven_ratios(problem, durations)
    else:
        ratios = _ratios(problem, _capped_question(problem, tolerance), durations)
    # One axis is gone through far quicker than two.
    kept = np.asarray((ratios <= 1 + tolerance).reshape(len(ratios), -1).all(axis=1))
    return _within_positions(problem, durations, kept, tolerance)


def _within_positions(
    problem: Problem, durations: Array, kept: NDArray[np.bool_], tolerance: float
) -> NDArray[np.bool_]:
    """Which of the vectors that keep all other limits keep those of position too."""
    asked = _positions_asked(problem)
    if asked is None or not kept.any():
        return kept
    within = kept.copy()
    within[kept] = (_reached(problem, asked, durations[kept]) <= 1 + tolerance).all(axis=1)
    return within


@dataclass(frozen=True, eq=False)
class _PositionsAsked:
    """The position limits of a problem beside what its curve knows of the way-points."""

    values: Array
    """From `Curve.motion_values`."""
    wanted: NDArray[np.bool_]
    """Shape (joints,)."""
    room: Array
    half: Array
    """Shape (joints, 2). Way from the first way-point to the lower and the upper limit, and what an
    excess beyond it is set beside."""


def _asked_of(problem: Problem, nodal: Array | None) -> _PositionsAsked | None:
    limits, q = problem.limits, problem.waypoints
    if not limits.limits_position:
        return None
    ends = np.stack([limits.position_lower, limits.position_upper], axis=1)
    half = [[half_range(low, high, limit) for limit in (low, high)] for low, high in ends]
    return _PositionsAsked(
        values=problem.curve.motion_values(q, nodal),
        wanted=np.asarray(np.isfinite(ends).any(axis=1)),
        room=ends - q[0][:, None],
        half=np.array(half),
    )


@lru_cache(maxsize=64)
def _positions_asked(problem: Problem) -> _PositionsAsked | None:
    """Keyed by the problem's identity, as `_fixed_question`; None if no position is limited."""
    return _asked_of(problem, None)


def _reached(problem: Problem, asked: _PositionsAsked, durations: Array) -> Array:
    """The larger ratio of both limits, shape (batch, joints), as the checker's; −inf for none."""
    # The first way-point is at 0, and among the positions.
    sides = Asked(asked.wanted[:, None], (-1.0, 1.0), least=0)
    reach = problem.curve.batch_reach(asked.values, durations, sides)[..., 0]
    ranges = reach.swapaxes(1, 2) * sides.sides
    with np.errstate(invalid="ignore", divide="ignore"):
        excess = np.array([-1.0, 1.0]) * (ranges - asked.room)
        ratios = 1.0 + excess / asked.half
    # A range of no width is kept by what stands there.
    narrow = np.where(excess > 0, np.inf, 0.0)
    ratios = np.where(asked.half > 0, ratios, narrow)
    ratios = np.where(np.isfinite(asked.room), ratios, -np.inf)
    return np.asarray(ratios.max(axis=2))


def _uneven_ratios(problem: Problem, h: Array, nodal: Array | None = None) -> Array:
    """The larger ratio of both sides, shape (batch, joints, orders)."""
    sides = problem.limits.sides
    wanted = np.isfinite(sides)
    peaks = problem.curve.batch_sides(problem.waypoints, h, wanted, nodal)
    with np.errstate(invalid="ignore", divide="ignore"):
        found = peaks / np.where(wanted, sides, 1.0)[:, None]
    found[np.isnan(found)] = 0.0  # 0/0 is kept
    ratios = np.asarray(found.max(axis=0))
    if problem.limits.braking.any():
        _put_braking(problem, h, nodal, ratios)
    return ratios


def _put_braking(problem: Problem, h: Array, nodal: Array | None, ratios: Array) -> None:
    """Ratios of accelerations where deceleration has a limit of its own, vector by vector."""
    limits, joints = problem.limits, np.flatnonzero(problem.limits.braking)
    sizes = np.stack([limits.ends("acceleration")[1], limits.deceleration])[:, joints]
    for k in np.flatnonzero(np.isfinite(ratios).all(axis=(1, 2))).tolist():
        motion = problem.curve.fitted(problem.waypoints, h[k], nodal)
        v, a = (motion.derivatives(r)[:, :, joints] for r in (1, 2))
        parts = v.shape[1:]
        tops = one_sided_sizes(v.reshape(len(v), -1), a.reshape(len(a), -1))
        ratios[k, joints, 1] = (tops.reshape(2, *parts).max(axis=1) / sizes).max(axis=0)


def _question(problem: Problem, nodal: Array | None) -> _Question:
    limits = problem.limits.derivatives
    wanted = np.isfinite(limits)
    values = problem.curve.motion_values(problem.waypoints, nodal)
    # A peak that is not wanted is 0, or inf if a duration is not positive: so is its ratio.
    divisors = np.where(wanted, limits, 1.0)
    return values, divisors, Asked(wanted), bool((divisors > 0).all())


@lru_cache(maxsize=64)
def _fixed_question(problem: Problem) -> _Question:
    """Keyed by the problem's identity: a swarm asks the same problem thousands of times."""
    return _question(problem, None)


@lru_cache(maxsize=64)
def _capped_question(problem: Problem, tolerance: float) -> _Question:
    """The same for what only asks whether limits are kept."""
    values, divisors, asked, plain = _fixed_question(problem)
    caps = np.where(asked.wanted, (1 + tolerance) * divisors, np.inf)
    return values, divisors, replace(asked, caps=caps) if plain else asked, plain


def worst_ratios(problem: Problem, trajectory: Trajectory) -> Array:
    """By how much each segment would have to be stretched, were it alone."""
    worst = np.zeros(len(trajectory.durations))
    below, above = problem.limits.sides
    for r in range(1, 1 + below.shape[1]):
        wanted = np.isfinite(below[:, r - 1]) | np.isfinite(above[:, r - 1])
        if not wanted.any():
            continue
        places, values = trajectory.turns(r)
        limit = np.where(values > 0.0, above[:, r - 1], below[:, r - 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(wanted & (limit > 0.0), np.abs(values) / limit, 0.0)
        ratio = np.where(np.isnan(places), 0.0, ratio)
        worst = np.maximum(worst, ratio.max(axis=(0, 2)) ** (1.0 / r))
    for j in np.flatnonzero(problem.limits.braking):
        v, a = (trajectory.derivatives(r)[:, :, j] for r in (1, 2))
        own = problem.limits.ends("acceleration")[1][j], problem.limits.deceleration[j]
        worst = np.maximum(worst, np.sqrt(one_sided_sizes(v, a).T / own).max(axis=1))
    return worst


def reachable_total(
    problem: Problem, durations: ArrayLike, lower: ArrayLike, upper: ArrayLike
) -> float | None:
    """A total with which these durations, stretched, keep the limits for every way-point in a box.

    For fixed durations the curve is linear in the way-points, so its peaks over the box are at
    most those at ``problem.waypoints`` plus, for each way-point, its deviation times the peaks of
    the cardinal curve (that way-point 1, the others 0).

    Parameters
    ----------
    problem : Problem
        Its curve must be determined and homogeneous.
    durations : array_like, shape (segments,)
        s.
    lower, upper : array_like, shape (way-points, joints)
        Box around ``problem.waypoints``, rad.

    Returns
    -------
    float or None
        An upper bound, s, on the optimum of every problem in the box, rounding errors of the
        peaks included; None if no stretch is known to repair all of them.
    """
    h = as_durations(durations, problem.segments)
    q, points = problem.waypoints, len(problem.waypoints)
    plain = not problem.curve.free and problem.curve.homogeneous
    if not plain or problem.limits.limits_position:
        return None
    if problem.limits.uneven:
        problem = replace(problem, limits=problem.limits.narrow)
    away = np.maximum(np.asarray(upper) - q, q - np.asarray(lower))
    limits = problem.limits.derivatives
    unlimited = Limits(joints=points)
    cardinal = replace(
        problem,
        waypoints=np.eye(points),
        limits=unlimited.with_derivatives(np.ones((points, limits.shape[1]))),
        joints=(),
        linear=(),
    )
    unit = evaluate(cardinal, h[None]).ratios[0]
    own = evaluate(problem, h[None]).ratios[0]
    moves = away.T @ unit
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = own + np.where(np.isfinite(limits), moves / limits, 0.0)
    if not np.isfinite(ratios).all():
        return None
    slack = 1.0 + TOLERANCE
    stretch = max(1.0, float(_stretch(ratios).max()) * slack)
    stretched = h * stretch
    inside = (stretched * slack >= problem.duration_lower).all()
    if not inside or (stretched > problem.duration_upper * slack).any():
        return None
    return float(stretched.sum())


def peak_gradients(
    problem: Problem,
    durations: Array,
    points: list[Extremum],
    nodal: Array | None = None,
) -> PeakGradients:
    """Gradients of the values at ``points``, extrema of the trajectory of these durations.

    Parameters
    ----------
    durations : ndarray, shape (segments,)
    points : list of Extremum
        Local extrema or end points, as `extrema` returns them.
    nodal : ndarray, shape (free, joints), optional

    Returns
    -------
    PeakGradients
        With respect to the way-points, with everything else fixed, including parameters from
        chords.
    """
    return problem.curve.value_gradients(problem.waypoints, durations, points, nodal)
