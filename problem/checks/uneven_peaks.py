"""Peaks of derivatives against limits whose lower and upper sides differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..curves import Extremum, Furthest, Trajectory, furthest
from ..limits import Limits


@dataclass(frozen=True)
class SidePeak:
    """The extremum of a derivative that comes nearest to, or furthest beyond, one of its limits.

    Attributes
    ----------
    size : float
        Size of the limit on its side.
    ratio : float
        What lies on that side over the limit; 0 if no value lies on a limited side.
    error : float
        Bound on the rounding error of the value such that no value on either side goes further
        beyond its limit than ``ratio + error/size``.
    """

    extremum: Extremum
    size: float
    ratio: float
    error: float


def uneven_peaks(limits: Limits, trajectory: Trajectory, error: Array) -> list[SidePeak]:
    """The deciding peak of each limited derivative, by joint, then by order.

    Parameters
    ----------
    error : ndarray, shape (pieces, 4, joints)
        Bound on the error of any extremum on a piece.
    """
    sides = limits.sides
    limited = np.isfinite(sides)
    peaks = []
    orders = np.flatnonzero(limited.any(axis=(0, 1))).tolist()
    reach = {r: furthest(trajectory, r + 1, error[:, r + 1]) for r in orders}
    for j, r in np.argwhere(limited.any(axis=0)).tolist():
        found = [
            _of_side(trajectory, reach[r], side, j, float(sides[side, j, r]), error[:, r + 1])
            for side in (0, 1)
            if limited[side, j, r]
        ]
        # What is not a number decides, as the checker cannot.
        worst = max(found, key=lambda p: np.inf if np.isnan(p.ratio) else p.ratio)
        slack = max(p.error / p.size if p.size else 0.0 for p in found)
        bound = max(worst.error, slack * worst.size)
        peaks.append(SidePeak(worst.extremum, worst.size, worst.ratio, bound))
    return peaks


def _of_side(
    trajectory: Trajectory, reach: Furthest, side: int, j: int, size: float, errors: Array
) -> SidePeak:
    """The furthest extremum to one side, with the bound on where the true one lies."""
    best, sign = reach.at(trajectory, side, j), (-1.0, 1.0)[side]
    top = sign * best.value
    bound = max(float(errors[best.segment, j]), sign * float(reach.outer[side, j]) - top)
    if size == 0.0:
        return SidePeak(best, size, 0.0 if top <= bound else np.inf, bound)
    return SidePeak(best, size, float(np.maximum(0.0, top)) / size, bound)
