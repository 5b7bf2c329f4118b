"""A piecewise polynomial joint trajectory over scipy's ``PPoly``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from .polynomials import derived, roots_in_unit, valued

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint angles over time, with the scaled coefficients from which exact peaks are found.

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
        """Whether each piece is a polynomial in time, so `derivative` answers."""
        return True

    @property
    def path(self) -> Trajectory:
        """The same path through the joint angles, as polynomials of a parameter, in the same time.

        The trajectory itself if its pieces are polynomials in time.
        """
        return self

    @property
    def joints(self) -> int:
        """Number of joints."""
        return int(self.scaled.shape[2])

    @cached_property
    def _known(self) -> dict[int, Array]:
        """Derivatives by order: the checker asks for each several times."""
        return {}

    @cached_property
    def _at_edges(self) -> dict[int, tuple[Array, Array, Array]]:
        """`edges` by order: bounds and jumps ask for the same."""
        return {}

    @cached_property
    def _turned(self) -> dict[int, tuple[Array, Array]]:
        """`turns` of all pieces by order: extrema are asked for joint by joint."""
        return {}

    def derivatives(self, order: int) -> Array:
        """Coefficients in s of a time derivative, (powers, pieces, joints); not to be written to.

        It has as many powers as the highest degree leaves, at least one.
        """
        if order not in self._known:
            if order == 0:
                powers = self.scaled[:, : max(self.degrees) + 1].transpose(1, 0, 2)
                self._known[0] = np.ascontiguousarray(powers).view()
            else:
                found = derived(self.derivatives(0), order)
                found /= self.durations[:, None] ** order
                self._known[order] = found
            self._known[order].setflags(write=False)
        return self._known[order]

    def derivative(self, segment: int, joint: int | slice, order: int) -> Array:
        """Ascending coefficients in s of a time derivative on one piece; not to be written to."""
        size = max(1, self.degrees[segment] + 1 - order)
        return self.derivatives(order)[:size, segment, joint]

    def turns(self, order: int, pieces: NDArray[np.int64] | None = None) -> tuple[Array, Array]:
        """Ends and turning points of a derivative, and its values there.

        Parameters
        ----------
        order : int
        pieces : ndarray of int, optional
            Pieces to be evaluated; all by default.

        Returns
        -------
        places, values : ndarray, shape (places, pieces, joints)
            Places in the pieces' own 0..1, ascending; NaN if there are fewer.
        """
        if pieces is None and order in self._turned:
            return self._turned[order]
        a = self.derivatives(order)
        degrees = np.array(self.degrees)
        if pieces is not None:
            a, degrees = a[:, pieces], degrees[pieces]
        places = np.full((max(2, len(a)), *a.shape[1:]), np.nan)
        places[0], places[-1] = 0.0, 1.0
        for degree in np.unique(degrees).tolist():
            size = degree + 1 - order
            if size > 2:
                own = slice(None) if (degrees == degree).all() else degrees == degree
                places[1 : size - 1, own] = roots_in_unit(derived(a[:size, own], 1))
        found = places, valued(a[:, None], places)
        if pieces is None:
            self._turned[order] = found
        return found

    def values(self, piece: int, joint: int | slice, order: int, places: Array) -> Array:
        """Derivative in time at places, 0..1, of a piece; of several joints at one place."""
        return valued(self.derivative(piece, joint, order), places)

    def times(self, pieces: int | NDArray[np.int64], places: Array) -> Array:
        """Times of places on one piece, or of each place on its own piece, s."""
        return np.asarray(self.breaks[pieces] + places * self.durations[pieces])

    def level(self, piece: int, joint: int, order: int, value: float) -> Array:
        """Ascending polynomial on a piece that vanishes where a derivative has the value."""
        found = self.derivative(piece, joint, order).copy()
        found[0] -= value
        return found

    def edges(self, order: int) -> tuple[Array, Array, Array]:
        """Derivative at the start and the end of each piece, and the size of its terms.

        Each of shape (pieces, joints).
        """
        if order not in self._at_edges:
            a = self.derivatives(order)
            self._at_edges[order] = a[0], a.sum(axis=0), np.abs(a).sum(axis=0)
        return self._at_edges[order]

    def steps(self, order: int) -> tuple[Array, Array, Array]:
        """Derivative before and after each inner break, and the size of their terms.

        Each of shape (breaks, joints).
        """
        start, end, sizes = self.edges(order)
        return end[:-1], start[1:], sizes[:-1] + sizes[1:]
