"""One-screen summaries of what `solve --certify` and `verify` prove."""

from __future__ import annotations

from typing import Any

from rich.console import RenderableType

from .cli_summary import _Columns, _line, plain

Document = dict[str, Any]

_PROVED = {"infeasible": "infeasible: proved", "open": "nothing proved"}
_COLUMNS = (">lower s", ">upper s", ">gap", ">nodes", ">open", ">seconds", "outcome")


def certified(document: Document) -> list[RenderableType]:
    """Summary of the `solve --certify` document."""
    results = document["certified"]
    if not results:
        return [_line("nothing was begun", "dim")]
    joint = any(r["joint"] is not None for r in results)
    head = ("problem", "reading", *(("joint",) if joint else ()), *_COLUMNS)
    rows = [
        (
            r["problem"],
            r["reading"],
            *((r["joint"] or "all",) if joint else ()),
            *(_bound(r[key]) for key in ("lower", "upper")),
            "" if r["gap"] is None else f"{r['gap']:.1e}",
            *("" if r[key] is None else r[key] for key in ("nodes", "open_nodes")),
            "" if r["seconds"] is None else f"{r['seconds']:.1f}",
            _PROVED.get(r["outcome"], r["outcome"]),
        )
        for r in results
    ]
    parts: list[RenderableType] = [_line(results[0]["case"], "bold"), _Columns(head, rows)]
    reasons = dict.fromkeys(
        f"{r['outcome']}: {r['outcome_why']} ({r['problem']}, {r['reading']})"
        for r in results
        if r["outcome_why"]
    )
    parts += [_line(reason, "dim") for reason in reasons]
    return parts + [_line(f"go on with --resume {r['state']}") for r in results if r["state"]]


def _bound(value: float | None) -> str:
    return "none" if value is None else f"{value:.9f}"


def verified(document: Document) -> str:
    """Text of the `verify` document: one line a file, whatever the window."""
    lines = (f"{one['file']}: {one['worth']}: {one['reason']}" for one in document["verified"])
    return "".join(f"{plain(line)}\n" for line in lines)
