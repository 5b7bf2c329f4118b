"""TG107, TG205 and TG207: what is stated of a curve, its conditions and its control vertices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import perm

import numpy as np

from ....problem import (
    QUANTITIES,
    USUAL,
    Curve,
    Interval,
    Printed,
    as_piecewise,
    counts_in_words,
    shown_bound,
)
from ....problem.cases import (
    AnyClaim,
    ConditionsClaim,
    ControlVerticesClaim,
    Statement,
    StatementClaim,
)
from ....problem.curves import vertex_matrix
from ...documents import Basis, ClaimVerdict, Finding, Severity, ranged
from ..printed_row import PrintedRow, named_rows
from ..rounding import Agreement, agreement, hull
from ..stated import RowClaim, all_called, called_under
from ..study import Study
from .peaks import largest
from .rule_group import Explained, rule_group

TG107 = Explained(
    "TG107",
    "The conditions stated fit the number of coefficients",
    "Can a curve satisfy all conditions that the paper states? They are counted against the "
    "coefficients of the polynomials, segment by segment.",
    "Refuted if the printed count differs, or if no polynomial of the stated degree satisfies "
    "the conditions. More conditions than coefficients get a warning: all of them can hold "
    "only for special way-points.",
    "A cubic has four coefficients. If position, velocity and acceleration are given at both "
    "ends, there are six conditions for four coefficients.",
    basis=Basis.COUNT,
)
TG207 = Explained(
    "TG207",
    "The motion is at rest where it is said to be",
    "Is the motion at rest if the paper says so? The derivatives at both ends are computed.",
    "Supported if they vanish, inconsistent if one does not.",
    "A paper says “starts and ends at rest”, but its natural cubic spline starts at 68 °/s.",
    basis=Basis.CHECK,
)


@rule_group(TG107, TG207)
def judge_counts(study: Study) -> Iterator[Finding]:
    """Findings of TG107 and TG207."""
    for claim in study.claims:
        if isinstance(claim, ConditionsClaim):
            counted = _counted(study, claim)
            yield counted
            if counted.verdict is not ClaimVerdict.REFUTED:
                yield from _at_rest(study, claim, claim.of, claim.orders)
        elif isinstance(claim, StatementClaim) and claim.checks == "at_rest":
            yield from _at_rest(study, claim, claim.of, (1,))


def count_conditions(study: Study, claim: ConditionsClaim) -> int:
    """Number of conditions that a statement asks for on one joint.

    Positions at both ends of every segment, continuity at the breaks, and the derivatives said to
    vanish: on both sides of a via-point where it is said of all way-points. At a virtual way-point
    of the declared curve the two segments only join: one condition instead of two positions.
    """
    n, virtual = len(claim.degrees), _virtual(study, claim)
    rest = len(claim.orders)
    positions, ends = 2 * n - virtual, 2 * rest
    if claim.rest_at == "all":
        others = [r for r in range(1, claim.continuity + 1) if r not in claim.orders]
        vias = (n - 1 - virtual) * (2 * rest + len(others))
        return positions + ends + vias + virtual * claim.continuity
    return positions + ends + (n - 1) * claim.continuity


def _virtual(study: Study, claim: ConditionsClaim) -> int:
    """Virtual way-points of the curve that a statement is about, if it has as many segments."""
    for pair in study.pairs:
        if claim.problem in (None, pair.problem) and pair.reading == study.main_reading:
            curve = as_piecewise(study.problem(pair).curve)
            if curve is not None and curve.segments == len(claim.degrees):
                return len(curve.virtual)
    return 0


def _counted(study: Study, claim: ConditionsClaim) -> Finding:
    wanted = count_conditions(study, claim)
    available = sum(d + 1 for d in claim.degrees)
    degrees = "-".join(map(str, claim.degrees))
    computed = counts_in_words(wanted, available)
    printed = None if claim.count is None else str(claim.count)
    verdict, severity, kind = ClaimVerdict.SUPPORTED, Severity.INFO, "count"
    said, more = f"{degrees} polynomials: {computed} per joint", ""
    if claim.count is not None and claim.count.fraction != wanted:
        verdict, severity, kind = ClaimVerdict.REFUTED, Severity.ERROR, "other count"
        said += f"; the paper prints {printed}"
    elif impossible := _impossible_segments(study, claim):
        verdict, severity, kind = ClaimVerdict.REFUTED, Severity.ERROR, "impossible"
        more = (
            f"No polynomial of that degree satisfies them in segment{'s' * (len(impossible) > 1)} "
            f"{' and '.join(map(str, impossible))}, where the way-points differ."
        )
    elif wanted > available:
        verdict, severity, kind = ClaimVerdict.NOT_CHECKABLE, Severity.WARNING, "too many"
        more = "All of them can hold only for special way-points."
    return TG107.finding(
        claim,
        kind,
        f"{said}.",
        more,
        severity=severity,
        verdict=verdict,
        printed=printed,
        computed=computed,
        built=verdict is ClaimVerdict.SUPPORTED and claim.count is None,
    )


def _impossible_segments(study: Study, claim: ConditionsClaim) -> list[int]:
    """Segments (from 1) on which no polynomial of the degree meets what is said of its ends.

    Of each segment alone: it passes two way-points that differ for every value that rounds to their
    digits, and the derivatives vanish at the ends where the statement says so. The duration only
    scales these equations, so they are decided in rational numbers, once for all durations.
    """
    found = set()
    for pair in study.pairs:
        if claim.problem not in (None, pair.problem) or pair.reading != study.main_reading:
            continue
        lower, upper = study.case.waypoint_box(*pair)
        if len(lower) != len(claim.degrees) + 1:
            continue
        apart = (lower[1:] > upper[:-1]) | (upper[1:] < lower[:-1])
        last = len(claim.degrees) - 1
        for k, degree in enumerate(claim.degrees):
            everywhere = claim.rest_at == "all"
            start = claim.orders if everywhere or k == 0 else ()
            end = claim.orders if everywhere or k == last else ()
            if apart[k].any() and not meets(degree, start, end):
                found.add(k + 1)
    return sorted(found)


def meets(degree: int, start: Sequence[int], end: Sequence[int]) -> bool:
    """Whether some polynomial moves from 0 to 1 while derivatives of these orders vanish there."""
    asked = [(0, 0, 0), (0, 1, 1), *((order, 0, 0) for order in start), *((o, 1, 0) for o in end)]
    rows = [
        [*(_slope(power, order, at) for power in range(degree + 1)), Fraction(value)]
        for order, at, value in asked
    ]
    for column in range(degree + 1):
        pivot = next((row for row in rows if row[column] != 0), None)
        if pivot is None:
            continue
        rows.remove(pivot)
        rows = [
            [a - b * row[column] / pivot[column] for a, b in zip(row, pivot, strict=True)]
            for row in rows
        ]
    # What is left says 0 = 0, or 0 = something.
    return all(row[-1] == 0 for row in rows)


def _slope(power: int, order: int, at: int) -> Fraction:
    """Derivative of a monomial at 0 or 1."""
    if order > power or (at == 0 and power != order):
        return Fraction(0)
    return Fraction(perm(power, order))


def _at_rest(
    study: Study, claim: AnyClaim, of: Sequence[str], orders: Sequence[int]
) -> Iterator[Finding]:
    """Evaluate the derivatives that are said to vanish, at both ends of printed motions."""
    every = [c.id for c in study.case.claims if isinstance(c, RowClaim)]
    for reading, rows, others in named_rows(study, of or every):
        moving, judged, built = [], 0, True
        for row in rows:
            if claim.problem not in (None, row.problem) or not row.has_curve:
                continue
            judged += 1
            built &= _prescribed(row.posed().curve, orders)
            moving += [
                f"{said} ({called_under(study.case, row.claim, row.problem)})"
                for said in _moving(row, orders)
            ]
        if not judged:
            continue
        derivatives = [QUANTITIES[r - 1] for r in orders if r <= USUAL]
        names = f"{' and '.join(derivatives)} {'is' if len(derivatives) == 1 else 'are'}"
        verdict, kind, unknown = ClaimVerdict.SUPPORTED, "at rest", ""
        message = f"On the stated curve {names} 0 at both ends of every printed motion."
        if moving:
            verdict, kind = ClaimVerdict.INCONSISTENT, "moving"
            message = (
                "The motion is said to be at rest at both ends, but on the stated curve "
                f"{'; '.join(moving)}."
            )
        elif others and of:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "in part"
            unknown = f"No motion is built from {all_called(others)}."
        yield TG207.finding(
            claim,
            kind,
            message,
            unknown,
            verdict=verdict,
            reading=reading,
            built=built and verdict is ClaimVerdict.SUPPORTED,
        )


def _prescribed(curve: Curve, orders: Sequence[int]) -> bool:
    """Whether a curve has derivatives 0 at both ends as it is declared."""
    ends = (curve.prescribed_at(0), curve.prescribed_at(curve.segments))
    return all((order, 0.0) in end for end in ends for order in orders)


def _moving(row: PrintedRow[AnyClaim], orders: Sequence[int]) -> Iterator[str]:
    """The largest derivative of each order that does not vanish at an end."""
    problem = row.posed()
    trajectory = row.motion
    for order in orders:
        if order > USUAL:
            continue
        quantity = QUANTITIES[order - 1]
        tops = [abs(top.value) for top in largest(row, order)]
        ends = np.abs(trajectory(np.array([0.0, trajectory.total_time]), order))
        # A hundredth of the peak counts as 0: rounding of the printed digits moves it by less.
        over = np.where(ends > 0.01 * np.array(tops), ends, 0.0)
        if not over.any():
            continue
        # Angles and lengths are no larger or smaller than each other.
        for kind in dict.fromkeys(problem.linear):
            own = np.where(np.array(problem.linear) == kind, over, 0.0)
            if not own.any():
                continue
            end, joint = np.unravel_index(int(np.argmax(own)), own.shape)
            label = problem.joints[int(joint)]
            value = row.shown(quantity, float(own[end, joint]), label, ".4g")
            where = "starts" if end == 0 else "ends"
            yield f"joint {label} {where} with a {quantity} of {value}"


# --- control vertices -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Vertex:
    """One printed control vertex beside the interval that the printed way-points allow.

    Attributes
    ----------
    index : int
        From 0, as the paper counts.
    allowed : Interval
        Of the vertex on the uniform cubic B-spline, for every way-point that rounds to its digits.
    allowed_cut : Interval
        The same for way-points whose digits are rounded or cut off.
    """

    joint: str
    index: int
    printed: Printed
    allowed: Interval
    allowed_cut: Interval

    @property
    def width(self) -> Fraction:
        """Half a digit of the way-points through the inverse, plus half a digit of V."""
        return (self.allowed.upper - self.allowed.lower) / 2 + self.printed.unit / 2

    @property
    def agreement(self) -> Agreement:
        """How it agrees with some way-points, whether their digits are rounded or cut off."""
        return agreement(
            (Agreement.ROUNDING, self.printed.interval, self.allowed),
            (Agreement.CUT_OFF, hull(self.printed), self.allowed_cut),
        )

    @property
    def inside(self) -> bool:
        """Whether some way-points that round to the digits give a vertex that rounds to its own."""
        return self.agreement is Agreement.ROUNDING


TG205 = Explained(
    "TG205",
    "Printed control vertices follow from the printed way-points",
    "Do printed control vertices follow from the printed way-points?",
    "Supported if each lies within the interval that the rounding of the way-points allows, "
    "otherwise refuted; not checkable on curves other than the uniform cubic B-spline.",
    "The vertex computed from the way-points lies between 0.4317 and 0.4319; 0.4318 is "
    "supported and 0.4381 refuted.",
    basis=Basis.DIGITS,
)


@rule_group(TG205)
def judge_vertices(study: Study) -> Iterator[Finding]:
    """Set every printed control vertex beside the way-points of its problem.

    Each kind of B-spline has vertices of its own, so a claim is judged only under readings
    whose curve is the uniform cubic one.
    """
    for claim in study.claims:
        if isinstance(claim, ControlVerticesClaim):
            problem = claim.problem or study.case.problems[0].id
            under = {
                pair.reading: _found(claim, statement)
                for pair in study.pairs
                if pair.problem == problem and (statement := study.case.statement(*pair)).complete
            }
            first = next(iter(under.values()), None)
            if first is not None and all(found == first for found in under.values()):
                yield first
            else:
                yield from (f.model_copy(update={"reading": r}) for r, f in under.items())


def has_vertices(statement: Statement) -> bool:
    """Whether the curve of a statement is the one whose vertices are computed here."""
    return statement.declaration.family == "uniform-cubic-b-spline"


def _found(claim: ControlVerticesClaim, statement: Statement) -> Finding:
    if has_vertices(statement):
        return _judged(claim, vertices(claim, statement), statement.unit("position") is None)
    return TG205.finding(
        claim,
        "other curve",
        "Control vertices are computed only for the uniform cubic B-spline; the case has "
        f"another curve ({statement.declaration.family}).",
    )


def vertices(claim: ControlVerticesClaim, statement: Statement) -> tuple[Vertex, ...]:
    """Every printed control vertex with the interval that its way-points allow.

    The unit does not matter: way-points and vertices are printed in the same one.
    """
    points = statement.waypoints.points
    matrix = vertex_matrix(len(points))
    found = []
    for j, label in enumerate(statement.labels):
        intervals = [row[j].interval for row in points]
        hulls = [hull(row[j]) for row in points]
        for index, (weights, printed) in enumerate(zip(matrix, claim.joint_rows[j], strict=True)):
            allowed, wide = _combined(weights, intervals), _combined(weights, hulls)
            found.append(Vertex(label, index, printed, allowed, wide))
    return tuple(found)


def _combined(weights: Sequence[Fraction], intervals: Sequence[Interval]) -> Interval:
    ends = [(w * i.lower, w * i.upper) for w, i in zip(weights, intervals, strict=True)]
    zero = Fraction(0)
    return Interval(sum((min(e) for e in ends), zero), sum((max(e) for e in ends), zero))


def _judged(claim: ControlVerticesClaim, found: tuple[Vertex, ...], apart: bool) -> Finding:
    """The finding; joints whose units lie ``apart`` have no widest interval in common."""
    outside = [v for v in found if not v.inside]
    beyond = [v for v in outside if v.agreement is Agreement.OFF]
    most = shown_bound(float(max(v.width for v in found)), "upper", digits=2)
    widest = f", which reaches at most {most} to either side of the value"
    widest = "" if apart else widest + " computed from the digits"
    if beyond:
        verdict, kind = ClaimVerdict.REFUTED, "outside"
        shown = "; ".join(
            f"V{v.index} of joint {v.joint} printed {v.printed}, allowed "
            f"{ranged(float(v.allowed_cut.lower), float(v.allowed_cut.upper), '.6f')}"
            for v in beyond[:5]
        )
        message = (
            f"{len(beyond)} of {len(found)} printed control vertices lie outside the intervals "
            f"that the printed way-points allow on the uniform cubic B-spline, with digits "
            f"rounded or cut off: {shown}."
        )
    elif outside:
        verdict, kind = ClaimVerdict.SUPPORTED, "cut off"
        names = ", ".join(f"V{v.index} of joint {v.joint}" for v in outside[:5])
        message = (
            f"{len(outside)} of {len(found)} printed control vertices ({names}) follow from the "
            "printed way-points only if digits are cut off instead of rounded."
        )
    else:
        verdict, kind = ClaimVerdict.SUPPORTED, "inside"
        message = (
            f"All {len(found)} printed control vertices lie inside the interval that the rounding "
            f"of the printed way-points allows on the uniform cubic B-spline{widest}."
        )
    weight = {"severity": Severity.WARNING} if kind == "cut off" else {}
    return TG205.finding(
        claim,
        kind,
        message,
        verdict=verdict,
        computed=f"{len(found) - len(outside)} of {len(found)} inside",
        **weight,
    )
