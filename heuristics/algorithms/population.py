"""Positions, their fitness and the best so far: what WOA and GA leave to the next iteration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import Array
from ..objective import Objective


@dataclass(frozen=True, eq=False, slots=True)
class Population:
    """A population without memory of single members.

    Of populations that move side by side every array and the best fitness have one more axis, the
    first.
    """

    iteration: int
    """Moves made so far."""
    positions: Array
    """Shape (members, dimensions). In s if the dimensions are durations."""
    fitness: Array
    """Shape (members,). Of the positions; the smaller the better."""
    best: Array
    """Shape (dimensions,). Best position so far."""
    best_fitness: float | Array


def lead(
    positions: Array, fitness: Array, best: Array, best_fitness: float | Array
) -> tuple[Array, float | Array]:
    """Best position so far and its fitness: only a strictly better member takes the lead.

    Of equal ones the first does. Positions are (..., members, dimensions), fitness (..., members).
    """
    least = fitness.min(axis=-1)
    better = np.asarray(least < best_fitness)
    if not better.any():
        return best, best_fitness
    leader = np.asarray(fitness.argmin(axis=-1))[..., None, None]
    first = np.take_along_axis(positions, leader, axis=-2)[..., 0, :]
    return np.where(better[..., None], first, best), np.where(better, least, best_fitness)


def first_population(positions: Array, objective: Objective) -> Population:
    """Judge the initial positions; the first smallest leads."""
    fitness = objective(positions)
    leader = int(np.argmin(fitness))
    return Population(0, positions, fitness, positions[leader], float(fitness[leader]))


def followed(before: Population, positions: Array, fitness: Array) -> Population:
    """Population that follows; only a strictly better member takes the lead."""
    best, best_fitness = lead(positions, fitness, before.best, before.best_fitness)
    return Population(before.iteration + 1, positions, fitness, best, best_fitness)
