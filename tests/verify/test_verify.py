"""The verifier: no alteration of a number, with the hash left aside, proves a false statement."""

from __future__ import annotations

import copy
import json
from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.alterations import Path_, changed, fields, get, put
from support.certificate_kinds import KINDS, stated, text
from support.shipped_problems import COVERED_PROBLEMS
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import shipped, write_certificate
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.problem import Limits, Problem, three_five_three
from trajgap.verify import CERTIFICATE_FORMAT, Subject, seal, verdict
from trajgap.verify import verify_certificate as verify
from trajgap.verify.curve import nonnegative
from trajgap.verify.reading import Clock
from trajgap.verify.verdict import KINDS as PROOFS


def document(kind: str = "three-piece") -> dict[str, Any]:
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
    declared = {k for k in PROOFS if verdict._proof_kind(k).subject is Subject.DECLARED}
    assert {*KINDS, "cubic"} == declared


SIBLING = "four-three-four"
"""Proved by the steps of the three-piece kind, which is attacked in its place where it is quick."""


@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=[pytest.mark.slow] if k == SIBLING else []) for k in KINDS]
)
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


def scaled(node: Any, factor: Fraction) -> Any:
    """Every number in a part of a document times a factor."""
    if isinstance(node, list):
        return [scaled(x, factor) for x in node]
    if isinstance(node, dict):
        return {**node, "value": scaled(node["value"], factor)}
    return None if node is None else str(Fraction(node) * factor)


def by(node: dict[str, Any], key: str, change: str) -> None:
    node[key] = scaled(node[key], 1 + Fraction(change))


def raise_proof(data: dict[str, Any]) -> None:
    proof = data["proof"]
    if proof["kind"] in ("rest-to-rest", "stretched"):
        leaf = proof["tree"][0]
        leaf[1:] = [[*row[:3], scaled(row[3], 1 + Fraction("1e-9"))] for row in leaf[1:]]
        by(proof, "total", "1e-9")
    else:
        by(proof, "total", "1e-5")
    by(data["claim"], "lower", "1e-9")


def raise_total(data: dict[str, Any]) -> None:
    by(data["proof"], "total", "1e-5")
    by(data["claim"], "lower", "1e-9")


def shorten(data: dict[str, Any]) -> None:
    by(data["claim"], "durations", "-1e-3")
    by(data["claim"], "upper", "-1e-3")


def declare_infeasible(data: dict[str, Any]) -> None:
    data["claim"] |= {"infeasible": True, "upper": None, "durations": None}


def cut(data: dict[str, Any]) -> None:
    tree = data["proof"]["tree"]
    last = tree[-1]
    data["proof"]["tree"] = [*tree[:-1], last[:-1]] if len(tree) == 1 else tree[:-1]


def leave_open(data: dict[str, Any]) -> None:
    data["proof"]["tree"][-1] = ["?"]


def one_box(data: dict[str, Any]) -> None:
    leaves = [node for node in data["proof"]["tree"] if isinstance(node, list)]
    widest = max(leaves, key=len)
    data["proof"]["tree"] = [widest if len(leaves) > 1 else widest[:2]]


def no_limits(data: dict[str, Any]) -> None:
    data["problem"]["limits"] = [[None] * 3 for _ in data["problem"]["limits"]]


Tampering = Callable[[dict[str, Any]], None]
TAMPERED: list[tuple[str, Tampering, str]] = [
    ("lower above the proof", lambda d: by(d["claim"], "lower", "1e-9"), "exceeds the total"),
    ("proof and lower raised", raise_proof, "not proved"),
    ("total and lower raised", raise_total, "not proved"),
    ("upper below its durations", lambda d: by(d["claim"], "upper", "-1e-9"), "exceed the upper"),
    ("shorter durations", shorten, "answer: "),
    ("tighter limits, old answer", lambda d: by(d["problem"], "limits", "-1e-4"), "answer: "),
    ("looser limits, old bound", lambda d: by(d["problem"], "limits", "1e-3"), "not proved"),
    (
        "way-points nearer, old bound",
        lambda d: by(d["problem"], "waypoints", "-1e-3"),
        "not proved",
    ),
    ("way-points farther, old answer", lambda d: by(d["problem"], "waypoints", "1e-3"), "answer: "),
    ("called infeasible", declare_infeasible, "infeasible only"),
    ("said of any curve", lambda d: d["claim"].update(subject="any curve"), "speaks about"),
    ("a branch cut off", cut, ""),
    ("a branch left open", leave_open, "leaves a part open"),
    ("one box that stands for all", one_box, ""),
    ("limits that are not there", no_limits, "not there"),
]


def tampered(data: dict[str, Any], tamper: Tampering) -> tuple[bool, str]:
    """Verdict on an altered copy whose hashes were made right again."""
    data = copy.deepcopy(data)
    tamper(data)
    data["problem_hash"] = seal(data["problem"])
    data["seal"] = seal({key: x for key, x in data.items() if key != "seal"})
    verdict = verify(data)
    assert not verdict.altered, "only the mathematics may refuse it"
    return verdict.proves, verdict.reason


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("tamper", "reason"), [t[1:] for t in TAMPERED], ids=[t[0] for t in TAMPERED]
)
def test_what_favours_the_claim_is_refused(kind: str, tamper: Tampering, reason: str) -> None:
    # Among the shipped ones, if possible: their interval is narrow and their numbers are printed.
    name = next((n for n, e in COVERED_PROBLEMS.items() if shipped_kind(e) == kind), None)
    data = document(kind) if name is None else shipped(COVERED_PROBLEMS[name])
    assert data is not None
    proves, why = tampered(data, tamper)
    assert not proves
    assert reason in why


def shipped_kind(exact: ExactProblem) -> str | None:
    data = shipped(exact)
    return None if data is None else str(data["proof"]["kind"])


@pytest.mark.slow
def test_what_favours_the_claim_is_refused_of_every_shipped_certificate() -> None:
    for name, exact in COVERED_PROBLEMS.items():
        data = shipped(exact)
        assert data is not None
        for what, tamper, reason in TAMPERED:
            proves, why = tampered(data, tamper)
            assert not proves, f"{name}: {what}"
            assert reason in why, f"{name}: {what}: {why}"


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


def test_a_harmless_change_is_reported() -> None:
    data = document()
    data["claim"]["lower"] = str(Fraction(data["claim"]["lower"]) * Fraction(99, 100))
    verdict = verify(data)
    assert verdict.proves
    assert verdict.altered
    assert str(verdict).startswith("altered, still proves")


def test_a_file_is_proved(tmp_path: Path) -> None:
    q = np.array([[0.25], [1.0], [-0.375], [0.5]])
    found = certify(Problem(q, Limits(1.0, 2.0), three_five_three()), gap=0.1)
    path = tmp_path / "certificate.json"
    assert write_certificate(found, path) == path.stat().st_size < 20_000
    verdict = verify(path)
    assert str(verdict).startswith("proves: ")
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", "1", '{"format": "trajgap-certificate-2"}', '{"a": NaN}', "[" * 99_999]
)
def test_a_malformed_file_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "broken.json"
    path.write_text(text)
    verdict = verify(path)
    assert not verdict.proves
    assert str(verdict).startswith("refused: ")
    assert not verify(tmp_path / "missing.json").proves


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "no JSON; name a certificate"),
        ("[case]", "no JSON; name a certificate"),
        ("[1]", "no JSON object; name a certificate"),
        ("{}", f"no {CERTIFICATE_FORMAT}; name a certificate"),
        (
            f'{{"format": "{CERTIFICATE_FORMAT}", "claim": {{}}, "question": 1, "made_by": ""}}',
            "malformed: the file: problem, problem_hash, proof, seal: missing",
        ),
    ],
)
def test_what_is_no_certificate_is_refused_in_plain_words(
    tmp_path: Path, text: str, reason: str
) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    assert verify(path).reason == reason
    assert verify(tmp_path).reason == "cannot be read (Is a directory); check the path"
    missing = verify(tmp_path / "missing.json").reason
    assert missing == "cannot be read (No such file or directory); check the path"


def test_a_key_named_twice_is_refused(tmp_path: Path) -> None:
    # Readers of the file may take the first value, and json takes the last.
    path = tmp_path / "twice.json"
    text = json.dumps(document())
    path.write_text(text.replace('"limits": ', '"limits": [], "limits": ', 1))
    verdict = verify(path)
    assert not verdict.proves
    assert "twice" in verdict.reason
    path.write_text(text)
    assert verify(path).proves


@pytest.mark.parametrize("way", [[0], [1, ["."]], [0, 1, ["."], ["."]]])
def test_an_endless_tree_is_refused(way: list[Any]) -> None:
    data = document()
    # A weight of 0 for one row and of 1 for itself: no leaf is proved by it.
    data["proof"]["tree"] = way * 1_000_000
    verdict = verify(data)
    assert not verdict.proves
    assert not verdict.out_of_time


@pytest.mark.parametrize(("cuts", "proves"), [(100, True), (300, False)])
def test_a_tree_of_slivers_is_refused(cuts: int, proves: bool) -> None:
    # A least duration above the total proves every box, so that only the digits of places grow.
    data = document()
    data["problem"]["duration_lower"][0] = "5"
    data["claim"] |= {"lower": "0.5", "upper": None, "durations": None}
    leaf = [".", 0, "1"]
    rows = [["lower", 0, 1, 1, 0, -1]]
    tree = [*[1, leaf] * cuts, leaf]
    data["proof"] |= {"total": "0.5", "rows": rows, "tree": tree}
    verdict = verify(data)
    assert verdict.proves == proves
    assert proves or "the tree is too deep" in verdict.reason
