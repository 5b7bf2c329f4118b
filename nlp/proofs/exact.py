"""The problem in exact rational numbers: what a certificate speaks about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ...problem import (
    USUAL,
    Curve,
    Interpolant,
    LimitPair,
    Printed,
    Problem,
    Quantity,
    Scale,
    TrajgapError,
    as_piecewise,
    scale,
)
from ...problem.cases import Statement
from ...problem.curves import Derivatives
from .shares import exact_shares, printed_shares

MOVING = (
    "prescribes derivatives other than 0, which this kind of proof does not cover; --any-curve "
    "proves a lower bound"
)
"""Why there is no proof of a curve at fixed ratios, of a B-spline, or in units of a proof for cubic
and quintic splines; and what still holds."""
_DERIVATIVES: tuple[Quantity, ...] = ("velocity", "acceleration", "jerk")
"""Quantities whose limits certificates state, and of which ends may have a value."""
_PI = Scale(Fraction(1), 1).bounds
"""Rational bounds of π, the same as for printed numbers."""


def decimal(number: Fraction) -> str:
    """Exact text of a rational: a decimal where it ends, a quotient otherwise."""
    digits, rest = 0, number.denominator
    for prime in (2, 5):
        count = 0
        while rest % prime == 0:
            rest //= prime
            count += 1
        digits = max(digits, count)
    if rest != 1 or digits > 60:
        return f"{number.numerator}/{number.denominator}"
    whole = abs(number) * 10**digits
    text = str(whole.numerator).rjust(digits + 1, "0")
    sign = "-" if number < 0 else ""
    return sign + (f"{text[:-digits]}.{text[-digits:]}" if digits else text)


@dataclass(frozen=True)
class Real:
    """The number ``rational · π**pi``, pi = −1, 0 or 1."""

    rational: Fraction
    pi: int = 0

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """Rational bounds of the number, equal without π."""
        if self.pi == 0:
            return self.rational, self.rational
        found = [self.rational * p if self.pi > 0 else self.rational / p for p in _PI]
        return min(found), max(found)

    @property
    def low(self) -> Fraction:
        """Rational lower bound."""
        return self.ends[0]

    @property
    def high(self) -> Fraction:
        """Rational upper bound."""
        return self.ends[1]


Prescribed = tuple[tuple[tuple[int, tuple[Fraction, ...]], ...], ...]
"""At each break derivatives by order, one for each joint, in the problem's unit of angle and s."""
Pair = tuple[Real | None, Real | None]
"""Sizes of a lower and an upper limit; None if there is none."""


def _joined(pairs: Mapping[tuple[int, int], Pair]) -> dict[tuple[int, int], Real | None]:
    """The larger size of each pair: none where a side has none."""
    found: dict[tuple[int, int], Real | None] = {}
    for place, (low, high) in pairs.items():
        found[place] = None if low is None or high is None else max(low, high, key=_high)
    return found


def _high(value: Real) -> Fraction:
    return value.high


@dataclass(frozen=True)
class ExactProblem:
    """A problem with shared durations, every number rational.

    A lower bound of the total takes the looser end of a limit with π, an answer the tighter one.

    Attributes
    ----------
    name : str
    curve : Curve
    joints : tuple of str
    waypoints : tuple of tuple of Fraction
        One row per way-point, in ``unit``.
    limits : tuple of tuple
        Per joint: velocity, acceleration, jerk as `Real` in ``unit``/sʳ, or None. Sizes that hold
        on both sides; for a pair in ``pairs`` the larger one, so a bound on the least total within
        them also holds within the pairs.
    position_lower, position_upper : tuple
        Per joint, a `Real` in ``unit`` or None.
    duration_lower : tuple of Fraction
        s; 0 means "positive".
    duration_upper : tuple of Fraction or None
        s.
    unit : str
        Unit of the way-points, "rad" or "deg", or "m", "cm" or "mm" for sliding joints; if joints
        differ, all units, separated by commas.
    pairs : tuple of ((joint, order), pair)
        Sizes of the lower and the upper limit, if they differ, which an answer has to keep in
        addition to ``limits``.
    prescribed : tuple or None
        Exact derivatives that the curve prescribes at its breaks, if its floats only approximate
        them.
    shares : tuple of Fraction or None
        Share of each segment in the total, if ratios fix it.
    chord : bool
        Whether the ratios are those of chord lengths that are not rational numbers; then without
        ``shares``.
    relaxed : tuple of str
        Quantities whose limits are left out (`Limits.unproved`). The least total without them is a
        lower bound on the one with them, and no answer to this problem is one within them.
    """

    name: str
    curve: Curve
    joints: tuple[str, ...]
    waypoints: tuple[tuple[Fraction, ...], ...]
    limits: tuple[tuple[Real | None, ...], ...]
    position_lower: tuple[Real | None, ...]
    position_upper: tuple[Real | None, ...]
    duration_lower: tuple[Fraction, ...]
    duration_upper: tuple[Fraction | None, ...]
    unit: str = "rad"
    pairs: tuple[tuple[tuple[int, int], Pair], ...] = ()
    prescribed: Prescribed | None = None
    shares: tuple[Fraction, ...] | None = None
    chord: bool = False
    relaxed: tuple[str, ...] = ()

    @property
    def units(self) -> tuple[str, ...]:
        """The unit of each joint's way-points."""
        each = tuple(self.unit.split(","))
        return each * len(self.joints) if len(each) == 1 else each

    def sides(self, joint: int, order: int) -> Pair:
        """Sizes of the lower and the upper limit of a derivative."""
        own = self.limits[joint][order - 1]
        return dict(self.pairs).get((joint, order), (own, own))

    @property
    def even(self) -> ExactProblem:
        """The problem within ``limits`` alone: its least total is at most this one's."""
        return replace(self, pairs=()) if self.pairs else self

    @property
    def segments(self) -> int:
        """Number of segments."""
        return self.curve.segments

    @property
    def piecewise(self) -> Interpolant:
        """The curve as a declared piecewise polynomial.

        Raises
        ------
        TrajgapError
            If the curve is of another kind.
        """
        if not isinstance(self.curve, Interpolant):
            raise TrajgapError(f"certify: {self.curve.name} is not a declared piecewise polynomial")
        return self.curve

    def joint(self, index: int) -> ExactProblem:
        """The same problem for one joint only."""
        one = slice(index, index + 1)
        curve = self.curve
        if isinstance(curve, Interpolant):
            curve = curve.for_joint(np.empty(0), index)
        own = self.prescribed
        if own is not None:
            own = tuple(tuple((r, each[one]) for r, each in at) for at in own)
        return ExactProblem(
            f"{self.name}, joint {self.joints[index]}",
            curve,
            self.joints[one],
            tuple(row[one] for row in self.waypoints),
            self.limits[one],
            self.position_lower[one],
            self.position_upper[one],
            self.duration_lower,
            self.duration_upper,
            self.units[index],
            tuple(((0, r), pair) for (j, r), pair in self.pairs if j == index),
            own,
            self.shares,
            self.chord,
            self.relaxed,
        )


def one_velocity(end: Derivatives) -> float | None:
    """The velocity that is prescribed for all joints at an end; None if none is.

    Raises
    ------
    TrajgapError
        If it differs from joint to joint.
    """
    value = dict(end).get(1)
    if isinstance(value, tuple):
        raise TrajgapError(
            "certify: end velocities that differ between joints are covered for polynomials only"
        )
    return value


def exact_problem(problem: Problem) -> ExactProblem:
    """Take the floats of a `Problem` as exact numbers.

    Parameters
    ----------
    problem : Problem
        Its coupling is ignored.

    Returns
    -------
    ExactProblem
    """
    limits = problem.limits

    def point(value: float) -> Real | None:
        return Real(Fraction(value)) if np.isfinite(value) else None

    below, above = limits.sides
    pairs = [
        ((j, r + 1), (point(float(below[j, r])), point(float(above[j, r]))))
        for j, r in np.argwhere((below != above)[:, :USUAL]).tolist()
    ]
    return ExactProblem(
        problem.name,
        problem.curve,
        problem.joints,
        tuple(tuple(Fraction(float(q)) for q in row) for row in problem.waypoints),
        tuple(tuple(point(float(x)) for x in row) for row in limits.widest[:, :USUAL]),
        tuple(point(float(x)) for x in limits.position_lower),
        tuple(point(float(x)) for x in limits.position_upper),
        tuple(Fraction(float(x)) for x in problem.duration_lower),
        tuple(Fraction(float(x)) if np.isfinite(x) else None for x in problem.duration_upper),
        unit=_joined_units(["m" if slides else "rad" for slides in problem.linear]),
        pairs=tuple(pairs),
        shares=exact_shares(problem.ratios),
        relaxed=limits.unproved,
    )


def printed_problem(statement: Statement) -> ExactProblem:
    """Take the printed digits of one problem under one reading as exact numbers.

    Parameters
    ----------
    statement : Statement
        From `Case.statement`.

    Returns
    -------
    ExactProblem
        Each joint in the unit of its way-points; a limit in another unit of angle contains π.

    Raises
    ------
    TrajgapError
        If turns are added to angles, or a derivative that is prescribed at an end is an interval
        or in another unit of angle than the way-points.
    CaseError
        If a unit is missing.
    """
    statement.points()
    if statement.turns:
        raise TrajgapError("certify: angles with whole turns added are not covered")
    problem = statement.problem()
    curve, prescribed = problem.curve, None
    if not curve.homogeneous:
        curve, prescribed = _in_motion(statement, curve)

    def own(number: Printed | None, quantity: Quantity, joint: int) -> Real | None:
        unit = statement.unit(quantity, joint)
        if number is None or unit is None:
            return None
        base, other = scale(str(statement.unit("position", joint))), scale(unit)
        value = number.fraction * other.rational / base.rational
        return Real(value, other.pi - base.pi)

    def each(given: Any, count: int) -> list[Any]:
        return list(given) if isinstance(given, tuple | list) else [given] * count

    limits, total = statement.limits, len(statement.labels)
    columns: list[list[Real | None]] = []
    pairs: dict[tuple[int, int], Pair] = {}
    for order, name in enumerate(_DERIVATIVES, 1):
        column = each(getattr(limits, name), total)
        for place, j in enumerate(statement.joints):
            if not isinstance(column[j], LimitPair):
                continue
            ends = (column[j].lower, column[j].upper)
            least, most = (own(x, name, j) for x in ends)
            below = None if least is None else Real(-least.rational, least.pi)
            if below != most:
                pairs[place, order] = below, most
            column[j] = column[j].upper
        joined = _joined(pairs)
        found = [
            joined[place, order] if (place, order) in joined else own(column[j], name, j)
            for place, j in enumerate(statement.joints)
        ]
        if order == 2:
            # An acceleration lies within the larger limit, whatever the sign of the speed.
            braking = each(limits.deceleration, total)
            apart = [own(braking[j], name, j) for j in statement.joints]
            both = zip(found, apart, strict=True)
            found = [a if a is None or d is None else max(a, d, key=_high) for a, d in both]
        columns.append(found)
    low, high = (
        [own(each(getattr(limits, name), total)[j], "position", j) for j in statement.joints]
        for name in ("position_lower", "position_upper")
    )
    time = statement.units.time
    second = scale(time).rational if time is not None else Fraction(1)
    n = problem.segments
    rows = statement.waypoints.points
    shortest, longest = each(statement.durations.lower, n), each(statement.durations.upper, n)
    return ExactProblem(
        problem.name,
        curve,
        problem.joints,
        tuple(tuple(row[j].fraction for j in statement.joints) for row in rows),
        tuple(zip(*columns, strict=True)),
        tuple(low),
        tuple(high),
        tuple(Fraction(0) if x is None else x.fraction * second for x in shortest),
        tuple(None if x is None else x.fraction * second for x in longest),
        _joined_units([str(statement.unit("position", j)) for j in statement.joints]),
        tuple(pairs.items()),
        prescribed,
        printed_shares(statement, problem),
        statement.durations.ratios == "chord" and len(statement.joints) > 1,
        problem.limits.unproved,
    )


def _joined_units(each: Sequence[str]) -> str:
    """The unit of all joints, or those of each where they differ."""
    return each[0] if len(set(each)) == 1 else ",".join(each)


def _in_motion(statement: Statement, curve: Curve) -> tuple[Interpolant, Prescribed]:
    """A curve whose ends move, in the unit of the way-points, and its exact derivatives."""
    polynomials = as_piecewise(curve)
    if polynomials is None or any(polynomials.prescribed[1:-1]):
        raise TrajgapError("certify: derivatives are prescribed between the ends")
    if statement.loose_ends:
        raise TrajgapError(
            "certify: a derivative at an end is a printed number, which stands for an interval; "
            "write it as a bare number"
        )
    block = statement.declaration
    ends: list[tuple[tuple[int, tuple[Fraction, ...]], ...]] = []
    for orders, values in (
        (block.orders, block.end_derivatives),
        (block.last_orders, block.last_derivatives),
    ):
        found = []
        for place, order in enumerate(orders):
            given = Printed("0", exact=True) if values is None else values[place]
            each = given if isinstance(given, tuple) else (given,) * len(statement.labels)
            found.append(
                (order, tuple(_derivative(each[j], order, statement, j) for j in statement.joints))
            )
        ends.append(tuple(found))
    exact = (ends[0], *((),) * (polynomials.segments - 1), ends[1])
    own = tuple(tuple((r, tuple(map(float, each))) for r, each in at) for at in exact)
    return replace(polynomials, prescribed=own), exact


def _derivative(number: Printed, order: int, statement: Statement, joint: int) -> Fraction:
    """A derivative at an end in the unit of its joint's way-points, and s."""
    if number.fraction == 0:
        return Fraction(0)
    base = scale(str(statement.unit("position", joint)))
    other = scale(str(statement.unit(_DERIVATIVES[order - 1], joint)))
    if other.pi != base.pi:
        raise TrajgapError(
            "certify: a derivative at an end is in another unit of angle than the way-points, "
            "so no certificate can state it exactly; give both in the same unit"
        )
    return number.fraction * other.rational / base.rational
