"""Pictures of trajgap in a gallery of examples made by sphinx-gallery."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent
from typing import Any

from ...problem import file_name
from ..pictures import Picture, embedded, svg
from .docutils_nodes import framed

SAVED = "_trajgap_saved"
"""Name under which an example keeps the pictures that stand on its page already."""


def scrape_pictures(_block: object, block_vars: dict[str, Any], gallery_conf: Any) -> str:
    """Save the pictures that a block of an example made, as vectors.

    List ``"trajgap.compare.sphinx.gallery.scrape_pictures"`` in ``image_scrapers`` of
    ``sphinx_gallery_conf``. A picture counts once it has a name, or is what the block ends with.
    Parameters are those that sphinx-gallery passes.

    Returns reStructuredText that shows them, each with its description in words: inside a web page,
    so that they follow its theme and scroll on a phone; as files elsewhere.
    """
    from sphinx_gallery.scrapers import figure_rst

    names = block_vars["example_globals"]
    saved = names.setdefault(SAVED, [])
    shown = []
    for picture in [one for one in names.values() if isinstance(one, Picture)]:
        if not any(picture is one for one in saved):
            saved.append(picture)
            path = Path(next(block_vars["image_path_iterator"])).with_suffix(".svg")
            drawn = svg(picture)
            path.write_text(drawn, encoding="utf-8")
            file = figure_rst([str(path)], gallery_conf["src_dir"], picture.description)
            inside = framed(embedded(drawn, file_name(path.stem)))
            shown += [f".. raw:: html\n\n{indent(inside, '    ')}\n"]
            shown += [f".. only:: not html\n\n{indent(file, '    ')}\n"]
    return "\n".join(shown)
