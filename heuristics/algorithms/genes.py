"""Genetic operators on durations: encoding, crossover and mutation of a mating pool.

Of populations that are bred side by side every array has one more axis, the first.
"""

from __future__ import annotations

from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, TrajgapError
from ..objective import Bounds, Objective
from .population import Population, first_population, followed
from .swarm import held, spread

Rate = float | Array
"""A chance; of populations side by side that differ in it, of shape (populations, 1, 1)."""


class Encoding(StrEnum):
    """What a chromosome is made of."""

    REAL = "real"
    """One number for each duration."""
    BINARY = "binary"
    """A bit string for each duration, its lattice spread over the range."""


class Crossover(StrEnum):
    """How two parents make two children."""

    ARITHMETIC = "arithmetic"
    """α x + (1 − α) y and (1 − α) x + α y, one random α for each pair."""
    ONE_POINT = "one-point"
    """They swap all genes after a random place."""
    UNIFORM = "uniform"
    """They swap each gene with chance 1/2."""


class Mutation(StrEnum):
    """What happens to a mutated number; a mutated bit is flipped."""

    REDRAW = "redraw"
    """It is drawn anew, uniformly in the range."""
    CREEP = "creep"
    """It moves uniformly within ± a share of the range, and is held in the range."""


class MutationUnit(StrEnum):
    """What the mutation probability is the probability of."""

    GENE = "gene"
    """That a gene mutates."""
    INDIVIDUAL = "individual"
    """That one random gene of an individual mutates."""


class FitnessRule(StrEnum):
    """How a total to be minimised becomes a fitness f ≥ 0 to be maximised; infeasible: 0."""

    INVERSE = "inverse"
    """f = 1/T."""
    COMPLEMENT = "complement"
    """f = T_worst − T, with the worst feasible total of the population, which so gets 0 as well."""


def fitness_values(totals: Array, penalty: float, rule: FitnessRule) -> Array:
    """Fitness f of a population's totals, shape (..., members), in 1/s or s.

    Raises
    ------
    TrajgapError
        If a total of 0 or less is to be inverted.
    """
    feasible = totals < penalty
    fitness = np.zeros_like(totals)
    if not feasible.any():
        return fitness
    if rule is FitnessRule.COMPLEMENT:
        worst = np.where(feasible, totals, -np.inf).max(axis=-1, keepdims=True)
        return np.where(feasible, worst - totals, fitness)
    if (totals[feasible] <= 0).any():
        raise TrajgapError(
            "fitness_rule: 'inverse' needs positive objective values; take 'complement'"
        )
    fitness[feasible] = 1.0 / totals[feasible]
    return fitness


class Genetics:
    """Encoding and operators of algorithms with these settings."""

    population: int
    encoding: Encoding
    crossover: Crossover
    mutation: Mutation
    mutated: MutationUnit
    mutation_reach: float
    position_range: tuple[float, float]
    resolution: float

    @cached_property
    def bits(self) -> int:
        """Bits for each duration: enough for steps no larger than the resolution."""
        low, high = self.position_range
        steps = int(np.ceil((high - low) / self.resolution * (1 - 1e-12)))
        return max(1, steps.bit_length())

    @property
    def spacing(self) -> float:
        """Distance of neighbouring lattice points of the binary encoding, s."""
        low, high = self.position_range
        return (high - low) / float((1 << self.bits) - 1)

    def encoded(self, positions: Array) -> Array:
        """Bits of the nearest lattice points, most significant first, (..., durations·bits)."""
        low, high = self.position_range
        index = np.rint((held(positions, low, high) - low) / self.spacing).astype(np.int64)
        places = np.arange(self.bits)[::-1]
        bits = (index[..., None] >> places) & 1
        return bits.reshape(*positions.shape[:-1], -1).astype(np.float64)

    def decoded(self, bits: Array) -> Array:
        """Positions of bit strings, s."""
        powers = 2.0 ** np.arange(self.bits)[::-1]
        index = bits.reshape(*bits.shape[:-1], -1, self.bits) @ powers
        decoded: Array = self.position_range[0] + index * self.spacing
        return decoded

    def on_lattice(self, positions: Array) -> Array:
        """Positions as the encoding holds them."""
        if self.encoding is Encoding.BINARY:
            return self.decoded(self.encoded(positions))
        return positions

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> Population:
        """Draw and judge the initial population."""
        drawn = spread(rng, self.position_range, (self.population, bounds.lower.size))
        return first_population(self.on_lattice(drawn), objective)

    def bred(
        self,
        before: Population,
        pool: Array,
        rates: tuple[Rate, Rate],
        elite: int,
        rng: np.random.Generator,
        objective: Objective,
    ) -> Population:
        """Next generation from a shuffled mating pool, by chances of crossover and mutation."""
        children = self.offspring(pool, *rates, rng)
        positions, totals = elite_kept(
            before.positions, before.fitness, children, objective(children), elite
        )
        return followed(before, positions, totals)

    def offspring(
        self, pool: Array, crossover_rate: Rate, mutation_rate: Rate, rng: np.random.Generator
    ) -> Array:
        """Cross neighbours of a shuffled pool of even size, then mutate.

        Draws whether each pair mates, its crossover's numbers, whether each gene (or individual)
        mutates, then the numbers of the mutation.
        """
        if self.encoding is Encoding.REAL:
            return self._mutated(crossed(pool, self.crossover, crossover_rate, rng),
                                 mutation_rate, rng)  # fmt: skip
        if self.crossover is Crossover.ARITHMETIC:
            bits = self.encoded(crossed(pool, self.crossover, crossover_rate, rng))
        else:
            bits = crossed(self.encoded(pool), self.crossover, crossover_rate, rng)
        flips = chosen(self.mutated, mutation_rate, bits.shape[-2:], rng)
        return self.decoded(np.where(flips, 1.0 - bits, bits))

    def _mutated(self, children: Array, rate: Rate, rng: np.random.Generator) -> Array:
        low, high = self.position_range
        where = chosen(self.mutated, rate, children.shape[-2:], rng)
        size = rng.random(children.shape[-2:])
        if self.mutation is Mutation.CREEP:
            reach = self.mutation_reach * (high - low)
            fresh = held(children + reach * (2.0 * size - 1.0), low, high)
        else:
            fresh = low + (high - low) * size
        return np.where(where, fresh, children)


def crossed(pool: Array, rule: Crossover, rate: Rate, rng: np.random.Generator) -> Array:
    """Cross the pairs (0, 1), (2, 3), ... of a pool, each with chance ``rate``."""
    first, second = pool[..., 0::2, :], pool[..., 1::2, :]
    pairs, genes = first.shape[-2:]
    mates = rng.random((pairs, 1)) < rate
    if rule is Crossover.ARITHMETIC:
        part = rng.random((pairs, 1))
        one, two = part * first + (1 - part) * second, (1 - part) * first + part * second
    else:
        if rule is Crossover.ONE_POINT:
            cut = 1 + np.floor(rng.random((pairs, 1)) * (genes - 1))
            swap = np.arange(genes) >= cut
        else:
            swap = rng.random((pairs, genes)) < 0.5
        one, two = np.where(swap, second, first), np.where(swap, first, second)
    children = np.empty_like(pool)
    children[..., 0::2, :] = np.where(mates, one, first)
    children[..., 1::2, :] = np.where(mates, two, second)
    return children


def chosen(
    unit: MutationUnit, rate: Rate, shape: tuple[int, ...], rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Draw which genes mutate, of a population of shape (members, genes)."""
    members, genes = shape
    if unit is MutationUnit.GENE:
        each: NDArray[np.bool_] = rng.random(shape) < rate
        return each
    drawn = rng.random((2, members, 1))
    which, place = drawn[..., 0, :, :], drawn[..., 1, :, :]
    one: NDArray[np.bool_] = (which < rate) & (np.arange(genes) == np.floor(place * genes))
    return one


def roulette(weights: Array, draws: Array) -> NDArray[np.intp]:
    """Members drawn with chances proportional to weights ≥ 0; equal chances if all are 0.

    Weights that all populations share have one axis, and draws any number; otherwise both have
    the axis of populations.
    """
    total = np.cumsum(np.where(weights.any(axis=-1, keepdims=True), weights, 1.0), axis=-1)
    places = draws * total[..., -1:]
    if weights.ndim == 1:
        picked = np.searchsorted(total, places, side="right")
    else:
        picked = (total[..., None, :] <= places[..., :, None]).sum(axis=-1)
    held_in: NDArray[np.intp] = np.minimum(picked, weights.shape[-1] - 1)
    return held_in


def members_of(population: Array, which: NDArray[np.intp]) -> Array:
    """Members of shape (..., members, genes) by their indices (..., members)."""
    return np.take_along_axis(population, which[..., None], axis=-2)


def shuffled(pool: Array, rng: np.random.Generator) -> Array:
    """Shuffle a mating pool, so neighbours are random pairs."""
    return members_of(pool, np.argsort(rng.random(pool.shape[-2]), axis=-1, kind="stable"))


def elite_kept(
    parents: Array, parent_totals: Array, children: Array, child_totals: Array, elite: int
) -> tuple[Array, Array]:
    """Children whose worst are replaced by the best parents, and their totals."""
    if elite == 0:
        return children, child_totals
    best = np.argsort(parent_totals, axis=-1, kind="stable")[..., :elite]
    worst = np.argsort(child_totals, axis=-1, kind="stable")[..., child_totals.shape[-1] - elite :]
    kept, totals = children.copy(), child_totals.copy()
    np.put_along_axis(kept, worst[..., None], members_of(parents, best), axis=-2)
    np.put_along_axis(totals, worst, np.take_along_axis(parent_totals, best, axis=-1), axis=-1)
    return kept, totals
