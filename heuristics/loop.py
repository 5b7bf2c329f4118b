"""The one loop: an algorithm on a problem, with its seed, budget and best-so-far trace."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import Any, TypeVar, cast

import numpy as np

from ..problem import Array, Problem, TrajgapError, in_processes
from .algorithm import Algorithm, S, Search, State
from .baseline import looked_in
from .budget import searched
from .objective import Bounds, Counted, Objective
from .repair import Handling, Judge, compile_judge, judge_of
from .result import JointRuns, Run
from .settings import COUNT, SEED, checked
from .side_by_side import TOGETHER, Start, moves_together, stepped_together


def states(
    algorithm: Algorithm[S], objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> Iterator[S]:
    """Every state of one search: the initial one, then one per iteration.

    Parameters
    ----------
    objective : callable
        Maps positions, shape (batch, dimensions), to fitness, shape (batch,).
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


Method = Algorithm[Any] | Search
"""What can be run: an algorithm step by step, or a search that owns its loop."""


def _with_budget(method: Method, iterations: int | None) -> Method:
    if iterations is None:
        return method
    return cast(Method, replace(cast(Any, method), iterations=iterations))


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


@dataclass(frozen=True, eq=False)
class AskedRun:
    """The specification of one run."""

    problem: Problem
    """Its coupling is ignored."""
    seed: int
    stream: tuple[int, ...] = ()
    """Spawn key under the seed."""
    handling: str = Handling.DEATH_PENALTY
    """Treatment of vectors that break a limit; see `Handling`."""


def _started(method: Method, questions: Sequence[AskedRun]) -> list[Start]:
    known: dict[tuple[Problem, str], tuple[Judge, Bounds]] = {}
    starts = []
    for one in questions:
        key = (one.problem, one.handling)
        if key not in known:
            judge = judge_of(one.problem, method.penalty, one.handling)
            known[key] = judge, looked_in(method, one.problem)
        # Named, not numpy's default, which may change: the same seed must give the same bits.
        sequence = np.random.SeedSequence(one.seed, spawn_key=one.stream)
        rng = np.random.Generator(np.random.PCG64(sequence))
        starts.append(Start(*known[key], rng))
    return starts


def _alone(method: Method, start: Start) -> tuple[Array, Array, int]:
    search = searched if isinstance(method, Search) else _stepped
    return search(cast(Any, method), start.judge, start.bounds, start.rng)


def run_asked(method: Method, questions: Sequence[AskedRun]) -> list[Run]:
    """Run an algorithm on several questions, side by side if it can, with the same results.

    Parameters
    ----------
    questions : sequence of AskedRun
        Neighbours with the same problem and handling are evaluated in one call.

    Returns
    -------
    list of Run
        In the order of the questions.

    Raises
    ------
    TrajgapError
        As `run`.
    """
    starts = _started(method, questions)
    sizes = {one.problem.segments for one in questions}
    if len(starts) > 1 and len(sizes) == 1 and moves_together(method):
        parts = [starts[i : i + TOGETHER] for i in range(0, len(starts), TOGETHER)]
        found = [one for part in parts for one in stepped_together(cast(Any, method), part)]
    else:
        found = [_alone(method, start) for start in starts]
    return [
        _answered(method, one, start.judge, *each)
        for one, start, each in zip(questions, starts, found, strict=True)
    ]


def run_as_left(
    method: Method, question: AskedRun, trace: Array, position: Array, evaluations: int
) -> Run:
    """The run of an earlier search, with its answer evaluated again.

    Parameters
    ----------
    trace, position, evaluations
        As the attributes of `Run`.

    Raises
    ------
    TrajgapError
        As `run`, or if no search can have produced it: the objective gives the position a total
        that differs from the end of the trace, or the trace does not decrease.
    """
    judge = judge_of(question.problem, method.penalty, question.handling)
    if position.shape != (question.problem.segments,) or trace.shape != (method.iterations + 1,):
        raise TrajgapError("run: its position or trace is of another size")
    total = float(judge(position[None])[0])
    ended = total if total < method.penalty else np.inf
    if ended != trace[-1] or not (trace[1:] <= trace[:-1]).all():
        raise TrajgapError(f"run: its trace does not end at {ended} s")
    return _answered(method, question, judge, trace, position, evaluations)


def _answered(
    method: Method, one: AskedRun, judge: Judge, trace: Array, position: Array, evaluations: int
) -> Run:
    trace[trace >= method.penalty] = np.inf
    return Run(
        algorithm=method.kind,
        settings=method,
        problem=one.problem.name,
        seed=one.seed,
        stream=one.stream,
        durations=judge.decode(position[None])[0],
        reported_time=float(trace[-1]),
        trace=trace,
        evaluations=evaluations,
        iterations=method.iterations,
        feasible=bool(np.isfinite(trace[-1])),
        objective=Handling(one.handling),
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
        Its coupling is ignored; see `run_per_joint`.
    seed : int
        0 or more.
    iterations : int, optional
        Replaces the algorithm's own.
    objective : str
        Treatment of vectors that break a limit: "death-penalty", "stretch" or "rescale"; see
        `Handling`. With the latter two, the durations and times of the run are stretched ones.

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
    return run_many(algorithm, problem, (seed,), iterations=iterations, objective=objective)[0]


def run_per_joint(
    algorithm: Method,
    problem: Problem,
    seed: int,
    iterations: int | None = None,
    objective: str = Handling.DEATH_PENALTY,
) -> JointRuns:
    """Search each joint separately; each segment then takes the longest duration.

    Source: `puma560-mnam-pso-353`, section 4.1.

    Parameters
    ----------
    seed : int
        Joint ``i`` draws from child stream ``i`` of the seed, as ``SeedSequence(seed).spawn``.
    iterations : int, optional
        Replaces the algorithm's own.
    objective : str
        As `run`.

    Raises
    ------
    TrajgapError
        As `run`.
    """
    asked = {"iterations": iterations, "objective": objective}
    return run_many_per_joint(algorithm, problem, (seed,), **cast(Any, asked))[0]


def joined_runs(problem: Problem, seed: int, runs: tuple[Run, ...]) -> JointRuns:
    """The runs of all joints as one: every segment takes the longest of their durations.

    Parameters
    ----------
    problem : Problem
        With all joints.
    """
    durations = np.max([one.durations for one in runs], axis=0)
    feasible = all(one.feasible for one in runs)
    return JointRuns(
        algorithm=runs[0].algorithm,
        problem=problem.name,
        seed=seed,
        runs=runs,
        durations=durations,
        reported_time=float(durations.sum()) if feasible else np.inf,
        feasible=feasible,
    )


R = TypeVar("R")
_Seeds = tuple[int, ...]
"""Seeds whose runs are moved side by side."""


def _each(
    some: Callable[[Method, Problem, str, _Seeds], tuple[R, ...]],
    method: Method,
    problem: Problem,
    objective: str,
    seeds: Iterable[int],
    workers: int,
    progress: Callable[[R], None] | None,
) -> tuple[R, ...]:
    clean = [checked(SEED, "seed", seed) for seed in seeds]
    workers = min(checked(COUNT, "workers", workers), max(1, len(clean)))
    by_joint = some is _joint_runs
    most = max(1, TOGETHER // (len(problem.joints) if by_joint else 1))
    most = most if moves_together(method) else 1
    # Four pieces for each process, so none waits long for the last one.
    size = most if workers == 1 else max(1, min(most, len(clean) // (4 * workers)))
    parts = [tuple(clean[i : i + size]) for i in range(0, len(clean), size)]
    collected: list[R] = []
    if workers > 1:
        compile_judge(problem.joint(0) if by_joint else problem, objective)
    # Threads would be slower than one: half of each iteration holds the interpreter.
    with closing(in_processes(partial(some, method, problem, objective), parts, workers)) as found:
        for result in chain.from_iterable(found):
            collected.append(result)
            if progress is not None:
                progress(result)
    return tuple(collected)


def _runs(method: Method, problem: Problem, objective: str, seeds: _Seeds) -> tuple[Run, ...]:
    return tuple(run_asked(method, [AskedRun(problem, s, (), objective) for s in seeds]))


def _joint_runs(
    method: Method, problem: Problem, objective: str, seeds: _Seeds
) -> tuple[JointRuns, ...]:
    joints = [problem.joint(j) for j in range(len(problem.joints))]
    asked = [AskedRun(one, s, (j,), objective) for j, one in enumerate(joints) for s in seeds]
    runs = run_asked(method, asked)
    count = len(seeds)
    return tuple(joined_runs(problem, s, tuple(runs[i::count])) for i, s in enumerate(seeds))


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
    workers : int
        Number of processes. More than one costs about a second to start. The work of a killed
        process is repeated once.
    iterations : int, optional
        Replaces the algorithm's own.
    progress : callable, optional
        Called with each run, in order, in the calling process.
    objective : str
        As `run`.

    Raises
    ------
    TrajgapError
        As `run`, if workers is not a whole number of 1 or more, or if processes end twice at the
        same run.
    """
    method = _with_budget(algorithm, iterations)
    return _each(_runs, method, problem, objective, seeds, workers, progress)


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
    method = _with_budget(algorithm, iterations)
    return _each(_joint_runs, method, problem, objective, seeds, workers, progress)
