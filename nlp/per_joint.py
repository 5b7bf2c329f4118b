"""The papers' other procedure: each joint separately, then the longest duration per segment."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..problem import Array, Problem, as_piecewise, check, fit
from .clock import time_up
from .optimum import (
    IPOPT_OPTIONS,
    NEAR,
    Evidence,
    Program,
    SearchResult,
    Solution,
    Status,
    ca,
    constraints,
    near_rows,
    solve,
    weakest,
)

ROUNDS = 20
"""Rounds from one optimum: a bound against endless shrinking of the region; two to four suffice
where the first region does."""
REGION = 0.05
"""Share by which a first round may change a duration: near an optimum the extrema hardly move."""
LEFT = 1e-8
"""Relative change of the durations at which the rounds end, and excess of a cap that rounding
explains."""
OPTIONS = IPOPT_OPTIONS | {"ipopt.mu_init": 1e-4, "ipopt.tol": 1e-9}
"""Options of IPOPT, begun near a solution: with a small barrier."""


class Near(NamedTuple):
    """A question near known optima: durations of some joints at which an objective is least.

    Each joint stays within its limits and its cap.
    """

    problems: list[Problem]
    """Of the joints, one for each."""
    starts: list[Array]
    """Durations that keep the limits and the caps, s."""
    caps: list[float]
    """Largest total of each joint, s."""
    weights: Array | None
    """Of the durations of the one joint in the objective; None for Σ_k max_j h_jk."""


def nearby(question: Near) -> list[Array]:
    """Durations of the joints, found by rounds of the NLP near the starts.

    These are returned where nothing better was found.

    Parameters
    ----------
    question : Near

    Returns
    -------
    list of ndarray
    """
    problems, starts, caps, weights = question
    unit = float(np.mean(starts))
    programs = [Program(problem, unit, np.zeros(problem.segments)) for problem in problems]
    h, radius = starts, REGION
    for _ in range(ROUNDS):
        new = _round(programs, h, caps, radius, weights)
        stretches = [check(q, d).stretch for q, d in zip(problems, new, strict=True)]
        if max(stretches) > 1 + 1e-4 * radius:
            radius *= 0.25
            continue
        moved = np.abs(np.array(new) / np.array(h) - 1).max()
        h, radius = new, min(REGION, 4.0 * radius)
        if moved < LEFT:
            break
    inside = []
    for problem, own, cap in zip(problems, h, caps, strict=True):
        tight = own * max(1.0, check(problem, own).stretch)
        inside.append(np.clip(tight, problem.duration_lower, problem.duration_upper))
        if inside[-1].sum() > cap * (1 + LEFT):
            return starts
    return inside


def _round(
    programs: list[Program],
    h: list[Array],
    caps: list[float],
    radius: float,
    weights: Array | None,
) -> list[Array]:
    n, unit = programs[0].segments, programs[0].unit
    top = ca.MX.sym("longest", n)
    longest = np.max(h, axis=0) / unit
    variables, given, low, high = [top], [longest], [np.zeros(n)], [np.full(n, np.inf)]
    expressions, least, most = [], [], []
    for program, own, cap in zip(programs, h, caps, strict=True):
        motion = fit(program.problem.curve, program.problem.waypoints, own)
        stated, floor, ceiling = constraints(program, near_rows(program, motion, NEAR))
        x, (lower, upper) = program.pack(motion, own), program.bounds()
        lower[:n] = np.maximum(lower[:n], x[:n] * (1 - radius))
        upper[:n] = np.minimum(upper[:n], x[:n] * (1 + radius))
        durations = program.durations
        variables.append(program.variables)
        given.append(x)
        low.append(lower)
        high.append(upper)
        expressions += [stated, ca.sum1(durations), durations - top]
        least += [floor, np.zeros(1), np.full(n, -np.inf)]
        most += [ceiling, np.array([cap / unit]), np.zeros(n)]
    objective = ca.sum1(top)
    if weights is not None:  # the longest durations have no part in it
        objective = ca.dot(ca.DM(weights), programs[0].durations)
        given[0] = low[0] = high[0] = np.full(n, 10.0 * longest.max())
    nlp = {"x": ca.vertcat(*variables), "f": objective, "g": ca.vertcat(*expressions)}
    result = ca.nlpsol("near", "ipopt", nlp, OPTIONS)(
        x0=np.concatenate(given),
        lbx=np.concatenate(low),
        ubx=np.concatenate(high),
        lbg=np.concatenate(least),
        ubg=np.concatenate(most),
    )
    answer, at, found = np.asarray(result["x"]).ravel(), n, []
    for program in programs:
        own, problem = answer[at : at + n] * unit, program.problem
        found.append(np.clip(own, problem.duration_lower, problem.duration_upper))
        at += program.variables.numel()
    return found


def _all_nearby(questions: list[Near]) -> Sequence[list[Array]]:
    return [nearby(one) for one in questions]


def longest_per_segment_range(
    problems: list[Problem],
    optima: list[Array],
    slack: float,
    search: Callable[[list[Near]], Sequence[list[Array]]] = _all_nearby,
) -> tuple[float, float]:
    """Lowest and highest Σ_k max_j h_jk, s, each joint within ``slack`` s of its optimum.

    Found by local optimisation from the joints' own best known optima: an inner estimate of the
    range. The highest value goes through every assignment of segments to the joints that set them.
    """
    caps = [float(h.sum()) + slack for h in optima]
    given = float(np.max(optima, axis=0).sum())
    n = problems[0].segments
    every = tuple(range(n))
    subsets = [some for size in range(1, n) for some in itertools.combinations(every, size)]
    parts = [(j, subset) for subset in subsets for j in range(len(problems))]
    questions = [Near(problems, optima, caps, None)]
    questions += [
        Near([problems[j]], [optima[j]], [caps[j]], -np.isin(every, subset).astype(np.float64))
        for j, subset in parts
    ]
    least, *most = search(questions)
    lowest = float(np.max(least, axis=0).sum())
    reach = {(j, every): cap for j, cap in enumerate(caps)}
    for (j, subset), (h,) in zip(parts, most, strict=True):
        chosen = np.isin(every, subset)
        reach[j, subset] = float(max(optima[j][chosen].sum(), h[chosen].sum()))
    highest = max(
        sum(reach[j, tuple(k for k in every if setting[k] == j)] for j in set(setting))
        for setting in itertools.product(range(len(problems)), repeat=n)
    )
    return min(given, lowest), max(given, highest)


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


def longest_status(joints: tuple[Solution, ...]) -> Status:
    """The worst status among the joints; *converged* at best, because there is no optimum."""
    order = [
        Status.OPTIMAL,
        Status.CONVERGED,
        Status.FEASIBLE,
        Status.NOT_ATTAINED,
        Status.FAILED,
        Status.NONE_FOUND,
        Status.INFEASIBLE,
    ]
    return max((Status.CONVERGED, *(s.status for s in joints)), key=order.index)


@dataclass(frozen=True, eq=False)
class PerJointSolution(SearchResult):
    """Each joint's own optimum, and the total that the longest duration per segment gives.

    Its durations are the longest of the joints', per segment, judged with all joints. The total of
    the procedure is its output, not an optimum: if a joint's optimum is flat, many totals are
    equally justified, and `ranges` gives them.

    Attributes
    ----------
    joints : tuple of Solution
        One per joint.
    ranges : tuple of Range
        `why` says why there is none.
    """

    joints: tuple[Solution, ...] = ()
    ranges: tuple[Range, ...] = ()

    @property
    def joint_evidence(self) -> Evidence:
        """The weakest evidence of the joints' own optima."""
        return weakest(s.evidence for s in self.joints)

    @property
    def evidence(self) -> Evidence:
        """Evidence of the output: best known at most, because it is not an optimum."""
        if self.vector is None:
            return Evidence.NONE
        return weakest([Evidence.BEST_KNOWN, self.joint_evidence])

    def __str__(self) -> str:
        lines = [
            f"{self.problem.name}: each joint separately, then the longest duration per segment"
        ]
        for label, s in zip(self.problem.joints, self.joints, strict=True):
            shown = ", ".join(f"{d:.4f}" for d in s.durations) if s.found else s.why
            lines.append(f"joint {label:<9} {s.total_time:.6f} s  ({shown})  {s.status}")
        if self.vector is not None and self.check is not None:
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
    search: Callable[[list[Near]], Sequence[list[Array]]] = _all_nearby,
) -> PerJointSolution:
    """Optimise each joint separately and take the longest duration of each segment.

    If the problem fixes the ratios of its durations, this is the longest of the joints' totals, and
    also the optimum with shared durations.

    Parameters
    ----------
    problem : Problem
        Its coupling is ignored.
    slacks : tuple of float
        Excesses over each joint's own optimum, s, for which the range of the procedure's total
        is reported; none for an empty tuple.
    solver : callable
        Answers the problem of one joint.
    search : callable
        Answers the questions behind the ranges, as `nearby` does each.

    Returns
    -------
    PerJointSolution
    """
    began = time.perf_counter()
    singles = [problem.joint(j) for j in range(problem.waypoints.shape[1])]
    solutions = tuple(map(solver, singles))
    answers = [s.durations for s in solutions if s.found]
    ranges: list[Range] = []
    if len(answers) < len(solutions):
        durations, verdict = None, None
        why = "some joint has no feasible durations: " + "; ".join(
            f"joint {label}: {s.why}"
            for label, s in zip(problem.joints, solutions, strict=True)
            if not s.found
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
        settled = longest_status(solutions) is Status.CONVERGED
        shares = problem.shares
        if shares is not None and settled:
            # The longest of totals at the same ratios is the total: each may be as much longer.
            total = float(durations.sum())
            most = float((problem.duration_upper / shares).min())
            ranges = [Range(slack, total, min(total + slack, most)) for slack in slacks]
        elif as_piecewise(problem.curve) is None:
            why = "ranges are computed for declared piecewise polynomials only"
        elif problem.segments > _MOST_SEGMENTS:
            why = f"ranges are computed for at most {_MOST_SEGMENTS} segments"
        elif time_up():
            why = "ranges were not computed: the time ran out"
        elif not settled:
            why = "ranges need an attained optimum of every joint"
        else:
            ranges = [
                Range(slack, *longest_per_segment_range(singles, answers, slack, search))
                for slack in slacks
            ]
    seconds = time.perf_counter() - began
    status = longest_status(solutions)
    return PerJointSolution(
        problem, status, why, durations, verdict, seconds, solutions, tuple(ranges)
    )
