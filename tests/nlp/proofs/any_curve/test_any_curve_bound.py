"""The optimum over all C1 curves: closed forms, splines that are slower, and where it has none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.any_curve_proofs import PUMA_PROBLEM, interval, spline_problem, verified
from support.puma import PUMA
from support.retimed import rest_to_rest_time
from trajgap.nlp import Evidence
from trajgap.nlp.clock import stopping_after
from trajgap.nlp.proofs.any_curve import estimate
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.reach import furthest, profile, reachable
from trajgap.problem import Limits, Problem, TrajgapError, curves


def with_ends(q: list[float], start: float, last: float, limits: Limits) -> Problem:
    return Problem(q, limits, curves.cubic_spline(len(q) - 1, ((1, start),), ((1, last),)))


def between(step: float, first: float, last: float, a: float) -> float:
    """Accelerate to p, brake to the end: (2p² − v₀² − v₁²)/2a = d."""
    peak = np.sqrt((2 * a * step + first**2 + last**2) / 2)
    return float((2 * peak - first - last) / a)


def overshooting(d: float, a: float) -> float:
    """From rest to d at speed w in (√(4ad + 2w²) − w)/a, and back alike, for the best w."""
    w = np.linspace(0.0, 3.0, 300_001)
    root = np.sqrt(4 * a * d + 2 * w**2)
    return float(((root - w) / a + (root + w) / a).min())


CLOSED = [
    *(
        (spline_problem([0.25, 0.25 + step], v, a), rest_to_rest_time(step, v, a))
        for v, a in ((9.0, 8.0), (0.7, 8.0), (np.inf, 2.5), (1.5, 2.0))
        for step in (1.4, -0.3, 4.0)
    ),
    *(
        (spline_problem([0.2, 0.2 + middle, 1.5], v, 4.0), rest_to_rest_time(1.3, v, 4.0))
        for middle in (0.01, 0.4, 1.25)
        for v in (9.0, 1.1)
    ),
    (
        spline_problem([0.2, 1.5, -0.1], 1.7, 4.0),
        rest_to_rest_time(1.3, 1.7, 4.0) + rest_to_rest_time(1.6, 1.7, 4.0),
    ),
    (spline_problem([0.0, 1.0, 0.0], 10.0, 2.0), overshooting(1.0, 2.0)),
    # Flat out from way-point to way-point.
    (spline_problem([0.2, 1.5], 1.7, 4.0, ends=()), 1.3 / 1.7),
    # The second joint decides.
    (
        spline_problem([[0.0, 1.0], [0.5, 0.4], [0.9, -0.5]], [2.0, 9.0], [50.0, 1.5]),
        rest_to_rest_time(1.5, 9.0, 1.5),
    ),
    (spline_problem([0.0, 0.1, 0.3], 5.0, 50.0, duration_lower=[2.0, 3.0]), 5.0),
    *(
        (with_ends([0.2, 1.5], first, last, Limits(50.0, 4.0)), between(1.3, first, last, 4.0))
        for first, last in ((0.5, 0.9), (-0.8, 0.0), (1.2, -1.2))
    ),
    # Another joint has another start: the one that moves away at first takes longer.
    (
        Problem(
            np.array([[0.0, 3.0], [1.3, 4.3]]),
            Limits(50.0, 4.0, joints=2),
            curves.cubic_spline(1, ((1, (0.6, -0.4)),), ((1, 0.0),)),
        ),
        between(1.3, -0.4, 0.0, 4.0),
    ),
]


@pytest.mark.parametrize(("problem", "total"), CLOSED)
def test_a_closed_form_is_found_and_proved(problem: Problem, total: float) -> None:
    assert verified(problem, estimate_any_curve(problem)) == pytest.approx(total, rel=1e-8)
    low, high = interval(problem)
    assert low <= total * (1 + 1e-12)
    assert high >= total * (1 - 1e-9)


def test_rest_at_waypoints_of_the_interpolant_is_not_asked_for() -> None:
    smooth = estimate_any_curve(PUMA_PROBLEM)
    stopping = estimate_any_curve(replace(PUMA_PROBLEM, curve=curves.rest_to_rest(3, 5)))
    assert stopping.total_time == pytest.approx(smooth.total_time, rel=1e-9)


def test_velocity_limits_only() -> None:
    velocity = np.array([1.5, 0.4, 2.0, 3.0, 0.7, 1.1])
    found = estimate_any_curve(Problem(PUMA, Limits(velocity), curves.three_five_three()))
    expected = (np.abs(np.diff(PUMA, axis=0)) / velocity).max(axis=1)
    assert found.durations == pytest.approx(expected, rel=1e-15)
    assert found.total_time == pytest.approx(expected.sum(), rel=1e-15)
    assert not found.attained
    assert found.why.startswith("only velocity is limited")
    assert np.isnan(found.nodal_velocities).all()


def test_velocity_limits_only_may_be_attained() -> None:
    assert estimate_any_curve(spline_problem([0.0, 1.0, 3.0], 2.0, ends=())).attained
    assert not estimate_any_curve(spline_problem([0.0, 1.0, 3.0], 2.0)).attained
    assert not estimate_any_curve(spline_problem([0.0, 1.0, 0.0], 2.0, ends=())).attained
    assert estimate_any_curve(spline_problem([0.0, 1.0, 0.0], 2.0, duration_lower=0.6)).attained


def test_a_joint_without_acceleration_limit_only_needs_its_speed() -> None:
    q = np.array([[0.0, 0.3], [0.5, 1.9], [0.2, 0.1]])
    problem = spline_problem(q, [3.0, 1.5], [6.0, np.inf])
    found = estimate_any_curve(problem)
    both = verified(problem, found)
    floor = np.abs(np.diff(q[:, 1])) / 1.5
    alone = spline_problem(q[:, :1], 3.0, 6.0, duration_lower=floor)
    assert both == pytest.approx(verified(alone, estimate_any_curve(alone)), rel=1e-9)
    assert np.isnan(found.nodal_velocities[:, 1]).all()


@settings(max_examples=60, deadline=None)
@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.05, 3.0), st.floats(0.0, 1.0))
def test_reachable_displacements_have_a_curve(v0: float, v1: float, h: float, share: float) -> None:
    limits = np.array(1.0), np.array(2.0)
    at = np.array(v0), np.array(v1), np.array(h)
    up = float(furthest(*at, *limits))
    down = -float(furthest(-at[0], -at[1], at[2], *limits))
    if abs(v1 - v0) > 2.0 * h:
        assert up == -np.inf
        assert not reachable(np.array(0.0), *at, *limits)
        return
    assert down <= up
    step = down + share * (up - down)
    curve = profile(step, v0, v1, h, 1.0, 2.0)
    assert curve.displacement == pytest.approx(step, abs=1e-12)
    assert curve.velocity[[0, -1]] == pytest.approx([v0, v1], abs=1e-12)
    assert np.abs(curve.velocity).max() <= 1.0 + 1e-12
    low, high = curve.position_range()
    times = np.linspace(0, h, 4001)
    v = np.interp(times, curve.time, curve.velocity)
    path = np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(times))])
    assert low == pytest.approx(path.min(), abs=1e-5)
    assert high == pytest.approx(path.max(), abs=1e-5)
    for beyond in (up + 1e-9, down - 1e-9):
        assert not reachable(np.array(beyond), *at, *limits)
    # No sampled admissible motion goes further: the pointwise bound on the velocity.
    top = np.minimum.reduce([v0 + 2 * times, v1 + 2 * (h - times), np.ones_like(times)])
    assert up == pytest.approx(np.trapezoid(top, times), abs=1e-5)


def test_same_seed_same_bits() -> None:
    one, two = (estimate_any_curve(PUMA_PROBLEM, starts=3, seed=5) for _ in range(2))
    assert one.total_time == two.total_time
    assert (one.nodal_velocities == two.nodal_velocities).all()


def test_every_start_reaches_the_best_of_the_puma_problem() -> None:
    found = estimate_any_curve(PUMA_PROBLEM, starts=20, seed=1)
    assert found.starts_at_best == found.starts == 20
    assert verified(PUMA_PROBLEM, found) == pytest.approx(1.53528793, abs=1e-7)


def test_duration_bounds_hold_between_waypoints() -> None:
    bounded = replace(PUMA_PROBLEM, duration_lower=[0.9, 0.0, 0.0], duration_upper=[2.0, 0.6, 3.0])
    found = estimate_any_curve(bounded)
    assert verified(bounded, found) > estimate_any_curve(PUMA_PROBLEM).total_time
    assert found.durations[0] == pytest.approx(0.9, rel=1e-9)
    assert found.durations[1] <= 0.6 * (1 + 1e-9)


def test_virtual_breaks_are_merged() -> None:
    virtual = Problem(PUMA, PUMA_PROBLEM.limits, curves.cubic_spline_virtual(4))
    found = estimate_any_curve(virtual)
    assert found.durations.shape == (3,)
    assert found.total_time == pytest.approx(estimate_any_curve(PUMA_PROBLEM).total_time, rel=1e-9)
    lower = replace(virtual, duration_lower=[0.5, 0.4, 0.0, 0.0, 0.0])
    assert estimate_any_curve(lower).durations[0] == pytest.approx(0.9, rel=1e-9)


def test_repeated_waypoints_are_passed_in_no_time() -> None:
    q = [0.2, 1.5, 1.5, 2.0]
    found = estimate_any_curve(spline_problem(q, 9.0, 4.0))
    assert found.total_time == pytest.approx(rest_to_rest_time(1.8, 9.0, 4.0), rel=1e-8)
    assert found.durations[1] == 0.0
    assert not found.attained
    assert found.why == "nothing moves in segment 2: its duration goes to 0"
    held = estimate_any_curve(spline_problem(q, 9.0, 4.0, duration_lower=0.3))
    assert held.attained
    assert held.durations[1] >= 0.3


TURNING = with_ends([0.2, 0.2], 0.5, -0.3, Limits(5.0, 4.0))
NOTHING_FASTER = Limits(5.0, 8.0, position_lower=-0.2)
NO_VALUE = [
    (replace(PUMA_PROBLEM, limits=Limits(6.0, 8.0, 50.0, joints=6)), "jerk is limited"),
    (
        replace(PUMA_PROBLEM, limits=Limits([6, 6, 0, 6, 6, 6], 8.0)),
        "joint 3 moves, but its velocity limit is 0",
    ),
    (
        replace(PUMA_PROBLEM, limits=Limits(6.0, [8, 0, 8, 8, 8, 8])),
        "joint 2 moves, but its acceleration limit is 0",
    ),
    (replace(PUMA_PROBLEM, limits=Limits(joints=6)), "nothing that moves is limited"),
    (
        replace(PUMA_PROBLEM, limits=Limits(6.0, 8.0, position_upper=0.5, joints=6)),
        "a way-point lies outside",
    ),
    # It would have to go out and come back.
    (TURNING, "nothing moves between the way-points, but the two end velocities differ"),
    (
        spline_problem([0.0, 1.0, 0.5], 2.0, 8.0, duration_upper=0.45),
        "segment 1 cannot be traversed within its upper bound",
    ),
    (
        spline_problem([0.0, 1.0, 0.5], 2.0, 1.0, duration_upper=0.9),
        "none of 6 starts led to an answer",
    ),
    (
        spline_problem([0.0, 1.0], 2.0, 8.0, ends=((1, 2.5),)),
        "the velocity prescribed at the start exceeds the limit of joint 1",
    ),
    # From full speed the joint must overshoot 1.0, where the range ends.
    (
        with_ends([0.0, 0.1], 0.0, 4.0, NOTHING_FASTER),
        "position is limited, and the curve found leaves the range",
    ),
]


@pytest.mark.parametrize(("problem", "why"), NO_VALUE)
def test_no_value_has_its_reason(problem: Problem, why: str) -> None:
    found = estimate_any_curve(problem)
    assert found.total_time is None
    assert found.durations is None
    assert found.evidence is Evidence.NONE
    assert str(found.why).startswith(why)
    assert why in str(found)


def test_where_nothing_moves_it_takes_no_time() -> None:
    assert estimate_any_curve(spline_problem([0.4, 0.4, 0.4], 1.0, 2.0)).why == "nothing moves"
    found = estimate_any_curve(with_ends([0.2, 0.2], 0.5, 0.5, Limits(5.0, 4.0)))
    assert found.total_time == 0.0
    assert found.nodal_velocities[:, 0] == pytest.approx([0.5, 0.5])


def test_position_limits_that_are_kept_change_nothing() -> None:
    # Joint 1 turns at the middle way-point; hurrying joint 2 makes no difference to that.
    q = np.array([[0.0, 0.0], [1.0, 0.5], [0.2, 1.0]])
    wide = Limits(5.0, 8.0, position_lower=-1.0, position_upper=2.0, joints=2)
    free = Limits(5.0, 8.0, joints=2)
    one, two = (
        estimate_any_curve(Problem(q, limits, curves.cubic_spline(2))) for limits in (wide, free)
    )
    assert one.total_time == pytest.approx(two.total_time, rel=1e-12)


def test_starts_of_the_wrong_shape() -> None:
    with pytest.raises(TrajgapError, match=r"initial: .* of shape \(starts, 3\)"):
        estimate_any_curve(PUMA_PROBLEM, initial=[1.0, 2.0])
    with pytest.raises(TrajgapError, match="initial: expected positive durations"):
        estimate_any_curve(PUMA_PROBLEM, initial=[1.0, -2.0, 1.0])


def test_curves_through_the_same_waypoints_share_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    q = np.array([[0.13, 0.4], [0.81, -0.1], [0.32, -1.5], [1.07, 0.6]])
    problem = Problem(q, Limits([1.6, 1.2], [4.0, 3.0]), curves.cubic_spline(3))
    searched, search = [], estimate.local_optimum
    monkeypatch.setattr(
        estimate, "local_optimum", lambda *asked: searched.append(asked) or search(*asked)
    )
    estimate._kept.cache_clear()
    first = estimate_any_curve(problem, starts=2)
    assert len(searched) == 2
    other = estimate_any_curve(replace(problem, curve=curves.quintic_spline(3)), starts=2)
    assert len(searched) == 2
    assert other.durations.tobytes() == first.durations.tobytes()
    # Whatever else differs is another question, and a limited time keeps nothing.
    slower = replace(problem, limits=Limits([1.6, 1.1], [4.0, 3.0]))
    assert estimate_any_curve(slower, starts=2).totals > first.totals
    estimate_any_curve(problem, starts=2, seed=1)
    assert len(searched) == 6
    with stopping_after(60.0):
        estimate_any_curve(problem, starts=2)
    assert len(searched) == 8
