"""Numerical hazards, each shown by running it; the tent map's is in test_tent.py."""

import numpy as np
import pytest
from trajgap.heuristics import WOA, ConstrainedPSO, ImprovedWOA, run
from trajgap.heuristics.hazards import not_positive, not_positive_share, weight_fall
from trajgap.problem import Limits, Problem, quintic_spline

WAY = np.random.default_rng(0).uniform(-2, 2, (8, 6))
PROBLEM = Problem(WAY, Limits(2.0, 5.0), quintic_spline(7), 0.0, 5.0)


@pytest.mark.parametrize("s", [0.0, 5.0, -0.5])
def test_a_weighted_best_breaks_the_limits_from_the_second_move_on(s: float) -> None:
    best = run(WOA(), PROBLEM, 1, 50, objective="stretch").durations
    found = weight_fall(PROBLEM, best, 500, s)
    assert found.first_infeasible == 1
    assert found.weights[0] == 1.0
    assert found.weights[-1] == 0.0
    # Stretching time: c* of w X* is c*/w.
    np.testing.assert_allclose(
        found.stretches[:-1] * found.weights[:-1], found.stretches[0], rtol=1e-9
    )
    assert found.stretches[-1] == np.inf


def test_a_best_with_room_to_spare_breaks_them_later() -> None:
    best = 1.25 * run(WOA(), PROBLEM, 1, 50, objective="stretch").durations
    found = weight_fall(PROBLEM, best, 500)
    assert found.first_infeasible == 101  # w = 0.8 at I = 100 is just enough, w = 0.798 is not


def test_share_of_a_box() -> None:
    assert not_positive_share(np.array([-1.0, 0.0]), np.array([3.0, 5.0])) == 0.25
    assert not_positive_share(np.array([-2.0, 1.0]), np.array([-1.0, 5.0])) == 1.0
    assert not_positive_share(np.full(2, 0.1), np.full(2, 5.0)) == 0.0


@pytest.mark.parametrize(
    "algorithm", [WOA(iterations=100), ImprovedWOA(iterations=100)], ids=lambda a: a.kind
)
def test_whales_are_set_to_zero_seconds(algorithm: WOA) -> None:
    """The printed bounds [0, 5] s contain 0; whales that leave them are judged there."""
    found = not_positive(algorithm, PROBLEM, 0)
    assert found.judged == 30 * 101
    assert found.box_share == 0.0
    assert 0 < found.zero == found.not_positive


def test_negative_durations_inside_the_palletisers_bounds() -> None:
    found = not_positive(ConstrainedPSO(iterations=20), PROBLEM, 0, (-2.0, 2.0))
    assert found.box_share == 1 - 2.0**-7
    assert found.not_positive > found.judged / 10
    assert found.zero == 0
