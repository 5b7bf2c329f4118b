"""The optimum through the same way-points over all C1 joint curves: an upper estimate."""

from __future__ import annotations

import math
import pickle
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....problem import TOLERANCE, Problem, TrajgapError
from ...clock import seconds_left, time_up
from ...optimum import Evidence
from .local import LocalQuestion, local_optimum, starting_points
from .reach import profile

STARTS = 6
"""Standing still at every way-point, and five random ones: the problem is not convex."""


@dataclass(frozen=True, eq=False)
class AnyCurveEstimate:
    """Best known total over all C1 curves through the way-points within v and a limits.

    Attributes
    ----------
    total_time : float or None
        s; an upper estimate of the optimum, never a bound below it. None if not computed.
    durations : ndarray, shape (way-points − 1,), or None
        Between way-points, s; virtual breaks of the interpolant do not count.
    nodal_velocities : ndarray, shape (way-points, joints), or None
        rad/s; NaN for moving joints without an acceleration limit, whose velocities are open.
    attained : bool
        False if curves only come arbitrarily close to the total.
    why : str or None
        Why nothing was computed, or why the total is not attained.
    starts, starts_at_best : int
    totals : tuple of float
        Totals of the starts that led to an answer, s.
    """

    total_time: float | None
    durations: NDArray[np.float64] | None = None
    nodal_velocities: NDArray[np.float64] | None = None
    attained: bool = False
    why: str | None = None
    starts: int = 0
    starts_at_best: int = 0
    totals: tuple[float, ...] = field(default=(), repr=False)

    @property
    def evidence(self) -> Evidence:
        """Best known, or none without a value."""
        return Evidence.NONE if self.total_time is None else Evidence.BEST_KNOWN

    def __str__(self) -> str:
        if self.total_time is None or self.durations is None:
            return f"optimum over any curve: not computed, {self.why}"
        shown = ", ".join(f"{d:.6f}" for d in self.durations)
        lines = [
            f"optimum over any curve {self.total_time:.9f} s  [{self.evidence}, an upper estimate]",
            f"durations              {shown} s",
        ]
        if not self.attained:
            lines.append(f"not attained           {self.why}")
        return "\n".join(lines)


def estimate_any_curve(
    problem: Problem,
    *,
    starts: int = STARTS,
    seed: int = 0,
    initial: ArrayLike | None = None,
) -> AnyCurveEstimate:
    """Least total time through the way-points over all C1 curves with |v| ≤ V and |a| ≤ A.

    The joints share their segment durations and nothing else; acceleration may jump. From the
    interpolant, only the velocities prescribed at the two ends are used. A segment in which nothing
    moves, and whose duration has no lower bound, takes no time.

    Parameters
    ----------
    problem : Problem
        Its coupling is ignored: durations are shared.
    starts : int
        Number of starts: rest at every way-point first, then random ones.
    seed : int
        Seed of the random starts.
    initial : array_like, shape (starts, segments of the interpolant), optional
        Durations to start from as well, s.

    Returns
    -------
    AnyCurveEstimate
        Never raises for a problem without answer: `why` says the reason.

    Raises
    ------
    TrajgapError
        If ``initial`` has the wrong shape.

    Notes
    -----
    In a segment a joint makes the displacement Δq between nodal velocities v₀ and v₁ if and only
    if |v₁ − v₀| ≤ A h, D(p) ≥ Δq for some p ≤ V, and the same mirrored (`reach.furthest` says
    why). So durations, nodal velocities and peaks p are the only unknowns. The problem
    is not convex in them: several starts, and nothing is claimed below the value.
    """
    given = _initial(problem, initial)
    reason = _not_covered(problem)
    if reason is not None:
        return AnyCurveEstimate(None, why=reason)
    matter = _matter(problem)
    question = _question(problem, matter)
    short = np.flatnonzero(question.lower > question.upper * (1 + TOLERANCE))
    if short.size:
        return AnyCurveEstimate(
            None, why=f"segment {short[0] + 1} cannot be traversed within its upper bound"
        )
    bounded = np.isfinite(question.acceleration)
    durations = question.lower.copy()
    totals: tuple[float, ...] = ()
    count = 0
    velocities = np.full(problem.waypoints.shape, np.nan)
    moving = ~((question.steps == 0).all(axis=1) & (question.lower == 0))
    first, last = question.ends[:, bounded]
    if bounded.any() and not moving.any():
        if (np.abs(first - last) > 0).any():
            still = "nothing moves between the way-points, but the two end velocities differ"
            return AnyCurveEstimate(None, why=still)
        still_speed = np.nan_to_num(np.where(np.isfinite(first), first, last))
        velocities[:, np.flatnonzero(matter)[bounded]] = still_speed
    elif bounded.any():
        core = replace(
            question,
            steps=question.steps[moving][:, bounded],
            velocity=question.velocity[bounded],
            acceleration=question.acceleration[bounded],
            lower=question.lower[moving],
            upper=question.upper[moving],
            ends=question.ends[:, bounded],
        )
        points = starting_points(core, starts, np.random.default_rng(seed), given[:, moving])
        # Where the time is limited an answer depends on the clock, and is not kept.
        kept = seconds_left() == math.inf
        answers, count = _kept(pickle.dumps((core, points))) if kept else _searched(core, points)
        if not answers:
            return AnyCurveEstimate(
                None, why=f"none of {count} starts led to an answer", starts=count
            )
        totals = tuple(float(h.sum()) for h, _ in answers)
        h, v = answers[int(np.argmin(totals))]
        durations[moving] = h
        nodes = np.concatenate([[0], np.cumsum(moving)])
        velocities[:, np.flatnonzero(matter)[bounded]] = v[nodes]
    outside = _outside_range(problem, durations, velocities)
    if outside is not None:
        return AnyCurveEstimate(None, why=outside, starts=count)
    velocities[:, ~_restless(problem)] = 0.0
    total = float(durations.sum())
    why = _not_attained(question, durations)
    best = sum(t <= total * (1 + 1e-6) for t in totals)  # as near they count as the same
    return AnyCurveEstimate(total, durations, velocities, why is None, why, count, best, totals)


_Answer = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Durations and nodal velocities of a local optimum."""


def _searched(
    question: LocalQuestion, points: NDArray[np.float64]
) -> tuple[tuple[_Answer, ...], int]:
    """The answers of all starts that led to one, and how many were begun."""
    answers, count = [], 0
    for h in points:
        if count and time_up():
            break
        count += 1
        if (answer := local_optimum(question, h)) is not None:
            answers.append(answer)
    return tuple(answers), count


@lru_cache(maxsize=64)
def _kept(packed: bytes) -> tuple[tuple[_Answer, ...], int]:
    """Found once a process: an audit asks under each reading, of which a case has some dozen."""
    return _searched(*pickle.loads(packed))


def _merge(problem: Problem, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values per segment of the interpolant added up between way-points, along the last axis."""
    breaks = problem.curve.waypoint_breaks
    return np.add.reduceat(values, breaks[:-1], axis=-1)


def _initial(problem: Problem, initial: ArrayLike | None) -> NDArray[np.float64]:
    if initial is None:
        return np.empty((0, problem.waypoints.shape[0] - 1))
    h = np.atleast_2d(np.asarray(initial, dtype=np.float64))
    if h.ndim != 2 or h.shape[1] != problem.segments or not (np.isfinite(h) & (h > 0)).all():
        raise TrajgapError(
            f"initial: expected positive durations of shape (starts, {problem.segments}), "
            f"got shape {h.shape}"
        )
    return _merge(problem, h)


def _ends(problem: Problem) -> NDArray[np.float64]:
    """Velocities prescribed at start and end, shape (2, joints); NaN if they are free."""
    found = np.full((2, problem.waypoints.shape[1]), np.nan)
    for side, end in enumerate(problem.curve.ends):
        if 1 in dict(end):
            found[side] = dict(end)[1]
    return found


def _restless(problem: Problem) -> NDArray[np.bool_]:
    """Joints that cannot simply stay where they are."""
    moves = np.ptp(problem.waypoints, axis=0) > 0
    return np.asarray(moves | (np.nan_to_num(_ends(problem)) != 0).any(axis=0))


def _matter(problem: Problem) -> NDArray[np.bool_]:
    """Joints that have to move and have a limit."""
    limited = np.isfinite(problem.limits.velocity) | np.isfinite(problem.limits.acceleration)
    return np.asarray(_restless(problem) & limited)


def _not_covered(problem: Problem) -> str | None:
    """The reason why there is no value, as far as it is known before solving."""
    limits, restless = problem.limits, _restless(problem)
    if limits.braking.any():
        return "deceleration has a limit of its own; this optimum is computed within one size only"
    if limits.uneven:
        return "lower and upper limits differ; this optimum is computed within equal ones only"
    higher = limits.limited[restless][:, 2:].any(axis=0)
    if higher.any():
        highest = limits.quantities[2 + int(np.argmax(higher))]
        only = "the optimum over all curves is computed for v and a limits only"
        return f"{highest} is limited; {only}"
    for name, values in (("velocity", limits.velocity), ("acceleration", limits.acceleration)):
        stuck = np.flatnonzero(restless & (values == 0))
        if stuck.size:
            return f"joint {problem.joints[stuck[0]]} moves, but its {name} limit is 0"
    if not _matter(problem).any():
        return "nothing that moves is limited" if restless.any() else "nothing moves"
    for end, v in zip(("start", "end"), _ends(problem), strict=True):
        fast = np.flatnonzero(np.abs(v) > limits.velocity)
        if fast.size:
            joint = problem.joints[fast[0]]
            return f"the velocity prescribed at the {end} exceeds the limit of joint {joint}"
    low, high = limits.position_lower, limits.position_upper
    if ((problem.waypoints < low) | (problem.waypoints > high)).any():
        return "a way-point lies outside the position limits"
    return None


def _question(problem: Problem, matter: NDArray[np.bool_]) -> LocalQuestion:
    steps = np.diff(problem.waypoints, axis=0)[:, matter]
    velocity = problem.limits.velocity[matter]
    return LocalQuestion(
        steps=steps,
        velocity=velocity,
        acceleration=problem.limits.acceleration[matter],
        lower=np.maximum(
            _merge(problem, problem.duration_lower), (np.abs(steps) / velocity).max(axis=1)
        ),
        upper=_merge(problem, problem.duration_upper),
        ends=_ends(problem)[:, matter],
    )


def _outside_range(
    problem: Problem, durations: NDArray[np.float64], velocities: NDArray[np.float64]
) -> str | None:
    """Say that the curve found leaves the position limits; the search does not know them."""
    limits = problem.limits
    for j in np.flatnonzero(np.isfinite(velocities[0])):
        low, high = limits.position_lower[j], limits.position_upper[j]
        if np.isinf(low) and np.isinf(high):
            continue
        for k in np.flatnonzero(durations > 0):
            start, end = problem.waypoints[k : k + 2, j]
            v0, v1 = velocities[k : k + 2, j]
            top, bend = limits.velocity[j], limits.acceleration[j]
            curve = profile(end - start, v0, v1, durations[k], top, bend)
            least, most = curve.position_range()
            slack = TOLERANCE * max(1.0, abs(start))
            if start + least < low - slack or start + most > high + slack:
                return (
                    f"position is limited, and the curve found leaves the range of joint "
                    f"{problem.joints[j]}; optima that keep such limits are not computed"
                )
    return None


def _not_attained(question: LocalQuestion, durations: NDArray[np.float64]) -> str | None:
    """Say why curves only approach the total, or None if one attains it."""
    vanishing = np.flatnonzero(durations == 0)
    if vanishing.size:
        return f"nothing moves in segment {vanishing[0] + 1}: its duration goes to 0"
    for j in np.flatnonzero(np.isinf(question.acceleration)):
        # A joint that needs its full speed all through a segment has it at both of its ends.
        steps = question.steps[:, j]
        full = np.abs(steps) >= question.velocity[j] * durations * (1 - TOLERANCE)
        wanted = np.where(full, np.sign(steps) * question.velocity[j], np.nan)
        first, last = question.ends[:, j]
        before, after = np.append(first, wanted), np.append(wanted, last)
        if (np.abs(before - after) > TOLERANCE * question.velocity[j]).any():
            return "only velocity is limited: it would have to jump between its limits"
    return None
