"""What is asked of `solve`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Problem, TrajgapError
from .formulation import Form


@dataclass(frozen=True, eq=False)
class Ask:
    """The arguments of `solve`."""

    starts: int
    seed: int
    initial: Array | None
    known: Array
    known_nodal: Array | None
    form: Form | None
    until: float
    """Reading of the monotonic clock after which no further start is begun."""
    lower: float = 0.0
    """A proved lower bound of the total, s."""


def asked(
    problem: Problem,
    starts: int,
    seed: int,
    initial: ArrayLike | None,
    known: ArrayLike | None,
    known_nodal: ArrayLike | None,
    form: Form | None,
    until: float,
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
    first = None if initial is None else vectors(problem, "initial", initial)
    return Ask(starts, seed, first, points, nodal, form, until, lower)


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
