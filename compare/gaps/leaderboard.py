"""The leaderboard: how near each optimiser gets to the certified optima of many problems."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from ...problem import Array
from ...problem.suite import load_instance
from .rows import Row, RowStatus
from .standings import totals_of
from .statistics import SAMPLES, interval, quantiles
from .store import Store
from .studies import StudyPlan, parse_study
from .targets import hit, running_times
from .trials import DESCENT

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


LEADERBOARD = "leaderboard"
"""The word by which commands know the shipped study and its results."""
SIZES = ("1 to 3 segments", "4 to 6 segments", "7 to 10 segments")
"""Classes of instances by their number of segments: half of the suite has three."""


@dataclass(frozen=True, eq=False)
class Ranked:
    """One optimiser over all problems of a leaderboard, which have equal weight.

    Intervals come from resampling the problems: they show how much the numbers depend on the choice
    of problems.
    """

    optimizer: str
    """Label in the study."""
    problems: int
    runs: int
    failed: int
    median: float
    """Median over the problems of the median gap, relative; inf without an answer."""
    within: Array
    """Share of runs that come within each gap of `LADDER`; shape (gaps,)."""
    solved: tuple[tuple[float, float, float], ...]
    """For each gap of `SOLVED` the share of runs within it, with its 95 % interval."""
    expected: tuple[tuple[float, float, float], ...]
    """For each gap of `SOLVED` the evaluations of all runs over the number of hits, with its 95 %
    interval; inf without a hit."""


@dataclass(frozen=True, eq=False)
class Board:
    """Optimisers with the same budget and handling on the same problems."""

    budget: int
    handling: str
    problems: tuple[str, ...]
    """Problems on which each of them has all its runs."""
    standings: tuple[Ranked, ...]
    """The largest share of runs within 0.1 % first, then within 0.01 %, then within 1 %."""
    missing: tuple[str, ...]
    """Optimisers whose runs are not complete on these problems."""

    @property
    def searches(self) -> tuple[Ranked, ...]:
        """Optimisers that see durations only: all but the descent, which is a reference."""
        return tuple(one for one in self.standings if one.optimizer != DESCENT)

    def place(self, one: Ranked) -> int | None:
        """The place of an optimiser among the searches, from 1; None for the reference."""
        return self.searches.index(one) + 1 if one.optimizer != DESCENT else None


def leaderboard_study() -> StudyPlan:
    """The study behind the leaderboard."""
    text = files(__package__ or "").joinpath("leaderboard.toml").read_text(encoding="utf-8")
    return parse_study(text, LEADERBOARD, Path())


@lru_cache(maxsize=1)
def leaderboard_rows() -> tuple[Summary, ...]:
    """The committed results of `trajgap study leaderboard`."""
    text = files(__package__ or "").joinpath("leaderboard.csv").read_text(encoding="utf-8")
    return read_summaries(text)


def boards(found: Iterable[Summary]) -> tuple[Board, ...]:
    """Standings for each budget, and under it for each handling, that some problem is complete for.

    A board contains only optimisers with all their runs on all its problems, which are those that
    at least half of the optimisers have finished.
    """
    parts: dict[tuple[int, str], dict[str, dict[str, Summary]]] = {}
    for one in found:
        own = parts.setdefault((one.budget, one.handling), {})
        own.setdefault(one.optimizer, {})[one.problem] = one
    made = (_board(*key, own) for key, own in sorted(parts.items()))
    return tuple(board for board in made if board.problems)


def _board(budget: int, handling: str, own: dict[str, dict[str, Summary]]) -> Board:
    finished = Counter(problem for each in own.values() for problem in each)
    problems = tuple(sorted(name for name, n in finished.items() if 2 * n >= len(own)))
    complete = {
        label: [each[name] for name in problems]
        for label, each in own.items()
        if all(name in each for name in problems)
    }
    ranked = [_ranked(label, rows) for label, rows in complete.items()] if problems else []
    ranked.sort(key=_order)
    missing = tuple(label for label in own if label not in complete)
    return Board(budget, handling, problems, tuple(ranked), missing)


def _order(one: Ranked) -> tuple[float, float, float, float]:
    coarse, middle, fine = (share for share, _, _ in one.solved)
    return -middle, -fine, -coarse, one.median


def _ranked(label: str, rows: Sequence[Summary]) -> Ranked:
    runs = np.array([one.runs for one in rows])
    within = np.array([one.within for one in rows])
    spent = np.array([one.spent for one in rows])
    at = [LADDER.index(gap) for gap in SOLVED]
    shares = within / runs[:, None]
    rng = np.random.Generator(np.random.PCG64(0))
    drawn = rng.integers(len(rows), size=(SAMPLES, len(rows)))
    expected = running_times(spent[drawn].sum(axis=1), within[drawn][:, :, at].sum(axis=1))
    return Ranked(
        optimizer=label,
        problems=len(rows),
        runs=int(runs.sum()),
        failed=sum(one.failed for one in rows),
        median=float(quantiles(np.array([one.median for one in rows]), [0.5])[0]),
        within=shares.mean(axis=0),
        solved=_with_ends(shares.mean(axis=0)[at], shares[drawn][:, :, at].mean(axis=1)),
        expected=_with_ends(running_times(spent.sum(axis=0), within[:, at].sum(axis=0)), expected),
    )


def _with_ends(values: Array, samples: Array) -> tuple[tuple[float, float, float], ...]:
    """Values with the 95 % interval of their samples, shape (samples, values)."""
    low, high = interval(samples)
    return tuple(
        (float(value), float(one), float(other))
        for value, one, other in zip(values, low, high, strict=True)
    )


def curve_of(problem: str) -> str:
    """Kind of curve of an instance, by the name of its problem in rows."""
    return load_instance(problem.partition("/")[0]).curve


def size_of(problem: str) -> str:
    """Class of `SIZES` of an instance, by the name of its problem in rows."""
    segments = load_instance(problem.partition("/")[0]).segments
    return SIZES[0 if segments <= 3 else 1 if segments <= 6 else 2]
