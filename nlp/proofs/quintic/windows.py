"""Conditions that every C1 motion meets, whatever the interpolant: closed form over any box.

For a motion at rest at both ends and any piecewise linear ψ, ∫ψ a = −∫ψ' v. With mean velocities
Δ_k/h_k weighted by c_k, Σ c_k Δ_k/h_k = ∫(c/h) v = ∫ψ a + ∫(c/h + ψ') v, hence

Σ c_k Δ_k/h_k ≤ A Σ m_k h_k + V Σ |c_k + ψ_k − ψ_{k−1}|

with m_k the mean of |ψ| on segment k. Every term depends on one duration alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ....verify import WINDOW_UNIT

_CELLS = 6
"""Of a segment in the linear program for ψ: it only proposes, the mean of |ψ| is exact later."""
_TOGETHER = 12
"""Linear programs in one: with more the solver is slower, with fewer what stands around it."""
_TRIED = 4
"""Windows that are tried on a box with multipliers of the total: the nearest to excluding it."""
_FAR = 0.25
"""Share of what it weighs by which a window may miss a box without τ: with τ few did by more."""
_TURNS = (1.0, 0.7)
"""Shares of the multiplier at which a term is least at the upper end of its duration."""


def _conditions(n: int) -> Array:
    """Rows ≤ 0 in ψ, c, sizes of ψ in cells, and |c + ψ' h| in segments: absolute values."""
    free, cells = 2 * n + 1, n * _CELLS
    middles = np.tile((np.arange(_CELLS) + 0.5) / _CELLS, n)
    k, of = np.repeat(np.arange(n), _CELLS), np.arange(cells)
    sides = np.zeros((cells + n, free + cells + n))
    sides[of, k], sides[of, k + 1] = 1.0 - middles, middles
    each = np.arange(n)
    sides[cells + each, n + 1 + each] = sides[cells + each, each + 1] = 1.0
    sides[cells + each, each] = -1.0
    sizes = np.eye(cells + n, free + cells + n, free)
    return np.concatenate([sides - sizes, -sides - sizes])


def window(steps: Array, durations: Array, limits: Array) -> list[list[int]]:
    """ψ and c of the conditions of each joint that are violated most at given durations.

    The largest Σ c_k Δ_k/h_k with A Σ m_k h_k + V Σ |c_k + ψ_k − ψ_{k−1}| = 1, a linear program if
    the mean m_k of |ψ| is taken over the middles of cells.

    Parameters
    ----------
    steps : ndarray, shape (segments, joints)
        rad.
    durations : ndarray, shape (segments, joints)
        s; of a joint that comes twice they may differ.
    limits : ndarray, shape (joints, 2)
        Of velocity and acceleration, rad/s and rad/s²; inf for none, not both.

    Returns
    -------
    list of list of int
        The segments + 1 numbers ψ, then the segments numbers c, in units of 1/`WINDOW_UNIT`; empty
        for a joint that has none.
    """
    # Processes that search boxes need none of it: it takes longer to import than all the rest.
    from scipy.optimize import linprog
    from scipy.sparse import block_diag, eye_array, kron

    n, joints = steps.shape
    rows = _conditions(n)
    free, limited = 2 * n + 1, np.isfinite(limits)
    pay = np.where(limited, limits, 0.0)
    cells = pay[:, 1:] * np.repeat(durations.T, _CELLS, axis=1) / _CELLS
    still = np.repeat(pay[:, :1], n, axis=1)
    price = np.concatenate([np.zeros((joints, free)), cells, still], axis=1)
    top = np.full(price.shape, np.inf)
    top[:, free : free + cells.shape[1]][~limited[:, 1]] = 0.0
    top[:, free + cells.shape[1] :][~limited[:, 0]] = 0.0
    gain = np.zeros_like(price)
    gain[:, n + 1 : free] = -(steps / durations).T
    low = np.where(np.arange(price.shape[1]) < free, -np.inf, np.zeros_like(price))
    solved = linprog(
        gain.ravel(),
        A_ub=kron(eye_array(joints), rows, "csr"),
        b_ub=np.zeros(joints * len(rows)),
        A_eq=block_diag(list(price[:, None]), "csr"),
        b_eq=np.ones(joints),
        bounds=np.stack([low.ravel(), top.ravel()], axis=1),
        method="highs",
    )
    if solved.status != 0:
        return [[]] * joints
    found = []
    for x, (limited_v, limited_a) in zip(
        solved.x.reshape(joints, -1)[:, :free], limited, strict=True
    ):
        largest = np.abs(x).max()
        whole = np.rint(x / largest * WINDOW_UNIT) if largest > 0.0 else np.zeros(free)
        psi, weights = np.split(whole.astype(int), [n + 1])
        if not limited_v:  # no limit pays for what is left between them
            weights = psi[:-1] - psi[1:]
        found.append([*(psi if limited_a else 0 * psi).tolist(), *weights.tolist()])
    return [one if any(one) else [] for one in found]


def windows(
    steps: Array,
    limits: Array,
    durations: Array,
    directions: int = 50,
    deviation: float = 0.5,
    clock: Callable[[], None] = lambda: None,
) -> list[list[int]]:
    """Conditions that are violated at random directions, and the mean velocities.

    Parameters
    ----------
    steps : ndarray, shape (segments, joints)
    limits : ndarray, shape (joints, 3)
        inf for none.
    durations : ndarray, shape (segments,)
        The directions spread around it.
    directions : int
    deviation : float
        Of their log durations: within a factor of about e of the answer's.
    clock : callable, optional
        Called now and then; may raise.

    Returns
    -------
    list of list of int
        Joint, ψ and c, as a certificate states them.
    """
    rng = np.random.default_rng(0)
    n, joints = steps.shape
    library: list[list[int]] = []
    limited = [j for j in range(joints) if np.isfinite(limits[j, :2]).any() and steps[:, j].any()]
    asked: list[tuple[int, Array]] = []
    for d in range(directions):
        spread = deviation * rng.standard_normal(n) if d else np.zeros(n)
        direction = durations * np.exp(spread)
        asked += [(j, direction * durations.sum() / direction.sum()) for j in limited]
    for at in range(0, len(asked), _TOGETHER):
        clock()
        which, near = zip(*asked[at : at + _TOGETHER], strict=True)
        own = list(which)
        found = window(steps[:, own], np.stack(near, axis=1), limits[own, :2])
        library += [[j, *one] for j, one in zip(own, found, strict=True) if one]
    for j in limited:
        for k in range(n if np.isfinite(limits[j, 0]) else 0):
            mean = np.zeros(n, int)
            mean[k] = np.sign(steps[k, j]) * WINDOW_UNIT
            library.append([j, *[0] * (n + 1), *mean.tolist()])
    return library


def excluding_windows(kind: Any, low: Array, high: Array) -> tuple[NDArray[np.int64], Array]:
    """For each box a window of its verifier that excludes it, or −1, and its τ."""
    p, pay, fixed = kind.windows
    which, taus = np.full(len(low), -1), np.zeros(len(low))
    if not len(fixed):
        return which, taus
    # How far each is from excluding a box, relative to what it weighs there.
    weight = high @ pay.T + fixed
    near = ((1.0 / high) @ p.T - weight) / weight
    tried = np.flatnonzero(near.max(axis=1) > -_FAR)
    low, high, near = low[tried], high[tried], near[tried]
    count, boxes = min(_TRIED, len(fixed)), np.arange(len(tried))
    best = np.argpartition(-near, count - 1, axis=1)[:, :count]
    # d/dh (p/h + (τ − q)h) = 0 at the upper end of one duration.
    turned = pay[best] + p[best] / (high * high)[:, None]
    turns = [np.zeros((*best.shape, 1)), *(share * turned for share in _TURNS)]
    tau = np.maximum(0.0, np.concatenate(turns, axis=2))
    sides = (np.broadcast_to(x[:, None, None], (*tau.shape, x.shape[1])) for x in (low, high))
    least = kind.over_windows(np.broadcast_to(best[:, :, None], tau.shape), tau, *sides)
    flat = np.nan_to_num(least, nan=-np.inf).reshape(len(low), tau.shape[1] * tau.shape[2])
    top = flat.argmax(axis=1)
    excluded = flat[boxes, top] > 0.0
    which[tried[excluded]] = best[boxes, top // tau.shape[2]][excluded]
    taus[tried[excluded]] = tau.reshape(flat.shape)[boxes, top][excluded]
    return which, taus
