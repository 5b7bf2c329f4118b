"""A Denavit–Hartenberg table as a paper prints it, and the chains that it can mean."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, PlainSerializer, PlainValidator, WithJsonSchema, model_validator

from ..arrays import Array
from ..files import MOST
from ..printed import (
    MINUS_SIGNS,
    AngleUnit,
    JointLabels,
    LengthUnit,
    LowerPosition,
    Measured,
    Number,
    Printed,
    Strict,
    UpperPosition,
    fault,
    plain_number,
    read_number,
    to_si,
)
from .chain import Chain, Convention, JointKind

_PI_MULTIPLE = re.compile(r"([+-]?)\s*([0-9]*)\s*(?:π|pi)\s*(?:/\s*([1-9][0-9]*))?")
"""A multiple of π: sign, numerator, denominator."""


@dataclass(frozen=True)
class PiMultiple:
    """An angle printed as a multiple of π, such as ``"-π/2"``, meant exactly."""

    text: str
    factor: Fraction

    @property
    def value(self) -> float:
        """The angle in rad."""
        return float(self.factor * Fraction(math.pi))  # exactly the double, as in every toolbox


def read_angle(raw: object) -> Printed | PiMultiple:
    """Read a printed or exact number, or a multiple of π."""
    if isinstance(raw, PiMultiple):
        return raw
    text = raw.strip().translate(MINUS_SIGNS) if isinstance(raw, str) else ""
    match = _PI_MULTIPLE.fullmatch(text)
    if match is None or len(text) > MOST.digits:
        return read_number(raw)
    factor = Fraction(int(match[2] or 1), int(match[3] or 1))
    return PiMultiple(text, -factor if match[1] == "-" else factor)


def _plain(angle: Printed | PiMultiple) -> str | int | float | None:
    return angle.text if isinstance(angle, PiMultiple) else plain_number(angle)


Angle = Annotated[
    Printed | PiMultiple,
    PlainValidator(read_angle),
    PlainSerializer(_plain),
    WithJsonSchema({"type": ["number", "string"]}),
]
"""A `Number`, or a multiple of π such as "-π/2"."""


class DhTable(Strict):
    """A Denavit–Hartenberg table as printed, one entry per joint in every list."""

    where: str = ""
    convention: Convention
    """How a row makes a transform: standard, or modified (a and α of the link before)."""
    other_conventions: tuple[Convention, ...] = ()
    """Conventions that the source admits beside it."""
    why: str = ""
    """Why others are admitted, or why signs are uncertain."""
    length_unit: LengthUnit
    angle_unit: AngleUnit
    joints: JointLabels | None = None
    """Joint labels; those of the robot if absent."""
    kinds: tuple[JointKind, ...] | None = None
    """revolute or prismatic; all revolute if absent."""
    d: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MOST.joints)]
    a: tuple[Number, ...]
    alpha: tuple[Angle, ...]
    theta_offset: tuple[Angle, ...] | None = None
    """Angle where the joint variable is 0; 0 if absent."""
    lower: tuple[LowerPosition, ...] | None = None
    upper: tuple[UpperPosition, ...] | None = None
    alpha_signs: Literal["certain", "uncertain"] = "certain"
    """Whether signs of α may be lost."""

    @model_validator(mode="after")
    def _one_entry_per_joint(self) -> Self:
        for name in ("d", "a", "alpha", "theta_offset", "kinds", "lower", "upper"):
            row = getattr(self, name)
            if row is not None and len(row) != len(self.d):
                raise fault(
                    f".{name}", f"has {len(row)} entries, but d has {len(self.d)}; give one each"
                )
        if self.joints is not None:
            if len(self.joints) != len(self.d):
                raise fault(
                    ".joints",
                    f"{len(self.joints)} labels, but d has {len(self.d)} entries; give one each",
                )
            if len(set(self.joints)) < len(self.joints):
                raise fault(".joints", "names a joint twice; rename one")
        if self.convention in self.other_conventions:
            raise fault(".other_conventions", f"repeats {self.convention}; leave it out")
        for name in ("alpha", "theta_offset"):
            for index, angle in enumerate(getattr(self, name) or ()):
                if isinstance(angle, PiMultiple) and self.angle_unit != "rad":
                    raise fault(
                        f".{name}[{index}]",
                        f"{angle.text} is in rad, but angle_unit is {self.angle_unit}; "
                        "write it in that unit",
                    )
        for index, (low, high) in enumerate(zip(*self._bounds(), strict=True)):
            if low > high:
                raise fault(f".lower[{index}]", "lies above upper; exchange them")
        return self

    @property
    def conventions(self) -> tuple[Convention, ...]:
        """Every convention that the source admits, the stated one first."""
        return (self.convention, *self.other_conventions)

    @property
    def twisted(self) -> tuple[int, ...]:
        """Rows whose twist changes with its sign."""
        angles = _values(self._row("alpha"))
        return tuple(int(i) for i in np.flatnonzero(np.abs(np.sin(angles)) > 1e-12))

    def chain(
        self,
        name: str = "",
        labels: tuple[str, ...] = (),
        convention: Convention | None = None,
        flipped: tuple[int, ...] = (),
    ) -> Chain:
        """Chain of the printed numbers.

        Parameters
        ----------
        labels : tuple of str
            Joint labels where the table has none.
        convention : Convention, optional
            Instead of the stated one.
        flipped : tuple of int
            Rows whose α is taken with the other sign.
        """
        signs = np.ones(len(self.d))
        signs[list(flipped)] = -1.0
        lower, upper = self._bounds()
        return Chain(
            convention=convention or self.convention,
            a=_values(self._row("a")),
            alpha=signs * _values(self._row("alpha")),
            d=_values(self._row("d")),
            theta_offset=_values(self._row("theta_offset")),
            kinds=self.kinds or (),
            lower=lower,
            upper=upper,
            labels=self.joints or labels,
            name=name,
        )

    def rounding(self, chain: Chain) -> float:
        """Bound on how far rounding of the printed table moves the end, m.

        Half a unit in the last place of every length, and of every angle times what it swings.
        """
        lengths = _halves(self._row("a")).sum() + _halves(self._row("d")).sum()
        swung = chain.reach * _halves(self._row("alpha")).sum()
        turned = chain.arms * _halves(self._row("theta_offset"))
        return float(lengths + swung + turned.sum())

    def _row(self, name: str) -> list[Measured]:
        """Entries in rad or m."""
        angles = name in ("alpha", "theta_offset")
        unit = self.angle_unit if angles else self.length_unit
        zero = Printed("0", exact=True)
        return [
            Measured(*(number.value,) * 3)
            if isinstance(number, PiMultiple)
            else to_si(number, unit)
            for number in getattr(self, name) or (zero,) * len(self.d)
        ]

    def _bounds(self) -> tuple[Array, Array]:
        units = {JointKind.REVOLUTE: self.angle_unit, JointKind.PRISMATIC: self.length_unit}
        each = [units[kind] for kind in self.kinds or (JointKind.REVOLUTE,) * len(self.d)]

        def bounds(row: Sequence[Printed | None] | None, none: float) -> Array:
            numbers = zip(row or (None,) * len(each), each, strict=True)
            return np.array([none if n is None else to_si(n, unit).value for n, unit in numbers])

        return bounds(self.lower, -np.inf), bounds(self.upper, np.inf)


def _values(row: list[Measured]) -> Array:
    return np.array([entry.value for entry in row])


def _halves(row: list[Measured]) -> Array:
    return np.array([(entry.upper - entry.lower) / 2 for entry in row])
