"""The command line ``trajgap``: its commands, and how it ends."""

from __future__ import annotations

import io
import os
import signal
import sys
import threading
import traceback
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module
from types import FrameType
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from .options import ENDS, ExitCode, check_numbers, command_group, with_options

COMMANDS = {
    "cases": "List the published cases.",
    "show": "Show what a case contains, and what it leaves open.",
    "check": "Judge a motion, or a case's durations, against limits.",
    "solve": "Solve a case exactly: all its problems under all its readings.",
    "verify": "Verify certificates independently of the solver.",
    "audit": "Audit every claim of the cases, and write pages with pictures.",
    "explain": "Explain a rule or a word of the reports.",
    "study": "Run optimisers on many problems; finished runs are kept.",
    "bench": "Show how far optimisers end from the optimum of a case or suite.",
    "new": "Create a case file from a table of way-points.",
    "suite": "List problems whose optimum is known within proved bounds.",
    "case": "Work on case files.",
    "app": "Open a form in the browser.",
}
"""Every command with the first line of its help: NAME_command.py holds the command NAME, and is
imported when it is called, so --help answers at once."""


class _Commands(TyperGroup):
    """The commands, of which only the one that is called is imported."""

    def list_commands(self, ctx: Any) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        return _loaded(cmd_name) if cmd_name in COMMANDS else None

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@cache
def _loaded(name: str) -> Any:
    """One command as the parser has it."""
    found = getattr(import_module(f".{name}_command", __package__), name)
    if not isinstance(found, typer.Typer):
        alone = command_group()
        alone.command(name, epilog=ENDS)(with_options(found))
        found = alone
    command = typer.main.get_command(found)
    command.name = name
    return command


# The commands of this program.
app = command_group(cls=_Commands, pretty_exceptions_enable=False)

_BEGIN = """To begin:
  trajgap audit puma560-mnam-pso-353           judge a published paper
  trajgap new mine.toml --from table.csv       create a case file of your own (see new --help)
  trajgap check motion.csv --urdf arm.urdf     judge a motion against limits
  trajgap solve points.csv --urdf arm.urdf     find the fastest motion through way-points
"""
"""What `trajgap` without a command says first."""


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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns the exit code. `arguments`: those of the process by default.
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
        if code != ExitCode.BAD_INPUT:  # said already, where it is that nothing can be written
            sys.stdout.flush()
        return code
    except BrokenPipeError:
        return ExitCode.CLOSED_PIPE
    except OSError as error:
        return _unwritten(error)
    except KeyboardInterrupt:
        return _fail("interrupted", ExitCode.INTERRUPTED)
    finally:
        try:
            sys.stdout.flush()
        except OSError:
            # The interpreter would try again at its end.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@cache
def _command() -> Any:
    """The commands as typer's own parser has them, built once a process."""
    return typer.main.get_command(app)


def _run(arguments: Sequence[str]) -> int:
    from ...problem import TrajgapError, check_name

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
            return _fail(f"{str(usage()).rstrip('.')}; see `{about} --help`", ExitCode.BAD_INPUT)
        if isinstance(error, OSError) and error.filename is None:
            return _unwritten(error)
        if isinstance(error, TrajgapError):
            return _fail(str(error), ExitCode.BAD_INPUT)
        traceback.print_exc()
        return _fail("this is a bug in trajgap; please report the lines above", ExitCode.FAULT)


def _unwritten(error: OSError) -> int:
    return _fail(f"standard output: cannot be written ({error.strerror})", ExitCode.BAD_INPUT)


def _fail(message: str, code: int) -> int:
    from ...problem import visible

    line = visible(" ".join(message.split()))
    if len(line) > 1600:  # room for eight faults; a longer line quotes the file at length
        # The file stands in front, how to fix it at the end.
        line = f"{line[:800]} ... {line[-800:]}"
    print(f"trajgap: {line}", file=sys.stderr)
    return code


def catch_interrupts() -> None:
    """Answer Ctrl-C with one line and exit code 130.

    CasADi takes a KeyboardInterrupt for the failure of one solve and continues, so raising one is
    not enough.
    """
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, _end)


def _end(signum: int, frame: FrameType | None) -> None:
    # The second Ctrl-C of an impatient hand would only say the same again.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    from ...problem import remove_drafts

    remove_drafts()
    # A progress bar hides the cursor.
    restored = "\x1b[?25h\r\x1b[K" if sys.stderr.isatty() else ""
    with suppress(OSError):
        os.write(2, f"{restored}trajgap: interrupted\n".encode())
    # An exception would unwind whatever runs, and could be printed on its way or be lost in a call.
    os._exit(ExitCode.INTERRUPTED)


LIBRARIES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What the libraries that numpy and scipy are built with read when they are imported."""
EVERY = "OMP_NUM_THREADS"
"""What all of them read where their own variable is missing."""


def one_thread() -> None:
    """Leave linear algebra one thread, unless the environment says how many; before any import.

    Our matrices are small: a second thread waits for work, which on a busy machine takes more
    processor time than all the rest, and sums depend on how many share them. Processes inherit it.
    """
    if EVERY not in os.environ and not any(name in os.environ for name in LIBRARIES):
        os.environ.update(dict.fromkeys((EVERY, *LIBRARIES), "1"))
