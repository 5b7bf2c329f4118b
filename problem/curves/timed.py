"""Curves q(e) with a clock t(e), both piecewise cubic: exact derivatives in time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import CurveError, TrajgapError
from .kind import Asked, Enclosed, are_durations
from .polynomials import (
    MAX_COEFFICIENTS,
    Numbers,
    beyond,
    derived,
    following,
    in_time,
    roots_in_unit,
    tops,
    valued,
)
from .trajectory import Trajectory

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


def numerators(q: Numbers, t: Numbers, highest: int, sign: int = -1) -> list[Numbers]:
    """Polynomials N_r with dʳq/dtʳ = N_r/t′²ʳ⁻¹, r = 1..highest, for q(e) and t(e).

    N_1 = q′, N_{r+1} = N_r′ t′ − (2r − 1) N_r t″; N_2 = q″t′ − q′t″ is (7).

    Parameters
    ----------
    q, t : ndarray, shape (4, ...)
        Ascending coefficients; complex ones too.
    highest : int
    sign : int
        As `following`.

    Returns
    -------
    list of ndarray, shape (powers, ...)
    """
    found = [derived(q, 1)]
    for r in range(1, highest):
        found.append(following(found[-1], t, r, sign))
    return found


def _least_speed(speed: Array) -> tuple[Array, Array]:
    """Smallest value on [0, 1] of quadratics, ascending powers leading, and its place."""
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = -0.5 * speed[1] / speed[2]
    turn = np.where((speed[2] > 0.0) & (turn > 0.0) & (turn < 1.0), turn, 0.0)
    places = np.stack([np.zeros(turn.shape), np.ones(turn.shape), turn])
    values = valued(speed, places)
    at = values.argmin(axis=0)[None]
    return np.take_along_axis(values, at, 0)[0], np.take_along_axis(places, at, 0)[0]


TOGETHER = 256
"""Vectors whose pieces are looked at together: what they take fits a cache."""


@dataclass(frozen=True, eq=False)
class ClockedTrajectory(Trajectory):
    """Joint angles over a parameter e, with time a growing function of e.

    ``polynomial`` maps e, 0 to the number of pieces, to the joint angles; ``scaled`` holds the
    same in each piece's own 0..1.

    Attributes
    ----------
    clock : ndarray, shape (pieces, 4)
        Ascending coefficients of t on each piece, s.
    """

    clock: Array

    @cached_property
    def polynomial(self) -> PPoly:
        """The joint angles over e as scipy's ``PPoly``, values of shape (joints,), rad."""
        from scipy.interpolate import PPoly  # half a second, and no peak needs it

        angles = np.ascontiguousarray(self.scaled[:, 3::-1].transpose(1, 0, 2))
        return PPoly(angles, np.arange(len(self.clock) + 1.0))

    @cached_property
    def breaks(self) -> Array:
        """Times at which the pieces meet, s."""
        return np.append(self.clock[:, 0], self.clock[-1].sum())

    @cached_property
    def _time(self) -> Array:
        """The clock with powers leading, shape (4, pieces, 1)."""
        return np.ascontiguousarray(self.clock.T[:, :, None])

    @cached_property
    def numerators(self) -> list[Array]:
        """N_1 to N_5, each of shape (powers, pieces, joints)."""
        found = numerators(self.derivatives(0), self._time, 5)
        return [np.ascontiguousarray(a, dtype=np.float64) for a in found]

    def __call__(self, time: ArrayLike, order: int = 0) -> Array:
        """Derivative ``order`` in time at ``time`` (s), by inverting t(e)."""
        t = np.asarray(time, dtype=np.float64)
        last = len(self.clock) - 1
        piece = np.clip(np.searchsorted(self.breaks, t.ravel(), side="right") - 1, 0, last)
        level = self.clock[piece].T
        level[0] -= t.ravel()
        # One root, as time grows; none at an end, nor beyond it.
        found = np.fmax.reduce(roots_in_unit(level), axis=0)
        places = np.where(np.isnan(found), level[0] < 0.0, found)
        every = slice(None)
        values = [
            self.values(k, every, order, e)
            for k, e in zip(piece.tolist(), places[:, None], strict=True)
        ]
        return np.array(values).reshape(*t.shape, self.joints)

    def turns(self, order: int, pieces: NDArray[np.int64] | None = None) -> tuple[Array, Array]:
        """Like `Trajectory.turns`, for derivatives that are not polynomials."""
        if order == 0:
            return super().turns(0, pieces)
        own = slice(None) if pieces is None else pieces
        inner = roots_in_unit(self.numerators[order][:, own])
        edge = np.zeros((1, *inner.shape[1:]))
        places = np.concatenate([edge, inner, edge + 1.0])
        speed = derived(self._time[:, own], 1)
        return places, in_time(self.numerators[order - 1][:, own], speed, order, places)

    def derivative(self, segment: int, joint: int | slice, order: int) -> Array:
        """Refuse: a derivative in time is not a polynomial.

        Raises
        ------
        TrajgapError
            For every order above 0.
        """
        if order == 0:
            return super().derivative(segment, joint, 0)
        raise TrajgapError(
            "trajectory: time is not linear here, so derivatives are not polynomials"
        )

    @property
    def path(self) -> Trajectory:
        """q(e) with a parameter that grows evenly."""
        even = np.full(len(self.clock), self.total_time / len(self.clock))
        return Trajectory(even, self.scaled, self.degrees)

    @property
    def polynomial_in_time(self) -> bool:
        """Never: time is not linear in the parameter."""
        return False

    def values(self, piece: int, joint: int | slice, order: int, places: Array) -> Array:
        """Derivative in time, up to order 4, at places of a piece."""
        if order == 0:
            return super().values(piece, joint, 0, places)
        speed = derived(self.clock[piece], 1)
        return in_time(self.numerators[order - 1][:, piece, joint], speed, order, places)

    def times(self, pieces: int | NDArray[np.int64], places: Array) -> Array:
        """As `Trajectory.times`, by the clock."""
        return valued(self.clock[pieces].T, places)

    def level(self, piece: int, joint: int, order: int, value: float) -> Array:
        """N_r − value·t′²ʳ⁻¹, as t′ > 0."""
        if order == 0:
            return super().level(piece, joint, order, value)
        speed = np.polynomial.polynomial.polypow(derived(self.clock[piece], 1), 2 * order - 1)
        found = self.numerators[order - 1][:, piece, joint]
        return np.asarray(np.polynomial.polynomial.polysub(found, value * speed))

    def steps(self, order: int) -> tuple[Array, Array, Array]:
        """Derivative, up to order 3, before and after each inner break, and its terms' size."""
        if order == 0:
            return super().steps(0)
        q, speed = self.derivatives(0), derived(self._time, 1)
        edges = np.stack([np.zeros(q.shape[1:]), np.ones(q.shape[1:])])
        terms = numerators(np.abs(q), np.abs(self._time), order, 1)[-1]
        values = in_time(self.numerators[order - 1], speed, order, edges)
        sizes = in_time(terms, speed, order, edges)
        return values[1, :-1], values[0, 1:], sizes[1, :-1] + sizes[0, 1:]


def combined(matrix: Numbers, numbers: Array) -> tuple[Array, Array]:
    """Combinations in extended precision of way-points, or durations, and a bound on their error.

    The matrix has shape (pieces, 4, numbers), the numbers (numbers, joints), both results
    (pieces, 10, joints).
    """
    wide = numbers.astype(np.longdouble)
    tiny = np.finfo(np.longdouble).eps * (len(numbers) + 5)
    scaled, error = np.zeros((2, len(matrix), MAX_COEFFICIENTS, numbers.shape[1]))
    scaled[:, :4] = matrix @ wide
    error[:, :4] = tiny * (np.abs(matrix) @ np.abs(wide))
    error += np.finfo(np.float64).eps * np.abs(scaled)
    return scaled, error


def enclosed_with_clock(q: Numbers, t: Numbers, waypoints: Array, durations: Array) -> Enclosed:
    """Trajectory of q(e) and t(e), with a bound on the error of every extremum.

    Both are combinations, coefficients in e of way-points and of durations, in extended precision.

    Raises
    ------
    CurveError
        If the clock does not run forwards everywhere.
    """
    scaled, error = combined(q, waypoints)
    clock, clock_error = (one[:, :4, 0] for one in combined(t, durations[:, None]))
    speeds, places = _least_speed(derived(clock.T, 1))
    k = int(speeds.argmin())
    if not speeds[k] > 0:
        raise CurveError(
            f"durations: time would not increase along the curve, dt/de = {speeds[k]:.6g} s at "
            f"e = {places[k]:.4g} of segment {k + 1}; make neighbouring durations less unequal",
            k,
            float(speeds[k]),
        )
    lengths = np.diff(np.append(clock[:, 0], clock[-1].sum()))
    found = ClockedTrajectory(lengths, scaled, (3,) * len(clock), clock)
    return Enclosed(found, partial(_errors, found, error, clock_error))


def _errors(found: ClockedTrajectory, error: Array, clock_error: Array) -> Array:
    """Bound on the error of each derivative's extrema, shape (pieces, 5, joints).

    First order in the coefficients' errors and in the rounding of the numerators, doubled; the
    division by t′²ʳ⁻¹ adds (2r − 1) δt′/t′ of the largest value.
    """
    epsilon = 64 * np.finfo(np.float64).eps
    q, t = np.abs(found.derivatives(0)), np.abs(found.clock.T[:, :, None])
    dq = error[:, :4].transpose(1, 0, 2) + epsilon * q
    dt = clock_error.T[:, :, None] + epsilon * t
    least = _least_speed(derived(found.clock.T, 1))[0][:, None]
    slow = derived(dt, 1).sum(axis=0) / least
    bounds = np.empty((len(found.clock), 5, found.joints))
    bounds[:, 0] = 2.0 * dq.sum(axis=0)
    terms = [a.sum(axis=0) for a in numerators(q, t, 5, 1)]
    moved = [a.sum(axis=0) for a in numerators(q + dq, t + dt, 5, 1)]
    for r in range(1, 5):
        sway = moved[r - 1] - terms[r - 1] + epsilon * terms[r - 1]
        power = least ** (2 * r - 1)
        # The place of an extremum is where the next numerator vanishes to rounding.
        place = epsilon * terms[r] / (power * least)
        size = terms[r - 1] / power
        bounds[:, r] = 2.0 * (sway / power + (2 * r - 1) * slow * size) + place
    return bounds


def values_at(q: Numbers, t: Numbers, order: int, places: Array) -> Numbers:
    """Derivatives in time at places of q(e) and t(e); coefficients lead."""
    if order == 0:
        return valued(q, places)
    return in_time(numerators(q, t, order)[-1], derived(t, 1), order, places)


def runs_forwards(nodes: Array, durations: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Clocks of many duration vectors, and which of them run forwards everywhere.

    From coefficients in e of t, (pieces, 4, segments), and durations (batch, segments): clocks of
    shape (4, batch, pieces).
    """
    valid = are_durations(durations)
    h = np.where(valid[:, None], durations, 1.0)
    clocks = np.einsum("vs,kps->pvk", h, nodes)  # the same bits for any number of vectors
    least = _least_speed(derived(clocks, 1))[0].min(axis=1)
    return clocks, np.asarray(valid & (least > 0.0))


def clocked_reach(q: Array, clocks: Array, asked: Asked) -> Array:
    """How far derivatives in time go under many clocks that run forwards.

    On a piece Bernstein coefficients bound N_r, its least value t′; where that stays below what
    another piece has at one of its ends it is not looked at further.

    Coefficients q have shape (pieces, 4, joints), clocks (4, batch, pieces); the answer is that of
    `Curve.batch_reach`.
    """
    found = asked.room(clocks.shape[1])
    for first in range(0, len(found), TOGETHER):
        some = slice(first, first + TOGETHER)
        _reach_of_some(q, clocks[:, some], asked, found[some])
    return found


def _reach_of_some(q: Array, clocks: Array, asked: Asked, found: Array) -> None:
    """`clocked_reach` of few vectors; a vector beyond a cap is left out of what follows."""
    a, t = q.transpose(1, 0, 2)[:, None], clocks[..., None]
    slowest, at = _least_speed(derived(t, 1))[0], np.arange(len(found))
    for r in range(asked.least + asked.wanted.shape[1]):
        if r > 0:
            a = derived(a, 1) if r == 1 else following(a, t, r - 1)
        i = r - asked.least
        if i < 0 or not asked.wanted[:, i].any():
            continue
        clock = (t, r, slowest) if r else None
        caps = None if asked.caps is None else asked.caps[:, i]
        for side, sign in enumerate(asked.sides):
            found[at, side, :, i] = tops(a, sign, clock, caps)
        if caps is not None:
            within = ~beyond(found[at, :, :, i].max(axis=1), caps)
            at, t, slowest = at[within], t[:, within], slowest[within]
            a = a[:, within] if a.shape[1] > 1 else a
