"""An audit as an RO-Crate: case files, pages, JSON, certificates and environment in one archive."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterator
from hashlib import sha256
from importlib import import_module
from importlib.metadata import distributions
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ...problem import TrajgapError, file_name
from ...problem.cases import PUBLISHED
from ..audits import AuditReport, CaseAudit, certificate_files
from ..documents import Provenance, Why
from .writer import report_files


def crate_library() -> Any:
    """The class that writes crates."""
    try:
        return import_module("rocrate.rocrate").ROCrate
    except ImportError:
        raise TrajgapError(
            "--crate: needs the library rocrate; install it with `pip install trajgap[crate]`"
        ) from None


def crate_of(report: AuditReport) -> bytes:
    """The archive that holds an audit and all that it was made from.

    A ZIP file, RO-Crate 1.1 or later: the case files as they were read, the pages with their
    pictures, the JSON, every certificate that was used, and the versions of everything that is
    installed.
    """
    crate = crate_library()()
    made = [one.document.provenance for one in report.cases]
    crate.name = f"Audit of {', '.join(one.case.id for one in report.cases)}"
    crate.description = "Published claims about robot trajectories, audited by trajgap"
    crate.datePublished = max(one.date for one in made)
    # The profile of crates that tell which process made which files from which.
    crate.root_dataset["conformsTo"] = {"@id": "https://w3id.org/ro/wfrun/process/0.5"}
    with TemporaryDirectory(prefix="trajgap-") as name:
        folder = Path(name)
        inputs = _add(crate, folder, dict(_cases(report)), "case file")
        inputs += _add(crate, folder, dict(_certificates(report)), "certificate")
        _add(crate, folder, dict(_environment()), "environment")
        pages = {f"report/{path}": text for path, text in report_files(report).items()}
        results = _add(crate, folder, pages, "report")
        _tell(crate, report, made, inputs, results)
        out = folder / "crate.zip"
        crate.write_zip(out)
        return out.read_bytes()


def _add(crate: Any, folder: Path, texts: dict[str, str], what: str) -> list[Any]:
    """Add files to a crate, each with its kind, media type and SHA-256."""
    added = []
    for path, text in texts.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(text.encode())
        formats = {
            ".html": "text/html",
            ".json": "application/json",
            ".md": "text/markdown",
            ".svg": "image/svg+xml",
            ".toml": "application/toml",
            ".txt": "text/plain",
        }
        properties = {
            "name": Path(path).name,
            "description": what,
            "encodingFormat": formats[file.suffix],
            "contentSize": str(len(text.encode())),
            "sha256": sha256(text.encode()).hexdigest(),
        }
        added.append(crate.add_file(file, path, properties=properties))
    return added


def _cases(report: AuditReport) -> Iterator[tuple[str, str]]:
    for one in report.cases:
        case = one.case
        if case.sha256 is None:
            raise TrajgapError(
                f"{case.id}: was not read from a file, but a crate contains case files"
            )
        text, digest = PUBLISHED.hashed(case.file)
        if digest != case.sha256:
            raise TrajgapError(f"{case.file}: has changed since the audit began; audit it again")
        yield f"cases/{file_name(case.id)}.toml", text


def _certificates(report: AuditReport) -> Iterator[tuple[str, str]]:
    """Shipped certificates that were used, those given, and those made by the audit itself."""
    for one in report.cases:
        for file, _ in certificate_files(one.study):
            yield f"certificates/{file.name}", file.read_text(encoding="utf-8")
        for document in one.study.intervals.documents:
            text = json.dumps(document, indent=1) + "\n"
            yield f"certificates/{sha256(text.encode()).hexdigest()[:16]}.json", text


def _environment() -> Iterator[tuple[str, str]]:
    """What the audit ran on, and the version of every installed distribution."""
    pins = sorted({f"{d.metadata['Name']}=={d.version}" for d in distributions()}, key=str.lower)
    yield "environment/requirements.txt", "\n".join(pins) + "\n"
    machine = {
        "python": platform.python_version(),
        "implementation": platform.python_implementation(),
        "system": platform.system(),
        "machine": platform.machine(),
    }
    yield "environment/machine.json", json.dumps(machine, indent=2) + "\n"


def _tell(
    crate: Any, report: AuditReport, made: list[Provenance], inputs: list[Any], results: list[Any]
) -> None:
    """State which software made the report, from what, and which papers it is about."""
    first, ended = made[0], crate.datePublished
    software = {"@id": "#trajgap", "@type": "SoftwareApplication", "name": "trajgap"}
    software["softwareVersion"] = first.trajgap
    if not isinstance(first.commit, Why):
        software["identifier"] = first.commit
    instrument = crate.add_jsonld(software)
    about = [crate.add_jsonld(paper) for paper in map(_paper, report.cases)]
    action = crate.add_jsonld(
        {
            "@id": "#audit",
            "@type": "CreateAction",
            "name": "Audit",
            "description": "; ".join(one.command for one in made),
            "endTime": ended.isoformat() if hasattr(ended, "isoformat") else str(ended),
            "actionStatus": "http://schema.org/CompletedActionStatus",
        }
    )
    action["instrument"], action["object"], action["result"] = instrument, inputs, results
    crate.root_dataset["mentions"] = [action]
    crate.root_dataset["about"] = about
    crate.root_dataset["author"] = crate.add_jsonld(
        {"@id": "#authors", "@type": "Organization", "name": "The trajgap authors"}
    )


def _paper(one: CaseAudit) -> dict[str, Any]:
    """The audited paper, as far as the case file names it."""
    source = one.document.source
    paper: dict[str, Any] = {
        "@id": f"https://doi.org/{source.doi}" if source.doi else f"#paper-{one.case.id}",
        "@type": "ScholarlyArticle",
        "name": source.title or one.case.title,
    }
    if source.authors:
        paper["creditText"] = source.authors
    if source.journal:
        paper["isPartOf"] = source.journal
    if not isinstance(source.year, Why):
        paper["datePublished"] = str(source.year)
    return paper
