"""The problem as a certificate states it, read strictly."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from .ranges import MOST_DEGREE, MOST_JOINTS, MOST_POWER, MOST_SEGMENTS
from .reading import exactly, fields, listed, need, number, optional, text, whole

_DIGITS = 314159265358979323846264338327950288419716939937510
"""Of π, 51 of them: 35 more than a float has."""
PI = (Fraction(_DIGITS, 10**50), Fraction(_DIGITS + 1, 10**50))
"""Rational bounds of π."""

CHORD = "chord"
"""Stands for ratios of durations that no rational numbers state: those of chord lengths."""

Bounds = tuple[Fraction, Fraction] | None
"""Rational bounds of a number that may carry π; None if there is no limit."""

_POLYNOMIALS = ("degrees", "continuity", "prescribed", "virtual")
"""Keys that declare a piecewise polynomial; without them the curve is named."""
_KEYS = (
    "unit",
    "joints",
    "waypoints",
    "limits",
    "position_lower",
    "position_upper",
    "duration_lower",
    "duration_upper",
)
"""Keys that every problem states; what is missing is null, never left out."""


@dataclass(frozen=True)
class Declaration:
    """A piecewise polynomial."""

    degrees: list[int]
    continuity: list[int]
    """The highest derivative that agrees at each inner break."""
    prescribed: list[dict[int, list[Fraction]]]
    """At each break, the values of some derivatives, by order: one for each joint."""
    virtual: list[int]
    """Breaks without a way-point."""

    @property
    def at_rest(self) -> bool:
        """Whether every prescribed derivative is 0."""
        return not any(any(each) for entries in self.prescribed for each in entries.values())


@dataclass(frozen=True)
class StatedProblem:
    """The problem in a certificate, every number rational."""

    waypoints: list[list[Fraction]]
    """[way-point][joint]."""
    limits: list[list[Bounds]]
    """[joint][order − 1]: the larger size of both sides. A bound from below that holds within it
    holds here."""
    sides: list[list[list[Bounds]]]
    """[0 lower, 1 upper][joint][order − 1]: size on each side, which an answer keeps."""
    position: list[list[Bounds]]
    """[0 lower, 1 upper][joint]."""
    shortest: list[Fraction]
    longest: list[Fraction | None]
    declaration: Declaration | None
    """None for a curve that is not a piecewise polynomial with breaks at the way-points."""
    curve: str | None
    """Name of such a curve."""
    ends: list[list[Fraction | None]]
    """[0 start, 1 end][joint]: velocity prescribed there; None if it is free."""
    shares: list[Fraction] | None = None
    """Shares of the segments in the total, if ratios fix them."""
    chord: bool = False
    """Whether they are fixed by chord lengths, which are not rational numbers; without shares."""

    @property
    def joints(self) -> int:
        """How many joints."""
        return len(self.limits)

    @property
    def segments(self) -> int:
        """How many segments."""
        return len(self.shortest)


def read_problem(data: Any) -> StatedProblem:
    """Read ``problem`` of a certificate.

    Raises
    ------
    Refused
        If it is malformed, too large, or a bound makes no sense.
    """
    polynomial = type(data) is dict and "degrees" in data
    own, more = (_POLYNOMIALS, ()) if polynomial else (("curve",), ("ends",))
    data = fields(data, "problem", (*_KEYS, *own), (*more, "ratios"))
    text(data["unit"], "unit")
    labels = [text(x, "joints") for x in listed(data["joints"], "joints", MOST_JOINTS, 1)]
    need(len(set(labels)) == len(labels), "malformed: joints: a name occurs twice")
    joints = len(labels)
    points = listed(data["waypoints"], "waypoints", MOST_SEGMENTS + 1, 2)
    q = [exactly(row, "waypoints", joints, number) for row in points]
    pairs = exactly(data["limits"], "limits", joints, lambda row: exactly(row, "limits", 3, _pair))
    sides = [[[pair[side] for pair in row] for row in pairs] for side in (0, 1)]
    limits = [[_larger(*pair) for pair in row] for row in pairs]
    both = ("position_lower", "position_upper")
    position = [exactly(data[key], key, joints, _bounds) for key in both]
    declaration = _declaration(data, joints) if polynomial else None
    n = len(q) - 1 if declaration is None else len(declaration.degrees)
    shortest = exactly(data["duration_lower"], "duration_lower", n, number)
    longest = exactly(data["duration_upper"], "duration_upper", n, optional)
    need(min(shortest) >= 0, "a lower bound of a duration is negative")
    need(all(x is None or x > 0 for x in longest), "an upper bound of a duration is not positive")
    if declaration is None:
        stated = exactly(data.get("ends", [None, None]), "ends", 2, optional)
        ends = [[speed] * joints for speed in stated]
        curve = text(data["curve"], "curve")
    else:
        need(len(q) == n + 1 - len(declaration.virtual), "malformed: waypoints: one for each break")
        ends = [list(declaration.prescribed[k].get(1, [None] * joints)) for k in (0, -1)]
        curve = None
    chord = data.get("ratios") == CHORD
    shares = _shares(data["ratios"], n) if "ratios" in data and not chord else None
    return StatedProblem(
        q, limits, sides, position, shortest, longest, declaration, curve, ends, shares, chord
    )


def in_own_units(
    problem: StatedProblem, proof: dict[str, Any]
) -> tuple[Fraction, list[list[Fraction]], list[list[Fraction | None]]]:
    """A proof's unit of time, and steps and limits in its units, which are powers of two.

    Returns
    -------
    second : Fraction
    steps : list, [step][joint]
    limits : list, [joint][order − 1]
        None if there is none; one of 0 takes no part.
    """
    joints, q = problem.joints, problem.waypoints
    units = exactly(proof["powers"], "powers", joints, _power_of_two)
    second = _power_of_two(proof["second"])
    steps = [[(b - a) / u for a, b, u in zip(*rows, units, strict=True)] for rows in pairwise(q)]
    limits = [
        [None if x is None else x * second**r / u for r, x in enumerate(map(loose, row), 1)]
        for row, u in zip(problem.limits, units, strict=True)
    ]
    return second, steps, limits


def _power_of_two(power: Any) -> Fraction:
    return Fraction(2) ** whole(power, -MOST_POWER, MOST_POWER)


def loose(limit: Bounds) -> Fraction | None:
    """An upper bound of a limit; one of 0 takes no part in a lower bound of the total."""
    return None if limit is None or limit[1] <= 0 else limit[1]


def _shares(entry: Any, segments: int) -> list[Fraction]:
    """Shares of the segments in the total, from ratios of any scale."""
    ratios = exactly(entry, "ratios", segments, number)
    need(min(ratios) > 0, "a ratio of durations is not positive")
    total = sum(ratios, Fraction(0))
    return [x / total for x in ratios]


def _pair(entry: Any) -> tuple[Bounds, Bounds]:
    """Sizes of a lower and an upper limit, from one size or from the least and largest value."""
    if type(entry) is not list:
        size = _bounds(entry)
        need(size is None or size[0] >= 0, "a limit is negative")
        return size, size
    low, high = (_bounds(x) for x in listed(entry, "limits", 2, 2))
    need(low is None or low[1] <= 0, "a lower limit is positive")
    need(high is None or high[0] >= 0, "an upper limit is negative")
    return (None if low is None else (-low[1], -low[0])), high


def _larger(one: Bounds, other: Bounds) -> Bounds:
    """Bounds of the larger of two sizes; None if one of them is no limit."""
    if one is None or other is None:
        return None
    return max(one[0], other[0]), max(one[1], other[1])


def _bounds(entry: Any) -> Bounds:
    """Rational bounds of a number, which may carry a factor π or 1/π; None if there is none."""
    if entry is None:
        return None
    if type(entry) is str:
        exact = number(entry)
        return exact, exact
    entry = fields(entry, "a limit with π", ("value", "pi"))
    value, power = number(entry["value"]), whole(entry["pi"], -1, 1)
    ends = [value * p if power > 0 else value / p if power < 0 else value for p in PI]
    return min(ends), max(ends)


def _values(stated: Any, joints: int) -> list[Fraction]:
    """A number for all joints, or a list with one for each."""
    one = type(stated) is not list
    return [number(stated)] * joints if one else exactly(stated, "prescribed", joints, number)


def _declaration(data: dict[str, Any], joints: int) -> Declaration:
    degrees = [
        whole(x, 1, MOST_DEGREE) for x in listed(data["degrees"], "degrees", MOST_SEGMENTS, 1)
    ]
    n = len(degrees)
    inner = exactly(data["continuity"], "continuity", n - 1, lambda c: whole(c, 0, MOST_DEGREE))
    prescribed: list[dict[int, list[Fraction]]] = []
    for entries in listed(data["prescribed"], "prescribed", n + 1, n + 1):
        pairs = [
            listed(pair, "prescribed", 2, 2) for pair in listed(entries, "prescribed", MOST_DEGREE)
        ]
        values = {whole(order, 1, MOST_DEGREE): _values(value, joints) for order, value in pairs}
        need(len(values) == len(pairs), "malformed: prescribed: a derivative occurs twice")
        prescribed.append(values)
    virtual = [whole(b, 1, n - 1) for b in listed(data["virtual"], "virtual", n - 1)]
    need(len(set(virtual)) == len(virtual), "malformed: virtual: a break occurs twice")
    return Declaration(degrees, inner, prescribed, virtual)
