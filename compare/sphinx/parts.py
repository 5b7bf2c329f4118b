"""Parts of a page: paragraphs, words of the vocabulary, tables, pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from docutils import nodes
from sphinx.addnodes import only

from ...nlp import Evidence
from ..documents import Waterfall
from ..pictures import Picture, embedded, seconds, svg

_STEPS = (24, 20, 12, 40)
"""Characters of the columns of a table of steps: no word of the first three is broken."""


def paragraph(text: str, *classes: str) -> nodes.paragraph:
    """A paragraph of plain text."""
    return nodes.paragraph("", text, classes=list(classes))


def folded(opening: str, *inside: nodes.Node) -> list[nodes.Node]:
    """Nodes a click away, under a line that says what they are; outside HTML they stand open."""
    held = nodes.container(classes=["trajgap-folded"])
    held += list(inside)
    return [
        nodes.raw("", f"<details><summary>{opening}</summary>", format="html"),
        held,
        nodes.raw("", "</details>", format="html"),
    ]


def badge(word: str) -> nodes.inline:
    """A word of the vocabulary, coloured as on the pages of an audit."""
    return nodes.inline("", word, classes=["trajgap-word", f"trajgap-{word.replace(' ', '-')}"])


def table(
    columns: Sequence[str],
    rows: Iterable[Sequence[nodes.Node | str]],
    *classes: str,
    widths: Sequence[int] = (),
) -> nodes.table:
    """A table of texts and inline nodes; widths in characters, for builders that draw them."""
    found = nodes.table(classes=["trajgap-table", *classes])
    group = nodes.tgroup(cols=len(columns))
    found += group
    for width in widths or [1] * len(columns):
        group += nodes.colspec(colwidth=width)

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


def picture(drawn: Picture, name: str, instead: nodes.Node) -> list[nodes.Node]:
    """A picture inside the page, so it follows the theme; without HTML what it says."""
    inside, elsewhere = only(expr="format_html"), only(expr="not format_html")
    inside += nodes.raw("", framed(embedded(svg(drawn), name)), format="html")
    elsewhere += instead
    return [inside, elsewhere]


def steps(waterfall: Waterfall) -> nodes.table:
    """The steps of a waterfall, each with its time, what stands behind it, and its note."""
    rows = [
        (one.name, seconds(one), "" if one.evidence == Evidence.NONE else one.evidence, one.note)
        for one in waterfall.steps
    ]
    return table(("step", "total", "evidence", "note"), rows, "colwidths-given", widths=_STEPS)


def framed(inside: str) -> str:
    """A picture in HTML, in a frame that scrolls, by keys too, where a page is too narrow."""
    return f'<div class="trajgap-picture" tabindex="0">{inside}</div>'
