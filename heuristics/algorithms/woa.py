"""The whale optimisation algorithm as printed: encircling, spiral, and a random whale."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...problem import Array
from ..objective import Bounds, Objective
from ..settings import Span, clean, number, positive, whole
from .population import Population, first_population, followed
from .swarm import PositionRule, kept_in, spread

COUNTER_OPEN = (
    "counter: whether the first move has I = 0 or 1; 0, so δ falls from 2 to 2/N and never "
    "reaches the 0 that it is said to fall to"
)
"""Of the plain algorithm alone: the improved one has a reason of its own."""
INITIAL_OPEN = (
    "the initial population of the plain algorithm is not printed; uniform in the printed range"
)
"""Of the plain algorithm alone: the improved one prints its initial population."""
OPEN_CHOICES = (
    "spiral: the constant b of (17) is not printed; 1, as in the published program of the "
    "algorithm's authors",
    "threshold: the |A| from which (20) is used is not printed; 1, as in the source that the paper "
    "cites (Mirjalili & Lewis 2016)",
    "coefficients: A and C are called coefficients and r a number, whereas the source has "
    "vectors; one A "
    "and one C for each whale",
    "threshold_rule: |A| of a vector; each coordinate by its own |A| (the same for numbers)",
    "r_rule: (16) prints one r in A and in C; drawn separately, as in the authors' program",
    COUNTER_OPEN,
    "replacement: 'a search that crosses a limit is cut off' (Step 4) may mean the penalty, or "
    "that the whale stays; every whale moves, an infeasible one has the penalty",
    "position_rule: [0, 5] s is printed, what happens to a whale that leaves it is not; set to the "
    "duration bounds of the reading, where a duration of 0 is infeasible",
    "λ and g are numbers ('any value'); one each for every whale, not for every coordinate",
    "X_r of (20) is drawn from all whales, the moving one included, one for each whale; the "
    "authors' program draws a new one for each coordinate",
    "order within an iteration: the whole population moves from where it was, then it is judged; "
    "the authors' program lets later whales see moved ones",
    INITIAL_OPEN,
    "ties: X* is replaced only by a strictly smaller fitness; the first whale leads",
    "budget: N iterations are N moves after the initial evaluation, N + 1 evaluations of the "
    "population; the authors' program never judges the last move",
)
"""What the paper leaves open, and what was chosen."""


class Coefficients(StrEnum):
    """What one A and one C of (16) serve."""

    WHALE = "whale"
    """All coordinates of a whale."""
    COORDINATE = "coordinate"
    """One coordinate of a whale: A and C are vectors."""


class ThresholdRule(StrEnum):
    """What is compared with the threshold if A is a vector."""

    COORDINATE = "coordinate"
    """Each coordinate by its own |A|."""
    LENGTH = "length"
    """The whole whale by the length of A."""


class RRule(StrEnum):
    """Whether the r of A and the r of C in (16) are one number."""

    SEPARATE = "separate"
    """Two draws."""
    SHARED = "shared"
    """One draw, as the letter says: C = 1 + A/δ."""


class Counter(StrEnum):
    """The I of the first move."""

    ZERO = "zero"
    """Moves have I = 0..N−1: δ falls from 2 to 2/N."""
    ONE = "one"
    """Moves have I = 1..N: δ falls from 2 − 2/N to 0."""


class Replacement(StrEnum):
    """When a whale takes its new position."""

    ALWAYS = "always"
    """Always, as (19) says."""
    FEASIBLE = "feasible"
    """If it is feasible; else the whale stays."""
    GREEDY = "greedy"
    """If it is better; so libraries do."""


@dataclass(frozen=True, eq=False, slots=True)
class Draw:
    """Random numbers of one iteration, of shape (whales, 1) or (whales, dimensions)."""

    a: Array
    c: Array
    """The r of A and the r of C, in [0, 1)."""
    g: Array
    """Shape (whales, 1). In [−1, 1)."""
    chance: Array
    """Shape (whales, 1); λ, in [0, 1)."""
    member: NDArray[np.intp]
    """Shape (whales,). Which whale is X_r."""


def draw(
    rng: np.random.Generator, positions: Array, coefficients: Coefficients, rule: RRule
) -> Draw:
    """Draw r of A, r of C (unless shared), g, λ and X_r, each for all whales."""
    whales, dimensions = positions.shape[-2:]
    shape = (whales, dimensions if coefficients is Coefficients.COORDINATE else 1)
    a = rng.random(shape)
    c = a if rule is RRule.SHARED else rng.random(shape)
    g = 2.0 * rng.random((whales, 1)) - 1.0
    chance = rng.random((whales, 1))
    member = (whales * rng.random(whales)).astype(np.intp)
    return Draw(a, c, g, chance, member)


def members(positions: Array, which: NDArray[np.intp]) -> Array:
    """Positions of the members that were drawn, one for each member."""
    return np.take_along_axis(positions, which[..., None], axis=-2)


def delta(i: int, iterations: int) -> float:
    """δ of (16) for I = ``i``: 2 at I = 0, 0 at I = ``iterations``."""
    return 2.0 * (1.0 - i / iterations)


def encircled(x: Array, target: Array, a: Array, c: Array, weight: float = 1.0) -> Array:
    """Whales around a target: w X* − A |C X* − X|, (14)(15); with X_r as target, (20)."""
    return weight * target - a * np.abs(c * target - x)


def spiralled(x: Array, best: Array, g: Array, b: float, weight: float = 1.0) -> Array:
    """Whales on the spiral: |X* − X| e^{bg} cos(2πg) + w X*, (17)(18)."""
    return np.abs(best - x) * np.exp(b * g) * np.cos(2.0 * np.pi * g) + weight * best


def explores(a: Array, threshold: float, rule: ThresholdRule) -> NDArray[np.bool_]:
    """Where |A| reaches the threshold, of the shape of A or (whales, 1)."""
    if rule is ThresholdRule.LENGTH:
        size: Array = np.linalg.norm(a, axis=-1, keepdims=True)
        return size >= threshold
    return np.abs(a) >= threshold


def replaced(
    pod: Population, positions: Array, objective: Objective, rule: Replacement, penalty: float
) -> Population:
    """Judge moved whales and let those take their new position that the rule allows."""
    fitness = objective(positions)
    if rule is Replacement.ALWAYS:
        return followed(pod, positions, fitness)
    taken = fitness < (penalty if rule is Replacement.FEASIBLE else pod.fitness)
    kept = np.where(taken[..., None], positions, pod.positions)
    return followed(pod, kept, np.where(taken, fitness, pod.fitness))


@dataclass(frozen=True)
class WOA:
    """WOA of `z1-woa-bspline`, (14)–(20), after Mirjalili & Lewis (2016), and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type or lies outside its range.

    Notes
    -----
    Random numbers are drawn in this order. Initially: positions, whale by whale. At each step: all
    r of A, all r of C unless shared, all g, all λ, all X_r; all of them, used or not.
    """

    kind: ClassVar[str] = "woa"
    side_by_side: ClassVar[bool] = True
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    whales: Annotated[int, whole(1)] = 30
    """Printed."""
    iterations: Annotated[int, whole(0)] = 500
    """T, moves of the population; printed. Also the T over which δ falls."""
    spiral: Annotated[float, number()] = 1.0
    """b of (17); not printed."""
    threshold: Annotated[float, number(infinite=True)] = 1.0
    """|A| from which a random whale is the target; not printed. ``inf`` never explores."""
    coefficients: Coefficients = Coefficients.WHALE
    """"whale" or "coordinate"; not printed."""
    threshold_rule: ThresholdRule = ThresholdRule.COORDINATE
    """"coordinate" or "length"; matters only with coefficients "coordinate"; not printed."""
    r_rule: RRule = RRule.SEPARATE
    """"separate" or "shared"; (16) prints one letter."""
    counter: Counter = Counter.ZERO
    """"zero" or "one"; not printed."""
    replacement: Replacement = Replacement.ALWAYS
    """"always" (as (19) says), "feasible" or "greedy"; Step 4 leaves it open."""
    position_initial: Span = (0.0, 5.0)
    """Range that the initial durations are drawn from, s; printed."""
    position_rule: PositionRule = PositionRule.BOUNDS
    """"bounds", "initial" or "free"; not printed."""
    penalty: Annotated[float, positive(infinite=True)] = np.inf
    """Fitness of an infeasible whale, s; not printed."""

    def __post_init__(self) -> None:
        clean(self)

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> Population:
        """Draw and judge the initial population."""
        shape = (self.whales, bounds.lower.size)
        return first_population(spread(rng, self.position_initial, shape), objective)

    def step(
        self, pod: Population, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Population:
        """Move every whale once, (19) and (20), and judge it."""
        x, best = pod.positions, pod.best[..., None, :]
        drawn = draw(rng, x, self.coefficients, self.r_rule)
        d = delta(pod.iteration + (self.counter is Counter.ONE), self.iterations)
        a, c = 2.0 * d * drawn.a - d, 2.0 * drawn.c  # (16)
        others = members(x, drawn.member)
        far = explores(a, self.threshold, self.threshold_rule)
        circle = np.where(far, encircled(x, others, a, c), encircled(x, best, a, c))
        spiral = spiralled(x, best, drawn.g, self.spiral)
        moved = np.where(drawn.chance < 0.5, circle, spiral)  # (19)
        moved = kept_in(moved, self.position_rule, self.position_initial, bounds)
        return replaced(pod, moved, objective, self.replacement, self.penalty)
