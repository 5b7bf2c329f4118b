"""Runs of one algorithm moved together: the same bits as each by itself, and one call for all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from typing import Any, cast

import numpy as np

from ..problem import Array
from .algorithm import Algorithm
from .objective import Bounds, Counted, Objective, Recalling
from .repair import Judge

TOGETHER = 100
"""Runs that are moved side by side at most: calls are cheap beside the work then, and what one
iteration touches still fits a cache."""


@dataclass(frozen=True, eq=False)
class Start:
    """What one run begins with."""

    judge: Judge
    """Neighbours that share one are judged in one call."""
    bounds: Bounds
    rng: np.random.Generator
    """Its only source of randomness."""


def moves_together(algorithm: object) -> bool:
    """Whether an algorithm's own class says that its `step` takes a first axis of runs."""
    return bool(vars(type(algorithm)).get("side_by_side", False))


def stepped_together(
    algorithm: Algorithm[Any], starts: Sequence[Start]
) -> list[tuple[Array, Array, int]]:
    """Trace, best position and number of evaluations of runs that are moved side by side.

    Each run draws its numbers from its own generator, in the order in which it would alone.

    Parameters
    ----------
    algorithm : Algorithm
        One that `moves_together`. Where its class says that it ``makes_copies``, positions of one
        step that stood in the step before are not judged again.
    starts : sequence of Start
        At least one; all of the same number of dimensions.
    """
    judges = _Judges(starts, vars(type(algorithm)).get("makes_copies", False))
    bounds = Bounds(
        np.stack([one.bounds.lower for one in starts])[:, None],
        np.stack([one.bounds.upper for one in starts])[:, None],
    )
    rng = cast(np.random.Generator, _Streams([one.rng for one in starts]))
    traces = np.empty((len(starts), algorithm.iterations + 1))
    # A swarm without a velocity limit may leave every range; what overflows is infeasible.
    with np.errstate(over="ignore", invalid="ignore"):
        state = _stacked(
            [algorithm.init(one.bounds, one.rng, judges.alone(i)) for i, one in enumerate(starts)]
        )
        traces[:, 0] = state.best_fitness
        for i in range(algorithm.iterations):
            state = algorithm.step(state, bounds, rng, judges)
            traces[:, i + 1] = state.best_fitness
    best = np.array(state.best)
    return [(traces[i].copy(), best[i].copy(), judges.evaluations(i)) for i in range(len(starts))]


def _stacked(states: list[Any]) -> Any:
    """States of single runs as one: arrays and best fitness get a first axis."""
    values = {
        field.name: [getattr(state, field.name) for state in states] for field in fields(states[0])
    }
    counter = values.pop("iteration")[0]
    return type(states[0])(iteration=counter, **{k: np.stack(v) for k, v in values.items()})


class _Streams:
    """Stands in for a generator: every run's own, asked for the same shape."""

    def __init__(self, generators: list[np.random.Generator]) -> None:
        self._generators = generators

    def random(self, shape: int | tuple[int, ...]) -> Array:
        """Uniform numbers of each run, shape (runs, *shape)."""
        each = shape if isinstance(shape, tuple) else (shape,)
        drawn = np.empty((len(self._generators), *each))
        for generator, part in zip(self._generators, drawn, strict=True):
            generator.random(out=part)
        return drawn


class _Judges:
    """Objective of positions of shape (runs, members, dimensions)."""

    def __init__(self, starts: Sequence[Start], copies: bool) -> None:
        self._parts: list[tuple[slice, Counted]] = []
        at = 0
        for _, group in groupby(starts, key=lambda one: one.judge):
            alike = list(group)
            judge: Objective = alike[0].judge
            judge = Recalling(judge) if copies else judge
            self._parts.append((slice(at, at + len(alike)), Counted(judge)))
            at += len(alike)

    def __call__(self, positions: Array) -> Array:
        """Fitness of all, shape (runs, members)."""
        fitness = np.empty(positions.shape[:2])
        for rows, judge in self._parts:
            part = positions[rows]
            fitness[rows] = judge(part.reshape(-1, part.shape[2])).reshape(part.shape[:2])
        return fitness

    def _of(self, run: int) -> tuple[slice, Counted]:
        return next(one for one in self._parts if one[0].start <= run < one[0].stop)

    def alone(self, run: int) -> Counted:
        """Objective of one run, for positions of shape (members, dimensions)."""
        return self._of(run)[1]

    def evaluations(self, run: int) -> int:
        """Positions of one run that were judged: each run judges as many."""
        rows, judge = self._of(run)
        return judge.evaluations // int(rows.stop - rows.start)
