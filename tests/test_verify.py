"""The verifier: no alteration of a number, with the hash left aside, proves a false statement."""

from __future__ import annotations

import ast
import copy
import json
import sys
from fractions import Fraction
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from trajgap.nlp.certificate import certificate, shipped, write_certificate
from trajgap.nlp.certify import certify
from trajgap.nlp.verify import seal, verify
from trajgap.problem import Limits, Problem, three_five_three

from tests.test_certify import POSED, dense_best

Path_ = tuple[str | int, ...]


@lru_cache(maxsize=1)
def small() -> str:
    """A certificate with few boxes and every kind of number in it, as JSON."""
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    limits = Limits([1.0, 0.9], [2.0, 1.5], [np.inf, 8.0], [-1.5, -np.inf], [np.inf, 1.75])
    problem = Problem(q, limits, three_five_three(), (0.5, 0.1, 0.1), (6.0, 6.0, 7.0))
    return json.dumps(certificate(certify(problem, gap=0.03)))


def document() -> dict[str, Any]:
    return dict(json.loads(small()))


def places(node: Any, path: Path_ = ()) -> list[Path_]:
    """Path of every number, printed ones too, and of the tree."""
    if isinstance(node, dict):
        return [p for key, x in node.items() for p in places(x, (*path, key))]
    if isinstance(node, list):
        return [p for i, x in enumerate(node) for p in places(x, (*path, i))]
    if isinstance(node, bool) or node is None:
        return []
    if isinstance(node, int):
        return [path]
    numeric = path[0] in ("problem", "claim", "proof") and any(c.isdigit() for c in node)
    return [path] if numeric or path[-1] == "tree" else []


def changed(value: Any, rng: np.random.Generator) -> Any:
    if isinstance(value, int):
        return int(rng.choice([value + 1, value - 1, -value, int(rng.integers(0, 20_000)), 0]))
    if set(value) <= set("ab."):
        k = int(rng.integers(0, len(value)))
        return value[:k] + str(rng.choice(["a", "b", ".", "", "..", "x"])) + value[k + 1 :]
    try:
        number = Fraction(value)
    except ValueError:
        return value
    factor = 1 + Fraction(float(rng.choice([1, -1]) * 10 ** rng.uniform(-9, 0.5)))
    changed = rng.choice(5)
    if changed == 0:
        number = -number
    elif changed == 1:
        number = number + Fraction(float(rng.normal()))
    elif changed == 2:
        number = Fraction(0)
    else:
        number = number * factor
    return f"{number.numerator}/{number.denominator}" if len(str(number)) < 300 else "7"


def put(data: dict[str, Any], path: Path_, value: Any) -> None:
    node: Any = data
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value


def get(data: dict[str, Any], path: Path_) -> Any:
    node: Any = data
    for key in path:
        node = node[key]
    return node


def stated(data: dict[str, Any]) -> Problem:
    """The problem in a certificate, by a second route."""
    p = data["problem"]

    def numbers(row: list[Any], absent: float) -> list[float]:
        return [absent if x is None else float(Fraction(x)) for x in row]

    v, a, j = np.array([numbers(row, np.inf) for row in p["limits"]]).T
    limits = Limits(
        v, a, j, numbers(p["position_lower"], -np.inf), numbers(p["position_upper"], np.inf)
    )
    return Problem(
        np.array([numbers(row, 0.0) for row in p["waypoints"]]),
        limits,
        three_five_three(),
        numbers(p["duration_lower"], 0.0),
        numbers(p["duration_upper"], np.inf),
    )


def mutate_all(per_place: int, seed: int) -> dict[str, int]:
    rng = np.random.default_rng(seed)
    base = document()
    optimum = dense_best(stated(base), 81)
    counts = {"refused": 0, "still proves": 0}
    for path in places(base):
        for _ in range(per_place):
            data = copy.deepcopy(base)
            put(data, path, changed(get(data, path), rng))
            if data == base:
                continue
            verdict = verify(data)
            if not verdict.proves:
                counts["refused"] += 1
                continue
            counts["still proves"] += 1
            assert verdict.altered
            assert str(verdict).startswith("altered, still proves")
            assert verdict.lower is not None
            # The statement must be true of the problem now in the file.
            same = data["problem"] == base["problem"]
            best = optimum if same else dense_best(stated(data), 81)
            assert float(verdict.lower) <= best * (1 + 1e-9), path
            if verdict.upper is not None:
                assert verdict.lower <= verdict.upper, path
    return counts


def test_no_mutation_proves_a_false_statement() -> None:
    counts = mutate_all(1, 7)
    assert counts["refused"] > 50
    assert counts["still proves"] > 5


@pytest.mark.slow
def test_a_thousand_mutations_of_the_claim_prove_nothing_false() -> None:
    rng = np.random.default_rng(11)
    base = document()
    best = dense_best(stated(base))
    wanted = [p for p in places(base) if p[0] == "claim"]
    for path in wanted:
        for _ in range(1000):
            data = copy.deepcopy(base)
            put(data, path, changed(get(data, path), rng))
            verdict = verify(data)
            if verdict.proves and verdict.lower is not None:
                assert float(verdict.lower) <= best * (1 + 1e-9), path
                assert verdict.upper is None or float(verdict.upper) >= best * (1 - 1e-2)


TAMPERED: list[tuple[str, Path_, Any, str]] = [
    ("a lower bound above the proof", ("claim", "lower"), "+1e-9", "exceeds the total"),
    ("a larger total", ("proof", "total"), "+1e-5", "leaf"),
    ("an upper bound without its durations", ("claim", "upper"), "-1e-9", "exceed"),
    ("a shorter first duration", ("claim", "durations", 0), "-1e-7", "limit"),
    ("a shorter last duration", ("claim", "durations", 2), "-1e-7", "limit"),
    ("a smaller limit with the old answer", ("problem", "limits", 0, 1), "-1e-6", "limit"),
    ("a larger limit with the old bound", ("problem", "limits", 0, 1), "+1e-3", "leaf"),
    ("a way-point moved nearer", ("problem", "waypoints", 1, 0), "-2e-2", "leaf"),
    ("a branch cut off", ("proof", "tree"), "cut", "leaves"),
    ("a box that stands for all", ("proof", "tree"), ".", "leaves"),
    ("a limit that is not there", ("problem", "limits", 0, 1), None, "not there"),
]


@pytest.mark.parametrize(
    ("what", "path", "change", "reason"), TAMPERED, ids=[t[0] for t in TAMPERED]
)
def test_what_favours_the_claim_is_refused(
    what: str, path: Path_, change: str | None, reason: str
) -> None:
    found = shipped(POSED["puma560-mnam-pso-353.six-joints.durations-positive.joint-1"])
    assert found is not None
    data = copy.deepcopy(found)
    value: Any = change
    if change == "cut":
        value = get(data, path)[:-1]
    elif change is not None and change != ".":
        value = get(data, path)
        text = str(Fraction(value) * (1 + Fraction(change.removeprefix("+"))))
        value = text
    put(data, path, value)
    data["problem_hash"] = seal(data["problem"])
    data["seal"] = seal({key: x for key, x in data.items() if key != "seal"})
    verdict = verify(data)
    assert not verdict.proves
    assert not verdict.altered, "only the mathematics may refuse it"
    assert reason in verdict.reason or "leaf" in verdict.reason


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
    "text", ["", "[]", "{}", "1", '{"format": "trajgap-certificate-1"}', '{"a": NaN}', "[" * 99_999]
)
def test_a_malformed_file_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "broken.json"
    path.write_text(text)
    verdict = verify(path)
    assert not verdict.proves
    assert str(verdict).startswith("refused: ")
    assert not verify(tmp_path / "missing.json").proves


def test_the_verifiers_share_no_code_with_the_solver() -> None:
    folder = Path(str(import_module("trajgap.nlp.verify").__file__)).parent
    modules = sorted(folder.glob("verify*.py"))
    assert len(modules) > 3
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                names = [alias.name.partition(".")[0] for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [str(node.module).partition(".")[0]]
            elif isinstance(node, ast.ImportFrom):
                inner = [node.module] if node.module else [alias.name for alias in node.names]
                assert node.level == 1, path
                assert all(str(name).startswith("verify") for name in inner), path
                continue
            else:
                continue
            assert set(names) <= {*sys.stdlib_module_names, "numpy"}, path
