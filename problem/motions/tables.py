"""Samples from tables: one row per time, columns known by their names; CSV is read here."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..files import MOST, decoded, read_regular
from .digits import HalfUnits, digits_of_text, half_units
from .motion import numbered
from .samples import Samples

_TIME = re.compile(
    r"(t|time|times|timestamp|time[ _]?(from[ _]start)?[ _]?[\[(]?s(ec(onds)?)?[\])]?)"
)
"""Names of the column of times, lower case."""
_WORDS = {
    "position": 0, "pos": 0, "q": 0,
    "velocity": 1, "vel": 1, "qd": 1, "dq": 1, "qdot": 1,
    "acceleration": 2, "acc": 2, "accel": 2, "qdd": 2, "ddq": 2, "qddot": 2,
}  # fmt: skip
"""What a column holds, said before or after the joint's name."""
_SYMBOLS = _WORDS | {"v": 1, "a": 2}
"""The same where a number alone follows, as in q1, qd1: one letter may be a joint's name too, so
these count only beside a column of positions with that number."""
_FORCES = "effort|torque|tau|force|current|voltage|temperature|jerk"
"""What a column holds that is no part of the motion, alone, with a number or beside a joint."""
_UNIT = re.compile(r".*(?:[\[(][^\])]*[\])]|[ _./-](?P<unit>deg|degrees?|mm|cm))", re.IGNORECASE)
"""A name that ends in a unit: any in brackets, or one that is not the default."""
_GAP = r"[ ._:/-]"
"""What stands between a joint's name and such a word."""
_ASIDE = re.compile(
    rf"index|idx|row|sample|frame|seq"
    rf"|(.+{_GAP})?({_FORCES})s?({_GAP}.+)?{_GAP}?\d*([ _]?[\[(].*[\])])?",
    re.IGNORECASE,
)
"""A column that is left out."""


def read_csv(path: Path, joints: Sequence[str] = ()) -> Samples:
    """Read samples from a text table.

    Parameters
    ----------
    path : Path
        The first column, or the one named ``time``, is time in s. Other columns are positions, or
        carry ``velocity`` or ``acceleration`` before or after the joint's name; those of effort,
        current, jerk and the like are left out. Without a header all others are positions.
        Commas, semicolons, tabs or blanks separate; # begins a comment.
    joints : sequence of str, optional
        Names of the joints, where the header gives none.

    Raises
    ------
    CaseError
        If it is not such a table; the line says where and how to fix it.
    """
    name = str(path)
    data = read_regular(path, MOST.table_bytes, "split it, or keep fewer rows")
    text = decoded(data, name, "give CSV text, Parquet or a ROS message")
    return parse_csv(text, name, joints)


def parse_csv(text: str, name: str, joints: Sequence[str] = ()) -> Samples:
    """`read_csv` of a text; ``name`` is for messages."""
    first = next((x for x in _lines(text[:100_000]) if x), "")
    if not first:
        raise CaseError(name, "", "contains no rows; give one row per sample")
    separator = next((s for s in (",", ";", "\t") if s in first), None)
    cells = [x.strip().strip("\"'") for x in first.split(separator)]
    header = not all(_is_number(x) for x in cells)
    table = _numbers(text, name, separator, skip=header, columns=len(cells))
    digits = digits_of_text(text, separator, len(cells))

    def half(at: list[int]) -> Array:
        return half_units(table[:, at], digits[at])

    return samples_of_columns(name, table, cells if header else (), joints, half)


def _lines(text: str) -> list[str]:
    return [line.partition("#")[0].strip() for line in text.splitlines()]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def check_size(name: str, rows: int, columns: int) -> None:
    """Refuse tables that are too large to be read."""
    if rows * columns > 4 * MOST.positions or columns > 3 * MOST.joints + 1:
        raise CaseError(name, "", f"{rows} rows of {columns} columns are too many; keep fewer")


def _numbers(text: str, name: str, separator: str | None, skip: bool, columns: int) -> Array:
    check_size(name, text.count("\n"), columns)
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
        raise CaseError(name, "", "contains no rows of numbers; give one row per sample")
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
                f"{len(cells)} cells, but the first line has {columns}; give every row as many",
            )
        for k, cell in enumerate(cells, 1):
            if not _is_number(cell.strip()):
                shown = cell.strip()[:40]
                comma = "; write a decimal point" if re.fullmatch(r"\s*-?\d+,\d+\s*", cell) else ""
                return CaseError(
                    name,
                    f"line {number}, column {k}",
                    f"{shown!r} is not a number{comma or '; give one'}",
                )
    return CaseError(name, "", "is not a table of numbers; give one row per sample")


def samples_of_columns(
    name: str,
    table: Array,
    header: Sequence[str],
    joints: Sequence[str],
    half: Callable[[list[int]], Array],
) -> Samples:
    """Samples of a table of numbers, times in s; without a header time comes first.

    ``half`` gives what the numbers of columns of one kind may be off by.
    """
    # A row that a logger wrote twice says nothing new.
    table = table[np.append(True, (table[1:] != table[:-1]).any(axis=1))]
    if table.shape[1] < 2:
        raise CaseError(name, "", "has one column; give time and a position per joint")
    if header:
        time, columns = column_meaning(name, header)
        labels = tuple(dict.fromkeys(joint for joint, _ in columns))
    else:
        labels = numbered(table.shape[1] - 1)
        time, columns = 0, {(joint, 0): k for k, joint in enumerate(labels, 1)}
    latest = float(np.abs(table[:, time]).max())
    # Seconds from 1970 to the year 10000: later times are milliseconds or less.
    if 253_402_300_800 < latest < np.inf:
        raise CaseError(
            name, "time", f"is {latest:g}, which is not a time in seconds; convert it to seconds"
        )
    if not labels:
        raise CaseError(name, "line 1", "no column holds positions; name one after each joint")
    parts: list[Array | None] = []
    rounded = np.zeros((3, len(labels)))
    for order, word in enumerate(("position", "velocity", "acceleration")):
        missing = [joint for joint in labels if (joint, order) not in columns]
        if missing and (order == 0 or len(missing) < len(labels)):
            raise CaseError(
                name, "line 1", f"no {word} of joint {missing[0]}; give it for every joint"
            )
        at = [columns[joint, order] for joint in labels if not missing]
        parts.append(table[:, at] if at else None)
        if at:
            rounded[order] = half(at)
    rounding = HalfUnits(float(half([time])[0]), rounded)
    position, velocity, acceleration = parts
    assert position is not None
    if velocity is not None and len(position) > 4:
        _refuse_other_unit(name, table[:, time], position, velocity)
    try:
        return Samples(
            tuple(joints) or labels,
            table[:, time],
            position,
            velocity,
            acceleration,
            rounding=rounding,
        )
    except TrajgapError as error:
        raise CaseError(name, "", str(error)) from None


def _refuse_other_unit(name: str, time: Array, position: Array, velocity: Array) -> None:
    """Refuse velocities that are those of the positions but for radians and degrees."""
    with np.errstate(all="ignore"):
        moved = (np.diff(position, axis=0) / np.diff(time)[:, None]).ravel()
        stated = (velocity[1:] + velocity[:-1]).ravel() / 2.0
        alike = (moved @ stated) ** 2 / ((moved @ moved) * (stated @ stated))
        ratio = (moved @ stated) / (stated @ stated)
    for unit, factor in (("rad/s", np.rad2deg(1.0)), ("deg/s", np.deg2rad(1.0))):
        if alike > 0.99 and abs(ratio / factor - 1.0) < 0.05:
            other = "deg" if unit == "rad/s" else "rad"
            raise CaseError(
                name,
                "velocity",
                f"is in {unit} if positions are in {other}; give both in the same unit of angle",
            )


def column_meaning(name: str, header: Sequence[str]) -> tuple[int, dict[tuple[str, int], int]]:
    """Column of times, and of each joint and order."""
    times = [k for k, one in enumerate(header) if _TIME.fullmatch(one.strip().lower())]
    if len(times) != 1:
        columns_are = "no column is" if not times else "several columns are"
        raise CaseError(
            name, "line 1", f"{columns_are} named time; name the column of seconds 'time'"
        )
    columns: dict[tuple[str, int], int] = {}
    for k, one in enumerate(header):
        if k == times[0] or _aside(one.strip().lower()):
            continue
        joint, order = _numbered(one.strip(), header) or _joint(one.strip())
        if not joint:
            raise CaseError(name, "line 1", f"column {k + 1} has no name; name it after its joint")
        if _UNIT.fullmatch(joint):
            raise CaseError(
                name,
                "line 1",
                f"the name {one.strip()!r} ends in a unit; leave it out there, and state --units",
            )
        if (joint, order) in columns:
            raise CaseError(name, "line 1", f"two columns are named {one.strip()!r}; rename one")
        columns[joint, order] = k
    return times[0], columns


def _aside(column: str) -> bool:
    """Whether a column is left out: it is named for what is no part of the motion alone."""
    words = re.split(_GAP, column)
    return not _WORDS.keys() & words and _ASIDE.fullmatch(column) is not None


def _numbered(column: str, header: Sequence[str]) -> tuple[str, int] | None:
    """Joint and order of a column such as qd1, where q1 is another column."""
    found = re.fullmatch(r"([a-z]+)(\d+)", column, re.IGNORECASE)
    order = 0 if found is None else _SYMBOLS.get(found[1].lower(), 0)
    if found is None or order == 0:
        return None
    places = {word + found[2] for word, held in _WORDS.items() if held == 0}
    return next(((x.strip(), order) for x in header if x.strip().lower() in places), None)


def _joint(column: str) -> tuple[str, int]:
    words = "|".join(sorted(_WORDS, key=len, reverse=True))
    for pattern in (rf"(?P<j>.+){_GAP}(?P<w>{words})", rf"(?P<w>{words}){_GAP}(?P<j>.+)"):
        found = re.fullmatch(pattern, column, re.IGNORECASE)
        if found is not None:
            return found["j"], _WORDS[found["w"].lower()]
    return column, 0
