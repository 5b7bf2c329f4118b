"""Numerical hazards of the printed equations, each shown by running it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ..problem import Array, Problem, TrajgapError, evaluate
from .algorithm import Algorithm
from .algorithms import (
    THIRD,
    concentration,
    crossover_rate,
    exact_orbit,
    inertia_weight,
    mutation_rate,
    orbit,
)
from .loop import states
from .objective import Bounds, DeathPenalty


@dataclass(frozen=True, eq=False)
class TentCollapse:
    """An orbit of the tent map in double precision and exactly.

    Attributes
    ----------
    start : Fraction
        Start as a decimal; the double orbit starts at the nearest double.
    doubles : ndarray, shape (steps + 1,)
    zero_at : int or None
        First step at which the double orbit is exactly 0, where it stays.
    exact_zero_at : int or None
        The same for the exact orbit.
    period : tuple of int or None
        (n, p) if the exact orbit repeats itself from step n on every p steps.
    """

    start: Fraction
    doubles: Array
    exact: tuple[Fraction, ...]
    zero_at: int | None
    exact_zero_at: int | None
    period: tuple[int, int] | None


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


@dataclass(frozen=True, eq=False)
class WeightFall:
    """What the inertia weight does to the best durations, move by move.

    Attributes
    ----------
    weights : ndarray, shape (iterations + 1,)
        w(I) of (22), I = 0..T.
    stretches : ndarray, shape (iterations + 1,)
        c* of the durations w(I)·X*; above 1 they break a limit, inf at 0 s.
    first_infeasible : int or None
        First I at which w(I)·X* breaks a limit.
    """

    weights: Array
    stretches: Array
    first_infeasible: int | None


def weight_fall(problem: Problem, best: Array, iterations: int = 500, s: float = 0.0) -> WeightFall:
    """Evaluate w(I)·X*, the centre that (21) moves whales around, for every I.

    Shrinking all durations by w multiplies c* by 1/w; a best that is tight leaves no room, so its
    weighted image is infeasible from the first move with w < 1 on, and tends to 0 s.

    Parameters
    ----------
    best : ndarray, shape (segments,)
        X*, s.
    iterations : int
        T.
    s : float
        Constant of (22).
    """
    weights = np.array([inertia_weight(i, iterations, s) for i in range(iterations + 1)])
    stretches = evaluate(problem, weights[:, None] * best).stretch
    broken = np.flatnonzero(stretches > 1 + 1e-9)
    return WeightFall(weights, stretches, int(broken[0]) if broken.size else None)


@dataclass(frozen=True)
class NotPositive:
    """How much of a search went to durations of 0 or less.

    Attributes
    ----------
    box_share : float
        Share of the box of positions in which some duration is negative or 0.
    judged : int
        Positions that the search had judged.
    not_positive : int
        Those with some duration of 0 or less.
    zero : int
        Those with some duration of exactly 0, the lower bound that whales are set to.
    """

    box_share: float
    judged: int
    not_positive: int
    zero: int


def not_positive_share(lower: Array, upper: Array) -> float:
    """Share of a box in which some coordinate is 0 or less.

    Examples
    --------
    >>> not_positive_share(np.full(3, -2.0), np.full(3, 2.0))
    0.875
    >>> not_positive_share(np.zeros(7), np.full(7, 5.0))
    0.0
    """
    width = upper - lower
    positive = np.clip(upper, 0.0, None) - np.clip(lower, 0.0, None)
    return float(1.0 - np.prod(positive / width))


def not_positive(
    algorithm: Algorithm[Any],
    problem: Problem,
    seed: int,
    box: tuple[float, float] | None = None,
) -> NotPositive:
    """Run an algorithm and count the durations of 0 or less that it had judged.

    Parameters
    ----------
    box : tuple of float, optional
        Range of each position, s; the problem's duration bounds by default.
    """
    judge = DeathPenalty(problem, algorithm.penalty)
    counts = {"judged": 0, "not_positive": 0, "zero": 0}

    def counting(positions: Array) -> Array:
        counts["judged"] += len(positions)
        counts["not_positive"] += int((positions <= 0).any(axis=1).sum())
        counts["zero"] += int((positions == 0).any(axis=1).sum())
        return judge(positions)

    bounds = Bounds.of(problem)
    for _ in states(algorithm, counting, bounds, np.random.Generator(np.random.PCG64(seed))):
        pass
    span = bounds if box is None else Bounds(*(np.full(problem.segments, end) for end in box))
    return NotPositive(not_positive_share(span.lower, span.upper), **counts)


@dataclass(frozen=True)
class RateBranches:
    """The adaptive rates (14)(15) where their branches meet, and at the ends.

    Attributes
    ----------
    crossover, mutation : tuple of float
        P_c and P_z at f_ave/f_max → 0, just below 1/2, at 1/2, and at 1.
    crossover_jump, mutation_jump : float
        Value at 1/2 minus the limit from below.
    negative : float
        arcsin(f_ave/f_max) for the fitness values −2 and −1, as −T would give: NaN, because their
        quotient exceeds 1.
    """

    crossover: tuple[float, float, float, float]
    mutation: tuple[float, float, float, float]
    crossover_jump: float
    mutation_jump: float
    negative: float


def rate_branches(
    k1: float = 1.0, k2: float = 0.05, k3: float = 0.02, k4: float = 2.0
) -> RateBranches:
    """Evaluate (14) and (15) at f_ave/f_max = 0, 1/2 from both sides, and 1.

    The two equations assign their formulas to the two branches the other way round.

    Examples
    --------
    >>> found = rate_branches()
    >>> [round(p, 4) for p in found.crossover], round(found.crossover_jump, 4)
    ([0.0, 0.6667, 0.6667, 0.0], 0.0)
    >>> [round(p, 4) for p in found.mutation], round(found.mutation_jump, 4)
    ([0.02, 0.0133, 0.0167, 0.05], 0.0033)
    """
    at = (0.0, float(np.nextafter(THIRD, 0.0)), THIRD, 1.0)
    crossover = tuple(crossover_rate(c, k1, k4) for c in at)
    mutation = tuple(mutation_rate(c, k2, k3) for c in at)
    return RateBranches(
        crossover=(crossover[0], crossover[1], crossover[2], crossover[3]),
        mutation=(mutation[0], mutation[1], mutation[2], mutation[3]),
        crossover_jump=crossover[2] - crossover[1],
        mutation_jump=mutation[2] - mutation[1],
        negative=concentration(-1.5, -1.0),
    )
