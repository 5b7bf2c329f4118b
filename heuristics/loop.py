"""The one loop: an algorithm on a problem, with its seed, budget and best-so-far trace."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, closing
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, TypeVar, cast

import numpy as np

from ..problem import Array, Problem
from .algorithm import Algorithm, S, Search, State
from .budget import searched
from .objective import Bounds, Counted, Objective
from .repair import Handling, judge_of
from .result import JointRuns, Run
from .settings import checked, whole
from .workers import in_processes


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


_SEED = Annotated[int, whole(0)]
"""What numpy takes as entropy, told in one line."""
_WORKERS = Annotated[int, whole(1)]
"""The calling process counts as one."""
Method = Algorithm[Any] | Search
"""What can be run: an algorithm step by step, or a search that owns its loop."""

M = TypeVar("M", bound=Method)


def _with_budget(method: M, iterations: int | None) -> M:
    if iterations is None:
        return method
    return cast(M, replace(cast(Any, method), iterations=iterations))


def _stepped(
    algorithm: Algorithm[Any], objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> tuple[Array, Array, int]:
    """Trace, best position and number of evaluations of an algorithm."""
    counted = Counted(objective)
    trace = np.empty(algorithm.iterations + 1)
    state: State
    for i, state in enumerate(states(algorithm, counted, bounds, rng)):
        trace[i] = state.best_fitness
    return trace, np.array(state.best), counted.evaluations


def _run(
    method: Method, problem: Problem, seed: int, stream: tuple[int, ...], handling: str
) -> Run:
    judge = judge_of(problem, method.penalty, handling)
    bounds = Bounds.of(problem)
    # Named, not numpy's default, which may change: the same seed must give the same bits.
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=stream)))
    if isinstance(method, Search):
        trace, position, evaluations = searched(method, judge, bounds, rng)
    else:
        trace, position, evaluations = _stepped(method, judge, bounds, rng)
    trace[trace >= method.penalty] = np.inf
    return Run(
        algorithm=method.kind,
        settings=method,
        problem=problem.name,
        seed=seed,
        stream=stream,
        durations=judge.decode(position[None])[0],
        reported_time=float(trace[-1]),
        trace=trace,
        evaluations=evaluations,
        iterations=method.iterations,
        feasible=bool(np.isfinite(trace[-1])),
        objective=Handling(handling),
        position=position,
    )


def run(
    algorithm: Method,
    problem: Problem,
    seed: int,
    iterations: int | None = None,
    objective: str = Handling.DEATH_PENALTY,
) -> Run:
    """Search one duration vector for all joints of a problem.

    Parameters
    ----------
    algorithm : Algorithm or Search
        Such as ``PSO()``, what `from_settings` returns, or an adapted library.
    problem : Problem
        Its coupling is not looked at; see `run_per_joint`.
    seed : int
        0 or more.
    iterations : int, optional
        Replaces the algorithm's own.
    objective : str
        What happens to vectors that break a limit: "death-penalty", "stretch" or "rescale", see
        `Handling`. Under the latter two the durations and times of the run are stretched ones.

    Returns
    -------
    Run

    Raises
    ------
    TrajgapError
        If the seed or budget is not a whole number, or the objective is unknown or cannot judge
        the problem (see `DeathPenalty` and `Stretch`).

    Examples
    --------
    >>> from trajgap.problem import Limits, Problem, three_five_three
    >>> from trajgap.heuristics import PSO, run
    >>> waypoints = [[0.1, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
    >>> problem = Problem(waypoints, Limits(6.0, 8.0, joints=2), three_five_three())
    >>> run(PSO(), problem, seed=1).feasible
    True
    """
    record = _with_budget(algorithm, iterations)
    return _run(record, problem, checked(_SEED, "seed", seed), (), objective)


def run_per_joint(
    algorithm: Method,
    problem: Problem,
    seed: int,
    iterations: int | None = None,
    objective: str = Handling.DEATH_PENALTY,
) -> JointRuns:
    """Search each joint by itself; each segment then takes the longest duration.

    Source: `puma560-mnam-pso-353`, section 4.1.

    Parameters
    ----------
    algorithm : Algorithm or Search
    problem : Problem
    seed : int
        Joint ``i`` draws from child stream ``i`` of the seed, as ``SeedSequence(seed).spawn``.
    iterations : int, optional
        Replaces the algorithm's own.
    objective : str
        As `run`.

    Returns
    -------
    JointRuns

    Raises
    ------
    TrajgapError
        As `run`.
    """
    root = checked(_SEED, "seed", seed)
    record = _with_budget(algorithm, iterations)
    runs = tuple(
        _run(record, problem.joint(j), root, (j,), objective) for j in range(len(problem.joints))
    )
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
    clean = [checked(_SEED, "seed", seed) for seed in seeds]
    workers = min(checked(_WORKERS, "workers", workers), max(1, len(clean)))
    collected = []
    with ExitStack() as stack:
        results: Iterable[R] = map(one, clean)
        if workers > 1:
            # Threads would be slower than one: half of each iteration holds the interpreter.
            results = stack.enter_context(closing(in_processes(one, clean, workers)))
        for result in results:
            collected.append(result)
            if progress is not None:
                progress(result)
    return tuple(collected)


def _run_seed(
    algorithm: Method, problem: Problem, iterations: int | None, objective: str, seed: int
) -> Run:
    return run(algorithm, problem, seed, iterations, objective)


def _joints_seed(
    algorithm: Method, problem: Problem, iterations: int | None, objective: str, seed: int
) -> JointRuns:
    return run_per_joint(algorithm, problem, seed, iterations, objective)


def run_many(
    algorithm: Method,
    problem: Problem,
    seeds: Iterable[int],
    workers: int = 1,
    iterations: int | None = None,
    progress: Callable[[Run], None] | None = None,
    objective: str = Handling.DEATH_PENALTY,
) -> tuple[Run, ...]:
    """`run` with each seed, in the order given; the same bits for any number of workers.

    Parameters
    ----------
    algorithm : Algorithm or Search
    problem : Problem
    seeds : iterable of int
    workers : int
        Processes. More than one costs about a second to start, and a script that asks for them
        must guard its entry point with ``if __name__ == "__main__":``. The work of a process that
        is killed is done again, once.
    iterations : int, optional
        Replaces the algorithm's own.
    progress : callable, optional
        Called with each run, in order, in the calling process.
    objective : str
        As `run`.

    Returns
    -------
    tuple of Run

    Raises
    ------
    TrajgapError
        As `run`, if workers is not a whole number of 1 or more, or if processes end twice at the
        same run.
    """
    one = partial(_run_seed, algorithm, problem, iterations, objective)
    return _each(one, seeds, workers, progress)


def run_many_per_joint(
    algorithm: Method,
    problem: Problem,
    seeds: Iterable[int],
    workers: int = 1,
    iterations: int | None = None,
    progress: Callable[[JointRuns], None] | None = None,
    objective: str = Handling.DEATH_PENALTY,
) -> tuple[JointRuns, ...]:
    """`run_per_joint` with each seed, in the order given; parameters as `run_many`."""
    one = partial(_joints_seed, algorithm, problem, iterations, objective)
    return _each(one, seeds, workers, progress)
