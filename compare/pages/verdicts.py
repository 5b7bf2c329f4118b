"""What a report page was made from: problems, findings, readings, assumptions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ...problem import QUANTITIES, Case, Coupling, Problem, file_name
from ...problem.cases import Statement
from ..audits import RULES, CaseAudit, Study, place
from ..blocks import Block, Cell, Folded, Grid, Prose, Section, Terms, table, word
from ..documents import ClaimVerdict, Finding, Gap, Severity, Why, facts
from .numbers import asked_cells, problem_cell
from .units import both_units, one_unit

_FEW = 10
"""Equal shares of a total up to which each is shown."""
_TITLES = {rule.id: rule.title for rule in RULES}
"""What each rule looks at, by its id."""


def problems_audited(one: CaseAudit) -> Section:
    """The problems of the paper, as they were computed."""
    grid = _problems(one.study)
    case = one.case
    terms = [
        ("note on the text", case.source.note),
        ("robot", case.robot.name),
        ("joints", ", ".join(case.robot.joints)),
        *facts(one.document),
    ]
    blocks: tuple[Block, ...] = (Terms(tuple(term for term in terms if term[1])),)
    blocks += (grid,) if grid.rows else ()
    return Section("audited", "What was audited", blocks, folded=True)


def _problems(study: Study) -> Grid:
    rows, slides = [], False
    for pair in study.pairs:
        p = study.problem(pair)
        slides |= any(p.linear)
        how = "shared durations" if p.coupling is Coupling.SHARED else "each joint separately"
        rows.append(
            (
                *asked_cells(study, pair),
                f"{len(p.joints)} × {p.waypoints.shape[0]}",
                p.curve.name,
                _limits(p, study.case.statement(*pair)),
                _bounds(p),
                how,
            )
        )
    names = ("problem", "reading", "joints × way-points", "curve", "limits", "durations",
             "coupling")  # fmt: skip
    base = "rad, m and s" if slides else "rad and s"
    caption = f"Problems; {base} in brackets if the paper has other units"
    return table(names, rows, caption).filled


def _limits(problem: Problem, statement: Statement) -> str:
    parts = []
    for name in QUANTITIES:
        if problem.limits.is_uneven(name):
            low, high = (
                both_units(statement, name, x.tolist(), ".6g") for x in problem.limits.ends(name)
            )
            parts.append(f"{name} at least {low}, at most {high}")
            continue
        values = getattr(problem.limits, name)
        alike = len({f"{v:.6g}" for v in values}) == 1
        if not (alike and np.isinf(values[0])):
            alike &= one_unit(statement, name, statement.joints)
            every = values[:1] if alike else values
            parts.append(f"{name} {both_units(statement, name, every, '.6g')}")
    if problem.limits.limits_position:
        parts.append("position")
    return "\n".join(parts) or "none"


def _bounds(problem: Problem) -> str:
    low = list(dict.fromkeys(f"{v:g}" for v in problem.duration_lower))
    high = list(dict.fromkeys(f"{v:g}" for v in problem.duration_upper))
    text = f"at least {', '.join(low)} s" if low != ["0"] else "positive"
    text += f", at most {', '.join(high)} s" if high != ["inf"] else ""
    if problem.shares is not None:
        shares = [f"{s:.4g}" for s in problem.shares]
        equal = len(shares) > _FEW and len(set(shares)) == 1
        shown = f"{len(shares)} times {shares[0]}" if equal else ", ".join(shares)
        text += f"; shares of the total fixed: {shown}"
    return text


# --- findings -------------------------------------------------------------------------------------


def findings(one: CaseAudit) -> Section:
    """Findings by severity; those that say the same under several readings share a row."""
    blocks: list[Block] = []
    for severity in Severity:
        own = [f for f in one.findings if f.severity is severity]
        if not own:
            continue
        title = f"Severity {severity}: {len(own)} finding{'' if len(own) == 1 else 's'}"
        grid = _finding_grid(one.case, own, len(one.study.readings))
        if severity is Severity.INFO:
            blocks.append(Folded(title, (grid,)))
        else:
            blocks += [Prose(title, "heading"), grid]
    return Section("findings", "Every finding, rule by rule", tuple(blocks), folded=True)


def _word(finding: Finding) -> str:
    """The verdict of a finding; a distance that was computed and decides nothing informs."""
    informs = finding.verdict is ClaimVerdict.NOT_CHECKABLE and isinstance(finding.gap, Gap)
    return "information" if informs else str(finding.verdict)


def _finding_grid(case: Case, found: list[Finding], readings: int) -> Grid:
    groups: dict[tuple[object, ...], list[Finding]] = {}
    for f in found:
        key = (f.rule, f.claim, f.problem, f.verdict, f.printed, f.computed, f.message, _gap(f))
        groups.setdefault(key, []).append(f)
    rows = []
    for f, *more in groups.values():
        names = [x.reading for x in (f, *more) if x.reading is not None]
        which = (
            "all"
            if not names or len(set(names)) == readings
            else "; ".join(case.labels[name] for name in dict.fromkeys(names))
        )
        about = f.claim or ""
        where = place(case.claim(about)) if about else ""
        problem = problem_cell(case, f.problem) if f.problem else ""
        under = [where, problem, f"readings: {which}"]
        rows.append(
            (
                Cell(f"{f.rule}\n{_TITLES.get(f.rule, '')}", target=f"word-{f.rule}"),
                Cell(
                    "\n".join(x for x in under if x),
                    target=file_name("claim", about) if about else "",
                ),
                f.printed,
                f.computed,
                _gap(f),
                replace(word(f.verdict), text=f"{_word(f)}\nbasis: {f.basis}"),
                f.message,
            )
        )
    columns = ("rule", "claim", "printed", "computed", "gap", "says", "~finding")
    return table(columns, rows).filled


def _gap(finding: Finding) -> str | None:
    gap = finding.gap
    return None if isinstance(gap, Why) else f"{gap.percent}\n{gap.kind}"


# --- what it rests on -----------------------------------------------------------------------------


def foundations(one: CaseAudit) -> list[Section]:
    """Readings, assumptions, and what cannot be checked."""
    case, default = one.case, one.case.default_reading.id
    readings = tuple(
        (
            f"{case.labels[r.id]}{' (default)' if r.id == default else ''}",
            f"{r.why} Its id: {r.id}",
        )
        for r in case.readings
        if r.id in one.study.readings
    )
    assumed = tuple(
        (
            a.text,
            a.choice,
            "; ".join(dict.fromkeys(_affected(case, one) for one in a.affects)),
        )
        for a in case.assumptions
    )
    lost = tuple((n.where, n.what, n.why) for n in case.not_checkable)
    opened = [
        Folded(f"Left open for {a.name}", (Terms(_numbered(a.open)),))
        for a in case.algorithms
        if a.open
    ]
    choices = (table(("left open", "chosen", "affects"), assumed),) if assumed else ()
    return [
        Section(
            "readings",
            "Readings and why they are admissible",
            (Terms(readings),) if len(readings) > 1 else (),
            folded=True,
        ),
        Section(
            "assumptions",
            "Points that the text leaves open, and the choices made",
            (*choices, *opened),
            folded=True,
        ),
        Section(
            "not-checkable",
            "Not checkable from the text",
            (table(("where", "what", "why"), lost),) if lost else (),
            folded=True,
        ),
    ]


def _affected(case: Case, one: str) -> str:
    """What an assumption affects, as a reader calls it: no id stands for a name."""
    places = {c.id: place(c) for c in case.claims}
    printed = {t.id: t.where for t in case.tables}
    printed |= {t.id: t.where for t in case.columns} | {t.id: t.where for t in case.cartesian}
    names = {a.id: a.name for a in case.algorithms}
    titles = {p.id: p.title or p.id for p in case.problems}
    words = {"waypoints": "way-points", "interpolant": "curve"}
    called: dict[str, str] = {**words, **titles, **printed, **names, **places, **case.labels}
    return called.get(one, one)


def _numbered(lines: Iterable[str]) -> tuple[tuple[str, str], ...]:
    return tuple((str(i), line) for i, line in enumerate(lines, start=1))
