"""Optimality gap of a time against a reference, as an interval and never clipped."""

from __future__ import annotations

import math

from ...nlp import Evidence, Solution, printed_problem_or_none, solve
from ...problem import Case, Problem, TrajgapError
from ...problem.cases import Statement
from ...problem.suite import instance_of
from ..documents import UNCERTIFIED, Gap, GapKind, Reference, Why, known, value_or_none
from .rows import Bracket


def reference_of(solution: Solution) -> Reference | None:
    """The reference interval of a solution, or None if it has no positive time."""
    return _reference(solution) if 0 < solution.best < math.inf else None


def _reference(solution: Solution) -> Reference:
    lower = known(solution.lower_bound, UNCERTIFIED.reason)
    return Reference(upper=solution.best, lower=lower, evidence=solution.evidence)


def gap(
    time: float | tuple[float, float],
    reference: Reference | Solution | float,
    *,
    feasible: bool = True,
) -> Gap:
    """Gap of a time, or of the interval of a printed time, against a reference.

    Parameters
    ----------
    time : float or (float, float)
        Total time, or the interval that its printed digits stand for, s.
    reference : Reference, Solution or float
        The exact side's answer, or its value in s.
    feasible : bool
        Whether the trajectory behind the time keeps its limits; otherwise the number is a
        difference of reported time.

    Returns
    -------
    Gap
        Negative values are kept: a time below the best known value is a new best value.

    Raises
    ------
    TrajgapError
        If the time is negative, or the reference is not a positive finite time.
    """
    if isinstance(reference, Solution):
        reference = _reference(reference)
    elif not isinstance(reference, Reference):
        reference = Reference(upper=float(reference))
    if not 0 < reference.upper < math.inf:
        raise TrajgapError(f"gap: the reference {reference.upper} s is not a positive finite time")
    low, high = time if isinstance(time, tuple) else (float(time), float(time))
    if not 0 <= low <= high:
        raise TrajgapError(f"gap: {time} is no time; give seconds, from 0 on")
    base = reference.upper if isinstance(reference.lower, Why) else reference.lower
    return Gap(
        kind=GapKind.OPTIMALITY if feasible else GapKind.REPORTED,
        lowest=(low - reference.upper) / reference.upper,
        highest=(high - base) / base,
        reference=reference,
    )


def known_optimum(
    case: Case, problem: Problem, statement: Statement, joint: int | None = None
) -> Solution | Reference:
    """What the suite states of its own instance, or else what a solve with shared durations finds.

    `statement`: the same problem in printed digits, for certificates. `joint`: the joint that the
    problem is about, where the statement is about all.
    """
    instance = instance_of(case) if joint is None else None
    if instance is None:
        return solve(problem, exact=printed_problem_or_none(statement, joint))
    lower = known(instance.lower or None, "no lower bound is proved")
    evidence = Evidence(str(instance.evidence))
    return Reference(upper=instance.upper, lower=lower, evidence=evidence)


def bracket_of(
    case: Case, problem: Problem, statement: Statement, joint: int | None = None
) -> Bracket | None:
    """The same as an interval; None if no positive total is attained."""
    found = known_optimum(case, problem, statement, joint)
    if isinstance(found, Reference):
        return Bracket(found.upper, value_or_none(found.lower))
    return Bracket(found.best, found.lower_bound) if 0 < found.best < math.inf else None
