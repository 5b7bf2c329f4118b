"""TG404: relative claims on instances drawn for them, where the paper's own are not printed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....problem.cases import ConvergenceClaim
from ...documents import Basis, Effect, Finding, Procedure, quoted, ranged
from ...gaps import SETTLED
from ..instances import (
    MIDDLE,
    InstancesResult,
    distribution,
    examinable,
    examined,
    percent_range,
    readings_of,
    reproduced,
    unexamined,
)
from ..study import Study
from ..words import percent, seconds
from .rule_group import INFORMS, Explained, rule_group

HANDLED = {
    "death-penalty": "durations that break a limit get the penalty",
    "stretch": "durations that break a limit are stretched until they keep it",
    "rescale": "all durations are rescaled until a limit is just reached",
}
"""What each objective does, in words."""


TG404 = Explained(
    "TG404",
    "A relative claim, tried on instances drawn from the robot's workspace",
    "If no way-points are printed, how large is the improvement on instances that are drawn "
    "from the workspace of the robot?",
    INFORMS + " The instances are not the paper's.",
    "On 50 instances one run of B is 8 to 14 % shorter than one of A; 10.5 % is printed.",
    basis=Basis.REPLAY,
    decides=False,
)


@rule_group(TG404, without_waypoints=True)
def judge_instances(study: Study) -> Iterator[Finding]:
    """Findings of TG404. None of them decides: the instances are not the paper's."""
    for block in study.case.instances:
        why = unexamined(study, block) if readings_of(study, block) else None
        if why is not None:
            yield TG404.finding(None, "not examined", f"Family {block.id} is not examined: {why}.")
    for block in examinable(study):
        result = examined(study, block)
        yield _summary(result)
        for reading in result.readings:
            yield _under(result, reading)
        for claim in study.case.claims:
            own = Procedure(problem=claim.problem or "", algorithm=claim.algorithm or "")
            if isinstance(claim, ConvergenceClaim) and own == result.faster:
                yield _convergence(result, claim)


def placed(result: InstancesResult) -> str:
    """Where the printed reduction lies among those of the runs, over all readings."""
    drawn = f"{result.instances} instances drawn from the robot's workspace"
    if result.printed is None:
        return f"No reduction is printed that could be compared with {drawn}."
    inside = [r for r in result.readings if reproduced(result, r)]
    sides: dict[str, list[str]] = {}
    for reading in result.readings:
        if reading not in inside:
            sides.setdefault(_aside(result, reading), []).append(reading)
    said = f"On {drawn}, the printed reduction of {percent_range(*result.printed)} is "
    middle = f"the middle {percent(MIDDLE, 'g')} of the reductions of one run against one run"
    parts = []
    if inside:
        parts.append(f"usual under {_quoted(result, inside)}(within {middle})")
    for side, own in sides.items():
        what = "" if parts else f", outside {middle}"
        parts.append(f"unusual under {_quoted(result, own)} ({side}){what}")
    return f"{said}{'; it is '.join(parts)}."


def _quoted(result: InstancesResult, readings: list[str]) -> str:
    return ", ".join(quoted(one, result.labels) for one in readings)


def attributed(result: InstancesResult) -> Iterator[str]:
    """What the reduction is due to: medians over the readings; nothing if there are none."""
    both, curve = medians(result, Effect.BOTH), medians(result, Effect.CURVE)
    if both is None or curve is None:
        return
    yield (
        f"Median reduction, from the smallest to the largest over the readings: curve and "
        f"algorithm together {percent_range(*both, digits=1)}; the curve alone, at the best known "
        f"optima, {percent_range(*curve, digits=1)}."
    )
    for at, objective in enumerate(result.block.objectives):
        span = medians(result, Effect.ALGORITHM, at)
        if span is not None:
            yield (
                f"The algorithm alone, if {HANDLED[objective]}: {percent_range(*span, digits=1)}."
            )


def _aside(result: InstancesResult, reading: str) -> str:
    """On which side of the printed reduction those of a reading lie."""
    found = distribution(result.reductions(reading, Effect.BOTH))
    if found.missing == found.pairs or result.printed is None:
        return "no pair of answers"
    return "most are larger there" if found.median > result.printed[1] else "most are smaller there"


def medians(result: InstancesResult, effect: Effect, at: int = 0) -> tuple[float, float] | None:
    """Smallest and largest median over the readings; None if no pair has two answers."""
    found = [distribution(result.reductions(r, effect, at)).median for r in result.readings]
    known = [m for m in found if np.isfinite(m)]
    return (min(known), max(known)) if known else None


def _summary(result: InstancesResult) -> Finding:
    block = result.block
    span = medians(result, Effect.BOTH)
    computed = f"medians {percent_range(*span, digits=1)}" if span else "no pair of answers"
    return TG404.finding(
        None,
        "over the readings",
        placed(result),
        *attributed(result),
        block.why,
        "These are not the paper's instances, so they decide nothing about its totals.",
        claim=block.claim,
        printed=_printed(result),
        computed=computed,
    )


def _printed(result: InstancesResult) -> str | None:
    return None if result.printed is None else percent_range(*result.printed)


def _under(result: InstancesResult, reading: str) -> Finding:
    block = result.block
    both = distribution(result.reductions(reading, Effect.BOTH))
    parts = []
    if result.printed is not None and both.missing < both.pairs:
        values = result.reductions(reading, Effect.BOTH)
        least = float((values[np.isfinite(values)] >= result.printed[0]).mean())
        usual, inside = (
            ("usual", "within") if reproduced(result, reading) else ("unusual", "outside")
        )
        parts.append(
            f"The printed reduction of {_printed(result)} is {usual} here: it lies {inside} the "
            f"middle {percent(MIDDLE, 'g')} of the reductions, and {percent(least)} of them are at "
            "least as large."
        )
    steps = ", ".join(f"{step:g}" for step in block.lengths)
    parts += [
        f"Reductions of one run against one run on {result.instances} instances, at steps of "
        f"{steps} {block.unit}, with {block.runs} runs each: {both}.",
        f"The paper's procedure is faster in {percent(both.shorter)} of the pairs.",
    ]
    low, high = result.median_interval(reading, Effect.BOTH)
    if np.isfinite(low):
        parts.append(
            f"The median over the instances lies in {percent_range(low, high, digits=1)} "
            "(95 % interval, instances resampled)."
        )
    parts += _totals(result, reading)
    curve = distribution(result.reductions(reading, Effect.CURVE))
    alone = distribution(result.reductions(reading, Effect.ALGORITHM))
    parts += [
        f"Saving by the curve alone, at the best known optima: {curve}.",
        f"Saving by the algorithm alone, on the paper's curve: {alone}.",
    ]
    for at, objective in enumerate(block.objectives[1:], start=1):
        pair = [
            distribution(result.reductions(reading, effect, at))
            for effect in (Effect.BOTH, Effect.ALGORITHM)
        ]
        parts.append(
            f"If {HANDLED[objective]}, curve and algorithm together save {pair[0]}, and the "
            f"algorithm alone saves {pair[1]}."
        )
    failed = result.failed(reading)
    if failed:
        parts.append(f"{failed} runs found no motion within the limits.")
    facts = {"reading": reading, "printed": _printed(result), "computed": str(both)}
    return TG404.finding(None, "under a reading", *parts, claim=block.claim, **facts)


def _totals(result: InstancesResult, reading: str) -> Iterator[str]:
    """Where printed totals lie among those of the runs: how usual they are under a reading."""
    for route, printed in zip((0, 2), result.printed_totals, strict=True):
        totals = result.totals(reading, route)
        if printed is None or not totals.size:
            continue
        low, middle, high = np.quantile(totals, [0.0, 0.5, 1.0])
        which = "it is compared with" if route == 0 else "of the paper"
        yield (
            f"The paper prints {printed}; the procedure {which} takes {seconds(middle, '.3g')} at "
            f"the median ({ranged(low, high, '.3g')} s)."
        )


def _convergence(result: InstancesResult, claim: ConvergenceClaim) -> Finding:
    shares = []
    for reading in result.readings:
        settled = result.settled(reading)
        shares.append(float((settled <= claim.iterations.value).mean()) if settled.size else 0.0)
    low, high = 100 * min(shares), 100 * max(shares)
    each = ", ".join(
        f"{percent(share)} under {quoted(reading, result.labels)}"
        for share, reading in zip(shares, result.readings, strict=True)
    )
    return TG404.finding(
        claim,
        "convergence",
        f"By iteration {claim.iterations} of {result.iterations} the search has converged in "
        f"{ranged(low, high, '.3g')} % of the runs on {result.instances} drawn instances: its "
        f"best total is then within {percent(SETTLED, 'g')} of the final one ({each}).",
        "The instances are not the paper's.",
        printed=f"{claim.iterations} iterations",
        computed=f"{ranged(low, high, '.3g')} % of the runs",
    )
