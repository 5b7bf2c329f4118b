"""The role that puts one value of a result into a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst.states import Inliner

from ...problem import TrajgapError
from .results import Results


def shown(value: object, form: str) -> str:
    """A value in a sentence, by a format of Python's such as ``.1f`` or ``.1%``.

    Raises
    ------
    TrajgapError
        If the value is none, or not of the format's kind.
    """
    if value is None or isinstance(value, dict | list):
        raise TrajgapError(f"{value!r} is no single value; name a key further down")
    try:
        return format(value, form)
    except (TypeError, ValueError):
        raise TrajgapError(f"{value!r} cannot be written as {form!r}; change the format") from None


def value_role(
    _name: str,
    rawtext: str,
    text: str,
    lineno: int,
    inliner: Inliner,
    _options: Mapping[str, Any] | None = None,
    _content: Sequence[str] = (),
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """A value by its key: ``NAME:key.key`` or ``NAME:key.key|FORMAT``.

    A key at which nothing stands is an error of the build.
    """
    environment = inliner.document.settings.env
    folder = Path(environment.srcdir, environment.config.trajgap_results)
    key, _, form = text.partition("|")
    environment.note_dependency(str(folder / f"{key.partition(':')[0]}.json"))
    try:
        said = shown(Results(folder).value(key.strip()), form.strip())
    except TrajgapError as error:
        message = inliner.reporter.error(str(error), line=lineno)
        return [inliner.problematic(rawtext, rawtext, message)], [message]
    return [nodes.inline(rawtext, said, classes=["trajgap-value"])], []
