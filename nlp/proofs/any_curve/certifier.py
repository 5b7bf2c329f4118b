"""A proved interval for the least total of all motions through the way-points."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from ....problem import Array
from ....verify import Subject
from ..answer import float_problem
from ..certifier import Certifier
from ..document import stated_problem
from ..driver import grow
from ..rounding import down
from ..session import Session, Shorter
from .estimate import estimate_any_curve
from .proof import DIGITS, free_bound, regrown
from .question import FreeQuestion, Motion, keeps, missing, prove_motion, question
from .search import Cutting, Node, Search


class _Run:
    """The best motion of one run, and the boxes that are cut below it."""

    def __init__(self, session: Session) -> None:
        self.session, self.asked = session, question(session.exact)
        self.stated = stated_problem(session.exact)
        self.longest = [x for x in self.asked.longest if x is not None]
        self.bounded = len(self.longest) == len(self.asked.longest)
        self.motion: Motion | None = None
        with session.sharing_the_time():
            first = self._local()
        for found in (session.answer, first):
            if found is not None and found[1] is not None:
                self.take((found[0], found[1]))

    def take(self, motion: Motion) -> bool:
        """Take a motion as the answer if it is the shortest; one that is none bounds all the same.

        Limits of jerk and position only make motions slower: an answer has to keep them too.
        """
        if self.motion is not None and sum(motion[0]) >= sum(self.motion[0]):
            return False
        self.motion = motion
        self.session.one_sided = not keeps(self.stated, motion)
        if not self.session.one_sided:
            self.session.answer = motion
        return True

    def _local(self, durations: Array | None = None) -> Motion | None:
        """The best motion of the local solver, proved: from given durations or its own starts."""
        exact = self.session.exact
        free = (None,) * len(exact.joints)
        alone = replace(
            exact,
            limits=tuple((v, a, None) for v, a, _ in exact.limits),
            position_lower=free,
            position_upper=free,
        )
        problem, seed = float_problem(alone), self.session.request.seed
        if durations is None:
            known = estimate_any_curve(problem, seed=seed)
        else:
            pieces = np.diff(problem.curve.waypoint_breaks)
            start = np.repeat(durations / pieces, pieces)
            known = estimate_any_curve(problem, starts=0, initial=start)
        if known.durations is None or known.nodal_velocities is None:
            return None
        speeds = known.nodal_velocities[:, list(self.asked.joints)]
        return prove_motion(self.asked, known.durations, speeds)

    def cap(self) -> Fraction | None:
        """Totals below it are looked at, s; None if there is neither answer nor bound."""
        if self.motion is not None:
            return sum(self.motion[0], Fraction(0))
        # A proof that nothing is feasible must get above the sum of all longest durations.
        most = sum(self.longest, Fraction(0)) * (1 + Fraction(1, 2**20))
        return most if self.bounded else None

    def target(self, cap: Fraction) -> float:
        """What is enough for every box, s: nine tenths of the gap leave room for rounding."""
        if self.motion is None:
            return float(cap)
        return float(sum(self.motion[0])) * (1 - 0.9 * self.session.request.gap)

    def improve(self, durations: Array) -> None:
        """Raise `Shorter` if a motion that is shorter lies near durations."""
        better = self._local(durations)
        if better is not None and self.take(better):
            raise Shorter(durations)

    def close(self, search: Search, root: Node) -> None:
        """Leave the bound of all boxes, proved in rational numbers."""
        cap = search.cap if self.motion is None else sum(self.motion[0], Fraction(0))
        least = min(search.exact(leaf, DIGITS[-1])[0] for leaf in root.leaves)
        total = down(min(least, cap), 15)  # digits of a double
        if total > 0:
            self.session.keep(total, free_bound(search, root, total))
        gap = self.session.request.gap if self.motion is not None else 0.0
        wanted = float(cap) * (1.0 - gap)
        self.session.report(sum(leaf.lower < wanted for leaf in root.leaves), search.nodes)


def _prove(session: Session) -> bool:
    """Raise the least bound of all boxes until it is near the best motion.

    Of the curve only the velocities prescribed at its two ends count. Limits of jerk and position
    only make motions slower: the lower bound holds with them, and no upper bound is claimed.
    """
    run = _Run(session)
    cap = run.cap()
    if cap is None:
        return True
    search, looks = Search(run.asked, cap), iter(range(Search.effort.looks))
    pending = session.proposals or session.proof
    if pending is not None:
        document = pending.document()
        with session.searching():
            root = session.read(lambda: regrown(search, document, run.target(cap)))
    else:
        # The first box is bounded whatever the time: without it nothing is proved.
        root = search.root(*_floats(run.asked, run.motion), run.target(cap))
    session.proposals = None

    def watch(waiting: int, lowest: float) -> None:
        session.report(waiting, search.nodes, lowest)

    def improve(durations: Array) -> None:
        if next(looks, None) is not None:
            run.improve(durations)

    try:
        while True:
            cutting = Cutting(search, run.target(cap), watch, improve)
            try:
                grow(
                    cutting, (leaf for leaf in root.leaves if leaf.lower < cutting.target), session
                )
                break
            except Shorter:
                continue
    finally:
        run.close(search, root)
    session.infeasible = run.motion is None and run.bounded and session.lower > sum(run.longest)
    return not cutting.stuck


ANY_CURVE = Certifier(
    "every C1 motion", lambda _: True, missing, _prove, subject=Subject.ANY, boxes=200, moving=True
)
"""Takes every curve, because of a curve only the velocities at its two ends count."""


def _floats(asked: FreeQuestion, motion: Motion | None) -> tuple[Array, Array]:
    if motion is None:
        h = [1.0 if x is None else float(x) for x in asked.longest]
        return np.array(h), np.zeros((len(h) + 1, len(asked.joints)))
    return (
        np.array([float(x) for x in motion[0]]),
        np.array([[float(row[j]) for j in asked.joints] for row in motion[1]]),
    )
