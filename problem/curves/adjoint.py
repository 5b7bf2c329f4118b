"""Gradients of values on splines: one solve for each value, or one for a weighted sum.

With Ac = b for the coefficients c of a joint, a value wᵀc changes with a parameter by yᵀ(b′ − A′c),
Aᵀy = w: of long splines rows of the inverse are never formed. The durations stand in A and b as the
powers that `Conditions` states: an entry (h_{b−1}/h_b)ʳ changes by r/h_{b−1} and −r/h_b of itself,
a right-hand side h_kʳ by r/h_k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .condition import Layout
from .peak import Extremum, PeakGradients
from .polynomials import derivative_rows
from .system import system

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
    layout : Layout
    values : ndarray, shape (rows, joints)
        What the conditions give.
    durations : ndarray, shape (segments,)
        s.

    It raises `SingularError` where float64 has lost the curve.
    """

    def __init__(self, layout: Layout, values: Array, durations: Array) -> None:
        rows = system(layout, durations)
        self._layout, self._rows, self._durations = layout, rows, durations
        self._scaled = rows.fitted(values)
        flat = layout.flat(self._scaled)
        self._links, slots = layout.links
        self._after, orders = layout.breaks[self._links], layout.orders[self._links]
        own, column = (of[self._links, slots] for of in (rows.values, layout.entries[0]))
        self._slope = (orders * own)[:, None] * flat[column]
        self._given = np.flatnonzero(layout.powers)
        self._at = layout.segment[self._given]
        rate = layout.powers[self._given] * rows.factor[self._given] / durations[self._at]
        self._rate = rate[:, None] * values[self._given]

    def values(self, places: Places) -> Array:
        """The derivatives in time at some places."""
        basis = self._basis(places)
        return np.asarray((basis * self._scaled[places.segment, :, places.joint]).sum(axis=1))

    def weighted(self, places: Places, weights: Array) -> Array:
        """Gradient by the durations of the weighted sum of values at places, shape (segments,)."""
        load = np.zeros((len(self._rows.values), self._scaled.shape[2]))
        column, basis = self._loads(places)
        np.add.at(load, (column, places.joint[:, None]), basis * weights[:, None])
        found = self._by_durations(self._rows.solve(load, transposed=True), slice(None)).sum(axis=1)
        np.add.at(found, places.segment, weights * self._own(places))
        return np.asarray(found)

    def gradients(self, places: Places) -> PeakGradients:
        """Gradients of the values at places, each by all durations, way-points and nodal values."""
        count, size = places.s.size, len(self._rows.values)
        numbers = (self._layout.waypoint, self._layout.nodal)
        given = [np.zeros((count, int(number.max(initial=-1)) + 1)) for number in numbers]
        by_duration = np.empty((count, self._durations.size))
        column, basis = self._loads(places)
        own = self._own(places)
        step = max(1, CHUNK // size)
        for start in range(0, count, step):
            at = slice(start, min(start + step, count))
            v = np.arange(at.stop - start)
            load = np.zeros((size, v.size))
            np.add.at(load, (column[at], v[:, None]), basis[at])
            y = self._rows.solve(load, transposed=True)
            by_duration[at] = self._by_durations(y, places.joint[at]).T
            by_duration[at][v, places.segment[at]] += own[at]
            for out, number in zip(given, numbers, strict=True):
                i = np.flatnonzero(number >= 0)
                part = np.zeros((out.shape[1], v.size))
                np.add.at(part, number[i], self._rows.factor[i, None] * y[i])
                out[at] = part.T
        by_waypoint, by_nodal = given
        return PeakGradients(by_duration, by_nodal, lambda: by_waypoint)

    def _basis(self, places: Places) -> Array:
        rate = self._durations[places.segment] ** places.order
        return np.asarray(derivative_rows(places.s, places.order) / rate[:, None])

    def _loads(self, places: Places) -> tuple[NDArray[np.int64], Array]:
        """Columns and weights of the coefficients in each value; padded weights are 0."""
        first = self._layout.first
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
        change = y[self._links] * self._slope[:, joint]
        np.add.at(out, b - 1, -change / h[b - 1, None])
        np.add.at(out, b, change / h[b, None])
        np.add.at(out, self._at, y[self._given] * self._rate[:, joint])
        return out
