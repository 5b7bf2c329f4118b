"""Options about motions: what `check` reads, and what `solve` writes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

MotionSource = Annotated[
    str,
    typer.Argument(
        metavar="CASE|FILE",
        help="A motion: .csv, .parquet, .json, .yaml or a rosbag. With --durations the id of a "
        "published case, suite:NAME, or a case file.",
    ),
]


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
        help="Between samples: none, linear, cubic, quintic, spline, or controller as ROS does.",
        show_default="none; controller for ROS",
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(
        metavar="N",
        help="What positions may be off by: one number, or one a joint; 0 if all are exact.",
        show_default="half a unit of the last digit in the file",
    ),
]
TimeNoise = Annotated[
    float | None,
    typer.Option(
        "--time-noise",
        metavar="S",
        min=0.0,
        help="What times may be off by, s; 0 if they are exact.",
        show_default="half a unit of the last digit in the file",
    ),
]
MotionUnits = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Of table and flags: rad, deg, m, cm or mm, one or one a joint; ROS has rad and m.",
        show_default="rad",
    ),
]
JointNames = Annotated[
    str | None,
    typer.Option(metavar="A,B,...", help="Names of the columns of a table, in order."),
]
Topic = Annotated[str | None, typer.Option(metavar="/NAME", help="Of a rosbag.")]
Tolerance = Annotated[
    float,
    typer.Option(min=0.0, max=1.0, help="Of a motion: relative excess that counts as kept."),
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
        help="With --samples: the path of the answer as TOPPRA times it, under velocity and "
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
