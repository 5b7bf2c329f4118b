"""Many duration vectors at once by plain numpy, for searches that try to beat the solver."""

from __future__ import annotations

import numpy as np
from scipy.optimize import differential_evolution

from attacks.curves import Array, Asked, NoCurve, excess
from attacks.declared import Declared, coefficients, declared, derivative_row

PLACES = 33
"""Chebyshev points of each segment while searching; the winner is judged by `excess`."""
_S = (1.0 - np.cos(np.pi * np.arange(PLACES) / (PLACES - 1))) / 2.0
"""Where each segment is sampled, its ends included."""


def form_of(asked: Asked) -> Declared | None:
    """The question's curve as piecewise polynomials, where it is one."""
    return declared(asked.block, asked.segments, asked.ends, asked.finish)


def motions(form: Declared, way: Array, h: Array) -> Array:
    """Derivatives 0 to 3 of each segment, shape (batch, joints, segments, places, 4)."""
    c, starts = coefficients(form, way, h)
    found = np.empty((len(h), way.shape[1], h.shape[1], PLACES, 4))
    for k, degree in enumerate(form.degrees):
        own = c[:, starts[k] : starts[k + 1]]
        for r in range(4):
            basis = np.stack([derivative_row(degree, float(s), r) for s in _S], axis=1)
            values = np.einsum("bpj,ps->bjs", own, basis)
            found[:, :, k, :, r] = values / (h[:, k] ** r)[:, None, None]
    return found


def ratios(asked: Asked, form: Declared, h: Array) -> tuple[Array, Array]:
    """Stretch c* and the largest ratio to a bound that no stretch repairs, one for each h."""
    seen = motions(form, asked.waypoints, h)
    moved = seen[..., 1:]
    tops = np.stack([-moved.min(axis=(2, 3)), moved.max(axis=(2, 3))], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(tops > 0, tops / asked.sides, 0.0)
    c = (share ** (1 / np.arange(1, 4))).max(axis=(1, 2, 3))
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
