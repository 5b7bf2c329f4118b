"""What an audit was made of, so that it can be cited and made again."""

from __future__ import annotations

from ...verify import Subject
from .entry import Count, Entry, OrWhy


class UsedCertificate(Entry):
    """A certificate that the audit proved again and rests on."""

    file: str
    """Name of the file."""
    sha256: str
    """Of the file."""
    subject: Subject
    """Curves that it speaks about."""


class Provenance(Entry):
    """Date, versions, hashes and the command that makes the audit again."""

    date: str
    """Day of the audit in UTC, such as "2026-01-31"; that of SOURCE_DATE_EPOCH where it is set."""
    trajgap: str
    """Version."""
    commit: OrWhy[str]
    """Of the git checkout that it ran from; ends with "+changes" where files differ from it."""
    libraries: dict[str, str]
    """Versions of Python and of the libraries that can move a digit or a pixel."""
    seeds: Count
    """Seeds of each replay, from 0 on."""
    case_sha256: OrWhy[str]
    """Of the case file."""
    certificates: tuple[UsedCertificate, ...]
    command: str
    """What makes the audit again."""
    citation: str
    """BibTeX entry for this audit."""
