"""A forged document: a certificate with some values replaced, for one check of the verifier."""

import ast
import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.small_certificates import rest_to_rest, sealed
from trajgap import verify
from trajgap.verify import STATE_FORMAT, CertificateVerdict, reading, verify_certificate

Document = dict[str, Any]
Changes = dict[str, Any] | Callable[[Document], None]
FOLDER = Path(verify.__file__).resolve().parent
"""Where the verifier that judges was installed, which is not always the checkout."""
KEPT = Path(__file__).with_name("certificates")
FORGED = Path(__file__).with_name("forged")
GONE = object()
"""Stands for a value that is taken out."""
NO_ANSWER = {"claim.durations": None, "claim.upper": None, "claim.speeds": None}
B_SPLINE_AT_RATIOS = {
    **NO_ANSWER,
    "problem.ratios": ["4", "7", "5"],
    "proof.kind": "fixed-ratios",
    "proof.tree": [[".", 0, 2, 2, 0]],
    "claim.lower": "5",
}
"""The last segment alone needs 1.60147811188824 s, which is 5/16 of 5.12472995804 s."""
_HANDS_ON = ("need", "required")
"""Functions that refuse for whoever calls them."""


@dataclass(frozen=True)
class Forgery:
    """What is refused by one check, and by none before it.

    Attributes
    ----------
    check : str
        Module and function of the check with its message, as `checks` names it.
    base : str
        "by hand", "state", or the name of a committed certificate; "file" for a file's content.
    changes : dict or callable
        New values by path; of a file: its content, or its path.
    patch : dict
        Values in modules of the verifier that are replaced while it judges.
    spread : callable or None
    """

    check: str
    base: str
    changes: Any
    patch: dict[str, Any] = field(default_factory=dict)
    spread: Any = None


def listed() -> list[Forgery]:
    """The forgeries of `forged/`: below each check, by certificate, values by path as JSON.

    With "no answer" the answer is taken out too; "beyond" gives the least and the largest whole
    number allowed, and stands for one below and one above.
    """
    found: list[Forgery] = []
    for file in sorted(FORGED.glob("*.txt")):
        check = ""
        for line in file.read_text("utf-8").splitlines():
            if line.startswith("= "):
                check = line.removeprefix("= ")
            elif line and not line.startswith("#"):
                named, _, text = line.partition(": ")
                base, _, word = named.partition(", ")
                changes = json.loads(text)
                if word == "beyond":
                    ((path, (low, high)),) = changes.items()
                    found += [Forgery(check, base, {path: x}) for x in (low - 1, high + 1)]
                else:
                    assert word in ("", "no answer"), line
                    found.append(Forgery(check, base, (NO_ANSWER if word else {}) | changes))
    return found


def spline(n: int, degree: int = 3, joints: int = 1) -> Callable[[Document], None]:
    """A spline of so many equal segments, as smooth as its degree allows, without an answer."""

    def altered(data: Document) -> None:
        rest = [[order, "0"] for order in range(1, (degree + 1) // 2)]
        data["problem"] |= {
            "degrees": [degree] * n, "continuity": [degree - 1] * (n - 1),
            "prescribed": [rest, *[[]] * (n - 1), rest], "virtual": [],
            "joints": [str(j) for j in range(joints)], "limits": [["1", "2", None]] * joints,
            "position_lower": [None] * joints, "position_upper": [None] * joints,
            "waypoints": [[str(k)] * joints for k in range(n + 1)],
            "duration_lower": ["0"] * n, "duration_upper": [None] * n,
        }  # fmt: skip
        data["claim"] |= {"durations": None, "upper": None}

    return altered


@cache
def _kept(name: str) -> str:
    return (KEPT / f"{name}.json").read_text("utf-8")


def document(base: str) -> Document:
    """A certificate to alter."""
    if base == "by hand":
        return deepcopy(rest_to_rest())
    if base == "state":
        data = deepcopy(rest_to_rest())
        data |= {"format": STATE_FORMAT, "proof": None, "proposals": None}
        data["claim"]["lower"] = "0"
        return data
    return dict(json.loads(_kept(base)))


def altered(base: str, changes: Changes) -> Document:
    """A certificate with new values and right hashes, so mathematics alone may refuse it."""
    data = document(base)
    if callable(changes):
        changes(data)
        return sealed(data)
    for path, value in changes.items():
        node: Any = data
        *way, last = [int(key) if key.lstrip("-").isdigit() else key for key in path.split(".")]
        for key in way:
            node = node[key]
        if value is GONE:
            del node[last]
        else:
            node[last] = deepcopy(value)
    return sealed(data)


def judged(forgery: Forgery, folder: Path, patch: pytest.MonkeyPatch) -> CertificateVerdict:
    """The verdict on a forged document."""
    source: Any = forgery.changes
    if forgery.base == "file":
        if isinstance(source, bytes):
            path = folder / "certificate.json"
            path.write_bytes(source)
            source = path
        elif callable(source):
            source = source(folder)
    else:
        source = altered(forgery.base, source)
    for name, value in forgery.patch.items():
        patch.setattr(f"trajgap.verify.{name}", value)
    return verify_certificate(source, spread=forgery.spread)


Place = tuple[str, int, int]
"""Path in the folder, line and column."""


@cache
def checks() -> dict[Place, str]:
    """Every place where the verifier refuses, with its function and message."""
    found: dict[Place, str] = {}
    seen: Counter[str] = Counter()
    for path in sorted(FOLDER.rglob("*.py")):
        name = path.relative_to(FOLDER).as_posix()
        for node, function in _calls(ast.parse(path.read_text("utf-8")), ()):
            if name == "reading.py" and function in _HANDS_ON:
                continue
            said = ast.unparse(node.args[-1])
            words = f"{name.removesuffix('.py')}.{function}: {said.lstrip('f').strip(said[-1])}"
            seen[words] += 1
            times = f" ({seen[words]})" if seen[words] > 1 else ""
            found[name, node.lineno, node.col_offset] = words + times
    return found


def _calls(node: ast.AST, inside: tuple[str, ...]) -> Iterator[tuple[ast.Call, str]]:
    for child in ast.iter_child_nodes(node):
        called = child.func if isinstance(child, ast.Call) else None
        if isinstance(called, ast.Name) and called.id in (*_HANDS_ON, "Refused"):
            assert isinstance(child, ast.Call)
            yield child, ".".join(inside)
        named = isinstance(child, ast.FunctionDef | ast.ClassDef)
        yield from _calls(child, (*inside, child.name) if named else inside)  # type: ignore[attr-defined]


@contextmanager
def recorded(patch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """The checks that refuse something, in their order."""
    fired: list[str] = []
    plain = reading.Refused.__init__

    def init(refused: reading.Refused, *words: str) -> None:
        plain(refused, *words)
        frame = sys._getframe(1)
        while frame.f_code.co_name in _HANDS_ON and frame.f_back is not None:
            frame = frame.f_back
        line, _, column, _ = list(frame.f_code.co_positions())[frame.f_lasti // 2]
        name = Path(frame.f_code.co_filename).resolve().relative_to(FOLDER).as_posix()
        fired.append(checks()[name, line, column])

    with patch.context() as own:
        own.setattr(reading.Refused, "__init__", init)
        yield fired
