"""Whole runs for declared curves, against other directions; the weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from support.declared_curves import CURVES
from support.intervals import dense_best, judged
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.declared.certifier import DECLARED
from trajgap.nlp.proofs.declared.simplex import best_weights
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome, Request
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    evaluate,
    piecewise,
    quintic_spline_virtual,
    three_five_three,
)
from trajgap.verify import verify_certificate as verify


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


# --- whole runs -----------------------------------------------------------------------------------


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


@pytest.mark.parametrize(
    ("curve", "reason"),
    [
        (piecewise((5, 3, 5)), "the conditions do not determine the curve"),
        (piecewise((3,) * 13, 2, ((1, 0.0),), name="other"), "more than 12 segments"),
        (quintic_spline_virtual(2), "no limit of a joint that moves in it"),
    ],
)
def test_what_is_not_covered_is_said_with_its_reason(curve: Interpolant, reason: str) -> None:
    count = curve.segments + 1 - len(curve.virtual)
    q = np.linspace(0.0, 1.0, count)[:, None] ** 2
    why = covered(exact_problem(Problem(q, Limits(1.0, 2.0, joints=1), curve)))
    if curve.degrees == (3,) * 13:
        assert why is None  # a C2 cubic spline has its own kind of proof
    else:
        assert why is not None
        assert reason in why


def test_a_segment_in_which_nothing_moves_needs_a_bound() -> None:
    """Where velocity alone is limited, the shorter it is the better; else it takes a turn."""
    q = np.array([[0.25], [1.0], [1.0], [0.5]])
    problem = Problem(q, Limits(1.0, joints=1), three_five_three())
    why = covered(exact_problem(problem))
    assert why is not None
    assert "segment 2: no limit of a joint that moves in it, and no bound" in why
    bounded = replace(problem, duration_lower=0.1)
    turning = (Limits([np.inf], 2.0), Limits([np.inf], np.inf, 8.0))
    for one in (bounded, *(replace(problem, limits=limits) for limits in turning)):
        found = certify(one)
        assert found.outcome is Outcome.CERTIFIED
        assert verify(certificate(found)).proves
        if one is not bounded:
            judged(one, found, dense_best(one))
