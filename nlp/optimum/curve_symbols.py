"""Curves other than declared piecewise polynomials, as CasADi expressions in the durations.

Writing them down looks at the clock, and ends with `clock.TooLong` where the time is up.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import perm
from typing import Any

import numpy as np

from ...problem import Array, ClampedBSpline, Curve, Problem, TrajgapError
from ...problem.curves import (
    TimedUniformBSpline,
    average_matrix,
    fractions_of,
    shape_matrix,
)
from .clock import look_ahead
from .symbolic import ca

Polynomial = list[Any]


@dataclass(frozen=True, eq=False)
class SymbolicPiece:
    """One polynomial piece of one joint.

    Attributes
    ----------
    numerators : list of polynomials in e, 0..1
        N_r for r = 0, 1, ...; derivative r in time is N_r over ``scale(r, e)``, and turns where
        N_{r+1} vanishes.
    scale : callable
    """

    numerators: list[Polynomial]
    scale: Callable[[int, Any], Any]


@dataclass(frozen=True, eq=False)
class Symbols:
    """A curve as expressions in the durations and its own parameters.

    Attributes
    ----------
    durations, parameters : casadi.SX
    pieces : list, one entry per joint, of lists of SymbolicPiece
    speeds : list of polynomials
        t′ on each piece where time is not linear: must stay positive.
    """

    durations: Any
    parameters: Any
    pieces: list[list[SymbolicPiece]]
    speeds: list[Polynomial]


def evaluated(a: Polynomial, e: Any) -> Any:
    """Value at ``e`` by Horner's scheme."""
    value: Any = 0
    for c in reversed(a):
        value = value * e + c
    return value


def derived(a: Polynomial) -> Polynomial:
    """Derivative of a polynomial."""
    return [m * c for m, c in enumerate(a)][1:] or [ca.SX(0)]


def _product(a: Polynomial, b: Polynomial) -> Polynomial:
    out: Polynomial = [0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for k, y in enumerate(b):
            out[i + k] = out[i + k] + x * y
    return out


def _in_time(a: Polynomial, width: Any, highest: int) -> SymbolicPiece:
    """Piece whose time is linear: derivative r is N_r over the r-th power of its duration."""
    look_ahead()
    found = [a]
    for _ in range(highest):
        found.append(derived(found[-1]))
    return SymbolicPiece(found, lambda r, e: width**r)


def shape_key(problem: Problem) -> tuple[int, ...]:
    """Degree, then the segment of each piece of a stretched curve; empty for other kinds."""
    form = problem.curve.shape(problem.waypoints)
    return () if form is None else (form.degree, *map(int, form.segment))


def symbols(curve: Curve, joints: int, highest: int, key: tuple[int, ...]) -> Symbols:
    """Expressions of a curve for ``joints`` joints, numerators up to order ``highest``.

    Raises
    ------
    TrajgapError
        If the kind is neither stretched nor one of `EXPRESSIONS`.
    """
    if key:
        return _stretched_symbols(key[0], curve.segments, joints, highest, key[1:])
    return _expression(curve).symbols(curve, joints, highest)


def numbers(curve: Curve, waypoints: Array) -> Array:
    """Values of the parameters of `symbols` for way-points."""
    form = curve.shape(waypoints)
    if form is None:
        return _expression(curve).numbers(curve, waypoints)
    c = form.scaled[:, : form.degree + 1].reshape(-1, waypoints.shape[1])
    return np.concatenate([form.share, c.ravel("F")])


def _stretched_symbols(
    degree: int, n: int, joints: int, highest: int, key: tuple[int, ...]
) -> Symbols:
    h, count = ca.SX.sym("h", n), len(key)
    share = ca.SX.sym("share", count)
    c = ca.SX.sym("c", count * (degree + 1), joints)
    pieces = [
        [
            _in_time(
                [c[p * (degree + 1) + m, j] for m in range(degree + 1)], h[k] * share[p], highest
            )
            for p, k in enumerate(key)
        ]
        for j in range(joints)
    ]
    return Symbols(h, ca.vertcat(share, ca.vec(c)), pieces, [])


def _timed_symbols(curve: TimedUniformBSpline, joints: int, highest: int) -> Symbols:
    n = curve.segments
    h, c = ca.SX.sym("h", n), ca.SX.sym("c", 4 * n, joints)
    nodes = curve.clock.astype(np.float64)
    clocks = [[ca.dot(nodes[k, m], h) for m in range(4)] for k in range(n)]
    speeds = [derived(t) for t in clocks]
    pieces = [
        [_clocked([c[4 * k + m, j] for m in range(4)], speeds[k], highest) for k in range(n)]
        for j in range(joints)
    ]
    return Symbols(h, ca.vec(c), pieces, speeds)


def _clocked(q: Polynomial, speed: Polynomial, highest: int) -> SymbolicPiece:
    look_ahead()
    bend = derived(speed)
    found = [q, derived(q)]
    for r in range(1, highest):
        a = found[-1]
        first, second = _product(derived(a), speed), _product(a, bend)
        following = [x - (2 * r - 1) * y for x, y in zip(first, second, strict=True)]
        found.append(following[:3] if r == 1 else following)
    return SymbolicPiece(found, lambda r, e: evaluated(speed, e) ** (2 * r - 1) if r else 1)


def _timed_numbers(curve: TimedUniformBSpline, waypoints: Array) -> Array:
    c = shape_matrix(curve.waypoints).astype(np.float64) @ waypoints
    return np.asarray(c.reshape(-1, waypoints.shape[1]).ravel("F"))


def _clamped_symbols(curve: ClampedBSpline, joints: int, highest: int) -> Symbols:
    w, p = curve.waypoints, curve.degree
    h, q = ca.SX.sym("h", w - 1), ca.SX.sym("q", w, joints)
    times = [ca.SX(0), *(ca.sum1(h[: k + 1]) for k in range(w - 1))]
    average = average_matrix(curve)
    groups = _groups(curve, joints)
    fractions = ca.SX.sym("u", groups, w)
    pieces: list[list[SymbolicPiece]] = []
    for g in range(max(1, groups)):
        sites = [fractions[g, k] * times[-1] for k in range(w)] if groups else times
        inner = [sum(a * u for a, u in zip(row, sites, strict=True) if a) for row in average]
        columns = range(joints) if groups < 2 else range(g, g + 1)
        pieces += _spline_pieces(curve, times, inner, [q[:, j] for j in columns], p, highest)
    return Symbols(h, ca.vertcat(ca.vec(q), ca.vec(fractions)), pieces, [])


def _groups(curve: ClampedBSpline, joints: int) -> int:
    if curve.fractions is not None:
        return len(curve.fractions)
    return {"times": 0, "chord": 1, "joint-chord": joints}[curve.parameters]


def _clamped_numbers(curve: ClampedBSpline, waypoints: Array) -> Array:
    rows = fractions_of(curve, waypoints)
    fractions = np.empty((0, curve.waypoints)) if rows is None else np.array(rows)
    return np.concatenate([(waypoints - waypoints[0]).ravel("F"), fractions.ravel("F")])


def _span_bases(knots: list[Any], p: int) -> list[list[Polynomial]]:
    """Powers of the basis functions on every span, as `clamped_system.span_bases`."""
    found = []
    for at in range(p, len(knots) - p - 1):
        look_ahead()
        start, width = knots[at], knots[at + 1] - knots[at]
        basis: list[Polynomial] = [[ca.SX(1)]]
        for q in range(1, p + 1):
            raised: list[Polynomial] = [[ca.SX(0)] * (q + 1) for _ in range(q + 1)]
            for a in range(q):
                left, right = knots[at - q + 1 + a], knots[at + 1 + a]
                for m, value in enumerate(basis[a]):
                    c = value / (right - left)
                    raised[a + 1][m] += (start - left) * c
                    raised[a + 1][m + 1] += width * c
                    raised[a][m] += (right - start) * c
                    raised[a][m + 1] -= width * c
            basis = raised
        found.append(basis)
    return found


def _spline_pieces(
    curve: ClampedBSpline,
    times: list[Any],
    inner: list[Any],
    columns: list[Any],
    p: int,
    highest: int,
) -> list[list[SymbolicPiece]]:
    knots = [ca.SX(0)] * (p + 1) + inner + [times[-1]] * (p + 1)
    bases = _span_bases(knots, p)
    size, last = len(inner) + p + 1, len(bases) - 1
    rows: list[list[Any]] = []
    for r in (0, *curve.end_orders):
        row = [ca.SX(0)] * size
        for a in range(p + 1):
            row[a] = bases[0][a][r]
        rows.append(row)
    for time in times[1:-1]:
        rows.append(_values_at(knots, p, size, time))
    for r in (*reversed(curve.end_orders), 0):
        row = [ca.SX(0)] * size
        for a in range(p + 1):
            row[last + a] = sum(perm(m, r) * bases[last][a][m] for m in range(p + 1))
        rows.append(row)
    c = len(curve.end_orders)
    right = []
    for q in columns:
        right.append([q[0], *[ca.SX(0)] * c, *(q[k] for k in range(1, len(times) - 1))])
        right[-1] += [*[ca.SX(0)] * c, q[len(times) - 1]]
    control = _eliminated(rows, right)
    return [
        [
            _in_time(
                [sum(bases[k][a][m] * d[k + a] for a in range(p + 1)) for m in range(p + 1)],
                knots[p + k + 1] - knots[p + k],
                highest,
            )
            for k in range(len(bases))
        ]
        for d in control
    ]


def _values_at(knots: list[Any], p: int, size: int, time: Any) -> list[Any]:
    """Basis functions at a time that may lie in any span, by Cox–de Boor on values.

    A function of the durations with p − 1 continuous derivatives where the time passes a knot.
    """
    look_ahead()
    last = len(knots) - 1
    values: list[Any] = [
        ca.logic_and(knots[i] <= time, time < knots[i + 1]) if p <= i < last - p else ca.SX(0)
        for i in range(last)
    ]
    for q in range(1, p + 1):
        raised = []
        for i in range(last - q):
            value = ca.SX(0)
            if i + q > p and i < last - p:
                value += (time - knots[i]) / (knots[i + q] - knots[i]) * values[i]
            if i + q + 1 > p and i + 1 < last - p:
                gap = knots[i + q + 1] - knots[i + 1]
                value += (knots[i + q + 1] - time) / gap * values[i + 1]
            raised.append(value)
        values = raised
    return values[:size]


def _eliminated(rows: list[list[Any]], right: list[list[Any]]) -> list[list[Any]]:
    """Solve without exchanging rows, which totally positive systems allow."""
    n = len(rows)
    for c in range(n):
        look_ahead()
        for i in range(c + 1, n):
            if rows[i][c].is_zero():
                continue
            factor = rows[i][c] / rows[c][c]
            for k in range(c + 1, n):
                if not rows[c][k].is_zero():
                    rows[i][k] = rows[i][k] - factor * rows[c][k]
            for column in right:
                column[i] = column[i] - factor * column[c]
    for column in right:
        look_ahead()
        for c in range(n - 1, -1, -1):
            for k in range(c + 1, n):
                if not rows[c][k].is_zero():
                    column[c] = column[c] - rows[c][k] * column[k]
            column[c] = column[c] / rows[c][c]
    return right


@dataclass(frozen=True)
class Expression:
    """How a kind of curve enters the NLP: its symbols, and the values of their parameters."""

    symbols: Callable[[Any, int, int], Symbols]
    numbers: Callable[[Any, Array], Array]


EXPRESSIONS: dict[type[Curve], Expression] = {
    TimedUniformBSpline: Expression(_timed_symbols, _timed_numbers),
    ClampedBSpline: Expression(_clamped_symbols, _clamped_numbers),
}
"""Kinds of curve that neither are declared polynomials nor have a `Curve.shape`; the one place of
the optimum that asks for a curve's type, since CasADi must not be known to `problem`."""


def _expression(curve: Curve) -> Expression:
    if type(curve) not in EXPRESSIONS:
        raise TrajgapError(f"curve: no NLP is known for {curve.name}; use another curve")
    return EXPRESSIONS[type(curve)]
