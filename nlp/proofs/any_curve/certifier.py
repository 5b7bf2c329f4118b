"""A proved interval for the least total of all motions through the way-points."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import Problem, TrajgapError
from ....verify import Subject
from ..answer import float_problem
from ..exact import ExactProblem, exact_problem
from ..judged import judged, unstated
from ..outcome import GAP, Certified, Outcome, Progress
from ..state import resumed
from .estimate import family_free
from .exact import FreeQuestion, missing, prove_motion, question, unanswered
from .local import Question, local_optimum
from .proof import DIGITS, free_bound, restored
from .search import Node, Search
from .tangents import Array

_SHARE = 0.9
"""Of the gap asked for, so that rounding has room."""
_ABOVE = Fraction(1, 2**20)

Motion = tuple[tuple[Fraction, ...], tuple[tuple[Fraction, ...], ...]]


def certify_family_free(
    problem: Problem | ExactProblem,
    *,
    gap: float = GAP,
    seconds: float = 60.0,
    seed: int = 0,
    resume: Certified | dict[str, Any] | None = None,
    report: Callable[[Progress], None] | None = None,
) -> Certified:
    """Prove an interval of the least total over all C1 motions with |v| ≤ V and |a| ≤ A.

    Parameters
    ----------
    problem : Problem or ExactProblem
        Of the curve only the velocities prescribed at its two ends count, and the durations are
        shared. Limits of jerk and position only make motions slower: the lower bound holds with
        them, and no upper bound is claimed.
    gap : float
        Relative width of the interval to reach.
    seconds : float
        Time limit. At the limit, or at Ctrl-C, the interval proved so far is returned.
    seed : int
        Of the starts of the local solver that finds the answer.
    resume : Certified or dict, optional
        A stopped run, or its `state_document`; its boxes are bounded anew.
    report : callable, optional
        Called with a `Progress` for every box; its lower bound is not yet proved in rationals.

    Returns
    -------
    Certified
        Its subject is `Subject.ANY`.

    Raises
    ------
    TrajgapError
        If the problem is not covered, or ``resume`` is malformed.
    """
    exact = exact_problem(problem) if isinstance(problem, Problem) else problem
    why = unstated(exact) or missing(exact)
    if why is not None:
        raise TrajgapError(f"certify: {why}")
    taken_up = None if resume is None else resumed(exact, resume, Subject.ANY)
    began = time.perf_counter()
    asked = question(exact)
    motion = _first_motion(exact, asked, seed)
    longest = [x for x in asked.longest if x is not None]
    if motion is not None:
        cap = sum(motion[0], Fraction(0))
    elif len(longest) == len(asked.longest):
        cap = sum(longest, Fraction(0)) * (1 + _ABOVE)
    else:
        seconds = time.perf_counter() - began
        nothing = (Fraction(0), None, None, 0, 0, seconds)
        return Certified(exact, Outcome.OPEN, *nothing, subject=Subject.ANY)
    search = Search(asked, cap)
    found: list[Motion] = [] if motion is None else [motion]

    def target() -> float:
        total = sum(found[-1][0]) if found else cap
        return float(total) * (1 - _SHARE * gap if found else 1.0)

    def told(lower: float, left: int) -> None:
        if report is not None:
            upper = float(sum(found[-1][0])) if found else float("inf")
            relative = (upper - lower) / upper if found else float("inf")
            rate = search.nodes / (time.perf_counter() - began)
            report(Progress(lower, upper, relative, left, search.nodes, rate))

    def improve(durations: Array) -> bool:
        better = _local_motion(asked, durations)
        if better is None or (found and sum(better[0]) >= sum(found[-1][0])):
            return False
        found.append(better)
        return True

    if taken_up is not None and taken_up.proof is not None:
        root = restored(search, taken_up.proof.document(), target())
    else:
        root = search.root(*_floats(asked, motion), target())
    complete = False
    while not complete:
        known = len(found)
        complete = search.grow(root, target(), began + seconds, told, improve)
        if len(found) == known:
            break
    return judged(_result(exact, search, root, found[-1] if found else None, gap, began))


def _result(
    exact: ExactProblem,
    search: Search,
    root: Node,
    motion: Motion | None,
    gap: float,
    began: float,
) -> Certified:
    answer = motion if unanswered(exact) is None else None
    upper = None if answer is None else sum(answer[0], Fraction(0))
    leaves = root.leaves
    least = min(search.exact(leaf, DIGITS[-1])[0] for leaf in leaves)
    total = _down(min(least, search.cap if motion is None else sum(motion[0], Fraction(0))))
    durations = None if answer is None else answer[0]
    longest = [x for x in search.asked.longest if x is not None]
    if motion is None:
        late = len(longest) == len(search.asked.longest) and total > sum(longest)
        outcome = Outcome.INFEASIBLE if late else Outcome.OPEN
    else:
        reached = sum(motion[0])
        enough = reached - total <= Fraction(gap) * reached
        outcome = Outcome.CERTIFIED if enough and upper is not None else Outcome.INTERVAL
    speeds = _all_speeds(exact, search, answer)
    proof = None if total <= 0 else free_bound(search, root, total)
    wanted = float(sum(motion[0])) * (1 - gap) if motion is not None else float(search.cap)
    return Certified(
        exact,
        outcome,
        max(total, Fraction(0)),
        upper,
        durations,
        search.nodes,
        sum(leaf.lower < wanted for leaf in leaves),
        time.perf_counter() - began,
        proof,
        proof is not None and outcome in (Outcome.INTERVAL, Outcome.OPEN),
        None,
        Subject.ANY,
        speeds,
    )


def _first_motion(exact: ExactProblem, asked: FreeQuestion, seed: int) -> Motion | None:
    """The best motion that the local solver finds, proved."""
    alone = replace(
        exact,
        limits=tuple((v, a, None) for v, a, _ in exact.limits),
        position_lower=(None,) * len(exact.joints),
        position_upper=(None,) * len(exact.joints),
    )
    known = family_free(float_problem(alone), seed=seed)
    if known.durations is None or known.nodal_velocities is None:
        return None
    return prove_motion(asked, known.durations, known.nodal_velocities[:, list(asked.joints)])


def _local_motion(asked: FreeQuestion, durations: Array) -> Motion | None:
    """A locally best motion from given durations, proved."""
    bent = [j for j, (_, a) in enumerate(asked.tight) if a is not None]
    limits = np.array(
        [[np.inf if x is None else float(x) for x in asked.tight[j]] for j in bent]
    ).reshape(-1, 2)
    ends = asked.ends
    core = Question(
        np.array([[float(row[j]) for j in bent] for row in asked.steps]),
        limits[:, 0],
        limits[:, 1],
        np.array([float(asked.floor(k)) for k in range(len(asked.steps))]),
        np.array([np.inf if x is None else float(x) for x in asked.longest]),
        (None if ends[0] is None else float(ends[0]), None if ends[1] is None else float(ends[1])),
    )
    answer = local_optimum(core, durations) if bent else None
    if answer is None:
        return None
    speeds = np.full((len(durations) + 1, len(asked.joints)), np.nan)
    speeds[:, bent] = answer[1]
    return prove_motion(asked, answer[0], speeds)


def _floats(asked: FreeQuestion, motion: Motion | None) -> tuple[Array, Array]:
    if motion is None:
        h = [1.0 if x is None else float(x) for x in asked.longest]
        return np.array(h), np.zeros((len(h) + 1, len(asked.joints)))
    return (
        np.array([float(x) for x in motion[0]]),
        np.array([[float(v) for v in row] for row in motion[1]]),
    )


def _all_speeds(
    exact: ExactProblem, search: Search, answer: Motion | None
) -> tuple[tuple[Fraction, ...], ...] | None:
    if answer is None:
        return None
    place = {j: n for n, j in enumerate(search.asked.joints)}
    every = range(len(exact.joints))
    return tuple(
        tuple(row[place[j]] if j in place else Fraction(0) for j in every) for row in answer[1]
    )


def _down(total: Fraction) -> Fraction:
    """A little less, in 15 digits after the first."""
    if total <= 0:
        return Fraction(0)
    unit = Fraction(1)
    while total < unit:
        unit /= 10
    while total >= 10 * unit:
        unit *= 10
    unit /= 10**15
    return (total // unit) * unit
