"""An answer whose feasibility is proved in rational numbers."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...problem import Interpolant, Limits, Problem
from ...problem.curves import StretchedUniformBSpline, layout, vertex_matrix
from .exact import ExactProblem, Real

_STRETCHES = tuple(Fraction(1, 10**k) for k in (13, 12, 11, 10, 9, 8, 7))
"""Shares by which an answer is stretched until it is feasible, tried in turn: from some roundings
of a float to a tenth of the gap that is asked for by default."""
_DEEPEST = 60
"""Halvings after which a polynomial is taken to exceed its bound: finer than any float."""


def _tight(size: Real | None) -> float:
    """The tighter end of a limit in floats; inf for none."""
    return np.inf if size is None else float(size.low)


def float_problem(exact: ExactProblem) -> Problem:
    """Nearest problem in floats, in the unit of angle of ``exact``; π on the tighter side."""
    pairs = [[exact.sides(j, r) for r in (1, 2, 3)] for j in range(len(exact.joints))]
    sides = [[[_tight(pair[side]) for pair in row] for row in pairs] for side in (0, 1)]
    low = [-np.inf if x is None else float(x.high) for x in exact.position_lower]
    high = [np.inf if x is None else float(x.low) for x in exact.position_upper]
    return Problem(
        np.array([[float(q) for q in row] for row in exact.waypoints]),
        Limits(joints=len(exact.joints)).with_sides(sides).with_positions(low, high),
        exact.curve,
        np.array([float(x) for x in exact.duration_lower]),
        np.array([np.inf if x is None else float(x) for x in exact.duration_upper]),
        joints=exact.joints,
        name=exact.name,
        ratios=None if exact.shares is None else np.array([float(x) for x in exact.shares]),
    )


def _unlimited() -> None:
    """A clock that never stops anything."""


def solve_exactly(
    matrix: list[list[Fraction]],
    right: list[list[Fraction]],
    clock: Callable[[], None] = _unlimited,
) -> list[list[Fraction]] | None:
    """Solution of a square linear system by Gauss elimination; None if it is singular.

    Of the rows with an entry in a column the shortest is its pivot: the systems of splines are
    bands, and stay so.
    """
    left = [
        ({c: x for c, x in enumerate(row) if x}, list(values))
        for row, values in zip(matrix, right, strict=True)
    ]
    done: list[tuple[dict[int, Fraction], list[Fraction]]] = []
    for column in range(len(left)):
        holding = [n for n, (row, _) in enumerate(left) if column in row]
        if not holding:
            return None
        row, values = left.pop(min(holding, key=lambda n: len(left[n][0])))
        inverse = 1 / row.pop(column)
        row = {c: x * inverse for c, x in row.items()}
        values = [x * inverse for x in values]
        for other, beside in left:
            factor = other.pop(column, None)
            if factor is None:
                continue
            clock()
            for c, x in row.items():
                rest = other.get(c, 0) - factor * x
                if rest:
                    other[c] = rest
                else:
                    del other[c]
            beside[:] = [x - factor * y if y else x for x, y in zip(beside, values, strict=True)]
        done.append((row, values))
    solved: list[list[Fraction]] = [[] for _ in done]
    for column in range(len(done) - 1, -1, -1):
        clock()
        row, values = done[column]
        for c, x in row.items():
            values = [v - x * y for v, y in zip(values, solved[c], strict=True)]
        solved[column] = values
    return solved


def exact_coefficients(
    interpolant: Interpolant,
    waypoints: Sequence[Sequence[Fraction]],
    durations: Sequence[Fraction],
    clock: Callable[[], None] = _unlimited,
) -> list[list[list[Fraction]]] | None:
    """Coefficients [joint][segment][power] in s = (t − t_k)/h_k; None if not determined."""
    if interpolant.free:
        return None
    plan, joints = layout(interpolant), len(waypoints[0])
    h = np.array(durations, dtype=object)
    rows, given = plan.dense(plan.matrix(h)).tolist(), plan.prescribed.tolist()
    matrix, right = [[Fraction(x) for x in row] for row in rows], []
    for rate, point, own in zip(plan.rates(h), plan.waypoint, given, strict=True):
        held = own * joints if len(own) == 1 else own
        right.append([rate * Fraction(x) for x in (held if point < 0 else waypoints[point])])
    solved = solve_exactly(matrix, right, clock)
    if solved is None:
        return None
    first = plan.first
    return [
        [[solved[i][j] for i in range(first[k], first[k + 1])] for k in range(interpolant.segments)]
        for j in range(joints)
    ]


def uniform_coefficients(waypoints: Sequence[Sequence[Fraction]]) -> list[list[list[Fraction]]]:
    """Coefficients [joint][segment][power] in e of the uniform cubic B-spline through way-points.

    Source: `irb1600-ga-cubic-bspline`, (1) to (3).
    """
    matrix, found = vertex_matrix(len(waypoints)), []
    for column in zip(*waypoints, strict=True):
        v = [sum((x * q for x, q in zip(row, column, strict=True)), Fraction(0)) for row in matrix]
        pieces = []
        for k in range(len(waypoints) - 1):
            a, b, c, d = v[k : k + 4]
            third = (d - 3 * c + 3 * b - a) / 6
            pieces.append([(a + 4 * b + c) / 6, (c - a) / 2, (a - 2 * b + c) / 2, third])
        found.append(pieces)
    return found


def never_above(coefficients: Sequence[Fraction], bound: Fraction) -> bool:
    """Whether a polynomial is ≤ bound on [0, 1]: Bernstein form, halved until it shows.

    Σ c_k sᵏ = Σ b_i C(n, i) sⁱ(1 − s)ⁿ⁻ⁱ with b_i = Σ_(k ≤ i) C(i, k)/C(n, k) c_k lies between the
    least and the largest b_i, and is b_0 and b_n at the ends. De Casteljau's means give the b_i of
    both halves.
    """
    n = len(coefficients) - 1
    start = [
        bound
        - sum(Fraction(math.comb(i, k), math.comb(n, k)) * coefficients[k] for k in range(i + 1))
        for i in range(n + 1)
    ]
    pieces = [(start, 0)]
    while pieces:
        control, depth = pieces.pop()
        if min(control) >= 0:
            continue
        if control[0] < 0 or control[-1] < 0 or depth == _DEEPEST:
            return False
        left, right, row = [control[0]], [control[-1]], control
        while len(row) > 1:
            row = [(x + y) / 2 for x, y in itertools.pairwise(row)]
            left.append(row[0])
            right.append(row[-1])
        pieces += [(left, depth + 1), (right[::-1], depth + 1)]
    return True


def _smooth(pieces: list[list[Fraction]], durations: Sequence[Fraction], order: int) -> bool:
    """Whether a derivative is continuous."""
    scaled = [
        ([math.perm(p, order) * c / h**order for p, c in enumerate(piece)][order:])
        for piece, h in zip(pieces, durations, strict=True)
    ]
    ends = [sum(piece, Fraction(0)) for piece in scaled]
    starts = [piece[0] if piece else Fraction(0) for piece in scaled]
    return ends[:-1] == starts[1:]


def keeps_limits(
    problem: ExactProblem,
    durations: Sequence[Fraction],
    clock: Callable[[], None] = _unlimited,
) -> bool:
    """Whether durations are within their bounds and their trajectory keeps every limit, exactly.

    ``clock`` is called between the steps, and ends it by raising.

    The velocity must not jump, nor the acceleration of a joint whose jerk is limited, as `check`
    has it; only a curve that is stretched segment by segment is judged inside its segments alone.
    """
    for h, low, high in zip(durations, problem.duration_lower, problem.duration_upper, strict=True):
        if h <= 0 or h < low or (high is not None and h > high):
            return False
    stretched = isinstance(problem.curve, StretchedUniformBSpline)
    if stretched:
        curve: list[list[list[Fraction]]] | None = uniform_coefficients(problem.waypoints)
    else:
        curve = exact_coefficients(problem.piecewise, problem.waypoints, durations, clock)
    if curve is None:
        return False
    for j, pieces in enumerate(curve):
        orders = (1,) if problem.sides(j, 3) == (None, None) else (1, 2)
        if not stretched and not all(_smooth(pieces, durations, order) for order in orders):
            return False
        floor, roof = problem.position_lower[j], problem.position_upper[j]
        for piece, h in zip(pieces, durations, strict=True):
            clock()
            if roof is not None and not never_above(piece, roof.low):
                return False
            if floor is not None and not never_above([-c for c in piece], -floor.high):
                return False
            derivative, scale = piece, Fraction(1)
            for order in (1, 2, 3):
                derivative = [p * c for p, c in enumerate(derivative)][1:]
                scale *= h
                below, above = problem.sides(j, order)
                for sign, limit in ((1, above), (-1, below)):
                    if limit is None or not derivative:
                        continue
                    if not never_above([sign * c for c in derivative], limit.low * scale):
                        return False
    return True


def prove_feasible(
    problem: ExactProblem,
    durations: NDArray[np.float64],
    clock: Callable[[], None] = _unlimited,
) -> tuple[Fraction, ...] | None:
    """Rational durations near the given ones, proved feasible; None if none was found.

    The durations are stretched uniformly by a tiny factor, rounded up to 15 digits, and never
    beyond their upper bounds; where ratios are fixed, their total is, and they have these ratios
    exactly. ``clock`` is called between the steps, and ends it by raising.
    """
    for stretch in (Fraction(0), *_STRETCHES):
        if problem.shares is not None:
            found = _at_shares(problem, problem.shares, Fraction(sum(durations)) * (1 + stretch))
            if keeps_limits(problem, found, clock):
                return tuple(found)
            continue
        found = []
        for h, low, high in zip(
            durations, problem.duration_lower, problem.duration_upper, strict=True
        ):
            value = max(_rounded_up(Fraction(float(h)) * (1 + stretch)), low)
            found.append(value if high is None else min(value, high))
        if keeps_limits(problem, found, clock):
            return tuple(found)
    return None


def _rounded_up(value: Fraction) -> Fraction:
    """The least decimal of 15 digits that is not below a positive number."""
    digits = 15 - math.ceil(math.log10(max(float(value), 1e-12)))
    return Fraction(math.ceil(value * 10**digits), 10**digits)


def _at_shares(
    problem: ExactProblem, shares: Sequence[Fraction], total: Fraction
) -> list[Fraction]:
    """Durations of exactly these shares in a total, rounded up and within the bounds on them."""
    both = list(zip(shares, problem.duration_lower, problem.duration_upper, strict=True))
    total = max(_rounded_up(total), *(low / share for share, low, _ in both))
    total = min([total, *(high / share for share, _, high in both if high is not None)])
    return [share * total for share in shares]
