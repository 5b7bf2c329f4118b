"""TG205: printed control vertices against the printed way-points, in exact rational numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ....problem import Interval, Printed, shown_bound
from ....problem.cases import ControlVerticesClaim, Statement
from ....problem.curves import vertex_matrix
from ...documents import Basis, ClaimVerdict, Finding, Severity, ranged
from ..rounding import Agreement, agreement, hull
from ..study import Study
from .rule_group import Explained, rule_group


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
