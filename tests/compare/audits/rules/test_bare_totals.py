"""Tests of printed totals: what proves them, what excludes them, and what accuses nobody."""

from __future__ import annotations

from typing import Any

import pytest
from support.findings import audited_text, said_of, study_of
from support.made_up import algorithms, entry, gain, one_joint, paper, row, sentence, total
from trajgap.compare.audits import study as study_module
from trajgap.compare.audits.card_errors import plainly
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.rounding import RoundingBox
from trajgap.compare.audits.study import Study
from trajgap.compare.audits.total_bound import excludes_total
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, rest_to_rest, three_five_three


def bare(value: str, checks: str, points: str = "0, 1") -> Study:
    """A total, what is said of it, and a rival's that is twice as long; 0.98684 s are needed."""
    tail = (
        total("t", value)
        + sentence("said", checks, "t")
        + total("before", f"{2 * float(value):.3f}", algorithm="other")
        + gain("before", "t", percent="50")
        + algorithms("other")
    )
    return study_of(one_joint(points, "1.9", "0.99", "optimal", tail))


@pytest.mark.parametrize(
    ("points", "value", "checks", "verdict"),
    [
        ("0, 1", "5.35", "optimal", "refuted"),  # 442 % above
        ("0, 1", "0.690", "optimal", "refuted"),  # 0.7 of it
        ("0, 1", "0.987", "optimal", "supported"),
        ("0, 1", "0.690", "within_limits", "refuted"),
        ("0, 1", "0.986", "within_limits", "not checkable"),  # 0.98684 cut off
        ("0, 1", "5.35", "within_limits", "not checkable"),
        ('"0.00", "1.00"', "0.690", "optimal", "refuted"),
        ('"0.00", "1.00"', "0.690", "within_limits", "refuted"),
        ('"0.00", "1.00"', "0.975", "within_limits", "not checkable"),  # 0.99 rad takes 0.977 s
        ('"0.00", "1.00"', "0.999", "optimal", "not checkable"),  # 1.01 rad, cut off, takes it
        ('"0.00", "1.00"', "1.020", "optimal", "refuted"),
        ('"0.00", "1.00"', "0.990", "optimal", "not checkable"),
    ],
)
def test_a_bare_total_is_judged(points: str, value: str, checks: str, verdict: str) -> None:
    study = bare(value, checks, points)
    id_ = {"optimal": "TG302", "within_limits": "TG201"}[checks]
    (found,) = said_of(study, "said", id_)
    assert found.verdict == verdict
    # A total is refuted where no motion is so short, never for being long.
    short = verdict == "refuted" and value == "0.690"
    judged = {one.claim: one for one in audit_case(study).judgements}
    assert (judged["t"].verdict == "refuted") == short
    assert ("takes 0.690 s or less" in judged["t"].why) == short
    # The percentage follows from both totals, and from a refuted one nothing follows.
    assert judged["gain"].verdict == ("not checkable" if short else "supported")


def test_no_total_is_excluded_that_a_motion_takes() -> None:
    """Three pieces under a velocity limit: the proof holds well below the optimum, never at it."""
    limits = Limits(velocity=1.7, joints=1)
    problem = Problem([[0.1], [0.9], [-0.3], [0.5]], limits, three_five_three())
    best = solve(problem, prove=0).total_time
    assert excludes_total(problem, 0.4 * best) is True
    assert not excludes_total(problem, best, boxes=100)
    wide = RoundingBox(problem.waypoints, problem.waypoints - 0.05, problem.waypoints + 0.05)
    assert excludes_total(problem, 0.3 * best, wide)
    # A proof that would need more boxes says nothing.
    assert excludes_total(problem, 0.4 * best, boxes=4) is None
    still = Problem([[0.0], [1.0]], Limits(acceleration=1.0, joints=1), rest_to_rest(1, 5))
    assert not excludes_total(still, 0.01)  # no speed bounds a duration: nothing is proved


def test_what_would_take_more_boxes_to_exclude_is_said_and_accuses_nobody(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(study_module, "excludes_total", lambda *_: None)
    study = bare("0.7", "within_limits")
    (found,) = said_of(study, "said", "TG201")
    assert found.verdict == "not checkable"
    (left,) = study.intervals.left_out
    assert left == "whether any motion takes 0.7 s or less, tried with 1000 boxes"


def test_a_total_that_a_known_motion_takes_is_never_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> bool:
        raise AssertionError("a proof was tried that cannot succeed")

    monkeypatch.setattr(study_module, "excludes_total", never)
    (found,) = said_of(bare("1.2", "within_limits"), "said", "TG201")
    assert found.verdict == "not checkable"


TABLES = algorithms("new", "old") + "".join(
    entry("tables", id=f"table-{k}", where=f"Table {k}", title="an experiment") for k in (2, 6)
)
NEW, OLD = {"algorithm": "new"}, {"algorithm": "old"}
STRAIGHT = {"other_curve": "straight lines"}


@pytest.mark.parametrize(
    ("own", "other", "more", "severity"),
    [
        ({}, {}, "", Severity.WARNING),
        (NEW, NEW, "", Severity.WARNING),
        ({"table": "table-2"}, {"printed_tables": ["table-2"]}, "", Severity.ERROR),
        ({}, {"of": "d"}, "", Severity.ERROR),
        # A rival's: of a method that the text names, or that the total's place leaves out.
        (OLD, {}, "", None),
        (OLD, NEW, "", None),
        (OLD, NEW | {"of": "d"}, "", None),
        ({}, {}, gain("t", "d", percent="24.4"), None),
        # Another curve's.
        (STRAIGHT, {}, "", None),
        ({}, STRAIGHT | {"of": "d"}, "", None),
        # Another experiment's, of the same method.
        (NEW | {"table": "table-2"}, NEW | {"table": "table-6"}, "", None),
        ({"state": "before"}, {}, "", None),
        ({"coupling": "per-joint"}, {"coupling": "shared"}, "", None),
        # It may be the total of either row, or the mean of many runs.
        (NEW, NEW, row("e", "0.8", algorithm="new"), None),
        ({}, NEW, total("best", "0.990", algorithm="new"), None),
    ],
)
def test_two_totals_that_the_file_keeps_apart_contradict_nothing(
    own: dict[str, Any], other: dict[str, Any], more: str, severity: Severity | None
) -> None:
    parts = row("d", "0.990", **own), total("t", "1.31", **other), TABLES, more
    found = said_of(study_of(paper([[0, 1]], *parts, velocity=1.9)), "t", "TG105")
    against = [f for f in found if f.severity is not Severity.INFO]
    assert [f.severity for f in against] == ([severity] if severity else [])
    assert all((f.verdict is ClaimVerdict.INCONSISTENT) == (f in against) for f in found)
    assert all("0.990 s (sum of its durations)" in f.message for f in against)


def test_a_total_is_set_beside_the_place_that_prints_the_other() -> None:
    d = row("d", "0.990", where="Figure 3")
    t = total("t", "1.31", of="d", where="Figure 9")
    found = audited_text(paper([[0, 1]], d, t, velocity=1.9))
    (cause,) = (c for c in found.causes if c.rule == "TG105")
    said = "Figure 9 prints 1.31 s for a total that Figure 3 gives as 0.990 s"
    assert said in plainly(found.case, cause)[0]
