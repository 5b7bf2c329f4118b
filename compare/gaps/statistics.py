"""Spreads over seeds, and optimisers run against run: what one run against one can show by luck."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ...problem import TOLERANCE, Array
from ..documents import PairCompared

SETTLED = 1e-3
"""A run counts as converged when its best-so-far is within this share of its final total."""


def quantiles(values: Array, levels: Sequence[float]) -> Array:
    """Quantiles over runs, shape (runs, ...), inf for a run without an answer.

    A level that falls between two runs, such as the median of an even number, is the mean of both
    (definition 2 of Hyndman and Fan, "Sample quantiles in statistical packages", 1996). It is
    infinite as soon as either is: numpy's own interpolation says nan there.
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
    """Spread of the totals of one algorithm over its seeds, inf for a run without an answer, s."""
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

    nan if there is no pair of finite totals, s. `reduction`: relative to the slower total, e.g.
    0.109.
    """
    return _share(slower, faster, reduction, np.ones((slower.size, faster.size), dtype=bool))


def share_of_luck(totals: Array, reduction: float) -> float:
    """The same for two different runs of one algorithm: the share due to chance alone."""
    return _share(totals, totals, reduction, ~np.eye(totals.size, dtype=bool))


def share_interval(slower: Array, faster: Array, reduction: float) -> tuple[float, float]:
    """95 % interval of `share_of_pairs`, by resampling the runs of both algorithms, two at least.

    Pairs that share a run depend on each other, so runs are resampled, not pairs. Percentiles of
    1,000 samples, with a fixed seed. nan if there is no pair of finite totals, or so few finite
    totals that some sample has none.
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


SAMPLES = 2000
"""Bootstrap samples of an interval: its ends move by about 1 % of its width with the seed."""


def compare_pair(first: Array, second: Array) -> dict[str, float]:
    """Shares of pairs of runs that the first wins and that tie, A₁₂, and its 95 % interval.

    A₁₂ is the probability that a run of the first is shorter, a tie counting half: Vargha and
    Delaney, "A critique and improvement of the CL common language effect size statistics of McGraw
    and Wong", 2000. Runs without an answer, whose total is inf, tie with each other. Runs are
    resampled, not pairs, which depend on each other: percentiles of 2,000 samples, with a fixed
    seed.
    """
    a, b = _tied(first, second)
    shorter = a[:, None] < b[None, :]
    equal = a[:, None] == b[None, :]
    won = shorter + 0.5 * equal
    rng = np.random.Generator(np.random.PCG64(0))
    rows = _weights(rng, a.size)
    columns = _weights(rng, b.size)
    samples = np.einsum("si,ij,sj->s", rows, won, columns, optimize=True)
    low, high = np.quantile(samples, (0.025, 0.975)).clip(0.0, 1.0)  # rounding of the weights
    return {
        "first_shorter": float(shorter.mean()),
        "equal": float(equal.mean()),
        "vargha_delaney": float(won.mean()),
        "lowest": float(low),
        "highest": float(high),
    }


def compare_pairs(totals: Mapping[str, Array], least: int = 5) -> tuple[PairCompared, ...]:
    """Every pair of optimisers in order, with Mann and Whitney's test and Holm's correction.

    The test is for independent samples: the streams of two optimisers differ even for equal seeds
    (see `bench`), so runs are not paired and no signed-rank test is made. `totals`: of each
    optimiser's runs, s; inf for a run without an answer. `least`:
    runs of each that are compared; below five the smallest p-value of the rank test is above 1 %.
    """
    pairs = list(combinations([n for n, one in totals.items() if one.size >= least], 2))
    tests = [_p_value(*_tied(totals[a], totals[b])) for a, b in pairs]
    return tuple(
        PairCompared(first=a, second=b, p_value=p, **compare_pair(totals[a], totals[b]))
        for (a, b), p in zip(pairs, corrected(tests), strict=True)
    )


def interval(samples: Array) -> tuple[Array, Array]:
    """95 % intervals by bootstrap samples, shape (samples, ...), some of which may be infinite."""
    # Quantiles that are samples: between a number and infinity there is no mean.
    low, high = np.quantile(samples, (0.025, 0.975), axis=0, method="inverted_cdf")
    return low, high


def corrected(p_values: Sequence[float]) -> tuple[float, ...]:
    """p-values of several tests made at once, after Holm (1979).

    >>> corrected([0.01, 0.04, 0.03])
    (0.03, 0.06, 0.06)
    """
    adjusted = [0.0] * len(p_values)
    largest = 0.0
    for rank, at in enumerate(np.argsort(p_values, kind="stable")):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[at]))
        adjusted[at] = largest
    return tuple(adjusted)


def _tied(first: Array, second: Array) -> tuple[Array, Array]:
    """Ranks of totals, equal where the totals differ by less than the checker's tolerance."""
    every = np.concatenate([first, second])
    order = np.argsort(every, kind="stable")
    ascending = every[order]
    with np.errstate(invalid="ignore"):
        apart = ascending[1:] > ascending[:-1] * (1 + TOLERANCE)
    ranks = np.empty(every.size)
    ranks[order] = np.concatenate([[0.0], np.cumsum(apart)])
    return ranks[: first.size], ranks[first.size :]


def _p_value(a: Array, b: Array) -> float:
    if np.ptp(np.concatenate([a, b])) == 0:
        return 1.0  # all tie, and scipy would divide by their spread
    from scipy.stats import mannwhitneyu  # half a second, and few need it

    return float(mannwhitneyu(a, b).pvalue)


def _weights(rng: np.random.Generator, count: int) -> Array:
    """How often each run is drawn in each bootstrap sample, as shares."""
    shares: Array = rng.multinomial(count, np.full(count, 1 / count), size=SAMPLES) / count
    return shares
