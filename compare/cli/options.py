"""Options that several commands share, records of options, and what every help text ends with."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Sequence
from dataclasses import MISSING, dataclass, field, fields
from enum import IntEnum
from functools import wraps
from inspect import Parameter, Signature, getsource, signature
from itertools import pairwise
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


@dataclass(frozen=True, kw_only=True)
class Options:
    """A record of options, one a field, that commands take as one parameter.

    The help of an option is the docstring below it.
    """

    @classmethod
    def declared(cls) -> list[tuple[str, Any, Any]]:
        """Name, default and type of each option, as the parser takes them."""
        hints, said = get_type_hints(cls), _docstrings(cls)
        found = []
        for one in fields(cls):
            made, names = one.metadata["made"], one.metadata["names"]
            if hints[one.name] is bool and not names:
                names = (f"--{one.name.replace('_', '-')}",)
            asked = made(*names, help=said.get(one.name), **one.metadata["settings"])
            usual = Parameter.empty if one.default is MISSING else one.default
            found.append((one.name, usual, Annotated[hints[one.name], asked]))
        return found

    @property
    def given(self) -> list[str]:
        """Options that are there, for the message where they do not belong."""
        there = [one.name for one in fields(self) if getattr(self, one.name) != one.default]
        return [f"--{name.replace('_', '-')}" for name in there]


def option(metavar: str = "", default: Any = None, *names: str, **settings: Any) -> Any:
    """An option of a record; settings as typer takes them, and `usual` for a default in words."""
    settings["show_default"] = settings.pop("usual", True)
    own = {"metavar": metavar or None, **settings}
    metadata = {"made": typer.Option, "names": names, "settings": own}
    return field(default=default, metadata=metadata)


def argument(metavar: str, default: Any = MISSING, *, usual: str | bool = True) -> Any:
    """An argument of a record."""
    own = {"metavar": metavar, "show_default": usual}
    return field(default=default, metadata={"made": typer.Argument, "names": (), "settings": own})


def count(default: Any = None, *, least: int = 1, usual: str | bool = True) -> Any:
    """The option for a number of starts, seeds or workers: what they make is kept in memory."""
    return option("", default, min=least, max=10_000, usual=usual)


def _docstrings(kind: type[Options]) -> dict[str, str]:
    """The docstring below each option."""
    found = {}
    for one in kind.__mro__:
        if one is not Options and issubclass(one, Options):
            (declared,) = ast.parse(getsource(one)).body
            for member, below in pairwise(getattr(declared, "body", ())):
                match member, below:
                    case ast.AnnAssign(target=ast.Name(name)), ast.Expr(ast.Constant(str(text))):
                        found[name] = " ".join(text.split())
    return found


def with_options(command: Callable[..., int]) -> Callable[..., int]:
    """The command with the fields of its records as options, in the place of each record."""
    hints = get_type_hints(command)
    kinds: dict[str, type[Options]] = {
        name: kind
        for name, kind in hints.items()
        if isinstance(kind, type) and issubclass(kind, Options)
    }
    taken = [
        Parameter(name, Parameter.KEYWORD_ONLY, default=usual, annotation=hint)
        for one in signature(command).parameters
        for name, usual, hint in (
            kinds[one].declared() if one in kinds else [(one, Parameter.empty, hints[one])]
        )
    ]

    @wraps(command)
    def called(**given: Any) -> int:
        for name, kind in kinds.items():
            given[name] = kind(**{one.name: given.pop(one.name) for one in fields(kind)})
        return command(**given)

    called.__dict__["__signature__"] = Signature(taken)
    called.__annotations__ = {one.name: one.annotation for one in taken}
    return called


@dataclass(frozen=True, kw_only=True)
class CaseOptions(Options):
    """A case."""

    case: str = argument("CASE|FILE")
    """Id of a published case, suite:NAME, or a case file."""


@dataclass(frozen=True, kw_only=True)
class PartOptions(Options):
    """The part of a case that is asked for; all of it by default."""

    problem: str | None = option("ID")
    """Only this problem of the case."""
    reading: str | None = option("ID")
    """Only this reading of the case."""


@dataclass(frozen=True, kw_only=True)
class SelectOptions(PartOptions):
    """The same, and how its joints share durations."""

    coupling: str | None = option("shared|per-joint")
    """Replaces the coupling of the case file."""


@dataclass(frozen=True, kw_only=True)
class CacheOptions(Options):
    """What is kept for later runs."""

    no_cache: bool = option("", False)
    """Neither keep proofs, optima and replays for later runs nor use kept ones. Kept ones are
    verified or judged again before they count."""


@dataclass(frozen=True, kw_only=True)
class LimitOptions(Options):
    """Limits that the command line states, and units."""

    velocity: str | None = option("L")
    """Largest speed, or a range LOW:HIGH: one for all joints, or L,L,..."""
    acceleration: str | None = option("L")
    """Largest acceleration, or a range LOW:HIGH: one for all joints, or L,L,..."""
    deceleration: str | None = option("L")
    """Largest acceleration while the speed falls: one for all joints, or L,L,..."""
    jerk: str | None = option("L")
    """Largest jerk, or a range LOW:HIGH: one for all joints, or L,L,..."""
    position: str | None = option("L")
    """Range LOW:HIGH of positions: one for all joints, or L,L,..."""
    limits: Path | None = option("FILE")
    """MoveIt's joint_limits.yaml, in rad and m."""
    urdf: Path | None = option("FILE")
    """Limits of a URDF, in rad and m."""
    units: str | None = option("UNIT", usual="rad")
    """Units of the table and the flags: rad, deg, m, cm or mm; one, or one per joint. ROS uses rad
    and m."""

    @property
    def flags(self) -> dict[str, str | None]:
        """Limits that the command line itself states."""
        quantities = ("velocity", "acceleration", "deceleration", "jerk", "position")
        return {name: getattr(self, name) for name in quantities}


@dataclass(frozen=True, kw_only=True)
class CurveOptions(Options):
    """The curve through the way-points of a table."""

    family: str | None = option("", usual="3-5-3 for four way-points, else a cubic spline")
    """Curve, by its name in case files or in the literature, or by the degrees of its segments:
    3-5-3, 4-3-3-4, natural-cubic, cubic-b-spline, quintic-polynomials..."""
    degree: int | None = option()
    """Degree, for a curve that needs one."""


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
