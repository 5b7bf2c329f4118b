"""Writes a report: one self-contained page per case, with Markdown, JSON and pictures beside it."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections import Counter
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any
from uuid import uuid4

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ...nlp.optimum import KKT_TOLERANCE, SAME, STARTS
from ...problem import TOLERANCE, TrajgapError
from ..audits import AuditReport, CaseAudit, ClaimVerdict
from ..documents import audit_document
from ..pictures import embedded
from . import motions_shown as report_pictures
from .blocks import Page, Prose, Section, Terms, slug
from .exhibits import exhibits_of_motion, exhibits_of_search
from .glossary import glossary
from .instances import families
from .markdown_text import markdown
from .numbers import optima, sensitivities, where_time_goes
from .readings import side_by_side
from .verdicts import audited, claim_table, findings, foundations, summary

MARK = "audit.json"
"""The file by which the folder of an earlier report is known."""
_INDEX = "index.html"
_TEMPLATES = Path(__file__).parent / "templates"
_LIBRARIES = (
    "casadi",
    "jinja2",
    "matplotlib",
    "numba",
    "numpy",
    "pydantic",
    "scipy",
    "toppra",
)


def write_report(report: AuditReport, out: Path) -> None:
    """Write the pages of an audit into a folder; all of them appear together.

    Parameters
    ----------
    report : AuditReport
    out : Path
        A new or an empty folder, or one with an earlier report, which is replaced. It gets
        ``index.html`` and ``audit.json``, and for each case ``CASE.html``, ``CASE.md``,
        ``CASE.json`` and ``pictures/CASE-*.svg``.

    Raises
    ------
    TrajgapError
        If the folder holds anything else, two cases would share a file, or it cannot be written.
    """
    out = Path(out)
    names = [one.case.id for one in report.cases]
    for name in names:
        if names.count(name) > 1:
            raise TrajgapError(f"{out}: two cases are called {name!r}; give each an id of its own")
        if name in (Path(_INDEX).stem, Path(MARK).stem):
            raise TrajgapError(f"{out}: a case cannot be called {name!r}; rename it")
    try:
        other = foreign(out)
        if other is not None:
            raise TrajgapError(
                f"{out}: {other} is not part of a trajgap report; name a new or an empty folder"
            )
        _replace(out, _files(report))
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise TrajgapError(f"{out}: cannot be written ({reason}); name another place") from None


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
        document = json.loads((out / MARK).read_text(encoding="utf-8"))
        cases = [str(one["case"]) for one in document["cases"]]
        if not str(document["schema"]).startswith("trajgap/"):
            return MARK
    except (OSError, ValueError, KeyError, TypeError):
        return there[0]
    known = {_INDEX, MARK, *(f"{c}.{end}" for c in cases for end in ("html", "md", "json"))}
    drawn = tuple(f"pictures/{c}-" for c in cases)
    for name in there:
        if name not in known and not (name.startswith(drawn) and name.endswith(".svg")):
            return name
    return None


def _replace(out: Path, files: dict[str, str]) -> None:
    out.parent.mkdir(parents=True, exist_ok=True)
    draft = out.parent / f".trajgap-{uuid4().hex}.tmp"
    old = draft.with_suffix(".old")
    try:
        for name, content in files.items():
            file = draft / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(content, encoding="utf-8", newline="\n")
        if out.exists():
            out.rename(old)
        try:
            draft.rename(out)
        except OSError:
            if old.exists():
                old.rename(out)
            raise
    finally:
        shutil.rmtree(draft, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


def _files(report: AuditReport) -> dict[str, str]:
    document = audit_document(report)
    style = (_TEMPLATES / "style.css").read_text(encoding="utf-8")
    environment = _environment()
    files: dict[str, str] = {}
    for one, own in zip(report.cases, document["cases"], strict=True):
        page = case_page(one)
        name = page.id
        files[f"{name}.html"] = environment.get_template("case.html").render(page=page, style=style)
        files[f"{name}.md"] = markdown(page)
        files[f"{name}.json"] = _json({"schema": document["schema"], "cases": [own]})
        for picture in page.pictures:
            files[f"pictures/{name}-{picture.name}.svg"] = picture.document
    index = environment.get_template(_INDEX)
    files[_INDEX] = index.render(
        rows=[_row(one) for one in report.cases],
        verdicts=[str(v) for v in ClaimVerdict],
        version=_version("trajgap"),
        style=style,
    )
    files[MARK] = _json(document)
    return files


def _json(document: dict[str, Any]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _row(one: CaseAudit) -> dict[str, Any]:
    counts = Counter(str(j.verdict) for j in one.judgements)
    return {
        "id": one.case.id,
        "title": one.case.title,
        "summary": summary(one),
        "claims": len(one.judgements),
        "counts": counts,
        "errors": one.errors,
    }


def case_page(one: CaseAudit) -> Page:
    """Everything that the page of one case says, in order.

    Parameters
    ----------
    one : CaseAudit

    Returns
    -------
    Page
    """
    return Page(
        one.case.id,
        one.case.title,
        (
            audited(one),
            claim_table(one),
            side_by_side(one),
            where_time_goes(one),
            *families(one),
            findings(one),
            optima(one),
            sensitivities(one),
            report_pictures.motions(one),
            *exhibits_of_motion(one.study),
            report_pictures.searches(one),
            *exhibits_of_search(one.study),
            report_pictures.landscapes(one),
            _not_computed(one),
            *foundations(one),
            glossary(),
            _reproduced(one),
        ),
    ).filled


def _not_computed(one: CaseAudit) -> Section:
    """Why there are no optima; nothing where there are some."""
    if one.study.posed:
        return Section("not-computed", "Not computed", ())
    why = one.case.statement().waypoints.not_printed or "none of its readings poses a problem"
    said = Prose(
        f"No problem is posed: way-points are not printed ({why}). Optima, motions, replays and "
        "landscapes appear here as soon as the case file has way-points."
    )
    return Section("not-computed", "Not computed", (said,))


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _reproduced(one: CaseAudit) -> Section:
    python = ".".join(str(x) for x in sys.version_info[:3])
    libraries = ", ".join(f"{name} {_version(name)}" for name in _LIBRARIES)
    pairs = (
        ("trajgap", _version("trajgap")),
        ("libraries", f"Python {python}, {libraries}"),
        ("seeds", f"0 to {one.study.seeds - 1} for every replay"),
        ("starts", f"{STARTS} starts of every solve, first seed 0"),
        ("tolerances", f"{TOLERANCE:g} relative excess that still keeps a limit; "
         f"{KKT_TOLERANCE:g} KKT residual of an optimum; totals within {SAME:g} count as the same"),
    )  # fmt: skip
    return Section("reproducibility", "To compute this again", (Terms(pairs),))


def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["slug"] = slug
    environment.filters["inline"] = lambda drawn: Markup(
        embedded(drawn.document, slug(drawn.name).lower())
    )
    environment.filters["unescaped"] = Markup
    return environment
