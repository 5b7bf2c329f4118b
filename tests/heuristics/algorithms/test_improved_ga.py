"""Improved GA: (12)–(15) of irb1600-ga-cubic-bspline against steps worked by hand."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.scripted import OPEN, Script
from trajgap.heuristics import ImprovedGA
from trajgap.heuristics.algorithms.improved_ga import (
    THIRD,
    concentration,
    crossover_rate,
    mutation_rate,
    rank_chances,
    schedule,
)
from trajgap.heuristics.algorithms.population import Population
from trajgap.heuristics.hazards import rate_branches

SMALL = ImprovedGA(population=8, position_range=(0.0, 8.0), iterations=5)


def total(x: np.ndarray) -> np.ndarray:
    return x.sum(axis=1)


@pytest.mark.parametrize("q", [0.01, 0.2, 0.9])
@pytest.mark.parametrize("count", [2, 20, 50])
def test_equation_12_is_a_distribution(q: float, count: int) -> None:
    """Σ p_a = 1 identically: the geometric sum is what Q divides by."""
    exact = Fraction(q)
    top = exact / (1 - (1 - exact) ** count)
    chances = [top * (1 - exact) ** (a - 1) for a in range(1, count + 1)]
    assert sum(chances) == 1
    np.testing.assert_allclose(rank_chances(q, count), [float(p) for p in chances], rtol=1e-12)


def test_equation_13_by_hand() -> None:
    values = [schedule(m, 5, 0.5, 0.1) for m in (1, 2, 3, 5)]
    np.testing.assert_allclose(values, [0.5, 0.4, 0.3, 0.1], rtol=1e-15)
    assert schedule(1, 1, 0.5, 0.1) == 0.5  # (M − 1)/(Z − 1) is 0/0


def test_equations_14_and_15_by_hand() -> None:
    # arcsin 1/2 = π/6, over π/2: 1/3. arcsin(√3/2) = π/3: 2/3. arcsin sin 15° : 1/6.
    assert concentration(1.0, 2.0) == THIRD == pytest.approx(1 / 3, rel=1e-15)
    two_thirds = concentration(np.sqrt(3), 2.0)
    sixth = concentration(float(np.sin(np.pi / 12)), 1.0)
    for at, p_c, p_z in (
        (THIRD, 2 / 3, 0.05 / 3),
        (two_thirds, 1 / 3, 0.1 / 3),
        (concentration(3.0, 3.0), 0.0, 0.05),
        (sixth, 1 / 3, 0.02 * 5 / 6),
        (concentration(0.0, 3.0), 0.0, 0.02),
    ):
        assert crossover_rate(at, 1.0, 2.0) == pytest.approx(p_c, rel=1e-12)
        assert mutation_rate(at, 0.05, 0.02) == pytest.approx(p_z, rel=1e-12)


def test_the_branches_meet_in_14_and_not_in_15() -> None:
    found = rate_branches()
    assert found.crossover_jump == pytest.approx(0.0, abs=1e-15)
    assert found.mutation_jump == pytest.approx(0.05 / 3 - 0.02 * 2 / 3, rel=1e-12)
    # A scattered population is crossed and mutated least, where the text wants it mixed most.
    assert found.crossover[0] == found.crossover[3] == 0.0
    # With k1 = 1 and k4 = 2 the branches meet by the choice of constants, not by construction.
    assert rate_branches(k4=1.0).crossover_jump == pytest.approx(1 / 3)


def test_the_arcsine_has_no_value_for_negative_fitness() -> None:
    assert np.isnan(rate_branches().negative)
    assert np.isnan(concentration(1.0, 0.0))
    assert concentration(0.0, 0.0) == 1.0


def test_rates_of_a_population() -> None:
    record = ImprovedGA()
    # f_ave/f_max = 1/2
    assert record.rates(np.array([0.25, 0.5, 0.0, 0.25])) == pytest.approx((2 / 3, 0.05 / 3))
    # Nothing feasible: all alike, no crossover, most mutation.
    assert record.rates(np.zeros(4)) == (0.0, 0.05)
    for count in range(2, 60):  # the mean of equal numbers may round to above them
        crossing, mutating = record.rates(np.full(count, 0.1))
        assert (crossing, mutating) == pytest.approx((0.0, 0.05), abs=1e-7)


def test_either_rate_may_be_fixed() -> None:
    fitness = np.array([0.25, 0.5, 0.0, 0.25])
    printed = ImprovedGA().rates(fitness)
    assert ImprovedGA(adaptive_crossover=False).rates(fitness) == (0.8, printed[1])
    fixed = ImprovedGA(adaptive_mutation=False, mutation_fixed=0.3)
    assert fixed.rates(fitness) == (printed[0], 0.3)


def test_parents_by_hand() -> None:
    totals = np.array([5.0, 1.0, 8.0, 2.0, 7.0, 3.0, 6.0, 4.0])
    # Best quarter: 1, 3. Middle half: 5, 7, 0, 6. Dropped: 4, 2.
    # Generation 1 of 5, q = 1/2: p = 8/15, 4/15, 2/15, 1/15; sums 0.533, 0.8, 0.933, 1.
    record = replace(SMALL, q_best=0.5, q_worst=0.25)
    numbers = Script([0.0, 0.53, 0.54, 0.79, 0.81, 0.94])
    found = record.parents(totals, 1, numbers)
    np.testing.assert_array_equal(found, [1, 3, 5, 5, 7, 7, 0, 6])
    assert numbers.left == []
    # Generation 5: q = 1/4, p = 64/175, 48/175, 36/175, 27/175; sums 0.366, 0.64, 0.846, 1.
    found = record.parents(totals, 5, Script([0.36, 0.37, 0.63, 0.65, 0.84, 0.85]))
    np.testing.assert_array_equal(found, [1, 3, 5, 7, 7, 0, 0, 6])
    double = replace(record, pool_rule="double-best")
    numbers = Script([0.0, 0.54, 0.81, 0.94])
    np.testing.assert_array_equal(double.parents(totals, 1, numbers), [1, 3, 1, 3, 5, 7, 0, 6])
    assert numbers.left == []


def test_infeasible_ones_are_ranked_last() -> None:
    totals = np.array([np.inf, 1.0, np.inf, np.inf])
    found = ImprovedGA(population=4).parents(totals, 1, Script([0.0, 0.0, 0.99]))
    np.testing.assert_array_equal(found, [1, 0, 0, 2])


def test_a_generation_by_hand() -> None:
    x = np.array([[4.0], [1.0], [8.0], [2.0], [8.0], [2.0], [8.0], [4.0]])
    before = Population(0, x, total(x), x[1], 1.0)
    # f = 1/4, 1, 1/8, 1/2, 1/8, 1/2, 1/8, 1/4: mean 2.875/8 of the largest, below 1/2:
    # arcsin(0.359375)/(π/2) = 0.234, P_c = 2·0.234 = 0.468, P_z = 0.02·0.766 = 0.0153
    # Best: 1, 3. Middle: 5, 0, 7, 2 (equal ones in their order). q = 0.2: p = 0.339, 0.271, ...
    # Roulette 0, 0.35, 0.65, 0.85, 0, 0: 5, 0, 7, 2, 5, 5. Shuffled: left as they are.
    numbers = Script(
        [0.0, 0.35, 0.65, 0.85, 0.0, 0.0], np.arange(8) / 8, [0.467, 0.469, 0.9, 0.9],
        [0.25, 0.5, 0.5, 0.5], [0.9, 0.9, 0.0152, 0.0154, 0.9, 0.9, 0.9, 0.9], np.full(8, 0.75),
    )  # fmt: skip
    after = SMALL.step(before, OPEN, numbers, total)
    # Pair (1, 2) mates: 0.25·1 + 0.75·2 = 1.75 and 1.25; the third child is drawn anew at 6.
    np.testing.assert_array_equal(
        after.positions.ravel(), [1.75, 1.25, 6.0, 4.0, 4.0, 8.0, 2.0, 2.0]
    )
    assert (after.best_fitness, after.iteration, numbers.left) == (1.0, 1, [])


def test_the_best_quarter_may_survive() -> None:
    rng = np.random.default_rng(4)
    for rule, survive in (("survives", True), ("parents", False)):
        record = replace(SMALL, best_quarter=rule, k2=1.0)
        state = record.init(OPEN, rng, total)
        kept = []
        for _ in range(20):
            best = np.sort(state.fitness)[:2]
            state = record.step(state, OPEN, rng, total)
            kept.append(np.isin(best, state.fitness).all())
            assert state.positions.shape == (8, 2)
        assert all(kept) is survive
