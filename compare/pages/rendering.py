"""A report page as HTML, and as Markdown."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ...problem import visible
from ..blocks import (
    Block,
    CardShown,
    Claimed,
    Drawn,
    Folded,
    Page,
    Prose,
    Terms,
    doi_link,
    link,
    slug,
)
from ..pictures import embedded

_TEMPLATES = Path(__file__).parent / "templates"
"""Where the pages' templates and style lie, as package data."""


def style() -> str:
    """The style sheet that every page carries."""
    return (_TEMPLATES / "style.css").read_text(encoding="utf-8")


@lru_cache(maxsize=1)
def environment() -> Environment:
    """The templates, with what they call."""
    found = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=_visible,
    )
    found.globals["zip"] = zip
    found.filters["slug"] = slug
    found.filters["link"] = link
    found.filters["doi_link"] = doi_link
    found.filters["inline"] = lambda drawn: Markup(embedded(drawn.document, drawn.name))
    found.filters["unescaped"] = Markup
    return found


def _visible(value: object) -> object:
    """What a page prints: plain text with every character visible, markup of ours as it is."""
    if isinstance(value, str) and not isinstance(value, Markup):
        return visible(value, keep="\n")
    return value


def fill_template(path: Path, **values: Any) -> str:
    """Fill a template that lies elsewhere, with the style and the safety of all pages.

    `**values`: what it names; ``style`` is the style sheet.
    """
    shapes = environment().overlay(loader=FileSystemLoader(path.parent))
    return shapes.get_template(path.name).render(style=style(), **values)


def page_text(page: Page) -> str:
    """HTML of one page that stands by itself."""
    return environment().get_template("case.html").render(page=page, style=style())


def markdown(page: Page) -> str:
    """Render a page; pictures are links to the files beside it.

    GitHub-flavoured Markdown, in which text from case files is plain text.
    """
    parts = [f"# {plain(page.title)}", plain(page.trail)]
    if doi_link(page.doi):
        parts.append(f"[{plain(page.doi)}]({doi_link(page.doi)})")
    for section in page.sections:
        parts.append(f"## {plain(section.title)}")
        parts += [_block(page, block) for block in section.blocks]
    return "\n\n".join(part for part in parts if part) + "\n"


def plain(text: str) -> str:
    """Text in which nothing is markup: neither a sign, nor what begins an item of a list."""
    escaped = re.sub(r"([\\`*_\[\]<>#|~$&])", r"\\\1", visible(text, keep="\n"))
    return re.sub(r"(?m)^(\s*)([-+]|\d+[.)])(\s)", r"\1\\\2\3", escaped)


def _block(page: Page, block: Block) -> str:
    if isinstance(block, Prose):
        if block.weight == "heading":
            return f"### {plain(block.text)}"
        word = f"**{plain(block.word)}** " if block.word else ""
        link = f" [{plain(block.doi)}]({doi_link(block.doi)})" if doi_link(block.doi) else ""
        return f"{word}{plain(block.text)}{link}"
    if isinstance(block, Terms):
        return "\n".join(f"- **{plain(name)}**: {_line(said.text)}" for name, said in block.cells)
    if isinstance(block, Drawn):
        link = f"![{_line(block.title)}]({page.picture(block)})"
        return link + (f"\n\n{plain(block.caption)}" if block.caption else "")
    if isinstance(block, Folded):
        inner = [_block(page, one) for one in block.blocks]
        return "\n\n".join([f"### {plain(block.title)}", *inner])
    if isinstance(block, CardShown):
        card = "\n".join(f"- {_line(line)}" for line, _ in block.sentences)
        return card if block.drawn is None else f"{card}\n\n{_block(page, block.drawn)}"
    if isinstance(block, Claimed):
        place = "; ".join(x for x in (block.where, block.printed, block.holds) if x)
        head = f"- **{plain(block.verdict.text)}**: {_line(block.text)} ({_line(place)})"
        answer = [block.answer] if block.answer else []
        reasons = (*block.why, *block.more, *block.beside, *map(str, block.caveats), *answer)
        return "\n".join([head, *(f"  - {_line(reason)}" for reason in reasons)])
    lines = [
        "| " + " | ".join(map(_line, block.columns)) + " |",
        "|" + "---|" * len(block.columns),
        *("| " + " | ".join(map(_line, block.texts(row))) + " |" for row in block.rows),
    ]
    return (f"{plain(block.caption)}\n\n" if block.caption else "") + "\n".join(lines)


def _line(text: str) -> str:
    return "<br>".join(plain(line) for line in text.split("\n"))
