"""Templates and style of all pages, how text becomes safe in them, and the page as HTML."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ...problem import visible
from ..blocks import link, slug
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
