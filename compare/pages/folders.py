"""Folders that are written as a whole, in the place of an earlier one alone."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from ...problem import CaseError, recover_folder, replace_folder, try_writing_in

Foreign = Callable[[Path, list[str]], str | None]
"""Of the files in a folder, by their paths, the first one that no earlier one has written."""


def check_folder(out: Path, foreign: Foreign, what: str, option: str = "--out") -> None:
    """Find out whether a folder can be written, before computing what goes into it.

    `what`: what the folder is to be, such as "a bench". `option`: what names it, for messages.
    """
    with _writing(out, option):
        recover_folder(out)
        if os.path.lexists(out) and (not out.is_dir() or out.is_symlink()):
            raise CaseError(str(out), option, "is not a folder; give a new or an empty one")
        there = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if not p.is_dir())
        found = foreign(out, there) if there else None
        if found is not None:
            raise CaseError(
                str(out),
                option,
                f"contains {found}, which is not {what}; give a new or an empty folder",
            )
        if out.name in ("", "..") or out.is_mount():
            raise CaseError(str(out), option, "cannot be replaced as a whole; give a folder in it")
        out.parent.mkdir(parents=True, exist_ok=True)
        try_writing_in(out.parent)


def write_folder(
    out: Path, files: Mapping[str, str], foreign: Foreign, what: str, option: str = "--out"
) -> None:
    """Write a folder at once and complete; parameters and errors as of `check_folder`."""
    check_folder(out, foreign, what, option)
    with _writing(out, option):
        replace_folder(out, files)


@contextmanager
def _writing(out: Path, option: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise CaseError(str(out), option, unwritable(error, "give another place")) from None


def unwritable(error: OSError, advice: str = "give a writable place") -> str:
    """What a message says of a place that the system refuses to write to."""
    return f"cannot be written ({error.strerror or type(error).__name__}); {advice}"
