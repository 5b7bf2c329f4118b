"""Options that several commands share, records of options, and what every help text ends with."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import wraps
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, get_type_hints

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


class ExitCode(IntEnum):
    """How the program ends, as every help text says."""

    AGAINST = 1
    """A script must not take the answer for a success: what was asked for does not hold, or every
    run of an optimiser failed."""
    BAD_INPUT = 2
    """That of argument parsers."""
    NOT_PROVED = 3
    """An interval is wider than asked for, or nothing is proved."""
    FAULT = 70
    """EX_SOFTWARE."""
    INTERRUPTED = 130
    """What a shell says of SIGINT."""
    CLOSED_PIPE = 141
    """What a shell says of SIGPIPE."""


def command_group(**settings: Any) -> typer.Typer:
    """A group of commands, whose help this program prints as that of all others."""
    help_names = {"help_option_names": ["-h", "--help"]}
    return typer.Typer(
        add_completion=False, rich_markup_mode=None, context_settings=help_names, **settings
    )


def with_options(command: Callable[..., int]) -> Callable[..., int]:
    """The command with the fields of its records as options, in the place of each record."""
    kinds: dict[str, type[Options]] = {
        name: kind
        for name, kind in get_type_hints(command).items()
        if isinstance(kind, type) and issubclass(kind, Options)
    }
    hints = get_type_hints(command, include_extras=True)
    taken = [
        Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=hint)
        for one in signature(command).parameters.values()
        for name, default, hint in (
            kinds[one.name].declared()
            if one.name in kinds
            else [(one.name, one.default, hints[one.name])]
        )
    ]

    @wraps(command)
    def called(**given: Any) -> int:
        for name, kind in kinds.items():
            given[name] = kind(**{field: given.pop(field) for field, _, _ in kind.declared()})
        return command(**given)

    called.__dict__["__signature__"] = Signature(taken)
    called.__annotations__ = {one.name: one.annotation for one in taken}
    return called


@dataclass(frozen=True)
class Options:
    """A record of options, one a field, that commands take as one parameter."""

    @classmethod
    def declared(cls) -> list[tuple[str, Any, Any]]:
        """Name, default and type of each option."""
        hints = get_type_hints(cls, include_extras=True)
        return [(one.name, one.default, hints[one.name]) for one in fields(cls)]

    @property
    def given(self) -> list[str]:
        """Options that are there, for the message where they do not belong."""
        there = [name for name, usual, _ in self.declared() if getattr(self, name) != usual]
        return [f"--{name.replace('_', '-')}" for name in there]


def count(said: str, *, least: int = 1, **settings: Any) -> Any:
    """The option for a number of starts, seeds or workers: what they make is kept in memory."""
    return typer.Option(min=least, max=10_000, help=said, **settings)


# Arguments and options that several commands share.
Source = Annotated[
    str,
    typer.Argument(metavar="CASE|FILE", help="Id of a published case, suite:NAME, or a case file."),
]
ProblemId = Annotated[
    str | None, typer.Option("--problem", metavar="ID", help="Only this problem of the case.")
]
ReadingId = Annotated[
    str | None, typer.Option("--reading", metavar="ID", help="Only this reading of the case.")
]
NoCache = Annotated[
    bool,
    typer.Option(
        "--no-cache",
        help="Neither keep proofs, optima and replays for later runs nor use kept ones. Kept ones "
        "are verified or judged again before they count.",
    ),
]


@dataclass(frozen=True)
class Selection(Options):
    """What is asked of a case; all of it by default."""

    problem: ProblemId = None
    reading: ReadingId = None
    coupling: Annotated[
        str | None,
        typer.Option(metavar="shared|per-joint", help="Replaces the coupling of the case file."),
    ] = None


def _limit(what: str) -> Any:
    return typer.Option(metavar="L", help=f"{what}: one for all joints, or L,L,...")


@dataclass(frozen=True)
class LimitOptions(Options):
    """Limits that the command line states, and units."""

    velocity: Annotated[str | None, _limit("Largest speed, or a range LOW:HIGH")] = None
    acceleration: Annotated[str | None, _limit("Largest acceleration, or a range LOW:HIGH")] = None
    deceleration: Annotated[str | None, _limit("Largest acceleration while the speed falls")] = None
    jerk: Annotated[str | None, _limit("Largest jerk, or a range LOW:HIGH")] = None
    position: Annotated[str | None, _limit("Range LOW:HIGH of positions")] = None
    limits: Annotated[
        Path | None, typer.Option(metavar="FILE", help="MoveIt's joint_limits.yaml, in rad and m.")
    ] = None
    urdf: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Limits of a URDF, in rad and m.")
    ] = None
    units: Annotated[
        str | None,
        typer.Option(
            metavar="UNIT",
            help="Units of the table and the flags: rad, deg, m, cm or mm; one, or one per joint. "
            "ROS uses rad and m.",
            show_default="rad",
        ),
    ] = None

    @property
    def flags(self) -> dict[str, str | None]:
        """Limits that the command line itself states."""
        quantities = ("velocity", "acceleration", "deceleration", "jerk", "position")
        return {name: getattr(self, name) for name in quantities}


@dataclass(frozen=True)
class CurveOptions(Options):
    """The curve through the way-points of a table."""

    family: Annotated[
        str | None,
        typer.Option(
            help="Curve, by its name in case files or in the literature, or by the degrees of its "
            "segments: 3-5-3, 4-3-3-4, natural-cubic, cubic-b-spline, quintic-polynomials...",
            show_default="3-5-3 for four way-points, else a cubic spline",
        ),
    ] = None
    degree: Annotated[int | None, typer.Option(help="Degree, for a curve that needs one.")] = None


def run_workers(usual: str | bool = True) -> Any:
    """The option of `bench` and `study` that says how many processes run; and its default."""
    return count("Number of processes; the rows do not depend on it.", show_default=usual)


def run_store(usual: str | bool = True) -> Any:
    """The option of both that says where runs are kept; and its default."""
    said = "File that keeps finished runs; these are not repeated."
    return typer.Option(metavar="FILE", help=said, show_default=usual)


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
