"""The commands of `suite`: the table, one instance, plain files, pages."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from ...problem import CaseError, TrajgapError, replace_folder
from ...problem.suite import (
    LOADER,
    BenchmarkInstance,
    list_instances,
    load_instance,
    plain_text,
    select_curve,
)
from .. import pages as written
from ..documents import (
    SuiteDocument,
    SuiteShowDocument,
    instance_document,
    json_text,
    suite_document,
    value_or_none,
)
from .options import ENDS, AsJson, Out
from .output import Columns, command, emit, line, new_output, progress, say

# Commands of the suite.
suite = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Folder = Annotated[
    Path,
    typer.Argument(
        metavar="FOLDER", help="A new or an empty folder, or one written by this command."
    ),
]


@suite.callback(epilog=ENDS)
def _suite(
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
    chosen = list_instances() if curve is None else select_curve(curve)
    if not chosen:
        known = ", ".join(sorted({one.curve for one in list_instances()}))
        raise CaseError("suite", "--curve", f"no curve is called {curve!r}; known: {known}")
    with new_output(out) as write:
        document = suite_document(chosen)
        write(json_text(document))
    emit(document, _table, as_json)
    return 0


@suite.command(epilog=ENDS)
def show(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="An instance, with or without `suite:`.")
    ],
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Show an instance: bounds, where it comes from, how hard it is, how to verify it."""
    with new_output(out) as write:
        one = load_instance(name)
        document = instance_document(one, _certificate(one))
        write(json_text(document))
    emit(document, _shown, as_json)
    return 0


@suite.command(epilog=ENDS)
def export(out: Folder) -> int:
    """Write plain instance files, case files, certificates, the table, and a loader."""
    found = {"load_instance.py": LOADER}
    package = files("trajgap.problem.suite")
    for name in (_MARK, "suite.csv"):
        found[name] = package.joinpath(name).read_text(encoding="utf-8")
    instances = list_instances()
    with progress("export", len(instances)) as step:
        for one in instances:
            step(one.name)
            found[f"instances/{one.name}.toml"] = plain_text(one)
            case = package.joinpath("cases", f"{one.name}.toml")
            found[f"cases/{one.name}.toml"] = case.read_text(encoding="utf-8")
            certificate = one.certificate_file()
            if certificate is not None:
                text = certificate.read_text(encoding="utf-8")
                found[f"certificates/{one.name}.json"] = text
    _write(out, found)
    say(f"{len(instances)} instances: {out}\n")
    return 0


@suite.command(epilog=ENDS)
def pages(out: Folder) -> int:
    """Write a page for each instance, and an index."""
    instances = list_instances()
    with progress("pages", len(instances)) as step:
        found = written.suite_pages(instances, step)
    _write(out, {**found, _MARK: json_text(suite_document(instances))})
    say(f"pages: {out / 'index.html'}\n")
    return 0


_MARK = "suite.json"
"""The file by which a folder that was written so is known."""


def _table(document: SuiteDocument) -> list[RenderableType]:
    rows = [
        (
            one.name,
            one.curve,
            one.joints,
            one.segments,
            ", ".join(word[0] for word in one.tight),
            repr(one.lower),
            repr(one.upper),
            f"{one.width:.1e}",
            one.evidence,
        )
        for one in document.instances
    ]
    names = ("instance", "curve", ">joints", ">segments", "tight in", ">lower (s)", ">upper (s)")
    narrow = sum(one.evidence == "certified" for one in document.instances)
    summary = (
        f"suite {document.version}: {len(rows)} instances, {narrow} certified to 1 % or better"
    )
    return [Columns((*names, ">width", "evidence"), rows), line(summary)]


def _certificate(one: BenchmarkInstance) -> str | None:
    """Path of the certificate as a shell takes it."""
    file = one.certificate_file()
    return None if file is None else shlex.quote(str(file))


def _shown(document: SuiteShowDocument) -> list[RenderableType]:
    one, hard = document.instance, value_or_none(document.instance.hardness)
    facts = [
        ("curve", f"{one.curve}, {one.segments} segments, {one.joints} joints"),
        ("source", document.source),
        ("optimum", f"between {one.lower!r} and {one.upper!r} s, width {one.width:.1e}"),
        ("evidence", one.evidence),
        ("lower bound over", one.lower_subject),
        ("best known", ", ".join(f"{h:.9g}" for h in one.segment_durations) + " s"),
        ("tight in", ", ".join(one.tight)),
        ("certificate", str(one.certificate)),
    ]
    verify = value_or_none(document.verify)
    if verify is None:
        facts.append(("verify", str(document.verify)))
    if hard is not None:
        facts += [
            ("basins", f"{hard.basins} found by {hard.starts} random starts; "
             f"{hard.best_basin_share:.0%} of them reach the best"),
            ("feasible share", f"{hard.feasible_share:.2%} of durations drawn within bounds"),
        ]  # fmt: skip
        if hard.baselines:
            rates = ", ".join(f"{name} {rate:.0%}" for name, rate in hard.baselines.items())
            facts.append(
                (
                    "baselines",
                    f"{rates} of {hard.baseline_runs} runs of {hard.baseline_budget} evaluations "
                    "end within 1 %",
                )
            )
    return [
        line(one.name, "bold"),
        line(document.title),
        Columns(("what", "~of this instance"), facts),
        line("made by:"),
        command(one.command),
        *([] if verify is None else [line("verify it:"), command(verify)]),
    ]


def _write(out: Path, found: Mapping[str, str]) -> None:
    """Write a folder at once; only an empty one or one that was written so is replaced.

    Raises
    ------
    CaseError
        If it holds anything else, or cannot be written.
    """
    name = str(out)
    if os.path.lexists(out) and (not out.is_dir() or out.is_symlink()):
        raise CaseError(name, "FOLDER", "is not a folder; give a new one")
    try:
        other = list(out.iterdir()) if out.exists() else []
        if other and not (out / _MARK).is_file():
            held = min(p.name for p in other)
            raise CaseError(name, "FOLDER", f"contains {held}; give a new or an empty folder")
        replace_folder(out, found)
    except TrajgapError:
        raise
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise CaseError(name, "FOLDER", f"cannot be written ({reason}); give another") from None
