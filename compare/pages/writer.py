"""Writes a report: one self-contained page per case, with Markdown, JSON and pictures beside it."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ...nlp.optimum import KKT_TOLERANCE, SAME_TOTAL, STARTS
from ...problem import LONGEST_NAME, TOLERANCE, Case, CaseError, file_name, read_regular
from ..audits import AuditReport, CaseAudit, package_version
from ..blocks import (
    GLOSSARY,
    Block,
    Cell,
    Folded,
    Page,
    Prose,
    Section,
    Terms,
    card_shown,
    counts_said,
    reference,
    table,
)
from ..documents import AuditDocument, ClaimVerdict, json_text, tally
from ..pictures import themed
from . import motions_shown as report_pictures
from .exhibits import exhibits_of_motion, exhibits_of_search, other_instances
from .folders import check_folder, write_folder
from .glossary import glossary
from .numbers import card_picture, optima, reached_runs, sensitivities, where_time_goes
from .readings import side_by_side
from .rendering import markdown, page_text
from .verdicts import advised, against, findings, folded_claims, foundations, problems_audited

MARK = "audit.json"
"""The file by which the folder of an earlier report is known."""
RESERVED = (Path("index.html").stem, Path(MARK).stem, Path(GLOSSARY).stem)
"""Names of pages of the report itself, which no case can take."""


def write_report(report: AuditReport, out: Path) -> None:
    """Write the pages of an audit into a folder; they all appear together.

    Parameters
    ----------
    report : AuditReport
    out : Path
        A new or an empty folder, or one with an earlier report, which is replaced. It gets
        ``index.html``, ``glossary.html`` and ``audit.json``, and for each case ``CASE.html``,
        ``CASE.md``, ``CASE.json`` and ``pictures/CASE-*.svg``; CASE is its id, or what `file_name`
        makes of it.

    Raises
    ------
    CaseError
        If the folder contains anything else, two cases would share a file, or it cannot be written.
    """
    check_report_folder(Path(out), [one.case for one in report.cases], option="")
    write_folder(Path(out), report_files(report), _foreign, "an audit", option="")


def check_report_folder(out: Path, cases: Sequence[Case] = (), option: str = "--out") -> None:
    """Find out whether a report can be written, before computing what goes into it.

    `cases`: those that it is about. `option`: what names the folder, for messages.
    """
    names = [case.id for case in cases]
    for case in cases:
        taken = "another page" if case.id in RESERVED else "another case"
        if case.id in RESERVED or names.count(case.id) > 1:
            raise CaseError(case.file, "id", f"{case.id!r} is the name of {taken}; rename it")
    check_folder(out, _foreign, "an audit", option)


def _foreign(out: Path, there: list[str]) -> str | None:
    """The first file that no report has written; None if there is none."""
    try:
        # Hundreds of times the largest one shipped.
        mark = json.loads(read_regular(out / MARK, 1_000_000_000, "name another"))
        version, cases = str(mark["schema"]), [str(one["case"]) for one in mark["cases"]]
    except (OSError, ValueError, TypeError, LookupError, RecursionError):
        return there[0]
    if not version.startswith("trajgap/"):
        return MARK
    pages = [file_name(case) for case in cases]
    known = {
        "index.html",
        GLOSSARY,
        MARK,
        *(f"{page}.{end}" for page in pages for end in ("html", "md", "json")),
    }
    drawn = tuple(f"pictures/{f'{case}-'[:LONGEST_NAME]}" for case in cases)
    others = (name for name in there if name not in known)
    return next((n for n in others if not (n.startswith(drawn) and n.endswith(".svg"))), None)


def report_files(report: AuditReport) -> dict[str, str]:
    """Every file of a report, by its path in the folder."""
    document = report.document
    files: dict[str, str] = {}
    for one in report.cases:
        page = case_page(one)
        name = page.file
        files[f"{name}.html"] = page_text(page)
        files[f"{name}.md"] = markdown(page)
        files[f"{name}.json"] = json_text(AuditDocument(cases=(one.document,)))
        for picture in page.pictures:
            files[page.picture(picture)] = themed(picture.document)
    files["index.html"] = page_text(_index(report))
    words = Page("glossary", "How to read a verdict", (glossary(),))
    files[GLOSSARY] = page_text(words)
    files[MARK] = json_text(document)
    return files


def page_files(one: CaseAudit, links: tuple[tuple[str, str], ...]) -> dict[str, str]:
    """The page of a case, its pictures and the glossary, by their paths; the page comes first.

    `links`: words and addresses at the head of the page.
    """
    page = replace(case_page(one), links=links)
    words = replace(Page("glossary", "How to read a verdict", (glossary(),)), links=links[:1])
    pictures = {page.picture(drawn): themed(drawn.document) for drawn in page.pictures}
    return {f"{page.file}.html": page_text(page), GLOSSARY: page_text(words), **pictures}


def _index(report: AuditReport) -> Page:
    """The page that leads to those of the cases: counts of all, and the card of each."""
    rows = []
    for one in report.cases:
        counts = Counter(j.verdict for j in one.judgements)
        name = Cell(one.case.title, target=f"{file_name(one.case.id)}.html")
        every = (counts[verdict] for verdict in ClaimVerdict)
        rows.append((name, len(one.judgements), *every, one.errors))
    columns = ("case", ">claims", *(f">{verdict}" for verdict in ClaimVerdict), ">errors")
    cards = [
        Section(
            file_name("case", one.case.id),
            one.case.title,
            (card_shown(one.card), Prose(counts_said(one.judgements), "note")),
            target=f"{file_name(one.case.id)}.html",
        )
        for one in report.cases
    ]
    return Page(
        "index",
        "Audit of published trajectories",
        (Section("cases", "Verdicts on claims", (table(columns, rows),)), *cards),
        trail=f"trajgap {package_version('trajgap')}",
        links=(("Glossary", GLOSSARY), ("JSON", MARK)),
    )


def case_page(one: CaseAudit) -> Page:
    """Everything that the page of one case says, in order."""
    source, made = one.document.source, one.document.provenance
    shown = card_shown(one.card, tally(one.judgements), card_picture(one))
    audited = f"Audited {made.date} with trajgap {made.trajgap}"
    return Page(
        one.case.id,
        one.case.title,
        (
            Section("card", "Verdict", (shown,)),
            advised(one),
            against(one),
            where_time_goes(one),
            reached_runs(one),
            side_by_side(one),
            _not_computed(one),
            *folded_claims(one),
            problems_audited(one),
            findings(one),
            optima(one),
            sensitivities(one),
            report_pictures.motions(one),
            *exhibits_of_motion(one.study),
            report_pictures.searches(one),
            *exhibits_of_search(one.study),
            *other_instances(one),
            report_pictures.landscapes(one),
            *foundations(one),
            _reproduced(one),
        ),
        trail=f"{reference(source).text} {audited}.",
        doi=source.doi,
    ).filled


def _not_computed(one: CaseAudit) -> Section:
    """Why there are no optima; nothing if there are some."""
    why = one.case.statement().waypoints.not_printed or "none of its readings poses a problem"
    # Where there are several readings, the section above has said why.
    reason = "" if one.readings is not None else f" ({why})"
    said = Prose(
        f"No problem is posed, because way-points are not printed{reason}. The case has no "
        "optima, motions, replays or landscapes of its own."
    )
    return Section("not-computed", "Not computed", () if one.study.has_problems else (said,))


def _reproduced(one: CaseAudit) -> Section:
    made, source = one.document.provenance, one.document.source
    versions = ", ".join(f"{name} {version}" for name, version in made.libraries.items())
    pairs = [
        ("transcribed by", str(source.transcribed_by)),
        ("checked by", str(source.checked_by)),
        ("reproduce with", made.command),
        ("date", made.date),
        ("trajgap", made.trajgap),
        ("commit", str(made.commit)),
        ("case file, SHA-256", str(made.case_sha256)),
        ("libraries", versions),
        ("seeds", f"0 to {made.seeds - 1} for every replay"),
        ("starts", f"{STARTS} starts of every solve, first seed 0"),
        ("tolerances", f"{TOLERANCE:g} relative excess that still keeps a limit; "
         f"{KKT_TOLERANCE:g} KKT residual of an optimum; totals within {SAME_TOTAL:g} count as "
         "the same"),
    ]  # fmt: skip
    proved = tuple((c.file, f"SHA-256 {c.sha256}; about {c.subject}") for c in made.certificates)
    blocks: list[Block] = [Prose(made.citation, "source"), Terms(tuple(pairs))]
    if proved:
        blocks.append(Folded(f"{len(proved)} certificates, verified", (Terms(proved),)))
    title = "Cite and reproduce this audit"
    return Section("reproducibility", title, tuple(blocks), folded=True)
