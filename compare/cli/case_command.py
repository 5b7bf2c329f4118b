"""The command `case diff`: two transcriptions of one paper, field by field."""

from __future__ import annotations

from typing import Annotated

import typer

from ...problem import compare_transcriptions
from ..blocks import Block, Prose, table
from ..documents import CaseDiffDocument, DifferingField
from .input import read_case
from .options import ENDS, Source, command_group, with_options
from .output import Answering

# Commands on case files.
case = command_group(no_args_is_help=True)


@case.callback(epilog=ENDS)
def _case() -> None:
    """Work on case files."""


@case.command(epilog=ENDS)
@with_options
def diff(
    first: Source,
    second: Source,
    words: Annotated[
        bool, typer.Option("--words", help="Compare titles, notes and places in the paper too.")
    ] = False,
    *,
    to: Answering,
) -> int:
    """Compare two transcriptions of one paper field by field; exit code 1 if they differ."""
    found = compare_transcriptions(read_case(first), read_case(second), words)
    fields = tuple(map(DifferingField.of, found))
    document = CaseDiffDocument(first=first, second=second, differences=fields)
    to.answer(lambda: document, _table)
    return 1 if fields else 0


def _table(document: CaseDiffDocument) -> list[Block]:
    if not document.differences:
        return [Prose("The two transcriptions agree.")]
    rows = [(one.field, one.first, one.second) for one in document.differences]
    return [table(("field", "~first", "~second"), rows)]
