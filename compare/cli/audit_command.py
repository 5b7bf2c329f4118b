"""The command `audit`: every claim judged, and pages with pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from ...nlp import Evidence
from ...problem import Case, published_ids
from .. import audits
from ..audits import Study, in_words
from ..documents import (
    OPTIMA_STEPS,
    OPTIMUM_RETIMED,
    Advice,
    AuditDocument,
    AuditedCase,
    ClaimVerdict,
    Judgement,
    Scope,
    Step,
    Urgency,
    Waterfall,
    Why,
    by_search,
    capital,
    counted,
    facts,
    more_errors,
    qualified,
    reached_cells,
    tally,
    worth_little,
)
from .certifying import read_certificates
from .input import read_cases
from .options import MOST, Crate, NoCache, ProblemId, ReadingId, Workers
from .output import Columns, check_folder, emit, kept_proofs, line, new_output, progress, say
from .result_tables import seconds

AUDIT_FOLDER = Path("trajgap-audit")
"""Where the pages go, unless the command line says otherwise."""


def audit(
    cases: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[CASE|FILE]...",
            help="Ids of published cases, or case files; all published ones by default.",
        ),
    ] = None,
    problem: ProblemId = None,
    reading: ReadingId = None,
    seeds: Annotated[
        int, typer.Option(min=2, max=MOST, help="Number of seeds for each replay.")
    ] = 100,
    workers: Workers = None,
    certify_seconds: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            min=0.0,
            help="Time per case to certify optima that no certificate proves; 0 for none. "
            "By default boxes are counted, so no verdict depends on the machine.",
        ),
    ] = None,
    certificates: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Certificates to use in addition to the shipped ones; each is verified.",
        ),
    ] = None,
    draft: Annotated[
        bool,
        typer.Option(
            "--draft", help="Judge your own draft, and list what to change before you submit it."
        ),
    ] = False,
    no_cache: NoCache = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 if a finding has severity error.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON; write pages only with --out.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Folder for the pages: new, empty, or that of an earlier audit.",
            show_default="trajgap-audit",
        ),
    ] = None,
    crate: Crate = None,
) -> int:
    """Audit every claim of the cases, and write pages with pictures."""
    chosen = read_cases(cases or published_ids())
    for case in chosen:
        study = Study(case, seeds=seeds, problem=problem, reading=reading)
        for algorithm in case.algorithms:
            study.algorithm(algorithm.id)
    given = [] if certificates is None else read_certificates(certificates)
    folder = out if out is not None or as_json else AUDIT_FOLDER
    if folder is not None:
        check_folder(folder, chosen)
    if crate is not None:
        from ..pages import crate_library

        crate_library()
    with new_output(crate, "--crate") as bundle, progress("audit") as step:
        report = audits.audit(
            chosen,
            seeds=seeds,
            workers=workers,
            problem=problem,
            reading=reading,
            progress=step,
            certify_seconds=certify_seconds,
            certificates=given,
            # Where an absolute folder lies is nobody's business.
            certificates_folder=None
            if certificates is None
            else str(certificates.name if certificates.is_absolute() else certificates),
            draft=draft,
            cache=not no_cache,
        )
        if folder is not None:
            from ..pages import write_report

            step("pages and pictures")
            write_report(report, folder)
        if crate is not None:
            from ..pages import crate_of

            step("archive")
            bundle(crate_of(report))
    read = [one.case for one in report.cases]
    emit(report.document, lambda shown: audited(shown, read), as_json)
    if folder is not None and not as_json:
        say(f"pages: {folder / 'index.html'}\n")
    if report.kept and not as_json:
        say(kept_proofs(report.kept))
    return 1 if strict and report.errors else 0


def audited(document: AuditDocument, cases: Sequence[Case]) -> list[RenderableType]:
    """Summary of the `audit` document: for each case the card, claims, causes, where time goes."""
    parts: list[RenderableType] = []
    for case, asked in zip(document.cases, cases, strict=True):
        below = [line(case.case, "dim")] if case.case != case.title else []
        parts += [line(case.title, "bold"), *below, line("")]
        card = case.card
        against = {*card.errors, *([more_errors(card.more)] if card.more else [])}
        parts += [line(said, "bold red" if said in against else "") for said in card.sentences]
        parts.append(line(tally(case.verdicts), "dim"))
        counts = Counter(v.verdict for v in case.verdicts)
        beside = worth_little(case.verdicts)
        worth = {ClaimVerdict.SUPPORTED: f" ({beside})" if beside else ""}
        said = ", ".join(
            f"{counted(word, counts[word])}{worth.get(word, '')}"
            for word in ClaimVerdict
            if counts[word]
        )
        many = "1 claim" if len(case.verdicts) == 1 else f"{len(case.verdicts)} claims"
        parts += [line(""), line(f"{many}: {said or 'none to judge'}")]
        rows = _rows(case)
        if rows:
            parts.append(Columns(("verdict", "readings", "~claim and its place"), rows))
        parts += [line(said, "dim") for said in _unchecked(case)]
        advice = () if isinstance(case.advice, Why) else case.advice
        parts += _advised(advice) if advice else [line(one) for one in _causes(case)]
        parts += [line(""), *_time_goes(case.waterfalls, asked)]
        searches = list(by_search(case.reached).items())
        for title, runs in searches[:_SEARCHES]:
            shown = [(*one[:3], one[5]) for one in map(reached_cells, runs)]
            parts += [
                line(""),
                line(f"How near the paper's algorithms get: {title}"),
                Columns(_RUNS, shown),
            ]
        more = len(searches) - _SEARCHES
        parts += [line(f"{more} more searches are on the pages.", "dim")] if more > 0 else []
        parts += [line(f"{words}: {value}", "dim") for words, value in facts(case)]
    return parts


def _rows(case: AuditedCase) -> list[tuple[str, str, str]]:
    """Verdict, readings and words of each claim; the same words in several places are one row."""
    stated = {one.claim: one for one in case.claims}
    places: dict[tuple[str, str, str], list[str]] = {}
    for v in sorted(case.verdicts, key=lambda v: _ORDER.index(v.verdict)):
        key = (qualified(v.verdict, v.beside), _under(v), stated[v.claim].text)
        places.setdefault(key, []).append(stated[v.claim].where)
    return [
        (verdict, under, f"{text} ({'; '.join(where)})")
        for (verdict, under, text), where in places.items()
    ]


_SEARCHES = 2
"""Searches that a terminal shows, such as that of each joint separately and of all together."""
_RUNS = ("~algorithm", "limits broken", ">median, its gap", ">no answer")
"""Of the columns that a page has, those that fit a terminal."""
_REASONS = 3
"""Reasons that a terminal shows for claims that cannot be checked: enough for a first case, while
those of a long one fill a page."""
_ORDER = (
    ClaimVerdict.REFUTED,
    ClaimVerdict.INCONSISTENT,
    ClaimVerdict.DEPENDS,
    ClaimVerdict.SUPPORTED,
    ClaimVerdict.NOT_CHECKABLE,
)
"""Claims in the table: what speaks against them first."""


def _unchecked(case: AuditedCase) -> list[str]:
    """Why claims cannot be checked, each reason once; beyond the first few the pages have them."""
    places = {one.claim: one.where for one in case.claims}
    reasons: dict[str, list[str]] = {}
    for one in case.verdicts:
        # What only informs stands with the claim on its page: it is not a reason.
        if one.verdict is ClaimVerdict.NOT_CHECKABLE and not one.informs:
            reasons.setdefault(one.sentences[0].rstrip("."), []).append(places[one.claim])
    lines = [
        f"not checkable, {where[0] if len(where) == 1 else f'{len(where)} claims'}: {why}."
        for why, where in list(reasons.items())[:_REASONS]
    ]
    more = len(reasons) - len(lines)
    rest = [f"{more} more reason{'s are' if more > 1 else ' is'} on the pages."] if more else []
    return lines + rest


def _advised(advice: Sequence[Advice]) -> list[RenderableType]:
    """What to change, each with its place; what is found first, then how to fix it."""
    parts: list[RenderableType] = [line(""), line("Before you submit", "bold")]
    for one in advice:
        style = "bold red" if one.urgency is Urgency.CONTRADICTED else ""
        parts += [line(f"{one.urgency}, {one.where}: {one.says}", style), line(f"  → {one.change}")]
    return parts


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


def _time_goes(waterfalls: Sequence[Waterfall], case: Case) -> list[RenderableType]:
    """Where the time goes, for each problem under its first reading."""
    first: dict[str, Waterfall] = {}
    for waterfall in waterfalls:
        first.setdefault(waterfall.problem, waterfall)
    steps = [{step.name: step for step in one.steps} for one in first.values()]
    names = dict.fromkeys(name for one in steps for name in one)
    # The optimum keeps its row: distances are counted from it.
    unknown = {name: whys[0] for name in names if name not in OPTIMA_STEPS
               if (whys := [one[name].time for one in steps if name in one])
               if all(isinstance(why, Why) for why in whys)}  # fmt: skip
    several = len(case.problems) > 1 or len(case.readings) > 1
    parts: list[RenderableType] = []
    for pid, one in first.items():
        rows = [(step.name, *_step(step)) for step in one.steps if step.name not in unknown]
        if rows:
            under = f"; {in_words(case, pid, one.reading)}" if several else ""
            parts.append(line(f"Where the time goes{under}"))
            parts.append(Columns(("step", ">time s", "evidence"), rows))
    notes = dict.fromkeys(said for one in first.values() for said in one.without_optimum)
    notes |= dict.fromkeys(
        f"{capital(name)}: {why}." for name, why in unknown.items() if name != OPTIMUM_RETIMED
    )
    return [*parts, *(line(said, "dim") for said in notes)]


def _step(step: Step) -> tuple[str, str]:
    """Time of a step, and the word for what stands behind it, if any does."""
    return seconds(step.time), "" if step.evidence is Evidence.NONE else str(step.evidence)
