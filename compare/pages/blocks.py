"""What a report page is made of, before it becomes HTML or Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from html import unescape
from typing import ClassVar, TypeAlias
from urllib.parse import quote

from ...problem import file_name
from ..documents import Caveat

GLOSSARY = "glossary.html"
"""The page that explains every word, once for a report."""


@dataclass(frozen=True)
class Cell:
    """One cell of a table.

    Attributes
    ----------
    text : str
        Lines are separated by line feeds.
    mark : str
        Word of the vocabulary that the cell consists of, such as "refuted"; empty for free text.
    number : bool
        Whether it is set right, in digits of equal width.
    anchor : str
        Name under which other cells point here; empty for none.
    target : str
        Name of the cell or section that it points to; empty for none.
    """

    text: str
    mark: str = ""
    number: bool = False
    anchor: str = ""
    target: str = ""


@dataclass(frozen=True)
class Prose:
    """A paragraph; a lead is set larger, a note smaller."""

    text: str
    weight: str = ""
    kind: ClassVar[str] = "prose"


@dataclass(frozen=True)
class Grid:
    """A table.

    Attributes
    ----------
    columns : tuple of str
    rows : tuple of tuple of Cell
    caption : str
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str = ""
    prose: bool = False
    """Whether the last column is prose and gets the room."""
    kind: ClassVar[str] = "grid"

    @property
    def filled(self) -> Grid:
        """The same table without columns in which every cell is empty."""
        kept = [i for i in range(len(self.columns)) if any(row[i].text for row in self.rows)]
        return replace(
            self,
            columns=tuple(self.columns[i] for i in kept),
            rows=tuple(tuple(row[i] for i in kept) for row in self.rows),
        )


@dataclass(frozen=True)
class Terms:
    """Words and what they mean, or names and their values."""

    pairs: tuple[tuple[str, str], ...]
    anchored: bool = False
    """Whether each word can be pointed to."""
    kind: ClassVar[str] = "terms"


@dataclass(frozen=True)
class Drawn:
    """A picture.

    Attributes
    ----------
    name : str
        Made by `file_name`; unique in the page.
    document : str
        SVG.
    title, caption : str
    """

    name: str
    document: str
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
    """The verdict card, with the picture beside it.

    Attributes
    ----------
    lines : tuple of str
        Limits, optimum, improvement.
    errors : tuple of str
    beside : str
        The most charitable explanation; empty for none.
    drawn : Drawn or None
    """

    lines: tuple[str, ...]
    errors: tuple[str, ...]
    beside: str = ""
    drawn: Drawn | None = None
    tally: str = ""
    """How many claims have which word, and how that is known."""
    kind: ClassVar[str] = "card"


@dataclass(frozen=True)
class Claimed:
    """One claim: its words, place and digits, the verdict, and why.

    Attributes
    ----------
    text, where, printed : str
    verdict : Cell
    holds : str
        Under which readings, and what the verdict rests on.
    why : tuple of str
    more : tuple of str
        The rest of the reasons, for a fold.
    caveats : tuple of Caveat
        Each begins and ends as a sentence does.
    answer : str
        What the authors say; empty if they were not asked.
    anchor : str
        Name under which others point here.
    id : str
        Of the claim in the case file.
    """

    text: str
    where: str
    printed: str
    verdict: Cell
    holds: str
    why: tuple[str, ...]
    more: tuple[str, ...]
    caveats: tuple[Caveat, ...]
    anchor: str
    id: str
    answer: str = ""
    also: tuple[str, ...] = ()
    """Anchors of claims of the same words in other places, which this one stands for."""
    kind: ClassVar[str] = "claimed"


@dataclass(frozen=True)
class Behind:
    """What lies behind findings: one cause, what would explain it, and what follows.

    Attributes
    ----------
    weight : Cell
        Its severity.
    says : str
    explanations : tuple of str
    follows : tuple of Cell
        Claims that fall with it, as links.
    """

    weight: Cell
    says: str
    explanations: tuple[str, ...]
    follows: tuple[Cell, ...]
    kind: ClassVar[str] = "behind"


@dataclass(frozen=True)
class Folded:
    """Blocks that the reader may open."""

    title: str
    blocks: tuple[Block, ...]
    kind: ClassVar[str] = "folded"


Plain: TypeAlias = Prose | Grid | Terms | Drawn
"""What may stand anywhere."""
Block: TypeAlias = Plain | CardShown | Claimed | Behind | Folded
"""What a section holds."""


@dataclass(frozen=True)
class Section:
    """A headed part of a page, with the name that links point to."""

    id: str
    title: str
    blocks: tuple[Block, ...]
    folded: bool = False
    """Whether the reader opens it."""


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

    @property
    def doi_link(self) -> str:
        """Address of the paper; empty if the DOI is none."""
        return f"https://doi.org/{quote(self.doi, '/')}" if _DOI.fullmatch(self.doi) else ""


_DOI = re.compile(r"10\.[0-9]{4,9}/[^\s<>\"]+")
"""A DOI, as far as it can be told; other text is shown and leads nowhere."""


def _drawn(blocks: Sequence[Block]) -> Iterator[Drawn]:
    for block in blocks:
        if isinstance(block, Drawn):
            yield block
        elif isinstance(block, CardShown) and block.drawn is not None:
            yield block.drawn
        elif isinstance(block, Folded):
            yield from _drawn(block.blocks)


def link(target: str) -> str:
    """Where a cell's target leads: words to the report's glossary, others within the page."""
    return f"{GLOSSARY}#{target}" if target.startswith("word-") else f"#{target}"


def text(value: object) -> Cell:
    """Cell of free text; None is shown as empty."""
    return Cell("" if value is None else str(value))


def number(value: object) -> Cell:
    """Cell of digits, with a true minus sign; None is shown as empty."""
    return Cell("" if value is None else str(value).replace("-", "−"), number=True)


def word(value: str) -> Cell:
    """Cell of a word from the vocabulary, linked to its meaning in the glossary."""
    return Cell(value, mark=slug(value), target=f"word-{slug(value)}")


def slug(value: str) -> str:
    """Name for links and styles: letters, digits and dashes."""
    return "-".join("".join(c if c.isascii() and c.isalnum() else " " for c in value).split())


def seconds(value: float | None) -> str | None:
    """Time with six decimals; None stays."""
    return None if value is None else f"{value:.6f} s"


def listed(values: Sequence[float], digits: int = 6) -> str:
    """Numbers in a row."""
    return ", ".join(f"{v:.{digits}f}" for v in values)
