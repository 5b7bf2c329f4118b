"""Whether claims, clues and units fit the problem and the joints that they speak about."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence

from ..limits import BRAKING
from ..printed import Printed, Quantity, is_linear, spelling_hint
from ..robots import Chain, JointKind
from .claim import (
    AnyClaim,
    ControlVerticesClaim,
    DurationsClaim,
    MaximumClaim,
    MeasureClaim,
    MotionValueClaim,
    PeakClaim,
    PhasesClaim,
    ProfiledClaim,
    TimeClaim,
    TotalTimeClaim,
    ValueClaim,
)
from .clue import AnyClue, AxisClue, DataSheetClue, HalfTurnsClue
from .faults import Faults
from .joint_units import units_of
from .schema import CaseFile
from .statement import Statement


def check_claims(
    document: CaseFile, faults: Faults, statements_of: Callable[[AnyClaim], Sequence[Statement]]
) -> None:
    """Check that each claim fits the problem that it speaks about.

    Parameters
    ----------
    statements_of : callable
        The problems of a claim under every reading, that under the default one first.
    """
    problems = [problem.id for problem in document.problems]
    for index, claim in enumerate(document.claims):
        if claim.problem is not None and claim.problem not in problems:
            continue  # refused already
        with faults.noted():
            every = statements_of(claim)
            _check_claim(document, faults, claim, every, f"claims[{index}]")


_TIMES = ("durations", "total", "blends", "phases", "ramps", "time")
"""Keys of claims that hold times, one or a list."""
_SIZES: dict[str, Quantity] = {
    "deceleration": "acceleration",
    "snap": "jerk",
    "plateau": "velocity",
    "blend_acceleration": "acceleration",
}
"""Keys of claims that hold a size for all joints or one for each, and where its unit stands."""


def _check_claim(
    document: CaseFile, faults: Faults, claim: AnyClaim, every: Sequence[Statement], at: str
) -> None:
    statement = every[0]

    def number(printed: Printed, quantity: Quantity, field: str, joint: int | None = None) -> None:
        with faults.noted():
            statement.si(printed, quantity, f"{at}.{field}", joint)

    labels = [statement.labels[j] for j in statement.joints]
    if claim.joint in statement.labels and claim.joint not in labels:
        why = f"joint {claim.joint!r} takes no part; the problem has {', '.join(labels)}"
        faults.add(f"{at}.joint", why + statement.selected)
    if isinstance(claim, DurationsClaim | MaximumClaim):
        for segment, duration in enumerate(claim.durations):
            if duration.fraction == 0:
                why = "is 0; a duration is positive, give its digits"
                faults.add(f"{at}.durations[{segment}]", why + statement.selected)
    if isinstance(claim, PhasesClaim) and statement.waypoints.number != 2:
        faults.add(
            f"{at}.phases",
            f"describe one segment, but there are {statement.waypoints.number} way-points; "
            f"state a total instead{statement.selected}",
        )
    times = (*_TIMES, "value") if isinstance(claim, TotalTimeClaim) else _TIMES
    for key in times:
        value = getattr(claim, key, None)
        if isinstance(value, tuple):
            for position, length in enumerate(value):
                number(length, "time", f"{key}[{position}]")
        elif value is not None:
            number(value, "time", key)
    for key, quantity in _SIZES.items():
        if getattr(claim, key, None) is not None:
            _check_each(faults, getattr(claim, key), quantity, every, f"{at}.{key}")
    if isinstance(claim, MaximumClaim):
        _check_curves(document, faults, claim, at)
    if isinstance(claim, DurationsClaim) and isinstance(claim.blends, tuple):
        points = statement.waypoints.number
        if len(claim.blends) != points:
            faults.add(
                f"{at}.blends",
                f"{len(claim.blends)} blends for {points} way-points; give one for each, or one "
                "for all",
            )
    if isinstance(claim, ProfiledClaim):
        _check_profile(faults, claim, every, at)
    if isinstance(claim, PeakClaim | MeasureClaim | ValueClaim):
        for position, printed in enumerate(claim.printed):
            if claim.values is not None:
                number(printed, claim.derivative, f"values[{position}]", position)
            elif claim.joint in statement.labels:
                number(printed, claim.derivative, "value", statement.labels.index(claim.joint))
            else:
                _check_one_unit(faults, claim.derivative, every, f"{at}.value")
                number(printed, claim.derivative, "value")
        _check_motion_value(document, claim, statement, at)
    if isinstance(claim, ValueClaim):
        if claim.value is not None and claim.joint is None and len(labels) > 1:
            why = f"is one number for {len(labels)} joints; give values, one for each joint"
            faults.add(f"{at}.value", f"{why}, or name its joint{statement.selected}")
        if claim.time is None and claim.place not in (known := named_places(statement)):
            fix = spelling_hint(claim.place or "", known)
            faults.add(f"{at}.place", f"{claim.place!r} is not a place of the motion; {fix}")
    if isinstance(claim, ControlVerticesClaim):
        _check_vertices(claim, statement, f"{at}.joint_rows")


def named_places(statement: Statement) -> dict[str, int | None]:
    """What a place of a motion may be called, with the number of its way-point, from 0.

    Returns
    -------
    dict of str to int or None
        None for the largest and the smallest value of the motion.
    """
    points = statement.waypoints
    names = points.labels or tuple(str(k + 1) for k in range(points.number))
    named: dict[str, int | None] = {"largest": None, "smallest": None}
    named |= {"start": 0, "finish": points.number - 1}
    return named | {name: k for k, name in enumerate(names)}


def motions_of(claims: Iterable[AnyClaim], value: MotionValueClaim) -> list[AnyClaim]:
    """Claims of durations whose motion a number may describe: the one named, or all that fit."""
    motions = [c for c in claims if isinstance(c, DurationsClaim | MaximumClaim)]
    if value.of is not None:
        return [c for c in motions if c.id == value.of]
    return [
        c
        for c in motions
        if (value.algorithm is None or c.algorithm == value.algorithm)
        and c.problem == value.problem
        and c.joint in (None, value.joint)
        and c.other_curve is None
    ]


def profile_of(claims: Iterable[AnyClaim], value: AnyClaim) -> TotalTimeClaim | PhasesClaim | None:
    """The claim of a profile whose peak or value a claim states; None if it states neither."""
    if not isinstance(value, PeakClaim | ValueClaim) or value.of is None:
        return None
    for claim in claims:
        if isinstance(claim, TotalTimeClaim | PhasesClaim) and claim.id == value.of:
            return claim
    return None


def _check_curves(document: CaseFile, faults: Faults, claim: MaximumClaim, at: str) -> None:
    """Check that a maximum is of the curve that its rows are of: no motion is built otherwise."""
    rows = [one for one in document.claims if one.id in claim.of and isinstance(one, TimeClaim)]
    for row in rows:
        if row.other_curve != claim.other_curve:
            named = json.dumps(row.other_curve or claim.other_curve, ensure_ascii=False)
            faults.add(
                f"{at}.other_curve",
                f"is not that of {row.id!r}, whose durations it takes; give other_curve = {named} "
                "in both, or in neither",
            )
            return


def _check_profile(
    faults: Faults, claim: ProfiledClaim, every: Sequence[Statement], at: str
) -> None:
    """Refuse a profile without the limit that makes it the one that is named."""
    if claim.along_path:
        loose = [one for one in every if one.complete and one.durations.ratios is None]
        if loose:
            faults.add(
                f"{at}.path",
                f'"{claim.path}" needs durations.ratios, at which the curve has one path; add it'
                + loose[0].selected,
            )
    if claim.profile is None:
        return
    # Without this limit the highest derivative would jump: another profile.
    needed = "acceleration" if claim.profile == "trapezoidal" else "jerk"
    for key in (BRAKING, "snap"):
        beside = [one for one in every if getattr(one.limits, key) is not None]
        if beside:
            why = f"takes no limits.{key}, which is one of curves; state {key} in the claim instead"
            faults.add(f"{at}.profile", f'"{claim.profile}" {why}{beside[0].selected}')
    for statement in every:
        given = getattr(statement.limits, needed)
        each = given if isinstance(given, tuple) else (given,) * len(statement.labels)
        joints = [j for j in statement.joints if claim.joint in (None, statement.labels[j])]
        free = [statement.labels[j] for j in joints if j < len(each) and each[j] is None]
        if free:
            which = "" if len(free) == len(joints) else f" for joint {', '.join(free)}"
            faults.add(
                f"{at}.profile",
                f'"{claim.profile}" needs limits.{needed}, and none is stated{which}; add it, or '
                f"leave profile out{statement.selected}",
            )
            return


def _check_each(
    faults: Faults,
    size: Printed | tuple[Printed, ...],
    quantity: Quantity,
    every: Sequence[Statement],
    field: str,
) -> None:
    """Check that a size fits the joints, one for all or one each, and that it has a unit."""
    statement = every[0]
    if not isinstance(size, tuple):
        _check_one_unit(faults, quantity, every, field)
        with faults.noted():
            statement.si(size, quantity, field)
        return
    joints = len(statement.labels)
    if len(size) != joints:
        faults.add(field, f"{len(size)} values for {joints} joints; give one each, or one for all")
        return
    for joint, number in enumerate(size):
        with faults.noted():
            statement.si(number, quantity, f"{field}[{joint}]", joint)


def _check_one_unit(
    faults: Faults, quantity: Quantity, every: Sequence[Statement], field: str
) -> None:
    """Refuse one number for joints whose units differ under some reading."""
    for statement in every:
        units = getattr(statement.units, quantity)
        if units is not None and statement.unit(quantity) is None:
            apart = ", ".join(dict.fromkeys(units[j] for j in statement.joints))
            faults.add(
                field,
                f"is one number for joints in different units ({apart}); give values, one for each "
                "joint, or name its joint" + statement.selected,
            )


def _check_motion_value(
    document: CaseFile, claim: PeakClaim | MeasureClaim | ValueClaim, statement: Statement, at: str
) -> None:
    joints = len(statement.labels)
    if claim.values is not None and len(claim.values) != joints:
        raise statement.fail(
            f"{at}.values", f"{len(claim.values)} values for {joints} joints; give one each"
        )
    meant, profile = motions_of(document.claims, claim), profile_of(document.claims, claim)
    for motion in [*meant, *([] if profile is None else [profile])]:
        if motion.problem != claim.problem:
            raise statement.fail(
                f"{at}.of", f"{motion.id!r} belongs to another problem; name a motion of this one"
            )
    if len(meant) > 1:
        names = ", ".join(repr(c.id) for c in meant[:-1])
        raise statement.fail(
            f"{at}.of",
            f"is missing, but the {claim.quantity} may belong to {names} or {meant[-1].id!r}; "
            f"name the motion: of = {' or of = '.join(json.dumps(c.id) for c in meant)}",
        )


def _check_vertices(claim: ControlVerticesClaim, statement: Statement, field: str) -> None:
    joints, count = len(statement.labels), statement.waypoints.number
    if len(claim.joint_rows) != joints:
        raise statement.fail(
            field, f"gives {len(claim.joint_rows)} joints, but robot.joints lists {joints}"
        )
    for position, row in enumerate(claim.joint_rows):
        if len(row) != count + 2:
            raise statement.fail(
                f"{field}[{position}]",
                f"{len(row)} control vertices for {count} way-points; give {count + 2}",
            )


def check_kinds(statement: Statement, chain: Chain | None) -> None:
    """Check that units say of each joint what the robot's table says: that it turns or slides."""
    if chain is None:
        return
    for joint, label in enumerate(statement.labels):
        if label not in chain.labels:
            continue  # refused elsewhere
        slides = chain.kinds[chain.labels.index(label)] is JointKind.PRISMATIC
        quantity, unit = next(units_of(statement.units, joint), ("", ""))
        if unit and is_linear(unit) != slides:
            named = "prismatic" if slides else "revolute"
            fix = "a length such as mm" if slides else "an angle such as deg"
            raise statement.fail(
                f"units.{quantity}",
                f"joint {label!r} is in {unit}, but the robot's table calls it {named}; "
                f"give its unit as {fix}, or correct robot.dh.kinds",
            )


def check_clues(document: CaseFile, faults: Faults, statements: Sequence[Statement]) -> None:
    """Check that the unit of each clue fits the joints that it is about."""
    kinds = dict.fromkeys(statement.linear for statement in statements)
    for index, clue in enumerate(document.clues):
        for linear in kinds:
            misfit = _misfit(clue, document.robot.joints, linear)
            if misfit is not None:
                faults.add(f"clues[{index}].{misfit[0]}", misfit[1])


def _misfit(clue: AnyClue, labels: Sequence[str], linear: Sequence[bool]) -> tuple[str, str] | None:
    """Field and reason where a clue's unit is not that of its joints."""
    slides = dict(zip(labels, linear, strict=True))
    if isinstance(clue, HalfTurnsClue) and slides.get(clue.joint, False):
        return "joint", f"joint {clue.joint!r} slides, but half turns apply to angles; name another"
    if isinstance(clue, AxisClue):
        meant = slides.values() if clue.joint is None else [slides.get(clue.joint)]
        if None not in meant and is_linear(clue.unit) not in meant:
            what = "the joints" if clue.joint is None else f"joint {clue.joint!r}"
            return "unit", f"{clue.unit!r} does not fit {what}; {_FIX[is_linear(clue.unit)]}"
    if isinstance(clue, DataSheetClue):
        each = clue.units(len(labels))
        if len(each) != len(labels):
            why = f"{len(each)} units for {len(labels)} joints; give one for all, or one each"
            return "unit", why
        for place, (label, unit) in enumerate(zip(labels, each, strict=True)):
            if is_linear(unit) != slides[label]:
                at = f"unit[{place}]" if isinstance(clue.unit, tuple) else "unit"
                fix = "list one unit per joint" if len(labels) > 1 else _FIX[is_linear(unit)]
                return at, f"{unit!r} does not fit joint {label!r}; {fix}"
    return None


_FIX = {True: "give a unit of angle", False: "give a unit of length"}
"""What to give instead, by whether a unit is one of length."""
