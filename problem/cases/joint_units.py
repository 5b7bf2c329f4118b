"""Units of each joint, all of which measure an angle or all a length."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ..robots import Chain, JointKind
from ..units import CHOICES, is_linear
from .clue import AnyClue, AxisClue, DataSheetClue, HalfTurnsClue
from .faults import Faults

if TYPE_CHECKING:
    from ..fields import UnitOrEach
    from .schema import CaseFile, Units
    from .statement import Statement

OF_JOINTS = tuple(name for name in CHOICES if name != "time")
"""Quantities that each joint may have in a unit of its own."""


def unit_of(units: UnitOrEach, joint: int) -> str | None:
    """The unit of one joint, by its position in the robot's list."""
    return units[joint] if isinstance(units, tuple) else units


def linear_joints(units: Units, count: int) -> tuple[bool, ...]:
    """Whether each of the robot's joints slides, by its units; one without any turns."""
    every = ([unit for _, unit in _units_of(units, joint)] for joint in range(count))
    return tuple(any(map(is_linear, own)) for own in every)


def _units_of(units: Units, joint: int) -> Iterator[tuple[str, str]]:
    for quantity in OF_JOINTS:
        unit = unit_of(getattr(units, quantity), joint)
        if unit is not None:
            yield quantity, unit


def with_unit(numbers: Sequence[str], units: UnitOrEach) -> list[str]:
    """Numbers with their unit: behind the last one, or behind each where they differ.

    Parameters
    ----------
    numbers : sequence of str
    units : str, tuple of str or None
        One for all of them, or one for each.
    """
    each = units if isinstance(units, tuple) else (units,) * len(numbers)
    if len(set(each)) > 1:
        return [f"{number} {unit}" for number, unit in zip(numbers, each, strict=True)]
    unit = next(iter(each), None)
    return [*numbers[:-1], f"{numbers[-1]} {unit}" if unit else numbers[-1]]


def check_units(units: Units, labels: Sequence[str], faults: Faults, selected: str) -> None:
    """Check that lists have one unit per joint, and that no joint is an angle and a length at once.

    Parameters
    ----------
    units : Units
        Under one reading.
    labels : sequence of str
        Of the robot's joints.
    faults : Faults
        Takes what is wrong.
    selected : str
        Names problem and reading, for messages.
    """
    before = len(faults.found)
    for quantity in OF_JOINTS:
        each = getattr(units, quantity)
        if isinstance(each, tuple) and len(each) != len(labels):
            faults.add(
                f"units.{quantity}",
                f"{len(each)} units for {len(labels)} joints; give one for all, or one each"
                + selected,
            )
    if len(faults.found) > before:
        return
    for joint, label in enumerate(labels):
        (first, own), *others = [*_units_of(units, joint)] or [("", "")]
        for quantity, unit in others:
            if is_linear(unit) != is_linear(own):
                which = f"[{joint}]" if isinstance(getattr(units, quantity), tuple) else ""
                fix = "give both as an angle or both as a length"
                if not which and len(labels) > 1:
                    fix = f"list one unit per joint in units.{quantity}"
                faults.add(
                    f"units.{quantity}{which}",
                    f"joint {label!r} has {unit!r} here and {own!r} in units.{first}; {fix}"
                    + selected,
                )


def check_kinds(statement: Statement, chain: Chain | None) -> None:
    """Check that units say of each joint what the robot's table says: that it turns or slides.

    Parameters
    ----------
    statement : Statement
    chain : Chain or None
        The robot's chain, if it has one.

    Raises
    ------
    CaseError
        If they differ.
    """
    if chain is None:
        return
    for joint, label in enumerate(statement.labels):
        if label not in chain.labels:
            continue  # refused elsewhere
        slides = chain.kinds[chain.labels.index(label)] is JointKind.PRISMATIC
        quantity, unit = next(_units_of(statement.units, joint), ("", ""))
        if unit and is_linear(unit) != slides:
            named = "prismatic" if slides else "revolute"
            fix = "a length such as mm" if slides else "an angle such as deg"
            raise statement.fail(
                f"units.{quantity}",
                f"joint {label!r} is in {unit}, but the robot's table calls it {named}; "
                f"give its unit as {fix}, or correct robot.dh.kinds",
            )


def check_clues(document: CaseFile, faults: Faults, statements: Sequence[Statement]) -> None:
    """Check that the unit of each clue fits the joints that it is about.

    Parameters
    ----------
    document : CaseFile
    faults : Faults
        Takes what is wrong.
    statements : sequence of Statement
        Every problem under every reading.
    """
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
        return "joint", f"joint {clue.joint!r} slides, and half turns are of angles; name another"
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
