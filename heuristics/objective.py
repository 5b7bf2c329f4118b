"""The fitness as the papers define it: total time within the limits, a penalty outside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..problem import TOLERANCE, Array, Problem, TrajgapError, keeps_limits

Objective = Callable[[Array], Array]
"""Maps a batch of positions, shape (batch, dimensions), to their fitness, shape (batch,)."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Box of admissible positions; for a problem, its bounds on the segment durations."""

    lower: Array
    upper: Array
    """Shape (dimensions,). In s for durations; infinite if there is none."""

    @classmethod
    def of(cls, problem: Problem) -> Bounds:
        """Duration bounds of a problem, s."""
        return cls(problem.duration_lower, problem.duration_upper)


@dataclass(frozen=True, eq=False)
class DeathPenalty:
    """Σ t if every limit is kept for all t, otherwise the penalty.

    Source: `puma560-mnam-pso-353`, (13) with Step 2 (penalty ∞); `irb460-pso-353`, (18)(19) with
    its flow chart (penalty "a very large constant").

    Raises
    ------
    TrajgapError
        If the penalty is not positive or some admissible total reaches it, or if the curve leaves
        derivatives free, which durations do not determine.

    Notes
    -----
    A vector outside the duration bounds of the problem, or with a duration of 0 or less, is
    infeasible. Peaks are exact, positions included, whereas the authors' programs sample them.
    Jumps between segments are not detected here; only `trajgap.problem.check` detects those.
    """

    problem: Problem
    """All joints share one duration vector; its coupling is ignored."""
    penalty: float = np.inf
    """Fitness of an infeasible vector, s."""
    tolerance: float = TOLERANCE / 2
    """Relative excess over a limit that still counts as keeping it: half of the checker's, so an
    answer at the edge passes the checker, which adds a bound on rounding errors."""

    def __post_init__(self) -> None:
        problem = self.problem
        if not self.penalty > 0:
            raise TrajgapError(f"penalty: must be positive, got {self.penalty}; inf is allowed")
        largest = float(problem.duration_upper.sum())
        if np.isfinite(largest) and self.penalty <= largest:
            raise TrajgapError(
                f"penalty: {self.penalty:g} does not exceed the largest admissible total of "
                f"{largest:g} s; raise it"
            )
        if problem.curve.free:
            raise TrajgapError(
                f"interpolant {problem.curve.name}: leaves {problem.curve.free} "
                "derivatives per joint free, heuristics search durations only; prescribe them"
            )
        if problem.ratios is not None:
            raise TrajgapError(
                "ratios: the durations have fixed ratios, so the total is the only unknown and "
                "there is nothing to search; `solve` gives it, or leave the ratios out"
            )

    def decode(self, durations: Array) -> Array:
        """Durations of positions: the positions themselves."""
        return durations

    def __call__(self, durations: Array) -> Array:
        """Fitness of a batch of duration vectors.

        Parameters
        ----------
        durations : ndarray, shape (batch, segments)
            In s.

        Returns
        -------
        ndarray, shape (batch,)
            In s.
        """
        lower, upper = self.problem.duration_lower, self.problem.duration_upper
        kept = (durations >= lower) & (durations <= upper)
        if kept.size and kept.all():  # the usual swarm is held within the bounds
            return self._inside(durations)
        rows = kept.all(axis=1)
        fitness = np.full(durations.shape[0], self.penalty)
        if rows.any():
            fitness[rows] = self._inside(durations[rows])
        return fitness

    def _inside(self, durations: Array) -> Array:
        """Fitness of vectors within the duration bounds."""
        within = keeps_limits(self.problem, durations, self.tolerance)
        return np.where(within, durations.sum(axis=1), self.penalty)


class Counted:
    """An objective that counts the positions it evaluated.

    Parameters
    ----------
    objective : callable
        Maps positions, shape (batch, dimensions), to fitness, shape (batch,).

    Attributes
    ----------
    evaluations : int
        Positions evaluated so far, including those outside the bounds.
    """

    def __init__(self, objective: Objective) -> None:
        self._objective = objective
        self.evaluations = 0

    def __call__(self, positions: Array) -> Array:
        """Fitness of a batch.

        Raises
        ------
        TrajgapError
            If the objective returns another shape than one value per position, or NaN.
        """
        fitness = self._objective(positions)
        check_shape(fitness, positions.shape[0])
        if np.isnan(fitness).any():
            raise nan_returned()
        self.evaluations += positions.shape[0]
        return fitness


class Recalling:
    """An objective of its own that does not judge again what it judged in its last call.

    Parameters
    ----------
    objective : callable
        Gives a position the same bits in whatever company.
    """

    def __init__(self, objective: Objective) -> None:
        self._objective = objective
        self._known: dict[Any, float] = {}

    def __call__(self, positions: Array) -> Array:
        """Fitness of a batch."""
        row = np.dtype((np.void, positions.itemsize * positions.shape[1]))
        rows: list[Any] = np.ascontiguousarray(positions).view(row).ravel().tolist()
        new = {one: at for at, one in enumerate(rows) if one not in self._known}
        fitness = self._objective(positions[list(new.values())])
        check_shape(fitness, len(new))
        known = self._known | dict(zip(new, fitness.tolist(), strict=True))
        self._known = {one: known[one] for one in rows}
        return np.array([known[one] for one in rows])


def check_shape(fitness: Array, count: int) -> None:
    """Find out whether an objective returned one value per position.

    Raises
    ------
    TrajgapError
        If it did not.
    """
    if np.shape(fitness) != (count,):
        raise TrajgapError(
            f"objective: expected {count} values for as many positions, "
            f"got shape {np.shape(fitness)}"
        )


def nan_returned() -> TrajgapError:
    """Error for an objective that returned NaN."""
    return TrajgapError("objective: returned NaN; return inf for infeasible positions")
