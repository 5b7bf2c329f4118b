"""From a declared design to its instances, and their problems for both compared procedures."""

from __future__ import annotations

import os
from typing import Any, cast

from ....heuristics import Algorithm
from ....problem import CaseError, ProcessError, TrajgapError
from ....problem.cases import Claim, ImprovementClaim, InstancesBlock, instance_waypoints
from ...documents import Procedure
from ..chosen_case import ChosenCase
from .result import InstancesResult
from .study import Task, examine


def _claimed(study: ChosenCase, block: InstancesBlock) -> ImprovementClaim:
    return cast(ImprovementClaim, study.case.claim(block.claim))


def _sides(study: ChosenCase, block: InstancesBlock) -> tuple[Claim, Claim]:
    claim = _claimed(study, block)
    return study.case.claim(claim.slower), study.case.claim(claim.faster)


def _procedure(study: ChosenCase, side: Claim) -> Procedure:
    # A case file names both; the problem may be its only one.
    return Procedure(
        problem=side.problem or study.case.problems[0].id, algorithm=cast(str, side.algorithm)
    )


def readings_of(study: ChosenCase, block: InstancesBlock) -> tuple[str, ...]:
    """Selected readings of a design; none if an algorithm is not implemented."""
    sides = [_procedure(study, side) for side in _sides(study, block)]
    if any(study.algorithm(side.algorithm) is None for side in sides):
        return ()
    wanted = block.readings or tuple(reading.id for reading in study.case.readings)
    return tuple(r for r in wanted if all((side.problem, r) in study.selected for side in sides))


def printed_reduction(study: ChosenCase, block: InstancesBlock) -> tuple[float, float] | None:
    """Smallest and largest reduction that the printed digits allow, as shares of the slower total.

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
    (slow_low, slow_high), (fast_low, fast_high) = slow.interval, fast.interval
    return 1 - fast_high / slow_low, 1 - fast_low / slow_high


def _printed_totals(
    study: ChosenCase, block: InstancesBlock, rid: str
) -> tuple[str | None, str | None]:
    slow, fast = (study.claim_total(side, rid) for side in _sides(study, block))
    return slow and slow[0], fast and fast[0]


def examinable(study: ChosenCase) -> tuple[InstancesBlock, ...]:
    """Designs of instances of which both problems and some reading are selected.

    All of it is implemented, and can be replayed.
    """
    declared = (block for block in study.case.instances if readings_of(study, block))
    return tuple(block for block in declared if unexamined(study, block) is None)


def unexamined(study: ChosenCase, block: InstancesBlock) -> str | None:
    """Why the two procedures of a design cannot be run on its instances; None if they can."""
    try:
        examined(study, block)
    except (CaseError, ProcessError):
        raise
    except TrajgapError as error:
        return str(error)
    return None


def examined(study: ChosenCase, block: InstancesBlock) -> InstancesResult:
    """What the two procedures of an improvement do on instances that are drawn for it, once.

    Parameters
    ----------
    block : InstancesBlock
        For which `readings_of` names some reading.

    Raises
    ------
    CaseError
        If no instance can be drawn at a step.
    """
    own = study.drawing
    return own.once(("instances", block.id), lambda: _examined(own, block))


def _examined(study: ChosenCase, block: InstancesBlock) -> InstancesResult:
    """Draw instances, make their problems under their readings, and examine them."""
    what = f"instances {block.id}"
    study.progress(what)
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
        samples=examine(
            tasks,
            study.workers or os.cpu_count() or 1,
            lambda done: study.progress(f"{what}, {done}"),
        ),
        printed_totals=_printed_totals(study, block, readings[0]),
        labels=study.case.labels,
    )
