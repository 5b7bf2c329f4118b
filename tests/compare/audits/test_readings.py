"""The readings side by side: limits, segments, fit, optimum, and what holds under all or some."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from math import exp, log, pi
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from support.documents import assert_reasons, assert_valid, plain
from support.one_joint import UNITS, one_joint
from support.studies import changed, shipped
from trajgap.compare.audits.case_audit import AuditReport, CaseAudit
from trajgap.compare.audits.reading_words import answers, holding, segments
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.study import Study
from trajgap.compare.cli.auditing import audited
from trajgap.compare.documents import (
    AuditDocument,
    Cause,
    ClaimVerdict,
    Excess,
    Gap,
    GapKind,
    Judgement,
    Keeping,
    Limited,
    ReadingsSummary,
    Scope,
    Severity,
    Waterfall,
    Why,
)
from trajgap.compare.pages.blocks import Page
from trajgap.compare.pages.markdown_text import markdown
from trajgap.compare.pages.readings import side_by_side
from trajgap.nlp import Evidence
from trajgap.problem import Case, Problem, evaluate, fit, load_case, parse_case

POLISH, WHALE, PALLET = "irb1600-ga-cubic-bspline", "z1-woa-bspline", "irb460-pso-353"


def summed(case: Case, claims: dict[str, str], reading: str | None = None) -> CaseAudit:
    """Readings of a case, without the slow rest of its audit."""
    return case_audit(Study(case, seeds=2, reading=reading), claims)


def case_audit(study: Study, claims: dict[str, str]) -> CaseAudit:
    """One claim held under all readings, one under the first, and one under none."""
    waterfalls = tuple(
        Waterfall(problem=pid, reading=rid, claim=claims.get(pid), steps=())
        for pid, rid in study.pairs
    )
    held, against, lost = (
        dict.fromkeys((r.id for r in study.case.readings), verdict)
        for verdict in (ClaimVerdict.SUPPORTED, ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE)
    )
    mixed = against | dict(list(held.items())[:1])
    judged = tuple(
        Judgement(
            claim=claim,
            verdict=next(iter(words.values())),
            scope=scope,
            evidence=Evidence.NONE,
            why="",
            readings=words,
        )
        for claim, scope, words in (
            ("x", Scope.ALL, held),
            ("y", Scope.SOME, mixed),
            ("z", Scope.NO, lost),
        )
    )
    return CaseAudit(study.case, study, (), judged, made_waterfalls=waterfalls)


@cache
def polish() -> CaseAudit:
    return case_audit(shipped(POLISH), {"nine-segments": "after"})


@cache
def pallet() -> CaseAudit:
    return case_audit(shipped(PALLET), {"limit-80": "durations-80", "limit-110": "durations-110"})


def summary_of(one: CaseAudit) -> ReadingsSummary:
    assert one.readings is not None
    return one.readings


# --- the polishing paper --------------------------------------------------------------------------


@pytest.mark.slow
def test_every_unit_mix_of_the_polishing_paper_has_its_outcome() -> None:
    found = {o.reading: o for o in summary_of(polish()).outcomes}
    assert len(found) == 19
    under = {k: {r for r, o in found.items() if o.keeping is k} for k in Keeping}
    literal = {
        "angles-deg-v-rad-a-rad",
        "angles-deg-v-deg-a-rad",
        "angles-modulo-2pi-v-rad-a-rad",
    }
    assert under[Keeping.KEEPS] == {f"{r}-timed" for r in literal}
    assert under[Keeping.DISCONTINUOUS] == {f"{r}-stretched" for r in literal}
    assert len(under[Keeping.BREAKS]) == 13
    for reading, o in found.items():
        assert o.jumps == (48 if reading.endswith("stretched") else 0)
        assert bool(o.excesses) == (o.keeping is Keeping.BREAKS)
        assert isinstance(o.gap, Gap)
        kept = o.keeping is Keeping.KEEPS
        assert o.gap.kind is (GapKind.OPTIMALITY if kept else GapKind.REPORTED)


def printed(one: CaseAudit, reading: str) -> tuple[Problem, np.ndarray]:
    """The problem under a reading, and the durations after the optimisation."""
    durations = one.case.claim_durations(one.case.claim("after"), reading).value
    return one.case.problem(reading_id=reading), durations


@pytest.mark.slow
def test_segments_over_a_limit_are_those_of_a_dense_sample() -> None:
    one = polish()
    for outcome in summary_of(one).outcomes:
        if outcome.keeping is not Keeping.BREAKS:
            continue
        problem, durations = printed(one, outcome.reading)
        trajectory = fit(problem.curve, problem.waypoints, durations)
        over = set()
        for k, (low, high) in enumerate(pairwise([0.0, *np.cumsum(durations)])):
            inside = np.concatenate([np.linspace(low, high, 82)[1:-1], [low + 1e-9, high - 1e-9]])
            for order, limit in ((1, problem.limits.velocity), (2, problem.limits.acceleration)):
                if (np.abs(trajectory(inside, order)) > limit * (1 + 1e-6)).any():
                    over.add(k)
        assert {e.segment for e in outcome.excesses} == over


@pytest.mark.slow
def test_the_fit_is_the_factor_that_makes_the_printed_durations_tight() -> None:
    one = polish()
    found = summary_of(one)
    factors = {fit.reading: fit.factor for fit in found.fits}
    assert len(factors) == 19
    assert list(factors.values()) == sorted(factors.values())
    for outcome in found.outcomes:
        problem, durations = printed(one, outcome.reading)
        assert not isinstance(outcome.stretch, Why)
        ratios = evaluate(problem, (durations * outcome.stretch)[None]).ratios
        assert ratios.max() == pytest.approx(1.0, rel=1e-9)
        factor = exp(abs(log(outcome.stretch)))
        assert factors[outcome.reading] == pytest.approx(factor, rel=1e-12)
    # One unit throughout poses one question, whatever the unit.
    alike = ("rad-v-rad-a-rad", "deg-v-rad-a-deg", "deg-v-deg-a-deg")
    assert set(found.nearest) == {f"angles-{x}-timed" for x in alike}
    assert factors[found.nearest[0]] == pytest.approx(1.0852, abs=1e-4)


@pytest.mark.slow
def test_the_words_call_no_reading_the_right_one() -> None:
    limits, fit = answers(summary_of(polish()))
    for said in ("kept under 3 of 19 readings", "broken under 13 of 19", "2.09 to 12.8 times as"):
        assert said in limits
    assert fit.endswith("This does not say which reading was meant.")
    assert holding(summary_of(polish())) == (
        "Under every reading: supported x.",
        "Under some: y (supported 1, refuted 18).",
        "Decided under none: z.",
    )


# --- the other papers -----------------------------------------------------------------------------


def test_two_problems_of_one_reading_are_measured_by_the_worse() -> None:
    found = summary_of(pallet())
    best, other = found.fits
    assert (best.reading, other.reading) == ("waypoints-rad", "waypoints-deg")
    own = {o.problem: o for o in found.outcomes if o.reading == best.reading}
    assert own["limit-110"].stretch == pytest.approx(best.factor)
    assert own["limit-80"].keeping is Keeping.KEEPS
    assert [e.segment for e in own["limit-110"].excesses] == [1]
    assert own["limit-110"].excesses[0].quantity == "velocity"
    assert other.factor == pytest.approx(180 / pi / own["limit-80"].stretch, rel=1e-6)


def test_a_reading_far_from_the_limits_is_named_as_implausible_and_stands_last() -> None:
    """In degrees the angles are π/180 of those in radians: the durations are as much too long."""
    found = summary_of(pallet())
    assert list(found.implausible) == ["waypoints-deg"]
    (said,) = found.implausible.values()
    # Divided by this, the durations of both columns keep their limits, one of them just so.
    stretch = max(o.stretch for o in found.outcomes if o.reading == "waypoints-rad")
    assert not isinstance(stretch, Why)
    assert said == (
        f"printed durations divided by {180 / pi / stretch:.3g} would still keep every limit"
    )
    limits = next(one for one in answers(found) if one.startswith("durations-110"))
    assert "kept under the implausible “way-points in degrees”" in limits
    assert limits.endswith("21.4 % above it (1 implausible reading left out).")


def test_one_reading_alone_is_never_implausible() -> None:
    one = summed(load_case(PALLET), {"limit-80": "durations-80"}, reading="waypoints-deg")
    assert summary_of(one).implausible == {}


def test_without_waypoints_the_reason_stands_in_place_of_numbers() -> None:
    one = summed(load_case(WHALE), {})
    found = summary_of(one)
    assert found.outcomes == found.fits == found.nearest == ()
    (said,) = answers(found)
    assert said.startswith(f"Under none of {len(one.case.readings)} readings can limits")
    assert "no way-points are printed" in said
    page = markdown(Page("z1", "t", (side_by_side(one),)))
    assert all(f"| {one.case.labels[reading.id]} |" in page for reading in one.case.readings)
    assert "over-determined, 12 conditions, but only 8 control points" in page
    assert (
        "| 5 | waypoints | determined | determined, 12 conditions for 12 control points |" in page
    )


def test_a_single_reading_needs_no_comparison() -> None:
    text = one_joint("0, 1", "1.9496", "0.962", "within_limits")
    one = summed(parse_case(text, "fair.toml"), {"main": "d"})
    assert one.readings is None
    document = plain(AuditReport((one,)).document)
    assert_valid(document, "audit")
    assert document["cases"][0]["readings_why"] == "the case has one reading"


@pytest.mark.parametrize(
    ("time", "keeping"),
    [
        ("0.962", Keeping.KEEPS),
        ("0.9617", Keeping.CONSISTENT),
        ("0.961", Keeping.CONSISTENT),
        ("0.960", Keeping.BREAKS),
    ],
)
def test_digits_rounded_or_cut_off_are_given_their_due(time: str, keeping: Keeping) -> None:
    """The shortest time is 0.961736 s: 0.961 is its digits cut off."""
    text = one_joint("0, 1", "1.9496", time, "within_limits", UNITS)
    found = summary_of(summed(parse_case(text, "fair.toml"), {"main": "d"}))
    outcome = next(o for o in found.outcomes if o.reading == "header")
    assert outcome.keeping is keeping
    assert [e.segment for e in outcome.excesses] == ([0] if keeping is Keeping.BREAKS else [])


def test_a_problem_without_printed_durations_has_an_optimum_and_no_verdict() -> None:
    one = summed(load_case(PALLET), {}, reading="waypoints-rad")
    found = summary_of(one)
    assert all(isinstance(o.keeping, Why) for o in found.outcomes)
    assert all(isinstance(o.optimum, float) and isinstance(o.gap, Why) for o in found.outcomes)
    assert answers(found) == ()
    document = plain(AuditReport((one,)).document)
    assert_valid(document, "audit")
    assert_reasons(document)


def test_a_selected_reading_counts_as_one_of_all() -> None:
    claims = {"limit-80": "durations-80", "limit-110": "durations-110"}
    found = summary_of(summed(load_case(PALLET), claims, reading="waypoints-rad"))
    assert answers(found)[0].startswith(
        "durations-80 (limit-80): the limits are kept under “way-points in radians”."
    )
    assert all(answer.startswith("durations-") for answer in answers(found))


def test_durations_that_define_no_curve_are_not_decided() -> None:
    printed = """"0.66", "0.82", "0.70", "0.68", "0.74", "0.78", "0.84", "0.86", "0.73"]
total = "6.81\""""
    hasty = '"5", "0.01", "5", "0.01", "5", "0.01", "5", "0.01", "5"]'
    case = changed(POLISH, (printed, hasty)).case
    study = Study(case, seeds=2, reading="angles-deg-v-rad-a-rad-timed")
    (outcome,) = summary_of(case_audit(study, {"nine-segments": "after"})).outcomes
    assert outcome.keeping is Keeping.UNDECIDED
    assert outcome.excesses == ()
    assert isinstance(outcome.stretch, Why)
    found = [f for f in judge_motions(study) if f.claim == "after"]
    assert "the printed durations define no curve" in found[0].message


# --- documents and pages --------------------------------------------------------------------------


@pytest.mark.parametrize("made", [pallet, pytest.param(polish, marks=pytest.mark.slow)])
def test_the_document_carries_every_number(made: Callable[[], CaseAudit]) -> None:
    one = made()
    document = plain(AuditReport((one,)).document)
    assert_valid(document, "audit")
    assert_reasons(document)
    shown = document["cases"][0]["readings"]
    assert json.loads(json.dumps(shown, allow_nan=False)) == shown
    found = summary_of(one)
    assert shown["answers"] == list(answers(found))
    assert shown["holding"] == list(holding(found))
    assert [(f["reading"], f["factor"]) for f in shown["fits"]] == [
        (fit.reading, fit.factor) for fit in found.fits
    ]
    for own, outcome in zip(shown["outcomes"], found.outcomes, strict=True):
        assert own["keeping"] == outcome.keeping
        assert own["optimum"] == outcome.optimum
        assert [e["segment"] for e in own["excesses"]] == [e.segment for e in outcome.excesses]
        assert own["gap"]["lowest"] == outcome.gap.lowest
    if made is pallet:
        return
    y = shown["claims"][1]
    assert (y["claim"], y["scope"], y["readings"]) == ("y", "some", {"supported": 1, "refuted": 18})


@pytest.mark.slow
def test_the_page_has_a_row_for_each_reading() -> None:
    one = polish()
    page = markdown(Page("irb1600", "t", (side_by_side(one),)))
    summary = summary_of(one)
    for outcome in summary.outcomes:
        label = summary.labels[outcome.reading]
        (line,) = [
            x
            for x in page.splitlines()
            # One label may begin with another.
            if x.startswith((f"| {label} |", f"| {label}<br>"))
        ]
        # What decides nothing has the word that the claim has; its jumps stand below.
        open_ones = (Keeping.DISCONTINUOUS, Keeping.UNDECIDED)
        limits = "not checkable" if outcome.keeping in open_ones else outcome.keeping
        jumps = f"<br>{outcome.jumps} velocity jumps" if outcome.jumps else ""
        assert f"| {limits}{jumps} |" in line
        assert f"{outcome.optimum:.6f} s<br>{outcome.evidence}" in line
        assert ("(default)" in line) == (outcome.reading == one.case.default_reading.id)
    assert "segments 1–4, 6–9<br>joint 6 velocity, ratio 15.25" in page
    assert {Keeping.BREAKS, Keeping.DISCONTINUOUS} <= {o.keeping for o in summary.outcomes}


def terminal(document: AuditDocument, case: Case, width: int = 400) -> list[str]:
    out = io.StringIO()
    console = Console(file=out, width=width)
    for part in audited(document, [case]):
        console.print(part)
    return [line.rstrip() for line in out.getvalue().splitlines()]


@pytest.mark.slow
def test_the_terminal_says_once_what_many_readings_say() -> None:
    case = polish().document
    asked = polish().case
    assert isinstance(case.readings, ReadingsSummary)
    readings = case.readings.admissible
    one, other = case.claims[:2]
    nothing: Any = {"explanations": (), "consequences": ()}
    said = "Not shortest: 0.5 s. More of it."
    error = {"rule": "TG302", "claim": one.claim, "says": said, "readings": readings[:3]}
    other_ = {"rule": "TG106", "claim": None, "says": "m", "readings": ()}
    causes = (
        Cause(severity=Severity.ERROR, **error, **nothing),
        Cause(severity=Severity.WARNING, **other_, **nothing),
    )
    held, mixed = (v.model_copy(update={"claim": c.claim}) for v, c in zip(
        case.verdicts[:2], (one, other), strict=True))  # fmt: skip
    mixed = mixed.model_copy(update={"verdict": ClaimVerdict.DEPENDS})
    changed = case.model_copy(update={"causes": causes, "verdicts": (held, mixed)})
    document = AuditDocument(cases=(changed,))
    lines = terminal(document, asked)
    assert [line for line in lines if line.startswith(("error", "warning"))] == [
        f"error TG302 [3 of 19 readings] {one.where}: Not shortest: 0.5 s. More of it.",
        "warning TG106 m.",
    ]
    (row,) = [line for line in lines if line.startswith("depends on the reading ")]
    assert "supported 1 of 19" in row
    (row,) = [line for line in lines if line.startswith("supported ")]
    assert " all " in row
    assert max(map(len, terminal(document, asked, 80))) <= 100


@pytest.mark.parametrize(
    ("numbers", "words"),
    [((0,), "1"), ((0, 1), "1, 2"), ((0, 1, 2, 4, 6, 7, 8, 9), "1–3, 5, 7–10"), ((), "")],
)
def test_runs_of_segments_are_drawn_together(numbers: tuple[int, ...], words: str) -> None:
    given = {"joint": "1", "quantity": Limited.VELOCITY, "ratio": 2.0}
    assert segments([Excess(segment=n, **given) for n in numbers]) == words
