import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from support.small_studies import small_trial
from trajgap.compare.gaps import Bracket, Row, RowStatus, Store, failed, run_trial
from trajgap.problem import CaseError


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "kept.sqlite"


@pytest.fixture
def row() -> Row:
    return run_trial(small_trial())


def test_a_row_is_kept_and_read_again(path: Path, row: Row) -> None:
    with Store(path) as store:
        assert store.status(row.key) is None
        assert store.row(row.key) is None
        assert store.put(row, 0.25)
    with Store(path) as store:
        assert store.status(row.key) is RowStatus.FINISHED
        assert store.row(row.key) == row
        assert list(store.rows()) == [row]
        assert store.seconds() == 0.25
        assert store.tally() == {RowStatus.FINISHED: 1}


def test_the_row_that_was_there_first_stays(path: Path, row: Row) -> None:
    with Store(path) as store:
        store.put(row, 1)
        assert not store.put(replace(row, evaluations=7), 2)
        assert store.row(row.key) == row


def test_a_failed_row_gives_way(path: Path, row: Row) -> None:
    with Store(path) as store:
        assert store.put(failed(small_trial(), "no"), 1)
        assert store.status(row.key) is RowStatus.FAILED
        assert store.put(row, 2)
        assert store.row(row.key) == row


def test_a_row_is_on_disk_when_put_returns(path: Path, row: Row) -> None:
    program = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from trajgap.compare.gaps import Row, Store\n"
        "store = Store(Path(sys.argv[1]))\n"
        "store.put(Row.read(sys.argv[2]), 1)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    ended = subprocess.run([sys.executable, "-c", program, str(path), row.text()], check=False)
    assert ended.returncode < 0
    with Store(path) as store:
        assert store.row(row.key) == row


def test_the_file_is_written_through(path: Path) -> None:
    with Store(path) as store:
        assert store._data.execute("PRAGMA journal_mode").fetchone() == ("wal",)
        assert store._data.execute("PRAGMA synchronous").fetchone() == (2,)


def test_an_optimum_is_asked_for_once(path: Path) -> None:
    asked: Iterator[Bracket | None] = iter([Bracket(3.0, 2.5), None, Bracket(9.0)])
    with Store(path) as store:
        assert store.optimum("a", lambda: next(asked)) == Bracket(3.0, 2.5)
        assert store.optimum("b", lambda: next(asked)) is None
    with Store(path) as store:
        assert store.optimum("a", lambda: next(asked)) == Bracket(3.0, 2.5)
        assert store.optimum("b", lambda: next(asked)) is None
    assert next(asked) == Bracket(9.0)


def test_of_two_processes_that_solve_the_first_is_believed(path: Path) -> None:
    with Store(path) as one, Store(path) as other:

        def solve() -> Bracket:
            other.optimum("a", lambda: Bracket(3.0))
            return Bracket(4.0)

        assert one.optimum("a", solve) == Bracket(3.0)


def test_a_database_of_somebody_else_is_not_touched(path: Path) -> None:
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE theirs (a)")
    before = path.read_bytes()
    with pytest.raises(CaseError, match=r"kept.sqlite: is a database of another program; name"):
        Store(path)
    assert path.read_bytes() == before


def test_a_store_of_another_version_is_not_touched(path: Path) -> None:
    Store(path).close()
    with sqlite3.connect(path) as other:
        other.execute("PRAGMA user_version = 99")
    with pytest.raises(CaseError, match=r"holds rows of version 99, this program writes 1; name"):
        Store(path)


def test_what_is_no_database_is_refused(path: Path) -> None:
    path.write_text("format = 1\n" * 200)
    with pytest.raises(CaseError, match=r"kept.sqlite: is no store of trajgap; name a new file"):
        Store(path)
    with pytest.raises(CaseError, match=r"cannot be made .*; make its folder first"):
        Store(path.parent / "nowhere" / "kept.sqlite")
    with pytest.raises(CaseError, match=r"is a directory"):
        Store(path.parent)


def test_an_altered_row_is_refused(path: Path, row: Row) -> None:
    with Store(path) as store:
        store.put(row, 1)
        store._data.execute("UPDATE runs SET row = '{}'")
        with pytest.raises(CaseError, match=r"kept.sqlite: row: cannot be read"):
            store.row(row.key)


def test_a_store_that_cannot_be_written_is_reported(path: Path, row: Row) -> None:
    with Store(path) as store:
        store._data.execute("PRAGMA query_only = ON")
        with pytest.raises(CaseError, match=r"cannot be used \(attempt to write a readonly"):
            store.put(row, 1)


def test_notes(path: Path) -> None:
    with Store(path) as store:
        store.note("software", "old")
        store.note("software", "new")
        assert store.notes() == {"software": "new"}


WRITER = """
import sys
from dataclasses import replace
from pathlib import Path
from trajgap.compare.gaps import Row, Store
row = Row.read(sys.argv[2])
with Store(Path(sys.argv[1])) as store:
    for i in range(150):
        # Every third key is written by both.
        name = f"{i}" if i % 3 == 0 else f"{sys.argv[3]}-{i}"
        store.put(replace(row, key=name), 1)
"""


def test_two_processes_write_one_store(path: Path, row: Row) -> None:
    begun = [
        subprocess.Popen([sys.executable, "-c", WRITER, str(path), row.text(), name])
        for name in ("a", "b")
    ]
    assert [one.wait(300) for one in begun] == [0, 0]
    with Store(path) as store:
        rows = list(store.rows())
        assert store._data.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    names = {str(i) for i in range(0, 150, 3)}
    names |= {f"{name}-{i}" for name in "ab" for i in range(150) if i % 3}
    assert {one.key for one in rows} == names
    assert {replace(one, key="") for one in rows} == {replace(row, key="")}
