"""Conditions that every C1 motion meets, whatever the interpolant: closed form over any box.

For a motion at rest at both ends and any piecewise linear ψ, ∫ψ a = −∫ψ' v. With mean velocities
Δ_k/h_k weighted by c_k, Σ c_k Δ_k/h_k = ∫(c/h) v = ∫ψ a + ∫(c/h + ψ') v, hence

Σ c_k Δ_k/h_k ≤ A Σ m_k h_k + V Σ |c_k + ψ_k − ψ_{k−1}|

with m_k the mean of |ψ| on segment k. Every term depends on one duration alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from ....problem import Array
from ....verify import WINDOW_UNIT
from .energy import ROUNDING
from .nodal import compiled

_CELLS = 6
"""Of a segment in the linear program for ψ: it only proposes, the mean of |ψ| is exact later."""


def mean_size(psi: Array) -> Array:
    """Mean of |ψ| on each segment, ψ linear between its nodal values.

    (|a| + |b|)/2; where ψ changes its sign, two triangles: (a² + b²)/(2(|a| + |b|)).
    """
    a, b = np.abs(psi[:-1]), np.abs(psi[1:])
    both = a + b
    crossing = (a * a + b * b) / np.where(both > 0.0, 2.0 * both, 1.0)
    return np.asarray(np.where(psi[:-1] * psi[1:] >= 0.0, 0.5 * both, crossing), np.float64)


def window(
    steps: Array, durations: Array, velocity: float, acceleration: float
) -> tuple[Array, Array] | None:
    """ψ and c of the condition that is violated most at given durations, rounded; None if none.

    The largest Σ c_k Δ_k/h_k with A Σ m_k h_k + V Σ |c_k + ψ_k − ψ_{k−1}| = 1, a linear program if
    the mean m_k of |ψ| is taken over the middles of cells.

    Parameters
    ----------
    steps, durations : ndarray, shape (segments,)
        Of one joint, rad and s.
    velocity, acceleration : float
        Limits, rad/s and rad/s²; inf for none, not both.

    Returns
    -------
    tuple of ndarray, shapes (segments + 1,) and (segments,)
    """
    n = steps.size
    limited_a, limited_v = np.isfinite(acceleration), np.isfinite(velocity)
    middles = (np.arange(_CELLS) + 0.5) / _CELLS
    free, cells = 2 * n + 1, n * _CELLS
    size = free + cells + n  # ψ, c, |ψ| per cell, |c + ψ'h| per segment
    rows = []
    for k in range(n):
        for i, s in enumerate(middles):
            for sign in (1.0, -1.0):
                row = np.zeros(size)
                row[k], row[k + 1] = sign * (1.0 - s), sign * s
                row[free + k * _CELLS + i] = -1.0
                rows.append(row)
        for sign in (1.0, -1.0):
            row = np.zeros(size)
            row[n + 1 + k], row[k + 1], row[k] = sign, sign, -sign
            row[free + cells + k] = -1.0
            rows.append(row)
    price = np.zeros(size)
    price[free : free + cells] = acceleration * np.repeat(durations, _CELLS) / _CELLS
    price[free + cells :] = velocity
    upper = np.full(size, np.inf)
    if not limited_a:
        upper[free : free + cells] = 0.0
    if not limited_v:
        upper[free + cells :] = 0.0
    price[~np.isfinite(price)] = 0.0
    gain = np.zeros(size)
    gain[n + 1 : free] = -steps / durations
    bounds = [(None, None)] * free + [(0.0, u if u == 0.0 else None) for u in upper[free:]]
    found = linprog(
        gain, A_ub=np.array(rows), b_ub=np.zeros(len(rows)), A_eq=price[None, :], b_eq=[1.0],
        bounds=bounds, method="highs",
    )  # fmt: skip
    if found.status != 0:
        return None
    psi, weights = found.x[: n + 1], found.x[n + 1 : free]
    top = max(float(np.abs(psi).max()), float(np.abs(weights).max()))
    if not top > 0.0:
        return None
    # Dyadic numbers: the sums c + ψ' h are exact.
    psi = np.rint(psi / top * WINDOW_UNIT) / WINDOW_UNIT
    weights = np.rint(weights / top * WINDOW_UNIT) / WINDOW_UNIT
    if not limited_v:  # no limit pays for what is left between them
        weights = psi[:-1] - psi[1:]
    if not limited_a:
        psi = np.zeros(n + 1)
    return psi, weights


def window_terms(
    psi: Array, weights: Array, steps: Array, velocity: float, acceleration: float
) -> Array:
    """Condition as Σ_k (p_k/h_k − q_k h_k) − d ≤ 0: (p, q, d) in one array of 2·segments + 1."""
    left = np.abs(weights + psi[1:] - psi[:-1])
    d = velocity * left.sum() if left.any() else 0.0
    mean = mean_size(psi)
    q = acceleration * mean if mean.any() else np.zeros_like(mean)
    return np.concatenate([weights * steps, q, [d]])


@dataclass(frozen=True, eq=False)
class Windows:
    """Conditions on single joints.

    Attributes
    ----------
    joint : ndarray of int, shape (conditions,)
    psi : ndarray, shape (conditions, segments + 1)
    weights : ndarray, shape (conditions, segments)
    terms : ndarray, shape (conditions, 2·segments + 1)
        `window_terms` of each.
    """

    joint: NDArray[np.int64]
    psi: Array
    weights: Array
    terms: Array


def windows(
    steps: Array,
    limits: Array,
    durations: Array,
    directions: int = 50,
    deviation: float = 0.5,
    clock: Callable[[], None] = lambda: None,
) -> Windows:
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
        Called before each direction; may raise.

    Returns
    -------
    Windows
    """
    rng = np.random.default_rng(0)
    n, joints = steps.shape
    joint, psi, weights = [], [], []

    def add(j: int, bent: Array, mean: Array) -> None:
        joint.append(j)
        psi.append(bent)
        weights.append(mean)

    limited = [j for j in range(joints) if np.isfinite(limits[j, :2]).any() and steps[:, j].any()]
    for d in range(directions):
        clock()
        spread = deviation * rng.standard_normal(n) if d else np.zeros(n)
        direction = durations * np.exp(spread)
        direction *= durations.sum() / direction.sum()
        for j in limited:
            found = window(steps[:, j], direction, limits[j, 0], limits[j, 1])
            if found is not None:
                add(j, *found)
    for j in limited:
        for k in range(n if np.isfinite(limits[j, 0]) else 0):
            mean = np.zeros(n)
            mean[k] = np.sign(steps[k, j])
            add(j, np.zeros(n + 1), mean)
    terms = [
        window_terms(p, w, steps[:, j], limits[j, 0], limits[j, 1])
        for j, p, w in zip(joint, psi, weights, strict=True)
    ]
    return Windows(
        np.array(joint, np.int64),
        np.array(psi).reshape(-1, n + 1),
        np.array(weights).reshape(-1, n),
        np.array(terms).reshape(-1, 2 * n + 1),
    )


@compiled
def window_bound(n, terms, low, high, tau, total):  # type: ignore[no-untyped-def]
    """Lower bound of the condition's left side plus tau·(Σ h − total) over a box of durations."""
    value = -terms[2 * n] - tau * total
    absolute = abs(value) + 2.0 * abs(tau) * total
    for k in range(n):
        p, q = terms[k], tau - terms[n + k]
        if low[k] > 0.0:
            least = min(p / low[k] + q * low[k], p / high[k] + q * high[k])
        elif p >= 0.0:
            least = p / high[k] + min(q * high[k], 0.0)
        else:
            return -np.inf
        if p > 0.0 and q > 0.0:
            # p/h + q h ≥ 2√(p q), attained at √(p/q).
            turn, bottom = np.sqrt(p / q), 2.0 * np.sqrt(p * q) * (1.0 - 1e-12)
            if low[k] < turn < high[k]:
                least = bottom
            elif not low[k] > 0.0:
                least = p / high[k] + q * high[k]
        value += least
        absolute += abs(least) + (abs(tau) + terms[n + k]) * high[k]
    return value - 20.0 * ROUNDING * absolute


@compiled
def excluding_window(n, library, low, high, total):  # type: ignore[no-untyped-def]
    """Number and tau of a condition that the whole box violates; −1 if none is found.

    The four that are nearest to excluding the box are tried with multipliers of the total.
    """
    best = np.full(4, -np.inf)
    which = np.full(4, -1)
    for f in range(library.shape[0]):
        value = window_bound(n, library[f], low, high, 0.0, total)
        if value > 0.0:
            return f, 0.0
        # How far it is from excluding, relative to what it weighs.
        scale = library[f, 2 * n]
        for k in range(n):
            scale += library[f, n + k] * high[k]
        at = best.size - 1
        value /= scale
        if value <= best[at]:
            continue
        while at > 0 and best[at - 1] < value:
            best[at], which[at] = best[at - 1], which[at - 1]
            at -= 1
        best[at], which[at] = value, f
    for i in range(which.size):
        f = which[i]
        if f < 0:
            break
        for k in range(n):
            # d/dh (p/h + (tau − q)h) = 0 at the upper end of one duration.
            tau = library[f, n + k] + library[f, k] / (high[k] * high[k])
            for part in (1.0, 0.7):
                if tau > 0.0 and window_bound(n, library[f], low, high, part * tau, total) > 0.0:
                    return f, part * tau
    return -1, 0.0
