"""What the gaps of a study are set against."""

from __future__ import annotations

import math

from ...nlp import printed_problem_or_none, solve
from ...problem import Problem
from ...problem.cases import Statement
from .rows import Bracket


def bracket_of(
    problem: Problem, statement: Statement | None = None, joint: int | None = None
) -> Bracket | None:
    """Where the optimum lies: best known, with its certified lower bound where one is proved.

    Parameters
    ----------
    problem : Problem
        Solved with shared durations.
    statement : Statement, optional
        The same problem in printed digits, for certificates.
    joint : int, optional
        The joint that the problem is about, where the statement is about all.

    Returns
    -------
    Bracket or None
        None where no positive total is attained.
    """
    exact = None if statement is None else printed_problem_or_none(statement, joint)
    found = solve(problem, exact=exact)
    if not 0 < found.best < math.inf:
        return None
    return Bracket(found.best, found.lower_bound)
