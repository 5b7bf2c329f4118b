"""Verdicts over rounding boxes, by sampling and by exact rational arithmetic."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.rounding_boxes import MOVING_ENDS, boxes, contradiction, rounded_problem, sampled_worst
from trajgap.compare.audits.rounding import Place, Point, RoundingBox, judge_rounding
from trajgap.compare.documents import Rounding
from trajgap.problem import (
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    cubic_spline_virtual,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from trajgap.problem.cases.load import load_case

FAMILIES = {
    "3-5-3": three_five_three(),
    "C4 quintic": quintic_spline(4),
    "C2 cubic": cubic_spline(3),
    "virtual": cubic_spline_virtual(3),
    "rest to rest": rest_to_rest(3, 5),
    "moving ends": MOVING_ENDS,
}


WIDTHS = [(1.0, 5e-4), (0.9995, 5e-4), (0.99, 5e-4), (0.98, 5e-3), (0.9, 1e-2), (0.7, 5e-2)]


def judged_families():
    for number, interpolant in enumerate(FAMILIES.values()):
        for w, (share, half) in enumerate(WIDTHS):
            problem, h = rounded_problem(10 * number + w, interpolant)
            h = h * check(problem, h).stretch * share
            yield problem, *boxes(h, half, problem.waypoints, half / 10), number + w


def test_no_point_of_the_box_contradicts_a_verdict():
    seen = set()
    for problem, h, q, seed in judged_families():
        verdict = judge_rounding(problem, h, q)
        assert contradiction(problem, h, q, verdict, seed) is None
        seen.add(verdict.verdict)
    assert seen >= {Rounding.KEEPS, Rounding.CONSISTENT, Rounding.BREAKS}


@pytest.mark.parametrize("seed", range(6))
def test_bound_is_close_to_the_least_worst_ratio(seed):
    problem, h = rounded_problem(seed, three_five_three())
    h = 0.99 * check(problem, h).stretch * h
    h, q = boxes(h, 5e-4, problem.waypoints, 5e-5)
    verdict = judge_rounding(problem, h, q)
    assert verdict.verdict is Rounding.BREAKS
    least = sampled_worst(problem, h, q, np.random.default_rng(seed)).min()
    assert verdict.lower_bound_of_worst is not None
    assert verdict.lower_bound_of_worst <= least
    # The printed point exceeds by 1 %; half a unit in the last place moves that by 0.1 %.
    assert verdict.worst_at_print - verdict.lower_bound_of_worst < 3e-3
    assert least - verdict.lower_bound_of_worst < 5e-4


def test_several_places_share_a_proof():
    # Two cubics at rest at 0, q, 2 rad over 1 s each: peaks 1.5 q and 1.5 (2 − q) rad/s. Either can
    # be kept, not both: the worst is least at q = 1.
    limits = Limits(1.49)
    problem = Problem([0.0, 1.02, 2.0], limits, rest_to_rest(2, 3))
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


def printed(case, claim, reading, problem_id=None):
    """A claim's problem, its durations and its way-points, as boxes."""
    problem = case.problem(problem_id, reading)
    low, high = case.waypoint_box(problem_id, reading)
    if claim.joint and len(problem.joints) > 1:
        column = problem.joints.index(claim.joint)
        problem, low, high = problem.joint(column), low[:, [column]], high[:, [column]]
    box = case.claim_durations(claim, reading)
    h = RoundingBox(box.value, box.lower, box.upper)
    return problem, h, RoundingBox(problem.waypoints, low, high)


@pytest.mark.parametrize("reading", ["durations-at-least-0.3", "durations-positive"])
def test_puma_table_3(reading):
    case = load_case("puma560-mnam-pso-353")
    verdicts = []
    for claim in case.table_claims("table-3"):
        problem, h, q = printed(case, claim, reading)
        verdict = judge_rounding(problem, h, q)
        assert contradiction(problem, h, q, verdict, 0) is None
        verdicts.append(verdict.verdict)
        if isinstance(verdict.exhibit, Point):
            # Not only in the box of floats: inside the printed interval itself.
            for digits, at in zip(claim.durations, verdict.exhibit.durations, strict=True):
                assert digits.interval.lower <= Fraction(float(at)) <= digits.interval.upper
            assert (verdict.exhibit.durations >= problem.duration_lower).all()
    # A plain check calls five of the six rows violated, by 0.03 to 0.04 %.
    kept, near = Rounding.KEEPS, Rounding.CONSISTENT
    assert verdicts == [near, kept, near, near, near, near, kept]


def test_palletiser():
    case = load_case("irb460-pso-353")
    verdicts = {}
    for limit in ("80", "110"):
        claim = case.claim(f"durations-{limit}")
        box = printed(case, claim, "waypoints-rad", f"limit-{limit}")
        verdicts[limit] = judge_rounding(*box)
        assert contradiction(*box, verdicts[limit], 1) is None
    assert verdicts["80"].verdict in (Rounding.KEEPS, Rounding.CONSISTENT)
    assert verdicts["110"].verdict is Rounding.BREAKS
    place = verdicts["110"].exhibit
    assert isinstance(place, Place)
    assert (place.joint, place.quantity, place.segment) == ("5", "velocity", 1)
    assert place.lower_bound == verdicts["110"].lower_bound_of_worst
    assert 1.08 < place.lower_bound < verdicts["110"].worst_at_print


@pytest.mark.parametrize("interpolant", FAMILIES.values(), ids=FAMILIES)
def test_a_box_of_width_0_is_the_plain_check(interpolant):
    problem, h = rounded_problem(7, interpolant)
    stretch = check(problem, h).stretch
    for share, expected in ((1.001, Rounding.KEEPS), (0.9999, Rounding.BREAKS)):
        at = h * stretch * share
        verdict = judge_rounding(problem, RoundingBox.exact(at))
        if interpolant is MOVING_ENDS:
            passes = check(problem, at).verdict is Verdict.PASS
            expected = Rounding.KEEPS if passes else Rounding.BREAKS
        assert verdict.verdict is expected
        worst = check(problem, at).worst
        assert worst is not None
        assert verdict.worst_at_print == worst.ratio
        if expected is Rounding.BREAKS:
            assert verdict.lower_bound_of_worst == pytest.approx(worst.ratio, rel=1e-9)
            assert verdict.lower_bound_of_worst <= worst.ratio * (1 + 1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_wide_boxes_prove_nothing_false(seed):
    problem, h = rounded_problem(seed, quintic_spline(4))
    h = 0.9 * check(problem, h).stretch * h
    wide = RoundingBox(h, 0.6 * h, 1.4 * h)
    assert judge_rounding(problem, wide).verdict is Rounding.CONSISTENT
    held = RoundingBox(h, 0.6 * h, h * (1.0 + 1e-6))
    verdict = judge_rounding(problem, held)
    assert verdict.verdict in (Rounding.CONSISTENT, Rounding.UNDECIDED)
    assert contradiction(problem, held, RoundingBox.exact(problem.waypoints), verdict, seed) is None


def test_mean_speed_decides_where_nothing_else_does():
    problem, h = rounded_problem(1, quintic_spline(4))
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


@given(
    angle=st.floats(0.01, 100.0),
    time=st.floats(0.01, 100.0),
    which=st.integers(0, 3),
    seed=st.integers(0, 20),
)
@settings(max_examples=25, deadline=None)
def test_units_do_not_matter(angle, time, which, seed):
    share = (1.001, 0.9999, 0.99, 0.97)[which]
    problem, h = rounded_problem(seed, quintic_spline(3))
    h = h * check(problem, h).stretch * share
    limits = problem.limits
    scaled = replace(
        problem,
        waypoints=problem.waypoints * angle,
        limits=Limits(
            limits.velocity * angle / time,
            limits.acceleration * angle / time**2,
            limits.jerk * angle / time**3,
        ),
    )
    one = judge_rounding(problem, *boxes(h, 5e-4, problem.waypoints, 5e-5))
    two = judge_rounding(scaled, *boxes(h * time, 5e-4 * time, scaled.waypoints, 5e-5 * angle))
    assert one.verdict is two.verdict
    assert one.worst_at_print == pytest.approx(two.worst_at_print, rel=1e-9)
    if one.verdict is Rounding.BREAKS:
        assert one.lower_bound_of_worst == pytest.approx(two.lower_bound_of_worst, rel=1e-7)


def test_the_order_of_joints_does_not_matter():
    problem, h = rounded_problem(11, three_five_three(), joints=3)
    h = h * check(problem, h).stretch * 0.99
    limits = problem.limits
    turned = replace(
        problem,
        waypoints=problem.waypoints[:, ::-1],
        limits=Limits(limits.velocity[::-1], limits.acceleration[::-1]),
        joints=problem.joints[::-1],
    )
    one, two = (judge_rounding(p, *boxes(h, 5e-4, p.waypoints, 5e-5)) for p in (problem, turned))
    assert isinstance(one.exhibit, Place)
    assert isinstance(two.exhibit, Place)
    assert one.exhibit.joint == two.exhibit.joint
    assert one.lower_bound_of_worst == pytest.approx(two.lower_bound_of_worst, rel=1e-9)
