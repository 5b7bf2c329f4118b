"""What the extension adds to Sphinx: directives, a role, a style, and what makes a page stale."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

from ..audits import package_version
from .directives import DIRECTIVES
from .roles import value_role

STATIC = Path(__file__).parent / "static"
"""Style and script of the pages: shipped, so that nothing comes from the network."""


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the extension; list ``"trajgap.compare.sphinx"`` in ``extensions`` of conf.py.

    Settings of conf.py: ``trajgap_results``, the folder with JSON documents, and
    ``trajgap_certificates``, a folder with certificates; both relative to conf.py.
    """
    app.add_config_value("trajgap_results", "results", "env", frozenset({str}))
    app.add_config_value("trajgap_certificates", "", "env", frozenset({str}))
    for name, directive in DIRECTIVES.items():
        app.add_directive(name, directive)
    app.add_role("trajgap", value_role)
    app.connect("builder-inited", _add_static)
    app.add_css_file("trajgap.css")
    app.add_js_file("trajgap.js", loading_method="defer")
    return {
        "version": package_version("trajgap"),
        "parallel_read_safe": True,
        "parallel_write_safe": True,
    }


def _add_static(app: Any) -> None:
    app.config.html_static_path.append(str(STATIC))
