"""Rows of one optimiser on one problem, summed up in one: what a leaderboard is made from."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from .rows import Row, RowStatus
from .standings import totals_of
from .statistics import quantiles
from .store import Store
from .studies import StudyPlan
from .targets import hit

LADDER = tuple(float(f"{gap:.4g}") for gap in np.logspace(0, -6, 13))
"""Relative gaps at which runs are counted, two for every tenfold: from twice the optimum to a
millionth above it, as the curves of a bench."""
SOLVED = (0.01, 1e-3, 1e-4)
"""Gaps of `LADDER` that tables show: 1 % and 0.1 % are what papers' printed digits can tell apart,
0.01 % is below them."""


@dataclass(frozen=True)
class Summary:
    """Summary of the runs of one optimiser on one problem, over all seeds."""

    problem: str
    """As rows call it."""
    optimizer: str
    """Label of the optimiser in its study."""
    handling: str
    budget: int
    """Evaluations of each run."""
    runs: int
    failed: int
    """Number of runs, and of those that raised, hung or broke the rules."""
    lower_quartile: float
    median: float
    upper_quartile: float
    """Relative gap of the feasible time to the upper end of the optimum; inf if that
    quantile has no feasible answer."""
    within: tuple[int, ...]
    """Number of runs that come within each gap of `LADDER`."""
    spent: tuple[int, ...]
    """For each gap of `SOLVED`, evaluations of all runs up to their hits."""


def summary_of(label: str, rows: Sequence[Row]) -> Summary:
    """Summarise rows of an optimiser with a label that differ only in their seeds.

    At least one; of a problem whose optimum is known.
    """
    first = rows[0]
    optimum = first.reference_upper
    assert optimum is not None
    hits = np.array([[hit(row, optimum * (1 + gap)) for row in rows] for gap in LADDER])
    ended = np.array([row.spent for row in rows])
    gaps = quantiles(totals_of(rows) / optimum - 1, (0.25, 0.5, 0.75))
    low, median, high = (float(f"{gap:.4g}") for gap in gaps)
    asked = [LADDER.index(gap) for gap in SOLVED]
    return Summary(
        problem=first.problem,
        optimizer=label,
        handling=first.handling,
        budget=first.budget,
        runs=len(rows),
        failed=sum(row.status is RowStatus.FAILED for row in rows),
        lower_quartile=low,
        median=median,
        upper_quartile=high,
        within=tuple(int(n) for n in np.isfinite(hits).sum(axis=1)),
        spent=tuple(int(np.minimum(hits[at], ended).sum()) for at in asked),
    )


def summed_up(study: StudyPlan, store: Store) -> Iterator[Summary]:
    """Summaries of the complete parts of a study in a store, in the order of the study.

    One for each problem, optimiser, handling and budget with a run for every seed and a known
    optimum.
    """
    for label, trials in study.groups(store):
        if trials[0].reference is None or store.status(trials[-1].key) is None:
            continue
        rows = [row for row in (store.row(trial.key) for trial in trials) if row is not None]
        if len(rows) == len(trials):
            yield summary_of(label, rows)


def summaries_text(found: Iterable[Summary]) -> str:
    """Summaries as CSV: counts of several gaps stand in one cell, a gap without answer is inf."""
    names = [field.name for field in fields(Summary)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    for one in found:
        cells = [getattr(one, name) for name in names]
        writer.writerow(
            " ".join(map(str, cell)) if isinstance(cell, tuple) else cell for cell in cells
        )
    return text.getvalue()


def read_summaries(text: str) -> tuple[Summary, ...]:
    """Summaries of their CSV."""
    readers: dict[Any, Callable[[str], Any]] = {
        "str": str,
        "int": int,
        "float": float,
        "tuple[int, ...]": lambda cell: tuple(map(int, cell.split())),
    }
    kinds = {field.name: readers[field.type] for field in fields(Summary)}
    return tuple(
        Summary(**{name: kinds[name](cell) for name, cell in row.items()})
        for row in csv.DictReader(io.StringIO(text))
    )
