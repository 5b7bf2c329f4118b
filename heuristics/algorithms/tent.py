"""The tent map (23) of `z1-woa-bspline`: in doubles, exactly, and as initial population."""

from __future__ import annotations

from enum import StrEnum
from fractions import Fraction

import numpy as np

from ...problem import Array


class TentRule(StrEnum):
    """How orbits of the tent map fill a population."""

    COORDINATE = "coordinate"
    """One orbit for each coordinate, through all members, from a random start of its own."""
    MEMBER = "member"
    """One orbit for each member, through its coordinates, from a random start of its own."""
    SINGLE = "single"
    """One orbit through everything, member by member."""


def tent(x: Array, beta: float = 0.5) -> Array:
    """One step of the tent map, x/β up to β and (1 − x)/(1 − β) above it, (23)."""
    return np.where(x <= beta, x / beta, (1.0 - x) / (1.0 - beta))


def orbit(start: Array, steps: int, beta: float = 0.5) -> Array:
    """Orbits in double precision, the starts included.

    Parameters
    ----------
    start : ndarray, shape (orbits,)
        In [0, 1].
    beta : float
        Between 0 and 1.

    Returns
    -------
    ndarray, shape (steps + 1, orbits)
    """
    points = np.empty((steps + 1, np.size(start)))
    points[0] = start
    for n in range(steps):
        points[n + 1] = tent(points[n], beta)
    return points


def exact_orbit(start: Fraction, steps: int, beta: Fraction = Fraction(1, 2)) -> list[Fraction]:
    """Orbit in rational arithmetic, without rounding, the start included.

    Parameters
    ----------
    start : Fraction
        In [0, 1]; ``Fraction("0.37")`` is the decimal, ``Fraction(0.37)`` the double beside it.
    beta : Fraction
        Between 0 and 1.

    Returns
    -------
    list of Fraction, length steps + 1

    Examples
    --------
    >>> [str(x) for x in exact_orbit(Fraction("0.3"), 4)]
    ['3/10', '3/5', '4/5', '2/5', '4/5']
    """
    points = [start]
    for _ in range(steps):
        x = points[-1]
        points.append(x / beta if x <= beta else (1 - x) / (1 - beta))
    return points


def tent_population(
    rng: np.random.Generator, members: int, dimensions: int, rule: TentRule, beta: float
) -> Array:
    """Draw starts and fill a population with orbits, in [0, 1], shape (members, dimensions).

    Notes
    -----
    One random number for each orbit. With β = 0.5 an orbit of doubles ends on exactly 0 after at
    most 54 steps from a random start (`trajgap.heuristics.hazards.tent_collapse`): "single" fills
    all later members with 0.
    """
    if rule is TentRule.COORDINATE:
        return orbit(rng.random(dimensions), members - 1, beta)
    if rule is TentRule.MEMBER:
        return np.ascontiguousarray(orbit(rng.random(members), dimensions - 1, beta).T)
    whole = orbit(rng.random(1), members * dimensions - 1, beta)
    return whole.reshape(members, dimensions)
