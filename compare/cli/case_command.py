"""The command `case diff`: two transcriptions of one paper, field by field."""

from __future__ import annotations

from dataclasses import dataclass

from ...problem import compare_transcriptions
from ..blocks import Block, Prose, table
from ..documents import CaseDiffDocument, DifferingField
from .input import read_case
from .options import ENDS, Options, argument, command_group, option, with_options
from .output import AnswerOptions

# Commands on case files.
case = command_group(no_args_is_help=True)


@case.callback(epilog=ENDS)
def _case() -> None:
    """Work on case files."""


@dataclass(frozen=True, kw_only=True)
class DiffOptions(Options):
    """Two transcriptions."""

    first: str = argument("CASE|FILE")
    """Id of a published case, suite:NAME, or a case file."""
    second: str = argument("CASE|FILE")
    """Id of a published case, suite:NAME, or a case file."""
    words: bool = option("", False)
    """Compare titles, notes and places in the paper too."""


@case.command(epilog=ENDS)
@with_options
def diff(asked: DiffOptions, to: AnswerOptions) -> int:
    """Compare two transcriptions of one paper field by field; exit code 1 if they differ."""
    first, second = asked.first, asked.second
    found = compare_transcriptions(read_case(first), read_case(second), asked.words)
    fields = tuple(map(DifferingField.of, found))
    document = CaseDiffDocument(first=first, second=second, differences=fields)
    to.answer(lambda: document, _table)
    return 1 if fields else 0


def _table(document: CaseDiffDocument) -> list[Block]:
    if not document.differences:
        return [Prose("The two transcriptions agree.")]
    rows = [(one.field, one.first, one.second) for one in document.differences]
    return [table(("field", "~first", "~second"), rows)]
