"""The part of a report page on other instances: design, picture, distributions, samples."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...problem import Case
from ..audits import CaseAudit, Study, place
from ..audits.instances import STARTS, InstancesResult, examinable, examined, percent_range
from ..audits.rules import HANDLED, attributed, placed
from ..blocks import Block, Folded, Grid, Prose, Section, Terms, table
from ..documents import Effect, ExaminedInstances, Procedure, Why
from ..pictures import drawn, instances_picture


def other_instances(one: CaseAudit) -> tuple[Section, ...]:
    """One section if the case says which instances to draw, none otherwise."""
    blocks: list[Block] = []
    for declared, entry in zip(examinable(one.study), one.document.families, strict=True):
        blocks += _examined(one.study, examined(one.study, declared), entry)
    if not blocks:
        return ()
    title = "The comparison on other instances"
    return (Section("families", title, tuple(blocks), folded=True),)


def _examined(study: Study, result: InstancesResult, entry: ExaminedInstances) -> list[Block]:
    block = result.block
    stands = place(study.case.claim(block.claim))
    title = f"Reduction of the total, {stands}, on {result.instances} instances"
    picture = instances_picture(result, title=title)
    caption = (
        "Every pair of one run of each, and every pair of optima; strokes are medians. Instances "
        "are drawn from the robot's workspace and are not the paper's."
    )
    by_step = tuple(
        table(_COLUMNS, _rows(entry, result, step), f"Steps of {step:g} {block.unit}")
        for step in block.lengths
    )
    return [
        *(Prose(said) for said in (placed(result), " ".join(attributed(result))) if said),
        Prose(
            "The instances are not the paper's: they are information and decide nothing, and the "
            "absolute times remain not checkable.",
            "note",
        ),
        Terms(_design(study, result)),
        drawn(picture, "family", block.id, caption=caption),
        table(_COLUMNS, _rows(entry, result, None), "Reductions of the total, in %"),
        Folded("Reductions by step length", by_step),
        Folded(f"Totals of every instance, {stands}", (_instances(entry, result.labels),)),
    ]


def _design(study: Study, result: InstancesResult) -> tuple[tuple[str, str], ...]:
    block, slow, fast = result.block, result.slower, result.faster
    points = result.samples[0].waypoints
    steps = ", ".join(f"{step:g}" for step in block.lengths)
    kind = "largest change of any joint" if block.kind == "joint" else "path of the end"
    objectives = "; ".join(f"{name}: {HANDLED[name]}" for name in block.objectives)
    pairs = [
        ("compared", f"the faster one, {_procedure(study.case, fast)}, against the slower one, "
         f"{_procedure(study.case, slow)}, both with the settings and the choices of the case "
         "file"),
        ("printed", "no reduction" if result.printed is None else
         f"{percent_range(*result.printed)} less"),
        ("instances", f"{block.instances} for each step of {steps} {block.unit} ({kind}), "
         f"{len(points)} way-points each, from {block.samples} positions of the workspace of "
         f"{study.case.robot.name}, seed {block.seed}"),
        ("why these", block.why),
        ("runs", f"{block.runs} of each algorithm on each instance, seeds 0 to {block.runs - 1}"),
        ("optima", f"best known, {STARTS} starts of each solve; "
         f"{len(result.unsolved) or 'none'} of {2 * len(result.samples)} unknown"
         + "".join(f"; {line}" for line in result.unsolved)),
        ("objectives", objectives),
    ]  # fmt: skip
    return tuple(pairs)


def _procedure(case: Case, one: Procedure) -> str:
    """An algorithm on a problem, by their names."""
    names = {block.id: block.name for block in case.algorithms}
    called = next((p.title for p in case.problems if p.id == one.problem), "") or one.problem
    return f"{names[one.algorithm]} (“{called}”)"


_COLUMNS = ("reading", "due to", ">pairs", ">least", ">quarter", ">median", ">three quarters",
            ">most", ">shorter", ">as printed or more")  # fmt: skip
"""Columns of the reductions."""


def _rows(
    entry: ExaminedInstances, result: InstancesResult, step: float | None
) -> list[tuple[object, ...]]:
    rows: list[tuple[object, ...]] = []
    for one in (found for found in entry.reductions if found.step == step):
        reached = None
        if result.printed is not None and one.effect is Effect.BOTH and one.objective is not None:
            at = result.block.objectives.index(one.objective)
            values = result.reductions(one.reading, one.effect, at, one.step)
            good = values[np.isfinite(values)]
            if good.size:
                reached = f"{100 * float((good >= result.printed[0]).mean()):.3g} %"
        quantiles = (one.lowest, one.lower_quarter, one.median, one.upper_quarter, one.highest)
        rows.append(
            (
                result.label(one.reading),
                one.effect + (f", {one.objective}" if one.objective else ""),
                f"{one.pairs}" + (f"\n{one.missing} without answer" if one.missing else ""),
                *(None if isinstance(x, Why) else f"{100 * x:.1f}" for x in quantiles),
                None if isinstance(one.shorter, Why) else f"{100 * one.shorter:.3g} %",
                reached,
            )
        )
    return rows


def _instances(entry: ExaminedInstances, labels: Mapping[str, str]) -> Grid:
    routes = ("slower", "slower algorithm on the faster curve", "faster")
    rows = []
    for one in entry.instances:
        for own in one.readings:
            cells = [labels.get(own.reading, own.reading), f"{one.step:g}", one.instance + 1]
            for optimum in (own.slower_optimum, own.faster_optimum):
                total = optimum.total_time
                cells.append(optimum.status if isinstance(total, Why) else f"{total:.4f}")
            for runs in own.totals:
                for totals in (runs.slower, runs.slower_algorithm_on_faster_curve, runs.faster):
                    said = ("none" if t is None else f"{t:.3f}" for t in totals)
                    cells.append("\n".join(said))
            rows.append(tuple(cells))
    names = (
        "reading",
        f">step, {entry.unit}",
        ">instance",
        ">optimum of the slower curve",
        ">optimum of the faster curve",
        *(f">{route}, {objective}" for objective in entry.objectives for route in routes),
    )
    return table(names, tuple(rows), "Totals in s, one line for each run")
