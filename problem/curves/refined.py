"""Coefficients with a bound on their error: refined in extended precision."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .banded import image
from .condition import Layout
from .system import System, inverse, singular, system

SHARES = (1e-5, 1e-9, 1e-14)
"""Of the largest entry in a row of the inverse, below which entries are left out, tried in turn:
the first nearly always does (at 1e-3 a second image is needed, at 1e-8 rows are a third longer),
the last leaves out what rounding would lose."""
GUESSED = 1e-2
"""The same for the guess that an image has to stay below: shorter rows, and twice the sum of what
is left mostly covers the rest; where it does not, a further image does."""
DENSE_AFTER_ALL = 6000
"""Up to this many coefficients, 300 MB, a dense inverse is tried where no banded one settles."""
IMAGES = 3
"""Images of a bound that are taken: the first one contains its own nearly always."""
_POSITIVE = 1e-290
"""Added to every bound, so that none is 0: far below any angle, far above the least float even
after division by hʳ."""


def refined_coefficients(layout: Layout, values: Array, durations: Array) -> tuple[Array, Array]:
    """Coefficients after iterative refinement in extended precision, with an error bound.

    The residual is taken in ``longdouble``; its rounding is bounded by that type's own epsilon,
    so the bound holds (only wider) where ``longdouble`` is float64. An approximate inverse B of
    the matrix A bounds the error e = x − A⁻¹b entry by entry: with the residual r = b − Ax,

        e = −Br + (I − BA)e,  so  |e| ≤ |B||r| + |I − BA||e|,

    and every ``error`` that contains its own image, |B||r| + |I − BA| error ≤ error, is a bound if
    the first term is positive: |I − BA| then shrinks a positive vector, so its spectral radius is
    below 1 and repeated use of the inequality ends in |e| ≤ error. That holds for any B, also for
    one with the far entries left out, as `banded.image` makes it for long splines. An image of a
    bound is a bound itself, and the closer one.

    Parameters
    ----------
    layout : Layout
    values : ndarray, shape (rows, joints)
        What the conditions give.
    durations : ndarray, shape (segments,)
        s.

    Returns
    -------
    coefficients, error : ndarray, shape (segments, 10, joints)
        Scaled coefficients and a bound on their absolute error.

    Raises
    ------
    SingularError
        If the system is, or if rounding does not tell it from one that is.
    """
    rows = system(layout, durations.astype(np.longdouble))
    size = len(rows.values)
    flat, error = _refined_in_band(rows, values) if rows.in_band else (values, None)
    if error is None:
        if rows.in_band and size > DENSE_AFTER_ALL:
            raise singular(layout, durations)
        approximate = inverse(rows, layout, durations)
        flat = _refined(rows, values, lambda residual: approximate @ residual)
        error = _bounded(rows, approximate, values, flat)
    if error is None or not np.isfinite(flat).all():
        raise singular(layout, durations)
    rounded = flat.astype(np.float64)
    error = error + np.finfo(np.float64).eps * np.abs(rounded)
    return layout.unflat(rounded), layout.unflat(error)


def _refined(rows: System, values: Array, solve: Callable[[Array], Array]) -> NDArray[np.floating]:
    """Coefficients after a solution and two steps of refinement, in extended precision."""
    flat = rows.begun(values)
    for _ in range(3):
        residual = np.concatenate(
            [(part.right(values[at]) - part.times(flat)) for at, part in rows.parts()]
        )
        flat = flat + solve(residual.astype(np.float64))
    return flat


def _excess(rows: System, values: Array, flat: NDArray[np.floating], terms: int) -> Array:
    """Bound on the residual, its rounding in sums of so many terms included."""
    tiny = np.finfo(np.longdouble).eps * (terms + 24)
    found = []
    for at, part in rows.parts():
        right = part.right(values[at])
        sizes = replace(part, values=np.abs(part.values)).times(np.abs(flat))
        excess = np.abs(right - part.times(flat)) + tiny * (sizes + np.abs(right))
        found.append(excess.astype(np.float64))
    return np.concatenate(found)


def _refined_in_band(rows: System, values: Array) -> tuple[NDArray[np.floating], Array | None]:
    """Coefficients, refined by a band's factors, and an error that contains its own image."""
    factors = rows.factors
    if not (np.abs(factors.diagonal) > 0.0).all():
        return values, None
    flat = _refined(rows, values, factors.solve)
    excess = _excess(rows, values, flat, rows.columns.shape[1])
    for share in SHARES:
        guess = 2.0 * (_POSITIVE + image(factors, max(share, GUESSED), excess, None))
        for _ in range(IMAGES):
            error = _POSITIVE + image(factors, share, excess, guess)
            if (error <= guess).all():
                return flat, error
            guess = 2.0 * error
    return flat, None


def _bounded(
    rows: System, approximate: Array, values: Array, flat: NDArray[np.floating]
) -> Array | None:
    """An error that contains its own image, or None."""
    matrix = rows.dense
    excess = _excess(rows, values, flat, len(matrix))
    size = np.finfo(np.float64).eps * (len(matrix) + 2)
    # The rounding of the product, and of A's entries, is part of the defect |BA − I|.
    found = np.abs(approximate @ matrix - np.eye(len(matrix)))
    defect = found + size * (np.abs(approximate) @ np.abs(matrix))
    first = _POSITIVE + np.abs(approximate) @ excess
    error = first
    for _ in range(3):
        error = first + 1.1 * (defect @ error)
    return error if (first + defect @ error <= error).all() else None
