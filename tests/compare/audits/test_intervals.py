"""Optima that an audit certifies by itself, takes from given files, or leaves out and says so."""

from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pytest
from support.findings import OwnCurve
from support.made_up import paper, row, sentence
from trajgap.compare import audit
from trajgap.compare.audits import intervals
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.audits.intervals import AuditOptions, Intervals
from trajgap.compare.audits.study import Study
from trajgap.compare.audits.waterfall import waterfalls
from trajgap.compare.blocks import Prose
from trajgap.compare.cli.audit_command import audited
from trajgap.compare.documents import AuditDocument, Why, facts
from trajgap.compare.pages.verdicts import problems_audited
from trajgap.nlp import Evidence, Outcome, Solution, Status, certificate, certify, printed_problem
from trajgap.problem import Case, parse_case

TEXT = paper(
    ["0.13 0.71 -0.42 0.37"],
    row("d", "0.9 1.4 1.1"),
    sentence("best", "optimal", "d"),
    curve={"family": "3-5-3"},
    velocity=2,
    acceleration=5,
)


@pytest.fixture(autouse=True)
def own_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    """What another curve would take costs more than the rest."""
    monkeypatch.setattr(Study, "relaxed", OwnCurve.relaxed)


def stated() -> Case:
    return parse_case(TEXT, "four-points.toml")


def distance_of(one: CaseAudit) -> Evidence:
    return next(f.evidence for f in one.findings if f.rule == "TG302" and f.claim == "d")


def test_an_audit_certifies_what_it_can() -> None:
    (one,) = audit(stated(), seeds=2).cases
    assert distance_of(one) is Evidence.CERTIFIED
    assert one.document.left_out == ()
    optimum = one.study.optimum(one.study.pairs[0])
    assert optimum.lower_bound <= optimum.best <= optimum.lower_bound * 1.01


def test_an_audit_says_the_same_with_kept_proofs(tmp_path: Path) -> None:
    day = date(2026, 1, 1)
    cold, warm = (audit(stated(), seeds=2, cache=tmp_path) for _ in range(2))
    assert cold.kept == 0 < warm.kept
    one, other = (replace(report.cases[0], day=day).document for report in (cold, warm))
    assert one.model_dump_json() == other.model_dump_json()


def test_without_time_nothing_is_certified() -> None:
    (one,) = audit(stated(), seeds=2, certify_seconds=0).cases
    assert distance_of(one) is Evidence.BEST_KNOWN
    assert one.document.left_out == ()


def test_what_the_budget_leaves_out_is_said() -> None:
    (one,) = audit(stated(), seeds=2, certify_seconds=0.1).cases
    assert distance_of(one) is Evidence.BEST_KNOWN
    (said,) = one.document.left_out
    assert said == "the optimum: no time was left"
    assert facts(one.document) == [("not certified", said)]
    (terms, *_) = problems_audited(one).blocks
    assert ("not certified", said) in terms.pairs  # page and Markdown
    shown = audited(AuditDocument(cases=(one.document,)), [stated()])
    assert Prose(f"not certified: {said}", "note") in shown


def test_boxes_are_counted_unless_seconds_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a gap that takes 100 boxes: the budget, and not the clock, says what is certified."""
    exact = printed_problem(stated().statement())
    certified = Intervals(AuditOptions())
    assert certified.interval(exact) is not None
    assert certified.left_out == []
    monkeypatch.setattr(intervals, "ALLOWANCES", 0.2)
    none = Intervals(AuditOptions())
    assert none.interval(exact) is None
    assert none.left_out == ["the optimum: no boxes were left"]


def test_a_lower_bound_alone_is_no_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = printed_problem(stated().statement())
    bounded = replace(certify(exact, gap=1e-2), outcome=Outcome.OPEN, upper=None, durations=None)
    monkeypatch.setattr(intervals, "certify", lambda *_, **__: bounded)
    none = Intervals(AuditOptions())
    assert none.interval(exact) is None
    assert none.left_out[0].startswith("the optimum, tried with ")


def test_a_given_certificate_counts_once_it_is_proved_again() -> None:
    exact = printed_problem(stated().statement())
    given = certificate(certify(exact, gap=1e-3, seconds=30))
    (one,) = audit(stated(), seeds=2, certify_seconds=0, certificates=[given]).cases
    assert distance_of(one) is Evidence.CERTIFIED
    forged = given | {"claim": given["claim"] | {"lower": given["claim"]["upper"]}}
    (one,) = audit(stated(), seeds=2, certify_seconds=0, certificates=[forged]).cases
    assert distance_of(one) is Evidence.BEST_KNOWN


def test_an_unconverged_search_is_no_step_of_a_waterfall(monkeypatch) -> None:
    study = Study(stated(), seeds=2, certify_seconds=0)
    early = Solution(study.problem(study.pairs[0]), Status.FEASIBLE, "residual 3e-01", np.ones(3))
    monkeypatch.setattr(Study, "relaxed", lambda *_: early)
    steps = {s.name: s for s in waterfalls(study)[0].steps}
    shown = steps["relaxed family"]
    assert isinstance(shown.time, Why)
    assert "did not converge (residual 3e-01)" in shown.note
    assert isinstance(steps["TOPPRA on the path of the relaxed family"].time, Why)
