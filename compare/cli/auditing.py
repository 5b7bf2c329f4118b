"""The command `audit`: every claim judged, and pages with pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.console import RenderableType

from ...nlp import Evidence
from ...problem import published_ids
from ..audits import Study
from ..documents import (
    AuditDocument,
    Finding,
    Judgement,
    Scope,
    Severity,
    Step,
    Waterfall,
    Why,
)
from .certifying import read_certificates
from .input import read_cases
from .output import check_folder, emit, progress, say
from .result_tables import seconds
from .table import Columns, line

AUDIT_FOLDER = Path("trajgap-audit")
"""Where the pages go, unless the command line says otherwise."""


def audit_cases(
    sources: Sequence[str],
    problem: str | None,
    reading: str | None,
    seeds: int,
    workers: int,
    certify_seconds: float,
    certificates: Path | None,
    strict: bool,
    as_json: bool,
    out: Path | None,
) -> int:
    """Audit cases; all of them are read before anything is computed."""
    chosen = read_cases(sources or published_ids())
    for case in chosen:
        study = Study(case, seeds=seeds, problem=problem, reading=reading)
        for algorithm in case.algorithms:
            study.algorithm(algorithm.id)
    given = [] if certificates is None else read_certificates(certificates)
    folder = out if out is not None or as_json else AUDIT_FOLDER
    if folder is not None:
        check_folder(folder, chosen)
    from ..audits import audit

    with progress("audit") as step:
        report = audit(
            chosen,
            seeds=seeds,
            workers=workers,
            problem=problem,
            reading=reading,
            progress=step,
            certify_seconds=certify_seconds,
            certificates=given,
        )
        if folder is not None:
            from ..pages import write_report

            step("pages and pictures")
            write_report(report, folder)
    emit(report.document, audited, as_json)
    if folder is not None and not as_json:
        say(f"pages: {folder / 'index.html'}\n")
    return 1 if strict and report.errors else 0


def audited(document: AuditDocument) -> list[RenderableType]:
    """Summary of the `audit` document."""
    parts: list[RenderableType] = []
    for case in document.cases:
        counts = Counter(v.verdict for v in case.verdicts)
        said = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
        parts.append(line(f"{case.case}: {len(case.verdicts)} claims; {said}", "bold"))
        rows = [(v.claim, v.verdict, _under(v), v.evidence, v.why) for v in case.verdicts]
        parts.append(Columns(("claim", "verdict", "readings", "reference", "…why"), rows))
        parts += _time_goes(case.waterfalls)
        if not isinstance(case.readings, Why):
            parts += [line(one) for one in (*case.readings.answers, "")]
        parts += [line(said) for said in _said_once(case.findings, Severity.ERROR)]
        warned = _places(case.findings, Severity.WARNING)
        parts += [line(f"warnings: {', '.join(warned)}", "dim")] if warned else []
        parts += [line(f"not certified: {one}", "dim") for one in case.left_out]
        parts.append(line(""))
    return parts


def _under(judgement: Judgement) -> str:
    """Under how many readings a verdict holds."""
    readings = list(judgement.readings.values())
    if judgement.scope is not Scope.SOME or not readings:
        return str(judgement.scope)
    return f"{readings.count(judgement.verdict)} of {len(readings)}"


def _said_once(findings: Sequence[Finding], severity: Severity) -> list[str]:
    """Findings that say the same in other numbers as one line, with the number of readings."""
    groups: dict[tuple[str, ...], list[Finding]] = {}
    for f in findings:
        if f.severity is severity:
            groups.setdefault((f.rule, f.claim or "", f.verdict, f.kind), []).append(f)
    lines = []
    for (rule, claim, *_), own in groups.items():
        where = f"{severity} {rule} {claim}".rstrip()
        readings = list(dict.fromkeys(f.reading for f in own if f.reading))
        messages = list(dict.fromkeys(f.message for f in own))
        if len(readings) < 2:
            lines += [f"{where}: {message}" for message in messages]
            continue
        shown = "" if len(messages) == 1 else f"; as follows under {readings[0]}"
        lines.append(f"{where} ({len(readings)} readings{shown}): {messages[0]}")
    return lines


def _places(findings: Sequence[Finding], severity: Severity) -> list[str]:
    """Rule and claim of the findings, with the number of readings."""
    groups: dict[str, set[str]] = {}
    for f in findings:
        if f.severity is severity:
            where = f"{f.rule} {f.claim or ''}".rstrip()
            groups.setdefault(where, set()).update([f.reading] if f.reading else [])
    return [
        where + (f" ({len(readings)} readings)" if len(readings) > 1 else "")
        for where, readings in groups.items()
    ]


def _time_goes(waterfalls: Sequence[Waterfall]) -> list[RenderableType]:
    """Where the time goes, for each problem under its first reading."""
    first: dict[str, Waterfall] = {}
    for waterfall in waterfalls:
        first.setdefault(waterfall.problem, waterfall)
    steps = [{step.name: step for step in one.steps} for one in first.values()]
    names = dict.fromkeys(name for one in steps for name in one)
    if not names:
        return []
    rows = [(name, *(cell for one in steps for cell in _step(one.get(name)))) for name in names]
    columns = [column for problem in first for column in (f">{problem}", "evidence")]
    return [Columns((f"where the time goes, s ({waterfalls[0].reading})", *columns), rows)]


def _step(step: Step | None) -> tuple[str, str]:
    """Time of a step, and the word for what stands behind it, if any does."""
    if step is None:
        return "", ""
    return seconds(step.time), "" if step.evidence is Evidence.NONE else str(step.evidence)
