"""A claim that has no text of its own as one sentence: its quantity, joint, digits and unit."""

from __future__ import annotations

from ...problem import Case
from ...problem.cases import (
    AnyClaim,
    ConditionsClaim,
    ControlVerticesClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MeasureClaim,
    MotionValueClaim,
    PhasesClaim,
    TotalTimeClaim,
    ValueClaim,
    with_unit,
)
from ..documents import enumerated

_MOST = 8
"""Numbers of a row that a sentence repeats at most; of a longer one it gives the total."""
_MEASURES = {
    "mean": "mean {one}",
    "rms": "root mean square of the {one}",
    "integral": "integral of the {one}",
    "integral-square": "integral of the squared {one}",
}
"""How a measure of a derivative is called."""
_PLURALS = {
    "position": "positions",
    "velocity": "velocities",
    "acceleration": "accelerations",
    "jerk": "jerks",
}
"""Derivatives of several joints."""
_ORDERS = {1: "velocity", 2: "acceleration", 3: "jerk"}
"""Derivatives by their order."""
_STATEMENTS = {
    "within_limits": "the motion keeps its limits",
    "continuous": "velocity and acceleration are continuous",
    "jumps": "the acceleration{of} jumps",
    "at_rest": "the motion is at rest at both ends",
    "optimal": "the motion is optimal",
    "kinematics": "joint angles and positions belong together",
    "varies_most": "joint {joint} varies most",
    "varies_much": "joint {joint} varies much",
    "equations": "the kinematic equations hold on the printed robot",
    "above": "one position lies above another",
    "none": "a sentence that cannot be checked",
}
"""What a statement says, by what it checks."""


def sentence_of(case: Case, claim: AnyClaim) -> str:
    """One sentence for a claim, from what it prints.

    Parameters
    ----------
    case : Case
    claim : AnyClaim

    Returns
    -------
    str
        Such as "The largest velocity of joint 2 is 94.7 deg/s."
    """
    said = _said(case, claim)
    names = {one.id: one.name for one in case.algorithms}
    if claim.algorithm is not None:
        said = f"{names[claim.algorithm]}: {said}"
    return f"{said[:1].upper()}{said[1:]}."


def _said(case: Case, claim: AnyClaim) -> str:
    time = case.document.units.time or "s"
    whose = f" of joint {claim.joint}" if claim.joint is not None else ""
    match claim:
        case DurationsClaim() | MaximumClaim() | TotalTimeClaim():
            before = "before optimisation, " if claim.state == "before" else ""
            curve = f" ({claim.other_curve})" if claim.other_curve else ""
            return f"{before}{_timed(claim, time, whose)}{curve}"
        case PhasesClaim():
            lengths = ", ".join(map(str, claim.phases))
            return f"the phases{whose} take {lengths} {time} ({claim.other_curve})"
        case ImprovementClaim(percent=percent) if percent is not None:
            return f"the motion is {percent} % shorter"
        case ImprovementClaim(seconds=saved):
            return f"the motion is {'' if saved is None else f'{saved} {time} '}shorter"
        case MotionValueClaim():
            return _measured(case, claim, whose)
        case ConvergenceClaim():
            return f"the search converges within {claim.iterations} iterations"
        case ConditionsClaim():
            names = enumerated(_ORDERS.get(k, f"derivative {k}") for k in claim.orders)
            at = "both ends" if claim.rest_at == "ends" else "all way-points"
            verb = "is" if len(claim.orders) == 1 else "are"
            count = f": {claim.count} conditions" if claim.count is not None else ""
            return f"{names} {verb} 0 at {at}{count}"
        case ControlVerticesClaim():
            return "the control vertices of the B-spline"
    return _STATEMENTS[claim.checks].format(of=whose, joint=claim.joint)


def _timed(claim: DurationsClaim | MaximumClaim | TotalTimeClaim, unit: str, whose: str) -> str:
    if isinstance(claim, TotalTimeClaim):
        return f"the motion{whose} takes {claim.value} {unit}"
    count = len(claim.durations)
    # The total of one segment is its duration.
    total = "" if claim.total is None or count == 1 else f"{claim.total} {unit} in total"
    if count > _MOST:
        plain = f"the {count} segments{whose} take {total}"
        return plain if total else f"the durations of {count} segments{whose}"
    digits = f"{enumerated(claim.durations)} {unit}{', ' if total else ''}{total}"
    several = "s" if count > 1 else ""
    if isinstance(claim, MaximumClaim):
        verb = "are" if several else "is"
        return f"the longest duration{several} of the segment{several}{whose} {verb} {digits}"
    return f"the segment{several}{whose} take{'' if several else 's'} {digits}"


def _measured(case: Case, claim: MotionValueClaim, whose: str) -> str:
    """A largest value, a mean or an integral of a derivative."""
    called = "largest {one}"
    if isinstance(claim, MeasureClaim):
        called = _MEASURES[claim.measure]
    if isinstance(claim, ValueClaim):
        called = f"{claim.place} {{one}}" if claim.place in ("largest", "smallest") else "{one}"
    each = claim.values is not None
    plain = called.startswith(("largest", "smallest", "mean", "{one}"))
    one = _PLURALS[claim.derivative] if each and plain else claim.derivative
    name = called.format(one=one)
    if each:
        whose = " of the joints"
        name = name.replace("integral", "integrals").replace("mean square", "mean squares")
    if len(claim.printed) > _MOST:
        return f"the {name}{whose}"
    if isinstance(claim, ValueClaim):
        whose += place_of_value(case, claim)
    verb = "are" if each else "is"
    return f"the {name}{whose} {verb} {enumerated(with_units(case, claim))}"


def place_of_value(case: Case, claim: ValueClaim) -> str:
    """Where a value is taken, as a sentence says it; empty for the largest and the smallest."""
    if claim.time is not None:
        return f" at {claim.time} {case.document.units.time or 's'}"
    if claim.place in ("largest", "smallest"):
        return ""
    if claim.place in ("start", "finish"):
        return f" at the {claim.place}"
    labelled = case.statement(claim.problem).waypoints.labels
    return f" at {claim.place}" if labelled else f" at way-point {claim.place}"


def with_units(case: Case, claim: MotionValueClaim) -> list[str]:
    """The numbers of a claim of a derivative with their unit, which no integral has in a file."""
    numbers = list(map(str, claim.printed))
    if isinstance(claim, MeasureClaim) and claim.measure.startswith("integral"):
        return numbers
    units = getattr(case.document.units, claim.derivative)
    if claim.values is None and isinstance(units, tuple):
        # The joint's own, or the one that all joints of the claim's problem have.
        joint = None if claim.joint is None else case.robot.joints.index(claim.joint)
        units = case.statement(claim.problem).unit(claim.derivative, joint)
    return with_unit(numbers, units)
