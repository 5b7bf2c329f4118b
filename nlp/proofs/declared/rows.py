"""Limits that a box may lean on: where the curve at its centre comes nearest to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....problem import Array

_GRID = 12
"""Parts of a piece between whose ends peaks are looked for: more than a polynomial of the degrees
of this field has."""
_NEWTON = 3
"""Steps to a peak from the best place of the grid: each doubles the digits, and two are right."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """Limits with the largest values at the centres of boxes.

    Attributes
    ----------
    rows : ndarray of int, shape (box, row, 5)
        Segment, joint, order, sign, place.
    values : ndarray, shape (box, row)
        By what share of the limit it is exceeded there; −inf if there are fewer limits.
    slopes : ndarray, shape (box, row, segment)
        Its change with the logarithm of each duration.
    """

    rows: NDArray[np.int64]
    values: Array
    slopes: Array


class NearLimits:
    """What all boxes have in common.

    Parameters
    ----------
    segments, powers : int
        Pieces, and coefficients of each.
    caps : ndarray, shape (2, joints, 4)
        Limits of orders 0 to 3 on the lower and the upper side; inf if there is none.
    places : int
        Of a piece, in which places are counted.
    parts : int, optional
        Of a piece, between whose ends peaks are looked for.
    """

    def __init__(
        self, segments: int, powers: int, caps: Array, places: int, parts: int = _GRID
    ) -> None:
        self.places, self.parts, self._caps = places, parts, caps
        self.count = 4 * (segments + 1) + 8
        self.grid = np.rint(np.arange(parts + 1) * (places / parts)).astype(np.int64)
        side, joint, order = np.nonzero(np.isfinite(caps))
        limits = np.stack([joint, order, 2 * side - 1], axis=1)
        limits = limits[np.lexsort((side, order, joint))]
        self.rows = np.concatenate(
            [np.repeat(np.arange(segments), len(limits))[:, None], np.tile(limits, (segments, 1))],
            axis=1,
        )
        self._factors = np.ones((6, powers))
        for r in range(5):
            self._factors[r + 1] = self._factors[r] * np.maximum(np.arange(powers) - r, 0)
        each = np.repeat(self.rows[:, None], parts + 1, axis=1)
        at = np.broadcast_to(self.grid[:, None], (len(self.rows), parts + 1, 1))
        self.shapes = self._shapes(np.concatenate([each, at], axis=2))

    def _cap(self, rows: NDArray[np.int64]) -> Array:
        return np.asarray(self._caps[(1 + rows[..., 3]) // 2, rows[..., 1], rows[..., 2]])

    def _shapes(self, rows: NDArray[np.int64]) -> Array:
        """Sign times the derivative of each power at the place: (..., power)."""
        s, order = rows[..., 4] / self.places, rows[..., 2]
        power = np.ones((*s.shape, self._factors.shape[1]))
        for p in range(1, power.shape[-1]):
            # The power of s that is left of sᵖ.
            power[..., p] = np.where(p > order, power[..., p - 1] * s, 1.0)
        return np.asarray(rows[..., 3, None] * self._factors[order] * power)

    def candidates(self, h: Array, pieces: Array, moved: Array) -> Candidates:
        """The limits that are nearest to being exceeded, or exceeded most.

        Parameters
        ----------
        h : ndarray, shape (box, segment)
            Durations at the centre.
        pieces : ndarray, shape (box, segment, power, joint)
            The curve there, in the share of a segment.
        moved : ndarray, shape (box, segment, segment, power, joint)
            Its change with the logarithm of each duration, which is the first axis.
        """
        segment, joint, order, _ = self.rows.T
        size = self._cap(self.rows) * (h[:, :, None] ** np.arange(4))[:, segment, order]
        own = pieces[:, segment, :, joint]  # (row, box, power)
        found, far = own @ np.swapaxes(self.shapes, 1, 2), order == 0
        found /= np.where(far, 1.0, size).T[:, :, None]
        found[far] = found[far] - size.T[far][:, :, None] + 1
        rises, no = found[:, :, 1:] > found[:, :, :-1], np.full((*found.shape[:2], 1), False)
        beside = np.concatenate([no, ~rises], axis=2) | np.concatenate([rises, no], axis=2)
        found[beside] = -np.inf  # all but peaks
        flat = np.swapaxes(found, 0, 1).reshape(len(h), -1)
        count = min(self.count, flat.shape[1])
        best = np.argpartition(-flat, count - 1, axis=1)[:, :count]
        box = np.arange(len(h))[:, None]
        there = np.isfinite(flat[box, best])
        which, spot = best // len(self.grid), self.grid[best % len(self.grid)]
        rows = np.concatenate([self.rows[which], spot[:, :, None]], axis=2)
        coefficients = own[which, box]
        rows[..., 4] = self._peaks(rows, coefficients)
        shape, high = self._shapes(rows), rows[..., 2] > 0
        size = size[box, which]
        value = (shape * coefficients).sum(axis=2)
        value = np.where(high, value / size - 1.0, value - size)
        shape *= np.where(high, 1.0 / size, 1.0)[:, :, None]
        turned = moved.transpose(0, 2, 4, 1, 3)[box, rows[..., 0], rows[..., 1]]
        slopes = (turned @ shape[..., None])[..., 0]
        slopes[box, np.arange(count), rows[..., 0]] -= rows[..., 2]
        return Candidates(rows, np.where(there, value, -np.inf), slopes)

    def _peaks(self, rows: NDArray[np.int64], coefficients: Array) -> NDArray[np.int64]:
        """Places of the peaks next to those of the grid."""
        first, order = rows[..., 4] / self.places, rows[..., 2]
        wide = 1.0 / self.parts
        low, high = np.maximum(first - wide, 0.0), np.minimum(first + wide, 1.0)
        signed = coefficients * rows[..., 3, None]
        rise, bend = signed * self._factors[order + 1], signed * self._factors[order + 2]
        s = first
        for _ in range(_NEWTON):
            up, bent = np.zeros_like(s), np.zeros_like(s)
            for p in range(coefficients.shape[-1] - 1, 0, -1):
                # From the highest power on: those above the derivative's own order.
                up = np.where(p > order, up * s + rise[..., p], up)
                bent = np.where(p > order + 1, bent * s + bend[..., p], bent)
            falls = bent < 0.0
            newton = s - up / np.where(falls, bent, 1.0)
            s = np.clip(np.where(falls, newton, np.where(up > 0.0, high, low)), low, high)
        return np.asarray(np.rint(s * self.places), dtype=np.int64)
