"""Linear inequalities that hold for every motion of one joint through one segment."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from .exact import FreeQuestion

Sides = tuple[tuple[Fraction, Fraction], ...]
"""Bounds of every duration, s."""

UNIT = 10**10
"""Parameters of rows are multiples of 1/UNIT."""
REACH, BRAKE, CHANGE = range(3)
"""Kinds of rows as integers: a row is a line of an integer array."""
KINDS = ("reach", "brake", "change")
"""Their names in a certificate, in the order of the integers."""


class ReachRow(NamedTuple):
    """One inequality; ``sign`` mirrors the joint so that its displacement is not negative.

    ``a`` and ``b`` are slopes of tangents, ``c`` is velocity limit over peak speed, all times UNIT.
    """

    kind: int
    segment: int
    joint: int
    sign: int
    a: int
    b: int
    c: int


@dataclass(frozen=True)
class ExactRow:
    """time·h + start·v₀ + end·v₁ ≥ right."""

    time: Fraction
    start: Fraction
    end: Fraction
    right: Fraction


def exact_row(asked: FreeQuestion, row: ReachRow, box: Sides, speed: Fraction) -> ExactRow:
    """A row in rational numbers.

    Parameters
    ----------
    asked : FreeQuestion
    row : ReachRow
    box : Sides
        Only "brake" depends on it.
    speed : Fraction
        Bound on the joint's speed.

    Returns
    -------
    ExactRow
        With d = |displacement|, V and A the limits, l ≤ h ≤ u the box:

        - change: A h ± (v₀ − v₁) ≥ 0,
        - reach: h + (a v₀ + b v₁)/A ≥ 2dn + min(0, peak·V), n = c/V,
          peak = (a(2 − a) + b(2 − b))/2A − dn²,
        - brake: (A(a² + b²)/2 − d/lu)·h − a v₀ − b v₁ ≥ −|1 − a − b|·V − d(1/l + 1/u).

        Why they hold for all a, b and c ≥ 0 is in docs/explanation/certificates-any-curve.md.
    """
    acceleration = asked.loose[row.joint][1]
    assert acceleration is not None
    if row.kind == CHANGE:
        return ExactRow(acceleration, Fraction(row.sign), Fraction(-row.sign), Fraction(0))
    way = abs(asked.steps[row.segment][row.joint])
    a, b = Fraction(row.a, UNIT), Fraction(row.b, UNIT)
    if row.kind == REACH:
        n = Fraction(row.c, UNIT) / speed
        peak = (2 * a - a * a + 2 * b - b * b) / (2 * acceleration) - way * n * n
        return ExactRow(
            Fraction(1),
            row.sign * a / acceleration,
            row.sign * b / acceleration,
            2 * way * n + min(Fraction(0), peak * speed),
        )
    low, high = box[row.segment]
    return ExactRow(
        acceleration * (a * a + b * b) / 2 - way / (low * high),
        -row.sign * a,
        -row.sign * b,
        -abs(1 - a - b) * speed - way * (1 / low + 1 / high),
    )


def bound(
    asked: FreeQuestion,
    speeds: tuple[Fraction, ...],
    box: Sides,
    weighted: Iterable[tuple[ReachRow, Fraction]],
) -> Fraction:
    """Lower bound of the total in a box: Σh − Σ weight·(row's excess), least over the box.

    Parameters
    ----------
    asked : FreeQuestion
    speeds : tuple of Fraction
        Bounds on the joints' speeds.
    box : Sides
    weighted : iterable of (ReachRow, Fraction)
        Weights ≥ 0.

    Returns
    -------
    Fraction
        s.
    """
    total = Fraction(0)
    times = [Fraction(1)] * len(box)
    slopes: dict[tuple[int, int], Fraction] = {}
    for row, weight in weighted:
        exact = exact_row(asked, row, box, speeds[row.joint])
        total += weight * exact.right
        times[row.segment] -= weight * exact.time
        for at, slope in ((row.segment, exact.start), (row.segment + 1, exact.end)):
            key = (at, row.joint)
            slopes[key] = slopes.get(key, Fraction(0)) - weight * slope
    for factor, (low, high) in zip(times, box, strict=True):
        total += factor * (low if factor > 0 else high)
    for (at, joint), slope in slopes.items():
        end = asked.end(at, joint)
        total += slope * end if end is not None else -abs(slope) * speeds[joint]
    return total
