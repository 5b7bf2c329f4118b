"""The one alias for arrays of float64: shapes and units stand in each docstring."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Angles, times and limits inside the house, rad and s; (way-point, joint), batches lead."""
_FOLD = 64
"""Rows that are reduced side by side: seven columns alone take ten times as long."""


def over_rows(largest: np.ufunc, a: NDArray[np.floating]) -> NDArray[np.floating]:
    """The least or the largest of each column, over rows of few columns."""
    rows = len(a) // _FOLD * _FOLD
    if rows == 0:
        return np.asarray(largest.reduce(a, axis=0))
    folded = largest.reduce(a[:rows].reshape(-1, _FOLD * a.shape[1]), axis=0)
    return np.asarray(largest.reduce(np.concatenate([folded.reshape(_FOLD, -1), a[rows:]]), axis=0))
