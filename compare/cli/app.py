"""The command line ``trajgap``: what each command takes, and how it ends."""

from __future__ import annotations

import io
import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from .interrupt import INTERRUPTED, catch_interrupts

# Whatever computes is imported inside the commands, so that --help answers at once.
# The commands of this program.
app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

_LIMIT = "Limit of every joint, or one for each with commas between."
"""Help of the three options of `new` that take limits."""
_ENDS = """\b
Exit codes:
  0    done
  1    audit --strict, and a finding has severity error; verify, and a file is refused
  2    bad input; one line on standard error says how to fix it
  3    solve --certify, and an interval is wider than asked for or nothing is proved
  70   a fault of trajgap itself
  130  interrupted
"""
"""What every command's --help ends with."""
BAD_INPUT, FAULT, CLOSED_PIPE = 2, 70, 141
"""Exit codes: that of argument parsers, EX_SOFTWARE, and what a shell says of SIGPIPE."""

MOST = 10_000
"""Largest number of starts, seeds and workers: what they make is kept in memory."""

# Arguments and options that several commands share.
Source = Annotated[
    str, typer.Argument(metavar="CASE|FILE", help="Id of a published case, or a case file.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON (see docs/command-line.md).")]
Out = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Also write the JSON to this new file.")
]
ProblemId = Annotated[
    str | None, typer.Option("--problem", metavar="ID", help="Only this problem of the case.")
]
ReadingId = Annotated[
    str | None, typer.Option("--reading", metavar="ID", help="Only this reading of the case.")
]
Coupled = Annotated[
    str | None,
    typer.Option(
        "--coupling", metavar="shared|per-joint", help="Instead of what the case file says."
    ),
]


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"trajgap {version('trajgap')}")
        raise typer.Exit


@app.callback(invoke_without_command=True, epilog=_ENDS)
def _trajgap(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_version, help="Print the version.")
    ] = False,
) -> None:
    """Audit published time-optimal trajectories against the exact optimum of the same problem."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command(epilog=_ENDS)
def cases(as_json: AsJson = False, out: Out = None) -> int:
    """List the published cases."""
    from .listing import list_cases

    return list_cases(as_json, out)


@app.command(epilog=_ENDS)
def show(
    case: Source,
    problem: ProblemId = None,
    reading: ReadingId = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Show a case: problems, readings, claims, and what the paper leaves open."""
    from .showing import show_case

    return show_case(case, problem, reading, as_json, out)


@app.command(epilog=_ENDS)
def check(
    case: Source,
    durations: Annotated[
        str,
        typer.Option(
            metavar="0.961,1.258,1.078",
            help="Segment durations as printed, in the case's unit of time (s if it states none). "
            "Each number stands for all that round to its digits.",
        ),
    ],
    problem: ProblemId = None,
    reading: ReadingId = None,
    coupling: Coupled = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Judge segment durations, for all t and over all inputs that print alike.

    Under per-joint coupling each joint is judged by itself as well.
    """
    from .checking import check_durations

    return check_durations(case, durations, problem, reading, coupling, as_json, out)


@app.command(epilog=_ENDS)
def solve(
    case: Source,
    problem: ProblemId = None,
    reading: ReadingId = None,
    coupling: Coupled = None,
    starts: Annotated[int, typer.Option(min=1, max=MOST, help="Starts of the solver.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random starts.")] = 0,
    certify: Annotated[
        bool, typer.Option("--certify", help="Prove an interval of each optimum instead.")
    ] = False,
    gap: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            metavar="G",
            help="With --certify: relative width to reach.",
            show_default="1e-6",
        ),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(
            "--time",
            min=0.0,
            metavar="S",
            help="With --certify: seconds for each problem; then the best interval is left.",
            show_default="60",
        ),
    ] = None,
    any_curve: Annotated[
        bool,
        typer.Option(
            "--any-curve",
            help="With --certify: over every motion through the way-points, whatever its curve.",
        ),
    ] = False,
    certificates: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="With --certify: where certificates go, and states of stopped runs.",
            show_default="trajgap-certificates; none with --json",
        ),
    ] = None,
    resume: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="With --certify: go on from this state file, every part of it proved again. "
            "May be given several times.",
        ),
    ] = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Solve a case exactly: all its problems under all its readings.

    With --certify, Ctrl-C leaves the best interval, and a state to go on from.
    """
    if not certify:
        options = {
            "--gap": gap,
            "--time": seconds,
            "--any-curve": any_curve or None,
            "--certificates": certificates,
            "--resume": resume or None,
        }
        for name, value in options.items():
            if value is not None:
                raise typer.BadParameter(f"{name} needs --certify")
        from .solving import solve_case

        return solve_case(case, problem, reading, coupling, starts, seed, as_json, out)
    from ...verify import Subject
    from .certifying import certify_case

    return certify_case(
        case,
        problem,
        reading,
        coupling,
        1e-6 if gap is None else gap,
        60.0 if seconds is None else seconds,
        seed,
        Subject.ANY if any_curve else Subject.DECLARED,
        certificates,
        resume or [],
        as_json,
        out,
    )


@app.command(epilog=_ENDS)
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
    """Prove certificates again, with code that shares nothing with the solver."""
    from .certifying import verify_files

    return verify_files(files, case, seconds, as_json, out)


@app.command(epilog=_ENDS)
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
    workers: Annotated[
        int,
        typer.Option(
            min=1,
            max=MOST,
            help="Processes for the replays; the result does not depend on it. Starting one takes "
            "longer than a few dozen short replays.",
        ),
    ] = 1,
    certify_seconds: Annotated[
        float,
        typer.Option(
            metavar="SECONDS",
            min=0.0,
            help="For each case: time to certify optima that no certificate proves; 0 for none.",
        ),
    ] = 20.0,
    certificates: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Certificates to use beside the shipped ones; each is proved again.",
        ),
    ] = None,
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
        strict,
        as_json,
        out,
    )


@app.command(epilog=_ENDS)
def new(
    out: Annotated[Path, typer.Argument(metavar="OUT.toml", help="New case file.")],
    table: Annotated[
        Path,
        typer.Option(
            "--from", metavar="TABLE.csv", help="One way-point a row, one joint a column."
        ),
    ],
    position_unit: Annotated[str | None, typer.Option(metavar="rad|deg")] = None,
    velocity: Annotated[str | None, typer.Option(help=_LIMIT)] = None,
    velocity_unit: Annotated[str | None, typer.Option(metavar="rad/s|deg/s")] = None,
    acceleration: Annotated[str | None, typer.Option(help=_LIMIT)] = None,
    acceleration_unit: Annotated[str | None, typer.Option(metavar="rad/s^2|deg/s^2")] = None,
    jerk: Annotated[str | None, typer.Option(help=_LIMIT)] = None,
    jerk_unit: Annotated[str | None, typer.Option(metavar="rad/s^3|deg/s^3")] = None,
    time_unit: Annotated[str | None, typer.Option(metavar="s|ms")] = None,
    case_id: Annotated[
        str | None, typer.Option("--id", help="Id of the case.", show_default="the table's name")
    ] = None,
    family: Annotated[
        str | None,
        typer.Option(
            help="Curve, as case files or the literature name it: 3-5-3, 4-3-4, natural-cubic, "
            "cubic-b-spline, quintic-b-spline, quintic-polynomials...",
            show_default="3-5-3 for four way-points, else a cubic spline",
        ),
    ] = None,
    degree: Annotated[int | None, typer.Option(help="Of a curve that needs one.")] = None,
    durations: Annotated[
        str | None,
        typer.Option(metavar="H1,H2,...", help="Printed durations of the segments: a claim."),
    ] = None,
    total: Annotated[str | None, typer.Option(help="Printed total time: a claim.")] = None,
) -> int:
    """Start a case file from a table of way-points; asks for units that are not given."""
    from .scaffolding import new_case

    units = {
        "position": position_unit,
        "velocity": velocity_unit,
        "acceleration": acceleration_unit,
        "jerk": jerk_unit,
        "time": time_unit,
    }
    limits = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    new_case(out, table, units, limits, case_id, family, degree, durations, total)
    return 0


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
        catch_interrupts()
    try:
        code = _run(sys.argv[1:] if arguments is None else arguments)
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


def _run(arguments: Sequence[str]) -> int:
    from ...problem import TrajgapError, check_name

    command = typer.main.get_command(app)
    try:
        for argument in arguments:
            # Nothing that is printed or written could state such a name.
            check_name(argument)
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

    print(f"trajgap: {visible(' '.join(message.split()))}", file=sys.stderr)
    return code
