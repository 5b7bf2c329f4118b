"""The command `check`: durations judged under each problem and reading."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import RenderableType

from ...problem import Case, Check, Coupling, Peak, check
from ..audits import Point, RoundingBox, RoundingVerdict, in_words, judge_rounding
from ..documents import (
    BrokenPlace,
    CheckDocument,
    CheckedJoint,
    CheckResult,
    Judged,
    Limited,
    PassingPoint,
    RoundingExhibit,
    Why,
    WorstPeak,
    json_text,
    known,
    reason,
)
from .input import (
    Selected,
    duration_box,
    naming,
    one_joint,
    read_case,
    read_durations,
    select,
    waypoint_box,
)
from .output import emit, new_output, progress
from .result_tables import by_result, place, reasons, seconds
from .table import line


def check_durations(
    source: str,
    text: str,
    problem: str | None,
    reading: str | None,
    coupling: str | None,
    as_json: bool,
    out: Path | None,
) -> int:
    """Judge printed durations under each selected problem and reading."""
    case = read_case(source)
    selected = select(case, problem, reading, coupling)
    printed = read_durations(text, case.file)
    boxes = [duration_box(case, one, printed) for one in selected]
    with new_output(out) as write:
        results = []
        with progress("check", len(selected)) as step, naming(case.file):
            for one, box in zip(selected, boxes, strict=True):
                step(in_words(case, one.problem_id, one.reading_id))
                results.append(_checked(case, one, box))
        document = CheckDocument(results=tuple(results))
        write(json_text(document))
    emit(document, lambda shown: _tables(shown, case), as_json)
    return 0


def _checked(case: Case, one: Selected, box: RoundingBox) -> CheckResult:
    problem, points = one.problem, waypoint_box(case, one)
    joints: list[tuple[str, Check, RoundingVerdict]] = []
    loose = case.statement(one.problem_id, one.reading_id).loose_ends
    if problem.coupling is Coupling.PER_JOINT:
        for j, label in enumerate(problem.joints):
            alone = problem.joint(j)
            rounding = judge_rounding(alone, box, one_joint(points, j), loose_ends=loose)
            joints.append((label, check(alone, box.value), rounding))
    return check_result(
        case.id,
        one.problem_id,
        one.reading_id,
        problem.coupling,
        check(problem, box.value),
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

    Parameters
    ----------
    case, problem, reading : str
        Ids.
    coupling : Coupling
    found : Check
        The durations judged at the printed point, with all joints.
    rounding : RoundingVerdict
        Judged for every value that rounds to the printed digits.
    durations : sequence of float
        s.
    joints : iterable of (str, Check, RoundingVerdict), optional
        The same for each joint by itself, by label.

    Returns
    -------
    CheckResult
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
    return Judged(
        verdict=found.verdict,
        rounding_verdict=rounding.verdict,
        total_time=found.total_time,
        worst=Why("nothing is limited") if found.worst is None else _worst(found.worst),
        feasible_time=known(found.feasible_time, found.feasible_why),
        tight_time=known(found.tight_time, found.tight_why),
        rounding=RoundingExhibit(
            exhibit=_exhibit(rounding),
            worst_ratio_at_least=known(rounding.lower_bound_of_worst, "no bound was needed"),
        ),
    )


def _worst(worst: Peak) -> WorstPeak:
    return WorstPeak(
        joint=worst.joint,
        quantity=Limited(worst.quantity),
        segment=worst.segment,
        time=known(worst.time, "a bound on the whole duration"),
        value=worst.value,
        limit=worst.limit,
        ratio=worst.ratio,
    )


def _exhibit(rounding: RoundingVerdict) -> PassingPoint | BrokenPlace | None:
    shown = rounding.exhibit
    if isinstance(shown, Point):
        return PassingPoint(
            segment_durations=shown.durations.tolist(), waypoints=shown.waypoints.tolist()
        )
    if shown is None:
        return None
    return BrokenPlace(joint=shown.joint, quantity=Limited(shown.quantity), segment=shown.segment)


_COLUMNS = ("verdict", "rounding", ">total s", ">feasible s", ">tight s", ">worst", "…where")
"""What the table says of each result, or of each of its joints."""


def _tables(document: CheckDocument, case: Case) -> list[RenderableType]:
    results = document.results
    shown = " ".join(f"{d:.6g}" for d in results[0].segment_durations)
    note = (
        "verdict: the printed numbers themselves, for all t. rounding: however the digits were "
        "rounded."
    )
    return [
        line(f"{results[0].case}: durations {shown} s", "bold"),
        *by_result(results, _COLUMNS, _cells, "all", case),
        line(note, "dim"),
        *reasons(results, _missing, case),
    ]


def _missing(result: CheckResult) -> dict[str, str | None]:
    return {
        "feasible time": reason(result.feasible_time),
        "tight time": reason(result.tight_time),
    }


def _cells(result: Judged) -> tuple[object, ...]:
    worst = result.worst
    ratio, where = "", str(worst)
    if not isinstance(worst, Why):
        ratio = f"{worst.ratio:.6f}" if math.isfinite(worst.ratio) else "unbounded"
        where = place(worst)
    times = (result.total_time, result.feasible_time, result.tight_time)
    return (result.verdict, result.rounding_verdict, *map(seconds, times), ratio, where)
