"""How often and how soon runs come within given gaps of the optimum."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from ...problem import Array
from .rows import Row
from .statistics import SAMPLES, interval, quantiles

TARGETS = (0.1, 0.01, 1e-3, 1e-4, 1e-6)
"""Relative gaps that are asked for: 10 % is a poor answer, 1 % and 0.1 % are what papers' printed
digits can tell apart, 0.01 % is below them, 1e-6 is a solver's answer."""

CURVE_TARGETS = tuple(float(g) for g in np.logspace(0, -6, 61))
"""Targets of the share of targets reached, ten for every tenfold: from twice the optimum to a
millionth above it."""


def hit(row: Row, total: float) -> float:
    """Evaluations after which the best total of a run was at most this large (s); inf if never.

    Counted at the log-spaced evaluations of the row's trace, so up to 7.5 % too many and never
    too few. A run whose answer fails `trajgap.problem.check` never hits.
    """
    if not row.feasible:
        return np.inf
    return next((float(at) for at, best in row.trace if best <= total), np.inf)


def expected_running_time(hits: Array, evaluations: Array) -> float:
    """Evaluations that independent restarts need on average until the first one hits; inf if none.

    The evaluations of all runs, up to the hit if there is one, divided by the number of hits.
    Source: Hansen, Auger, Ros, Mersmann, Tušar, Brockhoff, "COCO: a platform for comparing
    continuous optimizers in a black-box setting", 2021, section 5.

    `hits, evaluations`: shape (runs,), those at the hit, inf if there is none, and those of the
    whole run.

    >>> expected_running_time(np.array([100.0, np.inf, 300.0]), np.array([500.0, 500.0, 500.0]))
    450.0
    """
    reached = np.isfinite(hits)
    return float(running_times(np.where(reached, hits, evaluations).sum(), reached.sum()))


def running_times(spent: Array, hits: Array) -> Array:
    """Evaluations of all runs over the number of hits; inf where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(hits > 0, spent / hits, np.inf), dtype=np.float64)


def running_time_interval(hits: Array, evaluations: Array) -> tuple[float, float]:
    """95 % interval of `expected_running_time`, by resampling runs; inf where samples miss.

    Percentiles of 2,000 samples, with a fixed seed.
    """
    rng = np.random.Generator(np.random.PCG64(0))
    drawn = rng.integers(hits.size, size=(SAMPLES, hits.size))
    reached = np.isfinite(hits)
    spent = np.where(reached, hits, evaluations)[drawn].sum(axis=1)
    count = reached[drawn].sum(axis=1)
    low, high = interval(running_times(spent, count))
    return float(low), float(high)


def success_interval(successes: int, runs: int) -> tuple[float, float]:
    """95 % interval of a success rate (Wilson): shares p within z standard errors √(p(1 − p)/n)."""
    share = successes / runs
    z = 1.959963984540054  # 97.5 % of the normal distribution
    whole = 2 * (runs + z**2)
    middle = (2 * runs * share + z**2) / whole
    reach = z / whole * math.sqrt(4 * runs * share * (1 - share) + z**2)
    low = 0.0 if successes == 0 else middle - reach
    return low, 1.0 if successes == runs else middle + reach


def share_of_targets(
    rows: Sequence[Row], optimum: float, targets: Iterable[float] = CURVE_TARGETS
) -> tuple[Array, Array]:
    """Share of pairs of run and target that are reached after each number of evaluations (ECDF).

    Returns evaluations and shares: a share holds from its evaluation on. `rows`: of one optimiser
    on one problem; for several problems average the shares. `targets`: relative gaps.
    """
    wanted = list(targets)
    hits = np.array([hit(row, optimum * (1 + g)) for row in rows for g in wanted])
    steps, counts = np.unique(hits[np.isfinite(hits)], return_counts=True)
    return steps, np.cumsum(counts) / hits.size


def share_within(totals: Array, optimum: float) -> tuple[Array, Array]:
    """Performance profile against the optimum: share of runs that end within each ratio to it.

    Unlike a profile against the best optimiser compared, it does not depend on the other
    optimisers. Returns ratios and shares: a share holds from its ratio on. `totals`: shape (runs,),
    s; inf for a run without an answer.
    """
    ratios, counts = np.unique(totals[np.isfinite(totals)] / optimum, return_counts=True)
    return ratios, np.cumsum(counts) / totals.size


def band(rows: Sequence[Row], optimum: float, levels: Sequence[float]) -> tuple[Array, Array]:
    """`quantiles` over the runs of the gap of the best so far, at log-spaced evaluations.

    Returns evaluations, shape (points,), and relative gaps, shape (levels, points), inf if too few
    runs have an answer. A failed row counts as a run without an answer.
    """
    points = sorted({at for row in rows for at, _ in row.trace} | {max(r.budget for r in rows)})
    known = np.full((len(rows), len(points)), np.inf)
    for i, row in enumerate(rows):
        at = np.searchsorted(points, [when for when, _ in row.trace]).tolist()
        for (start, end), (_, best) in zip(pairwise([*at, len(points)]), row.trace, strict=True):
            known[i, start:end] = best
    return np.array(points, dtype=np.float64), quantiles(known / optimum - 1, levels)
