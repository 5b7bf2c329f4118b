"""Replays of an audit, kept in a folder of the user's for later ones.

Each answer is judged again by the objective that the search had, see `KeptFiles.answers`.
"""

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
from ...nlp import problem_seal
from ...nlp.proofs import KeptFiles, as_text, code_hash, folder_of, from_text
from ...problem import Coupling, Problem, TrajgapError

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
            _left,
            lambda at, left: _judged(*asked[at], *left),
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


def _left(run: Run) -> list[Any]:
    """What a search left, as text: its position, its evaluations, and where its trace falls."""
    falls = [0, *(1 + np.flatnonzero(run.trace[1:] < run.trace[:-1])).tolist()]
    return [as_text(run.position), run.evaluations, falls, as_text(run.trace[falls])]


def _judged(
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
