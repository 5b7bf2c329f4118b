"""The command line ``trajgap case``: what each of its commands takes."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import ENDS, AsJson, Out, Source

# Commands on case files; what computes is imported inside them.
case_app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@case_app.callback(epilog=ENDS)
def case() -> None:
    """Work on case files."""


@case_app.command(epilog=ENDS)
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
    from .diffing import diff_cases

    return diff_cases(first, second, words, as_json, out)
