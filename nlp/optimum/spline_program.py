"""The exact NLP of B-splines: durations and control points, where these depend on the durations.

Three kinds are no polynomials of time with breaks at the way-points. A uniform B-spline whose
segments are each stretched in time has fixed coefficients; one with a clock q(e), t(e) has fixed
control vertices and a time that is a cubic of e with coefficients linear in the durations; one with
averaged knots has knots linear in the durations, and control points that interpolation determines.
All of them are pieces with derivative r equal to N_r(e) over a power of a duration or of t′.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import perm
from typing import Any

import numpy as np

from ...problem import Array, ClampedBSpline, Problem, TrajgapError
from ...problem.curves import (
    ClockedTrajectory,
    Places,
    TimedUniformBSpline,
    Trajectory,
    average_matrix,
    clamped_control_points,
    fractions_of,
    numerators,
    shape_matrix,
)
from .limit_rows import REACH, Indices, Rows, Scaled, along
from .symbolic import ca

Polynomial = list[Any]
"""Ascending coefficients in e, 0..1."""

SLOWEST = 1e-4
"""Least dt/de of a clock at the ends of its pieces, in units of the mean duration; `check` judges
the rest."""
CLOCK = 4
"""Stands for the order of a row that keeps a clock going."""
FLAT = 1e-3
"""Slope of N_{r+1}, in shares of the limit, below which a row stays at its place."""


@dataclass(frozen=True, eq=False)
class Piece:
    """One polynomial piece of one joint.

    Attributes
    ----------
    numerators : list of polynomials
        N_r for r = 0, 1, ...; derivative r in time is N_r over ``scale(r, e)``, and turns where
        N_{r+1} vanishes.
    scale : callable
    """

    numerators: list[Polynomial]
    scale: Callable[[int, Any], Any]


class SplineProgram(Scaled):
    """The NLP of a B-spline, in units of order one, with its expressions: as `program.Program`.

    Parameters
    ----------
    problem : Problem
        With a curve that is no piecewise polynomial with breaks at the way-points.
    unit : float
        Time unit, s.
    floor : ndarray, shape (segments,)
        Least durations, s.

    Raises
    ------
    TrajgapError
        If the kind of curve is none of the three.
    """

    def __init__(self, problem: Problem, unit: float, floor: Array) -> None:
        super().__init__(problem, unit, floor)
        self.durations = ca.SX.sym("h", self.segments)
        self._control = ca.SX(0, self.joints)
        self._speeds: list[Polynomial] = []
        self._breaks: list[Array] = []
        """Breaks of each joint's own pieces, as shares of the total, where joints differ."""
        self._equalities: list[Any] = []
        q = (problem.waypoints - problem.waypoints[0]) / self.angle
        curve = problem.curve
        form = curve.shape(problem.waypoints)
        if form is not None:
            scaled = form.scaled / self.angle
            scaled[:, 0] -= problem.waypoints[0] / self.angle
            self._pieces = [self._stretched(form, scaled[:, :, j]) for j in range(self.joints)]
        elif isinstance(curve, TimedUniformBSpline):
            self._pieces = self._clocked(curve, q)
        elif isinstance(curve, ClampedBSpline):
            self._pieces = self._clamped(curve, q)
        else:
            raise TrajgapError(f"curve: no NLP is known for {curve.name}; use another curve")
        # What is divided by powers of t′ turns inside pieces whatever the degree of q.
        degree = max(len(p.numerators[0]) for own in self._pieces for p in own) - 1
        self.top = degree + 2 if self._speeds else degree
        self.variables = ca.vertcat(self.durations, ca.vec(self._control))
        self.equalities = ca.vertcat(*self._equalities) if self._equalities else ca.SX(0, 1)
        if problem.shares is not None:
            h, shares = self.durations, problem.shares
            fixed = h[1:] * shares[0] - ca.DM(shares[1:]) * h[0]
            self.equalities = ca.vertcat(self.equalities, fixed)
        self.ends = self._end_places()

    def __str__(self) -> str:
        points = self._control.numel()
        return (
            f"minimise the sum of {self.segments} segment durations\n"
            f"  curve        {self.problem.curve.name}, {self.joints} joint(s)\n"
            f"  variables    {self.variables.numel()}: {self.segments} durations, {points} "
            "coordinates of control points\n"
            f"  equalities   {self.equalities.numel()}\n"
            f"  limits       {self.ends.s.size} rows at ends of pieces, and a row at each extremum "
            "inside a piece,\n"
            "               found anew in each round"
        )

    def _stretched(self, form: Any, scaled: Array) -> list[Piece]:
        top = form.degree + 1
        return [
            _in_time([ca.SX(c) for c in scaled[p, :top]], self.durations[int(k)] * float(share))
            for p, (k, share) in enumerate(zip(form.segment, form.share, strict=True))
        ]

    def _clocked(self, curve: TimedUniformBSpline, q: Array) -> list[list[Piece]]:
        nodes = curve.clock.astype(np.float64)
        clocks = [
            [ca.dot(ca.DM(nodes[k, m]), self.durations) for m in range(4)]
            for k in range(self.segments)
        ]
        self._speeds = [_derived(t) for t in clocks]
        c = (shape_matrix(curve.waypoints).astype(np.float64) @ q).reshape(-1, 4, self.joints)
        return [
            [
                _by_clock([ca.SX(float(x)) for x in c[k, :, j]], self._speeds[k])
                for k in range(self.segments)
            ]
            for j in range(self.joints)
        ]

    def _clamped(self, curve: ClampedBSpline, q: Array) -> list[list[Piece]]:
        w, p = curve.waypoints, curve.degree
        times = [ca.SX(0), *(ca.sum1(self.durations[: k + 1]) for k in range(w - 1))]
        fractions = fractions_of(curve, self.problem.waypoints)
        groups = [None] if fractions is None else [np.asarray(row) for row in fractions]
        average = average_matrix(curve)
        self._control = ca.SX.sym("d", curve.control_points, self.joints)
        pieces: list[list[Piece]] = []
        for g, row in enumerate(groups):
            sites = times if row is None else [float(u) * times[-1] for u in row]
            inner = [sum(a * u for a, u in zip(r, sites, strict=True) if a) for r in average]
            knots = [ca.SX(0)] * (p + 1) + inner + [times[-1]] * (p + 1)
            columns = range(self.joints) if len(groups) == 1 else range(g, g + 1)
            if len(groups) > 1:
                assert row is not None
                self._breaks.append(np.concatenate([[0.0], average @ row, [1.0]]))
            rows, values = self._interpolation(curve, knots, times)
            bases = _span_bases(knots, p)
            for j in columns:
                d = self._control[:, j]
                for at, value in zip(rows, values, strict=True):
                    wanted = 0.0 if value is None else float(q[value, j])
                    self._equalities.append(ca.dot(at, d) - wanted)
                pieces.append(
                    [
                        _in_time(
                            [
                                sum(bases[k][a][m] * d[k + a] for a in range(p + 1))
                                for m in range(p + 1)
                            ],
                            knots[p + k + 1] - knots[p + k],
                        )
                        for k in range(len(bases))
                    ]
                )
        return pieces

    def _interpolation(
        self, curve: ClampedBSpline, knots: list[Any], times: list[Any]
    ) -> tuple[list[Any], list[int | None]]:
        """Rows over the control points, and the way-point that each meets; None: derivative 0."""
        p, size, last = curve.degree, curve.control_points, curve.waypoints - 1
        bases = _span_bases(knots, p)
        rows: list[Any] = []
        values: list[int | None] = []
        for r in (0, *curve.end_orders):
            at = ca.SX.zeros(size)
            at[: p + 1] = ca.vertcat(*(bases[0][a][r] for a in range(p + 1)))
            rows.append(at)
            values.append(0 if r == 0 else None)
            at = ca.SX.zeros(size)
            ends = [sum(perm(m, r) * bases[-1][a][m] for m in range(p + 1)) for a in range(p + 1)]
            at[size - p - 1 :] = ca.vertcat(*ends)
            rows.append(at)
            values.append(last if r == 0 else None)
        for k in range(1, last):
            rows.append(ca.vertcat(*_values_at(knots, p, size, times[k])))
            values.append(k)
        return rows, values

    def _end_places(self) -> Places:
        """Ends of pieces at which a derivative is neither given nor that of the piece before."""
        curve = self.problem.curve
        start, end = ({order for order, _ in side} for side in curve.ends)
        found: list[tuple[int, int, int, float]] = []
        for j, pieces in enumerate(self._pieces):
            last = len(pieces) - 1
            for r in (1, 2, 3):
                if np.isinf(self.sides.scale[j, r - 1]):
                    continue
                for k, piece in enumerate(pieces):
                    if not (k > 0 and curve.smooth_order(k) >= r) and not (k == 0 and r in start):
                        found.append((j, k, r, 0.0))
                    if len(piece.numerators[r]) > 1 and not (k == last and r in end):
                        found.append((j, k, r, 1.0))
        found += [(0, k, CLOCK, s) for k in range(len(self._speeds)) for s in (0.0, 1.0)]
        whole = np.array(found, dtype=np.float64).reshape(-1, 4)
        joint, segment, order = whole[:, :3].T.astype(np.int64)
        return Places(joint, segment, order, whole[:, 3])

    def at_places(self, places: Places, weight: Array) -> Any:
        """Derivatives at places that follow their extremum, over their limits (positions plain)."""
        found = []
        columns = (places.joint, places.segment, places.order, places.s, weight)
        for j, k, r, s, w in zip(*(c.tolist() for c in columns), strict=True):
            if r == CLOCK:
                found.append(_evaluated(self._speeds[k], s))
                continue
            piece = self._pieces[j][k]
            e: Any = s
            if w:
                e = s - REACH * ca.tanh(w * _evaluated(piece.numerators[r + 1], s) / REACH)
            value = _evaluated(piece.numerators[r], e) / piece.scale(r, e)
            found.append(value if r == 0 else value / float(self.sides.scale[j, r - 1]))
        return ca.vertcat(*found) if found else ca.SX(0, 1)

    def order_of_rows(self, places: Places) -> Indices:
        """The order in which `at_places` answers: that of the places."""
        return np.arange(places.s.size, dtype=np.int64)

    def rows_at(self, trajectory: Trajectory, places: Places, sign: Array, flat: float) -> Rows:
        """Rows at extrema of a motion; the weight is 1 over the slope of N_{r+1}, 0 where flat."""
        if isinstance(trajectory, ClockedTrajectory):
            q = (trajectory.scaled[:, :4] / self.angle).transpose(0, 2, 1)
            every = [q, *numerators(q, trajectory.clock[:, None, :] / self.unit, 4)]
            power = np.polynomial.polynomial
            columns = (places.joint, places.segment, places.order, places.s)
            slopes = [
                power.polyval(s, power.polyder(every[r + 1][k, j]))
                for j, k, r, s in zip(*columns, strict=True)
            ]
            slope = np.array(slopes, dtype=np.float64)
        else:
            slope = along(trajectory, places, 2) / self.angle[places.joint]
        if len(self._breaks) > 1:
            places, wider = self._own_pieces(trajectory, places)
            slope = slope * wider ** (places.order + 2)
        stays = np.abs(slope) < max(flat, FLAT)
        return Rows(places, sign, np.where(stays, 0.0, 1.0 / np.where(stays, 1.0, slope)))

    def _own_pieces(self, trajectory: Trajectory, places: Places) -> tuple[Places, Array]:
        """Places in pieces of all joints' knots as places in those of the joint's own.

        With them how many times as wide these are.
        """
        breaks = trajectory.breaks / trajectory.breaks[-1]
        width = np.diff(breaks)[places.segment]
        u = breaks[places.segment] + places.s * width
        own, s, wider = np.empty_like(places.segment), np.empty(u.size), np.empty(u.size)
        for i, (j, at) in enumerate(zip(places.joint.tolist(), u.tolist(), strict=True)):
            knots = self._breaks[j]
            own[i] = k = min(int(np.searchsorted(knots, at, side="right")) - 1, knots.size - 2)
            s[i] = (at - knots[k]) / (knots[k + 1] - knots[k])
            wider[i] = (knots[k + 1] - knots[k]) / width[i]
        return Places(places.joint, own, places.order, s), wider

    def bounds(self) -> tuple[Array, Array]:
        """Bounds on the variables: those of the durations."""
        low, high = self.duration_bounds()
        free = np.full(self._control.numel(), np.inf)
        return np.concatenate([low, -free]), np.concatenate([high, free])

    def rooms(self, places: Places, sign: Array) -> Array:
        """As of every NLP; a clock keeps going."""
        going = np.where(sign > 0, np.inf, SLOWEST)
        return np.asarray(np.where(places.order == CLOCK, going, super().rooms(places, sign)))

    def pack(self, trajectory: Trajectory, durations: Array) -> Array:
        """Variables at a motion with these durations."""
        points = np.empty((0, self.joints))
        if self._control.numel():
            assert isinstance(self.problem.curve, ClampedBSpline)
            points, _ = clamped_control_points(
                self.problem.curve, self.problem.waypoints, durations
            )
            points = (points - self.problem.waypoints[0]) / self.angle
        return np.concatenate([durations / self.unit, points.ravel("F")])

    def motion(self, x: Array) -> tuple[Array, None]:
        """Durations, s; the way-points and they determine the curve."""
        return x[: self.segments] * self.unit, None


def _evaluated(a: Polynomial, e: Any) -> Any:
    """Value at ``e`` by Horner's scheme."""
    value: Any = 0
    for c in reversed(a):
        value = value * e + c
    return value


def _derived(a: Polynomial) -> Polynomial:
    """Derivative of a polynomial."""
    return [m * c for m, c in enumerate(a)][1:] or [ca.SX(0)]


def _product(a: Polynomial, b: Polynomial) -> Polynomial:
    out: Polynomial = [0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for k, y in enumerate(b):
            out[i + k] = out[i + k] + x * y
    return out


def _in_time(a: Polynomial, width: Any) -> Piece:
    """Piece whose time is linear: derivative r is N_r over the r-th power of its duration."""
    found = [a]
    for _ in range(4):
        found.append(_derived(found[-1]))
    return Piece(found, lambda r, e: width**r)


def _by_clock(q: Polynomial, speed: Polynomial) -> Piece:
    """Piece with time t(e): N_1 = q′, N_{r+1} = N_r′ t′ − (2r − 1) N_r t″ over t′²ʳ⁻¹."""
    bend = _derived(speed)
    found = [q, _derived(q)]
    for r in range(1, 4):
        a = found[-1]
        first, second = _product(_derived(a), speed), _product(a, bend)
        following = [x - (2 * r - 1) * y for x, y in zip(first, second, strict=True)]
        found.append(following[:3] if r == 1 else following)
    return Piece(found, lambda r, e: _evaluated(speed, e) ** (2 * r - 1) if r else 1)


def _span_bases(knots: list[Any], p: int) -> list[list[Polynomial]]:
    """Powers of the basis functions on every span in its own 0..1, by Cox–de Boor."""
    found = []
    for at in range(p, len(knots) - p - 1):
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


def _values_at(knots: list[Any], p: int, size: int, time: Any) -> list[Any]:
    """Basis functions at a time that may lie in any span, by Cox–de Boor on values.

    A function of the durations with p − 1 continuous derivatives where the time passes a knot.
    """
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
