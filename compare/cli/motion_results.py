"""What `check` and `solve` answer, as tables and lines of a terminal."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias, TypeVar

from ...problem import Case, Verdict, from_si, shown_bound
from ...problem.motions import Interpolation, MotionCheck, MotionPeak, unstated_words
from ..audits import asked_as, in_words
from ..blocks import Block, Prose, table
from ..documents import (
    ActiveLimit,
    CheckedMotion,
    CheckResult,
    MotionCheckDocument,
    MotionFloor,
    MotionJumpShown,
    MotionPeakShown,
    MotionQuantity,
    NotJudged,
    SolveResult,
    Why,
    WorstPeak,
    known,
    value_or_none,
)


def checked_motion(found: MotionCheck) -> CheckedMotion:
    """The entry of a verdict on a motion."""
    return CheckedMotion.of(
        found,
        limits_verdict=found.limits,
        not_judged=tuple(
            NotJudged(joint=joint, quantity=MotionQuantity(quantity))
            for joint, quantity in found.not_judged
        ),
        worst=Why("nothing is limited") if found.worst is None else _peak(found.worst),
        slow_down=found.stretch,
        feasible_time=known(found.feasible_time, found.feasible_why),
        floor=known(
            found.floor and MotionFloor.of(found.floor, standstills=found.floor.stops),
            found.floor_why,
        ),
        peaks=tuple(map(_peak, found.peaks)),
        jumps=tuple(MotionJumpShown.of(one, breaks=one.count) for one in found.jumps),
    )


def _peak(one: MotionPeak) -> MotionPeakShown:
    return MotionPeakShown.of(one, ratio_at_least=one.least_ratio, ratio_at_most=one.most_ratio)


_POWERS = {
    MotionQuantity.POSITION: "",
    MotionQuantity.VELOCITY: "/s",
    MotionQuantity.ACCELERATION: "/s²",
    MotionQuantity.DECELERATION: "/s²",
    MotionQuantity.JERK: "/s³",
}
"""What follows the unit of positions."""


def shown_check(document: MotionCheckDocument) -> list[Block]:
    """Lines and the table that `check` prints for a motion."""
    result = document.result
    units = dict(zip(document.joints, document.units, strict=True))
    how = value_or_none(document.interpolation)
    between = "" if how is None else f", interpolation {how}"
    joints = len(document.joints)
    head = (
        f"{document.file}: {document.format}, {joints} joint{'s' * (joints > 1)}, "
        f"{document.rows:,} {'breaks' if how is None else 'samples'}{between}, "
        f"{result.total_time:.6g} s"
    )
    parts: list[Block] = [Prose(head, "heading"), *_verdict(document, units)]
    if result.not_judged:
        advice = (
            "To judge the rest, state its limit, or inf if it has none. --strict fails otherwise."
        )
        parts.append(Prose(advice, "note"))
    written = value_or_none(document.repaired)
    if written is not None:
        slower = f"{written.slow_down:.6f} times slower" if written.slow_down > 1 else "as it is"
        said = f"{written.file}: the motion {slower}, as {written.form}"
        parts.append(Prose(f"{said}; read back: {written.result.verdict}"))
    if document.picture is not None:
        parts.append(Prose(f"{document.picture}: the motion with its limits"))
    rows = [
        (
            one.joint,
            one.quantity,
            _number(one.value, units[one.joint]),
            _number(one.limit, units[one.joint]),
            units[one.joint] + _POWERS[one.quantity],
            _ratio(one, how is Interpolation.NONE),
            _instant(one.time),
            one.source,
        )
        for one in result.peaks
    ]
    columns = ("joint", "quantity", ">nearest", ">limit", "unit", ">ratio", ">at s", "~from")
    return [*parts, table(columns, rows)] if rows else parts


def _instant(time: float) -> str:
    """Six digits, and a millisecond even of the seconds since 1970."""
    return f"{time:.{max(6, len(f'{abs(time):.0f}') + 3)}g}"


def _ratio(one: MotionPeakShown, samples_alone: bool) -> str:
    """The ratio with the digits that it is known to; its bounds where noise leaves it open."""
    low, high = max(0.0, one.ratio_at_least), one.ratio_at_most
    if not math.isfinite(one.ratio):
        return "unbounded"
    least = shown_bound(low, "lower", digits=4)
    if samples_alone or not math.isfinite(high):
        return f"{least} or more"
    if high - low <= 1e-6 * max(1.0, high):
        return f"{one.ratio:.6f}"
    return f"{least} to {shown_bound(high, 'upper', digits=4)}"


def _verdict(document: MotionCheckDocument, units: Mapping[str, str]) -> list[Block]:
    result = document.result
    parts: list[Block] = [Prose(f"{result.verdict}: {_sentence(result, tuple(units))}", "heading")]
    worst = value_or_none(result.worst)
    if worst is not None:
        value, limit = (_sized(size, worst, units) for size in (worst.value, worst.limit))
        said = f"worst: joint {worst.joint}, {worst.quantity} {value} against {limit}"
        parts.append(Prose(f"{said} at {_instant(worst.time)} s (limit from {worst.source})"))
    order = list(MotionQuantity)
    # The largest jump of the lowest derivative that jumps.
    for one in sorted(result.jumps, key=lambda j: (order.index(j.quantity), -abs(j.size)))[:1]:
        said = f"jump: {one.quantity} of joint {one.joint} by {_sized(one.size, one, units)}"
        breaks = f"it jumps at {one.breaks} break{'s' * (one.breaks > 1)}"
        parts.append(Prose(f"{said} at {_instant(one.time)} s; {breaks}"))
    repaired = value_or_none(result.feasible_time)
    if repaired is None:
        parts.append(Prose(f"repair: none, {document.repaired}"))
    elif result.slow_down > 1 + result.tolerance:
        slower = shown_bound(result.slow_down, "upper", places=6)
        whole = shown_bound(repaired, "upper", places=6)
        parts.append(Prose(f"repair: {slower} times slower keeps the limits, in {whole} s"))
    floor = value_or_none(result.floor)
    if floor is None:
        parts.append(Prose(f"floor: none, {result.floor}", "note"))
    else:
        least = shown_bound(floor.time, "lower", places=6)
        above = shown_bound(100 * floor.above, "upper", places=1)
        way = "(way-points that it passes without stopping do not count)"
        here = f"is at most {above} % above {way}" if floor.above >= 0 else "is too fast"
        parts.append(
            Prose(
                f"floor: no motion within the limits takes less than {least} s between the same "
                f"{floor.standstills} standstills; this one {here}"
            )
        )
    parts += [Prose(text, "note") for text in (*result.concluded, *result.open)]
    return parts


def _sentence(result: CheckedMotion, joints: Sequence[str]) -> str:
    silent = unstated_words([(one.joint, one.quantity) for one in result.not_judged], joints)
    limit = "stated limit" if silent else "limit"
    sentences = {
        Verdict.PASS: "every {limit} is kept at every instant",
        Verdict.VIOLATED: "a limit is exceeded",
        Verdict.DISCONTINUOUS: "the motion jumps",
        Verdict.UNDECIDED: "it is not shown whether every {limit} is kept",
    }
    sentence = sentences[result.verdict].format(limit=limit)
    if result.verdict is Verdict.DISCONTINUOUS:
        kept = "kept" if result.limits_verdict is Verdict.PASS else "not decided"
        sentence += f"; limits, jumps apart: {kept}"
    if silent:
        sentence += f"; not judged: {silent}"
    return f"{sentence} (relative tolerance {result.tolerance:g})"


def _sized(value: float, one: MotionPeakShown | MotionJumpShown, units: Mapping[str, str]) -> str:
    """A value of a joint in the unit of the file."""
    unit = units[one.joint]
    return f"{_number(value, unit)} {unit}{_POWERS[one.quantity]}"


def _number(value: float, unit: str) -> str:
    return f"{from_si(value, unit):.6g}"


Result: TypeAlias = CheckResult | SolveResult
"""One problem under one reading, and under per-joint coupling its joints."""
R = TypeVar("R", CheckResult, SolveResult)
Cells = Callable[[Any], tuple[object, ...]]
"""What a row says of a result, or of one of its joints."""
Rows = Sequence[Sequence[object]]
"""Rows of a table."""


def by_result(
    results: Sequence[Result], columns: Sequence[str], cells: Cells, whole: str, case: Case
) -> list[Block]:
    """One table of all results, or one for each where the joints stand by themselves."""
    rows: dict[tuple[str, str], Rows] = {}
    apart = any(result.joints for result in results)
    for result in results:
        joints = [(one.joint, *cells(one)) for one in result.joints or ()]
        own = [*joints, (whole, *cells(result))] if apart else [cells(result)]
        rows[result.problem, result.reading] = own
    return by_question(rows, ("joint", *columns) if apart else columns, apart, case)


def by_question(
    rows: Mapping[tuple[str, str], Rows], columns: Sequence[str], apart: bool, case: Case
) -> list[Block]:
    """What is said of each problem and reading, which are called by words; an id stands once.

    One table of them all, or one for each where they are set apart or there is only one.
    """
    if not apart and len(rows) > 1:
        joined = [(in_words(case, *ids), *row) for ids, own in rows.items() for row in own]
        # What a command has to be given so that it takes one problem or one reading alone.
        problems, readings = (dict.fromkeys(ids) for ids in zip(*rows, strict=True))
        titles = {p.id: p.title or p.id for p in case.problems}
        asked = [(f"--problem {one}", titles[one]) for one in problems if len(titles) > 1]
        several = len(case.readings) > 1
        asked += [(f"--reading {one}", case.labels[one]) for one in readings if several]
        return [table(("~problem", *columns), joined), table(("for one alone", "~which"), asked)]
    parts: list[Block] = []
    for ids, own in rows.items():
        words = asked_as(case, *ids)
        # The tables stand below the case's id.
        parts += [Prose(words)] if words != case.id else []
        parts.append(table(columns, own))
    return parts


def reasons(
    results: Iterable[R], missing: Callable[[R], Mapping[str, str | None]], case: Case
) -> list[Prose]:
    """Why a number is missing, for each result without joints of its own."""
    return [
        Prose(f"{name}: {why} ({in_words(case, result.problem, result.reading)})", "note")
        for result in results
        if not result.joints
        for name, why in missing(result).items()
        if why
    ]


def place(at: ActiveLimit | WorstPeak) -> str:
    """Where on a trajectory, and of what."""
    where = f"segment {at.segment + 1}" if at.joint is None else f"joint {at.joint}"
    when = "" if isinstance(at.time, Why) else f" at {at.time:.4f} s"
    return f"{where} {at.quantity}{when}"
