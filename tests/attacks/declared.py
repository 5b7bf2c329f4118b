"""Piecewise polynomials as declared, by one dense linear system for each vector of durations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ends = dict[int, Array]
"""Derivatives at one end by order, in rad and s, one for each joint."""
_REST = {3: 1, 5: 2, 7: 3, 9: 4}
"""Derivatives that vanish at every way-point, by degree."""


@dataclass(frozen=True)
class Declared:
    """Degree of each piece; at each inner break the highest derivative that agrees; at each break
    the prescribed derivatives; breaks without a way-point."""

    degrees: tuple[int, ...]
    continuity: tuple[int, ...]
    prescribed: tuple[tuple[tuple[int, Array | float], ...], ...]
    virtual: tuple[int, ...] = ()

    def joint(self, j: int) -> Declared:
        """The declaration of one joint by itself."""

        def own(value: Array | float) -> float:
            each = np.atleast_1d(value)
            return float(each[j if len(each) > 1 else 0])

        return replace(
            self, prescribed=tuple(tuple((r, own(v)) for r, v in b) for b in self.prescribed)
        )

    @property
    def breaks(self) -> list[int]:
        """Those with a way-point."""
        return [b for b in range(len(self.degrees) + 1) if b not in self.virtual]


def declared(
    block: dict[str, Any], segments: int, ends: Ends, finish: Ends | None = None
) -> Declared | None:
    """A family of case files in this form; None where it is something else."""
    n = segments
    last = ends if finish is None else finish

    def joined(degrees: Any, continuity: int, orders: Any, virtual: Any = ()) -> Declared:
        inner = ((),) * (n - 1)
        start, end = (
            tuple((r, values.get(r, 0.0)) for r in own)
            for own, values in ((orders, ends), (block.get("finish_orders", orders), last))
        )
        return Declared(
            tuple(degrees), (continuity,) * (n - 1), (start, *inner, end), tuple(virtual)
        )

    match block["family"]:
        case "3-5-3":
            return joined((3, 5, 3), 2, (1, 2))
        case "polynomials":
            orders = block.get("end_orders", (1, 2))
            return joined(block["degrees"], block.get("continuity", 2), orders)
        case "cubic-spline":
            return joined((3,) * n, 2, block.get("end_orders", (1,)))
        case "quintic-spline":
            return joined((5,) * n, 4, (1, 2))
        case "septic-spline":
            return joined((7,) * n, 6, (1, 2, 3))
        case "cubic-spline-virtual":
            return joined((3,) * n, 2, (1, 2), sorted({1, n - 1}))
        case "quintic-spline-virtual":
            return joined((5,) * n, 4, (1, 2, 3), sorted({1, n - 1}))
        case "rest-to-rest" | "jtraj":
            degree = block.get("degree", 5)
            rest = tuple((r, 0.0) for r in range(1, _REST[degree] + 1))
            return Declared((degree,) * n, (0,) * (n - 1), (rest,) * (n + 1))
        case "stated":
            found: Declared = block["declared"]
            return found
    return None


def derivative_row(degree: int, s: float, r: int) -> Array:
    """Derivative r of the powers of s up to a degree."""
    row = np.zeros(degree + 1)
    for p in range(r, degree + 1):
        row[p] = float(np.prod(np.arange(p - r + 1, p + 1))) * s ** (p - r) if r else s**p
    return row


def coefficients(form: Declared, way: Array, h: Array) -> tuple[Array, Array]:
    """Coefficients in s of all pieces, shape (batch, sum of sizes, joints), and where each begins.

    Raises
    ------
    np.linalg.LinAlgError
        If the conditions do not determine them.
    """
    starts = np.concatenate([[0], np.cumsum([d + 1 for d in form.degrees])])
    batch, n, size = len(h), len(form.degrees), int(starts[-1])
    rows: list[Array] = []
    right: list[Array] = []

    def derivative(k: int, s: float, r: int) -> Array:
        """h_k^r times derivative r, the same for every h."""
        row = np.zeros(size)
        row[starts[k] : starts[k + 1]] = derivative_row(form.degrees[k], s, r)
        return row

    def demand(row: Array, value: Array) -> None:
        rows.append(np.broadcast_to(row, (batch, size)))
        right.append(np.broadcast_to(value, (batch, way.shape[1])))

    still = np.zeros(way.shape[1])
    for index, b in enumerate(form.breaks):
        if b < n:
            demand(derivative(b, 0.0, 0), way[index])
        if b > 0:
            demand(derivative(b - 1, 1.0, 0), way[index])
    for b in range(1, n):
        rate = (h[:, b - 1] / h[:, b])[:, None]
        for r in range(0 if b in form.virtual else 1, form.continuity[b - 1] + 1):
            demand(derivative(b - 1, 1.0, r) - derivative(b, 0.0, r) * rate**r, still)
    for b, entries in enumerate(form.prescribed):
        # Where nothing agrees but the position, what is prescribed is so on both sides.
        sides = [(b, 0.0)] * (b < n) + [(b - 1, 1.0)] * (b > 0)
        for r, value in entries:
            both = 0 < b < n and form.continuity[b - 1] < r
            for k, s in sides if both else sides[:1]:
                demand(derivative(k, s, r), value * h[:, k, None] ** r)
    if len(rows) != size:
        raise np.linalg.LinAlgError(f"{len(rows)} conditions on {size} coefficients")
    found = np.linalg.solve(np.stack(rows, axis=1), np.stack(right, axis=1))
    return found, starts
