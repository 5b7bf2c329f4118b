"""From rows to standings: gap quantiles, targets reached, and who is shorter than whom."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from ...nlp import Solution
from ...problem import Array
from ..documents import (
    BenchResult,
    Reference,
    Standing,
    TargetReached,
    Why,
    value_or_none,
)
from .optimality_gap import gap
from .rows import Row, RowStatus
from .statistics import compare_pairs, quantiles
from .targets import (
    TARGETS,
    expected_running_time,
    hit,
    running_time_interval,
    success_interval,
)

_NO_ANSWER = "as many runs found no feasible answer"
"""Why a quantile is missing."""


def totals_of(rows: Sequence[Row]) -> Array:
    """Feasible times of runs, s; inf for a run without an answer.

    The feasible time is T·max(1, c*) as `trajgap.problem.check` finds it, whatever the optimiser
    reports.
    """
    times = [row.feasible_time for row in rows]
    return np.array([np.inf if time is None else time for time in times])


def bench_result(
    rows: Mapping[str, Sequence[Row]],
    optimum: Solution | Reference | float,
    *,
    problem: str,
    reading: str,
    budget: int,
    seeds: int,
    notes: tuple[str, ...] = (),
) -> BenchResult:
    """Standings of optimisers on one problem, by their labels, the smallest median gap first."""
    reference = gap(1.0, optimum).reference
    standings = [_standing(label, one, reference) for label, one in rows.items()]
    standings.sort(key=_order)
    totals = {s.optimizer: totals_of(rows[s.optimizer]) for s in standings}
    return BenchResult(
        problem=problem,
        reading=reading,
        budget=budget,
        seeds=seeds,
        optimum=reference,
        notes=notes,
        standings=tuple(standings),
        pairs=compare_pairs(totals),
    )


def _order(standing: Standing) -> tuple[float, float]:
    median, best = value_or_none(standing.median), value_or_none(standing.best)
    return np.inf if median is None else median, np.inf if best is None else best


def _standing(label: str, rows: Sequence[Row], reference: Reference) -> Standing:
    totals = totals_of(rows)
    ends = quantiles(totals, (0.0, 0.25, 0.5, 0.75))
    best, low, median, high = (_gap(total, reference.upper) for total in ends)
    base = value_or_none(reference.lower)
    failed = [row for row in rows if row.status is RowStatus.FAILED]
    return Standing(
        optimizer=label,
        handling=rows[0].handling,
        settings=rows[0].settings,
        runs=len(rows),
        failed=len(failed),
        messages=_messages(rows),
        feasible=sum(row.feasible for row in rows),
        best=best,
        lower_quartile=low,
        median=median,
        upper_quartile=high,
        median_total=_finite(float(ends[2]), _NO_ANSWER),
        median_highest=Why("no lower bound is certified") if base is None else _gap(ends[2], base),
        evaluations=float(np.median([row.evaluations for row in rows])),
        targets=tuple(_target(rows, reference.upper, one) for one in TARGETS),
    )


def _messages(rows: Sequence[Row]) -> tuple[str, ...]:
    said = [
        f"failed: {row.message}"
        if row.status is RowStatus.FAILED
        else f"without a feasible answer: {row.feasible_why}"
        for row in rows
        if row.feasible_time is None
    ]
    return tuple(f"{n} of {len(rows)} runs {why}" for why, n in Counter(said).items())


def _gap(total: float, base: float) -> float | Why:
    return _finite(float(total / base - 1), _NO_ANSWER)


def _target(rows: Sequence[Row], optimum: float, wanted: float) -> TargetReached:
    hits = np.array([hit(row, optimum * (1 + wanted)) for row in rows])
    return target_reached(wanted, hits, np.array([row.spent for row in rows], dtype=np.float64))


def target_reached(wanted: float, hits: Array, spent: Array) -> TargetReached:
    """How often and how soon runs come within a relative gap.

    `hits, spent`: shape (runs,), evaluations until each run reaches it, inf if it does not, and
    those of the whole run.
    """
    reached = int(np.isfinite(hits).sum())
    lowest, highest = success_interval(reached, hits.size)
    low, high = running_time_interval(hits, spent)
    never = "no run reached it"
    unbounded = "in some samples of the runs none reached it"
    return TargetReached(
        gap=wanted,
        reached=reached,
        rate=reached / hits.size,
        rate_lowest=lowest,
        rate_highest=highest,
        evaluations=_finite(expected_running_time(hits, spent), never),
        evaluations_lowest=_finite(low, never),
        evaluations_highest=_finite(high, unbounded if reached else never),
    )


def _finite(value: float, why: str) -> float | Why:
    return value if np.isfinite(value) else Why(why)
