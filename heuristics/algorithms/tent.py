"""The tent map (23) of `z1-woa-bspline`: in doubles, exactly, and as initial population."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

import numpy as np

from ...problem import Array, TrajgapError


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
    most 54 steps from a random start (`tent_collapse`): "single" fills
    all later members with 0.
    """
    if rule is TentRule.COORDINATE:
        return orbit(rng.random(dimensions), members - 1, beta)
    if rule is TentRule.MEMBER:
        return np.ascontiguousarray(orbit(rng.random(members), dimensions - 1, beta).T)
    whole = orbit(rng.random(1), members * dimensions - 1, beta)
    return whole.reshape(members, dimensions)


@dataclass(frozen=True, eq=False)
class TentCollapse:
    """An orbit of the tent map in double precision and exactly."""

    start: Fraction
    """Start as a decimal; the double orbit starts at the nearest double."""
    doubles: Array
    """Shape (steps + 1,)."""
    exact: tuple[Fraction, ...]
    zero_at: int | None
    """First step at which the double orbit is exactly 0, where it stays."""
    exact_zero_at: int | None
    """The same for the exact orbit."""
    period: tuple[int, int] | None
    """(n, p) if the exact orbit repeats itself from step n on every p steps."""


def tent_collapse(
    start: str = "0.37", steps: int = 100, beta: Fraction = Fraction(1, 2)
) -> TentCollapse:
    """Run the tent map (23) in double precision and exactly.

    With β = 1/2 no step of the double orbit rounds: x/β and 1 − x are exact there. But every
    double is a whole number over a power of two, each step takes one factor from that power, and
    after at most 54 steps (for a double in [2⁻¹, 1], or any drawn as k·2⁻⁵³) nothing is left: the
    orbit is 0 for ever. The intended decimal has other factors and never ends there; its
    orbit is periodic, hence not chaotic either.

    Parameters
    ----------
    start : str
        Decimal in [0, 1].
    beta : Fraction
        Between 0 and 1.

    Raises
    ------
    TrajgapError
        If the start or β lies outside its range.

    Examples
    --------
    >>> found = tent_collapse("0.37")
    >>> found.zero_at, found.exact_zero_at, found.period
    (54, None, (3, 10))
    """
    given = Fraction(start)
    if not 0 <= given <= 1:
        raise TrajgapError(f"start: expected a number from 0 to 1, got {start}")
    if not 0 < beta < 1:
        raise TrajgapError(f"beta: expected a number between 0 and 1, got {beta}")
    doubles = orbit(np.array([float(given)]), steps, float(beta))[:, 0]
    exact = tuple(exact_orbit(given, steps, beta))
    zeros = np.flatnonzero(doubles == 0.0)
    seen: dict[Fraction, int] = {}
    period = None
    for n, x in enumerate(exact):
        if x in seen:
            period = (seen[x], n - seen[x])
            break
        seen[x] = n
    return TentCollapse(
        start=given,
        doubles=doubles,
        exact=exact,
        zero_at=int(zeros[0]) if zeros.size else None,
        exact_zero_at=exact.index(Fraction(0)) if Fraction(0) in exact else None,
        period=period,
    )
