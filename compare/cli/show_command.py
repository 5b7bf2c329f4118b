"""The command `show`: one case file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

from ...problem import BRAKING, Quantity
from ...problem.cases import Case, Reading, Statement, ratio_words, with_unit
from ..audits import claim_text, digits_of
from ..blocks import Block, Prose, table
from ..documents import ShowDocument, capital, quoted, show_document
from .input import read_case
from .options import CaseOptions, PartOptions
from .output import AnswerOptions

_LIMITED = ("velocity", "acceleration", BRAKING, "jerk", "snap")
"""Limits in the order in which they are shown."""


def show(asked: CaseOptions, part: PartOptions, to: AnswerOptions) -> int:
    """Show what a case contains, and what it leaves open."""
    case = read_case(asked.case)
    to.answer(
        lambda: show_document(case, part.problem, part.reading), lambda shown: _tables(shown, case)
    )
    return 0


def _tables(document: ShowDocument, case: Case) -> list[Block]:
    source, robot = document.source, document.robot
    named = (source.authors, source.title, source.journal, source.year, source.doi)
    objective = case.document.objective
    cited = ". ".join(str(part).rstrip(".") for part in named if part)
    lines = [
        *([document.title] if document.title != document.id else []),
        *([cited] if cited else []),
        f"{robot.name}, joint{'s' * (len(robot.joints) > 1)} {', '.join(robot.joints)}",
        *([f"minimised: {objective}, not time alone"] if objective else []),
        "",
    ]
    problems = [(p.id, p.title or p.why or "as stated below") for p in document.problems]
    labels = case.labels
    readings = [
        (r.id + (" (default)" if r.default else ""), _meaning(r, labels)) for r in document.readings
    ]
    parts: list[Block] = [
        Prose(document.id, "heading"),
        *(Prose(said) for said in lines),
        table(("problem", "~title"), problems),
        *_asked(document, case),
        table(("reading", "~meaning, and why it is admissible"), readings),
    ]
    if document.claims:
        claims = [
            (c.id, digits_of(case, c), f"{claim_text(case, c)} ({c.where})")
            for c in document.claims
        ]
        parts.append(table(("claim", "printed", "~statement, and its place"), claims))
    if document.assumptions:
        choices = [(str(k), f"{a.text} {a.choice}") for k, a in enumerate(document.assumptions, 1)]
        parts.append(table(("choice", "~open point, and the choice made"), choices))
    return parts


def _meaning(reading: Reading, labels: Mapping[str, str]) -> str:
    """A reading's words and why it is admissible; the reason alone where it has no words."""
    label = labels[reading.id]
    said = [f"{capital(label)}."] if label != reading.id or not reading.why else []
    return " ".join([*said, capital(reading.why)]).strip()


def _asked(document: ShowDocument, case: Case) -> list[Block]:
    """Curve, angles and limits of each problem, in the digits and units that are read."""
    reading = next((r.id for r in document.readings if r.default), document.readings[0].id)
    rows, slides = [], False
    for problem in document.problems:
        one = case.statement(problem.id, reading)
        size = f"{one.waypoints.number} × {len(one.labels)}"
        curve = one.curve().name + _ends(one)
        if one.durations.ratios not in (None, "free"):
            curve += f", {ratio_words(one.durations.ratios)}"
        said = (_limit(one, name) for name in _LIMITED)
        limits = "; ".join(each for each in said if each) or "none"
        words = (problem.title or problem.id,) if len(document.problems) > 1 else ()
        slides |= any(one.linear)
        units = one.units.position or ""
        shown = units if isinstance(units, str) else ", ".join(units)
        rows.append((*words, curve, size, shown, limits))
    first = ("~problem",) if len(rows) > 1 else ()
    given = "positions in" if slides else "angles in"
    names = (*first, "curve", "way-points × joints", given, "~limits")
    under = f" under {quoted(reading, case.labels)}" if len(document.readings) > 1 else ""
    return [Prose(f"Curve, units and limits{under}:"), table(names, rows)]


def _ends(one: Statement) -> str:
    """What is prescribed at the ends of a spline whose name does not say it."""
    block = one.declaration
    chosen = block.end_orders is not None or block.finish_orders is not None
    # The names of these two say what holds at the ends, unless the file chooses it.
    named = block.family in ("quintic-spline", "septic-spline")
    if block.family != "cubic-spline" and not (named and chosen):
        return ""
    if block.finish_orders is None and block.finish_derivatives is None:
        return _zeros(block.orders, block.end_derivatives, "at the ends")
    start = _zeros(block.orders, block.end_derivatives, "at the start")
    return start + _zeros(block.last_orders, block.last_derivatives, "at the finish")


def _zeros(orders: Sequence[int], values: object, where: str) -> str:
    """What is 0 at an end; where something else is given, the curve's name says so."""
    # Papers call higher derivatives by their order.
    words = {1: "velocity", 2: "acceleration", 3: "jerk"}
    names = " and ".join(words.get(k, f"derivative {k}") for k in orders)
    return f", {names} 0 {where}" if names and values is None else ""


def _limit(one: Statement, quantity: str) -> str:
    """A limit as printed, with the unit that it is read in; empty if there is none."""
    printed = getattr(one.limits, quantity)
    if printed is None:
        return ""
    numbers = list(map(str, printed)) if isinstance(printed, Sequence) else [str(printed)]
    units = getattr(one.units, quantity)
    if len(numbers) == 1 and isinstance(units, tuple):
        units = one.unit(cast(Quantity, quantity))
    return f"{quantity} {' '.join(with_unit(numbers, units))}"
