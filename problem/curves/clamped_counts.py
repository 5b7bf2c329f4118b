"""Which readings of a clamped B-spline with end conditions are determined, and what is nearest."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import product

from ..errors import TrajgapError
from .clamped import ClampedBSpline
from .clamped_knots import RULES, Knots, Parameters, count_inner_knots, nearest_reading
from .condition import counts_in_words
from .stretched import Timing

DEGREES = (3, 4, 5, 6, 7)
"""Degrees that `ClampedBSpline` takes: from C2 in time up to the highest compared anywhere."""


class Count(StrEnum):
    """Conditions against control points."""

    DETERMINED = "determined"
    """As many conditions as control points."""
    OVER = "over-determined"
    """More conditions than control points: impossible but for special way-points."""
    UNDER = "under-determined"
    """Control points are left free."""


@dataclass(frozen=True)
class ClampedReading:
    """One way of reading degree, knots and parameters, with its count.

    Attributes
    ----------
    degree : int
    knots : Knots
    parameters : Parameters
    time : Timing
    conditions, control_points : int
        Of one joint.
    count : Count
    curve : ClampedBSpline or None
        The declaration, if it is determined.
    words : str
        What holds of this reading, and the nearest one that works.
    """

    degree: int
    knots: Knots
    parameters: Parameters
    time: Timing
    conditions: int
    control_points: int
    count: Count
    curve: ClampedBSpline | None
    words: str

    def __str__(self) -> str:
        return (
            f"degree {self.degree}, knots {self.knots}, parameters {self.parameters}, "
            f"{self.time}: {self.words}"
        )


def clamped_readings(
    waypoints: int, end_orders: tuple[int, ...] = (1, 2), degrees: tuple[int, ...] = DEGREES
) -> tuple[ClampedReading, ...]:
    """Every reading of `z1-woa-bspline`, (1) to (12), for a number of way-points.

    Parameters
    ----------
    waypoints : int
    end_orders : tuple of int
        Derivatives that are 0 at both ends.
    degrees : tuple of int

    Returns
    -------
    tuple of ClampedReading
        By degree, then knots, then parameters; stretched ones only where parameters come from
        chords. Degrees not above the highest of `end_orders` are left out.

    Raises
    ------
    TrajgapError
        If there are fewer than two way-points.

    Examples
    --------
    >>> first = clamped_readings(8, degrees=(5,))[0]
    >>> first.words
    'determined, 12 conditions for 12 control points'
    """
    if waypoints < 2:
        raise TrajgapError("interpolant: at least two way-points are needed")
    found = []
    sources = [one for one in Parameters if one is not Parameters.GIVEN]
    able = [degree for degree in degrees if degree > max(end_orders, default=0)]
    for degree, knots, parameters, time in product(able, RULES, sources, Timing):
        if time is Timing.STRETCHED and parameters is Parameters.TIMES:
            continue
        found.append(_read(waypoints, degree, knots, parameters, time, end_orders))
    return tuple(found)


def _read(
    waypoints: int,
    degree: int,
    knots: Knots,
    parameters: Parameters,
    time: Timing,
    end_orders: tuple[int, ...],
) -> ClampedReading:
    conditions = waypoints + 2 * len(end_orders)
    inner = count_inner_knots(knots, waypoints, degree, end_orders)
    points = inner + degree + 1
    counted = counts_in_words(conditions, points, "control points")
    if inner >= 0 and points == conditions:
        curve = ClampedBSpline(waypoints, degree, knots, parameters, time, end_orders)
        note = "" if parameters is Parameters.TIMES else _CHORDS[time]
        return ClampedReading(
            degree, knots, parameters, time, conditions, points, Count.DETERMINED, curve,
            f"determined, {counted}{note}",
        )  # fmt: skip
    why = nearest_reading(knots, degree, end_orders) if inner >= 0 else "lower the degree"
    if inner < 0:
        words = f"impossible as the text has it: degree {degree} needs more way-points; {why}"
        return ClampedReading(
            degree, knots, parameters, time, conditions, points, Count.OVER, None, words
        )
    if points < conditions:
        # Only the printed rule, taken at its letter, is called impossible.
        literal = "impossible as the text has it: " if knots is Knots.AVERAGED else ""
        words = f"{literal}over-determined, {counted}; {why}"
        return ClampedReading(
            degree, knots, parameters, time, conditions, points, Count.OVER, None, words
        )
    free = points - conditions
    words = f"under-determined, {counted}: {free} left free per joint"
    if parameters is Parameters.TIMES:
        words += (
            f', which family "polynomials" of degree {degree}, continuity {degree - 1} and '
            f"free = {free} leaves to the optimiser"
        )
    words += f"; {why}"
    return ClampedReading(
        degree, knots, parameters, time, conditions, points, Count.UNDER, None, words
    )


_CHORDS = {
    Timing.TIMED: (
        "; chords place the knots, times the way-points: passes only durations not too far from "
        "the chords' proportions"
    ),
    Timing.STRETCHED: (
        "; chords place knots and way-points, velocity jumps where a segment's duration leaves the "
        "chords' proportions. With one u = t/T for all, only the total is left of the durations"
    ),
}
"""What is added to the words of a determined reading with chord parameters."""
