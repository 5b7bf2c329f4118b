"""What planners return, as piecewise polynomials in time: converters of `referee.py`.

Where the library reads an object itself (`trajgap.problem.motions.as_motion`: TOPPRA's and Ruckig's
outputs) nothing is done here. The rest are timings s(t) of a known path q(s):

- `timed`: s(t) is a polynomial on each piece (copp's TOPP2: constant path acceleration; Drake's
  ``Toppra``: a ``PiecewisePolynomial``), so q(s(t)) is one too, exactly.
- `third_order`: copp's TOPP3 documents s'' linear in s between stations, and s cubic in t on the
  stationary intervals at the ends. The first is not a polynomial in t, but its Taylor series has a
  closed form; pieces are cut until what the series leaves out is below rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly
from trajgap.problem.motions import Motion

Array = NDArray[np.float64]
POWERS = 10
"""Coefficients of a piece that the library judges: degree 9."""
_STEP = 0.2
"""Largest |w|·half-length of a piece where s'' = b + c·s, w² = |c|: what degree 9 leaves out of a
third derivative is then below 0.2⁷/7! = 3e-9 of it."""
_SHARE = 0.25
"""Largest half-length of a piece over the distance to a speed of 0 or over its own growth: bounds
the series of a path of degree 5 in the same way."""


def composed(outer: Array, inner: Array, powers: int) -> Array:
    """Ascending coefficients of p(u(t)) up to ``powers``; ``outer`` ascending, by joint."""
    total = np.zeros((powers, outer.shape[1]))
    power = np.zeros(powers)
    power[0] = 1.0
    for row in outer:
        total += power[:, None] * row
        power = np.convolve(power, inner)[:powers]
    return total


def shifted(ascending: Array, by: float) -> Array:
    """Coefficients of p(t + by)."""
    count = ascending.shape[0]
    out = np.zeros_like(ascending)
    for k in range(count):
        for i in range(k + 1):
            out[i] += math.comb(k, i) * by ** (k - i) * ascending[k]
    return out


def on_path(path: PPoly, place: float, near: float) -> Array:
    """Ascending coefficients of the path about ``place``, of the piece that holds ``near``."""
    k = int(np.clip(np.searchsorted(path.x, near, side="right") - 1, 0, path.x.size - 2))
    return shifted(path.c[::-1, k].astype(np.float64), place - float(path.x[k]))


def timed(path: PPoly, times: Sequence[float], laws: Sequence[Array], between: str) -> Motion:
    """The motion q(s(t)), exact; ``laws`` holds s as ascending powers of t − t_k on each piece.

    No knot of the path may lie inside a piece: stations include the knots.
    """
    degree = (path.c.shape[0] - 1) * (max(len(law) for law in laws) - 1)
    if degree >= POWERS:
        raise ValueError(f"degree {degree}: too high to be judged")
    rows = []
    for law, (begin, end) in zip(laws, pairwise(times), strict=True):
        middle = float(np.polyval(law[::-1], 0.5 * (end - begin)))
        inner = np.array(law, dtype=np.float64)
        outer = on_path(path, float(inner[0]), middle)
        inner[0] = 0.0
        rows.append(composed(outer, inner, degree + 1))
    c = np.stack(rows, axis=1)[::-1]
    return Motion.of_polynomial(PPoly(c, np.asarray(times)), (), between)


def steps(grid: Array, squares: Array) -> tuple[list[float], list[Array]]:
    """Times and laws of a path speed whose square is ``squares`` at ``grid``, linear between."""
    times, laws = [0.0], []
    speeds = np.sqrt(np.maximum(squares, 0.0))
    for k in range(grid.size - 1):
        way = grid[k + 1] - grid[k]
        push = (speeds[k + 1] ** 2 - speeds[k] ** 2) / (2.0 * way)
        laws.append(np.array([grid[k], speeds[k], 0.5 * push]))
        times.append(times[-1] + 2.0 * way / (speeds[k] + speeds[k + 1]))
    return times, laws


def third_order(path: PPoly, stations: Array, profile: Any, times: Array) -> Motion:
    """The motion of copp's TOPP3 profile on a path.

    Parameters
    ----------
    path : PPoly
        q(s), its knots among the stations.
    stations, times : ndarray
        s and the arrival times that ``s_to_t_topp3`` gives.
    profile
        copp's ``Profile3rd``: a = s'², b = s'' at the stations, and how many intervals at either
        end are stationary (s cubic in t).
    """
    a, b = np.asarray(profile.a), np.asarray(profile.b)
    head, tail = profile.num_stationary
    last = stations.size - 1
    breaks: list[float] = [float(times[0])]
    rows: list[Array] = []

    def add(law: Array, begin: float, end: float, near: float) -> None:
        """One piece; ``law`` is s by powers of t less the middle."""
        inner = law.copy()
        inner[0] = 0.0
        outer = on_path(path, float(law[0]), near)
        rows.append(shifted(composed(outer, inner, POWERS), -0.5 * (end - begin)))
        breaks.append(end)

    def cubic(k: int, anchor: float, at: float, size: float) -> None:
        """A stationary interval: s = anchor + size·(t − at)³."""
        for begin, end in pairwise(np.linspace(times[k], times[k + 1], 9).tolist()):
            d = 0.5 * (begin + end) - at
            law = np.array([anchor + size * d**3, 3 * size * d * d, 3 * size * d, size])
            add(law, begin, end, 0.5 * (stations[k] + stations[k + 1]))

    for k in range(last):
        way = stations[k + 1] - stations[k]
        if k < head:
            size = a[head] ** 1.5 / (27.0 * (stations[head] - stations[0]) ** 2)
            cubic(k, float(stations[0]), float(times[0]), size)
            continue
        if k >= last - tail:
            size = a[last - tail] ** 1.5 / (27.0 * (stations[last] - stations[last - tail]) ** 2)
            cubic(k, float(stations[last]), float(times[last]), size)
            continue
        slope = (b[k + 1] - b[k]) / way
        # copp integrates the last ordinary interval, and one that ends at rest, from its right end.
        right = a[k] != 0.0 and (k == last - tail - 1 or a[k + 1] == 0.0)
        anchor = k + 1 if right else k
        length = times[k + 1] - times[k]
        growth = (
            abs(b[anchor]) * length / max(math.sqrt(a[anchor]), abs(b[anchor]) * length, 1e-300)
        )
        count = math.ceil(
            max(1.0, 0.5 * length * math.sqrt(abs(slope)) / _STEP, 0.5 * growth / _SHARE)
        )
        for begin, end in pairwise(np.linspace(times[k], times[k + 1], count + 1).tolist()):
            law = _swing(
                math.sqrt(a[anchor]), b[anchor], slope, 0.5 * (begin + end) - times[anchor]
            )
            law[0] += stations[anchor]
            add(law, begin, end, 0.5 * (stations[k] + stations[k + 1]))
    c = np.stack(rows, axis=1)[::-1]
    return Motion.of_polynomial(PPoly(c, np.asarray(breaks)), (), "copp's profile of third order")


def _swing(speed: float, push: float, slope: float, at: float) -> Array:
    """Taylor series about ``at`` of u with u'' = push + slope·u, u(0) = 0, u'(0) = speed."""
    root = np.sqrt(complex(slope)) * at
    if abs(root) < 1e-4:
        sine, cosine = 1.0 + slope * at * at / 6.0, 0.5 + slope * at * at / 24.0
    else:
        sine = float((np.sinh(root) / root).real)
        # cosh − 1 over its square by its half angle: no digits are lost where the root is small.
        cosine = float((0.5 * (np.sinh(0.5 * root) / (0.5 * root)) ** 2).real)
    law = np.zeros(POWERS)
    law[0] = speed * at * sine + push * at * at * cosine
    law[1] = speed * (1.0 + slope * at * at * cosine) + push * at * sine
    law[2] = 0.5 * (push + slope * law[0])
    for k in range(3, POWERS):
        law[k] = slope * law[k - 2] / (k * (k - 1))
    return law


def joined(motions: Sequence[Motion]) -> Motion:
    """Motions one after another."""
    rows, breaks = [], [0.0]
    powers = max(m.scaled.shape[1] for m in motions)
    for one in motions:
        for k in range(one.durations.size):
            c = np.zeros((powers, len(one.joints)))
            c[: one.scaled.shape[1]] = one.scaled[k] / one.durations[k] ** np.arange(
                one.scaled.shape[1]
            ).reshape(-1, 1)
            rows.append(c)
            breaks.append(breaks[-1] + float(one.durations[k]))
    c = np.stack(rows, axis=1)[::-1]
    return Motion.of_polynomial(PPoly(c, np.asarray(breaks)), (), "motions one after another")
