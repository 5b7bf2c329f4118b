"""Divided differences of samples, and what they prove of a derivative, towards both sides."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

_EPS = 2.0**-52
"""Spacing of float64 at 1."""
_TOGETHER = 1 << 14
"""Windows that are looked at together: a dozen arrays of that length stay in a core's own cache."""


def divided_extremes(
    times: Array, values: Array, order: int, stride: int, noise: Array
) -> tuple[Array, Array]:
    """The windows of samples that prove most of a derivative of each joint.

    A window is ``order`` + 1 samples, ``stride`` apart. By plain array operations, one after the
    other as they stand: compiled loops have the same bits, and take longer to load than this runs.

    Parameters
    ----------
    times : ndarray, shape (samples,)
        s, increasing; more than ``order * stride`` of them.
    values : ndarray, shape (samples, joints)
    order, stride : int
    noise : ndarray, shape (joints,)
        What the values of each joint may be off by.

    Returns
    -------
    found : ndarray, shape (joints, 2, 3)
        For the smallest and the largest proof: ``order``! times the divided difference, the bound
        of its error, and the middle of its window; zeros where no window has finite numbers.
    widest : ndarray, shape (joints,)
        The largest error of all windows.
    """
    joints = values.shape[1]
    found, widest = np.zeros((joints, 2, 3)), np.zeros(joints)
    sure = np.tile([np.inf, -np.inf], (joints, 1))
    count = times.size - order * stride
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for first in range(0, count, _TOGETHER):
            last = min(first + _TOGETHER, count)
            sites = [slice(first + m * stride, last + m * stride) for m in range(order + 1)]
            weights, factor = _weights([times[at] for at in sites])
            middle = 0.5 * (times[sites[0]] + times[sites[-1]])
            for j in range(joints):
                value, error = _differences(
                    [values[at, j] for at in sites], weights, factor, float(noise[j])
                )
                widest[j] = np.fmax(widest[j], np.fmax.reduce(error))
                for side, proof in enumerate((value + error, value - error)):
                    # The first of several; what is no number proves nothing.
                    wrong = np.isnan(proof)
                    if wrong.any():
                        proof[wrong] = (np.inf, -np.inf)[side]
                    k = int(proof.argmax() if side else proof.argmin())
                    if proof[k] > sure[j, side] if side else proof[k] < sure[j, side]:
                        sure[j, side] = proof[k]
                        found[j, side] = value[k], error[k], middle[k]
    return found, widest


def _weights(times: list[Array]) -> tuple[list[Array], Array]:
    """Weights of each sample in ``order``! times the divided difference, and of its rounding."""
    order = len(times) - 1
    factorial = 1.0
    for m in range(2, order + 1):
        factorial *= m
    clock = np.zeros(times[0].size)
    weights = []
    for m, here in enumerate(times):
        weight = np.full(here.size, factorial)
        for n, other in enumerate(times):
            if n != m:
                step = here - other
                weight /= step
                # Both times carry the rounding of their digits.
                np.fmax(clock, _EPS * (np.abs(here) + np.abs(other)) / np.abs(step), out=clock)
        weights.append(weight)
    return weights, 16 * _EPS + 1.25 * order * clock


def _differences(
    values: list[Array], weights: list[Array], factor: Array, noise: float
) -> tuple[Array, Array]:
    """The divided differences of one joint, and bounds of their errors."""
    first, order = values[0], len(values) - 1
    value, error, sizes = (np.zeros(first.size) for _ in range(3))
    for there, weight in zip(values, weights, strict=True):
        # Differences from the first value: the weights of a divided difference sum to 0.
        term = weight * (there - first) if order else there
        value += term
        sizes += np.abs(term)
        error += np.abs(weight) * (noise + _EPS * np.abs(there))
    error += factor * sizes
    return value, error
