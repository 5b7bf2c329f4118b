"""What a document is laid out as, before it becomes HTML, Markdown, a page of the site or text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from html import unescape
from math import isfinite
from typing import ClassVar, TypeAlias
from urllib.parse import quote

from ...problem import file_name
from ..documents import Caveat, Why

GLOSSARY = "glossary.html"
"""The page that explains every word, once for a report."""


@dataclass(frozen=True)
class Cell:
    """One cell of a table."""

    text: str
    """Lines are separated by line feeds."""
    mark: str = ""
    """Word of the vocabulary that the first line consists of, such as "refuted"; empty for free
    text."""
    target: str = ""
    """Name of the claim, word, file or page that it points to; empty for none."""
    code: bool = False
    """Whether it is taken letter by letter: an id, a file, a command."""


@dataclass(frozen=True)
class Prose:
    """A paragraph; its weight is lead, heading, note, against, warning, source, or none."""

    text: str
    weight: str = ""
    word: str = ""
    """Of the vocabulary, in front of the text; empty for none."""
    doi: str = ""
    """Of what the text names, behind it; empty for none."""

    kind: ClassVar[str] = "prose"


@dataclass(frozen=True)
class Grid:
    """A table, as `table` makes it."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str = ""
    marks: tuple[str, ...] = ()
    """Of each column: > for numbers, ~ for prose, which gets the room, … for what may be cut off
    where there is none; empty for other text."""
    styles: tuple[str, ...] = ()
    """What a page of the site adds to it, such as "sortable"."""
    kind: ClassVar[str] = "grid"

    def mark(self, column: int) -> str:
        """What kind of text a column holds."""
        return self.marks[column] if self.marks else ""

    def texts(self, row: Sequence[Cell]) -> list[str]:
        """What a page shows of a row: numbers have a true minus sign."""
        return [
            cell.text.replace("-", "−") if self.mark(i) == ">" else cell.text
            for i, cell in enumerate(row)
        ]

    @property
    def filled(self) -> Grid:
        """The same table without columns in which every cell is empty."""
        return self.without(
            *(i for i in range(len(self.columns)) if not any(row[i].text for row in self.rows))
        )

    def without(self, *columns: int) -> Grid:
        """The same table without some columns."""
        kept = [i for i in range(len(self.columns)) if i not in columns]
        return replace(
            self,
            columns=tuple(self.columns[i] for i in kept),
            marks=tuple(self.mark(i) for i in kept),
            rows=tuple(tuple(row[i] for i in kept) for row in self.rows),
        )


def table(
    columns: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "", *styles: str
) -> Grid:
    """A table of cells and plain values.

    `columns`: names, each behind one of the marks of `Grid` or none. `rows`: a value that is None,
    or has a reason in its place, is shown as empty.
    """
    marks = tuple(name[0] if name[0:1] in (">", "~", "…") else "" for name in columns)
    return Grid(
        tuple(name.removeprefix(mark) for name, mark in zip(columns, marks, strict=True)),
        tuple(tuple(map(text, row)) for row in rows),
        caption,
        marks,
        styles,
    )


@dataclass(frozen=True)
class Terms:
    """Words and what they mean, or names and their values."""

    pairs: tuple[tuple[str, str | Cell], ...]
    anchored: bool = False
    """Whether each word can be pointed to."""
    kind: ClassVar[str] = "terms"

    @property
    def cells(self) -> tuple[tuple[str, Cell], ...]:
        """Names with their values as cells."""
        return tuple((name, text(value)) for name, value in self.pairs)


@dataclass(frozen=True)
class Drawn:
    """A picture."""

    name: str
    """Made by `file_name`; unique in the page."""
    document: str
    """SVG."""
    title: str
    caption: str = ""
    inside: bool = False
    """Whether it stands in the page itself; others are fetched when they are unfolded."""
    kind: ClassVar[str] = "drawn"

    @property
    def description(self) -> str:
        """What the picture shows, in words, for those who cannot see it."""
        found = re.search(r"<desc[^>]*>(.*?)</desc>", self.document, re.DOTALL)
        return unescape(found[1]) if found else self.title

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels, so the page does not move when it appears."""
        found = re.search(r'viewBox="0 0 ([0-9.]+) ([0-9.]+)"', self.document)
        width, height = (float(found[1]), float(found[2])) if found else (4.0, 3.0)
        return round(width * 4 / 3), round(height * 4 / 3)


@dataclass(frozen=True)
class CardShown:
    """The verdict card, with the picture beside it."""

    verdict: str
    """The verdict in a few words."""
    errors: tuple[str, ...]
    lines: tuple[str, ...]
    """Limits, optimum, improvement."""
    beside: str = ""
    """The most charitable explanation; empty for none."""
    drawn: Drawn | None = None
    tally: str = ""
    """How many claims have which word, and how that is known."""
    kind: ClassVar[str] = "card"

    @property
    def sentences(self) -> tuple[tuple[str, str], ...]:
        """Everything that it says, in order, with the weight of each; no empty ones."""
        own = [(self.verdict, "verdict"), *((line, "against") for line in self.errors)]
        own += [
            *((line, "") for line in self.lines),
            (self.beside, "beside"),
            (self.tally, "tally"),
        ]
        return tuple(one for one in own if one[0])


@dataclass(frozen=True)
class Claimed:
    """One claim: its words, place and digits, the verdict, and why."""

    text: str
    where: str
    printed: str
    verdict: Cell
    holds: str
    """Under which readings, and what the verdict rests on."""
    why: tuple[str, ...]
    more: tuple[str, ...]
    """What is left out of that, for a fold."""
    caveats: tuple[Caveat, ...]
    """Each begins and ends as a sentence does."""
    anchor: str
    """Name under which others point here."""
    id: str
    """Of the claim in the case file."""
    answer: str = ""
    """What the authors say; empty if they were not asked."""
    beside: tuple[str, ...] = ()
    """What else is said of it, such as an innocent explanation."""
    also: tuple[str, ...] = ()
    """Anchors of claims of the same words in other places, which this one stands for."""
    fold: str = "Read on"
    """The line above what a fold holds."""
    kind: ClassVar[str] = "claimed"


@dataclass(frozen=True)
class Folded:
    """Blocks that the reader may open."""

    title: str
    blocks: tuple[Block, ...]
    kind: ClassVar[str] = "folded"


Plain: TypeAlias = Prose | Grid | Terms | Drawn
"""What may stand anywhere."""
Block: TypeAlias = Plain | CardShown | Claimed | Folded
"""What a section holds."""


@dataclass(frozen=True)
class Section:
    """A headed part of a page, with the name that links point to."""

    id: str
    title: str
    blocks: tuple[Block, ...]
    folded: bool = False
    """Whether the reader opens it."""
    target: str = ""
    """File that its title leads to; empty for none."""


@dataclass(frozen=True)
class Page:
    """One case's page."""

    id: str
    title: str
    sections: tuple[Section, ...]
    trail: str = ""
    """Who printed it, when it was audited, and with what."""
    doi: str = ""
    """Of the paper; empty if it is not named."""
    links: tuple[tuple[str, str], ...] = ()
    """Words and files that the head of the page leads to, where it is not a page of an audit."""

    @property
    def filled(self) -> Page:
        """The same page without sections that hold nothing."""
        return replace(self, sections=tuple(s for s in self.sections if s.blocks))

    @property
    def file(self) -> str:
        """Name of its files, without an ending."""
        return file_name(self.id)

    def picture(self, drawn: Drawn) -> str:
        """File of one of its pictures, beside the page; no other page of a report has it."""
        return f"pictures/{file_name(self.id, drawn.name)}.svg"

    @property
    def pictures(self) -> tuple[Drawn, ...]:
        """All pictures, folded or not, in order."""
        return tuple(one for section in self.sections for one in _drawn(section.blocks))


def doi_link(doi: str) -> str:
    """Address of a paper; empty where the text is no DOI, as far as that can be told."""
    known = re.fullmatch(r"10\.[0-9]{4,9}/[^\s<>\"]+", doi)
    return f"https://doi.org/{quote(doi, '/')}" if known else ""


def _drawn(blocks: Sequence[Block]) -> Iterator[Drawn]:
    for block in blocks:
        if isinstance(block, Drawn):
            yield block
        elif isinstance(block, CardShown) and block.drawn is not None:
            yield block.drawn
        elif isinstance(block, Folded):
            yield from _drawn(block.blocks)


def link(target: str) -> str:
    """Where a cell's target leads: words to the report's glossary, claims within the page."""
    if target.endswith(".html"):
        return target
    return f"{GLOSSARY}#{target}" if target.startswith("word-") else f"#{target}"


def text(value: object) -> Cell:
    """A value as a cell; None, and a reason in the place of a value, is shown as empty."""
    if isinstance(value, Cell):
        return value
    return Cell("" if value is None or isinstance(value, Why) else str(value))


def code(value: object) -> Cell:
    """Cell of an id, a file or a command."""
    return Cell(str(value), code=True)


def badge(value: str) -> Cell:
    """Cell of a word from the vocabulary."""
    return Cell(value, mark=slug(value))


def word(value: str) -> Cell:
    """Cell of a word from the vocabulary, linked to its meaning in the glossary of a report."""
    return Cell(value, mark=slug(value), target=f"word-{slug(value)}")


def slug(value: str) -> str:
    """Name for links and styles: letters, digits and dashes."""
    return "-".join("".join(c if c.isascii() and c.isalnum() else " " for c in value).split())


def seconds(value: float | Why, places: int = 6, none: str = "none") -> str:
    """A time without its unit; a word in place of one that is missing or unbounded."""
    known = not isinstance(value, Why) and isfinite(value)
    return f"{value:.{places}f}" if known else none
