"""The one loop: an algorithm on a problem, with its seed, budget and best-so-far trace."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from typing import Any, TypeVar, cast

import numpy as np

from ..problem import Problem, TrajgapError
from .algorithm import Algorithm, S, State
from .objective import Bounds, Counted, DeathPenalty, Objective
from .result import JointRuns, Run
from .settings import whole


def states(
    algorithm: Algorithm[S], objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> Iterator[S]:
    """Every state of one search: the initial one, then one per iteration.

    Parameters
    ----------
    algorithm : Algorithm
    objective : callable
        Maps positions, shape (batch, dimensions), to fitness, shape (batch,).
    bounds : Bounds
    rng : numpy.random.Generator
        The only source of randomness.
    """
    # A swarm without a velocity limit may leave every range; what overflows is infeasible.
    with np.errstate(over="ignore", invalid="ignore"):
        state = algorithm.init(bounds, rng, objective)
    yield state
    for _ in range(algorithm.iterations):
        with np.errstate(over="ignore", invalid="ignore"):
            state = algorithm.step(state, bounds, rng, objective)
        yield state


def _whole(name: str, value: object, least: int) -> int:
    try:
        return whole(least)(value)
    except TrajgapError as error:
        raise TrajgapError(f"{name}: {error}") from None


def _with_budget(algorithm: Algorithm[S], iterations: int | None) -> Algorithm[S]:
    if iterations is None:
        return algorithm
    return cast(Algorithm[S], replace(cast(Any, algorithm), iterations=iterations))


def _run(algorithm: Algorithm[Any], problem: Problem, seed: int, stream: tuple[int, ...]) -> Run:
    objective = Counted(DeathPenalty(problem, algorithm.penalty))
    # Named, not numpy's default, which may change: the same seed must give the same bits.
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=stream)))
    trace = np.empty(algorithm.iterations + 1)
    state: State
    for i, state in enumerate(states(algorithm, objective, Bounds.of(problem), rng)):
        trace[i] = state.best_fitness
    trace[trace >= algorithm.penalty] = np.inf
    feasible = bool(np.isfinite(trace[-1]))
    durations = np.array(state.best)
    return Run(
        algorithm=algorithm.kind,
        settings=algorithm,
        problem=problem.name,
        seed=seed,
        stream=stream,
        durations=durations,
        reported_time=float(trace[-1]),
        trace=trace,
        evaluations=objective.evaluations,
        iterations=algorithm.iterations,
        feasible=feasible,
    )


def run(
    algorithm: Algorithm[Any], problem: Problem, seed: int, iterations: int | None = None
) -> Run:
    """Search one duration vector for all joints of a problem.

    Parameters
    ----------
    algorithm : Algorithm
        Such as ``PSO()``, or what `from_settings` returns.
    problem : Problem
        Its coupling is not looked at; see `run_per_joint`.
    seed : int
        0 or more.
    iterations : int, optional
        Replaces the algorithm's own.

    Returns
    -------
    Run

    Raises
    ------
    TrajgapError
        If the seed or budget is not a whole number, or the objective cannot judge the problem
        (see `DeathPenalty`).

    Examples
    --------
    >>> from trajgap.problem import Limits, Problem, three_five_three
    >>> from trajgap.heuristics import PSO, run
    >>> waypoints = [[0.1, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
    >>> problem = Problem(waypoints, Limits(6.0, 8.0, joints=2), three_five_three())
    >>> run(PSO(), problem, seed=1).feasible
    True
    """
    return _run(_with_budget(algorithm, iterations), problem, _whole("seed", seed, 0), ())


def run_per_joint(
    algorithm: Algorithm[Any], problem: Problem, seed: int, iterations: int | None = None
) -> JointRuns:
    """Search each joint by itself; each segment then takes the longest duration.

    Source: `puma560-mnam-pso-353`, section 4.1.

    Parameters
    ----------
    algorithm : Algorithm
    problem : Problem
    seed : int
        Joint ``i`` draws from child stream ``i`` of the seed, as ``SeedSequence(seed).spawn``.
    iterations : int, optional
        Replaces the algorithm's own.

    Returns
    -------
    JointRuns

    Raises
    ------
    TrajgapError
        As `run`.
    """
    root = _whole("seed", seed, 0)
    record = _with_budget(algorithm, iterations)
    runs = tuple(_run(record, problem.joint(j), root, (j,)) for j in range(len(problem.joints)))
    durations = np.max([one.durations for one in runs], axis=0)
    feasible = all(one.feasible for one in runs)
    return JointRuns(
        algorithm=record.kind,
        problem=problem.name,
        seed=root,
        runs=runs,
        durations=durations,
        reported_time=float(durations.sum()) if feasible else np.inf,
        feasible=feasible,
    )


R = TypeVar("R")


def _each(
    one: Callable[[int], R],
    seeds: Iterable[int],
    workers: int,
    progress: Callable[[R], None] | None,
) -> tuple[R, ...]:
    checked = [_whole("seed", seed, 0) for seed in seeds]
    workers = min(_whole("workers", workers, 1), max(1, len(checked)))
    collected = []
    with ExitStack() as stack:
        results: Iterable[R] = map(one, checked)
        if workers > 1:
            # Threads would be slower than one: half of each iteration holds the interpreter.
            # Spawned, because a fork copies the locks of the compiled libraries.
            context = get_context("spawn")
            pool = stack.enter_context(ProcessPoolExecutor(workers, mp_context=context))
            share = -(-len(checked) // (4 * workers))
            results = pool.map(one, checked, chunksize=share)
        for result in results:
            collected.append(result)
            if progress is not None:
                progress(result)
    return tuple(collected)


def _run_seed(
    algorithm: Algorithm[Any], problem: Problem, iterations: int | None, seed: int
) -> Run:
    return run(algorithm, problem, seed, iterations)


def _joints_seed(
    algorithm: Algorithm[Any], problem: Problem, iterations: int | None, seed: int
) -> JointRuns:
    return run_per_joint(algorithm, problem, seed, iterations)


def run_many(
    algorithm: Algorithm[Any],
    problem: Problem,
    seeds: Iterable[int],
    workers: int = 1,
    iterations: int | None = None,
    progress: Callable[[Run], None] | None = None,
) -> tuple[Run, ...]:
    """`run` with each seed, in the order given; the same bits for any number of workers.

    Parameters
    ----------
    algorithm : Algorithm
    problem : Problem
    seeds : iterable of int
    workers : int
        Processes. More than one costs about a second to start, and a script that asks for them
        must guard its entry point with ``if __name__ == "__main__":``.
    iterations : int, optional
        Replaces the algorithm's own.
    progress : callable, optional
        Called with each run, in order, in the calling process.

    Returns
    -------
    tuple of Run

    Raises
    ------
    TrajgapError
        As `run`, or if workers is not a whole number of 1 or more.
    """
    return _each(partial(_run_seed, algorithm, problem, iterations), seeds, workers, progress)


def run_many_per_joint(
    algorithm: Algorithm[Any],
    problem: Problem,
    seeds: Iterable[int],
    workers: int = 1,
    iterations: int | None = None,
    progress: Callable[[JointRuns], None] | None = None,
) -> tuple[JointRuns, ...]:
    """`run_per_joint` with each seed, in the order given; parameters as `run_many`."""
    return _each(partial(_joints_seed, algorithm, problem, iterations), seeds, workers, progress)
