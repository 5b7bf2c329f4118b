"""The command `check`: a motion from elsewhere, or the printed durations of a case."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from .motion_options import (
    AccelerationLimit,
    Between,
    DecelerationLimit,
    JerkLimit,
    JointNames,
    LimitsFile,
    MotionSource,
    MotionUnits,
    Noise,
    PositionLimit,
    TimeNoise,
    Tolerance,
    Topic,
    UrdfFile,
    VelocityLimit,
)
from .options import AsJson, Coupled, Out, ProblemId, ReadingId


class MissingOption(typer.BadParameter):
    """An option that only some uses of a command need: said as typer says it of others."""

    def format_message(self) -> str:
        """The message alone."""
        return self.message


def check(
    context: typer.Context,
    case: MotionSource,
    durations: Annotated[
        str | None,
        typer.Option(
            metavar="0.961,1.258,1.078",
            help="Of a case: segment durations as printed, in the case's unit of time (s if it "
            "states none). Each number is taken as rounded to its digits.",
        ),
    ] = None,
    problem: ProblemId = None,
    reading: ReadingId = None,
    coupling: Coupled = None,
    velocity: VelocityLimit = None,
    acceleration: AccelerationLimit = None,
    deceleration: DecelerationLimit = None,
    jerk: JerkLimit = None,
    position: PositionLimit = None,
    limits: LimitsFile = None,
    urdf: UrdfFile = None,
    interpolation: Between = None,
    noise: Noise = None,
    time_noise: TimeNoise = None,
    units: MotionUnits = None,
    joints: JointNames = None,
    topic: Topic = None,
    tolerance: Tolerance = 1e-6,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict", help="Of a motion: exit with 1 unless it passes and all of it is judged."
        ),
    ] = False,
    repair: Annotated[
        Path | None,
        typer.Option(
            "--repair",
            metavar="OUT",
            help="Of a motion that breaks a limit: write it to this new file as it came in (a "
            "table as CSV, a message as JSON), slowed down until it keeps every limit.",
        ),
    ] = None,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Judge a motion, or a case's durations, against limits.

    A motion is judged for all t: samples (CSV, Parquet), piecewise polynomials (JSON), a ROS
    JointTrajectory (YAML, JSON, rosbag). Flags count before --limits, and that before --urdf.

    Durations of a case are judged for all t, as printed and however the digits were rounded.
    Under per-joint coupling each joint is judged by itself as well.
    """
    from .motion_checking import MotionOptions, check_file

    options = MotionOptions(
        {
            "velocity": velocity,
            "acceleration": acceleration,
            "deceleration": deceleration,
            "jerk": jerk,
            "position": position,
        },
        limits,
        urdf,
        interpolation,
        noise,
        time_noise,
        units,
        joints,
        topic,
        tolerance,
        strict,
        repair,
    )
    if math.isnan(tolerance):
        raise typer.BadParameter("--tolerance is no number; give one from 0 to 1")
    if durations is not None:
        if options.names:
            raise typer.BadParameter(f"{options.names[0]} is of a motion; --durations of a case")
        from .checking import check_durations

        return check_durations(case, durations, problem, reading, coupling, as_json, out)
    for name, value in (("problem", problem), ("reading", reading), ("coupling", coupling)):
        if value is not None:
            raise typer.BadParameter(f"--{name} is of a case, which needs --durations")
    from ...problem import published_ids

    if case in published_ids() or case.startswith("suite:") or case.endswith(".toml"):
        raise MissingOption("Missing option '--durations'", ctx=context)
    return check_file(case, options, as_json, out)
