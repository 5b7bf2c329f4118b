"""Blocks as nodes of a page of the site."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from docutils import nodes
from sphinx.addnodes import only, pending_xref

from .. import blocks
from ..documents import capital
from ..pictures import embedded


def nodes_of(shown: Iterable[blocks.Block]) -> list[nodes.Node]:
    """What a page of the site shows of blocks; their folds stand open outside HTML."""
    return [node for block in shown for node in _nodes(block)]


def _nodes(block: blocks.Block) -> Iterator[nodes.Node]:
    if isinstance(block, blocks.Prose):
        yield _prose(block)
    elif isinstance(block, blocks.Grid):
        yield _table(block.columns, block.rows, block.styles, block.marks)
    elif isinstance(block, blocks.Terms):
        rows = [(blocks.Cell(name), value) for name, value in block.cells]
        yield _table(("what", "value"), rows, ("facts",))
    elif isinstance(block, blocks.Drawn):
        # Inside a page a picture follows its theme; without HTML stands what it says.
        inside, elsewhere = only(expr="format_html"), only(expr="not format_html")
        picture = framed(embedded(block.document, block.name))
        inside += nodes.raw("", picture, format="html")
        elsewhere += _paragraph(block.description)
        yield from (inside, elsewhere)
    elif isinstance(block, blocks.CardShown):
        box = nodes.container(classes=["trajgap-card"])
        box += [_paragraph(said, weight) for said, weight in block.sentences]
        yield box
    elif isinstance(block, blocks.Claimed):
        yield _claimed(block)
    elif isinstance(block, blocks.Folded):
        yield from _folded(block.title, nodes_of(block.blocks))


def _paragraph(text: str, weight: str = "") -> nodes.paragraph:
    said = {"note": "beside"}.get(weight, weight)
    return nodes.paragraph("", text, classes=[f"trajgap-{said}"] if said else [])


def _prose(block: blocks.Prose) -> nodes.Element:
    if block.weight == "source":
        return nodes.literal_block(block.text, block.text, language="bibtex")
    made = _paragraph("", block.weight)
    made += [_badge(block.word), nodes.Text(" ")] if block.word else []
    made += nodes.Text(block.text)
    if blocks.doi_link(block.doi):
        made += nodes.Text(" ")
        made += nodes.reference("", f"doi:{block.doi}", refuri=blocks.doi_link(block.doi))
    return made


def _claimed(block: blocks.Claimed) -> nodes.container:
    box = nodes.container(classes=["trajgap-claim"])
    said = nodes.paragraph(classes=["trajgap-said"])
    word, comma, beside = block.verdict.text.partition(", ")
    said += _badge(word)
    said += nodes.Text(f"{comma}{beside} {block.text}")
    place = ". ".join(filter(None, (block.where, block.printed, block.holds)))
    box += [said, _paragraph(capital(place), "beside"), *map(_paragraph, block.why)]
    box += _folded(block.fold, list(map(_paragraph, block.more))) if block.more else []
    box += [_paragraph(one) for one in block.beside]
    box += [_paragraph(str(one), "beside") for one in (*block.caveats, block.answer) if one]
    return box


def _folded(title: str, inside: Sequence[nodes.Node]) -> list[nodes.Node]:
    """Nodes a click away, under a line that says what they are."""
    held = nodes.container(classes=["trajgap-folded"])
    held += list(inside)
    return [
        nodes.raw("", f"<details><summary>{title}</summary>", format="html"),
        held,
        nodes.raw("", "</details>", format="html"),
    ]


def _badge(word: str) -> nodes.inline:
    """A word of the vocabulary, coloured as on the pages of an audit."""
    return nodes.inline("", word, classes=["trajgap-word", f"trajgap-{blocks.slug(word)}"])


def _inline(cell: blocks.Cell) -> Iterator[nodes.Node]:
    """A cell: its first line a badge, code or a link; further ones in grey behind it."""
    first, *others = cell.text.split("\n")
    kind, _, target = cell.target.partition(":")
    if cell.mark:
        yield _badge(first)
    elif cell.code:
        yield nodes.literal("", first)
    elif target:
        yield pending_xref(
            "", nodes.inline("", first), refdomain="std", reftype=kind,
            reftarget=target, refexplicit=True, refwarn=True,
        )  # fmt: skip
    else:
        yield nodes.Text(first)
    for line in others:
        yield nodes.inline("", f" {line}", classes=["trajgap-beside"])


def _table(
    columns: Sequence[str],
    rows: Iterable[Sequence[blocks.Cell]],
    styles: Sequence[str],
    marks: Sequence[str] = (),
) -> nodes.table:
    drawn = "steps" in styles
    given = ["colwidths-given"] if drawn else []
    found = nodes.table(classes=["trajgap-table", *(f"trajgap-{one}" for one in styles), *given])
    group = nodes.tgroup(cols=len(columns))
    for mark in marks or [""] * len(columns):
        group += nodes.colspec(colwidth={"~": 40, ">": 20}.get(mark, 24) if drawn else 1)
    head, body = nodes.thead(), nodes.tbody()
    head += _row(map(blocks.Cell, columns))
    body += [_row(cells) for cells in rows]
    group += [head, body]
    found += group
    return found


def _row(cells: Iterable[blocks.Cell]) -> nodes.row:
    made = nodes.row()
    for cell in cells:
        inside = nodes.paragraph()
        inside += list(_inline(cell))
        made += nodes.entry("", inside)
    return made


def framed(inside: str) -> str:
    """A picture in HTML, in a frame that scrolls, by keys too, where a page is too narrow."""
    return f'<div class="trajgap-picture" tabindex="0">{inside}</div>'
