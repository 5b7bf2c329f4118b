"""Standard particle swarm optimisation with a fixed inertia weight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from ..objective import Bounds, Objective
from ..settings import Span, clean, number, positive, whole
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
    "inertia: fixed in the standard algorithm, value not printed; 0.65, the middle of the printed "
    "range 0.4 to 0.9 of the improved one",
    "particles, iterations, c1, c2 and initial ranges: printed for the improved algorithm, taken "
    "for the standard one too",
    "draws: r1 and r2 are 'random constants in [0, 1]'; one pair for each coordinate",
    "velocity_rule: no velocity limit is printed; held in the printed initial range [−2, 2]",
    "position_rule: no treatment of positions out of range is printed; set to the duration bounds "
    "of the reading, the velocity is not changed",
    "order within an iteration: the whole swarm moves, then all bests are renewed",
    "ties: a best is replaced only by a strictly smaller fitness; the first particle leads",
    "budget: N iterations are N moves after the initial evaluation, N + 1 evaluations of the "
    "swarm; as printed, the last move would never be judged",
)
"""What the paper leaves open, and what was chosen."""


@dataclass(frozen=True)
class PSO:
    """Standard PSO of `puma560-mnam-pso-353`, (10)(11), and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type or lies outside its range.

    Notes
    -----
    Random numbers are drawn in this order. Initially: positions, then velocities, particle by
    particle. At each step: all r1, then all r2, particle by particle.
    """

    kind: ClassVar[str] = "pso"
    side_by_side: ClassVar[bool] = True
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    particles: Annotated[int, whole(1)] = 30
    """S; printed for the improved algorithm."""
    iterations: Annotated[int, whole(0)] = 200
    """N, moves of the swarm; printed for the improved algorithm."""
    c1: Annotated[float, number()] = 2.0
    c2: Annotated[float, number()] = 2.0
    """Learning factors; printed."""
    inertia: Annotated[float, number()] = 0.65
    """ω; fixed, its value is not printed."""
    position_initial: Span = (0.3, 3.0)
    """Range that the initial durations are drawn from, s; printed."""
    velocity_initial: Span = (-2.0, 2.0)
    """Range that the initial velocities are drawn from, s per iteration; printed."""
    velocity_rule: VelocityRule = VelocityRule.CLAMP
    """"clamp" or "free"; not printed."""
    position_rule: PositionRule = PositionRule.BOUNDS
    """"bounds", "initial" or "free"; not printed."""
    draws: Draws = Draws.COORDINATE
    """"coordinate", "particle" or "iteration"; not printed."""
    penalty: Annotated[float, positive(infinite=True)] = np.inf
    """Fitness of an infeasible particle, s; printed."""

    def __post_init__(self) -> None:
        clean(self)

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> Swarm:
        """Draw and judge the initial swarm."""
        shape = (self.particles, bounds.lower.size)
        positions = spread(rng, self.position_initial, shape)
        velocities = spread(rng, self.velocity_initial, shape)
        return first_swarm(positions, velocities, objective)

    def step(
        self, swarm: Swarm, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Swarm:
        """Move the swarm once and judge it."""
        r1, r2 = draw_pair(rng, self.draws, *swarm.positions.shape[-2:])
        v = attracted(swarm, self.inertia, self.c1, self.c2, r1, r2)  # (10)
        if self.velocity_rule is VelocityRule.CLAMP:
            v = held(v, *self.velocity_initial)
        x = swarm.positions + v  # (11)
        x = kept_in(x, self.position_rule, self.position_initial, bounds)
        return judged(swarm, x, v, objective)
