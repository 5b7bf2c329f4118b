"""Durations that no segment can do without."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

from .problem import Declaration, StatedProblem, loose

_DIGITS = 10**12
"""Roots are rounded down to one part in it."""


def least_durations(problem: StatedProblem, total: Fraction) -> list[Fraction]:
    """Least durations of any feasible answer of at most this total, s; 0 where none is proved.

    A segment between two way-points takes at least |Δq|/V. Where the velocity is continuous, and
    u and w at the ends, |a| ≤ A keeps it below (|u| + |w| + A·total)/2, so V is at most that.
    Where the acceleration is continuous too, v less the parabola J·t(T − t)/2 is convex for
    |j| ≤ J, and so nowhere above its chord: V is at most max(|u|, |w|) + J·total²/8. A segment that
    begins or ends at rest, with the derivatives below order r at 0, takes at least
    (r!·|Δq|/limit)^(1/r).

    Parameters
    ----------
    problem : StatedProblem
        With a declaration.
    total : Fraction
        s.
    """
    declared = problem.declaration
    assert declared is not None
    n, held = problem.segments, declared.prescribed
    virtual, rows = set(declared.virtual), iter(problem.waypoints)
    at = [None if b in virtual else next(rows) for b in range(n + 1)]
    found = list(problem.shortest)
    for j, sizes in enumerate(problem.limits):
        caps = [loose(x) for x in sizes]
        speeds = _speeds(declared, j, caps, total)
        for k in range(n):
            start, finish = at[k], at[k + 1]
            if start is None or finish is None or start[j] == finish[j]:
                continue
            way = finish[j] - start[j]
            for end in (held[k], held[k + 1]):
                for r in (2, 3):
                    cap = caps[r - 1]
                    if cap is not None and all(x in end and end[x][j] == 0 for x in range(1, r)):
                        found[k] = max(found[k], _root(factorial(r) * abs(way) / cap, r))
            own = loose(problem.sides[1 if way > 0 else 0][j][0])
            found[k] = max([found[k], *(abs(way) / v for v in (*speeds, own) if v is not None)])
    return found


def _speeds(
    declared: Declaration, joint: int, caps: list[Fraction | None], total: Fraction
) -> list[Fraction | None]:
    """Upper bounds of the speed that follow from limits of acceleration and jerk."""
    inner, held = range(1, len(declared.degrees)), declared.prescribed
    smooth = [all(r in held[b] or declared.continuity[b - 1] >= r for b in inner) for r in (1, 2)]
    _, acceleration, jerk = caps
    found: list[Fraction | None] = []
    velocities = [abs(end[1][joint]) for end in (held[0], held[-1]) if 1 in end]
    if smooth[0] and len(velocities) == 2:
        if acceleration is not None:
            found.append((sum(velocities) + acceleration * total) / 2)
        if smooth[1] and jerk is not None:
            found.append(max(velocities) + jerk * total * total / 8)
    return found


def _root(value: Fraction, order: int) -> Fraction:
    """A rational that is at most the root of a positive number, and near to it."""
    near = Fraction(float(value) ** (1.0 / order)) * (1 - Fraction(1, _DIGITS))
    return near if near**order <= value else Fraction(0)
