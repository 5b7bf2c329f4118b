"""Limits that a box may lean on: where the curve at its centre comes nearest to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

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
        By what share of the limit it is exceeded there; −inf where there are fewer limits.
    slopes : ndarray, shape (box, row, segment)
        Its change with the logarithm of each duration.
    """

    rows: NDArray[np.int64]
    values: Array
    slopes: Array


class NearLimits:
    """What all boxes have in common, from the verifier's `Task`.

    Parameters
    ----------
    task : Task
    places : int
        Of a piece, in which places are counted.
    """

    def __init__(self, task: Any, places: int) -> None:
        self.task, self.places = task, places
        n = task.segments
        self.count = 4 * (n + 1) + 8
        orders = [r for r in range(4) if np.isfinite(task.caps[:, :, r]).any()]
        grid = np.rint(np.arange(_GRID + 1) * (places / _GRID)).astype(np.int64)
        self.grid = grid
        sides = [(r, s) for r in orders for s in (0, 1)]
        self.rows = np.array(
            [
                [k, j, r, 2 * s - 1]
                for k in range(n)
                for j in range(task.joints)
                for r, s in sides
                if np.isfinite(task.caps[s, j, r])
            ],
            np.int64,
        ).reshape(-1, 4)
        each = np.broadcast_to(self.rows[:, None], (len(self.rows), _GRID + 1, 4))
        at = np.broadcast_to(grid[:, None], (len(self.rows), _GRID + 1, 1))
        self.caps = task.cap(np.concatenate([each, at], axis=2)[:, 0])
        self.shapes = task.shapes(np.concatenate([each, at], axis=2), float(places))

    def candidates(self, centre: Any) -> Candidates:
        """The limits that are nearest to being exceeded, or exceeded most."""
        task, form = self.task, self.task.form
        boxes = len(centre.h)
        pieces = form.fixed + np.einsum("kpx,lxj->lkpj", form.basis, centre.x)
        segment, joint, order, _ = self.rows.T
        own = pieces[:, segment, :, joint]  # (row, box, power)
        found = np.einsum("rbp,rgp->brg", own, self.shapes)
        size = self._size(order, self.caps, centre.h[:, segment])
        found = np.where(order[:, None] > 0, found / size[:, :, None], found - size[:, :, None] + 1)
        peak = np.full(found.shape, True)
        peak[:, :, 1:] &= found[:, :, 1:] > found[:, :, :-1]
        peak[:, :, :-1] &= found[:, :, :-1] >= found[:, :, 1:]
        flat = np.where(peak, found, -np.inf).reshape(boxes, -1)
        count = min(self.count, flat.shape[1])
        if count == flat.shape[1]:
            best = np.broadcast_to(np.arange(count), (boxes, count))
        else:
            best = np.argpartition(-flat, count - 1, axis=1)[:, :count]
        box = np.arange(boxes)[:, None]
        there = np.isfinite(flat[box, best])
        which, spot = best // (_GRID + 1), self.grid[best % (_GRID + 1)]
        rows = np.concatenate([self.rows[which], spot[:, :, None]], axis=2)
        coefficients = own[which, box]
        rows[..., 4] = self._peaks(rows, coefficients)
        shape = task.shapes(rows, float(self.places))
        size = size[box, which]
        high = rows[..., 2] > 0
        value = (shape * coefficients).sum(axis=2)
        value = np.where(high, value / size - 1.0, value - size)
        scale = np.where(high, 1.0 / size, 1.0)
        phi = np.einsum("lcp,lcpx->lcx", shape * scale[:, :, None], form.basis[rows[..., 0]])
        turn = -(phi @ centre.y) * np.swapaxes(centre.g, 1, 2)[box, rows[..., 1]] * task.half
        slopes = (turn @ task.at) @ task.across
        np.add.at(slopes, (box, np.arange(count)[None], rows[..., 0]), -1.0 * rows[..., 2])
        return Candidates(rows, np.where(there, value, -np.inf), slopes)

    @staticmethod
    def _size(order: NDArray[np.int64], cap: Array, h: Array) -> Array:
        power = np.ones_like(h)
        for r in (1, 2, 3):
            power = np.where(order >= r, power * h, power)
        return np.asarray(cap * power)

    def _peaks(self, rows: NDArray[np.int64], coefficients: Array) -> NDArray[np.int64]:
        """Places of the peaks next to those of the grid."""
        first = rows[..., 4] / self.places
        wide = 1.0 / _GRID
        low, high = np.maximum(first - wide, 0.0), np.minimum(first + wide, 1.0)
        powers = np.arange(coefficients.shape[-1])
        order, sign = rows[..., 2], rows[..., 3]
        factor = np.ones(coefficients.shape)
        for r in range(5):
            # (s^p) differentiated order + 1 times, then once more.
            factor = np.where(r <= order[..., None], factor * np.maximum(powers - r, 0), factor)
        left = powers - order[..., None] - 1
        one = factor * coefficients * sign[..., None]
        two = one * np.maximum(left, 0)
        s = first
        for _ in range(_NEWTON):
            power = np.where(left >= 0, s[..., None] ** np.maximum(left, 0), 0.0)
            rise = (one * power).sum(axis=-1)
            power = np.where(left >= 1, s[..., None] ** np.maximum(left - 1, 0), 0.0)
            bend = (two * power).sum(axis=-1)
            bent = bend < 0.0
            newton = s - rise / np.where(bent, bend, 1.0)
            s = np.clip(np.where(bent, newton, np.where(rise > 0.0, high, low)), low, high)
        return np.asarray(np.rint(s * self.places), dtype=np.int64)
