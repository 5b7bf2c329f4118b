"""The readings side by side: limits, segments, fit, optimum, and what holds under all or some."""

from functools import cache
from itertools import pairwise
from math import exp, log, pi
from typing import Any

import numpy as np
import pytest
from support.documents import assert_reasons, assert_valid, plain
from support.findings import study_of, with_waterfalls
from support.made_up import TWO_UNITS, one_joint, paper, readings, row
from support.studies import shipped
from trajgap.compare.audits.case_audit import AuditReport, CaseAudit
from trajgap.compare.audits.readings import answers, holding, segments
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.study import Study
from trajgap.compare.blocks import Page
from trajgap.compare.cli.audit_command import audited
from trajgap.compare.cli.output import rendered
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
from trajgap.compare.pages.readings import side_by_side
from trajgap.compare.pages.rendering import markdown
from trajgap.nlp import Evidence
from trajgap.problem import evaluate, fit, load_case

PALLET = "irb460-pso-353"
TIMED = {"family": "uniform-cubic-b-spline", "time": "timed"}
STRETCHED = TIMED | {"time": "stretched"}
FIVE = readings(
    timed={"default": True},
    stretched={"interpolant": STRETCHED},
    tight={"limits": {"velocity": [1.7, 1.1], "acceleration": 9}},
    both={"interpolant": STRETCHED, "limits": {"velocity": 1.0, "acceleration": 4}},
    degrees={"units": {"velocity": "deg/s", "acceleration": "deg/s^2"}},
)
"""One that keeps the limits, one that jumps, and three that break them, one by far."""


def spline(durations: str = "0.80 1.10 0.90 0.95") -> str:
    points = ["0.10 0.90 -0.40 0.30 0.80", "1.00 0.20 0.70 -0.30 0.10"]
    limits: dict[str, Any] = {"velocity": 2.5, "acceleration": 14}
    return paper(points, FIVE, row("d", durations), curve=TIMED, **limits)


def summed(study: Study, claims: dict[str, str]) -> CaseAudit:
    """Readings of a case, without the slow rest of its audit.

    One claim is held under all readings, one under the first, and one under none.
    """
    waterfalls = tuple(
        Waterfall(problem=pid, reading=rid, claim=claims.get(pid), steps=())
        for pid, rid in study.pairs
    )
    held, against, lost = (
        dict.fromkeys((r.id for r in study.case.readings), verdict)
        for verdict in (ClaimVerdict.SUPPORTED, ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE)
    )
    mixed = against | dict(list(held.items())[:1])
    told: Any = {"evidence": Evidence.NONE, "why": ""}
    judged = tuple(
        Judgement(
            claim=claim, verdict=next(iter(words.values())), scope=scope, readings=words, **told
        )
        for claim, scope, words in (
            ("x", Scope.ALL, held),
            ("y", Scope.SOME, mixed),
            ("z", Scope.NO, lost),
        )
    )
    return with_waterfalls(CaseAudit(study.case, study, (), judged), waterfalls)


@cache
def five() -> CaseAudit:
    return summed(study_of(spline()), {"main": "d"})


@cache
def pallet() -> CaseAudit:
    return summed(shipped(PALLET), {"limit-80": "durations-80", "limit-110": "durations-110"})


def document_of(one: CaseAudit) -> Any:
    document = plain(AuditReport((one,)).document)
    assert_valid(document, "audit")
    assert_reasons(document)
    return document["cases"][0]


def summary_of(one: CaseAudit) -> ReadingsSummary:
    return one.readings


def test_every_reading_has_its_outcome_and_the_segments_of_a_dense_sample() -> None:
    one = five()
    found = {o.reading: o for o in summary_of(one).outcomes}
    assert {k: o.keeping for k, o in found.items()} == {
        "timed": Keeping.KEEPS, "stretched": Keeping.DISCONTINUOUS,
        "tight": Keeping.BREAKS, "both": Keeping.BREAKS, "degrees": Keeping.BREAKS,
    }  # fmt: skip
    for reading, o in found.items():
        # Three inner way-points of two joints.
        assert o.jumps == (6 if reading in ("stretched", "both") else 0)
        assert isinstance(o.gap, Gap)
        kept = o.keeping is Keeping.KEEPS
        assert o.gap.kind is (GapKind.OPTIMALITY if kept else GapKind.REPORTED)
        problem = one.case.problem(reading_id=reading)
        durations = one.case.claim_durations(one.case.claim("d"), reading).value
        trajectory = fit(problem.curve, problem.waypoints, durations)
        over = set()
        for k, (low, high) in enumerate(pairwise([0.0, *np.cumsum(durations)])):
            inside = np.concatenate([np.linspace(low, high, 82)[1:-1], [low + 1e-9, high - 1e-9]])
            for order, limit in ((1, problem.limits.velocity), (2, problem.limits.acceleration)):
                if (np.abs(trajectory(inside, order)) > limit * (1 + 1e-6)).any():
                    over.add(k)
        assert {e.segment for e in o.excesses} == over


def test_an_excess_is_over_the_limit_of_its_own_side() -> None:
    """A quintic over 0.4 rad in 1 s peaks at 15/8 · 0.4 = 0.75 rad/s, and never runs backwards."""
    text = paper([[0, 0.4]], TWO_UNITS, row("d", [1]), velocity=[[-0.5, 0.7]])
    (excess,) = summary_of(summed(study_of(text), {"main": "d"})).outcomes[0].excesses
    assert excess.ratio == pytest.approx(0.75 / 0.7)


def test_the_fit_is_the_factor_that_makes_the_printed_durations_tight() -> None:
    one = five()
    found = summary_of(one)
    factors = {fit.reading: fit.factor for fit in found.fits}
    assert list(factors.values()) == sorted(factors.values())
    for o in found.outcomes:
        durations = one.case.claim_durations(one.case.claim("d"), o.reading).value
        assert not isinstance(o.stretch, Why)
        tight = evaluate(one.case.problem(reading_id=o.reading), (durations * o.stretch)[None])
        assert tight.ratios.max() == pytest.approx(1.0, rel=1e-9)
        assert factors[o.reading] == pytest.approx(exp(abs(log(o.stretch))), rel=1e-12)
    assert found.nearest == ("timed",)


def test_the_words_call_no_reading_the_right_one() -> None:
    limits, fit = answers(summary_of(five()))
    for said in ("jumps", "broken under 3 of 5 readings (1 implausible", "28.7 % below it to"):
        assert said in limits
    assert fit.endswith("This does not say which reading was meant.")
    assert holding(summary_of(five())) == (
        "Under every reading: supported x.",
        "Under some: y (supported 1, refuted 4).",
        "Decided under none: z.",
    )


def test_the_page_has_a_row_for_each_reading() -> None:
    one = five()
    page = markdown(Page("made-up", "t", (side_by_side(one),)))
    summary = summary_of(one)
    for o in summary.outcomes:
        label = summary.labels[o.reading]
        (line,) = (x for x in page.splitlines() if x.startswith((f"| {label} |", f"| {label}<br>")))
        # What decides nothing has the word that the claim has; its jumps stand below.
        limits = "not checkable" if o.keeping is Keeping.DISCONTINUOUS else o.keeping
        jumps = f"<br>{o.jumps} velocity jumps" if o.jumps else ""
        assert f"| {limits}{jumps} |" in line
        assert f"{o.optimum:.6f} s<br>{o.evidence}" in line
        assert ("(default)" in line) == (o.reading == "timed")
    assert "segments 1, 3<br>joint 2 velocity, ratio 1.665" in page


def test_the_terminal_says_once_what_many_readings_say(monkeypatch: pytest.MonkeyPatch) -> None:
    def terminal(document: AuditDocument, width: int = 400) -> list[str]:
        monkeypatch.setenv("COLUMNS", str(width))
        return rendered(audited(document, [five().case])).splitlines()

    case = five().document
    nothing: Any = {"explanations": (), "consequences": ()}
    said = {"says": "Not shortest: 0.5 s. More of it.", "readings": ("timed", "tight", "both")}
    causes = (
        Cause(severity=Severity.ERROR, rule="TG302", claim="d", **said, **nothing),
        Cause(
            severity=Severity.WARNING, rule="TG106", claim=None, says="m", readings=(), **nothing
        ),
    )
    held, mixed = (v.model_copy(update={"claim": "d"}) for v in case.verdicts[:2])
    for verdict, beside in ((held, " all "), (mixed, "supported 1 of 5")):
        word = "supported" if verdict is held else "depends on the reading"
        one = verdict.model_copy(update={"verdict": ClaimVerdict(word)})
        changed = case.model_copy(update={"causes": causes, "verdicts": (one,)})
        lines = terminal(AuditDocument(cases=(changed,)))
        assert [line for line in lines if line.startswith(("error", "warning"))] == [
            "error TG302 [3 of 5 readings] d: Not shortest: 0.5 s. More of it.",
            "warning TG106 m.",
        ]
        (row_,) = [line for line in lines if line.startswith(f"{word} ")]
        assert beside in row_
    assert max(map(len, terminal(AuditDocument(cases=(changed,)), 80))) <= 100


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
    # In degrees the angles are π/180 of those in radians: the durations are as much too long.
    assert list(found.implausible) == ["waypoints-deg"]
    (said,) = found.implausible.values()
    # Divided by this, the durations of both columns keep their limits, one of them just so.
    stretch = max(o.stretch for o in own.values())
    assert not isinstance(stretch, Why)
    factor = f"{180 / pi / stretch:.3g}"
    assert said == f"printed durations divided by {factor} would still keep every limit"
    limits = next(one for one in answers(found) if one.startswith("durations-110"))
    assert "kept under the implausible “way-points in degrees”" in limits
    assert limits.endswith("21.4 % above it (1 implausible reading left out).")


def test_one_reading_alone_is_never_implausible_and_counts_as_one_of_all() -> None:
    claims = {"limit-80": "durations-80", "limit-110": "durations-110"}
    one = Study(load_case(PALLET), seeds=2, reading="waypoints-deg")
    assert summary_of(summed(one, claims)).implausible == {}
    other = Study(load_case(PALLET), seeds=2, reading="waypoints-rad")
    said = answers(summary_of(summed(other, claims)))
    first = "durations-80 (limit-80): the limits are kept under “way-points in radians”."
    assert said[0].startswith(first)
    assert all(answer.startswith("durations-") for answer in said)
    # Problems without printed durations have an optimum and no verdict.
    bare = summed(other, {})
    found = summary_of(bare)
    assert all(isinstance(o.keeping, Why) for o in found.outcomes)
    assert all(isinstance(o.optimum, float) and isinstance(o.gap, Why) for o in found.outcomes)
    assert answers(found) == ()
    document_of(bare)


def test_without_waypoints_the_reason_stands_in_place_of_numbers() -> None:
    one = summed(Study(load_case("z1-woa-bspline"), seeds=2), {})
    found = summary_of(one)
    assert found.outcomes == found.fits == found.nearest == ()
    (said,) = answers(found)
    words = "Limits, optimum and gap cannot be computed under any of the 14 readings"
    assert said.startswith(words)
    assert "no way-points are printed" in said
    page = markdown(Page("z1", "t", (side_by_side(one),)))
    assert all(f"| {one.case.labels[reading.id]} |" in page for reading in one.case.readings)
    assert "over-determined, 12 conditions, but only 8 control points" in page
    counts = "determined | determined, 12 conditions for 12 control points"
    assert f"| 5 | waypoints | {counts} |" in page


def test_a_single_reading_needs_no_comparison() -> None:
    text = one_joint("0, 1", "1.9496", "0.962", "within_limits")
    one = summed(study_of(text), {"main": "d"})
    assert one.readings is None
    assert document_of(one)["readings_why"] == "the case has one reading"


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
    text = one_joint("0, 1", "1.9496", time, "within_limits", TWO_UNITS)
    found = summary_of(summed(study_of(text), {"main": "d"}))
    outcome = next(o for o in found.outcomes if o.reading == "header")
    assert outcome.keeping is keeping
    assert [e.segment for e in outcome.excesses] == ([0] if keeping is Keeping.BREAKS else [])


def test_durations_that_define_no_curve_are_not_decided() -> None:
    study = study_of(spline("5 0.001 5 0.001"))
    found = {o.reading: o for o in summary_of(summed(study, {"main": "d"})).outcomes}
    outcome = found["timed"]
    assert outcome.keeping is Keeping.UNDECIDED
    assert outcome.excesses == ()
    assert isinstance(outcome.stretch, Why)
    said = [f.message for f in judge_motions(study) if f.reading == "timed"]
    assert "the printed durations define no curve" in said[0]


def test_the_document_carries_every_number() -> None:
    for one in (pallet(), five()):
        shown, found = document_of(one)["readings"], summary_of(one)
        assert shown["answers"] == list(answers(found))
        assert shown["holding"] == list(holding(found))
        fits = [(fit.reading, fit.factor) for fit in found.fits]
        assert [(f["reading"], f["factor"]) for f in shown["fits"]] == fits
        for own, outcome in zip(shown["outcomes"], found.outcomes, strict=True):
            assert own["keeping"] == outcome.keeping
            assert own["optimum"] == outcome.optimum
            assert [e["segment"] for e in own["excesses"]] == [e.segment for e in outcome.excesses]
            assert own["gap"]["lowest"] == outcome.gap.lowest
    y = shown["claims"][1]
    assert (y["claim"], y["scope"], y["readings"]) == ("y", "some", {"supported": 1, "refuted": 4})


@pytest.mark.parametrize(
    ("numbers", "words"),
    [((0,), "1"), ((0, 1), "1, 2"), ((0, 1, 2, 4, 6, 7, 8, 9), "1–3, 5, 7–10"), ((), "")],
)
def test_runs_of_segments_are_drawn_together(numbers: tuple[int, ...], words: str) -> None:
    given = {"joint": "1", "quantity": Limited.VELOCITY, "ratio": 2.0}
    assert segments([Excess(segment=n, **given) for n in numbers]) == words
