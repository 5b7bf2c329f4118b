"""Certificates in closed form: at fixed ratios, and of the stretched uniform cubic B-spline."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.uneven import CURVES
from trajgap.nlp import solve
from trajgap.nlp.proofs.answer import keeps_limits
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import certificate, fits
from trajgap.nlp.proofs.evidence import interval_of, printed_problem_or_none
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.problem import Limits, Problem, TrajgapError, Verdict, check, curves, parse_case
from trajgap.verify import Subject, verify_certificate as verify

Q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
LIMITS = Limits([1.0, 0.9], [2.0, 1.5], [12.0, 9.0])
RATIOS = [1.0, 1.75, 1.25]
UNEVEN = LIMITS.with_sides([LIMITS.derivatives, 0.7 * LIMITS.derivatives])
CLOSED = {
    **{
        f"{curve} at ratios, {name}": Problem(Q, limits, declare(), ratios=RATIOS)
        for curve, declare in CURVES.items()
        for name, limits in (("even", LIMITS), ("uneven", UNEVEN))
    },
    # A cubic's acceleration jumps at the way-points, which no jerk limit survives.
    **{
        f"rest to rest {degree}": Problem(
            Q,
            Limits([1.1, 0.8], [2.0, np.inf], jerk),
            curves.rest_to_rest(3, degree),
            (0.2, 0.2, 3.4),
        )
        for degree, jerk in ((3, np.inf), (5, [np.inf, 9.0]), (7, [np.inf, 9.0]), (9, [9.0, 9.0]))
    },
}


@pytest.mark.parametrize("name", CLOSED)
def test_it_is_proved_to_the_last_digits(name: str) -> None:
    problem = CLOSED[name]
    found = certify(problem, gap=1e-12)
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.lower) == pytest.approx(solve(problem).total_time, rel=1e-9)
    assert verify(certificate(found)).lower == found.lower
    if problem.ratios is not None:
        total = sum(found.durations, Fraction(0))
        assert [h / total for h in found.durations] == [Fraction(r) / 4 for r in RATIOS]


def test_a_bound_on_a_duration_may_ask_for_most() -> None:
    problem = Problem(Q, LIMITS, curves.cubic_spline(3), [0.0, 8.75, 0.0], ratios=RATIOS)
    found = certify(problem)
    assert found.lower == found.upper == 20


def test_a_proof_of_one_question_is_none_of_the_other() -> None:
    fixed = Problem(Q, LIMITS, curves.rest_to_rest(3, 5), ratios=RATIOS)
    free = replace(fixed, ratios=None)
    own, other = (certificate(certify(one)) for one in (fixed, free))
    assert fits(own, exact_problem(fixed), Subject.DECLARED)
    assert interval_of(own, exact_problem(fixed)) is not None
    for document, asked in ((own, free), (other, fixed)):
        assert interval_of(document, exact_problem(asked)) is None
    # Nor are other ratios the same question; their scale is.
    assert interval_of(own, exact_problem(replace(fixed, ratios=[1, 2, 1]))) is None
    assert interval_of(own, exact_problem(replace(fixed, ratios=[4, 7, 5]))) is not None


def test_any_curve_is_bounded_whatever_the_ratios() -> None:
    fixed = Problem(Q[:3], Limits([1.0, 0.9], [2.0, 1.5]), curves.cubic_spline(2), ratios=[1, 3])
    found = certify(fixed, subject=Subject.ANY, gap=0.5, seconds=20)
    free = replace(fixed, ratios=None)
    assert fits(certificate(found), exact_problem(free), Subject.ANY)
    assert 0 < float(found.lower) <= solve(free).total_time <= solve(fixed).total_time


CASE = """
format = 1
id = "made-up"
title = "Made up"
robot = { name = "arm", joints = ["a", "b"] }
units = { position = "deg", velocity = "rad/s", time = "s" }
interpolant = { family = "cubic-spline" }
source = { kind = "teaching" }

[waypoints]
waypoint_rows = [[0, 10], ["30.0", 25], [-5, 40]]

[limits]
velocity = 1

[durations]
ratios = RATIOS
"""


@pytest.mark.parametrize(
    ("ratios", "joints", "shares"),
    [
        ('[1, "2.50"]', None, (Fraction(2, 7), Fraction(5, 7))),
        ('"equal"', None, (Fraction(1, 2), Fraction(1, 2))),
        ('"chord"', '["a"]', (Fraction(30, 65), Fraction(35, 65))),
        ('"free"', None, None),
    ],
)
def test_printed_ratios_are_exact(ratios: str, joints: str | None, shares) -> None:
    own = "" if joints is None else f'\n[[readings]]\nid = "r"\nwhy = "one"\njoints = {joints}\n'
    case = parse_case(CASE.replace("RATIOS", ratios) + own, "made-up.toml")
    exact = printed_problem_or_none(case.statement())
    assert exact.shares == shares


def test_chord_lengths_of_several_joints_are_not_rational() -> None:
    case = parse_case(CASE.replace("RATIOS", '"chord"'), "made-up.toml")
    exact = printed_problem_or_none(case.statement())
    assert exact.shares is None
    assert "chord lengths of several joints are not rational numbers" in str(covered(exact))
    # A bound over any curve holds all the same, and says which question it was asked for.
    found = certify(exact, subject=Subject.ANY, gap=0.5, seconds=20)
    document = certificate(found)
    assert document["problem"]["ratios"] == "chord"
    assert fits(document, replace(exact, chord=False), Subject.ANY)
    assert not fits(document, replace(exact, chord=False), Subject.DECLARED)
    own = certificate(certify(replace(exact, shares=(Fraction(1, 4), Fraction(3, 4)), chord=False)))
    stated = {**own["problem"], "ratios": "chord"}
    assert not fits({**own, "problem": stated}, replace(exact, chord=False), Subject.DECLARED)


JUMPS = {
    "lines, jerk": (curves.piecewise((1, 1), 0, ()), (np.inf, np.inf, 1.0)),
    "lines, acceleration": (curves.piecewise((1, 1), 0, ()), (np.inf, 1.0, np.inf)),
    "lines, velocity": (curves.piecewise((1, 1), 0, ()), (2.0, np.inf, np.inf)),
    "cubics, jerk": (curves.piecewise((3, 3), 0, ((1, 0.0), (2, 0.0))), (np.inf, np.inf, 40.0)),
    "rest to rest, jerk": (curves.rest_to_rest(2, 3), (np.inf, np.inf, 40.0)),
}


@pytest.mark.parametrize("sides", ["both", "upper", "lower"])
@pytest.mark.parametrize("name", JUMPS)
def test_a_jump_is_no_answer_of_prover_or_check(name: str, sides: str) -> None:
    curve, sizes = JUMPS[name]
    none = np.full((1, 3), np.inf)
    pair = [none if sides == "upper" else np.array([sizes]),
            none if sides == "lower" else np.array([sizes])]  # fmt: skip
    q = [[0.0], [1.0], [-0.5]]
    problem = Problem(q, Limits(joints=1).with_sides(pair), curve, ratios=[1.0, 1.5])
    h = np.array([2.0, 3.0])
    judged = check(problem, h)
    assert judged.verdict is Verdict.DISCONTINUOUS
    assert judged.limits is Verdict.PASS
    assert not keeps_limits(exact_problem(problem), [Fraction(2), Fraction(3)])
    try:
        found = certify(problem, seconds=5.0)
    except TrajgapError:  # nothing bounds the total from below
        return
    assert found.upper is None


def random_problem(seed: int) -> Problem:
    rng = np.random.default_rng(seed)
    count, joints = int(rng.integers(2, 7)), int(rng.integers(1, 4))
    q = rng.normal(0.4, 1.3, (count, joints))
    scale = rng.uniform(0.3, 4.0, (3, joints))
    some = rng.random(3) < 0.7
    some[rng.integers(0, 3)] = True
    v, a, j = (scale[i] if some[i] else np.full(joints, np.inf) for i in range(3))
    lower = rng.uniform(0.1, 1.5, count - 1) if rng.random() < 0.4 else 0.0
    return Problem(q, Limits(v, a, j), curves.uniform_cubic_b_spline(count, "stretched"), lower)


@pytest.mark.parametrize("seed", range(12))
def test_the_interval_holds_the_closed_form(seed: int) -> None:
    problem = random_problem(seed)
    found = certify(problem)
    assert found.outcome is Outcome.CERTIFIED
    assert found.gap < 1e-11
    durations = curves.solve_in_closed_form(
        problem.curve, problem.waypoints, problem.limits.derivatives
    )
    best = float(np.maximum(durations, problem.duration_lower).sum())
    assert float(found.lower) <= best * (1 + 1e-12)
    assert float(found.upper) >= best * (1 - 1e-12)
    verdict = verify(certificate(found))
    assert str(verdict).startswith("proves")
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)


def test_positions_are_judged() -> None:
    # It overshoots its highest way-point, whatever the durations.
    q = np.array([[0.0], [1.0], [0.9], [0.0]])
    curve = curves.uniform_cubic_b_spline(4, "stretched")
    tight = Problem(q, Limits(1.0, position_upper=1.0), curve)
    assert certify(tight).outcome is Outcome.OPEN
    wide = certify(Problem(q, Limits(1.0, position_upper=1.2), curve))
    assert verify(certificate(wide)).proves
