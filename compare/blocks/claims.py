"""What the claims, tables and the card of an audit say, wherever they are shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from ...nlp import Evidence
from ...problem import file_name
from ..documents import (
    OPTIMA_STEPS,
    OPTIMUM_RETIMED,
    THIRD_ORDER,
    AuditedCase,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Confidence,
    Gap,
    Judgement,
    Named,
    Reached,
    Said,
    StatedClaim,
    StatedSource,
    VerdictCard,
    Waterfall,
    Why,
    capital,
    counted,
    grouped,
    in_full,
    noted,
    opened,
    qualified,
    same_reason,
    value_or_none,
    worth_little,
)
from .tree import CardShown, Claimed, Drawn, Grid, Prose, seconds, table, word

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
    return CardShown(card.verdict, card.against, card.lines, beside, drawn, tally)


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
            "; ".join([f"{one.budget:,}", *(_spent(target.evaluations) for target in one.within)]),
        )
        for one in runs
    ]
    columns = ("~algorithm", "limits broken in the search", ">median, its gap", ">best, its gap",
               ">quartiles, s", ">no answer", ">evaluations; until 1 %; 0.1 %")  # fmt: skip
    return table(columns, rows, title)


def _with_gap(total: float | Why, gap: Gap | Why) -> str:
    beside = "" if isinstance(gap, Why) else f" s, {gap.percent.replace(' %', _NO_BREAK + '%')}"
    return f"{seconds(total, 4, _NONE)}{beside}"


def _spent(evaluations: float | Why) -> str:
    return "never" if isinstance(evaluations, Why) else f"{evaluations:,.0f}"


def claims_shown(
    found: AuditedCase,
    chosen: Iterable[Judgement],
    beside: Mapping[str, Sequence[str]] | None = None,
    words: int | None = None,
) -> Iterator[Claimed]:
    """Claims with their verdicts, each reason and each long caveat once.

    `chosen`: verdicts of this case, in the order in which they are shown. `beside`: what else is
    said of a claim, by its id. `words`: of a reason that stand in the open, where there is less
    room than the opening needs.
    """
    stated = {one.claim: one for one in found.claims}
    more = beside or {}
    own = [_claimed(found, stated[j.claim], j, words) for j in chosen]
    return shown_once([replace(one, beside=tuple(more.get(one.id, ()))) for one in own])


def _claimed(
    found: AuditedCase, claim: StatedClaim, judgement: Judgement, words: int | None
) -> Claimed:
    reason, every = _reasons(found, judgement, words)
    # Of doubted way-points the word has said so, or a short line does, where there is no room.
    # Caveats of doubted way-points.
    points = (CaveatKind.POINTS, CaveatKind.SOME_POINTS)
    doubts = () if words is None else [c for c in judgement.caveats if c.kind in points]
    short = [replace(c, why="") for c in doubts if c.kind is CaveatKind.SOME_POINTS]
    shown = [*short, *(c for c in judgement.caveats if c not in doubts)]
    title = {1: "The whole reason", 2: "Both reasons"}.get(len(every), f"All {len(every)} reasons")
    verdict = word(judgement.verdict)
    return Claimed(
        text=claim.text,
        where=claim.where,
        printed=claim.printed,
        verdict=replace(verdict, text=qualified(judgement.verdict, judgement.beside)),
        holds=_holds(judgement),
        why=(reason,),
        more=(*every, *(str(_sentence(c)) for c in doubts)),
        caveats=tuple(map(_sentence, shown)),
        fold=title if words is None else "Read on",
        anchor=file_name("claim", claim.claim),
        id=claim.claim,
        answer=answered(claim),
    )


def _reasons(
    found: AuditedCase, judgement: Judgement, words: int | None
) -> tuple[str, tuple[str, ...]]:
    """The opening of what decides, and all of it in full where that is more."""
    named, computed = names(found), tuple(judgement.readings)
    said = [
        Said(f.verdict, f.rule, f.kind, f.sentences, f.reading)
        for f in found.findings
        if f.claim == judgement.claim and f.decides
    ]
    reasons = grouped(said, computed, named)
    depends = judgement.verdict is ClaimVerdict.DEPENDS
    every = [line for one in reasons for line in in_full(one, computed, named, word=depends)]
    opening = judgement.opening
    if words is not None:
        shown, rest = opened(judgement.sentences, words)
        opening = " ".join(shown) if rest else None
    if opening is None and len(every) == len(reasons):
        return judgement.why, ()
    return opening or judgement.why, tuple(every) if len(every) > 1 else (judgement.why,)


def names(found: AuditedCase) -> Named:
    """What the readings of a case are called."""
    said = found.readings
    return Named() if isinstance(said, Why) else Named(said.labels, said.implausible, said.default)


def _holds(judgement: Judgement) -> str:
    """Under how many readings the word holds, its reference, and how that is known."""
    words = list(judgement.readings.values())
    each = [f"{one} under {words.count(one)}" for one in dict.fromkeys(words)]
    undecided = set(words) == {ClaimVerdict.NOT_CHECKABLE}
    parts = [f"{', '.join(each)} of {len(words)} readings"] * (len(words) > 1 and not undecided)
    if judgement.evidence is not Evidence.NONE:
        parts.append(f"reference {judgement.evidence}")
    parts += [judgement.confidence] if isinstance(judgement.confidence, Confidence) else []
    return capital("; ".join(parts))


def _sentence(caveat: Caveat) -> Caveat:
    """A caveat that begins and ends as a sentence does."""
    if caveat.why:
        return Caveat(caveat.kind, capital(caveat.says), f"{caveat.why.rstrip('.')}.")
    return Caveat(caveat.kind, f"{capital(caveat.says).rstrip('.')}.")


def answered(claim: StatedClaim) -> str:
    """What the authors say of a claim, or that they were asked; empty if they were not."""
    answer = claim.answer
    if isinstance(answer, Why):
        return ""
    came = answer.answered if isinstance(answer.answered, Why) else f"answered {answer.answered}"
    said = f"Authors asked {answer.sent}, {came}"
    return f"{said}: {answer.outcome}" if answer.outcome else f"{said}."


def shown_once(found: Sequence[Claimed]) -> Iterator[Claimed]:
    """Claims in order, without what an earlier one has said.

    Claims of the same words and the same verdict are one with several places. A reason that an
    earlier claim gave is named, and a long caveat is given in full once.
    """
    groups: dict[tuple[str, ...], list[Claimed]] = {}
    for one in found:
        groups.setdefault((one.text, one.verdict.text, one.holds), []).append(one)
    first: dict[tuple[str, ...], Claimed] = {}
    seen: set[Caveat] = set()
    for group in groups.values():
        one = _joined(group)
        before = first.setdefault((*one.why, *one.more), one)
        if before is not one:
            one = replace(one, why=(same_reason(before.text, before.where, one.where),), more=())
        caveats = tuple(
            Caveat(c.kind, f"{c.says} (see above).") if c in seen else c for c in one.caveats
        )
        seen.update(caveat for caveat in one.caveats if caveat.why)
        yield replace(one, caveats=caveats)


def _joined(group: Sequence[Claimed]) -> Claimed:
    """Claims of the same words as one, with the other reasons of the others."""
    one, *others = group
    if not others:
        return one
    why = [f"{other.where}: {' '.join(other.why)}" for other in others if other.why != one.why]
    return replace(
        one,
        where="; ".join(dict.fromkeys(c.where for c in group)),
        printed="; ".join(dict.fromkeys(c.printed for c in group if c.printed)),
        why=(*one.why, *why),
        beside=tuple(dict.fromkeys(said for c in group for said in c.beside)),
        caveats=tuple(dict.fromkeys(caveat for c in group for caveat in c.caveats)),
        answer=" ".join(dict.fromkeys(c.answer for c in group if c.answer)),
        also=tuple(c.anchor for c in others),
    )
