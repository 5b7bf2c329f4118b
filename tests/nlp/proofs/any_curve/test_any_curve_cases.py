"""The bound over all curves beside splines, its identities, and where it has no value."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from support.any_motions import PUMA_PROBLEM, verified
from support.joint_splines import rest_to_rest_time, spline_problem
from support.puma import PUMA
from trajgap.nlp import Evidence, solve
from trajgap.nlp.optimum import stopping_after
from trajgap.nlp.proofs.any_curve import estimate
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.retiming.toppra_check import retime
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    check,
    cubic_spline,
    cubic_spline_virtual,
    fit,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)

# --- below every spline, identities ---------------------------------------------------------------


@pytest.mark.parametrize(
    "interpolant",
    [
        three_five_three(),
        cubic_spline(3),
        quintic_spline(3),
        rest_to_rest(3, 3),
        piecewise((4, 4, 4), 2),
        piecewise((5, 5, 5), 2),
        pytest.param(cubic_spline_virtual(4), marks=pytest.mark.slow),
    ],
    ids=lambda i: i.name,
)
def test_no_spline_is_faster(interpolant: Interpolant) -> None:
    problem = replace(PUMA_PROBLEM, curve=interpolant, duration_lower=0.0, duration_upper=np.inf)
    solution = solve(problem, starts=1)
    assert solution.durations is not None
    found = estimate_any_curve(problem, initial=solution.durations)
    assert verified(problem, found) <= solution.total_time
    assert found.starts == 7


def test_no_retiming_is_faster() -> None:
    h = np.array([0.9, 0.8, 0.9])
    curve = fit(quintic_spline(3), PUMA, h * check(PUMA_PROBLEM, h).stretch)
    retimed = retime(curve, PUMA_PROBLEM.limits)
    assert retimed.extrapolated is not None
    assert retimed.error is not None
    assert estimate_any_curve(PUMA_PROBLEM).total_time <= retimed.extrapolated + retimed.error


@pytest.mark.parametrize("seed", range(8))
def test_random_feasible_splines_are_not_faster(seed: int) -> None:
    generator = np.random.default_rng(seed)
    joints, segments = int(generator.integers(1, 5)), int(generator.integers(2, 6))
    problem = Problem(
        generator.normal(size=(segments + 1, joints)) + generator.normal(size=joints),
        Limits(generator.uniform(0.5, 6, joints), generator.uniform(2, 20, joints)),
        quintic_spline(segments),
    )
    h = generator.uniform(0.3, 1.5, segments)
    repaired = h * check(problem, h).stretch
    found = estimate_any_curve(problem, starts=3, initial=repaired)
    assert verified(problem, found) <= repaired.sum()


def test_time_scaling_mirror_and_permutation() -> None:
    base = verified(PUMA_PROBLEM, estimate_any_curve(PUMA_PROBLEM))
    faster = replace(PUMA_PROBLEM, limits=Limits(6.0 * 3, 8.0 * 9, joints=6))
    assert verified(faster, estimate_any_curve(faster)) == pytest.approx(base / 3, rel=1e-8)
    for waypoints in (1.0 - PUMA, PUMA[::-1], PUMA[:, [3, 0, 5, 1, 4, 2]]):
        other = replace(PUMA_PROBLEM, waypoints=waypoints)
        assert verified(other, estimate_any_curve(other)) == pytest.approx(base, rel=1e-8)


def test_more_of_a_limit_never_takes_longer() -> None:
    totals = [
        verified(p, estimate_any_curve(p))
        for v, a in ((1.0, 4.0), (1.0, 8.0), (2.0, 8.0), (6.0, 8.0), (6.0, 20.0))
        for p in [replace(PUMA_PROBLEM, limits=Limits(v, a, joints=6))]
    ]
    assert all(two <= one * (1 + 1e-9) for one, two in pairwise(totals))


def test_same_seed_same_bits() -> None:
    one, two = (estimate_any_curve(PUMA_PROBLEM, starts=3, seed=5) for _ in range(2))
    assert one.total_time == two.total_time
    assert (one.nodal_velocities == two.nodal_velocities).all()


def test_every_start_reaches_the_best_of_the_puma_problem() -> None:
    found = estimate_any_curve(PUMA_PROBLEM, starts=20, seed=1)
    assert found.starts_at_best == found.starts == 20
    assert verified(PUMA_PROBLEM, found) == pytest.approx(1.53528793, abs=1e-7)


# --- bounds, virtual breaks -----------------------------------------------------------------------


def test_duration_bounds_hold_between_waypoints() -> None:
    bounded = replace(PUMA_PROBLEM, duration_lower=[0.9, 0.0, 0.0], duration_upper=[2.0, 0.6, 3.0])
    found = estimate_any_curve(bounded)
    assert verified(bounded, found) > estimate_any_curve(PUMA_PROBLEM).total_time
    assert found.durations[0] == pytest.approx(0.9, rel=1e-9)
    assert found.durations[1] <= 0.6 * (1 + 1e-9)


def test_virtual_breaks_are_merged() -> None:
    virtual = Problem(PUMA, PUMA_PROBLEM.limits, cubic_spline_virtual(4))
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


# --- no value, and the reason ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        (Limits(6.0, 8.0, 50.0, joints=6), "jerk is limited"),
        (Limits([6, 6, 0, 6, 6, 6], 8.0), "joint 3 moves, but its velocity limit is 0"),
        (Limits(6.0, [8, 0, 8, 8, 8, 8]), "joint 2 moves, but its acceleration limit is 0"),
        (Limits(joints=6), "nothing that moves is limited"),
        (Limits(6.0, 8.0, position_upper=0.5, joints=6), "a way-point lies outside"),
    ],
)
def test_not_computed(limits: Limits, why: str) -> None:
    found = estimate_any_curve(replace(PUMA_PROBLEM, limits=limits))
    assert found.total_time is None
    assert found.durations is None
    assert found.evidence is Evidence.NONE
    assert found.why is not None
    assert found.why.startswith(why)
    assert str(found).startswith(f"optimum over any curve: not computed, {why}")


def test_nothing_moves() -> None:
    assert estimate_any_curve(spline_problem([0.4, 0.4, 0.4], 1.0, 2.0)).why == "nothing moves"


@pytest.mark.parametrize(("first", "last"), [(0.5, 0.5), (0.5, -0.3)])
def test_nothing_moves_but_the_ends_are_passed_with_a_velocity(first: float, last: float) -> None:
    """Passed in no time at one velocity; with two the joint would have to go out and come back."""
    curve = Interpolant((3,), (), (((1, first),), ((1, last),)))
    found = estimate_any_curve(Problem([[0.2], [0.2]], Limits(5.0, 4.0), curve))
    if first == last:
        assert found.total_time == 0.0
        assert found.nodal_velocities[:, 0] == pytest.approx([first, first])
    else:
        assert found.total_time is None
        assert found.why.endswith("the two end velocities differ")


def test_too_little_time() -> None:
    found = estimate_any_curve(spline_problem([0.0, 1.0, 0.5], 2.0, 8.0, duration_upper=0.45))
    assert found.why == "segment 1 cannot be done within its upper bound"
    found = estimate_any_curve(spline_problem([0.0, 1.0, 0.5], 2.0, 1.0, duration_upper=0.9))
    assert found.why == "none of 6 starts led to an answer"


def test_prescribed_velocity_beyond_its_limit() -> None:
    found = estimate_any_curve(spline_problem([0.0, 1.0], 2.0, 8.0, ends=((1, 2.5),)))
    assert found.why == "the velocity prescribed at the start exceeds the limit of joint 1"


def test_position_limits_are_never_dropped_silently() -> None:
    # Joint 1 turns at the middle way-point; hurrying joint 2 makes no difference to that.
    q = np.array([[0.0, 0.0], [1.0, 0.5], [0.2, 1.0]])
    wide = Limits(5.0, 8.0, position_lower=-1.0, position_upper=2.0, joints=2)
    free = Limits(5.0, 8.0, joints=2)
    one, two = (estimate_any_curve(Problem(q, limits, cubic_spline(2))) for limits in (wide, free))
    assert one.total_time == pytest.approx(two.total_time, rel=1e-12)
    # From full speed the joint must overshoot 1.0, where the range ends.
    start = Interpolant((3,), (), (((1, 0.0),), ((1, 4.0),)))
    late = Problem([[0.0], [0.1]], Limits(5.0, 8.0, position_lower=-0.2), start)
    found = estimate_any_curve(late)
    assert found.total_time is None
    assert found.why is not None
    assert found.why.startswith("position is limited, and the curve found leaves the range")


def test_starts_of_the_wrong_shape() -> None:
    with pytest.raises(TrajgapError, match=r"initial: .* of shape \(starts, 3\)"):
        estimate_any_curve(PUMA_PROBLEM, initial=[1.0, 2.0])
    with pytest.raises(TrajgapError, match="initial: expected positive durations"):
        estimate_any_curve(PUMA_PROBLEM, initial=[1.0, -2.0, 1.0])


def test_summary_on_one_screen() -> None:
    text = str(estimate_any_curve(PUMA_PROBLEM))
    for part in ("1.535287930 s", "best known, an upper estimate", "6 of 6"):
        assert part in text
    assert "floor" not in text


def test_curves_through_the_same_waypoints_share_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    q = np.array([[0.13, 0.4], [0.81, -0.1], [0.32, -1.5], [1.07, 0.6]])
    problem = Problem(q, Limits([1.6, 1.2], [4.0, 3.0]), cubic_spline(3))
    searched, search = [], estimate.local_optimum
    monkeypatch.setattr(
        estimate, "local_optimum", lambda *asked: searched.append(asked) or search(*asked)
    )
    estimate._kept.cache_clear()
    first = estimate_any_curve(problem, starts=2)
    assert len(searched) == 2
    other = estimate_any_curve(replace(problem, curve=quintic_spline(3)), starts=2)
    assert len(searched) == 2
    assert other.durations is not None
    assert other.durations.tobytes() == first.durations.tobytes()
    # Whatever else differs is another question, and a limited time keeps nothing.
    slower = replace(problem, limits=Limits([1.6, 1.1], [4.0, 3.0]))
    assert estimate_any_curve(slower, starts=2).totals > first.totals
    estimate_any_curve(problem, starts=2, seed=1)
    assert len(searched) == 6
    with stopping_after(60.0):
        estimate_any_curve(problem, starts=2)
    assert len(searched) == 8
