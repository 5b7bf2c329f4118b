"""The exact NLP in CasADi, of every curve: durations, and derivatives at left ends of pieces.

The derivatives q⁽ʳ⁾, r = 1..d, at the left end of a piece determine its polynomial; its Taylor
series gives the values at the right end. The conditions of the curve are equalities between them,
limits at left ends are bounds on variables, and limits inside pieces are rows at places that
follow the extrema. Derivatives are in time and not in the piece's parameter, so that a limit is
one number whatever the duration. Of a curve with a fixed shape those derivatives are no variables
but constants over powers of a duration, and limits at left ends are rows too.

Every matrix is (pieces, joints): no expression is written once a piece, so that building takes a
tenth of a second at a thousand segments.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...problem import QUANTITIES, Array, Interpolant, Problem
from ...problem.curves import PERM, ConditionKind, Places, Trajectory
from .pieces import Clock, Indices, ca, clocked_bend, left_derivatives, pieces_of

REACH = 0.5
"""Farthest that a place follows its extremum, in shares of its piece: one of a derivative that is
all but constant runs to any distance, where the polynomial means nothing. With 0.1 the
windows of a plateau over 250 segments did not join, with 0.25 one of 150 did not settle."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Limits inside pieces, a row of the table each.

    Attributes
    ----------
    table : ndarray, shape (rows, 6)
        Joint, piece, order, place in 0..1, side of the limit, and Newton weight w: the place moves
        by −w f′, f the derivative as a function of the place, up to `REACH`.
    """

    table: Array

    @property
    def places(self) -> Places:
        """Where they are."""
        joint, segment, order = self.table[:, :3].T.astype(np.int64)
        return Places(joint, segment, order, self.table[:, 3])

    @property
    def sign(self) -> Array:
        """Sides of the limits."""
        return self.table[:, 4]

    @property
    def weight(self) -> Array:
        """Newton weights; 0 of a place that stays."""
        return self.table[:, 5]


class Sides:
    """Limits of derivatives in units of order one, as shares of the larger side.

    Attributes
    ----------
    scale : ndarray, shape (joints, 3)
        The larger side; inf where nothing is limited.
    low, high : ndarray, shape (joints, 3)
        Both sides in shares of it: −1 and 1 where they are equal.
    """

    def __init__(self, problem: Problem, unit: float, angle: Array) -> None:
        below, above = problem.limits.sides * unit ** np.arange(1, 4) / angle[:, None]
        positive = [np.where(np.isfinite(side), side, 0.0) for side in (below, above)]
        scale = np.maximum(*positive)
        # A derivative that must not leave 0 to a side has no size to take; standing still keeps it.
        moves = np.ptp(problem.waypoints, axis=0)[:, None] > 0.0
        limited = (scale > 0.0) | (moves & ((below == 0.0) | (above == 0.0)))
        size = np.where(scale > 0.0, scale, 1.0)
        self.scale = np.where(limited, size, np.inf)
        self.low = np.where(limited, -below / size, -np.inf)
        self.high = np.where(limited, above / size, np.inf)


class Program:
    """The NLP of a problem, in units of order one, with its expressions.

    Parameters
    ----------
    problem : Problem
    unit : float
        Time unit, s. That of angles is each joint's mean way between way-points.
    floor : ndarray, shape (segments,)
        Least durations, s.

    Raises
    ------
    TrajgapError
        If no NLP is known for the kind of curve.
    """

    def __init__(self, problem: Problem, unit: float, floor: Array) -> None:
        self.problem, self.unit, self._floor = problem, unit, floor
        self.segments, self.joints = problem.segments, problem.waypoints.shape[1]
        steps = np.abs(np.diff(problem.waypoints, axis=0)).mean(axis=0)
        self.angle = np.where(steps > 0, steps, 1.0)
        self.sides = Sides(problem, unit, self.angle)
        self.pieces = pieces_of(problem)
        self.degrees = self.pieces.degrees
        held = {r: np.flatnonzero(self.degrees >= r) for r in range(1, 1 + self.degrees.max())}
        self._held = held
        self._row = {r: _inverted(k, self.degrees.size) for r, k in held.items()}
        self.durations = ca.MX.sym("h", self.segments)
        self._widths = self._widths_of_pieces()
        if self.pieces.declared is None:
            self._of_shape()
        else:
            self._of_conditions(self.pieces.declared)
        self.ends = self._end_places()

    def _widths_of_pieces(self) -> Any:
        """Durations of the pieces, a column for each joint."""
        widths = self.pieces.widths
        if widths is None:
            return ca.repmat(self.durations, 1, self.joints)
        columns = [ca.mtimes(ca.sparsify(ca.DM(own)), self.durations) for own in widths]
        return ca.horzcat(*columns) if len(columns) > 1 else ca.repmat(columns[0], 1, self.joints)

    def _of_shape(self) -> None:
        """Constants in the place of variables; a clock gives its own derivatives."""
        scaled = np.array(self.pieces.scaled) / self.angle
        scaled[:, 0] -= self.problem.waypoints[0] / self.angle
        self._states, self._virtual = {}, np.zeros(0, dtype=np.int64)
        self._q, self._offset = ca.DM(scaled[:, 0]), np.array([0, self.segments, self.segments])
        self._clock = None
        if self.pieces.clock is not None:
            self._clock = Clock(self.pieces.clock, scaled, self.durations)
            self._held = {}
        self._d = {
            r: ca.DM(math.factorial(r) * scaled[k, r]) / self._widths[k.tolist(), :] ** r
            for r, k in self._held.items()
        }
        self.variables, self.equalities = self.durations, self._fixed_ratios()

    def _of_conditions(self, curve: Interpolant) -> None:
        """Variables at left ends, and what the curve says of right ends."""
        joints, self._states, breaks = self.joints, self._held, list(curve.waypoint_breaks)
        self._table, self._values = curve.table, _stated_values(curve, joints)
        self._virtual = np.array(curve.virtual, dtype=np.int64)
        self._d = {r: ca.MX.sym(f"d{r}", len(k), joints) for r, k in self._held.items()}
        free = ca.MX.sym("q", self._virtual.size, joints)
        q = (self.problem.waypoints - self.problem.waypoints[0]) / self.angle
        self._fixed = np.zeros((self.degrees.size + 1, joints))
        self._fixed[breaks] = q[[0, -1]] if self.pieces.passed else q
        self._q = ca.MX(ca.DM(self._fixed))
        if self._virtual.size:
            self._q[self._virtual.tolist(), :] = free
        parts = [ca.vec(d) for d in self._d.values()]
        self.variables = ca.vertcat(self.durations, *parts, ca.vec(free))
        sizes = [self.segments, *(part.numel() for part in parts), free.numel()]
        self._offset = np.concatenate([[0], np.cumsum(sizes)])
        stated = [*self._conditions(), *self._passed(q), self._fixed_ratios()]
        self._clock, self.equalities = None, ca.vertcat(*stated)

    def __str__(self) -> str:
        p, rows = self.problem, self.ends.s.size
        limited = [
            q for q, s in zip(QUANTITIES, self.sides.scale.T, strict=True) if s.min() < np.inf
        ]
        if p.limits.limits_position:
            limited.insert(0, "position")
        pieces = "pieces" if self.pieces.widths is not None else "segments"
        states, free = (int(n) for n in np.diff(self._offset[[1, -2, -1]]))
        variables = f"{self.segments} durations"
        if self._states:
            variables += f", {states} derivatives at left ends of {pieces}"
        if free:
            variables += f", {free} positions"
        stated = ["the curve's conditions at right ends"] if self._states else []
        stated += ["way-points at their times"] if self.pieces.passed else []
        stated += ["the fixed ratios"] if p.ratios is not None else []
        return (
            f"minimise the sum of {self.segments} segment durations\n"
            f"  curve        {p.curve.name}, {self.joints} joint(s)\n"
            f"  variables    {self.variables.numel()}: {variables}\n"
            f"  equalities   {self.equalities.numel()}: {', '.join(stated) or 'none'}\n"
            f"  limits       on {', '.join(limited) or 'nothing'}: "
            f"{'bounds at left ends,' if self._states else ''}\n"
            f"               {rows} rows at {'right ends' if self._states else 'ends'}, and a row "
            "at each extremum inside a piece,\n"
            "               found anew in each round"
        )

    def _series(self, order: int, degree: int, t: Any, left: Callable[[int], Any]) -> Any:
        """Derivative at time ``t`` of a piece, from those at its left end; of order 0 its way."""
        value: Any = ca.MX.zeros(*t.shape)
        for m in range(degree, max(order, 1) - 1, -1):
            value = value * t + left(m) / math.factorial(m - order)
        return value * t if order == 0 else value

    def _left(self, r: int, k: Indices) -> Any:
        """Derivative of pieces at their left ends, (pieces, joints); 0 above their degree."""
        if k.size == self._held[r].size == self.degrees.size:
            return self._d[r]
        there = self.degrees[k] >= r
        rows = self._d[r][self._row[r][k[there]].tolist(), :]
        if there.all():
            return rows
        out = ca.MX.zeros(k.size, self.joints)
        if there.any():
            out[np.flatnonzero(there).tolist(), :] = rows
        return out

    def _conditions(self) -> list[Any]:
        """What the curve says of right ends, joint by joint."""
        table, found = self._table, []
        rows = np.flatnonzero(table.kinds != ConditionKind.RIGHT_VALUE)
        keys = np.stack(
            [table.kinds[rows], table.orders[rows], self.degrees[table.breaks[rows] - 1]]
        )
        for kind, r, degree in np.unique(keys, axis=1).T.tolist():
            i = rows[(keys == np.array([[kind], [r], [degree]])).all(axis=0)]
            b = table.breaks[i]
            before = b - 1
            t = self._widths[before.tolist(), :] if b.size < self.degrees.size else self._widths
            value = self._series(r, degree, t, lambda m, k=before: self._left(m, k))
            if r == 0:
                wanted = self._q[b.tolist(), :] - self._q[before.tolist(), :]
            elif kind == ConditionKind.LEFT_VALUE:
                wanted = ca.DM(self._values[i] * self.unit**r / self.angle)
            else:
                wanted = self._left(r, b)
            found.append(ca.vec(value - wanted))
        return found

    def _passed(self, q: Array) -> list[Any]:
        """Positions at the times of way-points that lie inside pieces.

        A time t may pass a knot. The value is that of the piece with t_k ≤ t < t_{k+1}: a function
        of the durations with p − 1 continuous derivatives, as the spline has. Beside a curve's c
        end conditions, way-point w lies in one of p + 1 pieces (Schoenberg and Whitney).
        """
        passed, found = self.pieces.passed, []
        if not passed:
            return found
        p, last, c = int(self.degrees[0]), self.degrees.size - 1, len(self.problem.curve.ends[0])
        near = [(i, k) for i, w in enumerate(passed) for k in range(w + c - p, w + c + 1)]
        i, k = np.array([(i, k) for i, k in near if 0 <= k <= last], dtype=np.int64).T
        time = ca.cumsum(self.durations)[[passed[row] - 1 for row in i]]
        sums = ca.DM.zeros(len(passed), i.size)
        for column, row in enumerate(i.tolist()):
            sums[row, column] = 1.0
        for j in range(self.joints):
            knots = ca.vertcat(0, ca.cumsum(self._widths[:, j]))
            t = time - knots[k.tolist()]
            inside = ca.logic_and(t >= 0, time < knots[(k + 1).tolist()])
            way = self._series(0, p, t, lambda m, j=j: self._d[m][k.tolist(), j])
            value = ca.mtimes(ca.sparsify(sums), inside * (self._q[k.tolist(), j] + way))
            found.append(value - ca.DM(q[list(passed), j]))
        return found

    def _fixed_ratios(self) -> Any:
        h, shares = self.durations, self.problem.shares
        return ca.MX(0, 1) if shares is None else h[1:] * shares[0] - ca.DM(shares[1:]) * h[0]

    def _end_places(self) -> Places:
        """Ends of pieces at which a limited derivative is neither given nor bounded otherwise."""
        declared, last = self.pieces.declared, self.degrees.size
        given = {0: self.problem.curve.ends[0], last: self.problem.curve.ends[1]}
        if declared is not None:
            given = dict(enumerate(map(declared.prescribed_at, range(last + 1))))
        orders = {b: {order for order, _ in at} for b, at in given.items() if at}
        found: list[tuple[int, int, int, float]] = []
        for r in (1, 2, 3):
            joints = np.flatnonzero(np.isfinite(self.sides.scale[:, r - 1])).tolist()
            right = (self.degrees > r) & ~self.pieces.smooth(r)
            left = np.zeros(last, dtype=bool) if self._states else self.degrees >= r
            for s, at in ((0.0, left), (1.0, right)):
                for k in np.flatnonzero(at).tolist():
                    if r not in orders.get(k + int(s), ()):
                        found += [(j, k, r, s) for j in joints]
        whole = np.array(found, dtype=np.float64).reshape(-1, 4)
        joint, segment, order = whole[:, :3].T.astype(np.int64)
        return Places(joint, segment, order, whole[:, 3])

    def at_places(self, places: Places, weight: Array) -> Any:
        """Derivatives at places that follow their extremum, over their limits (positions plain)."""
        found, numbers = [], []
        degree = self.degrees[places.segment]
        for r, d in sorted(set(zip(places.order.tolist(), degree.tolist(), strict=True))):
            i = np.flatnonzero((places.order == r) & (degree == d))
            k, j = places.segment[i], places.joint[i]
            value, speed = self._motion(k, j, r, d)
            s = ca.DM(places.s[i])
            if weight[i].any():
                # f′ is dt/ds times the next derivative in time.
                step = ca.DM(weight[i]) * speed(s) * value(r + 1, s)
                s = s - REACH * ca.tanh(step / REACH)
            size = 1.0 if r == 0 else ca.DM(self.sides.scale[j, r - 1])
            found.append(value(r, s) / size)
            numbers.append(i)
        if not found:
            return ca.MX(0, 1)
        back = np.argsort(np.concatenate(numbers))
        together = ca.vertcat(*found)
        return together if (np.diff(back) == 1).all() else together[back.tolist()]

    def _motion(self, k: Indices, j: Indices, lowest: int, degree: int) -> tuple[Any, Any]:
        """Derivatives in time and dt/ds, functions of the place, of pieces with their joints."""
        if self._clock is not None:
            return self._clock.motion(k, j)
        # One number, taken several times, is a row.
        h = ca.vec(ca.vec(self._widths)[(k + self.degrees.size * j).tolist()])
        left = {
            m: ca.vec(ca.vec(self._d[m])[(self._row[m][k] + self._held[m].size * j).tolist()])
            for m in range(max(lowest, 1), degree + 1)
        }
        first = ca.vec(ca.vec(self._q)[(k + self._q.shape[0] * j).tolist()]) if lowest == 0 else 0

        def value(order: int, s: Any) -> Any:
            found = self._series(order, degree, s * h, left.__getitem__)
            return found + first if order == 0 else found

        return value, lambda s: h

    def slope(self, trajectory: Trajectory, places: Places, times: int) -> Array:
        """Derivatives by the place of f, a derivative in time as a function of the place.

        Parameters
        ----------
        trajectory : Trajectory
        places : Places
            With a clock, those where f turns.
        times : int
            1 for f′, 2 for f″; with a clock 2.
        """
        unit = self.unit**places.order / self.angle[places.joint]
        if self._clock is not None:
            return clocked_bend(trajectory, places) * unit
        a = trajectory.scaled[places.segment, :, places.joint]
        r, out = places.order + times, np.zeros(places.s.size)
        for p in range(min(a.shape[1], len(PERM)) - 1, 0, -1):
            factor = PERM[p, np.minimum(r, PERM.shape[1] - 1)]
            out = np.where(p >= r, out * places.s + factor * a[:, p], out)
        return out * unit / trajectory.durations[places.segment] ** places.order

    def followed(self, trajectory: Trajectory, rows: Rows) -> Rows:
        """Rows where a motion has them: those that follow an extremum at its side."""
        table = rows.table.copy()
        step = rows.weight * self.slope(trajectory, rows.places, 1)
        table[:, 3] -= REACH * np.tanh(step / REACH)
        return Rows(table)

    def own_places(self, trajectory: Trajectory, places: Places) -> tuple[Places, Array]:
        """Places of a motion in each joint's own pieces, and how many times as wide these are."""
        widths = self.pieces.widths
        if widths is None or len(widths) == 1:
            return places, np.ones(places.s.size)
        breaks, total = trajectory.breaks, float(trajectory.breaks[-1])
        width = np.diff(breaks)[places.segment]
        time = breaks[places.segment] + places.s * width
        own, s, wider = np.empty_like(places.segment), np.empty(time.size), np.empty(time.size)
        for j, of_joint in enumerate(widths):
            # Where joints have knots of their own these are shares of the total.
            knots = total * np.append(0.0, np.cumsum(of_joint[:, 0]))
            i = np.flatnonzero(places.joint == j)
            own[i] = k = np.clip(np.searchsorted(knots, time[i], "right") - 1, 0, knots.size - 2)
            each = np.diff(knots)[k]
            s[i], wider[i] = (time[i] - knots[k]) / each, each / width[i]
        return Places(places.joint, own, places.order, s), wider

    def duration_bounds(self) -> tuple[Array, Array]:
        """Bounds on the durations, in units."""
        low = np.maximum(self.problem.duration_lower, self._floor) / self.unit
        return low, np.maximum(self.problem.duration_upper / self.unit, low)

    def rooms(self, places: Places, sign: Array) -> Array:
        """Limits of rows: derivatives in shares of the larger side, positions in angles."""
        limits, first, j = self.problem.limits, self.problem.waypoints[0], places.joint
        r = np.clip(places.order, 1, 3) - 1
        at = np.where(sign > 0, limits.position_upper[j], limits.position_lower[j])
        side = np.where(sign > 0, self.sides.high[j, r], self.sides.low[j, r])
        return np.asarray(np.where(places.order == 0, (at - first[j]) / self.angle[j], side))

    def stated(self) -> tuple[Any, Array, Array]:
        """Equalities, rows at ends, and that a clock goes on, with what they lie between."""
        ends, zero = self.ends, np.zeros(self.equalities.numel())
        low, high = (self.rooms(ends, np.full(ends.s.size, sign)) for sign in (-1.0, 1.0))
        at_ends = self.at_places(ends, np.zeros(ends.s.size))
        going = ca.MX(0, 1) if self._clock is None else self._clock.speeds()
        low = np.concatenate([zero, low, np.zeros(going.numel())])
        high = np.concatenate([zero, high, np.full(going.numel(), np.inf)])
        return ca.vertcat(self.equalities, at_ends, going), low, high

    def bounds(self) -> tuple[Array, Array]:
        """Bounds on the variables: durations, limits at left ends, given derivatives."""
        low, high = ([bound] for bound in self.duration_bounds())
        for r, held in self._states.items():
            edges = (np.full(self.joints, -np.inf), np.full(self.joints, np.inf))
            if r <= 3:
                size = self.sides.scale[:, r - 1]
                edges = size * self.sides.low[:, r - 1], size * self.sides.high[:, r - 1]
            lower, upper = (np.tile(edge, (held.size, 1)) for edge in edges)
            right = self._table.kinds == ConditionKind.RIGHT_VALUE
            i = np.flatnonzero(right & (self._table.orders == r))
            at = self._row[r][self._table.breaks[i]]
            lower[at] = upper[at] = self._values[i] * self.unit**r / self.angle
            low.append(lower.ravel("F"))
            high.append(upper.ravel("F"))
        limits, first = self.problem.limits, self.problem.waypoints[0]
        for bound, out in ((limits.position_lower, low), (limits.position_upper, high)):
            out.append(np.tile((bound - first) / self.angle, (self._virtual.size, 1)).ravel("F"))
        return np.concatenate(low), np.concatenate(high)

    def pack(self, trajectory: Trajectory, durations: Array) -> Array:
        """Variables at a motion with these durations."""
        if not self._states:
            return durations / self.unit
        left = left_derivatives(self.pieces, self.problem, trajectory, durations)
        rates = self.unit ** np.arange(left.shape[1])[:, None]
        left[:, 0] -= self.problem.waypoints[0]
        left = left * rates / self.angle
        parts = [left[held, r].ravel("F") for r, held in self._states.items()]
        return np.concatenate([durations / self.unit, *parts, left[self._virtual, 0].ravel("F")])

    def motion(self, x: Array) -> tuple[Array, Array | None]:
        """Durations, s, and free derivatives, where the declaration leaves some."""
        h, curve = x[: self.segments], self.problem.curve.piecewise
        if curve is None or not curve.free:
            return h * self.unit, None
        scaled = np.zeros((self.segments, 1 + len(self._states), self.joints))
        scaled[:, 0] = self._fixed[:-1]
        scaled[self._virtual, 0] = x[self._offset[-2] :].reshape(self.joints, -1).T
        for r, held in self._states.items():
            own = x[self._offset[r] : self._offset[r + 1]].reshape(self.joints, -1).T
            scaled[held, r] = own * (h[held] ** r / math.factorial(r))[:, None]
        scaled *= self.angle
        scaled[:, 0] += self.problem.waypoints[0]
        trajectory = Trajectory(h * self.unit, scaled, tuple(self.degrees.tolist()))
        return trajectory.durations, free_values(curve, trajectory)

    def priced(
        self, bounds: Array, stated: Array, rows: Rows, duals: Array
    ) -> tuple[Places, Array, Array]:
        """What multipliers say of limits at places, and of bounds on durations, in seconds.

        Parameters
        ----------
        bounds, stated : ndarray
            Multipliers of the bounds on variables, and of what the program states.
        rows : Rows
        duals : ndarray
            Their multipliers.

        Returns
        -------
        places : Places
        limits : ndarray
            Of the limits there, in shares of the larger side (positions in rad), signed by the
            side.
        walls : ndarray, shape (segments,)
            Of the bounds on durations, s per s, signed by the side.
        """
        at_left, number = self.left_places()
        parts, first = (at_left, self.ends, rows.places), self.equalities.numel()
        joint, segment, order, s = (
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("joint", "segment", "order", "s")
        )
        # A bound on a variable is no share of its limit, as the rows are.
        shares = self.sides.scale[at_left.joint, np.maximum(at_left.order, 1) - 1]
        left = bounds[number] * np.where(at_left.order == 0, 1.0, shares)
        limits = np.concatenate([left, stated[first : first + self.ends.s.size], duals])
        angle = np.where(order == 0, self.angle[joint], 1.0)
        places = Places(joint, segment, order, s)
        return places, limits * self.unit / angle, bounds[: self.segments]

    def left_places(self) -> tuple[Places, Indices]:
        """Limits that are bounds on variables, as places, and the variables' numbers."""
        found: list[tuple[Indices, Indices, Indices, Indices]] = []
        limited = [(r, k, self._offset[r]) for r, k in self._states.items() if r <= 3]
        for r, k, first in (*limited, (0, self._virtual, self._offset[-2])):
            joint, row = np.divmod(np.arange(self.joints * k.size), max(1, k.size))
            found.append((joint, k[row], np.full(joint.size, r), first + np.arange(joint.size)))
        joint, segment, order, number = (np.concatenate([f[i] for f in found]) for i in range(4))
        low, high = self.bounds()
        # What is given is no limit, nor is what has none.
        at = np.flatnonzero((low < high)[number] & (np.isfinite(low) | np.isfinite(high))[number])
        places = Places(joint[at], segment[at], order[at], np.zeros(at.size))
        return places, np.asarray(number[at])


def free_values(curve: Interpolant, trajectory: Trajectory) -> Array:
    """What a trajectory gives the free derivatives of a declaration with the same breaks.

    Parameters
    ----------
    curve : Interpolant
    trajectory : Trajectory

    Returns
    -------
    ndarray, shape (free, joints)
    """
    n, joints = curve.segments, trajectory.scaled.shape[2]
    nodal = np.empty((curve.free, joints))
    for i, (b, order) in enumerate(curve.free_derivatives):
        for j in range(joints):
            side = trajectory.derivative(min(b, n - 1), j, order)
            nodal[i, j] = side[0] if b < n else side.sum()
    return nodal


def _stated_values(curve: Interpolant, joints: int) -> Array:
    """Derivatives that conditions give, rad/sᵒʳᵈᵉʳ, (conditions, joints); 0 for the others."""
    table = curve.table
    values = np.zeros((table.kinds.size, joints))
    given = [dict(curve.prescribed_at(b)) for b in range(curve.segments + 1)]
    told = (table.kinds != ConditionKind.MATCH) & (table.orders > 0)
    for i in np.flatnonzero(told).tolist():
        values[i] = given[table.breaks[i]][int(table.orders[i])]
    return values


def _inverted(held: Indices, size: int) -> Indices:
    """Row of each piece among those held; −1 elsewhere."""
    out = np.full(size, -1, dtype=np.int64)
    out[held] = np.arange(held.size)
    return out
