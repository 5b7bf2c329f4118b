"""Optima and replays of an audit, kept in a folder of the user's for later ones."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from itertools import islice
from typing import Any, NamedTuple, cast

import numpy as np

from ...heuristics import (
    Algorithm,
    AskedRun,
    JointRuns,
    Run,
    joined_runs,
    run_as_left,
    run_asked,
    run_many,
    run_many_per_joint,
)
from ...nlp import Route, Solution, Status, kkt, problem_seal, with_other_route
from ...nlp.optimum import KKT_TOLERANCE, SAME_TOTAL, STARTS, solve
from ...nlp.proofs import KeptFiles, as_text, code_hash, folder_of, from_text, search_code
from ...problem import Array, Coupling, Problem, TrajgapError, Verdict, check


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
            _left_of_optimum,
            lambda at, left: _judged_optimum(asked[at], left),
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


def _left_of_optimum(found: Solution) -> list[Any]:
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


def _judged_optimum(asked: AskedOptimum, left: Sequence[Any]) -> Solution:
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


# --- replays --------------------------------------------------------------------------------------


Replays = tuple[Run, ...] | tuple[JointRuns, ...]
"""Runs of one algorithm, one for each seed: of all joints, or of each joint separately."""


class AskedReplay(NamedTuple):
    """One run that an audit asks for."""

    algorithm: Algorithm[Any]
    question: AskedRun


class KeptReplays(KeptFiles):
    """The replays that are kept in one folder."""

    kind = "runs"

    def runs(
        self, asked: Sequence[AskedReplay], compute: Callable[[], Iterable[Run]]
    ) -> tuple[Run, ...]:
        """The runs that are asked for: those of an earlier audit, or else made now and kept.

        Parameters
        ----------
        asked : sequence of AskedReplay
            A group that is kept, judged and discarded as a whole.
        """
        return self.answers(
            lambda: _question(asked),
            len(asked),
            compute,
            _left_of_run,
            lambda at, left: _judged_run(*asked[at], *left),
            lambda at: run_asked(asked[at].algorithm, [asked[at].question])[0],
        )

    def replayed(
        self,
        problem: Problem,
        algorithms: Mapping[str, Algorithm[Any]],
        seeds: int,
        workers: int | None,
        progress: Callable[[str], None],
    ) -> dict[str, Replays]:
        """Replays of some algorithms on one problem, as one group.

        Parameters
        ----------
        problem : Problem
            With its coupling: joints by themselves are searched apart.
        algorithms : mapping
            Each under what it is called.
        seeds : int
            Counted from 0.
        workers : int or None
            Processes; as many as pay if None.
        progress : callable
            Called with what an algorithm is called before it runs.
        """
        apart = problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1
        single = [problem.joint(j) for j in range(len(problem.joints))] if apart else [problem]
        asked = [
            AskedReplay(one, AskedRun(each, seed, (j,) if apart else ()))
            for one in algorithms.values()
            for seed in range(seeds)
            for j, each in enumerate(single)
        ]

        def compute() -> Iterator[Run]:
            for called, one in algorithms.items():
                progress(called)
                # Fewer iterations take some seconds side by side, and each process takes two to
                # import what it needs.
                worth = (os.cpu_count() or 1) if seeds * one.iterations >= 50_000 else 1
                use = worth if workers is None else workers
                if apart:
                    for joints in run_many_per_joint(one, problem, range(seeds), use):
                        yield from joints.runs
                else:
                    yield from run_many(one, problem, range(seeds), use)

        runs = iter(self.runs(asked, compute))
        found: dict[str, Replays] = {}
        for called in algorithms:
            mine = [tuple(islice(runs, len(single))) for _ in range(seeds)]
            found[called] = (
                tuple(joined_runs(problem, seed, each) for seed, each in enumerate(mine))
                if apart
                else tuple(each[0] for each in mine)
            )
        return found


def _question(asked: Sequence[AskedReplay]) -> dict[str, Any]:
    """All that the bits of the runs depend on."""
    seals: dict[Problem, list[str]] = {}
    for _, one in asked:
        if one.problem not in seals:
            seals[one.problem] = [problem_seal(one.problem), repr(one.problem.curve)]
    number = {problem: at for at, problem in enumerate(seals)}
    settings = {algorithm: _settings(algorithm) for algorithm, _ in asked}
    return {
        "problems": list(seals.values()),
        "runs": [
            [settings[algorithm], number[q.problem], q.seed, list(q.stream), str(q.handling)]
            for algorithm, q in asked
        ],
        "code": code_hash(folder_of(TrajgapError), folder_of(Run)),
    }


def _settings(algorithm: Algorithm[Any]) -> list[str]:
    """An algorithm's kind and each of its settings, the number of iterations among them."""
    said = [f"{f.name} {getattr(algorithm, f.name)!r}" for f in fields(cast(Any, algorithm))]
    return [algorithm.kind, repr(float(algorithm.penalty)), str(algorithm.iterations), *said]


def _left_of_run(run: Run) -> list[Any]:
    """What a search left, as text: its position, its evaluations, and where its trace falls."""
    falls = [0, *(1 + np.flatnonzero(run.trace[1:] < run.trace[:-1])).tolist()]
    return [as_text(run.position), run.evaluations, falls, as_text(run.trace[falls])]


def _judged_run(
    algorithm: Algorithm[Any],
    question: AskedRun,
    position: str,
    evaluations: int,
    falls: list[int],
    totals: str,
) -> Run:
    """The run that left this; raises if it is not what such a search leaves."""
    trace = np.empty(algorithm.iterations + 1)
    for start, total in zip(falls, from_text(totals), strict=True):
        trace[start:] = total
    return run_as_left(algorithm, question, trace, from_text(position), evaluations)
