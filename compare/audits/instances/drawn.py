"""From a declared design to its instances, and their problems for both compared procedures."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, cast

from ....heuristics import Algorithm
from ....problem import CaseError, TrajgapError
from ....problem.cases import Claim, ImprovementClaim, InstancesBlock, instance_waypoints
from ...documents import Procedure
from ..replayed_case import ReplayedCase
from .result import InstancesResult
from .study import Task, examine


def _claimed(study: ReplayedCase, block: InstancesBlock) -> ImprovementClaim:
    return cast(ImprovementClaim, study.case.claim(block.claim))


def _sides(study: ReplayedCase, block: InstancesBlock) -> tuple[Claim, Claim]:
    claim = _claimed(study, block)
    return study.case.claim(claim.slower), study.case.claim(claim.faster)


def _procedure(study: ReplayedCase, side: Claim) -> Procedure:
    # A case file names both; the problem may be its only one.
    return Procedure(
        problem=side.problem or study.case.problems[0].id, algorithm=cast(str, side.algorithm)
    )


def readings_of(study: ReplayedCase, block: InstancesBlock) -> tuple[str, ...]:
    """Selected readings of a design; none if an algorithm is not implemented."""
    sides = [_procedure(study, side) for side in _sides(study, block)]
    if any(study.algorithm(side.algorithm) is None for side in sides):
        return ()
    wanted = block.readings or tuple(reading.id for reading in study.case.readings)
    return tuple(r for r in wanted if all((side.problem, r) in study.selected for side in sides))


def printed_reduction(study: ReplayedCase, block: InstancesBlock) -> tuple[float, float] | None:
    """Smallest and largest reduction that the printed digits allow, as shares of the slower total.

    Parameters
    ----------
    study : ReplayedCase
    block : InstancesBlock

    Returns
    -------
    tuple of float or None
        From the printed percentage, else from the two totals; None if neither is printed.
    """
    claim = _claimed(study, block)
    if claim.percent is not None:
        return float(claim.percent.lower) / 100, float(claim.percent.upper) / 100
    rid = readings_of(study, block)[0]
    slow, fast = (study.claim_total(side, rid) for side in _sides(study, block))
    if slow is None or fast is None:
        return None
    (slow_low, slow_high), (fast_low, fast_high) = slow[1], fast[1]
    return 1 - fast_high / slow_low, 1 - fast_low / slow_high


def _printed_totals(
    study: ReplayedCase, block: InstancesBlock, rid: str
) -> tuple[str | None, str | None]:
    slow, fast = (study.claim_total(side, rid) for side in _sides(study, block))
    return slow and slow[0], fast and fast[0]


def examined(
    study: ReplayedCase, block: InstancesBlock, progress: Callable[[str], None] | None = None
) -> InstancesResult:
    """Draw instances, make their problems under their readings, and examine them.

    Parameters
    ----------
    study : ReplayedCase
    block : InstancesBlock
        For which `readings_of` names some reading.
    progress : callable, optional
        Called with a few words after each instance.

    Returns
    -------
    InstancesResult

    Raises
    ------
    CaseError
        If no instance can be drawn at a step.
    """
    case = study.case
    slower, faster = (_procedure(study, side) for side in _sides(study, block))
    first, last = (
        cast(Algorithm[Any], study.algorithm(side.algorithm)) for side in (slower, faster)
    )
    readings = readings_of(study, block)
    chain = case.chain()
    assert chain is not None
    count = case.statement(faster.problem, readings[0]).waypoints.number
    try:
        drawn = instance_waypoints(block, chain, case.robot.joints, count)
    except TrajgapError as error:
        raise CaseError(case.file, f"families.{block.id}", str(error)) from None
    tasks = [
        Task(
            step=step,
            index=index,
            waypoints=points,
            readings=readings,
            slower=tuple(case.statement(slower.problem, r).problem_at(points) for r in readings),
            faster=tuple(case.statement(faster.problem, r).problem_at(points) for r in readings),
            algorithms=(first, last),
            runs=block.runs,
            objectives=block.objectives,
        )
        for step, instances in zip(block.lengths, drawn, strict=True)
        for index, points in enumerate(instances)
    ]
    return InstancesResult(
        block=block,
        slower=slower,
        faster=faster,
        printed=printed_reduction(study, block),
        readings=readings,
        iterations=last.iterations,
        samples=examine(tasks, study.workers or os.cpu_count() or 1, progress),
        printed_totals=_printed_totals(study, block, readings[0]),
        labels=study.case.labels,
    )
