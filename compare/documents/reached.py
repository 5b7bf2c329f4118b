"""How near a paper's algorithms get to the optimum at the paper's own budget, run many times."""

from __future__ import annotations

from collections.abc import Iterable

from .benched import TargetReached
from .entry import Count, Entry, OrWhy, Why
from .finding import Gap, percent_digits


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
