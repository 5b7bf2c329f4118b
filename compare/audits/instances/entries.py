"""What instances show, as part of the audit's document."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....problem import Array
from ...documents import (
    Effect,
    ExaminedInstances,
    Instance,
    InstanceUnderReading,
    KnownOptimum,
    Reduction,
    Totals,
    Why,
    known,
)
from .result import InstancesResult, Optimum, Sample, distribution


def examined_entry(result: InstancesResult) -> ExaminedInstances:
    """Everything that was computed on the instances of one design.

    Parameters
    ----------
    result : InstancesResult

    Returns
    -------
    ExaminedInstances
    """
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
    for reading in result.readings:
        for effect in Effect:
            alone = effect is Effect.CURVE
            for at, objective in enumerate(result.block.objectives[: 1 if alone else None]):
                for step in (None, *result.block.lengths):
                    found = distribution(result.reductions(reading, effect, at, step))
                    empty = found.missing == found.pairs
                    low, high = (
                        result.median_interval(reading, effect, at)
                        if step is None
                        else (np.nan, np.nan)
                    )
                    apart = Why(
                        "instances are resampled over all steps together"
                        if step is not None
                        else "fewer than two instances have answers"
                    )
                    none = Why("no pair of runs has two answers")
                    yield Reduction(
                        reading=reading,
                        effect=effect,
                        objective=None if alone else objective,
                        step=step,
                        pairs=found.pairs,
                        missing=found.missing,
                        lowest=none if empty else found.lowest,
                        lower_quarter=none if empty else found.lower_quarter,
                        median=none if empty else found.median,
                        upper_quarter=none if empty else found.upper_quarter,
                        highest=none if empty else found.highest,
                        shorter=none if empty else found.shorter,
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
