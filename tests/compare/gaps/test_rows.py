"""Rows of runs: their keys, their numbers, the store that keeps them, and how they are exported."""

import csv
import json
import math
import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.small_studies import small_problem, small_trial
from trajgap.compare.gaps import (
    COLUMNS,
    Bracket,
    Row,
    RowStatus,
    Store,
    against,
    canonical,
    check_export,
    export_rows,
    failed,
    run_trial,
)
from trajgap.compare.gaps.exports import _write_parquet
from trajgap.compare.gaps.rows import checkpoints, trace_of
from trajgap.nlp import certificate, certify, exact_problem, problem_seal
from trajgap.problem import CaseError, Limits, Problem, TrajgapError, three_five_three


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "kept.sqlite"


@pytest.fixture(scope="module")
def row() -> Row:
    return run_trial(small_trial())


def test_a_problem_is_hashed_as_certificates_do() -> None:
    waypoints = [[0.25], [0.75], [1.25], [0.875]]
    problem = Problem(waypoints, Limits(6.0, 8.0), three_five_three(), 0.25, 3.0)
    document = certificate(certify(exact_problem(problem)))
    assert problem_seal(problem) == document["problem_hash"]


CHANGES: tuple[dict[str, object], ...] = (
    {"seed": 4}, {"budget": 201}, {"optimizer": "support.optimizers:overspends"},
    {"settings": '{"a":1}'}, {"handling": "stretch"}, {"stream": (1,)},
    {"origin": "sha256:other"}, {"name": "mine/other"}, {"reading": "other"},
)  # fmt: skip
KEY = "d5604aec1ad85ca652853b012f16b9efb3035854cbde14d046beed157aa30dc7"


def test_whatever_determines_a_run_changes_its_key_and_nothing_else_does() -> None:
    # Stores of an earlier version would run everything again: raise ROW_FORMAT with this number.
    assert small_trial().key == small_trial(reference=None, seconds=1.0).key == KEY
    assert len({KEY, *(small_trial(**change).key for change in CHANGES)}) == 1 + len(CHANGES)
    given, moved = small_problem(), small_problem().waypoints.copy()
    moved[1, 0] = np.nextafter(moved[1, 0], 2)
    other = Problem(moved, given.limits, given.curve, 0.2, 6.0, name="small")
    assert problem_seal(other) != small_trial().problem_sha256


def test_a_row_is_read_as_it_was_written(row: Row) -> None:
    assert row.trace
    assert row.durations
    assert Row.read(row.text()) == row
    assert "\n" not in row.text()
    json.loads(row.text(), parse_constant=pytest.fail)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"key": 1}'])
def test_what_is_no_row_is_refused(text: str) -> None:
    with pytest.raises(TrajgapError, match=r"row: cannot be read .*the file may have been altered"):
        Row.read(text)


def test_gaps_are_intervals_and_are_never_clipped(row: Row) -> None:
    assert row.reported_time
    assert row.feasible_time
    row = against(row, Bracket(2 * row.reported_time, 1.5 * row.reported_time))
    assert row.reported_gap == pytest.approx((-1 / 2, -1 / 3))
    assert row.feasible_gap == pytest.approx((-1 / 2, -1 / 3), abs=1e-6)
    row = against(row, Bracket(row.reported_time / 2))
    assert row.reported_gap == pytest.approx((1.0, 1.0))
    assert row.reference_lower is None
    bare = against(row, None)
    assert bare.reported_gap is bare.feasible_gap is bare.reference_upper is None
    assert bare.reported_time == row.reported_time


@pytest.mark.parametrize("ends", [(0.0, None), (math.inf, None), (1.0, 1.1), (1.0, 0.0)])
def test_a_reference_that_is_none_is_refused(ends: tuple[float, float | None]) -> None:
    with pytest.raises(TrajgapError, match=r"reference: .* is n"):
        Bracket(*ends)


def test_a_trial_that_cannot_be_run_is_refused() -> None:
    with pytest.raises(TrajgapError, match="handling: 'squeeze' is unknown; choose death-penalty"):
        small_trial(handling="squeeze")
    with pytest.raises(TrajgapError, match="trial: give a seed of 0 or more and a budget of 1"):
        small_trial(budget=0)
    with pytest.raises(TrajgapError, match=r"settings: .*; use finite numbers"):
        canonical({"a": math.nan})


def test_the_trace_is_the_best_so_far_at_every_checkpoint() -> None:
    totals = np.minimum.accumulate(np.random.default_rng(5).uniform(3, 9, 4000))
    totals[:17] = np.inf
    trace = trace_of(totals)
    assert trace[0][0] >= 18
    for point in checkpoints(4000):
        known = [total for at, total in trace if at <= point]
        assert (known[-1] if known else np.inf) == totals[point - 1]
    assert len(trace) < 140


def test_checkpoints_are_log_spaced_and_end_at_the_last_evaluation() -> None:
    assert checkpoints(0) == ()
    assert checkpoints(1) == (1,)
    points = checkpoints(6030)
    assert points[:5] == (1, 2, 3, 4, 5)
    assert points[-1] == 6030
    assert points == tuple(sorted(set(points)))
    late = np.array([p for p in points if p > 100], dtype=float)
    assert (late[1:] / late[:-1] < 1.09).all()


def test_a_row_is_kept_and_read_again(path: Path, row: Row) -> None:
    with Store(path) as store:
        assert store.status(row.key) is None
        assert store.row(row.key) is None
        assert store.put(row, 0.25)
    with Store(path) as store:
        assert store.status(row.key) is RowStatus.FINISHED
        assert store.row(row.key) == row
        assert list(store.rows()) == [row]


def test_the_first_row_stays_but_a_failed_one_gives_way(path: Path, row: Row) -> None:
    with Store(path) as store:
        assert store.put(failed(small_trial(), "no"), 1)
        assert store.status(row.key) is RowStatus.FAILED
        assert store.put(row, 2)
        assert not store.put(replace(row, evaluations=7), 2)
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
    with pytest.raises(CaseError, match=r"kept.sqlite: is a database of another program; give"):
        Store(path)
    assert path.read_bytes() == before


def test_a_store_of_another_version_is_not_touched(path: Path) -> None:
    Store(path).close()
    with sqlite3.connect(path) as other:
        other.execute("PRAGMA user_version = 99")
    words = r"contains rows of version 99, but this program writes 1; give"
    with pytest.raises(CaseError, match=words):
        Store(path)


def test_what_is_no_database_is_refused(path: Path) -> None:
    path.write_text("format = 1\n" * 200)
    with pytest.raises(CaseError, match=r"kept.sqlite: is not a store of trajgap; give a new file"):
        Store(path)
    with pytest.raises(CaseError, match=r"cannot be created .*; create its folder first"):
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


@pytest.fixture(scope="module")
def rows(row: Row) -> list[Row]:
    """A finished row, one with nothing feasible, one that failed, one of another optimiser."""
    nothing = replace(
        row, key="n", reported_time=None, durations=None, verdict=None, worst_ratio=None,
        feasible_time=None, feasible_why="none", feasible_gap=None, reported_gap=None, trace=(),
        reference_upper=None, reference_lower=None,
    )  # fmt: skip
    bad = failed(small_trial("support.optimizers:raises"), 'said "no",\nthen\t; ended')
    changes = {"seed": 9, "budget": 333, "handling": "stretch", "reference": Bracket(2.0)}
    other = run_trial(small_trial("random", **changes))
    return [row, nothing, bad, other]


def listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def wanted(row: Row, column: str) -> Any:
    """The value of a column, by its meaning."""
    if column.startswith("trace_"):
        return [point[column == "trace_totals"] for point in row.trace]
    name, _, side = column.rpartition("_")
    if side in ("lowest", "highest"):
        ends = getattr(row, name)
        return None if ends is None else ends[side == "highest"]
    return listed(getattr(row, column))


def test_csv_is_read_by_csv(rows: list[Row], tmp_path: Path) -> None:
    assert export_rows(iter(rows), tmp_path / "rows.csv") == 4
    with (tmp_path / "rows.csv").open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file))
    assert len(found) == 4
    for row, cells in zip(rows, found, strict=True):
        assert list(cells) == list(COLUMNS)
        for column, cell in cells.items():
            value = wanted(row, column)
            if isinstance(value, list):
                assert json.loads(cell) == value
            elif isinstance(value, float):
                assert float(cell) == value
            else:
                assert cell == ("" if value is None else str(value))


def test_parquet_is_read_by_pandas_and_pyarrow(rows: list[Row], tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "rows.parquet"
    assert export_rows(iter(rows), path) == 4
    found = parquet.read_table(path).to_pylist()
    for row, cells in zip(rows, found, strict=True):
        assert cells == {column: wanted(row, column) for column in COLUMNS}
    pandas = pytest.importorskip("pandas")
    table = pandas.read_parquet(path)
    assert list(table.columns) == list(COLUMNS)
    assert table["seed"].tolist() == [3, 3, 3, 9]
    assert table["feasible_time"].isna().tolist() == [False, True, True, False]
    assert table["feasible_time"][0] == rows[0].feasible_time


def test_many_rows_pass_through_in_batches(rows: list[Row], tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "rows.parquet"
    assert _write_parquet((replace(rows[0], seed=i) for i in range(10)), path, batch=3) == 10
    file = parquet.ParquetFile(path)
    assert file.num_row_groups == 4
    assert file.read()["seed"].to_pylist() == list(range(10))


def test_iohprofiler_is_read_by_iohinspector(rows: list[Row], tmp_path: Path) -> None:
    inspector = pytest.importorskip("iohinspector")
    path = tmp_path / "rows.ioh"
    more = [replace(rows[0], seed=4, evaluations=150, trace=rows[0].trace[:3])]
    assert export_rows([*rows[:2], *more, *rows[2:]], path) == 4  # the failed one judged nothing
    manager = inspector.DataManager()
    manager.add_folder(str(path))
    runs = manager.overview.sort("algorithm_name", "run_id").to_dicts()
    assert [one["algorithm_name"] for one in runs] == [
        "random, stretch, {}",
        *["support.optimizers:draws, death-penalty, {}"] * 3,
    ]
    assert {one["function_name"] for one in runs} == {"mine/main, plain"}
    assert {(one["suite"], one["dimension"]) for one in runs} == {("trajgap", 3)}
    assert [one["evals"] for one in runs] == [333, 200, 200, 150]
    best = [one["best_y"] for one in runs]
    assert best[:2] == [rows[3].reported_time, rows[0].reported_time]
    assert best[2] == sys.float_info.max
    data = manager.load(monotonic=False)
    for run, row in zip(runs, [rows[3], rows[0], rows[1], more[0]], strict=True):
        lines = data.filter(data["data_id"] == run["data_id"])
        dots = list(zip(lines["evaluations"], lines["raw_y"], strict=True))
        assert dots[0][0] == 1
        assert dots[-1][0] == row.evaluations
        assert [p for p in dots if p in row.trace] == list(row.trace)
        first = row.trace[0][0] if row.trace else math.inf
        assert all(y == sys.float_info.max for at, y in dots if at < first)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("rows.xls", "rows.xls: --export: has an unknown ending; use .csv, .parquet, .ioh"),
        ("there.csv", "there.csv: --export: already exists; give another or delete this one"),
        ("nowhere/rows.csv", "rows.csv: --export: its folder does not exist; create it first"),
    ],
)
def test_a_name_that_cannot_be_used_is_refused(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "there.csv").touch()
    with pytest.raises(CaseError, match=said):
        check_export(tmp_path / name)
    with pytest.raises(CaseError, match=said):
        export_rows([], tmp_path / name)


def test_a_missing_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(CaseError, match=r'pyarrow is not installed; run `.*"trajgap\[parquet\]"`'):
        check_export(tmp_path / "rows.parquet")


@pytest.mark.parametrize("ending", ["csv", "parquet", "ioh"])
def test_an_export_that_fails_leaves_nothing(rows: list[Row], tmp_path: Path, ending: str) -> None:
    def broken() -> Any:
        yield rows[0]
        raise OSError(28, "No space left on device")

    with pytest.raises(CaseError, match=r"--export: cannot be written \(No space left on device\)"):
        export_rows(broken(), tmp_path / f"rows.{ending}")
    assert os.listdir(tmp_path) == []
