"""How the site is built: `python -m sphinx -W -b html docs build/site`."""

import sys
from importlib.metadata import version as installed
from pathlib import Path
from typing import Any

from pygments.lexers.special import TextLexer
from sphinx.highlighting import lexers

sys.path.insert(0, str(Path(__file__).parent))
from made_pages import write_pages

# Hosts draw the plan in CONTRIBUTING.md; here it stands as text.
lexers["mermaid"] = TextLexer()

project = "trajgap"
author = "The trajgap authors"
copyright = "The trajgap authors, MIT licence"
version = release = installed("trajgap")

extensions = [
    "myst_parser",  # pages in Markdown
    "sphinx.ext.autodoc",  # the API from its docstrings
    "numpydoc",  # which are written after numpydoc
    "sphinx_gallery.gen_gallery",  # programs with the pictures that they draw
    "sphinx_design",  # cards and tabs
    "trajgap.compare.sphinx",  # our own: audits, certificates, values by key
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["paper", "results", "examples", "gallery/examples", "_build", "_templates"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4
suppress_warnings = ["myst.xref_missing_file_extension"]

trajgap_results = "results"
trajgap_certificates = "../nlp/certificates"

sphinx_gallery_conf = {
    "examples_dirs": "gallery/examples",
    "gallery_dirs": "gallery/generated",
    "image_scrapers": ("trajgap.compare.sphinx.gallery.scrape_pictures", "matplotlib"),
    "capture_repr": (),
    "download_all_examples": False,
    "notebook_extensions": {".py"},  # every program as a notebook too
    "show_signature": False,
    "write_computation_times": False,
    "min_reported_time": 3600,  # s: how long a program took says nothing to a reader
    "abort_on_example_error": True,
}

numpydoc_show_class_members = False
autodoc_typehints = "none"  # the docstrings say types, shapes and units

templates_path = ["_templates"]  # two parts of the theme, with names for those who hear the page
html_theme = "pydata_sphinx_theme"
html_title = "trajgap"
html_theme_options = {
    "navbar_end": ["theme-switcher"],
    "header_links_before_dropdown": 8,  # every part of the site stands in its head
    "secondary_sidebar_items": {"**": ["page-toc"], "index": []},  # the front page has a wide table
    "show_prev_next": True,
    "use_edit_page_button": False,
    "show_toc_level": 2,
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_context = {"default_mode": "auto"}  # light or dark as the reader's system is
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_favicon = "_static/mark.svg"


def link_inside(_app: Any, _page: str, source: list[str]) -> None:
    """The file for contributors is a page of the site, and links to it stay inside."""
    source[0] = source[0].replace("](../../CONTRIBUTING.md", "](../reference/contributing.md")


def plain_bars(
    _app: Any, _what: str, _name: str, _of: Any, _options: Any, lines: list[str]
) -> None:
    """Absolute values, |v|, are not substitutions of reStructuredText."""
    lines[:] = [
        "``".join(
            part if k % 2 else part.replace("|", "\\|") for k, part in enumerate(line.split("``"))
        )
        for line in lines
    ]


def setup(app: Any) -> None:
    """Hooks of this site alone."""
    app.connect("builder-inited", lambda app: write_pages(Path(app.srcdir)))
    app.connect("source-read", link_inside)
    app.connect("autodoc-process-docstring", plain_bars, priority=900)
