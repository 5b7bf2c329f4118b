"""The command line ``trajgap``: what each command takes, and how it ends."""

from __future__ import annotations

import io
import os
import sys
import traceback
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import typer

from .app_command import app_form
from .bench_command import bench
from .case_app import case_app
from .check_command import check
from .interrupt import INTERRUPTED, catch_interrupts
from .new_command import new
from .options import (
    ENDS,
    MOST,
    AsJson,
    Crate,
    NoCache,
    Out,
    ProblemId,
    ReadingId,
    Source,
    Workers,
)
from .solve_command import solve
from .study_command import study
from .suite_app import suite_app
from .threads import one_thread

# Whatever computes is imported inside the commands, so that --help answers at once.
# The commands of this program.
app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

app.add_typer(suite_app, name="suite")
app.add_typer(case_app, name="case")

BAD_INPUT, FAULT, CLOSED_PIPE = 2, 70, 141
"""Exit codes: that of argument parsers, EX_SOFTWARE, and what a shell says of SIGPIPE."""
_BEGIN = """To begin:
  trajgap audit puma560-mnam-pso-353           judge a published paper
  trajgap new mine.toml --from table.csv       start a case file for your own (see new --help)
  trajgap check motion.csv --urdf arm.urdf     judge a motion against limits
  trajgap solve points.csv --urdf arm.urdf     find the fastest motion through way-points
"""
"""What `trajgap` without a command says first."""
_LONGEST = 1600
"""Characters of an error line, room for eight faults: a longer one quotes the file at length."""


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"trajgap {version('trajgap')}")
        raise typer.Exit


@app.callback(invoke_without_command=True, epilog=ENDS)
def _trajgap(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_version, help="Print the version.")
    ] = False,
) -> None:
    """Audit published time-optimal trajectories against the exact optimum of the same problem."""
    if context.invoked_subcommand is None:
        typer.echo(f"{_BEGIN}\n{context.get_help()}")


@app.command(epilog=ENDS)
def cases(as_json: AsJson = False, out: Out = None) -> int:
    """List the published cases."""
    from .listing import list_cases

    return list_cases(as_json, out)


@app.command(epilog=ENDS)
def show(
    case: Source,
    problem: ProblemId = None,
    reading: ReadingId = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Show what a case holds, and what it leaves open."""
    from .showing import show_case

    return show_case(case, problem, reading, as_json, out)


app.command(epilog=ENDS)(check)


app.command(epilog=ENDS)(solve)


@app.command(epilog=ENDS)
def verify(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Certificates, or states.")
    ],
    case: Annotated[
        str | None,
        typer.Option(
            "--case",
            metavar="CASE",
            help="Id of a published case, or case file: compare the problems, number by number.",
        ),
    ] = None,
    seconds: Annotated[
        float,
        typer.Option("--time", metavar="SECONDS", min=0.0, help="For each file."),
    ] = 60.0,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Prove certificates again, apart from the solver.

    The code that does so imports nothing of it.
    """
    from .certifying import verify_files

    return verify_files(files, case, seconds, as_json, out)


@app.command(epilog=ENDS)
def audit(
    cases: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[CASE|FILE]...",
            help="Ids of published cases, or case files; all published ones by default.",
        ),
    ] = None,
    problem: ProblemId = None,
    reading: ReadingId = None,
    seeds: Annotated[int, typer.Option(min=2, max=MOST, help="Seeds of each replay.")] = 100,
    workers: Workers = None,
    certify_seconds: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            min=0.0,
            help="For each case: time to certify optima that no certificate proves; 0 for none. "
            "By default boxes are counted, so that no verdict depends on the machine.",
        ),
    ] = None,
    certificates: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Certificates to use beside the shipped ones; each is proved again.",
        ),
    ] = None,
    draft: Annotated[
        bool,
        typer.Option("--draft", help="Your own draft: say what to change before you submit it."),
    ] = False,
    no_cache: NoCache = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 if a finding has severity error.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON; write pages only where --out says.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Where the pages go: a new or an empty folder, or that of an earlier audit.",
            show_default="trajgap-audit",
        ),
    ] = None,
    crate: Crate = None,
) -> int:
    """Audit every claim of the cases, and write pages with pictures."""
    from .auditing import audit_cases

    return audit_cases(
        cases or [],
        problem,
        reading,
        seeds,
        workers,
        certify_seconds,
        certificates,
        draft,
        strict,
        as_json,
        out,
        crate,
        not no_cache,
    )


@app.command(epilog=ENDS)
def explain(
    asked: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[RULE|WORD]...", help="Such as TG201 or certified; all are listed by default."
        ),
    ] = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Explain a rule or a word of the reports.

    A rule is explained with what it may conclude and an example. Without an argument, everything
    that can be explained is listed.
    """
    from .explaining import explain

    return explain(asked or [], as_json, out)


app.command(epilog=ENDS)(study)
app.command(epilog=ENDS)(bench)


app.command(epilog=ENDS)(new)
app.command("app", epilog=ENDS)(app_form)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Those of the process by default.

    Returns
    -------
    int
        Exit code.
    """
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, io.StringIO())
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    if arguments is None:
        one_thread()
        catch_interrupts()
    try:
        code = _run(sys.argv[1:] if arguments is None else arguments)
        if code != BAD_INPUT:  # said already, where it is that nothing can be written
            sys.stdout.flush()
        return code
    except BrokenPipeError:
        return CLOSED_PIPE
    except OSError as error:
        return _unwritten(error)
    except KeyboardInterrupt:
        return _fail("interrupted", INTERRUPTED)
    finally:
        _settle()


def _settle() -> None:
    """Drop what standard output did not take: the interpreter would try again at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@cache
def _command() -> Any:
    """The commands as typer's own parser has them, built once a process."""
    return typer.main.get_command(app)


def _run(arguments: Sequence[str]) -> int:
    from ...problem import TrajgapError, check_name
    from .input import check_numbers

    command = _command()
    try:
        for argument in arguments:
            # Nothing that is printed or written could state such a name.
            check_name(argument)
        check_numbers(arguments)
        with command.make_context("trajgap", list(arguments)) as context:
            result = command.invoke(context)
            return result if isinstance(result, int) else 0
    except typer.Exit as end:
        return end.exit_code
    except (BrokenPipeError, KeyboardInterrupt):
        raise
    except Exception as error:
        usage = getattr(error, "format_message", None)
        if usage is not None:
            about = getattr(getattr(error, "ctx", None), "command_path", "trajgap")
            return _fail(f"{str(usage()).rstrip('.')}; see `{about} --help`", BAD_INPUT)
        if isinstance(error, OSError) and error.filename is None:
            return _unwritten(error)
        if isinstance(error, TrajgapError):
            return _fail(str(error), BAD_INPUT)
        traceback.print_exc()
        return _fail("a fault of trajgap itself, please report the lines above", FAULT)


def _unwritten(error: OSError) -> int:
    return _fail(f"standard output: cannot be written ({error.strerror})", BAD_INPUT)


def _fail(message: str, code: int) -> int:
    from ...problem import visible

    line = visible(" ".join(message.split()))
    if len(line) > _LONGEST:
        # The file stands in front, how to fix it at the end.
        line = f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 2 :]}"
    print(f"trajgap: {line}", file=sys.stderr)
    return code
