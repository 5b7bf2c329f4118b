"""Optimisers from elsewhere under the same objective and budget: scipy's, and any callable."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, Any

import numpy as np

from ..problem import Array, TrajgapError
from .objective import Bounds, Objective
from .settings import clean, positive, reject, whole

Searching = Callable[[Objective, Bounds, np.random.Generator], object]
"""Called with the objective, the bounds and the generator; what it returns is not looked at."""


@dataclass(frozen=True)
class External:
    """A search with its own loop, run by `run` like any algorithm.

    The answer is the best position that the search passed to the objective, and the trace is the
    best so far after every ``per_iteration`` evaluations, as for an algorithm with a population of
    that size. What the search itself reports is ignored. When the budget of ``per_iteration`` ×
    (``iterations`` + 1) evaluations is spent the search is stopped from inside the objective.

    Parameters
    ----------
    kind : str
        Name of the search.
    searching : callable
        ``searching(objective, bounds, rng)``. The objective takes a batch of shape
        (batch, segments), s, and returns (batch,). To run in other processes it must be picklable.
    iterations : int
        Blocks of evaluations after the first one.
    per_iteration : int
        Evaluations that count as one iteration.
    penalty : float
        Fitness of an infeasible vector, s; finite by default, because many searches subtract.
    position_range : tuple of float, optional
        Range of every duration that is searched within the problem's bounds, s. Needed by searches
        that require finite bounds if the problem has none.
    options : mapping
        Options that were passed to the search, for the record.

    Raises
    ------
    TrajgapError
        If a value has the wrong type or lies outside its range.

    Examples
    --------
    A random search of one's own:

    >>> from trajgap.problem import Limits, Problem, three_five_three
    >>> from trajgap.heuristics import External, run
    >>> waypoints = [[0.1], [0.7], [1.2], [0.9]]
    >>> problem = Problem(waypoints, Limits(6.0, 8.0), three_five_three(), 0.1, 3.0)
    >>> def drawing(objective, bounds, rng):
    ...     while True:
    ...         objective(rng.uniform(bounds.lower, bounds.upper, (30, 3)))
    >>> found = run(External("random", drawing), problem, seed=1)
    >>> found.evaluations, found.feasible
    (6030, True)
    """

    kind: str
    searching: Searching
    iterations: Annotated[int, whole(0)] = 200
    per_iteration: Annotated[int, whole(1)] = 30
    penalty: Annotated[float, positive(infinite=True)] = 1e6
    position_range: tuple[float, float] | None = None
    options: Mapping[str, object] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        if not callable(self.searching):
            raise reject(self.kind, "searching", "expected a callable (objective, bounds, rng)")
        clean(self)
        if self.position_range is not None:
            low, high = self.position_range
            if not 0 <= low < high:
                raise reject(self.kind, "position_range", "give two numbers, the smaller first")

    def search(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> None:
        """Search until done or stopped."""
        if self.position_range is not None:
            low, high = self.position_range
            bounds = Bounds(np.maximum(bounds.lower, low), np.minimum(bounds.upper, high))
            if (bounds.lower > bounds.upper).any():
                raise reject(self.kind, "position_range", "lies outside the duration bounds")
        self.searching(objective, bounds, rng)


def one_by_one(objective: Objective) -> Callable[[Array], float]:
    """Objective of a single position, shape (dimensions,), for searches that ask for one."""
    return lambda position: float(objective(np.asarray(position)[None, :])[0])


def _finite(kind: str, bounds: Bounds) -> list[tuple[float, float]]:
    if not (np.isfinite(bounds.lower).all() and np.isfinite(bounds.upper).all()):
        raise TrajgapError(
            f"{kind}: needs finite duration bounds; give the problem some, or a position_range"
        )
    return list(zip(bounds.lower.tolist(), bounds.upper.tolist(), strict=True))


def _seeded(function: Callable[..., Any], rng: np.random.Generator) -> dict[str, object]:
    # scipy 1.15 renamed the keyword.
    return {"rng" if "rng" in inspect.signature(function).parameters else "seed": rng}


def _evolve(
    options: Mapping[str, Any], objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> None:
    from scipy.optimize import differential_evolution as minimise

    kept = {"maxiter": 10**6, "vectorized": True, "updating": "deferred", **options}
    single = one_by_one(objective)

    def function(x: Array) -> Array | float:  # a generation as columns, or one vector to polish
        return objective(x.T) if x.ndim == 2 else single(x)

    box = _finite("differential-evolution", bounds)
    minimise(function, box, **_seeded(minimise, rng), **kept)


def _anneal(
    options: Mapping[str, Any], objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> None:
    from scipy.optimize import dual_annealing as minimise

    kept = {"maxiter": 10**6, **options}
    box = _finite("dual-annealing", bounds)
    minimise(one_by_one(objective), box, **_seeded(minimise, rng), **kept)


def _homology(
    options: Mapping[str, Any], objective: Objective, bounds: Bounds, _: np.random.Generator
) -> None:
    from scipy.optimize import shgo as minimise

    minimise(one_by_one(objective), _finite("shgo", bounds), **options)


def differential_evolution(
    iterations: int = 200,
    per_iteration: int = 30,
    penalty: float = 1e6,
    position_range: tuple[float, float] | None = None,
    **options: object,
) -> External:
    """Run scipy's differential evolution.

    Parameters
    ----------
    iterations, per_iteration, penalty, position_range
        As `External`.
    **options
        Passed on to ``scipy.optimize.differential_evolution``. Unless given otherwise, generations
        are judged as a batch, and only the budget or convergence ends the search.

    Returns
    -------
    External
    """
    return _adapted("differential-evolution", _evolve, options, iterations, per_iteration, penalty,
                    position_range)  # fmt: skip


def dual_annealing(
    iterations: int = 200,
    per_iteration: int = 30,
    penalty: float = 1e6,
    position_range: tuple[float, float] | None = None,
    **options: object,
) -> External:
    """Run scipy's dual annealing; parameters as `differential_evolution`."""
    return _adapted("dual-annealing", _anneal, options, iterations, per_iteration, penalty,
                    position_range)  # fmt: skip


def shgo(
    iterations: int = 200,
    per_iteration: int = 30,
    penalty: float = 1e6,
    position_range: tuple[float, float] | None = None,
    **options: object,
) -> External:
    """Run scipy's simplicial homology optimisation; parameters as `differential_evolution`.

    It draws no random numbers: every seed gives the same run.
    """
    return _adapted("shgo", _homology, options, iterations, per_iteration, penalty,
                    position_range)  # fmt: skip


def _adapted(
    kind: str,
    function: Callable[..., None],
    options: Mapping[str, object],
    iterations: int,
    per_iteration: int,
    penalty: float,
    position_range: tuple[float, float] | None,
) -> External:
    for name in ("rng", "seed", "bounds", "func", "workers"):
        if name in options:
            raise reject(kind, name, "is set by the run; leave it out")
    return External(
        kind, partial(function, dict(options)), iterations, per_iteration, penalty,
        position_range, dict(options),
    )  # fmt: skip
