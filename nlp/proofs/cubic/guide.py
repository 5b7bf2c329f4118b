"""What the optimum of a relaxation tells: which side to halve, which velocities to look at."""

from __future__ import annotations

import numpy as np

from ....problem import Array
from .ranges import matrices
from .relaxation import BoxProgram, Proposal
from .system import PLACES, CubicRow, CubicSystem

_TINY = 1e-9
"""Stands for a span of 0 in a quotient: spans are of order 1 in the units of a system."""
_EXCESS = 1.001
"""A peak counts where it exceeds its limit by this factor."""


def errors(program: BoxProgram, proposal: Proposal) -> Array:
    """How far the products of each coordinate are from being products, shape (free,)."""
    system = program.relaxation.system
    out = np.zeros(system.coordinates)
    scale = np.maximum(np.abs(proposal.unknowns).max(axis=1, initial=0.0), 1e-9)
    for p, (k, i) in enumerate(program.relaxation.pairs):
        miss = np.abs(proposal.products[:, p] - proposal.point[k] * proposal.unknowns[:, i])
        out[k] += float((miss / scale).sum())
    for h, _, rho in system.curved:
        out[h] += out[rho]
    return out[: system.free]


def peaks(system: CubicSystem, point: Array) -> list[CubicRow]:
    """Velocity conditions at the interior peaks of the splines for some durations.

    On a piece the acceleration runs from a to b in a line, and is 0 at the share s = a/(a − b); the
    velocity there is v₀ + length·(a(s − s²/2) + b s²/2).

    Parameters
    ----------
    system : CubicSystem
    point : ndarray, shape (free,)

    Returns
    -------
    list of CubicRow
        Where a limit is exceeded; empty if the durations determine no spline.
    """
    fixed, linear, steps, which = matrices(system)
    m, n = system.spans, system.pieces
    y = np.append(point, [point[h] ** 2 / max(point[t], _TINY) for h, t, _ in system.curved])
    right = np.zeros((system.unknowns, system.joints))
    for t in np.flatnonzero(which >= 0).tolist():
        right[which[t]] = steps.mid[t] / max(point[t], _TINY)
    try:
        x = np.linalg.solve(fixed + np.tensordot(y, linear, 1), right)
    except np.linalg.LinAlgError:
        return []
    found = []
    for j, (velocity, _, _) in enumerate(system.limits):
        for t in range(m if velocity is not None else 0):
            rough = system.virtual and t in (0, m - 1)
            if rough:
                near, far, h = (1, 2, m) if t == 0 else (n - 1, n - 2, m + 1)
                a, b, length = x[near, j], x[far, j], y[t] - y[h]
                speed = a * y[h] / 2
            else:
                a, b, length = x[system.breaks[t], j], x[system.breaks[t + 1], j], y[t]
                speed = x[system.speed(t), j]
            if not a * b < 0:
                continue
            place = round(a / (a - b) * PLACES)
            s = place / PLACES
            value = speed + length * (a * (s - s * s / 2) + b * s * s / 2)
            if abs(value) > _EXCESS * float(velocity or 0):
                found.append(CubicRow("velocity", j, t, 1 if value > 0 else -1, place))
    return found
