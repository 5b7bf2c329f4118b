"""The state of a particle swarm, and the moves that the particle-swarm papers have in common."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ...problem import Array
from ..objective import Bounds, Objective
from .population import lead


class Draws(StrEnum):
    """What one pair of random numbers r1, r2 serves."""

    COORDINATE = "coordinate"
    """A pair for each coordinate of each particle."""
    PARTICLE = "particle"
    """A pair for each particle."""
    ITERATION = "iteration"
    """A pair for the whole swarm."""


class VelocityRule(StrEnum):
    """What happens to a velocity outside the range that the velocities start in."""

    CLAMP = "clamp"
    """It is set to the nearer end of that range."""
    FREE = "free"
    """Nothing."""


class PositionRule(StrEnum):
    """What happens to a position that leaves a range."""

    BOUNDS = "bounds"
    """It is set to the nearer end of the problem's duration bounds."""
    INITIAL = "initial"
    """It is set to the nearer end of the range that the positions start in."""
    FREE = "free"
    """Nothing: outside the problem's bounds it is infeasible."""


@dataclass(frozen=True, eq=False, slots=True)
class Swarm:
    """All that one iteration of a particle swarm leaves to the next.

    Of swarms that move side by side every array and the best fitness have one more axis, the first.
    """

    iteration: int
    """Moves made so far."""
    positions: Array
    velocities: Array
    """Shape (particles, dimensions). In s, and s per iteration, if the dimensions are durations."""
    fitness: Array
    """Shape (particles,). Of the positions."""
    personal: Array
    """Shape (particles, dimensions). Best position of each particle so far, p."""
    personal_fitness: Array
    """Shape (particles,)."""
    best: Array
    """Shape (dimensions,). Best position of the swarm so far, g."""
    best_fitness: float | Array


def spread(rng: np.random.Generator, span: tuple[float, float], shape: tuple[int, int]) -> Array:
    """Draw uniformly from a range that all coordinates share."""
    low, high = span
    return low + (high - low) * rng.random(shape)


def draw_pair(
    rng: np.random.Generator, draws: Draws, particles: int, dimensions: int
) -> tuple[Array, Array]:
    """Draw r1, then r2, shaped to broadcast against (..., particles, dimensions)."""
    shape = {
        Draws.COORDINATE: (particles, dimensions),
        Draws.PARTICLE: (particles, 1),
        Draws.ITERATION: (1, 1),
    }[draws]
    pair = rng.random((2, *shape))
    return pair[..., 0, :, :], pair[..., 1, :, :]


def attracted(
    swarm: Swarm, inertia: float | Array, c1: float, c2: float, r1: Array, r2: Array
) -> Array:
    """Velocities drawn to the personal and the global best.

    ``v ← ω v + c1 r1 (p − x) + c2 r2 (g − x)``: (10) of `puma560-mnam-pso-353`, (24) of
    `irb460-pso-353`.
    """
    x = swarm.positions
    to_personal, to_best = swarm.personal - x, swarm.best[..., None, :] - x
    return inertia * swarm.velocities + c1 * r1 * to_personal + c2 * r2 * to_best


def held(values: Array, lower: float | Array, upper: float | Array) -> Array:
    """Set what lies outside a range to its nearer end."""
    return np.minimum(np.maximum(values, lower), upper)


def kept_in(
    positions: Array, rule: PositionRule, initial: tuple[float, float], bounds: Bounds
) -> Array:
    """Apply a rule to positions that have left their range."""
    if rule is PositionRule.BOUNDS:
        return held(positions, bounds.lower, bounds.upper)
    if rule is PositionRule.INITIAL:
        return held(positions, *initial)
    return positions


def first_swarm(positions: Array, velocities: Array, objective: Objective) -> Swarm:
    """Judge the initial positions: each is its own personal best, the first smallest is global."""
    fitness = objective(positions)
    leader = int(np.argmin(fitness))
    return Swarm(
        0, positions, velocities, fitness, positions, fitness,
        positions[leader], float(fitness[leader]),
    )  # fmt: skip


def judged(swarm: Swarm, positions: Array, velocities: Array, objective: Objective) -> Swarm:
    """Judge moved particles and keep what is strictly better, all particles at once."""
    fitness = objective(positions)
    better = fitness < swarm.personal_fitness
    personal = np.where(better[..., None], positions, swarm.personal)
    personal_fitness = np.where(better, fitness, swarm.personal_fitness)
    best, best_fitness = lead(personal, personal_fitness, swarm.best, swarm.best_fitness)
    return Swarm(
        swarm.iteration + 1, positions, velocities, fitness, personal, personal_fitness,
        best, best_fitness,
    )  # fmt: skip
