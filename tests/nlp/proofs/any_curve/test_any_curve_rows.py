"""The bound over all motions: rows, identities, shipped questions."""

from fractions import Fraction

import numpy as np
import pytest
from support.any_curve_proofs import certify_any, interval, proved, random_problem, spline_problem
from support.shipped_problems import printed_problems
from trajgap.nlp.proofs import evidence
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.question import missing, question
from trajgap.nlp.proofs.any_curve.search import Search
from trajgap.nlp.proofs.any_curve.tangents import KINDS, matrix
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.problem import ClampedBSpline, Knots, Limits, Problem
from trajgap.verify import TANGENT_UNIT, Subject, verify_certificate as verify


@pytest.mark.parametrize("seed", [700, 701])
def test_seven_segments_and_six_joints(seed: int) -> None:
    interval(random_problem(np.random.default_rng(seed), 7, 6), 1e-6)


def test_too_short_upper_bounds_are_infeasible() -> None:
    found = certify_any(spline_problem([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[1.2, 1.3]))
    assert found.outcome is Outcome.INFEASIBLE
    assert proved(found).infeasible
    late = certify_any(spline_problem([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[0.5, 9.0]))
    assert late.outcome is Outcome.INFEASIBLE
    assert proved(late).infeasible
    half = certify_any(spline_problem([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[1.2, np.inf]))
    assert half.outcome is Outcome.OPEN
    assert half.proof is None


@pytest.mark.parametrize("seed", range(40))
def test_rows_of_search_and_verifier_are_the_same(seed: int) -> None:
    """Which hold for every motion, as tests/verify asserts."""
    rng = np.random.default_rng(seed)
    step, v, a = rng.uniform([-2.0, 0.3, 0.3], [2.0, 3.0, 3.0])
    search = Search(question(exact_problem(spline_problem([0.0, step, 1.0], v, a))), Fraction(7))
    low, high = float(rng.uniform(0.1, 1.0)), float(rng.uniform(1.0, 3.0))
    sign = 1 if step >= 0 else -1
    numbers = [round(x * TANGENT_UNIT) for x in rng.uniform([-3.0, -3.0, 0.0], [3.0, 3.0, 50.0])]
    unit, angle = search.scaled.time, float(search.scaled.angle[0])
    for kind, word in enumerate(KINDS):
        rows = np.array([[kind, 0, 0, sign, *numbers]])
        sides = np.full(2, low) / unit, np.full(2, high) / unit
        left, right, size = matrix(search.scaled, rows, *sides)
        left = left.toarray()[0] * size
        box = (Fraction(low), Fraction(high))
        limits = (Fraction(float(step)), Fraction(float(v)), Fraction(float(a)))
        own = search.kind.row([word, 0, 0, sign, *numbers]).terms(*limits, box)
        # A row of least times is one of time, the others of speeds.
        each = unit if word == "reach" else angle / unit
        mine = [left[0] / unit * each, *(x * each * unit / angle for x in left[2:4])]
        assert mine == pytest.approx([float(x) for x in own[:3]], rel=1e-12, abs=1e-12)
        assert right[0] * size[0] * each == pytest.approx(float(own[3]), rel=1e-12, abs=1e-12)


def test_every_shipped_question_has_a_bound_that_is_proved() -> None:
    for name, statement, exact in printed_problems():
        if missing(exact) is None:
            found = evidence.proved(exact, Subject.ANY)
            assert found is not None, f"{name}: run benchmarks/any_curve_bound.py"
            assert found.upper - found.lower <= found.upper / 10**5, name
            estimate = estimate_any_curve(statement.problem(), starts=1).total_time
            assert float(found.lower) <= estimate * (1 + 1e-12), name
            assert float(found.upper) == pytest.approx(estimate, rel=1e-9), name


@pytest.mark.parametrize("orders", [(1, 2), (2,)])
def test_end_velocities_of_other_kinds_of_curve_are_stated(orders: tuple[int, ...]) -> None:
    curve = ClampedBSpline(3, 3, Knots.CONTINUED, end_orders=orders)
    problem = Problem(np.array([[0.0], [1.0], [0.2]]), Limits(1.0, 2.0, joints=1), curve)
    least, _ = interval(problem)
    ends = ((1, 0.0),) if 1 in orders else ()
    other, _ = interval(spline_problem([0.0, 1.0, 0.2], 1.0, 2.0, ends))
    assert least == pytest.approx(other, rel=1e-5)
    data = certificate(certify_any(problem))
    assert ("ends" in data["problem"]) == (1 in orders)
    if 1 in orders:
        del data["problem"]["ends"]
        assert not verify(data).proves
