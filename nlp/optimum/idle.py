"""Segments in which nothing moves and on which nothing depends: they take their least duration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...problem import Array, Problem, check, fit
from ...problem.curves import segment_peaks
from .decided import kept
from .judgement import KKT_TOLERANCE
from .optimality import kkt
from .solution import Solution, Status
from .starts import equal_start

SHORT = (1e-4, 1e-3, 1e-2)
"""Shares of the mean that an idle segment takes: the first at which rounding hides no limit."""


def idle_segments(problem: Problem) -> list[int]:
    """Segments in which nothing moves and whose duration nothing else depends on."""
    if problem.curve.free:
        return []
    if problem.curve.shape(problem.waypoints) is not None:
        still = segment_peaks(problem.curve, problem.waypoints).max(axis=(1, 2)) == 0.0
        return np.flatnonzero(still).tolist()
    polynomials = problem.curve.piecewise
    if polynomials is None:
        return []
    rests = (problem.waypoints[1:] == problem.waypoints[:-1]).all(axis=1).any()
    if not rests and len(polynomials.waypoint_breaks) == polynomials.segments + 1:
        return []
    h = equal_start(problem)
    trajectory = fit(problem.curve, problem.waypoints, h)
    adjoint = polynomials.adjoint(problem.waypoints, h)
    moved = [np.abs(adjoint.coefficients_by_duration(k)).max() for k in range(problem.segments)]
    size = 1e-12 * max(1.0, float(np.abs(trajectory.scaled).max()))
    still = np.abs(trajectory.scaled[:, 1:]).max(axis=(1, 2)) <= size
    apart = np.array(moved) * h <= size
    return np.flatnonzero(still & apart).tolist()


def with_least_idle(problem: Problem, idle: list[int], held: Array, solution: Solution) -> Solution:
    """The answer to the moving segments, with the least durations of the idle ones.

    Parameters
    ----------
    problem : Problem
    idle : list of int
    held : ndarray, shape (segments,)
        Ordinary durations, s.
    solution : Solution
        With durations.

    Returns
    -------
    Solution
    """
    assert solution.durations is not None
    h = solution.durations.copy()
    h[idle] = problem.duration_lower[idle]
    vanishing = [k for k in idle if h[k] == 0]
    infimum = float(h.sum()) if vanishing else None
    for share in SHORT:
        # Across very unequal durations the checker's bound on rounding may hide the limits.
        h[vanishing] = share * held.mean()
        if not vanishing or kept(problem, check(problem, h)):
            break
    answer = replace(solution, problem=problem, durations=h, check=check(problem, h))
    if not vanishing:
        report = kkt(problem, h)
        if solution.status is Status.CONVERGED and report.residual > KKT_TOLERANCE:
            return answer  # rounding blurs its limits: the conditions hold at the tight motion
        return replace(answer, kkt_residual=report.residual, active=report.active)
    names = ", ".join(str(k + 1) for k in vanishing)
    return replace(
        answer,
        status=Status.NOT_ATTAINED,
        why=f"nothing moves in segment {names}: the total falls as its duration goes to 0",
        infimum=infimum,
    )
