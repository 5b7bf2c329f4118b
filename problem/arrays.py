"""The one alias for arrays of float64: shapes and units stand in each docstring."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Angles, times and limits inside the house, rad and s; (way-point, joint), batches lead."""


def over_rows(largest: np.ufunc, a: NDArray[np.floating], fold: int = 64) -> NDArray[np.floating]:
    """The least or the largest of each column, over rows of few columns.

    By default 64 rows are reduced side by side: seven columns alone take ten times as long.
    """
    rows = len(a) // fold * fold
    if rows == 0:
        return np.asarray(largest.reduce(a, axis=0))
    folded = largest.reduce(a[:rows].reshape(-1, fold * a.shape[1]), axis=0)
    return np.asarray(largest.reduce(np.concatenate([folded.reshape(fold, -1), a[rows:]]), axis=0))
