"""The bound for declared curves against the curves themselves, and the search's own parts."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from support.intervals import judged
from support.three_pieces import dense_best, random_problem
from trajgap.nlp import solve
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.declared.certifier import DECLARED
from trajgap.nlp.proofs.declared.simplex import best_weights
from trajgap.nlp.proofs.document import certificate, problem_document
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome, Request
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    piecewise,
    quintic_spline,
    quintic_spline_virtual,
    septic_spline,
    three_five_three,
)
from trajgap.verify import PLACES, Clock, least_durations, proof_kind, read_problem
from trajgap.verify import verify_certificate as verify
from trajgap.verify.curve import derivative, pieces, value_at

CURVES = {
    "3-5-3": (three_five_three(), 4),
    "4-3-4": (piecewise((4, 3, 4)), 4),
    "5-3-5, C3": (piecewise((5, 3, 5), 3), 4),
    "4-3-3-4": (piecewise((4, 3, 3, 4)), 5),
    "4-3-3-3-3-4": (piecewise((4, 3, 3, 3, 3, 4)), 7),
    "septic, C6": (septic_spline(3), 4),
    "clamped cubic": (cubic_spline(4), 5),
    "cubic, virtual": (cubic_spline_virtual(3), 3),
    "quintic": (quintic_spline(3), 4),
    "quintic, virtual": (quintic_spline_virtual(3), 3),
    "rest inside": (
        Interpolant(
            (5, 3, 4, 4),
            (2, 2, 2),
            (((1, 0.0), (2, 0.0)), (), ((1, 0.0), (2, 0.0)), (), ((1, 0.0), (2, 0.0))),
            name="mixed degrees with a stop",
        ),
        5,
    ),
}


def kind_of(problem: Problem, total: Fraction, proof: dict[str, Any] | None = None) -> Any:
    stated = read_problem(problem_document(exact_problem(problem)))
    given = {"rows": [], "tree": []} if proof is None else proof
    return proof_kind("declared")(stated, given, total, Clock(inf))


def drawn(name: str, rng: np.random.Generator, joints: int) -> Problem:
    """With a limit of every order, position included, whose sides differ."""
    curve, count = CURVES[name]
    q = rng.normal(0.3, 1.0, (count, joints))
    high = rng.uniform(0.5, 3.0, (3, joints)) * np.array([[1.0], [2.0], [9.0]])
    low = -high * rng.uniform(0.6, 1.4, (3, joints))
    limits = Limits(
        *np.stack([low, high], axis=2), q.min(axis=0) - 0.5, q.max(axis=0) + rng.uniform(0.1, 1.0)
    )
    return Problem(q, limits, curve, rng.uniform(0.1, 0.2, curve.segments))


def exact_sum(problem: Problem, kind: Any, h: list[Fraction], leaf: Any, centre: Any) -> Fraction:
    """F at durations in rationals, by the verifier's own elimination for an answer."""
    tau, rows, weights = leaf
    stated = read_problem(problem_document(exact_problem(problem)))
    own = pieces(stated, h, Clock(inf))
    value = Fraction(tau) * (sum(h) / kind.total - 1)
    for (k, j, order, sign, place), weight in zip(rows.tolist(), weights.tolist(), strict=True):
        at = value_at(derivative(own[j][k], order), h[k] * Fraction(place, PLACES))
        if order == 0:
            ends = stated.position[(1 + sign) // 2][j]
            far = max(abs(row[j] - stated.waypoints[0][j]) for row in stated.waypoints)
            unit = Fraction(2) ** (far.numerator.bit_length() - far.denominator.bit_length())
            value += Fraction(weight) * (sign * at - sign * ends[0]) / unit
            continue
        size = stated.sides[(1 + sign) // 2][j][order - 1][0]
        scale = (h[k] / (Fraction(centre[k]) * kind.second)) ** order
        value += Fraction(weight) * (sign * at / size - 1) * scale
    return value


@pytest.mark.parametrize("name", CURVES)
def test_the_bound_is_below_the_exact_sum_all_over_a_box(name: str) -> None:
    rng = np.random.default_rng(sum(map(ord, name)))
    narrowest, judged_boxes = inf, 0
    for trial in range(8):
        problem = drawn(name, rng, 1 + trial % 3)
        n, joints = problem.segments, problem.limits.joints
        middle = rng.uniform(0.5, 2.0, n)
        kind = kind_of(problem, Fraction(float(middle.sum() * rng.uniform(0.9, 1.1))))
        e = 10.0 ** rng.uniform(-4.0, -0.8) * rng.uniform(0.3, 1.0, n)
        own = middle / float(kind.second)
        rows = np.array(
            [[rng.integers(n), rng.integers(joints), rng.integers(4), rng.choice((-1, 1)),
              rng.integers(PLACES + 1)] for _ in range(7)]
        )  # fmt: skip
        rows[0, 4], rows[1, 4] = 0, PLACES
        weights, tau = rng.uniform(0.0, 1.0, 7), float(rng.normal())
        centre = kind.centre(np.array([[own * np.exp(-e), own * np.exp(e)]]))
        least = float(centre.least(np.array([tau]), rows[None], weights[None], float(PLACES))[0])
        if not np.isfinite(least):
            continue
        judged_boxes += 1
        for spot in range(5):
            way = rng.choice((-1.0, 1.0), n) if spot % 2 else rng.uniform(-1.0, 1.0, n)
            h = [Fraction(float(x)) * kind.second for x in own * np.exp(e * way * (1 - 1e-9))]
            value = exact_sum(problem, kind, h, (tau, rows, weights), centre.h[0])
            assert value >= Fraction(least), (trial, spot)
            if e.max() < 1e-3:
                narrowest = min(narrowest, float(value) - least)
    assert judged_boxes >= 4
    # And it is worth something: in a narrow box little is lost.
    assert narrowest < 0.1


def test_a_box_that_the_tail_cannot_hold_is_not_bounded() -> None:
    problem = drawn("3-5-3", np.random.default_rng(2), 1)
    kind = kind_of(problem, Fraction(4))
    for low, high in ((0.01, 3.9), (0.0, 0.1), (1e-10, 2e-10), (0.4, 0.3)):
        sides = np.array([[[low] * 3, [high] * 3]])
        with np.errstate(all="ignore"):
            centre = kind.centre(sides)
            row = np.array([[[0, 0, 1, 1, 5]]])
            least = centre.least(np.array([0.0]), row, np.array([[1.0]]), float(PLACES))
        assert least[0] == -inf


@pytest.mark.parametrize("name", ["3-5-3", "4-3-4", "4-3-3-4", "rest inside"])
def test_no_feasible_answer_has_a_duration_below_the_least_one(name: str) -> None:
    rng = np.random.default_rng(3 + len(name))
    for joints in (1, 2):
        problem = drawn(name, rng, joints)
        for drop in ((0, 1), (0, 2)):
            below, above = problem.limits.sides
            both = np.stack([-below.T, above.T], axis=2)
            both[list(drop)] *= inf
            limits = Limits(*both)
            one = replace(problem, limits=limits, duration_lower=0.01)
            h = solve(one).durations
            assert h is not None
            stated = read_problem(problem_document(exact_problem(one)))
            found = least_durations(stated, Fraction(float(h.sum()) * (1 + 1e-9)))
            assert all(float(x) <= y * (1 + 1e-7) for x, y in zip(found, h, strict=True)), drop


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


def of_any_kind(seed: int) -> Problem:
    """3-5-3 or 4-3-4: every kind of limit and bound, unequal sides among them."""
    problem, rng = random_problem(seed), np.random.default_rng([seed, 5])
    if seed % 2:
        problem = replace(problem, curve=piecewise((4, 3, 4)))
    return problem if rng.random() < 0.7 else replace(problem, limits=uneven(problem.limits, rng))


def uneven(limits: Limits, rng: np.random.Generator) -> Limits:
    high = limits.derivatives.T
    low = -high * rng.uniform(0.5, 1.5, high.shape)
    return Limits(*np.stack([low, high], axis=2), limits.position_lower, limits.position_upper)


def attack(seed: int) -> Outcome:
    problem = of_any_kind(seed)
    found = certify(problem, gap=1e-3, seconds=20.0)
    return judged(problem, found, dense_best(problem))


@pytest.mark.parametrize("seed", range(208, 212))
def test_dense_search_never_leaves_the_interval(seed: int) -> None:
    attack(seed)


@pytest.mark.slow
def test_dense_search_never_leaves_the_interval_of_two_hundred_problems() -> None:
    outcomes = [attack(seed) for seed in range(212, 418)]
    decided = outcomes.count(Outcome.CERTIFIED) + outcomes.count(Outcome.INFEASIBLE)
    assert decided >= 190


@pytest.mark.parametrize("name", CURVES)
def test_every_kind_of_curve_is_certified(name: str) -> None:
    """The directions that the search looks at hold no shorter answer either."""
    rng = np.random.default_rng(8 + len(name))
    curve, count = CURVES[name]
    q = rng.normal(0.3, 1.0, (count, 2))
    low = 0.4 if curve.virtual else 0.15
    problem = Problem(q, Limits([1.0, 0.9], [2.0, 3.0], [9.0, 8.0]), curve, low)
    exact = exact_problem(problem)
    found = DECLARED.run(exact, Request(1e-3, 60.0, 0, boxes=20_000))
    assert found.outcome is Outcome.CERTIFIED
    verdict = verify(certificate(found))
    assert verdict.proves
    h = np.array([float(x) for x in found.durations or ()])
    near = np.maximum(h * np.exp(rng.normal(0.0, 0.3, (200, len(h)))), low)
    stretched = near * evaluate(problem, near).stretch[:, None]
    held = np.maximum(stretched, low).sum(axis=1)
    assert float(verdict.lower or 0) <= held.min()


@pytest.mark.parametrize(
    ("curve", "reason"),
    [
        (piecewise((5, 3, 5)), "the conditions do not determine the curve"),
        (piecewise((3,) * 13, 2, ((1, 0.0),), name="other"), "more than 12 segments"),
        (quintic_spline_virtual(2), "no limit of a joint that moves in it"),
        (piecewise((4, 3, 4), ends=((1, 0.1), (2, 0.0))), "prescribes derivatives other than 0"),
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
    q = np.array([[0.25], [1.0], [1.0], [0.5]])
    problem = Problem(q, Limits(1.0, 2.0, 8.0), three_five_three())
    why = covered(exact_problem(problem))
    assert why is not None
    assert "segment 2: no limit of a joint that moves in it, and no bound" in why
    found = certify(replace(problem, duration_lower=0.1))
    assert found.outcome is Outcome.CERTIFIED
    assert verify(certificate(found)).proves
