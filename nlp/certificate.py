"""Certificates as JSON: the problem, the claim, and for every box the rows that prove it."""

from __future__ import annotations

import importlib.metadata
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..problem import TrajgapError
from .certify import Certified, State
from .exact import ExactProblem, Real
from .rest_to_rest import SegmentBound
from .three_piece import Row
from .verify import FORMAT, seal

MOST_BYTES = 200_000


def decimal(number: Fraction) -> str:
    """Exact text of a rational: a decimal where it ends, a quotient otherwise."""
    digits, rest = 0, number.denominator
    for prime in (2, 5):
        count = 0
        while rest % prime == 0:
            rest //= prime
            count += 1
        digits = max(digits, count)
    if rest != 1 or digits > 60:
        return f"{number.numerator}/{number.denominator}"
    whole = abs(number) * 10**digits
    text = str(whole.numerator).rjust(digits + 1, "0")
    sign = "-" if number < 0 else ""
    return sign + (f"{text[:-digits]}.{text[-digits:]}" if digits else text)


def _real(value: Real | None) -> str | dict[str, Any] | None:
    if value is None:
        return None
    text = decimal(value.rational)
    return text if value.pi == 0 else {"value": text, "pi": value.pi}


def problem_document(problem: ExactProblem) -> dict[str, Any]:
    """The problem as it stands in a certificate.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    dict
        JSON-ready; every number as exact text.
    """
    interpolant = problem.interpolant
    return {
        "name": problem.name,
        "unit": problem.unit,
        "joints": list(problem.joints),
        "degrees": list(interpolant.degrees),
        "continuity": list(interpolant.continuity),
        "prescribed": [
            [[order, decimal(Fraction(value))] for order, value in entries]
            for entries in interpolant.prescribed
        ],
        "virtual": list(interpolant.virtual),
        "waypoints": [[decimal(q) for q in row] for row in problem.waypoints],
        "limits": [[_real(x) for x in row] for row in problem.limits],
        "position_lower": [_real(x) for x in problem.position_lower],
        "position_upper": [_real(x) for x in problem.position_upper],
        "duration_lower": [decimal(x) for x in problem.duration_lower],
        "duration_upper": [None if x is None else decimal(x) for x in problem.duration_upper],
    }


def certificate(certified: Certified) -> dict[str, Any]:
    """Certificate of a proved interval, ready for JSON.

    Parameters
    ----------
    certified : Certified
        With a proof (``state``).

    Returns
    -------
    dict

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    if certified.segments is not None:
        proof = _closed_form(certified.segments)
    elif certified.state is not None:
        proof = _boxes(certified.state)
    else:
        raise TrajgapError("certificate: nothing is proved; give more time")
    problem = problem_document(certified.problem)
    durations, upper = certified.durations, certified.upper
    document: dict[str, Any] = {
        "format": FORMAT,
        "made_by": f"trajgap {importlib.metadata.version('trajgap')}",
        "problem": problem,
        "problem_hash": seal(problem),
        "claim": {
            "lower": decimal(certified.lower),
            "upper": None if upper is None else decimal(upper),
            "durations": None if durations is None else [decimal(h) for h in durations],
        },
        "proof": proof,
    }
    return {**document, "seal": seal(document)}


def _closed_form(bounds: tuple[SegmentBound, ...]) -> dict[str, Any]:
    return {"segments": [[b.joint, b.order, b.place, decimal(b.least)] for b in bounds]}


def _boxes(state: State) -> dict[str, Any]:
    tree, order = _tree(state)
    rows: dict[Row, int] = {}
    leaves = []
    for n in order:
        proof = state.proofs[n]
        assert proof is not None
        leaf: list[int | str] = []
        for row, weight in zip(*proof, strict=True):
            leaf += [rows.setdefault(row, len(rows)), _weight(weight)]
        leaves.append(leaf)
    return {
        "total": decimal(state.target),
        "rows": [[r.kind, r.joint, r.order, r.sign, r.place, r.cap] for r in rows],
        "tree": tree,
        "leaves": leaves,
    }


def write_certificate(certified: Certified, path: str | Path) -> int:
    """Write a certificate.

    Parameters
    ----------
    certified : Certified
    path : str or Path

    Returns
    -------
    int
        Its size in bytes.

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    text = json.dumps(certificate(certified), separators=(",", ":"), ensure_ascii=False)
    # One key a line keeps a diff readable.
    text = text.replace(',"problem', ',\n"problem').replace(',"claim"', ',\n"claim"')
    text = text.replace(',"proof"', ',\n"proof"').replace(',"tree"', ',\n"tree"')
    text = text.replace(',"leaves"', ',\n"leaves"').replace(',"seal"', ',\n"seal"') + "\n"
    Path(path).write_text(text, encoding="utf-8")
    return len(text.encode())


def shipped_folder() -> Path:
    """Folder of the certificates that come with the package."""
    return Path(__file__).parent / "certificates"


def shipped(problem: ExactProblem) -> dict[str, Any] | None:
    """Certificate of exactly this problem that comes with the package, not yet proved again.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    dict or None
    """
    wanted = seal(problem_document(problem))
    for path in sorted(shipped_folder().glob("*.json")):
        document: dict[str, Any] = json.loads(path.read_text("utf-8"))
        if document.get("problem_hash") == wanted:
            return document
    return None


def _weight(weight: Fraction) -> str:
    text = decimal(weight)
    short = f"{float(weight):.4g}"
    return short if len(short) < len(text) and Fraction(short) == weight else text


def _tree(state: State) -> tuple[str, list[int]]:
    """Bisection tree in preorder, and the leaves in its order."""
    letters: list[str] = []
    order: list[int] = []
    boxes = [(*state.boxes.level[n], *state.boxes.index[n]) for n in range(len(state.boxes))]
    stack = [((0, 0), (0, 0), list(range(len(boxes))))]
    while stack:
        level, index, members = stack.pop()
        if len(members) == 1:
            letters.append(".")
            order.append(members[0])
            continue
        axis = next(x for x in (0, 1) if all(boxes[n][x] > level[x] for n in members))
        halves: tuple[list[int], list[int]] = ([], [])
        deeper = level[axis] + 1
        for n in members:
            halves[(boxes[n][2 + axis] >> (boxes[n][axis] - deeper)) & 1].append(n)
        for side in (1, 0):
            where = list(index)
            where[axis] = 2 * index[axis] + side
            depth = (deeper, level[1]) if axis == 0 else (level[0], deeper)
            stack.append((depth, (where[0], where[1]), halves[side]))
        letters.append("ab"[axis])
    return "".join(letters), order
