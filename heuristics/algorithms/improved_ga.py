"""The improved GA: quarters by rank, roulette on the middle half, adaptive rates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...problem import Array
from ..objective import Bounds, Objective
from ..settings import Span, clean, number, positive, reject, share, switch, whole
from .ga import (
    ELITE_OPEN,
    SHARED_OPEN,
    check_population,
    check_range,
)
from .genes import (
    Crossover,
    Encoding,
    FitnessRule,
    Genetics,
    Mutation,
    MutationUnit,
    Rate,
    fitness_values,
    members_of,
    roulette,
    shuffled,
)
from .population import Population

OPEN_CHOICES = (
    "q_best, q_worst: q_y and q_s of (13), not printed; 0.2 and 0.05",
    "pool_rule: how many are drawn from the middle half is not printed; as many as fill the pool "
    "with the best quarter, 3/4 of the population",
    "best_quarter: 'directly selected as parents of the next generation' may mean that they enter "
    "the mating pool, to be crossed and mutated, or that they survive; they enter the pool",
    "M of (13) is 1 in the first generation that is bred, Z in the last",
    "f_ave/f_max of a population without any feasible individual is 0/0; taken as 1, all equal",
    "(14)(15): the rates hold for the whole population; at arcsin = π/6 the branches with ≥ hold",
    *(line for line in SHARED_OPEN if line != ELITE_OPEN),
)
"""What the paper leaves open, and what was chosen."""


class PoolRule(StrEnum):
    """How the mating pool is filled up to the size of the population."""

    FILL = "fill"
    """The best quarter once; the middle half gives the other three quarters."""
    DOUBLE_BEST = "double-best"
    """The best quarter twice, instead of the worst; the middle half gives one half."""


class BestQuarter(StrEnum):
    """What becomes of the best quarter."""

    PARENTS = "parents"
    """It enters the mating pool, where it may be crossed and mutated."""
    SURVIVES = "survives"
    """It enters the pool, and it also replaces the worst quarter of the children."""


def schedule(generation: int, generations: int, q_best: float, q_worst: float) -> float:
    """Chance q^M of the best of the middle half, (13): q_y at M = 1, q_s at M = Z.

    The quotient is 0/0 for a single generation; then q_y.
    """
    if generations == 1:
        return q_best
    return q_best - (q_best - q_worst) * (generation - 1) / (generations - 1)


def rank_chances(q: float, count: int) -> Array:
    """Chances p_a = Q(1 − q)^{a−1} of ranks a = 1..count, Q = q/(1 − (1 − q)^count), (12)."""
    top = q / (1.0 - (1.0 - q) ** count)
    return np.array([top * (1.0 - q) ** (a - 1) for a in range(1, count + 1)])


def concentration(f_mean: float, f_max: float) -> float:
    """arcsin(f_ave/f_max)/(π/2) of (14)(15), from 0 to 1; NaN if the arcsine has no value.

    With every fitness 0 the quotient is 0/0; all are alike, so 1.
    """
    if f_max == 0.0 == f_mean:
        return 1.0
    ratio = f_mean / f_max if f_max else math.inf
    return math.asin(ratio) / (math.pi / 2) if abs(ratio) <= 1.0 else math.nan


def crossover_rate(concentrated: float, k1: float, k4: float) -> float:
    """P_c of (14); arcsin ≥ π/6 is a concentration of 1/3 or more."""
    return k1 * (1.0 - concentrated) if concentrated >= THIRD else k4 * concentrated


def mutation_rate(concentrated: float, k2: float, k3: float) -> float:
    """P_z of (15); its two formulas are assigned the other way round than those of (14)."""
    return k2 * concentrated if concentrated >= THIRD else k3 * (1.0 - concentrated)


THIRD = math.asin(0.5) / (math.pi / 2)
"""Concentration at f_ave/f_max = 1/2, π/6 over π/2, rounded as the arcsine rounds it."""


@dataclass(frozen=True)
class ImprovedGA(Genetics):
    """Improved GA of `irb1600-ga-cubic-bspline`, (12)–(15), and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type, lies outside its range, or contradicts another one.

    Notes
    -----
    Random numbers are drawn in this order. Initially: positions, individual by individual. At each
    step: one number for each parent from the middle half, then as `GA` from the shuffling on.
    """

    kind: ClassVar[str] = "improved-ga"
    side_by_side: ClassVar[bool] = True
    makes_copies: ClassVar[bool] = True
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    population: Annotated[int, whole(2)] = 40
    """N, a multiple of 4; not printed."""
    iterations: Annotated[int, whole(0)] = 200
    """Z, generations after the initial one; not printed. Also the Z of (13)."""
    q_best: Annotated[float, share(ends=False)] = 0.2
    q_worst: Annotated[float, share(ends=False)] = 0.05
    """q_y and q_s of (13), between 0 and 1; not printed."""
    pool_rule: PoolRule = PoolRule.FILL
    """"fill" or "double-best"; not printed."""
    best_quarter: BestQuarter = BestQuarter.PARENTS
    """"parents" or "survives"; the text leaves it open."""
    k1: Annotated[float, number()] = 1.0
    k2: Annotated[float, number()] = 0.05
    k3: Annotated[float, number()] = 0.02
    k4: Annotated[float, number()] = 2.0
    """Constants of (14)(15); printed."""
    adaptive_crossover: Annotated[bool, switch()] = True
    adaptive_mutation: Annotated[bool, switch()] = True
    """Whether the rate is that of (14) or (15), as printed; otherwise the fixed one, to see what
    adapting it changes."""
    crossover_fixed: Annotated[float, share()] = 0.8
    mutation_fixed: Annotated[float, share()] = 0.05
    """Rates where they are not adaptive; those of `GA`, not printed."""
    fitness_rule: FitnessRule = FitnessRule.INVERSE
    encoding: Encoding = Encoding.REAL
    resolution: Annotated[float, positive()] = 0.001
    position_range: Span = (0.1, 2.0)
    crossover: Crossover = Crossover.ARITHMETIC
    mutation: Mutation = Mutation.REDRAW
    mutated: MutationUnit = MutationUnit.GENE
    """As `GA`; not printed, the resolution apart."""
    mutation_reach: Annotated[float, share()] = 0.1
    penalty: Annotated[float, positive(infinite=True)] = np.inf
    """As `GA`; not printed."""

    def __post_init__(self) -> None:
        clean(self)
        check_population(self.kind, self.population, 0, 4)
        check_range(self.kind, self.position_range)
        if self.q_worst > self.q_best:
            raise reject(self.kind, "q_worst", "exceeds q_best")

    def rates(self, fitness: Array) -> tuple[Rate, Rate]:
        """P_c and P_z of a population, (14)(15), or the fixed ones."""
        tops, means = fitness.max(axis=-1), fitness.mean(axis=-1)
        if fitness.ndim == 1:
            return self._rates(float(means), float(tops))
        each = map(self._rates, means.tolist(), tops.tolist())
        crossing, mutating = np.array(list(each)).T[..., None, None]
        return crossing, mutating

    def _rates(self, mean: float, top: float) -> tuple[float, float]:
        # Rounding may lift the mean of equal numbers above them, and the arcsine out of its domain.
        at = concentration(min(mean, top), top)
        crossing = crossover_rate(at, self.k1, self.k4)
        mutating = mutation_rate(at, self.k2, self.k3)
        return (
            crossing if self.adaptive_crossover else self.crossover_fixed,
            mutating if self.adaptive_mutation else self.mutation_fixed,
        )

    def parents(self, totals: Array, generation: int, rng: np.random.Generator) -> NDArray[np.intp]:
        """Indices of the mating pool: the best quarter, and a roulette on the middle half."""
        order = np.argsort(totals, axis=-1, kind="stable")  # the worst quarter is dropped
        quarter: int = totals.shape[-1] // 4
        best, middle = order[..., :quarter], order[..., quarter : 3 * quarter]
        q = schedule(generation, self.iterations, self.q_best, self.q_worst)  # (13)
        again = best if self.pool_rule is PoolRule.DOUBLE_BEST else best[..., :0]
        draws = rng.random(3 * quarter - again.shape[-1])
        ranks = roulette(rank_chances(q, middle.shape[-1]), draws)  # (12)
        picked = np.take_along_axis(middle, ranks, axis=-1)
        return np.concatenate([best, again, picked], axis=-1)

    def step(
        self, before: Population, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Population:
        """Make the next generation and judge it."""
        fitness = fitness_values(before.fitness, self.penalty, self.fitness_rule)
        rates = self.rates(fitness)
        chosen = self.parents(before.fitness, before.iteration + 1, rng)
        pool = shuffled(members_of(before.positions, chosen), rng)
        elite = self.population // 4 if self.best_quarter is BestQuarter.SURVIVES else 0
        return self.bred(before, pool, rates, elite, rng, objective)
