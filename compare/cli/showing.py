"""The command `show`: one case file."""

from __future__ import annotations

from pathlib import Path

from rich.console import RenderableType

from ...problem.cases import (
    AnyClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    TotalTimeClaim,
)
from ..documents import ShowDocument, json_text, show_document
from .input import read_case
from .output import emit, new_output
from .table import Columns, line


def show_case(
    source: str, problem: str | None, reading: str | None, as_json: bool, out: Path | None
) -> int:
    """Show one case."""
    with new_output(out) as write:
        document = show_document(read_case(source), problem, reading)
        write(json_text(document))
    emit(document, _tables, as_json)
    return 0


def _tables(document: ShowDocument) -> list[RenderableType]:
    source, robot = document.source, document.robot
    named = (source.authors, source.title, source.journal, source.year, source.doi)
    cited = ". ".join(str(part).rstrip(".") for part in named if part)
    lines = [
        document.title,
        *([cited] if cited else []),
        f"{robot.name}, joints {', '.join(robot.joints)}",
        "",
    ]
    problems = [(p.id, p.title or p.why) for p in document.problems]
    readings = [(r.id + (" (default)" if r.default else ""), r.why) for r in document.readings]
    parts: list[RenderableType] = [
        line(document.id, "bold"),
        *(line(said) for said in lines),
        Columns(("problem", "~title"), problems),
        Columns(("reading", "~why it is admissible"), readings),
    ]
    if document.claims:
        claims = [(c.id, c.quantity, _stated(c), c.where) for c in document.claims]
        parts.append(Columns(("claim", "quantity", "printed", "…where"), claims))
    if document.assumptions:
        choices = [(a.id, a.choice) for a in document.assumptions]
        parts.append(Columns(("left open", "…what was chosen"), choices))
    return parts


def _stated(claim: AnyClaim) -> str:
    """The printed digits of a claim."""
    match claim:
        case DurationsClaim() | MaximumClaim():
            total = "" if claim.total is None else f", total {claim.total}"
            return " ".join(map(str, claim.durations)) + total
        case TotalTimeClaim():
            return str(claim.value)
        case PeakClaim():
            return " ".join(map(str, claim.printed))
        case ImprovementClaim(percent=percent) if percent is not None:
            return f"{percent} %"
        case ImprovementClaim(seconds=seconds) if seconds is not None:
            return str(seconds)
        case ConvergenceClaim():
            return str(claim.iterations)
    return ""
