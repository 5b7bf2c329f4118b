"""What the command `new` takes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import FAMILY, LIMIT, USUAL

_UNITS = "One for all joints, or one for each with commas between: deg,deg,mm."
"""Said of each option that takes a unit of joints."""


def new(
    out: Annotated[Path, typer.Argument(metavar="OUT.toml", help="New case file.")],
    table: Annotated[
        Path,
        typer.Option(
            "--from", metavar="TABLE.csv", help="One way-point a row, one joint a column."
        ),
    ],
    position_unit: Annotated[
        str | None, typer.Option(metavar="rad|deg|m|cm|mm", help=_UNITS)
    ] = None,
    velocity: Annotated[str | None, typer.Option(help=LIMIT)] = None,
    velocity_unit: Annotated[
        str | None, typer.Option(metavar="rad/s|deg/s|rpm|mm/s|...", help=_UNITS)
    ] = None,
    acceleration: Annotated[str | None, typer.Option(help=LIMIT)] = None,
    acceleration_unit: Annotated[
        str | None, typer.Option(metavar="rad/s^2|deg/s^2|mm/s^2|...", help=_UNITS)
    ] = None,
    jerk: Annotated[str | None, typer.Option(help=LIMIT)] = None,
    jerk_unit: Annotated[
        str | None, typer.Option(metavar="rad/s^3|deg/s^3|mm/s^3|...", help=_UNITS)
    ] = None,
    time_unit: Annotated[str | None, typer.Option(metavar="s|ms|min")] = None,
    case_id: Annotated[
        str | None, typer.Option("--id", help="Id of the case.", show_default="the name of OUT")
    ] = None,
    family: Annotated[str | None, typer.Option(help=FAMILY, show_default=USUAL)] = None,
    degree: Annotated[int | None, typer.Option(help="Of a curve that needs one.")] = None,
    durations: Annotated[
        str | None,
        typer.Option(metavar="H1,H2,...", help="Printed durations of the segments: a claim."),
    ] = None,
    total: Annotated[str | None, typer.Option(help="Printed total time: a claim.")] = None,
    where: Annotated[
        str | None, typer.Option(metavar="PLACE", help="Where these are printed: Table 2.")
    ] = None,
) -> int:
    """Start a case file from a table of way-points.

    Units that are not given are asked for.
    """
    from .scaffolding import new_case

    units = {
        "position": position_unit,
        "velocity": velocity_unit,
        "acceleration": acceleration_unit,
        "jerk": jerk_unit,
        "time": time_unit,
    }
    limits = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    new_case(out, table, units, limits, case_id, family, degree, durations, total, where)
    return 0
