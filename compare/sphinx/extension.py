"""What the extension adds to Sphinx: directives, a role, a style, and what makes a page stale."""

from __future__ import annotations

from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxRole
from sphinx.util.typing import ExtensionMetadata

from ...problem import TrajgapError
from ..audits import package_version
from .directives import DIRECTIVES
from .results import Results


def shown(value: object, form: str) -> str:
    """A value in a sentence, by a format of Python's such as ``.1f`` or ``.1%``."""
    if value is None or isinstance(value, dict | list):
        raise TrajgapError(f"{value!r} is not a single value; add another key")
    try:
        return format(value, form)
    except (TypeError, ValueError):
        raise TrajgapError(
            f"{value!r} cannot be formatted as {form!r}; change the format"
        ) from None


class ValueRole(SphinxRole):
    """A value by its key: ``NAME:key.key`` or ``NAME:key.key|FORMAT``.

    A key at which nothing stands is an error of the build.
    """

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """The value, or an error of the build."""
        folder = Path(self.env.srcdir, self.config.trajgap_results)
        key, _, form = self.text.partition("|")
        self.env.note_dependency(str(folder / f"{key.partition(':')[0]}.json"))
        try:
            said = shown(Results(folder).value(key.strip()), form.strip())
        except TrajgapError as error:
            message = self.inliner.reporter.error(str(error), line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, message)], [message]
        return [nodes.inline(self.rawtext, said, classes=["trajgap-value"])], []


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the extension; list ``"trajgap.compare.sphinx"`` in ``extensions`` of conf.py.

    Settings of conf.py: ``trajgap_results``, the folder with JSON documents, and
    ``trajgap_certificates``, a folder with certificates; both relative to conf.py.
    """
    app.add_config_value("trajgap_results", "results", "env", frozenset({str}))
    app.add_config_value("trajgap_certificates", "", "env", frozenset({str}))
    for name, directive in DIRECTIVES.items():
        app.add_directive(name, directive)
    app.add_role("trajgap", ValueRole())
    static = str(Path(__file__).parent / "static")
    app.connect("builder-inited", lambda app: app.config.html_static_path.append(static))
    app.add_css_file("trajgap.css")
    app.add_js_file("trajgap.js", loading_method="defer")
    return {
        "version": package_version("trajgap"),
        "parallel_read_safe": True,
        "parallel_write_safe": True,
    }
