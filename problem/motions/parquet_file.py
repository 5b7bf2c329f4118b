"""Parquet, by the optional library pyarrow: samples, each column converted by its type."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import CaseError
from ..files import MOST, check_regular, read_regular
from .samples import Samples
from .tables import check_size, column_meaning, samples_of_columns

_A_SECOND = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
"""How many units of Arrow's types of time a second has."""


def read_parquet(path: Path, joints: Sequence[str] = ()) -> Samples:
    """Read samples from a Parquet file; columns are named as in `read_csv`.

    Times are seconds where they are decimal numbers. Durations are converted by their unit;
    timestamps, times of day and dates too, relative to the first row. Whole numbers need a column
    whose name says seconds, such as ``time_s``. What a column's type rounds off, half a unit of its
    last place, is known of no number in it: of 32-bit floats as of milliseconds.

    Raises
    ------
    CaseError
        If it is not such a table, a column has a type without a reading, or pyarrow is not
        installed.
    """
    name = str(path)
    check_regular(path)
    try:
        from pyarrow import lib, parquet
    except ImportError:
        raise CaseError(
            name, "", "Parquet needs pyarrow; pip install trajgap[parquet], or export CSV"
        ) from None
    data = read_regular(path, MOST.table_bytes, "split it, or keep fewer rows")
    try:
        file = parquet.ParquetFile(io.BytesIO(data))
        names, rows = list(file.schema_arrow.names), file.metadata.num_rows
        check_size(name, rows, len(names))
        if not names or rows == 0:
            raise CaseError(name, "", "contains no rows; give one row per sample")
        rows_read = file.read()
        time, _ = column_meaning(name, names)
        read = [
            (_times if k == time else _numbers)(name, names[k], column)
            for k, column in enumerate(rows_read.itercolumns())
        ]
        columns, halves = zip(*read, strict=True)
    except CaseError:
        raise
    except (lib.ArrowException, OSError, ValueError, TypeError, MemoryError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise CaseError(name, "", f"no Parquet table ({reason}); export it again") from None
    table, known = np.column_stack(columns), np.array(halves)
    return samples_of_columns(name, table, names, joints, lambda at: known[at])


def _numbers(name: str, label: str, column: Any) -> tuple[Array, float]:
    """A column of positions or derivatives, NaN if it has no value, and its half unit."""
    from pyarrow import float64, types

    column = _plain(column)
    kind = column.type
    if label.startswith("__index_level_"):
        raise CaseError(name, label, "is the index of a data frame; write it with index=False")
    numeric = (types.is_integer, types.is_floating, types.is_decimal, types.is_null)
    if not any(one(kind) for one in numeric):
        raise CaseError(name, label, f"holds {kind}, which is not a number; give rad or m")
    found = np.asarray(column.cast(float64()).to_numpy(), dtype=np.float64)
    if types.is_decimal(kind):
        return found, 0.5 * 10.0**-kind.scale
    digits = 24 if types.is_float32(kind) else 11 if types.is_float16(kind) else None
    if digits is None:
        return found, 0.0
    return found, float(np.ldexp(np.nanmax(np.abs(found), initial=0.0), -digits))


def _times(name: str, label: str, column: Any) -> tuple[Array, float]:
    """The column of times and its half unit, s."""
    from pyarrow import int32, int64, types

    column = _plain(column)
    kind = column.type
    if column.null_count:
        row = int(np.argmax(np.asarray(column.is_null()))) + 1
        raise CaseError(name, label, f"has no time in row {row}; give one in every row")
    if types.is_temporal(kind) and not types.is_interval(kind):
        if types.is_date(kind) or types.is_time32(kind):
            width = int64() if types.is_date64(kind) else int32()
            column = column.cast(width)
        whole = np.asarray(column.cast(int64()).to_numpy(), dtype=np.int64)
        if types.is_date32(kind):
            whole = whole * 86_400
        second = 1 if types.is_date32(kind) else _A_SECOND[getattr(kind, "unit", "ms")]
        start = 0 if types.is_duration(kind) else int(whole[0])
        if max(abs(int(whole.max()) - start), abs(int(whole.min()) - start)) >= 2**63:
            raise CaseError(name, label, "spans more time than can be read; give seconds")
        return np.asarray((whole - start) / second, dtype=np.float64), 0.5 / second
    whole_numbers = types.is_integer(kind) or (types.is_decimal(kind) and kind.scale <= 0)
    # Other names of the column of times say seconds.
    if whole_numbers and label.strip().lower() in ("t", "time", "times", "timestamp"):
        raise CaseError(
            name, label, f"holds {kind} without a unit; name it time_s if these are seconds"
        )
    return _numbers(name, label, column)


def _plain(column: Any) -> Any:
    """A column with its values instead of the keys of a dictionary."""
    from pyarrow import types

    kind = column.type
    return column.cast(kind.value_type) if types.is_dictionary(kind) else column
