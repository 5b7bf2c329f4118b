"""What a report page is made of, before it becomes HTML or Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, TypeAlias

from ...problem import file_name


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
    kind: ClassVar[str] = "drawn"


@dataclass(frozen=True)
class Folded:
    """Blocks that the reader may open."""

    title: str
    blocks: tuple[Plain, ...]
    kind: ClassVar[str] = "folded"


Plain: TypeAlias = Prose | Grid | Terms | Drawn
"""What may stand anywhere."""
Block: TypeAlias = Plain | Folded
"""What a section holds."""


@dataclass(frozen=True)
class Section:
    """A headed part of a page, with the name that links point to."""

    id: str
    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Page:
    """One case's page."""

    id: str
    title: str
    sections: tuple[Section, ...]

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
        found: list[Drawn] = []
        for section in self.sections:
            for block in section.blocks:
                inner: Sequence[Block] = block.blocks if isinstance(block, Folded) else (block,)
                found += [one for one in inner if isinstance(one, Drawn)]
        return tuple(found)


def text(value: object) -> Cell:
    """Cell of free text; None is shown as empty."""
    return Cell("" if value is None else str(value))


def number(value: object) -> Cell:
    """Cell of digits, with a true minus sign; None is shown as empty."""
    return Cell("" if value is None else str(value).replace("-", "−"), number=True)


def word(value: str) -> Cell:
    """Cell of a word from the vocabulary, linked to its meaning at the page's end."""
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
