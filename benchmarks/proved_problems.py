"""Random problems of up to four segments by kind, each with a motion that is known to keep it.

A kind is a curve and what the problem has beside limits of v, a and j. Limits, bounds and ranges
leave the known motion some room, so every problem has an answer.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from trajgap.nlp import Solution
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    cubic_spline,
    piecewise,
    quintic_spline,
    septic_spline,
)

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))  # the searches are shared with attacks

from attacks.nasty import reached, searched, shorter

CURVES = ("3-5-3", "4-3-4", "cubic", "quintic", "septic")
TRAITS = ("limits alone", "boxes", "positions", "moving ends", "all three")
KINDS = tuple(f"{curve}, {trait}" for curve in CURVES for trait in TRAITS)
MOST_SEGMENTS, MOST_JOINTS = 4, 3


def _curve(family: str, n: int, velocity: float | tuple[float, ...]) -> Interpolant:
    """A curve that starts with a velocity, and else at rest."""
    rest = ((1, 0.0), (2, 0.0), (3, 0.0))
    start = ((1, velocity), *rest[1:])
    match family:
        case "3-5-3":
            return piecewise((3, 5, 3), 2, start[:2], finish=rest[:2])
        case "4-3-4":
            return piecewise((4, *(3,) * (n - 2), 4), 2, start[:2], finish=rest[:2])
        case "cubic":
            return cubic_spline(n, start[:1], rest[:1])
        case "quintic":
            return quintic_spline(n, start[:2], rest[:2])
    return septic_spline(n, start, rest)


def known_problem(kind: str, seed: int) -> tuple[Problem, NDArray[np.float64]]:
    """The problem of a kind and a seed, and durations that keep it."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    family, trait = kind.split(", ")
    least = {"3-5-3": 3, "4-3-4": 3}.get(family, 1)
    n = 3 if family == "3-5-3" else int(rng.integers(least, MOST_SEGMENTS + 1))
    joints = int(rng.integers(1, MOST_JOINTS + 1))
    q = np.cumsum(rng.normal(size=(n + 1, joints)), axis=0)
    h = np.exp(0.5 * rng.normal(size=n))
    moves = trait in ("moving ends", "all three")
    curve = _curve(family, n, tuple(rng.normal(size=joints).tolist()) if moves else 0.0)
    peaks, low, high = reached(Problem(q, Limits(joints=joints), curve), h)
    rates = peaks.max(axis=0) * rng.uniform(1.0, 2.0, (joints, 3))
    kept = rng.random(3) < 0.6
    kept[int(rng.integers(3))] = True
    limits = Limits(*np.where(kept, rates, np.inf).T, joints=joints)
    if trait in ("positions", "all three"):
        below, above = rng.uniform(0.0, 0.3, (2, joints)) * (high - low)
        limits = limits.with_positions(low - below, high + above)
    shortest, longest = np.zeros(n), np.full(n, np.inf)
    if trait in ("boxes", "all three"):
        shortest, longest = h * rng.uniform(0.3, 1.0, n), h * rng.uniform(1.0, 2.0, n)
    return Problem(q, limits, curve, duration_lower=shortest, duration_upper=longest), h


def attacked(
    problem: Problem, h: NDArray[np.float64], answer: Solution, seed: int
) -> NDArray[np.float64]:
    """The shortest durations of a wide search, and of random steps from its end and the answer.

    Parameters
    ----------
    problem : Problem
    h : ndarray, shape (segments,)
        Durations that keep it, s.
    answer : Solution
    seed : int

    Returns
    -------
    ndarray, shape (segments,)
        Exact totals of motions that `check` passes, within their position limits to the last digit.
    """
    rng = np.random.default_rng(seed)
    ends = [searched(rng, problem, h), *([answer.durations] if answer.found else [])]
    return min((shorter(rng, problem, end) for end in ends), key=np.sum)
