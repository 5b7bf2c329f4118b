"""Arguments and options that several commands share, and what every help text ends with."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

ENDS = """\b
Exit codes:
  0    done
  1    audit --strict, and a finding has severity error; verify, and a file is refused;
       case diff, and the files differ; check --strict, and a motion does not pass or something in
       it has no stated limit; bench and study, and every run of an optimiser on a problem failed
  2    bad input; one line on standard error says how to fix it
  3    solve --certify, and an interval is wider than asked for or nothing is proved
  70 a bug in trajgap
  130  interrupted
"""
"""What every command's --help ends with."""

INTERRUPTED = 130
"""Exit code: what a shell says of SIGINT."""
MOST = 10_000
"""Largest number of starts, seeds and workers: what they make is kept in memory."""


def command_group(**settings: Any) -> typer.Typer:
    """A group of commands, whose help this program prints as that of all others."""
    help_names = {"help_option_names": ["-h", "--help"]}
    return typer.Typer(
        add_completion=False, rich_markup_mode=None, context_settings=help_names, **settings
    )


# Arguments and options that several commands share.
Source = Annotated[
    str,
    typer.Argument(metavar="CASE|FILE", help="Id of a published case, suite:NAME, or a case file."),
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Print JSON (see docs/reference/command-line.md).")
]
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
        "--coupling", metavar="shared|per-joint", help="Replaces the coupling of the case file."
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        min=1,
        max=MOST,
        help="Number of processes for the replays; the result does not depend on it. Starting a "
        "process takes longer than a hundred short replays.",
        show_default="all cores; 1 for short replays",
    ),
]
ProofWorkers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        min=1,
        max=MOST,
        help="With --certify: number of cores for the proof; the result does not depend on it.",
        show_default="all cores",
    ),
]
NoCache = Annotated[
    bool,
    typer.Option(
        "--no-cache",
        help="Neither keep proofs, optima and replays for later runs nor use kept ones. Kept ones "
        "are verified or judged again before they count.",
    ),
]
Crate = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.zip",
        help="Also write an RO-Crate for archives to this new file: case files, pages, JSON, "
        "certificates and environment.",
    ),
]


MotionSource = Annotated[
    str,
    typer.Argument(
        metavar="CASE|FILE",
        help="A motion: .csv, .parquet, .json, .yaml or a rosbag. With --durations: the id of a "
        "published case, suite:NAME, or a case file.",
    ),
]


def run_workers(usual: str | bool = True) -> Any:
    """The option of `bench` and `study` that says how many processes run; and its default."""
    said = "Number of processes; the rows do not depend on it."
    return typer.Option("--workers", min=1, max=MOST, help=said, show_default=usual)


def run_store(usual: str | bool = True) -> Any:
    """The option of both that says where runs are kept; and its default."""
    said = "File that keeps finished runs; these are not repeated."
    return typer.Option("--store", metavar="FILE", help=said, show_default=usual)


def _limit(name: str, what: str) -> Any:
    return typer.Option(f"--{name}", metavar="L", help=f"{what}: one for all joints, or L,L,...")


VelocityLimit = Annotated[str | None, _limit("velocity", "Largest speed, or a range LOW:HIGH")]
AccelerationLimit = Annotated[
    str | None, _limit("acceleration", "Largest acceleration, or a range LOW:HIGH")
]
DecelerationLimit = Annotated[
    str | None, _limit("deceleration", "Largest acceleration while the speed falls")
]
JerkLimit = Annotated[str | None, _limit("jerk", "Largest jerk, or a range LOW:HIGH")]
PositionLimit = Annotated[str | None, _limit("position", "Range LOW:HIGH of positions")]
LimitsFile = Annotated[
    Path | None,
    typer.Option("--limits", metavar="FILE", help="MoveIt's joint_limits.yaml, in rad and m."),
]
UrdfFile = Annotated[
    Path | None, typer.Option("--urdf", metavar="FILE", help="Limits of a URDF, in rad and m.")
]
Between = Annotated[
    str | None,
    typer.Option(
        metavar="WORD",
        help="Interpolation between samples: none, linear, cubic, quintic, spline, or controller "
        "(as in ROS).",
        show_default="none; controller for ROS",
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(
        metavar="N",
        help="Uncertainty of the positions: one number, or one per joint; 0 if all are exact.",
        show_default="half a unit of the last digit in the file",
    ),
]
TimeNoise = Annotated[
    float | None,
    typer.Option(
        "--time-noise",
        metavar="S",
        min=0.0,
        help="Uncertainty of the times, s; 0 if they are exact.",
        show_default="half a unit of the last digit in the file",
    ),
]
MotionUnits = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Units of the table and the flags: rad, deg, m, cm or mm; one, or one per joint. ROS "
        "uses rad and m.",
        show_default="rad",
    ),
]
JointNames = Annotated[
    str | None, typer.Option(metavar="A,B,...", help="Names of the columns of a table, in order.")
]
Topic = Annotated[str | None, typer.Option(metavar="/NAME", help="Of a rosbag.")]
Tolerance = Annotated[
    float,
    typer.Option(
        min=0.0,
        max=1.0,
        help="For a motion: relative excess over a limit that still counts as kept.",
    ),
]
SamplesFile = Annotated[
    Path | None,
    typer.Option("--samples", metavar="FILE", help="Write the motion of the answer to this file."),
]
Rate = Annotated[
    float | None,
    typer.Option(min=1e-3, max=1e6, help="With --samples: rows a second.", show_default="500"),
]
Retimed = Annotated[
    bool,
    typer.Option(
        "--retimed",
        help="With --samples: the path of the answer, re-timed by TOPPRA under velocity and "
        "acceleration limits only.",
    ),
]
Form = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="csv|ros|ppoly",
        help="With --samples: rows, a JointTrajectory, or the polynomials.",
        show_default="csv",
    ),
]
Family = Annotated[
    str | None,
    typer.Option(
        help="Curve, by its name in case files or in the literature, or by the degrees of its "
        "segments: 3-5-3, 4-3-3-4, natural-cubic, cubic-b-spline, quintic-polynomials...",
        show_default="3-5-3 for four way-points, else a cubic spline",
    ),
]
Degree = Annotated[int | None, typer.Option(help="Degree, for a curve that needs one.")]


def check_numbers(arguments: Sequence[str]) -> None:
    """Refuse numbers that parsers of options would take for infinite, without a word of it."""
    # A number that may be too large for float64, alone or among others in an argument.
    large = re.compile(
        r"(?<![\w./])(?:(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)[eE]\+?[0-9]+|[0-9]{300,})(?![\w./])"
    )
    for before, argument in zip(("", *arguments), arguments, strict=False):
        for word in large.findall(argument):
            from ...problem import CaseError, TrajgapError, read_float  # few commands need them

            option = before if before.startswith("--") else argument.partition("=")[0]
            try:
                read_float(word)
            except TrajgapError as error:
                raise CaseError(option, "", f"{error}; give less") from None
