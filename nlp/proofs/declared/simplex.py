"""Many small linear programs at once: the weights under which the sum of limits is largest."""

from __future__ import annotations

import numpy as np

from ....problem import Array

_EXACT = 1e-12
"""A gain below it is none: values are about 1."""
_PIVOT = 1e-10
"""An entry below it is not a pivot, for the same reason."""
_TURNS = 12
"""Pivots for each row of a program, after which the weights found so far are taken."""


def best_weights(
    values: Array, slopes: Array, spare: Array, lean: Array, signed: bool
) -> tuple[Array, Array, Array]:
    """Maximise Σ w value + τ spare − Σ_k |Σ w slope_k + τ lean_k| over w ≥ 0 with Σ w = 1, and τ.

    Parameters
    ----------
    values : ndarray, shape (box, row)
    slopes : ndarray, shape (box, row, segment)
    spare : ndarray, shape (box,)
    lean : ndarray, shape (box, segment)
    signed : bool
        Whether τ may be negative.

    Returns
    -------
    most : ndarray, shape (box,)
    weights : ndarray, shape (box, row)
    tau : ndarray, shape (box,)
    """
    boxes, count, n = slopes.shape
    wide = count + 2 + 2 * n
    table = np.zeros((boxes, n + 2, wide + 1))
    above, below = count + 2, count + 2 + n
    table[:, :n, :count] = np.swapaxes(slopes, 1, 2)
    table[:, :n, count], table[:, :n, count + 1] = lean, -lean
    each = np.arange(n)
    table[:, each, above + each], table[:, each, below + each] = -1.0, 1.0
    table[:, n, :count] = table[:, n, wide] = 1.0
    cost = np.full((boxes, wide), -1.0)
    cost[:, :count], cost[:, count] = values, spare
    cost[:, count + 1] = -spare if signed else -np.inf
    first = np.argmax(values - np.abs(slopes).sum(axis=2), axis=1)
    box = np.arange(boxes)
    table[:, :n] -= table[box, :n, first][:, :, None] * table[:, n : n + 1]
    turned = table[:, :n, wide] < 0.0
    table[:, :n] *= np.where(turned, -1.0, 1.0)[:, :, None]
    basis = np.empty((boxes, n + 1), np.int64)
    basis[:, :n], basis[:, n] = np.where(turned, above, below) + each, first
    held = np.take_along_axis(cost, basis, axis=1)
    table[:, n + 1, :wide] = cost
    table[:, n + 1] -= np.einsum("lq,lqc->lc", held, table[:, : n + 1])
    table[:, n + 1, count + 1] = -np.inf if not signed else table[:, n + 1, count + 1]
    done_table, done_basis = table, basis
    active = box
    for _ in range(_TURNS * (n + 1)):
        gain = table[:, n + 1, :wide]
        enter = gain.argmax(axis=1)
        at = np.arange(len(active))
        column = table[at, :, enter]
        usable = column[:, : n + 1] > _PIVOT
        ratio = np.where(
            usable, table[:, : n + 1, wide] / np.where(usable, column[:, : n + 1], 1.0), np.inf
        )
        leave = ratio.argmin(axis=1)
        going = (gain[at, enter] > _EXACT) & usable.any(axis=1)
        if not going.all():
            done_table[active[~going], :, wide] = table[~going][:, :, wide]
            done_basis[active[~going]] = basis[~going]
            if not going.any():
                active = active[:0]
                break
            table, basis, active = table[going], basis[going], active[going]
            enter, leave, column = enter[going], leave[going], column[going]
            at = np.arange(len(active))
        row = table[at, leave] / column[at, leave][:, None]
        column[at, leave] = 0.0
        table[at, leave] = row
        table -= column[:, :, None] * row[:, None, :]
        basis[at, leave] = enter
    done_table[active, :, wide] = table[:, :, wide] if len(active) else done_table[active, :, wide]
    done_basis[active] = basis if len(active) else done_basis[active]
    most = -done_table[:, n + 1, wide]
    found = np.zeros((boxes, wide))
    np.put_along_axis(found, done_basis, done_table[:, : n + 1, wide], axis=1)
    return most, np.maximum(found[:, :count], 0.0), found[:, count] - found[:, count + 1]
