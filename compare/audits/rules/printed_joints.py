"""TG110, TG602 and TG603: printed joints, positions and equations, without printed motions."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from math import sqrt

from ....problem import Printed
from ....problem.cases import Cartesian, StatementClaim
from ....problem.robots import Chain, Equation, check_equation
from ...documents import Basis, ClaimVerdict, Finding
from ..rounding import meet
from ..study import Study
from .rule_group import Explained, rule_group

TG110 = Explained(
    "TG110",
    "A joint varies most among the printed joints if the text says so",
    "Does a joint cover the range that the text describes? Its largest and smallest printed "
    "angles are compared with those of the other printed joints.",
    "If the joint is said to vary most: supported if all joints are printed and no range is "
    "larger; inconsistent, with a warning, if one is larger however the digits were rounded or "
    "cut off. If it is only said to vary much, nothing is decided, because no text says how much "
    "that is.",
    "Joint 3 is said to vary most. Its printed angles lie within 0.6 rad, those of joint 1 "
    "within 4.6 rad.",
    basis=Basis.DIGITS,
)
TG602 = Explained(
    "TG602",
    "A position lies above another if the text says so",
    "Does a position lie above another if the text says so?",
    "Supported if the two agree in the plane within rounding and the first is higher. "
    "Otherwise not checkable, with both distances: signs are easily lost in print and in "
    "extracted text.",
    "“Above the table” lies 0.30 m beside the table; with another sign of y it would be 0 m.",
    basis=Basis.DIGITS,
)


TG603 = Explained(
    "TG603",
    "Printed kinematic equations hold on the printed chain",
    "Do the printed kinematic equations hold on the printed robot? Both sides are computed at "
    "random joint angles.",
    "Supported if all hold as printed. Otherwise not checkable, with the correction that "
    "would make each of them hold: signs, exponents and indices are easily lost in extracted "
    "text.",
    "13 of 16 equations hold; another holds once a missing plus sign is added.",
    basis=Basis.KINEMATICS,
)


@rule_group(TG110, TG602, TG603, without_waypoints=True)
def judge_joints(study: Study) -> Iterator[Finding]:
    """Findings of TG110, TG602 and TG603.

    No equation is ever held against a paper: whether a sign was lost in print or in the extraction
    cannot be told from the text.
    """
    for claim in study.statements("varies_most", "varies_much"):
        yield _varies(study, claim)
    for claim in study.statements("above"):
        yield _above(study, claim)
    for claim in study.statements("equations"):
        chain = study.case.chain()
        assert chain is not None
        yield _judged(claim, study.case.document.equations, chain)


def _varies(study: Study, claim: StatementClaim) -> Finding:
    """The joint's range beside those of the other printed joints, all in the printed unit."""
    statement = study.case.statement(claim.problem)
    rows = statement.waypoints.points
    printed = {label: [row[j] for row in rows] for j, label in enumerate(statement.labels)}
    printed |= {c.joint: list(c.values) for c in study.case.columns if c.joint is not None}
    ranges = {label: _range(numbers) for label, numbers in printed.items() if numbers}
    cut = {label: _range(numbers, cut=True) for label, numbers in printed.items() if numbers}
    own = ranges.pop(str(claim.joint), None)
    if own is None:
        return TG110.finding(claim, "not printed", f"No angles of joint {claim.joint} are printed.")
    computed = f"{_middle(*own):.2f} in the printed unit"
    if claim.joint is not None and statement.unit("position") is None:
        listed = ", ".join(dict.fromkeys(statement.units.position or ()))
        said = [
            f"Joints are printed in different units ({listed}), so it cannot be said which of them "
            "varies more.",
            f"The printed positions of joint {claim.joint} span {_middle(*own):.2f} (printed "
            "unit).",
        ]
        return TG110.finding(claim, "other units", *said, computed=computed)
    shown = " and ".join(
        f"{_middle(least, most):.2f} of joint {label}" for label, (least, most) in ranges.items()
    )
    said = [
        f"The printed angles of joint {claim.joint} span "
        f"{_middle(*own):.2f}, compared with {shown or 'no other printed joint'} (printed unit)."
    ]
    chain = study.case.chain()
    missing = [] if chain is None else [one for one in chain.labels if one not in printed]
    several = len(missing) > 1
    are = "are" if several else "is"
    aside = [f"Joint{'s' * several} {' and '.join(missing)} {are} not printed."] if missing else []
    kind, verdict = "spans", ClaimVerdict.NOT_CHECKABLE
    if claim.checks == "varies_much":
        # "Much" has no measure, and a joint that turns less may vary much in another sense.
        aside.append("The text does not say how much “much” is, so nothing is decided.")
    elif more := [
        label
        for label, (least, _) in ranges.items()
        if least > own[1] and cut[label][0] > cut[str(claim.joint)][1]
    ]:
        plural = "s" if len(more) > 1 else ""
        kind, verdict = "others more", ClaimVerdict.INCONSISTENT
        said.append(f"Joint{plural} {', '.join(more)} var{'y' if plural else 'ies'} more.")
    elif not missing and ranges and all(most <= own[0] for _, most in ranges.values()):
        verdict = ClaimVerdict.SUPPORTED
    return TG110.finding(claim, kind, *said, *aside, verdict=verdict, computed=computed)


def _range(numbers: list[Printed], cut: bool = False) -> tuple[Fraction, Fraction]:
    """Least and largest range of all values that round to the digits, or are cut off to them."""
    intervals = [n.truncated if cut else n.interval for n in numbers]
    high = max(i.upper for i in intervals) - min(i.lower for i in intervals)
    low = max(i.lower for i in intervals) - min(i.upper for i in intervals)
    return max(low, Fraction(0)), high


def _middle(low: Fraction, high: Fraction) -> float:
    return float(low + high) / 2


def _above(study: Study, claim: StatementClaim) -> Finding:
    """How far one position stands beside another in the horizontal plane, and how far above it.

    Signs are often lost in print and in extraction, so no sign alone decides.
    """
    by_id = {place.id: place for place in study.case.cartesian}
    upper, lower = (by_id[name] for name in claim.positions)
    beside = _beside(upper, lower)
    rise = upper.values[2].interval
    floor = lower.values[2].interval
    names = f"{upper.label or upper.id} lies {{}} {upper.unit} beside {lower.label or lower.id}"
    height = float(upper.values[2].fraction - lower.values[2].fraction)
    said = [f"{names.format(f'{beside[0]:.4g}')} and {height:.4g} {upper.unit} above it."]
    plane = zip(upper.values[:2], lower.values[:2], strict=True)
    same = all(meet(a.interval, b.interval) for a, b in plane)
    if same and rise.lower > floor.upper:
        return TG602.finding(claim, "beside and above", *said, verdict=ClaimVerdict.SUPPORTED)
    least = min(_beside(upper, lower, signs) for signs in product((1, -1), repeat=2))
    if least[0] < beside[0]:
        said.append(
            f"With another sign of {' and '.join(least[1])} it would be {least[0]:.4g} "
            f"{upper.unit}; signs may be lost in the text, so nothing is decided."
        )
    return TG602.finding(claim, "beside and above", *said)


def _beside(
    one: Cartesian, other: Cartesian, signs: tuple[int, ...] = (1, 1)
) -> tuple[float, tuple[str, ...]]:
    """Distance in the plane with other signs of one position, and the coordinates changed."""
    away = [
        sign * a.value - b.value
        for sign, a, b in zip(signs, one.values[:2], other.values[:2], strict=True)
    ]
    changed = tuple(name for name, sign in zip("xy", signs, strict=True) if sign < 0)
    return sqrt(sum(x * x for x in away)), changed


def _judged(claim: StatementClaim, equations: tuple[Equation, ...], chain: Chain) -> Finding:
    held, mended, apart = [], [], []
    for equation in equations:
        found = check_equation(chain, equation.printed)
        if found.holds:
            held.append(_name(equation))
        elif equation.mended is not None and check_equation(chain, equation.mended).holds:
            # How often it holds as it is, where it does at some poses.
            partly = f"({found.share:.0%} of the poses as printed) " if found.share else ""
            mended.append(f"{_name(equation)} {partly}with {equation.mend}")
        else:
            apart.append(_name(equation))
    listed = f": {', '.join(held)}" if held else ""
    said = [
        f"{len(held)} of {len(equations)} equations hold at every pose tried, as the text has them"
        f"{listed}."
    ]
    if mended:
        said.append(f"Others hold once corrected: {'; '.join(mended)}.")
    if apart:
        said.append(f"These do not hold as printed: {', '.join(apart)}.")
    if mended or apart:
        said.append("It is unknown whether the paper or the extraction lost what is missing.")
    return TG603.finding(
        claim,
        "in part" if mended or apart else "all",
        *said,
        verdict=ClaimVerdict.NOT_CHECKABLE if mended or apart else ClaimVerdict.SUPPORTED,
        printed="; ".join(equation.where for equation in equations),
        computed=f"{len(held)} hold as printed, {len(mended)} once corrected",
    )


def _name(equation: Equation) -> str:
    return equation.where.removeprefix("equation ")
