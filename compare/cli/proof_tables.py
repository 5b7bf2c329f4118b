"""One-screen summaries of what `solve --certify` and `verify` prove."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from typing import Any

from rich.console import RenderableType

from ..documents import UNNAMED
from .table import Columns, line, plain

Document = dict[str, Any]

_PROVED = {"infeasible": "infeasible: proved", "open": "nothing proved"}
_COLUMNS = (">lower s", ">upper s", ">gap", ">nodes", ">open", ">seconds", "outcome")


def certified(document: Document) -> list[RenderableType]:
    """Summary of the `solve --certify` document."""
    results = document["intervals"]
    if not results:
        return [line("nothing was begun", "dim")]
    joint = any(r["joint"] is not None for r in results)
    head = ("problem", "reading", *(("joint",) if joint else ()), *_COLUMNS)
    rows = [
        (
            r["problem"],
            r["reading"],
            *((r["joint"] or "all",) if joint else ()),
            _bound(r["lower_exact"], -1),
            _bound(r["upper_exact"], 1),
            "" if r["gap"] is None else f"{r['gap']:.1e}",
            *("" if r[key] is None else r[key] for key in ("nodes", "open_nodes")),
            "" if r["seconds"] is None else f"{r['seconds']:.1f}",
            _PROVED.get(r["outcome"], r["outcome"]),
        )
        for r in results
    ]
    parts: list[RenderableType] = [line(results[0]["case"], "bold"), Columns(head, rows)]
    reasons = dict.fromkeys(r["outcome_why"] for r in results if r["outcome_why"])
    parts += [line(reason, "dim") for reason in reasons]
    return parts + [line(f"go on with --resume {r['state']}") for r in results if r["state"]]


def _bound(exact: str | None, side: int) -> str:
    """Nine decimals, rounded outwards."""
    if exact is None:
        return "none"
    steps = Fraction(exact) * 10**9
    return f"{Decimal(math.floor(steps) if side < 0 else math.ceil(steps)).scaleb(-9):.9f}"


def verified(document: Document) -> str:
    """Text of the `verify` document: a line a file, whatever the window, and what was asked."""
    lines = []
    for one in document["verified"]:
        lines.append(f"{one['file']}: {one['worth']}: {one['reason']}")
        if one["problem_hash"] is not None:
            lines.append(f"    {_asked(one['question'])}; problem sha256 {one['problem_hash']}")
        if one["in_case"] is not None:
            lines.append(f"    the same problem as in the case: {_asked(one['in_case'])}")
        elif one["in_case_why"] not in (UNNAMED, one["worth"]):
            lines.append(f"    not in the case: {one['in_case_why']}")
    return "".join(f"{plain(line)}\n" for line in lines)


def _asked(question: Document) -> str:
    keys = ("case", "problem", "reading", "joint")
    named = (f"{key} {question[key]}" for key in keys if question[key] is not None)
    return ", ".join(named) or "a problem without a case"
