"""The exact NLP in CasADi: durations, and derivatives at the left ends of segments.

The derivatives q⁽ʳ⁾, r = 1..d, at the left end of a segment determine its polynomial; its Taylor
series gives the values at the right end. The declaration's conditions are equalities between them,
limits at left ends are bounds on variables, and limits inside segments are rows at places that
follow the extrema. Derivatives are in time and not in the segment's parameter, so that a limit is
one number whatever the duration.

Every matrix is (segments, joints): no expression is written once a segment, so that building takes
a tenth of a second at a thousand segments.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...problem import QUANTITIES, Array, Interpolant, Problem
from ...problem.curves import ConditionKind, Places, Trajectory
from .limit_rows import REACH, Indices, Rows, Scaled, along
from .symbolic import ca


@dataclass(frozen=True, eq=False)
class StatedConditions:
    """What the declaration states at its breaks, shape (conditions,).

    Attributes
    ----------
    kinds, breaks, orders : ndarray of int
    values : ndarray, shape (conditions, joints)
        Given derivatives, rad/sᵒʳᵈᵉʳ; 0 for matches and positions.
    """

    kinds: Indices
    breaks: Indices
    orders: Indices
    values: Array

    @classmethod
    def of(cls, curve: Interpolant, joints: int) -> StatedConditions:
        """The conditions of a declaration; derivatives that it leaves free have none."""
        table = curve.table
        values = np.zeros((table.kinds.size, joints))
        given = [dict(curve.prescribed_at(b)) for b in range(curve.segments + 1)]
        told = (table.kinds != ConditionKind.MATCH) & (table.orders > 0)
        for i in np.flatnonzero(told).tolist():
            values[i] = given[table.breaks[i]][int(table.orders[i])]
        return cls(table.kinds, table.breaks, table.orders, values)


class Program(Scaled):
    """The NLP of a declared curve, in units of order one, with its expressions.

    Parameters
    ----------
    problem : Problem
        With a piecewise polynomial.
    unit : float
        Time unit, s.
    floor : ndarray, shape (segments,)
        Least durations, s.
    """

    def __init__(self, problem: Problem, unit: float, floor: Array) -> None:
        super().__init__(problem, unit, floor)
        curve = problem.piecewise
        self.degrees = np.array(curve.degrees, dtype=np.int64)
        self.top = int(self.degrees.max())
        self._plan = StatedConditions.of(curve, self.joints)
        self._held = {r: np.flatnonzero(self.degrees >= r) for r in range(1, self.top + 1)}
        self._row = {r: _inverted(k, self.segments) for r, k in self._held.items()}
        self._virtual = np.array(curve.virtual, dtype=np.int64)
        self._declare()
        self.equalities = self._equalities()
        self.ends = self._end_places()

    def _declare(self) -> None:
        n, joints = self.segments, self.joints
        self.durations = ca.MX.sym("h", n)
        self._d = {r: ca.MX.sym(f"d{r}", len(k), joints) for r, k in self._held.items()}
        free = ca.MX.sym("q", self._virtual.size, joints)
        breaks = list(self.problem.curve.waypoint_breaks)
        shifted = (self.problem.waypoints - self.problem.waypoints[0]) / self.angle
        self._fixed = np.zeros((n + 1, joints))
        self._fixed[breaks] = shifted
        self._q = ca.MX(ca.DM(self._fixed))
        if self._virtual.size:
            self._q[self._virtual.tolist(), :] = free
        parts = [ca.vec(self._d[r]) for r in range(1, self.top + 1)]
        self.variables = ca.vertcat(self.durations, *parts, ca.vec(free))
        sizes = [n, *(len(k) * joints for k in self._held.values()), self._virtual.size * joints]
        self._offset = np.concatenate([[0], np.cumsum(sizes)])

    def __str__(self) -> str:
        p, rows = self.problem, self.ends.s.size
        limited = [
            q for q, s in zip(QUANTITIES, self.sides.scale.T, strict=True) if s.min() < np.inf
        ]
        if p.limits.limits_position:
            limited.insert(0, "position")
        free = f", {self._virtual.size * self.joints} positions" if self._virtual.size else ""
        states = int(self._offset[-2]) - self.segments
        return (
            f"minimise the sum of {self.segments} segment durations\n"
            f"  curve        {p.curve.name}, {self.joints} joint(s)\n"
            f"  variables    {self.variables.numel()}: {self.segments} durations, "
            f"{states} derivatives at left ends of segments{free}\n"
            f"  equalities   {self.equalities.numel()}: the declaration's conditions at right ends"
            f"{' and the fixed ratios' if p.ratios is not None else ''}\n"
            f"  limits       on {', '.join(limited) or 'nothing'}: bounds at left ends,\n"
            f"               {rows} rows at right ends, and a row at each extremum inside a\n"
            "               segment, found anew in each round"
        )

    def _taylor(self, order: int, k: Indices) -> Any:
        """Derivative of some segments of one degree at their ends; of order 0 their way."""
        h = self.durations if k.size == self.segments else self.durations[k.tolist()]
        t = ca.repmat(h, 1, self.joints)
        return self._series(order, int(self.degrees[k[0]]), t, lambda r: self._left(r, k))

    def _series(self, order: int, degree: int, t: Any, left: Any) -> Any:
        value: Any = ca.MX.zeros(*t.shape)
        for m in range(degree, max(order, 1) - 1, -1):
            value = value * t + left(m) / math.factorial(m - order)
        return value * t if order == 0 else value

    def _left(self, r: int, k: Indices) -> Any:
        if k.size == self._held[r].size:
            return self._d[r]
        return self._d[r][self._row[r][k].tolist(), :]

    def _equalities(self) -> Any:
        """What the declaration says of right ends, and the fixed ratios of durations."""
        plan, unit = self._plan, self.unit
        rows = np.flatnonzero(plan.kinds != ConditionKind.RIGHT_VALUE)
        keys = np.stack([plan.kinds[rows], plan.orders[rows], self.degrees[plan.breaks[rows] - 1]])
        found = []
        for kind, r, degree in np.unique(keys, axis=1).T.tolist():
            i = rows[(keys == np.array([[kind], [r], [degree]])).all(axis=0)]
            b = plan.breaks[i]
            value = self._taylor(r, b - 1)
            if r == 0:
                wanted = self._q[b.tolist(), :] - self._q[(b - 1).tolist(), :]
            elif kind == ConditionKind.LEFT_VALUE:
                wanted = ca.DM(plan.values[i] * unit**r / self.angle)
            else:
                there = self.degrees[b] >= r
                if there.all():
                    wanted = self._left(r, b)
                else:
                    wanted = ca.MX.zeros(b.size, self.joints)
                    if there.any():
                        wanted[np.flatnonzero(there).tolist(), :] = self._left(r, b[there])
            found.append(ca.vec(value - wanted))
        shares = self.problem.shares
        if shares is not None:
            h = self.durations
            found.append(h[1:] * shares[0] - ca.DM(shares[1:]) * h[0])
        return ca.vertcat(*found)

    def _end_places(self) -> Places:
        """Right ends at which a limited derivative is neither given nor bounded on the left."""
        curve = self.problem.piecewise
        found: list[tuple[int, int, int]] = []
        for r in (1, 2, 3):
            joints = np.flatnonzero(np.isfinite(self.sides.scale[:, r - 1]))
            smooth = np.array([*curve.continuity, -1])  # nothing bounds the last right end but rows
            open_ = (self.degrees > r) & (smooth < r)
            for k in np.flatnonzero(open_).tolist():
                given = any(order == r for order, _ in curve.prescribed_at(k + 1))
                found += [] if given else [(int(j), k, r) for j in joints]
        whole = np.array(found, dtype=np.int64).reshape(-1, 3)
        places = Places(whole[:, 0], whole[:, 1], whole[:, 2], np.ones(len(whole)))
        at = self.order_of_rows(places)
        return replace(places, joint=whole[at, 0], segment=whole[at, 1], order=whole[at, 2])

    def at_places(self, places: Places, weight: Array) -> Any:
        """Derivatives at places that follow their extremum, over their limits (positions plain)."""
        found = []
        for r, degree in sorted(set(zip(places.order, self.degrees[places.segment], strict=True))):
            i = (places.order == r) & (self.degrees[places.segment] == degree)
            found.append(self._some(places, weight, np.flatnonzero(i), int(r), int(degree)))
        return ca.vertcat(*found) if found else ca.MX(0, 1)

    def order_of_rows(self, places: Places) -> Indices:
        """The order in which `at_places` answers."""
        return np.lexsort(
            (np.arange(places.s.size), self.degrees[places.segment], places.order)
        ).astype(np.int64)

    def _some(self, places: Places, weight: Array, i: Indices, r: int, degree: int) -> Any:
        k, j = places.segment[i], places.joint[i]
        # One number, taken several times, is a row.
        h = ca.vec(self.durations[k.tolist()])
        flat = {
            m: ca.vec(ca.vec(self._d[m])[(self._row[m][k] + self._held[m].size * j).tolist()])
            for m in range(max(r, 1), degree + 1)
        }
        s, w = ca.DM(places.s[i]), weight[i]
        if w.any():
            # f′(s) is h times the next derivative in time.
            step = ca.DM(w) * h * self._series(r + 1, degree, s * h, flat.__getitem__)
            s = s - REACH * ca.tanh(step / REACH)
        value = self._series(r, degree, s * h, flat.__getitem__)
        if r == 0:
            return value + ca.vec(ca.vec(self._q)[(k + (self.segments + 1) * j).tolist()])
        return value / ca.DM(self.sides.scale[j, r - 1])

    def rows_at(self, trajectory: Trajectory, places: Places, sign: Array, flat: float) -> Rows:
        """Rows at extrema of a motion; the weight is 1/f″, 0 where f″ is below ``flat``.

        f is a derivative in units of order one as a function of s.
        """
        curvature = along(trajectory, places, 2)
        rate = (self.unit / trajectory.durations[places.segment]) ** places.order
        curvature = curvature * rate / self.angle[places.joint]
        limits = self.sides.scale[places.joint, np.maximum(places.order, 1) - 1]
        stays = np.abs(curvature) < flat * np.where(places.order == 0, 1.0, limits)
        return Rows(places, sign, np.where(stays, 0.0, 1.0 / np.where(stays, 1.0, curvature)))

    def bounds(self) -> tuple[Array, Array]:
        """Bounds on the variables: durations, limits at left ends, given derivatives."""
        problem, plan, unit = self.problem, self._plan, self.unit
        low, high = ([bound] for bound in self.duration_bounds())
        right = plan.kinds == ConditionKind.RIGHT_VALUE
        for r, held in self._held.items():
            edges = (np.full(self.joints, -np.inf), np.full(self.joints, np.inf))
            if r <= 3:
                size = self.sides.scale[:, r - 1]
                edges = size * self.sides.low[:, r - 1], size * self.sides.high[:, r - 1]
            lower, upper = (np.tile(edge, (held.size, 1)) for edge in edges)
            i = np.flatnonzero(right & (plan.orders == r))
            at = self._row[r][plan.breaks[i]]
            lower[at] = upper[at] = plan.values[i] * unit**r / self.angle
            low.append(lower.ravel("F"))
            high.append(upper.ravel("F"))
        first = problem.waypoints[0]
        for bound, out in (
            (problem.limits.position_lower, low),
            (problem.limits.position_upper, high),
        ):
            out.append(np.tile((bound - first) / self.angle, (self._virtual.size, 1)).ravel("F"))
        return np.concatenate(low), np.concatenate(high)

    def pack(self, trajectory: Trajectory, durations: Array) -> Array:
        """Variables at a motion with these durations."""
        scaled = trajectory.scaled
        parts = [durations / self.unit]
        for r, held in self._held.items():
            rate = math.factorial(r) / (durations[held] / self.unit) ** r
            parts.append((scaled[held, r] * rate[:, None] / self.angle).ravel("F"))
        at = scaled[self._virtual, 0] - self.problem.waypoints[0]
        return np.concatenate([*parts, (at / self.angle).ravel("F")])

    def trajectory(self, x: Array) -> Trajectory:
        """The polynomials that variables stand for, from the derivatives at left ends."""
        size, joints = self.segments, self.joints
        h = x[:size]
        scaled = np.zeros((size, self.top + 1, joints))
        scaled[:, 0] = self._fixed[:-1]
        scaled[self._virtual, 0] = x[self._offset[-2] :].reshape(joints, -1).T
        for r, held in self._held.items():
            own = x[self._offset[r] : self._offset[r + 1]].reshape(joints, -1).T
            scaled[held, r] = own * (h[held] ** r / math.factorial(r))[:, None]
        scaled *= self.angle
        scaled[:, 0] += self.problem.waypoints[0]
        return Trajectory(h * self.unit, scaled, tuple(self.degrees.tolist()))

    def motion(self, x: Array) -> tuple[Array, Array | None]:
        """Durations, s, and free derivatives, where the declaration leaves some."""
        curve, trajectory = self.problem.piecewise, self.trajectory(x)
        nodal = free_values(curve, trajectory) if curve.free else None
        return trajectory.durations, nodal

    def left_places(self) -> tuple[Places, Indices]:
        """Limits that are bounds on variables, as places, and the variables' numbers."""
        found: list[tuple[Indices, Indices, Indices, Indices]] = []
        for r, held in self._held.items():
            if r > 3:
                break
            j = np.flatnonzero(np.isfinite(self.sides.scale[:, r - 1]))
            joint, row = np.repeat(j, held.size), np.tile(np.arange(held.size), j.size)
            number = self._offset[r] + joint * held.size + row
            found.append((joint, held[row], np.full(joint.size, r), number))
        count = self._virtual.size
        joint, row = (
            np.repeat(np.arange(self.joints), count),
            np.tile(np.arange(count), self.joints),
        )
        number = self._offset[-2] + joint * count + row
        found.append((joint, self._virtual[row], np.zeros(joint.size, dtype=np.int64), number))
        joint, segment, order, number = (np.concatenate([f[i] for f in found]) for i in range(4))
        low, high = self.bounds()
        at = np.flatnonzero(low[number] < high[number])  # what is given is no limit
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


def _inverted(held: Indices, size: int) -> Indices:
    """Row of each segment among those held; −1 elsewhere."""
    out = np.full(size, -1, dtype=np.int64)
    out[held] = np.arange(held.size)
    return out
