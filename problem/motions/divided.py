"""Divided differences of samples, and what they prove of a derivative, towards both sides."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .motion import EPS, ROUNDED_UP
from .samples import Samples

_TOGETHER = 1 << 14
"""Windows that are looked at together: a dozen arrays of that length stay in a core's own cache."""


def divided_extremes(
    times: Array, values: Array, order: int, stride: int, noise: Array, clock: float = 0.0
) -> tuple[Array, Array]:
    """The windows of samples that prove most of a derivative of each joint.

    A window is ``order`` + 1 samples, ``stride`` apart. By plain array operations, one after the
    other as they stand: compiled loops have the same bits, and take longer to load than this runs.

    **Bounds.** The true samples are at times t* and have values q* with |t* − t| ≤ τ and
    |q* − q| ≤ ε, where τ and ε hold the stated noise and the rounding to float64. With
    D = (b − a)/H for the difference of two divided differences over the time H between their
    outer samples, and Δa, Δb, ΔH = τ + τ' what these may be off by, D* H* = b* − a* gives

        (D* − D) H* = (b* − b) − (a* − a) − D (H* − H),
        |D* − D| ≤ (Δa + Δb + |D| ΔH) / (H − ΔH),

    level by level, from Δ = ε. Where ΔH reaches H, the order of two samples is not known, and
    nothing is bounded. For exact times the bound is the sum of the weights of the divided
    difference times ε, for their signs alternate: noise can do no less.

    Parameters
    ----------
    times : ndarray, shape (samples,)
        s, increasing; more than ``order * stride`` of them.
    values : ndarray, shape (samples, joints)
    noise : ndarray, shape (joints,)
        What the values of each joint may be off by.
    clock : float
        What the times may be off by, s.

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
            spans = _spans([times[at] for at in sites], clock)
            middle = 0.5 * (times[sites[0]] + times[sites[-1]])
            for j in range(joints):
                value, error = _differences([values[at, j] for at in sites], spans, float(noise[j]))
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


def neighbours(samples: Samples, order: int) -> tuple[Array, Array, Array]:
    """What neighbouring samples prove about a derivative, from the highest one in every row.

    Parameters
    ----------
    order : int
        0 to 3.

    Returns
    -------
    times : ndarray, shape (windows,)
        Middles of the windows, s; none if the samples are too few.
    values, errors : ndarray, shape (windows, joints)
        Every motion through the samples has such a value in the window, or jumps across it.
    """
    given = max(r for r in range(min(order, 2) + 1) if samples.has(r).all())
    values = samples.given(given)
    assert values is not None
    count = max(0, samples.time.size - (order - given))
    sites = [slice(m, m + count) for m in range(order - given + 1)]
    times = [samples.time[at] for at in sites]
    noise = samples.doubt(given).tolist()
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        spans = _spans(times, samples.clock) if count else []
        found = [
            _differences([values[at, j] for at in sites], spans, noise[j])
            for j in range(values.shape[1] if count else 0)
        ]
    if not count:
        none = np.empty((0, values.shape[1]))
        return np.empty(0), none, none
    middles = 0.5 * (times[0] + times[-1])
    return middles, np.column_stack([v for v, _ in found]), np.column_stack([e for _, e in found])


Span = tuple[Array, Array, Array]
"""Time between two samples, what it may be off by, and the least that it can be."""


def _spans(times: list[Array], clock: float) -> list[list[Span]]:
    """For each level of the divided differences the times that they are divided by."""
    off = [clock + EPS * np.abs(t) for t in times]
    levels = []
    for level in range(1, len(times)):
        spans = []
        for m in range(len(times) - level):
            span = times[m + level] - times[m]
            # A product and a quotient round the difference too, by less than this.
            error = off[m] + off[m + level] + 4 * EPS * span
            least = span - error
            # Where the order of two samples is not known nothing is bounded.
            spans.append((span, error, np.where(least > 0.0, least, 0.0)))
        levels.append(spans)
    return levels


def _differences(values: list[Array], spans: list[list[Span]], noise: float) -> tuple[Array, Array]:
    """Divided differences of one joint times the factorial of their order, and their errors."""
    found = values
    errors = [noise + EPS * np.abs(one) for one in values]
    factorial = 1.0
    for level, spans_here in enumerate(spans, 1):
        factorial *= level
        differences, bounds = [], []
        for m, (span, off, least) in enumerate(spans_here):
            one = (found[m + 1] - found[m]) / span
            differences.append(one)
            bounds.append(ROUNDED_UP * (errors[m] + errors[m + 1] + np.abs(one) * off) / least)
        found, errors = differences, bounds
    return factorial * found[0], ROUNDED_UP * factorial * errors[0]
