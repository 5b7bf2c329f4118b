"""The command line ``trajgap suite``: what each of its commands takes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import ENDS, AsJson, Out

# Commands of the suite; what computes is imported inside them.
suite_app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Folder = Annotated[
    Path, typer.Argument(metavar="FOLDER", help="A new or an empty folder, or one written so.")
]


@suite_app.callback(epilog=ENDS)
def suite(
    context: typer.Context,
    curve: Annotated[
        str | None,
        typer.Option(metavar="WORD", help="Only curves with this word in their name: quintic."),
    ] = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """List problems whose optimum is known within proved bounds."""
    if context.invoked_subcommand is not None:
        return 0
    from .suite_listing import list_suite

    return list_suite(curve, as_json, out)


@suite_app.command(epilog=ENDS)
def show(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="An instance, with or without `suite:`.")
    ],
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Show an instance: bounds, where it comes from, how hard it is, how to verify it."""
    from .suite_listing import show_instance

    return show_instance(name, as_json, out)


@suite_app.command(epilog=ENDS)
def export(out: Folder) -> int:
    """Write plain instance files, case files, certificates, the table, and a loader."""
    from .suite_listing import export_suite

    return export_suite(out)


@suite_app.command(epilog=ENDS)
def pages(out: Folder) -> int:
    """Write a page for each instance, and an index."""
    from .suite_listing import write_pages

    return write_pages(out)
