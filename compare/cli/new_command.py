"""The command `new`: a case file from a table, asking for the units that are not given."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass
from pathlib import Path

from ...problem import CHOICES, CaseError, scaffold
from ...problem.cases import identity_of, units_in_header
from .options import CurveOptions, LimitOptions, Options, argument, option
from .output import new_output, say, warn
from .solve_files import limits_of_table


@dataclass(frozen=True, kw_only=True)
class DraftOptions(Options):
    """The new file, and the table that it is made from."""

    out: Path = argument("OUT.toml")
    """New case file."""
    table: Path = option("TABLE.csv", MISSING, "--from")
    """One way-point a row, one joint a column."""
    position_unit: str | None = option("rad|deg|m|cm|mm")
    """One for all joints, or one per joint, separated by commas: deg,deg,mm."""
    urdf: Path | None = option("FILE")
    """URDF with the limits that are not given below, for the joints that the table names or
    numbers."""
    velocity: str | None = option()
    """One limit for all joints, or one per joint, separated by commas."""
    velocity_unit: str | None = option("rad/s|deg/s|rpm|mm/s|...")
    """One for all joints, or one per joint, separated by commas: deg,deg,mm."""
    acceleration: str | None = option()
    """One limit for all joints, or one per joint, separated by commas."""
    acceleration_unit: str | None = option("rad/s^2|deg/s^2|mm/s^2|...")
    """One for all joints, or one per joint, separated by commas: deg,deg,mm."""
    jerk: str | None = option()
    """One limit for all joints, or one per joint, separated by commas."""
    jerk_unit: str | None = option("rad/s^3|deg/s^3|mm/s^3|...")
    """One for all joints, or one per joint, separated by commas: deg,deg,mm."""
    time_unit: str | None = option("s|ms|min")
    case_id: str | None = option("", None, "--id", usual="the name of OUT")
    """Id of the case."""


@dataclass(frozen=True, kw_only=True)
class ClaimOptions(Options):
    """What the paper prints."""

    durations: str | None = option("H1,H2,...")
    """Printed durations of the segments, recorded as a claim."""
    total: str | None = option()
    """Printed total time, recorded as a claim."""
    where: str | None = option("PLACE")
    """Place where these are printed: Table 2."""


def new(draft: DraftOptions, curve: CurveOptions, claimed: ClaimOptions) -> int:
    """Create a case file from a table of way-points.

    Units that are not given are asked for.
    """
    out, table, urdf = draft.out, draft.table, draft.urdf
    quantities = ("position", "velocity", "acceleration", "jerk", "time")
    units = {name: getattr(draft, f"{name}_unit") for name in quantities}
    limits = {name: getattr(draft, name) for name in ("velocity", "acceleration", "jerk")}
    with new_output(out, "OUT") as write:
        needed = ["position", *(name for name, limit in limits.items() if limit is not None)]
        units["position"] = draft.position_unit or units_in_header(table) or None
        given = {name: unit for name, unit in units.items() if unit is not None}

        def written(stated: Mapping[str, str]) -> str:
            beside = LimitOptions(urdf=urdf, units=stated.get("position"))
            return scaffold(
                table,
                stated,
                case_id=identity_of(out.stem) if draft.case_id is None else draft.case_id,
                family=curve.family,
                degree=curve.degree,
                durations=claimed.durations,
                total=claimed.total,
                where=claimed.where or "",
                limits_of=None if urdf is None else limits_of_table(str(table), beside),
                warn=doubts.append,
                **limits,
            )

        doubts: list[str] = []

        faults: list[tuple[str, str]] = []
        file = ""
        # A faulty table or option should be refused before anything is asked.
        guess = {name: CHOICES[name][0] for name in needed} | given
        try:
            written(guess)
        except CaseError as error:
            file, faults = error.file, [(_option(field), why) for field, why in error.faults]
        asked = [name for name in (*needed, "time") if name not in given]
        if faults:
            # Nobody is asked in vain; what a pipe does not hold either is named with the faults.
            asked = [] if _interactive() else [name for name in asked if name != "time"]
        for name in asked:
            answer = _ask(name, str(table))
            if _known(answer, name):
                given[name] = answer
            else:
                said = f"{answer!r} is not a unit of {name}" if answer else "is missing"
                faults.append((f"--{name}-unit", f"{said}; give one of {', '.join(CHOICES[name])}"))
        if faults:
            raise CaseError(file, *faults[0], faults[1:])
        doubts.clear()
        write(written(given))
    warn(doubts)
    then = (
        "judges what is claimed"
        if claimed.durations or claimed.total
        else "once claims are filled in"
    )
    say(f"written: {out}\nnext: trajgap audit {shlex.quote(str(out))}  # {then}\n")
    return 0


def _option(field: str) -> str:
    """The option of the command line that an argument of `scaffold` comes from."""
    if field.startswith("units."):
        return f"--{field.removeprefix('units.')}-unit"
    options = ("family", "degree", "velocity", "acceleration", "jerk", "durations", "total")
    if field in options:
        return f"--{field}"
    return "--id" if field == "case_id" else field


def _ask(quantity: str, table: str) -> str:
    """Ask for a unit on a terminal until one is given, or read a line of a pipe, which may end."""
    choices = CHOICES[quantity]
    default = "s" if quantity == "time" else None
    shown = ", ".join(choices) + (f" [{default}]" if default else "")
    while True:
        interactive = _interactive()
        if interactive:
            sys.stderr.write(f"unit of {quantity} in {table} ({shown}): ")
            sys.stderr.flush()
        line = ""  # as where standard input has ended
        if sys.stdin is not None:
            with suppress(OSError):
                line = sys.stdin.readline()
        answer = line.strip() or default or ""
        if _known(answer, quantity) or not line or not interactive:
            return answer


def _known(answer: str, quantity: str) -> bool:
    """Whether an answer is a unit, or one for each joint with commas between."""
    choices = CHOICES[quantity]
    several = quantity != "time" and "," in answer
    return all(one.strip() in choices for one in (answer.split(",") if several else [answer]))


def _interactive() -> bool:
    return sys.stdin is not None and sys.stdin.isatty()
