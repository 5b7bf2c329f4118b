"""The readings of a case side by side, as a section of its page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from ...problem import Case
from ...problem.cases import Statement
from ...problem.curves import ClampedBSpline, Knots, Parameters, clamped_readings
from ..audits import CaseAudit, answers, place, segments
from ..blocks import Block, Cell, Folded, Grid, Plain, Prose, Section, table, word
from ..documents import (
    ClaimVerdict,
    Keeping,
    ReadingOutcome,
    ReadingsSummary,
    Why,
    capital,
    value_or_none,
)
from .numbers import both_units, problem_cell


def side_by_side(one: CaseAudit) -> Section:
    """What each reading makes of the printed answers, and what holds whatever the reading."""
    blocks: list[Block] = []
    summary = one.readings
    if summary is not None:
        tables = _outcomes(one, summary) if summary.outcomes else [_without_problems(one)]
        rows = sum(len(t.rows) for t in tables if isinstance(t, Grid))
        title = f"{len(summary.admissible)} readings side by side"
        found = answers(summary, lambda claim, _: place(one.case.claim(claim)))
        said = [Prose(capital(answer)) for answer in found]
        if rows > 4:
            blocks += said
            blocks.append(Folded(title, tuple(tables)))
        else:
            blocks += [*said[-1:], *tables]
        blocks += _argued(one, summary)
    blocks += _determined(one.case)
    return Section("side-by-side", "What depends on the reading", tuple(blocks))


def _argued(one: CaseAudit, summary: ReadingsSummary) -> Iterator[Block]:
    """Why the default is one, what speaks for each reading, and limits held elsewhere."""
    found: dict[tuple[str, str, str, str], list[str]] = {}
    for clue in summary.clues:
        key = (clue.where, clue.text, clue.computed, str(clue.speaks))
        found.setdefault(key, []).append(clue.reading)
    rows = [
        (f"{where}\n{said}", "; ".join(summary.labels[one] for one in readings), speaks, computed)
        for (where, said, computed, speaks), readings in found.items()
    ]
    blocks: list[Plain] = []
    if not isinstance(summary.default_why, Why):
        blocks.append(Prose(f"Default: {summary.labels[summary.default]}. {summary.default_why}"))
    blocks += [
        Prose(f"Implausible, though admissible: {summary.labels[reading]}, for {why}.")
        for reading, why in summary.implausible.items()
    ]
    if rows:
        columns = ("printed or known", "readings", "speaks", "~computed under them")
        note = "None of this decides a verdict: an implausible reading stays admissible."
        blocks += [table(columns, rows), Prose(note, "note")]
    if blocks:
        yield Folded("Evidence for and against the readings", tuple(blocks))
    held = [o for o in summary.outcomes if not isinstance(o.held, Why)]
    if held:
        yield Folded("If the limits were enforced elsewhere", _held(one, held))


def _held(one: CaseAudit, outcomes: list[ReadingOutcome]) -> tuple[Block, ...]:
    """Largest ratio to a limit for all t, at samples, and on control vertices."""
    rows, steps = [], 0
    for outcome in outcomes:
        held = outcome.held
        if not isinstance(held, Why):
            steps = held.steps
            ratios = (held.everywhere, held.sampled, held.vertices)
            shown = [None if isinstance(x, Why) else f"{x:.4g}" for x in ratios]
            rows.append((_whose(one, outcome), one.case.labels[outcome.reading], *shown))
    columns = ("durations", "reading", ">for all t", ">at samples", ">on control vertices")
    note = (
        "Largest ratio of the printed durations to a limit; above 1 it is broken. Every verdict "
        f"means all t. Samples: {steps} steps a segment. Control vertices bound velocity and "
        "acceleration of a B-spline from outside, so limits on them are stricter."
    )
    return table(columns, rows).filled, Prose(note, "note")


def _whose(one: CaseAudit, outcome: ReadingOutcome) -> str:
    """Where the durations of an outcome are printed, or the problem if none are."""
    if outcome.claim:
        return place(one.case.claim(outcome.claim))
    return problem_cell(one.case, outcome.problem)


def _outcomes(one: CaseAudit, summary: ReadingsSummary) -> list[Block]:
    """One table for each printed answer, or for each problem without one."""
    default = one.case.default_reading.id
    printed: dict[tuple[str | None, str], list[ReadingOutcome]] = {}
    for outcome in summary.outcomes:
        printed.setdefault((outcome.claim, outcome.problem), []).append(outcome)
    names = ("reading", "limits", "over a limit", ">× to limits", ">optimum", "printed total")
    grids: list[Block] = [
        table(names, [_row(x, default, summary) for x in own], _whose(one, own[0])).filled
        for own in printed.values()
    ]
    note = (
        "Limits are judged for all ways in which the digits may have been rounded or cut off; "
        "jumps and violated segments are those of the printed point. × to limits: the factor on "
        "all durations with which they just reach the limits, apart from jumps. The printed total "
        "stands next to the optimum."
    )
    return [*grids, Folded("How to read this table", (Prose(note, "note"),))]


def _row(outcome: ReadingOutcome, default: str, summary: ReadingsSummary) -> tuple[object, ...]:
    mark = "\n(default)" if outcome.reading == default else ""
    mark += "\n(implausible)" if outcome.reading in summary.implausible else ""
    optimum, stretch = value_or_none(outcome.optimum), value_or_none(outcome.stretch)
    gap = value_or_none(outcome.gap)
    over = ""
    if outcome.excesses:
        worst = max(outcome.excesses, key=lambda e: e.ratio)
        whose = f"joint {worst.joint} {worst.quantity}" if worst.joint else worst.quantity
        plural = "s" if len(outcome.excesses) > 1 else ""
        over = f"segment{plural} {segments(outcome.excesses)}\n{whose}, ratio {worst.ratio:.4g}"
    several = "s" if outcome.jumps > 1 else ""
    jumps = f"\n{outcome.jumps} velocity jump{several}" if outcome.jumps else ""
    limits = Cell("")
    if not isinstance(outcome.keeping, Why):
        limits = word(outcome.keeping)
        # What decides nothing about limits.
        if outcome.keeping in (Keeping.DISCONTINUOUS, Keeping.UNDECIDED):
            # The word that the claim has under this reading; its reason is behind the link.
            limits = replace(limits, text=str(ClaimVerdict.NOT_CHECKABLE))
    return (
        summary.labels[outcome.reading] + mark,
        replace(limits, text=limits.text + jumps),
        over,
        stretch and f"{stretch:.4f}",
        optimum and f"{optimum:.6f} s\n{outcome.evidence}",
        gap and f"{gap.percent.replace('-', '−')}\n{gap.kind}",
    )


def _without_problems(one: CaseAudit) -> Grid:
    """Curve and limits of each reading, where nothing can be computed for want of way-points."""
    rows, slides = [], False
    for pid, rid in one.case.selections():
        if rid in one.study.readings:
            statement = one.case.statement(pid, rid)
            curve, limits, _, _ = statement.data()
            slides |= any(statement.linear)
            speeds = _listed(statement, "velocity", limits.velocity)
            rates = _listed(statement, "acceleration", limits.acceleration)
            asked = one.case.labels[rid], problem_cell(one.case, pid)
            rows.append((*asked, curve.name, speeds, rates))
    units = ("", "") if slides else (", rad/s", ", rad/s²")
    limited = (f"velocity limits{units[0]}", f"acceleration limits{units[1]}")
    names = ("reading", "problem", "curve", *limited)
    return table(names, rows, "The problem under each reading, apart from way-points").filled


def _listed(statement: Statement, quantity: str, limits: Iterable[float]) -> str:
    """Limits in SI, all of them once where they are equal; with all units where a joint slides."""
    every = [f"{v:.6g}" for v in limits]
    if any(statement.linear):
        return both_units(statement, quantity, list(limits), ".6g")
    return every[0] if len(set(every)) == 1 else ", ".join(every)


def _determined(case: Case) -> list[Block]:
    """Which degrees and knots the end conditions of a clamped B-spline determine."""
    curves = [case.statement(pid, rid).curve() for pid, rid in case.selections()]
    # A printed vector leaves no rule to choose.
    ruled = (c for c in curves if isinstance(c, ClampedBSpline) and c.knots is not Knots.GIVEN)
    curve = next(ruled, None)
    if curve is None:
        return []
    count = len(curve.waypoint_breaks)
    rows = tuple(
        (r.degree, str(r.knots), str(r.count), r.words)
        for r in clamped_readings(count, curve.end_orders)
        if r.parameters is Parameters.TIMES
    )
    grid = table((">degree", "knots", "count", "~what holds"), rows)
    title = f"Degrees and knots through {count} way-points, and what the conditions determine"
    return [Folded(title, (grid,))]
