"""The papers' other procedure: each joint by itself, then the longest duration per segment."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...problem import Array, Check, Problem, check
from .clock import time_up
from .near_optimal import longest_per_segment_range
from .solution import Evidence, Solution, Status, weakest
from .solver import solve

OPTIMUM_SLACK = 1e-6
"""Excess over each joint's own optimum (s) within which the procedure's output is reported."""
_MOST_SEGMENTS = 4
"""Ranges go through every assignment of segments to joints, 2ⁿ subsets: up to here."""


@dataclass(frozen=True)
class Range:
    """The procedure's total while each joint stays within ``slack`` (s) of its own optimum."""

    slack: float
    lowest: float
    highest: float


@dataclass(frozen=True, eq=False)
class PerJointSolution:
    """Each joint's own optimum, and what the longest-per-segment procedure makes of them.

    The total of the procedure is its output, not an optimum of anything: where a joint's optimum
    is flat, many totals are equally justified, and `ranges` says which.

    Attributes
    ----------
    problem : Problem
    joints : tuple of Solution
        One per joint.
    durations : ndarray, shape (segments,), or None
        Longest of the joints' durations, per segment.
    check : Check or None
        That vector judged with all joints.
    ranges : tuple of Range
    why : str or None
        Why there is no total or no range.
    """

    problem: Problem
    joints: tuple[Solution, ...]
    durations: Array | None
    check: Check | None
    ranges: tuple[Range, ...]
    why: str | None
    solve_seconds: float

    @property
    def status(self) -> Status:
        """The worst status among the joints; *converged* at best, for the output is no optimum."""
        order = [
            Status.OPTIMAL,
            Status.CONVERGED,
            Status.FEASIBLE,
            Status.NOT_ATTAINED,
            Status.LIMIT,
            Status.FAILED,
            Status.NONE_FOUND,
            Status.INFEASIBLE,
        ]
        worst = max((s.status for s in self.joints), key=order.index)
        return Status.CONVERGED if worst is Status.OPTIMAL else worst

    @property
    def total_time(self) -> float:
        """Total of the longest durations, s; inf without an answer."""
        return float(self.durations.sum()) if self.durations is not None else float("inf")

    @property
    def joint_evidence(self) -> Evidence:
        """The weakest evidence of the joints' own optima."""
        return weakest(s.evidence for s in self.joints)

    @property
    def evidence(self) -> Evidence:
        """Of the output, which is no optimum: best known at most, where every search converged."""
        if self.durations is None:
            return Evidence.NONE
        return weakest([Evidence.BEST_KNOWN, self.joint_evidence])

    def __str__(self) -> str:
        lines = [f"{self.problem.name}: each joint by itself, then the longest per segment"]
        for label, s in zip(self.problem.joints, self.joints, strict=True):
            shown = ", ".join(f"{d:.4f}" for d in s.durations) if s.durations is not None else s.why
            lines.append(f"joint {label:<9} {s.total_time:.6f} s  ({shown})  {s.status}")
        if self.durations is not None and self.check is not None:
            lines.append(f"longest         {self.total_time:.6f} s, {self.check.verdict}")
        for r in self.ranges:
            lines.append(
                f"within {r.slack:g} s of each optimum: {r.lowest:.6f} to {r.highest:.6f} s"
            )
        if self.why:
            lines.append(self.why)
        return "\n".join(lines)


def solve_per_joint(
    problem: Problem,
    *,
    slacks: tuple[float, ...] = (OPTIMUM_SLACK,),
    solver: Callable[[Problem], Solution] = solve,
) -> PerJointSolution:
    """Optimise each joint by itself and take the longest duration of each segment.

    Where the problem fixes the ratios of its durations, that is the longest of the joints' totals,
    and the optimum with shared durations too.

    Parameters
    ----------
    problem : Problem
        Its coupling is not looked at.
    slacks : tuple of float
        Excesses over each joint's own optimum, s, for which the range of the procedure's total
        is reported; none for an empty tuple.
    solver : callable
        Answers the problem of one joint.

    Returns
    -------
    PerJointSolution
    """
    began = time.perf_counter()
    singles = [problem.joint(j) for j in range(problem.waypoints.shape[1])]
    solutions = tuple(map(solver, singles))
    answers = [s.durations for s in solutions if s.durations is not None]
    ranges: list[Range] = []
    if len(answers) < len(solutions):
        durations, verdict = None, None
        why = "some joint has no feasible durations: " + "; ".join(
            f"joint {label}: {s.why}"
            for label, s in zip(problem.joints, solutions, strict=True)
            if s.durations is None
        )
    elif problem.curve.free:
        durations, verdict = None, None
        why = (
            f"the longest durations do not determine the motion: {problem.curve.name} "
            f"leaves {problem.curve.free} derivatives of each joint free"
        )
    else:
        durations = np.max(answers, axis=0)
        verdict = check(problem, durations)
        why = None
        settled = all(s.status in (Status.CONVERGED, Status.OPTIMAL) for s in solutions)
        shares = problem.shares
        if shares is not None and settled:
            # The longest of totals at the same ratios is the total: each may be as much longer.
            total = float(durations.sum())
            most = float((problem.duration_upper / shares).min())
            ranges = [Range(slack, total, min(total + slack, most)) for slack in slacks]
        elif problem.curve.piecewise is None:
            why = "ranges are computed for declared piecewise polynomials only"
        elif problem.segments > _MOST_SEGMENTS:
            why = f"ranges are computed for at most {_MOST_SEGMENTS} segments"
        elif time_up():
            why = "ranges were not computed: the time ran out"
        elif not settled:
            why = "ranges need an attained optimum of every joint"
        else:
            ranges = [
                Range(slack, *longest_per_segment_range(singles, answers, slack))
                for slack in slacks
            ]
    return PerJointSolution(
        problem,
        solutions,
        durations,
        verdict,
        tuple(ranges),
        why,
        time.perf_counter() - began,
    )
