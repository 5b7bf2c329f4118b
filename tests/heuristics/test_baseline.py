"""Uniform rescaling: tight by the checker, scaled by identities, refused where it is undefined."""

import numpy as np
import pytest
from trajgap.heuristics import uniform_rescaling
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    three_five_three,
)

WAYPOINTS = np.array([[0.19, -1.63], [0.82, -2.01], [0.13, -1.07], [-0.88, -1.31]])


def problem_under(limits: Limits, **bounds: object) -> Problem:
    return Problem(WAYPOINTS, limits, three_five_three(), **bounds)


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
    durations = uniform_rescaling(problem_under(limits))
    np.testing.assert_array_equal(durations, durations[0])
    found = check(problem_under(limits), durations)
    assert found.verdict is Verdict.PASS
    assert found.worst is not None
    assert found.worst.ratio == pytest.approx(1.0, abs=1e-12)
    tight = check(problem_under(limits), [0.7, 0.7, 0.7]).tight_time
    assert durations.sum() == pytest.approx(tight, rel=1e-12)


def test_scaling_identities() -> None:
    slow = uniform_rescaling(problem_under(Limits(1.3, joints=2)))
    np.testing.assert_allclose(uniform_rescaling(problem_under(Limits(2.6, joints=2))), slow / 2)
    soft = uniform_rescaling(problem_under(Limits(np.inf, 2.0, joints=2)))
    np.testing.assert_allclose(
        uniform_rescaling(problem_under(Limits(np.inf, 8.0, joints=2))), soft / 2
    )


def test_set_to_lower_bounds() -> None:
    bounds = np.array([2.0, 2.5, 3.0])
    durations = uniform_rescaling(problem_under(Limits(6.0, 8.0, joints=2), duration_lower=bounds))
    np.testing.assert_array_equal(durations, bounds)


def test_set_to_an_upper_bound_that_costs_nothing() -> None:
    waypoints = np.array([0.4, 0.5, 0.50001, 1.6])
    problem = Problem(waypoints, Limits(1.0), three_five_three())
    equal = uniform_rescaling(problem)
    cap = 0.9 * equal[0]
    capped = Problem(waypoints, Limits(1.0), three_five_three(), 0.0, [cap, 9.0, 9.0])
    np.testing.assert_array_equal(uniform_rescaling(capped), [cap, equal[1], equal[2]])


def test_upper_bound_too_short() -> None:
    problem = problem_under(Limits(6.0, 8.0, joints=2), duration_upper=0.8)
    with pytest.raises(
        TrajgapError,
        match=r"^uniform rescaling: .* s per segment set to the duration bounds is violated; no",
    ):
        uniform_rescaling(problem)


def test_position_limit_in_the_way() -> None:
    limits = Limits(6.0, 8.0, position_upper=0.5, joints=2)
    with pytest.raises(TrajgapError, match=r"lead joint 1 beyond a position limit; no uniform"):
        uniform_rescaling(problem_under(limits))


def test_limit_zero() -> None:
    with pytest.raises(TrajgapError, match="a joint with limit 0 moves"):
        uniform_rescaling(problem_under(Limits([0.0, 3.0])))


def test_nothing_limited() -> None:
    with pytest.raises(TrajgapError, match="nothing moves or nothing is limited"):
        uniform_rescaling(problem_under(Limits(joints=2)))
    with_bounds = problem_under(Limits(joints=2), duration_lower=0.4)
    np.testing.assert_array_equal(uniform_rescaling(with_bounds), [0.4, 0.4, 0.4])


def test_prescribed_derivative() -> None:
    moving = cubic_spline(3, ((1, 0.5),))
    with pytest.raises(TrajgapError, match="a prescribed derivative is not 0"):
        uniform_rescaling(Problem(WAYPOINTS, Limits(6.0, joints=2), moving))
