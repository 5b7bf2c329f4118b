"""What the digits of a file leave open: half a unit of the last place that a column shows."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array

_ALL = 17
"""Significant digits that determine a float64: what shows as many was not rounded any further."""
_NUMBER = re.compile(r"[+-]?(\d*)\.?(\d*)(?:[eE]([+-]?\d{1,4}))?")
"""Digits before and after the point, and the power of ten."""


@dataclass(frozen=True, eq=False)
class HalfUnits:
    """Uncertainty of the numbers in a file from rounding when they were written."""

    time: float = 0.0
    """s."""
    values: ArrayLike = 0.0
    """Shape (3, joints) or broadcast to it. Uncertainty of positions, velocities and accelerations,
    rad, s."""

    def of(self, order: int, joints: int) -> Array:
        """Digits of derivative ``order`` of every joint, shape (joints,)."""
        each = np.broadcast_to(np.asarray(self.values, dtype=np.float64), (3, joints))
        return np.asarray(each[order])


Digits = NDArray[np.int64]
"""Most decimal places, and most significant digits, of each column: shape (columns, 2)."""


def digits_of_text(text: str, separator: str | None, columns: int, lines: int = 2000) -> Digits:
    """Digits of the columns of a table as they stand; cells without a number show none.

    Parameters
    ----------
    separator : str or None
        Between cells; None for blanks.
    lines : int
        Lines that are looked at, spread evenly: some hundredths of a second for a dozen columns. A
        place that stands in none of them can only make the rounding larger.
    """
    rows = (line.partition("#")[0].split(separator) for line in _spread(text, lines))
    return _most((row for row in rows if len(row) == columns), columns)


def digits_of_values(values: Array, lines: int = 2000) -> Digits:
    """Digits of each column of numbers in their shortest form, which ends no number in 0."""
    step = max(1, len(values) // lines)
    return _most((map(repr, row) for row in values[::step].tolist()), values.shape[1])


def _spread(text: str, lines: int) -> Iterator[str]:
    before = -1
    for start in range(0, len(text), max(1, len(text) // lines)):
        first = text.rfind("\n", 0, start) + 1
        if first != before:
            before = first
            last = text.find("\n", first)
            yield text[first : last if last >= 0 else len(text)]


def _most(rows: Iterable[Iterable[str]], columns: int) -> Digits:
    most = np.zeros((columns, 2), dtype=np.int64)
    open_columns = set(range(columns))
    for row in rows:
        for k, cell in enumerate(row):
            if k in open_columns:
                places, significant = _digits(cell.strip())
                most[k] = max(most[k, 0], places), max(most[k, 1], significant)
                if significant >= _ALL:
                    open_columns.discard(k)
        if not open_columns:
            break
    return most


def _digits(cell: str) -> tuple[int, int]:
    found = _NUMBER.fullmatch(cell)
    if found is None:
        return 0, 0
    whole, part, power = found.groups()
    significant = len((whole + part).lstrip("0"))
    if power is not None and not significant:
        significant = len(whole + part)  # 0.00e+00 shows three
    return len(part) - int(power or 0), significant


def half_units(values: Array, digits: Digits) -> Array:
    """What each column may be off by: half a unit of its last place, shape (columns,).

    Programs print a fixed number of decimal places, or of significant digits; both may leave out
    zeros at the end. Of both readings the one that rounds the largest number of the column more
    counts. A column that never changes shows little of its format: the others' counts for it.

    Parameters
    ----------
    values : ndarray, shape (rows, columns)
        Columns that one format has written: all positions, for example.
    digits : ndarray, shape (columns, 2)
    """
    still = np.asarray((values == values[:1]).all(axis=0))
    if still.any():
        digits = np.where(still[:, None], digits.max(axis=0), digits)
    largest = np.nanmax(np.abs(values), axis=0, initial=0.0)
    return np.array(
        [
            _half_unit(int(places), int(significant), float(top))
            for (places, significant), top in zip(digits, largest, strict=True)
        ]
    )


def _half_unit(places: int, significant: int, largest: float) -> float:
    if significant >= _ALL:
        return 0.0
    last = -places
    if significant and 0.0 < largest < math.inf:
        last = max(last, math.floor(math.log10(largest)) - significant + 1)
    # A power of ten is rounded too, by less than this.
    return 0.5 * 10.0 ** min(max(last, -320), 300) * (1.0 + 2.0**-50)
