"""Audits of a curve whose knots are printed: nothing is held against what their digits may hide."""

from __future__ import annotations

from typing import Any

import pytest
from support.findings import audited_text, study_of, verdicts
from support.made_up import claim, paper, peak, row, sentence
from trajgap.compare import ClaimVerdict
from trajgap.compare.audits import CaseAudit
from trajgap.compare.pages.readings import _determined

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
        claim("mean", "measure", derivative="velocity", measure="mean", of="d", values=["9", "8"]),
        sentence("shortest", "optimal", "d"),
        curve={"family": "clamped-b-spline", "degree": 4} | curve,
        velocity=[1.1, 1.7],
        acceleration=[3.0, 2.2],
    )


@pytest.fixture(scope="module")
def slow() -> dict[str, CaseAudit]:
    """Durations that keep the limits, far from the shortest ones."""
    return {inner: audited_text(text(given(inner, TIMED), "3.0 3.2 3.5")) for inner in INNER}


def test_rounded_knots_hold_nothing_against_what_is_said(slow: dict[str, CaseAudit]) -> None:
    exact, printed = (verdicts(slow[inner]) for inner in INNER)
    for found in (exact, printed):
        assert found["kept"] is found["smooth"] is SUPPORTED, "at some value it does"
    assert exact["peak"] is exact["mean"] is ClaimVerdict.INCONSISTENT
    assert exact["shortest"] is ClaimVerdict.REFUTED
    assert printed["peak"] is printed["mean"] is printed["shortest"] is OPEN
    note = " Knots are rounded numbers, which may explain it."
    assert sum(f.message.endswith(note) for f in slow["printed"].findings) == 2


@pytest.mark.parametrize(("inner", "verdict"), [("exact", "refuted"), ("printed", "not checkable")])
def test_a_broken_limit_is_not_refuted_for_rounded_knots(inner: str, verdict: str) -> None:
    one = audited_text(text(given(inner, TIMED), "0.20 0.20 0.20"))
    assert verdicts(one)["kept"] == verdict
    (found,) = (f for f in one.findings if f.rule == "TG201" and f.claim == "d")
    said = "no proof covers all that rounds to them" in found.message
    assert said == (inner == "printed")


@pytest.mark.parametrize(("curve", "tables"), [(given("exact", TIMED), 0), (RULED, 1)])
def test_no_table_of_rules_stands_beside_a_printed_vector(
    curve: dict[str, Any], tables: int
) -> None:
    assert len(_determined(study_of(text(curve, "1 1 1")).case)) == tables


@pytest.mark.parametrize(
    ("first", "verdict"), [("0.86", "not checkable"), ("0.96", "inconsistent")]
)
def test_stretched_segments_jump_unless_rounding_hides_their_proportions(
    first: str, verdict: str
) -> None:
    """3 : 3.5 : 3.5 are the proportions of the parameters; 0.86 : 1.00 : 1.00 round to them."""
    one = audited_text(text(given("exact", STRETCHED), f"{first} 1.00 1.00"))
    assert verdicts(one)["smooth"] == verdict
    said = [f.message for f in one.findings if f.claim == "smooth"]
    alike = "may have the proportions of the parameters"
    assert any(alike in one for one in said) == (verdict == "not checkable")
