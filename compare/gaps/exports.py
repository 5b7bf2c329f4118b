"""Rows for other programs: CSV, Parquet, and the folders of IOHprofiler."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from itertools import groupby, islice
from operator import attrgetter
from pathlib import Path
from typing import Any, TextIO

from ...problem import CaseError, new_draft
from .rows import Row, canonical

_KINDS: dict[Any, str] = {
    "str": "text",
    "str | None": "text",
    "RowStatus": "text",
    "int": "count",
    "tuple[int, ...]": "counts",
    "float | None": "number",
    "tuple[float, ...] | None": "numbers",
}
"""What a column holds, by the type of a row's field."""
_SPLIT = {
    "reported_gap": {"reported_gap_lowest": "number", "reported_gap_highest": "number"},
    "feasible_gap": {"feasible_gap_lowest": "number", "feasible_gap_highest": "number"},
    "trace": {"trace_evaluations": "counts", "trace_totals": "numbers"},
}
"""Fields of a row that become two columns."""
COLUMNS: dict[str, str] = {
    name: kind
    for one in fields(Row)
    for name, kind in (_SPLIT.get(one.name) or {one.name: _KINDS[one.type]}).items()
}
"""Columns of a table of rows, and what each holds; the meaning is that of `Row`."""
_NOTHING = sys.float_info.max
"""Total that IOHprofiler's files state before anything feasible is known: they have no infinity."""


def export_rows(rows: Iterable[Row], path: Path) -> int:
    """Write rows in the format of the name's ending; the file appears complete or not at all.

    Returns the number of rows written: IOHprofiler's format cannot hold a run that evaluated
    nothing. `path`: ends with ".csv" or ".parquet", or with ".ioh", a folder in IOHprofiler's
    format.
    """
    check_export(path)
    try:
        with new_draft(path, is_folder=path.suffix == ".ioh") as draft:
            return _WRITERS[path.suffix](rows, draft)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise CaseError(
            str(path), "--export", f"cannot be written ({reason}); name a place that can"
        ) from None


def check_export(path: Path) -> None:
    """Check whether rows can be exported to a path, before anything is computed."""
    name = str(path)
    if path.suffix not in _WRITERS:
        raise CaseError(name, "--export", f"has an unknown ending; use {', '.join(_WRITERS)}")
    if os.path.lexists(path):
        raise CaseError(name, "--export", "already exists; give another or delete this one")
    if not path.parent.is_dir():
        raise CaseError(name, "--export", "its folder does not exist; create it first")
    if path.suffix == ".parquet":
        _arrow(name)


def flat(row: Row) -> dict[str, Any]:
    """Values of `COLUMNS`; None if there is none."""
    found = {name: getattr(row, name) for name in COLUMNS if hasattr(row, name)}
    for name in ("reported_gap", "feasible_gap"):
        low, high = getattr(row, name) or (None, None)
        found |= {f"{name}_lowest": low, f"{name}_highest": high}
    found["trace_evaluations"] = [at for at, _ in row.trace]
    found["trace_totals"] = [total for _, total in row.trace]
    found["status"] = str(row.status)
    return {name: found[name] for name in COLUMNS}


def rows_text(rows: Iterable[Row]) -> str:
    """The text of a CSV export of rows: one line a run, `COLUMNS`."""
    table = io.StringIO()
    _into_csv(rows, table)
    return table.getvalue()


def _write_csv(rows: Iterable[Row], path: Path) -> int:
    with path.open("w", encoding="utf-8", newline="") as file:
        return _into_csv(rows, file)


def _into_csv(rows: Iterable[Row], file: TextIO) -> int:
    count = 0
    lists = [name for name, kind in COLUMNS.items() if kind.endswith("s")]
    table = csv.writer(file, lineterminator="\n")
    table.writerow(COLUMNS)
    for row in rows:
        values = flat(row)
        for name in lists:
            # A list is one cell of JSON.
            values[name] = None if values[name] is None else canonical(list(values[name]))
        table.writerow(values.values())
        count += 1
    return count


def _arrow(name: str) -> Any:
    try:
        import pyarrow.parquet
    except ImportError:
        raise CaseError(
            name,
            "--export",
            'pyarrow is not installed; run `python -m pip install "trajgap[parquet]"`',
        ) from None
    return pyarrow


def _write_parquet(rows: Iterable[Row], path: Path, batch: int = 1_000) -> int:
    """Write rows, of which so many are in memory at a time."""
    arrow = _arrow(str(path))
    kinds = {
        "text": arrow.string(),
        "count": arrow.int64(),
        "number": arrow.float64(),
        "counts": arrow.list_(arrow.int64()),
        "numbers": arrow.list_(arrow.float64()),
    }
    schema = arrow.schema([(name, kinds[kind]) for name, kind in COLUMNS.items()])
    count, left = 0, iter(rows)
    with arrow.parquet.ParquetWriter(path, schema) as writer:
        while some := [flat(row) for row in islice(left, batch)]:
            writer.write_table(arrow.Table.from_pylist(some, schema=schema))
            count += len(some)
    return count


# --- IOHprofiler ----------------------------------------------------------------------------------


def _write_ioh(rows: Iterable[Row], folder: Path) -> int:
    """One folder for each algorithm, and in it one description and one table for each problem.

    An algorithm is an optimiser with its settings and handling, a function is a problem under a
    reading. The values are the totals of the objective, s.
    """
    # Numbered from 1 in the order in which they come.
    algorithms: dict[Any, int] = {}
    functions: dict[Any, int] = {}
    count = 0
    useful = (row for row in rows if row.evaluations)
    ours_of = attrgetter("optimizer", "settings", "handling", "origin")
    theirs_of = attrgetter("problem", "reading", "segments")
    for (ours, theirs), runs in groupby(useful, lambda row: (ours_of(row), theirs_of(row))):
        optimizer, settings, handling, origin = ours
        words = re.sub(r"[^A-Za-z0-9.-]+", "-", f"{optimizer}-{handling}")
        home = folder / f"{algorithms.setdefault(ours, len(algorithms) + 1)}-{words}"
        number = functions.setdefault(theirs, len(functions) + 1)
        table = f"data_f{number}/IOHprofiler_f{number}_DIM{theirs[2]}.dat"
        (home / table).parent.mkdir(parents=True, exist_ok=True)
        described = list(_write_runs(runs, home / table))
        count += len(described)
        document = {
            "version": "0.3.22",
            "suite": "trajgap",
            "function_id": number,
            "function_name": f"{theirs[0]}, {theirs[1]}",
            "maximization": False,
            "algorithm": {
                "name": f"{optimizer}, {handling}, {settings}",
                "info": origin or "trajgap",
            },
            "attributes": ["evaluations", "raw_y"],
            "scenarios": [{"dimension": theirs[2], "path": table, "runs": described}],
        }
        text = json.dumps(document, indent=1, allow_nan=False) + "\n"
        (home / f"IOHprofiler_f{number}.json").write_text(text, encoding="utf-8", newline="")
    return count


def _write_runs(rows: Iterable[Row], path: Path) -> Iterator[dict[str, Any]]:
    """Write the traces of one algorithm on one problem; say of each run what it came to."""
    with path.open("w", encoding="utf-8", newline="") as file:
        for row in rows:
            points = list(row.trace)
            # Readers find a run by its first evaluation, and its budget by the last.
            if not points or points[0][0] > 1:
                points.insert(0, (1, _NOTHING))
            if points[-1][0] < row.evaluations:
                points.append((row.evaluations, points[-1][1]))
            file.write("evaluations raw_y\n")
            file.writelines(f"{at} {total!r}\n" for at, total in points)
            best = row.trace[-1] if row.trace else (row.evaluations, _NOTHING)
            yield {
                "instance": 1,
                "evals": row.evaluations,
                "best": {"evals": best[0], "y": best[1], "x": list(row.durations or ())},
            }


_WRITERS: dict[str, Callable[[Iterable[Row], Path], int]] = {
    ".csv": _write_csv,
    ".parquet": _write_parquet,
    ".ioh": _write_ioh,
}
"""Writers by the ending of the name; each takes the rows and a path that is not there yet."""
