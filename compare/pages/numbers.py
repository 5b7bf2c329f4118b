"""The computed half of a report page: where the time goes, optima, sensitivities and replays."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from ...nlp import PerJointSolution, Solution
from ...problem import Case, Coupling, Printed, shown_bound, shown_unit, to_si
from ...problem.cases import DurationsClaim, Statement
from ..audits import CaseAudit, Pair, PrintedRow, Study, at_ratios, place, routes, searched_for
from ..blocks import (
    REACHED_MEANING,
    Block,
    Drawn,
    Folded,
    Grid,
    Prose,
    Section,
    distances_table,
    reached_table,
    steps_table,
    table,
    word,
)
from ..documents import UNITS, Waterfall, Why, by_search, ranged, si_unit
from ..gaps import gap, reference_of, spread
from ..pictures import pictured, reached_picture, waterfall_picture


def paper_units(statement: Statement) -> dict[tuple[str, str], tuple[str, float]]:
    """The paper's units where they are not SI, as pictures take them: as written, and in SI.

    By joint and quantity.

    `statement`: the problem under the reading whose units count.
    """
    found = {}
    for joint in statement.joints:
        for quantity in UNITS:
            own = _own(statement, quantity, joint)
            if own is not None:
                found[statement.labels[joint], quantity] = own
    return found


def _own(statement: Statement, quantity: str, joint: int) -> tuple[str, float] | None:
    """The paper's unit of a joint where it is not SI, and how much of SI one of it is."""
    unit = statement.unit(quantity, joint)  # type: ignore[arg-type]
    if unit is None or shown_unit(unit) == si_unit(quantity, statement.linear[joint]):
        return None
    return shown_unit(unit), to_si(Printed("1", exact=True), unit).value


def both_units(
    statement: Statement,
    quantity: str,
    values: Sequence[float],
    form: str,
    joints: Sequence[int] | None = None,
) -> str:
    """Values in the paper's unit of a quantity, with SI in brackets where that is another.

    `quantity`: such as "velocity". `values`: in SI. `form`: format of each number, such as "+.6g".
    `joints`: position of each value's joint in the robot's list; those that take part by default,
    where one value may stand for all that have one unit.
    """
    places = list(statement.joints if joints is None else joints)
    places = places[: len(values)]
    if not one_unit(statement, quantity, places):
        each = zip(values, places, strict=True)
        return ", ".join(both_units(statement, quantity, [v], form, [j]) for v, j in each)
    si = ", ".join(f"{v:{form}}" for v in values)
    si += f" {si_unit(quantity, statement.linear[places[0]])}"
    unit = _own(statement, quantity, places[0])
    if unit is None:
        return si
    own = ", ".join(f"{round(v / unit[1], 10):{form}}" for v in values)
    return f"{own} {unit[0]} ({si})"


def one_unit(statement: Statement, quantity: str, joints: Sequence[int]) -> bool:
    """Whether some joints have a quantity in the same unit, stated or not."""
    found = {(statement.unit(quantity, j), statement.linear[j]) for j in joints}  # type: ignore[arg-type]
    return len(found) == 1


def first_waterfall(one: CaseAudit) -> Waterfall | None:
    """That of the first problem under the default reading, which stands beside the card."""
    main = one.study.main_reading
    return next((w for w in one.waterfalls if w.reading == main), None)


def card_picture(one: CaseAudit) -> Drawn | None:
    """Where the time goes, small: the first problem under the default reading."""
    waterfall = first_waterfall(one)
    if waterfall is None:
        return None
    several = len({w.problem for w in one.waterfalls}) > 1
    title = "Where the time goes"
    title += f": {problem_name(one, waterfall.problem)}" if several else ""
    return pictured(waterfall_picture(waterfall, title=title, narrow=True), "time", inside=True)


def where_time_goes(one: CaseAudit, few: int = 3) -> Section:
    """Distances under the default reading; pictures and steps of all readings folded.

    `few`: other readings of a problem that still get a picture each.
    """
    main = one.study.main_reading
    blocks: list[Block] = []
    for pid in dict.fromkeys(w.problem for w in one.waterfalls):
        own = [w for w in one.waterfalls if w.problem == pid]
        others = [w for w in own if w.reading != main]
        for waterfall in own:
            shown = problem_name(one, pid, waterfall.reading)
            own_reading = waterfall.reading == main
            if own_reading:
                blocks.append(distances_table(waterfall, shown).filled)
                notes = [Prose(said, "note") for said in waterfall.without_optimum]
                blocks += [note for note in notes if note not in blocks]
            if own_reading or len(others) <= few:
                title = f"{'Picture and notes' if own_reading else 'Other reading'}: {shown}"
                inside = _drawn(one, waterfall), steps_table(waterfall)
                blocks.append(Folded(title, inside))
        if len(others) > few:
            title = f"Other readings, step by step: {problem_name(one, pid)}"
            blocks.append(Folded(title, (_side_by_side(one, pid, others),)))
    return Section("waterfall", "Distance from the optimum", tuple(blocks))


def reached_runs(one: CaseAudit, few: int = 3) -> Section:
    """How near each of the paper's algorithms gets, with every run between optimum and print.

    `few`: searches that stand open.
    """
    blocks: list[Block] = []
    for at, (title, runs) in enumerate(by_search(one.reached).items()):
        picture = reached_picture(runs, one.waterfalls, title=title)
        own = reached_table(runs, title), pictured(picture, "reached", str(at))
        blocks += own if at < few else [Folded(title, own)]
    if blocks:
        meaning = Folded("How to read this", (Prose(REACHED_MEANING, "note"),))
        blocks = [Prose(str(one.reached[0]), "lead"), *blocks, meaning]
    return Section("reached", "How near the paper's algorithms get", tuple(blocks))


def _called(case: Case, pid: str) -> str:
    """What a reader calls a problem: its title."""
    return next((p.title for p in case.problems if p.id == pid), "") or pid


def problem_cell(case: Case, pid: str) -> str:
    """What a table calls a problem; nothing if it is the only one."""
    return _called(case, pid) if len(case.problems) > 1 else ""


def asked_cells(study: Study, pair: Pair) -> tuple[str, str]:
    """What a table calls a problem and its reading."""
    return problem_cell(study.case, pair.problem), study.case.labels[pair.reading]


def problem_name(one: CaseAudit, pid: str, reading: str | None = None) -> str:
    """What a reader calls a problem, and the reading where there are several."""
    # A file that names no problem has one called "main", which says nothing.
    title = _called(one.case, pid) if one.case.document.problems else "The motion"
    if reading is None or len(one.study.readings) == 1:
        return title
    return f"{title}; {one.case.labels.get(reading, reading)}"


def only_under(study: Study, rid: str) -> str:
    """Under which reading something is shown, behind its title; empty if there is one."""
    return f"; {study.case.labels[rid]}" if len(study.readings) > 1 else ""


def noted(study: Study, rid: str) -> str:
    """The same as a sentence behind a caption."""
    return f" Reading: {study.case.labels[rid]}." if len(study.readings) > 1 else ""


def _drawn(one: CaseAudit, waterfall: Waterfall) -> Drawn:
    title = f"Where the time goes: {problem_name(one, waterfall.problem, waterfall.reading)}"
    picture = waterfall_picture(waterfall, title=title)
    caption = "Bars start at 0; best known values are hatched, certified ones solid."
    if waterfall.claim:
        caption += f" The first bar is printed in {place(one.case.claim(waterfall.claim))}."
    return pictured(picture, "waterfall", waterfall.problem, waterfall.reading, caption=caption)


def _side_by_side(one: CaseAudit, pid: str, waterfalls: Sequence[Waterfall]) -> Grid:
    """Steps of many readings, one row each; steps that no reading has are left out."""
    names = dict.fromkeys(s.name for w in waterfalls for s in w.steps)
    rows = []
    for waterfall in waterfalls:
        steps = {s.name: s for s in waterfall.steps}
        cells = [
            "" if (step := steps.get(name)) is None or isinstance(step.time, Why)
            else "\n".join(filter(None, (step.total(), step.known)))
            for name in names
        ]  # fmt: skip
        rows.append((one.case.labels.get(waterfall.reading, waterfall.reading), *cells))
    caption = f"{problem_name(one, pid)}; an empty cell was not computed"
    return table(("reading", *(f">{name}" for name in names)), rows, caption).filled


_ANSWER = ("status", ">total", "by", "evidence", ">durations, s", "check", ">KKT residual")
"""Columns that say how a solve ended."""


def _answer(solution: Solution) -> tuple[object, ...]:
    if solution.boundless is not None:
        why = f"{solution.status}\n{solution.boundless}"
        return (why, *(None for _ in _ANSWER[1:]))
    check, residual, durations = solution.check, solution.kkt_residual, None
    total = f"{solution.total_time:.6f} s" if solution.found else None
    if solution.found:
        # Two on a line: nine on one would push the table off the page.
        shown = [f"{value:.6f}" for value in solution.durations]
        durations = ",\n".join(", ".join(shown[i : i + 2]) for i in range(0, len(shown), 2))
    if solution.infimum is not None:
        called = "infimum" if solution.approach_proved else "approached"
        total = f"{solution.infimum:.6f} s ({called})"
    if total is not None and solution.lower_bound is not None:
        total += f"\nat least {shown_bound(solution.lower_bound, 'lower', places=9)} s,\nproved"
    return (
        solution.status + (f"\n{solution.why}" if solution.why else ""),
        total,
        None if solution.route is None else "\n".join(routes(solution)),
        word(solution.evidence),
        durations,
        word(check.verdict) if check is not None else None,
        None if residual is None else f"{residual:.1e}",
    )


def optima(one: CaseAudit) -> Section:
    """Optimum of each formulation, then each joint separately where the text does that."""
    study = one.study
    rows: list[tuple[object, ...]] = []
    blocks: list[Block] = []
    without: defaultdict[str, list[str]] = defaultdict(list)
    for pair in study.pairs:
        own, relaxed = study.optimum(pair), study.relaxed(pair)
        solved = {f"printed curve, shared durations{at_ratios(own.problem)}": own}
        if relaxed.found:
            solved["relaxed family"] = relaxed
        else:
            without[relaxed.why or str(relaxed.status)].append(pair.reading)
        rows += [(*asked_cells(study, pair), name, *_answer(one)) for name, one in solved.items()]
        problem = own.problem
        if problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1:
            blocks += _joints(study, pair)
    if not rows:
        return Section("optima", "", ())
    notes = [
        Prose(
            f"No relaxed family for {len(found)} of {len(study.pairs)} rows above: {why}.", "note"
        )
        for why, found in without.items()
    ]
    names = ("problem", "reading", "formulation", *_ANSWER)
    shown = table(names, rows).filled, *notes, *blocks
    return Section("optima", "Optimum of each formulation", shown, folded=True)


def _joints(study: Study, pair: Pair) -> Iterator[Block]:
    answer = study.per_joint(pair)
    rows = []
    for label, solution in zip(answer.problem.joints, answer.joints, strict=True):
        shown: dict[str, list[str]] = {}
        gaps = []
        reference = reference_of(solution)
        for claim in study.case.claims:
            own = isinstance(claim, DurationsClaim) and claim.joint == label
            total = (
                study.claim_total(claim, pair.reading) if own and study.fits(claim, pair) else None
            )
            if total is not None and reference is not None:
                shown.setdefault(total.shown, []).append(claim.where)
                row = PrintedRow(study, claim, pair)
                far = gap(total.interval, reference, feasible=row.kept)
                gaps.append(f"{far.percent} ({far.kind})")
        rows.append(
            (
                label,
                *_answer(solution),
                "\n".join(f"{t} ({'; '.join(where)})" for t, where in shown.items()),
                "\n".join(dict.fromkeys(gaps)),
            )
        )
    names = ("joint", *_ANSWER, "printed", "gap")
    named = problem_cell(study.case, pair.problem) or "each segment takes the longest duration"
    yield Prose(f"Each joint separately: {named}{only_under(study, pair.reading)}", "heading")
    yield table(names, rows)
    yield Prose(_procedure(answer), "note")


def _procedure(answer: PerJointSolution) -> str:
    if answer.check is None:
        return f"The longest durations are not known: {answer.why}."
    parts = [
        f"Longest duration of each segment at these optima: {answer.total_time:.6f} s "
        f"(check: {answer.check.verdict}). That total is the output of a procedure, not an optimum."
    ]
    for r in answer.ranges:
        parts.append(
            f"While every joint stays within {r.slack:g} s of its own optimum it takes "
            f"{ranged(r.lowest, r.highest, '.6f')} s."
        )
    return " ".join(parts)


def sensitivities(one: CaseAudit) -> Section:
    """What 10 % more of each active limit buys, to first order."""
    title = "Effect of raising a limit by 10 %"
    rows = []
    for pair in one.study.pairs:
        solution = one.study.optimum(pair)
        bought: defaultdict[tuple[str, str], list[float]] = defaultdict(list)
        for a in solution.active:
            where = f"joint {a.joint}" if a.joint is not None else f"segment {a.segment + 1}"
            bought[where, a.quantity].append(a.sensitivity)
        for limit, changes in bought.items():
            change = sum(changes)
            share = f"{100 * change / solution.total_time:+.3f} %"
            asked = asked_cells(one.study, pair)
            rows.append((*asked, *limit, len(changes), f"{change:+.6f} s", share))
    note = Prose(
        "First-order change of the total if a limit that is reached is raised by 10 %, from the "
        "multipliers of the optimum with shared durations.",
        "note",
    )
    names = ("problem", "reading", "limit of", "quantity", ">peaks at it", ">changes the total",
             ">by")  # fmt: skip
    body: Block = table(names, rows).filled if rows else Prose("No limit is reached.")
    shown = (note, body) if one.study.has_problems else ()
    return Section("sensitivities", title, shown, folded=True)


def replay_rows(study: Study, pair: Pair) -> list[tuple[object, ...]]:
    """Totals of every algorithm over its seeds, under the listed choices and spread settings."""
    reference = searched_for(study, pair)
    rows: list[tuple[object, ...]] = []
    for algorithm in study.case.algorithms:
        for name, runs in study.spread_runs(algorithm.id, pair).items():
            s = spread(np.array([r.reported_time for r in runs]))
            away = None
            if reference is not None and np.isfinite(s.median):
                away = gap(s.median, reference).percent
            totals = (s.lowest, s.median, s.highest)
            shown = [f"{x:.6f} s" if np.isfinite(x) else None for x in totals]
            rows.append((algorithm.name, name, s.runs, s.failed, *shown, away))
    return rows


REPLAY_COLUMNS = ("algorithm", "choices", ">runs", ">without answer", ">shortest", ">median",
                  ">longest", ">gap of the median")  # fmt: skip
"""Columns of `replay_rows`."""
