"""A family of instances as part of the audit's JSON document."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..audits.instances import Effect, FamilyResult, Optimum, Sample, distribution
from .undefined import number_or_why

_NONE = "no pair of runs has two answers"
_UNSOLVED = "the optimum is not known"


def family_document(result: FamilyResult) -> dict[str, Any]:
    """Everything that was computed on a family of instances.

    Parameters
    ----------
    result : FamilyResult

    Returns
    -------
    dict
        Keys as in docs/output.schema.json.
    """
    block = result.block
    low, high = result.printed or (None, None)
    absent = "no reduction is printed"
    return {
        "id": block.id,
        "claim": block.claim,
        "why": block.why,
        "kind": block.kind,
        "unit": block.unit,
        "steps": list(block.lengths),
        "instances_per_step": block.instances,
        "seed": block.seed,
        "samples": block.samples,
        "runs": block.runs,
        "objectives": list(block.objectives),
        "readings": list(result.readings),
        "slower": {"problem": result.slower.problem, "algorithm": result.slower.algorithm},
        "faster": {"problem": result.faster.problem, "algorithm": result.faster.algorithm},
        **number_or_why("printed_lowest", low, absent),
        **number_or_why("printed_highest", high, absent),
        "reductions": [
            _distributed(result, reading, effect, at, step)
            for reading in result.readings
            for effect in Effect
            for at in range(1 if effect is Effect.CURVE else len(block.objectives))
            for step in (None, *block.lengths)
        ],
        "instances": [_instance(result, s) for s in result.of(result.readings[0])],
    }


def _distributed(
    result: FamilyResult, reading: str, effect: Effect, at: int, step: float | None
) -> dict[str, Any]:
    found = distribution(result.reductions(reading, effect, at, step))
    empty = found.missing == found.pairs
    quantiles = ("lowest", "lower_quarter", "median", "upper_quarter", "highest", "shorter")
    document: dict[str, Any] = {
        "reading": reading,
        "effect": str(effect),
        "objective": None if effect is Effect.CURVE else result.block.objectives[at],
        "step": step,
        "pairs": found.pairs,
        "missing": found.missing,
    }
    for name in quantiles:
        document |= number_or_why(name, None if empty else getattr(found, name), _NONE)
    return document


def _instance(result: FamilyResult, first: Sample) -> dict[str, Any]:
    own = [s for s in result.samples if (s.step, s.index) == (first.step, first.index)]
    return {
        "step": first.step,
        "instance": first.index,
        "waypoints": first.waypoints.tolist(),
        "readings": [_sample(result, s) for s in own],
    }


def _sample(result: FamilyResult, sample: Sample) -> dict[str, Any]:
    names = ("slower", "slower_algorithm_on_faster_curve", "faster")
    return {
        "reading": sample.reading,
        "slower_optimum": _optimum(sample.slower),
        "faster_optimum": _optimum(sample.faster),
        "totals": [
            {
                "objective": objective,
                **{
                    name: [float(t) if np.isfinite(t) else None for t in sample.totals[at, route]]
                    for route, name in enumerate(names)
                },
            }
            for at, objective in enumerate(result.block.objectives)
        ],
    }


def _optimum(optimum: Optimum) -> dict[str, Any]:
    total = optimum.total if np.isfinite(optimum.total) else None
    return {
        **number_or_why("total_time", total, _UNSOLVED),
        "evidence": str(optimum.evidence),
        "status": optimum.status,
    }
