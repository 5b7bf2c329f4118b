"""The problem and the claim as a certificate states them, read strictly: standard library only."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

_DIGITS = 314159265358979323846264338327950288419716939937510
PI = (Fraction(_DIGITS, 10**50), Fraction(_DIGITS + 1, 10**50))
_NUMBER = re.compile(r"-?\d{1,400}(/[1-9]\d{0,400}|\.\d{1,400})?(e-?\d{1,2})?")

Bounds = tuple[Fraction, Fraction] | None
"""Rational bounds of a number that may carry π; None where there is no limit."""


class Refused(ValueError):
    """The file does not prove what it claims; the message says where."""


@dataclass(frozen=True)
class Proved:
    """What a proof shows.

    Attributes
    ----------
    lower : Fraction
        No feasible total is below it, s.
    upper : Fraction or None
        A feasible total, s.
    infeasible : bool
        No durations within their bounds keep the limits.
    """

    lower: Fraction
    upper: Fraction | None = None
    infeasible: bool = False


@dataclass(frozen=True)
class Declaration:
    """A piecewise polynomial; conditions as in `trajgap.problem.Interpolant`."""

    degrees: list[int]
    continuity: list[int]
    prescribed: list[dict[int, Fraction]]
    virtual: list[int]

    @property
    def at_rest(self) -> bool:
        """Whether every prescribed derivative is 0."""
        return all(value == 0 for entries in self.prescribed for value in entries.values())


@dataclass(frozen=True)
class Stated:
    """The problem in a certificate, every number rational.

    Attributes
    ----------
    waypoints : list, [way-point][joint]
    limits : list, [joint][order − 1]
    position : list, [0 lower, 1 upper][joint]
    shortest, longest : list, one per segment
    declaration : Declaration or None
        None for a curve that is no piecewise polynomial with breaks at the way-points.
    curve : str or None
        Name of such a curve.
    """

    waypoints: list[list[Fraction]]
    limits: list[list[Bounds]]
    position: list[list[Bounds]]
    shortest: list[Fraction]
    longest: list[Fraction | None]
    declaration: Declaration | None
    curve: str | None


def need(condition: bool, reason: str) -> None:
    """Refuse the file unless a condition holds."""
    if not condition:
        raise Refused(reason)


def number(text: Any) -> Fraction:
    """A rational from its exact text: an integer, a decimal or a quotient."""
    need(isinstance(text, str) and _NUMBER.fullmatch(text) is not None, f"no number: {text!r}")
    mantissa, _, exponent = text.partition("e")
    return Fraction(mantissa) * Fraction(10) ** int(exponent or 0)


def whole(value: Any, low: int, high: int) -> int:
    """An integer within bounds."""
    need(type(value) is int and low <= value <= high, f"no integer in {low}..{high}: {value!r}")
    return int(value)


def bounds(entry: Any) -> Bounds:
    """Rational bounds of a number, which may carry a factor π or 1/π; None where there is none."""
    if entry is None:
        return None
    if isinstance(entry, str):
        return number(entry), number(entry)
    value, power = number(entry["value"]), whole(entry["pi"], -1, 1)
    ends = [value * p if power > 0 else value / p if power < 0 else value for p in PI]
    return min(ends), max(ends)


def _declaration(data: dict[str, Any]) -> Declaration:
    degrees = [whole(d, 1, 9) for d in data["degrees"]]
    n = len(degrees)
    continuity = [whole(c, 0, 9) for c in data["continuity"]]
    need(n > 0 and len(continuity) == n - 1 and len(data["prescribed"]) == n + 1, "declaration")
    prescribed: list[dict[int, Fraction]] = []
    for entries in data["prescribed"]:
        orders = [whole(order, 1, 9) for order, _ in entries]
        need(len(set(orders)) == len(orders), "declaration: a derivative is prescribed twice")
        prescribed.append({order: number(value) for order, value in entries})
    virtual = [whole(b, 1, n - 1) for b in data["virtual"]]
    need(len(set(virtual)) == len(virtual), "declaration: a break is named twice")
    return Declaration(degrees, continuity, prescribed, virtual)


def read_problem(data: dict[str, Any]) -> Stated:
    """Read the problem of a certificate.

    Parameters
    ----------
    data : dict
        ``problem`` of the file.

    Returns
    -------
    Stated

    Raises
    ------
    Refused
        If shapes disagree or a bound makes no sense.
    """
    declaration = _declaration(data) if "degrees" in data else None
    curve = None if declaration is not None else str(data["curve"])
    joints = len(data["joints"])
    q = [[number(x) for x in row] for row in data["waypoints"]]
    need(joints > 0 and all(len(r) == joints for r in q), "way-points: shape")
    limits = [[bounds(x) for x in row] for row in data["limits"]]
    need(len(limits) == joints and all(len(r) == 3 for r in limits), "limits: shape")
    need(all(x is None or x[0] >= 0 for r in limits for x in r), "limits: negative")
    position = [[bounds(x) for x in data[key]] for key in ("position_lower", "position_upper")]
    need(all(len(side) == joints for side in position), "position limits: shape")
    shortest = [number(x) for x in data["duration_lower"]]
    longest = [None if x is None else number(x) for x in data["duration_upper"]]
    n = len(q) - 1 if declaration is None else len(declaration.degrees)
    need(n > 0 and len(shortest) == len(longest) == n, "duration bounds: shape")
    if declaration is not None:
        need(len(q) == n + 1 - len(declaration.virtual), "way-points: shape")
    need(min(shortest) >= 0 and all(x is None or x > 0 for x in longest), "duration bounds")
    return Stated(q, limits, position, shortest, longest, declaration, curve)
