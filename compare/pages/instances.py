"""The part of a report page on families of instances: design, picture, distributions, samples."""

from __future__ import annotations

import numpy as np

from ...problem import file_name
from ..audits import CaseAudit, Study
from ..audits.instances import STARTS, Effect, FamilyResult, distribution, percent_range
from ..audits.rules import HANDLED, attributed, placed
from ..pictures import family_picture, svg
from .blocks import (
    Block,
    Cell,
    Drawn,
    Folded,
    Grid,
    Prose,
    Section,
    Terms,
    number,
    text,
)


def families(one: CaseAudit) -> tuple[Section, ...]:
    """One section if the case declares families of instances, none otherwise."""
    blocks: list[Block] = []
    for declared in one.study.families:
        blocks += _family(one.study, one.study.family(declared))
    if not blocks:
        return ()
    return (Section("families", "The comparison on other instances", tuple(blocks)),)


def _family(study: Study, result: FamilyResult) -> list[Block]:
    block = result.block
    title = f"Reduction of the total, {block.claim}, on {result.instances} instances"
    picture = family_picture(result, title=title)
    caption = (
        "Every pair of one run of each, and every pair of optima; strokes are medians. Instances "
        "are drawn from the robot's workspace and are not the paper's."
    )
    return [
        *(Prose(said) for said in (placed(result), attributed(result)) if said),
        Prose(
            "The instances are not the paper's: what they show can be called not reproduced, never "
            "more, and the absolute times stay not checkable. Way-points written into the case "
            "file in place of not_printed and count bring the whole audit.",
            "note",
        ),
        Terms(_design(study, result)),
        Drawn(file_name("family", block.id), svg(picture), title, caption),
        Grid(_COLUMNS, _rows(result, None), "Reductions of the total, in %"),
        Folded(
            "Reductions by step length",
            tuple(
                Grid(_COLUMNS, _rows(result, step), f"Steps of {step:g} {block.unit}")
                for step in block.lengths
            ),
        ),
        Folded(f"Totals of every instance, {block.id}", (_instances(result),)),
    ]


def _design(study: Study, result: FamilyResult) -> tuple[tuple[str, str], ...]:
    block, slow, fast = result.block, result.slower, result.faster
    points = result.samples[0].waypoints
    steps = ", ".join(f"{step:g}" for step in block.lengths)
    kind = "largest change of any joint" if block.kind == "joint" else "way of the end"
    objectives = "; ".join(f"{name}: {HANDLED[name]}" for name in block.objectives)
    pairs = [
        ("compared", f"{fast.algorithm} on {fast.problem} against {slow.algorithm} on "
         f"{slow.problem}, both with the settings and the choices of the case file"),
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


_COLUMNS = (
    "reading",
    "due to",
    "pairs",
    "least",
    "quarter",
    "median",
    "three quarters",
    "most",
    "shorter",
    "as printed or more",
)


def _rows(result: FamilyResult, step: float | None) -> tuple[tuple[Cell, ...], ...]:
    objectives = result.block.objectives
    return tuple(
        _row(result, reading, effect, at, step)
        for reading in result.readings
        for effect in Effect
        for at in range(1 if effect is Effect.CURVE else len(objectives))
    )


def _row(
    result: FamilyResult, reading: str, effect: Effect, at: int, step: float | None
) -> tuple[Cell, ...]:
    values = result.reductions(reading, effect, at, step)
    found, good = distribution(values), values[np.isfinite(values)]
    reached = None
    if result.printed is not None and good.size and effect is Effect.BOTH:
        reached = f"{100 * float((good >= result.printed[0]).mean()):.3g} %"
    quantiles = (
        found.lowest,
        found.lower_quarter,
        found.median,
        found.upper_quarter,
        found.highest,
    )
    return (
        text(reading),
        text(effect + ("" if effect is Effect.CURVE else f", {result.block.objectives[at]}")),
        number(f"{found.pairs}" + (f"\n{found.missing} without answer" if found.missing else "")),
        *(number(f"{100 * x:.1f}" if good.size else None) for x in quantiles),
        number(f"{100 * found.shorter:.3g} %" if good.size else None),
        number(reached),
    )


def _instances(result: FamilyResult) -> Grid:
    slow, fast, objectives = result.slower, result.faster, result.block.objectives
    routes = (
        f"{slow.algorithm} on {slow.problem}",
        f"{slow.algorithm} on {fast.problem}",
        f"{fast.algorithm} on {fast.problem}",
    )
    rows = []
    for s in result.samples:
        cells = [text(s.reading), number(f"{s.step:g}"), number(s.index + 1)]
        for optimum in (s.slower, s.faster):
            known = np.isfinite(optimum.total)
            cells.append(number(f"{optimum.total:.4f}") if known else text(optimum.status))
        for at in range(len(objectives)):
            for route in range(len(routes)):
                totals = (f"{t:.3f}" if np.isfinite(t) else "none" for t in s.totals[at, route])
                cells.append(number("\n".join(totals)))
        rows.append(tuple(cells))
    names = (
        "reading",
        f"step, {result.block.unit}",
        "instance",
        f"optimum of {slow.problem}",
        f"optimum of {fast.problem}",
        *(f"{route}, {objective}" for objective in objectives for route in routes),
    )
    return Grid(names, tuple(rows), "Totals in s, one line for each run")
