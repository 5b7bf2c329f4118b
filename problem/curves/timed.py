"""Curves q(e) with a clock t(e), both piecewise cubic: exact derivatives in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PPoly

from ..arrays import Array
from ..errors import CurveError, TrajgapError
from . import kernel, timed_kernel
from . import kind as kinds
from .kind import Enclosed, PeakGradients
from .peak import Extremum, critical_points, extrema
from .spline import as_durations
from .stretched import as_waypoints
from .trajectory import Trajectory
from .uniform import TimedUniformBSpline, clock_matrix, shape_matrix

Numbers = NDArray[np.inexact]


def _derived(a: Numbers) -> Numbers:
    """Derivatives of polynomials, ascending powers along the last axis."""
    return np.asarray(a[..., 1:] * np.arange(1, a.shape[-1]))


def _product(a: Numbers, b: Numbers) -> Numbers:
    out = np.zeros(
        (*np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), a.shape[-1] + b.shape[-1] - 1),
        dtype=np.result_type(a, b),
    )
    for k in range(b.shape[-1]):
        out[..., k : k + a.shape[-1]] += a * b[..., k : k + 1]
    return out


def _valued(a: Numbers, e: float | Array) -> Numbers:
    value = a[..., -1]
    for m in range(a.shape[-1] - 2, -1, -1):
        value = value * e + a[..., m]
    return value


def numerators(q: Numbers, t: Numbers, highest: int, sign: int = -1) -> list[Numbers]:
    """Polynomials N_r with dʳq/dtʳ = N_r/t′²ʳ⁻¹, r = 1..highest, for q(e) and t(e).

    N_1 = q′, N_{r+1} = N_r′ t′ − (2r − 1) N_r t″; N_2 = q″t′ − q′t″ is (7).

    Parameters
    ----------
    q, t : ndarray, shape (..., 4)
        Ascending coefficients; complex ones too.
    highest : int
    sign : int
        With + the terms of absolute coefficients are added, which bounds what was summed.

    Returns
    -------
    list of ndarray, shape (..., powers)
    """
    speed = _derived(t)
    bend = _derived(speed)
    found = [_derived(q)]
    for r in range(1, highest):
        a = found[-1]
        following = _product(_derived(a), speed) + sign * (2 * r - 1) * _product(a, bend)
        # The leading terms of q″t′ and q′t″ cancel for two cubics.
        found.append(following[..., :3] if r == 1 and sign < 0 else following)
    return found


@dataclass(frozen=True, eq=False)
class ClockedTrajectory(Trajectory):
    """Joint angles over a parameter e whose time grows with it.

    ``polynomial`` maps e, 0 to the number of pieces, to the joint angles; ``scaled`` holds the
    same in each piece's own 0..1.

    Attributes
    ----------
    clock : ndarray, shape (pieces, 4)
        Ascending coefficients of t on each piece, s.
    """

    clock: Array

    @property
    def breaks(self) -> Array:
        """Times at which the pieces meet, s."""
        return np.append(self.clock[:, 0], self.clock[-1].sum())

    @cached_property
    def _numerators(self) -> list[Array]:
        """N_1 to N_4, each of shape (pieces, joints, powers)."""
        q = self.scaled[:, :4].transpose(0, 2, 1)
        found = numerators(q, self.clock[:, None, :], 4)
        return [np.ascontiguousarray(a, dtype=np.float64) for a in found]

    @cached_property
    def _terms(self) -> list[Array]:
        """Sums of the absolute terms of q and N_1, N_2 at both ends of the pieces."""
        q = np.abs(self.scaled[:, :4]).transpose(0, 2, 1)
        found = [q, *numerators(q, np.abs(self.clock)[:, None, :], 2, 1)]
        return [np.stack([a[..., 0], a.sum(axis=-1)]).astype(np.float64) for a in found]

    def __call__(self, time: ArrayLike, order: int = 0) -> Array:
        """Derivative ``order`` in time at ``time`` (s), by inverting t(e)."""
        t = np.asarray(time, dtype=np.float64)
        flat = t.ravel()
        last = len(self.clock) - 1
        piece = np.clip(np.searchsorted(self.breaks, flat, side="right") - 1, 0, last)
        values = np.empty((flat.size, self.joints))
        for i, (k, target) in enumerate(zip(piece, flat, strict=True)):
            e = self.place(int(k), float(target))
            values[i] = [self.value(int(k), j, order, e) for j in range(self.joints)]
        return values.reshape(*t.shape, self.joints)

    def place(self, piece: int, time: float) -> float:
        """Parameter of the piece at which a time is reached; Newton steps within bisection."""
        a = self.clock[piece].copy()
        a[0] -= time
        slope = _derived(a)
        low, high, e = 0.0, 1.0, 0.5
        for _ in range(100):
            value = float(_valued(a, e))
            low, high = (e, high) if value < 0 else (low, e)
            step = e - value / float(_valued(slope, e))
            step = step if low <= step <= high else 0.5 * (low + high)
            if abs(step - e) <= 1e-16:
                break
            e = step
        return e

    def value(self, piece: int, joint: int, order: int, e: float) -> float:
        """Derivative in time, up to order 4, at the parameter ``e`` of a piece."""
        if order == 0:
            return float(_valued(self.scaled[piece, :4, joint], e))
        speed = float(_valued(_derived(self.clock[piece]), e))
        return float(_valued(self._numerators[order - 1][piece, joint], e)) / speed ** (
            2 * order - 1
        )

    def turning(self, piece: int, joint: int, order: int) -> Array:
        """Places in (0, 1) where a derivative turns: roots of the next one's numerator."""
        if order == 0:
            return critical_points(np.ascontiguousarray(self.scaled[piece, :4, joint]))
        following = self._numerators[order][piece, joint]
        roots = np.empty(timed_kernel.ROOM)
        work = np.empty((timed_kernel.ROOM, timed_kernel.ROOM))
        count = kernel.roots_in_unit(following, following.size - 1, work, roots)
        return roots[:count].copy()

    def derivative(self, segment: int, joint: int, order: int) -> Array:
        """Refuse: a derivative in time is no polynomial.

        Raises
        ------
        TrajgapError
            For every order above 0.
        """
        if order == 0:
            return self.scaled[segment, :4, joint].copy()
        raise TrajgapError("trajectory: time is not linear here, derivatives are no polynomials")

    def sides(self, break_index: int, joint: int, order: int) -> tuple[float, float, float]:
        """Derivative, up to order 2, at both sides of an inner break, and the size of its terms."""
        before, after = (break_index - 1, 1.0), (break_index, 0.0)
        left, right = (self.value(k, joint, order, e) for k, e in (before, after))
        scale = 0.0
        for k, e in (before, after):
            speed = float(_valued(_derived(self.clock[k]), e)) if order else 1.0
            scale += float(self._terms[order][int(e), k, joint]) / speed ** max(0, 2 * order - 1)
        return left, right, scale


@extrema.register
def _(trajectory: ClockedTrajectory, joint: int, order: int) -> list[Extremum]:
    found: list[Extremum] = []
    for k, t in enumerate(trajectory.clock):
        for e in (0.0, *trajectory.turning(k, joint, order), 1.0):
            value = trajectory.value(k, joint, order, float(e))
            found.append(Extremum(joint, k, order, float(e), float(_valued(t, e)), value))
    return found


def _checked_clock(clock: Array) -> None:
    """Refuse a clock that does not run forwards everywhere.

    Raises
    ------
    CurveError
    """
    worst = [timed_kernel.least_speed(_derived(a)) for a in clock]
    k = int(np.argmin([value for value, _ in worst]))
    value, e = worst[k]
    if not value > 0:
        raise CurveError(
            f"durations: time would not increase along the curve, dt/de = {value:.6g} s at "
            f"e = {e:.4g} of segment {k + 1}; make neighbouring durations less unequal",
            k,
            float(value),
        )


def _trajectory(scaled: Array, clock: Array) -> ClockedTrajectory:
    polynomial = PPoly(
        np.ascontiguousarray(scaled[:, 3::-1].transpose(1, 0, 2)), np.arange(len(clock) + 1.0)
    )
    breaks = np.append(clock[:, 0], clock[-1].sum())
    return ClockedTrajectory(polynomial, np.diff(breaks), scaled, (3,) * len(clock), clock)


@kinds.fit.register
def _(
    curve: TimedUniformBSpline,
    waypoints: ArrayLike,
    durations: ArrayLike,
    nodal: ArrayLike | None = None,
) -> Trajectory:
    q = as_waypoints(curve, waypoints)
    h = as_durations(durations, curve.segments)
    return _enclosed(curve, q, h).trajectory


@kinds.enclosed.register
def _enclosed(
    curve: TimedUniformBSpline, waypoints: Array, durations: Array, nodal: Array | None = None
) -> Enclosed:
    matrix, nodes = shape_matrix(curve.waypoints), clock_matrix(curve.waypoints)
    wide = waypoints.astype(np.longdouble)
    long = durations.astype(np.longdouble)
    tiny, epsilon = np.finfo(np.longdouble).eps * (curve.waypoints + 4), np.finfo(np.float64).eps
    n, joints = curve.segments, waypoints.shape[1]
    scaled, error = np.zeros((2, n, kernel.MAX_COEFFICIENTS, joints))
    scaled[:, :4] = matrix @ wide
    error[:, :4] = tiny * (np.abs(matrix) @ np.abs(wide)) + epsilon * np.abs(scaled[:, :4])
    clock = np.asarray(nodes @ long, dtype=np.float64)
    clock_error = np.asarray(tiny * (np.abs(nodes) @ long) + epsilon * np.abs(clock))
    _checked_clock(clock)
    found = _trajectory(scaled, clock)
    return Enclosed(found, _errors(found, error, clock_error))


def _errors(found: ClockedTrajectory, error: Array, clock_error: Array) -> Array:
    """Bound on the error of each derivative's extrema, shape (pieces, 4, joints).

    First order in the coefficients' errors and in the rounding of the numerators, doubled; the
    division by t′²ʳ⁻¹ adds (2r − 1) δt′/t′ of the largest value.
    """
    epsilon = 64 * np.finfo(np.float64).eps
    q = np.abs(found.scaled[:, :4]).transpose(0, 2, 1)
    t = np.abs(found.clock)[:, None, :]
    dq = error[:, :4].transpose(0, 2, 1) + epsilon * q
    dt = clock_error[:, None, :] + epsilon * t
    least = np.array([timed_kernel.least_speed(_derived(a))[0] for a in found.clock])[:, None]
    slow = _derived(dt).sum(axis=-1) / least
    bounds = np.empty((len(found.clock), 4, found.joints))
    bounds[:, 0] = 2.0 * dq.sum(axis=-1)
    terms = [a.sum(axis=-1) for a in numerators(q, t, 4, 1)]
    moved = [a.sum(axis=-1) for a in numerators(q + dq, t + dt, 4, 1)]
    for r in range(1, 4):
        sway = moved[r - 1] - terms[r - 1] + epsilon * terms[r - 1]
        power = least ** (2 * r - 1)
        # The place of an extremum is where the next numerator vanishes to rounding.
        place = epsilon * terms[r] / (power * least)
        size = terms[r - 1] / power
        bounds[:, r] = 2.0 * (sway / power + (2 * r - 1) * slow * size) + place
    return bounds


@kinds.motion_values.register
def _(curve: TimedUniformBSpline, waypoints: Array, nodal: Array | None = None) -> Array:
    matrix = shape_matrix(curve.waypoints)
    return np.asarray(matrix @ (waypoints - waypoints[0]), dtype=np.float64)


@kinds.batch_peaks.register
def _(
    curve: TimedUniformBSpline, values: Array, durations: Array, wanted: NDArray[np.bool_]
) -> Array:
    h = np.ascontiguousarray(durations, dtype=np.float64)
    if h.ndim != 2 or h.shape[1] != curve.segments:
        raise TrajgapError(
            f"durations: a batch has shape (vectors, {curve.segments}), got {h.shape}"
        )
    peaks = np.empty((h.shape[0], values.shape[2], 3))
    nodes = np.ascontiguousarray(clock_matrix(curve.waypoints), dtype=np.float64)
    timed_kernel.batch_peaks(h, values, nodes, wanted, peaks)
    return peaks


@kinds.value_gradients.register
def _(
    curve: TimedUniformBSpline,
    waypoints: Array,
    durations: Array,
    points: Sequence[Extremum],
    nodal: Array | None = None,
) -> PeakGradients:
    """By complex steps: every number is a rational function of durations and way-points."""
    matrix = shape_matrix(curve.waypoints).astype(np.float64)
    nodes = clock_matrix(curve.waypoints).astype(np.float64)
    scaled, clock = matrix @ waypoints, nodes @ durations
    by_duration = np.empty((len(points), curve.segments))
    by_waypoint = np.empty((len(points), curve.waypoints))
    for i, e in enumerate(points):
        q, t = scaled[e.segment, :, e.joint], clock[e.segment]
        steps = t + 1e-30j * nodes[e.segment].T
        by_duration[i] = _value(q, steps, e).imag / 1e-30
        # The numerators are linear in q.
        by_waypoint[i] = _value(matrix[e.segment].T, t, e)
    return PeakGradients(by_duration, by_waypoint, np.empty((len(points), 0)))


def _value(q: Numbers, t: Numbers, e: Extremum) -> Numbers:
    """Derivatives at the place of an extremum, for coefficients along the last axis."""
    if e.order == 0:
        return _valued(q, e.s)
    n = numerators(q, t, e.order)[-1]
    return np.asarray(_valued(n, e.s) / _valued(_derived(t), e.s) ** (2 * e.order - 1))


@kinds.smooth_order.register
def _(curve: TimedUniformBSpline, break_index: int) -> int:
    return 2
