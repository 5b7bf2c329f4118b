"""Spreads over seeds: what one run against one run can show by luck."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...problem import Array

SETTLED = 1e-3
"""A run counts as converged when its best-so-far is within this share of its final total."""


def quantiles(values: Array, levels: Sequence[float]) -> Array:
    """Quantiles over runs, some of which may have no answer.

    A level that falls between two runs, such as the median of an even number, is the mean of both
    (definition 2 of Hyndman and Fan, "Sample quantiles in statistical packages", 1996). It is
    infinite as soon as either is: numpy's own interpolation says nan there.

    Parameters
    ----------
    values : ndarray, shape (runs, ...)
        inf for a run without answer.
    levels : sequence of float
        In 0..1.

    Returns
    -------
    ndarray, shape (levels, ...)
    """
    ordered = np.sort(values, axis=0)
    at = np.asarray(levels) * len(ordered)
    below = np.maximum(np.ceil(at).astype(int) - 1, 0)
    above = np.minimum(np.floor(at).astype(int), len(ordered) - 1)
    return np.asarray((ordered[below] + ordered[above]) / 2, dtype=np.float64)


@dataclass(frozen=True)
class Spread:
    """Totals of many seeds: count, failures (infinite totals) and quantiles of the rest, s."""

    runs: int
    failed: int
    lowest: float
    median: float
    highest: float

    def __str__(self) -> str:
        if self.failed == self.runs:
            return f"no feasible answer in {self.runs} runs"
        text = f"median {self.median:.4f} s ({self.lowest:.4f} to {self.highest:.4f})"
        return text + (f", {self.failed} of {self.runs} without answer" if self.failed else "")


def spread(totals: Array) -> Spread:
    """Spread of the totals of one algorithm over its seeds.

    Parameters
    ----------
    totals : ndarray, shape (runs,)
        Seconds; inf for a run without feasible answer, kept and counted.

    Returns
    -------
    Spread
    """
    good = totals[np.isfinite(totals)]
    if good.size == 0:
        return Spread(totals.size, totals.size, np.inf, np.inf, np.inf)
    return Spread(
        runs=totals.size,
        failed=totals.size - good.size,
        lowest=float(good.min()),
        median=float(np.median(good)),
        highest=float(good.max()),
    )


def share_of_pairs(slower: Array, faster: Array, reduction: float) -> float:
    """Share of pairs, one run of each, in which the second is shorter by at least ``reduction``.

    Parameters
    ----------
    slower, faster : ndarray
        Totals, s.
    reduction : float
        Relative to the slower total, e.g. 0.109.

    Returns
    -------
    float
        In 0..1; nan if there is no pair of finite totals.
    """
    return _share(slower, faster, reduction, np.ones((slower.size, faster.size), dtype=bool))


def share_of_luck(totals: Array, reduction: float) -> float:
    """The same for two different runs of one algorithm: what luck alone shows."""
    return _share(totals, totals, reduction, ~np.eye(totals.size, dtype=bool))


def share_interval(slower: Array, faster: Array, reduction: float) -> tuple[float, float]:
    """95 % interval of `share_of_pairs`, by resampling the runs of both algorithms.

    Pairs of the same runs depend on each other, so that runs are drawn and not pairs. Percentiles
    of 1,000 samples, with a fixed seed.

    Parameters
    ----------
    slower, faster : ndarray
        Totals, s; at least two each.
    reduction : float

    Returns
    -------
    (float, float)
        nan if there is no pair of finite totals, or so few finite totals that some sample has none.
    """
    if not (np.isfinite(slower).any() and np.isfinite(faster).any()):
        return float("nan"), float("nan")
    from scipy.stats import DegenerateDataWarning, bootstrap  # half a second, and few need it

    with warnings.catch_warnings():
        # Of samples without a pair, which the answer tells.
        warnings.simplefilter("ignore", DegenerateDataWarning)
        found = bootstrap(
            (slower, faster),
            lambda a, b: share_of_pairs(a, b, reduction),
            n_resamples=1000,
            vectorized=False,
            method="percentile",
            rng=0,
        ).confidence_interval
    return float(found.low), float(found.high)


def _share(
    slower: Array,
    faster: Array,
    reduction: float,
    paired: NDArray[np.bool_],
) -> float:
    with np.errstate(invalid="ignore"):
        reductions = 1.0 - faster[None, :] / slower[:, None]
    pairs = paired & np.isfinite(slower)[:, None] & np.isfinite(faster)[None, :]
    return float((reductions[pairs] >= reduction).mean()) if pairs.any() else float("nan")


def settled_at(trace: Array, tolerance: float) -> int:
    """First iteration from which the best-so-far stays within ``tolerance`` (s) of its end."""
    close = trace <= trace[-1] + tolerance
    return int(np.argmax(close)) if np.isfinite(trace[-1]) else trace.size
