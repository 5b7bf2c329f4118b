"""What a certificate states, read a second time, and the least total that brute force can show."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from attacks.batch import form_of, searched, settled
from attacks.curves import Array, Asked, NoCurve, excess
from attacks.declared import Declared

UNIFORM = "uniform cubic B-spline, segments stretched in time"
"""Name of the one curve that is no declared polynomial and has proofs."""
_DEFAULT_SPEEDS = 400
"""Random speeds at the way-points that are tried for any curve."""
_GRID = np.exp(np.linspace(0.0, math.log(8.0), 400))
"""Durations of a span that are tried, as multiples of the least that any joint needs."""


def asked_in(document: dict[str, Any]) -> Asked | None:
    """The question of a certificate; None if it cannot be read that way."""
    try:
        return _asked(document["problem"])
    except (KeyError, TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError):
        return None


def _real(value: Any, absent: float) -> float:
    if value is None:
        return absent
    if isinstance(value, dict):
        return float(Fraction(value["value"])) * math.pi ** value["pi"]
    return float(Fraction(value))


def _each(value: Any, joints: int) -> Array:
    """A number for all joints, or a list with one for each."""
    if not isinstance(value, list):
        return np.full(joints, _real(value, 0.0))
    if len(value) != joints:
        raise ValueError(value)
    return np.array([_real(x, 0.0) for x in value])


def _asked(problem: dict[str, Any]) -> Asked:
    way = np.array([[_real(x, 0.0) for x in row] for row in problem["waypoints"]])
    pairs = [[x if isinstance(x, list) else [x, x] for x in row] for row in problem["limits"]]
    below = np.array([[abs(_real(low, -np.inf)) for low, _ in row] for row in pairs])
    limits = np.array([[_real(high, np.inf) for _, high in row] for row in pairs])
    low, high = (
        np.array([_real(x, side) for x in problem[key]])
        for key, side in (("position_lower", -np.inf), ("position_upper", np.inf))
    )
    first = np.array([_real(x, 0.0) for x in problem["duration_lower"]])
    last = np.array([_real(x, np.inf) for x in problem["duration_upper"]])
    if "degrees" in problem:
        form = Declared(
            tuple(problem["degrees"]),
            tuple(problem["continuity"]),
            tuple(tuple((r, _each(v, way.shape[1])) for r, v in b) for b in problem["prescribed"]),
            tuple(problem["virtual"]),
        )
        block: dict[str, Any] = {"family": "stated", "declared": form}
        rest = [v for entries in form.prescribed for _, each in entries for v in np.ravel(each)]
        # Told only so that nothing counts on a stretch: the form itself has the values.
        ends = {1: np.ones(way.shape[1])} if any(rest) else {}
    elif problem["curve"] == UNIFORM:
        block, ends = {"family": "uniform-cubic-b-spline", "time": "stretched"}, {}
    else:
        raise ValueError(problem["curve"])
    shapes = (way.shape[1], *limits.shape, len(low), len(high), len(last))
    if shapes != (way.shape[1], way.shape[1], 3, way.shape[1], way.shape[1], len(first)):
        raise ValueError(f"shapes {shapes}")
    return Asked(block, way, *limits.T, low, high, first, last, ends=ends, below=below)


def claimed(document: dict[str, Any]) -> Array | None:
    """Durations that a certificate states as its answer."""
    try:
        h = np.array([float(Fraction(x)) for x in document["claim"]["durations"]])
    except (KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError):
        return None
    return h


def least_declared(asked: Asked, seed: int, known: list[Array]) -> float:
    """The least total that samples show to be feasible on the declared curve; inf if none."""
    if asked.family == "uniform-cubic-b-spline":
        return _alone(asked)
    form = form_of(asked)
    assert form is not None
    best = np.inf
    try:
        for h in known:
            if h.shape == (asked.segments,) and (h > 0).all() and np.isfinite(h).all():
                kept = _repaired(asked, form, h)
                best = min(best, kept)
        found = searched(asked, form, seed, 2.0, 80)
    except (np.linalg.LinAlgError, FloatingPointError, NoCurve):
        return best
    return best if found is None else min(best, found[0])


def _repaired(asked: Asked, form: Declared, h: Array) -> float:
    try:
        if excess(asked, h)[1] <= 1:
            return float(h.sum())
    except (NoCurve, np.linalg.LinAlgError):
        return np.inf
    found = settled(asked, form, h)
    return np.inf if found is None else found[0]


def _alone(asked: Asked) -> float:
    """Each segment by itself: limits that samples show to hold, by the samples of one motion."""
    from attacks.curves import pieces

    n = asked.segments
    h = np.zeros(n)
    places = (1 - np.cos(np.pi * np.linspace(0, 1, 2001))) / 2
    for j, joint in enumerate(pieces(asked, np.ones(n))):
        for k, piece in enumerate(joint):
            q, *values = piece.at(places)
            if q.min() < asked.position_lower[j] or q.max() > asked.position_upper[j]:
                return np.inf
            for r, value in enumerate(values, 1):
                more = (piece.excess - 1) * float(np.abs(value).max())
                for reach, limit in zip(
                    (-float(value.min()), float(value.max())), asked.sides[:, j, r - 1], strict=True
                ):
                    if reach > 1e-12:
                        if limit == 0:
                            return np.inf
                        h[k] = max(h[k], ((reach + more) / limit) ** (1 / r))
    h = np.maximum(h, asked.duration_lower)
    return float(h.sum()) if (h <= asked.duration_upper).all() else np.inf


def least_any(asked: Asked, ends: tuple[Any, Any], speeds: Array | None, seed: int) -> float:
    """The least total of motions of bounded velocity and acceleration that are found.

    Between two way-points with given speeds a joint can go any way between the two that it makes
    by bending one way at full acceleration and then the other, held at its fastest.
    """
    rng = np.random.default_rng(seed)
    # A bound over any curve speaks of the larger side.
    v_max, a_max, _ = asked.sides.max(axis=0).T
    way = asked.waypoints
    n, joints = way.shape
    moved = np.ptp(way, axis=0) + 1e-9
    # Where nothing limits the acceleration, one that takes a thousandth of the way is enough.
    a_max = np.where(np.isfinite(a_max), a_max, 1e3 * v_max**2 / moved)
    if not np.isfinite(a_max).all() or not (a_max > 0).all():
        return np.inf
    fast = np.where(np.isfinite(v_max), v_max, np.sqrt(a_max * np.ptp(way, axis=0) * n))
    bounds = _spans(asked)
    best = np.inf
    given = np.zeros((n, joints)) if speeds is None else speeds
    for trial in range(_DEFAULT_SPEEDS):
        v = (
            given
            if trial < 2
            else given + rng.normal(size=given.shape) * fast * 0.5 ** (trial % 12)
        )
        if trial == 1:
            v = np.zeros((n, joints))
        v = np.clip(v, -fast, fast)
        for k, end in zip((0, -1), ends, strict=True):
            if end is not None:
                v[k] = end
        if (np.abs(v) > v_max).any():
            continue
        total = _total(way, v, v_max, a_max, bounds)
        if total < best:
            best, given = total, v
    return best


def _spans(asked: Asked) -> tuple[Array, Array]:
    """Bounds on the durations between way-points: virtual breaks join two."""
    form = form_of(asked)
    breaks = list(range(asked.segments + 1)) if form is None else form.breaks
    low = [asked.duration_lower[a:b].sum() for a, b in pairwise(breaks)]
    high = [asked.duration_upper[a:b].sum() for a, b in pairwise(breaks)]
    return np.array(low), np.array(high)


def _total(way: Array, v: Array, v_max: Array, a_max: Array, bounds: tuple[Array, Array]) -> float:
    total = 0.0
    for k in range(len(way) - 1):
        step, v0, v1 = way[k + 1] - way[k], v[k], v[k + 1]
        least = np.maximum(np.abs(v1 - v0) / a_max, np.abs(step) / v_max).max()
        first = max(float(least), float(bounds[0][k]), 1e-12 + 1e-3 * _quick(step, a_max))
        h = first * _GRID
        h = h[h <= bounds[1][k]]
        fits = np.ones(len(h), dtype=bool)
        for j in range(len(step)):
            fits &= _reaches(step[j], h, v0[j], v1[j], v_max[j], a_max[j])
        if not fits.any():
            return np.inf
        total += float(h[np.argmax(fits)])
    return total


def _quick(step: Array, a_max: Array) -> float:
    return float(np.sqrt(2 * np.abs(step) / a_max).max())


def _reaches(d: float, h: Array, v0: float, v1: float, v_max: float, a_max: float) -> Any:
    """Whether a way can be gone in each of some durations."""
    room = np.abs(v1 - v0) <= a_max * h * (1 - 1e-12)
    return (
        room
        & (d <= _farthest(h, v0, v1, v_max, a_max))
        & (-d <= _farthest(h, -v0, -v1, v_max, a_max))
    )


def _farthest(h: Array, v0: float, v1: float, v_max: float, a_max: float) -> Array:
    peak = (a_max * h + v0 + v1) / 2
    held = np.maximum(peak - v_max, 0.0) if np.isfinite(v_max) else np.zeros(len(h))
    # Cut off above v_max: two triangles of height ``held``, each held/a long.
    return (2 * peak**2 - v0**2 - v1**2) / (2 * a_max) - held**2 / a_max
