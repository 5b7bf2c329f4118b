"""What the optimum of a relaxation tells: which side to halve, which velocities to look at."""

from __future__ import annotations

import numpy as np

from ....problem import Array
from ....verify import SPOTS
from .relaxation import BoxProgram, Proposal
from .system import CubicRow, CubicSystem


def errors(program: BoxProgram, proposal: Proposal) -> Array:
    """How far the products of each coordinate are from being products, shape (free,)."""
    exact = program.relaxation.system.exact
    out = np.zeros(exact.coordinates)
    scale = np.maximum(np.abs(proposal.unknowns).max(axis=1, initial=0.0), 1e-9)
    for p, (k, i) in enumerate(program.relaxation.pairs):
        miss = np.abs(proposal.products[:, p] - proposal.point[k] * proposal.unknowns[:, i])
        out[k] += float((miss / scale).sum())
    for h, _, rho in exact.rho:
        out[h] += out[rho]
    return out[: exact.free]


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
    exact = system.exact
    y = np.append(point, [point[h] ** 2 / max(point[t], 1e-9) for h, t, _ in exact.rho])
    right, spans = np.zeros((exact.size, exact.joints)), np.flatnonzero(system.moving)
    right[system.which[spans]] = system.steps[spans] / np.maximum(point[spans], 1e-9)[:, None]
    try:
        x = np.linalg.solve(system.fixed + np.tensordot(y, system.linear, 1), right)
    except np.linalg.LinAlgError:
        return []
    found = []
    for j, (velocity, _, _) in enumerate(exact.limits):
        for t in range(exact.m if velocity is not None else 0):
            rough = exact.rough.get(t)
            if rough is not None:
                near, far, h = rough
                a, b, length = x[near, j], x[far, j], y[t] - y[h]
                speed = a * y[h] / 2
            else:
                a, b, length = x[exact.breaks[t], j], x[exact.breaks[t + 1], j], y[t]
                speed = x[exact.n + 1 + t, j]
            if not a * b < 0:
                continue
            place = round(a / (a - b) * SPOTS)
            s = place / SPOTS
            value = speed + length * (a * (s - s * s / 2) + b * s * s / 2)
            if abs(value) > 1.001 * float(velocity or 0):
                found.append(CubicRow("velocity", j, t, 1 if value > 0 else -1, place))
    return found
