"""The pictures of a report page: motions, searches and landscapes, under the default reading."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress

import numpy as np

from ...heuristics import JointRuns
from ...nlp import Solution, weakest
from ...problem import Array, Problem, TrajgapError
from ...problem.cases import DurationsClaim, MaximumClaim, TotalTimeClaim
from ..audits import CaseAudit, Pair, PrintedRow, Study, at_ratios, place, planned_apart
from ..blocks import Block, Drawn, Folded, Prose, Section, table
from ..documents import OWN_OPTIMA
from ..pictures import Runs, convergence, endings, landscape, motion_picture, pictured
from .numbers import REPLAY_COLUMNS, noted, paper_units, problem_name, replay_rows

_Row = PrintedRow[DurationsClaim | MaximumClaim]
"""A row that prints durations."""


def motions(one: CaseAudit) -> Section:
    """Angle, velocity and acceleration of every printed set of durations, and of the optimum."""
    blocks: list[Block] = []
    for pair in one.study.main_pairs:
        blocks += _printed_motions(one.study, pair)
        solution = one.study.optimum(pair)
        if solution.found and solution.boundless is None:
            known = f"{solution.evidence.capitalize()} optimum{at_ratios(solution.problem)}"
            if len(one.case.problems) > 1:
                known += f", {problem_name(one, pair.problem)}"
            picture = motion_picture(
                solution.problem,
                solution.durations,
                title=f"{known}: {solution.total_time:.6f} s",
                check=solution.check,
                nodal=solution.nodal,
                units=paper_units(one.study.case.statement(*pair)),
            )
            caption = noted(one.study, pair.reading).strip()
            blocks.append(pictured(picture, "optimum", pair.problem, caption=caption))
    return Section("motions", "Motions, with limits and peaks", tuple(blocks), folded=True)


def whole_rows(study: Study, pair: Pair) -> list[_Row]:
    """Claims that print durations for all joints of a problem."""
    joints = study.problem(pair).joints
    return [
        PrintedRow(study, c, pair)
        for c in study.case.claims
        if isinstance(c, DurationsClaim | MaximumClaim)
        and study.fits(c, pair)
        and (c.joint is None or len(joints) == 1)
    ]


def alike(rows: Iterable[_Row]) -> list[list[_Row]]:
    """Rows that print the same digits together."""
    found: dict[tuple[str, ...], list[_Row]] = {}
    for row in rows:
        found.setdefault(tuple(map(str, row.claim.durations)), []).append(row)
    return list(found.values())


def _printed_motions(study: Study, pair: Pair) -> Iterator[Block]:
    under = noted(study, pair.reading)
    for rows in alike(whole_rows(study, pair)):
        row = rows[0]
        title = f"Printed durations: {'; '.join(dict.fromkeys(place(r.claim) for r in rows))}"
        if row.unmoved is not None or not row.has_curve:
            why = "define no curve" if row.unmoved is None else f"are not drawn: {row.unmoved}"
            yield Prose(f"{title} {why}.{under}", "note")
            continue
        picture = motion_picture(
            study.problem(pair),
            row.durations.value,
            title=title,
            check=row.check,
            note=f"however the digits were rounded: {row.rounding.verdict}",
            units=paper_units(row.statement),
        )
        caption = f"{'; '.join(r.claim.where for r in rows)}.{under}"
        yield pictured(picture, "motion", row.problem, row.claim.id, caption=caption)
    for tables, singles in _tables_by_joint(study, pair):
        if singles[0].unmoved is None:
            yield _joint_by_joint(tables, singles)


def _tables_by_joint(study: Study, pair: Pair) -> list[tuple[str, list[_Row]]]:
    """Rows of tables that print every joint by itself, by the tables' places; alike together."""
    joints = study.problem(pair).joints
    if len(joints) == 1:
        return []
    found: dict[tuple[tuple[str, ...], ...], tuple[list[str], list[_Row]]] = {}
    for printed in study.case.tables:
        rows = {
            c.joint: PrintedRow(study, c, pair)
            for c in study.case.table_claims(printed.id)
            if isinstance(c, DurationsClaim) and study.fits(c, pair)
        }
        if all(label in rows for label in joints):
            own: list[_Row] = [rows[label] for label in joints]
            digits = tuple(tuple(map(str, row.claim.durations)) for row in own)
            found.setdefault(digits, ([], own))[0].append(printed.where)
    return [(", ".join(tables), own) for tables, own in found.values()]


def _joint_by_joint(tables: str, rows: list[_Row]) -> Drawn:
    study, pair = rows[0].study, rows[0].pair
    verdicts = [str(row.rounding.verdict) for row in rows]
    picture = motion_picture(
        study.problem(pair),
        np.array([row.durations.value for row in rows]),
        title=f"Printed durations of each joint separately: {tables}",
        note=f"however the digits were rounded: {', '.join(dict.fromkeys(verdicts))}",
        units=paper_units(study.case.statement(*pair)),
    )
    each = "; ".join(f"joint {r.claim.joint}: {v}" for r, v in zip(rows, verdicts, strict=True))
    caption = (
        "Each joint with its own durations, at the printed digits. However the digits were "
        f"rounded: {each}.{noted(study, pair.reading)}"
    )
    name = "motion", pair.problem, "joints", str(rows[0].claim.table)
    return pictured(picture, *name, caption=caption)


def searches(one: CaseAudit) -> Section:
    """Replays of the algorithms: convergence, where they end, and the spread over choices."""
    study = one.study
    blocks: list[Block] = []
    for pair in study.main_pairs:
        runs = _runs(study, pair)
        if not runs:
            continue
        name = problem_name(one, pair.problem)
        blocks += _convergence(study, pair, runs, name)
        references, printed = _totals(study, pair)
        ends = {each: np.array([r.reported_time for r in one]) for each, one in runs.items()}
        picture = endings(ends, references, printed, title=f"Totals of all runs: {name}")
        caption = "Vertical strokes are medians. A reported total is not clipped at the optimum."
        blocks.append(pictured(picture, "totals", pair.problem, caption=caption))
        grid = table(REPLAY_COLUMNS, replay_rows(study, pair))
        blocks.append(Folded(f"Spread over seeds and open choices: {name}", (grid,)))
    last = study.options.seeds - 1
    lead = Prose(
        f"Each algorithm was run with seeds 0 to {last} under the choices listed below, "
        f"and under settings spread over everything that the text leaves open."
        f"{noted(study, study.main_reading)} Replays are information and decide nothing.",
        "note",
    )
    shown = (lead, *blocks) if blocks else ()
    return Section("searches", "Replays of the algorithms", shown, folded=True)


def _runs(study: Study, pair: Pair) -> dict[str, Runs]:
    names = [a.name for a in study.case.algorithms]
    replays = {
        a.name if names.count(a.name) == 1 else f"{a.name} ({a.id})": study.runs(a.id, pair)
        for a in study.case.algorithms
    }
    return {name: one for name, one in replays.items() if one}


def _convergence(study: Study, pair: Pair, runs: dict[str, Runs], name: str) -> Iterator[Block]:
    by_joint = isinstance(next(iter(runs.values()))[0], JointRuns)
    problem = study.problem(pair)
    searched = problem.joints if by_joint else [None]
    solutions = [study.optimum(pair, label) for label in searched]
    if any(not s.found or not s.best > 0 for s in solutions):
        return  # there is nothing, or nothing positive, that a gap could be a share of
    printed: dict[str, list[float]] = {}
    widths = [0.0]
    groups = (
        dict(_tables_by_joint(study, pair))
        if by_joint
        else {place(row.claim): [row] for row in whole_rows(study, pair)}
    )
    for label, rows in groups.items():
        boxes = [total.interval for row in rows if (total := row.total) is not None]
        printed[label] = [(low + high) / 2 for low, high in boxes]
        widths += [(high - low) / 2 for low, high in boxes]
    picture = convergence(
        runs,
        [s.best for s in solutions],
        printed,
        rounding=max(widths),
        evidence=str(weakest(s.evidence for s in solutions)),
        joints=problem.joints,
        title=f"Best total so far: {name}" + (", each joint separately" if by_joint else ""),
    )
    caption = (
        "Gap to the optimum, linear up to 0.01 % and logarithmic beyond. The band around a printed "
        "total is its rounding."
    )
    yield pictured(picture, "convergence", pair.problem, caption=caption)


def _totals(study: Study, pair: Pair) -> tuple[dict[str, float], dict[str, float]]:
    shared = study.optimum(pair)
    references = {}
    if shared.found and shared.boundless is None:
        at = at_ratios(shared.problem)
        references[f"{shared.evidence} optimum, shared durations{at}"] = shared.best
    if planned_apart(study.problem(pair)) and study.per_joint(pair).found:
        references[OWN_OPTIMA] = study.per_joint(pair).total_time
    printed: dict[str, list[str]] = {}
    values: dict[str, float] = {}
    own = [row.claim for row in whole_rows(study, pair)]
    for claim in study.case.claims:
        whole = isinstance(claim, TotalTimeClaim) and claim.joint is None
        if claim in own or (whole and claim.problem in (None, pair.problem)):
            total = study.claim_total(claim, pair.reading)
            if total is not None:
                printed.setdefault(total.shown, []).append(place(claim))
                values[total.shown] = sum(total.interval) / 2
    return references, {
        ", ".join(dict.fromkeys(where)): values[shown] for shown, where in printed.items()
    }


def landscapes(one: CaseAudit) -> Section:
    """Total time over the shares of three durations, for all joints and for each by itself."""
    study = one.study
    blocks: list[Block] = []
    for pair in study.main_pairs:
        problem, name = study.problem(pair), problem_name(one, pair.problem)
        if problem.ratios is not None:
            continue  # its ratios are one point of the map
        if problem.segments != 3:
            said = f"{name}: {problem.segments} segments; a landscape needs three."
            blocks.append(Prose(said, "note"))
            continue
        runs = _runs(study, pair)
        printed = [(place(row.claim), row.durations.value) for row in whole_rows(study, pair)]
        ends = {each: np.array([r.durations for r in many]) for each, many in runs.items()}
        named = "landscape", pair.problem
        blocks += _landscape(named, problem, study.optimum(pair), printed, ends, name)
        single: list[Drawn] = []
        for tables, rows in _tables_by_joint(study, pair)[:1]:
            for j, row in enumerate(rows):
                label = problem.joints[j]
                own = {
                    each: np.array([r.runs[j].durations for r in many if isinstance(r, JointRuns)])
                    for each, many in runs.items()
                    if isinstance(many[0], JointRuns)
                }
                alone = problem.joint(j), study.optimum(pair, label)
                printed = [(tables, row.durations.value)]
                own_name = *named, "joint", str(j + 1)
                single += _landscape(own_name, *alone, printed, own, f"joint {label}")
        if single:
            blocks.append(Folded(f"Each joint separately: {name}", tuple(single)))
    shown = tuple(blocks) if any(not isinstance(b, Prose) for b in blocks) else ()
    return Section("landscapes", "Landscapes of the total time", shown, folded=True)


def _landscape(
    name: tuple[str, ...],
    problem: Problem,
    optimum: Solution,
    printed: list[tuple[str, Array]],
    ends: dict[str, Array],
    what: str,
) -> Iterator[Drawn]:
    same: dict[bytes, tuple[list[str], Array]] = {}
    for label, durations in printed:
        same.setdefault(durations.tobytes(), ([], durations))[0].append(label)
    points = [(", ".join(labels), durations) for labels, durations in same.values()]
    title = f"Total time over the shares of h₁ : h₂ : h₃, {what}"
    caption = "Exact totals: durations of any shares, stretched until the first limit is reached."
    with suppress(TrajgapError):
        picture = landscape(problem, optimum, points, ends, title=title)
        yield pictured(picture, *name, caption=caption)
