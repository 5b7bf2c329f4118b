"""The motion through samples under a stated interpolation, with bounds on noise and rounding."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..curves import PERM
from ..errors import TrajgapError
from .digits import HalfUnits
from .motion import EPS, ROUNDED_UP, Motion
from .samples import Interpolation, Samples
from .through_spline import not_a_knot_spline

_BASIS = {
    1: [[1, 0], [0, 1]],
    3: [[1, 0, 0, 0], [0, 0, 1, 0], [0, 3, -2, -1], [0, -2, 1, 1]],
    5: [
        [1, 0, 0, 0, 0, 0],
        [0, 0, 1, 0, 0, 0],
        [0, 0, 0, 0, 0.5, 0],
        [0, 10, -6, -4, -1.5, 0.5],
        [0, -15, 8, 7, 1.5, -1],
        [0, 6, -3, -3, -0.5, 0.5],
    ],
}
"""Coefficients in s of each degree, from the position at the start, the way, and hv and h²a at both
ends: the columns in this order."""


def interpolated(samples: Samples, how: Interpolation) -> Motion:
    """The motion through samples under a stated interpolation.

    Parameters
    ----------
    how : Interpolation
        Any but ``none``.

    Returns
    -------
    Motion
        With bounds on the effect of noise and rounding.

    Raises
    ------
    TrajgapError
        If the interpolation needs a derivative that is not given.
    """
    if how is Interpolation.NONE:
        raise TrajgapError("interpolation: 'none' is not a motion; check_samples judges samples")
    if how is Interpolation.SPLINE:
        return not_a_knot_spline(samples)
    velocities, accelerations = samples.has(1), samples.has(2)
    pairs = samples.time.size - 1
    both = [velocities[1:] & velocities[:-1], accelerations[1:] & accelerations[:-1]]
    if how is Interpolation.CONTROLLER:
        if (both[1] & ~both[0]).any():
            k = int(np.argmax(both[1] & ~both[0]))
            raise TrajgapError(
                f"points {k + 1} and {k + 2}: accelerations without velocities; give velocities too"
            )
        degree = np.where(both[0], np.where(both[1], 5, 3), 1)
        # The controller is given these very numbers, however they were rounded before.
        samples = replace(samples, rounding=HalfUnits())
    else:
        degree = np.full(pairs, {"linear": 1, "cubic": 3, "quintic": 5}[how])
        for order, word, least in ((1, "velocity", 3), (2, "acceleration", 5)):
            missing = (degree >= least) & ~both[order - 1]
            if missing.any():
                first = int(np.argmax(~samples.has(order))) + 1
                raise TrajgapError(
                    f"interpolation {how}: sample {first} has no {word}; "
                    "give it, or state another --interpolation"
                )
    return hermite(samples, degree, _words(how, degree))


def _words(how: Interpolation, degree: NDArray[np.int64]) -> str:
    names = {1: "straight lines", 3: "cubic Hermite", 5: "quintic Hermite"}
    used = [names[d] for d in (1, 3, 5) if (degree == d).any()]
    said = " and ".join(used) + " between samples"
    return f"{said}, as in joint_trajectory_controller" if how is Interpolation.CONTROLLER else said


@lru_cache(maxsize=3)
def _reach(degree: int) -> Array:
    """Largest |derivative in s| of the way's and of each end's basis polynomial on [0, 1].

    Shape (4 orders, 3): of the way, of hv and of h²a, the larger one of both ends.
    """
    basis = np.array(_BASIS[degree], dtype=np.float64)
    most = np.zeros((4, 6))
    for column in range(1, basis.shape[1]):
        polynomial = np.polynomial.Polynomial(basis[:, column])
        for order in range(4):
            turns = np.asarray(polynomial.deriv().roots(), dtype=np.complex128)
            inside = turns.real[(turns.real > 0.0) & (turns.real < 1.0)]
            places = np.concatenate([[0.0, 1.0], inside])
            most[order, column] = np.abs(polynomial(places)).max()
            polynomial = polynomial.deriv()
    largest = [most[:, 1], most[:, 2:4].max(axis=1), most[:, 4:].max(axis=1)]
    return np.column_stack(largest) * ROUNDED_UP


def hermite(samples: Samples, degree: NDArray[np.int64], between: str) -> Motion:
    """Hermite polynomials between rows.

    **Bounds.** The true samples have times within τ, and positions, velocities and accelerations
    within ε₀, ε₁, ε₂ of those of the file, rounding to float64 included. The r-th derivative is
    Hq⁽ʳ⁾ w h⁻ʳ + Σ Hv⁽ʳ⁾ v h¹⁻ʳ + Σ Ha⁽ʳ⁾ a h²⁻ʳ in the way w and the data of both ends, so
    each term is off by at most

        max |H⁽ʳ⁾| (ε h*ᵐ + |x| |h*ᵐ − hᵐ|),   m = −r, 1 − r, 2 − r,

    with the duration h* within 2τ of h. Position has the way's basis between 0 and 1, so it is
    off by ε₀ and not by twice as much.

    Parameters
    ----------
    degree : ndarray of int, shape (rows − 1,)
        1, 3 or 5 for each pair of rows.
    """
    time, q = samples.time, samples.position
    pairs, count = q.shape[0] - 1, q.shape[1]
    scaled = np.zeros((pairs, int(degree.max()) + 1, count))
    error = np.empty((pairs, 4, count))
    h = np.diff(time)
    clock = samples.time_error
    off = clock[1:] + clock[:-1] + EPS * h
    for d in sorted({int(x) for x in degree}):
        # A slice where all pairs are alike: nothing is copied.
        at: Any = slice(None) if (degree == d).all() else degree == d
        _fill(samples, d, at, (h[at], off[at]), scaled, error)
    return Motion(
        samples.joints,
        time,
        scaled,
        error,
        between,
        (int(degree.min()) - 1) // 2,
        samples.assumed,
        samples.advice,
    )


def _fill(
    samples: Samples, degree: int, at: Any, clock: tuple[Array, Array], scaled: Array, error: Array
) -> None:
    """Coefficients and error bounds of the pairs ``at``."""
    h, off = clock[0][:, None], clock[1][:, None]
    least, most = np.maximum(h - off, 0.0), h + off
    q = samples.position
    basis = np.array(_BASIS[degree], dtype=np.float64)
    data = [q[:-1][at], (q[1:] - q[:-1])[at]]
    for order in range(1, (degree + 1) // 2):
        given = samples.given(order)
        assert given is not None
        data += [given[:-1][at] * h**order, given[1:][at] * h**order]
    sizes = sum(top * np.abs(one) for top, one in zip(np.abs(basis).max(axis=0), data, strict=True))
    for power in range(degree + 1):
        scaled[at, power] = sum(
            weight * one for weight, one in zip(basis[power], data, strict=True) if weight
        )
    reach = _reach(degree)
    doubt = [samples.error(order) for order in range((degree + 1) // 2)]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for r in range(4):
            # Seven roundings of each coefficient, from products, powers and sums.
            bound = 7 * EPS * PERM[: degree + 1, r].sum() * sizes / h**r
            for order, one in enumerate(doubt):
                if not reach[r, order]:
                    continue
                power = order - r
                largest = (most if power >= 0 else least) ** power
                shift = np.abs(largest - h**power)
                both = one[1:][at] + one[:-1][at]
                if order == 0:
                    size = np.abs(data[1])
                    both = np.maximum(one[1:][at], one[:-1][at]) if r == 0 else both
                else:
                    size = (np.abs(data[2 * order]) + np.abs(data[2 * order + 1])) / h**order
                bound = bound + reach[r, order] * (both * largest + size * shift)
            error[at, r] = np.where(np.isnan(bound), np.inf, ROUNDED_UP * bound)
