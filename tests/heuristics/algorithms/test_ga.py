"""The standard GA: selection, crossover and mutation against steps worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, Script
from trajgap.heuristics import GA, Bounds
from trajgap.heuristics.algorithms.genes import (
    Crossover,
    FitnessRule,
    Genetics,
    MutationUnit,
    chosen,
    crossed,
    elite_kept,
    fitness_values,
    roulette,
)
from trajgap.heuristics.algorithms.population import Population
from trajgap.problem import TrajgapError

X = np.array([[1.0, 1.0], [0.5, 1.5], [1.5, 2.5], [3.0, 1.0]])
SMALL = GA(population=4, position_range=(0.0, 4.0))


def total(x: np.ndarray) -> np.ndarray:
    """Sum of the coordinates, infeasible where one is below 1/4."""
    return np.where((x >= 0.25).all(axis=1), x.sum(axis=1), np.inf)


def generation(positions: np.ndarray = X) -> Population:
    totals = total(positions)
    best = int(totals.argmin())
    return Population(0, positions, totals, positions[best], float(totals[best]))


def test_fitness_to_be_maximised() -> None:
    totals = np.array([2.0, np.inf, 4.0, 5.0])
    inverse, complement = FitnessRule.INVERSE, FitnessRule.COMPLEMENT
    np.testing.assert_array_equal(fitness_values(totals, np.inf, inverse), [0.5, 0, 0.25, 0.2])
    np.testing.assert_array_equal(fitness_values(totals, np.inf, complement), [3, 0, 1, 0])
    np.testing.assert_array_equal(fitness_values(totals, 5.0, inverse), [0.5, 0, 0.25, 0])
    np.testing.assert_array_equal(fitness_values(totals[[1, 1]], np.inf, inverse), [0, 0])
    negative = np.array([-1.0, 2.0])
    np.testing.assert_array_equal(fitness_values(negative, np.inf, complement), [3.0, 0.0])
    with pytest.raises(
        TrajgapError, match=r"^fitness_rule: 'inverse' needs positive .* take 'comp"
    ):
        fitness_values(negative, np.inf, inverse)


def test_roulette_by_hand() -> None:
    # Shares 1/4, 0, 1/2, 1/4 of the wheel.
    weights = np.array([1.0, 0.0, 2.0, 1.0])
    draws = np.array([0.0, 0.24, 0.25, 0.74, 0.75, 0.999])
    np.testing.assert_array_equal(roulette(weights, draws), [0, 0, 2, 2, 3, 3])
    np.testing.assert_array_equal(roulette(np.zeros(4), np.array([0.0, 0.3, 0.6, 0.9])), range(4))
    assert roulette(np.full(10, 0.1), np.array([np.nextafter(1.0, 0.0)]))[0] == 9


def test_a_generation_by_hand() -> None:
    # f = 1/2, 1/2, 1/4, 1/4: the wheel is cut at 1/3, 2/3, 5/6. Parents 0, 1, 2, 0.
    # Shuffled by the ranks of (0.5, 0.25, 1, 0.75): 1, 0, 0, 2.
    # Pair (1, 0) mates with α = 0.25; pair (0, 2) does not.
    # Gene 2 of child 1 is drawn anew at 0.125 of [0, 4], gene 1 of child 4 at 0.5.
    numbers = Script(
        [0.1, 0.5, 0.7, 0.2], [0.5, 0.25, 1.0, 0.75], [0.79, 0.81], [0.25, 0.5],
        [0.9, 0.04, 0.9, 0.9, 0.9, 0.9, 0.04, 0.9], [0.0, 0.125, 0, 0, 0, 0, 0.5, 0],
    )  # fmt: skip
    after = SMALL.step(generation(), OPEN, numbers, total)
    # 0.25 (0.5, 1.5) + 0.75 (1, 1) = (0.875, 1.125); 0.75 (0.5, 1.5) + 0.25 (1, 1)
    expected = [[0.875, 0.5], [0.625, 1.375], [1.0, 1.0], [2.0, 2.5]]
    np.testing.assert_array_equal(after.positions, expected)
    np.testing.assert_array_equal(after.fitness, [1.375, 2.0, 2.0, 4.5])
    np.testing.assert_array_equal(after.best, [0.875, 0.5])
    assert (after.iteration, after.best_fitness, numbers.left) == (1, 1.375, [])


def test_the_best_is_kept_though_it_does_not_survive() -> None:
    record = replace(SMALL, crossover_rate=0.0, mutation_rate=0.0)
    numbers = Script([0.9] * 4, [0.1, 0.2, 0.3, 0.4], [0.5] * 4, [0.5] * 8, [0.5] * 8)
    after = record.step(generation(), OPEN, numbers, total)
    np.testing.assert_array_equal(after.positions, X[[3, 3, 3, 3]])
    np.testing.assert_array_equal(after.best, X[0])
    assert after.best_fitness == 2.0


def test_tournament_by_hand() -> None:
    record = replace(SMALL, selection="tournament")
    fitness = np.array([0.5, 0.5, 0.25, 0.2])
    numbers = Script([0.0, 0.3, 0.6, 0.9], [0.3, 0.0, 0.9, 0.6])
    np.testing.assert_array_equal(record.parents(fitness, numbers), [0, 1, 2, 2])


@pytest.mark.parametrize(
    ("rule", "numbers", "expected"),
    [
        # Cut after gene 1 + ⌊0.5·2⌋ = 2.
        ("one-point", [0.5], [[1, 2, 6], [4, 5, 3]]),
        ("one-point", [0.0], [[1, 5, 6], [4, 2, 3]]),
        ("uniform", [0.49, 0.5, 0.1], [[4, 2, 6], [1, 5, 3]]),
        ("arithmetic", [0.25], [[3.25, 4.25, 5.25], [1.75, 2.75, 3.75]]),
    ],
)
def test_crossover(rule: str, numbers: list[float], expected: list[list[float]]) -> None:
    pool = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    script = Script([0.29], numbers)
    np.testing.assert_array_equal(crossed(pool, Crossover(rule), 0.3, script), expected)
    assert script.left == []
    apart = crossed(pool, Crossover(rule), 0.3, Script([0.3], numbers))
    np.testing.assert_array_equal(apart, pool)


def test_mutated_genes() -> None:
    hits = chosen(MutationUnit.GENE, 0.25, (2, 2), Script([0.24, 0.25, 0.0, 0.9]))
    np.testing.assert_array_equal(hits, [[True, False], [True, False]])
    one = chosen(MutationUnit.INDIVIDUAL, 0.25, (3, 4), Script([0.24, 0.25, 0.0], [0.5, 0.5, 0.99]))
    np.testing.assert_array_equal(one, [[0, 0, 1, 0], [0, 0, 0, 0], [0, 0, 0, 1]])


def genetics(**changes: object) -> Genetics:
    return replace(SMALL, **changes).genetics


def test_creeping_mutation_is_held_in_the_range() -> None:
    record = genetics(mutation="creep", mutation_reach=0.25)
    pool = np.array([[1.0, 3.5], [0.5, 2.0]])
    numbers = Script([0.9], [0.5], np.zeros(4), [0.75, 1.0, 0.0, 0.25])
    # ± 1 s: +0.5, +1 (held at 4), −1 (held at 0), −0.5
    children = record.offspring(pool, 0.0, 1.0, numbers)
    np.testing.assert_array_equal(children, [[1.5, 4.0], [0.0, 1.5]])


def test_binary_lattice() -> None:
    record = genetics(encoding="binary", position_range=(1.0, 4.5), resolution=0.5)
    assert (record.bits, record.step) == (3, 0.5)
    bits = record.encoded(np.array([[1.0, 2.6], [4.5, 9.0]]))
    np.testing.assert_array_equal(bits, [[0, 0, 0, 0, 1, 1], [1, 1, 1, 1, 1, 1]])
    np.testing.assert_array_equal(record.decoded(bits), [[1.0, 2.5], [4.5, 4.5]])


@pytest.mark.parametrize(
    ("span", "resolution", "bits"),
    [((0.1, 2.0), 0.001, 11), ((0.0, 1.0), 1.0, 1), ((0.0, 3.0), 1.0, 2), ((0.0, 3.1), 1.0, 3)],
)
def test_bits_for_a_resolution(span: tuple[float, float], resolution: float, bits: int) -> None:
    record = genetics(encoding="binary", position_range=span, resolution=resolution)
    assert record.bits == bits
    assert record.step <= resolution * (1 + 1e-9)


def test_binary_operators_by_hand() -> None:
    record = genetics(
        encoding="binary", position_range=(0.0, 7.0), resolution=1.0, crossover="one-point"
    )
    pool = np.array([[5.0, 3.0], [2.0, 6.0]])  # 101 011 and 010 110
    numbers = Script([0.0], [0.5], [0.9, 0.9, 0.9, 0.9, 0.9, 0.0], [0.0, 0.9, 0.9, 0.9, 0.9, 0.9])
    # Cut after 1 + ⌊0.5·5⌋ = 3 bits: 101 110 and 010 011; the last and the first bit flip.
    children = record.offspring(pool, 1.0, 0.1, numbers)
    np.testing.assert_array_equal(children, [[5.0, 7.0], [6.0, 3.0]])
    assert numbers.left == []


def test_arithmetic_crossover_of_bit_strings() -> None:
    record = genetics(encoding="binary", position_range=(0.0, 7.0), resolution=1.0)
    pool = np.array([[5.0, 3.0], [2.0, 6.0]])
    numbers = Script([0.0], [0.25], [0.9] * 12)
    # 0.25 (5, 3) + 0.75 (2, 6) = (2.75, 5.25), on the lattice (3, 5)
    children = record.offspring(pool, 1.0, 0.1, numbers)
    np.testing.assert_array_equal(children, [[3.0, 5.0], [4.0, 4.0]])


def test_initial_population() -> None:
    first = SMALL.init(OPEN, Script(np.arange(8) / 8), total)
    np.testing.assert_array_equal(first.positions, np.arange(8).reshape(4, 2) / 2)
    coarse = replace(SMALL, encoding="binary", position_range=(0.0, 3.0), resolution=1.0)
    first = coarse.init(OPEN, Script(np.arange(8) / 8), total)
    np.testing.assert_array_equal(first.positions.ravel(), [0, 0, 1, 1, 2, 2, 2, 3])


def test_elite_replaces_the_worst_children() -> None:
    children = np.array([[9.0], [5.0], [7.0]])
    kept, totals = elite_kept(np.array([[1.0], [2.0]]), np.array([1.0, 2.0]),
                              children, children[:, 0], 2)  # fmt: skip
    np.testing.assert_array_equal(sorted(totals), [1.0, 2.0, 5.0])
    np.testing.assert_array_equal(kept[:, 0], totals)
    np.testing.assert_array_equal(children[:, 0], [9.0, 5.0, 7.0])


def test_an_elite_never_gets_worse() -> None:
    record = GA(population=10, elite=1, position_range=(0.0, 4.0))
    rng = np.random.default_rng(3)
    state = record.init(OPEN, rng, total)
    for _ in range(30):
        state = record.step(state, OPEN, rng, total)
        assert state.fitness.min() == state.best_fitness


def test_a_population_without_anything_feasible_goes_on() -> None:
    record = replace(SMALL, position_range=(0.0, 0.2))
    rng = np.random.default_rng(3)
    state = record.init(OPEN, rng, total)
    for _ in range(3):
        state = record.step(state, OPEN, rng, total)
    assert np.isinf(state.fitness).all()


def test_bounds_are_left_to_the_objective() -> None:
    tight = Bounds(np.full(2, 3.0), np.full(2, 3.5))
    first = SMALL.init(tight, np.random.default_rng(1), total)
    assert (first.positions < 3.0).any()
