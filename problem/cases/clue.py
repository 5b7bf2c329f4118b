"""What speaks for or against readings beside the claims: figures, data sheets, words, π."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, model_validator

from ..files import MOST
from ..printed import CHOICES, Id, Number, Strict, Text, TextOrEach, fault, kinds_of

Known = Literal["velocity", "acceleration", "jerk"]
"""Derivatives that have a unit."""


class Clue(Strict):
    """What all clues have in common; none of them decides a claim."""

    id: Id
    where: Text
    """Place in the paper, or the source where it is known from elsewhere."""
    text: Text
    """What is printed or known there, in English."""


class AxisClue(Clue):
    """Labels of an axis of a figure, which survive where the curve does not."""

    kind: Literal["axis"]
    quantity: Known
    unit: Text
    ticks: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MOST.entries)]
    """The labels as printed; their largest size counts, for signs may be lost."""
    of: Annotated[tuple[Id, ...], Field(min_length=1)]
    """The claims of durations whose motion the figure shows."""
    joint: Text | None = None
    """The joint that it shows; all if absent."""

    @model_validator(mode="after")
    def _unit_fits(self) -> Self:
        _check_unit(self.quantity, self.unit)
        if all(tick.fraction == 0 for tick in self.ticks):
            raise fault(".ticks", "are all 0; give the labels of the axis")
        return self


class DataSheetClue(Clue):
    """Limits of the robot as a data sheet states them."""

    kind: Literal["data-sheet"]
    quantity: Known
    unit: TextOrEach
    """The unit of all values, or of each."""
    values: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MOST.entries)]
    """One for each of the robot's joints."""

    @model_validator(mode="after")
    def _unit_fits(self) -> Self:
        for index, unit in enumerate(self.units(1)):
            at = f"[{index}]" if isinstance(self.unit, tuple) else ""
            _check_unit(self.quantity, unit, at)
        if any(value.fraction <= 0 for value in self.values):
            raise fault(".values", "contain a number that is not positive; limits are positive")
        return self

    def units(self, count: int) -> tuple[str, ...]:
        """The unit of each value, where there are ``count``."""
        return self.unit if isinstance(self.unit, tuple) else (self.unit,) * count


class SmoothClue(Clue):
    """Words that say that a derivative does not jump."""

    kind: Literal["smooth"]
    quantity: Literal["velocity", "acceleration"]
    of: Annotated[tuple[Id, ...], Field(min_length=1)]
    """The claims of durations whose motion they are about."""


class HalfTurnsClue(Clue):
    """Angles of one joint that are multiples of π if they are printed in radians."""

    kind: Literal["half-turns"]
    joint: Text


AnyClue = Annotated[
    AxisClue | DataSheetClue | SmoothClue | HalfTurnsClue,
    Discriminator("kind"),
]
"""Any kind of clue, told apart by ``kind``."""

CLUE_KINDS = kinds_of(AnyClue, "kind")
"""The values of ``kind``."""


def _check_unit(quantity: Known, unit: str, at: str = "") -> None:
    if unit not in CHOICES[quantity]:
        known = ", ".join(CHOICES[quantity])
        raise fault(f".unit{at}", f"{unit!r} is not a unit of {quantity}; use one of {known}")
