"""The command `check`: a motion from elsewhere, or the printed durations of a case."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import typer

from ...problem import Case, Check, Coupling, RoundingBox, check as judge, published_ids
from ..audits import Point, RoundingVerdict, in_words, judge_rounding
from ..blocks import Block, Prose, seconds
from ..documents import (
    BrokenPlace,
    CheckDocument,
    CheckedJoint,
    CheckResult,
    Judged,
    PassingPoint,
    RoundingExhibit,
    Why,
    WorstPeak,
    known,
    reason,
)
from .input import Selected, duration_box, naming, read_case, read_durations, select
from .motion_checking import MotionOptions, check_file
from .motion_results import by_result, place, reasons
from .options import Options, SelectOptions, argument, option
from .output import AnswerOptions, progress


class MissingOption(typer.BadParameter):
    """An option that only some uses of a command need: said as typer says it of others."""

    def format_message(self) -> str:
        """The message alone."""
        return self.message


@dataclass(frozen=True, kw_only=True)
class CheckOptions(Options):
    """What is judged."""

    case: str = argument("CASE|FILE")
    """A motion: .csv, .parquet, .json, .yaml or a rosbag. With --durations: the id of a published
    case, suite:NAME, or a case file."""
    durations: str | None = option("0.961,1.258,1.078")
    """For a case: segment durations as printed, in the case's unit of time (s if it states none).
    Each number counts as rounded to its digits."""


def check(
    context: typer.Context,
    asked: CheckOptions,
    chosen: SelectOptions,
    motion: MotionOptions,
    to: AnswerOptions,
) -> int:
    """Judge a motion, or a case's durations, against limits.

    A motion is judged for all t: samples (CSV, Parquet), piecewise polynomials (JSON), a ROS
    JointTrajectory (YAML, JSON, rosbag). Flags count before --limits, and that before --urdf.

    Durations of a case are judged for all t, as printed and however the digits were rounded.
    Under per-joint coupling each joint is judged separately as well.
    """
    if math.isnan(motion.tolerance):
        raise typer.BadParameter("--tolerance is not a number; give one from 0 to 1")
    case = asked.case
    if asked.durations is not None:
        for name in motion.given:
            raise typer.BadParameter(f"{name} is for a motion, but --durations is for a case")
        return _check_durations(case, asked.durations, chosen, to)
    for name in chosen.given:
        raise typer.BadParameter(f"{name} is for a case, which needs --durations")
    if case in published_ids() or case.startswith("suite:") or case.endswith(".toml"):
        raise MissingOption("Missing option '--durations'", ctx=context)
    return check_file(case, motion, to)


def _check_durations(source: str, text: str, chosen: SelectOptions, to: AnswerOptions) -> int:
    """Judge printed durations under each selected problem and reading."""
    case = read_case(source)
    selected = select(case, chosen.problem, chosen.reading, chosen.coupling)
    printed = read_durations(text, case.file)
    boxes = [duration_box(case, one, printed) for one in selected]

    def made() -> CheckDocument:
        results = []
        with progress("check", len(selected)) as step, naming(case.file):
            for one, box in zip(selected, boxes, strict=True):
                step(in_words(case, one.problem_id, one.reading_id))
                results.append(_checked(case, one, box))
        return CheckDocument(results=tuple(results))

    to.answer(made, lambda shown: _tables(shown, case))
    return 0


def _checked(case: Case, one: Selected, box: RoundingBox) -> CheckResult:
    problem, sides = one.problem, case.waypoint_box(one.problem_id, one.reading_id)
    points = RoundingBox(problem.waypoints, *sides)
    joints: list[tuple[str, Check, RoundingVerdict]] = []
    loose = case.statement(one.problem_id, one.reading_id).loose_ends
    if problem.coupling is Coupling.PER_JOINT:
        for j, label in enumerate(problem.joints):
            alone, own = problem.joint(j), [j]
            column = RoundingBox(points.value[:, own], points.lower[:, own], points.upper[:, own])
            rounding = judge_rounding(alone, box, column, loose_ends=loose)
            joints.append((label, judge(alone, box.value), rounding))
    return check_result(
        case.id,
        one.problem_id,
        one.reading_id,
        problem.coupling,
        judge(problem, box.value),
        judge_rounding(problem, box, points, loose_ends=loose),
        box.value.tolist(),
        joints,
    )


def check_result(
    case: str,
    problem: str,
    reading: str,
    coupling: Coupling,
    found: Check,
    rounding: RoundingVerdict,
    durations: Sequence[float],
    joints: Iterable[tuple[str, Check, RoundingVerdict]] = (),
) -> CheckResult:
    """Result of `check` for one problem under one reading.

    `found`: the durations judged at the printed point, with all joints. `rounding`: judged however
    the digits were rounded. `durations` are in s. `joints`: the same for each joint separately, by
    label.
    """
    alone = tuple(CheckedJoint(joint=label, **dict(_judged(c, r))) for label, c, r in joints)
    return CheckResult(
        case=case,
        problem=problem,
        reading=reading,
        coupling=coupling,
        segment_durations=tuple(durations),
        **dict(_judged(found, rounding)),
        joints=alone or None,
    )


def _judged(found: Check, rounding: RoundingVerdict) -> Judged:
    exhibit: PassingPoint | BrokenPlace | None = None
    shown = rounding.exhibit
    if isinstance(shown, Point):
        exhibit = PassingPoint(
            segment_durations=shown.durations.tolist(), waypoints=shown.waypoints.tolist()
        )
    elif shown is not None:
        exhibit = BrokenPlace.of(shown)
    worst = found.worst
    time = known(worst and worst.time, "a bound on the whole duration")
    return Judged.of(
        found,
        rounding_verdict=rounding.verdict,
        worst=known(worst and WorstPeak.of(worst, time=time), "nothing is limited"),
        feasible_time=known(found.feasible_time, found.feasible_why),
        tight_time=known(found.tight_time, found.tight_why),
        rounding=RoundingExhibit(
            exhibit=exhibit,
            worst_ratio_at_least=known(rounding.lower_bound_of_worst, "no bound was needed"),
        ),
    )


def _tables(document: CheckDocument, case: Case) -> list[Block]:
    results = document.results
    shown = " ".join(f"{d:.6g}" for d in results[0].segment_durations)
    note = (
        "verdict: for the printed numbers themselves, at all t. rounding: however the digits were "
        "rounded."
    )

    def missing(result: CheckResult) -> dict[str, str | None]:
        times = {"feasible time": result.feasible_time, "tight time": result.tight_time}
        return {name: reason(time) for name, time in times.items()}

    columns = ("verdict", "rounding", ">total s", ">feasible s", ">tight s", ">worst", "…where")
    return [
        Prose(f"{results[0].case}: durations {shown} s", "heading"),
        *by_result(results, columns, _cells, "all", case),
        Prose(note, "note"),
        *reasons(results, missing, case),
    ]


def _cells(result: Judged) -> tuple[object, ...]:
    worst = result.worst
    ratio, where = "", str(worst)
    if not isinstance(worst, Why):
        ratio = f"{worst.ratio:.6f}" if math.isfinite(worst.ratio) else "unbounded"
        where = place(worst)
    times = (result.total_time, result.feasible_time, result.tight_time)
    return (result.verdict, result.rounding_verdict, *map(seconds, times), ratio, where)
