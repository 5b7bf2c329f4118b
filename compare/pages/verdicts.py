"""The judging half of a report page: what was audited, the verdicts, and the findings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

from ...nlp import Evidence
from ...problem import QUANTITIES, Case, Coupling, Problem, file_name
from ...problem.cases import (
    AnyClaim,
    ConditionsClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    TotalTimeClaim,
)
from ..audits import CaseAudit, Study, named
from ..audits.rules import placed
from ..documents import (
    RULES,
    UNITS,
    ClaimVerdict,
    Finding,
    Gap,
    Judgement,
    Scope,
    Severity,
    Waterfall,
    Why,
)
from ..pictures import seconds as interval
from .blocks import Block, Cell, Folded, Grid, Prose, Section, Terms, slug, text, word
from .glossary import SCOPES

_DECIDED = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
"""Verdicts that say something of a claim, those against it first."""
_FEW = 4
"""Problems and readings that stand in the open."""
_TITLES = {rule.id: rule.title for rule in RULES}
"""What each rule looks at, by its id."""


def audited(one: CaseAudit) -> Section:
    """What was audited, and the verdict in one paragraph."""
    case, source = one.case, one.case.source
    printed = ", ".join(
        str(p) for p in (source.authors, source.title, source.journal, source.year) if p
    )
    facts = [
        ("source", printed or "not named in the text"),
        ("DOI", source.doi),
        ("note on the text", source.note),
        ("robot", case.robot.name),
        ("joints", ", ".join(case.robot.joints)),
    ]
    blocks: list[Block] = [Prose(summary(one), "lead"), Terms(tuple(f for f in facts if f[1]))]
    posed = _problems(one.study)
    title = f"{len(posed.rows)} problems posed"
    blocks.append(Folded(title, (posed,)) if len(posed.rows) > _FEW else posed)
    return Section("audited", "What was audited", tuple(blocks))


def summary(one: CaseAudit) -> str:
    """The verdict on a case in one paragraph."""
    counts = Counter(j.verdict for j in one.judgements)
    said = ", ".join(f"{counts[v]} {v}" for v in ClaimVerdict if counts[v])
    sentences = [f"{_count(len(one.judgements), 'claim')}: {said or 'none to judge'}."]
    sentences += _against(one)
    sentences += _errors(one)
    sentences += [placed(one.study.instances(block)) for block in one.study.instance_blocks]
    for waterfall in one.waterfalls:
        if waterfall.reading == one.study.main_reading:
            sentences += _down(one, waterfall)
    return " ".join(sentences)


def _count(size: int, noun: str) -> str:
    return f"{size} {noun}{'' if size == 1 else 's'}"


def _against(one: CaseAudit) -> Iterable[str]:
    """What speaks against claims: under every admissible reading, then under some of them."""
    against = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT)
    for verdict in against:
        every = [j.claim for j in one.judgements if j.verdict is verdict and j.scope is Scope.ALL]
        if every:
            yield f"{verdict.capitalize()}: {', '.join(every)}."
    alike: dict[tuple[tuple[str, ClaimVerdict], ...], list[str]] = {}
    for j in one.judgements:
        if j.scope is not Scope.ALL and any(v in against for v in j.readings.values()):
            alike.setdefault(tuple(j.readings.items()), []).append(j.claim)
    for readings, claims in alike.items():
        under: dict[ClaimVerdict, list[str]] = {}
        for reading, verdict in readings:
            under.setdefault(verdict, []).append(reading)
        said = ", ".join(f"{v} under {_which(under[v])}" for v in ClaimVerdict if v in under)
        yield f"Of {len(readings)} readings: {', '.join(claims)} {said}."


def _errors(one: CaseAudit) -> Iterable[str]:
    """Rules whose findings are errors, with the claim; readings count as one."""
    places: dict[str, set[str]] = {}
    for f in one.findings:
        if f.severity is Severity.ERROR:
            place = f"{f.rule} on {f.claim}" if f.claim else f.rule
            places.setdefault(place, set()).update([f.reading] if f.reading else [])
    shown = [
        place + (f" under {len(readings)} readings" if len(readings) > 1 else "")
        for place, readings in places.items()
    ]
    if shown:
        yield f"A proof speaks against something printed: {', '.join(shown)}."


def _which(readings: list[str]) -> str:
    return readings[0] if len(readings) == 1 else str(len(readings))


def _down(one: CaseAudit, waterfall: Waterfall) -> Iterable[str]:
    about = waterfall.problem, waterfall.reading
    solution = one.study.optimum(*about)
    where = f"Under {', '.join(about)}"
    if solution.durations is None:
        yield f"{where}: {solution.status}{f', {solution.why}' if solution.why else ''}."
        return
    yield f"{where}, the {solution.evidence} shortest time of the printed curve family is " + (
        f"{solution.total_time:.6f} s."
    )
    for f in one.findings:
        beside = (f.claim, f.problem, f.reading) == (waterfall.claim, *about)
        if beside and isinstance(f.gap, Gap) and f.rule in ("TG302", "TG303"):
            yield f"The printed {f.printed} has the {f.gap.kind} {f.gap.percent}."
            break
    known = [s for s in waterfall.steps if not isinstance(s.time, Why)]
    if known and known[-1].evidence is not Evidence.NONE:
        last = known[-1]
        shown = f"{interval(last)} ({last.note})"
        yield f"With {last.name} the {last.evidence} shortest time is {shown}."


def _problems(study: Study) -> Grid:
    rows = []
    for pid, rid in study.pairs:
        p = study.problem(pid, rid)
        how = "shared durations" if p.coupling is Coupling.SHARED else "each joint by itself"
        rows.append(
            (
                text(pid),
                text(rid),
                text(f"{len(p.joints)} × {p.waypoints.shape[0]}"),
                text(p.curve.name),
                text(_limits(p)),
                text(_bounds(p)),
                text(how),
            )
        )
    names = (
        "problem",
        "reading",
        "joints × way-points",
        "curve",
        "limits",
        "durations",
        "coupling",
    )
    return Grid(names, tuple(rows), "Problems posed, in radians and seconds")


def _limits(problem: Problem) -> str:
    parts = []
    for name in QUANTITIES:
        values = getattr(problem.limits, name)
        shown = dict.fromkeys(f"{v:.6g}" for v in values)
        if list(shown) != ["inf"]:
            every = list(shown) if len(shown) == 1 else [f"{v:.6g}" for v in values]
            parts.append(f"{name} {', '.join(every)} {UNITS[name]}")
    if problem.limits.limits_position:
        parts.append("position")
    return "\n".join(parts) or "none"


def _bounds(problem: Problem) -> str:
    low = list(dict.fromkeys(f"{v:g}" for v in problem.duration_lower))
    high = list(dict.fromkeys(f"{v:g}" for v in problem.duration_upper))
    text = f"at least {', '.join(low)} s" if low != ["0"] else "positive"
    return text + (f", at most {', '.join(high)} s" if high != ["inf"] else "")


# --- claims ---------------------------------------------------------------------------------------


def claim_table(one: CaseAudit) -> Section:
    """The verdict on every claim, in the order of the case file."""
    rows = []
    for judgement in one.judgements:
        claim = one.case.claim(judgement.claim)
        rows.append(
            (
                Cell(f"{claim_text(claim)}\n[{claim.id}]", anchor=file_name("claim", claim.id)),
                text(claim.where),
                text(printed(one.case, claim)),
                word(judgement.verdict),
                _readings(judgement),
                word(judgement.evidence),
                text(_why(one, judgement)),
            )
        )
    names = ("claim", "where", "printed", "verdict", "readings", "reference", "why")
    readings = f"{_count(len(one.study.readings), 'reading')}: {named(one.study.readings, _FEW)}"
    note = Prose(f"{readings}. Words are explained at the end of the page.", "note")
    return Section(
        "verdicts", "Verdicts on the claims", (note, Grid(names, tuple(rows), prose=True))
    )


def claim_text(claim: AnyClaim) -> str:
    """What a claim says: its own words, or its kind and place."""
    if claim.text:
        return claim.text
    kinds = {"durations": "Segment durations", "maximum": "Longest segment durations"}
    said = kinds.get(claim.quantity, claim.quantity.replace("_", " ").capitalize())
    said += f" of joint {claim.joint}" if claim.joint else ""
    return said + (f", {claim.algorithm}" if claim.algorithm else "") + "."


def printed(case: Case, claim: AnyClaim) -> str:
    """The digits that a claim prints, with their unit."""
    units = case.document.units
    time = f" {units.time}" if units.time else ""
    if isinstance(claim, DurationsClaim | MaximumClaim):
        shown = ", ".join(map(str, claim.durations)) + time
        return shown + (f"; total {claim.total}{time}" if claim.total is not None else "")
    if isinstance(claim, TotalTimeClaim):
        return f"{claim.value}{time}"
    if isinstance(claim, ImprovementClaim):
        parts = [f"{claim.percent} %"] if claim.percent is not None else []
        return "; ".join(parts + ([f"{claim.seconds}{time}"] if claim.seconds is not None else []))
    if isinstance(claim, PeakClaim):
        digits = ", ".join(map(str, claim.printed))
        return f"{digits} {getattr(units, claim.derivative) or ''}".strip()
    if isinstance(claim, ConvergenceClaim):
        return f"{claim.iterations} iterations"
    if isinstance(claim, ConditionsClaim) and claim.count is not None:
        return f"{claim.count} conditions"
    return ""


def _readings(judgement: Judgement) -> Cell:
    """Under how many readings the verdict holds; where they differ, those of each verdict."""
    lines = [str(judgement.scope)]
    if judgement.scope is Scope.SOME:
        under: dict[ClaimVerdict, list[str]] = {}
        for reading, verdict in judgement.readings.items():
            under.setdefault(verdict, []).append(reading)
        lines += [f"{verdict} under {_which(r)}" for verdict, r in under.items()]
    return Cell("\n".join(lines), target=f"word-{slug(SCOPES)}")


def _why(one: CaseAudit, judgement: Judgement) -> str:
    """What decides: findings that say the same in other numbers share a line."""
    lines: dict[tuple[str, ...], list[Finding]] = {}
    for f in one.findings:
        if f.claim == judgement.claim and f.decides and f.verdict in _DECIDED:
            lines.setdefault((f.rule, f.verdict, f.kind), []).append(f)
    if not lines:
        return judgement.why
    shown = []
    for (rule, *_), own in sorted(
        lines.items(), key=lambda line: line[1][0].verdict is not judgement.verdict
    ):
        messages = list(dict.fromkeys(f.message for f in own))
        readings = list(dict.fromkeys(f.reading for f in own if f.reading))
        every = not readings or len(readings) == len(one.study.readings)
        where = "" if every and len(messages) == 1 else f" ({named(readings)})"
        others = _count(len(messages) - 1, "more finding")
        more = f" In other numbers: {others}." if len(messages) > 1 else ""
        shown.append(f"{rule}{where}: {messages[0]}{more}")
    return "\n".join(shown)


# --- findings -------------------------------------------------------------------------------------


def findings(one: CaseAudit) -> Section:
    """Findings by severity; those that say the same under several readings share a row."""
    blocks: list[Block] = []
    for severity in Severity:
        own = [f for f in one.findings if f.severity is severity]
        if not own:
            blocks.append(Prose(f"No finding of severity {severity}."))
            continue
        title = f"Severity {severity}: {_count(len(own), 'finding')}"
        grid = _finding_grid(own, len(one.study.readings))
        if severity is Severity.INFO:
            blocks.append(Folded(title, (grid,)))
        else:
            blocks += [Prose(title, "heading"), grid]
    return Section("findings", "Findings", tuple(blocks))


def _finding_grid(found: list[Finding], readings: int) -> Grid:
    groups: dict[tuple[object, ...], list[Finding]] = {}
    for f in found:
        key = (f.rule, f.claim, f.problem, f.verdict, f.printed, f.computed, f.message, _gap(f))
        groups.setdefault(key, []).append(f)
    rows = []
    for f, *more in groups.values():
        names = [x.reading for x in (f, *more) if x.reading is not None]
        which = "all" if not names or len(set(names)) == readings else ", ".join(names)
        about = f.claim or ""
        under = [about, f.problem or "", f"readings: {which}"]
        rows.append(
            (
                Cell(f"{f.rule}\n{_TITLES.get(f.rule, '')}", target=f"word-{f.rule}"),
                Cell(
                    "\n".join(x for x in under if x),
                    target=file_name("claim", about) if about else "",
                ),
                text(f.printed),
                text(f.computed),
                text(_gap(f)),
                replace(word(f.verdict), text=f"{f.verdict}\nbasis: {f.basis}"),
                text(f.message),
            )
        )
    columns = ("rule", "claim", "printed", "computed", "gap", "says", "finding")
    return Grid(columns, tuple(rows), prose=True).filled


def _gap(finding: Finding) -> str | None:
    gap = finding.gap
    return None if isinstance(gap, Why) else f"{gap.percent}\n{gap.kind}"


# --- what it rests on -----------------------------------------------------------------------------


def foundations(one: CaseAudit) -> list[Section]:
    """Readings, assumptions, and what cannot be checked."""
    case, default = one.case, one.case.default_reading.id
    readings = tuple(
        (r.id + (" (default)" if r.id == default else ""), r.why)
        for r in case.readings
        if r.id in one.study.readings
    )
    assumed = tuple(
        (text(a.id), text(a.text), text(a.choice), text(", ".join(a.affects)))
        for a in case.assumptions
    )
    lost = tuple((text(n.where), text(n.what), text(n.why)) for n in case.not_checkable)
    opened = [
        Folded(f"Left open for {a.name} ({a.kind})", (Terms(_numbered(a.open)),))
        for a in case.algorithms
        if a.open
    ]
    nothing = Prose("None.")
    return [
        Section("readings", "Readings and why they are admissible", (Terms(readings),)),
        Section(
            "assumptions",
            "Assumptions: what the text leaves open, and what was chosen",
            (
                Grid(("name", "left open", "chosen", "affects"), assumed) if assumed else nothing,
                *opened,
            ),
        ),
        Section(
            "not-checkable",
            "Not checkable from the text",
            (Grid(("where", "what", "why"), lost) if lost else nothing,),
        ),
    ]


def _numbered(lines: Iterable[str]) -> tuple[tuple[str, str], ...]:
    return tuple((str(i), line) for i, line in enumerate(lines, start=1))
