"""Certified intervals of 4-3-4 polynomials: rows against splines, dense search, broken rows."""

from __future__ import annotations

import itertools
from dataclasses import replace
from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest
from support.checkout import ROOT
from support.three_pieces import dense_best
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.nlp.proofs.three_piece.ratios import SHAPES, ThreePieces, shape_of
from trajgap.nlp.proofs.three_piece.rows import PieceRow, exact_row
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    fit,
    piecewise,
)
from trajgap.problem.cases.declaration import InterpolantBlock, declare
from trajgap.verify import read_problem
from trajgap.verify import three_piece as checker
from trajgap.verify import verify_certificate as verify
from trajgap.verify.reading import Clock

search = import_module("trajgap.nlp.proofs.three_piece.search")
MAKES = {"three-piece": checker.ThreeFiveThree, "four-three-four": checker.FourThreeFour}

CURVE = piecewise((4, 3, 4))


def fixed(joints: int = 2) -> Problem:
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, -1.0]])[:, :joints]
    return Problem(q, Limits(1.0, 2.0, 8.0), CURVE)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.proof)
def test_solver_and_verifier_have_the_same_rows(shape: ThreePieces) -> None:
    limits = Limits(2.0, 3.0, 5.0, -9.0, 7.0)
    problem = replace(fixed(), limits=limits, curve=piecewise(shape.degrees))
    bounded = replace(problem, duration_lower=np.full(3, 0.5), duration_upper=np.full(3, 9.0))
    found = certify(bounded, gap=0.5)
    document = certificate(found)
    stated = read_problem(document["problem"])
    assert document["proof"]["kind"] == shape.proof
    total = Fraction(17, 5)
    proof = MAKES[shape.proof](stated, document["proof"], total, Clock(60.0))
    assert proof.degrees == list(shape.degrees)
    curves = proof._curves()
    rows = [PieceRow("lower", 2, 1), PieceRow("mean", 0, 1, cap=2)]
    for order, cap in itertools.product((1, 2, 3), (-1, 0)):
        rows += [PieceRow(end, 1, order, cap=cap) for end in ("first", "last")]
        rows += [PieceRow(kind, 1, order, -1, 123_456, cap) for kind in proof.divisors]
    rows += [PieceRow(kind, 0, 0, sign, 777_777) for kind in proof.divisors for sign in (1, -1)]
    for row in rows:
        mine = exact_row(exact_problem(bounded), row, total)
        entry = [row.kind, row.joint, row.order, row.sign, row.place, row.cap]
        theirs, unit = proof._polynomial(curves, checker._Row.read(entry, proof))
        assert {k: v for k, v in np.ndenumerate(mine) if v} == {
            k: Fraction(v, unit) for k, v in theirs.items() if v
        }


def test_what_an_end_piece_must_reach() -> None:
    # |d| ≤ limit·hʳ/r! from rest, whatever the other pieces do.
    rng, ends = np.random.default_rng(4), SHAPES[1].ends
    nearest = np.full(3, np.inf)
    for _ in range(200):
        h, q = rng.uniform(0.1, 3.0, 3), rng.normal(size=(4, 1))
        curve = fit(CURVE, q, h)
        for t0, k in ((0.0, 0), (h[0] + h[1], 2)):
            times = t0 + h[k] * np.linspace(1e-9, 1 - 1e-9, 400)
            for order in (1, 2, 3):
                top = max(abs(float(curve(t, order)[0])) for t in times[:: 1 if order < 3 else 399])
                least = ends[order - 1] * abs(float(q[k + 1, 0] - q[k, 0])) / h[k] ** order
                assert top >= least * (1 - 1e-4)
                nearest[order - 1] = min(nearest[order - 1], top / least)
    assert (nearest < 2.5).all(), "the constants are not far from what is reached"


LIMITS = {
    "velocity": Limits(1.0),
    "acceleration": Limits(np.inf, 2.0),
    "jerk": Limits(np.inf, np.inf, 8.0),
    "all three": Limits(1.0, 2.0, 8.0),
}


@pytest.mark.parametrize("joints", [1, 2])
@pytest.mark.parametrize("kind", LIMITS)
def test_each_kind_of_limit_is_certified(kind: str, joints: int) -> None:
    problem = replace(fixed(joints), limits=LIMITS[kind])
    found = certify(problem, seconds=60.0)
    assert found.outcome is Outcome.CERTIFIED
    assert found.gap <= 1e-6
    assert float(found.lower) <= dense_best(problem, 81) <= float(found.lower) * 1.03
    assert verify(certificate(found)).proves
    page = (ROOT / "docs" / "explanation" / "certificates.md").read_text("utf-8")
    cells = next(line.split("|") for line in page.splitlines() if line.startswith(f"| {kind} |"))
    assert float(cells[1 + joints]) == pytest.approx(float(found.upper), rel=2e-6)
    assert joints == 1 or int(cells[4]) == pytest.approx(found.nodes, rel=0.25)


def overshooting(roof: float) -> Problem:
    """The first piece arrives at its way-point from above."""
    q = np.array([[0.0], [0.5], [0.3], [-0.7]])
    return Problem(q, Limits(1.0, 2.0, 8.0, -np.inf, roof), CURVE)


def test_an_end_piece_meets_its_position_limit() -> None:
    problem = overshooting(np.inf)
    free = certify(problem)
    h = np.array([float(x) for x in free.durations or ()])
    curve = fit(CURVE, problem.waypoints, h)
    top = max(float(curve(t)[0]) for t in np.linspace(0.0, h[0] + h[1], 999))
    assert top > 0.5 + 1e-3
    held = certify(overshooting(0.5 * (0.5 + top)))
    assert held.outcome is Outcome.CERTIFIED
    assert held.lower > free.upper
    assert float(held.lower) <= dense_best(overshooting(0.5 * (0.5 + top)), 41)
    document = certificate(held)
    assert verify(document).proves
    document["problem"]["position_upper"] = ["2"]
    assert "not proved" in verify(document).reason


def test_where_nothing_moves_in_the_middle_the_interval_holds() -> None:
    # The rows meet in one corner of the square, where the ratio of the end pieces is lost.
    problem = Problem([[0.0], [1.0], [1.0], [0.0]], Limits(1.0, 2.0, 8.0), CURVE)
    found = certify(problem, seconds=1.5)
    assert found.outcome is Outcome.INTERVAL
    assert 0 < float(found.lower) <= dense_best(problem, 81)
    assert verify(certificate(found)).proves


def test_what_is_covered() -> None:
    q = fixed().waypoints
    block = InterpolantBlock(family="polynomials", degrees=(4, 3, 4))
    rest = ((1, 0.0), (2, 0.0))
    declared = declare(block, 4, (rest, rest))
    assert shape_of(declared) is SHAPES[1]
    assert covered(exact_problem(Problem(q, Limits(1.0), declared))) is None
    moving = piecewise((4, 3, 4), 2, ((1, 0.1), (2, 0.0)))
    for curve, why in (
        (moving, "no proof covers such a curve"),
        (piecewise((3, 4, 4)), "covered are"),
    ):
        assert shape_of(curve) is None
        with pytest.raises(TrajgapError, match=why):
            certify(Problem(q, Limits(1.0), curve))
