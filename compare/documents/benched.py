"""How far runs of optimisers end from the optimum: what `bench` answers, and in an audit."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from pydantic import Field

from .entry import Count, Document, Entry, OrWhy, Real, Why
from .finding import Gap, Reference, percent_digits
from .why_judged import noted


class TargetReached(Entry):
    """How often and how soon the runs of an optimiser come within a gap of the optimum."""

    gap: float
    """Relative, above the upper end of the optimum."""
    reached: Count
    """Runs that come within it."""
    rate: float
    rate_lowest: float
    rate_highest: float
    """95 % interval of the rate (Wilson)."""
    evaluations: OrWhy[float]
    """Expected running time: all evaluations over the number of runs that reach the gap."""
    evaluations_lowest: OrWhy[float]
    evaluations_highest: OrWhy[float]
    """95 % interval, by resampling runs; unbounded where samples hold no run that reaches it."""

    @property
    def spent(self) -> tuple[str, str]:
        """Expected evaluations, and their interval, of which an end without bound is ∞."""
        if isinstance(self.evaluations, Why):
            return "never", ""
        ends = (self.evaluations_lowest, self.evaluations_highest)
        low, high = ("∞" if isinstance(end, Why) else f"{end:.0f}" for end in ends)
        return f"{self.evaluations:.0f}", f"{low} to {high}"


class Standing(Entry):
    """Where the runs of one optimiser end."""

    optimizer: str
    """Its name in the tables: with its handling if that is another than was asked for."""
    handling: str
    """What happened to vectors that break a limit."""
    settings: str
    """As JSON; what is not in it has its default."""
    runs: Count
    failed: Count
    """Runs that raised, hung or broke the rules; they count as runs without an answer."""
    messages: tuple[str, ...]
    """Why runs failed or have no feasible answer, each reason once with its number of runs."""
    feasible: Count
    """Runs whose answer passes `check`."""
    best: OrWhy[float]
    """Relative gap of the shortest answer to the upper end of the optimum; never clipped."""
    lower_quartile: OrWhy[float]
    median: OrWhy[float]
    upper_quartile: OrWhy[float]
    """Gaps of a quarter, half and three quarters of all runs. What falls between two runs is the
    mean of both; none if either has no answer."""
    median_total: OrWhy[float]
    """s"""
    median_highest: OrWhy[float]
    """The median gap against the certified lower end of the optimum."""
    evaluations: float
    """Median number of evaluations."""
    targets: tuple[TargetReached, ...]


class PairCompared(Entry):
    """Two optimisers, run against run."""

    first: str
    second: str
    first_shorter: float
    """Share of pairs of runs in which the first ends shorter."""
    equal: float
    """Share in which they tie: within the checker's tolerance, or both without an answer."""
    vargha_delaney: float
    """Probability that a run of the first is shorter, a tie counting half."""
    lowest: float
    highest: float
    """95 % interval of it, by resampling runs."""
    p_value: Real
    """Of Mann and Whitney's test for independent samples, after Holm's correction."""


class BenchResult(Entry):
    """Optimisers on one problem under one reading."""

    problem: str
    """Its name in rows: the case and its problem."""
    reading: str
    words: str = Field(default="", exclude=True)
    """What a reader calls case, problem and reading, with the ids that a command takes; not in
    JSON."""
    budget: Count
    """Evaluations of each run, unless `notes` give a paper's algorithm its own."""
    seeds: Count
    optimum: Reference
    notes: tuple[str, ...]
    """What was chosen so that the optimisers could run."""
    standings: tuple[Standing, ...]
    """The smallest median gap first."""
    pairs: tuple[PairCompared, ...]

    @property
    def title(self) -> str:
        """The problem in words where there are some; else as rows call it, with its reading."""
        return self.words or ", ".join(part for part in (self.problem, self.reading) if part)

    @property
    def messages(self) -> tuple[str, ...]:
        """Why runs failed or have no answer, each with its optimiser."""
        return tuple(f"{s.optimizer}: {message}" for s in self.standings for message in s.messages)

    @property
    def verdict(self) -> str:
        """Which optimiser is closest to the optimum by its median gap, in a sentence."""
        known = [(s.median, s) for s in self.standings if isinstance(s.median, float)]
        if not known:
            return "No optimiser found a feasible answer in more than half of its runs."
        median, first = known[0]
        runs = "1 run" if first.runs == 1 else f"{first.runs} runs"
        said = f"Closest: {first.optimizer} (median gap {percent(median)} over {runs})"
        for gap, second in known[1:2]:
            said += f"; next: {second.optimizer} ({percent(gap)})"
        return f"{said}."

    def __str__(self) -> str:
        names = [name.lstrip(">") for name in BENCH_COLUMNS]
        table = [names, *(bench_cells(one) for one in self.standings)]
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        lines = [
            "  ".join(
                cell.ljust(width) if i == 0 else cell.rjust(width)
                for i, (cell, width) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
            for row in table
        ]
        return "\n".join([self.verdict, "", *lines, *self.messages, *self.notes])


class OverallTarget(Entry):
    """How often an optimiser comes within a gap, over all problems of a bench."""

    gap: float
    """Relative, above the upper end of each optimum."""
    rate: float
    """Mean over the problems of the share of runs that come within it."""
    solved: Count
    """Problems on which half of the runs or more do."""


class OverallStanding(Entry):
    """One optimiser over all problems of a bench, each counting alike."""

    optimizer: str
    problems: Count
    first: Count
    """Problems on which no other optimiser has a smaller median gap; ties count for each."""
    median: OrWhy[float]
    """Median over the problems of the median gap."""
    worst: OrWhy[float]
    """Largest median gap; none if half of the runs have no answer on some problem."""
    failed: Count
    """Runs that failed."""
    targets: tuple[OverallTarget, ...]


class BenchDocument(Document):
    """What `trajgap bench --json` prints."""

    results: tuple[BenchResult, ...]
    overall: tuple[OverallStanding, ...] = ()
    """Over all problems, the largest share of runs within 1 % first; empty for one problem."""


BENCH_COLUMNS = (
    "optimizer", ">median gap", ">quartiles", ">best", ">feasible", ">≤ 1 %", ">≤ 0.01 %",
    ">evaluations to 1 %", ">evaluations to 0.01 %",
)  # fmt: skip
"""What a table says of each optimiser. Of the five targets two are shown: what a paper's digits can
tell apart, and what they cannot; the JSON has all."""


def bench_cells(standing: Standing) -> tuple[str, ...]:
    """The row of an optimiser in a table, as `BENCH_COLUMNS`."""
    shown = [t for t in standing.targets if t.gap in SHOWN_GAPS]
    return (
        standing.optimizer,
        gap_cell(standing.median),
        f"{gap_cell(standing.lower_quartile)} to {gap_cell(standing.upper_quartile)}",
        gap_cell(standing.best),
        f"{standing.feasible} of {standing.runs}",
        *(f"{100 * target.rate:.0f} %" for target in shown),
        *(noted(*target.spent) for target in shown),
    )


SHOWN_GAPS = (0.01, 1e-4)
"""Gaps of the targets in a table."""


def gap_cell(gap: float | Why) -> str:
    """A gap in a table."""
    return "none" if isinstance(gap, Why) else percent(gap)


def percent(gap: float) -> str:
    """A relative gap in percent, with two digits that count; of an infinite one, none.

    Below the checker's tolerance of 1e-9, which is 1e-7 %, the gap of an answer says nothing.
    """
    if math.isinf(gap):
        return "none"
    value = 100 * gap
    if 0 < abs(value) < 1e-7:
        return "< 1e-7 %" if value > 0 else "> −1e-7 %"
    shown = f"{value:.0f}".replace("-", "−") if abs(value) >= 10 else two_digits(value)
    return f"{shown} %"


def two_digits(value: float) -> str:
    """A number without an exponent, with two digits that count and a true minus sign."""
    text = np.format_float_positional(value, precision=2, fractional=False, trim="-")
    return text.replace("-", "−")


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
            return self._ends(f"the {self.name}", f"at {self.median:.4f} s", f"; {self.gap}")
        return self._ends(f"the {self.name}", f"{apart(self.gap)} {self.beside}")

    @property
    def briefly(self) -> str:
        """The same in fewer words; empty without an answer."""
        if isinstance(self.gap, Why):
            return ""
        return self._ends("its algorithm", f"{apart(self.gap)} {self.beside}")

    def _ends(self, name: str, where: str, note: str = "") -> str:
        return f"Replayed {self.runs} times, {name} ends {where} (median){note}."


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
