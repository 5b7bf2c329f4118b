"""Verdicts over rounding boxes, by sampling and by exact rational arithmetic."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.positions import CURVES, WAYPOINTS, limited
from support.rounding_boxes import MOVING_ENDS, boxes, contradiction, rounded_problem
from support.same_question import DRESSES, SLOWER, same_question
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
