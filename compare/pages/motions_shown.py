"""The pictures of a report page: motions, searches and landscapes, under the default reading."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...heuristics import JointRuns
from ...nlp import Solution, weakest
from ...problem import Array, Problem, TrajgapError, file_name
from ...problem.cases import AnyClaim, DurationsClaim, MaximumClaim, TotalTimeClaim
from ..audits import CaseAudit, Study, at_ratios, place, planned_apart
from ..documents import OWN_OPTIMA
from ..pictures import Picture, Runs, convergence, endings, landscape, motion_picture, svg
from .blocks import Block, Drawn, Folded, Grid, Prose, Section
from .numbers import REPLAY_COLUMNS, noted, problem_name, replay_rows
from .units import paper_units


def motions(one: CaseAudit) -> Section:
    """Angle, velocity and acceleration of every printed set of durations, and of the optimum."""
    blocks: list[Block] = []
    rid = one.study.main_reading
    for pid in one.study.problems:
        blocks += _printed_motions(one.study, pid, rid)
        solution = one.study.optimum(pid, rid)
        if solution.found and solution.boundless is None:
            title = f"{_optimum_of(one, pid, solution)}: {solution.total_time:.6f} s"
            picture = motion_picture(
                solution.problem,
                solution.durations,
                title=title,
                check=solution.check,
                nodal=solution.nodal,
                units=paper_units(one.study.case.statement(pid, rid)),
            )
            blocks.append(_drawn(file_name("optimum", pid), picture, noted(one.study, rid).strip()))
    return Section("motions", "Motions, with limits and peaks", tuple(blocks), folded=True)


def _optimum_of(one: CaseAudit, pid: str, solution: Solution) -> str:
    """What the optimum of a problem is called, and the problem where there are several."""
    known = f"{solution.evidence.capitalize()} optimum{at_ratios(solution.problem)}"
    return known + (f", {problem_name(one, pid)}" if len(one.case.problems) > 1 else "")


def _drawn(name: str, picture: Picture, caption: str) -> Drawn:
    return Drawn(name, svg(picture), picture.title, caption)


def whole_claims(study: Study, pid: str) -> list[DurationsClaim | MaximumClaim]:
    """Claims that print durations for all joints of a problem."""
    joints = study.problem(pid, study.main_reading).joints
    return [
        c
        for c in study.case.claims
        if isinstance(c, DurationsClaim | MaximumClaim)
        and study.fits(c, pid, study.main_reading)
        and (c.joint is None or len(joints) == 1)
    ]


def _printed_motions(study: Study, pid: str, rid: str) -> Iterator[Block]:
    alike: dict[tuple[str, ...], list[AnyClaim]] = {}
    for claim in whole_claims(study, pid):
        alike.setdefault(tuple(map(str, claim.durations)), []).append(claim)
    for claims in alike.values():
        first = claims[0]
        problem = study.problem(pid, rid)
        title = f"Printed durations: {'; '.join(dict.fromkeys(place(c) for c in claims))}"
        unmoved = study.unmoved(first, pid, rid)
        if unmoved is not None:
            yield Prose(f"{title} are not drawn: {unmoved}.{noted(study, rid)}", "note")
            continue
        rounding = study.claim_rounding(first, pid, rid).verdict
        worst = study.claim_check(first, pid, rid).worst
        if worst is not None and worst.quantity == "curve":
            yield Prose(f"{title} define no curve.{noted(study, rid)}", "note")
            continue
        picture = motion_picture(
            problem,
            study.case.claim_durations(first, rid).value,
            title=title,
            check=study.claim_check(first, pid, rid),
            note=f"however the digits were rounded: {rounding}",
            units=paper_units(study.case.statement(pid, rid)),
        )
        where = "; ".join(c.where for c in claims)
        yield _drawn(file_name("motion", pid, first.id), picture, f"{where}.{noted(study, rid)}")
    for tables, singles in _tables_by_joint(study, pid).items():
        if study.unmoved(singles[0], pid, rid) is None:
            yield _joint_by_joint(study, pid, rid, tables, singles)


def _tables_by_joint(study: Study, pid: str) -> dict[str, list[DurationsClaim]]:
    """Claims of tables that print every joint by itself; tables alike share an entry."""
    joints = study.problem(pid, study.main_reading).joints
    if len(joints) == 1:
        return {}
    found: dict[tuple[tuple[str, ...], ...], tuple[list[str], list[DurationsClaim]]] = {}
    for table in study.case.tables:
        rows = {
            c.joint: c
            for c in study.case.table_claims(table.id)
            if isinstance(c, DurationsClaim) and study.fits(c, pid, study.main_reading)
        }
        if all(label in rows for label in joints):
            claims = [rows[label] for label in joints]
            digits = tuple(tuple(map(str, c.durations)) for c in claims)
            found.setdefault(digits, ([], claims))[0].append(table.id)
    return {", ".join(tables): claims for tables, claims in found.values()}


def _tables_called(study: Study, tables: str) -> str:
    """Tables by their places instead of their ids."""
    places = {table.id: table.where for table in study.case.tables}
    return ", ".join(places.get(one, one) for one in tables.split(", "))


def _joint_by_joint(
    study: Study, pid: str, rid: str, tables: str, claims: list[DurationsClaim]
) -> Drawn:
    problem = study.problem(pid, rid)
    durations = np.array([study.case.claim_durations(c, rid).value for c in claims])
    verdicts = [str(study.claim_rounding(c, pid, rid).verdict) for c in claims]
    words = ", ".join(dict.fromkeys(verdicts))
    picture = motion_picture(
        problem,
        durations,
        title=f"Printed durations of each joint by itself: {_tables_called(study, tables)}",
        note=f"however the digits were rounded: {words}",
        units=paper_units(study.case.statement(pid, rid)),
    )
    each = "; ".join(f"joint {c.joint}: {v}" for c, v in zip(claims, verdicts, strict=True))
    caption = (
        "Each joint with its own durations, at the printed digits. However the digits were "
        f"rounded: {each}.{noted(study, rid)}"
    )
    return _drawn(file_name("motion", pid, "joints", str(claims[0].table)), picture, caption)


# --- searches -------------------------------------------------------------------------------------


def searches(one: CaseAudit) -> Section:
    """Replays of the algorithms: convergence, where they end, and the spread over choices."""
    study, rid = one.study, one.study.main_reading
    blocks: list[Block] = []
    for pid in study.problems:
        runs = _runs(study, pid)
        if not runs:
            continue
        name = problem_name(one, pid)
        blocks += _convergence(study, pid, rid, runs, name)
        references, printed = _totals(study, pid, rid)
        title = f"Totals of all runs: {name}"
        ends = {each: np.array([r.reported_time for r in one]) for each, one in runs.items()}
        caption = "Vertical strokes are medians. A reported total is not clipped at the optimum."
        blocks.append(
            _drawn(
                file_name("totals", pid), endings(ends, references, printed, title=title), caption
            )
        )
        grid = Grid(REPLAY_COLUMNS, tuple(replay_rows(study, pid)))
        blocks.append(Folded(f"Spread over seeds and open choices: {name}", (grid,)))
    lead = Prose(
        f"Each algorithm was run with seeds 0 to {study.seeds - 1} under the choices listed below, "
        f"and under settings spread over all that the text leaves open.{noted(study, rid)} "
        "Replays inform and decide nothing.",
        "note",
    )
    shown = (lead, *blocks) if blocks else ()
    return Section("searches", "Replays of the algorithms", shown, folded=True)


def _runs(study: Study, pid: str) -> dict[str, Runs]:
    names = [a.name for a in study.case.algorithms]
    replays = {
        a.name if names.count(a.name) == 1 else f"{a.name} ({a.id})": study.runs(
            a.id, pid, study.main_reading
        )
        for a in study.case.algorithms
    }
    return {name: one for name, one in replays.items() if one}


def _convergence(
    study: Study, pid: str, rid: str, runs: dict[str, Runs], name: str
) -> Iterator[Block]:
    by_joint = isinstance(next(iter(runs.values()))[0], JointRuns)
    problem = study.problem(pid, rid)
    solutions = [study.optimum(pid, rid, label) for label in problem.joints] if by_joint else [
        study.optimum(pid, rid)
    ]  # fmt: skip
    if any(not s.found or not _time(s) > 0 for s in solutions):
        return  # there is nothing, or nothing positive, that a gap could be a share of
    printed: dict[str, list[float]] = {}
    widths = [0.0]
    groups: dict[str, list[DurationsClaim | MaximumClaim]] = (
        {
            _tables_called(study, tables): list(claims)
            for tables, claims in _tables_by_joint(study, pid).items()
        }
        if by_joint
        else {place(c): [c] for c in whole_claims(study, pid)}
    )
    for label, claims in groups.items():
        boxes = [total[1] for c in claims if (total := study.claim_total(c, rid)) is not None]
        printed[label] = [(low + high) / 2 for low, high in boxes]
        widths += [(high - low) / 2 for low, high in boxes]
    picture = convergence(
        runs,
        [_time(s) for s in solutions],
        printed,
        rounding=max(widths),
        evidence=str(weakest(s.evidence for s in solutions)),
        joints=problem.joints,
        title=f"Best total so far: {name}" + (", each joint by itself" if by_joint else ""),
    )
    yield _drawn(
        file_name("convergence", pid),
        picture,
        "Gap to the optimum, linear up to 0.01 % and logarithmic beyond. The band around a printed "
        "total is its rounding.",
    )


def _time(solution: Solution) -> float:
    return solution.best


def _totals(study: Study, pid: str, rid: str) -> tuple[dict[str, float], dict[str, float]]:
    shared = study.optimum(pid, rid)
    references = {}
    if shared.found and shared.boundless is None:
        at = at_ratios(shared.problem)
        references[f"{shared.evidence} optimum, shared durations{at}"] = _time(shared)
    problem = study.problem(pid, rid)
    if planned_apart(problem):
        answer = study.per_joint(pid, rid)
        if answer.found:
            references[OWN_OPTIMA] = answer.total_time
    printed: dict[str, list[str]] = {}
    values: dict[str, float] = {}
    for claim in study.case.claims:
        whole = isinstance(claim, TotalTimeClaim) and claim.joint is None
        if claim in whole_claims(study, pid) or (whole and claim.problem in (None, pid)):
            total = study.claim_total(claim, rid)
            if total is not None:
                printed.setdefault(total[0], []).append(place(claim))
                values[total[0]] = (total[1][0] + total[1][1]) / 2
    return references, {
        ", ".join(dict.fromkeys(where)): values[shown] for shown, where in printed.items()
    }


# --- landscapes -----------------------------------------------------------------------------------


def landscapes(one: CaseAudit) -> Section:
    """Total time over the shares of three durations, for all joints and for each by itself."""
    study, rid = one.study, one.study.main_reading
    blocks: list[Block] = []
    for pid in study.problems:
        problem = study.problem(pid, rid)
        if problem.ratios is not None:
            continue  # its ratios are one point of the map
        if problem.segments != 3:
            blocks.append(
                Prose(
                    f"{problem_name(one, pid)}: {problem.segments} segments; a landscape "
                    "needs three.",
                    "note",
                )
            )
            continue
        runs = _runs(study, pid)
        printed = [
            (place(c), study.case.claim_durations(c, rid).value) for c in whole_claims(study, pid)
        ]
        ends = {name: np.array([r.durations for r in many]) for name, many in runs.items()}
        blocks += _landscape(
            file_name("landscape", pid),
            problem,
            study.optimum(pid, rid),
            printed,
            ends,
            problem_name(one, pid),
        )
        single: list[Drawn] = []
        for tables, claims in _tables_by_joint(study, pid).items():
            for j, claim in enumerate(claims):
                own = {
                    name: np.array([r.runs[j].durations for r in many if isinstance(r, JointRuns)])
                    for name, many in runs.items()
                    if isinstance(many[0], JointRuns)
                }
                single += _landscape(
                    file_name("landscape", pid, "joint", str(j + 1)),
                    problem.joint(j),
                    study.optimum(pid, rid, problem.joints[j]),
                    [(_tables_called(study, tables), study.case.claim_durations(claim, rid).value)],
                    own,
                    f"joint {problem.joints[j]}",
                )
            break
        if single:
            blocks.append(Folded(f"Each joint by itself: {problem_name(one, pid)}", tuple(single)))
    shown = tuple(blocks) if any(not isinstance(b, Prose) for b in blocks) else ()
    return Section("landscapes", "Landscapes of the total time", shown, folded=True)


def _landscape(
    name: str,
    problem: Problem,
    optimum: Solution,
    printed: list[tuple[str, Array]],
    ends: dict[str, Array],
    what: str,
) -> Iterator[Drawn]:
    alike: dict[bytes, tuple[list[str], Array]] = {}
    for label, durations in printed:
        alike.setdefault(durations.tobytes(), ([], durations))[0].append(label)
    points = [(", ".join(labels), durations) for labels, durations in alike.values()]
    try:
        picture = landscape(
            problem,
            optimum,
            points,
            ends,
            title=f"Total time over the shares of h₁ : h₂ : h₃, {what}",
        )
    except TrajgapError:
        return
    yield _drawn(
        name,
        picture,
        "Exact totals: any shares, stretched until the first limit is reached for all t.",
    )
