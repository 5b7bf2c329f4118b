"""Files that spare later runs a computation: each under the question that it answers.

What a file says counts for nothing by itself. Who reads one proves it, or computes a part of it
again, before it counts.
"""

from __future__ import annotations

import importlib.metadata
import inspect
import json
import os
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import numpy as np

from ...problem import Array, TrajgapError, replace_file
from ...verify import read_document, seal

VARIABLE = "TRAJGAP_CACHE"
"""Environment variable with another folder for what is kept; empty for none."""
MOST_KEPT = 256 * 2**20
"""Bytes of all files together: thousands of usual size. The oldest make way."""
UNREADABLE = (OSError, LookupError, TypeError, ValueError, ArithmeticError, RecursionError)
"""What a file of any content may raise while it is read; `Refused` is a `ValueError`."""
_LIBRARIES = ("casadi", "numba", "numpy", "scipy")
"""What searches compute with: another version may find another answer to the same question."""
AGAIN = 100
"""Searches of which one is made again, and at least one of each group: a hundredth of the work
finds out whether this machine computes what the one that kept them did."""

A = TypeVar("A")


def cache_folder() -> Path | None:
    """The folder where answers are kept; None if the environment says that none are.

    Returns
    -------
    Path or None
        ``kept`` in what `VARIABLE` names, or in the system's usual place for caches.
    """
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) / "kept" if named else None
    from platformdirs import user_cache_path

    return user_cache_path("trajgap", appauthor=False) / "kept"


class KeptFiles:
    """What is kept of one kind.

    Parameters
    ----------
    where : bool or Path
        The folder, made when something is kept; True for `cache_folder`. False keeps nothing and
        knows nothing.
    """

    kind: ClassVar[str]
    """What begins with another kind is none of these files."""

    def __init__(self, where: bool | Path) -> None:
        self._folder = cache_folder() if where is True else (where or None)
        self._format = f"trajgap kept {self.kind} 1"
        self.searches = 0
        """Groups of answers that no file had."""

    @property
    def used(self) -> bool:
        """Whether anything is kept."""
        return self._folder is not None

    def read(self, asked: object) -> dict[str, Any]:
        """What is kept under a question.

        Parameters
        ----------
        asked : object
            JSON-ready. All that the answer depends on, the code included.

        Returns
        -------
        dict
            As it was written, if nobody altered it.

        Raises
        ------
        one of `UNREADABLE`
            If nothing is kept, or what is kept is of another form.
        """
        if self._folder is None:
            raise LookupError("nothing is kept")
        kept = read_document(self._file(asked))
        if type(kept) is not dict or kept.pop("format", None) != self._format:
            raise ValueError(f"no {self._format}")
        return kept

    def write(self, asked: object, content: dict[str, Any]) -> None:
        """Keep something under a question; where that is impossible, nothing happens.

        Parameters
        ----------
        asked : object
            As in `read`.
        content : dict
            JSON-ready, without floats.
        """
        if self._folder is None:
            return
        text = json.dumps({"format": self._format, **content}, separators=(",", ":"))
        # A full disk, a folder that is read-only: the next run takes as long as this one.
        with suppress(OSError, TrajgapError):
            replace_file(self._file(asked), text + "\n")
            self._make_room()

    def answers(
        self,
        question: Callable[[], object],
        count: int,
        compute: Callable[[], Iterable[A]],
        left: Callable[[A], Any],
        judged: Callable[[int, Any], A],
        again: Callable[[int], A] | None,
    ) -> tuple[A, ...]:
        """The answers of some searches: what earlier ones left, or else found now and kept.

        Each answer is judged again and must leave the same. Where that does not prove what a search
        finds, a few of the searches are made again too. One bit that differs discards all of them.

        Parameters
        ----------
        question : callable
            What the answers depend on, as in `read`; not asked for if nothing is kept. It raises
            `TrajgapError` if that cannot be stated.
        count : int
            Number of the searches.
        compute : callable
            Makes all of them.
        left : callable
            An answer as JSON without floats, to the last bit.
        judged : callable
            The answer of a search, by its place and what was left; raises one of `UNREADABLE` if no
            search leaves that.
        again : callable or None
            Makes the search at one place; None where `judged` computes all that an answer is used
            for, and compares.

        Returns
        -------
        tuple
        """

        def searched() -> tuple[A, ...]:
            self.searches += 1
            return tuple(compute())

        if self._folder is None or count == 0:
            return searched()
        try:
            asked = question()
        except TrajgapError:
            return searched()
        try:
            kept = self.read(asked)
            parts = kept["answers"]
            if kept["seal"] != seal([asked, parts]) or len(parts) != count:
                raise ValueError("altered")
            found = tuple(judged(at, part) for at, part in enumerate(parts))
            if [left(one) for one in found] != parts:
                raise ValueError("judged to be another answer")
            rng = np.random.default_rng(int(kept["seal"], 16))
            few = 0 if again is None else -(-count // AGAIN)
            for at in rng.choice(count, few, replace=False).tolist():
                if again is not None and left(again(at)) != parts[at]:
                    raise ValueError("another answer")
        except UNREADABLE:
            found = searched()
            parts = [left(one) for one in found]
            self.write(asked, {"answers": parts, "seal": seal([asked, parts])})
        return found

    def _file(self, asked: object) -> Path:
        assert self._folder is not None
        return self._folder / f"{seal(asked)}.json"

    def _make_room(self) -> None:
        """Remove the oldest files until the rest is small enough."""
        assert self._folder is not None
        files = [(file, file.stat()) for file in self._folder.glob("*.json")]
        total = sum(status.st_size for _, status in files)
        for file, status in sorted(files, key=lambda one: one[1].st_mtime):
            if total <= MOST_KEPT:
                return
            file.unlink(missing_ok=True)
            total -= status.st_size


@cache
def code_hash(*folders: Path) -> str:
    """Hash of all that a search consists of: our files, and versions of what they compute with.

    Parameters
    ----------
    *folders : Path
        Of our code; see `folder_of`.
    """
    hashed = [f"python {'.'.join(map(str, sys.version_info[:3]))}"]
    hashed += [f"{name} {importlib.metadata.version(name)}" for name in _LIBRARIES]
    for folder in folders:
        hashed += [seal(file.read_text("utf-8")) for file in sorted(folder.rglob("*.py"))]
    return seal(hashed)


def folder_of(known: type) -> Path:
    """The folder of the module in which a class is defined."""
    return Path(inspect.getfile(known)).parent


def as_text(values: Array) -> str:
    """An array of one axis as text, to the last bit; `from_text` reads it."""
    return " ".join(map(repr, values.tolist()))


def from_text(text: str) -> Array:
    """The array of `as_text`; raises one of `UNREADABLE` if it is none."""
    return np.array([float(word) for word in text.split(" ")])
