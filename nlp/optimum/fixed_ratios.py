"""The shortest total at fixed ratios of the durations: one unknown, in closed form."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from ...problem import QUANTITIES, TOLERANCE, Array, Check, Problem, TrajgapError, Verdict, check
from ...verify import shown_bound
from .decided import BLURRED, decided, kept, longer_than_tight
from .optimality import KKT_TOLERANCE, kkt, unmet
from .solution import Route, Solution, Status

FORMULA = "at fixed ratios the total is the one unknown, in closed form"
"""Beside every optimum at fixed ratios: no search stands behind it."""


def at_ratios(problem: Problem) -> Solution:
    """The shortest motion whose durations have the ratios of the problem.

    A derivative of order r falls with the total T as T⁻ʳ where a curve may be stretched in time:
    with its peak p_r at T = 1 s, a limit asks for T ≥ (p_r/limit_r)^(1/r), and the largest of these
    is the answer, unless bounds on durations ask for more. Positions do not depend on T. The
    numbers are those of `check`, which is also what judges the answer.

    Parameters
    ----------
    problem : Problem
        With ratios.

    Returns
    -------
    Solution

    Raises
    ------
    TrajgapError
        If the curve has free coefficients or cannot be stretched, so that there is no formula.
    """
    began = time.perf_counter()
    shares, why = problem.shares, problem.unscaled
    if why is not None:
        raise TrajgapError(why)
    assert shares is not None
    answer = _answer(problem, shares)
    return replace(answer, solve_seconds=time.perf_counter() - began)


def _answer(problem: Problem, shares: Array) -> Solution:
    at_one = check(problem, shares)
    lost = _unrepaired(at_one)
    if lost is not None:
        return Solution(problem, *lost)
    least = max(at_one.stretch, float((problem.duration_lower / shares).max()))
    most = float((problem.duration_upper / shares).min())
    if least > most:
        return _at_upper_bounds(problem, shares, least, most)
    # Rounding may take a duration beyond the bound that it meets.
    h = shares * (least or min(1.0, most))
    h = np.clip(h, problem.duration_lower, problem.duration_upper)
    answer = _judged(problem, h)
    if least > 0.0 or not answer.found:
        return answer
    why = "nothing that moves is limited, so that the total falls to 0"
    return replace(
        answer, status=Status.NOT_ATTAINED, why=why, infimum=0.0, kkt_residual=None, active=()
    )


def _unrepaired(at_one: Check) -> tuple[Status, str] | None:
    """What no total repairs, as status and reason; None where some total may do."""
    if any(p.quantity == "curve" for p in at_one.peaks):
        return Status.FAILED, f"at these ratios there is no curve: {at_one.feasible_why}"
    for p in at_one.peaks:
        if np.isinf(p.ratio) and p.quantity in QUANTITIES:
            why = f"joint {p.joint} moves, though its {p.quantity} limit is 0"
            return Status.INFEASIBLE, why
    return None


def _at_upper_bounds(problem: Problem, shares: Array, least: float, most: float) -> Solution:
    """The answer where the upper bounds on durations end below the total that is asked for.

    The longest total breaks the limits least: it passes where rounding alone sets the two apart.
    """
    h = np.minimum(shares * most, problem.duration_upper)
    verdict = check(problem, h)
    if verdict.limits is Verdict.PASS:
        return _judged(problem, h)
    said = (
        f"at these ratios limits and least durations ask for {shown_bound(least, 'lower')} s "
        f"in total, and the upper bounds on durations end at {shown_bound(most, 'upper')} s"
    )
    if verdict.limits is Verdict.VIOLATED:
        return Solution(problem, Status.INFEASIBLE, said)
    return Solution(problem, Status.NONE_FOUND, f"{said}; rounding hides which is the larger")


def _judged(problem: Problem, h: Array) -> Solution:
    """The tight motion, or the one beside it that rounding lets pass, with its evidence."""
    verdict = check(problem, h)
    passing = h if kept(problem, verdict) else None
    if passing is None and verdict.limits is Verdict.UNDECIDED:
        inside = decided(problem, h)
        passing = None if inside is None else inside.durations
    if passing is None:
        return Solution(problem, *_refused(problem, verdict))
    report = kkt(problem, h)
    beyond = max(0.0, float(passing.sum() / h.sum()) - 1.0)
    optimal = report.residual <= KKT_TOLERANCE and beyond <= BLURRED
    notes = [FORMULA] if optimal else []
    if report.residual > KKT_TOLERANCE:
        notes.append(unmet(report.residual))
    if beyond > KKT_TOLERANCE:
        notes.append(longer_than_tight(beyond))
    return Solution(
        problem,
        Status.CONVERGED if optimal else Status.FEASIBLE,
        "; ".join(notes),
        vector=passing,
        check=check(problem, passing),
        route=Route.CLOSED_FORM,
        kkt_residual=report.residual,
        active=report.active,
        totals=(float(passing.sum()),),
    )


def _refused(problem: Problem, verdict: Check) -> tuple[Status, str]:
    """Why no total makes a motion pass that is as tight as its limits allow."""
    outside = [p for p in verdict.peaks if p.quantity == "position" and p.ratio > 1.0 + TOLERANCE]
    if verdict.limits is Verdict.VIOLATED and outside:
        worst = max(outside, key=lambda p: p.ratio)
        unit = "m" if problem.linear[problem.joints.index(str(worst.joint))] else "rad"
        return Status.INFEASIBLE, (
            f"at these ratios joint {worst.joint} reaches {worst.value:.6g} {unit}, beyond its "
            f"position limit of {worst.limit:.6g} {unit}, whatever the total"
        )
    if verdict.jumps:
        jump = max(verdict.jumps, key=lambda one: (-one.order, abs(one.size)))
        what = ("position", "velocity", "acceleration")[jump.order]
        return Status.NONE_FOUND, (
            f"at these ratios the {what} of joint {jump.joint} jumps, whatever the total"
        )
    return Status.NONE_FOUND, "rounding hides whether any total keeps the limits at these ratios"
