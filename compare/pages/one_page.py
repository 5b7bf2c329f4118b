"""The page of one case without a folder around it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from jinja2 import FileSystemLoader

from ..audits import CaseAudit
from ..blocks import GLOSSARY, Page
from ..pictures import themed
from .environment import environment, style
from .glossary import glossary
from .writer import case_page, page_text


def page_files(one: CaseAudit, links: tuple[tuple[str, str], ...]) -> dict[str, str]:
    """The page of a case, its pictures and the glossary, by their paths; the page comes first.

    Parameters
    ----------
    links : tuple of (str, str)
        Words and addresses at the head of the page.

    Returns
    -------
    dict of str to str
    """
    page = replace(case_page(one), links=links)
    words = replace(Page("glossary", "How to read a verdict", (glossary(),)), links=links[:1])
    pictures = {page.picture(drawn): themed(drawn.document) for drawn in page.pictures}
    return {f"{page.file}.html": page_text(page), GLOSSARY: page_text(words), **pictures}


def fill_template(path: Path, **values: Any) -> str:
    """Fill a template that lies elsewhere, with the style and the safety of all pages.

    Parameters
    ----------
    **values
        What it names; ``style`` is the style sheet.

    Returns
    -------
    str
    """
    shapes = environment().overlay(loader=FileSystemLoader(path.parent))
    return shapes.get_template(path.name).render(style=style(), **values)
