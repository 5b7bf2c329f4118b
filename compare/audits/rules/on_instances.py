"""TG404: relative claims on instances drawn for them, where the paper's own are not printed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....problem.cases import ConvergenceClaim
from ...documents import Basis, Effect, Finding, Procedure
from ...gaps import SETTLED
from ..instances import (
    MIDDLE,
    InstancesResult,
    distribution,
    percent_range,
    readings_of,
    reproduced,
)
from ..study import Study

HANDLED = {
    "death-penalty": "durations that break a limit get the penalty",
    "stretch": "durations that break a limit are stretched until they keep it",
    "rescale": "all durations are rescaled until a limit is just reached",
}
"""What each objective does, in words."""


def judge_instances(study: Study) -> Iterator[Finding]:
    """Findings of TG404. None of them decides: the instances are not the paper's."""
    for block in study.case.instances:
        why = study.unexamined(block) if readings_of(study, block) else None
        if why is not None:
            message = f"Family {block.id} is not examined: {why}."
            yield Finding(rule="TG404", basis=Basis.REPLAY, decides=False, message=message)
    for block in study.instance_blocks:
        result = study.instances(block)
        yield _summary(result)
        for reading in result.readings:
            yield _under(result, reading)
        for claim in study.case.claims:
            own = Procedure(problem=claim.problem or "", algorithm=claim.algorithm or "")
            if isinstance(claim, ConvergenceClaim) and own == result.faster:
                yield _convergence(result, claim)


def placed(result: InstancesResult) -> str:
    """Where the printed reduction lies among those of the runs, over all readings."""
    many = len(result.readings)
    drawn = f"{result.instances} instances drawn from the robot's workspace"
    if result.printed is None:
        return f"No reduction is printed to set beside {drawn}."
    missed = [r for r in result.readings if not reproduced(result, r)]
    aside = ", ".join(f"{r}: {_aside(result, r)}" for r in missed)
    out = f"; not reproduced in {len(missed)} ({aside})" if missed else ""
    return (
        f"On {drawn} the printed reduction of {percent_range(*result.printed)} lies within the "
        f"middle {100 * MIDDLE:g} % of those of one run against one run in "
        f"{many - len(missed)} of {many} readings{out}."
    )


def attributed(result: InstancesResult) -> str:
    """What the reduction is due to: medians over the readings; empty if there are none."""
    both, curve = medians(result, Effect.BOTH), medians(result, Effect.CURVE)
    if both is None or curve is None:
        return ""
    alone = ", ".join(
        f"{percent_range(*span, digits=1)} with {objective}"
        for at, objective in enumerate(result.block.objectives)
        if (span := medians(result, Effect.ALGORITHM, at)) is not None
    )
    return (
        f"Medians by reading: both together {percent_range(*both, digits=1)}; the curve alone, at "
        f"the best known optima, {percent_range(*curve, digits=1)}; the algorithm alone {alone}."
    )


def _aside(result: InstancesResult, reading: str) -> str:
    """On which side of the printed reduction those of a reading lie."""
    found = distribution(result.reductions(reading, Effect.BOTH))
    if found.missing == found.pairs or result.printed is None:
        return "no pair of answers"
    return "larger there" if found.median > result.printed[1] else "smaller there"


def medians(result: InstancesResult, effect: Effect, at: int = 0) -> tuple[float, float] | None:
    """Smallest and largest median over the readings; None if no pair has two answers."""
    found = [distribution(result.reductions(r, effect, at)).median for r in result.readings]
    known = [m for m in found if np.isfinite(m)]
    return (min(known), max(known)) if known else None


def _summary(result: InstancesResult) -> Finding:
    block = result.block
    span = medians(result, Effect.BOTH)
    said = (
        placed(result),
        attributed(result),
        block.why,
        "They are not the paper's instances and decide nothing about its totals.",
    )
    message = " ".join(sentence for sentence in said if sentence)
    printed = None if result.printed is None else percent_range(*result.printed)
    computed = f"medians {percent_range(*span, digits=1)}" if span else "no pair of answers"
    return Finding(
        rule="TG404",
        basis=Basis.REPLAY,
        decides=False,
        claim=block.claim,
        printed=printed,
        computed=computed,
        message=message,
    )


def _under(result: InstancesResult, reading: str) -> Finding:
    fast, slow, block = result.faster, result.slower, result.block
    both = distribution(result.reductions(reading, Effect.BOTH))
    steps = ", ".join(f"{step:g}" for step in block.lengths)
    parts = [
        f"{fast.algorithm} on {fast.problem} against {slow.algorithm} on {slow.problem}, "
        f"{result.instances} instances at steps of {steps} {block.unit}, {block.runs} runs each, "
        f"one run against one run: the total falls by {both}; "
        f"it falls at all in {100 * both.shorter:.3g} % of the pairs."
    ]
    if result.printed is not None and both.missing < both.pairs:
        values = result.reductions(reading, Effect.BOTH)
        least = float((values[np.isfinite(values)] >= result.printed[0]).mean())
        inside = "within" if reproduced(result, reading) else "outside"
        parts.append(
            f"The printed {percent_range(*result.printed)} lies {inside} the middle "
            f"{100 * MIDDLE:g} % of them; {100 * least:.3g} % show at least as much."
        )
    curve = distribution(result.reductions(reading, Effect.CURVE))
    alone = distribution(result.reductions(reading, Effect.ALGORITHM))
    parts.append(
        f"At the best known optima the curve alone is worth {curve}; the algorithm alone, on "
        f"{fast.problem}, {alone}."
    )
    for at, objective in enumerate(block.objectives[1:], start=1):
        pair = [
            distribution(result.reductions(reading, effect, at))
            for effect in (Effect.BOTH, Effect.ALGORITHM)
        ]
        parts.append(f"Where {HANDLED[objective]}: both {pair[0]}; the algorithm alone {pair[1]}.")
    failed = result.failed(reading)
    if failed:
        parts.append(f"{failed} runs found nothing that keeps its limits.")
    printed = None if result.printed is None else percent_range(*result.printed)
    return Finding(
        rule="TG404",
        basis=Basis.REPLAY,
        decides=False,
        claim=block.claim,
        reading=reading,
        printed=printed,
        computed=str(both),
        message=" ".join(parts),
    )


def _convergence(result: InstancesResult, claim: ConvergenceClaim) -> Finding:
    shares = []
    for reading in result.readings:
        settled = result.settled(reading)
        shares.append(float((settled <= claim.iterations.value).mean()) if settled.size else 0.0)
    missed = sum(share < 0.5 for share in shares)
    low, high = 100 * min(shares), 100 * max(shares)
    message = (
        f"On {result.instances} instances drawn from the robot's workspace the best-so-far of "
        f"{claim.algorithm} on {claim.problem} is within {100 * SETTLED:g} % of its final value by "
        f"iteration {claim.iterations} of {result.iterations} in {low:.3g} to {high:.3g} % of the "
        f"runs, depending on the reading. "
    )
    message += (
        f"Most runs of every one of {len(shares)} readings are."
        if missed == 0
        else f"Not reproduced by most runs in {missed} of {len(shares)} readings. The instances "
        "are not the paper's."
    )
    return Finding(
        rule="TG404",
        basis=Basis.REPLAY,
        decides=False,
        claim=claim.id,
        printed=f"{claim.iterations} iterations",
        computed=f"{low:.3g} to {high:.3g} % of the runs",
        message=message,
    )
