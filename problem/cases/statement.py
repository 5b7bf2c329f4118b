"""From a case file, a problem and a reading to the numbers of one question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import cast

import numpy as np

from ..arrays import Array
from ..curves import MOST_OPEN, Curve, Derivatives, as_piecewise, counts_in_words
from ..duration_ratios import ratio_word
from ..errors import CaseError, RatiosError, TrajgapError
from ..limits import BRAKING, QUANTITIES, Limits
from ..printed import CHOICES, LimitPair, Measured, Printed, Quantity, is_linear, to_si
from ..problem import Coupling, Problem
from .declaration import InterpolantBlock, Values, declare
from .digits import Digits, end, turned
from .faults import Faults
from .joint_units import Units, linear_joints, unit_of
from .schema import Durations, LimitsBlock, Waypoints

Data = tuple[Curve, Limits, Array, Array]
"""Curve, limits, and bounds on the durations."""
_LIMITED: dict[str, Quantity] = {
    "velocity": "velocity",
    "acceleration": "acceleration",
    BRAKING: "acceleration",
    "jerk": "jerk",
    "snap": "snap",
    "position_lower": "position",
    "position_upper": "position",
}
"""What each key of the limits is measured in."""
_LARGEST = 1e12
"""Largest number of a case file, rad and s: squares and quotients stay far from overflow."""
_LOWER = "durations.lower"
"""The field whose value may be as near 0 as it likes: a lower bound of 0 says "positive"."""


@dataclass(frozen=True)
class Statement:
    """One problem under one reading, still in printed digits.

    ``joints`` are the positions, in the robot's list, of the joints that take part.
    """

    file: str
    name: str
    selected: str
    labels: tuple[str, ...]
    joints: tuple[int, ...]
    units: Units
    waypoints: Waypoints
    limits: LimitsBlock
    declaration: InterpolantBlock
    durations: Durations
    coupling: Coupling
    turns: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """Whole turns added to the angles of joints, one number per way-point."""

    def fail(self, field: str, reason: str) -> CaseError:
        """Make an error at a field, naming the problem and reading under which it shows."""
        return CaseError(self.file, field, reason + self.selected)

    @cached_property
    def linear(self) -> tuple[bool, ...]:
        """Whether each of the robot's joints slides instead of turning, by its units."""
        return linear_joints(self.units, len(self.labels))

    def unit(self, quantity: Quantity, joint: int | None = None) -> str | None:
        """The unit of a quantity, None if none is stated.

        Parameters
        ----------
        joint : int, optional
            Position in the robot's list; without it that of all joints that take part, None also
            where they differ.
        """
        if joint is not None:
            return unit_of(getattr(self.units, quantity), joint)
        found = {unit_of(getattr(self.units, quantity), j) for j in self.joints}
        return found.pop() if len(found) == 1 else None

    def si(
        self, number: Printed, quantity: Quantity, field: str = "", joint: int | None = None
    ) -> Measured:
        """Convert printed digits with this reading's unit of ``quantity``.

        Parameters
        ----------
        field : str
            Where the number stands in the file, for messages.
        joint : int, optional
            Which of the robot's joints it belongs to; all that take part by default.

        Raises
        ------
        CaseError
            If the unit is not stated or differs among the joints, or the number is so large or
            small that no motion can be computed with it.
        """
        unit = self.unit(quantity, joint)
        if unit is None and getattr(self.units, quantity) is not None:
            units = ", ".join(dict.fromkeys(getattr(self.units, quantity)))
            raise self.fail(
                field or quantity,
                f"is one number for joints in different units ({units}); give one for each joint",
            )
        if unit is None:
            raise self.fail(
                f"units.{quantity}", f"is missing; add one of {', '.join(CHOICES[quantity])}"
            )
        try:
            measured = to_si(number, unit)
        except TrajgapError as error:
            raise self.fail(field or quantity, str(error)) from None
        size = abs(measured.value)
        # An angle may be near 0, and so may a lower bound that says "positive".
        near_zero = quantity == "position" or field == _LOWER
        if size > _LARGEST or (0 < size < 1 / _LARGEST and not near_zero):
            raise self.fail(
                field or quantity,
                f"{number} {unit} lies outside the magnitudes from {1 / _LARGEST:g} to "
                f"{_LARGEST:g} {'m' if is_linear(unit) else 'rad'} and s that can be computed; "
                "correct digits or unit",
            )
        return measured

    def points(self) -> list[list[Measured]]:
        """Way-points in rad or m, one row per way-point, one entry per joint that takes part."""
        rows = self.waypoints.points
        if not rows:
            raise self.fail(
                "waypoints",
                f"are not printed ({self.waypoints.not_printed}); add them as joint_rows or "
                "waypoint_rows",
            )
        if len(rows[0]) != len(self.labels):
            field = "joint_rows" if self.waypoints.joint_rows is not None else "waypoint_rows"
            raise self.fail(
                f"waypoints.{field}",
                f"gives {len(rows[0])} joints, but robot.joints lists {len(self.labels)}; "
                "list every joint in both",
            )
        by_joint = self.waypoints.joint_rows is not None
        self._check_turns(len(rows))
        return [
            [
                turned(
                    self.si(
                        row[j],
                        "position",
                        f"waypoints.joint_rows[{j}][{k}]"
                        if by_joint
                        else f"waypoints.waypoint_rows[{k}][{j}]",
                        j,
                    ),
                    self.turns[self.labels[j]][k] if self.labels[j] in self.turns else 0,
                )
                for j in self.joints
            ]
            for k, row in enumerate(rows)
        ]

    def _check_turns(self, count: int) -> None:
        for label, given in self.turns.items():
            if label not in self.labels:
                listed = ", ".join(self.labels)
                raise self.fail("turns", f"joint {label!r} is unknown; robot.joints lists {listed}")
            if self.linear[self.labels.index(label)]:
                why = f"joint {label!r} slides, but turns apply to angles; leave it out"
                raise self.fail(f"turns.{label}", why)
            if len(given) != count:
                raise self.fail(
                    f"turns.{label}", f"{len(given)} numbers for {count} way-points; give one each"
                )

    @property
    def complete(self) -> bool:
        """Whether the way-points are printed, so there is a problem to solve."""
        return bool(self.waypoints.points)

    def check(self) -> None:
        """Check that a problem can be made, and list all that is in the way at once."""
        faults = Faults(self.file)
        with faults.noted():
            if self.complete:
                self.problem()
            else:
                self.data()
        if not faults.found:
            return
        # The first fault may hide the rest: each part is asked for by itself.
        with faults.noted():
            self.curve()
        with faults.noted():
            if self.complete:
                self.points()
        for name, quantity in _LIMITED.items():
            with faults.noted():
                self._limit(name, quantity, Digits.PRINTED)
        for name in ("lower", "upper"):
            with faults.noted():
                self._each("durations", name, "time", self.curve().segments, "segment", 0.0)
        faults.refuse()

    def curve(self) -> Curve:
        """Declare the curve for the number of way-points.

        Raises
        ------
        CaseError
            If the conditions don't determine the curve, or it needs another number of way-points.
        """
        block, count = self.declaration, self.waypoints.number
        if block.parameters == "chord" and len({self.linear[j] for j in self.joints}) > 1:
            raise self.fail(
                "interpolant.parameters",
                '"chord" adds angles and lengths, so its knots depend on their units; use '
                '"joint-chord" or "times"',
            )
        start = self._end("end_derivatives", block.end_derivatives, block.orders)
        finish = self._end("finish_derivatives", block.last_derivatives, block.last_orders)
        try:
            curve = declare(block, count, (start, finish))
        except TrajgapError as error:
            why = str(error).removeprefix("interpolant").lstrip(".: ")
            raise self.fail("interpolant", why) from None
        if len(curve.waypoint_breaks) != count:
            raise self.fail(
                "interpolant",
                f"{curve.name} of {curve.segments} segments passes "
                f"{len(curve.waypoint_breaks)} way-points, but {count} are given; "
                "change the family, the degrees or the way-points",
            )
        polynomials = as_piecewise(curve)
        if polynomials is not None and polynomials.free and polynomials.coefficients > MOST_OPEN:
            raise self.fail(
                "interpolant",
                f"leaves {polynomials.free} of {polynomials.coefficients} coefficients free, but "
                f"at most {MOST_OPEN} coefficients are supported if some are free; add conditions",
            )
        if polynomials is not None and polynomials.free != block.free:
            raise self.fail(
                "interpolant",
                "under-determined, "
                f"{counts_in_words(polynomials.conditions, polynomials.coefficients)} leave "
                f"{polynomials.free} free, not {block.free}; add conditions, "
                f"lower a degree, or state free = {polynomials.free}",
            )
        return curve

    @property
    def loose_ends(self) -> bool:
        """Whether a derivative at the ends, a knot or a parameter is a printed number.

        It stands for an interval, which no proof covers.
        """
        return bool(self.declaration.loose)

    @property
    def loose_ratios(self) -> bool:
        """Whether fixed ratios stand for intervals: printed digits, or lengths between them."""
        ratios = self.durations.ratios
        points = [row[j] for row in self.waypoints.points for j in self.joints]
        taken = ratios if isinstance(ratios, tuple) else points if ratios == "chord" else ()
        return any(not number.exact for number in taken)

    def _end(self, key: str, values: Values | None, orders: tuple[int, ...]) -> Derivatives:
        """Derivatives at one end in rad and s, of the joints that take part."""
        if values is None:
            return tuple((order, 0.0) for order in orders)
        return tuple(
            (order, self._end_value(f"interpolant.{key}[{index}]", order, value))
            for index, (order, value) in enumerate(zip(orders, values, strict=True))
        )

    def _end_value(
        self, field: str, order: int, given: Printed | tuple[Printed, ...]
    ) -> float | tuple[float, ...]:
        if isinstance(given, tuple):
            if len(given) != len(self.labels):
                why = f"{len(given)} values for {len(self.labels)} joints"
                raise self.fail(field, f"{why}; give one for all, or one each")
            return tuple(self._in_si(field, order, given[j], j) for j in self.joints)
        return self._in_si(field, order, given)

    def _in_si(self, field: str, order: int, number: Printed, joint: int | None = None) -> float:
        zero = number.fraction == 0 or order > len(QUANTITIES)
        return (
            0.0
            if zero
            else self.si(number, cast(Quantity, QUANTITIES[order - 1]), field, joint).value
        )

    def problem(self, digits: Digits = Digits.PRINTED) -> Problem:
        """Problem in radians, metres and seconds.

        Parameters
        ----------
        digits : Digits
            Which values limits and bounds on durations take; the way-points are as printed.

        Raises
        ------
        CaseError
            If the numbers don't fit together, or the way-points are not printed.
        """
        points = [[angle.value for angle in row] for row in self.points()]
        return self._at(self.data(digits), np.array(points))

    def problem_at(self, waypoints: Array) -> Problem:
        """The same question through other way-points.

        Parameters
        ----------
        waypoints : ndarray, shape (way-points, joints of the robot)
            rad; as many way-points as the file states.
        """
        return self._at(self.data(), waypoints[:, list(self.joints)])

    def _at(self, data: Data, waypoints: Array) -> Problem:
        curve, limits, lower, upper = data
        fixed = self.durations.ratios
        numbers = [number.value for number in fixed] if isinstance(fixed, tuple) else None
        try:
            return Problem(
                waypoints=waypoints,
                limits=limits,
                curve=curve,
                duration_lower=lower,
                duration_upper=upper,
                coupling=self.coupling,
                joints=tuple(self.labels[j] for j in self.joints),
                linear=tuple(self.linear[j] for j in self.joints),
                name=self.name,
                ratios=ratio_word(fixed) if numbers is None else np.array(numbers),
            )
        except RatiosError as error:
            raise self.fail("durations.ratios", error.why) from None
        except TrajgapError as error:
            raise self.fail("", str(error)) from None

    def data(self, digits: Digits = Digits.PRINTED) -> Data:
        """All but the way-points: curve, limits, and bounds on the durations, rad and s."""
        curve = self.curve()
        segments = curve.segments
        durations = self._each("durations", "lower", "time", segments, "segment", 0.0)
        lower = np.maximum(end(durations, digits, upper=False), 0.0)
        durations = self._each("durations", "upper", "time", segments, "segment", np.inf)
        upper = end(durations, digits, upper=True)
        if (upper == 0).any():
            raise self.fail("durations.upper", "is 0; a duration is positive, give more")
        if (lower > upper).any():
            at = int(np.argmax(lower > upper))
            raise self.fail(
                "durations.lower",
                f"lies above durations.upper in segment {at + 1}; exchange or change them",
            )
        ratios = self.durations.ratios
        if isinstance(ratios, tuple) and len(ratios) != segments:
            raise self.fail(
                "durations.ratios", f"{len(ratios)} ratios for {segments} segments; give one each"
            )
        position_lower = self._limit("position_lower", "position", digits)
        position_upper = self._limit("position_upper", "position", digits)
        if (position_lower > position_upper).any():
            raise self.fail(
                "limits.position_lower", "lies above limits.position_upper; exchange them"
            )
        limits = Limits(
            velocity=self._sizes("velocity", digits),
            acceleration=self._sizes("acceleration", digits),
            jerk=self._sizes("jerk", digits),
            snap=self._sizes("snap", digits),
            position_lower=position_lower,
            position_upper=position_upper,
        )
        try:
            limits = limits.with_deceleration(self._limit(BRAKING, "acceleration", digits))
        except TrajgapError as error:
            raise self.fail("limits.deceleration", str(error).partition(": ")[2]) from None
        return curve, limits, lower, upper

    def _sizes(self, quantity: Quantity, digits: Digits) -> Array:
        """Sizes of a derivative's limits, or their pairs where some joint has one."""
        given = getattr(self.limits, quantity)
        sizes = np.maximum(self._limit(quantity, quantity, digits), 0.0)
        if not isinstance(given, tuple) or not any(isinstance(x, LimitPair) for x in given):
            return sizes
        least = [x.lower if isinstance(x, LimitPair) else x for x in given]
        low = [
            Measured(-np.inf, -np.inf, -np.inf)
            if x is None
            else self.si(x, quantity, f"limits.{quantity}", j)
            for j, x in enumerate(least)
        ]
        # A size stands for both sides.
        low = [n if n.value <= 0 else Measured(-n.value, -n.upper, -n.lower) for n in low]
        lower = np.minimum(end([low[j] for j in self.joints], digits, upper=False), 0.0)
        return np.column_stack([lower, sizes])

    def _limit(self, name: str, quantity: Quantity, digits: Digits) -> Array:
        default = -np.inf if name == "position_lower" else np.inf
        every = self._each("limits", name, quantity, len(self.labels), "joint", default)
        return end([every[j] for j in self.joints], digits, upper=name != "position_lower")

    def _each(
        self, block: str, name: str, quantity: Quantity, count: int, item: str, default: float
    ) -> list[Measured]:
        given: Sequence[Printed | LimitPair | None] | Printed | None = getattr(
            getattr(self, block), name
        )
        none = Measured(default, default, default)
        if given is None:
            return [none] * count
        if isinstance(given, Printed):
            return [self.si(given, quantity, f"{block}.{name}")] * count
        if len(given) != count:
            raise self.fail(
                f"{block}.{name}",
                f"{len(given)} values for {count} {item}s; give one for all, or one each",
            )
        upper = [one.upper if isinstance(one, LimitPair) else one for one in given]
        return [
            none if one is None else self.si(one, quantity, f"{block}.{name}", place)
            for place, one in enumerate(upper)
        ]
