"""The path of a trajectory, cut into pieces wherever all joints stand still."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...problem import Array, Trajectory, extrema

STANDSTILL = 1e-5
"""Joint speeds below this share of the segment's highest count as standing still.

Exact standstills lie at 1e-12; a turn taken at a speed in between is sharper than TOPPRA's linear
programs resolve, and stopping there costs less than this share of the time."""


@dataclass(frozen=True, eq=False)
class SegmentPart:
    """The part of one segment that lies in one piece, over u in [0, 1].

    Attributes
    ----------
    left, right : ndarray, shape (powers, joints)
        Ascending coefficients in u, and in 1 − u: near either end every derivative then keeps
        its relative accuracy, however slow the motion is there.
    start, duration : float
        When it begins on the trajectory, and how long it lasts there, s.
    rest : tuple of bool
        Whether all joints stand still at its two ends.
    """

    left: Array
    right: Array
    start: float
    duration: float
    rest: tuple[bool, bool]

    def derivative(self, u: Array, order: int) -> Array:
        """Time derivative at ``u``, shape (points, joints)."""
        early = _value(self.left, u, order)
        late = (-1.0) ** order * _value(self.right, 1.0 - u, order)
        return np.asarray(np.where((u <= 0.5)[:, None], early, late) / self.duration**order)

    def speed(self, u: Array) -> Array:
        """Path speed |dq/dt| at ``u``, rad/s, shape (points,)."""
        return np.asarray(np.linalg.norm(self.derivative(u, 1), axis=1))

    def tangent(self, u: Array) -> Array:
        """Unit tangent q′ at ``u``, shape (points, joints); at a standstill its limit."""
        v = self.derivative(u, 1)
        for at, coefficients, rest, sign in (
            (0.0, self.left, self.rest[0], 1.0),
            (1.0, self.right, self.rest[1], -1.0),
        ):
            if rest:
                first = next(m for m in range(1, len(coefficients)) if coefficients[m].any())
                v[u == at] = sign * coefficients[first]
        return np.asarray(v / np.linalg.norm(v, axis=1)[:, None])

    def curvature(self, u: Array) -> Array:
        """Second derivative q″ by arc length at ``u``, 1/rad, shape (points, joints).

        At a standstill, where it may be infinite, it is given as 0: it only ever stands in the
        product with a path speed that is 0.
        """
        tangent, acceleration = self.tangent(u), self.derivative(u, 2)
        still = (self.rest[0] & (u == 0.0)) | (self.rest[1] & (u == 1.0))
        square = np.where(still, 1.0, self.speed(u) ** 2)
        normal = acceleration - tangent * (acceleration * tangent).sum(axis=1)[:, None]
        return np.asarray(np.where(still[:, None], 0.0, normal / square[:, None]))


@dataclass(frozen=True, eq=False)
class PathPiece:
    """The motion from one standstill, or end of the trajectory, to the next."""

    stretches: tuple[SegmentPart, ...]

    @property
    def start(self) -> float:
        """When the piece begins on the trajectory, s."""
        return self.stretches[0].start

    @property
    def duration(self) -> float:
        """How long the trajectory takes for it, s."""
        return sum(one.duration for one in self.stretches)

    @property
    def rest(self) -> tuple[bool, bool]:
        """Whether it begins and ends at a standstill."""
        return self.stretches[0].rest[0], self.stretches[-1].rest[1]


def jump(trajectory: Trajectory) -> str | None:
    """Say where position or velocity jumps, or None if both are continuous."""
    span = float(np.abs(trajectory.scaled[:, 1:]).sum(axis=1).max(initial=0.0))
    top = float(segment_speeds(trajectory).max())
    for b in range(1, trajectory.durations.size):
        for order, name, size in ((0, "position", span), (1, "velocity", top)):
            for j in range(trajectory.joints):
                left = float(trajectory.derivative(b - 1, j, order).sum())
                step = float(trajectory.derivative(b, j, order)[0]) - left
                if abs(step) > 1e-9 * size + 1e-15 * abs(left):
                    return f"the {name} of joint {j + 1} jumps by {step:.3g} at break {b}"
    return None


def segment_speeds(trajectory: Trajectory) -> Array:
    """Largest |velocity| of any joint in each segment, rad/s."""
    speeds = np.zeros(trajectory.durations.size)
    for j in range(trajectory.joints):
        for e in extrema(trajectory, j, 1):
            speeds[e.segment] = max(speeds[e.segment], abs(e.value))
    return speeds


def pieces(trajectory: Trajectory) -> tuple[tuple[PathPiece, ...], tuple[float, ...]]:
    """Cut a trajectory wherever all joints stand still.

    Standstills are the common roots of the joints' velocities. A root at which a velocity changes
    sign is a turning point of that position, a root at which it does not is a turning point of
    the velocity; all of those are known exactly, so nothing is sampled.

    Returns
    -------
    pieces : tuple of PathPiece
        In order. Segments in which nothing moves are left out.
    cuts : tuple of float
        Times of the standstills, s, those at the ends included.
    """
    tops = segment_speeds(trajectory)
    places = _standstills(trajectory, STANDSTILL * tops)
    groups: list[list[SegmentPart]] = [[]]
    cuts: list[float] = []
    for k, begin in enumerate(trajectory.breaks[:-1]):
        h = float(trajectory.durations[k])
        a = trajectory.scaled[k, : trajectory.degrees[k] + 1]
        # What moves by less than this share of what the fastest speed covers stands still.
        if np.abs(a[1:]).sum(axis=0).max() <= 1e-11 * tops.max() * h:
            cuts += [float(begin), float(begin + h)]
            groups.append([])
            continue
        still = places[k]
        cuts += [float(begin + s * h) for s in still]
        marks = sorted({0.0, *still, 1.0})
        for one, two in pairwise(marks):
            rest = (one in still, two in still)
            left = _expanded(a, one, two - one, rest[0])
            right = _expanded(a, two, one - two, rest[1])
            if rest[0]:
                groups.append([])
            groups[-1].append(
                SegmentPart(left, right, float(begin + one * h), (two - one) * h, rest)
            )
            if rest[1]:
                groups.append([])
    apart = 1e-6 * trajectory.total_time
    cuts = [t for i, t in enumerate(cuts) if i == 0 or t - cuts[i - 1] > apart]
    return tuple(PathPiece(tuple(group)) for group in groups if group), tuple(cuts)


def _value(c: Array, u: Array, order: int) -> Array:
    value = np.zeros((u.size, c.shape[1]))
    for p in range(len(c) - 1, order - 1, -1):
        value = value * u[:, None] + math.perm(p, order) * c[p]
    return value


def _expanded(a: Array, about: float, width: float, rest: bool) -> Array:
    """Coefficients in w of q(about + width·w); at a standstill the vanishing ones exactly 0."""
    size = len(a)
    b = np.empty_like(a)
    for m in range(size):
        binomials = np.array([math.comb(p, m) for p in range(m, size)])
        b[m] = width**m * (binomials * about ** np.arange(size - m)) @ a[m:]
    if rest:
        b[1] = 0.0
        scale = np.abs(b[1:]).max()
        for m in range(2, size):
            if np.abs(b[m]).max() > 1e-9 * scale:  # below it, rounding
                break
            b[m] = 0.0
    return b


def _standstills(trajectory: Trajectory, slow: Array) -> list[list[float]]:
    """Places in each segment, ends included, where no joint is faster than ``slow``."""
    segments = range(trajectory.durations.size)
    candidates = [{0.0, 1.0} for _ in segments]
    for j in range(trajectory.joints):
        for order in (0, 1):
            for e in extrema(trajectory, j, order):
                candidates[e.segment].add(e.s)
    found: list[list[float]] = []
    for k in segments:
        velocities = [trajectory.derivative(k, j, 1) for j in range(trajectory.joints)]
        places: list[float] = []
        group: list[tuple[bool, float, float]] = []
        for s in sorted(candidates[k]):
            speed = max(float(abs(np.polynomial.polynomial.polyval(s, v))) for v in velocities)
            if speed <= slow[k]:
                group.append((s not in (0.0, 1.0), speed, s))
            # Velocities are monotone between neighbours: slow at both means slow between them,
            # one standstill. An end of the segment stands for its group.
            if group and (speed > slow[k] or s == 1.0):
                places.append(min(group)[2])
                group = []
        found.append(places)
    return found
