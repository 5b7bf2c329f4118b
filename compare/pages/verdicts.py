"""Claims on a report page, causes, findings, and what all of it was made from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby

import numpy as np

from ...problem import BRAKING, Case, Coupling, Problem, file_name
from ...problem.cases import Statement
from ..audits import RULES, CaseAudit, Study, claim_text, place, plainly
from ..blocks import (
    Block,
    Cell,
    Folded,
    Grid,
    Prose,
    Section,
    Terms,
    claims_shown,
    names,
    slug,
    table,
    word,
)
from ..documents import (
    AGAINST,
    Cause,
    ClaimVerdict,
    Finding,
    Gap,
    Severity,
    Urgency,
    Why,
    facts,
    opened,
    worth_little,
)
from .numbers import asked_cells, both_units, one_unit, problem_cell


def against(one: CaseAudit, words: int = 30) -> Section:
    """Claims that are refuted, contradicted or depend on the reading, and what lies behind.

    `words`: of a reason that stand in the open; what goes beyond is a fold away.
    """
    chosen = [j for verdict in AGAINST for j in one.judgements if j.verdict is verdict]
    blocks: list[Block] = [*claims_shown(one.document, chosen, words=words)]
    causes = [c for c in one.causes if not _covered(one, c)]
    if causes:
        behind = [block for cause in causes for block in _behind(one, cause, words)]
        blocks += [Prose("The causes", "heading"), *behind]
    title = "Evidence against printed statements"
    if chosen:
        title = "Claims refuted, contradicted or dependent on the reading"
    return Section("against", title, tuple(blocks))


def folded_claims(one: CaseAudit, words: int = 30) -> Iterator[Section]:
    """Supported claims, then those that cannot be checked, each behind a fold; `words` as there."""
    for verdict in (ClaimVerdict.SUPPORTED, ClaimVerdict.NOT_CHECKABLE):
        own = [j for j in one.judgements if j.verdict is verdict]
        beside = worth_little(own)
        title = f"{len(own)} claim{'' if len(own) == 1 else 's'} {verdict}"
        title += f": {beside}" if beside else ""
        found = tuple(claims_shown(one.document, own, words=words))
        yield Section(f"claims-{slug(verdict)}", title, found, folded=True)


def _covered(one: CaseAudit, cause: Cause) -> bool:
    """Whether a claim above says all of a warning: nothing rests on it, nothing explains it."""
    if cause.severity is Severity.ERROR or cause.explanations or cause.consequences:
        return False
    return any(j.claim == cause.claim and j.verdict in AGAINST for j in one.judgements)


def _behind(one: CaseAudit, cause: Cause, words: int) -> Iterator[Block]:
    """One cause, what would explain it, and the claims that fall with it."""
    says, _ = opened(plainly(one.case, cause, names(one.document).implausible), words)
    yield Prose(" ".join(says), word=cause.severity)
    # The one reading of a cause stands in front of it already.
    known = len(cause.readings) == 1
    alike = groupby(cause.explanations, lambda e: (known and e.in_any) or e.effect)
    changes = [f"{' Or: '.join(e.change for e in each)} {effect}" for effect, each in alike]
    shown = tuple(Prose(change, "beside") for change in changes)
    yield from shown[:1]
    if shown[1:]:
        yield Folded("Other changes that would explain it", shown[1:])
    hit = dict.fromkeys(c.claim for c in cause.consequences if c.claim and c.claim != cause.claim)
    if hit:
        claims = map(one.case.claim, hit)
        rows = [
            (Cell(claim_text(one.case, c), target=file_name("claim", c.id)), place(c))
            for c in claims
        ]
        title = f"{len(hit)} more claim{'' if len(hit) == 1 else 's'} affected"
        yield Folded(title, (table(("claim", "place"), rows),))


def advised(one: CaseAudit) -> Section:
    """What contradicts itself or is doubtful stands open, what is left open behind a fold."""
    columns = ("", "where", "what was found", "~what to change")
    pressing, left_open = (
        table(
            columns,
            [
                (word(a.urgency), a.where, a.says, a.change)
                for a in one.advice
                if (a.urgency is Urgency.OPEN) == later
            ],
        )
        for later in (False, True)
    )
    blocks: list[Block] = [pressing] if pressing.rows else []
    if left_open.rows:
        title = f"{len(left_open.rows)} points that readers cannot check"
        blocks.append(Folded(title, (left_open,)))
    return Section("before-you-submit", "Before you submit", tuple(blocks))


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
        size = f"{len(p.joints)} × {p.waypoints.shape[0]}"
        limits = _limits(p, study.case.statement(*pair))
        rows.append((*asked_cells(study, pair), size, p.curve.name, limits, _bounds(p), how))
    columns = ("problem", "reading", "joints × way-points", "curve", "limits", "durations",
             "coupling")  # fmt: skip
    base = "rad, m and s" if slides else "rad and s"
    caption = f"Problems; {base} in brackets if the paper has other units"
    return table(columns, rows, caption).filled


def _limits(problem: Problem, statement: Statement) -> str:
    parts = []
    for name in problem.limits.quantities:
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
    if problem.limits.braking.any():
        said = both_units(statement, BRAKING, problem.limits.deceleration.tolist(), ".6g")
        parts.append(f"{BRAKING} {said}")
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
        # Up to ten equal shares are shown one by one.
        equal = len(shares) > 10 and len(set(shares)) == 1
        shown = f"{len(shares)} times {shares[0]}" if equal else ", ".join(shares)
        text += f"; shares of the total fixed: {shown}"
    return text


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


def _finding_grid(case: Case, found: list[Finding], readings: int) -> Grid:
    groups: dict[tuple[object, ...], list[Finding]] = {}
    for f in found:
        key = (f.rule, f.claim, f.problem, f.verdict, f.printed, f.computed, f.message, _gap(f))
        groups.setdefault(key, []).append(f)
    titles, rows = {rule.id: rule.title for rule in RULES}, []
    for f, *more in groups.values():
        under = dict.fromkeys(x.reading for x in (f, *more) if x.reading is not None)
        which = "all"
        if 0 < len(under) < readings:
            which = "; ".join(case.labels[name] for name in under)
        where = place(case.claim(f.claim)) if f.claim else ""
        problem = problem_cell(case, f.problem) if f.problem else ""
        known = "\n".join(x for x in (where, problem, f"readings: {which}") if x)
        # A distance that was computed and decides nothing informs.
        informs = f.verdict is ClaimVerdict.NOT_CHECKABLE and isinstance(f.gap, Gap)
        said = "information" if informs else str(f.verdict)
        rows.append(
            (
                Cell(f"{f.rule}\n{titles.get(f.rule, '')}", target=f"word-{f.rule}"),
                Cell(known, target=file_name("claim", f.claim) if f.claim else ""),
                f.printed,
                f.computed,
                _gap(f),
                replace(word(f.verdict), text=f"{said}\nbasis: {f.basis}"),
                f.message,
            )
        )
    columns = ("rule", "claim", "printed", "computed", "gap", "says", "~finding")
    return table(columns, rows).filled


def _gap(finding: Finding) -> str | None:
    gap = finding.gap
    return None if isinstance(gap, Why) else f"{gap.percent}\n{gap.kind}"


def foundations(one: CaseAudit) -> list[Section]:
    """Readings, assumptions, and what cannot be checked."""
    case, default = one.case, one.case.default_reading.id
    readings = tuple(
        (f"{case.labels[r.id]}{' (default)' if r.id == default else ''}", f"{r.why} Its id: {r.id}")
        for r in case.readings
        if r.id in one.study.readings
    )
    assumed = [
        (a.text, a.choice, "; ".join(dict.fromkeys(_affected(case, x) for x in a.affects)))
        for a in case.assumptions
    ]
    lost = [(n.where, n.what, n.why) for n in case.not_checkable]
    choices: list[Block] = [table(("left open", "chosen", "affects"), assumed)] if assumed else []
    for a in case.algorithms:
        if a.open:
            points = tuple((str(i), line) for i, line in enumerate(a.open, start=1))
            choices.append(Folded(f"Left open for {a.name}", (Terms(points),)))
    shown = (Terms(readings),) if len(readings) > 1 else ()
    unread = (table(("where", "what", "why"), lost),) if lost else ()
    parts: tuple[tuple[str, str, tuple[Block, ...]], ...] = (
        ("readings", "Readings and why they are admissible", shown),
        ("assumptions", "Points that the text leaves open, and the choices made", tuple(choices)),
        ("not-checkable", "Not checkable from the text", unread),
    )
    return [Section(*part, folded=True) for part in parts]


def _affected(case: Case, one: str) -> str:
    """What an assumption affects, as a reader calls it: no id stands for a name."""
    places = {c.id: place(c) for c in case.claims}
    printed = {t.id: t.where for t in case.tables}
    printed |= {t.id: t.where for t in case.columns} | {t.id: t.where for t in case.cartesian}
    algorithms = {a.id: a.name for a in case.algorithms}
    titles = {p.id: p.title or p.id for p in case.problems}
    words = {"waypoints": "way-points", "interpolant": "curve"}
    called: dict[str, str] = {**words, **titles, **printed, **algorithms, **places, **case.labels}
    return called.get(one, one)
