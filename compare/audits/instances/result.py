"""What instances show: samples, reductions, and their distribution."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....nlp import Evidence
from ....problem import Array
from ....problem.cases import InstancesBlock
from ...documents import (
    Effect,
    ExaminedInstances,
    Instance,
    InstanceUnderReading,
    KnownOptimum,
    Procedure,
    Reduction,
    Totals,
    Why,
    known,
)

MIDDLE = 0.9
"""Share of a distribution within which a printed reduction counts as reproduced."""


@dataclass(frozen=True)
class Optimum:
    """Total (s) of a solve, inf without an answer, and how it ended."""

    total: float
    evidence: Evidence
    status: str


@dataclass(frozen=True, eq=False)
class Sample:
    """One instance under one reading.

    Attributes
    ----------
    step : float
        rad or m.
    waypoints : ndarray, shape (way-points, joints)
        rad.
    totals : ndarray, shape (objectives, 3, runs)
        Reported totals, s, of the slower procedure, the slower one's algorithm on the faster
        one's curve, and the faster procedure; inf if a run has no answer that keeps its limits.
    settled : ndarray, shape (objectives, 3, runs)
        Iteration from which the best-so-far stays within `SETTLED` of its final value.
    """

    reading: str
    step: float
    index: int
    waypoints: Array
    slower: Optimum
    faster: Optimum
    totals: Array
    settled: NDArray[np.intp]

    def reductions(self, effect: Effect, objective: int = 0) -> Array:
        """Share by which the total falls, of every pair of runs; nan where one has no answer.

        Parameters
        ----------
        objective : int
            Position among the design's objectives; the optima have none.
        """
        if effect is Effect.CURVE:
            before, after = np.array([self.slower.total]), np.array([self.faster.total])
        else:
            first = 0 if effect is Effect.BOTH else 1
            before, after = self.totals[objective, first], self.totals[objective, 2]
        known = np.isfinite(before)[:, None] & np.isfinite(after)[None, :]
        with np.errstate(invalid="ignore"):
            shares = 1.0 - after[None, :] / before[:, None]
        return np.where(known, shares, np.nan).ravel()


@dataclass(frozen=True)
class Distribution:
    """Quantiles of reductions, in 0..1 or below, with pairs that have none counted apart."""

    pairs: int
    missing: int
    lowest: float
    lower_quarter: float
    median: float
    upper_quarter: float
    highest: float
    shorter: float
    """Share of the pairs with a reduction above 0."""

    def __str__(self) -> str:
        if self.missing == self.pairs:
            return f"no pair of answers in {self.pairs}"
        low, middle, high = (
            f"{100 * x:.1f}".replace("-", "−") for x in (self.lowest, self.median, self.highest)
        )
        text = f"median {middle} % ({low} to {high} %)"
        return text + (f", {self.missing} of {self.pairs} without answer" if self.missing else "")


def distribution(reductions: Array) -> Distribution:
    """Quantiles of reductions, which are nan where a pair has none; nothing is clipped.

    All are nan if no pair has one.
    """
    known = reductions[np.isfinite(reductions)]
    if not known.size:
        known = np.array([np.nan])
    low, quarter, middle, three, high = map(float, np.quantile(known, [0.0, 0.25, 0.5, 0.75, 1.0]))
    missing = int(np.isnan(reductions).sum())
    shorter = float((known > 0).mean()) if missing < reductions.size else np.nan
    return Distribution(reductions.size, missing, low, quarter, middle, three, high, shorter)


@dataclass(frozen=True, eq=False)
class InstancesResult:
    """What the two procedures of a relative claim do on instances drawn for it.

    Attributes
    ----------
    slower, faster : Procedure
        The one that is said to be slower, and the paper's.
    printed : tuple of float or None
        Smallest and largest reduction that the printed digits allow.
    iterations : int
        Budget of the faster procedure's algorithm.
    samples : tuple of Sample
        By step, instance and reading, in this order; failures included.
    labels : mapping of str to str
        What each reading means in words.
    """

    block: InstancesBlock
    slower: Procedure
    faster: Procedure
    printed: tuple[float, float] | None
    readings: tuple[str, ...]
    iterations: int
    samples: tuple[Sample, ...]
    printed_totals: tuple[str | None, str | None] = (None, None)
    """Of the slower and the faster procedure, with their unit."""
    labels: Mapping[str, str] = field(default_factory=dict)

    @property
    def instances(self) -> int:
        """Instances of all steps together."""
        return len(self.block.steps) * self.block.instances

    def of(self, reading: str, step: float | None = None) -> tuple[Sample, ...]:
        """Instances under one reading, of one step or of all."""
        return tuple(
            s for s in self.samples if s.reading == reading and (step is None or s.step == step)
        )

    def reductions(
        self, reading: str, effect: Effect, objective: int = 0, step: float | None = None
    ) -> Array:
        """Reductions of all instances under one reading, as `Sample.reductions`."""
        return np.concatenate([s.reductions(effect, objective) for s in self.of(reading, step)])

    def median_interval(
        self, reading: str, effect: Effect, objective: int = 0
    ) -> tuple[float, float]:
        """95 % interval of the median reduction of an instance, by resampling the instances.

        Pairs of runs on one instance depend on each other, so instances are drawn, each with
        its median; percentiles with a fixed seed. nan with fewer than two instances with answers.
        """
        each = [distribution(s.reductions(effect, objective)).median for s in self.of(reading)]
        known = np.array([m for m in each if np.isfinite(m)])
        if known.size < 2:
            return float("nan"), float("nan")
        if np.ptp(known) == 0.0:
            return float(known[0]), float(known[0])
        from scipy.stats import bootstrap  # half a second, and few need it

        # With so many resamples the ends move by about a tenth of the width.
        found = bootstrap(
            (known,), np.median, n_resamples=1000, method="percentile", rng=0
        ).confidence_interval
        return float(found.low), float(found.high)

    def totals(self, reading: str, route: int, objective: int = 0) -> Array:
        """Totals (s) of a procedure's runs on all instances: 0 the slower one, 2 the faster."""
        every = np.concatenate([s.totals[objective, route] for s in self.of(reading)])
        return np.asarray(every[np.isfinite(every)])

    def settled(self, reading: str, objective: int = 0) -> NDArray[np.intp]:
        """Iterations at which the faster procedure's runs settled, those without answer apart."""
        chosen = [
            s.settled[objective, 2][np.isfinite(s.totals[objective, 2])] for s in self.of(reading)
        ]
        return np.concatenate(chosen)

    def failed(self, reading: str, objective: int = 0) -> int:
        """Runs without an answer that keeps its limits, over all routes."""
        return sum(int(np.isinf(s.totals[objective]).sum()) for s in self.of(reading))

    def label(self, reading: str) -> str:
        """What a reading means in words."""
        return self.labels.get(reading, reading)

    @property
    def unsolved(self) -> tuple[str, ...]:
        """Optima that are not known, in words."""
        found = []
        for s in self.samples:
            for problem, one in ((self.slower.problem, s.slower), (self.faster.problem, s.faster)):
                if not np.isfinite(one.total):
                    at = f"step {s.step:g}, instance {s.index + 1}, {self.label(s.reading)}"
                    found.append(f"{problem}, {at}: {one.status}")
        return tuple(found)


def reproduced(result: InstancesResult, reading: str) -> bool:
    """Whether the printed reduction lies in the middle of those of one run against one run."""
    values = result.reductions(reading, Effect.BOTH)
    known = values[np.isfinite(values)]
    if result.printed is None or not known.size:
        return False
    low, high = np.quantile(known, [(1 - MIDDLE) / 2, (1 + MIDDLE) / 2])
    return bool(result.printed[0] <= high and low <= result.printed[1])


def percent_range(low: float, high: float, digits: int = 2) -> str:
    """Two shares as one range in percent, such as "10.40 to 10.55 %"."""
    ends = [f"{100 * x + 0.0:.{digits}f}" for x in (low, high)]
    return " to ".join(dict.fromkeys(ends)).replace("-", "−") + " %"


def examined_entry(result: InstancesResult) -> ExaminedInstances:
    """Everything that was computed on the instances of one design."""
    block = result.block
    low, high = result.printed or (None, None)
    absent = "no reduction is printed"
    return ExaminedInstances(
        id=block.id,
        claim=block.claim,
        why=block.why,
        kind=block.kind,
        unit=block.unit,
        steps=block.lengths,
        instances_per_step=block.instances,
        seed=block.seed,
        samples=block.samples,
        runs=block.runs,
        objectives=block.objectives,
        readings=result.readings,
        slower=result.slower,
        faster=result.faster,
        printed_lowest=known(low, absent),
        printed_highest=known(high, absent),
        reductions=tuple(_reductions(result)),
        instances=tuple(_instance(result, s) for s in result.of(result.readings[0])),
    )


def _reductions(result: InstancesResult) -> Iterator[Reduction]:
    """Of each reading and effect, under each objective, for all steps together and for each."""
    none = Why("no pair of runs has two answers")
    for reading, effect in product(result.readings, Effect):
        alone = effect is Effect.CURVE
        objectives = list(enumerate(result.block.objectives))
        for (at, objective), step in product(
            objectives[:1] if alone else objectives, (None, *result.block.lengths)
        ):
            found = distribution(result.reductions(reading, effect, at, step))
            low, high = np.nan, np.nan
            apart = Why("instances are resampled over all steps together")
            if step is None:
                low, high = result.median_interval(reading, effect, at)
                apart = Why("fewer than two instances have answers")
            numbers: dict[str, Any] = dict(vars(found))
            if found.missing == found.pairs:
                numbers = dict.fromkeys(numbers, none)
            yield Reduction(
                reading=reading,
                effect=effect,
                objective=None if alone else objective,
                step=step,
                **numbers | {"pairs": found.pairs, "missing": found.missing},
                median_from=low if np.isfinite(low) else apart,
                median_to=high if np.isfinite(high) else apart,
            )


def _instance(result: InstancesResult, first: Sample) -> Instance:
    own = [s for s in result.samples if (s.step, s.index) == (first.step, first.index)]
    return Instance(
        step=first.step,
        instance=first.index,
        waypoints=first.waypoints.tolist(),
        readings=tuple(_under_reading(result, s) for s in own),
    )


def _under_reading(result: InstancesResult, sample: Sample) -> InstanceUnderReading:
    return InstanceUnderReading(
        reading=sample.reading,
        slower_optimum=_optimum(sample.slower),
        faster_optimum=_optimum(sample.faster),
        totals=tuple(
            Totals(
                objective=objective,
                slower=_finite(sample.totals[at, 0]),
                slower_algorithm_on_faster_curve=_finite(sample.totals[at, 1]),
                faster=_finite(sample.totals[at, 2]),
            )
            for at, objective in enumerate(result.block.objectives)
        ),
    )


def _finite(totals: Array) -> tuple[float | None, ...]:
    return tuple(float(t) if np.isfinite(t) else None for t in totals)


def _optimum(optimum: Optimum) -> KnownOptimum:
    unsolved = Why("the optimum is not known")
    return KnownOptimum(
        total_time=optimum.total if np.isfinite(optimum.total) else unsolved,
        evidence=optimum.evidence,
        status=optimum.status,
    )
