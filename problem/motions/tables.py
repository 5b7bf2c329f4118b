"""Samples from tables: CSV and Parquet, one row per time, columns known by their names."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..fields import MOST_JOINTS
from ..files import check_regular, read_regular
from .motion import MOST_VALUES, numbered
from .samples import Samples

LARGEST_FILE = 500_000_000
"""Bytes of a table: ten million positions with derivatives of 17 digits each."""
_TIME = re.compile(
    r"(t|time|times|timestamp|time[ _]?(from[ _]start)?[ _]?[\[(]?s(ec(onds)?)?[\])]?)"
)
"""Names of the column of times, lower case."""
_WORDS = {
    "position": 0, "pos": 0, "q": 0,
    "velocity": 1, "vel": 1, "qd": 1,
    "acceleration": 2, "acc": 2, "accel": 2, "qdd": 2,
}  # fmt: skip
"""What a column holds, said before or after the joint's name."""
_GAP = r"[ ._:/-]"
"""What stands between a joint's name and such a word."""


def read_csv(path: Path, joints: Sequence[str] = (), noise: float | Array = 0.0) -> Samples:
    """Read samples from a text table.

    Parameters
    ----------
    path : Path
        The first column, or the one named ``time``, is time in s. Other columns are positions, or
        carry ``velocity`` or ``acceleration`` before or after the joint's name. Without a header
        all others are positions. Commas, semicolons, tabs or blanks separate; # begins a comment.
    joints : sequence of str, optional
        Names of the joints, where the header gives none.
    noise : float or ndarray
        See `Samples`.

    Returns
    -------
    Samples

    Raises
    ------
    CaseError
        If it is no such table; the line says where and how to fix it.
    """
    name = str(path)
    data = read_regular(path, LARGEST_FILE, "split it, or keep fewer rows")
    if b"\0" in data[:100_000]:
        raise CaseError(name, "", "is a binary file; give CSV text, Parquet or a ROS message")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise CaseError(name, f"line {line}", "is not UTF-8 text; save the file as UTF-8") from None
    return parse_csv(text, name, joints, noise)


def parse_csv(
    text: str, name: str, joints: Sequence[str] = (), noise: float | Array = 0.0
) -> Samples:
    """`read_csv` of a text; ``name`` is for messages.

    Raises
    ------
    CaseError
    """
    first = next((x for x in _lines(text[:100_000]) if x), "")
    if not first:
        raise CaseError(name, "", "holds no rows; give one row per sample")
    separator = next((s for s in (",", ";", "\t") if s in first), None)
    cells = [x.strip().strip("\"'") for x in first.split(separator)]
    header = not all(_is_number(x) for x in cells)
    table = _numbers(text, name, separator, skip=header, columns=len(cells))
    return _samples(name, table, cells if header else (), joints, noise)


def read_parquet(path: Path, joints: Sequence[str] = (), noise: float | Array = 0.0) -> Samples:
    """Read samples from a Parquet file; columns are named as in `read_csv`.

    Raises
    ------
    CaseError
        If it is no such table, or pyarrow is not installed.
    """
    name = str(path)
    check_regular(path)
    try:
        from pyarrow import lib, parquet
    except ImportError:
        raise CaseError(
            name, "", "Parquet needs pyarrow; pip install trajgap[parquet], or export CSV"
        ) from None
    data = read_regular(path, LARGEST_FILE, "split it, or keep fewer rows")
    try:
        file = parquet.ParquetFile(io.BytesIO(data))
        names, rows = list(file.schema_arrow.names), file.metadata.num_rows
        _check_size(name, rows, len(names))
        table = file.read()
        columns = [np.asarray(c.to_numpy(), dtype=np.float64) for c in table.itercolumns()]
    except (lib.ArrowException, OSError, ValueError, TypeError, MemoryError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise CaseError(name, "", f"no Parquet table ({reason}); export it again") from None
    if not columns or rows == 0:
        raise CaseError(name, "", "holds no rows; give one row per sample")
    return _samples(name, np.column_stack(columns), names, joints, noise)


def _lines(text: str) -> list[str]:
    return [line.partition("#")[0].strip() for line in text.splitlines()]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _check_size(name: str, rows: int, columns: int) -> None:
    if rows * columns > 4 * MOST_VALUES or columns > 3 * MOST_JOINTS + 1:
        raise CaseError(
            name, "", f"{rows} rows of {columns} columns are more than is read; keep fewer"
        )


def _numbers(text: str, name: str, separator: str | None, skip: bool, columns: int) -> Array:
    _check_size(name, text.count("\n"), columns)
    stream = io.StringIO(text)
    if skip:
        for line in stream:
            if line.partition("#")[0].strip():
                break
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of no data, which is refused below
            found = np.loadtxt(stream, delimiter=separator, ndmin=2, comments="#")
    except (ValueError, OverflowError, UnicodeError):
        raise _bad_row(text, name, separator, skip, columns) from None
    if found.size == 0:
        raise CaseError(name, "", "holds no rows of numbers; give one row per sample")
    if found.shape[1] != columns:
        raise _bad_row(text, name, separator, skip, columns)
    return np.asarray(found, dtype=np.float64)


def _bad_row(text: str, name: str, separator: str | None, skip: bool, columns: int) -> CaseError:
    """Find the first row that is not as wide as the first line, or holds no number."""
    waiting = skip
    for number, line in enumerate(_lines(text), 1):
        if not line:
            continue
        if waiting:
            waiting = False
            continue
        cells = line.split(separator)
        if len(cells) != columns:
            return CaseError(
                name,
                f"line {number}",
                f"{len(cells)} cells, the first line has {columns}; give every row as many",
            )
        for k, cell in enumerate(cells, 1):
            if not _is_number(cell.strip()):
                shown = cell.strip()[:40]
                comma = "; write a decimal point" if re.fullmatch(r"\s*-?\d+,\d+\s*", cell) else ""
                return CaseError(
                    name,
                    f"line {number}, column {k}",
                    f"{shown!r} is no number{comma or '; fix it'}",
                )
    return CaseError(name, "", "is no table of numbers; give one row per sample")


def _samples(
    name: str, table: Array, header: Sequence[str], joints: Sequence[str], noise: float | Array
) -> Samples:
    if table.shape[1] < 2:
        raise CaseError(name, "", "has one column; give time and a position per joint")
    try:
        if not header:
            labels = tuple(joints) or numbered(table.shape[1] - 1)
            return Samples(labels, table[:, 0], table[:, 1:], noise=noise)
        time, columns = _meaning(name, header)
        labels = tuple(dict.fromkeys(joint for joint, _ in columns))
        parts: list[Array | None] = []
        for order in range(3):
            places = [columns.get((joint, order)) for joint in labels]
            missing = [one for one, k in zip(labels, places, strict=True) if k is None]
            if missing and (order == 0 or len(missing) < len(labels)):
                word = ("position", "velocity", "acceleration")[order]
                raise CaseError(
                    name, "line 1", f"no {word} of joint {missing[0]}; give it for every joint"
                )
            parts.append(None if missing else table[:, [k for k in places if k is not None]])
        assert parts[0] is not None
        named = tuple(joints) or labels
        return Samples(named, table[:, time], parts[0], parts[1], parts[2], noise)
    except CaseError:
        raise
    except TrajgapError as error:
        raise CaseError(name, "", str(error)) from None


def _meaning(name: str, header: Sequence[str]) -> tuple[int, dict[tuple[str, int], int]]:
    """Column of times, and of each joint and order."""
    times = [k for k, one in enumerate(header) if _TIME.fullmatch(one.strip().lower())]
    if len(times) != 1:
        columns_are = "no column is" if not times else "several columns are"
        raise CaseError(
            name, "line 1", f"{columns_are} named time; name the column of seconds 'time'"
        )
    columns: dict[tuple[str, int], int] = {}
    for k, one in enumerate(header):
        if k == times[0]:
            continue
        joint, order = _joint(one.strip())
        if not joint:
            raise CaseError(name, "line 1", f"column {k + 1} has no name; name it after its joint")
        if (joint, order) in columns:
            raise CaseError(name, "line 1", f"two columns are named {one.strip()!r}; rename one")
        columns[joint, order] = k
    return times[0], columns


def _joint(column: str) -> tuple[str, int]:
    words = "|".join(sorted(_WORDS, key=len, reverse=True))
    for pattern in (rf"(?P<j>.+){_GAP}(?P<w>{words})", rf"(?P<w>{words}){_GAP}(?P<j>.+)"):
        found = re.fullmatch(pattern, column, re.IGNORECASE)
        if found is not None:
            return found["j"], _WORDS[found["w"].lower()]
    return column, 0
