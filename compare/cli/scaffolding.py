"""`trajgap new`: a case file from a table, asking for the units that are not given."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path

from ...problem import CHOICES, CaseError, scaffold
from .output import new_output, say


def new_case(
    out: Path,
    table: Path,
    units: Mapping[str, str | None],
    limits: Mapping[str, str | None],
    case_id: str | None,
    family: str | None,
    degree: int | None,
    durations: str | None,
    total: str | None,
) -> None:
    """Write a case file for a table of way-points.

    Parameters
    ----------
    out : Path
        New file.
    table : Path
        CSV.
    units : mapping
        Unit of "position", "velocity", "acceleration", "jerk", "time"; None where not given.
    limits : mapping
        Limits on "velocity", "acceleration", "jerk"; None where not given.
    case_id, family, degree, durations, total : optional
        As in `scaffold`.

    Raises
    ------
    CaseError
        If the table, a unit or the output cannot be used.
    """
    with new_output(out, "OUT") as write:
        needed = ["position", *(name for name, limit in limits.items() if limit is not None)]
        given = {name: unit for name, unit in units.items() if unit is not None}
        # A faulty table should be told before anything is asked.
        guess = {name: CHOICES[name][0] for name in needed} | given

        def written(units: Mapping[str, str]) -> str:
            return scaffold(
                table,
                units,
                case_id=case_id,
                family=family,
                degree=degree,
                durations=durations,
                total=total,
                **limits,
            )

        written(guess)
        for name in (*needed, "time"):
            if name not in given:
                given[name] = _ask(name, str(table))
        write(written(given))
    then = "judges what is claimed" if durations or total else "once claims are filled in"
    say(f"written: {out}\nnext: trajgap audit {shlex.quote(str(out))}  # {then}\n")


def _ask(quantity: str, table: str) -> str:
    """Ask for a unit on a terminal, or read it from a pipe."""
    choices = CHOICES[quantity]
    default = "s" if quantity == "time" else None
    shown = ", ".join(choices) + (f" [{default}]" if default else "")
    while True:
        interactive = sys.stdin.isatty()
        if interactive:
            sys.stderr.write(f"unit of {quantity} in {table} ({shown}): ")
            sys.stderr.flush()
        line = sys.stdin.readline()
        answer = line.strip() or default or ""
        if answer in choices:
            return answer
        if not line or not interactive:
            said = f"{answer!r} is no unit of {quantity}" if answer else "is missing"
            raise CaseError(table, f"--{quantity}-unit", f"{said}; give {' or '.join(choices)}")
