"""What the NLP is told of a curve and its limits: pieces, what durations do to them, and rows.

Declared curves and B-splines with knots in time are pieces with conditions at their breaks; the
derivatives at left ends are variables. Curves of a fixed shape in a parameter have constants in
their place, and only their time depends on the durations: linearly, or by a clock.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, ClampedBSpline, Interpolant, Problem, TrajgapError, as_piecewise
from ...problem.curves import (
    Places,
    TimedUniformBSpline,
    Trajectory,
    average_matrix,
    fractions_of,
    numerators,
    piecewise,
    splines_of,
)

Indices = NDArray[np.int64]


class _Casadi:
    """Stands for the module. A lazily loaded one would be loaded by whatever lists all modules."""

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module("casadi"), name)


ca: Any = _Casadi()
"""CasADi, imported where an NLP is built: small problems need none, and it takes a while."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Limits inside pieces, a row of the table each.

    Attributes
    ----------
    table : ndarray, shape (rows, 6)
        Joint, piece, order, place in 0..1, side of the limit, and Newton weight w: the place moves
        by −w f′, f the derivative as a function of the place, up to `program.REACH`.
    """

    table: Array

    @property
    def places(self) -> Places:
        """Where they are."""
        joint, segment, order = self.table[:, :3].T.astype(np.int64)
        return Places(joint, segment, order, self.table[:, 3])

    @property
    def sign(self) -> Array:
        """Sides of the limits."""
        return self.table[:, 4]

    @property
    def weight(self) -> Array:
        """Newton weights; 0 of a place that stays."""
        return self.table[:, 5]


class Sides:
    """Limits of derivatives in units of order one, as shares of the larger side.

    Attributes
    ----------
    scale : ndarray, shape (joints, orders)
        The larger side; inf if nothing is limited.
    low, high : ndarray, shape (joints, orders)
        Both sides in shares of it: −1 and 1 where they are equal.
    """

    def __init__(self, problem: Problem, unit: float, angle: Array) -> None:
        sides = problem.limits.sides
        self.orders = np.arange(1, 1 + sides.shape[2])
        below, above = sides * unit**self.orders / angle[:, None]
        positive = [np.where(np.isfinite(side), side, 0.0) for side in (below, above)]
        scale = np.maximum(*positive)
        # A derivative that must not leave 0 to a side has no size to take; standing still keeps it.
        moves = np.ptp(problem.waypoints, axis=0)[:, None] > 0.0
        limited = (scale > 0.0) | (moves & ((below == 0.0) | (above == 0.0)))
        size = np.where(scale > 0.0, scale, 1.0)
        self.scale = np.where(limited, size, np.inf)
        self.low = np.where(limited, -below / size, -np.inf)
        self.high = np.where(limited, above / size, np.inf)


@dataclass(frozen=True, eq=False)
class CurvePieces:
    """The pieces of a curve through the way-points of a problem.

    Attributes
    ----------
    degrees : ndarray of int, shape (pieces,)
    declared : Interpolant or None
        The conditions at breaks; None for a curve of a fixed shape.
    widths : ndarray, shape (groups, pieces, segments), or None
        Durations of the pieces as combinations of those of the segments, one group for all joints
        or one for each; None where pieces are segments.
    scaled : ndarray, shape (pieces, powers, joints), or None
        The fixed shape, rad, in the pieces' own 0..1.
    clock : ndarray, shape (pieces, powers, segments), or None
        Coefficients of time in the pieces' own 0..1 as combinations of the durations, where it is
        not linear.
    passed : tuple of int
        Way-points that lie inside pieces and are passed at their times.
    """

    degrees: Indices
    declared: Interpolant | None = None
    widths: Array | None = None
    scaled: Array | None = None
    clock: Array | None = None
    passed: tuple[int, ...] = ()

    def smooth(self, order: int) -> NDArray[np.bool_]:
        """Whether a derivative is continuous at each right end; nowhere at the last one."""
        if self.declared is None:
            inner = np.full(self.degrees.size - 1, self.clock is not None and order <= 2)
        else:
            inner = np.array(self.declared.continuity, dtype=np.int64) >= order
        return np.append(inner, False)

    def own_places(self, trajectory: Trajectory, places: Places) -> tuple[Places, Array]:
        """Places of a motion in each joint's own pieces, and how many times as wide these are."""
        if self.widths is None or len(self.widths) == 1:
            return places, np.ones(places.s.size)
        breaks, total = trajectory.breaks, float(trajectory.breaks[-1])
        width = np.diff(breaks)[places.segment]
        time = breaks[places.segment] + places.s * width
        own, s, wider = np.empty_like(places.segment), np.empty(time.size), np.empty(time.size)
        for j, of_joint in enumerate(self.widths):
            # Where joints have knots of their own these are shares of the total.
            knots = total * np.append(0.0, np.cumsum(of_joint[:, 0]))
            i = np.flatnonzero(places.joint == j)
            own[i] = k = np.clip(np.searchsorted(knots, time[i], "right") - 1, 0, knots.size - 2)
            each = np.diff(knots)[k]
            s[i], wider[i] = (time[i] - knots[k]) / each, each / width[i]
        return Places(places.joint, own, places.order, s), wider


def pieces_of(problem: Problem) -> CurvePieces:
    """The pieces of a problem's curve.

    Raises
    ------
    TrajgapError
        If the kind of curve gives the NLP nothing to work with.
    """
    curve, q = problem.curve, problem.waypoints
    declared = as_piecewise(curve)
    if declared is not None:
        return CurvePieces(np.array(declared.degrees, dtype=np.int64), declared)
    shape = curve.shape(q)
    if shape is not None:
        widths = np.zeros((1, shape.share.size, curve.segments))
        widths[0, np.arange(shape.share.size), shape.segment] = shape.share
        degrees = np.full(shape.share.size, shape.degree)
        return CurvePieces(degrees, widths=widths, scaled=shape.scaled)
    if isinstance(curve, TimedUniformBSpline):
        scaled = curve.motion_values(q)
        scaled[:, 0] += q[0]
        # N_r has two powers more than the derivative of a polynomial of degree 3.
        degrees = np.full(curve.segments, 5)
        return CurvePieces(degrees, scaled=scaled, clock=curve.clock.astype(np.float64))
    if isinstance(curve, ClampedBSpline):
        return _between_knots(curve, q)
    raise TrajgapError(f"curve: no NLP is known for {curve.name}; use another curve")


def _between_knots(curve: ClampedBSpline, waypoints: Array) -> CurvePieces:
    """A spline with breaks at its knots, which are linear in the durations."""
    p, n, count = curve.degree, curve.segments, curve.inner_knots + 1
    times, average = np.tri(n + 1, n, -1), average_matrix(curve)
    fractions = fractions_of(curve, waypoints)
    inner = [average @ times]
    if fractions is not None:
        inner = [np.outer(average @ np.array(row), np.ones(n)) for row in fractions]
    ends = np.zeros((1, n)), np.ones((1, n))
    widths = np.array([np.diff(np.vstack([ends[0], k, ends[1]]), axis=0) for k in inner])
    rest = tuple((order, 0.0) for order in curve.end_orders)
    declared = piecewise((p,) * count, p - 1, rest, virtual=tuple(range(1, count)))
    return CurvePieces(np.full(count, p), declared, widths, passed=tuple(range(1, n)))


def left_derivatives(
    pieces: CurvePieces, problem: Problem, motion: Trajectory, durations: Array
) -> Array:
    """Derivatives in time at the left ends of the pieces of a motion, (pieces, orders, joints).

    The pieces have conditions; durations are those of the segments, s.
    """
    factorials = np.cumprod([1.0, *range(1, int(pieces.degrees.max()) + 1)])[:, None]
    if pieces.widths is None:
        rates = motion.durations[:, None, None] ** np.arange(factorials.size)[:, None]
        return np.asarray(motion.scaled[:, : factorials.size] * factorials / rates)
    assert isinstance(problem.curve, ClampedBSpline)
    found = []
    for spline in splines_of(problem.curve, problem.waypoints, durations):
        rates = spline.lengths[:, None, None] ** np.arange(factorials.size)[:, None]
        found.append(spline.scaled / rates)
    return np.concatenate(found, axis=2) * factorials


class Clock:
    """Derivatives in time of a curve q(s) with a clock t(s), N_r over t′²ʳ⁻¹, as expressions.

    The nodes are those of `CurvePieces.clock`, and the coefficients of q (pieces, powers, joints).
    """

    def __init__(self, nodes: Array, scaled: Array, durations: Any) -> None:
        self._scaled = scaled
        self._t = [ca.mtimes(ca.DM(at), durations) for at in nodes.transpose(1, 0, 2)]

    def motion(self, k: Indices, j: Indices) -> tuple[Any, Any]:
        """Derivatives in time and dt/ds of pieces and their joints, as functions of the place."""
        q, t = (np.empty(len(self._t), dtype=object) for _ in range(2))
        for m, coefficients in enumerate(self._t):
            q[m], t[m] = ca.MX(ca.DM(self._scaled[k, m, j])), coefficients[k.tolist()]
        every, rate = [q, *numerators(q, t, 5)], t[1:] * np.arange(1, t.size)

        def speed(s: Any) -> Any:
            return _evaluated(rate, s)

        def value(order: int, s: Any) -> Any:
            return _evaluated(every[order], s) / speed(s) ** (max(0, 2 * order - 1))

        return value, speed

    def speeds(self) -> Any:
        """dt/ds at both ends of all pieces."""
        rates = [m * t for m, t in enumerate(self._t)][1:]
        return ca.vertcat(rates[0], sum(rates))


def _evaluated(a: Any, s: Any) -> Any:
    """Value at ``s`` by Horner's scheme, ascending coefficients."""
    value: Any = 0
    for coefficient in a[::-1]:
        value = value * s + coefficient
    return value


def clocked_bend(trajectory: Any, places: Places) -> Array:
    """Second derivatives by s of derivatives in time, N_{r+1}′ over t′²ʳ where these turn."""
    every = [trajectory.derivatives(0), *trajectory.numerators]
    out, k, power = np.zeros(places.s.size), places.segment, np.polynomial.polynomial
    for i, (j, r, s) in enumerate(zip(places.joint, places.order, places.s, strict=True)):
        speed = power.polyval(s, power.polyder(trajectory.clock[k[i]]))
        slope = power.polyval(s, power.polyder(every[r + 1][:, k[i], j]))
        out[i] = slope / speed ** (2 * r)
    return out
