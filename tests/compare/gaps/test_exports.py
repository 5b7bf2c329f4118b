import csv
import json
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.small_studies import small_trial
from trajgap.compare.gaps import COLUMNS, Bracket, Row, check_export, export_rows, failed, run_trial
from trajgap.problem import CaseError


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    """A finished row, one with nothing feasible, one that failed, one of another optimiser."""
    good = run_trial(small_trial())
    nothing = replace(
        good, key="n", reported_time=None, durations=None, verdict=None, worst_ratio=None,
        feasible_time=None, feasible_why="none", feasible_gap=None, reported_gap=None, trace=(),
    )  # fmt: skip
    bad = failed(small_trial("support.optimizers:raises"), 'said "no",\nthen\t; ended')
    other = run_trial(small_trial("random", seed=9, budget=333, handling="stretch"))
    return [good, nothing, bad, other]


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


def test_many_rows_pass_through_in_batches(
    rows: list[Row], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("trajgap.compare.gaps.exports._BATCH", 3)
    path = tmp_path / "rows.parquet"
    assert export_rows((replace(rows[0], seed=i) for i in range(10)), path) == 10
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
        points = list(zip(lines["evaluations"], lines["raw_y"], strict=True))
        assert points[0][0] == 1
        assert points[-1][0] == row.evaluations
        assert [p for p in points if p in row.trace] == list(row.trace)
        assert all(
            y == sys.float_info.max for at, y in points if not row.trace or at < row.trace[0][0]
        )


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("rows.xls", "rows.xls: --export: has no known ending; use .csv, .parquet, .ioh"),
        ("there.csv", "there.csv: --export: exists already; name another or delete this one"),
        ("nowhere/rows.csv", "rows.csv: --export: its folder is not there; make it first"),
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


def test_gaps_of_rows_without_reference_are_empty(rows: list[Row], tmp_path: Path) -> None:
    bare = run_trial(small_trial(reference=None))
    export_rows([bare, run_trial(small_trial(reference=Bracket(2.0)))], tmp_path / "rows.csv")
    with (tmp_path / "rows.csv").open(encoding="utf-8", newline="") as file:
        first, second = csv.DictReader(file)
    assert first["reported_gap_lowest"] == first["reference_upper"] == ""
    assert second["reported_gap_lowest"] == second["reported_gap_highest"] != ""
    assert second["reference_lower"] == ""
