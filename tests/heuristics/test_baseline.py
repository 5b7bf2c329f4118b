"""Uniform rescaling, tight by the checker; and numerical hazards, each shown by running it."""

import numpy as np
import pytest
from support.two_joints import two_joints
from trajgap.heuristics import WOA, ConstrainedPSO, ImprovedWOA, run, uniform_rescaling
from trajgap.heuristics.hazards import not_positive, not_positive_share, weight_fall
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    quintic_spline,
    three_five_three,
)


@pytest.mark.parametrize(
    "limits",
    [
        Limits(3.0, joints=2),
        Limits([6.0, 5.0], [8.0, 9.0]),
        Limits(6.0, 8.0, [25.0, 30.0]),
    ],
    ids=["v", "va", "vaj"],
)
def test_equal_durations_at_the_limit(limits: Limits) -> None:
    durations = uniform_rescaling(two_joints(limits))
    np.testing.assert_array_equal(durations, durations[0])
    found = check(two_joints(limits), durations)
    assert found.verdict is Verdict.PASS
    assert found.worst is not None
    assert found.worst.ratio == pytest.approx(1.0, abs=1e-12)
    tight = check(two_joints(limits), [0.7, 0.7, 0.7]).tight_time
    assert durations.sum() == pytest.approx(tight, rel=1e-12)


def test_set_to_lower_bounds() -> None:
    bounds = np.array([2.0, 2.5, 3.0])
    durations = uniform_rescaling(two_joints(Limits(6.0, 8.0, joints=2), duration_lower=bounds))
    np.testing.assert_array_equal(durations, bounds)


def test_set_to_an_upper_bound_that_costs_nothing() -> None:
    waypoints = np.array([0.4, 0.5, 0.50001, 1.6])
    problem = Problem(waypoints, Limits(1.0), three_five_three())
    equal = uniform_rescaling(problem)
    cap = 0.9 * equal[0]
    capped = Problem(waypoints, Limits(1.0), three_five_three(), 0.0, [cap, 9.0, 9.0])
    np.testing.assert_array_equal(uniform_rescaling(capped), [cap, equal[1], equal[2]])


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (
            two_joints(Limits(6.0, 8.0, joints=2), duration_upper=0.8),
            r"^uniform rescaling: .* s per segment set to the duration bounds is violated; no",
        ),
        (
            two_joints(Limits(6.0, 8.0, position_upper=0.5, joints=2)),
            r"lead joint 1 beyond a position limit; no uniform",
        ),
        (two_joints(Limits([0.0, 3.0])), "a joint with limit 0 moves"),
        (two_joints(Limits(joints=2)), "nothing moves or nothing is limited"),
        (two_joints(curve=cubic_spline(3, ((1, 0.5),))), "a prescribed derivative is not 0"),
    ],
)
def test_what_has_no_uniform_rescaling(problem: Problem, said: str) -> None:
    with pytest.raises(TrajgapError, match=said):
        uniform_rescaling(problem)


def test_where_nothing_is_limited_the_bounds_are_the_answer() -> None:
    found = uniform_rescaling(two_joints(Limits(joints=2), duration_lower=0.4))
    np.testing.assert_array_equal(found, [0.4, 0.4, 0.4])


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
