"""The verifier: no alteration of a number, with the hash left aside, proves a false statement."""

import copy
import json
from collections import Counter
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.alterations import Path_, changed, fields, get, put
from support.certificate_kinds import KINDS, stated, text
from trajgap.problem import evaluate
from trajgap.verify import Subject, verify_certificate as verify
from trajgap.verify.curve import nonnegative
from trajgap.verify.reading import Clock
from trajgap.verify.verdict import KINDS as PROOFS


def document(kind: str = "declared") -> dict[str, Any]:
    return dict(json.loads(text(kind)))


def attack(base: dict[str, Any], optimum: float, path: Path_, rng: np.random.Generator) -> str:
    """Alter one number; what still proves must be true of the problem then in the file."""
    data = copy.deepcopy(base)
    put(data, path, changed(get(data, path), rng))
    if data == base:
        return "the same"
    verdict = verify(data)
    if not verdict.proves:
        return "refused"
    assert verdict.altered
    assert str(verdict).startswith("altered, still proves")
    kind = KINDS[base["proof"]["kind"]]
    if data["problem"] != base["problem"]:
        optimum = kind.optimum(stated(data))
    assert float(verdict.lower) <= optimum * (1 + 1e-9), path
    assert not verdict.infeasible
    if verdict.upper is not None:
        assert verdict.lower <= verdict.upper, path
        assert not kind.exact or float(verdict.upper) >= optimum * (1 - 1e-9), path
    return "still proves"


def mutate(kind: str, per_field: int, seed: int) -> Counter[str]:
    """Alter every field of a certificate so many times, at random places."""
    rng = np.random.default_rng(seed)
    base = document(kind)
    optimum = KINDS[kind].optimum(stated(base))
    outcomes: Counter[str] = Counter()
    for paths in fields(base).values():
        each = rng.integers(0, len(paths), per_field)
        outcomes.update(attack(base, optimum, paths[k], rng) for k in each)
    return outcomes


def test_every_kind_of_proof_is_attacked() -> None:
    assert set(KINDS) == set(PROOFS)


@pytest.mark.parametrize("kind", KINDS)
def test_the_interval_holds_beside_other_programs(kind: str) -> None:
    """The judge of `trajgap.problem` passes the answer, and no search undercuts the lower bound."""
    base, one = document(kind), KINDS[kind]
    problem, claim = stated(base), base["claim"]
    h = np.array([float(Fraction(x)) for x in claim["durations"]])
    assert h.sum() <= float(Fraction(claim["upper"])) + 1e-12
    assert float(Fraction(claim["lower"])) <= one.optimum(problem) * (1 + 1e-9)
    if one.subject is Subject.DECLARED:
        assert (problem.duration_lower <= h * (1 + 1e-12)).all()
        assert (h <= problem.duration_upper).all()
        assert evaluate(problem, h[None]).stretch[0] <= 1 + 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_no_mutation_proves_a_false_statement(kind: str) -> None:
    assert verify(document(kind)).proves
    outcomes = mutate(kind, 3, 7)
    assert outcomes["refused"] > 12
    assert outcomes["still proves"] > 3


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_mutations_of_each_field_prove_nothing_false(kind: str) -> None:
    many = KINDS[kind].many
    outcomes = mutate(kind, many, 11)
    assert outcomes["refused"] > 5 * many
    assert outcomes["still proves"] > many / 2


def positive(poly: list[Fraction], high: Fraction) -> bool:
    return nonnegative([c * high**p for p, c in enumerate(poly)], Clock(60.0))


def test_polynomials_are_judged_exactly() -> None:
    # 4s(1 − s) touches 0 at both ends, (s − 1/3)² inside; a hair less does not pass.
    hair = Fraction(1, 10**15)
    assert positive([Fraction(0), Fraction(4), Fraction(-4)], Fraction(1))
    assert not positive([-hair, Fraction(4), Fraction(-4)], Fraction(1))
    assert positive([Fraction(1, 9) + hair, Fraction(-2, 3), Fraction(1)], Fraction(2))
    assert not positive([Fraction(1, 9) - hair, Fraction(-2, 3), Fraction(1)], Fraction(2))
    assert positive([Fraction(1), Fraction(-1)], Fraction(1))
    assert not positive([Fraction(1), Fraction(-1)], 1 + hair)


@pytest.mark.parametrize("way", [[0], [1, ["."]], [0, 1, ["."], ["."]]])
def test_an_endless_tree_is_refused(way: list[Any]) -> None:
    data = document()
    # A weight of 0 for one row and of 1 for itself: no leaf is proved by it.
    data["proof"]["tree"] = way * 1_000_000
    verdict = verify(data)
    assert not verdict.proves
    assert not verdict.out_of_time
