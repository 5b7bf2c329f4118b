"""What the exact side returns: a status from a closed set, durations, and their evidence."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from ...problem import (
    TOLERANCE,
    Array,
    Check,
    InNotebooks,
    Problem,
    Trajectory,
    TrajgapError,
    fit,
    shown_bound,
)
from ...problem.motions import Samples, sampled
from .optimality import Active

_VANISHING = 1e-3
"""Share of a motion's total below which its infimum is 0: the motion found stands a floor of the
search above it, and an infimum above 0 is nearly reached there."""


WIDEST = 0.01
"""Relative width up to which an interval is narrow enough to call the optimum certified."""


def close(lower: float, upper: float) -> bool:
    """Whether a proved interval is narrow enough to call the optimum within it certified."""
    return upper - lower <= WIDEST * lower


class Status(StrEnum):
    """How a solve ended."""

    OPTIMAL = "optimal"
    """Proved: feasible for all t, and no motion of the question is shorter by more than a millionth
    of its total."""
    CONVERGED = "converged"
    """Feasible for all t, and the optimality conditions hold: a local optimum, the best known."""
    FEASIBLE = "feasible"
    """Feasible for all t; the optimality conditions were not reached."""
    INFEASIBLE = "infeasible"
    """No duration vector within the bounds keeps the limits: `why` is the proof."""
    NONE_FOUND = "none found"
    """No feasible duration vector found, and no proof that there is none; `why` says how near."""
    NOT_ATTAINED = "not_attained"
    """No shortest motion was found: the totals found fall as a duration goes to 0."""
    FAILED = "failed"
    """The solver failed; nothing is claimed."""


class Route(StrEnum):
    """How an answer was found."""

    NLP = "nlp"
    """The exact NLP in CasADi, solved by IPOPT: the reference."""
    DESCENT = "descent"
    """Descents on the exact extrema, dense and without a solver: the fast route."""
    CLOSED_FORM = "closed form"
    """A formula; nothing was searched."""


class Evidence(StrEnum):
    """The evidence for a reference value."""

    CERTIFIED = "certified"
    """Lower and upper bound within the stated gap, verified again."""
    BEST_KNOWN = "best known"
    """The best value found and checked, with no bound proved within 1 % below it. A gap against it
    is a lower estimate of the true one."""
    UNCONVERGED = "not converged"
    """The value of a checked motion at which the search stopped before it met the conditions of an
    optimum: shorter ones are to be expected."""
    NONE = "none"
    """No value. A verdict without a reference rests on the printed digits, a count, a check of what
    is printed, or a shorter motion that was checked and needs no optimum for comparison."""


def weakest(evidence: Iterable[Evidence]) -> Evidence:
    """The weakest of some words; none for no words."""
    order = [Evidence.CERTIFIED, Evidence.BEST_KNOWN, Evidence.UNCONVERGED, Evidence.NONE]
    return max(evidence, key=order.index, default=Evidence.NONE)


@dataclass(frozen=True, eq=False)
class SearchResult(InNotebooks):
    """What a search comes to: durations that `check` has judged, or the reason why there are none.

    Attributes
    ----------
    problem : Problem
    status : Status
    why : str or None
        The reason, where the status needs one.
    vector : ndarray, shape (segments,), or None
        The durations, or None if there is no motion; `durations` is what users read.
    check : Check or None
        The checker's verdict on the durations.
    solve_seconds : float
    """

    problem: Problem
    status: Status
    why: str | None = None
    vector: Array | None = None
    check: Check | None = None
    solve_seconds: float = 0.0

    @property
    def found(self) -> bool:
        """Whether there is a motion."""
        return self.vector is not None

    @property
    def durations(self) -> Array:
        """Durations of the segments, s, shape (segments,).

        Raises
        ------
        TrajgapError
            If there is no motion, with the reason; `found` tells.
        """
        if self.vector is None:
            why = f", {self.why}" if self.why else ""
            raise TrajgapError(f"no motion: {self.status}{why}")
        return self.vector

    @property
    def total_time(self) -> float:
        """Sum of the durations, s; inf without an answer, so no comparison passes."""
        return float(self.durations.sum()) if self.vector is not None else float("inf")


@dataclass(frozen=True, eq=False)
class Solution(SearchResult):
    """Answer of the exact side to a `Problem` with shared durations.

    Attributes
    ----------
    nodal : ndarray, shape (free, joints), or None
        Free derivatives of an under-determined curve.
    route : Route or None
        How it was found; None without durations.
    other_total : float or None
        Total by the other route, s, if requested: that of the NLP for a descent or a formula, that
        of a descent for the NLP. See `with_other_route`.
    infimum : float or None
        For `not_attained`: the value that the totals found approach, s. It is the infimum if
        `approach_proved` is true, and otherwise the best known estimate of it.
    lower_bound : float or None
        A lower bound that the arithmetic of `trajgap.verify` proves, s: of the declared curve, or
        of any curve. None if nothing is proved.
    kkt_residual : float or None
        Scaled residual for the reduced problem, with all active peaks found again.
    active : tuple of Active
        Limits that are reached, with multipliers and sensitivities.
    starts, starts_at_best : int
        Starts, and how many ended within 1e-6 (relative) of the best or came near one that did.
    iterations : int
        Solver iterations over all starts.
    build_seconds : float
    """

    nodal: Array | None = None
    route: Route | None = None
    other_total: float | None = None
    infimum: float | None = None
    lower_bound: float | None = None
    kkt_residual: float | None = None
    active: tuple[Active, ...] = ()
    starts: int = 0
    starts_at_best: int = 0
    iterations: int = 0
    build_seconds: float = 0.0
    totals: tuple[float, ...] = field(default=(), repr=False)

    @property
    def best(self) -> float:
        """The infimum if it is not attained, otherwise the total, s; inf without an answer.

        If nothing keeps the total from 0, the value at the floors of the search is not returned.
        """
        if self.boundless is not None:
            return 0.0
        return self.infimum if self.infimum is not None else self.total_time

    @property
    def approach_proved(self) -> bool:
        """Whether the value approached is proved to be the infimum: it is 0, or equals a bound."""
        if self.infimum is None:
            return False
        return self.best == 0.0 or (self.lower_bound or 0.0) >= self.infimum * (
            1.0 - TOLERANCE
        )  # what rounding explains

    @property
    def boundless(self) -> str | None:
        """Why nothing keeps the total from 0, so there is no time for comparison."""
        if self.infimum is None or self.infimum > _VANISHING * self.total_time:
            return None
        if not np.isfinite(self.problem.limits.sides).any():
            return "without limits there is no shortest motion (not checkable)"
        return "no limit keeps the total from falling to 0, so there is no shortest motion"

    @property
    def settled(self) -> bool:
        """Whether it meets the conditions of an optimum, or of a total that is not attained."""
        return self.status in (Status.CONVERGED, Status.OPTIMAL, Status.NOT_ATTAINED)

    @property
    def evidence(self) -> Evidence:
        """Certified with a lower bound within 1 %; best known only if the search converged."""
        if self.vector is None:
            return Evidence.NONE
        if self.lower_bound is not None and close(self.lower_bound, self.best):
            return Evidence.CERTIFIED
        return Evidence.BEST_KNOWN if self.settled else Evidence.UNCONVERGED

    @property
    def trajectory(self) -> Trajectory:
        """The motion of the answer: joint angles over time, rad over s.

        Raises
        ------
        TrajgapError
            If there are no durations.
        """
        return fit(self.problem.curve, self.problem.waypoints, self.durations, self.nodal)

    def sample(self, dt: float) -> Samples:
        """Position, velocity and acceleration every ``dt`` seconds, and at the end.

        Parameters
        ----------
        dt : float
            s.

        Returns
        -------
        Samples

        Raises
        ------
        TrajgapError
            If there are no durations, or the step is not a time.
        """
        return sampled(self.trajectory, dt, self.problem.joints)

    def __str__(self) -> str:
        lines = [f"{self.problem.name}: {self.status}" + (f" ({self.why})" if self.why else "")]
        if self.vector is not None and self.check is not None:
            shown = ", ".join(f"{d:.6f}" for d in self.durations)
            lines += [
                f"total time      {self.total_time:.9f} s  [{self.evidence}]",
                f"durations       {shown} s",
                f"check           {self.check.verdict}, largest excess "
                f"{self.check.max_violation:.1e}",
            ]
        if self.lower_bound is not None:
            width = (self.best - self.lower_bound) / self.best
            low = shown_bound(self.lower_bound, "lower", places=9)
            lines.append(f"lower bound     {low} s, proved; gap {width:.1e}")
        if self.infimum is not None:
            if self.approach_proved:
                lines.append(f"infimum         {self.infimum:.9f} s, approached but not attained")
            else:
                lines.append(
                    f"approached      {self.infimum:.9f} s as a duration goes to 0: an estimate"
                )
        if self.kkt_residual is not None:
            lines.append(f"KKT residual    {self.kkt_residual:.1e}")
        for a in self.active:
            where = f"joint {a.joint}" if a.joint else f"segment {a.segment + 1}"
            at = f" at t = {a.time:.4f} s" if a.time is not None else ""
            lines.append(
                f"active          {where} {a.quantity}{at}: 10 % more changes the total by "
                f"{a.sensitivity:+.4f} s"
            )
        lines.append(
            f"build, solve    {1e3 * self.build_seconds:.1f} ms, {1e3 * self.solve_seconds:.1f} ms"
        )
        return "\n".join(lines)
