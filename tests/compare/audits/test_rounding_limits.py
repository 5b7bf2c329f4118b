"""Rounding verdicts at bounds, positions and limits that leave nothing to move."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from support.b_splines import NATURAL, uniform
from support.rounding_boxes import rounded_problem
from support.rounding_samples import boxes, contradiction
from trajgap.compare.audits.rounding import (
    Place,
    Point,
    RoundingBox,
    judge_rounding,
)
from trajgap.compare.documents import Rounding
from trajgap.nlp.enclosure import box_bound
from trajgap.nlp.enclosure.balls import Ball
from trajgap.nlp.enclosure.uniform import centred_timed
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    fit,
    piecewise,
    quintic_spline,
    three_five_three,
)
from trajgap.problem.cases.load import parse_case

# --- bounds, positions, degenerate limits ---------------------------------------------------------


def test_durations_outside_their_bounds_break():
    problem, h = rounded_problem(2, three_five_three())
    h = 3.0 * check(problem, h).stretch * h
    box = RoundingBox(h, h - 5e-4, h + 5e-4)
    short = replace(problem, duration_lower=np.array([0.0, h[1] + 0.01, 0.0]))
    verdict = judge_rounding(short, box)
    assert verdict.verdict is Rounding.BREAKS
    assert isinstance(verdict.exhibit, Place)
    assert (verdict.exhibit.joint, verdict.exhibit.quantity) == (None, "duration")
    assert verdict.exhibit.segment == 1
    assert 1.0 < verdict.exhibit.lower_bound < (h[1] + 0.01) / (h[1] + 5e-4)
    long = replace(problem, duration_upper=np.array([np.inf, np.inf, h[2] - 0.01]))
    verdict = judge_rounding(long, box)
    assert verdict.verdict is Rounding.BREAKS
    assert isinstance(verdict.exhibit, Place)
    assert verdict.exhibit.segment == 2


def test_the_search_stays_within_the_duration_bounds():
    problem, h = rounded_problem(2, three_five_three())
    h = 3.0 * check(problem, h).stretch * h
    box = RoundingBox(h, h - 5e-4, h + 5e-4)
    at_bound = replace(problem, duration_lower=h, duration_upper=h)
    assert judge_rounding(at_bound, box).verdict is Rounding.KEEPS
    for side in (-1.0, 1.0):
        bound = h + side * 3e-4
        above = replace(problem, duration_lower=bound if side > 0 else 0.0 * h)
        above = replace(above, duration_upper=bound if side < 0 else np.inf + 0.0 * h)
        verdict = judge_rounding(above, box)
        assert verdict.verdict is Rounding.CONSISTENT
        assert isinstance(verdict.exhibit, Point)
        assert (verdict.exhibit.durations >= above.duration_lower).all()
        assert (verdict.exhibit.durations <= above.duration_upper).all()


def test_a_bound_keeps_the_durations_from_repairing_the_motion():
    problem, h = rounded_problem(2, three_five_three())
    h = 0.9999 * check(problem, h).stretch * h
    box = RoundingBox(h, h - 5e-4, h + 5e-4)
    assert judge_rounding(problem, box).verdict is Rounding.CONSISTENT
    held = replace(problem, duration_upper=h)
    verdict = judge_rounding(held, box)
    assert verdict.verdict in (Rounding.BREAKS, Rounding.UNDECIDED)
    assert contradiction(held, box, RoundingBox.exact(held.waypoints), verdict, 3) is None


def test_positions():
    waypoints = np.array([[0.1], [0.9], [0.3], [0.5]])
    h = np.array([0.8, 0.7, 0.9])
    free = Problem(waypoints, Limits(50.0), three_five_three())
    capped = replace(free, limits=Limits(50.0, position_upper=0.0))
    top = max(p.value for p in check(capped, h).peaks if p.quantity == "position")
    box = boxes(h, 5e-4, waypoints, 5e-5)
    for shift, expected in (
        (1e-3, Rounding.KEEPS),
        (-1e-5, Rounding.CONSISTENT),
        (-1e-2, Rounding.BREAKS),
    ):
        limits = Limits(50.0, position_lower=-2.0, position_upper=top + shift)
        verdict = judge_rounding(replace(free, limits=limits), *box)
        assert verdict.verdict is expected
        if expected is Rounding.BREAKS:
            assert isinstance(verdict.exhibit, Place)
            assert verdict.exhibit.quantity == "position"
            least = min(
                check(replace(free, limits=limits, waypoints=q), x).worst.ratio
                for x in (box[0].lower, box[0].value, box[0].upper)
                for q in (box[1].lower, box[1].value, box[1].upper)
            )
            assert 1.0 < verdict.lower_bound_of_worst <= least
    low = Limits(50.0, position_lower=0.11, position_upper=2.0)
    verdict = judge_rounding(replace(free, limits=low), *box)
    assert verdict.verdict is Rounding.BREAKS
    assert isinstance(verdict.exhibit, Place)
    assert verdict.exhibit.segment == 0


def test_a_joint_that_must_not_move():
    still = np.column_stack([[0.1, 0.5, 0.3, 0.2], [0.7] * 4])
    limits = Limits([9.0, 0.0], np.inf)
    h = RoundingBox(np.ones(3), np.full(3, 0.9995), np.full(3, 1.0005))
    assert judge_rounding(Problem(still, limits, three_five_three()), h).verdict is Rounding.KEEPS
    moving = still + np.array([[0.0, 0.0], [0.0, 1e-3], [0.0, 0.0], [0.0, 0.0]])
    verdict = judge_rounding(Problem(moving, limits, three_five_three()), h)
    assert verdict.verdict is Rounding.BREAKS
    assert verdict.lower_bound_of_worst == np.inf
    assert isinstance(verdict.exhibit, Place)
    assert verdict.exhibit.joint == "2"
    # With way-points that may all be equal there is no proof.
    around = RoundingBox(moving, moving - 1e-3, moving + 1e-3)
    verdict = judge_rounding(Problem(moving, limits, three_five_three()), h, around)
    assert verdict.verdict is Rounding.UNDECIDED


def test_a_jump_is_not_called_an_excess():
    jumping = piecewise((3, 3), 0, ((1, 0.0), (2, 0.0)))
    problem = Problem([[0.1], [0.9], [0.4]], Limits(50.0), jumping)
    assert check(problem, [1.0, 0.9]).verdict is Verdict.DISCONTINUOUS
    h = np.array([1.0, 0.9])
    verdict = judge_rounding(problem, RoundingBox(h, h - 5e-4, h + 5e-4))
    assert verdict.verdict is Rounding.UNDECIDED
    assert verdict.exhibit is None
    fast = judge_rounding(replace(problem, limits=Limits(0.5)), RoundingBox(h, h - 5e-4, h + 5e-4))
    assert fast.verdict is Rounding.BREAKS


def test_nothing_limited():
    problem = Problem([[0.1], [0.9], [0.4], [0.0]], Limits(joints=1), three_five_three())
    verdict = judge_rounding(problem, RoundingBox.exact(np.ones(3)))
    assert (verdict.verdict, verdict.worst_at_print) == (Rounding.KEEPS, 0.0)
    assert verdict.lower_bound_of_worst is None


def test_same_input_same_answer():
    problem, h = rounded_problem(5, quintic_spline(3))
    h = h * check(problem, h).stretch * 0.9995
    one, two = (judge_rounding(problem, *boxes(h, 5e-4, problem.waypoints, 5e-5)) for _ in "ab")
    assert one.lower_bound_of_worst == two.lower_bound_of_worst
    assert one.verdict is two.verdict


def test_bisection_tightens():
    problem, h = rounded_problem(4, three_five_three())
    h = 0.9 * check(problem, h).stretch * h
    ball = Ball.exact(problem.waypoints)
    root = box_bound.bound_ratio(problem, 0.98 * h, 1.02 * h, ball)
    finer = [
        box_bound.bound_by_bisection(problem, root, ball, target)
        for target in (0.0, root.value + 1e-4, np.inf)
    ]
    assert finer[0].value == root.value
    assert all(a.value < b.value for a, b in pairwise(finer))
    least = evaluate(problem, np.random.default_rng(0).uniform(0.98, 1.02, (2000, 3)) * h).ratios
    assert finer[-1].value <= least.max(axis=(1, 2)).min()


def test_bad_boxes_are_refused():
    problem, h = rounded_problem(0, three_five_three())
    with pytest.raises(TrajgapError, match="differ in shape"):
        RoundingBox(h, h[:2], h)
    with pytest.raises(TrajgapError, match="not finite"):
        RoundingBox(h, h - np.inf, h)
    with pytest.raises(TrajgapError, match="outside its bounds"):
        RoundingBox(h, h + 1.0, h + 2.0)
    with pytest.raises(TrajgapError, match=r"waypoints: the box has shape \(4, 1\)"):
        judge_rounding(problem, RoundingBox.exact(h), RoundingBox.exact(problem.waypoints[:, :1]))
    with pytest.raises(TrajgapError, match=r"durations: expected 3"):
        judge_rounding(problem, RoundingBox.exact(h[:2]))
    with pytest.raises(TrajgapError, match="must all be positive"):
        judge_rounding(problem, RoundingBox(0.0 * h, 0.0 * h, h))
    free = Problem(problem.waypoints, problem.limits, piecewise((5, 5, 5), 2))
    with pytest.raises(TrajgapError, match="give nodal derivatives"):
        judge_rounding(free, RoundingBox.exact(h))


def test_a_moving_joint_with_limit_zero_alone_is_judged() -> None:
    points = np.array([[0.1], [0.4], [0.2], [0.6]])
    problem = Problem(points, Limits(0.0, np.inf, joints=1), three_five_three())
    durations = RoundingBox(np.ones(3), np.full(3, 0.99), np.full(3, 1.01))
    assert judge_rounding(problem, durations, None).verdict is Rounding.BREAKS


def test_nothing_limited_is_kept_by_every_duration() -> None:
    free = Problem([[0.0], [1.0], [0.5]], Limits(np.inf), cubic_spline(2), duration_lower=0.5)
    below = RoundingBox(np.array([0.49, 0.6]), np.array([0.48, 0.59]), np.array([0.495, 0.61]))
    assert judge_rounding(free, below).verdict is Rounding.BREAKS
    around = RoundingBox(np.array([0.49, 0.6]), np.array([0.48, 0.59]), np.array([0.51, 0.61]))
    assert judge_rounding(free, around).verdict in (Rounding.CONSISTENT, Rounding.UNDECIDED)


def test_a_motion_whose_limited_derivative_vanishes_is_not_searched() -> None:
    """Two way-points of a timed uniform cubic B-spline: a straight line, whose jerk is 0."""
    case = parse_case(
        """
format = 1
id = "line"
title = "a straight line"
source = { year = 2024 }
robot = { name = "arm", joints = ["1"] }
units = { position = "deg", jerk = "deg/s^3", time = "s" }
waypoints = { where = "Table 1", joint_rows = [[23.0138, -31.7772]] }
limits = { jerk = 302.867 }
interpolant = { family = "uniform-cubic-b-spline", time = "timed" }
""",
        "line.toml",
    )
    problem = case.problem()
    times = np.array([1.7282e-05])
    points = RoundingBox(problem.waypoints, problem.waypoints - 1e-6, problem.waypoints + 1e-6)
    found = judge_rounding(problem, RoundingBox(times, times - 5e-10, times + 5e-10), points)
    assert found.verdict is not Rounding.BREAKS


@pytest.mark.parametrize("natural", [False, True])
def test_derivatives_over_a_box_hold_those_of_its_motions_however_time_ends(natural: bool) -> None:
    problem, h = uniform(NATURAL if natural else "timed", 3, count=5)
    rng = np.random.default_rng(8)
    segment, joint = rng.integers(0, 4, 12), rng.integers(0, 3, 12)
    order, s = rng.integers(1, 3, 12), rng.uniform(0, 1, 12)
    wide = Ball.between(0.999 * h, 1.001 * h)
    q = Ball(problem.waypoints, np.full(problem.waypoints.shape, 1e-3))
    form = centred_timed(5, joint, segment, order, s, wide, q, natural)
    spread = (np.abs(form.by_duration.mid) + form.by_duration.rad) @ (1e-3 * h) + (
        np.abs(form.by_waypoint.mid) + form.by_waypoint.rad
    ).sum(axis=1) * 1e-3
    for _ in range(5):
        durations = h * rng.uniform(0.999, 1.001, 4)
        points = problem.waypoints + rng.uniform(-1e-3, 1e-3, problem.waypoints.shape)
        moved = fit(problem.curve, points, durations)
        found = [moved.value(*at) for at in zip(segment, joint, order, s, strict=True)]
        away = np.abs(found - form.value.mid)
        assert (away <= 1.01 * spread + form.value.rad).all()
        assert away.max() > 0.01 * spread.max()
