"""Handling of infeasible durations: the papers' death penalty, or a uniform stretch as repair."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..problem import TOLERANCE, Array, Problem, TrajgapError, evaluate
from .objective import DeathPenalty
from .settings import checked


class Handling(StrEnum):
    """What the objective does with a vector that breaks a limit."""

    DEATH_PENALTY = "death-penalty"
    """It gets the penalty, as the papers print."""
    STRETCH = "stretch"
    """It stands for its durations times max(1, c*), the shortest stretch that repairs it."""
    RESCALE = "rescale"
    """Every vector stands for its durations times c*: one that could be shorter is shortened."""


class Judge(Protocol):
    """An objective that says what a position stands for."""

    def __call__(self, durations: Array, /) -> Array:
        """Fitness of positions, shape (batch, segments), as (batch,)."""

    def decode(self, durations: Array, /) -> Array:
        """Segment durations that a batch of positions stands for, of the same shape."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Σ t of the durations stretched uniformly until every limit is kept.

    Stretching all durations by c divides velocity, acceleration and jerk by c, c², c³; c* is the
    factor that makes a vector exactly tight. It has no parameter, and it needs one evaluation, as
    the death penalty does. The search goes on from the position as it stands, only its judgement
    changes: so it serves every algorithm alike and leaves its equations as printed.

    Parameters
    ----------
    problem : Problem
        All joints share one duration vector, whatever its coupling says.
    penalty : float
        Fitness where no stretch helps, s: a duration of 0 or less, stretched durations outside the
        problem's bounds, a joint with limit 0 that moves, a path beyond a position limit, which
        no stretch moves.
    shorten : bool
        Whether a vector with c* < 1 is shortened too.

    Raises
    ------
    TrajgapError
        As `DeathPenalty`, or if a prescribed derivative is not 0: stretching would change it.

    Notes
    -----
    Peaks of the stretched vector are at the limit up to rounding, which grows with the spread of
    the durations: below 1e-10 for C4 quintic splines with durations that differ 1,000-fold, near
    the checker's tolerance where they differ 100,000-fold. The checker remains the judge.
    """

    problem: Problem
    penalty: float = np.inf
    shorten: bool = False

    def __post_init__(self) -> None:
        DeathPenalty(self.problem, self.penalty)
        if not self.problem.curve.homogeneous:
            raise TrajgapError(
                "stretch: a prescribed derivative is not 0, and stretching would change it; use "
                "the death penalty"
            )

    def _stretched(self, durations: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Stretched vectors, and whether each is admissible."""
        found = evaluate(self.problem, durations)
        factor = found.stretch
        if not self.shorten:
            factor = np.maximum(factor, 1.0)
        with np.errstate(invalid="ignore", over="ignore"):
            stretched = durations * factor[:, None]
        lower, upper = self.problem.duration_lower, self.problem.duration_upper
        within = (stretched >= lower) & (stretched <= upper)
        proper = (durations > 0) & (stretched > 0) & np.isfinite(stretched)
        kept: NDArray[np.bool_] = np.all(within & proper, axis=1)
        if found.positions_limited:
            kept &= (found.positions <= 1 + TOLERANCE / 2).all(axis=1)
        return stretched, kept

    def decode(self, durations: Array) -> Array:
        """Durations that positions stand for; a position that no stretch repairs is left as it is.

        Parameters
        ----------
        durations : ndarray, shape (batch, segments)
            In s.

        Returns
        -------
        ndarray, shape (batch, segments)
            In s.
        """
        stretched, kept = self._stretched(durations)
        return np.where(kept[:, None], stretched, durations)

    def __call__(self, durations: Array) -> Array:
        """Total of the durations that each position stands for.

        Parameters
        ----------
        durations : ndarray, shape (batch, segments)
            In s.

        Returns
        -------
        ndarray, shape (batch,)
            In s.
        """
        stretched, kept = self._stretched(durations)
        fitness = np.full(durations.shape[0], self.penalty)
        fitness[kept] = stretched[kept].sum(axis=1)
        return fitness


def judge_of(problem: Problem, penalty: float, handling: str = Handling.DEATH_PENALTY) -> Judge:
    """Objective of a problem under one handling of infeasible durations.

    Parameters
    ----------
    problem : Problem
    penalty : float
        Fitness of what remains infeasible, s.
    handling : str
        "death-penalty", "stretch" or "rescale".

    Raises
    ------
    TrajgapError
        If the handling is unknown, or the objective cannot judge the problem.
    """
    chosen = checked(Handling, "objective", handling)
    if chosen is Handling.DEATH_PENALTY:
        return DeathPenalty(problem, penalty)
    return Stretch(problem, penalty, shorten=chosen is Handling.RESCALE)


def compile_judge(problem: Problem, handling: str = Handling.DEATH_PENALTY) -> None:
    """Compile what judges vectors of a problem, so that it lies on disk.

    Processes that start afterwards find it there; otherwise each of them compiles it once more.

    Parameters
    ----------
    problem : Problem
    handling : str
        As `judge_of`.

    Raises
    ------
    TrajgapError
        As `judge_of`.
    """
    ones = np.ones((2, problem.segments))
    judge_of(problem, np.inf, handling)(ones)
