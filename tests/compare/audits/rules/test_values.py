"""TG211: values at one place, beside scipy's splines and an exam's printed table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support.findings import audited_text, finding
from support.made_up import claim, paper, row
from trajgap.compare.documents import ClaimVerdict
from trajgap.problem import CaseError, parse_case

EXAM = [45, 90, -45, 45]
"""Robotics I, exam of February 5, 2018, exercise 4: the table on page 12 follows."""
VELOCITIES = ["0", "-175.7143", "-215.3571", "0"]
ACCELERATIONS = ["621.4286", "-972.8571", "814.2857", "-527.1429"]


def made_up(derivative: str, rows: Sequence[list[float]] = (EXAM,), **keys: Any) -> str:
    given = row("given", [1, 0.5, 1.5], state="before")
    one = claim("one", "value", of="given", derivative=derivative, **keys)
    limits = {"velocity": 250, "acceleration": 1000}
    return paper(rows, given, one, curve={"family": "cubic-spline"}, angle="deg", **limits)


def verdict_of(
    derivative: str, rows: Sequence[list[float]] = (EXAM,), **keys: Any
) -> ClaimVerdict | None:
    return finding(made_up(derivative, rows, **keys), "one", "TG211").verdict


@pytest.mark.parametrize("knot", range(4))
def test_an_exam_and_its_table_agree(knot: int) -> None:
    place = str(knot + 1)
    for name, column in (("velocity", VELOCITIES), ("acceleration", ACCELERATIONS)):
        assert verdict_of(name, place=place, value=column[knot]) is ClaimVerdict.SUPPORTED
    wrong = f"{float(column[knot]):.1f}"
    assert verdict_of("velocity", place=place, value=wrong) is ClaimVerdict.INCONSISTENT


def test_ends_instants_and_largest_values_are_those_of_scipys_spline() -> None:
    rows = [EXAM, [10.0, -20.0, 35.0, 30.0]]
    curve = CubicSpline([0, 1, 1.5, 3], np.array(rows).T, bc_type="clamped")
    times = np.linspace(0, 3, 300_001)

    def judged(name: str, at: np.ndarray, **where: Any) -> ClaimVerdict | None:
        return verdict_of(name, rows, values=[f"{v:.3f}" for v in at], **where)

    for name, order in (("position", 0), ("velocity", 1), ("acceleration", 2)):
        found = curve(times, order)
        top, bottom = found.max(axis=0), found.min(axis=0)
        for place, at, beyond in (
            ("start", found[0], 0.01),
            ("finish", found[-1], 0.01),
            ("largest", top, 0.01),
            ("smallest", bottom, -0.01),  # samples do not reach the true value
        ):
            assert judged(name, at, place=place) is ClaimVerdict.SUPPORTED, (name, place)
            far = judged(name, at + beyond, place=place)
            assert far is ClaimVerdict.INCONSISTENT, (name, place)
        assert judged(name, curve(0.7, order), time=0.7) is ClaimVerdict.SUPPORTED


def test_either_side_of_a_jump_may_be_meant() -> None:
    curve = CubicSpline([0, 1, 1.5, 3], EXAM, bc_type="clamped")
    before, after = float(curve(0.9, 3)), float(curve(1.1, 3))
    for value, verdict in (
        (before, ClaimVerdict.SUPPORTED),
        (after, ClaimVerdict.SUPPORTED),
        ((before + after) / 2, ClaimVerdict.INCONSISTENT),
    ):
        assert verdict_of("jerk", place="2", value=f"{value:.2f}") is verdict


def test_a_printed_instant_is_an_interval() -> None:
    curve = CubicSpline([0, 1, 1.5, 3], EXAM, bc_type="clamped")
    for time, verdict in (("1.3", ClaimVerdict.SUPPORTED), (1.3, ClaimVerdict.INCONSISTENT)):
        assert verdict_of("position", time=time, value=f"{float(curve(1.34)):.3f}") is verdict


@pytest.mark.parametrize(
    ("rows", "keys", "said"),
    [
        ([EXAM], {"place": "5"}, "'5' is no place of the motion"),
        ([EXAM], {}, "or time is needed"),
        ([EXAM, EXAM], {"place": "1"}, "is one number for 2 joints"),
        ([EXAM], {"place": "1", "time": 1}, "or time is needed, and not both"),
    ],
)
def test_a_place_is_asked_for_in_one_line(
    rows: list[list[float]], keys: dict[str, Any], said: str
) -> None:
    with pytest.raises(CaseError, match=said):
        parse_case(made_up("velocity", rows, value=1, **keys), "made-up.toml")


def test_the_report_says_where() -> None:
    audit = audited_text(made_up("velocity", place="2", value="-175.8"))
    assert any("at way-point 2" in finding.message for finding in audit.findings)
    assert audit.card.errors == () or "value" in audit.card.errors[0]
