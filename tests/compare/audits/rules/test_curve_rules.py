"""Rules and rounding proofs on the B-spline cases: control vertices, jumps, cases without table."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
import pytest
from support.b_splines import NATURAL, uniform
from support.findings import judged, said_of, study_of
from support.made_up import claim, paper, readings, row, sentence
from support.papers.motions import vertices as solved
from support.studies import changed, shipped
from trajgap.compare.audits import Pair, PrintedRow
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.open_points import list_open_points
from trajgap.compare.audits.rules.stated_curve import judge_vertices, vertices
from trajgap.compare.documents import Basis, ClaimVerdict, Finding, Severity
from trajgap.nlp.enclosure.balls import Ball
from trajgap.nlp.enclosure.uniform import centred_stretched, centred_timed
from trajgap.problem import extrema, fit, load_case, peak_gradients

POLISH, WHALE = "irb1600-ga-cubic-bspline", "z1-woa-bspline"
TIMES = ("stretched", "timed")
STRETCHED = {"family": "uniform-cubic-b-spline", "time": "stretched"}
CLAMPED = {
    "family": "clamped-b-spline",
    "degree": 3,
    "knots": "averaged-continued",
    "end_orders": [1],
    "parameters": "chord",
    "time": "timed",
}


def of(findings, rule: str, claim: str | None = None) -> list[Finding]:
    return [f for f in findings if f.rule == rule and (claim is None or f.claim == claim)]


def vertices_on(curve: dict[str, Any], *more: str) -> list[Finding]:
    """Of four way-points, and vertices that are those of no uniform cubic B-spline."""
    own = ["0.1", "0.2", "1.5", "-0.8", "0.6", "0.7"]
    stated = claim("v", "control_vertices", joint_rows=[own])
    text = paper(["0.1 1.2 -0.4 0.7"], stated, *more, curve=curve, velocity=3)
    return judged(study_of(text), "TG205")


def test_every_printed_control_vertex_is_inside_what_rounding_allows() -> None:
    study = shipped(POLISH)
    (found,) = judged(study, "TG205")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert found.computed == "72 of 72 inside"
    every = vertices(study.case.claim("control-vertices"), study.case.statement())
    # Half a digit of W through the inverse, at most 3 times, plus half a digit of V.
    assert max(v.width for v in every) <= Fraction(2, 10**4)
    assert max(v.width for v in every) > Fraction(199, 10**6)
    w = load_case(POLISH).problem().waypoints
    computed = solved(w).T.ravel()
    middle = [float(v.allowed.lower + v.allowed.upper) / 2 for v in every]
    np.testing.assert_allclose(middle, computed, rtol=0, atol=1e-12)
    off = np.abs(computed - [v.printed.value for v in every])
    assert off.max() == pytest.approx(1.2434e-4, abs=1e-8)


@pytest.mark.parametrize(
    ("printed", "verdict", "severity"),
    [
        ("-2.1069", ClaimVerdict.SUPPORTED, Severity.INFO),
        ("-2.1068", ClaimVerdict.SUPPORTED, Severity.WARNING),
        ("-2.1072", ClaimVerdict.SUPPORTED, Severity.INFO),
        ("-2.1065", ClaimVerdict.REFUTED, Severity.ERROR),
        ("-2.1073", ClaimVerdict.REFUTED, Severity.ERROR),
    ],
)
def test_one_changed_digit_is_seen_where_neither_rounding_nor_cutting_explains_it(
    printed: str, verdict: ClaimVerdict, severity: Severity
) -> None:
    (found,) = judged(changed(POLISH, ('"-2.1070"', f'"{printed}"')), "TG205")
    assert (found.verdict, found.severity) == (verdict, severity)
    if severity is Severity.WARNING:
        assert "(V2 of joint 2)" in found.message
    if verdict is ClaimVerdict.REFUTED:
        assert found.message.startswith("1 of 72 printed control vertices lie outside")
        assert f"V2 of joint 2 printed {printed}, allowed -2.107" in found.message


@pytest.mark.parametrize(
    ("curve", "verdict"),
    [
        ({"family": "3-5-3"}, ClaimVerdict.NOT_CHECKABLE),
        (CLAMPED, ClaimVerdict.NOT_CHECKABLE),
        (STRETCHED, ClaimVerdict.REFUTED),
    ],
)
def test_vertices_of_another_curve_are_not_held_to_the_uniform_splines(
    curve: dict[str, Any], verdict: ClaimVerdict
) -> None:
    """A clamped spline has two vertices more than way-points as well, and other ones."""
    (found,) = vertices_on(curve)
    assert found.verdict is verdict
    assert (found.severity is Severity.ERROR) is (verdict is ClaimVerdict.REFUTED)
    # Under readings with several curves, each is judged by its own.
    both = readings(uniform={"default": True}, other={"interpolant": curve})
    words = {f.reading: f.verdict for f in vertices_on(STRETCHED, both)}
    one = {None: ClaimVerdict.REFUTED}
    apart = {"uniform": ClaimVerdict.REFUTED, "other": verdict}
    assert words == (one if curve is STRETCHED else apart)


@pytest.mark.parametrize("time", [*TIMES, NATURAL])
def test_balls_hold_values_and_gradients_all_over_the_box(time: str) -> None:
    problem, h = uniform(time, 41, count=5)
    curve, q = problem.curve, problem.waypoints
    trajectory = fit(curve, q, h)
    own = {"stretched": (centred_stretched, 3), NATURAL: (partial(centred_timed, natural=True), 2)}
    centred, highest = own.get(time, (centred_timed, 2))
    orders = range(1, highest + 1)
    points = [e for j in range(3) for r in orders for e in extrema(trajectory, j, r)]
    names = ("joint", "segment", "order")
    joint, segment, order = (np.array([getattr(e, key) for e in points]) for key in names)
    place = np.array([e.s for e in points])
    wide_h, wide_q = Ball(h, 0.01 * h), Ball(q, np.full_like(q, 5e-5))
    form = centred(len(q), joint, segment, order, place, wide_h, wide_q)
    exact = np.array([e.value for e in points])
    np.testing.assert_allclose(form.value.mid, exact, rtol=1e-9, atol=1e-12)
    assert (np.abs(form.value.mid - exact) <= form.value.rad + 1e-11 * form.amplitude).all()
    assert (form.amplitude >= np.abs(exact) * (1 - 1e-12)).all()
    rng = np.random.default_rng(0)
    for _ in range(20):
        there = h * (1 + 0.01 * rng.uniform(-1, 1, h.size))
        moved = q + 5e-5 * rng.uniform(-1, 1, q.shape)
        at = fit(curve, moved, there)
        values = [float(at.values(e.segment, e.joint, e.order, np.array([e.s]))[0]) for e in points]
        fixed = [replace(e, value=v) for e, v in zip(points, values, strict=True)]
        slope = peak_gradients(replace(problem, waypoints=moved), there, fixed).durations
        excess = np.abs(slope - form.by_duration.mid) - form.by_duration.rad
        assert (excess <= 1e-9 * np.abs(slope).max()).all()
    central = peak_gradients(problem, h, points)
    np.testing.assert_allclose(form.by_waypoint.mid, central.waypoints, rtol=1e-9, atol=1e-11)


@pytest.fixture(scope="module")
def motions() -> list[Finding]:
    return list(judge_motions(shipped(POLISH)))


def test_jumps_are_named_apart_from_the_limits(motions: list[Finding]) -> None:
    jumping = of(motions, "TG202", "after")
    assert {f.reading.rpartition("-")[2] for f in jumping} == {"stretched"}
    assert len(jumping) == 9
    assert not any(f.decides for f in jumping)
    assert all("velocity jumps 48 times" in f.message for f in jumping)
    assert not of(motions, "TG202", "before")
    limits = {f.reading: f for f in of(motions, "TG201", "after")}
    kept = limits["angles-deg-v-rad-a-rad-stretched"]
    assert kept.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "inside the segments, but the velocity jumps 48" in kept.message
    statement = {f.reading: f for f in of(motions, "TG201", "limits-kept")}
    assert "velocity jumps 48" in statement["angles-deg-v-rad-a-rad-stretched"].message
    assert limits["angles-deg-v-rad-a-rad-timed"].verdict is ClaimVerdict.SUPPORTED
    assert sum(f.verdict is ClaimVerdict.REFUTED for f in limits.values()) == 13
    # Nothing in the paper says that the equal durations before the optimisation keep them.
    assert not any(f.decides for f in of(motions, "TG201", "before"))


FEW = (
    "angles-deg-v-rad-a-rad-timed",
    "angles-deg-v-rad-a-rad-stretched",
    "angles-rad-v-rad-a-deg-stretched",
    "angles-rad-v-deg-a-deg-stretched",
)
"""A solve takes a second or two: readings of both kinds, as printed and below the optimum."""


def test_the_printed_durations_are_optimal_under_no_reading() -> None:
    """Under each, a shorter motion is exhibited, or no rounding lets them keep the limits."""
    study = shipped(POLISH)
    assert len(study.readings) == 19
    claim = study.case.claim("time-optimal")
    for reading in FEW:
        own = study.only(claim, pair=Pair("nine-segments", reading))
        (found,) = of(judge_distances(own), "TG302")
        assert found.verdict is ClaimVerdict.REFUTED
        # Angles in radians under limits in degrees: the printed total lies below the optimum.
        if reading.startswith("angles-rad-v-rad-a-deg") or "v-deg" in reading:
            assert found.message.startswith("The printed motion breaks a limit. Table 4")
            assert found.basis is Basis.ENCLOSURE
        else:
            said = "Not the shortest, however the digits were rounded: Table 4"
            assert found.message.startswith(said)
            jumps = "whose velocity may jump at the via-points" in found.message
            assert jumps == reading.endswith("stretched")


def test_a_stretched_curve_is_smooth_only_with_the_proportions_of_its_chords() -> None:
    """Of ways of 1.001 and 2 rad, whose proportions no two decimals state."""
    curve = CLAMPED | {"time": "stretched"}
    for times, kind in (("0.50 1.00", "may be smooth"), ("0.75 0.75", "jumps")):
        parts = row("d", times), sentence("s", "continuous", "d")
        text = paper([[0, 1.001, 3.001]], *parts, curve=curve, velocity=9)
        (found,) = said_of(study_of(text), "s", "TG202")
        assert found.kind == kind


@pytest.mark.parametrize(
    ("named", "word"),
    [
        ({}, "not checkable"),
        ({"derivative": "velocity"}, "supported"),
        ({"derivative": "acceleration"}, "inconsistent"),
    ],
)
def test_a_jump_of_acceleration_contradicts_what_names_it(named: dict[str, str], word: str) -> None:
    """Cubics that rest at each way-point: the acceleration of both sides has opposite signs."""
    parts = row("d", "1.00 1.00"), sentence("s", "continuous", "d", **named)
    text = paper([[0, 1, 2]], *parts, curve={"family": "rest-to-rest", "degree": 3}, velocity=9)
    (found,) = said_of(study_of(text), "s", "TG202")
    assert found.verdict == word


def test_acceleration_said_to_jump_does_in_the_stretched_reading(motions: list[Finding]) -> None:
    found = {f.reading: f for f in of(motions, "TG206", "acceleration-jumps")}
    assert len(found) == 19
    for reading, one in found.items():
        jumps = reading.endswith("stretched")
        assert one.verdict == ("supported" if jumps else "not checkable")
    study = shipped(POLISH)
    stretched = "angles-rad-v-rad-a-rad-stretched"
    at = PrintedRow(study, study.case.claim("after"), Pair("nine-segments", stretched)).check.jumps
    largest = max((j for j in at if j.order == 2 and j.joint == "2"), key=lambda j: abs(j.size))
    assert f"by {largest.size:.6g} rad/s²" in found[stretched].message


def test_a_case_without_waypoints_says_of_each_time_why_it_is_not_checkable() -> None:
    study = shipped(WHALE)
    assert not study.has_problems
    found = list(list_open_points(study))
    for name in ("b-spline-total", "quintic-total", "convergence"):
        (one,) = of(found, "TG501", name)
        assert one.verdict is ClaimVerdict.NOT_CHECKABLE
        assert "Without the way-points, nothing can be computed" in one.message
    assert not of(found, "TG501", "improvement")
    assert not list(judge_vertices(study))
    (improvement,) = said_of(study, "improvement", "TG103")
    assert improvement.verdict is ClaimVerdict.NOT_CHECKABLE
    # A case with problems has no such finding.
    assert shipped(POLISH).has_problems
    assert not of(list_open_points(shipped(POLISH)), "TG501", "after")
