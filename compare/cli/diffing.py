"""The command `case diff`: two transcriptions of one paper, field by field."""

from __future__ import annotations

from pathlib import Path

from rich.console import RenderableType

from ...problem import compare_transcriptions
from ..documents import CaseDiffDocument, diff_document, json_text
from .input import read_case
from .output import emit, new_output
from .table import Columns, line


def diff_cases(first: str, second: str, words: bool, as_json: bool, out: Path | None) -> int:
    """Compare two case files; 1 if they differ."""
    with new_output(out) as write:
        one, two = read_case(first), read_case(second)
        document = diff_document(first, second, compare_transcriptions(one, two, words))
        write(json_text(document))
    emit(document, _table, as_json)
    return 1 if document.differences else 0


def _table(document: CaseDiffDocument) -> list[RenderableType]:
    if not document.differences:
        return [line("The two transcriptions agree.")]
    rows = [(one.field, one.first, one.second) for one in document.differences]
    return [Columns(("field", "~first", "~second"), rows)]
