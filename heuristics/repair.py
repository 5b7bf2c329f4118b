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
    """Treatment of a vector that breaks a limit."""

    DEATH_PENALTY = "death-penalty"
    """It gets the penalty, as the papers print."""
    STRETCH = "stretch"
    """It represents its durations times max(1, c*), the shortest stretch that repairs it."""
    RESCALE = "rescale"
    """Every vector represents its durations times c*: one that could be shorter is shortened."""


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
    the death penalty does. The search continues from the unchanged position; only its fitness
    changes. It therefore works with every algorithm and leaves the equations as printed.

    Raises
    ------
    TrajgapError
        As `DeathPenalty`, or if a prescribed derivative is not 0: stretching would change it.

    Notes
    -----
    Peaks of the stretched vector are at the limit up to rounding, which grows with the spread of
    the durations: below 1e-10 for C4 quintic splines with durations that differ 1,000-fold, near
    the checker's tolerance if they differ 100,000-fold. The checker decides.
    """

    problem: Problem
    """All joints share one duration vector; its coupling is ignored."""
    penalty: float = np.inf
    """Fitness if no stretch helps, s: for a duration of 0 or less, stretched durations outside the
    problem's bounds, a moving joint with limit 0, or a path beyond a position limit."""
    shorten: bool = False
    """Whether a vector with c* < 1 is shortened too."""

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
        """Durations that positions represent; a position that no stretch repairs is unchanged.

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
    penalty : float
        Fitness of vectors that remain infeasible, s.
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
    """Compile the objective of a problem and store it on disk, where later processes find it.

    Parameters
    ----------
    handling : str
        As `judge_of`.

    Raises
    ------
    TrajgapError
        As `judge_of`.
    """
    ones = np.ones((2, problem.segments))
    judge_of(problem, np.inf, handling)(ones)
