"""A proved interval for the least total of all motions through the way-points."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from ....problem import Array
from ....verify import Subject
from ..answer import float_problem
from ..certifier import Certifier
from ..exact import ExactProblem
from ..rounding import down
from ..session import Session
from .estimate import estimate_any_curve
from .exact import FreeQuestion, missing, prove_motion, question, unanswered
from .local import LocalQuestion, local_optimum
from .proof import DIGITS, free_bound, restored
from .search import Node, Search

_SHARE = 0.9
"""Of the gap asked for, so that rounding has room."""
_ABOVE = Fraction(1, 2**20)
"""Share by which the cap exceeds the sum of all longest durations: a proof must get above it."""
_DIGITS = 15
"""Of a total after its first: what a double holds, about."""

Motion = tuple[tuple[Fraction, ...], tuple[tuple[Fraction, ...], ...]]


def _prove(session: Session) -> bool:
    """Raise the least bound of all boxes until it is near the best motion.

    Of the curve only the velocities prescribed at its two ends count. Limits of jerk and position
    only make motions slower: the lower bound holds with them, and no upper bound is claimed.
    """
    exact, gap = session.exact, session.request.gap
    asked = question(exact)
    answered = unanswered(exact) is None
    motion = _shorter(_given_motion(session, asked), _first_motion(session, asked))
    longest = [x for x in asked.longest if x is not None]
    bounded = len(longest) == len(asked.longest)
    if motion is not None:
        cap = sum(motion[0], Fraction(0))
    elif bounded:
        cap = sum(longest, Fraction(0)) * (1 + _ABOVE)
    else:
        return True
    search = Search(asked, cap, searching=lambda: session.searching, crew=session.crew)
    found: list[Motion] = []

    def take(better: Motion) -> None:
        found.append(better)
        session.one_sided = not answered
        if answered:
            session.answer = better[0], _all_speeds(exact, asked, better)

    def target() -> float:
        total = sum(found[-1][0]) if found else cap
        return float(total) * (1 - _SHARE * gap if found else 1.0)

    def watch(lower: float, left: int) -> None:
        session.report(left, search.nodes, lower)
        session.check_clock()

    def improve(durations: Array) -> bool:
        better = _local_motion(asked, durations)
        if better is None or (found and sum(better[0]) >= sum(found[-1][0])):
            return False
        take(better)
        return True

    if motion is not None:
        take(motion)
    pending = session.proposals or session.proof
    if pending is not None:
        search.clock = session.check_clock
        root = restored(search, pending.document(), target())
    else:
        # The first box is bounded whatever the time: without it nothing is proved.
        root = search.root(*_floats(asked, motion), target())
        search.clock = session.check_clock
    session.proposals = None
    try:
        complete = False
        while not complete:
            known = len(found)
            complete = search.grow(root, target(), watch, improve)
            if len(found) == known:
                break
    finally:
        _close(session, search, root, found[-1] if found else None)
    session.infeasible = not found and bounded and session.lower > sum(longest)
    return complete


def _close(session: Session, search: Search, root: Node, motion: Motion | None) -> None:
    """Leave the bound of all boxes, proved in rational numbers, and the motion as the answer."""
    top = search.cap if motion is None else sum(motion[0], Fraction(0))
    least = min(search.exact(leaf, DIGITS[-1])[0] for leaf in root.leaves)
    total = down(min(least, top), _DIGITS)
    if total > 0:
        session.keep(total, free_bound(search, root, total))
    wanted = float(top) * (1 - session.request.gap if motion is not None else 1.0)
    session.report(sum(leaf.lower < wanted for leaf in root.leaves), search.nodes)


ANY_CURVE = Certifier(
    "every C1 motion", lambda _: True, missing, _prove, subject=Subject.ANY, moving=True
)
"""Takes every curve, since of a curve only the velocities at its two ends count."""


def _given_motion(session: Session, asked: FreeQuestion) -> Motion | None:
    """The answer of the run that this one goes on from, proved there."""
    durations, speeds = session.answer or (None, None)
    if durations is None or speeds is None:
        return None
    return durations, tuple(tuple(row[j] for j in asked.joints) for row in speeds)


def _first_motion(session: Session, asked: FreeQuestion) -> Motion | None:
    """The best motion that the local solver finds, proved."""
    exact = session.exact
    alone = replace(
        exact,
        limits=tuple((v, a, None) for v, a, _ in exact.limits),
        position_lower=(None,) * len(exact.joints),
        position_upper=(None,) * len(exact.joints),
    )
    with session.sharing_the_time():
        known = estimate_any_curve(float_problem(alone), seed=session.request.seed)
    if known.durations is None or known.nodal_velocities is None:
        return None
    return prove_motion(asked, known.durations, known.nodal_velocities[:, list(asked.joints)])


def _shorter(one: Motion | None, other: Motion | None) -> Motion | None:
    """The motion that takes less time; the first of two that take the same."""
    if one is None or other is None:
        return one or other
    return other if sum(other[0]) < sum(one[0]) else one


def _local_motion(asked: FreeQuestion, durations: Array) -> Motion | None:
    """A locally best motion from given durations, proved."""
    bent = [j for j, (_, a) in enumerate(asked.tight) if a is not None]
    limits = np.array(
        [[np.inf if x is None else float(x) for x in asked.tight[j]] for j in bent]
    ).reshape(-1, 2)
    ends = [
        [np.nan if v is None else float(v) for v in (side[j] for j in bent)] for side in asked.ends
    ]
    core = LocalQuestion(
        np.array([[float(row[j]) for j in bent] for row in asked.steps]),
        limits[:, 0],
        limits[:, 1],
        np.array([float(asked.floor(k)) for k in range(len(asked.steps))]),
        np.array([np.inf if x is None else float(x) for x in asked.longest]),
        np.array(ends).reshape(2, -1),
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
    exact: ExactProblem, asked: FreeQuestion, answer: Motion
) -> tuple[tuple[Fraction, ...], ...]:
    """Speeds of every joint at the way-points: a joint that does not matter stands still."""
    place = {j: n for n, j in enumerate(asked.joints)}
    every = range(len(exact.joints))
    return tuple(
        tuple(row[place[j]] if j in place else Fraction(0) for j in every) for row in answer[1]
    )
