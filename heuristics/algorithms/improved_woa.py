"""The improved WOA: an inertia weight on the target, a tent map for the start."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, ClassVar

import numpy as np

from ...problem import Array
from ..objective import Bounds, Objective
from ..settings import Span, above, clean, number, positive, share, whole
from .population import Population, first_population
from .swarm import PositionRule, kept_in, spread
from .tent import TentRule, tent_population
from .woa import (
    COUNTER_OPEN,
    INITIAL_OPEN,
    OPEN_CHOICES as _SHARED,
    Coefficients,
    Counter,
    Replacement,
    RRule,
    ThresholdRule,
    delta,
    draw,
    encircled,
    explores,
    members,
    replaced,
    spiralled,
)

OPEN_CHOICES = (
    "s: a constant above −1 in (22), not printed; 0, with which w falls linearly",
    "exploration: (21) leaves out the branch (20), which Step 3 names; it is kept, without a "
    "weight",
    "counter: (22) gives w = 0 at I = T, the point 0 itself for A = 0; with I = 0..N−1 the last "
    "weight is above 0",
    "D and D' of (14)(18) keep X* without a weight; (21) prints it on the target only",
    "initial: printed, the tent map (23) with β = 0.5",
    "tent_rule: how orbits of (23) fill 30 whales of 7 durations is not printed; one orbit for "
    "each duration through all whales; its uniformly random start is the first point",
    *(line for line in _SHARED if line not in (COUNTER_OPEN, INITIAL_OPEN)),
)
"""What the paper leaves open, and what was chosen."""


class Exploration(StrEnum):
    """What becomes of the branch (20), which (21) does not show."""

    KEPT = "kept"
    """X_r − A D, as in (20)."""
    WEIGHTED = "weighted"
    """w X_r − A D, after the manner of (21)."""
    DROPPED = "dropped"
    """There is none: (21) to the letter."""


class InitialRule(StrEnum):
    """How the initial population is drawn in its range."""

    TENT = "tent"
    """Orbits of the tent map, as printed."""
    UNIFORM = "uniform"
    """Uniformly, as the plain algorithm: to see what the map changes."""


def inertia_weight(i: int, iterations: int, s: float) -> float:
    """Inertia weight w(I) of (22): 1 at I = 0, falling to 0 at I = T."""
    part = i / iterations
    return (1.0 - part) / (1.0 + s * part)


@dataclass(frozen=True)
class ImprovedWOA:
    """Improved WOA of `z1-woa-bspline`, (21)–(23) and Steps 1–6, and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type or lies outside its range.

    Notes
    -----
    Random numbers are drawn in this order. Initially: the starts of the orbits, or positions whale
    by whale. At each step: as `WOA`.
    """

    kind: ClassVar[str] = "improved-woa"
    side_by_side: ClassVar[bool] = True
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    whales: Annotated[int, whole(1)] = 30
    """Printed."""
    iterations: Annotated[int, whole(0)] = 500
    """T, moves of the population; printed. Also the T of (22) and of δ."""
    s: Annotated[float, above(-1.0)] = 0.0
    """Constant of (22), above −1; not printed."""
    exploration: Exploration = Exploration.KEPT
    """"kept", "weighted" or "dropped"; (21) and Step 3 disagree."""
    initial: InitialRule = InitialRule.TENT
    """"tent" (printed) or "uniform"."""
    tent_rule: TentRule = TentRule.COORDINATE
    """"coordinate", "member" or "single"; not printed."""
    beta: Annotated[float, share(ends=False)] = 0.5
    """β of (23); printed."""
    spiral: Annotated[float, number()] = 1.0
    threshold: Annotated[float, number(infinite=True)] = 1.0
    coefficients: Coefficients = Coefficients.WHALE
    threshold_rule: ThresholdRule = ThresholdRule.COORDINATE
    r_rule: RRule = RRule.SEPARATE
    counter: Counter = Counter.ZERO
    replacement: Replacement = Replacement.ALWAYS
    """As `WOA`; not printed."""
    position_initial: Span = (0.0, 5.0)
    """Range that the initial population fills, s; printed."""
    position_rule: PositionRule = PositionRule.BOUNDS
    """"bounds", "initial" or "free"; not printed."""
    penalty: Annotated[float, positive(infinite=True)] = np.inf
    """Fitness of an infeasible whale, s; not printed."""

    def __post_init__(self) -> None:
        clean(self)

    def scatter(self, rng: np.random.Generator, dimensions: int) -> Array:
        """Draw initial positions, by the tent map (23), shape (whales, dimensions)."""
        if self.initial is InitialRule.UNIFORM:
            return spread(rng, self.position_initial, (self.whales, dimensions))
        low, high = self.position_initial
        points = tent_population(rng, self.whales, dimensions, self.tent_rule, self.beta)
        return low + (high - low) * points

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> Population:
        """Draw and judge the initial population (Steps 1 and 2)."""
        return first_population(self.scatter(rng, bounds.lower.size), objective)

    def step(
        self, pod: Population, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Population:
        """Move every whale once (Step 3) and judge it (Steps 4 and 5)."""
        x, best = pod.positions, pod.best[..., None, :]
        drawn = draw(rng, x, self.coefficients, self.r_rule)
        i = pod.iteration + (self.counter is Counter.ONE)
        d = delta(i, self.iterations)
        a, c = 2.0 * d * drawn.a - d, 2.0 * drawn.c  # (16)
        w = inertia_weight(i, self.iterations, self.s)  # (22)
        circle = encircled(x, best, a, c, w)
        if self.exploration is not Exploration.DROPPED:
            weight = w if self.exploration is Exploration.WEIGHTED else 1.0
            far = explores(a, self.threshold, self.threshold_rule)
            circle = np.where(far, encircled(x, members(x, drawn.member), a, c, weight), circle)
        spiral = spiralled(x, best, drawn.g, self.spiral, w)
        moved = np.where(drawn.chance < 0.5, circle, spiral)  # (21)
        moved = kept_in(moved, self.position_rule, self.position_initial, bounds)
        return replaced(pod, moved, objective, self.replacement, self.penalty)
