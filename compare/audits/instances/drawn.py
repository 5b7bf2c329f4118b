"""A relative claim on instances: their problems, optima, and runs of the compared procedures."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any, cast

import numpy as np

from ....heuristics import Algorithm, AskedRun, Run, run_asked
from ....nlp import Solution
from ....problem import (
    TOLERANCE,
    Array,
    CaseError,
    Coupling,
    Problem,
    ProcessError,
    TrajgapError,
    as_piecewise,
    check,
    in_processes,
)
from ....problem.cases import Claim, ImprovementClaim, InstancesBlock, instance_waypoints
from ...documents import Procedure
from ...gaps import SETTLED, settled_at
from ..kept_answers import AskedOptimum, AskedReplay, KeptOptima, KeptReplays
from ..study import Study
from .result import InstancesResult, Optimum, Sample

STARTS = 2
"""Starts of every solve, for there are hundreds; one where the segments are independent."""


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
    replays: KeptReplays
    optima: KeptOptima

    @property
    def searches(self) -> int:
        """How often something had to be searched, in this process."""
        return self.replays.searches + self.optima.searches


def examine(
    tasks: Iterable[Task], workers: int = 1, progress: Callable[[str], None] | None = None
) -> tuple[Sample, ...]:
    """Solve every instance for both curves and run both procedures on it.

    Samples have the order of the tasks, one for each of their readings.

    Parameters
    ----------
    workers : int
        Processes; the same bits for any number of them.
    progress : callable, optional
        Called with a few words after each instance.
    """
    todo = list(tasks)
    found: list[Sample] = []
    with closing(_each(todo, workers)) as results:
        for done, samples in enumerate(results, start=1):
            found += samples
            if progress is not None:
                progress(f"instance {done} of {len(todo)}")
    return tuple(found)


def _each(todo: Sequence[Task], workers: int) -> Generator[tuple[Sample, ...], None, None]:
    """Samples of each task: of the first here, so that what all call is compiled once.

    The others are spread over processes if it had to search: what an earlier audit left takes less
    than the start of a process.
    """
    first, *others = todo
    before = first.searches
    yield _of_task(first)
    if first.searches > before and min(workers, len(others)) > 1:
        yield from in_processes(_of_task, others, min(workers, len(others)))
    else:
        yield from map(_of_task, others)


Key = tuple[object, ...]
"""What tells one question from another."""


def _of_task(task: Task) -> tuple[Sample, ...]:
    by_slower, by_faster = task.algorithms
    # The slower procedure, its algorithm on the faster one's curve, and the faster procedure.
    routes = []
    for slow, fast in zip(task.slower, task.faster, strict=True):
        one, other = _fast_form(slow), _fast_form(fast)
        routes.append(((one, by_slower), (other, by_slower), (other, by_faster)))
    ran = _runs(task, [route for each in routes for route in each])
    solved = _optima(task, [problem for each in routes for problem, _ in each])
    found = []
    for reading, each in zip(task.readings, routes, strict=True):
        shape = len(task.objectives), len(each), task.runs
        ended = np.empty((*shape, 2))
        for at, r, seed in np.ndindex(shape):
            problem, algorithm = each[r]
            ended[at, r, seed] = ran[(*_key(problem), algorithm, seed, task.objectives[at])]
        ended.setflags(write=False)
        found.append(
            Sample(
                reading=reading,
                step=task.step,
                index=task.index,
                waypoints=task.waypoints,
                slower=solved[_key(each[0][0])],
                faster=solved[_key(each[1][0])],
                totals=ended[..., 0],
                settled=ended[..., 1].astype(np.intp),
            )
        )
    return tuple(found)


def _fast_form(problem: Problem) -> Problem:
    """The problem with shared durations, its curve in the form that is evaluated fastest."""
    curve = problem.curve.polynomial_form()
    return replace(problem, curve=curve, coupling=Coupling.SHARED)


def _key(problem: Problem) -> Key:
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


def _runs(
    task: Task, routes: Iterable[tuple[Problem, Algorithm[Any]]]
) -> dict[Key, tuple[float, int]]:
    """What every run gives, each once: all runs of an algorithm are moved side by side."""
    todo: dict[Algorithm[Any], dict[Key, AskedRun]] = {}
    for problem, algorithm in routes:
        for objective, seed in product(task.objectives, range(task.runs)):
            key = (*_key(problem), algorithm, seed, objective)
            # The first of equal problems stands for all, so neighbours are judged together.
            one = AskedRun(problem, seed, (), objective)
            todo.setdefault(algorithm, {}).setdefault(key, one)
    found = {}
    for algorithm, questions in todo.items():
        together = list(questions.values())
        named = [AskedReplay(algorithm, one) for one in together]
        ran = task.replays.runs(named, partial(run_asked, algorithm, together))
        for (key, question), done in zip(questions.items(), ran, strict=True):
            found[key] = _judged(question.problem, done)
    return found


def _judged(problem: Problem, done: Run) -> tuple[float, int]:
    """Total of one run, inf without an answer that keeps its limits, and when it settled."""
    total = done.reported_time
    if np.isfinite(total) and check(problem, done.durations).max_violation > TOLERANCE:
        total = np.inf
    return total, settled_at(done.trace, SETTLED * total)


def _optima(task: Task, problems: Iterable[Problem]) -> dict[Key, Optimum]:
    """The optimum of every problem, each once."""
    asked: dict[Key, AskedOptimum] = {}
    for problem in problems:
        polynomials = as_piecewise(problem.curve)
        alone = polynomials is not None and set(polynomials.continuity) <= {0}
        asked.setdefault(_key(problem), AskedOptimum(problem, 1 if alone else STARTS))
    solved = task.optima.solved(list(asked.values()))
    return dict(zip(asked, map(_ended, solved), strict=True))


def _ended(solution: Solution) -> Optimum:
    words = f"{solution.status}" + (f" ({solution.why})" if solution.why else "")
    total = solution.total_time if solution.infimum is None else solution.infimum
    return Optimum(total, solution.evidence, words)


def _claimed(study: Study, block: InstancesBlock) -> ImprovementClaim:
    return cast(ImprovementClaim, study.case.claim(block.claim))


def _sides(study: Study, block: InstancesBlock) -> tuple[Claim, Claim]:
    claim = _claimed(study, block)
    return study.case.claim(claim.slower), study.case.claim(claim.faster)


def _procedure(study: Study, side: Claim) -> Procedure:
    # A case file names both; the problem may be its only one.
    return Procedure(
        problem=side.problem or study.case.problems[0].id, algorithm=cast(str, side.algorithm)
    )


def readings_of(study: Study, block: InstancesBlock) -> tuple[str, ...]:
    """Selected readings of a design; none if an algorithm is not implemented."""
    sides = [_procedure(study, side) for side in _sides(study, block)]
    if any(study.algorithm(side.algorithm) is None for side in sides):
        return ()
    wanted = block.readings or tuple(reading.id for reading in study.case.readings)
    return tuple(r for r in wanted if all((side.problem, r) in study.selected for side in sides))


def printed_reduction(study: Study, block: InstancesBlock) -> tuple[float, float] | None:
    """Smallest and largest reduction that the printed digits allow, as shares of the slower total.

    They follow from the printed percentage, else from the two totals, if either is printed.
    """
    claim = _claimed(study, block)
    if claim.percent is not None:
        return float(claim.percent.lower) / 100, float(claim.percent.upper) / 100
    rid = readings_of(study, block)[0]
    slow, fast = (study.claim_total(side, rid) for side in _sides(study, block))
    if slow is None or fast is None:
        return None
    (slow_low, slow_high), (fast_low, fast_high) = slow.interval, fast.interval
    return 1 - fast_high / slow_low, 1 - fast_low / slow_high


def examinable(study: Study) -> tuple[InstancesBlock, ...]:
    """Designs of instances of which both problems and some reading are selected.

    All of it is implemented, and can be replayed.
    """
    declared = (block for block in study.case.instances if readings_of(study, block))
    return tuple(block for block in declared if unexamined(study, block) is None)


def unexamined(study: Study, block: InstancesBlock) -> str | None:
    """Why the two procedures of a design cannot be run on its instances; None if they can."""
    try:
        examined(study, block)
    except (CaseError, ProcessError):
        raise
    except TrajgapError as error:
        return str(error)
    return None


def examined(study: Study, block: InstancesBlock) -> InstancesResult:
    """What the two procedures of an improvement do on instances that are drawn for it, once.

    Raises
    ------
    CaseError
        If no instance can be drawn at a step.
    """
    own = study.drawing
    return own.once(("instances", block.id), lambda: _examined(own, block))


def _examined(study: Study, block: InstancesBlock) -> InstancesResult:
    """Draw instances, make their problems under their readings, and examine them."""
    what = f"instances {block.id}"
    study.progress(what)
    case = study.case
    slower, faster = (_procedure(study, side) for side in _sides(study, block))
    first, last = (
        cast(Algorithm[Any], study.algorithm(side.algorithm)) for side in (slower, faster)
    )
    readings = readings_of(study, block)
    chain = case.chain()
    assert chain is not None
    count = case.statement(faster.problem, readings[0]).waypoints.number
    try:
        drawn = instance_waypoints(block, chain, case.robot.joints, count)
    except TrajgapError as error:
        raise CaseError(case.file, f"families.{block.id}", str(error)) from None
    tasks = [
        Task(
            step=step,
            index=index,
            waypoints=points,
            readings=readings,
            slower=tuple(case.statement(slower.problem, r).problem_at(points) for r in readings),
            faster=tuple(case.statement(faster.problem, r).problem_at(points) for r in readings),
            algorithms=(first, last),
            runs=block.runs,
            objectives=block.objectives,
            replays=study.kept_replays,
            optima=study.kept_optima,
        )
        for step, instances in zip(block.lengths, drawn, strict=True)
        for index, points in enumerate(instances)
    ]
    slow, fast = (study.claim_total(side, readings[0]) for side in _sides(study, block))
    return InstancesResult(
        block=block,
        slower=slower,
        faster=faster,
        printed=printed_reduction(study, block),
        readings=readings,
        iterations=last.iterations,
        samples=examine(
            tasks,
            study.options.workers or os.cpu_count() or 1,
            lambda done: study.progress(f"{what}, {done}"),
        ),
        printed_totals=(slow and slow.shown, fast and fast.shown),
        labels=study.case.labels,
    )
