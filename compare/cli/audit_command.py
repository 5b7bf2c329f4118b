"""The command `audit`: every claim judged, and pages with pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...problem import Case, published_ids
from .. import audits, pages
from ..audits import Study, in_words
from ..blocks import Block, Prose, card_shown, counts_said, distances_table, reached_table, table
from ..documents import (
    AGAINST,
    OPTIMA_STEPS,
    OPTIMUM_RETIMED,
    AuditDocument,
    AuditedCase,
    ClaimVerdict,
    Judgement,
    Scope,
    Urgency,
    Waterfall,
    Why,
    by_search,
    capital,
    facts,
    qualified,
    tally,
    value_or_none,
)
from .certifying import read_certificates
from .input import read_cases
from .options import CacheOptions, ExitCode, Options, PartOptions, argument, count, option
from .output import emit, kept_proofs, new_output, progress, say


@dataclass(frozen=True, kw_only=True)
class AuditingOptions(PartOptions):
    """What is audited, and how much is computed for it."""

    cases: list[str] | None = argument("[CASE|FILE]...", None)
    """Ids of published cases, or case files; all published ones by default."""
    seeds: int = count(100, least=2)
    """Number of seeds for each replay."""
    workers: int | None = count(usual="all cores; 1 for short replays")
    """Number of processes for the replays; the result does not depend on it. Starting a process
    takes longer than a hundred short replays."""
    certify_seconds: float | None = option("SECONDS", min=0.0)
    """Time per case to certify optima that no certificate proves; 0 for none. By default boxes are
    counted, so no verdict depends on the machine."""
    certificates: Path | None = option("FOLDER")
    """Certificates to use in addition to the shipped ones; each is verified."""
    draft: bool = option("", False)
    """Judge your own draft, and list what to change before you submit it."""


@dataclass(frozen=True, kw_only=True)
class PageOptions(Options):
    """What comes of it."""

    strict: bool = option("", False)
    """Exit with 1 if a finding has severity error."""
    as_json: bool = option("", False, "--json")
    """Print JSON; write pages only with --out."""
    out: Path | None = option("FOLDER", usual="trajgap-audit")
    """Folder for the pages: new, empty, or that of an earlier audit."""
    crate: Path | None = option("FILE.zip")
    """Also write an RO-Crate for archives to this new file: case files, pages, JSON, certificates
    and environment."""


def audit(asked: AuditingOptions, kept: CacheOptions, to: PageOptions) -> int:
    """Audit every claim of the cases, and write pages with pictures."""
    chosen = read_cases(asked.cases or published_ids())
    names = ("seeds", "problem", "reading")
    part: dict[str, Any] = {name: getattr(asked, name) for name in names}
    for case in chosen:
        study = Study(case, **part)
        for algorithm in case.algorithms:
            study.algorithm(algorithm.id)
    certificates, crate, as_json = asked.certificates, to.crate, to.as_json
    given = [] if certificates is None else read_certificates(certificates)
    folder = to.out if to.out is not None or as_json else Path("trajgap-audit")
    if folder is not None:
        pages.check_report_folder(folder, chosen)
    if crate is not None:
        pages.crate_library()
    with new_output(crate, "--crate") as bundle, progress("audit") as step:
        report = audits.audit(
            chosen,
            **part,
            workers=asked.workers,
            progress=step,
            certify_seconds=asked.certify_seconds,
            certificates=given,
            # Where an absolute folder lies is nobody's business.
            certificates_folder=None
            if certificates is None
            else str(certificates.name if certificates.is_absolute() else certificates),
            draft=asked.draft,
            cache=not kept.no_cache,
        )
        if folder is not None:
            step("pages and pictures")
            pages.write_report(report, folder)
        if crate is not None:
            step("archive")
            bundle(pages.crate_of(report))
    read = [one.case for one in report.cases]
    emit(report.document, lambda shown: audited(shown, read), as_json)
    if folder is not None and not as_json:
        say(f"pages: {folder / 'index.html'}\n")
    if report.kept and not as_json:
        say(kept_proofs(report.kept))
    return ExitCode.AGAINST if to.strict and report.errors else 0


def audited(document: AuditDocument, cases: Sequence[Case]) -> list[Block]:
    """Summary of the `audit` document: for each case the card, claims, causes, where time goes."""
    parts: list[Block] = []
    for case, asked in zip(document.cases, cases, strict=True):
        below = [Prose(case.case, "note")] if case.case != case.title else []
        parts += [Prose(case.title, "heading"), *below, Prose("")]
        parts.append(card_shown(case.card, tally(case.verdicts)))
        parts += [Prose(""), Prose(counts_said(case.verdicts))]
        rows = _rows(case)
        if rows:
            parts.append(table(("verdict", "readings", "~claim and its place"), rows))
        parts += [Prose(said, "note") for said in _unchecked(case)]
        advice = value_or_none(case.advice) or ()
        parts += [Prose(""), Prose("Before you submit", "heading")] if advice else []
        for one in advice:
            style = "against" if one.urgency is Urgency.CONTRADICTED else ""
            parts.append(Prose(f"{one.urgency}, {one.where}: {one.says}", style))
            parts.append(Prose(f"  → {one.change}"))
        parts += [Prose(one) for one in _causes(case)] if not advice else []
        parts += [Prose(""), *_time_goes(case.waterfalls, asked)]
        searches = list(by_search(case.reached).items())
        # Two, such as each joint separately and all together; the pages have all.
        for title, runs in searches[:2]:
            # Columns of a page that do not fit a terminal: best, quartiles, evaluations.
            columns = ("algorithm", "limits broken", "median, its gap", "no answer")
            parts += [
                Prose(""),
                Prose(f"How near the paper's algorithms get: {title}"),
                replace(reached_table(runs).without(3, 4, 6), columns=columns),
            ]
        more = len(searches) - 2
        parts += [Prose(f"{more} more searches are on the pages.", "note")] if more > 0 else []
        parts += [Prose(f"{words}: {value}", "note") for words, value in facts(case)]
    return parts


def _rows(case: AuditedCase) -> list[tuple[str, str, str]]:
    """Verdict, readings and words of each claim; the same words in several places are one row."""
    stated = {one.claim: one for one in case.claims}
    places: dict[tuple[str, str, str], list[str]] = {}
    # What speaks against a claim comes first.
    order = (*AGAINST, ClaimVerdict.SUPPORTED, ClaimVerdict.NOT_CHECKABLE)
    for v in sorted(case.verdicts, key=lambda v: order.index(v.verdict)):
        key = (qualified(v.verdict, v.beside), _under(v), stated[v.claim].text)
        places.setdefault(key, []).append(stated[v.claim].where)
    return [
        (verdict, under, f"{text} ({'; '.join(where)})")
        for (verdict, under, text), where in places.items()
    ]


def _unchecked(case: AuditedCase) -> list[str]:
    """Why claims cannot be checked, each reason once; beyond the first few the pages have them."""
    places = {one.claim: one.where for one in case.claims}
    reasons: dict[str, list[str]] = {}
    for one in case.verdicts:
        # What only informs stands with the claim on its page: it is not a reason.
        if one.verdict is ClaimVerdict.NOT_CHECKABLE and not one.informs:
            reasons.setdefault(one.sentences[0].rstrip("."), []).append(places[one.claim])
    # Reasons that a terminal shows for claims that cannot be checked: enough for a first case,
    # while those of a long one fill a page.
    lines = [
        f"not checkable, {where[0] if len(where) == 1 else f'{len(where)} claims'}: {why}."
        for why, where in list(reasons.items())[:3]
    ]
    more = len(reasons) - len(lines)
    rest = [f"{more} more reason{'s are' if more > 1 else ' is'} on the pages."] if more else []
    return lines + rest


def _under(judgement: Judgement) -> str:
    """Under how many readings a verdict holds; where it depends on them, how many support it."""
    readings = list(judgement.readings.values())
    if judgement.verdict is ClaimVerdict.DEPENDS:
        return f"supported {readings.count(ClaimVerdict.SUPPORTED)} of {len(readings)}"
    if judgement.scope is not Scope.SOME or not readings:
        return str(judgement.scope)
    return f"{readings.count(judgement.verdict)} of {len(readings)}"


def _causes(case: AuditedCase) -> list[str]:
    """Errors and warnings, one paragraph each with the rule; `trajgap explain RULE` explains it."""
    places = {one.claim: one.where for one in case.claims}
    found = []
    every = 1 if isinstance(case.readings, Why) else len(case.readings.admissible)
    for cause in case.causes:
        where = f"{places[cause.claim]}: " if cause.claim else ""
        count = len(cause.readings)
        under = f" [{count} of {every} readings]" if 0 < count < every else ""
        found.append(f"{cause.severity} {cause.rule}{under} {where}{cause.says.rstrip('.')}.")
    return found


def _time_goes(waterfalls: Sequence[Waterfall], case: Case) -> Iterator[Block]:
    """Where the time goes, for each problem under its first reading."""
    first = {one.problem: one for one in reversed(waterfalls)}
    several = len(case.problems) > 1 or len(case.readings) > 1
    notes: dict[str, None] = {}
    for pid in dict.fromkeys(one.problem for one in waterfalls):
        one = first[pid]
        under = f"; {in_words(case, pid, one.reading)}" if several else ""
        grid = distances_table(one, f"Where the time goes{under}", ends=False)
        if grid.rows:
            # Column of what was found how, which has no room on a terminal.
            yield grid.without(4)
        notes |= dict.fromkeys(one.without_optimum)
        notes |= dict.fromkeys(
            f"{capital(step.name)}: {step.time}."
            for step in one.steps
            if isinstance(step.time, Why) and step.name not in (*OPTIMA_STEPS, OPTIMUM_RETIMED)
        )
    yield from (Prose(said, "note") for said in notes)
