"""How a case file declares its interpolant, and the curve that it means."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, PlainValidator, StrictInt, WithJsonSchema, model_validator

from ..curves import (
    ClampedBSpline,
    Curve,
    Derivatives,
    Knots,
    Parameters,
    Timing,
    cubic_spline,
    cubic_spline_virtual,
    jtraj,
    piecewise,
    quintic_spline,
    quintic_spline_virtual,
    rest_to_rest,
    septic_spline,
    three_five_three,
    uniform_cubic_b_spline,
)
from ..errors import TrajgapError
from ..printed import Number, OneOrEachNumber, Printed, Strict, fault
from .literature import meant_by

Ends = tuple[Derivatives, Derivatives]
"""Derivatives ``(order, value)`` prescribed at the start and at the finish, rad/sᵒʳᵈᵉʳ."""
Values = tuple[Number | tuple[Number, ...], ...]
"""As printed: for each order one value for all joints, or one for each of them."""


@dataclass(frozen=True)
class Family:
    """A kind of curve as case files name it."""

    curve: Callable[[InterpolantBlock, int, Ends], Curve]
    """From the block, the number of way-points and the derivatives at both ends to the curve."""
    needed: tuple[str, ...] = ()
    allowed: tuple[str, ...] = ()
    """Keys of the block that it asks for, and that it takes beside."""


def _polynomials(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
    continuity = 2 if block.continuity is None else block.continuity
    virtual = block.virtual or ()
    return piecewise(block.degrees or (), continuity, ends[0], finish=ends[1], virtual=virtual)


def _spline(made: Callable[..., Curve]) -> Callable[[InterpolantBlock, int, Ends], Curve]:
    """A spline of one degree with a segment between breaks; virtual breaks are not way-points."""

    def declared(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
        virtual = block.virtual or ()
        return made(count - 1 + len(virtual), *ends, virtual=virtual)

    return declared


def _clamped(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
    knots, parameters = Knots(block.knots or ""), Parameters(block.parameters or "")
    time = Timing(block.time or "timed")
    fractions = None
    if block.parameter_values is not None:
        if len(block.parameter_values) != count:
            raise TrajgapError(
                f"interpolant.parameter_values: {len(block.parameter_values)} numbers for {count} "
                "way-points; give one each"
            )
        fractions = (_scaled(block.parameter_values),)
    vector = () if block.knot_vector is None else _scaled(block.knot_vector)
    return ClampedBSpline(
        count, block.degree or 0, knots, parameters, time, block.orders, fractions, vector
    )


def _scaled(numbers: tuple[Number, ...]) -> tuple[float, ...]:
    """Printed numbers as fractions of the whole, from the first, 0, to the last, 1."""
    first, last = numbers[0].fraction, numbers[-1].fraction
    return tuple(float((one.fraction - first) / (last - first)) for one in numbers)


_ENDS = ("end_orders", "finish_orders", "end_derivatives", "finish_derivatives", "virtual", "free")
"""Keys of the families whose ends and virtual breaks can be chosen."""
_USUAL_ORDERS = {"cubic-spline": (1,), "septic-spline": (1, 2, 3)}
"""Orders at the ends that determine a spline where its block has none, if they are not (1, 2)."""
FAMILIES = {
    "3-5-3": Family(lambda block, count, ends: three_five_three()),
    "polynomials": Family(_polynomials, ("degrees",), ("continuity", *_ENDS)),
    "cubic-spline": Family(_spline(cubic_spline), (), _ENDS),
    "quintic-spline": Family(_spline(quintic_spline), (), _ENDS),
    "septic-spline": Family(_spline(septic_spline), (), _ENDS),
    "cubic-spline-virtual": Family(lambda block, count, ends: cubic_spline_virtual(count)),
    "quintic-spline-virtual": Family(lambda block, count, ends: quintic_spline_virtual(count)),
    "rest-to-rest": Family(
        lambda block, count, ends: rest_to_rest(count - 1, block.degree or 0), ("degree",)
    ),
    "jtraj": Family(lambda block, count, ends: jtraj(count - 1)),
    "uniform-cubic-b-spline": Family(
        lambda block, count, ends: uniform_cubic_b_spline(
            count, block.time or "", block.time_ends == "natural"
        ),
        ("time",),
        ("time_ends",),
    ),
    "clamped-b-spline": Family(
        _clamped,
        ("degree", "knots", "parameters"),
        ("time", "end_orders", "knot_vector", "parameter_values"),
    ),
}
"""Families by the name that case files give them; a polynomial interpolant is one entry."""


def _known(name: object) -> str:
    if not isinstance(name, str) or name not in FAMILIES:
        meant = meant_by(name, FAMILIES) if isinstance(name, str) else None
        if meant is not None:
            raise fault("", f"{name!r} is not allowed; write {meant.written()}")
        *most, last = map(repr, FAMILIES)
        raise fault("", f"{name!r} is not allowed; use {', '.join(most)} or {last}")
    return name


FamilyName = Annotated[
    str, PlainValidator(_known), WithJsonSchema({"enum": list(FAMILIES), "type": "string"})
]
"""One of the names of `FAMILIES`."""


class InterpolantBlock(Strict):
    """The curve through the way-points."""

    family: FamilyName
    where: str = ""
    degrees: tuple[Annotated[StrictInt, Field(ge=1, le=9)], ...] | None = None
    """Polynomials: the degree of each segment."""
    continuity: Annotated[StrictInt, Field(ge=0, le=8)] | None = None
    """Polynomials: highest continuous derivative at the via-points; 2 if absent."""
    end_orders: tuple[Annotated[StrictInt, Field(ge=1, le=8)], ...] | None = None
    """Orders of the derivatives prescribed at both ends; [1, 2] if absent (cubic-spline: [1],
    septic-spline: [1, 2, 3])."""
    finish_orders: tuple[Annotated[StrictInt, Field(ge=1, le=8)], ...] | None = None
    """Those at the last way-point, where they are others; end_orders are the start's then."""
    end_derivatives: tuple[OneOrEachNumber, ...] | None = None
    """Their values, in the units of the file, each one for all joints or one per joint; all 0 if
    absent."""
    finish_derivatives: tuple[OneOrEachNumber, ...] | None = None
    """Those at the last way-point, where they differ; end_derivatives are the start's then."""
    degree: StrictInt | None = None
    """Rest-to-rest: degree of every segment, 3, 5, 7 or 9. Clamped B-spline: 3 to 7."""
    knots: Literal["waypoints", "averaged", "averaged-continued", "given"] | None = None
    """Clamped B-spline: where the inner knots lie."""
    knot_vector: Annotated[tuple[Number, ...], Field(min_length=2)] | None = None
    """Clamped B-spline whose knots are given: all of them as printed, on any scale, those that are
    repeated at the ends included."""
    parameters: Literal["times", "chord", "joint-chord", "given"] | None = None
    """Clamped B-spline: what places the knots, and the way-points where time is stretched."""
    parameter_values: Annotated[tuple[Number, ...], Field(min_length=2)] | None = None
    """Clamped B-spline whose parameters are given: one per way-point, on the scale of the knots."""
    time: Literal["stretched", "timed"] | None = None
    """B-splines: whether each segment is stretched in time by itself, or time is smooth."""
    time_ends: Literal["equal-vertices", "natural"] | None = None
    """Uniform B-spline whose time is timed: how time ends, as the joints do if absent."""
    virtual: tuple[Annotated[StrictInt, Field(ge=1)], ...] | None = None
    """Breaks without a way-point, counted among all breaks with the first way-point as 0."""
    free: Annotated[StrictInt, Field(ge=0)] = 0
    """Coefficients per joint that the conditions leave free: positions of virtual breaks first."""

    @model_validator(mode="after")
    def _keys_of_family(self) -> Self:
        family = FAMILIES[self.family]
        for key in family.needed:
            if getattr(self, key) is None:
                raise fault(f".{key}", f"is missing; family {self.family!r} needs it")
        for key in self.model_fields_set - {"family", "where", *family.needed, *family.allowed}:
            raise fault(f".{key}", f"is not used by family {self.family!r}; leave it out")
        if self.degree is not None:
            allowed_degrees = (3, 5, 7, 9) if self.family == "rest-to-rest" else range(3, 8)
            if self.degree not in allowed_degrees:
                words = ", ".join(map(str, allowed_degrees[:-1]))
                raise fault(
                    ".degree",
                    f"{self.degree} is not allowed; use {words} or {allowed_degrees[-1]}",
                )
        self._check_numbers()
        virtual = self.virtual or ()
        if len(set(virtual)) != len(virtual):
            raise fault(".virtual", "names a break twice; leave one out")
        for end, orders in (("end", self.orders), ("finish", self.last_orders)):
            if len(set(orders)) != len(orders):
                raise fault(f".{end}_orders", "names an order twice; leave one out")
            _check_values(f".{end}_derivatives", getattr(self, f"{end}_derivatives"), orders)
        return self

    def _check_numbers(self) -> None:
        """Find out whether what is printed of knots and parameters is there where it is used."""
        for key, listed in (("knots", "knot_vector"), ("parameters", "parameter_values")):
            numbers = getattr(self, listed)
            given = getattr(self, key) == "given"
            if given and numbers is None:
                raise fault(f".{listed}", f'is missing; {key} = "given" needs it')
            if numbers is not None and not given:
                raise fault(
                    f".{listed}", f'is used only with {key} = "given"; leave it out, or write that'
                )
            if numbers is not None:
                _check_rising(f".{listed}", numbers, repeats=listed == "knot_vector")
        if self.knot_vector is not None and self.parameter_values is not None:
            ends = [
                tuple(n.fraction for n in (one[0], one[-1]))
                for one in (self.parameter_values, self.knot_vector)
            ]
            if ends[0] != ends[1]:
                knots, values = self.knot_vector, self.parameter_values
                raise fault(
                    ".parameter_values",
                    f"run from {values[0]} to {values[-1]}, but knot_vector from {knots[0]} to "
                    f"{knots[-1]}; give both on one scale",
                )

    @property
    def orders(self) -> tuple[int, ...]:
        """Orders prescribed at the start, and at the finish unless it has its own."""
        if self.end_orders is not None:
            return self.end_orders
        return _USUAL_ORDERS.get(self.family, (1, 2))

    @property
    def last_orders(self) -> tuple[int, ...]:
        """Orders prescribed at the finish."""
        return self.orders if self.finish_orders is None else self.finish_orders

    @property
    def last_derivatives(self) -> Values | None:
        """Values at the finish: its own, or the start's where both prescribe the same orders."""
        own = self.finish_derivatives is not None or self.finish_orders is not None
        return self.finish_derivatives if own else self.end_derivatives

    @property
    def _ends(self) -> Values:
        """The values prescribed at both ends."""
        return (*(self.end_derivatives or ()), *(self.finish_derivatives or ()))

    @property
    def at_rest(self) -> bool:
        """Whether no derivative other than 0 is prescribed at the ends."""
        return all(number.fraction == 0 for number in _each(self._ends))

    @property
    def loose(self) -> str:
        """What of the curve is a printed number, as the subject of a sentence; empty if nothing."""
        parts = (
            ("derivatives at the ends", self._ends),
            ("knots", self.knot_vector or ()),
            ("parameters of way-points", self.parameter_values or ()),
        )
        found = []
        for name, every in parts:
            if any(not number.exact for number in _each(every)):
                found.append(name)
        return " and ".join(found).capitalize()


def _each(values: Values) -> Iterator[Printed]:
    """Every number, those of single joints too."""
    return (n for one in values for n in (one if isinstance(one, tuple) else (one,)))


def _check_rising(key: str, numbers: tuple[Printed, ...], repeats: bool) -> None:
    """Find out whether no number is smaller than the one before, or equal to it unless repeated."""
    for index, (one, other) in enumerate(pairwise(numbers), 1):
        if other.fraction < one.fraction or (not repeats and other.fraction == one.fraction):
            rule = "not be smaller" if repeats else "be larger"
            raise fault(
                f"{key}[{index}]", f"{other} follows {one}, but must {rule}; correct one of them"
            )
    if numbers[0].fraction == numbers[-1].fraction:
        raise fault(key, "repeats a single number; give the whole vector")


def _check_values(key: str, values: Values | None, orders: tuple[int, ...]) -> None:
    """Find out whether there is a value for each order, and a unit for each value."""
    if values is None:
        return
    if len(values) != len(orders):
        raise fault(
            key,
            f"{len(values)} values for the {len(orders)} orders {list(orders)}; "
            "give one value per order",
        )
    for index, (order, value) in enumerate(zip(orders, values, strict=True)):
        each = value if isinstance(value, tuple) else (value,)
        if order > 3 and any(one.fraction != 0 for one in each):
            raise fault(
                f"{key}[{index}]",
                f"order {order} has no unit; only 0 can be prescribed above jerk",
            )


@lru_cache(maxsize=128)
def declare(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
    """Curve that a block means for a number of way-points.

    Parameters
    ----------
    ends : tuple
        Derivatives ``(order, value)`` prescribed at the start and at the finish, rad/sᵒʳᵈᵉʳ, where
        the family leaves them open.

    Raises
    ------
    TrajgapError
        If the declaration is over- or under-determined or contradicts itself.
    """
    return FAMILIES[block.family].curve(block, count, ends)
