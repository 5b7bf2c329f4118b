"""What the tables and the card of an audit say, wherever they are shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from ..documents import (
    OPTIMA_STEPS,
    OPTIMUM_RETIMED,
    THIRD_ORDER,
    ClaimVerdict,
    Gap,
    Judgement,
    Reached,
    StatedSource,
    TargetReached,
    VerdictCard,
    Waterfall,
    Why,
    counted,
    noted,
    value_or_none,
    worth_little,
)
from .tree import CardShown, Drawn, Grid, Prose, seconds, table, word

_NO_BREAK = "\N{NO-BREAK SPACE}"
"""The unit stays with its number on the narrowest screen."""
_NONE = "–"
"""A cell without a value."""


def reference(source: StatedSource) -> Prose:
    """A source in full, with its DOI; what the text lacks is said."""
    parts = (source.authors, source.title, source.journal, value_or_none(source.year))
    printed = ", ".join(str(one) for one in parts if one)
    said = f"{printed}." if printed else "The text that was read names neither authors nor title."
    if printed and not source.authors:
        said += " The text that was read names no authors."
    return Prose(said, "note", doi=source.doi)


def card_shown(card: VerdictCard, tally: str = "", drawn: Drawn | None = None) -> CardShown:
    """A card, with a tally below it and a picture beside it."""
    beside = card.explanation if isinstance(card.explanation, str) else ""
    return CardShown(card.lines, card.against, beside, drawn, tally)


def counts_said(judgements: Sequence[Judgement]) -> str:
    """How many claims have which verdict, in a sentence."""
    counts = Counter(one.verdict for one in judgements)
    beside = worth_little(judgements)
    said = ", ".join(
        noted(counted(word, counts[word]), beside if word is ClaimVerdict.SUPPORTED else "")
        for word in ClaimVerdict
        if counts[word]
    )
    many = "1 claim" if len(judgements) == 1 else f"{len(judgements)} claims"
    return f"{many}: {said or 'none to judge'}"


def distances_table(waterfall: Waterfall, caption: str = "", *, ends: bool = True) -> Grid:
    """Each step in seconds, with or without ends, and how far the first one lies above it."""
    known = [step for step in waterfall.steps if not isinstance(step.time, Why)]
    # Steps whose note stands in the open: the optimum, its proof and routes, and its cross-check.
    rows = [
        (s.name, s.total(ends), _above(known[0].value, s.value), s.known and word(s.known),
         s.note if s.name in (*OPTIMA_STEPS, OPTIMUM_RETIMED, THIRD_ORDER) else None)
        for s in known
    ]  # fmt: skip
    columns = ("~step", ">total", ">first step relative to this one", "evidence", "found how")
    return table(columns, rows, caption)


def _above(first: float, time: float) -> str | None:
    if time <= 0 or first == time:
        return None
    # Distance, as a share, whose one decimal is 0, so its sign would say nothing.
    if abs(first / time - 1) < 5e-4:
        return f"0.0{_NO_BREAK}%"
    if first / time > 1 + 10:
        return f"{first / time:.1f} times"
    return f"{100 * (first / time - 1):+.1f}{_NO_BREAK}%"


def steps_table(waterfall: Waterfall) -> Grid:
    """Each step with its time, what stands behind it, and its note."""
    rows = [(s.name, s.total(), s.known and word(s.known), s.note) for s in waterfall.steps]
    return table(("step", ">total", "evidence", "~note"), rows, "", "steps")


REACHED_MEANING = (
    "Each row is one algorithm at the paper's own budget, run from different seeds under the "
    "choices that the case lists. A vector of durations that breaks a limit gets a penalty "
    "(death penalty), counts with the shortest uniform stretch that keeps every limit (stretch), "
    "or is scaled until one limit is tight (rescale). Every total is that of a motion that keeps "
    "its limits. Gaps are measured from the proven interval of the optimum, if there is one. "
    "Evaluations are those of a run, and those that restarts need on average until one run comes "
    "this near; if each joint is planned separately, until every joint is this near its own "
    "optimum, counted over all joints. "
    "Operators and seeds are not printed, so these runs are information and refute nothing."
)
"""What the table means."""


def reached_table(runs: Iterable[Reached], title: str = "") -> Grid:
    """A row for each algorithm."""
    rows = [
        (
            one.name,
            one.handling.replace("-", " "),
            _with_gap(one.median, one.gap),
            _with_gap(one.best, one.best_gap),
            " to ".join(seconds(end, 4, _NONE) for end in (one.lower_quartile, one.upper_quartile)),
            f"{one.unanswered} of {one.runs}",
            "; ".join([f"{one.budget:,}", *(_evaluations(target) for target in one.within)]),
        )
        for one in runs
    ]
    columns = (
        "~algorithm",
        "limits broken in the search",
        ">median, its gap",
        ">best, its gap",
        ">quartiles, s",
        ">no answer",
        ">evaluations; until 1 %; 0.1 %",
    )
    return table(columns, rows, title)


def _with_gap(total: float | Why, gap: Gap | Why) -> str:
    beside = "" if isinstance(gap, Why) else f" s, {gap.percent.replace(' %', _NO_BREAK + '%')}"
    return f"{seconds(total, 4, _NONE)}{beside}"


def _evaluations(target: TargetReached) -> str:
    if isinstance(target.evaluations, Why):
        return "never"
    return f"{target.evaluations:,.0f}"
