"""Optima of an audit, kept in a folder of the user's for later ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ...nlp import Route, Solution, Status, kkt, problem_seal, with_other_route
from ...nlp.optimum import KKT_TOLERANCE, SAME_TOTAL, STARTS, solve
from ...nlp.proofs import KeptFiles, as_text, from_text, search_code
from ...problem import Array, Problem, Verdict, check


class AskedOptimum(NamedTuple):
    """A problem, and what `solve` is given beside it."""

    problem: Problem
    starts: int = STARTS
    known: Array | None = None
    known_nodal: Array | None = None
    lower: float = 0.0
    other_route: bool = False
    """Whether the answer needs the total of the other route, see `with_other_route`."""

    def words(self) -> list[Any]:
        """All that the answer depends on beside the code, JSON-ready without floats."""
        given = [None if one is None else [one.shape, as_text(one.ravel())] for one in self[2:4]]
        own = [problem_seal(self.problem), repr(self.problem.curve), self.starts]
        return [*own, *given, repr(self.lower), self.other_route]


class KeptOptima(KeptFiles):
    """The optima that are kept in one folder."""

    kind = "optima"

    def solved(self, asked: Sequence[AskedOptimum], again: bool = True) -> Sequence[Solution]:
        """Answers of `solve`: those of an earlier audit, or else found now and kept.

        Parameters
        ----------
        asked : sequence of AskedOptimum
            A group that is kept, judged and discarded as a whole.
        again : bool
            Whether some of the searches are made again, as `KeptFiles.answers` does. Check and
            optimality conditions judge every answer either way.
        """
        return self.answers(
            lambda: {"problems": [one.words() for one in asked], "code": search_code()},
            len(asked),
            lambda: map(_solved, asked),
            _left,
            lambda at, left: _judged(asked[at], left),
            (lambda at: _solved(asked[at])) if again else None,
        )

    def optimum(self, asked: AskedOptimum) -> Solution:
        """Answer of `solve` to one question; raises what `solve` raises."""
        (found,) = self.solved([asked], again=False)
        return found


def _solved(asked: AskedOptimum) -> Solution:
    found = solve(
        asked.problem,
        starts=asked.starts,
        known=asked.known,
        known_nodal=asked.known_nodal,
        lower=asked.lower,
    )
    return with_other_route(found) if asked.other_route else found


def _left(found: Solution) -> list[Any]:
    durations = as_text(found.durations) if found.found else None
    nodal = None if found.nodal is None else as_text(found.nodal.ravel())
    search = [found.starts, found.starts_at_best, found.iterations, *map(repr, found.totals)]
    return [
        str(found.status),
        found.why,
        durations,
        repr(found.infimum),
        repr(found.lower_bound),
        nodal,
        None if found.route is None else str(found.route),
        None if found.other_total is None else repr(found.other_total),
        repr(found.kkt_residual),
        repr(found.active),
        search,
    ]


def _judged(asked: AskedOptimum, left: Sequence[Any]) -> Solution:
    """The answer that left this; raises if its durations do not bear out its status.

    What no durations bear out is searched for again: that there are none, or that the other route
    ends elsewhere.
    """
    status, why, durations, _, _, nodal, route, other, *_, search = left
    if status not in (Status.CONVERGED, Status.FEASIBLE):
        return _solved(asked)
    problem, h = asked.problem, from_text(durations)
    other_total = None if other is None else float(other)
    if other_total is not None and abs(other_total - h.sum()) > SAME_TOTAL * h.sum():
        return _solved(asked)
    free = None if nodal is None else from_text(nodal).reshape(problem.curve.free, -1)
    verdict = check(problem, h, free)
    if verdict.limits is not Verdict.PASS:
        raise ValueError("durations that break a limit")
    report = kkt(problem, h, free)
    if status == Status.CONVERGED and report.residual > KKT_TOLERANCE:
        raise ValueError("no optimum")
    starts, at_best, iterations, *totals = search
    return Solution(
        problem,
        Status(status),
        why,
        h,
        verdict,
        nodal=free,
        route=Route(route),
        other_total=other_total,
        kkt_residual=report.residual,
        active=report.active,
        starts=int(starts),
        starts_at_best=int(at_best),
        iterations=int(iterations),
        totals=tuple(map(float, totals)),
    )
