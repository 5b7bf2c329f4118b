"""Optimisers over many problems: each problem counts alike, gaps are relative to its optimum."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ...problem import TOLERANCE
from ..documents import BenchResult, OverallStanding, OverallTarget, Standing, Why, value_or_none
from .benching import Runs
from .rows import Row
from .statistics import quantiles


def overall(results: Sequence[BenchResult]) -> tuple[OverallStanding, ...]:
    """Results of the same optimisers on several problems, the most runs within 1 % first.

    Empty for a single problem.
    """
    if len(results) < 2:
        return ()
    least = [min(_median(one) for one in result.standings) for result in results]
    by_name: dict[str, list[Standing]] = {}
    firsts: dict[str, int] = {}
    for result, best in zip(results, least, strict=True):
        for one in result.standings:
            by_name.setdefault(one.optimizer, []).append(one)
            tied = _median(one) <= best + TOLERANCE and np.isfinite(best)
            firsts[one.optimizer] = firsts.get(one.optimizer, 0) + tied
    found = [_standing(name, own, firsts[name]) for name, own in by_name.items()]
    return tuple(sorted(found, key=_order))


def _median(standing: Standing) -> float:
    known = value_or_none(standing.median)
    return np.inf if known is None else known


def _standing(name: str, own: Sequence[Standing], first: int) -> OverallStanding:
    medians = np.array([_median(one) for one in own])
    targets = []
    for same in zip(*(one.targets for one in own), strict=True):
        rates = np.array([target.rate for target in same])
        targets.append(
            OverallTarget(
                gap=same[0].gap, rate=float(rates.mean()), solved=int((rates >= 0.5).sum())
            )
        )
    return OverallStanding(
        optimizer=name,
        problems=len(own),
        first=first,
        median=_gap(float(quantiles(medians, [0.5])[0])),
        worst=_gap(float(medians.max())),
        failed=sum(one.failed for one in own),
        targets=tuple(targets),
    )


def _gap(value: float) -> float | Why:
    why = "on too many problems half of the runs have no answer"
    return value if np.isfinite(value) else Why(why)


def _order(standing: OverallStanding) -> tuple[float, float]:
    # By the gap that a paper's digits can tell apart.
    rate = next(target.rate for target in standing.targets if target.gap == 0.01)
    return -rate, value_or_none(standing.median) or np.inf


def relative_rows(results: Iterable[tuple[BenchResult, Runs]]) -> dict[str, list[Row]]:
    """Rows of every optimiser over all problems, times as multiples of each optimum.

    Functions for one problem, such as `share_of_targets`, then work for all together, with an
    optimum of 1.
    """
    found: dict[str, list[Row]] = {}
    for result, runs in results:
        unit = result.optimum.upper
        for label, rows in runs.by_label.items():
            found.setdefault(label, []).extend(_relative(row, unit) for row in rows)
    return found


def _relative(row: Row, unit: float) -> Row:
    feasible = None if row.feasible_time is None else row.feasible_time / unit
    trace = tuple((at, total / unit) for at, total in row.trace)
    return replace(row, feasible_time=feasible, trace=trace)
