"""The tent map: by hand, exactly in rational numbers, and its end in double precision."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import qmc
from trajgap.heuristics import DeathPenalty, ImprovedWOA
from trajgap.heuristics.algorithms import TentRule, tent_population
from trajgap.heuristics.algorithms.tent import exact_orbit, orbit, tent
from trajgap.heuristics.hazards import tent_collapse
from trajgap.problem import Limits, Problem, TrajgapError, quintic_spline


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
    found = tent_collapse(start, 600)
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
    found = tent_collapse("0.37", 2000, Fraction("0.49"))
    assert found.zero_at is None
    assert found.exact_zero_at is None


def test_a_dyadic_start_ends_exactly_too() -> None:
    found = tent_collapse("0.375", 10)
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
        tent_collapse(start, 5, beta)


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
        record = ImprovedWOA(tent_rule=rule)
        positions = record.scatter(np.random.default_rng(seed), 7)
        zero = (positions == 0.0).all(axis=1)
        assert at_zero <= zero.sum() <= at_zero + (1 if at_zero else 0)
        way = np.random.default_rng(seed).uniform(-1, 1, (8, 2))
        problem = Problem(way, Limits(50.0, joints=2), quintic_spline(7), 0.0, 5.0)
        fitness = DeathPenalty(problem)(positions)
        assert np.isinf(fitness[zero]).all()
