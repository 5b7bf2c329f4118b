"""What speaks for and against each reading beside the claims, computed; it decides no verdict."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import pi

import numpy as np

from ....problem import (
    Array,
    LimitPair,
    Problem,
    Trajectory,
    control_vertices,
    from_si,
    half_range,
    is_linear,
    shown_unit,
    to_si,
)
from ....problem.cases import (
    AnyClaim,
    AnyClue,
    AxisClue,
    DataSheetClue,
    HalfTurnsClue,
    SmoothClue,
    Statement,
)
from ...documents import HeldOtherwise, ReadingClue, Speaks, Why
from ..printed_row import PrintedRow, rows_under
from ..rounding import FEW_ROUNDINGS
from ..stated import DERIVATIVES
from ..study import Study
from .peaks import jumps_shown, largest

_FILLED = 0.1
"""Share of an axis that a curve fills at least, and of a data sheet's limits that printed ones use:
a plot scales its axes to its curves, and nobody buys a robot ten times too fast."""
_DATA_SHEET = 1e-3
"""Relative difference that rounding in a data sheet leaves: 3.1415 rad/s is 180 °/s."""
_STEPS = 10
"""Steps a segment on which limits held at samples only are tried: a coarse figure's."""


def reading_clues(study: Study) -> tuple[ReadingClue, ...]:
    """Every clue of a case under every reading with a problem.

    Their order is by clue, then by reading.
    """
    return tuple(
        found
        for clue in study.case.clues
        for reading in study.readings
        for found in _under(study, clue, reading)
    )


def _under(study: Study, clue: AnyClue, reading: str) -> Iterator[ReadingClue]:
    match clue:
        case AxisClue():
            said = _on_axis(study, clue, reading)
        case DataSheetClue():
            said = _data_sheet(study, clue, reading)
        case SmoothClue():
            said = _smooth(study, clue, reading)
        case _:
            said = _half_turns(study, clue, reading)
    if said is not None:
        about = {"clue": clue.id, "where": clue.where, "text": clue.text, "reading": reading}
        yield ReadingClue(speaks=said[0], computed=said[1], **about)


_Said = tuple[Speaks, str] | None
"""On which side a clue speaks and what was computed; None if a reading has no problem."""


def _motions(study: Study, names: Sequence[str], reading: str) -> list[PrintedRow[AnyClaim]]:
    """Claims with durations that define a curve under a reading."""
    named = rows_under(study, map(study.case.claim, names), reading)
    return [row for row in named if row.unmoved is None and row.has_curve]


def _on_axis(study: Study, clue: AxisClue, reading: str) -> _Said:
    """The largest value of the curves that a figure shows beside the last label of its axis."""
    tops = []
    for row in _motions(study, clue.of, reading):
        problem = row.posed()
        tops += [
            abs(top.value)
            for top in largest(row, DERIVATIVES.index(clue.quantity))
            if clue.joint in (None, problem.joints[top.joint])
            and problem.linear[top.joint] == is_linear(clue.unit)
        ]
    if not tops:
        return None
    reach = from_si(max(tops), clue.unit)
    labels = sorted({abs(tick.value) for tick in clue.ticks})
    last = labels[-1]
    # An axis may go on for less than one step beyond its last label.
    step = max((b - a for a, b in pairwise(labels)), default=0.0)
    beside = f"{clue.quantity} up to {reach:.3g} {shown_unit(clue.unit)}, last label {last:g}"
    if reach < _FILLED * last:
        return Speaks.AGAINST, f"{beside}: the curve would be a flat line"
    if reach > last + step:
        return Speaks.AGAINST, f"{beside}: the curve would leave the axis"
    return Speaks.FOR, beside + (" of an axis that may extend by one step" if reach > last else "")


def _data_sheet(study: Study, clue: DataSheetClue, reading: str) -> _Said:
    """The printed limits of a reading over those of a data sheet, joint by joint."""
    statement = _statement(study, reading)
    units = clue.units(len(clue.values))
    known = [to_si(value, unit) for value, unit in zip(clue.values, units, strict=True)]
    given = getattr(statement.limits, clue.quantity)
    each = list(given) if isinstance(given, tuple) else [given] * len(known)
    if any(isinstance(one, LimitPair) for one in each):
        return None  # a data sheet prints sizes
    pairs = [
        (statement.si(one, clue.quantity, joint=j), known[j])
        for j, one in enumerate(each)
        if one is not None and j in statement.joints
    ]
    if not pairs:
        return None
    if all(
        ours.lower <= sheet.upper + _DATA_SHEET * sheet.value
        and sheet.lower <= ours.upper + _DATA_SHEET * sheet.value
        for ours, sheet in pairs
    ):
        return Speaks.FOR, f"{clue.quantity} limits equal those of the data sheet"
    ratios = [ours.value / sheet.value for ours, sheet in pairs]
    low, high = (f"{ratio:.3g}" for ratio in (min(ratios), max(ratios)))
    times = low if low == high else f"{low} to {high}"
    below = all(ours.lower <= sheet.upper * (1 + _DATA_SHEET) for ours, sheet in pairs)
    within = below and min(ratios) >= _FILLED
    speaks = Speaks.FOR if within else Speaks.AGAINST
    return speaks, f"{clue.quantity} limits {times} times those of the data sheet"


def _smooth(study: Study, clue: SmoothClue, reading: str) -> _Said:
    """How often a derivative that is said not to jump does so."""
    motions = _motions(study, clue.of, reading)
    if not motions:
        return None
    order = DERIVATIVES.index(clue.quantity)
    jumps = [(row, jump) for row in motions for jump in row.check.jumps if jump.order == order]
    if not jumps:
        return Speaks.FOR, f"{clue.quantity} does not jump"
    shown, plural = " and ".join(jumps_shown(jumps, ".3g")), "s" if len(jumps) > 1 else ""
    return (Speaks.AGAINST, f"{clue.quantity} jumps {len(jumps)} time{plural}, by up to {shown}")


def _half_turns(study: Study, clue: HalfTurnsClue, reading: str) -> _Said:
    """How many printed angles of a joint are multiples of π within their rounding."""
    statement = _statement(study, reading)
    column = statement.labels.index(clue.joint)
    printed = [row[column] for row in statement.waypoints.points]
    angles = [statement.si(one, "position", joint=column) for one in printed if one.fraction != 0]
    if not angles:
        return None
    found = sum(
        one.lower <= round(one.value / pi) * pi <= one.upper and round(one.value / pi) != 0
        for one in angles
    )
    said = f"{found} of {len(angles)} angles of joint {clue.joint} other than 0 are multiples of π"
    # By luck hardly any is: digits are finer than half turns.
    return (Speaks.FOR if 2 * found > len(angles) else Speaks.AGAINST), said


def _statement(study: Study, reading: str) -> Statement:
    return study.case.statement(study.case.problems[0].id, reading)


def held_otherwise(row: PrintedRow[AnyClaim]) -> HeldOtherwise | Why:
    """The largest ratio to a limit if the limits were held otherwise than for all t."""
    worst = row.check.worst
    if worst is None or worst.quantity in ("curve", "duration"):
        return Why("the printed durations define no motion whose limits could be checked")
    problem = row.posed()
    durations = row.durations.value
    sampled = _at_samples(problem, durations, row.motion)
    vertices: float | Why = Why("the curve has no control vertices in time")
    declared = row.statement.declaration
    if problem.limits.uneven:
        vertices = Why(
            "lower and upper limits differ, but vertices are compared with equal ones only"
        )
    elif (declared.family, declared.time) == ("uniform-cubic-b-spline", "stretched"):
        vertices = _on_vertices(problem.waypoints, durations, problem.limits.sides[1])
    return HeldOtherwise(
        everywhere=float(worst.ratio), steps=_STEPS, sampled=sampled, vertices=vertices
    )


def _at_samples(problem: Problem, durations: Array, trajectory: Trajectory) -> float:
    """Largest ratio to any limit at sampled places of each piece, as `check` counts it for all t.

    Bounds on positions and durations count like limits on derivatives: "none is broken" means all.
    """
    limits = problem.limits
    bounds = (problem.duration_lower / durations, durations / problem.duration_upper)
    ratios = [float(one.max()) for one in bounds]
    places = np.linspace(0.0, 1.0, _STEPS + 1)
    pieces = range(len(trajectory.breaks) - 1)
    for joint in range(len(problem.joints)):
        low, high = float(limits.position_lower[joint]), float(limits.position_upper[joint])
        for order in range(len(limits.quantities) + 1):
            found = np.array([trajectory.values(piece, joint, order, places) for piece in pieces])
            sides = limits.sides[:, joint, order - 1] if order else np.array([-low, high])
            for most, limit in zip((-found.min(), found.max()), sides, strict=True):
                if not np.isfinite(limit):
                    continue
                width = limit if order else half_range(low, high, limit)
                over = most - limit
                ratio = 1.0 + over / width if width > 0 else np.inf if over > FEW_ROUNDINGS else 0.0
                ratios.append(float(ratio))
    return max(ratios)


def _on_vertices(waypoints: Array, durations: Array, limits: Array) -> float:
    """Limits on the vertices of velocity and acceleration, which bound the curve from outside."""
    vertices = control_vertices(waypoints)
    worst = 0.0
    for order in (1, 2):
        found = np.abs(np.diff(vertices, order, axis=0))
        for k, h in enumerate(durations):
            # Segment k is made of the vertices k to k + 3.
            ratio = found[k : k + 4 - order] / h**order / limits[:, order - 1]
            worst = max(worst, float(ratio[:, limits[:, order - 1] > 0].max(initial=0.0)))
    return worst
