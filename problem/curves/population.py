"""True peaks of declared curves for whole populations, by the compiled kernel."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ..arrays import Array
from .condition import Layout
from .kind import Asked
from .polynomials import PERM

_PART = 1000
"""Polynomials (vectors times joints) of a thread's part: starting threads for fewer than four parts
costs more than it saves."""


def batch_reach(layout: Layout, values: Array, durations: Array, asked: Asked) -> Array:
    """`Curve.batch_reach` of a declared curve.

    Parameters
    ----------
    layout : Layout
    values : ndarray, shape (rows, joints)
        What the conditions give, positions counted from the first way-point.
    durations, asked
        As `Curve.batch_reach` takes them.

    Returns
    -------
    ndarray, shape (batch, sides, joints, orders)
        rad/sᵒʳᵈᵉʳ; the same bits whatever the order, the size or the threads.
    """
    from . import kernel

    vectors, joints = len(durations), values.shape[1]
    peaks = asked.room(vectors)
    rows, sides = layout.rows, np.array(asked.sides)

    def run(first: int, last: int) -> None:
        part = durations[first:last], values, *rows, PERM
        kernel.batch_peaks(*part, asked.wanted, asked.least, sides, peaks[first:last])

    parts = vectors * joints // _PART
    if parts < 4:
        run(0, vectors)
        return peaks
    workers = os.cpu_count() or 1
    cuts = np.linspace(0, vectors, min(2 * workers, parts) + 1).astype(int).tolist()
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, cuts[:-1], cuts[1:]))
    return peaks
