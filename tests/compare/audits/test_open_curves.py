"""Audits of curves that durations alone do not settle: virtual breaks, and knots in print."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.drawn import sketched
from support.findings import audited_text, finding, study_of, verdicts
from support.made_up import claim, paper, peak, readings, row, sentence, total
from trajgap.compare import ClaimVerdict, write_report
from trajgap.compare.audits import CaseAudit
from trajgap.compare.audits.case_audit import AuditReport
from trajgap.compare.audits.rounding import excludes_total
from trajgap.compare.pages.readings import _determined
from trajgap.problem import Limits, Problem, quintic_spline

CASE = paper(
    ["0.3 0.9 0.2 -0.45", "-1.0 -0.55 0.35 0.1"],
    readings(free={"default": True}, virtual={"interpolant": {"family": "quintic-spline-virtual"}}),
    total("total", "2.9"),
    row("four", "0.98 0.89 0.20 0.94", total="3.01"),
    sentence("kept", "within_limits", "four"),
    peak("peak", "four", "velocity", ["1.1", "1.7"]),
    sentence("shortest", "optimal", "four"),
    curve={"family": "quintic-spline", "virtual": [2], "free": 1},
    bounds={"lower": 0.2},
    velocity=[1.1, 1.7],
    acceleration=[3.0, 2.2],
    jerk=[20, 15],
)


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> CaseAudit:
    found = audited_text(CASE)
    folder: Path = tmp_path_factory.mktemp("pages")
    with sketched():
        write_report(AuditReport((found,)), folder)
    return found


def test_durations_alone_say_nothing_of_limits_and_peaks(one: CaseAudit) -> None:
    assert verdicts(one)["kept"] is verdicts(one)["peak"] is ClaimVerdict.NOT_CHECKABLE
    why = "1 virtual way-point) leaves 1 coefficient per joint free"
    without = {(f.claim, f.reading) for f in one.findings if why in f.message}
    assert without == {("four", "free"), ("kept", "free"), ("peak", "free")}


def test_a_total_alone_is_excluded_by_speed_alone() -> None:
    q = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
    limits = Limits([1.1, 1.7], [3.0, 2.2], [20.0, 15.0])
    # Every duration has a lower bound, so a search over them would start.
    problem = Problem(q, limits, quintic_spline(4, virtual=(2,)), duration_lower=0.3)
    assert excludes_total(problem, 2.0) is False
    # 0.6 rad at 1.1 rad/s, 0.3 s twice, 0.65 rad at 1.1 rad/s: 1.736 s.
    assert excludes_total(problem, 1.73) is True


def test_totals_are_set_beside_the_optimum_over_durations_and_positions(one: CaseAudit) -> None:
    found = {f.claim: f for f in one.findings if f.rule == "TG302" and f.reading == "free"}
    assert found["shortest"].verdict is ClaimVerdict.SUPPORTED
    assert found["total"].verdict is ClaimVerdict.NOT_CHECKABLE
    # 2.99625 s, which SLSQP finds too: tests/nlp/optimum/test_free_way_points.py.
    assert "the best known optimum with shared durations, 2.996246 s" in found["total"].message


def test_a_reading_with_other_segments_has_no_printed_motion(one: CaseAudit) -> None:
    steps = {w.reading: {s.name: s for s in w.steps} for w in one.waterfalls}
    said = str(steps["virtual"]["feasible after repair"].time)
    assert said.endswith("has 5 segments, but 4 durations are printed")
    assert steps["virtual"]["published"].time == pytest.approx(3.01)
    found = [f for f in one.findings if f.rule == "TG109"]
    assert [(f.claim, f.reading) for f in found] == [("four", "virtual")]


SUPPORTED, OPEN = ClaimVerdict.SUPPORTED, ClaimVerdict.NOT_CHECKABLE
INNER: dict[str, list[Any]] = {"exact": [2.5, 5, 8], "printed": ["2.5", 5, "8"]}
TIMED = {"parameters": "times"}
STRETCHED = {"parameters": "given", "time": "stretched", "parameter_values": [0, 3, 6.5, 10]}
RULED = {"knots": "averaged-continued", "parameters": "times"}


def given(inner: str, how: dict[str, Any]) -> dict[str, Any]:
    return {"knots": "given", "knot_vector": [0] * 5 + INNER[inner] + [10] * 5} | how


def text(curve: dict[str, Any], durations: str) -> str:
    return paper(
        [[0.3, 0.9, 0.2, -0.45], [-1.0, -0.55, 0.35, 0.1]],
        row("d", durations),
        sentence("kept", "within_limits", "d"),
        sentence("smooth", "continuous", "d"),
        peak("peak", "d", "velocity", ["0.99", "1.62"]),
        sentence("shortest", "optimal", "d"),
        curve={"family": "clamped-b-spline", "degree": 4} | curve,
        velocity=[1.1, 1.7],
        acceleration=[3.0, 2.2],
    )


MEAN = claim("mean", "measure", derivative="velocity", measure="mean", of="d", values=["9", "8"])


@pytest.fixture(scope="module")
def slow() -> dict[str, CaseAudit]:
    """Durations that keep the limits, far from the shortest ones."""
    return {inner: audited_text(text(given(inner, TIMED), "3.0 3.2 3.5")) for inner in INNER}


def test_rounded_knots_hold_nothing_against_what_is_said(slow: dict[str, CaseAudit]) -> None:
    exact, printed = (verdicts(slow[inner]) for inner in INNER)
    for found in (exact, printed):
        assert found["kept"] is found["smooth"] is SUPPORTED, "at some value it does"
    assert exact["peak"] is ClaimVerdict.INCONSISTENT
    assert exact["shortest"] is ClaimVerdict.REFUTED
    assert printed["peak"] is printed["shortest"] is OPEN
    note = " Knots are rounded numbers, which may explain it."
    assert sum(f.message.endswith(note) for f in slow["printed"].findings) == 1
    for inner, verdict in (("exact", ClaimVerdict.INCONSISTENT), ("printed", OPEN)):
        one = finding(text(given(inner, TIMED), "3.0 3.2 3.5") + MEAN, "mean", "TG208")
        assert one.verdict is verdict
        assert one.message.endswith(note) == (verdict is OPEN)


@pytest.mark.parametrize(
    ("inner", "verdict"),
    [pytest.param("exact", "refuted", marks=pytest.mark.slow), ("printed", "not checkable")],
)
def test_a_broken_limit_is_not_refuted_for_rounded_knots(inner: str, verdict: str) -> None:
    one = audited_text(text(given(inner, TIMED), "0.20 0.20 0.20"))
    assert verdicts(one)["kept"] == verdict
    (found,) = (f for f in one.findings if f.rule == "TG201" and f.claim == "d")
    said = "no proof covers their rounding" in found.message
    assert said == (inner == "printed")


@pytest.mark.parametrize(("curve", "tables"), [(given("exact", TIMED), 0), (RULED, 1)])
def test_no_table_of_rules_is_beside_a_printed_vector(curve: dict[str, Any], tables: int) -> None:
    assert len(_determined(study_of(text(curve, "1 1 1")).case)) == tables


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "verdict"), [("0.86", "not checkable"), ("0.96", "inconsistent")]
)
def test_stretched_segments_jump_unless_rounding_hides_the_ratio(first: str, verdict: str) -> None:
    """3 : 3.5 : 3.5 are the proportions of the parameters; 0.86 : 1.00 : 1.00 round to them."""
    one = audited_text(text(given("exact", STRETCHED), f"{first} 1.00 1.00"))
    assert verdicts(one)["smooth"] == verdict
    said = [f.message for f in one.findings if f.claim == "smooth"]
    alike = "may have the proportions of the parameters"
    assert any(alike in one for one in said) == (verdict == "not checkable")
