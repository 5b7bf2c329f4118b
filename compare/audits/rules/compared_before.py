"""TG405: what a committed study found on the comparison of two algorithms, read once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from importlib.resources import files
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from ....problem import Case
from ...documents import Basis, Finding, noted
from ..study import Study
from ..words import percent
from .rule_group import INFORMS, Explained, rule_group

_RESULTS = "comparisons.json"
"""The committed results: written by benchmarks/comparison_results.py, never by hand."""

Share = Annotated[float, Field(ge=0, le=1)] | None
"""From 0 to 1; None if no pair of runs has two answers."""
Count = Annotated[int, Field(ge=0)]
"""How many."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ComparedWhere(_Strict):
    """What was searched, and what happened to vectors that break a limit."""

    problem: str
    reading: str
    handling: str


class PairShown(_Strict):
    """How often one run of the second algorithm is shorter than one of the first."""

    runs: tuple[Count, Count]
    """Of the first, of the second."""
    medians: tuple[float | None, float | None]
    """Of their totals, s; None where half of the runs have no answer."""
    share: Share
    """Of the pairs of runs, those in which the second is shorter by the printed advantage."""
    lowest: Share
    highest: Share
    """95 % interval of it, by resampling runs."""
    shorter: Share
    """Those in which it is shorter at all."""


class Listed(ComparedWhere):
    """Both algorithms under the settings that the case lists: the standard one first."""

    shown: PairShown


class Ablated(ComparedWhere):
    """The improved algorithm without something (first) against itself with all (second)."""

    without: tuple[str, ...]
    """What was taken away, in the paper's words."""
    shown: PairShown


class Designed(ComparedWhere):
    """Both algorithms under settings that fill the space of what the text leaves open."""

    settings: tuple[Count, Count]
    """Of the standard algorithm, of the improved one."""
    seeds: Count
    pairs: Count
    """Pairs of settings with two answers."""
    typical: Count
    """Settings in which at least half of the pairs of runs show the printed advantage."""
    shorter: Count
    """Those in which the improved one is shorter in more than half of the pairs of runs."""
    most: Share
    """Largest share of pairs of runs that show the printed advantage."""
    at: tuple[str, str]
    """Settings of the standard and of the improved algorithm at which that is."""


class Comparison(_Strict):
    """What one paper's comparison came to."""

    case: str
    claim: str
    """Id of the claim that compares."""
    standard: str
    improved: str
    """Ids of the algorithms in the case."""
    budget: Count
    """Evaluations of each run: the paper's."""
    advantage: float
    """Printed, as a share of the longer total; 0 where the paper prints no number."""
    printed: str | None
    """Its printed digits."""
    on: str
    """What was searched, in words."""
    listed: tuple[Listed, ...]
    ablated: tuple[Ablated, ...]
    designed: tuple[Designed, ...]


class _Results(_Strict):
    format: str
    command: str
    comparisons: tuple[Comparison, ...]


@lru_cache(maxsize=1)
def _results() -> _Results:
    text = files("trajgap.compare.audits").joinpath(_RESULTS).read_text(encoding="utf-8")
    return _Results.model_validate_json(text)


def comparison_of(case: str, claim: str) -> Comparison | None:
    """What a study found on the comparison that a claim makes; None if none was made."""
    return next(
        (one for one in _results().comparisons if (one.case, one.claim) == (case, claim)), None
    )


def all_comparisons() -> tuple[Comparison, ...]:
    """Every study that was made, by case."""
    return _results().comparisons


_TOGETHER = "all joints together"
"""Where a study names no other way of searching: a card calls such an optimum so."""


TG405 = Explained(
    "TG405",
    "A comparison of two algorithms, repeated in a committed study",
    "Does a larger study confirm the comparison of two algorithms: many seeds, every handling "
    "of "
    "limits, settings spread over what is open, each improvement removed?",
    INFORMS + " The results are committed with the command that makes them.",
    "B is at least 10 % shorter than A in 2 % of the pairs of runs, and typically so for 3 of "
    ""
    "256 pairs of settings.",
    basis=Basis.REPLAY,
    decides=False,
)


@rule_group(TG405, without_waypoints=True)
def cite_comparisons(study: Study) -> Iterator[Finding]:
    """Findings of TG405: information only, for settings, operators and seeds are not printed."""
    for claim in study.claims:
        known = comparison_of(study.case.id, claim.id)
        if known is None:
            continue
        first = known.listed[0]
        both = {one: study.called(getattr(known, one)) for one in ("improved", "standard")}
        yield TG405.finding(
            claim,
            "study",
            *comparison_words(known.model_copy(update=both), study.case),
            printed=known.printed,
            computed=f"holds in {_percent(first.shown.share)} of the pairs",
        )


def comparison_words(known: Comparison, case: Case) -> Iterator[str]:
    """What a comparison came to, in sentences; its problems are called as the case calls them."""
    what = f"at least {percent(known.advantage, '.4g')} shorter" if known.advantage else "shorter"
    runs = known.listed[0].shown.runs
    yield (
        f"A committed study ran both on {known.on}, with {known.budget:,} evaluations per run and "
        f"{min(runs)} independent runs each."
    )
    yield (
        f"Under the listed choices, one run of {known.improved} is {what} than one of "
        f"{known.standard} {_each(known.listed)}."
    )
    if known.designed:
        searched = _called(case, [one.problem for one in known.designed])
        counts = [
            noted(f"{one.typical} of {one.pairs} pairs of settings", searched[one.problem])
            for one in known.designed
        ]
        best = max(known.designed, key=lambda one: one.most or 0.0)
        most = ""
        if best.most:
            settings = f"{known.standard} at {best.at[0]} and {known.improved} at {best.at[1]}"
            most = f", most often with {settings} ({_percent(best.most)})"
        yield (
            f"If everything that the text leaves open is varied together, this is typical (true "
            f"of at least half of the pairs of runs) for {' and for '.join(counts)}{most}."
        )
    yield from _taken_away(known.ablated, case)


def _called(case: Case, problems: Iterable[str]) -> dict[str, str]:
    """What tells each of these problems from the others, in words; empty if there is one.

    A study writes a problem as its id, and behind a comma how its joints were searched.
    """
    parted = {one: one.partition(", ")[::2] for one in problems}
    titles = {one.id: one.title or one.id for one in case.problems}
    ids, ways = ({part[k] for part in parted.values()} for k in (0, 1))
    return {
        one: "; ".join(
            [
                *([titles.get(pid, pid)] if len(ids) > 1 else []),
                *([way or _TOGETHER] if len(ways) > 1 else []),
            ]
        )
        for one, (pid, way) in parted.items()
    }


def _each(listed: Sequence[Listed]) -> str:
    """Shares of the first problem and reading, one for each handling; the rest as a range."""
    first = listed[0]
    same = [o for o in listed if (o.problem, o.reading) == (first.problem, first.reading)]
    shares = "with probability " + "; ".join(
        f"{_percent(one.shown.share)} ({_sure(one)}) under {one.handling}" for one in same
    )
    others = [one.shown.share for one in listed if one not in same and one.shown.share is not None]
    if not others:
        return shares
    ends = " to ".join(dict.fromkeys(_percent(end) for end in (min(others), max(others))))
    where = "other problem or reading" if len(others) == 1 else "other problems and readings"
    return f"{shares}; under {len(others)} {where} {ends}"


def _sure(one: Listed) -> str:
    if one.shown.share == 0:  # resampling the same runs shows no event that none of them shows
        return f"in none of the {one.shown.runs[0] * one.shown.runs[1]:,} pairs"
    return f"95 % interval {_percent(one.shown.lowest)} to {_percent(one.shown.highest)}"


def _taken_away(ablated: Sequence[Ablated], case: Case) -> Iterator[str]:
    """What single parts of the improvement change, for each problem in a sentence.

    That it helps or harms is said where 3 of 4 pairs show it.
    """
    alone = [one for one in ablated if len(one.without) == 1 and one.shown.shorter is not None]
    for problem, searched in _called(case, [one.problem for one in alone]).items():
        parts = [
            f"{' and '.join(one.without)} {_percent(one.shown.shorter)}"
            + (" (it helps)" if shorter >= 0.75 else " (it harms)" if shorter <= 0.25 else "")
            for one in alone
            for shorter in (one.shown.shorter or 0.0,)
            if one.problem == problem
        ]
        yield (
            f"{noted('Share of pairs', searched)} in which the complete algorithm is shorter than "
            f"without one improvement: {', '.join(parts)}."
        )


def _percent(share: float | None) -> str:
    return "an unknown share" if share is None else percent(share)
