"""Rows that hold for every motion, in floats: as a matrix, and chosen where a point breaks them.

The verifier has them in rational numbers, and says why they hold: `verify/any_curve.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ....problem import Array
from ....verify import TANGENT_UNIT
from .question import FreeQuestion

Ints = NDArray[np.int64]
"""Rows: kind, segment, joint, sign, two slopes of tangents, velocity limit over peak speed; the
last three times `TANGENT_UNIT`. The sign mirrors the joint so that it does not go back."""

KINDS = ("reach", "brake", "change")
"""Names of the kinds of rows in a certificate, in the order of the integers."""
REACH, BRAKE, CHANGE = range(3)
"""The kinds as integers."""
_LARGEST = 2**53 // TANGENT_UNIT
"""Largest slope in a row: times `TANGENT_UNIT` it is an integer that a float holds exactly."""


@dataclass(frozen=True, eq=False)
class Floats:
    """The question in floats, in units of the joints' own steps and of a time.

    Attributes
    ----------
    ways, signs : ndarray, shape (segments, joints)
        |displacement|, and its sign (1 for none).
    speed, acceleration : ndarray, shape (joints,)
        NaN acceleration where there is no limit.
    ends : ndarray, shape (2, joints)
        NaN where free.
    time : float
        Unit of time, s.
    angle : ndarray, shape (joints,)
        Units of angle.
    """

    ways: Array
    signs: Array
    speed: Array
    acceleration: Array
    ends: Array
    time: float
    angle: Array


def floats(asked: FreeQuestion, speeds: Sequence[Fraction], time: float) -> Floats:
    """Scale a question for a linear program."""
    steps = np.array([[float(x) for x in row] for row in asked.steps])
    angle = np.abs(steps).max(axis=0)
    a = np.array([np.nan if x is None else float(x[1]) for x in asked.acceleration])
    angle = np.where(angle > 0, angle, np.where(np.isnan(a), 1.0, a) * time**2)
    ends = np.array([[np.nan if x is None else float(x) for x in side] for side in asked.ends])
    return Floats(
        np.abs(steps) / angle,
        np.where(steps < 0, -1.0, 1.0),
        np.array([float(v) for v in speeds]) * time / angle,
        a * time**2 / angle,
        ends * time / angle,
        time,
        angle,
    )


def matrix(scaled: Floats, rows: Ints, low: Array, high: Array) -> tuple[csr_array, Array, Array]:
    """Rows for a linear program over (durations, speeds at way-points in C order).

    Parameters
    ----------
    scaled : Floats
    rows : ndarray, shape (rows, 7)
        As `Ints` has them.
    low, high : ndarray, shape (segments,)
        The box, scaled.

    Returns
    -------
    matrix : csr_array, shape (rows, segments + way-points·joints)
    right : ndarray
        Matrix times unknowns ≥ right; each row's largest entry is 1.
    size : ndarray
        What each row was divided by.
    """
    kind, k, j, sign = rows[:, :4].T
    a, b, c = rows[:, 4:].T / TANGENT_UNIT
    segments, joints = scaled.ways.shape
    way, top, bend = scaled.ways[k, j], scaled.speed[j], scaled.acceleration[j]
    with np.errstate(divide="ignore", invalid="ignore"):
        n = c / top
        peak = (2 * a - a * a + 2 * b - b * b) / (2 * bend) - way * n * n
        chord = way / (low[k] * high[k])
        brake = -np.abs(1 - a - b) * top - way * (1 / low[k] + 1 / high[k])
    time = np.choose(kind, [np.ones_like(a), bend * (a * a + b * b) / 2 - chord, bend])
    start = np.choose(kind, [a / bend, -a, np.ones_like(a)]) * sign
    end = np.choose(kind, [b / bend, -b, -np.ones_like(a)]) * sign
    right = np.choose(kind, [2 * way * n + np.minimum(0.0, peak * top), brake, np.zeros_like(a)])
    size = np.maximum.reduce([np.abs(time), np.abs(start), np.abs(end)])
    at = segments + k * joints + j
    shape = (len(rows), segments + (segments + 1) * joints)
    values = np.stack([time, start, end], axis=1) / size[:, None]
    columns = np.stack([k, at, at + joints], axis=1)
    pointers = 3 * np.arange(len(rows) + 1)
    return csr_array((values.ravel(), columns.ravel(), pointers), shape), right / size, size


def change_rows(scaled: Floats) -> Ints:
    """All rows |v₁ − v₀| ≤ A·h."""
    segments, joints = scaled.ways.shape
    found = [
        (CHANGE, k, j, sign, 0, 0, 0)
        for k in range(segments)
        for j in range(joints)
        if np.isfinite(scaled.acceleration[j])
        for sign in (1, -1)
    ]
    return np.array(found, dtype=np.int64).reshape(-1, 7)


def reach_rows(scaled: Floats, h: Array, v: Array, tolerance: float) -> Ints:
    """Tangents of the least time for a displacement, where ``h`` is shorter than it.

    The least time is (d + ((p − v₀)² + (p − v₁)²)/2A)/p at its least over p ≤ V, which is at
    p = min(V, √(A d + (v₀² + v₁²)/2)). A row touches it there with slopes (p − v)/p and n = 1/p.

    Parameters
    ----------
    scaled : Floats
    h : ndarray, shape (segments,)
    v : ndarray, shape (way-points, joints)
    tolerance : float
        In units of time.

    Returns
    -------
    ndarray, shape (rows, 7)
    """
    found = []
    for mirror in (1.0, -1.0):
        sign = scaled.signs * mirror
        start, end = sign * v[:-1], sign * v[1:]
        squares = (start**2 + end**2) / 2
        top, bend, way = scaled.speed, scaled.acceleration, scaled.ways
        peak = np.minimum(top, np.sqrt(bend * way + squares))
        with np.errstate(divide="ignore", invalid="ignore"):
            least = (way + ((peak - start) ** 2 + (peak - end) ** 2) / (2 * bend)) / peak
            wanted = (least > h[:, None] + tolerance) & (top < _LARGEST * peak)
        if mirror < 0:
            wanted &= way == 0
        k, j = np.nonzero(wanted)
        p = peak[k, j]
        slopes = [(p - x[k, j]) / p for x in (start, end)]
        found.append(_rows(REACH, k, j, sign[k, j], [*slopes, top[j] / p]))
    return np.concatenate(found)


def brake_rows(
    scaled: Floats, h: Array, v: Array, low: Array, high: Array, tolerance: float
) -> tuple[Ints, Array]:
    """Tangents of the least that can be covered, where ``v`` is too fast for the displacement.

    Braking to −p and back covers −p h + ((p + v₀)² + (p + v₁)²)/2A at the least, which is at
    p = min(V, (A h − v₀ − v₁)/2). A row touches it there with slopes (p + v)/(A h).

    Parameters
    ----------
    scaled : Floats
    h, v : ndarray
        As in `reach_rows`.
    low, high : ndarray, shape (segments,)
        The box.
    tolerance : float
        In units of time.

    Returns
    -------
    rows : ndarray, shape (rows, 7)
    excess : ndarray, shape (segments, joints)
        By how much the true condition, without the chord, is broken, in units of time.
    """
    time = h[:, None]
    start, end = scaled.signs * v[:-1], scaled.signs * v[1:]
    bend, way = scaled.acceleration, scaled.ways
    free = (bend * time - start - end) / 2
    peak = np.minimum(scaled.speed, free)
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = ((peak + start) ** 2 + (peak + end) ** 2) / (2 * bend * time) - peak
        chord = way * ((1 / low + 1 / high - h / (low * high))[:, None])
        excess = (lost - way / time) / bend
        wanted = ((lost - chord) / bend > tolerance) & (way > 0) & (low > 0)[:, None]
        slopes = [(peak + x) / (bend * time) for x in (start, end)]
        wanted &= np.maximum.reduce(np.abs(slopes)) < _LARGEST
    k, j = np.nonzero(wanted)
    a, b = (x[k, j] for x in slopes)
    rows = _rows(BRAKE, k, j, scaled.signs[k, j], [a, b, np.zeros_like(a)])
    # Below the cap the two slopes add up to 1 exactly; rounding must not break that.
    inside = (free < scaled.speed)[k, j]
    rows[inside, 5] = TANGENT_UNIT - rows[inside, 4]
    return rows, np.where((way > 0) & np.isfinite(excess), excess, 0.0)


def _rows(kind: int, k: Ints, j: Ints, sign: Array, parameters: list[Array]) -> Ints:
    numbers = [np.rint(x * TANGENT_UNIT).astype(np.int64) for x in parameters]
    whole = np.rint(sign).astype(np.int64)
    return np.stack([np.full(len(k), kind), k, j, whole, *numbers], axis=1).astype(np.int64)
