"""Durations that no segment can do without."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

from .problem import Bounds, Declaration, StatedProblem

_DIGITS = 10**12
"""Roots are rounded down to one part in it."""


def least_durations(problem: StatedProblem, total: Fraction) -> list[Fraction]:
    """Least durations of any feasible answer of at most this total, s; 0 where none is proved.

    A segment between two way-points takes at least |Δq|/V. Where the velocity is continuous and 0
    at both ends, |a| ≤ A keeps it below A·total/2, so that V is at most that; and where the
    acceleration is so too, |j| ≤ J keeps the velocity below J·total²/8. A segment that begins or
    ends at rest, with the derivatives below order r at 0, takes at least (r!·|Δq|/limit)^(1/r).

    Parameters
    ----------
    problem : StatedProblem
        With a declaration that prescribes no derivative but 0.
    total : Fraction
        s.

    Returns
    -------
    list of Fraction
    """
    declared = problem.declaration
    assert declared is not None
    n, still = problem.segments, declared.prescribed
    virtual, rows = set(declared.virtual), iter(problem.waypoints)
    at = [None if b in virtual else next(rows) for b in range(n + 1)]
    found = list(problem.shortest)
    for j, sizes in enumerate(problem.limits):
        caps = [None if x is None or x[1] <= 0 else x[1] for x in sizes]
        speeds = _speeds(declared, caps, total)
        for k in range(n):
            start, finish = at[k], at[k + 1]
            if start is None or finish is None or start[j] == finish[j]:
                continue
            way = finish[j] - start[j]
            own = _size(problem.sides[1 if way > 0 else 0][j][0])
            found[k] = max([found[k], *(abs(way) / v for v in (*speeds, own) if v is not None)])
            for end in (still[k], still[k + 1]):
                for r in (2, 3):
                    cap = caps[r - 1]
                    if cap is not None and all(order in end for order in range(1, r)):
                        found[k] = max(found[k], _root(factorial(r) * abs(way) / cap, r))
    return found


def _size(limit: Bounds) -> Fraction | None:
    return None if limit is None or limit[1] <= 0 else limit[1]


def _speeds(
    declared: Declaration, caps: list[Fraction | None], total: Fraction
) -> list[Fraction | None]:
    """Upper bounds of the speed that follow from limits of acceleration and jerk."""
    inner, still = range(1, len(declared.degrees)), declared.prescribed
    smooth, rest = [], []
    for r in (1, 2):
        smooth.append(all(r in still[b] or declared.continuity[b - 1] >= r for b in inner))
        rest.append(r in still[0] and r in still[-1])
    _, acceleration, jerk = caps
    found: list[Fraction | None] = []
    if smooth[0] and rest[0]:
        if acceleration is not None:
            found.append(acceleration * total / 2)
        if smooth[1] and rest[1] and jerk is not None:
            found.append(jerk * total * total / 8)
    return found


def _root(value: Fraction, order: int) -> Fraction:
    """A rational that is at most the root of a positive number, and near to it."""
    near = Fraction(float(value) ** (1.0 / order)) * (1 - Fraction(1, _DIGITS))
    return near if near**order <= value else Fraction(0)
