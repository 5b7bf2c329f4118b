"""Verdicts over rounding boxes, by sampling and by exact rational arithmetic."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from support.positions import CURVES, WAYPOINTS, limited
from support.rounding_boxes import boxes, contradiction, rounded_problem
from support.same_question import DRESSES, SLOWER, same_question
from support.samples import DECLARATIONS
from trajgap.compare.audits.rounding import Place, Point, RoundingBox, judge_rounding
from trajgap.compare.documents import Rounding
from trajgap.nlp.enclosure import box_bound
from trajgap.nlp.enclosure.balls import Ball
from trajgap.problem import Limits, Problem, TrajgapError, Verdict, check, curves, evaluate

WIDTHS = ((1.0, 5e-4), (0.9995, 5e-4), (0.99, 5e-4), (0.8, 1e-2))
"""Share of the durations that just keep the limits, and how far digits reach."""
UNEVEN = Limits([[-1.5, 1.9], [-1.8, 1.6], [-2.4, 2.9]], [[-6, 8], [-7, 5.5], [-9, 11]])
"""No two sides alike."""
SLOW = ("chord", "degree 5")
"""Words in the names of clamped B-splines that are sampled for seconds."""


@pytest.mark.parametrize(
    ("number", "name"),
    [
        pytest.param(*one, marks=[pytest.mark.slow] if any(w in one[1] for w in SLOW) else [])
        for one in enumerate(CURVES)
    ],
)
def test_no_point_of_the_box_contradicts_a_verdict_in_any_dress(number: int, name: str) -> None:
    """Sides that differ, position limits on some; the same said mirrored, backwards or slower."""
    bounded = limited(CURVES[name], 2.0, UNEVEN)
    problem = Problem(WAYPOINTS, bounded.limits, bounded.curve)
    start = np.array([0.8, 1.3, 0.7, 0.9, 1.1])[: problem.segments]
    start *= check(problem, start).stretch
    seen = []
    for width, (share, half) in enumerate(WIDTHS):
        h, q = boxes(share * start, half, WAYPOINTS, half / 10)
        found = judge_rounding(problem, h, q)
        assert contradiction(problem, h, q, found, width) is None
        dress = DRESSES[(number + width) % len(DRESSES)]
        other, durations = same_question(dress, problem, h.value)
        time = SLOWER if dress == "slower" else 1.0
        angle = 180 / np.pi if dress == "degrees" else 1.0
        turned = boxes(durations, half * time, other.waypoints, half / 10 * angle)
        again = judge_rounding(other, *turned)
        assert again.verdict is found.verdict
        assert again.worst_at_print == pytest.approx(found.worst_at_print, rel=1e-9)
        if found.verdict is Rounding.BREAKS and half < 1e-3 and "clamped" not in name:
            # The printed point exceeds by 1 %; half a unit in the last place moves that by 0.1 %.
            for one in (found, again):
                assert 0 <= one.worst_at_print - one.lower_bound_of_worst < 5e-3
        seen.append(found.verdict)
    # A motion that jumps is never said to keep its limits.
    jumping = "stretched" in name or name == "straight lines"
    keeps = {Rounding.UNDECIDED} if jumping else {Rounding.KEEPS, Rounding.CONSISTENT}
    assert {*seen[:2]} <= keeps
    assert {*seen[2:]} == {Rounding.UNDECIDED if "clamped" in name else Rounding.BREAKS}


def test_several_places_share_a_proof():
    # Two cubics at rest at 0, q, 2 rad over 1 s each: peaks 1.5 q and 1.5 (2 − q) rad/s. Either can
    # be kept, not both: the worst is least at q = 1.
    limits = Limits(1.49)
    problem = Problem([0.0, 1.02, 2.0], limits, curves.rest_to_rest(2, 3))
    h = RoundingBox.exact(np.ones(2))
    reach = np.array([[0.0], [0.1], [0.0]])
    q = RoundingBox(problem.waypoints, problem.waypoints - reach, problem.waypoints + reach)
    verdict = judge_rounding(problem, h, q)
    assert verdict.verdict is Rounding.BREAKS
    assert verdict.lower_bound_of_worst == pytest.approx(1.5 / 1.49, rel=1e-12)
    wider = replace(problem, limits=Limits(1.51))
    found = judge_rounding(wider, h, q)
    assert found.verdict is Rounding.CONSISTENT
    assert isinstance(found.exhibit, Point)
    assert abs(found.exhibit.waypoints[1, 0] - 1.0) < 0.01
    assert found.lower_bound_of_worst == pytest.approx(1.5 / 1.51, rel=1e-12)


@pytest.mark.parametrize("name", sorted(DECLARATIONS.keys() - {"lines", "rest 7"}))
def test_a_box_of_width_0_is_the_plain_check(name):
    problem, h = rounded_problem(7, DECLARATIONS[name])
    stretch = check(problem, h).stretch
    for share in (1.001, 0.9999):
        at = h * stretch * share
        plain, verdict = check(problem, at), judge_rounding(problem, RoundingBox.exact(at))
        keeps = plain.verdict is Verdict.PASS
        assert verdict.verdict is (Rounding.KEEPS if keeps else Rounding.BREAKS)
        assert verdict.worst_at_print == plain.worst.ratio
        if not keeps:
            assert verdict.lower_bound_of_worst == pytest.approx(plain.worst.ratio, rel=1e-9)
            assert verdict.lower_bound_of_worst <= plain.worst.ratio * (1 + 1e-13)


def test_mean_speed_decides_where_nothing_else_does():
    problem, h = rounded_problem(1, curves.quintic_spline(4))
    slow = replace(problem, limits=Limits(0.01, joints=2))
    with_zero = RoundingBox(h, 0.0 * h, 1.4 * h)
    verdict = judge_rounding(slow, with_zero)
    assert verdict.verdict is Rounding.BREAKS
    place = verdict.exhibit
    assert isinstance(place, Place)
    assert (place.quantity, place.s) == ("velocity", None)
    ways = np.abs(np.diff(problem.waypoints, axis=0)) / with_zero.upper[:, None]
    assert place.lower_bound == pytest.approx(ways.max() / 0.01, rel=1e-12)
    assert place.lower_bound < ways.max() / 0.01


def near(h: np.ndarray, half: float = 5e-4) -> RoundingBox:
    return RoundingBox(h, h - half, h + half)


def scaled(seed: int, share: float) -> tuple[Problem, np.ndarray]:
    """A problem, and durations at a share of those that just keep its limits."""
    problem, h = rounded_problem(seed, curves.three_five_three())
    return problem, share * check(problem, h).stretch * h


def broken(problem: Problem, *box: RoundingBox) -> Place:
    """The place where a limit is broken all over a box."""
    verdict = judge_rounding(problem, *box)
    assert verdict.verdict is Rounding.BREAKS
    assert isinstance(verdict.exhibit, Place)
    return verdict.exhibit


def test_durations_outside_their_bounds_break():
    problem, h = scaled(2, 3.0)
    short = broken(replace(problem, duration_lower=np.array([0.0, h[1] + 0.01, 0.0])), near(h))
    assert (short.joint, short.quantity, short.segment) == (None, "duration", 1)
    assert 1.0 < short.lower_bound < (h[1] + 0.01) / (h[1] + 5e-4)
    long = replace(problem, duration_upper=np.array([np.inf, np.inf, h[2] - 0.01]))
    assert broken(long, near(h)).segment == 2


def test_the_search_stays_within_the_duration_bounds():
    problem, h = scaled(2, 3.0)
    at_bound = replace(problem, duration_lower=h, duration_upper=h)
    assert judge_rounding(at_bound, near(h)).verdict is Rounding.KEEPS
    for low, high in ((h + 3e-4, np.full(3, np.inf)), (0.0 * h, h - 3e-4)):
        verdict = judge_rounding(replace(problem, duration_lower=low, duration_upper=high), near(h))
        assert verdict.verdict is Rounding.CONSISTENT
        assert isinstance(verdict.exhibit, Point)
        assert ((low <= verdict.exhibit.durations) & (verdict.exhibit.durations <= high)).all()


def test_a_bound_keeps_the_durations_from_repairing_the_motion():
    problem, h = scaled(2, 0.9999)
    assert judge_rounding(problem, near(h)).verdict is Rounding.CONSISTENT
    held = replace(problem, duration_upper=h)
    verdict = judge_rounding(held, near(h))
    assert verdict.verdict in (Rounding.BREAKS, Rounding.UNDECIDED)
    assert contradiction(held, near(h), RoundingBox.exact(held.waypoints), verdict, 3) is None


def test_positions():
    waypoints = np.array([[0.1], [0.9], [0.3], [0.5]])
    h = np.array([0.8, 0.7, 0.9])
    free = Problem(waypoints, Limits(50.0), curves.three_five_three())
    capped = replace(free, limits=Limits(50.0, position_upper=0.0))
    top = max(p.value for p in check(capped, h).peaks if p.quantity == "position")
    box = boxes(h, 5e-4, waypoints, 5e-5)
    for shift, expected in ((1e-3, Rounding.KEEPS), (-1e-5, Rounding.CONSISTENT)):
        limits = Limits(50.0, position_lower=-2.0, position_upper=top + shift)
        assert judge_rounding(replace(free, limits=limits), *box).verdict is expected
    over = replace(free, limits=Limits(50.0, position_lower=-2.0, position_upper=top - 1e-2))
    least = min(
        check(replace(over, waypoints=q), x).worst.ratio
        for x in (box[0].lower, box[0].value, box[0].upper)
        for q in (box[1].lower, box[1].value, box[1].upper)
    )
    place = broken(over, *box)
    assert place.quantity == "position"
    assert 1.0 < place.lower_bound <= least
    low = Limits(50.0, position_lower=0.11, position_upper=2.0)
    assert broken(replace(free, limits=low), *box).segment == 0


def test_a_joint_that_must_not_move():
    still = np.column_stack([[0.1, 0.5, 0.3, 0.2], [0.7] * 4])
    limits = Limits([9.0, 0.0], np.inf)
    h = near(np.ones(3))
    problem = Problem(still, limits, curves.three_five_three())
    assert judge_rounding(problem, h).verdict is Rounding.KEEPS
    moving = still + np.array([[0.0, 0.0], [0.0, 1e-3], [0.0, 0.0], [0.0, 0.0]])
    problem = Problem(moving, limits, curves.three_five_three())
    assert judge_rounding(problem, h).lower_bound_of_worst == np.inf
    assert broken(problem, h).joint == "2"
    # With way-points that may all be equal there is no proof.
    assert judge_rounding(problem, h, near(moving, 1e-3)).verdict is Rounding.UNDECIDED
    alone = Problem([0.1, 0.4, 0.2, 0.6], Limits(0.0, np.inf, joints=1), curves.three_five_three())
    assert judge_rounding(alone, near(np.ones(3), 0.01), None).verdict is Rounding.BREAKS


def test_a_jump_is_not_called_an_excess():
    jumping = curves.piecewise((3, 3), 0, ((1, 0.0), (2, 0.0)))
    problem = Problem([[0.1], [0.9], [0.4]], Limits(50.0), jumping)
    assert check(problem, [1.0, 0.9]).verdict is Verdict.DISCONTINUOUS
    h = near(np.array([1.0, 0.9]))
    verdict = judge_rounding(problem, h)
    assert (verdict.verdict, verdict.exhibit) == (Rounding.UNDECIDED, None)
    broken(replace(problem, limits=Limits(0.5)), h)


def test_nothing_limited_is_kept_by_every_duration():
    problem = Problem([[0.1], [0.9], [0.4], [0.0]], Limits(joints=1), curves.three_five_three())
    verdict = judge_rounding(problem, RoundingBox.exact(np.ones(3)))
    assert (verdict.verdict, verdict.worst_at_print) == (Rounding.KEEPS, 0.0)
    assert verdict.lower_bound_of_worst is None
    free = Problem([0.0, 1.0, 0.5], Limits(np.inf), curves.cubic_spline(2), duration_lower=0.5)
    h = np.array([0.49, 0.6])
    below = RoundingBox(h, np.array([0.48, 0.59]), np.array([0.495, 0.61]))
    assert judge_rounding(free, below).verdict is Rounding.BREAKS
    around = judge_rounding(free, RoundingBox(h, np.array([0.48, 0.59]), np.array([0.51, 0.61])))
    assert around.verdict in (Rounding.CONSISTENT, Rounding.UNDECIDED)


def test_bisection_tightens():
    problem, h = scaled(4, 0.9)
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
    problem, h = rounded_problem(0, curves.three_five_three())
    for low, high, said in (
        (h[:2], h, "differ in shape"),
        (h - np.inf, h, "not finite"),
        (h + 1.0, h + 2.0, "outside its bounds"),
    ):
        with pytest.raises(TrajgapError, match=said):
            RoundingBox(h, low, high)
    free = Problem(problem.waypoints, problem.limits, curves.piecewise((5, 5, 5), 2))
    narrow = RoundingBox.exact(problem.waypoints[:, :1])
    for asked, box, said in (
        (problem, (RoundingBox.exact(h), narrow), r"waypoints: the box has shape \(4, 1\)"),
        (problem, (RoundingBox.exact(h[:2]),), r"durations: expected 3"),
        (problem, (RoundingBox(0.0 * h, 0.0 * h, h),), "must all be positive"),
        (free, (RoundingBox.exact(h),), "give nodal derivatives"),
    ):
        with pytest.raises(TrajgapError, match=said):
            judge_rounding(asked, *box)


def test_floats_at_the_ends_of_a_box_are_on_the_safe_side_of_the_digits() -> None:
    """0.3 is the float below 3/10, and 1.1 is the one above 11/10."""
    low, high = map(Fraction, RoundingBox(0.7, 0.3, 1.1).inside())
    assert Fraction("0.3") <= low <= high <= Fraction("1.1")
    assert Fraction(float(RoundingBox(-0.2, -0.25, -0.15).or_cut_off().lower)) <= Fraction("-0.3")


def test_a_motion_whose_limited_derivative_vanishes_is_not_searched() -> None:
    """Two way-points of a timed uniform cubic B-spline: a straight line, whose jerk is 0."""
    curve = curves.uniform_cubic_b_spline(2, "timed")
    points = np.deg2rad([[23.0138], [-31.7772]])
    problem = Problem(points, Limits(jerk=np.deg2rad(302.867), joints=1), curve)
    found = judge_rounding(problem, near(np.array([1.7282e-05]), 5e-10), near(points, 1e-6))
    assert found.verdict is not Rounding.BREAKS
