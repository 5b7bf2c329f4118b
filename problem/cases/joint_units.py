"""Units of each joint, all of which measure an angle or all a length."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..printed import (
    CHOICES,
    AccelerationUnits,
    JerkUnits,
    PositionUnits,
    SnapUnits,
    Strict,
    TimeUnit,
    UnitOrEach,
    VelocityUnits,
    is_linear,
)

OF_JOINTS = tuple(name for name in CHOICES if name != "time")
"""Quantities that each joint may have in a unit of its own."""


class Units(Strict):
    """The units that the numbers of the file are printed in: one, or one for each robot joint."""

    position: PositionUnits = None
    velocity: VelocityUnits = None
    acceleration: AccelerationUnits = None
    jerk: JerkUnits = None
    snap: SnapUnits = None
    time: TimeUnit = None

    @property
    def deceleration(self) -> UnitOrEach:
        """That of acceleration."""
        return self.acceleration


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
