"""The exact NLP in CasADi, of every curve: durations, and derivatives at left ends of pieces.

The derivatives q⁽ʳ⁾, r = 1..d, at the left end of a piece determine its polynomial; its Taylor
series gives the values at the right end. The conditions of the curve are equalities between them,
limits at left ends are bounds on variables, and limits inside pieces are rows at places that
follow the extrema. Derivatives are in time and not in the piece's parameter, so a limit is
one number whatever the duration. Of a curve with a fixed shape those derivatives are not variables
but constants over powers of a duration, and limits at left ends are rows too.

Every matrix is (pieces, joints): no expression is written once a piece, so building takes a
tenth of a second at a thousand segments.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ...problem import Array, Interpolant, Problem, as_piecewise
from ...problem.curves import ConditionKind, Conditions, Places, Trajectory, derivative_rows
from .feasibility import forbidden_jumps
from .pieces import Clock, Indices, Rows, Sides, ca, clocked_bend, left_derivatives, pieces_of

REACH = 0.5
"""Farthest that a place follows its extremum, in shares of its piece: one of a derivative that is
all but constant runs to any distance, where the polynomial means nothing. With 0.1 the
windows of a plateau over 250 segments did not join, with 0.25 one of 150 did not settle."""


class Program:
    """The NLP of a problem, in units of order one, with its expressions.

    Parameters
    ----------
    problem : Problem
    unit : float
        Time unit, s. The unit of angle is each joint's mean way between way-points.
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
        orders = range(1, 1 + self.degrees.max())
        self._held = {r: np.flatnonzero(self.degrees >= r) for r in orders}
        self._row = {r: np.cumsum(self.degrees >= r) - 1 for r in orders}  # of each piece held
        self.durations = ca.MX.sym("h", self.segments)
        self._widths = self._widths_of_pieces()
        self._clock: Clock | None = None
        if self.pieces.scaled is not None:
            self._of_shape(self.pieces.scaled)
        elif self.pieces.declared is not None:
            self._of_conditions(self.pieces.declared)
        self.ends = self._end_places()

    def _widths_of_pieces(self) -> Any:
        """Durations of the pieces, a column for each joint."""
        widths = self.pieces.widths
        if widths is None:
            return ca.repmat(self.durations, 1, self.joints)
        columns = [ca.mtimes(ca.sparsify(ca.DM(own)), self.durations) for own in widths]
        return ca.horzcat(*columns) if len(columns) > 1 else ca.repmat(columns[0], 1, self.joints)

    def _of_shape(self, scaled: Array) -> None:
        """Constants in the place of variables; a clock gives its own derivatives."""
        scaled = scaled / self.angle
        scaled[:, 0] -= self.problem.waypoints[0] / self.angle
        self._q, none = ca.DM(scaled[:, 0]), np.zeros(0, dtype=np.int64)
        self.left, self._given = Places(none, none, none, np.zeros(0)), np.zeros(0)
        if self.pieces.clock is not None:
            self._clock, self._held = Clock(self.pieces.clock, scaled, self.durations), {}
        self._d = {
            r: ca.DM(math.factorial(r) * scaled[k, r]) / self._widths[k.tolist(), :] ** r
            for r, k in self._held.items()
        }
        self.variables, self.equalities = self.durations, self._fixed_ratios()

    def _of_conditions(self, curve: Interpolant) -> None:
        """Variables at left ends, and what the curve says of right ends."""
        joints, table, values = self.joints, curve.table, _stated_values(curve, self.joints)
        q = (self.problem.waypoints - self.problem.waypoints[0]) / self.angle
        self._fixed = np.zeros((self.degrees.size + 1, joints))
        self._fixed[list(curve.waypoint_breaks)] = q[[0, -1]] if self.pieces.passed else q
        self._q = ca.MX(ca.DM(self._fixed))
        virtual = np.array(curve.virtual, dtype=np.int64)
        symbols = {r: ca.MX.sym(f"d{r}", len(k), joints) for r, k in self._held.items()}
        self._d, free = symbols, ca.MX.sym("q", virtual.size, joints)
        if virtual.size:
            self._q[virtual.tolist(), :] = free
        self.variables = ca.vertcat(self.durations, *map(ca.vec, symbols.values()), ca.vec(free))
        found = []
        for r, k in (*self._held.items(), (0, virtual)):
            given = np.full((k.size, joints), np.nan)
            i = np.flatnonzero((table.kinds == ConditionKind.RIGHT_VALUE) & (table.orders == r))
            if r:
                at = self._row[r][table.breaks[i]]
                given[at] = values[i] * self.unit**r / self.angle
            j, row = np.divmod(np.arange(given.size), max(1, k.size))
            found.append(np.array([j, k[row], np.full(j.size, r), given.ravel("F")]))
        columns = np.hstack(found)
        joint, piece, order = columns[:3].astype(np.int64)
        self.left, self._given = Places(joint, piece, order, np.zeros(joint.size)), columns[3]
        stated = [*self._conditions(table, values), *self._passed(q), self._fixed_ratios()]
        self.equalities = ca.vertcat(*stated, *self._without_jumps())

    def __str__(self) -> str:
        p, rows, states = self.problem, self.ends.s.size, int((self.left.order > 0).sum())
        scales = zip(p.limits.quantities, self.sides.scale.T, strict=True)
        limited = ["position"] if p.limits.limits_position else []
        limited += [quantity for quantity, scale in scales if scale.min() < np.inf]
        variables = f"{self.segments} durations"
        if states:
            variables += f", {states} derivatives at left ends of pieces"
        if states < self.left.s.size:
            variables += f", {self.left.s.size - states} positions"
        stated = ["the curve's conditions at right ends"] if states else []
        stated += ["way-points at their times"] if self.pieces.passed else []
        stated += ["the fixed ratios"] if p.ratios is not None else []
        stated += ["no jump that the limits forbid"] if forbidden_jumps(p) else []
        return (
            f"minimise the sum of {self.segments} segment durations\n"
            f"  curve        {p.curve.name}, {self.joints} joint(s), {self.degrees.size} pieces\n"
            f"  variables    {self.variables.numel()}: {variables}\n"
            f"  equalities   {self.equalities.numel()}: {', '.join(stated) or 'none'}\n"
            f"  limits       on {', '.join(limited) or 'nothing'}: "
            f"{'bounds at left ends, ' if states else ''}{rows} rows at ends,\n"
            "               and a row at each extremum inside a piece, found anew in each round"
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

    def _conditions(self, table: Conditions, values: Array) -> list[Any]:
        """What the curve says of right ends, joint by joint."""
        found = []
        rows = np.flatnonzero(table.kinds != ConditionKind.RIGHT_VALUE)
        degree = self.degrees[table.breaks[rows] - 1]
        keys = np.stack([table.kinds[rows], table.orders[rows], degree])
        for kind, r, d in np.unique(keys, axis=1).T.tolist():
            i = rows[(keys == np.array([[kind], [r], [d]])).all(axis=0)]
            b = table.breaks[i]
            t = self._widths if b.size == self.degrees.size else self._widths[(b - 1).tolist(), :]
            value = self._series(r, d, t, partial(self._left, k=b - 1))
            if r == 0:
                wanted = self._q[b.tolist(), :] - self._q[(b - 1).tolist(), :]
            elif kind == ConditionKind.LEFT_VALUE:
                wanted = ca.DM(values[i] * self.unit**r / self.angle)
            else:
                wanted = self._left(r, b)
            found.append(ca.vec(value - wanted))
        return found

    def _without_jumps(self) -> list[Any]:
        """Derivatives that agree at a break since a motion that passes must not jump there."""
        places, found = np.array(forbidden_jumps(self.problem), dtype=np.int64).reshape(-1, 3), []
        degrees = self.degrees[places[:, 0] - 1]
        for r, degree in sorted(set(zip(places[:, 1].tolist(), degrees.tolist(), strict=True))):
            at, _, joint = places[(places[:, 1] == r) & (degrees == degree)].T
            b = np.unique(at)
            t, left = self._widths[(b - 1).tolist(), :], partial(self._left, k=b - 1)
            step = self._series(r, degree, t, left) - self._left(r, b)
            found.append(ca.vec(step)[(np.searchsorted(b, at) + b.size * joint).tolist()])
        return found

    def _passed(self, q: Array) -> list[Any]:
        """Positions at the times of way-points that lie inside pieces.

        A time t may pass a knot. The value is that of the piece with t_k ≤ t < t_{k+1}: a function
        of the durations with p − 1 continuous derivatives, as the spline has. Beside a curve's c
        end conditions, way-point w lies in one of p + 1 pieces (Schoenberg and Whitney).
        """
        passed = self.pieces.passed
        found: list[Any] = []
        if not passed:
            return found
        p, last, c = int(self.degrees[0]), self.degrees.size - 1, len(self.problem.curve.ends[0])
        near = [(i, k) for i, w in enumerate(passed) for k in range(w + c - p, w + c + 1)]
        i, k = np.array([(i, k) for i, k in near if 0 <= k <= last], dtype=np.int64).T
        time = ca.cumsum(self.durations)[[passed[row] - 1 for row in i]]
        sums = ca.sparsify(ca.DM(np.eye(len(passed))[:, i]))
        for j in range(self.joints):
            knots = ca.vertcat(0, ca.cumsum(self._widths[:, j]))
            t = time - knots[k.tolist()]
            inside = ca.logic_and(t >= 0, time < knots[(k + 1).tolist()])
            left = {m: d[k.tolist(), j] for m, d in self._d.items()}
            value = self._q[k.tolist(), j] + self._series(0, p, t, left.__getitem__)
            found.append(ca.mtimes(sums, inside * value) - ca.DM(q[list(passed), j]))
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
        for r in self.sides.orders.tolist():
            joints = np.flatnonzero(np.isfinite(self.sides.scale[:, r - 1])).tolist()
            right = (self.degrees > r) & ~self.pieces.smooth(r)
            left = (self.degrees >= r) & (declared is None)
            for s, at in ((0.0, left), (1.0, right)):
                for k in np.flatnonzero(at).tolist():
                    if r not in orders.get(k + int(s), ()):
                        found += [(j, k, r, s) for j in joints]
        whole = np.array(found, dtype=np.float64).reshape(-1, 4)
        joint, segment, order = whole[:, :3].T.astype(np.int64)
        return Places(joint, segment, order, whole[:, 3])

    def at_places(self, places: Places, weight: Array) -> Any:
        """Derivatives at places that follow their extremum, by their limits (but not positions)."""
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
        """Derivatives in time and dt/ds of pieces and their joints, as functions of the place."""
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
        """Derivatives, with respect to the place, of f, which is a derivative in time.

        ``times`` is 1 for f′ and 2 for f″. With a clock it is 2, and f′ is 0 at the places.
        """
        unit = self.unit**places.order / self.angle[places.joint]
        if self._clock is not None:
            return clocked_bend(trajectory, places) * unit
        a = trajectory.scaled[places.segment, :, places.joint]
        found = (derivative_rows(places.s, places.order + times) * a).sum(axis=1)
        return np.asarray(found * unit / trajectory.durations[places.segment] ** places.order)

    def followed(self, trajectory: Trajectory, rows: Rows) -> Rows:
        """The rows at the places of a motion: rows that follow an extremum move with it."""
        table = rows.table.copy()
        step = rows.weight * self.slope(trajectory, rows.places, 1)
        table[:, 3] -= REACH * np.tanh(step / REACH)
        return Rows(table)

    def rooms(self, places: Places, sign: Array) -> Array:
        """Limits of rows: derivatives in shares of the larger side, positions in angles."""
        limits, first, j = self.problem.limits, self.problem.waypoints[0], places.joint
        r = self._column(places)
        at = np.where(sign > 0, limits.position_upper[j], limits.position_lower[j])
        side = np.where(sign > 0, self.sides.high[j, r], self.sides.low[j, r])
        return np.asarray(np.where(places.order == 0, (at - first[j]) / self.angle[j], side))

    def stated(self) -> tuple[Any, Array, Array]:
        """Equalities, rows at ends and conditions for a continuous clock, with their bounds."""
        ends, zero = self.ends, np.zeros(self.equalities.numel())
        low, high = (self.rooms(ends, np.full(ends.s.size, sign)) for sign in (-1.0, 1.0))
        at_ends = self.at_places(ends, np.zeros(ends.s.size))
        going = ca.MX(0, 1) if self._clock is None else self._clock.speeds()
        low = np.concatenate([zero, low, np.zeros(going.numel())])
        high = np.concatenate([zero, high, np.full(going.numel(), np.inf)])
        return ca.vertcat(self.equalities, at_ends, going), low, high

    def bounds(self) -> tuple[Array, Array]:
        """Bounds on the variables: durations, limits at left ends, given derivatives."""
        low = np.maximum(self.problem.duration_lower, self._floor) / self.unit
        found = [low, np.maximum(self.problem.duration_upper / self.unit, low)]
        for i, sign in enumerate((-1.0, 1.0)):
            rooms = self.rooms(self.left, np.full(self.left.s.size, sign)) * self._sizes(self.left)
            edge = np.where(self.left.order <= self.sides.orders[-1], rooms, sign * np.inf)
            edge = np.where(np.isnan(self._given), edge, self._given)
            found[i] = np.append(found[i], edge)
        return found[0], found[1]

    def _column(self, places: Places) -> Indices:
        """Columns of the limits of derivatives; those of orders without one are not used."""
        return np.asarray(np.clip(places.order, 1, self.sides.orders[-1]) - 1)

    def _sizes(self, places: Places) -> Array:
        """What limits are shares of: the larger side of a derivative; 1 of positions."""
        size = self.sides.scale[places.joint, self._column(places)]
        return np.where((places.order == 0) | np.isinf(size), 1.0, size)

    def pack(self, trajectory: Trajectory, durations: Array) -> Array:
        """Variables at a motion with these durations."""
        at, h = self.left, durations / self.unit
        if not at.s.size:
            return h
        left = left_derivatives(self.pieces, self.problem, trajectory, durations)
        left[:, 0] -= self.problem.waypoints[0]
        values = left[at.segment, at.order, at.joint] * self.unit**at.order / self.angle[at.joint]
        return np.append(h, values)

    def motion(self, x: Array) -> tuple[Array, Array | None]:
        """Durations, s, and free derivatives, where the declaration leaves some."""
        h, curve, at = x[: self.segments], as_piecewise(self.problem.curve), self.left
        if curve is None or not curve.free:
            return h * self.unit, None
        scaled = np.zeros((self.segments, 1 + len(self._held), self.joints))
        scaled[:, 0] = self._fixed[:-1]
        factorials = np.array([math.factorial(r) for r in range(scaled.shape[1])])
        rates = h[at.segment] ** at.order / factorials[at.order]
        scaled[at.segment, at.order, at.joint] = x[self.segments :] * rates
        scaled = scaled * self.angle
        scaled[:, 0] += self.problem.waypoints[0]
        trajectory = Trajectory(h * self.unit, scaled, tuple(self.degrees.tolist()))
        return trajectory.durations, free_values(curve, trajectory)

    def priced(
        self, bounds: Array, stated: Array, rows: Rows, duals: Array
    ) -> tuple[Places, Array, Array]:
        """Multipliers of limits at places and of bounds on durations, in seconds.

        They are computed from those of variables, of stated conditions and of rows. Returns places;
        the multipliers of the limits there, in shares of the larger side (positions in rad), signed
        by the side; and those of the bounds on durations, s per s, signed by the side.
        """
        low, high = (bound[self.segments :] for bound in self.bounds())
        # A given value is not a limit, and some variables have none.
        at = (low < high) & (np.isfinite(low) | np.isfinite(high))
        parts, first = (self.left, self.ends, rows.places), self.equalities.numel()
        keep = np.append(at, np.ones(self.ends.s.size + duals.size, dtype=bool))
        joint, segment, order, s = (
            np.concatenate([getattr(part, name) for part in parts])[keep]
            for name in ("joint", "segment", "order", "s")
        )
        # A bound on a variable is no share of its limit, as the rows are.
        left = (bounds[self.segments :] * self._sizes(self.left))[at]
        limits = np.concatenate([left, stated[first : first + self.ends.s.size], duals])
        angle = np.where(order == 0, self.angle[joint], 1.0)
        places = Places(joint, segment, order, s)
        return places, limits * self.unit / angle, bounds[: self.segments]


def free_values(curve: Interpolant, trajectory: Trajectory) -> Array:
    """Free derivatives of a trajectory, in a declaration with its breaks; shape (free, joints)."""
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
