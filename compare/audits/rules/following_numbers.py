"""Printed numbers as they follow from the others of the paper, in the digits that it uses."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction

from ....problem import Printed
from ....problem.cases import (
    AnyClaim,
    ControlVerticesClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MeasureClaim,
    MotionValueClaim,
    PeakClaim,
    TotalTimeClaim,
    ValueClaim,
    motions_of,
)
from ....problem.curves import vertex_matrix
from ...documents import Severity
from ..printed_row import PrintedRow, printed_rows
from ..stated import RowClaim, allowed_bases, printed_total
from ..study import Study
from .motion_numbers import measure_beside, value_beside
from .peaks import peak_beside
from .printed_tables import printed_alike
from .stated_curve import has_vertices


def in_digits(value: Fraction | Decimal | float, like: Printed, rounding: str = "") -> str:
    """A number with as many decimals as another one, rounded to the nearest by default."""
    exact = Fraction(value)
    number = Decimal(exact.numerator) / Decimal(exact.denominator)
    step = Decimal(1).scaleb(-max(like.places, 0))
    return f"{number.quantize(step, rounding=rounding or ROUND_HALF_EVEN):f}"


def summed(parts: Sequence[Printed | str], like: Printed) -> str:
    """The sum of printed digits, in those of a total."""
    return in_digits(sum((Decimal(str(one)) for one in parts), Decimal(0)), like)


def repeated_total(study: Study, claim: TotalTimeClaim) -> AnyClaim | None:
    """The claim whose total another place prints again; None if none is meant for sure."""
    found, weight = printed_alike(study, claim)
    totals = [printed_total(one) or _plain(one) for one in found]
    close = [
        one
        for one, total in zip(found, totals, strict=True)
        if total is not None and in_digits(total.fraction, claim.value) == claim.value.text
    ]
    if close:
        return close[0]
    return found[0] if found and (weight is Severity.ERROR or len(found) == 1) else None


def _plain(claim: AnyClaim) -> Printed | None:
    """The sum of printed durations, as a number with their digits."""
    if not isinstance(claim, RowClaim):
        return None
    return Printed(f"{sum((one.decimal for one in claim.durations), Decimal(0)):f}")


def recomputed(study: Study, claim: AnyClaim) -> dict[str, tuple[str, ...]]:
    """Numbers of a claim as they follow from what the claims print that it rests on.

    Digits stand under the claim's key; there are none where nothing follows.
    """
    if isinstance(claim, DurationsClaim):
        return {} if claim.total is None else {"total": (summed(claim.durations, claim.total),)}
    if isinstance(claim, MaximumClaim):
        return _longest(study, claim)
    if isinstance(claim, ImprovementClaim):
        return _improved(study, claim)
    if isinstance(claim, MotionValueClaim):
        return _of_motion(study, claim)
    if isinstance(claim, ControlVerticesClaim):
        return _vertices(study, claim)
    return {}


def _longest(study: Study, claim: MaximumClaim) -> dict[str, tuple[str, ...]]:
    rows = [study.case.printed_durations(study.case.claim(one)) for one in claim.of]
    if any(len(row) != len(claim.durations) for row in rows):
        return {}
    longest = tuple(
        in_digits(max(row[k].fraction for row in rows), own)
        for k, own in enumerate(claim.durations)
    )
    found = {"durations": longest}
    if claim.total is not None:
        found["total"] = (summed(longest, claim.total),)
    return found


def _improved(study: Study, claim: ImprovementClaim) -> dict[str, tuple[str, ...]]:
    sides = [printed_total(study.case.claim(one)) for one in (claim.slower, claim.faster)]
    slower, faster = (None if one is None else one.fraction for one in sides)
    if slower is None or faster is None or not 0 < faster < slower:
        return {}
    found: dict[str, tuple[str, ...]] = {}
    if claim.percent is not None:
        stated = claim.percent
        shares = [
            in_digits(100 * (slower - faster) / (slower if base == "slower" else faster), stated)
            for base in allowed_bases(claim)
        ]
        # Where the text leaves open what the share is of, the nearer one is meant.
        found["percent"] = (min(shares, key=lambda one: abs(Decimal(one) - stated.decimal)),)
    if claim.seconds is not None:
        found["seconds"] = (in_digits(slower - faster, claim.seconds),)
    return found


def _of_motion(study: Study, claim: MotionValueClaim) -> dict[str, tuple[str, ...]]:
    for motion in motions_of(study.case.claims, claim):
        for row in printed_rows(study, motion):
            if claim.problem not in (None, row.problem) or row.reading != study.main_reading:
                continue
            found = [
                _number(row, claim, number, joint) for joint, number in study.printed_numbers(claim)
            ]
            if None not in found:
                key = "value" if claim.values is None else "values"
                return {key: tuple(map(str, found))}
    return {}


def _number(
    row: PrintedRow[AnyClaim], claim: MotionValueClaim, printed: Printed, joint: str | None
) -> str | None:
    """One number of a motion; None if it has none."""
    if isinstance(claim, PeakClaim):
        one = peak_beside(row, claim, printed, joint)
    elif isinstance(claim, ValueClaim):
        one = value_beside(row, claim, printed, joint or row.posed().joints[0])
    else:
        assert isinstance(claim, MeasureClaim)
        one = measure_beside(row, claim, printed, joint)
    if one is None:
        return None
    # One number for several joints may be the norm over them, where that is nearer.
    exact = [one.exact, *([] if one.norm is None else [one.norm.exact])]
    return in_digits(min(exact, key=lambda value: abs(value - float(printed.fraction))), printed)


def _vertices(study: Study, claim: ControlVerticesClaim) -> dict[str, tuple[str, ...]]:
    statement = study.case.statement(claim.problem, study.main_reading)
    if not statement.complete or not has_vertices(statement):
        return {}
    points = statement.waypoints.points
    matrix = vertex_matrix(len(points))
    found = [
        in_digits(sum(w * row[j].fraction for w, row in zip(weights, points, strict=True)), printed)
        for j in range(len(statement.labels))
        for weights, printed in zip(matrix, claim.joint_rows[j], strict=True)
    ]
    return {"joint_rows": tuple(found)}
