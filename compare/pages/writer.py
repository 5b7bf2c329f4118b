"""Writes a report: one self-contained page per case, with Markdown, JSON and pictures beside it."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import Any

from pydantic import BaseModel, Field

from ...nlp.optimum import KKT_TOLERANCE, SAME, STARTS
from ...problem import (
    LONGEST_NAME,
    TOLERANCE,
    TrajgapError,
    file_name,
    read_regular,
    recover_folder,
    replace_folder,
)
from ..audits import AuditReport, CaseAudit, package_version
from ..documents import AuditDocument, ClaimVerdict, Why, json_text, more_errors, tally
from ..pictures import themed
from . import motions_shown as report_pictures
from .blocks import GLOSSARY, Block, CardShown, Folded, Page, Prose, Section, Terms
from .claims import advised, against, folded_claims
from .environment import environment, style
from .exhibits import exhibits_of_motion, exhibits_of_search
from .glossary import glossary
from .instances import other_instances
from .markdown_text import markdown
from .numbers import card_picture, optima, reached_runs, sensitivities, where_time_goes
from .readings import side_by_side
from .verdicts import findings, foundations, problems_audited

MARK = "audit.json"
"""The file by which the folder of an earlier report is known."""
_LARGEST_MARK = 1_000_000_000
"""Bytes that are read to know an earlier report: hundreds of times the largest one shipped."""
_INDEX = "index.html"
"""The page that leads to those of the cases."""
RESERVED = (Path(_INDEX).stem, Path(MARK).stem, Path(GLOSSARY).stem)
"""Names of pages of the report itself, which no case can take."""


class _MarkedCase(BaseModel):
    case: str


class _Mark(BaseModel):
    """What is read of an earlier report, of whatever version."""

    version: str = Field(alias="schema")
    cases: tuple[_MarkedCase, ...]


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
    TrajgapError
        If the folder contains anything else, two cases would share a file, or it cannot be written.
    """
    out = Path(out)
    names = [one.case.id for one in report.cases]
    for name in names:
        if names.count(name) > 1:
            raise TrajgapError(f"{out}: two cases are called {name!r}; give each an id of its own")
        if name in RESERVED:
            raise TrajgapError(f"{out}: a case cannot be called {name!r}; rename it")
    try:
        recover_folder(out)
        other = foreign(out)
        if other is not None:
            raise TrajgapError(
                f"{out}: {other} is not part of a trajgap report; give a new or an empty folder"
            )
        replace_folder(out, report_files(report))
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise TrajgapError(f"{out}: cannot be written ({reason}); give another place") from None


def foreign(out: Path) -> str | None:
    """Name of the first thing in a folder that no report has written; None if there is none."""
    if not os.path.lexists(out):
        return None
    if not out.is_dir() or out.is_symlink():
        return "what is there"
    there = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if not p.is_dir())
    if not there:
        return None
    try:
        mark = _Mark.model_validate_json(read_regular(out / MARK, _LARGEST_MARK, "name another"))
    except (OSError, ValueError):
        return there[0]
    if not mark.version.startswith("trajgap/"):
        return MARK
    cases = [one.case for one in mark.cases]
    pages = [file_name(case) for case in cases]
    known = {
        _INDEX,
        GLOSSARY,
        MARK,
        *(f"{page}.{end}" for page in pages for end in ("html", "md", "json")),
    }
    drawn = tuple(f"pictures/{f'{case}-'[:LONGEST_NAME]}" for case in cases)
    for name in there:
        if name not in known and not (name.startswith(drawn) and name.endswith(".svg")):
            return name
    return None


def report_files(report: AuditReport) -> dict[str, str]:
    """Every file of a report, by its path in the folder."""
    document = report.document
    shapes = environment()
    files: dict[str, str] = {}
    for one in report.cases:
        page = case_page(one)
        name = page.file
        files[f"{name}.html"] = shapes.get_template("case.html").render(page=page, style=style())
        files[f"{name}.md"] = markdown(page)
        files[f"{name}.json"] = json_text(AuditDocument(cases=(one.document,)))
        for picture in page.pictures:
            files[page.picture(picture)] = themed(picture.document)
    index = shapes.get_template(_INDEX)
    files[_INDEX] = index.render(
        rows=[_row(one) for one in report.cases],
        verdicts=[str(v) for v in ClaimVerdict],
        version=package_version("trajgap"),
        style=style(),
    )
    words = Page("glossary", "How to read a verdict", (glossary(),))
    files[GLOSSARY] = shapes.get_template("case.html").render(page=words, style=style())
    files[MARK] = json_text(document)
    return files


def page_text(page: Page) -> str:
    """HTML of one page that stands by itself."""
    return environment().get_template("case.html").render(page=page, style=style())


def _row(one: CaseAudit) -> dict[str, Any]:
    counts = Counter(str(j.verdict) for j in one.judgements)
    return {
        "id": one.case.id,
        "file": file_name(one.case.id),
        "title": one.case.title,
        "card": one.card,
        "claims": len(one.judgements),
        "counts": counts,
        "errors": one.errors,
    }


def case_page(one: CaseAudit) -> Page:
    """Everything that the page of one case says, in order."""
    source, made = one.document.source, one.document.provenance
    printed = ", ".join(
        str(p)
        for p in (source.authors, source.title, source.journal, source.year)
        if p and not isinstance(p, Why)
    )
    audited = f"Audited {made.date} with trajgap {made.trajgap}"
    return Page(
        one.case.id,
        one.case.title,
        (
            _card(one),
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
        trail=f"{printed or 'Source not named in the text'}. {audited}.",
        doi=source.doi,
    ).filled


def _card(one: CaseAudit) -> Section:
    card = one.card
    lines = [card.limits, card.optimum]
    lines += [card.reached] if isinstance(card.reached, str) else []
    lines += [card.improvement] if isinstance(card.improvement, str) else []
    errors = (*card.errors, *([more_errors(card.more)] if card.more else []))
    beside = card.explanation if isinstance(card.explanation, str) else ""
    shown = CardShown(tuple(lines), errors, beside, card_picture(one), tally(one.judgements))
    return Section("card", "Verdict", (shown,))


def _not_computed(one: CaseAudit) -> Section:
    """Why there are no optima; nothing if there are some."""
    if one.study.has_problems:
        return Section("not-computed", "Not computed", ())
    why = one.case.statement().waypoints.not_printed or "none of its readings poses a problem"
    # Where there are several readings, the section above has said why.
    reason = "" if one.readings is not None else f" ({why})"
    said = Prose(
        f"No problem is posed, because way-points are not printed{reason}. The case has no "
        "optima, motions, replays or landscapes of its own."
    )
    return Section("not-computed", "Not computed", (said,))


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
         f"{KKT_TOLERANCE:g} KKT residual of an optimum; totals within {SAME:g} count as the same"),
    ]  # fmt: skip
    proved = tuple((c.file, f"SHA-256 {c.sha256}; about {c.subject}") for c in made.certificates)
    blocks: list[Block] = [Prose(made.citation, "source"), Terms(tuple(pairs))]
    if proved:
        blocks.append(Folded(f"{len(proved)} certificates, verified", (Terms(proved),)))
    title = "Cite and reproduce this audit"
    return Section("reproducibility", title, tuple(blocks), folded=True)
