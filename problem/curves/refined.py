"""Coefficients with a bound on their error: refined in extended precision."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, over_rows
from .condition import Layout
from .system import POSITIVE, System, system

if TYPE_CHECKING:
    from .blocks import Blocks

WIDTHS = (1, 2, 4, 8, 16, 32)
"""Segments in a block, tried in turn: one gives a close bound for splines of degrees 3 and 5, two
or four for 7. Beyond 32 what is left is near singular, and a block costs the cube of its width."""
CLOSE_BOUND = 1e-11
"""Share of a joint's largest coefficient that its bound may have before wider blocks are tried: a
hundredth of what the checker's tolerance leaves."""


def refined_coefficients(
    layout: Layout, values: Array, durations: Array, extended: bool = True
) -> tuple[Array, Array]:
    """Coefficients after iterative refinement in extended precision, with an error bound.

    The residual is taken in ``longdouble``; its rounding is bounded by that type's own epsilon,
    so the bound holds (only wider) where ``longdouble`` is float64. An approximate inverse B of
    the matrix A bounds the error e = x − A⁻¹b entry by entry: with the residual r = b − Ax,

        e = −Br + (I − BA)e,  so  |e| ≤ |B||r| + |I − BA||e|,

    and every ``error`` that contains its own image, |B||r| + |I − BA| error ≤ error, is a bound if
    the first term is positive: |I − BA| then shrinks a positive vector, so its spectral radius is
    below 1 and repeated use of the inequality ends in |e| ≤ error. That holds for any B. An image
    of a bound is a bound itself, and the closer one. Long systems are bounded by `blocks`.

    Values are those of the conditions, (rows, joints); both results have shape (segments, powers,
    joints).

    Raises
    ------
    SingularError
        If the system is, or if rounding does not tell it from one that is.
    """
    wide = durations.astype(np.longdouble) if extended else durations
    with np.errstate(all="ignore"):  # what is no number has no bound, and is refused
        rows = system(layout, wide)
        flat, error = (_by_blocks if rows.in_band else _densely)(rows, values)
    if error is None or not np.isfinite(flat).all():
        raise rows.singular()
    rounded = flat.astype(np.float64, copy=False)
    error += np.finfo(np.float64).eps * np.abs(rounded)
    return layout.unflat(rounded), layout.unflat(error, int(layout.degrees.max()) + 1)


def _densely(rows: System, values: Array) -> tuple[NDArray[np.floating], Array | None]:
    """Coefficients, and an error that contains its own image, by the inverse of all rows."""
    flat = _refined(rows, values, rows.inverse.__matmul__)
    matrix = rows.layout.dense(rows.narrow.values)
    return flat, contained(rows.inverse, matrix, _excess(rows, values, flat, len(matrix)))


def _by_blocks(rows: System, values: Array) -> tuple[NDArray[np.floating], Array | None]:
    """The same by blocks of segments, wider ones where the bound is not close."""
    from .blocks import blocks_of  # compiled

    narrow = rows.narrow
    best: tuple[NDArray[np.floating], Array | None] = (values, None)
    for segments in WIDTHS:
        blocks = blocks_of(narrow, segments)
        if narrow is rows:
            flat, excess = _solved(blocks, values)
        else:
            flat = _refined(rows, values, blocks.solve)
            excess = _excess(rows, values, flat, rows.values.shape[1])
        error = blocks.bound(excess)
        if error is None:
            continue
        best = flat, error
        # A joint that stands still at 0 has what is added to every bound, and no more.
        still = POSITIVE / CLOSE_BOUND**2
        sizes = over_rows(np.maximum, np.abs(flat))
        if (over_rows(np.maximum, error) <= CLOSE_BOUND * sizes + still).all():
            break
    return best


def _solved(blocks: Blocks, values: Array) -> tuple[NDArray[np.floating], Array]:
    """Coefficients in float64, and a bound on their residual.

    What a step of refinement would gain is less than the rounding of the residual.
    """
    flat = blocks.rows.begun(values)
    flat += blocks.solve(blocks.residual(values, flat)[0])
    residual, excess = blocks.residual(values, flat)
    excess += np.abs(residual)
    return flat, excess


def _refined(rows: System, values: Array, solve: Callable[[Array], Array]) -> NDArray[np.floating]:
    """Coefficients after a solution and two steps of refinement, in extended precision."""
    flat = rows.begun(values)
    for _ in range(3):
        flat = flat + solve((rows.right(values) - rows.times(flat)).astype(np.float64))
    return flat


def _excess(rows: System, values: Array, flat: NDArray[np.floating], terms: int) -> Array:
    """Bound on the residual, its rounding in sums of so many terms included."""
    tiny, right = np.finfo(np.longdouble).eps * (terms + 24), rows.right(values)
    sizes = replace(rows, values=np.abs(rows.values)).times(np.abs(flat)) + np.abs(right)
    return np.asarray(np.abs(right - rows.times(flat)) + tiny * sizes, dtype=np.float64)


def contained(approximate: NDArray[np.floating], matrix: Array, excess: Array) -> Array | None:
    """An error that contains its own image by any approximate inverse of a matrix, or None.

    The excess bounds the residual, shape (size, joints).
    """
    size = np.finfo(np.float64).eps * (len(matrix) + 2)
    # The rounding of the product, and of A's entries, is part of the defect |BA − I|.
    found = np.abs(approximate @ matrix - np.eye(len(matrix)))
    defect = found + size * (np.abs(approximate) @ np.abs(matrix))
    first = POSITIVE + np.abs(approximate) @ excess
    error = first
    for _ in range(3):
        error = first + 1.1 * (defect @ error)
    return np.asarray(error) if (first + defect @ error <= error).all() else None
