"""Which of two optimisers is shorter, run against run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from ...problem import TOLERANCE, Array
from ..documents import PairCompared

_SAMPLES = 2000
"""Bootstrap samples of an interval: its ends move by about 1 % of its width with the seed."""
LEAST_RUNS = 5
"""Runs of each from which on two optimisers are compared: below it the smallest p-value of the
rank test is above 1 %, whatever the runs say."""


def vargha_delaney(first: Array, second: Array) -> float:
    """Probability that a run of the first is shorter than one of the second, a tie counting half.

    Source: Vargha and Delaney, "A critique and improvement of the CL common language effect size
    statistics of McGraw and Wong", 2000, A₁₂. Computed from the U of scipy's `mannwhitneyu`.

    Parameters
    ----------
    first, second : ndarray
        Totals, s; inf for a run without answer, which ties with its like.

    Returns
    -------
    float
        0.5 if neither is shorter; 1 if the first always is.
    """
    return _superiority(*_tied(first, second))


def compare_pair(first: Array, second: Array) -> tuple[float, float, float, float, float]:
    """Share of pairs that the first wins, share of ties, A₁₂, and its 95 % interval.

    Runs are resampled, not pairs, which depend on each other. Percentiles of 2,000 samples, with
    a fixed seed.
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
    return (
        float(shorter.mean()), float(equal.mean()), float(won.mean()), float(low), float(high)
    )  # fmt: skip


def compare_pairs(totals: Mapping[str, Array]) -> tuple[PairCompared, ...]:
    """Every pair of optimisers, with Mann and Whitney's test and Holm's correction.

    The test is for independent samples: the streams of two optimisers differ even where the seeds
    are called alike (see `bench`), so runs are not paired and no signed-rank test is made.

    Parameters
    ----------
    totals : mapping of str to ndarray
        Totals of each optimiser's runs, s; inf for a run without answer. Those with fewer than
        `LEAST_RUNS` are left out.

    Returns
    -------
    tuple of PairCompared
        In the order given.
    """
    pairs = list(combinations([n for n, one in totals.items() if one.size >= LEAST_RUNS], 2))
    tests = [_p_value(*_tied(totals[a], totals[b])) for a, b in pairs]
    found = []
    for (a, b), p in zip(pairs, corrected(tests), strict=True):
        wins, ties, a12, low, high = compare_pair(totals[a], totals[b])
        found.append(
            PairCompared(
                first=a,
                second=b,
                first_shorter=wins,
                equal=ties,
                vargha_delaney=a12,
                lowest=low,
                highest=high,
                p_value=p,
            )
        )
    return tuple(found)


def corrected(p_values: Sequence[float]) -> tuple[float, ...]:
    """p-values of several tests made at once, after Holm (1979).

    Examples
    --------
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


def _superiority(a: Array, b: Array) -> float:
    from scipy.stats import mannwhitneyu  # half a second, and few need it

    return float(mannwhitneyu(b, a).statistic) / (a.size * b.size)


def _p_value(a: Array, b: Array) -> float:
    if np.ptp(np.concatenate([a, b])) == 0:
        return 1.0  # all tie, and scipy would divide by their spread
    from scipy.stats import mannwhitneyu  # half a second, and few need it

    return float(mannwhitneyu(a, b).pvalue)


def _weights(rng: np.random.Generator, count: int) -> Array:
    """How often each run is drawn in each bootstrap sample, as shares."""
    shares: Array = rng.multinomial(count, np.full(count, 1 / count), size=_SAMPLES) / count
    return shares
