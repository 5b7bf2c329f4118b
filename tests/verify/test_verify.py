"""The verifier: no alteration of a number, with the hash left aside, proves a false statement."""

from __future__ import annotations

import copy
import json
from collections import Counter
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.alterations import Path_, changed, fields, get, put
from support.certificate_kinds import KINDS, stated, text
from trajgap.verify import Subject, verdict
from trajgap.verify import verify_certificate as verify
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
    assert verdict.lower is not None
    if data["problem"] != base["problem"]:
        optimum = KINDS[base["proof"]["kind"]].optimum(stated(data))
    assert float(verdict.lower) <= optimum * (1 + 1e-9), path
    assert not verdict.infeasible
    if verdict.upper is not None:
        assert verdict.lower <= verdict.upper, path
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
    # Proofs about any curve are attacked in test_forged_any_curve.py, trees of steps in
    # test_cubic_attacks.py.
    declared = {k for k in PROOFS if verdict.proof_kind(k).subject is Subject.DECLARED}
    assert {*KINDS, "cubic"} == declared


@pytest.mark.parametrize("kind", KINDS)
def test_no_mutation_proves_a_false_statement(kind: str) -> None:
    assert verify(document(kind)).proves
    outcomes = mutate(kind, 4, 7)
    assert outcomes["refused"] > 15
    assert outcomes["still proves"] > 3


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_thousand_mutations_of_each_field_prove_nothing_false(kind: str) -> None:
    outcomes = mutate(kind, 1000, 11)
    assert outcomes["refused"] > 5000
    assert outcomes["still proves"] > 500


def positive(poly: list[Fraction], high: Fraction) -> bool:
    return nonnegative(poly, high, Clock(60.0))


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
    data["proof"]["tree"] = way * 1_000_000
    verdict = verify(data)
    assert not verdict.proves
    assert not verdict.out_of_time
