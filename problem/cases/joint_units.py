"""Units of each joint, all of which measure an angle or all a length."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ..units import CHOICES, is_linear
from .faults import Faults

if TYPE_CHECKING:
    from ..fields import UnitOrEach
    from .schema import Units

OF_JOINTS = tuple(name for name in CHOICES if name != "time")
"""Quantities that each joint may have in a unit of its own."""


def unit_of(units: UnitOrEach, joint: int) -> str | None:
    """The unit of one joint, by its position in the robot's list."""
    return units[joint] if isinstance(units, tuple) else units


def linear_joints(units: Units, count: int) -> tuple[bool, ...]:
    """Whether each of the robot's joints slides, by its units; one without any turns."""
    every = ([unit for _, unit in units_of(units, joint)] for joint in range(count))
    return tuple(any(map(is_linear, own)) for own in every)


def units_of(units: Units, joint: int) -> Iterator[tuple[str, str]]:
    """Quantity and unit of everything that one joint has a unit for."""
    for quantity in OF_JOINTS:
        unit = unit_of(getattr(units, quantity), joint)
        if unit is not None:
            yield quantity, unit


def with_unit(numbers: Sequence[str], units: UnitOrEach) -> list[str]:
    """Numbers with their unit: behind the last one, or behind each where they differ.

    Parameters
    ----------
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
        (first, own), *others = [*units_of(units, joint)] or [("", "")]
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
