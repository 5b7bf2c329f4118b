"""MNAM-PSO: niches spread the initial swarm, the inertia varies, the global best is mutated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Annotated, ClassVar

import numpy as np

from ...problem import Array
from ..objective import Bounds, Objective
from ..settings import Span, clean, number, positive, reject, whole
from .population import lead
from .swarm import (
    Draws,
    PositionRule,
    Swarm,
    VelocityRule,
    attracted,
    draw_pair,
    first_swarm,
    held,
    judged,
    kept_in,
    spread,
)

OPEN_CHOICES = (
    "inertia_reading: (12) with e^(−(2n/N)²) falls from ω_max, the text says that ω increases and "
    "signs of (12) are partly lost; it falls",
    "niches_rule: Fig. 2, which shows how niches spread the initial positions, is not in the text; "
    "every coordinate's range is cut into m niches and each holds equally many particles",
    "mutated, mutation_scale: Fig. 3, which shows the mutation, is not in the text; all "
    "coordinates move, uniformly within ± the smallest coordinate of the global best",
    "the mutant replaces the global best only, no particle and no personal best",
    "the initial global best is mutated too (Steps 2 to 4 precede the first move)",
    "'non-linear learning factors' (introduction) against c1 = c2 = 2 (Step 1): constant",
    "draws: r1 and r2 are 'random constants in [0, 1]'; one pair for each coordinate",
    "velocity_rule: no velocity limit is printed; held in the printed initial range [−2, 2]",
    "position_rule: no treatment of positions out of range is printed; set to the duration bounds "
    "of the reading, the velocity is not changed",
    "order within an iteration: the whole swarm moves, then all bests are renewed",
    "ties: a best is replaced only by a strictly smaller fitness; the first particle leads",
    "budget: N iterations are N moves after the initial evaluation, N + 1 evaluations of the "
    "swarm and of a mutant; as printed, the last move would never be judged",
)
"""What the paper leaves open, and what was chosen."""


class InertiaReading(StrEnum):
    """How the signs of (12) are read."""

    FALLS = "falls"
    """ω_max − (ω_max − ω_min)(1 − e^(−(2n/N)²)), from ω_max to nearly ω_min."""
    RISES = "rises"
    """ω_min + (ω_max − ω_min)(1 − e^(−(2n/N)²)), from ω_min to nearly ω_max, as the text says."""


class NichesRule(StrEnum):
    """How niches spread the initial positions."""

    STRATIFIED = "stratified"
    """In every coordinate each of m equal sub-ranges holds equally many particles."""
    DIAGONAL = "diagonal"
    """Niche k starts in sub-range k of all coordinates."""
    CLUSTERS = "clusters"
    """Niche k starts in a box of width range/m around a random centre, held in the range."""


class MutatedCoordinates(StrEnum):
    """Which coordinates of the global best a mutation moves."""

    ALL = "all"
    """Every coordinate."""
    ONE = "one"
    """One, drawn at random."""


@dataclass(frozen=True)
class MNAMPSO:
    """MNAM-PSO of `puma560-mnam-pso-353`, (10)–(12) and Steps 1–6, and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type, lies outside its range, or contradicts another one.

    Notes
    -----
    Random numbers are drawn in this order. Initially: for "stratified" one number per particle and
    coordinate, whose ranks in each coordinate allot the niches, for "clusters" the centres;
    positions; velocities; one mutation. At each step: all r1, all r2, one mutation. A mutation
    draws one number per coordinate, or for "one" the coordinate and then the size.
    """

    kind: ClassVar[str] = "mnam-pso"
    side_by_side: ClassVar[bool] = True
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    particles: Annotated[int, whole(1)] = 30
    """S; printed."""
    iterations: Annotated[int, whole(0)] = 200
    """N, moves of the swarm; printed. Also the N of (12): another budget is another schedule."""
    niches: Annotated[int, whole(1)] = 3
    """m; printed."""
    c1: Annotated[float, number()] = 2.0
    c2: Annotated[float, number()] = 2.0
    """Learning factors; printed."""
    inertia_max: Annotated[float, number()] = 0.9
    inertia_min: Annotated[float, number()] = 0.4
    """ω_max, ω_min; printed."""
    inertia_reading: InertiaReading = InertiaReading.FALLS
    """"falls" or "rises": (12) and the text disagree."""
    niches_rule: NichesRule = NichesRule.STRATIFIED
    """"stratified", "diagonal" or "clusters"; not in the text."""
    mutated: MutatedCoordinates = MutatedCoordinates.ALL
    """"all" or "one"; not in the text."""
    mutation_scale: Annotated[float, number()] = 1.0
    """Mutation bound as a multiple of the smallest coordinate of the global best; not in the text.
    With 1 no mutated duration is negative."""
    position_initial: Span = (0.3, 3.0)
    """Range that the initial durations are drawn from, s; printed."""
    velocity_initial: Span = (-2.0, 2.0)
    """Range that the initial velocities are drawn from, s per iteration; printed."""
    velocity_rule: VelocityRule = VelocityRule.CLAMP
    """"clamp" or "free"; not printed."""
    position_rule: PositionRule = PositionRule.BOUNDS
    """"bounds", "initial" or "free"; not printed. Mutants are not moved, only judged."""
    draws: Draws = Draws.COORDINATE
    """"coordinate", "particle" or "iteration"; not printed."""
    penalty: Annotated[float, positive(infinite=True)] = np.inf
    """Fitness of an infeasible particle, s; printed."""

    def __post_init__(self) -> None:
        clean(self)
        if self.niches > self.particles:
            raise reject(
                self.kind, "niches", f"{self.niches} niches for {self.particles} particles"
            )
        if self.inertia_min > self.inertia_max:
            raise reject(self.kind, "inertia_min", "exceeds inertia_max")

    def inertia(self, n: int) -> float:
        """Inertia weight of move ``n`` = 1..N, (12)."""
        passed = 1.0 - np.exp(-((2.0 * n / self.iterations) ** 2))
        span = self.inertia_max - self.inertia_min
        if self.inertia_reading is InertiaReading.RISES:
            return float(self.inertia_min + span * passed)
        return float(self.inertia_max - span * passed)  # (12)

    def scatter(self, rng: np.random.Generator, dimensions: int) -> Array:
        """Draw initial positions, spread by niches, shape (particles, dimensions)."""
        low, high = self.position_initial
        width = (high - low) / self.niches
        shape = (self.particles, dimensions)
        niche = np.arange(self.particles) * self.niches // self.particles
        if self.niches_rule is NichesRule.CLUSTERS:
            centres = spread(rng, self.position_initial, (self.niches, dimensions))
            around = centres[niche] + width * (rng.random(shape) - 0.5)
            return held(around, low, high)
        if self.niches_rule is NichesRule.STRATIFIED:
            ranks = np.argsort(rng.random(shape), axis=0, kind="stable")
            return low + width * (niche[ranks] + rng.random(shape))
        return low + width * (niche[:, None] + rng.random(shape))

    def mutant(self, best: Array, rng: np.random.Generator) -> Array:
        """Draw a mutant of the global best, within bounds tied to its smallest coordinate."""
        dimensions = best.shape[-1]
        reach = self.mutation_scale * best.min(axis=-1, keepdims=True)
        if self.mutated is MutatedCoordinates.ONE:
            pair = np.asarray(rng.random(2))
            where, size = pair[..., :1], pair[..., 1:]
            here = np.arange(dimensions) == np.floor(where * dimensions)
            return np.where(here, best + reach * (2.0 * size - 1.0), best)
        moved: Array = best + reach * (2.0 * rng.random(dimensions) - 1.0)
        return moved

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> Swarm:
        """Draw and judge the initial swarm, and mutate its best (Steps 1 to 4)."""
        positions = self.scatter(rng, bounds.lower.size)
        velocities = spread(rng, self.velocity_initial, positions.shape)
        swarm = first_swarm(positions, velocities, objective)
        return self._mutate(swarm, rng, objective)

    def step(
        self, swarm: Swarm, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Swarm:
        """Move the swarm once (Step 5), judge it and mutate its best (Steps 2 to 4)."""
        r1, r2 = draw_pair(rng, self.draws, *swarm.positions.shape[-2:])
        w = self.inertia(swarm.iteration + 1)  # (12)
        v = attracted(swarm, w, self.c1, self.c2, r1, r2)  # (10)
        if self.velocity_rule is VelocityRule.CLAMP:
            v = held(v, *self.velocity_initial)
        x = swarm.positions + v  # (11)
        x = kept_in(x, self.position_rule, self.position_initial, bounds)
        return self._mutate(judged(swarm, x, v, objective), rng, objective)

    def _mutate(self, swarm: Swarm, rng: np.random.Generator, objective: Objective) -> Swarm:
        mutant = self.mutant(swarm.best, rng)
        fitness = objective(mutant[..., None, :])
        best, best_fitness = lead(  # Step 4: feasible and better
            mutant[..., None, :], fitness, swarm.best, swarm.best_fitness
        )
        return replace(swarm, best=best, best_fitness=best_fitness)
