"""Beside the equations of the algorithms, which test_one_by_one has: edges, zero, the tent map."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.stats import mannwhitneyu, qmc
from trajgap import heuristics
from trajgap.heuristics.algorithms import TentRule, tent_population
from trajgap.heuristics.algorithms.genes import FitnessRule, fitness_values, roulette
from trajgap.heuristics.algorithms.improved_ga import (
    THIRD,
    concentration,
    crossover_rate,
    mutation_rate,
    rank_chances,
    schedule,
)
from trajgap.heuristics.algorithms.improved_woa import inertia_weight
from trajgap.heuristics.algorithms.tent import exact_orbit, orbit, tent
from trajgap.problem import Array, Limits, Problem, TrajgapError, evaluate, quintic_spline


def test_negative_totals_have_a_fitness_by_complement_alone() -> None:
    negative = np.array([-1.0, 2.0])
    found = fitness_values(negative, np.inf, FitnessRule.COMPLEMENT)
    np.testing.assert_array_equal(found, [3.0, 0.0])
    words = r"^fitness_rule: 'inverse' needs positive .* take 'comp"
    with pytest.raises(TrajgapError, match=words):
        fitness_values(negative, np.inf, FitnessRule.INVERSE)


def test_the_edges_of_the_wheel() -> None:
    # Shares 1/4, 0, 1/2, 1/4 of the wheel.
    weights, draws = np.array([1.0, 0.0, 2.0, 1.0]), np.array([0.0, 0.25, 0.74, 0.75])
    np.testing.assert_array_equal(roulette(weights, draws), [0, 2, 2, 3])
    assert roulette(np.full(10, 0.1), np.array([np.nextafter(1.0, 0.0)]))[0] == 9


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
    below = np.nextafter(THIRD, 0.0)
    assert crossover_rate(below, 1.0, 2.0) == pytest.approx(crossover_rate(THIRD, 1.0, 2.0))
    jump = mutation_rate(THIRD, 0.05, 0.02) - mutation_rate(below, 0.05, 0.02)
    assert jump == pytest.approx(0.05 / 3 - 0.02 * 2 / 3, rel=1e-12)
    rates = [round(float(mutation_rate(c, 0.05, 0.02)), 4) for c in (below, THIRD)]
    assert rates == [0.0133, 0.0167]
    # A scattered population is crossed and mutated least, where the text wants it mixed most.
    assert crossover_rate(0.0, 1.0, 2.0) == crossover_rate(1.0, 1.0, 2.0) == 0.0
    # With k1 = 1 and k4 = 2 the branches meet by the choice of constants, not by construction.
    apart = crossover_rate(THIRD, 1.0, 1.0) - crossover_rate(below, 1.0, 1.0)
    assert apart == pytest.approx(1 / 3)


def test_the_arcsine_has_no_value_for_negative_fitness() -> None:
    # -T as fitness, of -2 and -1: the quotient exceeds 1.
    assert np.isnan(concentration(-1.5, -1.0))
    assert np.isnan(concentration(1.0, 0.0))
    assert concentration(0.0, 0.0) == 1.0


def test_rates_of_a_population() -> None:
    record = heuristics.ImprovedGA()
    # f_ave/f_max = 1/2: arcsin 1/2 is a third of π/2.
    assert record.rates(np.array([0.25, 0.5, 0.0, 0.25])) == pytest.approx((2 / 3, 0.05 / 3))
    # Nothing feasible: all alike, no crossover, most mutation.
    assert record.rates(np.zeros(4)) == (0.0, 0.05)
    for count in range(2, 60):  # the mean of equal numbers may round to above them
        crossing, mutating = record.rates(np.full(count, 0.1))
        assert (crossing, mutating) == pytest.approx((0.0, 0.05), abs=1e-7)


def bowl(x: np.ndarray, shift: float) -> np.ndarray:
    return ((x - shift) ** 2).sum(axis=-1)


def finals(record: heuristics.WOA | heuristics.PSO, shift: float, seeds: int = 12) -> np.ndarray:
    """Final values on a sphere; the box is shifted together with its centre."""
    low, high = shift - 5.0, shift + 5.0
    record = replace(record, position_initial=(low, high), iterations=150)
    box = heuristics.Bounds(np.full(5, low), np.full(5, high))
    found = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        *_, last = heuristics.states(record, lambda x: bowl(x, shift), box, rng)
        found.append(last.best_fitness)
    return np.array(found)


def test_what_woa_finds_depends_on_where_zero_is() -> None:
    """The same question, shifted by 3: WOA loses more than ten digits, PSO none."""
    assert finals(heuristics.WOA(), 0.0).max() < 1e-15
    assert finals(heuristics.WOA(), 3.0).min() > 1e-4
    pso = heuristics.PSO(velocity_initial=(-2.0, 2.0))
    ratio = np.median(finals(pso, 3.0)) / np.median(finals(pso, 0.0))
    assert 0.1 < ratio < 10


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 1.3])
def test_against_mealpy(shift: float) -> None:
    """mealpy 3.0.3, OriginalWOA: alike once its departures from the paper are set alike.

    Its departures: a whale moves only if it is then better; one r for A and C; δ counted from 1;
    a fresh random point instead of a random whale. The first three are settings here, the last is
    undone there. It is not a requirement of the tests: its metadata asks for numpy below 2.
    """
    mealpy = pytest.importorskip("mealpy")
    whale = pytest.importorskip("mealpy.swarm_based.WOA")

    class Member(whale.OriginalWOA):  # type: ignore[misc, name-defined]
        def evolve(self, epoch: int) -> None:
            self.problem.generate_solution = lambda encoded=True: (
                self.pop[self.generator.integers(self.pop_size)].solution
            )
            super().evolve(epoch)

    question = {
        "bounds": mealpy.FloatVar(lb=(shift - 5.0,) * 5, ub=(shift + 5.0,) * 5),
        "minmax": "min",
        "obj_func": lambda x: float(bowl(x, shift)),
        "log_to": None,
    }
    member = Member(epoch=150, pop_size=30)
    theirs = [member.solve(question, seed=seed).target.fitness for seed in range(40)]
    record = heuristics.WOA(replacement="greedy", r_rule="shared", counter="one")
    assert mannwhitneyu(finals(record, shift, 40), theirs).pvalue > 0.01


WAY = np.random.default_rng(0).uniform(-2, 2, (8, 6))
SIX_JOINTS = Problem(WAY, Limits(2.0, 5.0), quintic_spline(7), 0.0, 5.0)


def weighted(best: Array, s: float) -> tuple[Array, Array]:
    """w(I) of (22), and c* of w(I) X*, the centre that (21) moves whales around, I = 0..500."""
    weights = np.array([inertia_weight(i, 500, s) for i in range(501)])
    return weights, evaluate(SIX_JOINTS, weights[:, None] * best).stretch


@pytest.mark.parametrize("s", [0.0, 5.0, -0.5])
def test_a_weighted_best_breaks_the_limits_from_the_second_move_on(s: float) -> None:
    best = heuristics.run(heuristics.WOA(), SIX_JOINTS, 1, 50, objective="stretch").durations
    weights, stretches = weighted(best, s)
    assert np.flatnonzero(stretches > 1 + 1e-9)[0] == 1
    assert weights[0] == 1.0
    assert weights[-1] == 0.0
    # Stretching time: c* of w X* is c*/w.
    np.testing.assert_allclose(stretches[:-1] * weights[:-1], stretches[0], rtol=1e-9)
    assert stretches[-1] == np.inf


def test_a_best_with_room_to_spare_breaks_them_later() -> None:
    best = 1.25 * heuristics.run(heuristics.WOA(), SIX_JOINTS, 1, 50, objective="stretch").durations
    _, stretches = weighted(best, 0.0)
    # w = 0.8 at I = 100 is just enough, w = 0.798 is not.
    assert np.flatnonzero(stretches > 1 + 1e-9)[0] == 101


def judged(algorithm: Any) -> Array:
    """Every position that a search of seed 0 had judged."""
    judge, seen = heuristics.DeathPenalty(SIX_JOINTS, algorithm.penalty), []

    def seeing(positions: Array) -> Array:
        seen.append(positions)
        return judge(positions)

    bounds = heuristics.Bounds.of(SIX_JOINTS)
    for _ in heuristics.states(algorithm, seeing, bounds, np.random.Generator(np.random.PCG64(0))):
        pass
    return np.concatenate(seen)


@pytest.mark.parametrize(
    "algorithm",
    [heuristics.WOA(iterations=100), heuristics.ImprovedWOA(iterations=100)],
    ids=lambda a: a.kind,
)
def test_whales_are_set_to_zero_seconds(algorithm: heuristics.WOA) -> None:
    """The printed bounds [0, 5] s contain 0; whales that leave them are judged there."""
    positions = judged(algorithm)
    assert len(positions) == 30 * 101
    assert (positions == 0.0).any()
    assert (positions >= 0.0).all()


def test_negative_durations_inside_the_palletisers_bounds() -> None:
    """[-x_max, x_max] of irb460, of which all but 2⁻⁷ has a negative duration."""
    negative = (judged(heuristics.ConstrainedPSO(iterations=20)) < 0.0).any(axis=1)
    assert negative.mean() > 0.1


def test_equation_23_by_hand() -> None:
    # β = 0.5, then β = 0.25: 0.125/0.25 = 0.5; 0.25/0.25 = 1; (1 − 0.4)/0.75 = 0.8.
    assert tent(np.array([0.0, 0.125, 0.5, 0.75, 1.0])).tolist() == [0.0, 0.25, 1.0, 0.5, 0.0]
    np.testing.assert_allclose(
        tent(np.array([0.125, 0.25, 0.4, 1.0]), 0.25), [0.5, 1.0, 0.8, 0.0], rtol=1e-15
    )


@given(st.integers(0, 2**53 - 1))
def test_every_random_start_ends_on_zero_within_54_steps(k: int) -> None:
    """Generators return k·2⁻⁵³; with β = 0.5 no step rounds, so the end is exact, not noise."""
    start = k * 2.0**-53
    doubles = orbit(np.array([start]), 60)[:, 0]
    assert [Fraction(x) for x in doubles] == exact_orbit(Fraction(start), 60)
    assert (doubles[54:] == 0.0).all()


@pytest.mark.parametrize("start", ["0.37", "0.1", "0.3141", "0.9"])
def test_the_exact_orbit_of_a_decimal_never_ends(start: str) -> None:
    found = heuristics.tent_collapse(start, 600)
    assert found.zero_at is not None
    assert 50 <= found.zero_at <= 57
    assert (found.doubles[found.zero_at :] == 0).all()
    assert found.exact_zero_at is None
    assert found.period is not None
    first, length = found.period
    assert found.exact[first] == found.exact[first + length]
    assert len(set(found.exact[: first + length])) == first + length, "the first return"
    # They agree as long as doubling has not spent the 53 bits.
    np.testing.assert_allclose(found.doubles[:20], [float(x) for x in found.exact[:20]], atol=1e-9)


def test_a_beta_away_from_one_half_does_not_end() -> None:
    found = heuristics.tent_collapse("0.37", 2000, Fraction("0.49"))
    assert found.zero_at is None
    assert found.exact_zero_at is None


def test_a_dyadic_start_ends_exactly_too() -> None:
    found = heuristics.tent_collapse("0.375", 10)
    assert found.zero_at == found.exact_zero_at == 4


@pytest.mark.parametrize(
    ("start", "beta", "message"),
    [
        ("1.5", Fraction(1, 2), r"^start: expected a number from 0 to 1, got 1.5"),
        ("0.5", Fraction(1), r"^beta: expected a number between 0 and 1, got 1"),
    ],
)
def test_out_of_range(start: str, beta: Fraction, message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        heuristics.tent_collapse(start, 5, beta)


def test_the_experiment_of_figure_1() -> None:
    """30 points in [0, 5]², β = 0.5: spread by an orbit each, no more even than uniform draws."""
    at = {rule: [tent_population(np.random.default_rng((2, s)), 30, 2, rule, 0.5)
                 for s in range(200)] for rule in TentRule}  # fmt: skip
    even = [qmc.discrepancy(np.random.default_rng((1, s)).random((30, 2))) for s in range(200)]
    found = {rule: [qmc.discrepancy(x) for x in many] for rule, many in at.items()}
    wins = {rule: np.mean(np.less.outer(many, even)) for rule, many in found.items()}
    assert 0.4 < wins[TentRule.COORDINATE] < 0.65
    assert wins[TentRule.SINGLE] < 0.3
    assert all((x > 0).all() for x in at[TentRule.COORDINATE])
    # 60 numbers of one orbit: from step 54 on all are 0, the last three points at least.
    assert all((x[-3:] == 0).all() for x in at[TentRule.SINGLE])


@pytest.mark.parametrize(("rule", "at_zero"), [("coordinate", 0), ("member", 0), ("single", 22)])
def test_one_orbit_through_everything_leaves_most_whales_at_zero(rule: str, at_zero: int) -> None:
    """30 whales of 7 durations: 210 numbers, of which the last 155 or more are exactly 0 s."""
    for seed in range(20):
        record = heuristics.ImprovedWOA(tent_rule=rule)
        positions = record.scatter(np.random.default_rng(seed), 7)
        zero = (positions == 0.0).all(axis=1)
        assert at_zero <= zero.sum() <= at_zero + (1 if at_zero else 0)
        way = np.random.default_rng(seed).uniform(-1, 1, (8, 2))
        problem = Problem(way, Limits(50.0, joints=2), quintic_spline(7), 0.0, 5.0)
        fitness = heuristics.DeathPenalty(problem)(positions)
        assert np.isinf(fitness[zero]).all()
