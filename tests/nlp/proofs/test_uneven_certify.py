"""Certificates within limits whose sides differ: strict, sound, and closed where a side counts."""

import copy
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from support.same_question import same_question
from support.small_certificates import sealed
from support.uneven import LIMITS, WAYPOINTS, uneven_problem
from trajgap.nlp import Certified, Outcome, certify
from trajgap.nlp.optimum import solve
from trajgap.nlp.proofs import certificate
from trajgap.nlp.proofs.cubic import CUBIC
from trajgap.problem import Limits, Problem, cubic_spline, rest_to_rest
from trajgap.verify import verify_certificate

SIDED = ("rest-to-rest", "stretched", "3-5-3", "cubic")
"""Kinds of curve whose proofs know each side."""


@cache
def certified(curve: str) -> Certified:
    return certify(uneven_problem(curve), seconds=60.0)


@pytest.mark.parametrize("curve", SIDED)
def test_both_sides_are_certified(curve: str) -> None:
    problem, found = uneven_problem(curve), certified(curve)
    assert found.outcome is Outcome.CERTIFIED
    total = solve(problem).total_time
    assert float(found.lower) <= total * (1 + 1e-9)
    assert float(found.upper) == pytest.approx(total, rel=1e-8)
    mirrored, _ = same_question("mirror", problem, np.ones(problem.segments))
    back = certify(mirrored, seconds=60.0)
    assert float(back.lower) == pytest.approx(float(found.lower), rel=1e-9)
    verdict = verify_certificate(certificate(found))
    assert verdict.proves
    assert not verdict.altered
    limits = certificate(found)["problem"]["limits"]
    assert [Fraction(x) for x in limits[0][1]] == [-3, 5]


@pytest.mark.parametrize("curve", SIDED)
@pytest.mark.parametrize("side", [0, 1])
def test_a_looser_side_is_refused(curve: str, side: int) -> None:
    """The proof of a problem proves nothing of one that allows more on a side that is reached."""
    document = certificate(certified(curve))
    wider = copy.deepcopy(document)
    for row in wider["problem"]["limits"]:
        for pair in row:
            pair[side] = str(Fraction(pair[side]) * 4)
    found = verify_certificate(sealed(wider))
    # The motion that was found keeps wider limits, too: only the lower bound may fail.
    narrower = copy.deepcopy(document)
    for row in narrower["problem"]["limits"]:
        for pair in row:
            pair[side] = str(Fraction(pair[side]) / 4)
    answer = verify_certificate(sealed(narrower))
    assert not answer.proves
    assert "exceeds its limit" in answer.reason
    sides = LIMITS.sides.copy()
    sides[side] *= 4.0
    looser = Problem(WAYPOINTS, LIMITS.with_sides(sides), uneven_problem(curve).curve)
    reached = solve(looser).total_time
    if reached < solve(uneven_problem(curve)).total_time * (1 - 1e-6):
        assert not found.proves


def test_a_missing_side_is_no_limit() -> None:
    line, curve = np.array([[0.0], [1.0]]), rest_to_rest(1, 3)
    found = certify(Problem(line, Limits(velocity=[[-1.0, np.inf]], acceleration=6.0), curve))
    assert float(found.lower) == pytest.approx(1.0, rel=1e-9)
    document = certificate(found)
    assert document["problem"]["limits"][0][0] == ["-1", None]
    assert verify_certificate(document).proves


def test_other_kinds_prove_within_the_larger_size() -> None:
    limits = Limits([[-0.9, 1.0], [-2, 1.9]], [[-3, 2.9], [-6, 5.9]], [[-40, 39], [-59, 60]])
    problem = Problem(WAYPOINTS, limits, cubic_spline(3))
    found = certify(problem, boxes=40, certifier=CUBIC)
    assert found.outcome is Outcome.INTERVAL
    assert found.widened
    total, hull = solve(problem).total_time, solve(problem.hull).total_time
    assert hull < total * (1 - 1e-4)
    assert 0.99 * hull < float(found.lower) <= hull * (1 + 1e-9)
    assert float(found.upper) == pytest.approx(total, rel=1e-8)
    verdict = verify_certificate(certificate(found))
    assert verdict.proves
    assert verdict.upper == found.upper
