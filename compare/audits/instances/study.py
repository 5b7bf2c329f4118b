"""A relative claim on instances: optima and runs of the two procedures it compares."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ....heuristics import Algorithm, AskedRun, Run, compile_judge, in_processes, run_asked
from ....nlp import Solution
from ....nlp.optimum import solve
from ....problem import TOLERANCE, Array, Coupling, Problem, as_piecewise, check
from ...gaps import SETTLED, settled_at
from .result import Optimum, Sample

STARTS = 2
"""Starts of every solve, for there are hundreds; one where the segments are independent."""
_ROUTES = 3
"""The slower procedure, its algorithm on the faster one's curve, and the faster procedure."""


@dataclass(frozen=True, eq=False)
class Task:
    """One instance: its way-points, with a problem for both procedures under every reading."""

    step: float
    index: int
    waypoints: Array
    readings: tuple[str, ...]
    slower: tuple[Problem, ...]
    faster: tuple[Problem, ...]
    algorithms: tuple[Algorithm[Any], Algorithm[Any]]
    """Of the slower and of the faster procedure."""
    runs: int
    objectives: tuple[str, ...]


def examine(
    tasks: Iterable[Task],
    workers: int = 1,
    progress: Callable[[str], None] | None = None,
) -> tuple[Sample, ...]:
    """Solve every instance for both curves and run both procedures on it.

    Parameters
    ----------
    workers : int
        Processes; the same bits for any number of them.
    progress : callable, optional
        Called with a few words after each instance.

    Returns
    -------
    tuple of Sample
        In the order of the tasks, one for each of their readings.
    """
    todo = list(tasks)
    workers = max(1, min(workers, len(todo)))
    found: list[Sample] = []
    with ExitStack() as stack:
        results: Iterable[tuple[Sample, ...]] = map(_examined, todo)
        if workers > 1:
            for problem in (todo[0].slower[0], todo[0].faster[0]):
                compile_judge(_fast_form(problem), todo[0].objectives[0])
            results = stack.enter_context(closing(in_processes(_examined, todo, workers)))
        for done, samples in enumerate(results, start=1):
            found += samples
            if progress is not None:
                progress(f"instance {done} of {len(todo)}")
    return tuple(found)


Kept = dict[tuple[object, ...], Any]
"""What was computed already, by what tells one question from another."""


def _examined(task: Task) -> tuple[Sample, ...]:
    kept: Kept = {}
    by_slower, by_faster = task.algorithms
    routes = []
    for slow, fast in zip(task.slower, task.faster, strict=True):
        one, other = _fast_form(slow), _fast_form(fast)
        routes.append(((one, by_slower), (other, by_slower), (other, by_faster)))
    asked = [
        (problem, algorithm, objective)
        for each in routes
        for problem, algorithm in each
        for objective in task.objectives
    ]
    _run_all(kept, asked, task.runs)
    found = []
    for reading, each in zip(task.readings, routes, strict=True):
        totals = np.empty((len(task.objectives), _ROUTES, task.runs))
        settled = np.empty(totals.shape, dtype=np.intp)
        for at, objective in enumerate(task.objectives):
            for r, (problem, algorithm) in enumerate(each):
                for seed in range(task.runs):
                    ran = kept[(*_key(problem), algorithm, seed, objective)]
                    totals[at, r, seed], settled[at, r, seed] = ran
        totals.setflags(write=False)
        settled.setflags(write=False)
        (one, _), (other, _), _ = each
        found.append(
            Sample(
                reading=reading,
                step=task.step,
                index=task.index,
                waypoints=task.waypoints,
                slower=_optimum(kept, one),
                faster=_optimum(kept, other),
                totals=totals,
                settled=settled,
            )
        )
    return tuple(found)


def _fast_form(problem: Problem) -> Problem:
    """The problem with shared durations, its curve in the form that is evaluated fastest."""
    curve = problem.curve.polynomial_form()
    return replace(problem, curve=curve, coupling=Coupling.SHARED)


def _key(problem: Problem) -> tuple[object, ...]:
    """What tells one problem through the same way-points from another."""
    limits = problem.limits
    arrays = (
        limits.sides if limits.uneven else limits.derivatives,
        limits.position_lower,
        limits.position_upper,
        problem.duration_lower,
        problem.duration_upper,
        problem.waypoints,
    )
    return (problem.curve, *(array.tobytes() for array in arrays))


def _run_all(kept: Kept, asked: Iterable[tuple[Problem, Algorithm[Any], str]], runs: int) -> None:
    """Keep what every run gives, each once: all runs of an algorithm are moved side by side."""
    todo: dict[Algorithm[Any], dict[tuple[object, ...], AskedRun]] = {}
    for problem, algorithm, objective in asked:
        for seed in range(runs):
            key = (*_key(problem), algorithm, seed, objective)
            # The first of equal problems stands for all, so that neighbours are judged together.
            one = AskedRun(problem, seed, (), objective)
            todo.setdefault(algorithm, {}).setdefault(key, one)
    for algorithm, questions in todo.items():
        ran = run_asked(algorithm, list(questions.values()))
        for (key, question), done in zip(questions.items(), ran, strict=True):
            kept[key] = _judged(question.problem, done)


def _judged(problem: Problem, done: Run) -> tuple[float, int]:
    """Total of one run, inf without an answer that keeps its limits, and when it settled."""
    total = done.reported_time
    if np.isfinite(total) and check(problem, done.durations).max_violation > TOLERANCE:
        total = np.inf
    return total, settled_at(done.trace, SETTLED * total)


def _optimum(kept: Kept, problem: Problem) -> Optimum:
    key = _key(problem)
    if key not in kept:
        polynomials = as_piecewise(problem.curve)
        alone = polynomials is not None and set(polynomials.continuity) <= {0}
        kept[key] = _ended(solve(problem, starts=1 if alone else STARTS))
    known: Optimum = kept[key]
    return known


def _ended(solution: Solution) -> Optimum:
    words = f"{solution.status}" + (f" ({solution.why})" if solution.why else "")
    total = solution.total_time if solution.infimum is None else solution.infimum
    return Optimum(total, solution.evidence, words)
