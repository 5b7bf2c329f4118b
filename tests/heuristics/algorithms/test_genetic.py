"""Genetic algorithms: edges of wheel and fitness, and (12)–(15) of irb1600-ga-cubic-bspline.

Every step beside its equations: test_one_by_one.
"""

from fractions import Fraction

import numpy as np
import pytest
from trajgap.heuristics import ImprovedGA
from trajgap.heuristics.algorithms.genes import FitnessRule, fitness_values, roulette
from trajgap.heuristics.algorithms.improved_ga import concentration, rank_chances, schedule
from trajgap.heuristics.hazards import rate_branches
from trajgap.problem import TrajgapError


def test_negative_totals_have_a_fitness_by_complement_alone() -> None:
    negative = np.array([-1.0, 2.0])
    found = fitness_values(negative, np.inf, FitnessRule.COMPLEMENT)
    np.testing.assert_array_equal(found, [3.0, 0.0])
    with pytest.raises(
        TrajgapError, match=r"^fitness_rule: 'inverse' needs positive .* take 'comp"
    ):
        fitness_values(negative, np.inf, FitnessRule.INVERSE)


def test_the_edges_of_the_wheel() -> None:
    # Shares 1/4, 0, 1/2, 1/4 of the wheel.
    weights, draws = np.array([1.0, 0.0, 2.0, 1.0]), np.array([0.0, 0.25, 0.74, 0.75])
    np.testing.assert_array_equal(roulette(weights, draws), [0, 2, 2, 3])
    assert roulette(np.full(10, 0.1), np.array([np.nextafter(1.0, 0.0)]))[0] == 9


# --- improved -------------------------------------------------------------------------------------


@pytest.mark.parametrize("q", [0.01, 0.2, 0.9])
@pytest.mark.parametrize("count", [2, 50])
def test_equation_12_is_a_distribution(q: float, count: int) -> None:
    """Σ p_a = 1 identically: the geometric sum is what Q divides by."""
    exact = Fraction(q)
    top = exact / (1 - (1 - exact) ** count)
    chances = [top * (1 - exact) ** (a - 1) for a in range(1, count + 1)]
    assert sum(chances) == 1
    np.testing.assert_allclose(rank_chances(q, count), [float(p) for p in chances], rtol=1e-12)


def test_one_iteration_has_the_first_value_of_13() -> None:
    assert schedule(1, 1, 0.5, 0.1) == 0.5  # (M − 1)/(Z − 1) is 0/0


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
    # f_ave/f_max = 1/2: arcsin 1/2 is a third of π/2.
    assert record.rates(np.array([0.25, 0.5, 0.0, 0.25])) == pytest.approx((2 / 3, 0.05 / 3))
    # Nothing feasible: all alike, no crossover, most mutation.
    assert record.rates(np.zeros(4)) == (0.0, 0.05)
    for count in range(2, 60):  # the mean of equal numbers may round to above them
        crossing, mutating = record.rates(np.full(count, 0.1))
        assert (crossing, mutating) == pytest.approx((0.0, 0.05), abs=1e-7)
