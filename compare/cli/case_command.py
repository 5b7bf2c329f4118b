"""The command `case diff`: two transcriptions of one paper, field by field."""

from __future__ import annotations

from typing import Annotated

import typer

from ...problem import compare_transcriptions
from ..blocks import Block, Prose, table
from ..documents import CaseDiffDocument, diff_document, json_text
from .input import read_case
from .options import ENDS, AsJson, Out, Source
from .output import emit, new_output

# Commands on case files.
case = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@case.callback(epilog=ENDS)
def _case() -> None:
    """Work on case files."""


@case.command(epilog=ENDS)
def diff(
    first: Source,
    second: Source,
    words: Annotated[
        bool, typer.Option("--words", help="Compare titles, notes and places in the paper too.")
    ] = False,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Compare two transcriptions of one paper field by field; exit code 1 if they differ."""
    with new_output(out) as write:
        one, two = read_case(first), read_case(second)
        document = diff_document(first, second, compare_transcriptions(one, two, words))
        write(json_text(document))
    emit(document, _table, as_json)
    return 1 if document.differences else 0


def _table(document: CaseDiffDocument) -> list[Block]:
    if not document.differences:
        return [Prose("The two transcriptions agree.")]
    rows = [(one.field, one.first, one.second) for one in document.differences]
    return [table(("field", "~first", "~second"), rows)]
