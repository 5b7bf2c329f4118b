"""The declaration of an interpolant: degrees, continuity, prescribed derivatives, and its rows."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product

import numpy as np

from ..arrays import Array
from ..errors import SingularError, TrajgapError
from .adjoint import Adjoint, places_of
from .condition import ConditionKind, Conditions, Layout, conditions_of, counts_in_words
from .kind import Asked, Curve, Derivatives, Enclosed, as_batch, merged_values, value_errors
from .peak import Extremum, PeakGradients
from .polynomials import MAX_COEFFICIENTS, PERM
from .refined import refined_coefficients
from .system import DENSE_UNKNOWNS, system
from .trajectory import Trajectory
from .tridiagonal import tridiagonal_fit

MOST_OPEN = 600
"""Coefficients up to which a case file may leave some free: finding the derivatives that complete
the declaration takes a dense decomposition for each, some seconds in all."""

PART = 1000
"""Polynomials (vectors times joints) of a thread's part: starting threads for fewer than four parts
costs more than it saves."""


@dataclass(frozen=True)
class Interpolant(Curve):
    """A piecewise polynomial with breaks at the way-points, declared once.

    Everything else is derived from this declaration: the numeric evaluator, the exact NLP and the
    heuristics' objective.

    Parameters
    ----------
    degrees : tuple of int
        Polynomial degree of each segment.
    continuity : tuple of int
        For each interior break, the highest derivative order that is continuous there (2 for C2).
    prescribed : tuple, one entry per break
        ``((order, value), ...)``: derivatives (rad/sᵒʳᵈᵉʳ) that both sides take at that break; a
        value is one number for all joints, or a sequence with one per joint.
    virtual : tuple of int
        Interior breaks without a way-point: their position is free.

    Raises
    ------
    TrajgapError
        If the declaration contradicts itself or states more conditions than there are
        coefficients.

    Notes
    -----
    A break with a way-point gives one position condition per adjacent segment; a virtual break
    gives one (the position matches). Every order 1..continuity gives one condition unless it is
    prescribed, which gives one per adjacent segment. 3-5-3 polynomials with C2 via-points and
    v = a = 0 at the ends have 14 conditions on 14 coefficients.
    """

    degrees: tuple[int, ...]
    continuity: tuple[int, ...]
    prescribed: tuple[Derivatives, ...]
    virtual: tuple[int, ...] = ()
    name: str = "piecewise polynomial"

    def __post_init__(self) -> None:
        n = len(self.degrees)
        if n < 1:
            raise TrajgapError("interpolant.degrees: at least one segment is needed")
        if len(self.continuity) != n - 1:
            raise TrajgapError(
                f"interpolant.continuity: {n} segments have {n - 1} via-points, "
                f"got {len(self.continuity)} orders"
            )
        if len(self.prescribed) != n + 1:
            raise TrajgapError(
                f"interpolant.prescribed: {n} segments have {n + 1} breaks, "
                f"got {len(self.prescribed)} entries"
            )
        if min(self.degrees) < 1 or max(self.degrees) > 9:
            raise TrajgapError("interpolant.degrees: every degree must lie in 1..9")
        if min(self.continuity, default=0) < 0:
            raise TrajgapError("interpolant.continuity: every order must be 0 or more")
        if any(not 0 < b < n for b in self.virtual):
            raise TrajgapError(
                "interpolant.virtual: only interior breaks can be virtual, "
                f"{f'1 to {n - 1}' if n > 1 else 'and one segment has none'}"
            )
        # Long declarations state few different things: each is looked at once.
        keys = list(map(id, self.prescribed))
        same = dict(zip(keys, self.prescribed, strict=True))
        merged = {key: merged_values(entries) for key, entries in same.items()}
        object.__setattr__(self, "prescribed", tuple(map(merged.__getitem__, keys)))
        stated = {*self.prescribed}
        counts = {len(v) for at in stated for _, v in at if isinstance(v, tuple)}
        if len(counts) > 1:
            raise TrajgapError(
                "interpolant.prescribed: given for "
                f"{' and for '.join(map(str, sorted(counts)))} joints; give one value for all "
                "joints, or one for each of them"
            )
        for entries in stated:
            orders = [order for order, _ in entries]
            where = f"interpolant.prescribed[{self.prescribed.index(entries)}]"
            if len(set(orders)) != len(orders) or any(order < 1 for order in orders):
                raise TrajgapError(f"{where}: orders must be distinct and at least 1")
            if not all(map(math.isfinite, _values(entries))):
                raise TrajgapError(f"{where}: values must be finite")
        if self.conditions > self.coefficients:
            raise TrajgapError(
                f"interpolant {self.name}: over-determined, "
                f"{counts_in_words(self.conditions, self.coefficients)}; {self._room()}"
            )
        checked = self.conditions == self.coefficients or self.coefficients <= MOST_OPEN
        if checked and self.rank < self.conditions:
            raise TrajgapError(
                f"interpolant {self.name}: "
                f"{counts_in_words(self.conditions, self.coefficients)} contradict each other "
                f"(rank {self.rank}); spread the degrees"
                f"{' or the virtual breaks' if self.virtual else ''}"
            )

    def _room(self) -> str:
        """What makes room for the conditions that are too many."""
        spline = {*self.continuity} == {self.degrees[0] - 1} and len({*self.degrees}) == 1
        if not spline:
            return "raise a degree or drop a condition"
        # A segment more of a spline brings one coefficient more than continuity takes.
        needed = self.conditions - self.coefficients
        breaks = f"{needed} virtual break{'s' if needed > 1 else ''}"
        return f"raise a degree, drop conditions or add {breaks}"

    @property
    def segments(self) -> int:
        """Number of segments."""
        return len(self.degrees)

    @cached_property
    def waypoint_breaks(self) -> tuple[int, ...]:
        """Breaks that carry a way-point, in order."""
        every, virtual = range(self.segments + 1), set(self.virtual)
        return tuple(b for b in every if b not in virtual) if virtual else tuple(every)

    @cached_property
    def coefficients(self) -> int:
        """Number of coefficients of one joint."""
        return sum(self.degrees) + self.segments

    @cached_property
    def _velocities_suffice(self) -> bool:
        """Whether it is a C2 cubic spline with one velocity or acceleration given at each end.

        Its conditions are as many as its coefficients, and regular: see `tridiagonal`.
        """
        cubic = {*self.degrees} == {3} and {*self.continuity} <= {2} and not self.virtual
        ends = [order for end in self.ends for order, _ in end]
        each = all(len(end) == 1 for end in self.ends)
        return cubic and each and {*ends} <= {1, 2} and not any(self.prescribed[1:-1])

    @property
    def conditions(self) -> int:
        """Number of conditions on them."""
        return self.coefficients if self._velocities_suffice else self.table.kinds.size

    @property
    def free(self) -> int:
        """Coefficients left to the optimiser."""
        return self.coefficients - self.conditions

    def prescribed_at(self, break_index: int) -> Derivatives:
        """Derivatives that both sides take at a break."""
        return self.prescribed[break_index]

    @cached_property
    def homogeneous(self) -> bool:
        """Whether all derivatives that are prescribed are 0."""
        return all(value == 0.0 for at in {*self.prescribed} for _, value in at)

    @cached_property
    def prescribed_joints(self) -> int | None:
        """Number of joints, if prescribed derivatives differ between them."""
        several = (v for at in {*self.prescribed} for _, v in at if isinstance(v, tuple))
        return next(map(len, several), None)

    def for_joint(self, waypoints: Array, index: int) -> Interpolant:
        """The declaration with the derivatives that are prescribed for one joint."""
        if self.prescribed_joints is None:
            return self
        own = tuple(
            tuple((r, v[index] if isinstance(v, tuple) else v) for r, v in at)
            for at in self.prescribed
        )
        return replace(self, prescribed=own)

    def smooth_order(self, break_index: int) -> int:
        """Order of continuity that is declared."""
        return self.continuity[break_index - 1]

    def fitted(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Trajectory:
        """`fit` by one elimination."""
        values = right_hand_sides(self, waypoints, nodal)
        return Trajectory(durations, system(self.layout, durations).fitted(values), self.degrees)

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """`fit` with the bound of `refined_coefficients`, of long splines in float64 first."""

        def found(extended: bool) -> Enclosed:
            values = right_hand_sides(self, waypoints, nodal)
            scaled, error = refined_coefficients(self.layout, values, durations, extended)
            trajectory = Trajectory(durations, scaled, self.degrees)
            return Enclosed(trajectory, partial(value_errors, trajectory, error))

        if self.coefficients <= DENSE_UNKNOWNS:
            return found(True)
        if self._velocities_suffice:
            first = tridiagonal_fit(self.ends, waypoints, durations)
            if first is not None:
                return replace(first, closer=partial(found, True))
        try:
            return replace(found(False), closer=partial(found, True))
        except SingularError:
            return found(True)

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """Right-hand sides of the conditions, positions counted from the first way-point.

        Derivatives do not depend on that shift; a joint that stands still gets exact zeros by it.
        """
        values = right_hand_sides(self, waypoints, nodal)
        layout = self.layout
        values[(layout.orders == 0) & (layout.kinds != ConditionKind.MATCH)] -= waypoints[0]
        return values

    def batch_reach(self, values: Array, durations: Array, asked: Asked) -> Array:
        """Compute it with the compiled kernel."""
        return reach_of(self.layout, values, as_batch(self, durations), asked)

    def value_gradients(
        self, waypoints: Array, durations: Array, points: list[Extremum], nodal: Array | None = None
    ) -> PeakGradients:
        """Gradients by implicit differentiation of the linear system."""
        return self.adjoint(waypoints, durations, nodal).gradients(places_of(points))

    def by_durations(self, waypoints: Array, durations: Array, points: list[Extremum]) -> Array:
        """By the same."""
        return self.value_gradients(waypoints, durations, points).durations

    def adjoint(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Adjoint:
        """The curve at one duration vector, ready for gradients."""
        return Adjoint(self.layout, right_hand_sides(self, waypoints, nodal), durations)

    @cached_property
    def table(self) -> Conditions:
        """The conditions as arrays, ordered by break, so the linear system is banded."""
        orders = {at: frozenset(order for order, _ in at) for at in {*self.prescribed}}
        fixed = {at: given | {0} for at, given in orders.items()}
        given = [fixed[at] for at in self.prescribed]
        for b in self.virtual:
            given[b] = orders[self.prescribed[b]]
        return conditions_of(given, self.continuity, self.degrees)

    @cached_property
    def layout(self) -> Layout:
        """The determined system; free derivatives, if any, become prescribed rows."""
        full = self.completed() if self.free else self
        table, n = full.table, full.segments
        values = np.zeros((n + 1, MAX_COEFFICIENTS + 1, full.prescribed_joints or 1))
        for b, entries in enumerate(full.prescribed):
            for order, value in entries:
                if order < values.shape[1]:
                    values[b, order] = value
        free = np.full(values.shape[:2], -1, dtype=np.int64)
        for i, (b, order) in enumerate(self.free_derivatives):
            free[b, order] = i
        waypoint = np.ones(n + 1, dtype=np.int64)
        waypoint[list(self.virtual)] = 0
        waypoint = np.where(waypoint > 0, np.cumsum(waypoint) - 1, -1)
        match, orders = table.kinds == ConditionKind.MATCH, table.orders
        return Layout(
            kinds=table.kinds,
            breaks=table.breaks,
            orders=orders,
            degrees=table.degrees,
            name=self.name,
            prescribed=np.where(match[:, None], 0.0, values[table.breaks, orders]),
            waypoint=np.where((orders == 0) & ~match, waypoint[table.breaks], -1),
            nodal=np.where(match, -1, free[table.breaks, orders]),
        )

    @cached_property
    def rank(self) -> int:
        """Rank of the conditions for equal durations."""
        if self._velocities_suffice:
            return self.conditions
        if self.conditions == self.coefficients > DENSE_UNKNOWNS:
            return self.conditions if self._banded_regular() else self.conditions - 1
        return int(np.linalg.matrix_rank(_unit_matrix(self.table)))

    @cached_property
    def free_derivatives(self) -> tuple[tuple[int, int], ...]:
        """Nodal derivatives ``(break, order)`` that complete an under-determined declaration.

        Lowest orders first; with their values prescribed the coefficients are determined.
        """
        if self.free == 0:
            return ()
        table, n, chosen = self.table, self.segments, []
        stated = {*map(tuple, np.stack([table.kinds, table.breaks, table.orders], 1).tolist())}
        matrix, rank = _unit_matrix(table), self.rank
        for order, b in product(range(max(self.degrees) + 1), range(n + 1)):
            shared = b in (0, n) or order <= self.continuity[b - 1]
            # Either side's row says the same of what both share.
            kind = ConditionKind.LEFT_VALUE if b > 0 else ConditionKind.RIGHT_VALUE
            if not shared or (kind, b, order) in stated or rank == self.coefficients:
                continue
            kinds, breaks, orders = np.array([[kind], [b], [order]])
            one = Conditions(kinds, breaks, orders, table.degrees)
            extended = np.vstack([matrix, _unit_matrix(one)])
            if np.linalg.matrix_rank(extended) > rank:
                matrix, rank = extended, rank + 1
                chosen.append((b, order))
        return tuple(chosen)

    def completed(self) -> Interpolant:
        """Determined declaration in which `free_derivatives` are prescribed (with value 0).

        Raises
        ------
        TrajgapError
            If derivatives shared by both sides of the breaks do not suffice.
        """
        if len(self.free_derivatives) < self.free:
            raise TrajgapError(
                f"interpolant {self.name}: {self.free} free coefficients, but only "
                f"{len(self.free_derivatives)} of them are nodal derivatives; raise the continuity"
            )
        entries = [dict(e) for e in self.prescribed]
        virtual = list(self.virtual)
        for b, order in self.free_derivatives:
            if order == 0:
                virtual.remove(b)
            else:
                entries[b][order] = 0.0
        return replace(
            self,
            prescribed=tuple(tuple(sorted(e.items())) for e in entries),
            virtual=tuple(virtual),
        )

    def _banded_regular(self) -> bool:
        """Whether a long, determined declaration has a regular system for equal durations."""
        if self.table.orders.max() >= MAX_COEFFICIENTS:
            return False  # a derivative beyond every degree: 0 whatever the coefficients
        right = self.table.kinds == ConditionKind.RIGHT_VALUE
        if (self.table.orders > np.array([*self.degrees, 0])[self.table.breaks])[right].any():
            return False
        pivots = np.abs(system(self.layout, np.ones(self.segments)).factors.diagonal)
        return bool(pivots.min() > 1e-13 * pivots.max())


def right_hand_sides(interpolant: Interpolant, waypoints: Array, nodal: Array | None) -> Array:
    """Values of the rows, shape (rows, joints): way-points, prescribed and free derivatives."""
    plan = interpolant.layout
    joints = waypoints.shape[1]
    if waypoints.shape[0] != len(interpolant.waypoint_breaks):
        raise TrajgapError(
            f"waypoints: {interpolant.name} with {interpolant.segments} segments needs "
            f"{len(interpolant.waypoint_breaks)}, got {waypoints.shape[0]}"
        )
    if interpolant.free and (nodal is None or nodal.shape != (interpolant.free, joints)):
        raise TrajgapError(
            f"interpolant {interpolant.name}: "
            f"{counts_in_words(interpolant.conditions, interpolant.coefficients)}; give nodal "
            f"derivatives of shape ({interpolant.free}, {joints}) or add conditions"
        )
    if interpolant.prescribed_joints not in (None, joints):
        raise TrajgapError(
            f"interpolant {interpolant.name}: prescribes derivatives for "
            f"{interpolant.prescribed_joints} joints, the way-points have {joints}"
        )
    values = np.array(np.broadcast_to(plan.prescribed, (plan.kinds.size, joints)))
    rows = plan.waypoint >= 0
    values[rows] = waypoints[plan.waypoint[rows]]
    if interpolant.free and nodal is not None:
        rows = plan.nodal >= 0
        values[rows] = nodal[plan.nodal[rows]]
    return values


def reach_of(layout: Layout, values: Array, durations: Array, asked: Asked) -> Array:
    """`Curve.batch_reach` of a declared curve, on several threads where that pays.

    The same bits whatever the order, the size or the threads.
    """
    from .kernel import batch_peaks  # compiled

    vectors, joints = len(durations), values.shape[1]
    peaks = asked.room(vectors)
    rows, sides = layout.rows, np.array(asked.sides)

    def run(first: int, last: int) -> None:
        part = durations[first:last], values, *rows, PERM
        batch_peaks(*part, asked.wanted, asked.least, sides, peaks[first:last])

    parts = vectors * joints // PART
    if parts < 4:
        run(0, vectors)
        return peaks
    workers = os.cpu_count() or 1
    cuts = np.linspace(0, vectors, min(2 * workers, parts) + 1).astype(int).tolist()
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, cuts[:-1], cuts[1:]))
    return peaks


def _unit_matrix(conditions: Conditions) -> Array:
    """The conditions for equal durations, as a full matrix."""
    return conditions.dense(conditions.matrix(np.ones(conditions.degrees.size)))


def _values(entries: Derivatives) -> list[float]:
    """All values that are prescribed at a break, of every joint."""
    return [x for _, v in entries for x in (v if isinstance(v, tuple) else (v,))]


def as_piecewise(curve: Curve) -> Interpolant | None:
    """The declaration as polynomials with breaks at the ends of segments, if it is one."""
    return curve if isinstance(curve, Interpolant) else None
