"""A piece of a path by arc length, on a grid graded at standstills and refined at sharp turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...problem import Array
from .path import PathPiece, SegmentPart

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
"""Gauss–Legendre of 6 nodes: exact for degree 11, so a cell's arc length is, to rounding."""
_TABLE, _REFINEMENTS = 256, 4
"""Points of a stretch's first table, and rounds in which points move to where the path turns."""


@dataclass(frozen=True, eq=False)
class SampledPath:
    """One piece by arc length on a grid.

    Attributes
    ----------
    s : ndarray, shape (points,)
        Arc length, rad.
    position : ndarray, shape (points, joints)
        rad.
    tangent : ndarray, shape (points, joints)
        q′ = dq/ds.
    before, after : ndarray, shape (points, joints)
        q″ = d²q/ds², 1/rad, from the left and from the right: it jumps where acceleration does.
    speed : ndarray, shape (points,)
        The trajectory's own path speed, rad/s.
    duration : float
        How long the trajectory takes, s.
    """

    s: Array
    position: Array
    tangent: Array
    before: Array
    after: Array
    speed: Array
    duration: float

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Which joints move at all on this piece; the limits of the others say nothing."""
        return np.asarray(np.abs(self.tangent).max(axis=0) > 1e-12)

    def end_speeds(
        self, given: tuple[float | None, float | None] = (None, None)
    ) -> tuple[float, float]:
        """Path speeds at the two ends, rad/s: what is given, else the trajectory's own."""
        first, last = given
        return (
            float(self.speed[0]) if first is None else first,
            float(self.speed[-1]) if last is None else last,
        )


@dataclass(frozen=True, eq=False)
class Measure:
    """For each stretch of a piece a table of u, and of the measure in which grids are uniform."""

    u: tuple[Array, ...]
    tau: tuple[Array, ...]


def measure(piece: PathPiece) -> Measure:
    """The measure τ of a piece in which every grid is uniform.

    It is the mean of three: graded arc length (s ~ τ³ at a rest end, where q″ grows like
    s^(−2/3) if only jerk is non-zero there), the trajectory's time, and the angle by which the
    path turns, so a near-reversal gets its share of points however short it is.
    """
    tables = [np.linspace(0.0, 1.0, _TABLE) for _ in piece.stretches]
    for refinement in range(_REFINEMENTS):
        arcs, turns, times = [], [], []
        arc = turn = 0.0
        for one, u in zip(piece.stretches, tables, strict=True):
            chord = np.linalg.norm(np.diff(one.tangent(u), axis=0), axis=1)
            angle = 2.0 * np.arcsin(np.minimum(1.0, chord / 2.0))
            arcs.append(arc + np.concatenate([[0.0], np.cumsum(_lengths(one, u))]))
            turns.append(turn + np.concatenate([[0.0], np.cumsum(angle)]))
            times.append((one.start - piece.start + u * one.duration) / piece.duration)
            arc, turn = float(arcs[-1][-1]), float(turns[-1][-1])
        tau = [
            (_ungraded(s / arc, piece.rest) + t + theta) / (2.0 + turn)
            for s, t, theta in zip(arcs, times, turns, strict=True)
        ]
        if refinement < _REFINEMENTS - 1:
            for i, (u, own) in enumerate(zip(tables, tau, strict=True)):
                count = 2 + int(2 * _TABLE * (own[-1] - own[0]))
                finer = np.interp(np.linspace(own[0], own[-1], count), own, u)
                tables[i] = np.unique(np.concatenate([np.linspace(0.0, 1.0, _TABLE // 4), finer]))
    return Measure(tuple(tables), tuple(tau))


def sample(piece: PathPiece, graded: Measure, cells: int) -> SampledPath:
    """Arc length, tangent and curvature of a piece on a grid.

    Parameters
    ----------
    piece : PathPiece
    graded : Measure
        Of that piece.
    cells : int
        About the number of cells of a piece of up to five segments; longer ones take more in
        proportion. Every break of the trajectory is a grid point.

    Returns
    -------
    SampledPath
    """
    cells = round(cells * max(1.0, len(piece.stretches) / 5))
    shares = np.array([tau[-1] - tau[0] for tau in graded.tau])
    counts = np.maximum(1, np.round(cells * shares / shares.sum()).astype(int))
    parts = []
    length = 0.0
    for one, table, tau, count in zip(piece.stretches, graded.u, graded.tau, counts, strict=True):
        u = np.interp(np.linspace(tau[0], tau[-1], count + 1), tau, table)
        u[0], u[-1] = 0.0, 1.0
        s = length + np.concatenate([[0.0], np.cumsum(_lengths(one, u))])
        # Points too close for TOPPRA's linear programs go; the ends of the stretch stay.
        keep = np.concatenate([np.diff(s) > 1e-13 * s[-1], [True]])
        keep[0] = True
        u, s = u[keep], s[keep]
        length = float(s[-1])
        speed = np.where((one.rest[0] & (u == 0.0)) | (one.rest[1] & (u == 1.0)), 0.0, one.speed(u))
        parts.append((s, one.tangent(u), speed, one.curvature(u), one.derivative(u, 0)))
    last = parts[-1]

    def joined(i: int) -> Array:
        return np.concatenate([*[part[i][:-1] for part in parts], last[i][-1:]])

    return SampledPath(
        s=joined(0),
        position=joined(4),
        tangent=joined(1),
        before=np.concatenate([parts[0][3][:1], *[part[3][1:] for part in parts]]),
        after=joined(3),
        speed=joined(2),
        duration=piece.duration,
    )


def _lengths(stretch: SegmentPart, u: Array) -> Array:
    """Arc length of each cell of ``u``, rad, by Gauss quadrature."""
    half = np.diff(u) / 2
    nodes = (u[:-1] + half)[:, None] + half[:, None] * _NODES
    speed = stretch.speed(nodes.ravel()).reshape(nodes.shape)
    return np.asarray(stretch.duration * half * (speed @ _WEIGHTS), dtype=np.float64)


def _ungraded(share: Array, rest: tuple[bool, bool]) -> Array:
    """The τ in [0, 1] at which a graded grid reaches a share of the arc length."""
    tau = np.linspace(0.0, 1.0, 4001)
    if rest == (True, True):
        graded = tau**3 * (10 - 15 * tau + 6 * tau**2)
    elif rest[0]:
        graded = tau**3
    elif rest[1]:
        graded = 1.0 - (1.0 - tau) ** 3
    else:
        return share
    return np.interp(share, graded, tau)
