"""TG205: printed control vertices against the printed way-points, in exact rational numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ...nlp import Evidence
from ...problem import Printed
from ...problem.claim import ControlVerticesClaim
from ...problem.posing import Posing
from ...problem.printed import Interval
from ...problem.uniform import vertex_matrix
from ..finding import Basis, ClaimVerdict, Finding, Scope, Severity
from ..study import Study


@dataclass(frozen=True)
class Vertex:
    """One printed control vertex beside the interval that the printed way-points allow.

    Attributes
    ----------
    joint : str
    index : int
        From 0, as the paper counts.
    printed : Printed
    allowed : Interval
        Of V through the inverse of (2)(3), for every way-point that rounds to its digits.
    """

    joint: str
    index: int
    printed: Printed
    allowed: Interval

    @property
    def width(self) -> Fraction:
        """Half a digit of the way-points through the inverse, plus half a digit of V."""
        return (self.allowed.upper - self.allowed.lower) / 2 + self.printed.unit / 2

    @property
    def inside(self) -> bool:
        """Whether some way-points that print alike give a vertex that prints as this one."""
        own = self.printed.interval
        return own.lower <= self.allowed.upper and self.allowed.lower <= own.upper


def control_vertices(study: Study) -> Iterator[Finding]:
    """Set every printed control vertex beside the way-points of its problem."""
    for claim in study.case.claims:
        if isinstance(claim, ControlVerticesClaim):
            posing = study.case.posing(claim.problem)
            if posing.posed:
                yield _judged(claim, vertices(claim, posing))


def vertices(claim: ControlVerticesClaim, posing: Posing) -> tuple[Vertex, ...]:
    """Every printed control vertex with the interval that its way-points allow.

    The unit does not matter: way-points and vertices are printed in the same one.
    """
    points = posing.waypoints.points
    matrix = vertex_matrix(len(points))
    found = []
    for j, label in enumerate(posing.labels):
        intervals = [row[j].interval for row in points]
        for index, (weights, printed) in enumerate(zip(matrix, claim.joint_rows[j], strict=True)):
            found.append(Vertex(label, index, printed, _combined(weights, intervals)))
    return tuple(found)


def _combined(weights: Sequence[Fraction], intervals: Sequence[Interval]) -> Interval:
    ends = [(w * i.lower, w * i.upper) for w, i in zip(weights, intervals, strict=True)]
    zero = Fraction(0)
    return Interval(sum((min(e) for e in ends), zero), sum((max(e) for e in ends), zero))


def _judged(claim: ControlVerticesClaim, found: tuple[Vertex, ...]) -> Finding:
    outside = [v for v in found if not v.inside]
    widest = float(max(v.width for v in found))
    if outside:
        verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
        shown = "; ".join(
            f"V{v.index} of joint {v.joint} printed {v.printed}, allowed "
            f"{float(v.allowed.lower):.6f} to {float(v.allowed.upper):.6f}"
            for v in outside[:5]
        )
        message = (
            f"{len(outside)} of {len(found)} printed control vertices lie outside what the "
            f"rounding of the printed way-points allows through (2) and (3): {shown}."
        )
    else:
        verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
        message = (
            f"All {len(found)} printed control vertices lie inside the interval that the rounding "
            f"of the printed way-points allows through (2) and (3), at most {widest:.2g} either "
            "side of the value computed from the digits."
        )
    return Finding(
        rule="TG205",
        severity=severity,
        verdict=verdict,
        scope=Scope.ALL,
        evidence=Evidence.NONE,
        basis=Basis.DIGITS,
        claim=claim.id,
        problem=None,
        reading=None,
        printed=None,
        computed=f"{len(found) - len(outside)} of {len(found)} inside",
        gap=None,
        message=message,
    )
