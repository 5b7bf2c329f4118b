"""Positions, their fitness and the best so far: what WOA and GA leave to the next iteration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import Array
from ..objective import Objective


@dataclass(frozen=True, eq=False, slots=True)
class Population:
    """A population without memory of single members.

    Attributes
    ----------
    iteration : int
        Moves made so far.
    positions : ndarray, shape (members, dimensions)
        In s if the dimensions are durations.
    fitness : ndarray, shape (members,)
        Of the positions; the smaller the better.
    best : ndarray, shape (dimensions,)
        Best position so far.
    best_fitness : float
    """

    iteration: int
    positions: Array
    fitness: Array
    best: Array
    best_fitness: float


def first_population(positions: Array, objective: Objective) -> Population:
    """Judge the initial positions; the first smallest leads."""
    fitness = objective(positions)
    leader = int(np.argmin(fitness))
    return Population(0, positions, fitness, positions[leader], float(fitness[leader]))


def followed(before: Population, positions: Array, fitness: Array) -> Population:
    """Population that follows; only a strictly better member takes the lead."""
    leader = int(np.argmin(fitness))
    best, best_fitness = before.best, before.best_fitness
    if fitness[leader] < best_fitness:
        best, best_fitness = positions[leader], float(fitness[leader])
    return Population(before.iteration + 1, positions, fitness, best, best_fitness)
