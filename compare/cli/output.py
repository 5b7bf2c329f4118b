"""What the command line writes: JSON, tables, files that are complete or absent, progress."""

from __future__ import annotations

import io
import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import TypeVar

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from ...problem import CaseError, new_file, replace_file, try_writing_in, visible
from ..blocks import Block, CardShown, Grid, Prose, Terms, table
from ..documents import Document, json_text
from ..pages import unwritable
from .options import Options, option

D = TypeVar("D", bound=Document)


def emit(document: D, summary: Callable[[D], Iterable[Block]], as_json: bool) -> None:
    """Print a document, as JSON or as its summary for reading."""
    if as_json:
        # Standard output may not be able to carry more than ASCII.
        plain = not (sys.stdout.encoding or "").lower().startswith("utf")
        text = json_text(document, ascii_only=plain)
    else:
        text = rendered(summary(document))
    say(text)


@dataclass(frozen=True, kw_only=True)
class AnswerOptions(Options):
    """How a command answers: with a summary for reading, or with JSON."""

    as_json: bool = option("", False, "--json")
    """Print JSON (see docs/reference/command-line.md)."""
    out: Path | None = option("FILE")
    """Also write the JSON to this new file."""

    def answer(self, made: Callable[[], D], summary: Callable[[D], Iterable[Block]]) -> D:
        """Make a document, write it to a new file if there is to be one, and print it."""
        with new_output(self.out) as write:
            document = made()
            write(json_text(document))
        emit(document, summary, self.as_json)
        return document


def warn(doubts: Iterable[str]) -> None:
    """Write sentences to standard error, each on a line of its own."""
    for doubt in doubts:
        sys.stderr.write(f"trajgap: {visible(doubt)}\n")


def say(text: str) -> None:
    """Write text to standard output."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        why = unwritable(error, "redirect it elsewhere")
        raise CaseError("standard output", "", why) from None


def rendered(blocks: Iterable[Block]) -> str:
    """Text of what stands open in blocks, coloured only on a terminal and without NO_COLOR.

    Pictures and what is folded are for pages.
    """
    terminal, encoding = sys.stdout.isatty(), sys.stdout.encoding or "utf-8"
    page = io.TextIOWrapper(io.BytesIO(), encoding, errors="replace", newline="")
    console = Console(
        file=page,
        color_system="auto" if terminal and not os.environ.get("NO_COLOR") else None,
        force_terminal=terminal,
        # Nobody's window limits a pipe.
        width=None if terminal or "COLUMNS" in os.environ else 120,
        highlight=False,
        markup=False,
        emoji=False,
    )
    # In a narrow window a table is wider than it: cut digits would be other digits.
    unbounded = console.options.update(max_width=10_000)
    parts = [part for block in blocks for part in _parts(block)]
    bounded = [part for part in parts if not _unbroken(part)]
    needed = (Measurement.get(console, unbounded, part).minimum for part in bounded)
    console.width = max([console.width, *needed])
    for part in parts:
        console.print(part, soft_wrap=_unbroken(part))
    page.seek(0)
    lines = "\n".join(line.rstrip() for line in page.read().split("\n"))
    return re.sub(r"\n{3,}", "\n\n", lines)


def _parts(block: Block) -> Iterator[Text | Columns]:
    """What rich prints of a block."""
    if isinstance(block, Prose):
        # A command that is broken in two cannot be copied.
        command = block.weight == "source"
        said = " ".join(filter(None, (block.word, block.text, block.doi)))
        weights = {
            "heading": "bold",
            "verdict": "bold",
            "note": "dim",
            "tally": "dim",
            "against": "bold red",
            "warning": "yellow",
        }
        yield Text(plain(said), style=weights.get(block.weight, ""), no_wrap=command)
    elif isinstance(block, Grid):
        yield from _parts(Prose(block.caption)) if block.caption else ()
        yield Columns(block)
    elif isinstance(block, Terms):
        yield Columns(table(("", "~"), block.cells))
    elif isinstance(block, CardShown):
        yield from (part for one in block.sentences for part in _parts(Prose(*one)))


def _unbroken(part: object) -> bool:
    return isinstance(part, Text) and part.no_wrap is True


class Steps:
    """A bar on standard error that each call moves one step on; without a bar nothing is shown."""

    def __init__(self, show: Callable[..., None] = lambda **_: None) -> None:
        self._show = show
        self._begun = 0

    def __call__(self, text: str) -> None:
        """Begin the next step."""
        self._show(description=text, completed=self._begun)
        self._begun += 1

    def tell(self, text: str) -> None:
        """Say how the present step goes."""
        self._show(description=text)

    def done(self, text: str) -> None:
        """Count a step that is finished, where they do not come one after another."""
        self._show(description=text, advance=1)


@contextmanager
def progress(label: str, total: int | None = None, rate: bool = False) -> Iterator[Steps]:
    """Show a bar on standard error while something runs, if that is a terminal.

    What it yields is called with a short text before each step. `label`: what runs. `total`: number
    of steps, where it is known. `rate`: whether to show how many steps are done, how many a second,
    and how long the rest takes.
    """
    if not sys.stderr.isatty():
        yield Steps()
        return
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        Task,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    class Rate(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text("" if task.speed is None else f"{task.speed:.1f}/s")

    console = Console(stderr=True, markup=False, highlight=False)
    columns: list[ProgressColumn] = [BarColumn(bar_width=24), TimeElapsedColumn()]
    if rate:
        columns += [MofNCompleteColumn(), Rate(), TextColumn("left:"), TimeRemainingColumn()]
    columns.append(TextColumn("{task.description}"))
    with Progress(*columns, console=console, transient=True) as bar:
        yield Steps(partial(bar.update, bar.add_task(label, total=total)))


@contextmanager
def new_output(path: Path | None, field: str = "--out") -> Iterator[Callable[[str | bytes], None]]:
    """Reserve a new file, which appears under its name only when complete.

    What it yields is called with the whole content, once. `path`: nothing is written if None.
    `field`: the option that names it, for messages.
    """
    if path is None:
        yield lambda _: None
        return
    name = str(path)
    with ExitStack() as stack:
        with _writing(name, field):
            if path.is_dir():
                raise CaseError(name, field, "is a directory; give a file in it")
            put = stack.enter_context(new_file(path))

        def write(content: str | bytes) -> None:
            with _writing(name, field):
                put(content)

        yield write


def replace_output(path: Path, text: str) -> None:
    """Write a complete file in a single step, replacing an earlier one."""
    with _writing(str(path), "--certificates"):
        replace_file(path, text)


def check_certificates(folder: Path) -> None:
    """Find out before computing whether certificates can be written into a folder."""
    with _writing(str(folder), "--certificates"):
        try_writing_in(folder)


@contextmanager
def _writing(name: str, field: str) -> Iterator[None]:
    try:
        yield
    except FileExistsError:
        why = "already exists; give another file or delete this one"
        raise CaseError(name, field, why) from None
    except NotADirectoryError as error:
        if field != "--certificates":
            raise CaseError(name, field, unwritable(error)) from None
        raise CaseError(str(error.filename), field, "is not a folder; give another") from None
    except OSError as error:
        raise CaseError(name, field, unwritable(error)) from None


_STYLES = {
    **dict.fromkeys(("pass", "keeps", "consistent", "optimal", "converged", "supported"), "green"),
    **dict.fromkeys(("violated", "discontinuous", "feasible", "not_attained"), "yellow"),
    **dict.fromkeys(("inconsistent", "depends on the reading", "warning"), "yellow"),
    **dict.fromkeys(("breaks", "infeasible", "failed", "refuted", "error"), "red"),
}
"""Colour of a word: green where all is well, yellow where it may be, red where it is not."""


def plain(text: object) -> str:
    """Text from a file without anything that could steer a terminal."""
    return visible(" ".join(re.split(r"[\n\t]", str(text))))


class Columns:
    """Table in which columns of prose share what the window leaves.

    Whatever else is cut off would say something else, so a table may be wider than the window.
    `least`: characters that prose keeps in the narrowest window.
    """

    def __init__(self, grid: Grid, least: int = 16) -> None:
        self._least = least
        self._names = grid.columns
        self._kinds = [grid.mark(i) for i in range(len(grid.columns))]
        self._rows = [[plain(cell.text) for cell in row] for row in grid.rows]
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
            most = left - others * self._least if cut else left // (others + 1)
            shared[i] = min(self._widths[i], max(self._least, most))
            left -= shared[i]
        return shared

    def _total(self, prose: int) -> int:
        widths = zip(self._widths, self._kinds, strict=True)
        firm = sum(w if kind not in ("~", "…") else min(w, prose) for w, kind in widths)
        return firm + 2 * (len(self._widths) - 1)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(self._total(self._least), self._total(options.max_width))

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        widths = self._shared(options.max_width)
        shape = Table(
            box=box.SIMPLE_HEAD,
            show_edge=False,
            pad_edge=False,
            padding=(0, 1, 0, 0),
            show_header=any(self._names),
        )
        for name, kind, width in zip(self._names, self._kinds, widths, strict=True):
            shape.add_column(
                name,
                justify="right" if kind == ">" else "left",
                no_wrap=kind != "~",
                overflow="fold" if kind == "~" else "ellipsis",
                width=width,
            )
        for row in self._rows:
            shape.add_row(*(Text(cell, style=_STYLES.get(cell, "")) for cell in row))
        yield shape
        yield Text()


def kept_proofs(count: int) -> str:
    """One line for the end of an answer.

    It is about this run, like its seconds: no document says it, so documents are the same
    with and without what was kept.
    """
    proofs = "1 kept proof was" if count == 1 else f"{count} kept proofs were"
    return f"{proofs} verified instead of searched; --no-cache searches again\n"


@contextmanager
def interrupted_by(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Have a function answer Ctrl-C for a while; in another thread than the main one nothing does.

    After a KeyboardInterrupt only processes end: a second Ctrl-C would say the same again.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    except KeyboardInterrupt:
        before = signal.SIG_IGN
        raise
    finally:
        signal.signal(signal.SIGINT, before)
