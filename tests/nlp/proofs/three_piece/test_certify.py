"""Certified intervals of three pieces: what is shipped, closed forms, rows, and altered states."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from fractions import Fraction
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.alterations import changed, get, places, put
from support.checkout import ROOT
from support.shipped_problems import COVERED_PROBLEMS
from support.unlucky import answering
from trajgap.nlp import solve
from trajgap.nlp.proofs.answer import exact_coefficients, keeps_limits, never_above
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import certificate, problem_document, shipped, shipped_folder
from trajgap.nlp.proofs.exact import decimal, exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress, Request
from trajgap.nlp.proofs.session import Session
from trajgap.nlp.proofs.state import resumed, state_document
from trajgap.nlp.proofs.three_piece.boxes import Boxes
from trajgap.nlp.proofs.three_piece.rows import PieceRow, Prover
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    fit,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.verify import Subject
from trajgap.verify import verify_certificate as verify

module = import_module("trajgap.nlp.proofs.three_piece.search")


def test_shipped_certificates_are_fresh_and_prove() -> None:
    assert COVERED_PROBLEMS
    for name, exact in COVERED_PROBLEMS.items():
        document = shipped(exact)
        assert document is not None, f"{name}: no certificate; run benchmarks/certificates.py"
        assert document["problem"] == problem_document(exact)
        verdict = verify(document)
        assert verdict.proves, f"{name}: {verdict}"
        assert not verdict.altered
        assert verdict.upper - verdict.lower <= verdict.upper / 10**6
        assert len(json.dumps(document)) < 200_000
    files = {path.stem: json.loads(path.read_text("utf-8")) for path in all_files()}
    about = {n for n, d in files.items() if d["claim"]["subject"] == Subject.DECLARED}
    assert about == set(COVERED_PROBLEMS), "a certificate of a problem that is not shipped"
    assert all(path.stat().st_size <= 200_000 for path in all_files())


def all_files() -> list[Path]:
    return sorted(shipped_folder().glob("*.json"))


@pytest.mark.parametrize(
    ("page", "subject"),
    [("certificates.md", Subject.DECLARED), ("certificates-any-curve.md", Subject.ANY)],
)
def test_the_table_in_the_docs_is_that_of_the_files(page: str, subject: Subject) -> None:
    rows = {}
    for line in (ROOT / "docs" / "explanation" / page).read_text("utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 8 and cells[0].startswith("`"):
            rows[cells[0].strip("`")] = cells
    claims = {path.stem: json.loads(path.read_text("utf-8"))["claim"] for path in all_files()}
    sizes = {path.stem: path.stat().st_size for path in all_files()}
    assert set(rows) == {name for name, claim in claims.items() if claim["subject"] == subject}
    for name, cells in rows.items():
        lower, upper = (Fraction(claims[name][key]) for key in ("lower", "upper"))
        least, most = (Fraction(cell) for cell in cells[1:3])
        assert 0 <= lower - least < Fraction(1, 10**9), f"{name}: rounded outwards"
        assert 0 <= most - upper < Fraction(1, 10**9), f"{name}: rounded outwards"
        assert cells[3] == f"{float(1 - lower / upper):.1e}", name
        assert int(cells[6]) == sizes[name], name


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
    document = certificate(found)
    verdict = verify(document)
    assert verdict.proves
    assert verdict.lower == found.lower


def test_what_is_not_covered_is_said() -> None:
    q = np.array([[0.2], [1.1], [-0.4], [0.7]])
    with pytest.raises(TrajgapError, match="covered are curves at fixed ratios"):
        certify(Problem(q, Limits(1.0), uniform_cubic_b_spline(4, "timed")))
    with pytest.raises(TrajgapError, match="nothing limits"):
        certify(Problem(q, Limits(), three_five_three()))


def test_exact_coefficients_agree_with_the_fit() -> None:
    q = np.array([[0.3, -1.2], [1.1, 0.4], [0.6, 0.9], [-0.7, 0.1]])
    h = np.array([0.75, 1.25, 0.5])
    interpolant = three_five_three()
    curve = exact_coefficients(
        interpolant,
        [[Fraction(float(x)) for x in row] for row in q],
        [Fraction(float(x)) for x in h],
    )
    second = np.array(curve[1][1], dtype=float)
    expected = fit(interpolant, q, h)(0.75 + 0.5 * 1.25)[1]
    assert second @ 0.5 ** np.arange(6) == pytest.approx(expected, rel=1e-12)


def test_peaks_are_judged_exactly() -> None:
    # 4s(1 − s) touches 1 in the middle.
    parabola = [Fraction(0), Fraction(4), Fraction(-4)]
    assert never_above(parabola, Fraction(1))
    assert not never_above(parabola, 1 - Fraction(1, 10**15))


def test_a_proof_needs_weights() -> None:
    exact = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]
    row, side = PieceRow("first", 0, 1), (3, 0)
    prover = Prover(exact, Fraction(1))
    assert prover.proves((row,), (Fraction(1),), side, side)
    assert not prover.proves((row,), (Fraction(0),), side, side)
    assert not prover.proves((row,), (Fraction(-1),), side, side)
    assert not prover.proves((), (), side, side)


def test_boxes_halve() -> None:
    whole = Boxes(np.zeros((1, 2), np.int64), np.zeros((1, 2), np.int64))
    parts = whole.halves(np.array([1])).halves(np.array([0, 0]))
    area = (0.5**parts.level).prod(axis=1).sum()
    assert area == 1.0
    assert len({parts.sides(n) for n in range(4)}) == 4


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


def stopped_at(name: str, monkeypatch: pytest.MonkeyPatch) -> Certified:
    """A run that was stopped with a proved lower bound and with open boxes."""

    def interrupt(progress: Progress) -> None:
        if progress.lower > 0 and progress.open_boxes > 0:
            raise KeyboardInterrupt

    monkeypatch.setattr(module, "_BATCH", 8)
    found = certify(COVERED_PROBLEMS[name], report=interrupt)
    assert found.outcome is Outcome.INTERVAL
    return found


def state_of(found: Certified) -> dict[str, Any]:
    """The state of a stopped run, through JSON."""
    document = state_document(found)
    assert document is not None
    return dict(json.loads(json.dumps(document)))


def test_an_edited_state_proves_nothing_false(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    exact, found = COVERED_PROBLEMS[name], stopped_at(name, monkeypatch)
    base = state_of(found)
    assert resumed(exact, base).lower == found.lower
    rng = np.random.default_rng(3)
    outcomes = []
    for part in ("claim", "proof", "proposals"):
        numbers = places({"proof": base[part]})
        for _ in range(50):
            path = numbers[rng.integers(0, len(numbers))]
            data = copy.deepcopy(base)
            put({"proof": data[part]}, path, changed(get({"proof": base[part]}, path), rng))
            try:
                state = resumed(exact, data)
                session = Session(exact, Request(resume=state))
                pending = session.taken_up(partial(module._proposed, exact, "three-piece"))
            except TrajgapError:
                outcomes.append((part, "refused"))
                continue
            outcomes.append((part, "taken"))
            assert state.lower <= found.upper, path
            assert state.proof is not None or state.lower == 0
            if state.durations is not None:
                assert keeps_limits(exact, state.durations), path
            assert pending is None or (0.5**pending.boxes.level).prod(axis=1).sum() == 1.0
    for part in ("claim", "proof", "proposals"):
        assert outcomes.count((part, "refused")) > 20
    assert outcomes.count(("proof", "taken")) > 0
    assert outcomes.count(("proposals", "taken")) > 10


def test_a_resumed_bound_alone_proves_nothing_infeasible(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    exact, found = COVERED_PROBLEMS[name], stopped_at(name, monkeypatch)
    state = state_of(found)
    state["claim"] |= {"durations": None, "upper": None}
    assert state["proof"] is not None
    assert None in exact.duration_upper
    answering(monkeypatch, lambda call, initial: None)
    again = certify(exact, resume=state)
    assert again.outcome is Outcome.OPEN
    assert again.lower == found.lower
    assert verify(certificate(again)).proves


def test_edited_open_boxes_only_cost_time(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    exact, found = COVERED_PROBLEMS[name], stopped_at(name, monkeypatch)
    state = state_of(found)
    # "Everything is proved by any row", and a total that is far too long.
    state["proposals"] |= {"tree": [[".", 0, "1"]], "total": "100"}
    again = certify(exact, gap=1e-3, resume=state)
    assert again.outcome is Outcome.CERTIFIED
    assert again.lower >= found.lower
    assert verify(certificate(again)).proves


@pytest.mark.parametrize(
    ("part", "change", "reason"),
    [
        ("proposals", {"kind": "stretched"}, "a state of kind"),
        ("proposals", {"tree": None}, "malformed"),
        ("claim", {"durations": ["0.1", "0.1", "0.1"]}, "not proved .answer"),
        ("claim", {"durations": ["0.4", "0.4"]}, "not proved .answer: one duration per segment"),
        ("claim", {"lower": "1e-9"}, "not proved .the lower bound exceeds the total"),
        ("problem", {"unit": "deg"}, "about another problem"),
    ],
)
def test_a_bad_state_is_refused(part: str, change: dict[str, Any], reason: str) -> None:
    exact = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]
    state = state_of(certify(exact, seconds=0.0))
    state[part] |= change
    with pytest.raises(TrajgapError, match=reason):
        certify(exact, resume=state)


def test_what_is_no_state_is_refused() -> None:
    exact = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]
    finished = certify(exact, gap=0.1)
    for other in (finished, certificate(finished), {}, {"format": "trajgap-state-1"}):
        with pytest.raises(TrajgapError, match="resume: no trajgap-state-2"):
            certify(exact, resume=other)
