"""Declared curves: shipped certificates, whole runs beside other directions, altered states."""

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from support.checkout import ROOT
from support.declared_curves import CURVES
from support.intervals import dense_best, judged
from support.proof_runs import answering, state_of, stopped
from support.shipped_problems import COVERED_PROBLEMS
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import CUBIC
from trajgap.nlp.proofs.declared.certifier import DECLARED
from trajgap.nlp.proofs.declared.simplex import best_weights
from trajgap.nlp.proofs.document import certificate, problem_document, shipped, shipped_folder
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Request
from trajgap.problem import Interpolant, Limits, Problem, TrajgapError, curves, evaluate
from trajgap.verify import Subject, verify_certificate as verify

IRB = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]


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
    page = (ROOT / "docs/explanation/certificates.md").read_text("utf-8")
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


def test_no_time_gives_no_lower_bound() -> None:
    found = certify(IRB, seconds=0.0)
    assert (found.outcome, found.lower) == (Outcome.INTERVAL, 0)
    with pytest.raises(TrajgapError, match="nothing is proved"):
        certificate(found)


@pytest.mark.parametrize("curve", [curves.three_five_three(), curves.piecewise((4, 3, 4))])
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
    assert verify(certificate(found)).proves


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_a_way_point_on_a_position_limit_is_within_it(factor: float) -> None:
    """Motions stop there: they pass neither, and the answer is that without the limit."""
    q = factor * np.array([[0.0], [0.5], [1.0]])
    key = "position_upper" if factor > 0.0 else "position_lower"
    curve = curves.rest_to_rest(2, 3)
    free = certify(Problem(q, Limits(1.0, 2.0), curve))
    held = certify(Problem(q, Limits(1.0, 2.0, **{key: factor}), curve))
    assert held.outcome is free.outcome is Outcome.CERTIFIED
    assert float(held.upper) == pytest.approx(float(free.upper), rel=1e-6)


def test_weights_are_those_of_a_linear_program() -> None:
    rng = np.random.default_rng(4)
    boxes, count, n = 30, 9, 4
    values, spare = rng.normal(size=(boxes, count)), rng.uniform(-0.3, 0.3, boxes)
    slopes, lean = rng.normal(size=(boxes, count, n)), rng.uniform(0.1, 1.0, (boxes, n))
    for signed in (True, False):
        most, weights, tau = best_weights(values, slopes, spare, lean, signed)
        assert (weights >= 0.0).all()
        assert weights.sum(axis=1) == pytest.approx(np.ones(boxes))
        assert signed or (tau >= 0.0).all()
        for b in range(boxes):
            cost = -np.concatenate([values[b], [spare[b]], -np.ones(n)])
            wide = np.hstack([slopes[b].T, lean[b][:, None]])
            above = np.vstack([np.hstack([s * wide, -np.eye(n)]) for s in (1.0, -1.0)])
            bounds = [(0, None)] * count + [(None if signed else 0, None)] + [(0, None)] * n
            solved = linprog(cost, above, np.zeros(2 * n),
                             [[1.0] * count + [0.0] * (n + 1)], [1.0], bounds)  # fmt: skip
            assert most[b] == pytest.approx(-solved.fun, abs=1e-9)


@pytest.mark.parametrize("name", CURVES)
def test_every_kind_of_curve_is_certified(name: str) -> None:
    """The directions that the search looks at hold no shorter answer either."""
    rng = np.random.default_rng(8 + len(name))
    curve, count = CURVES[name]
    q = rng.normal(0.3, 1.0, (count, 2))
    low = 0.6 if curve.virtual else 0.15
    problem = Problem(q, Limits([1.0, 0.9], [2.0, 3.0], [9.0, 8.0]), curve, low)
    exact = exact_problem(problem)
    found = DECLARED.run(exact, Request(1e-3, boxes=20_000))
    assert found.outcome is Outcome.CERTIFIED
    verdict = verify(certificate(found))
    assert verdict.proves
    h = np.array([float(x) for x in found.durations or ()])
    near = np.maximum(h * np.exp(rng.normal(0.0, 0.3, (200, len(h)))), low)
    stretch = evaluate(problem, near).stretch
    if curve.homogeneous:
        totals = np.maximum(near * stretch[:, None], low).sum(axis=1)
    else:  # nothing is stretched
        totals = np.where(stretch <= 1.0, near.sum(axis=1), np.inf)
    assert float(verdict.lower or 0) <= totals.min()


def test_a_segment_in_which_nothing_moves_needs_a_bound() -> None:
    """Where velocity alone is limited, the shorter it is the better; else it takes a turn."""
    q = np.array([[0.25], [1.0], [1.0], [0.5]])
    problem = Problem(q, Limits(1.0, joints=1), curves.three_five_three())
    bounded = replace(problem, duration_lower=0.1)
    turning = (Limits([np.inf], 2.0), Limits([np.inf], np.inf, 8.0))
    for one in (bounded, *(replace(problem, limits=limits) for limits in turning)):
        found = certify(one)
        assert found.outcome is Outcome.CERTIFIED
        assert verify(certificate(found)).proves
        if one is not bounded:
            judged(one, found, dense_best(one))


def stopped_at(name: str, monkeypatch: pytest.MonkeyPatch) -> Certified:
    """A run that was stopped with a proved lower bound and with open boxes."""
    # However fast boxes are, something is said after every few of them.
    monkeypatch.setattr("trajgap.verify.boxes._LEAVES", 8)
    monkeypatch.setattr("trajgap.nlp.proofs.declared.search.Curves.part", 8)
    found = stopped(COVERED_PROBLEMS[name], lambda now: now.lower > 0 and now.open_boxes > 0)
    assert found.outcome is Outcome.INTERVAL
    return found


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


@pytest.mark.parametrize(
    ("part", "change", "reason"),
    [
        ("claim", {"durations": ["0.1", "0.1", "0.1"]}, "not proved .answer"),
        ("claim", {"durations": ["0.4", "0.4"]}, "not proved .answer: one duration per segment"),
        ("claim", {"lower": "1e-9"}, "not proved .the lower bound exceeds the total"),
        ("problem", {"unit": "deg"}, "belongs to another problem"),
    ],
)
def test_a_bad_state_is_refused(part: str, change: dict[str, Any], reason: str) -> None:
    state = state_of(certify(IRB, seconds=0.0))
    state[part] |= change
    with pytest.raises(TrajgapError, match=reason):
        certify(IRB, resume=state)


WALK = np.random.default_rng(0).uniform(-1.5, 1.5, (7, 3))
SPLINE = Problem(WALK, Limits(1.5, 2.0, 6.0), curves.cubic_spline(6))


def test_long_cubic_splines_begin_with_boxes_of_durations() -> None:
    found = certify(SPLINE)
    assert found.outcome is Outcome.CERTIFIED
    assert verify(certificate(found)).proves
    assert certificate(found)["proof"]["kind"] == "declared"
    assert certificate(certify(SPLINE, gap=0.1))["proof"]["kind"] == "cubic"


def test_what_they_leave_goes_to_its_own_kind() -> None:
    """With few boxes for each, the better bound of both is left."""
    few = certify(SPLINE, boxes=1)
    assert few.outcome is Outcome.INTERVAL
    assert few.nodes > 1
    alone = certify(SPLINE, boxes=1, certifier=replace(CUBIC, first=None))
    assert few.lower >= alone.lower > 0
    begun = state_of(stopped(SPLINE, lambda now: True))
    again = certify(SPLINE, resume=begun, gap=0.01)
    assert certificate(again)["proof"]["kind"] == "cubic"


def test_what_is_no_state_is_refused() -> None:
    finished = certify(IRB, gap=0.1)
    for other in (finished, certificate(finished), {}, {"format": "trajgap-state-1"}):
        with pytest.raises(TrajgapError, match="resume: no trajgap-state-2"):
            certify(IRB, resume=other)
