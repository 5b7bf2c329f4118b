"""One kind of proof, as a run needs it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import ClassVar

from ...verify import OutOfTime, Subject
from .exact import ExactProblem
from .outcome import Certified, Outcome, Request
from .session import Session


@dataclass(frozen=True)
class Certifier:
    """One kind of proof, as a run needs it.

    Attributes
    ----------
    family : str
        Words for the curves that it covers.
    declares : callable
        Whether a problem's curve is of its kind.
    missing : callable
        Why such a problem is not covered all the same, or None.
    prove : callable
        Raises the bound of a session, and returns whether nothing is left to do. Keyboard
        interrupts and `OutOfTime` end it.
    subject : Subject
        What its interval speaks about.
    instant : bool
        Whether it is a closed form.
    boxes : int
        Boxes that an audit allows a problem of seven segments by default: some ten seconds' worth,
        measured where nothing else ran.
    prepares : bool
        Whether a search begins with what takes seconds for long curves, too long for an answer that
        was not asked to be proved.
    sided : bool
        Whether its bounds know lower and upper limits that differ in size. If not, they are proved
        within the larger of both, which is sound and wider.
    moving : bool
        Whether derivatives may be prescribed other than 0.
    first : Certifier or None
        Another kind, which a run begins with where it covers the problem and the gap is below
        `narrow`: there it closes most problems sooner, and some not at all.
    """

    narrow: ClassVar[float] = 1e-3
    """Seven segments of cubics took boxes of durations 1.1 to 1.5 times as many for a gap of 1e-6
    as for 1e-2, and the kind of their own 4 to 300 times."""

    family: str
    declares: Callable[[ExactProblem], bool]
    missing: Callable[[ExactProblem], str | None]
    prove: Callable[[Session], bool]
    subject: Subject = Subject.DECLARED
    instant: bool = False
    boxes: int = 1
    prepares: bool = False
    sided: bool = False
    moving: bool = False
    first: Certifier | None = None

    def allowance(self, exact: ExactProblem) -> int:
        """Boxes that an audit allows a problem by default.

        What is computed of a box grows with the square of the segments, of four and more.
        """
        n = exact.segments
        return self.boxes * max(7, n) ** 2 // max(4, n) ** 2

    def run(self, exact: ExactProblem, request: Request) -> Certified:
        """Prove an interval of the optimum; the time limit and Ctrl-C end it with what is proved.

        Raises
        ------
        TrajgapError
            If the state to go on from does not prove what it says.
        """
        if exact.pairs and not self.sided:
            return self._run_wider(exact, request)
        session = Session(exact, request)
        try:
            complete = self._begun(session) or self.prove(session)
        except (KeyboardInterrupt, OutOfTime):
            complete = False
        return session.result(complete, self.subject)

    def _begun(self, session: Session) -> bool:
        """Whether the kind that a run begins with leaves nothing to do.

        It has half of the time, and of the boxes that an audit allows it the share that the run has
        of its own. A run that goes on from a state leaves it out: what the state proposes is of the
        kind behind.
        """
        exact, request, first = session.exact, session.request, self.first
        if first is None or request.resume is not None or request.gap >= self.narrow:
            return False
        # Of nine and ten segments boxes closed none of four splines in 25 s, their own kind two.
        if exact.segments > 8 or not first.declares(exact):
            return False
        share = min(1.0, request.boxes / self.allowance(exact))
        with session.part(share * first.allowance(exact), 0.5):
            return first.prove(session)
        return False

    def _run_wider(self, exact: ExactProblem, request: Request) -> Certified:
        """A bound proved within the larger size of both sides, and an answer that keeps both.

        Of any curve there is an answer to the wider problem alone, which is left out.
        """
        session = Session(exact, request)
        own = self.subject is Subject.DECLARED
        clock = request.clock.share(0.5 if own else 1.0)  # the rest is for the search of an answer
        wide = self.run(exact.even, replace(request, clock=clock))
        if wide.outcome is Outcome.INFEASIBLE:
            session.infeasible = True
        if wide.proof is not None:
            session.keep(wide.lower, wide.proof)
        session.proposals, session.nodes = wide.proposals, wide.nodes
        session.open_boxes, session.one_sided = wide.open_boxes, not own
        if own and not session.infeasible:
            with suppress(KeyboardInterrupt, OutOfTime):
                session.seek()
        found = session.result(False, self.subject)
        return replace(found, stopped=wide.stopped, proposals=wide.proposals, widened=True)
