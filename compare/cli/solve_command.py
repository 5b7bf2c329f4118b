"""The command `solve`: what it takes, and which of its two answers is wanted."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .motion_options import (
    AccelerationLimit,
    DecelerationLimit,
    Form,
    JerkLimit,
    LimitsFile,
    MotionUnits,
    PositionLimit,
    Rate,
    Retimed,
    SamplesFile,
    UrdfFile,
    VelocityLimit,
)
from .options import (
    FAMILY,
    MOST,
    USUAL,
    AsJson,
    Coupled,
    NoCache,
    Out,
    ProblemId,
    ProofWorkers,
    ReadingId,
)

if TYPE_CHECKING:
    from ...problem import Case
    from .motion_checking import MotionOptions


def solve(
    case: Annotated[
        str,
        typer.Argument(
            metavar="CASE|FILE",
            help="Id of a published case, suite:NAME, a case file, or a table of way-points (CSV) "
            "with limits beside it.",
        ),
    ],
    problem: ProblemId = None,
    reading: ReadingId = None,
    coupling: Coupled = None,
    starts: Annotated[int, typer.Option(min=1, max=MOST, help="Starts of the solver.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random starts.")] = 0,
    prove: Annotated[
        float,
        typer.Option(
            min=0.0,
            metavar="B",
            help="Boxes for the proof of each optimum, as a share of what an audit allows: 0 for "
            "no proof, 1 for some ten seconds.",
        ),
    ] = 0.1,
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
            help="Seconds for each problem; then the best motion, or interval, is left.",
            show_default="none; 60 with --certify",
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
    workers: ProofWorkers = None,
    velocity: VelocityLimit = None,
    acceleration: AccelerationLimit = None,
    deceleration: DecelerationLimit = None,
    jerk: JerkLimit = None,
    position: PositionLimit = None,
    limits: LimitsFile = None,
    urdf: UrdfFile = None,
    units: MotionUnits = None,
    family: Annotated[str | None, typer.Option(help=FAMILY, show_default=USUAL)] = None,
    degree: Annotated[int | None, typer.Option(help="Of a curve that needs one.")] = None,
    samples: SamplesFile = None,
    rate: Rate = None,
    form: Form = None,
    retimed: Retimed = False,
    no_cache: NoCache = False,
    as_json: AsJson = False,
    out: Out = None,
) -> int:
    """Solve a case exactly: all its problems under all its readings.

    Way-points of a table are taken as they stand. Flags count before --limits, and that before
    --urdf.

    With --samples the motion of the answer goes into a file, which is read back and checked.

    With --certify, Ctrl-C leaves the best interval, and a state to go on from.
    """
    from .motion_checking import MotionOptions

    flags = {
        "velocity": velocity,
        "acceleration": acceleration,
        "deceleration": deceleration,
        "jerk": jerk,
        "position": position,
    }
    stated = MotionOptions(flags, limits, urdf, units=units)
    read = _read(case, stated, family, degree)
    if not certify:
        options = {
            "--gap": gap,
            "--any-curve": any_curve or None,
            "--certificates": certificates,
            "--resume": resume or None,
            "--workers": workers,
        }
        for name, value in options.items():
            if value is not None:
                raise typer.BadParameter(f"{name} needs --certify")
        if samples is None and (rate is not None or form is not None or retimed):
            lone = "--rate" if rate is not None else "--retimed" if retimed else "--format"
            raise typer.BadParameter(f"{lone} needs --samples")
        from .motion_writing import asked_samples
        from .solving import solve_case

        asked = None if samples is None else asked_samples(samples, rate, form, retimed)
        return solve_case(
            read, problem, reading, coupling, starts, seed, prove, seconds, as_json, out, asked
        )
    if samples is not None or rate is not None or form is not None or retimed:
        raise typer.BadParameter("--samples is of a solution; leave --certify out")
    from ...verify import Subject
    from .certifying import certify_case

    return certify_case(
        read,
        problem,
        reading,
        coupling,
        1e-6 if gap is None else gap,
        60.0 if seconds is None else seconds,
        seed,
        Subject.ANY if any_curve else Subject.DECLARED,
        certificates,
        resume or [],
        workers or os.cpu_count() or 1,
        as_json,
        out,
        not no_cache,
    )


def _read(source: str, stated: MotionOptions, family: str | None, degree: int | None) -> Case:
    """A case, or a table of way-points with the limits beside it."""
    from .input import read_case

    if source.lower().endswith(".csv"):
        from .points import points_case

        return points_case(source, stated, family, degree)
    curve = [name for name, one in (("--family", family), ("--degree", degree)) if one is not None]
    for name in (*stated.names, *curve):
        raise typer.BadParameter(f"{name} is of a table of way-points (CSV); a case states its own")
    return read_case(source)
