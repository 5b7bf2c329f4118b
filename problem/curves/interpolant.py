"""The declaration of an interpolant: degrees, continuity, prescribed derivatives, and its rows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from . import kernel, refined, spline
from .condition import Condition, ConditionKind, ConditionTable, condition_table, counts_in_words
from .kind import (
    Curve,
    Derivatives,
    Enclosed,
    PeakGradients,
    as_batch,
    derivative_row,
    merged_values,
    value_errors,
)
from .peak import Extremum
from .trajectory import Trajectory

MOST_OPEN = 600
"""Coefficients up to which a case file may leave some free: finding the derivatives that complete
the declaration takes a dense decomposition for each, some seconds in all."""
_UNDECIDED = 1e-9
"""Relative distance from a ceiling within which peaks are computed: bounds know them to 1e-12."""
_DENSE = 300
"""Coefficients above which the rank is judged by a banded factorisation: a dense one is cubic."""


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
        if any(d < 1 or d > 9 for d in self.degrees):
            raise TrajgapError("interpolant.degrees: every degree must lie in 1..9")
        if any(c < 0 for c in self.continuity):
            raise TrajgapError("interpolant.continuity: every order must be 0 or more")
        if any(not 0 < b < n for b in self.virtual):
            raise TrajgapError(
                "interpolant.virtual: only interior breaks can be virtual, "
                f"{f'1 to {n - 1}' if n > 1 else 'of which one segment has none'}"
            )
        object.__setattr__(self, "prescribed", tuple(map(merged_values, self.prescribed)))
        counts = {len(v) for at in self.prescribed for _, v in at if isinstance(v, tuple)}
        if len(counts) > 1:
            raise TrajgapError(
                "interpolant.prescribed: given for "
                f"{' and for '.join(map(str, sorted(counts)))} joints; give one value for all "
                "joints, or one for each of them"
            )
        for b, entries in enumerate(self.prescribed):
            orders = [order for order, _ in entries]
            if len(set(orders)) != len(orders) or any(order < 1 for order in orders):
                raise TrajgapError(
                    f"interpolant.prescribed[{b}]: orders must be distinct and at least 1"
                )
            if not all(map(math.isfinite, _values(entries))):
                raise TrajgapError(f"interpolant.prescribed[{b}]: values must be finite")
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
        virtual = set(self.virtual)
        return tuple(b for b in range(self.segments + 1) if b not in virtual)

    @property
    def coefficients(self) -> int:
        """Number of coefficients of one joint."""
        return sum(d + 1 for d in self.degrees)

    @property
    def conditions(self) -> int:
        """Number of conditions on them."""
        return self.table.kinds.size

    @property
    def free(self) -> int:
        """Coefficients left to the optimiser."""
        return self.coefficients - self.conditions

    @property
    def piecewise(self) -> Interpolant:
        """The declaration itself."""
        return self

    def prescribed_at(self, break_index: int) -> Derivatives:
        """Derivatives that both sides take at a break."""
        return self.prescribed[break_index]

    @cached_property
    def prescribed_joints(self) -> int | None:
        """Joints that prescribed derivatives differ between."""
        several = (v for at in self.prescribed for _, v in at if isinstance(v, tuple))
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
        """`fit` by one banded elimination."""
        scaled = spline.coefficients(self, waypoints, durations, nodal)
        return Trajectory(durations, scaled, self.degrees)

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """`fit` refined in extended precision, with the bound of `refined_coefficients`."""
        scaled, error = refined.refined_coefficients(self, waypoints, durations, nodal)
        trajectory = Trajectory(durations, scaled, self.degrees)
        return Enclosed(trajectory, value_errors(trajectory, error))

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """Right-hand sides of the conditions, positions counted from the first way-point."""
        return spline.motion_values(self, waypoints, nodal)

    def batch_peaks(self, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
        """True peaks by the compiled kernel, on several threads where that pays."""
        return spline.batch_peaks(self, values, as_batch(self, durations), wanted)

    def decided_peaks(
        self, values: Array, durations: Array, wanted: NDArray[np.bool_], ceilings: Array
    ) -> Array:
        """Peaks of pieces that bounds alone do not decide."""
        h = as_batch(self, durations)
        return spline.leading_peaks(self, values, h, wanted, ceilings, 1.0 - _UNDECIDED)

    def leading_peaks(
        self, values: Array, durations: Array, wanted: NDArray[np.bool_], limits: Array
    ) -> Array:
        """Peaks of pieces whose bounds leave open whether they demand the largest stretch."""
        return spline.leading_peaks(self, values, as_batch(self, durations), wanted, limits, 0.0)

    def batch_sides(
        self,
        waypoints: Array,
        durations: Array,
        wanted: NDArray[np.bool_],
        nodal: Array | None = None,
    ) -> Array:
        """True peaks to each side by the compiled kernel."""
        values, h = self.motion_values(waypoints, nodal), as_batch(self, durations)
        sides = zip(wanted, (-1.0, 1.0), strict=True)
        return np.stack([spline.batch_peaks(self, values, h, part, sign) for part, sign in sides])

    def range_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """Right-hand sides, as for peaks."""
        return self.motion_values(waypoints, nodal)

    def batch_ranges(self, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
        """Least and largest positions by the compiled kernel, of the joints that are asked for."""
        h = as_batch(self, durations)
        found = np.zeros((len(h), wanted.size, 2))
        asked = np.ascontiguousarray(values[:, wanted])
        if asked.size:
            found[:, wanted] = spline.batch_ranges(self, asked, h)
        return found

    def value_gradients(
        self,
        waypoints: Array,
        durations: Array,
        points: list[Extremum],
        nodal: Array | None = None,
    ) -> PeakGradients:
        """Gradients by implicit differentiation of the linear system."""
        if self.coefficients > _DENSE:
            # The module builds on this one's neighbours, and few problems need it.
            from .adjoint import Adjoint, places_of

            return Adjoint(self, waypoints, durations, nodal).gradients(places_of(points))
        g = refined.coefficient_gradient(self, waypoints, durations, nodal)
        by_duration = np.empty((len(points), self.segments))
        by_waypoint = np.empty((len(points), waypoints.shape[0]))
        by_nodal = np.empty((len(points), self.free))
        for i, e in enumerate(points):
            basis = derivative_row(e.s, e.order) / durations[e.segment] ** e.order
            by_duration[i] = g.durations[:, e.segment, :, e.joint] @ basis
            by_duration[i, e.segment] -= e.order * e.value / durations[e.segment]
            by_waypoint[i] = g.waypoints[:, e.segment] @ basis
            by_nodal[i] = g.nodal[:, e.segment] @ basis
        return PeakGradients(by_duration, by_waypoint, by_nodal)

    @cached_property
    def table(self) -> ConditionTable:
        """The conditions as arrays, ordered by break, so that the linear system is banded."""
        virtual = set(self.virtual)
        given = [
            frozenset([*(order for order, _ in entries), *([] if b in virtual else [0])])
            for b, entries in enumerate(self.prescribed)
        ]
        return condition_table(given, self.continuity)

    @cached_property
    def rows(self) -> tuple[Condition, ...]:
        """The conditions one by one."""
        return self.table.conditions

    @cached_property
    def rank(self) -> int:
        """Rank of the conditions for equal durations."""
        if self.conditions == self.coefficients > _DENSE:
            return self.conditions if self._banded_regular() else self.conditions - 1
        return int(np.linalg.matrix_rank(self._unit_matrix(self.rows)))

    @cached_property
    def free_derivatives(self) -> tuple[tuple[int, int], ...]:
        """Nodal derivatives ``(break, order)`` that complete an under-determined declaration.

        Lowest orders first; with their values prescribed the coefficients are determined.
        """
        if self.free == 0:
            return ()
        rows = list(self.rows)
        chosen: list[tuple[int, int]] = []
        matrix, rank = self._unit_matrix(rows), self.rank
        for order in range(max(self.degrees) + 1):
            for b in range(self.segments + 1):
                for kind, there in _SIDES:
                    row = Condition(kind, b, order)
                    if rank == self.coefficients or row in rows or not there(b, self.segments):
                        continue
                    shared = b in (0, self.segments) or order <= self.continuity[b - 1]
                    if (b, order) in chosen or not shared:
                        continue
                    extended = np.vstack([matrix, self._unit_matrix([row])])
                    if np.linalg.matrix_rank(extended) > rank:
                        matrix, rank = extended, rank + 1
                        rows.append(row)
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
                f"interpolant {self.name}: {self.free} free coefficients, of which only "
                f"{len(self.free_derivatives)} are nodal derivatives; raise the continuity"
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
        if self.table.orders.max() >= kernel.MAX_COEFFICIENTS:
            return False  # a derivative beyond every degree: 0 whatever the coefficients
        right = self.table.kinds == ConditionKind.RIGHT_VALUE
        if (self.table.orders > np.array([*self.degrees, 0])[self.table.breaks])[right].any():
            return False
        pivots = np.abs(refined.system(self, np.ones(self.segments)).factorised().diagonal)
        return bool(pivots.min() > 1e-13 * pivots.max())

    def _entries(self, row: Condition) -> list[tuple[int, float]]:
        """Columns and values of one row for equal durations."""
        entries: list[tuple[int, float]] = []
        if row.kind != ConditionKind.RIGHT_VALUE:
            k = row.at - 1
            powers = range(row.order, self.degrees[k] + 1)
            entries += [(self._first[k] + p, float(math.perm(p, row.order))) for p in powers]
        if row.kind != ConditionKind.LEFT_VALUE and row.order <= self.degrees[row.at]:
            sign = 1.0 if row.kind == ConditionKind.RIGHT_VALUE else -1.0
            entries.append((self._first[row.at] + row.order, sign * math.factorial(row.order)))
        return entries

    @cached_property
    def _first(self) -> tuple[int, ...]:
        """Column of each segment's constant coefficient."""
        return tuple(itertools.accumulate((d + 1 for d in self.degrees), initial=0))

    def _unit_matrix(self, rows: tuple[Condition, ...] | list[Condition]) -> Array:
        matrix = np.zeros((len(rows), self.coefficients))
        for i, row in enumerate(rows):
            for column, value in self._entries(row):
                matrix[i, column] = value
        return matrix


def _values(entries: Derivatives) -> list[float]:
    """All values that are prescribed at a break, of every joint."""
    return [x for _, v in entries for x in (v if isinstance(v, tuple) else (v,))]


_SIDES: tuple[tuple[ConditionKind, Callable[[int, int], bool]], ...] = (
    (ConditionKind.LEFT_VALUE, lambda b, n: b > 0),
    (ConditionKind.RIGHT_VALUE, lambda b, n: b < n),
)
"""Kinds of condition on a value, and at which of the breaks 0..n their side exists."""
