"""C4 quintic splines over boxes of durations, by the arithmetic of their verifier."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ....verify import MOST_WEIGHT, QUINTIC_PLACES
from ..declared import Curves, Leaf, Middle, NearLimits
from .windows import excluding_windows

_SPARE = 1e-9
"""Part of the limits by which a leaf must exceed them, so another evaluation agrees."""
_PARTS = 8
"""Of a segment: twice as many as its velocity has peaks; with 12 as many boxes were left."""
_NODAL = np.array([1, 1, 2, 2])
"""Powers of its duration with the velocities and accelerations at the ends of a segment."""
_SLIGHT = 1e-5
"""Weights below it are left out: all sum up to 1, and short leaves are cheap."""


class QuinticCurves(Curves):
    """Windows exclude boxes where no spline is looked at."""

    widest = 1.38  # (high − low)/(high + low) < 0.6

    def __init__(self, kind: Any) -> None:
        limits = kind.task.limits
        caps = np.full((2, len(limits), 4), np.inf)
        caps[:, :, 1:] = limits
        super().__init__(kind, NearLimits(len(kind.task.steps), 6, caps, QUINTIC_PLACES, _PARTS))

    def middle(self, sides: Array) -> Middle:
        """At the harmonic means, where the verifier has its centres."""
        centre = self.kind.centre(sides)
        h, (n, joints), basis = 1.0 / centre.r, self.kind.task.steps.shape, self.kind.task.basis
        # The spline itself, then its change with each 1/h times −1/h.
        slope = -centre.slope / h[:, None, :, None]
        nodes = np.concatenate([centre.x0[:, :, None], slope], axis=2)
        own = centre.parted(nodes.reshape(len(h), joints * (1 + n), -1))
        own = own * (h[:, :, None] ** _NODAL)[:, :, None]
        own, each = own.reshape(len(h), n, joints, 1 + n, 4), np.arange(n)
        own[:, each, :, 1 + each] += np.swapaxes(own[:, :, :, 0], 0, 1) * _NODAL
        found = own @ basis[1:]
        found[:, :, :, 0] += self.kind.task.steps[:, :, None] * basis[0]
        pieces, moved = np.swapaxes(found[:, :, :, 0], 2, 3), found[:, :, :, 1:]
        return Middle(centre, h, centre.e * h, pieces, moved.transpose(0, 3, 1, 4, 2))

    def without_limits(self, low: Array, high: Array) -> list[Leaf | None]:
        """By a window: its number, τ, and a mark that tells it from other leaves."""
        which, tau = excluding_windows(self.kind, low, high)
        both = zip(which.tolist(), tau.tolist(), strict=True)
        return [None if f < 0 else (f, t, "window") for f, t in both]

    def proved(
        self, middle: Middle, rows: NDArray[np.int64], weights: Array, tau: Array
    ) -> tuple[NDArray[np.bool_], Array, Array, Array]:
        """By limits times powers of r = 1/h, with weights of at most 2²⁰."""
        order, box = rows[..., 2], np.arange(len(tau))[:, None]
        norm = self.kind.task.cap(rows) * middle.centre.r[box, rows[..., 0]] ** (2.0 - order)
        share = np.where(weights > _SLIGHT, weights / norm, 0.0)
        tau = tau / self.kind.most
        scale = np.minimum(2.0**20 / share.max(axis=1), MOST_WEIGHT / np.maximum(abs(tau), 1e-300))
        share, tau = np.rint(share * scale[:, None]), np.rint(tau * scale)
        norm = np.where(share > 0.0, norm, 0.0)
        least = middle.centre.least(tau, rows, share)
        excluded = least > _SPARE * (share * norm).sum(axis=1)
        blame = np.where(np.isfinite(middle.centre.blame), middle.centre.blame, 1.0)
        return excluded, tau, share, np.maximum(blame, 1e-300)
