"""Verdicts over rounding boxes, by sampling and by exact rational arithmetic."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trajgap.compare.audits.rounding import (
    Place,
    Point,
    RoundingBox,
    RoundingVerdict,
    judge_rounding,
)
from trajgap.compare.documents import Rounding
from trajgap.nlp.enclosure import balls as interval
from trajgap.nlp.enclosure import box_bound
from trajgap.nlp.enclosure.balls import Ball, enclose_spline
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from trajgap.problem.cases.load import load_case, parse_case
from trajgap.problem.curves.condition import ConditionKind

MOVING_ENDS = piecewise((4, 3, 4), 2, ((1, 0.3), (2, -0.7)))


def posed(seed: int, interpolant: Interpolant, joints: int = 2) -> tuple[Problem, np.ndarray]:
    """Shifted, unequal data under velocity, acceleration and, for C4, jerk limits."""
    rng = np.random.default_rng(seed)
    count = len(interpolant.waypoint_breaks)
    waypoints = np.round(0.7 + rng.normal(size=(count, joints)), 4)
    durations = np.round(rng.uniform(0.4, 1.3, interpolant.segments), 3)
    jerk = rng.uniform(80.0, 200.0, joints) if interpolant.continuity[0] > 2 else np.inf
    limits = Limits(rng.uniform(2.0, 4.0, joints), rng.uniform(8.0, 20.0, joints), jerk)
    return Problem(waypoints, limits, interpolant), durations


def boxes(durations: np.ndarray, half: float, waypoints: np.ndarray, angle: float):
    return (
        RoundingBox(durations, durations - half, durations + half),
        RoundingBox(waypoints, waypoints - angle, waypoints + angle),
    )


def sampled_worst(
    problem: Problem, h: RoundingBox, q: RoundingBox, rng, groups: int = 40, each: int = 50
):
    """Worst ratios at random points of the box, a quarter of them at its corners."""
    worst = []
    low = np.maximum(h.lower, problem.duration_lower)
    high = np.minimum(h.upper, problem.duration_upper)
    for g in range(groups):
        share = rng.uniform(size=q.value.shape)
        share = np.round(share) if g % 4 == 0 else share
        angles = np.clip(q.lower + share * (q.upper - q.lower), q.lower, q.upper)
        there = replace(problem, waypoints=angles)
        share = rng.uniform(size=(each, h.value.size))
        share[::4] = np.round(share[::4])
        durations = np.clip(low + share * (high - low), low, high)
        worst.append(evaluate(there, durations).ratios.max(axis=(1, 2)))
    return np.concatenate(worst)


def contradiction(
    problem: Problem, h: RoundingBox, q: RoundingBox, verdict: RoundingVerdict, seed: int
) -> str | None:
    """What a verdict states that some point of the box contradicts."""
    worst = sampled_worst(problem, h, q, np.random.default_rng(seed))
    bound = verdict.lower_bound_of_worst
    if bound is not None and worst.min() < bound * (1.0 - 1e-12):
        return f"a point of the box has ratio {worst.min()}, below {bound}"
    if verdict.verdict is Rounding.BREAKS:
        if not isinstance(verdict.exhibit, Place) or bound is None or bound <= 1.0 + 1e-9:
            return "no proof is exhibited"
        return None if worst.min() > 1.0 + 1e-9 else "a point of the box keeps the limits"
    if verdict.verdict in (Rounding.KEEPS, Rounding.CONSISTENT):
        point = verdict.exhibit
        if not isinstance(point, Point):
            return "no point is exhibited"
        for box, at in ((h, point.durations), (q, point.waypoints)):
            if not ((box.lower <= at) & (at <= box.upper)).all():
                return "the exhibited point lies outside the box"
        there = replace(problem, waypoints=point.waypoints)
        if check(there, point.durations).verdict is not Verdict.PASS:
            return "the exhibited point does not pass"
    return None


# --- enclosures against exact arithmetic ----------------------------------------------------------


def exact_coefficients(
    interpolant: Interpolant, durations: list[Fraction], waypoints: list[Fraction]
) -> list[Fraction]:
    """One joint's scaled coefficients by Gaussian elimination on fractions."""
    first = [0]
    for d in interpolant.degrees:
        first.append(first[-1] + d + 1)
    angle = dict(zip(interpolant.waypoint_breaks, waypoints, strict=True))
    system = []
    for row in interpolant.rows:
        b, r = row.at, row.order
        line = [Fraction(0)] * (first[-1] + 1)
        if row.kind != ConditionKind.RIGHT_VALUE:
            for p in range(r, interpolant.degrees[b - 1] + 1):
                line[first[b - 1] + p] = Fraction(math.perm(p, r)) / durations[b - 1] ** r
        if row.kind != ConditionKind.LEFT_VALUE and r <= interpolant.degrees[b]:
            sign = 1 if row.kind == ConditionKind.RIGHT_VALUE else -1
            line[first[b] + r] = sign * math.factorial(r) / durations[b] ** r
        if row.kind != ConditionKind.MATCH:
            prescribed = dict(interpolant.prescribed[b])
            line[-1] = angle[b] if r == 0 else Fraction(prescribed[r])
        system.append(line)
    size = first[-1]
    for c in range(size):
        pivot = next(i for i in range(c, size) if system[i][c])
        system[c], system[pivot] = system[pivot], system[c]
        system[c] = [x / system[c][c] for x in system[c]]
        for i in range(size):
            if i != c and system[i][c]:
                factor = system[i][c]
                system[i] = [x - factor * y for x, y in zip(system[i], system[c], strict=True)]
    return [line[-1] for line in system]


def escaped(ball: Ball, exact: list[Fraction]) -> float:
    """How far numbers lie outside a ball, in radii; 1 or less is inside."""
    return max(
        float(abs(x - Fraction(float(m))) / Fraction(float(r)))
        for x, m, r in zip(exact, ball.mid, ball.rad, strict=True)
    )


def worst_escape(interpolant: Interpolant, half: float, seed: int, corners: int = 3) -> float:
    """Largest escape of coefficients and of their derivatives at points of a box."""
    rng = np.random.default_rng(seed)
    problem, h = posed(seed, interpolant, joints=2)
    q = problem.waypoints
    ball_h, ball_q = Ball.between(h - half, h + half), Ball.between(q - half, q + half)
    found = enclose_spline(interpolant, ball_h, ball_q)
    assert found is not None
    worst = 0.0
    for way in [rng.uniform(-1, 1, h.size), *rng.choice([-1.0, 1.0], (corners, h.size))]:
        at = [Fraction(x) for x in np.clip(h + half * way, h - half, h + half).tolist()]
        shift = rng.choice([-1.0, 1.0], q.shape)
        there = np.clip(q + half * shift, q - half, q + half)
        for j in range(2):
            angles = [Fraction(x) for x in there[:, j].tolist()]
            exact = exact_coefficients(interpolant, at, angles)
            worst = max(worst, escaped(found.coefficients[:, j], exact))
            step = Fraction(1, 10**30)
            for m in range(interpolant.segments):
                ends = [
                    exact_coefficients(interpolant, [*at[:m], at[m] + d, *at[m + 1 :]], angles)
                    for d in (-step, step)
                ]
                slope = [(b - a) / (2 * step) for a, b in zip(*ends, strict=True)]
                worst = max(worst, escaped(found.by_duration[:, m, j], slope))
            w = int(rng.integers(len(angles)))
            moved = [*angles[:w], angles[w] + 1, *angles[w + 1 :]]
            other = exact_coefficients(interpolant, at, moved)
            slope = [b - a for a, b in zip(exact, other, strict=True)]
            worst = max(worst, escaped(found.by_waypoint[:, w], slope))
    return worst


@pytest.mark.parametrize(
    "interpolant",
    [three_five_three(), quintic_spline(3), cubic_spline_virtual(3), MOVING_ENDS],
    ids=lambda i: i.name,
)
@pytest.mark.parametrize("half", [0.0, 5e-4, 1e-2])
def test_enclosure_holds_the_exact_coefficients(interpolant, half):
    assert worst_escape(interpolant, half, seed=3) <= 1.0


def test_enclosure_is_not_far_too_wide():
    # At a corner the exact coefficients use a fair part of the radius.
    assert worst_escape(three_five_three(), 5e-4, seed=3) > 0.1
    _, h = posed(3, quintic_spline(3))
    problem, _ = posed(3, quintic_spline(3))
    found = enclose_spline(problem.curve, Ball.exact(h), Ball.exact(problem.waypoints))
    assert found is not None
    assert found.coefficients.rad.max() < 1e-12


def test_a_wide_box_is_not_enclosed():
    problem, h = posed(0, quintic_spline(3))
    wide = Ball.between(0.3 * h, 1.7 * h)
    assert enclose_spline(problem.curve, wide, Ball.exact(problem.waypoints)) is None
    zero = Ball.between(0.0 * h, 1.7 * h)
    assert enclose_spline(problem.curve, zero, Ball.exact(problem.waypoints)) is None


def _narrow_quotient(monkeypatch):
    true = interval.quotient_power

    def planted(numerator, denominator, exponents):
        ball = true(numerator, denominator, exponents)
        return Ball(ball.mid, 0.9 * ball.rad)

    monkeypatch.setattr(interval, "quotient_power", planted)


def _lost_defect(monkeypatch):
    true = interval._system

    def planted(matrix):
        system = true(matrix)
        return replace(system, defect=0.0 * system.defect, contraction=0.0)

    monkeypatch.setattr(interval, "_system", planted)


def _lost_radius(monkeypatch):
    true = Ball.__matmul__

    def planted(self, other):
        return true(self, Ball.exact(other.mid))

    monkeypatch.setattr(Ball, "__matmul__", planted)


def _swapped_ratio(monkeypatch):
    true = interval.quotient_power

    def planted(numerator, denominator, exponents):
        return true(denominator, numerator, exponents)

    monkeypatch.setattr(interval, "quotient_power", planted)


@pytest.mark.parametrize("fault", [_narrow_quotient, _lost_defect, _lost_radius, _swapped_ratio])
def test_a_fault_in_the_enclosure_is_seen(monkeypatch, fault):
    fault(monkeypatch)
    assert any(worst_escape(quintic_spline(2), 2e-2, seed, corners=8) > 1.0 for seed in (3, 4, 5))


def test_rounding_is_part_of_the_radius():
    # 1/3 and its powers are no floats: an enclosure without rounding would miss them.
    third = interval.quotient_power(
        Ball.exact(np.ones(3)), Ball.exact(np.full(3, 3.0)), np.array([1, 2, 5])
    )
    exact = [Fraction(1, 3), Fraction(1, 9), Fraction(1, 243)]
    assert 0.0 < escaped(third, exact) <= 1.0
    rng = np.random.default_rng(5)
    a, b = rng.normal(size=(3, 40)), rng.normal(size=(40, 2))
    product = Ball.exact(a) @ Ball.exact(b)
    for i in range(3):
        exact = [
            sum(
                (Fraction(x) * Fraction(y) for x, y in zip(a[i].tolist(), col, strict=True)),
                Fraction(0),
            )
            for col in b.T.tolist()
        ]
        assert escaped(product[i], exact) <= 1.0


@given(st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 4), min_size=1, max_size=5))
@settings(max_examples=60, deadline=None)
def test_ball_arithmetic_holds_every_result(numbers):
    a, b, c, d = (np.array(column) for column in zip(*numbers, strict=True))
    x = Ball.between(np.minimum(a, b), np.maximum(a, b))
    y = Ball.between(np.minimum(c, d), np.maximum(c, d))
    for left, right in ((a, c), (a, d), (b, c), (b, d)):
        pairs = [(Fraction(p), Fraction(q)) for p, q in zip(left, right, strict=True)]
        for ball, exact in (
            (x + y, [p + q for p, q in pairs]),
            (x - y, [p - q for p, q in pairs]),
            (x * y, [p * q for p, q in pairs]),
        ):
            assert escaped(ball, exact) <= 1.0
            least, most = ball.least().tolist(), ball.magnitude().tolist()
            for low, high, e in zip(least, most, exact, strict=True):
                assert Fraction(low) <= e <= abs(e) <= Fraction(high)


# --- verdicts -------------------------------------------------------------------------------------

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
            problem, h = posed(10 * number + w, interpolant)
            h = h * check(problem, h).stretch * share
            yield problem, *boxes(h, half, problem.waypoints, half / 10), number + w


def test_no_point_of_the_box_contradicts_a_verdict():
    seen = set()
    for problem, h, q, seed in judged_families():
        verdict = judge_rounding(problem, h, q)
        assert contradiction(problem, h, q, verdict, seed) is None
        seen.add(verdict.verdict)
    assert seen >= {Rounding.KEEPS, Rounding.CONSISTENT, Rounding.BREAKS}


@pytest.mark.parametrize("fault", ["gradient", "remainder"])
def test_a_fault_in_the_bound_is_seen(monkeypatch, fault):
    true = box_bound._mean_value

    def planted(*given):
        form = true(*given)
        if form is None:
            return None
        if fault == "gradient":
            gradient = Ball(-0.2 * form.by_duration.mid, 0.0 * form.by_duration.rad)
            return replace(form, by_duration=gradient)
        return replace(form, value=Ball(form.value.mid * 1.05, form.value.rad))

    monkeypatch.setattr(box_bound, "_mean_value", planted)
    found = [
        contradiction(problem, h, q, judge_rounding(problem, h, q), seed)
        for problem, h, q, seed in judged_families()
    ]
    assert any(found)


@pytest.mark.parametrize("seed", range(6))
def test_bound_is_close_to_the_least_worst_ratio(seed):
    problem, h = posed(seed, three_five_three())
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


@pytest.mark.parametrize("reading", ["durations-at-least-0.3", "durations-positive"])
def test_puma_table_3(reading):
    case = load_case("puma560-mnam-pso-353")
    low, high = case.waypoint_box(reading_id=reading)
    verdicts = []
    for claim in case.table_claims("table-3"):
        problem = case.problem(reading_id=reading)
        box = case.claim_durations(claim, reading)
        columns = list(range(6))
        if claim.joint:
            columns = [problem.joints.index(claim.joint)]
            problem = problem.joint(columns[0])
        h = RoundingBox(box.value, box.lower, box.upper)
        q = RoundingBox(problem.waypoints, low[:, columns], high[:, columns])
        verdict = judge_rounding(problem, h, q)
        assert contradiction(problem, h, q, verdict, 0) is None
        verdicts.append(verdict.verdict)
        if isinstance(verdict.exhibit, Point):
            # Not only in the box of floats: inside the printed interval itself.
            for printed, at in zip(claim.durations, verdict.exhibit.durations, strict=True):
                assert printed.interval.lower <= Fraction(float(at)) <= printed.interval.upper
            assert (verdict.exhibit.durations >= problem.duration_lower).all()
    # A plain check calls five of the six rows violated, by 0.03 to 0.04 %.
    kept, near = Rounding.KEEPS, Rounding.CONSISTENT
    assert verdicts == [near, kept, near, near, near, near, kept]


def test_palletiser():
    case = load_case("irb460-pso-353")
    verdicts = {}
    for limit in ("80", "110"):
        box = case.claim_durations(case.claim(f"durations-{limit}"), "waypoints-rad")
        problem = case.problem(f"limit-{limit}", "waypoints-rad")
        h = RoundingBox(box.value, box.lower, box.upper)
        q = RoundingBox(problem.waypoints, *case.waypoint_box(f"limit-{limit}", "waypoints-rad"))
        verdicts[limit] = judge_rounding(problem, h, q)
        assert contradiction(problem, h, q, verdicts[limit], 1) is None
    assert verdicts["80"].verdict in (Rounding.KEEPS, Rounding.CONSISTENT)
    assert verdicts["110"].verdict is Rounding.BREAKS
    place = verdicts["110"].exhibit
    assert isinstance(place, Place)
    assert (place.joint, place.quantity, place.segment) == ("5", "velocity", 1)
    assert place.lower_bound == verdicts["110"].lower_bound_of_worst
    assert 1.08 < place.lower_bound < verdicts["110"].worst_at_print


@pytest.mark.parametrize("interpolant", FAMILIES.values(), ids=FAMILIES)
def test_a_box_of_width_0_is_the_plain_check(interpolant):
    problem, h = posed(7, interpolant)
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
    problem, h = posed(seed, quintic_spline(4))
    h = 0.9 * check(problem, h).stretch * h
    wide = RoundingBox(h, 0.6 * h, 1.4 * h)
    assert judge_rounding(problem, wide).verdict is Rounding.CONSISTENT
    held = RoundingBox(h, 0.6 * h, h * (1.0 + 1e-6))
    verdict = judge_rounding(problem, held)
    assert verdict.verdict in (Rounding.CONSISTENT, Rounding.UNDECIDED)
    assert contradiction(problem, held, RoundingBox.exact(problem.waypoints), verdict, seed) is None


def test_mean_speed_decides_where_nothing_else_does():
    problem, h = posed(1, quintic_spline(4))
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
    problem, h = posed(seed, quintic_spline(3))
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
    problem, h = posed(11, three_five_three(), joints=3)
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


# --- bounds, positions, degenerate limits ---------------------------------------------------------


def test_durations_outside_their_bounds_break():
    problem, h = posed(2, three_five_three())
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
    problem, h = posed(2, three_five_three())
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
    problem, h = posed(2, three_five_three())
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
    problem, h = posed(5, quintic_spline(3))
    h = h * check(problem, h).stretch * 0.9995
    one, two = (judge_rounding(problem, *boxes(h, 5e-4, problem.waypoints, 5e-5)) for _ in "ab")
    assert one.lower_bound_of_worst == two.lower_bound_of_worst
    assert one.verdict is two.verdict


def test_bisection_tightens():
    problem, h = posed(4, three_five_three())
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
    problem, h = posed(0, three_five_three())
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
