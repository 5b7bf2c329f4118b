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
    AuditedCase,
    ClaimVerdict,
    Judgement,
    Scope,
    Step,
    Waterfall,
    more_errors,
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
    """Summary of the `audit` document: for each case the card, claims, causes, where time goes."""
    parts: list[RenderableType] = []
    for case in document.cases:
        parts += [line(case.title, "bold"), line(case.case, "dim"), line("")]
        card = case.card
        against = {*card.errors, *([more_errors(card.more)] if card.more else [])}
        parts += [line(said, "bold red" if said in against else "") for said in card.sentences]
        counts = Counter(v.verdict for v in case.verdicts)
        said = ", ".join(f"{counts[word]} {word}" for word in ClaimVerdict if counts[word])
        parts += [line(""), line(f"{len(case.verdicts)} claims: {said or 'none to judge'}")]
        stated = {one.claim: one for one in case.claims}
        rows = [
            (v.verdict, _under(v), f"{stated[v.claim].text} ({stated[v.claim].where})")
            for v in sorted(case.verdicts, key=lambda v: _ORDER.index(v.verdict))
        ]
        if rows:
            parts.append(Columns(("verdict", "readings", "~claim and its place"), rows))
        parts += [line(one) for one in _causes(case)]
        parts += [line(""), *_time_goes(case.waterfalls)]
        parts += [line(f"not certified: {one}", "dim") for one in case.left_out]
    return parts


_ORDER = (
    ClaimVerdict.REFUTED,
    ClaimVerdict.INCONSISTENT,
    ClaimVerdict.DEPENDS,
    ClaimVerdict.SUPPORTED,
    ClaimVerdict.NOT_CHECKABLE,
)
"""Claims in the table: what speaks against them first."""


def _under(judgement: Judgement) -> str:
    """Under how many readings a verdict holds; where it depends on them, how many support it."""
    readings = list(judgement.readings.values())
    if judgement.verdict is ClaimVerdict.DEPENDS:
        return f"supported {readings.count(ClaimVerdict.SUPPORTED)} of {len(readings)}"
    if judgement.scope is not Scope.SOME or not readings:
        return str(judgement.scope)
    return f"{readings.count(judgement.verdict)} of {len(readings)}"


def _causes(case: AuditedCase) -> list[str]:
    """Errors and warnings, one line each with the rule; the pages and --json have the rest."""
    places = {one.claim: one.where for one in case.claims}
    found = []
    for cause in case.causes:
        where = f"{places[cause.claim]}: " if cause.claim else ""
        under = f" [{len(cause.readings)} readings]" if len(cause.readings) > 1 else ""
        first = cause.says.split(". ")[0].rstrip(".")
        found.append(f"{cause.severity} {cause.rule}{under} {where}{first}.")
    return found


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
