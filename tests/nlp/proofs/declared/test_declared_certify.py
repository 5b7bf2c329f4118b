"""Certified intervals: attacked by a broken relaxation, stops, and an unlucky answer."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.checkout import ROOT
from support.shipped_problems import COVERED_PROBLEMS
from trajgap.nlp import solve
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import certificate, problem_document, shipped, shipped_folder
from trajgap.nlp.proofs.exact import decimal, exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    piecewise,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.verify import Subject
from trajgap.verify import verify_certificate as verify


def test_shipped_certificates_are_fresh_and_prove() -> None:
    assert COVERED_PROBLEMS
    for name, exact in COVERED_PROBLEMS.items():
        document = shipped(exact)
        assert document is not None, f"{name}: no certificate; run benchmarks/certificates.py"
        assert document["problem"] == problem_document(exact)
        verdict = verify(document)
        assert verdict.proves, f"{name}: {verdict}"
        assert not verdict.altered
        assert verdict.lower is not None
        assert verdict.upper is not None
        assert verdict.upper - verdict.lower <= verdict.upper / 10**6
        assert len(json.dumps(document)) < 200_000
    files = {path.stem: json.loads(path.read_text("utf-8")) for path in all_files()}
    about = {n for n, d in files.items() if d["claim"]["subject"] == Subject.DECLARED}
    assert about == set(COVERED_PROBLEMS), "a certificate of a problem that is not shipped"
    assert all(path.stat().st_size <= 200_000 for path in all_files())


def all_files() -> list[Path]:
    return sorted(shipped_folder().glob("*.json"))


def test_the_table_in_the_docs_is_that_of_the_files() -> None:
    page = (ROOT / "docs" / "explanation" / "certificates.md").read_text("utf-8")
    rows = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 8 and cells[0].startswith("`"):
            rows[cells[0].strip("`")] = cells
    files = {path.stem: path for path in shipped_folder().glob("*.json")}
    about = {name: json.loads(path.read_text("utf-8")) for name, path in files.items()}
    mine = {n for n, d in about.items() if d["claim"]["subject"] == Subject.DECLARED}
    assert set(rows) == mine
    for name, cells in rows.items():
        lower, upper = (Fraction(about[name]["claim"][key]) for key in ("lower", "upper"))
        least, most = (Fraction(cell) for cell in cells[1:3])
        assert 0 <= lower - least < Fraction(1, 10**9), f"{name}: rounded outwards"
        assert 0 <= most - upper < Fraction(1, 10**9), f"{name}: rounded outwards"
        assert cells[3] == f"{float(1 - lower / upper):.1e}", name
        assert int(cells[6]) == files[name].stat().st_size, name


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"waypoints": np.array([[0.0], [1e-200], [0.5], [1.0]])}, "at most 120 digits"),
        ({"joints": ("x" * 10_001,)}, "joints: no text, or too long"),
    ],
)
def test_what_no_certificate_can_state_is_not_covered(change: dict[str, Any], reason: str) -> None:
    q = np.array([[0.0], [1.0], [0.5], [1.0]])
    problem = Problem(q, Limits(1.0, joints=1), three_five_three())
    assert covered(exact_problem(problem)) is None
    wider = replace(problem, **change)
    why = covered(exact_problem(wider))
    assert why is not None
    assert why.startswith("no certificate can state the problem (malformed: ")
    assert reason in why
    with pytest.raises(TrajgapError, match="no certificate can state the problem"):
        certify(wider)


def test_no_time_gives_no_lower_bound() -> None:
    exact = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]
    found = certify(exact, seconds=0.0)
    assert (found.outcome, found.lower) == (Outcome.INTERVAL, 0)
    with pytest.raises(TrajgapError, match="nothing is proved"):
        certificate(found)


@pytest.mark.parametrize("degree", [3, 5, 7, 9])
def test_rest_to_rest_is_certified_in_closed_form(degree: int) -> None:
    q = np.array([[0.3, -0.2], [1.4, 0.1], [1.4, 2.3], [0.9, 2.2]])
    # A cubic's acceleration jumps at the way-points, which no jerk limit survives.
    jerk = np.inf if degree == 3 else 9.0
    limits = Limits([1.1, 0.8], [2.0, np.inf], [np.inf, jerk])
    problem = Problem(q, limits, rest_to_rest(3, degree), (0.2, 0.2, 0.4))
    found = certify(problem)
    assert found.outcome is Outcome.CERTIFIED
    assert found.gap < 1e-9
    solved = solve(problem)
    assert float(found.lower) == pytest.approx(solved.total_time, rel=1e-8)
    verdict = verify(certificate(found))
    assert verdict.proves
    assert verdict.lower == found.lower


@pytest.mark.parametrize("curve", [three_five_three(), piecewise((4, 3, 4))])
@pytest.mark.parametrize("place", [1, 3])
@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_a_way_point_beyond_a_position_limit_is_proved_infeasible(
    curve: Interpolant, place: int, factor: float
) -> None:
    q = np.array([[0.0], [0.5], [0.75], [0.25]])
    q[place] = 1.0
    key = "position_upper" if factor > 0.0 else "position_lower"
    found = certify(Problem(factor * q, Limits(1.0, **{key: 0.9375 * factor}), curve))
    assert found.outcome is Outcome.INFEASIBLE
    document = certificate(found)
    assert verify(document).proves
    for wider in (1.0, 1.5):
        document["problem"][key] = [decimal(Fraction(wider * factor))]
        assert not verify(document).proves


def test_what_is_not_covered_is_said() -> None:
    q = np.array([[0.2], [1.1], [-0.4], [0.7]])
    with pytest.raises(TrajgapError, match="covered are curves at fixed ratios"):
        certify(Problem(q, Limits(1.0), uniform_cubic_b_spline(4, "timed")))
    with pytest.raises(TrajgapError, match="nothing limits"):
        certify(Problem(q, Limits(), three_five_three()))


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (Fraction(-5, 4), "-1.25"),
        (Fraction(4, 9), "4/9"),
        (Fraction(12), "12"),
        (Fraction(1, 1000), "0.001"),
    ],
)
def test_exact_numbers_are_written_exactly(number: Fraction, text: str) -> None:
    assert decimal(number) == text
    assert Fraction(text) == number
