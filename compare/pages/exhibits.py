"""Further pictures of a page: workspace, control polygon, jumps, tent map, other instances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...heuristics.algorithms import ImprovedWOA, InitialRule, TentRule
from ...problem import Array, Case, TrajgapError, forward_kinematics, shown_bound, to_si
from ...problem.cases import ControlVerticesClaim, DurationsClaim, MaximumClaim
from ...problem.robots import Chain, DhTable, proximity, sample_workspace
from ..audits import CaseAudit, PrintedRow, Study, place
from ..audits.instances import STARTS, InstancesResult, examinable, examined, percent_range
from ..audits.rules import HANDLED, attributed, has_vertices, placed, vertices
from ..blocks import Block, Folded, Grid, Prose, Section, Terms, table
from ..documents import Effect, ExaminedInstances, Procedure, Why
from ..pictures import (
    instances_picture,
    jump_picture,
    pictured,
    polygon_picture,
    tent_picture,
    tent_scatter,
    velocity_jumps,
    workspace_picture,
)
from .motions_shown import alike, whole_rows
from .numbers import both_units, noted, only_under, paper_units


def exhibits_of_motion(study: Study) -> list[Section]:
    """Sections with workspace, control polygon and jumps; absent where there is none."""
    printed = (rows for pair in study.main_pairs for rows in alike(whole_rows(study, pair)))
    jumps = tuple(block for rows in printed for block in _jumps_of(study, rows))
    sections = (
        Section("jumps", "Jumps of the velocity", jumps, folded=True),
        Section("control-polygon", "Control polygon", tuple(_polygons(study)), folded=True),
        Section("workspace", "Workspace of the robot", tuple(_workspaces(study)), folded=True),
    )
    return [section for section in sections if section.blocks]


def exhibits_of_search(study: Study) -> list[Section]:
    """Section with the initial population of the tent map; none where no algorithm has one."""
    blocks = tuple(_tents(study))
    title = "The tent map in double precision"
    return [Section("tent-map", title, blocks, folded=True)] if blocks else []


def _jumps_of(
    study: Study, printed: list[PrintedRow[DurationsClaim | MaximumClaim]]
) -> Iterator[Block]:
    problem, claims = printed[0].problem, [row.claim for row in printed]
    first = claims[0]
    rows = [PrintedRow(study, first, pair) for pair in study.pairs if pair.problem == problem]
    moved = [row for row in rows if row.unmoved is None]
    jumping = [row for row in moved if any(j.order == 1 for j in row.check.jumps)]
    if not jumping:
        return
    row = jumping[0]
    statement, posed, durations = row.statement, study.problem(row.pair), row.durations.value
    names = "; ".join(dict.fromkeys(place(c) for c in claims))
    title = f"Jumps of the velocity with the printed durations of {names}"
    picture = jump_picture(posed, durations, title=title, units=paper_units(statement))
    where = "; ".join(dict.fromkeys(c.where for c in claims))
    caption = (
        f"{where}.{noted(study, row.reading)} The velocity jumps under {len(jumping)} of "
        f"{len(moved)} readings. Limits are judged inside the segments, separately from jumps."
    )
    yield pictured(picture, "jumps", problem, first.id, caption=caption)
    grid = []
    for jump in velocity_jumps(posed, durations):
        joint = [statement.labels.index(jump.joint)]
        size = both_units(statement, "velocity", [jump.size], "+.6g", joint)
        grid.append((jump.joint, jump.break_index, f"{jump.time:.3f} s", size))
    columns = ("joint", ">break", ">time", ">velocity after less before")
    head = f"All {len(grid)} jumps: {names}{only_under(study, row.reading)}"
    yield Folded(head, (table(columns, grid),))


def _polygons(study: Study) -> Iterator[Block]:
    for claim in study.case.claims:
        if not isinstance(claim, ControlVerticesClaim):
            continue
        statement = study.case.statement(claim.problem)
        if not (statement.complete and has_vertices(statement)):
            continue
        joints = range(len(statement.labels))
        waypoints = [[row[j].value for j in joints] for row in statement.waypoints.points]
        picture = polygon_picture(
            waypoints,
            vertices(claim, statement),
            title=f"Control polygon of every joint: {claim.where}",
            quantity="position" if any(statement.linear) else "angle",
        )
        both = "both are" if statement.unit("position") else "both of each joint are"
        caption = (
            f"{claim.where} compared with the vertices computed from the printed way-points "
            f"({statement.waypoints.where}). A grey bar covers every difference that the rounding "
            f"of both explains. No reading enters: {both} printed in one unit, and time is not "
            "involved."
        )
        yield pictured(picture, "polygon", claim.id, caption=caption)


_Path = tuple[Array, tuple[str, ...], tuple[bool, ...], str]
"""Way-points in the base, m, with names, marks for those out of reach, and what to say."""


def _workspaces(study: Study) -> Iterator[Block]:
    dh = study.case.dh
    if dh is None:
        return
    # By the stated convention alone: what another one keeps out of reach is not a fault of the
    # paper.
    chain = study.case.chain()
    assert chain is not None
    try:
        # Positions of the workspace that its bounding box is taken from, as by default in case
        # files.
        cloud = sample_workspace(chain, 20_000, 0)
    except TrajgapError:
        # A joint that slides without bounds has no workspace to sample.
        return
    path = _printed_path(study, dh, chain) or _joint_path(study, chain)
    points, labels, missed, said = path or (None, (), (), "")
    title = f"Workspace of {chain.name}"
    picture = workspace_picture(cloud, waypoints=points, labels=labels, missed=missed, title=title)
    ranges = "their ranges"
    if not np.isfinite(chain.upper - chain.lower).all():
        ranges += ", or one turn if none is printed"
    where = dh.where or "The table"
    caption = f"{where}, {chain.convention} convention. Joints uniform in {ranges}."
    if dh.alpha_signs == "uncertain":
        caption += " Twists have their printed signs; the text may have lost some of them."
    yield pictured(picture, "workspace", caption=f"{caption} {said}".strip())


def _printed_path(study: Study, dh: DhTable, chain: Chain) -> _Path | None:
    """Printed positions of the end, and which of them no joint values reach."""
    places = study.case.cartesian
    if not places:
        return None
    measured = [[to_si(number, place.unit) for number in place.values] for place in places]
    points = np.array([[m.value for m in row] for row in measured])
    halves = np.array([[(m.upper - m.lower) / 2 for m in row] for row in measured])
    # Distance that float arithmetic alone could leave, m.
    slack = dh.rounding(chain) + np.linalg.norm(halves, axis=1) + 1e-9
    free = np.full(chain.joints, np.nan)
    near = [proximity(chain, point, free) for point in points]
    names = tuple(place.label or place.id for place in places)
    missed = tuple(bool(n.lower > s) for n, s in zip(near, slack, strict=True))
    far = [
        f"{name} by {shown_bound(n.lower, 'lower', places=3)} m"
        for name, n, misses in zip(names, near, missed, strict=True)
        if misses
    ]
    reached = all(n.upper <= s for n, s in zip(near, slack, strict=True))
    where = "; ".join(dict.fromkeys(place.where for place in places))
    said = f"Way-points as printed ({where}). "
    if far:
        said += f"For any joint values, the end misses {', '.join(far)} at least."
    else:
        said += (
            "Some joint values reach each of them within rounding; TG601 examines whether these "
            "are the printed values."
            if reached
            else "None is shown to be out of reach."
        )
    return points, names, missed, said


def _joint_path(study: Study, chain: Chain) -> _Path | None:
    """Positions of the printed joint way-points, if the table gives every joint and its range."""
    if not study.has_problems:
        return None
    pair = study.main_pairs[0]
    problem = study.problem(pair)
    if set(chain.labels) != set(problem.joints) or not chain.revolute.all():
        return None
    order = [problem.joints.index(label) for label in chain.labels]
    q = problem.waypoints[:, order]
    labels = study.case.statement(*pair).waypoints.labels
    # Whole turns do not move the end.
    base = np.where(np.isfinite(chain.lower), chain.lower, q)
    outside = np.argwhere(base + np.mod(q - base, 2 * np.pi) > chain.upper)
    if outside.size:
        k, j = outside[0]
        name = labels[k] if labels else f"way-point {k + 1}"
        said = (
            f"The way-points are not drawn: joint {chain.labels[j]} at {name}, {q[k, j]:.4f} rad, "
            f"lies outside the range of this table, {chain.lower[j]:.4f} to {chain.upper[j]:.4f} "
            "rad, so the text may measure its angles from another zero."
        )
        return np.empty((0, 3)), (), (), said
    points = np.asarray(forward_kinematics(chain, q)[..., :3, 3])
    said = f"Way-points by forward kinematics.{noted(study, study.main_reading)}"
    return points, tuple(labels or ()), (), said


def _tents(study: Study) -> Iterator[Block]:
    counts = (
        study.case.statement(pid, rid).waypoints.number - 1
        for pid in dict.fromkeys(p for p, _ in study.case.selections())
        for rid in study.readings[:1]
    )
    dimensions = next((n for n in counts if n > 1), None)
    if dimensions is None:
        return
    for block in study.case.algorithms:
        built = study.algorithm(block.id)
        if not isinstance(built, ImprovedWOA) or built.initial is not InitialRule.TENT:
            continue
        scatter = tent_scatter(built.whales, dimensions, built.position_initial, built.beta)
        title = f"Initial population of {built.whales} times {dimensions} durations, tent map"
        picture = tent_picture(scatter, unit="s", title=title)
        printed = "as printed" if "tent_rule" in block.settings else "left open by the text"
        low, high = built.position_initial
        caption = (
            f"{block.where}. x′ = x/β up to β, (1 − x)/(1 − β) above, scaled to {low:g} to "
            f"{high:g} s; first two durations of every member. How orbits fill the population is "
            f"{printed}; the listed choice is “{built.tent_rule}”."
        )
        yield pictured(picture, "tent", block.id, caption=caption)
        lengths = {
            TentRule.COORDINATE: built.whales,
            TentRule.MEMBER: dimensions,
            TentRule.SINGLE: built.whales * dimensions,
        }
        rows = [
            (
                f"{rule} (listed choice)" if rule is built.tent_rule else str(rule),
                lengths[rule],
                f"{scatter.collapsed[rule]} of {built.whales}",
            )
            for rule in TentRule
        ]
        zero = ">members with a duration of exactly 0 (seed 0)"
        columns = ("orbits by", ">points of an orbit", zero)
        yield table(columns, rows)


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
        pictured(picture, "family", block.id, caption=caption),
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
