"""Linear programs over the rows of one box: the least total, and the weights that prove it."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import hstack

from ....problem import Array
from .tangents import Floats, Ints, matrix

_EXACT = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""Options of HiGHS: the smallest tolerances that it takes, because its errors weaken the bound."""


def least_total(
    scaled: Floats, rows: Ints, low: Array, high: Array, target: float
) -> tuple[Array, Array] | None:
    """Least total over the rows in a box, by a linear program.

    Parameters
    ----------
    scaled : Floats
    rows : ndarray, shape (rows, 7)
    low, high : ndarray, shape (segments,)
        The box, scaled.
    target : float
        Where no durations keep the rows, the weights are large enough for this bound, scaled.

    Returns
    -------
    unknowns : ndarray
        Durations, then speeds at the way-points in C order, scaled.
    weights : ndarray, shape (rows,)
        Of the scaled rows, ≥ 0.
        None instead of both if the program fails.
    """
    left, right, size = matrix(scaled, rows, low, high)
    segments = len(low)
    top = np.tile(scaled.speed, (segments + 1, 1))
    ends = np.stack([-top, top], axis=2)
    for at, given in ((0, scaled.ends[0]), (-1, scaled.ends[1])):
        fixed = np.isfinite(given)
        ends[at, fixed] = given[fixed, None]
    bounds = np.concatenate([np.stack([low, high], axis=1), ends.reshape(-1, 2)])
    cost = np.concatenate([np.ones(segments), np.zeros(ends.shape[0] * ends.shape[1])])
    found = linprog(cost, A_ub=-left, b_ub=-right, bounds=bounds, method="highs-ds", options=_EXACT)
    if found.status == 0:
        return np.asarray(found.x), np.maximum(0.0, -found.ineqlin.marginals) / size
    if found.status != 2:
        return None
    # Infeasible: by how little may all rows be broken? The weights, times enough, prove it.
    wide = hstack([left, np.ones((len(rows), 1))], format="csr")
    found = linprog(
        np.append(0 * cost, 1.0),
        A_ub=-wide,
        b_ub=-right,
        bounds=np.concatenate([bounds, [[0.0, np.inf]]]),
        method="highs-ds",
        options=_EXACT,
    )
    if found.status != 0 or found.fun <= 0:
        return None
    # The multipliers w prove Σ w (right − left) ≥ fun all over the box. So factor·w prove the bound
    # Σ low + factor·fun, which is 2·target − Σ low with this factor.
    factor = 2 * (target - low.sum()) / found.fun
    weights = np.maximum(0.0, -found.ineqlin.marginals) / size
    return np.asarray(found.x[:-1]), weights * max(factor, 1.0)


def lower(scaled: Floats, rows: Ints, weights: Array, low: Array, high: Array) -> float:
    """What weights prove in a box: `rows.bound` in floats, scaled."""
    left, right, size = matrix(scaled, rows, low, high)
    push = weights * size
    rest = -(left.T @ push)
    times = 1.0 + rest[: len(low)]
    slopes = rest[len(low) :].reshape(len(low) + 1, -1)
    total = float(push @ right)
    total += float(np.where(times > 0, times * low, times * high).sum())
    worst = -np.abs(slopes) * scaled.speed
    for at, given in ((0, scaled.ends[0]), (-1, scaled.ends[1])):
        fixed = np.isfinite(given)
        worst[at, fixed] = slopes[at, fixed] * given[fixed]
    return total + float(worst.sum())
