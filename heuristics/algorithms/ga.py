"""The standard genetic algorithm: fitness-proportionate selection, crossover, mutation."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...problem import Array
from ..objective import Bounds, Objective
from ..settings import Span, clean, positive, reject, share, whole
from .genes import (
    Crossover,
    Encoding,
    FitnessRule,
    Genetics,
    Mutation,
    MutationUnit,
    fitness_values,
    members_of,
    roulette,
    shuffled,
)
from .population import Population

ELITE_OPEN = (
    "elite: whether the best individual survives is not printed; it does not, but is reported"
)
"""Of the standard algorithm alone: the improved one prints what becomes of its best."""
SHARED_OPEN = (
    "population, iterations: not printed; 40 and 200",
    "encoding, resolution: not printed; real numbers (binary: a lattice at least as fine as the "
    "printed 'time resolution 0.001 s')",
    "position_range: no range of the durations is printed; [0.1, 2] s, around the printed 0.66 to "
    "1.00 s",
    "fitness_rule: the fitness of a minimisation is not printed, 'the largest fitness' is best; "
    "1/T, and 0 for an infeasible individual",
    "how limits enter the fitness is not printed; death penalty",
    "crossover, mutation, mutated, mutation_reach: operators are not printed; arithmetic crossover "
    "of random pairs, a mutated gene is drawn anew, the probability is that of a gene",
    ELITE_OPEN,
    "ties: the best is replaced only by a strictly smaller total; the first individual leads",
    "budget: N iterations are N generations after the initial one, N + 1 evaluations of the "
    "population",
)
"""What the paper leaves open for both of its genetic algorithms, and what was chosen."""

OPEN_CHOICES = (
    "selection: 'roulette in proportion to the fitness' is said of the traditional algorithm; "
    "kept, a tournament of two for comparison",
    "crossover_rate, mutation_rate: not printed for the traditional algorithm; 0.8 and 0.05",
    *SHARED_OPEN,
)
"""What the paper leaves open, and what was chosen."""


class Selection(StrEnum):
    """How parents are selected."""

    ROULETTE = "roulette"
    """With chances in proportion to the fitness."""
    TOURNAMENT = "tournament"
    """The fitter of two random individuals; the first of two equal ones."""


@dataclass(frozen=True)
class GA(Genetics):
    """Standard GA, the "traditional" one of `irb1600-ga-cubic-bspline`, and its settings.

    Raises
    ------
    TrajgapError
        If a value has the wrong type, lies outside its range, or contradicts another one.

    Notes
    -----
    Random numbers are drawn in this order. Initially: positions, individual by individual. At each
    step: the selection (one number for each parent; for "tournament" two), the shuffling of the
    parents, which pairs mate, the numbers of their crossover, which genes mutate (for "individual":
    which individuals, then where), the size of each mutation (real encoding).
    """

    kind: ClassVar[str] = "ga"
    side_by_side: ClassVar[bool] = True
    makes_copies: ClassVar[bool] = True
    open_choices: ClassVar[tuple[str, ...]] = OPEN_CHOICES

    population: Annotated[int, whole(2)] = 40
    """Even; not printed."""
    iterations: Annotated[int, whole(0)] = 200
    """Generations after the initial one; not printed."""
    crossover_rate: Annotated[float, share()] = 0.8
    mutation_rate: Annotated[float, share()] = 0.05
    """Not printed."""
    selection: Selection = Selection.ROULETTE
    """"roulette" (said of it) or "tournament"."""
    fitness_rule: FitnessRule = FitnessRule.INVERSE
    """"inverse" or "complement"; not printed."""
    encoding: Encoding = Encoding.REAL
    """"real" or "binary"; not printed."""
    resolution: Annotated[float, positive()] = 0.001
    """Largest step of the binary encoding, s; printed as the time resolution."""
    position_range: Span = (0.1, 2.0)
    """Range that durations are drawn, encoded and mutated in, s; not printed."""
    crossover: Crossover = Crossover.ARITHMETIC
    """"arithmetic", "one-point" or "uniform"; not printed. Arithmetic crossover of bit strings acts
    on the numbers that they encode."""
    mutation: Mutation = Mutation.REDRAW
    """"redraw" or "creep"; not printed. Bits are flipped."""
    mutated: MutationUnit = MutationUnit.GENE
    """"gene" or "individual"; not printed."""
    mutation_reach: Annotated[float, share()] = 0.1
    """Half-width of "creep" as a share of the range; not printed."""
    elite: Annotated[int, whole(0)] = 0
    """Best individuals that survive instead of the worst children; not printed."""
    penalty: Annotated[float, positive(infinite=True)] = np.inf
    """Total of an infeasible individual, s; not printed."""

    def __post_init__(self) -> None:
        clean(self)
        check_population(self.kind, self.population, self.elite, 2)
        check_range(self.kind, self.position_range)

    def parents(self, fitness: Array, rng: np.random.Generator) -> NDArray[np.intp]:
        """Draw as many parents as individuals."""
        size: int = fitness.shape[-1]
        if self.selection is Selection.ROULETTE:
            return roulette(fitness, rng.random(size))
        rivals = (size * rng.random((2, size))).astype(np.intp)
        first, second = rivals[..., 0, :], rivals[..., 1, :]
        fitter = np.take_along_axis(fitness, second, -1) > np.take_along_axis(fitness, first, -1)
        winners: NDArray[np.intp] = np.where(fitter, second, first)
        return winners

    def step(
        self, before: Population, bounds: Bounds, rng: np.random.Generator, objective: Objective
    ) -> Population:
        """Make the next generation and judge it."""
        fitness = fitness_values(before.fitness, self.penalty, self.fitness_rule)
        pool = shuffled(members_of(before.positions, self.parents(fitness, rng)), rng)
        rates = (self.crossover_rate, self.mutation_rate)
        return self.bred(before, pool, rates, self.elite, rng, objective)


def check_population(kind: str, population: int, elite: int, multiple: int) -> None:
    """Refuse a population that cannot be paired or divided, or one of survivors only."""
    if population % multiple:
        raise reject(kind, "population", f"must be a multiple of {multiple}, got {population}")
    if elite >= population:
        raise reject(kind, "elite", f"{elite} survivors leave no room in {population}")


def check_range(kind: str, span: tuple[float, float]) -> None:
    """Refuse a range without width: nothing could be encoded or mutated."""
    if not span[0] < span[1]:
        raise reject(kind, "position_range", "has no width; give two different numbers")
