"""How a case file declares its interpolant, and the curve that it means."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
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
from ..fields import Number, OneOrEachNumber, Strict, fault
from .literature import meant_by

Ends = tuple[Derivatives, Derivatives]
"""Derivatives ``(order, value)`` prescribed at the start and at the finish, rad/sᵒʳᵈᵉʳ."""
Values = tuple[Number | tuple[Number, ...], ...]
"""As printed: for each order one value for all joints, or one for each of them."""


@dataclass(frozen=True)
class Family:
    """A kind of curve as case files name it.

    Attributes
    ----------
    curve : callable
        From the block, the number of way-points and the derivatives at both ends to the curve.
    needed, allowed : tuple of str
        Keys of the block that it asks for, and that it takes beside.
    """

    curve: Callable[[InterpolantBlock, int, Ends], Curve]
    needed: tuple[str, ...] = ()
    allowed: tuple[str, ...] = ()


def _polynomials(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
    continuity = 2 if block.continuity is None else block.continuity
    virtual = block.virtual or ()
    return piecewise(block.degrees or (), continuity, ends[0], finish=ends[1], virtual=virtual)


def _spline(made: Callable[..., Curve]) -> Callable[[InterpolantBlock, int, Ends], Curve]:
    """A spline of one degree: a segment between breaks, of which virtual ones are no way-points."""

    def declared(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
        virtual = block.virtual or ()
        return made(count - 1 + len(virtual), *ends, virtual=virtual)

    return declared


def _clamped(block: InterpolantBlock, count: int, ends: Ends) -> Curve:
    knots, parameters = Knots(block.knots or ""), Parameters(block.parameters or "")
    time = Timing(block.time or "timed")
    return ClampedBSpline(count, block.degree or 0, knots, parameters, time, block.orders)


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
    "clamped-b-spline": Family(_clamped, ("degree", "knots", "parameters"), ("time", "end_orders")),
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
    knots: Literal["waypoints", "averaged", "averaged-continued"] | None = None
    """Clamped B-spline: where the inner knots lie."""
    parameters: Literal["times", "chord", "joint-chord"] | None = None
    """Clamped B-spline: what the knots are placed by."""
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
            raise fault(f".{key}", f"does not go with family {self.family!r}; leave it out")
        if self.degree is not None:
            allowed_degrees = (3, 5, 7, 9) if self.family == "rest-to-rest" else range(3, 8)
            if self.degree not in allowed_degrees:
                words = ", ".join(map(str, allowed_degrees[:-1]))
                raise fault(
                    ".degree",
                    f"{self.degree} is not allowed; use {words} or {allowed_degrees[-1]}",
                )
        virtual = self.virtual or ()
        if len(set(virtual)) != len(virtual):
            raise fault(".virtual", "names a break twice; leave one out")
        for end, orders in (("end", self.orders), ("finish", self.last_orders)):
            if len(set(orders)) != len(orders):
                raise fault(f".{end}_orders", "names an order twice; leave one out")
            _check_values(f".{end}_derivatives", getattr(self, f"{end}_derivatives"), orders)
        return self

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
    block : InterpolantBlock
    count : int
        Number of way-points.
    ends : tuple
        Derivatives ``(order, value)`` prescribed at the start and at the finish, rad/sᵒʳᵈᵉʳ, where
        the family leaves them open.

    Returns
    -------
    Curve

    Raises
    ------
    TrajgapError
        If the declaration is over- or under-determined or contradicts itself.
    """
    return FAMILIES[block.family].curve(block, count, ends)
