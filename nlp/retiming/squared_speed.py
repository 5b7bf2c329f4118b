"""The shortest time along a path, between two bounds, from the square of the path's speed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import permutations, product
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, Limits, Trajectory, extrema
from .path import pieces
from .toppra_check import not_applicable

_MARGIN = 1e-9
"""Relative margin of both bounds, far above the rounding errors of their sums."""
_ROUNDING = 1e-14
"""Rounding errors of a path's coefficients over the way of the joint, with a reserve."""
CELLS = 2000
"""Cells of a path, about: with them both bounds lie some 0.03 % apart, after some seconds."""
_QUIET = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.max_iter": 500}
"""Options of IPOPT."""


@dataclass(frozen=True, eq=False)
class PathCells:
    """A path q(u), cut into cells at its breaks, where a joint turns, and evenly between them.

    Attributes
    ----------
    widths : ndarray, shape (cells,)
        In the parameter u.
    coefficients : ndarray, shape (cells, powers, joints)
        Of q, ascending, over [0, 1] in each cell.
    first, second : ndarray, shape (cells, joints)
        By how much q′ and q″ (by u) of all paths that are meant may differ from those of this one.
    """

    widths: Array
    coefficients: Array
    first: Array
    second: Array

    @cached_property
    def slopes(self) -> Array:
        """Coefficients of q′ over [0, 1] in each cell, shape (cells, powers, joints)."""
        return _derived(self.coefficients, self.widths)

    @cached_property
    def bends(self) -> Array:
        """Those of q″."""
        return _derived(self.slopes, self.widths)


@dataclass(frozen=True)
class PathTime:
    """Bounds on the shortest time along a path from rest to rest.

    Attributes
    ----------
    lower : float
        No motion within the limits is shorter, s.
    upper : float
        A motion within the limits takes no longer, s; inf if none was found.
    why : str or None
        Why neither is computed.
    """

    lower: float = 0.0
    upper: float = np.inf
    why: str | None = None


def bound_along(
    trajectory: Trajectory,
    loosest: Limits,
    tightest: Limits,
    radius: tuple[Array, Array] | None = None,
    cells: int = CELLS,
) -> PathTime:
    """Bounds on the shortest time along a path, from rest to rest, whatever timed it before.

    Parameters
    ----------
    loosest, tightest : Limits
        The first may allow more than is meant, and bounds the time from below; the second may allow
        less, and bounds it from above. If they limit jerk or snap, there is no bound from above.
    radius : pair of ndarray, shape (segments, joints), optional
        By how much q′ and q″ of the paths that are meant may differ from this one, as
        `largest_derivatives` gives it of the difference: both bounds hold for all of them. 0 by
        default.
    cells : int
        Into which the path is cut, about.
    """
    path = trajectory.path
    jerky = bool(np.isfinite(tightest.widest[:, 2:]).any())
    without = [
        one if one.uneven else Limits(one.velocity, one.acceleration) for one in (loosest, tightest)
    ]
    why = next((w for w in (not_applicable(path, one) for one in without) if w is not None), None)
    if why is None and len(pieces(path)[0]) > 1:
        why = "all joints stand still between its ends"
    if why is not None:
        return PathTime(why=why)
    size = _ROUNDING * np.ptp(path.scaled[:, 0], axis=0) / path.durations[:, None]
    first, second = radius or (np.zeros_like(size), np.zeros_like(size))
    cut = cut_path(path, cells, (first + size, second + size / path.durations[:, None]))
    lower = least_time(cut, without[0])[0] * (1.0 - _MARGIN)
    upper = np.inf if jerky else _shortest_found(cut, without[1]) * (1.0 + _MARGIN)
    return PathTime(lower, upper)


def largest_derivatives(trajectory: Trajectory) -> tuple[Array, Array]:
    """Largest |q′| and |q″| in each segment, from above, shape (segments, joints)."""
    slopes = _derived(trajectory.scaled, trajectory.durations)
    return _largest(slopes), _largest(_derived(slopes, trajectory.durations))


def cut_path(path: Trajectory, cells: int, radius: tuple[Array, Array]) -> PathCells:
    """Cut a path into about so many cells; ``radius`` as in `bound_along`."""
    turns: list[set[float]] = [set() for _ in path.durations]
    for j in range(path.joints):
        for one in extrema(path, j, 0):
            turns[one.segment].add(one.s)
    each = -(-cells // path.durations.size)
    widths, parts, counts = [], [], []
    for given, h, own in zip(path.scaled, path.durations, turns, strict=True):
        edges = np.unique([*np.linspace(0.0, 1.0, each + 1), *own])
        step = np.diff(edges)
        shifted = np.zeros((step.size, max(3, len(given)), path.joints))
        for m in range(len(given)):
            for p in range(m, len(given)):
                factor = comb(p, m) * edges[:-1] ** (p - m) * step**m
                shifted[:, m] += factor[:, None] * given[p]
        widths.append(step * h)
        parts.append(shifted)
        counts.append(step.size)
    first, second = (np.repeat(one, counts, axis=0) for one in radius)
    return PathCells(np.concatenate(widths), np.concatenate(parts), first, second)


def least_time(path: PathCells, limits: Limits) -> tuple[float, Array]:
    """What no motion along a path undercuts, s, and what no b = u̇² exceeds at the cells' ends.

    With b, a joint's velocity is q̇² = q′² b, and on a cell in which it does not turn, since
    d(q̇²) = 2 q̈ dq,

        |q′₁² b₁ − q′₀² b₀| ≤ 2 A |q₁ − q₀|,   q′² b ≤ V².

    One sweep from either end finds the largest b that these rows leave, two rows of a cell together
    included. A cell then takes as long as its slowest joint needs alone between two such speeds.
    """
    some = _pushed(limits)
    spread = path.first * path.widths[:, None]
    moved = np.abs(path.coefficients[:, 1:].sum(axis=1))
    low, high = (
        [np.maximum(np.abs(q) + sign * path.first, 0.0) ** 2 for q in _at_ends(path.slopes)]
        for sign in (-1, 1)
    )
    # The path meant may turn elsewhere: back and forth by no more than thrice what it differs.
    gain = 2.0 * limits.acceleration * (moved + 3.0 * spread)
    with np.errstate(divide="ignore", invalid="ignore"):
        top = [np.fmin.reduce(limits.velocity**2 / square, axis=1) for square in low]
        for (j, k), (e, f) in product(permutations(some, 2), ((0, 1), (1, 0))):
            rate = low[e][:, j] * low[f][:, k] - high[e][:, k] * high[f][:, j]
            held = (gain[:, j] * low[f][:, k] + gain[:, k] * high[f][:, j]) / rate
            top[e] = np.where(rate > 0.0, np.minimum(top[e], held), top[e])
    most = np.minimum(np.append(top[0], np.inf), np.append(np.inf, top[1]))
    most[[0, -1]] = 0.0
    rows = gain[:, some], high[1][:, some], low[0][:, some], high[0][:, some], low[1][:, some]
    _sweep(most[::-1], rows[1][::-1], rows[2][::-1], rows[0][::-1])
    _sweep(most, rows[3], rows[4], rows[0])
    speeds = [
        np.minimum(limits.velocity, np.sqrt(square * np.minimum(b, 1e300)[:, None]))
        for square, b in zip(high, (most[:-1], most[1:]), strict=True)
    ]
    return _summed(limits, np.maximum(moved - spread, 0.0), *speeds), most


def _sweep(most: Array, before: Array, after: Array, gain: Array) -> None:
    """Lower each b to what the one before it allows, in place."""
    rows = zip(before.tolist(), after.tolist(), gain.tolist(), strict=True)
    values = most.tolist()
    for i, row in enumerate(rows):
        b, least = values[i], values[i + 1]
        for p, r, g in zip(*row, strict=True):
            if r > 0.0 and p * b + g < r * least:
                least = (p * b + g) / r
        values[i + 1] = least
    most[:] = values


def _summed(limits: Limits, way: Array, before: Array, after: Array) -> float:
    """Sum of the least times of all cells, s, each that of its slowest joint alone.

    A joint goes its way from at most one speed to at most another.
    """
    v, a = limits.velocity, limits.acceleration
    gain = 2.0 * a * way
    with np.errstate(invalid="ignore", divide="ignore"):
        one = np.minimum(before, np.sqrt(after**2 + gain))
        two = np.minimum(after, np.sqrt(one**2 + gain))
        peak = np.minimum(v, np.sqrt((one**2 + two**2 + gain) / 2.0))
        level = (way - (2.0 * peak**2 - one**2 - two**2) / (2.0 * a)) / peak
        times = (2.0 * peak - one - two) / a + np.maximum(level, 0.0)
        times = np.where(np.isinf(a), way / v, times)
    return float(np.nan_to_num(times, nan=0.0).max(axis=1).sum())


def _shortest_found(path: PathCells, limits: Limits) -> float:
    """Duration of a motion along every path that is meant, within the limits; inf if none is found.

    b is linear on each cell, so that b′/2 is the acceleration of u, and

        q′² b ≤ V²,   |q′ b′/2 + q″ b| ≤ A

    are linear in b at the ends of the cells, while the time Σ 2Δu/(√b₀ + √b₁) is convex. The
    motion found is then slowed down until the limits hold inside the cells, too.
    """
    import casadi as ca  # few need it, and it takes a while

    _, most = least_time(path, limits)
    scale = float(most[np.isfinite(most)].max())
    most = np.where(np.isfinite(most), most, scale) / scale
    moving = most > 0.0
    x = ca.SX.sym("b", int(moving.sum()))
    b = ca.SX(most.size, 1)
    b[np.flatnonzero(moving).tolist()] = x
    roots = ca.sqrt(b)
    asked = {
        "x": x,
        "f": ca.sum1(2.0 * ca.DM(path.widths) / (roots[1:] + roots[:-1])),
        "g": ca.mtimes(ca.DM(_rows(path, limits, scale)), b),
    }
    solver = ca.nlpsol("squares", "ipopt", asked, _QUIET)
    # What is left of the limits on the path that q″ b pushes most; b ≤ most.
    some = _pushed(limits)
    larger = scale * np.array([most[:-1], most[1:]])[..., None]
    taken = path.second[:, some] * larger / limits.acceleration[some]
    room = np.maximum(1.0 - taken, 0.5).transpose(0, 2, 1).ravel()
    found = solver(x0=0.5 * most[moving], lbx=0.0, ubx=most[moving], lbg=-room, ubg=room)
    if not solver.stats()["success"]:
        return np.inf
    b = np.zeros(most.size)
    b[moving] = np.maximum(np.asarray(found["x"]).ravel(), 0.0) * scale
    with np.errstate(divide="ignore"):
        time = float((2.0 * path.widths / (np.sqrt(b[1:]) + np.sqrt(b[:-1]))).sum())
    return time * float(np.sqrt(max(1.0, *_worst(path, limits, b))))


def _rows(path: PathCells, limits: Limits, scale: float) -> Any:
    """Accelerations over their limits at both ends of the cells, as a matrix over b/scale."""
    from scipy.sparse import coo_array

    n = path.widths.size
    entries = []
    some = _pushed(limits)
    for number, (end, j) in enumerate(product((0, 1), some)):
        slope = _at_ends(path.slopes)[end][:, j] / (2.0 * path.widths)
        parts = [-slope, slope]
        parts[end] = parts[end] + _at_ends(path.bends)[end][:, j]
        for side, part in enumerate(parts):
            entries.append((part * scale / limits.acceleration[j], number * n, side))
    values = np.concatenate([value for value, _, _ in entries])
    at = np.arange(n)
    down = np.concatenate([at + row for _, row, _ in entries])
    across = np.concatenate([at + side for _, _, side in entries])
    return coo_array((values, (down, across)), shape=(2 * some.size * n, n + 1)).tocsc()


def _worst(path: PathCells, limits: Limits, b: Array) -> list[float]:
    """Largest q̇²/V² and |q̈|/A of a motion on any path that is meant, from above."""
    slope, bend = path.slopes, path.bends
    line = np.stack([b[:-1], np.diff(b)], axis=1)[..., None]
    rate = (np.diff(b) / (2.0 * path.widths))[:, None]
    larger = np.maximum(b[:-1], b[1:])[:, None]
    speeds = _largest(_product(_product(slope, slope), line))
    # (|q′| + first)² b, the mixed term by its largest factors.
    speeds += (2.0 * _largest(slope) + path.first) * path.first * larger
    pushes = slope * rate[..., None] + _product(bend, line)
    accelerations = _largest(pushes) + path.first * np.abs(rate) + path.second * larger
    with np.errstate(invalid="ignore"):
        return [
            float(np.nanmax(speeds / limits.velocity**2)),
            float(np.nanmax(accelerations / limits.acceleration)),
        ]


def _pushed(limits: Limits) -> NDArray[np.intp]:
    """Joints whose acceleration is limited; one that may have none stands still."""
    return np.flatnonzero(np.isfinite(limits.acceleration) & (limits.acceleration > 0.0))


def _at_ends(polynomials: Array) -> tuple[Array, Array]:
    """Values at 0 and at 1, shape (cells, joints) each."""
    return polynomials[:, 0], polynomials.sum(axis=1)


def _derived(polynomials: Array, widths: Array) -> Array:
    """Derivatives of polynomials over [0, 1] by a parameter of which each covers a width."""
    powers = np.arange(1, polynomials.shape[1])[:, None]
    return np.asarray(powers * polynomials[:, 1:] / widths[:, None, None])


def _product(one: Array, two: Array) -> Array:
    """Coefficients of the product of polynomials, shape (cells, powers, joints)."""
    found = np.zeros((one.shape[0], one.shape[1] + two.shape[1] - 1, one.shape[2]))
    for p in range(two.shape[1]):
        found[:, p : p + one.shape[1]] += one * two[:, p : p + 1]
    return found


def _largest(polynomials: Array) -> Array:
    """Largest size on [0, 1] from above, by Bernstein coefficients, shape (cells, joints)."""
    n = polynomials.shape[1] - 1
    matrix = np.array(
        [[comb(i, p) / comb(n, p) if p <= i else 0.0 for p in range(n + 1)] for i in range(n + 1)]
    )
    return np.asarray(np.abs(np.einsum("ip,cpj->cij", matrix, polynomials)).max(axis=1))
