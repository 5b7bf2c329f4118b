"""What an audit was made of: date, versions, hashes, and the command that makes it again."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, date, datetime
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ...nlp import ExactProblem, printed_problem_or_none, proved, shipped_file
from ...problem import Coupling, TrajgapError
from ...verify import Subject
from ..documents import Provenance, UsedCertificate, Why, known
from .study import Study

LIBRARIES = ("casadi", "jinja2", "matplotlib", "numba", "numpy", "pydantic", "scipy", "toppra")
"""Libraries whose versions can move a digit or a pixel."""
_EPOCH = "SOURCE_DATE_EPOCH"
"""Variable of the environment that sets the date, by the convention of reproducible builds."""


def provenance(study: Study, day: date | None = None) -> Provenance:
    """Everything that is needed to cite an audit and to make it again."""
    day = day or today()
    own = package_version("trajgap")
    python = ".".join(str(x) for x in sys.version_info[:3])
    case = study.case
    return Provenance(
        date=day.isoformat(),
        trajgap=own,
        commit=commit(),
        libraries={"python": python, **{name: package_version(name) for name in LIBRARIES}},
        seeds=study.options.seeds,
        case_sha256=known(case.sha256, "the case was not read from a file"),
        certificates=tuple(
            UsedCertificate(
                file=file.name, sha256=sha256(file.read_bytes()).hexdigest(), subject=subject
            )
            for file, subject in certificate_files(study)
        ),
        command=_command(study),
        citation=_citation(study, day, own),
    )


def today() -> date:
    """The day in UTC, or that of SOURCE_DATE_EPOCH.

    Raises
    ------
    TrajgapError
        If SOURCE_DATE_EPOCH is not a number of seconds.
    """
    epoch = os.environ.get(_EPOCH)
    if not epoch:
        return datetime.now(UTC).date()
    try:
        return datetime.fromtimestamp(int(epoch), UTC).date()
    except (ValueError, OverflowError, OSError):
        raise TrajgapError(
            f"{_EPOCH}: {epoch!r} is not a time; give seconds since 1970, or unset it"
        ) from None


def package_version(package: str) -> str:
    """Version of an installed package, or that it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


@cache
def commit() -> str | Why:
    """Commit of the git checkout that the code runs from, or why it is not known."""
    folder = Path(__file__).resolve().parent
    try:
        # A file that git does not track lies in somebody else's checkout.
        _git(folder, "ls-files", "--error-unmatch", Path(__file__).name)
        changed = _git(folder, "status", "--porcelain", "--untracked-files=no", ":/")
        return _git(folder, "rev-parse", "HEAD") + ("+changes" if changed else "")
    except (OSError, subprocess.SubprocessError):
        return Why("not run from a git checkout")


def _git(folder: Path, *arguments: str) -> str:
    # Git needs a hundredth of this time to name the commit.
    done = subprocess.run(
        ("git", "-C", str(folder), *arguments),
        capture_output=True,
        text=True,
        check=True,
        timeout=5,
    )
    return done.stdout.strip()


def certificate_files(study: Study) -> Iterator[tuple[Path, Subject]]:
    """Shipped certificates that an audit rests on, and the curves that each speaks about."""
    seen: set[Path] = set()
    for exact, subject in _questions(study):
        file = shipped_file(exact, subject)
        if file is None or file in seen or proved(exact, subject) is None:
            continue
        seen.add(file)
        yield file, subject


def _questions(study: Study) -> Iterator[tuple[ExactProblem, Subject]]:
    """Exact problems whose certificates an audit looks for."""
    for pair in study.pairs:
        statement, problem = study.case.statement(*pair), study.problem(pair)
        joints: list[int | None] = [None]
        if problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1:
            joints += range(len(problem.joints))
        for joint in joints:
            exact = printed_problem_or_none(statement, joint)
            if exact is not None:
                yield exact, Subject.DECLARED
                if joint is None:
                    yield exact, Subject.ANY


def _command(study: Study) -> str:
    case = study.case
    name = case.id if case.file == case.id else Path(case.file).name
    own = study.options
    words = ["trajgap", "audit", name, "--seeds", str(own.seeds)]
    for option, value in (
        ("--problem", own.problem),
        ("--reading", own.reading),
        ("--certificates", own.certificates_folder),
    ):
        words += [] if value is None else [option, value]
    return shlex.join(words)


def _citation(study: Study, day: date, own: str) -> str:
    case = study.case
    digest = f", case file SHA-256 {case.sha256}" if case.sha256 else ""
    title = case.title.translate(_BRACES)
    return (
        f"@misc{{trajgap-{case.id},\n"
        "  author = {{The trajgap authors}},\n"
        f"  title = {{Audit of: {title}}},\n"
        f"  year = {{{day.year}}},\n"
        f"  note = {{trajgap {own}, {day.isoformat()}{digest}}},\n"
        "}"
    )


_BRACES = str.maketrans({"{": "(", "}": ")", "\\": "/"})
"""What would end or steer an entry of BibTeX."""
