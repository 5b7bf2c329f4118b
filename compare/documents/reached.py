"""How near a paper's algorithms get to the optimum at the paper's own budget, run many times."""

from __future__ import annotations

from collections.abc import Iterable

from .benched import TargetReached
from .entry import Count, Entry, OrWhy, Why
from .finding import Gap, percent_digits

NO_BREAK = "\N{NO-BREAK SPACE}"
"""The unit stays with its number on the narrowest screen."""
_NONE = "–"
"""A cell without a value."""


class Reached(Entry):
    """Where the runs of one algorithm end, under one handling of vectors that break a limit."""

    problem: str
    reading: str
    searched: str
    """What was searched, in words; no other search of the case is called so."""
    algorithm: str
    """Its id in the case."""
    name: str
    handling: str
    """What happened to vectors that break a limit."""
    budget: Count
    """Evaluations of a run."""
    runs: Count
    unanswered: Count
    """Runs without a feasible answer."""
    best: OrWhy[float]
    lower_quartile: OrWhy[float]
    median: OrWhy[float]
    upper_quartile: OrWhy[float]
    """Totals, s. What falls between two runs is the mean of both; none if either has no answer."""
    beside: str
    """What the gaps are set against, in words."""
    best_gap: OrWhy[Gap]
    gap: OrWhy[Gap]
    """Of the best run and of the median, as intervals and never clipped."""
    within: tuple[TargetReached, ...]
    """How often and how soon runs come within 1 % and 0.1 %; of joints searched by themselves,
    until each is so near its own optimum."""
    totals: tuple[float, ...]
    """Of every run with an answer, in rising order, s."""

    def __str__(self) -> str:
        """The median gap of the algorithm in a sentence."""
        if isinstance(self.median, Why):
            found = f"no answer in {self.unanswered} of {self.runs} runs"
            return f"The {self.name} finds {found}."
        if isinstance(self.gap, Why):
            end = f"ends at {self.median:.4f} s (median); {self.gap}"
            return f"In {self.runs} runs, the {self.name} {end}."
        far = f"{apart(self.gap)} {self.beside}"
        return f"In {self.runs} runs, the {self.name} ends {far} (median)."

    @property
    def briefly(self) -> str:
        """The same in fewer words; empty without an answer."""
        if isinstance(self.gap, Why):
            return ""
        return f"In {self.runs} runs, its algorithm ends {apart(self.gap)} {self.beside} (median)."


def apart(gap: Gap) -> str:
    """A gap in words: how far above, or below."""
    if gap.lowest < 0 < gap.highest:
        return f"{gap.percent} from"
    side = "below" if gap.lowest < 0 else "above"
    low, high = sorted((abs(100 * gap.lowest), abs(100 * gap.highest)))
    return f"{' to '.join(percent_digits(low, high))} % {side}"


def by_search(runs: Iterable[Reached]) -> dict[str, list[Reached]]:
    """Algorithms that searched the same, under the words for what they searched."""
    found: dict[str, list[Reached]] = {}
    for one in runs:
        found.setdefault(f"{one.searched[:1].upper()}{one.searched[1:]}", []).append(one)
    return found


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
REACHED_COLUMNS = (
    "algorithm",
    "limits broken in the search",
    "median, its gap",
    "best, its gap",
    "quartiles, s",
    "no answer",
    "evaluations; until 1 %; 0.1 %",
)
"""What a table says of each algorithm."""


def reached_cells(one: Reached) -> tuple[str, ...]:
    """The row of an algorithm, as `REACHED_COLUMNS`."""
    return (
        one.name,
        one.handling.replace("-", " "),
        _with_gap(one.median, one.gap),
        _with_gap(one.best, one.best_gap),
        f"{_seconds(one.lower_quartile)} to {_seconds(one.upper_quartile)}",
        f"{one.unanswered} of {one.runs}",
        "; ".join([f"{one.budget:,}", *(_evaluations(target) for target in one.within)]),
    )


def _with_gap(total: float | Why, gap: Gap | Why) -> str:
    beside = "" if isinstance(gap, Why) else f" s, {gap.percent.replace(' %', NO_BREAK + '%')}"
    return f"{_seconds(total)}{beside}"


def _seconds(total: float | Why) -> str:
    return _NONE if isinstance(total, Why) else f"{total:.4f}"


def _evaluations(target: TargetReached) -> str:
    if isinstance(target.evaluations, Why):
        return "never"
    return f"{target.evaluations:,.0f}"
