"""Gradients of values on long splines: a banded solve for each value, or one for a weighted sum.

With Ac = b for the coefficients c of a joint, a value wᵀc changes with a parameter by yᵀ(b′ − A′c),
Aᵀy = w: rows of the inverse are never formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from . import refined
from .banded import Factors
from .condition import ConditionKind
from .kind import PeakGradients, derivative_rows
from .peak import Extremum
from .spline import coefficients, layout, right_hand_sides

if TYPE_CHECKING:
    from .interpolant import Interpolant

CHUNK = 10_000_000
"""Entries of the multipliers y that are held at once, some hundred megabytes with all they need."""


@dataclass(frozen=True, eq=False)
class Places:
    """Places on a spline at which derivatives are looked at, as arrays of one length.

    Attributes
    ----------
    joint, segment, order : ndarray of int
    s : ndarray
        In the segments' own parameter, 0..1.
    """

    joint: NDArray[np.int64]
    segment: NDArray[np.int64]
    order: NDArray[np.int64]
    s: Array


def places_of(points: list[Extremum]) -> Places:
    """The places of some extrema."""
    whole = np.array([(e.joint, e.segment, e.order) for e in points], dtype=np.int64).reshape(-1, 3)
    return Places(whole[:, 0], whole[:, 1], whole[:, 2], np.array([e.s for e in points]))


class Adjoint:
    """A spline at one duration vector, ready for gradients of its derivatives in time.

    Parameters
    ----------
    interpolant : Interpolant
    waypoints : ndarray, shape (way-points, joints)
    durations : ndarray, shape (segments,)
    nodal : ndarray, shape (free, joints), optional
    """

    def __init__(
        self,
        interpolant: Interpolant,
        waypoints: Array,
        durations: Array,
        nodal: Array | None = None,
    ) -> None:
        plan, rows = layout(interpolant), refined.system(interpolant, durations)
        pattern = refined.pattern_of(interpolant)
        self._factors: Factors = rows.factorised()
        self._durations, self._rows, self._plan = durations, rows, plan
        self._scaled = coefficients(interpolant, waypoints, durations, nodal)
        flat = self._scaled[refined.places(interpolant)]
        # A row that matches two segments holds (h_{b−1}/h_b)ʳ.
        self._jumps, self._after = pattern.jumps, plan.breaks[pattern.jumps]
        own = rows.values[pattern.jumps, pattern.slots]
        column = rows.columns[pattern.jumps, pattern.slots]
        self._slope = (plan.orders[pattern.jumps] * own)[:, None] * flat[column]
        # The right-hand side of a given derivative holds hʳ.
        self._prescribed = np.flatnonzero((plan.kinds != ConditionKind.MATCH) & (plan.orders > 0))
        self._at = pattern.segment[self._prescribed]
        values = right_hand_sides(interpolant, waypoints, nodal)[self._prescribed]
        rate = plan.orders[self._prescribed] * rows.factor[self._prescribed] / durations[self._at]
        self._rate = rate[:, None] * values
        self._sizes = (waypoints.shape[0], interpolant.free)

    def values(self, places: Places) -> Array:
        """The derivatives in time at some places."""
        basis = self._basis(places)
        return np.asarray((basis * self._scaled[places.segment, :, places.joint]).sum(axis=1))

    def weighted(self, places: Places, weights: Array) -> Array:
        """Gradient by the durations of the weighted sum of values at places, shape (segments,)."""
        load = np.zeros((len(self._rows.values), self._scaled.shape[2]))
        column, basis = self._loads(places)
        np.add.at(load, (column, places.joint[:, None]), basis * weights[:, None])
        y = self._factors.solve(load, transposed=True)
        found = self._by_durations(y, slice(None)).sum(axis=1)
        np.add.at(found, places.segment, weights * self._own(places))
        return np.asarray(found)

    def gradients(self, places: Places) -> PeakGradients:
        """Gradients of the values at places, each by all durations, way-points and nodal values."""
        count, size = places.s.size, len(self._rows.values)
        points, free = self._sizes
        by_duration = np.empty((count, self._durations.size))
        by_waypoint, by_nodal = np.zeros((count, points)), np.zeros((count, free))
        column, basis = self._loads(places)
        own = self._own(places)
        step = max(1, CHUNK // size)
        for start in range(0, count, step):
            at = slice(start, min(start + step, count))
            v = np.arange(at.stop - start)
            load = np.zeros((size, v.size))
            np.add.at(load, (column[at], v[:, None]), basis[at])
            y = self._factors.solve(load, transposed=True)
            by_duration[at] = self._by_durations(y, places.joint[at]).T
            by_duration[at][v, places.segment[at]] += own[at]
            for out, number in ((by_waypoint, self._plan.waypoint), (by_nodal, self._plan.nodal)):
                i = np.flatnonzero(number >= 0)
                part = np.zeros((out.shape[1], v.size))
                np.add.at(part, number[i], self._rows.factor[i, None] * y[i])
                out[at] = part.T
        return PeakGradients(by_duration, by_waypoint, by_nodal)

    def _basis(self, places: Places) -> Array:
        rate = self._durations[places.segment] ** places.order
        return np.asarray(derivative_rows(places.s, places.order) / rate[:, None])

    def _loads(self, places: Places) -> tuple[NDArray[np.int64], Array]:
        """Columns and weights of the coefficients in each value; padded weights are 0."""
        first = self._rows.first
        basis = self._basis(places)
        power = np.arange(basis.shape[1])
        last = first[places.segment + 1] - 1
        column = np.minimum(first[places.segment, None] + power, last[:, None])
        there = power <= (last - first[places.segment])[:, None]
        return column, np.where(there, basis, 0.0)

    def _own(self, places: Places) -> Array:
        """Change of the values at fixed coefficients: d/dt is d/ds over h."""
        return np.asarray(-places.order * self.values(places) / self._durations[places.segment])

    def _by_durations(self, y: Array, joint: NDArray[np.int64] | slice) -> Array:
        out, h, b = np.zeros((self._durations.size, y.shape[1])), self._durations, self._after
        change = y[self._jumps] * self._slope[:, joint]
        np.add.at(out, b - 1, -change / h[b - 1, None])
        np.add.at(out, b, change / h[b, None])
        np.add.at(out, self._at, y[self._prescribed] * self._rate[:, joint])
        return out
