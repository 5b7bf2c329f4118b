"""The constrained PSO of the palletiser paper: held at its bounds, adaptive inertia."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, ClassVar

import numpy as np

from ...problem import Array
from ..objective import Bounds, Objective
from ..settings import Span, clean, number, positive, reject, whole
from .swarm import Draws, Swarm, attracted, draw_pair, held, spread

OPEN_CHOICES = (
    "(25) as extracted adds a position to a position; read as x + v, as its sentence says ('the "
    "last position and the current velocity are added')",
    "(24): its learning factors appear as g1 and y2; read as y1 and y2",
    "particles, y1, y2, inertia weights: not printed; 30, 2, 2, 0.4 to 0.9, the values usual with "
    "3-5-3 polynomials",
    "inertia_rule: 'adaptive inertia weight' without a formula; the usual one of that name, by "
    "fitness against the swarm's mean",
    "position_max, velocity_max: not printed; 2 s, more than twice the longest printed duration, "
    "and a fifth of it",
    "position_rule: [−x_max, x_max] as extracted contains negative durations, infeasible here; "
    "kept",
    "position_initial: not printed; (0.1, 2) s",
    "ties: of two equal positions 'either' becomes the personal best, and the global best is drawn "
    "from the best ones; both at random",
    "draws: r1 and r2 are 'any values in [0, 1]'; one pair for each coordinate",
    "penalty: 'a very large constant', not printed; 1e6 s",
    "a velocity does not change if its position was set to the bound",
    "budget: N iterations are N moves after the initial evaluation, N + 1 evaluations of the swarm",
)
"""What the paper leaves open, and what was chosen."""


class InertiaRule(StrEnum):
    """How the inertia weight adapts."""

    FITNESS = "fitness"
    """ω_min + (ω_max − ω_min)(f − f_min)/(f_mean − f_min) up to the mean fitness, ω_max above."""
    LINEAR = "linear"
    """Falls with the iteration from ω_max to ω_min."""
    FIXED = "fixed"
    """ω_max throughout."""


class RangeRule(StrEnum):
    """Which range positions are held in."""

    SYMMETRIC = "symmetric"
    """[−x_max, x_max], as printed."""
    BOUNDS = "bounds"
    """The problem's duration bounds."""


class Ties(StrEnum):
    """Which of equally good positions is kept."""

    RANDOM = "random"
    """Any, at random."""
    KEEP = "keep"
    """The older one, of the first particle."""


@dataclass(frozen=True)
class ConstrainedPSO:
    """Constrained PSO of `irb460-pso-353`, (24)(25) and Steps 1–9, and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type, lies outside its range, or contradicts another one.

    Notes
    -----
    Random numbers are drawn in this order. Initially: positions, then velocities, particle by
    particle. At each step: all r1, then all r2. Where ties are broken at random, the initial
    judgement and every step end with one number for the global best, and every step has one for
    each particle before it, whether or not there are ties.
    """

    kind: ClassVar[str] = "constrained-pso"
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    particles: Annotated[int, whole(1)] = 30
    """Not printed."""
    iterations: Annotated[int, whole(0)] = 100
    """Moves of the swarm; printed."""
    c1: Annotated[float, number()] = 2.0
    c2: Annotated[float, number()] = 2.0
    """Learning factors y1, y2; not printed."""
    inertia_max: Annotated[float, number()] = 0.9
    inertia_min: Annotated[float, number()] = 0.4
    """Not printed."""
    inertia_rule: InertiaRule = InertiaRule.FITNESS
    """"fitness", "linear" or "fixed"; not printed."""
    position_max: Annotated[float, positive()] = 2.0
    """x_max, s; not printed."""
    position_rule: RangeRule = RangeRule.SYMMETRIC
    """"symmetric" (printed) or "bounds"."""
    velocity_max: Annotated[float, positive()] = 0.4
    """v_max, s per iteration; not printed. Initial velocities are drawn from [−v_max, v_max]."""
    position_initial: Span = (0.1, 2.0)
    """Range that the initial durations are drawn from, s; not printed."""
    ties: Ties = Ties.RANDOM
    """"random" or "keep"."""
    draws: Draws = Draws.COORDINATE
    """"coordinate", "particle" or "iteration"; not printed."""
    penalty: Annotated[float, positive(infinite=True)] = 1e6
    """C, fitness of an infeasible particle, s; its value is not printed."""

    def __post_init__(self) -> None:
        clean(self)
        if self.inertia_min > self.inertia_max:
            raise reject(self.kind, "inertia_min", "exceeds inertia_max")

    def inertia(self, n: int, fitness: Array) -> float | Array:
        """Inertia weight of move ``n`` = 1..N, of the swarm or of each particle (rows)."""
        span = self.inertia_max - self.inertia_min
        if self.inertia_rule is InertiaRule.LINEAR:
            return self.inertia_max - span * n / self.iterations
        if self.inertia_rule is InertiaRule.FIXED:
            return self.inertia_max
        least, mean = float(fitness.min()), float(fitness.mean())
        if not least < mean < np.inf:  # nothing tells the particles apart: keep exploring
            return self.inertia_max
        weights = self.inertia_min + span * (fitness - least) / (mean - least)
        return np.where(fitness <= mean, weights, self.inertia_max)[:, None]

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> Swarm:
        """Draw and judge the initial swarm."""
        shape = (self.particles, bounds.lower.size)
        positions = self._held(spread(rng, self.position_initial, shape), bounds)
        velocities = spread(rng, (-self.velocity_max, self.velocity_max), shape)
        fitness = objective(positions)
        return self._led(0, positions, velocities, fitness, positions, fitness, rng)

    def step(
        self, swarm: Swarm, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Swarm:
        """Move the swarm once (Step 7) and judge it (Steps 2 to 6)."""
        r1, r2 = draw_pair(rng, self.draws, *swarm.positions.shape)
        n = swarm.iteration + 1
        w = self.inertia(n, swarm.fitness)
        v = attracted(swarm, w, self.c1, self.c2, r1, r2)  # (24)
        v = held(v, -self.velocity_max, self.velocity_max)
        x = self._held(swarm.positions + v, bounds)  # (25), read as x + v
        fitness = objective(x)
        better = fitness < swarm.personal_fitness  # dominance, with one objective
        if self.ties is Ties.RANDOM:
            better |= (fitness == swarm.personal_fitness) & (rng.random(better.size) < 0.5)
        personal = np.where(better[:, None], x, swarm.personal)
        personal_fitness = np.where(better, fitness, swarm.personal_fitness)
        return self._led(n, x, v, fitness, personal, personal_fitness, rng)

    def _held(self, positions: Array, bounds: Bounds) -> Array:
        if self.position_rule is RangeRule.BOUNDS:
            return held(positions, bounds.lower, bounds.upper)
        return held(positions, -self.position_max, self.position_max)

    def _led(
        self,
        iteration: int,
        positions: Array,
        velocities: Array,
        fitness: Array,
        personal: Array,
        personal_fitness: Array,
        rng: np.random.Generator,
    ) -> Swarm:
        """Swarm whose global best is one of its best personal ones."""
        optimal = np.flatnonzero(personal_fitness == personal_fitness.min())
        pick = int(rng.random() * optimal.size) if self.ties is Ties.RANDOM else 0
        leader = optimal[pick]
        return Swarm(
            iteration, positions, velocities, fitness, personal, personal_fitness,
            personal[leader], float(personal_fitness[leader]),
        )  # fmt: skip
