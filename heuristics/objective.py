"""The fitness as the papers define it: total time within the limits, a penalty outside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..problem import TOLERANCE, Array, Problem, TrajgapError, evaluate

Objective = Callable[[Array], Array]
"""Maps a batch of positions, shape (batch, dimensions), to their fitness, shape (batch,)."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Box of admissible positions; for a problem, its bounds on the segment durations.

    Attributes
    ----------
    lower, upper : ndarray, shape (dimensions,)
        In s for durations; infinite where there is none.
    """

    lower: Array
    upper: Array

    @classmethod
    def of(cls, problem: Problem) -> Bounds:
        """Duration bounds of a problem, s."""
        return cls(problem.duration_lower, problem.duration_upper)


@dataclass(frozen=True, eq=False)
class DeathPenalty:
    """Σ t where every limit is kept for all t, the penalty everywhere else.

    Source: `puma560-mnam-pso-353`, (13) with Step 2 (penalty ∞); `irb460-pso-353`, (18)(19) with
    its flow chart (penalty "a very large constant").

    Parameters
    ----------
    problem : Problem
        All joints share one duration vector, whatever its coupling says.
    penalty : float
        Fitness of an infeasible vector, s.
    tolerance : float
        Relative excess over a limit that still counts as keeping it: half of the checker's, so
        that an answer at the edge passes the checker, which adds a bound on rounding errors.

    Raises
    ------
    TrajgapError
        If the penalty is not positive or some admissible total reaches it, if a position limit is
        set, or if the curve leaves derivatives free: the batch evaluation sees neither.

    Notes
    -----
    A vector outside the duration bounds of the problem, or with a duration of 0 or less, is
    infeasible. Peaks are exact, where the authors' programs sample them; jumps between segments
    are not looked for, only `trajgap.problem.check` sees those.
    """

    problem: Problem
    penalty: float = np.inf
    tolerance: float = TOLERANCE / 2

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
        limits = problem.limits
        if np.isfinite(limits.position_lower).any() or np.isfinite(limits.position_upper).any():
            raise TrajgapError(
                "limits.position: the heuristics' objective judges velocity, acceleration and "
                "jerk only; drop the position limits"
            )
        if problem.curve.free:
            raise TrajgapError(
                f"interpolant {problem.curve.name}: leaves {problem.curve.free} "
                "derivatives per joint free, heuristics search durations only; prescribe them"
            )

    def decode(self, durations: Array) -> Array:
        """Durations that positions stand for: themselves."""
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
        kept = ((durations >= lower) & (durations <= upper)).all(axis=1)
        fitness = np.full(durations.shape[0], self.penalty)
        inside = durations[kept]
        if inside.size:
            ratios = evaluate(self.problem, inside).ratios
            within = (ratios <= 1 + self.tolerance).all(axis=(1, 2))
            fitness[kept] = np.where(within, inside.sum(axis=1), self.penalty)
        return fitness


class Counted:
    """An objective that counts how many positions it judged.

    Parameters
    ----------
    objective : callable
        Maps positions, shape (batch, dimensions), to fitness, shape (batch,).

    Attributes
    ----------
    evaluations : int
        Positions judged so far, the ones outside the bounds included.
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
        if np.shape(fitness) != positions.shape[:1]:
            raise TrajgapError(
                f"objective: expected {positions.shape[0]} values for as many positions, "
                f"got shape {np.shape(fitness)}"
            )
        if np.isnan(fitness).any():
            raise TrajgapError("objective: returned NaN; return inf for what is infeasible")
        self.evaluations += positions.shape[0]
        return fitness
