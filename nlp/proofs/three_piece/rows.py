"""Limits of 3-5-3 and 4-3-4 motions as polynomials on the square of directions, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from ....problem import TrajgapError
from ..exact import ExactProblem, Real
from .ratios import Ratios, ThreePieces, derivative, shape_of
from .square_polynomials import (
    MONOMIALS,
    SHARES,
    SUM,
    Poly,
    minus,
    never_negative,
    padded,
    power,
    times,
)

PLACES = 2**20
"""Places on a piece are multiples of 1/PLACES."""
STRICT = Fraction(1, 2**40)
"""Relaxation that makes a limit without the total time strict."""
TOTAL = -1
"""Cap on the durations: the total; 0, 1, 2 mean the upper bound of that segment."""


@dataclass(frozen=True)
class PieceRow:
    """One necessary condition on the durations.

    Attributes
    ----------
    kind : str
        "place", "place-first", "place-last" (a derivative of the middle, first or last piece at
        s), "first", "last" (what an end piece of its length must reach somewhere), "mean" (mean
        speed of the middle piece), "lower" (lower bound of a duration).
    joint : int
        Joint, or the segment for "lower".
    order : int
        Derivative order; 1 for "mean" and "lower".
    sign : int
        Side of the limit, ±1.
    place : int
        s·PLACES.
    cap : int
        What holds the durations down: `TOTAL`, or the segment whose upper bound does.
    """

    kind: str
    joint: int
    order: int
    sign: int = 1
    place: int = 0
    cap: int = TOTAL


def shape_for(problem: ExactProblem) -> ThreePieces:
    """Shape of the problem's curve.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    ThreePieces

    Raises
    ------
    TrajgapError
        If it has none.
    """
    shape = shape_of(problem.curve)
    if shape is None:
        raise TrajgapError(f"certify: {problem.curve.name}: neither 3-5-3 nor 4-3-4")
    return shape


def size_for(problem: ExactProblem) -> int:
    """Number of coefficients per variable that holds every row."""
    joints = range(len(problem.joints))
    limited = [r for j in joints for r in (1, 2, 3) if problem.sides(j, r) != (None, None)]
    return 3 + max(limited, default=1)


def side_of(problem: ExactProblem, row: PieceRow) -> int:
    """Side, ±1, of the limit that a row on a derivative leans on.

    The mean speed of a piece has the sign of its way. From rest a derivative of that sign is
    reached; to rest, seen backwards, every second one has the other sign.
    """
    step = {"first": 0, "mean": 1, "last": 2}.get(row.kind)
    if step is None:
        return row.sign
    forth = problem.waypoints[step + 1][row.joint] >= problem.waypoints[step][row.joint]
    return (1 if forth else -1) * (-1 if row.kind == "last" and row.order == 2 else 1)


def limit_of(problem: ExactProblem, row: PieceRow) -> Real | None:
    """Size of the limit that a row on a derivative leans on; None if there is none."""
    return problem.sides(row.joint, row.order)[(1 + side_of(problem, row)) // 2]


def on_square(ratios: dict[Ratios, Fraction]) -> Poly:
    """a²b² times a polynomial in x and y."""
    out: Poly = np.zeros((3, 3), dtype=object)
    for key, value in ratios.items():
        out = out + padded(MONOMIALS[key], 3) * value
    return out


def exact_row(problem: ExactProblem, row: PieceRow, total: Fraction) -> Poly:
    """Row as a polynomial that is negative at every feasible direction with a total < ``total``.

    A piece is N/E in the ratios, both with a²b² taken in, and h_g < cap·m_g/hold. So a feasible
    trajectory, |q⁽ʳ⁾(s)| ≤ limit·h_gʳ in the piece's own time, has

        sign·N⁽ʳ⁾(s)·holdʳ/(limit·capʳ) − E·m_gʳ < 0.
    """
    cap = total
    if row.cap != TOTAL:
        upper = problem.duration_upper[row.cap]
        assert upper is not None
        cap = upper * (1 + STRICT)
    left, right = _without_cap(problem, row)
    return minus(left * (1 / cap ** (1 if row.kind == "lower" else row.order)), right)


@lru_cache(maxsize=2_000)
def _without_cap(problem: ExactProblem, row: PieceRow) -> tuple[Poly, Poly]:
    """Both sides of a row, the left one times capʳ: the same in every stage of a search."""
    hold = SUM if row.cap == TOTAL else SHARES[row.cap]
    if row.kind == "lower":
        return hold * problem.duration_lower[row.joint], SHARES[row.joint]
    if row.order == 0:
        end = (problem.position_upper if row.sign > 0 else problem.position_lower)[row.joint]
        assert end is not None
        limit = end.high + STRICT if row.sign > 0 else STRICT - end.low
    else:
        bound = limit_of(problem, row)
        assert bound is not None
        limit = bound.high
    shape, q = shape_for(problem), [angles[row.joint] for angles in problem.waypoints]
    segment = shape.kinds[row.kind]
    piece = next((p for p in shape.pieces if p.kind == row.kind), None)
    if piece is not None:
        s = Fraction(row.place, PLACES)
        values = {key: row.sign * derivative(c, row.order, s) for key, c in piece.above(q).items()}
        left = on_square(values)
        right = on_square({key: Fraction(c) for key, c in piece.below.items()})
    else:
        way = abs(q[segment + 1] - q[segment])
        way *= 1 if row.kind == "mean" else shape.ends[row.order - 1]
        left, right = np.full((1, 1), way, dtype=object), np.ones((1, 1), dtype=object)
    if row.order == 0:
        return left, right * limit
    left = times(left, power(hold, row.order)) * (1 / limit)
    return left, times(right, power(SHARES[segment], row.order))


class Prover:
    """Exact tests of weighted rows on boxes, for one problem and one total.

    Parameters
    ----------
    problem : ExactProblem
    total : Fraction
        No feasible total below it is what a proof says, in the problem's seconds.
    """

    def __init__(self, problem: ExactProblem, total: Fraction) -> None:
        self.problem, self.total = problem, total
        self.size = size_for(problem)
        self._rows: dict[PieceRow, Poly] = {}

    def row(self, row: PieceRow) -> Poly:
        """`exact_row`, remembered."""
        if row not in self._rows:
            self._rows[row] = padded(exact_row(self.problem, row, self.total), self.size)
        return self._rows[row]

    def proves(
        self,
        rows: tuple[PieceRow, ...],
        weights: tuple[Fraction, ...],
        a: tuple[int, int],
        b: tuple[int, int],
    ) -> bool:
        """Whether Σ weight·row ≥ 0 all over a box: then nothing feasible in it is shorter."""
        if not rows or min(weights) < 0 or not any(weights):
            return False
        out = np.zeros((self.size, self.size), dtype=object)
        for row, weight in zip(rows, weights, strict=True):
            out = out + weight * self.row(row)
        return never_negative(out, a, b)


def static_rows(problem: ExactProblem) -> list[PieceRow]:
    """Rows that hold at every point alike: the heaviest joint for each kind and order."""
    caps = [TOTAL] + [g for g, u in enumerate(problem.duration_upper) if u is not None]
    rows, q = [], problem.waypoints
    for cap in caps:
        for kind, step in (("first", 0), ("last", 2), ("mean", 1)):
            for order in (1, 2, 3) if kind != "mean" else (1,):
                best: tuple[Fraction, int] | None = None
                for joint in range(len(problem.joints)):
                    limit = limit_of(problem, PieceRow(kind, joint, order))
                    if limit is None or limit.high <= 0:
                        continue
                    ratio = abs(q[step + 1][joint] - q[step][joint]) / limit.high
                    if ratio > 0 and (best is None or ratio > best[0]):
                        best = ratio, joint
                if best is not None:
                    rows.append(PieceRow(kind, best[1], order, cap=cap))
        for g, lower in enumerate(problem.duration_lower):
            if lower > 0 and g != cap:
                rows.append(PieceRow("lower", g, 1, cap=cap))
    return rows
