"""The store of a study: one SQLite file, in which a finished run is durable the moment it ends."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Self

from ...problem import CaseError, TrajgapError, check_regular
from .rows import ROW_FORMAT, Bracket, Row, RowStatus

_APPLICATION = int.from_bytes(b"trgj", "big")
"""SQLite's application id of our stores: a database of somebody else is not touched."""
_TABLES = """
CREATE TABLE runs (
    key TEXT PRIMARY KEY, status TEXT NOT NULL, row TEXT NOT NULL, seconds REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE optima (
    problem TEXT PRIMARY KEY, upper REAL, lower REAL
) WITHOUT ROWID;
CREATE TABLE notes (name TEXT PRIMARY KEY, text TEXT NOT NULL) WITHOUT ROWID;
"""
"""Seconds stand beside the row and not in it: they differ from run to run."""


class Store:
    """Rows of finished runs by the key of their trial, in a file that is created if need be.

    Several processes may use one store. A row is on disk before `put` returns, and never changes
    after that: the first row stays. A CaseError says that the file is not a store, is one of
    another version, or cannot be read or written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        check_regular(path)
        with self._telling():
            # Every statement is its own transaction, unless `_writing` says otherwise. It waits for
            # other processes, whose rows take milliseconds each.
            self._data = sqlite3.connect(path, timeout=60.0, isolation_level=None)
        try:
            with self._telling():
                self._prepare()
        except BaseException:
            self._data.close()
            raise

    def _prepare(self) -> None:
        (found,) = self._data.execute("PRAGMA application_id").fetchone()
        (tables,) = self._data.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if found not in (0, _APPLICATION) or (found == 0 and tables):
            raise CaseError(str(self.path), "", "is a database of another program; give a new file")
        self._data.execute("PRAGMA journal_mode = WAL")
        self._data.execute("PRAGMA synchronous = FULL")
        with self._writing():
            (version,) = self._data.execute("PRAGMA user_version").fetchone()
            if version == 0:
                for statement in filter(str.strip, _TABLES.split(";")):
                    self._data.execute(statement)
                self._data.execute(f"PRAGMA application_id = {_APPLICATION}")
                self._data.execute(f"PRAGMA user_version = {ROW_FORMAT}")
            elif version != ROW_FORMAT:
                raise CaseError(
                    str(self.path),
                    "",
                    f"contains rows of version {version}, but this program writes {ROW_FORMAT}; "
                    "give a new file",
                )

    @contextmanager
    def _writing(self) -> Iterator[None]:
        self._data.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            self._data.execute("ROLLBACK")
            raise
        self._data.execute("COMMIT")

    @contextmanager
    def _telling(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            name = str(self.path)
            if error.sqlite_errorcode == sqlite3.SQLITE_NOTADB:
                fix = "is not a store of trajgap; give a new file"
            elif self.path.parent.is_dir():
                fix = f"cannot be used ({error}); check the disk, or give another file"
            else:
                fix = f"cannot be created ({error}); create its folder first"
            raise CaseError(name, "", fix) from None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._data.close()

    def put(self, row: Row, seconds: float) -> bool:
        """Keep a row and the duration of its run; on disk when this returns.

        Returns whether it is new: a finished row of the same key stays as it is, a failed one is
        replaced.
        """
        with self._telling(), self._writing():
            before = self._data.total_changes
            self._data.execute(
                "INSERT INTO runs VALUES (?, ?, ?, ?) ON CONFLICT (key) DO UPDATE SET "
                "status = excluded.status, row = excluded.row, seconds = excluded.seconds "
                "WHERE status = ?",
                (row.key, row.status, row.text(), seconds, RowStatus.FAILED),
            )
            return self._data.total_changes > before

    def status(self, key: str) -> RowStatus | None:
        """How the run of a key ended; None if it is not stored."""
        with self._telling():
            found = self._data.execute("SELECT status FROM runs WHERE key = ?", (key,)).fetchone()
        return None if found is None else RowStatus(found[0])

    def row(self, key: str) -> Row | None:
        """The row of a key; None if it is not stored."""
        with self._telling():
            found = self._data.execute("SELECT row FROM runs WHERE key = ?", (key,)).fetchone()
        return None if found is None else self._read(found[0])

    def rows(self) -> Iterator[Row]:
        """Every row, in the order of the keys, read one by one."""
        with self._telling(), closing(self._data.execute("SELECT row FROM runs")) as found:
            for (text,) in found:
                yield self._read(text)

    def _read(self, text: str) -> Row:
        try:
            return Row.read(text)
        except TrajgapError as error:
            raise CaseError(str(self.path), "", str(error)) from None

    def optimum(self, problem: str, solve: Callable[[], Bracket | None]) -> Bracket | None:
        """Interval of the optimum of a problem, by its hash: the same in every process and session.

        None if there is no reference for gaps. `solve`: called once, if the interval is not stored.
        """
        asking = "SELECT upper, lower FROM optima WHERE problem = ?"
        with self._telling():
            found = self._data.execute(asking, (problem,)).fetchone()
        if found is None:
            solved = solve()
            ends = (None, None) if solved is None else (solved.upper, solved.lower)
            with self._telling():
                self._data.execute(
                    "INSERT OR IGNORE INTO optima VALUES (?, ?, ?)", (problem, *ends)
                )
                found = self._data.execute(asking, (problem,)).fetchone()
        return None if found[0] is None else Bracket(*found)

    def note(self, name: str, text: str) -> None:
        """Keep a text about the store, such as the software that computed its rows."""
        with self._telling():
            self._data.execute("INSERT OR REPLACE INTO notes VALUES (?, ?)", (name, text))
