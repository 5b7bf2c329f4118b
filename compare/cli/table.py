"""Lines and tables on a terminal, safe from what a file may hold."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from ...problem import visible

_NARROWEST = 16
"""Columns that prose keeps in the narrowest window."""
_GAP = 2
"""Columns between two columns of a table."""
_STYLES = {
    "pass": "green",
    "keeps": "green",
    "consistent": "green",
    "optimal": "green",
    "converged": "green",
    "supported": "green",
    "violated": "yellow",
    "discontinuous": "yellow",
    "feasible": "yellow",
    "not_attained": "yellow",
    "inconsistent": "yellow",
    "depends on the reading": "yellow",
    "warning": "yellow",
    "breaks": "red",
    "infeasible": "red",
    "failed": "red",
    "limit": "red",
    "refuted": "red",
    "error": "red",
}
"""Colour of a word: green where all is well, yellow where it may be, red where it is not."""


def plain(text: object) -> str:
    """Text from a file without anything that could steer a terminal."""
    return visible(" ".join(re.split(r"[\n\t]", str(text))))


def line(text: object, style: str = "") -> Text:
    """One line in a style of rich."""
    return Text(plain(text), style=style)


def command(text: object) -> Text:
    """A command on one line, however narrow the window: broken in two it could not be copied."""
    return Text(plain(text), no_wrap=True)


def unbroken(part: object) -> bool:
    """Whether a part of a summary is a `command`."""
    return isinstance(part, Text) and part.no_wrap is True


class Columns:
    """Table in which columns of prose share what the window leaves.

    Before a column's name, > aligns right, ~ lets its prose wrap, … lets it be cut off. Whatever
    else is cut off would say something else, so a table may be wider than the window.
    """

    def __init__(self, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        self._kinds = [c[0] if c[0] in ">~…" else "" for c in columns]
        self._names = [c.removeprefix(k) for c, k in zip(columns, self._kinds, strict=True)]
        self._rows = [[plain(cell) for cell in row] for row in rows]
        lines = [self._names, *self._rows]
        self._widths = [max(map(cell_len, column)) for column in zip(*lines, strict=True)]

    def _shared(self, window: int) -> list[int]:
        """Width of each column: what would be cut off comes first, then the narrow ones."""
        shared = list(self._widths)
        prose = [i for i, kind in enumerate(self._kinds) if kind in ("~", "…")]
        prose.sort(key=lambda i: (self._kinds[i] == "~", self._widths[i]))
        left = window - self._total(0)
        for after, i in enumerate(prose, 1):
            others = len(prose) - after
            cut = self._kinds[i] == "…"
            most = left - others * _NARROWEST if cut else left // (others + 1)
            shared[i] = min(self._widths[i], max(_NARROWEST, most))
            left -= shared[i]
        return shared

    def _total(self, prose: int) -> int:
        widths = zip(self._widths, self._kinds, strict=True)
        firm = sum(w if kind not in ("~", "…") else min(w, prose) for w, kind in widths)
        return firm + _GAP * (len(self._widths) - 1)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(self._total(_NARROWEST), self._total(options.max_width))

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        widths = self._shared(options.max_width)
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
        for name, kind, width in zip(self._names, self._kinds, widths, strict=True):
            table.add_column(
                name,
                justify="right" if kind == ">" else "left",
                no_wrap=kind != "~",
                overflow="fold" if kind == "~" else "ellipsis",
                width=width,
            )
        for row in self._rows:
            table.add_row(*(Text(cell, style=_STYLES.get(cell, "")) for cell in row))
        yield table
        yield Text()
