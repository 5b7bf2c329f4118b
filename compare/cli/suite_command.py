"""The commands of `suite`: the table, one instance, plain files, pages."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import typer

from ...problem import CaseError
from ...problem.suite import (
    LOADER,
    BenchmarkInstance,
    list_instances,
    load_instance,
    plain_text,
    select_curve,
)
from .. import pages as written
from ..blocks import Block, Prose, instance_terms, suite_table
from ..documents import (
    SuiteDocument,
    SuiteShowDocument,
    instance_document,
    json_text,
    suite_document,
    value_or_none,
)
from .options import ENDS, Options, argument, command_group, option, with_options
from .output import AnswerOptions, progress, say

# Commands of the suite.
suite = command_group(invoke_without_command=True)


@dataclass(frozen=True, kw_only=True)
class FolderOptions(Options):
    """Where files go."""

    out: Path = argument("FOLDER")
    """A new or an empty folder, or one written by this command."""


@dataclass(frozen=True, kw_only=True)
class InstanceOptions(Options):
    """An instance."""

    name: str = argument("NAME")
    """An instance, with or without `suite:`."""


@dataclass(frozen=True, kw_only=True)
class ListOptions(Options):
    """Which instances are listed."""

    curve: str | None = option("WORD")
    """Only curves with this word in their name: quintic."""


@suite.callback(epilog=ENDS)
@with_options
def _suite(context: typer.Context, listed: ListOptions, to: AnswerOptions) -> int:
    """List problems whose optimum is known within proved bounds."""
    if context.invoked_subcommand is not None:
        return 0
    curve = listed.curve
    chosen = list_instances() if curve is None else select_curve(curve)
    if not chosen:
        known = ", ".join(sorted({one.curve for one in list_instances()}))
        raise CaseError("suite", "--curve", f"no curve is called {curve!r}; known: {known}")
    certified = sum(one.evidence == "certified" for one in chosen)

    def summary(document: SuiteDocument) -> list[Block]:
        many = f"{len(chosen)} instances, {certified} certified to 1 % or better"
        said = Prose(f"suite {document.version}: {many}")
        return [suite_table(chosen, brief=True), said]

    to.answer(lambda: suite_document(chosen), summary)
    return 0


@suite.command(epilog=ENDS)
@with_options
def show(asked: InstanceOptions, to: AnswerOptions) -> int:
    """Show an instance: bounds, where it comes from, how hard it is, how to verify it."""
    one = load_instance(asked.name)
    file = one.certificate_file()
    path = None if file is None else shlex.quote(str(file))
    to.answer(lambda: instance_document(one, path), lambda shown: _shown(shown, one))
    return 0


@suite.command(epilog=ENDS)
@with_options
def export(to: FolderOptions) -> int:
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
    written.write_folder(to.out, found, _foreign, "a suite", "FOLDER")
    say(f"{len(instances)} instances: {to.out}\n")
    return 0


@suite.command(epilog=ENDS)
@with_options
def pages(to: FolderOptions) -> int:
    """Write a page for each instance, and an index."""
    instances = list_instances()
    with progress("pages", len(instances)) as step:
        found = written.suite_pages(instances, step)
    files = {**found, _MARK: json_text(suite_document(instances))}
    written.write_folder(to.out, files, _foreign, "a suite", "FOLDER")
    say(f"pages: {to.out / 'index.html'}\n")
    return 0


_MARK = "suite.json"
"""The file by which a folder that was written so is known."""


def _shown(document: SuiteShowDocument, one: BenchmarkInstance) -> list[Block]:
    verify = value_or_none(document.verify)
    return [
        Prose(one.name, "heading"),
        Prose(document.title),
        Prose(f"Source: {document.source}"),
        instance_terms(one),
        Prose("made by:"),
        Prose(one.command, "source"),
        Prose("verify it:" if verify else str(document.verify)),
        *([Prose(verify, "source")] if verify else []),
    ]


def _foreign(_: Path, there: list[str]) -> str | None:
    return None if _MARK in there else there[0]
