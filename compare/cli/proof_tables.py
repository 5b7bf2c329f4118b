"""One-screen summaries of what `solve --certify` and `verify` prove."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rich.console import RenderableType

from ...nlp import Outcome
from ...problem import Case, shown_bound
from ..audits import asked_as, in_words
from ..documents import (
    UNNAMED,
    AskedQuestion,
    CertifiedResult,
    CertifyDocument,
    VerifyDocument,
    Why,
)
from .result_tables import by_question
from .table import line, plain

_PROVED: dict[str, str] = {Outcome.INFEASIBLE: "infeasible: proved", Outcome.OPEN: "nothing proved"}
"""Outcomes whose word alone might be taken for a guess."""
_BOUNDED = "no motion proved"
"""Of an open outcome whose lower bound is proved."""
_COLUMNS = (">lower s", ">upper s", ">gap", ">nodes", ">open", ">seconds", "outcome")
"""What the table says of each interval."""


def certified(document: CertifyDocument, case: Case) -> list[RenderableType]:
    """Summary of the `solve --certify` document."""
    results = document.intervals
    if not results:
        return [line("nothing was begun", "dim")]
    apart = any(r.joint is not None for r in results)
    rows: dict[tuple[str, str], list[Sequence[object]]] = {}
    for r in results:
        row = ((r.joint or "all",) if apart else ()) + _cells(r)
        rows.setdefault((r.problem, r.reading), []).append(row)
    columns = (("joint",) if apart else ()) + _COLUMNS
    parts: list[RenderableType] = [line(results[0].case, "bold")]
    parts += by_question(rows, columns, apart, case)
    reasons = dict.fromkeys(r.outcome_why for r in results if r.outcome_why)
    parts += [line(reason, "dim") for reason in reasons]
    return parts + [line(f"go on with --resume {r.state}") for r in results if r.state]


def _cells(result: CertifiedResult) -> tuple[object, ...]:
    gap, seconds = result.gap, result.seconds
    bounded = result.outcome == Outcome.OPEN and Fraction(result.lower_exact or 0) > 0
    return (
        _bound(result.lower_exact, "lower"),
        _bound(result.upper_exact, "upper"),
        "" if isinstance(gap, Why) else f"{gap:.1e}",
        *("" if isinstance(n, Why) else n for n in (result.nodes, result.open_nodes)),
        "" if isinstance(seconds, Why) else f"{seconds:.1f}",
        _BOUNDED if bounded else _PROVED.get(result.outcome, result.outcome),
    )


def _bound(exact: str | None, side: str) -> str:
    """Nine decimals, rounded outwards."""
    return "none" if exact is None else shown_bound(Fraction(exact), side, places=9)


def verified(document: VerifyDocument, case: Case | None) -> str:
    """Text of the `verify` document: a line a file, whatever the window, and what was asked.

    A file's problem has the ids that the file names; in the case it is called by words, with ids
    only where the file names other ones.
    """
    lines = []
    for one in document.verified:
        lines.append(f"{one.file}: {one.worth}: {one.reason}")
        if one.problem_hash is not None:
            lines.append(f"    {_asked(one.question)}; problem sha256 {one.problem_hash}")
        if isinstance(one.in_case, AskedQuestion):
            found = _found(one.in_case, one.question, case)
            lines.append(f"    the same problem as in the case: {found}")
        elif one.in_case.reason not in (UNNAMED, one.worth):
            lines.append(f"    not in the case: {one.in_case.reason}")
    return "".join(f"{plain(line)}\n" for line in lines)


def _found(found: AskedQuestion, named: AskedQuestion, case: Case | None) -> str:
    """A question of a case in words."""
    if case is None or found.problem is None or found.reading is None:
        return _asked(found)
    ids = (found.problem, found.reading)
    words = in_words if ids == (named.problem, named.reading) else asked_as
    joint = "" if found.joint is None else f"joint {found.joint} alone; "
    return f"{joint}{words(case, *ids)}"


def _asked(question: AskedQuestion) -> str:
    named = {
        "case": question.case,
        "problem": question.problem,
        "reading": question.reading,
        "joint": question.joint,
    }
    parts = (f"{key} {value}" for key, value in named.items() if value is not None)
    return ", ".join(parts) or "a problem without a case"
