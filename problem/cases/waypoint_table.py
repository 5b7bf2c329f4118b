"""A table of way-points as text: its joints, the names of its way-points, and its digits."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

from ..errors import CaseError, TrajgapError
from ..printed import CHOICES, MINUS_SIGNS, Printed, unit_meant
from .faults import Faults

_LABEL_HEADERS = (
    *("", "waypoint", "way-point", "way point", "via-point", "via point", "point", "pose"),
    *("label", "name", "no", "no.", "nr", "nr.", "#", "id", "index"),
)
"""Headers, in lower case, of a first column that names way-points and holds no angles."""
_JOINT_HEADERS = ("joint", "joints", "axis", "axes")
"""The same of a first column that names joints: each row is a joint then."""
_JOINT_NAME = re.compile(r"(joint|axis|j|q|θ|theta)[ _-]?[0-9]+", re.IGNORECASE)
"""What papers call a joint; way-points are A, P1, start or 1."""
_UNIT_BEHIND = re.compile(r"(?P<name>.*[^\s/,]) *[/,]? *[\[(](?P<unit>[^\])]+)[\])]")
"""A joint's name with a unit in brackets."""
_TIME_HEADER = re.compile(r"(t|time)( *[\[(].*)?", re.IGNORECASE)
"""A column of instants, with its unit or without."""


@dataclass(frozen=True)
class WaypointTable:
    """Way-points as a table prints them."""

    joints: tuple[str, ...]
    labels: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    """Digits, (way-point, joint)."""
    units: tuple[str, ...]
    """Unit in brackets behind each joint's name, as case files write it; empty where none is."""
    counted: bool
    """Whether nothing but "1, 2, 3" names the joints, which might be angles."""


def read_waypoint_table(faults: Faults, text: str) -> WaypointTable:
    """Read a table; what does not keep its rows from being read is added to the faults.

    Parameters
    ----------
    text : str
        Cells with commas, semicolons, tabs or spaces between.

    Returns
    -------
    WaypointTable
        As far as it can be read, if faults were found.

    Raises
    ------
    CaseError
        If it is not valid CSV.
    """
    lines = _cells(faults, text)
    _, header = lines[0]
    many = len(header)
    whole = [row for _, row in lines[1:] if len(row) == many]
    labelled = header[0].lower() in _LABEL_HEADERS
    transposed = header[0].lower() in _JOINT_HEADERS and many > 1
    # A column without a single number holds names, whatever it is called.
    worded = many > 1 and bool(whole) and not any(map(_is_number, next(zip(*whole, strict=True))))
    first = 1 if labelled or transposed or worded else 0
    names = header[first:]
    if not transposed:
        _name_joints(faults, names, first)
        if first and whole and all(_JOINT_NAME.fullmatch(row[0]) for row in whole):
            faults.add(
                "column 1",
                f"names joints, {whole[0][0]} first; give a row for each way-point, or head this "
                'column "joint" if each row is a joint',
            )
        elif not first and many > 1 and len(whole) > 1:
            _refuse_count(faults, [row[0] for row in whole], header[0])
    for line, row in lines[1:]:
        if len(row) != many:
            cells = f"has {len(row)} cells, but the header has {many}"
            faults.add(f"line {line}", f"{cells}; fill or remove cells")
        for column, cell in enumerate(row[first:], first + 1):
            add_digits(faults, f"line {line}, column {column}", cell)
    numbers = [row[first:] for row in whole]
    labels = [row[0] for row in whole] if first else [str(k + 1) for k in range(len(whole))]
    if transposed:
        _name_joints(faults, labels, first, down=True)
        labels, names = names, labels
        numbers = [list(column) for column in zip(*numbers, strict=True)]
    names, units = _without_units(names)
    points = len(numbers) if transposed else len(lines) - 1
    if points < 2:
        faults.add("", f"contains {points} way-points; give at least two rows of numbers")
    return WaypointTable(
        joints=tuple(names),
        labels=tuple(labels),
        rows=tuple(map(tuple, numbers)),
        units=units,
        counted=not first and bool(names) and _counts(names),
    )


def _without_units(names: Sequence[str]) -> tuple[list[str], tuple[str, ...]]:
    """Names of joints without the units of positions that stand behind them, and those units."""
    found = [_UNIT_BEHIND.fullmatch(name) for name in names]
    units = ["" if one is None else unit_meant(one["unit"]) for one in found]
    units = [unit if unit in CHOICES["position"] else "" for unit in units]
    each = zip(names, found, units, strict=True)
    return [one["name"] if one and unit else name for name, one, unit in each], tuple(units)


def add_digits(faults: Faults, field: str, text: str) -> None:
    """Add what keeps a text from being the digits of a number."""
    try:
        Printed(text)
    except TrajgapError as error:
        fix = str(error)
        if re.fullmatch(r"\s*[-+−]?[0-9]+,[0-9]+\s*", text):
            fix = f"{text!r} has a decimal comma; write a decimal point"
        faults.add(field, fix)


def _cells(faults: Faults, text: str) -> list[tuple[int, list[str]]]:
    """Cells of each line that holds any, with the line's number."""
    filled = [line for line in text.splitlines() if line.strip()]
    words = {len(line.split()) for line in filled}
    separated = any(set(line) & set(",;\t") for line in filled)
    if len(words) == 1 and words != {1} and not separated:
        lines = enumerate(text.splitlines(), 1)
        return [(k, line.split()) for k, line in lines if line.strip()]
    delimiter = max(",;\t", key=text.split("\n", 1)[0].count)
    reader = csv.reader(text.splitlines(), delimiter=delimiter, strict=True)
    found: list[tuple[int, list[str]]] = []
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                found.append((reader.line_num, [cell.strip() for cell in row]))
    except csv.Error as error:
        why = f"not valid CSV, {error}; fix it"
        raise CaseError(faults.file, f"line {reader.line_num}", why) from None
    for line, row in found[1:]:
        parts = row[0].split()
        if len(row) == 1 and len(parts) > 1 and all(map(_is_number, parts)):
            why = f"contains {len(parts)} numbers in one cell, separated by spaces"
            raise CaseError(
                faults.file, f"line {line}", f"{why}; put commas between, in every line"
            )
    return found


def _name_joints(faults: Faults, names: Sequence[str], first: int, down: bool = False) -> None:
    """Add what is wrong with the names of joints, in the first line or down the first column."""
    if not names:
        faults.add("line 1", "names no joint; head one column per joint")
    if any(map(_is_number, names)) and not _counts(names):
        if down:
            faults.add("column 1", "contains numbers; name each joint there, such as J1")
        else:
            why = "contains numbers, but the first line must name the joints; put a header above it"
            faults.add("line 1", why)
        return
    for at, name in enumerate(names):
        where = f"line {at + 2}, column 1" if down else f"line 1, column {first + at + 1}"
        if not name:
            faults.add(where, "the joint has no name; head every column")
        elif name in names[:at]:
            faults.add(where, f"joint {name!r} is named twice; rename one")
        elif _TIME_HEADER.fullmatch(name):
            faults.add(where, f"{name!r} is not a joint; leave instants out, and print durations")


def _refuse_count(faults: Faults, cells: Sequence[str], header: str) -> None:
    """Add that a first column numbers the rows, whatever it is called."""
    if len(cells) > 2 and _counts(cells):
        faults.add(
            "column 1",
            f'numbers the rows; head it "point" instead of {header!r}, or write '
            "1.0 if it belongs to a joint",
        )


def _counts(cells: Sequence[str]) -> bool:
    """Whether cells are 1, 2, 3 and so on."""
    return list(cells) == [str(k + 1) for k in range(len(cells))]


def _is_number(cell: str) -> bool:
    try:
        Printed(cell.translate(MINUS_SIGNS).replace(",", "."))
    except TrajgapError:
        return False
    return True
