"""A piecewise polynomial joint trajectory over scipy's ``PPoly``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from .peak import Extremum, critical_points, polynomial_extrema

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint angles over time, with the scaled coefficients that exact peaks are found from.

    Attributes
    ----------
    durations : ndarray, shape (pieces,)
        Durations of the pieces, s: the segments, except where a curve has its knots elsewhere.
    scaled : ndarray, shape (pieces, powers, joints)
        Ascending coefficients in s = (t − t_k)/h_k.
    degrees : tuple of int
        Degree of each piece.
    """

    durations: Array
    scaled: Array
    degrees: tuple[int, ...]

    @cached_property
    def polynomial(self) -> PPoly:
        """The trajectory as scipy's ``PPoly``, values of shape (joints,), rad over s."""
        from scipy.interpolate import PPoly  # half a second, and no peak needs it

        powers = np.arange(max(self.degrees) + 1)
        in_time = self.scaled[:, : powers.size] / (self.durations[:, None] ** powers)[:, :, None]
        return PPoly(np.ascontiguousarray(in_time[:, ::-1].transpose(1, 0, 2)), self.breaks)

    def __call__(self, time: ArrayLike, order: int = 0) -> Array:
        """Derivative ``order`` at ``time`` (s); shape of ``time`` plus (joints,)."""
        return np.asarray(self.polynomial(time, nu=order), dtype=np.float64)

    @cached_property
    def breaks(self) -> Array:
        """Times at which the pieces meet, s."""
        return np.concatenate([[0.0], np.cumsum(self.durations)])

    @property
    def total_time(self) -> float:
        """Sum of the durations, s."""
        return float(self.durations.sum())

    @property
    def polynomial_in_time(self) -> bool:
        """Whether each piece is a polynomial in time, so that `derivative` answers."""
        return True

    @property
    def joints(self) -> int:
        """Number of joints."""
        return int(self.scaled.shape[2])

    def derivative(self, segment: int, joint: int, order: int) -> Array:
        """Ascending coefficients in s of a time derivative on one piece; not to be written to."""
        known = self._derivatives.get((segment, order))
        if known is None:
            d = self.degrees[segment]
            a = self.scaled[segment, : d + 1].T.copy()
            for _ in range(order):
                size = a.shape[1]
                a = a[:, 1:] * np.arange(1, size) if size > 1 else np.zeros((len(a), 1))
            known = np.asarray(a / self.durations[segment] ** order, dtype=np.float64)
            known.setflags(write=False)
            self._derivatives[segment, order] = known
        one: Array = known[joint]
        return one

    @cached_property
    def _derivatives(self) -> dict[tuple[int, int], Array]:
        """Of every joint, by piece and order: the checker asks for each several times."""
        return {}

    def turning(self, piece: int, joint: int, order: int) -> Array:
        """Places in (0, 1) of a piece where a derivative in time turns."""
        return critical_points(self.derivative(piece, joint, order))

    def values(self, piece: int, joint: int, order: int, places: Array) -> Array:
        """Derivative in time at places, 0..1, of a piece."""
        a = self.derivative(piece, joint, order)
        found: Array = a[-1] + places * 0.0
        for coefficient in a[-2::-1]:
            found = coefficient + found * places
        return found

    def quick_extrema(self, joint: int, order: int) -> list[Extremum] | None:
        """`extrema` of one derivative where plain polynomials allow a shorter way, else None."""
        if type(self) is not Trajectory:
            return None
        rows = self.scaled[:, :, joint].tolist()
        begins, durations = self.breaks.tolist(), self.durations.tolist()
        found: list[Extremum] = []
        for k, degree in enumerate(self.degrees):
            row = rows[k][: degree + 1]
            for _ in range(order):
                row = [c * p for p, c in enumerate(row)][1:] or [0.0]
            rate = durations[k] ** order
            row = [c / rate for c in row]
            found += polynomial_extrema(row, joint, k, order, begins[k], durations[k])
        return found

    def times(self, piece: int, places: Array) -> Array:
        """Times of places of a piece, s."""
        return np.asarray(self.breaks[piece] + places * self.durations[piece])

    def level(self, piece: int, joint: int, order: int, value: float) -> Array:
        """Ascending polynomial on a piece that vanishes where a derivative has the value."""
        found = self.derivative(piece, joint, order).copy()
        found[0] -= value
        return found

    def sides(self, break_index: int, joint: int, order: int) -> tuple[float, float, float]:
        """Derivative just before and just after an inner break, and the size of their terms."""
        left = self.derivative(break_index - 1, joint, order)
        right = self.derivative(break_index, joint, order)
        scale = float(np.abs(left).sum() + np.abs(right).sum())
        return float(left.sum()), float(right[0]), scale
