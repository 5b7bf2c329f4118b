"""Many duration vectors at once by plain numpy, for searches that try to beat the solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import differential_evolution

from .curves import Array, Asked, NoCurve, excess

PLACES = 33
"""Chebyshev points of each segment while searching; the winner is judged by `excess`."""
_S = (1.0 - np.cos(np.pi * np.arange(PLACES) / (PLACES - 1))) / 2.0
"""Where each segment is sampled, its ends included."""
_REST = {3: 1, 5: 2, 7: 3, 9: 4}
"""Derivatives that vanish at every way-point, by degree."""


@dataclass(frozen=True)
class Declared:
    """A family as piecewise polynomials: what is linear in it is one system for each h."""

    degrees: tuple[int, ...]
    continuity: int
    ends: tuple[int, ...]
    rest: int = 0


def declared(asked: Asked) -> Declared | None:
    """The family as polynomials with breaks at the way-points; None where it is something else."""
    block, n = asked.block, asked.segments
    if any(asked.ends.values()):
        return None
    match asked.family:
        case "3-5-3":
            return Declared((3, 5, 3), 2, (1, 2))
        case "polynomials":
            ends = tuple(block.get("end_orders", (1, 2)))
            return Declared(tuple(block["degrees"]), block.get("continuity", 2), ends)
        case "cubic-spline":
            return Declared((3,) * n, 2, tuple(block.get("end_orders", (1,))))
        case "quintic-spline":
            return Declared((5,) * n, 4, (1, 2))
        case "rest-to-rest" | "jtraj":
            degree = block.get("degree", 5)
            return Declared((degree,) * n, 0, (), _REST[degree])
    return None


def motions(form: Declared, way: Array, h: Array) -> Array:
    """Derivatives 0 to 3 of each segment, shape (batch, joints, segments, places, 4)."""
    starts = np.concatenate([[0], np.cumsum([d + 1 for d in form.degrees])])
    batch, n, size = len(h), h.shape[1], int(starts[-1])
    rows: list[Array] = []
    right: list[Array] = []

    def derivative(k: int, s: float, r: int) -> Array:
        """Row of h_k^r times derivative r, the same for every h."""
        row = np.zeros(size)
        for p in range(r, form.degrees[k] + 1):
            falling = float(np.prod(np.arange(p - r + 1, p + 1))) if r else 1.0
            row[starts[k] + p] = falling * s ** (p - r)
        return row

    still = np.zeros(way.shape[1])
    for k in range(n):
        for s, point in ((0.0, way[k]), (1.0, way[k + 1])):
            rows.append(np.tile(derivative(k, s, 0), (batch, 1)))
            right.append(point)
            for r in range(1, form.rest + 1):
                rows.append(np.tile(derivative(k, s, r), (batch, 1)))
                right.append(still)
    for k in range(n - 1):
        rate = (h[:, k] / h[:, k + 1])[:, None]
        for r in range(1, form.continuity + 1):
            rows.append(derivative(k, 1.0, r) - derivative(k + 1, 0.0, r) * rate**r)
            right.append(still)
    for r in form.ends:
        rows += [np.tile(derivative(k, s, r), (batch, 1)) for k, s in ((0, 0.0), (n - 1, 1.0))]
        right += [still, still]
    matrix = np.stack(rows, axis=1)
    c = np.linalg.solve(matrix, np.broadcast_to(np.array(right), (batch, size, way.shape[1])))
    found = np.empty((batch, way.shape[1], n, PLACES, 4))
    for k, degree in enumerate(form.degrees):
        own = c[:, starts[k] : starts[k] + degree + 1]
        for r in range(4):
            basis = np.zeros((degree + 1, PLACES))
            for p in range(r, degree + 1):
                falling = float(np.prod(np.arange(p - r + 1, p + 1))) if r else 1.0
                basis[p] = falling * _S ** (p - r)
            values = np.einsum("bpj,ps->bjs", own, basis)
            found[:, :, k, :, r] = values / (h[:, k] ** r)[:, None, None]
    return found


def ratios(asked: Asked, form: Declared, h: Array) -> tuple[Array, Array]:
    """Stretch c* and the largest ratio to a bound that no stretch mends, one for each h."""
    seen = motions(form, asked.waypoints, h)
    tops = np.abs(seen[..., 1:]).max(axis=(2, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(tops > 0, tops / asked.limits, 0.0)
    c = (share ** (1 / np.arange(1, 4))).max(axis=(1, 2))
    q = seen[..., 0]
    over = np.maximum(
        (asked.position_lower[:, None, None] - q).max(axis=(1, 2, 3)),
        (q - asked.position_upper[:, None, None]).max(axis=(1, 2, 3)),
    )
    return c, np.where(np.isfinite(over), over, -1.0)


def penalised(asked: Asked, form: Declared, h: Array) -> Array:
    """Total of each h, stretched just enough; beyond any total where bounds are broken."""
    c, over = ratios(asked, form, h)
    if asked.free_of_bounds:
        return np.asarray(h.sum(axis=1) * c)
    longer = h * np.maximum(c, 1.0)[:, None]
    late = np.maximum(longer / asked.duration_upper - 1, 0.0).max(axis=1)
    early = np.maximum(asked.duration_lower / longer - 1, 0.0).max(axis=1)
    misses = late + early + np.maximum(over, 0.0)
    return np.asarray(longer.sum(axis=1) + np.where(misses > 0, 1e6 * (1 + misses), 0.0))


def searched(
    asked: Asked, form: Declared, seed: int, decades: float, rounds: int
) -> tuple[float, Array] | None:
    """The best durations that a global search finds and that samples show to keep every limit."""
    first = _scale(asked, form)
    if np.isfinite(asked.duration_upper).all() and asked.duration_lower.all():
        box = np.log(np.stack([asked.duration_lower, asked.duration_upper], axis=1))
    else:
        box = np.log(first) + np.array([-decades, decades]) * np.log(10.0)
        box = np.tile(box, (asked.segments, 1))
        low = np.log(np.maximum(asked.duration_lower, 1e-300))
        box = np.stack([np.maximum(box[:, 0], low), np.maximum(box[:, 1], low + 1e-6)], axis=1)
        high = np.log(asked.duration_upper)
        box = np.stack([np.minimum(box[:, 0], high - 1e-6), np.minimum(box[:, 1], high)], axis=1)
    box[:, 1] = np.maximum(box[:, 1], box[:, 0] + 1e-9)

    def objective(z: Array) -> Array:
        h = np.exp(z.T if z.ndim == 2 else z[None])
        try:
            value = penalised(asked, form, h)
        except np.linalg.LinAlgError:
            value = np.full(len(h), 1e12)
        value = np.where(np.isfinite(value), value, 1e12)
        return value if z.ndim == 2 else value[0]

    found = differential_evolution(
        objective,
        box,
        maxiter=rounds,
        popsize=20,
        tol=1e-10,
        rng=np.random.default_rng(seed),
        vectorized=True,
        updating="deferred",
        polish=False,
    )
    h = np.exp(found.x)
    return settled(asked, form, h)


def settled(asked: Asked, form: Declared, h: Array) -> tuple[float, Array] | None:
    """Durations stretched until dense samples show that they keep every limit, if they can."""
    c = float(ratios(asked, form, h[None])[0][0])
    h = h * (c if asked.free_of_bounds else max(c, 1.0))
    for _ in range(30):
        try:
            _, most = excess(asked, h)
        except (NoCurve, np.linalg.LinAlgError):
            return None
        if most <= 1.0:
            return float(h.sum()), h
        if not most < 1.5:
            return None
        # Bounds that are reached leave nothing to stretch.
        longer = np.minimum(h * (1 + (most - 1) * 1.1), asked.duration_upper)
        if (longer == h).all():
            return None
        h = longer
    return None


def _scale(asked: Asked, form: Declared) -> float:
    """A typical duration: of equal ones, stretched until they are tight."""
    h = np.ones((1, asked.segments))
    c, _ = ratios(asked, form, h)
    return float(c[0]) if np.isfinite(c[0]) and c[0] > 0 else 1.0
