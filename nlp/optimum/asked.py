"""What is asked of `solve`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Problem, TrajgapError, evaluate
from .starts import stretching


@dataclass(frozen=True, eq=False)
class Ask:
    """The arguments of `solve`."""

    starts: int
    seed: int
    initial: Array | None
    known: Array
    """Durations that somebody has, and after them the same stretched to be tight, s."""
    known_nodal: Array | None
    lower: float = 0.0
    """A proved lower bound of the total, s."""


def asked(
    problem: Problem,
    starts: int,
    seed: int,
    initial: ArrayLike | None,
    known: ArrayLike | None,
    known_nodal: ArrayLike | None,
    lower: float,
) -> Ask:
    """The arguments of `solve`, read; a clear refusal of what has the wrong shape."""
    if starts < 1:
        raise TrajgapError(f"starts: must be 1 or more, got {starts}")
    points = np.empty((0, problem.segments)) if known is None else vectors(problem, "known", known)
    nodal = None if known_nodal is None else np.asarray(known_nodal, dtype=np.float64)
    wanted = (len(points), problem.curve.free, len(problem.joints))
    if nodal is not None and nodal.shape != wanted:
        raise TrajgapError(f"known_nodal: expected shape {wanted}, got {nodal.shape}")
    points, nodal = _with_tight(problem, points, nodal)
    first = None if initial is None else vectors(problem, "initial", initial)
    return Ask(starts, seed, first, points, nodal, lower)


def _with_tight(problem: Problem, known: Array, nodal: Array | None) -> tuple[Array, Array | None]:
    """Known motions, and after them each one stretched so that it just keeps its limits.

    A printed motion that exceeds a limit by its last digit is worth what its repair is worth.
    """
    if not len(known) or not problem.curve.homogeneous or (problem.curve.free and nodal is None):
        return known, nodal
    problem = stretching(problem)
    if nodal is None:
        stretch = evaluate(problem, known).stretch
    else:
        each = zip(known, nodal, strict=True)
        stretch = np.array([evaluate(problem, h[None], v).stretch[0] for h, v in each])
    usable = np.isfinite(stretch) & (stretch > 0) & (stretch != 1.0)
    factor = stretch[usable, None]
    inside = np.clip(known[usable] * factor, problem.duration_lower, problem.duration_upper)
    if nodal is not None:
        orders = np.array([r for _, r in problem.piecewise.free_derivatives])
        values = nodal[usable] / (factor**orders)[:, :, None]
        nodal = np.concatenate([nodal, values])
    return np.vstack([known, inside]), nodal


def vectors(problem: Problem, name: str, given: ArrayLike) -> Array:
    """Durations that are given to `solve`, shape (vectors, segments), or a clear refusal."""
    points = np.atleast_2d(np.asarray(given, dtype=np.float64))
    if points.size == 0:
        return np.empty((0, problem.segments))
    if points.shape[1:] != (problem.segments,) or not (np.isfinite(points) & (points > 0)).all():
        raise TrajgapError(
            f"{name}: expected shape (starts, {problem.segments}) of positive durations, "
            f"got {np.asarray(given).shape}"
        )
    return points
