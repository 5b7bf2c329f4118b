"""Parts of a page: paragraphs, words of the vocabulary, tables, pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from docutils import nodes

from ..pictures import Picture, embedded, svg


def paragraph(text: str, *classes: str) -> nodes.paragraph:
    """A paragraph of plain text."""
    return nodes.paragraph("", text, classes=list(classes))


def badge(word: str) -> nodes.inline:
    """A word of the vocabulary, coloured as on the pages of an audit."""
    return nodes.inline("", word, classes=["trajgap-word", f"trajgap-{word.replace(' ', '-')}"])


def table(
    columns: Sequence[str], rows: Iterable[Sequence[nodes.Node | str]], *classes: str
) -> nodes.table:
    """A table of texts and inline nodes."""
    found = nodes.table(classes=["trajgap-table", *classes])
    group = nodes.tgroup(cols=len(columns))
    found += group
    for _ in columns:
        group += nodes.colspec(colwidth=1)

    def row(cells: Sequence[nodes.Node | str]) -> nodes.row:
        made = nodes.row()
        for cell in cells:
            entry = nodes.entry()
            inside = nodes.paragraph()
            inside += nodes.Text(cell) if isinstance(cell, str) else cell
            entry += inside
            made += entry
        return made

    head, body = nodes.thead(), nodes.tbody()
    head += row(list(columns))
    for cells in rows:
        body += row(cells)
    group += head
    group += body
    return found


def picture(drawn: Picture, name: str) -> list[nodes.Node]:
    """A picture inside the page, so that it follows the theme; its words elsewhere."""
    return [nodes.raw("", framed(embedded(svg(drawn), name)), format="html")]


def framed(inside: str) -> str:
    """A picture in HTML, in a frame that scrolls, by keys too, where a page is too narrow."""
    return f'<div class="trajgap-picture" tabindex="0">{inside}</div>'
