"""The audited papers side by side: printed total, optimum, distance, and what was found."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from ...nlp import Evidence
from ..documents import (
    ALONG_PATH,
    OWN_OPTIMA,
    PUBLISHED,
    RATIOS_OPTIMUM,
    SHARED_OPTIMUM,
    AuditedCase,
    ClaimVerdict,
    Keeping,
    StatedSource,
    Why,
    at_least_percent,
    value_or_none,
)
from ..pictures import PaperBar, Picture, papers_picture
from .results import Results

NONE = "–"
"""A cell without a value."""
COLUMNS = ("paper", "printed, s", "optimum or best known, s", "above it", "evidence",
           "its algorithm ends", "what was found")  # fmt: skip
"""What a row of the table says."""


@dataclass(frozen=True)
class Distance:
    """A printed total beside the optimum of its own problem, at the printed digits."""

    printed: float
    """s."""
    interval: tuple[float, float]
    """All totals that round to its digits, s."""
    lowest: float
    highest: float
    """The optimum, s; an interval where each joint is planned by itself."""
    least: float | None
    """How far above its optimum the total is at least, however the digits were rounded: 0 where
    rounding may explain all of it, None if nothing bounds it."""
    evidence: str
    broken: bool
    """Whether the printed motion breaks a limit."""
    timed: bool
    """Whether time alone was minimised, so the distance is one from the optimum."""

    @property
    def shares(self) -> tuple[float, float]:
        """How far above the optimum the total is; 0 where the optimum rounds to the total."""
        if self.interval[0] <= self.highest and self.lowest <= self.interval[1]:
            return 0.0, 0.0
        return self.printed / self.highest - 1, self.printed / self.lowest - 1

    @property
    def above(self) -> str:
        """The same in words; a dash where something else than time alone was minimised."""
        if not self.timed:
            return NONE
        if not any(self.shares):
            said = "the optimum" if self.evidence == Evidence.CERTIFIED else "the best known total"
        elif self.least:
            said = f"at least {at_least_percent(self.least)}"
        else:
            percents = dict.fromkeys(f"{100 * one:z.1f}" for one in self.shares)
            said = f"{' to '.join(percents)} %"
            said += "" if self.least is None else ", which rounding may explain"
        return f"{said}, but breaks a limit" if self.broken else said

    @property
    def best(self) -> str:
        """The optimum in seconds."""
        return " to ".join(dict.fromkeys(f"{one:.4f}" for one in (self.lowest, self.highest)))


@dataclass(frozen=True)
class PaperRow:
    """One audited paper."""

    name: str
    """Of its result."""
    cited: str
    title: str
    distance: Distance | None
    """None if no problem is complete, or no total is printed."""
    reached: str
    """Median gap of the paper's algorithm in its own way of searching."""
    found: str
    """What the audit found, in one sentence."""
    decided: int
    """Claims on which there is a verdict."""
    against: bool
    """Whether something printed is refuted, contradicted or depends on the reading."""

    @property
    def order(self) -> tuple[bool, bool, int, str]:
        """What is worth reading first: something found, then nothing, then nothing to check."""
        return not self.decided, not self.against, -self.decided, self.name

    @property
    def cells(self) -> tuple[str, ...]:
        """What stands behind the paper's name, in the order of `COLUMNS`."""
        one = self.distance
        if one is None:
            return NONE, NONE, NONE, "", self.reached, self.found
        return f"{one.printed:g}", one.best, one.above, one.evidence, self.reached, self.found


def paper_rows(results: Results, kinds: str = "") -> tuple[PaperRow, ...]:
    """Audited cases, what is worth reading first.

    `kinds`: kinds of source, separated by spaces; all if empty.
    """
    cases = {n: results.audited(n) for n in results.names if "cases" in results.document(n)}
    chosen = (
        paper_row(name, case)
        for name, case in cases.items()
        if not kinds or case.source.kind in kinds.split()
    )
    return tuple(sorted(chosen, key=lambda row: row.order))


def paper_row(name: str, case: AuditedCase) -> PaperRow:
    """One audited case as a row of the table."""
    counts = Counter(one.verdict for one in case.verdicts)
    decided = counts.total() - counts[ClaimVerdict.NOT_CHECKABLE]
    against = decided > counts[ClaimVerdict.SUPPORTED]
    named = cited(case.source)
    found = case.card.errors[0] if case.card.errors else case.card.verdict
    distance, reached = distance_of(case), reached_of(case)
    return PaperRow(name, named, case.title, distance, reached, found, decided, against)


def cited(source: StatedSource) -> str:
    """A source as a sentence cites it, such as "Fan and Tang 2024"; empty without authors."""
    authors, year = source.authors, value_or_none(source.year)
    if not authors:
        return ""
    names = [one.strip() for one in re.split(r",| and ", authors) if one.strip()]
    # Initials and "et al." are not part of the name that a sentence gives.
    plain = [re.sub(r"( [A-Z]\.)+$", "", one.removesuffix("et al.").strip()) for one in names]
    plain = [one for one in plain if one]
    many = len(plain) > 2 or "et al." in authors
    who = f"{plain[0]} et al." if many else " and ".join(plain)
    return f"{who} {year}" if year else who


def reached_of(case: AuditedCase) -> str:
    """Median gap of a paper's algorithm in its own way of searching; a dash without runs."""
    if not case.reached:
        return NONE
    gap = case.reached[0].gap
    return "no answer" if isinstance(gap, Why) else gap.percent


def distance_of(case: AuditedCase) -> Distance | None:
    """The printed total of the first problem beside its optimum.

    The optimum is that of shared durations; where the paper plans each joint separately, it is what
    the joints' own optima give.

    None if no problem is complete, or no total is printed.
    """
    otherwise = {c.claim for c in case.claims if not isinstance(c.objective, Why)}
    for entry in case.waterfalls:
        steps = {step.name: step for step in entry.steps if not isinstance(step.time, Why)}
        names = (SHARED_OPTIMUM, RATIOS_OPTIMUM, ALONG_PATH)
        own = next((n for n in names if n in steps), None)
        if PUBLISHED not in steps or own is None:
            continue
        printed, best = steps[PUBLISHED], steps.get(OWN_OPTIMA, steps[own])
        # A certified interval is narrower than what is shown; those of the joints' optima and of
        # a path are not.
        wide = OWN_OPTIMA in steps or own == ALONG_PATH
        low, high = best.ends if wide else (best.value, best.value)
        longest = None if OWN_OPTIMA in steps else value_or_none(entry.longest_optimum)
        return Distance(
            printed.value,
            printed.ends,
            low,
            high,
            None if longest is None else max(0.0, printed.ends[0] / longest - 1),
            best.evidence,
            printed.keeping is Keeping.BREAKS,
            entry.claim not in otherwise,
        )
    return None


def papers_drawn(rows: Iterable[PaperRow]) -> Picture:
    """The papers that minimise time alone and print a total, each beside its optimum."""
    bars = [
        PaperBar(
            row.cited or row.title.split(",")[0],
            1 + one.shares[0],
            1 + one.shares[1],
            f"{one.printed:g} s: {one.above}",
            one.evidence == Evidence.CERTIFIED,
            one.least is None or one.least > 0,
        )
        for row in rows
        for one in ([row.distance] if row.distance and row.distance.timed else [])
    ]
    return papers_picture(bars, title="How far each printed total is from its own optimum")
