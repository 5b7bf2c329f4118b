"""The NLP of the optimum over all C1 curves: one local optimum from one start, made feasible."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import TOLERANCE
from ...clock import seconds_left
from ...optimum import ca
from .reach import reachable

CAPS = (0.25, 2.0, 16.0, 128.0)
"""Seconds that one call of IPOPT may take: it cannot be told to stop, and its limit is compiled in.
A factor of 8 apart, so a long run compiles few; below the first, a call ends anyway."""


def call_cap() -> float | None:
    """Longest time of a call of IPOPT that begins now, s; None without a limit."""
    left = seconds_left()
    if left == math.inf:
        return None
    return max((cap for cap in CAPS if cap <= left), default=CAPS[0])


@dataclass(frozen=True, eq=False)
class LocalQuestion:
    """What is left of a problem.

    Attributes
    ----------
    steps : ndarray, shape (segments, joints)
        Displacements between way-points of the joints that matter, rad.
    velocity, acceleration : ndarray, shape (joints,)
        Limits; rad/s, rad/s².
    lower, upper : ndarray, shape (segments,)
        Duration bounds, s.
    ends : ndarray, shape (2, joints)
        Velocities prescribed at start and end, rad/s; NaN if free.
    """

    steps: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    ends: NDArray[np.float64]


def starting_points(
    question: LocalQuestion, count: int, generator: np.random.Generator, given: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Durations with a standstill at every way-point, random multiples of them, given ones."""
    d, v, a = np.abs(question.steps), question.velocity, question.acceleration
    with np.errstate(invalid="ignore"):
        cruising = d / v + v / a
    h = np.where(np.sqrt(d * a) < v, 2.0 * np.sqrt(d / a), cruising).max(axis=1)
    factors = 10.0 ** generator.uniform(-0.5, 0.5, (max(count - 1, 0), h.size))
    points = np.vstack([h, h * factors, given]) if count > 0 else np.vstack([h, given])
    smallest = 1e-3 * h.max()
    low = np.maximum(question.lower, smallest)
    return np.asarray(np.clip(points, low, np.maximum(question.upper, low)))


@lru_cache(maxsize=32)
def _solver(segments: int, joints: int, cap: float | None) -> Any:
    """IPOPT on durations h, nodal velocities v, upward and downward peak speeds."""
    h = ca.SX.sym("h", segments)
    v = ca.SX.sym("v", segments + 1, joints)
    peaks = [ca.SX.sym(name, segments, joints) for name in ("up", "down")]
    steps = ca.SX.sym("steps", segments, joints)
    acceleration = ca.SX.sym("acceleration", 1, joints)
    wide = ca.mtimes(h, ca.SX.ones(1, joints))
    a = ca.mtimes(ca.SX.ones(segments, 1), acceleration)
    v0, v1 = v[:-1, :], v[1:, :]
    rows = [a * wide - (v1 - v0), a * wide + (v1 - v0)]
    for p, sign in zip(peaks, (1.0, -1.0), strict=True):
        lost = (p - sign * v0) ** 2 + (p - sign * v1) ** 2
        rows.append(p * wide - lost / (2.0 * a) - sign * steps)
    nlp = {
        "x": ca.vertcat(h, ca.vec(v), *[ca.vec(p) for p in peaks]),
        "p": ca.vertcat(ca.vec(steps), acceleration.T),
        "f": ca.sum1(h),
        "g": ca.vertcat(*[ca.vec(row) for row in rows]),
    }
    options: dict[str, Any] = {
        "print_time": False,
        "show_eval_warnings": False,  # the status says where a function is not defined
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-10,
        "ipopt.constr_viol_tol": 1e-11,
        "ipopt.compl_inf_tol": 1e-11,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.honor_original_bounds": "yes",
        "ipopt.acceptable_iter": 0,
        "ipopt.max_iter": 300,
    }
    if cap is not None:
        options["ipopt.max_wall_time"] = cap
    return ca.nlpsol("estimate_any_curve", "ipopt", nlp, options)


def local_optimum(
    question: LocalQuestion, start: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Durations and nodal velocities of a local optimum, exactly feasible, or None."""
    n, joints = question.steps.shape
    time_unit = float(start.mean())
    angle = np.abs(question.steps).max(axis=0)
    angle = np.where(angle > 0, angle, question.acceleration * time_unit**2)
    steps = question.steps / angle
    cap = question.velocity * time_unit / angle
    a = question.acceleration * time_unit**2 / angle
    h = start / time_unit
    low = np.maximum(question.lower, 1e-6 * time_unit) / time_unit
    v = _slopes(steps, h, cap)
    v_low, v_high = np.tile(-cap, (n + 1, 1)), np.tile(cap, (n + 1, 1))
    for at, end in zip((0, n), question.ends, strict=True):
        prescribed = np.isfinite(end)
        for values in (v, v_low, v_high):
            values[at, prescribed] = (end * time_unit / angle)[prescribed]
    up = np.minimum(cap, (v[:-1] + v[1:] + a * h[:, None]) / 2)
    down = np.minimum(cap, (-v[:-1] - v[1:] + a * h[:, None]) / 2)
    tall = np.tile(cap, (n, 1)).ravel("F")
    free = np.full(n * joints, -np.inf)
    # Up to this size a call of IPOPT ends by itself in less than a second.
    solver = _solver(n, joints, call_cap() if n * joints > 16 else None)
    given = {
        "x0": np.concatenate([h, *[part.ravel("F") for part in (v, up, down)]]),
        "p": np.concatenate([steps.ravel("F"), a]),
        "lbx": np.concatenate([low, v_low.ravel("F"), free, free]),
        "ubx": np.concatenate(
            [np.maximum(question.upper / time_unit, low), v_high.ravel("F"), tall, tall]
        ),
    }
    x = np.asarray(solver(**given, lbg=0.0, ubg=np.inf)["x"]).ravel()
    if not np.isfinite(x).all():
        return None
    velocities = x[n : n + (n + 1) * joints].reshape((n + 1, joints), order="F")
    return _repaired(question, x[:n] * time_unit, velocities * angle / time_unit)


def _slopes(
    steps: NDArray[np.float64], h: NDArray[np.float64], cap: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Nodal velocities to start from: 0 at reversals, else the smaller neighbouring slope."""
    slope = steps / h[:, None]
    before = np.vstack([np.zeros_like(slope[:1]), slope])
    after = np.vstack([slope, np.zeros_like(slope[:1])])
    smaller = np.where(np.abs(before) < np.abs(after), before, after)
    return np.asarray(np.clip(np.where(before * after > 0, smaller, 0.0), -cap, cap))


def _repaired(
    question: LocalQuestion, h: NDArray[np.float64], v: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """The answer stretched uniformly by as little as makes it feasible in our own arithmetic."""
    h = np.maximum(h, question.lower)

    def stretched(c: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        w = np.clip(v / c, -question.velocity, question.velocity)
        for at, end in zip((0, -1), question.ends, strict=True):
            w[at] = np.where(np.isfinite(end), end, w[at])
        return h * c, w

    def keeps(c: float) -> bool:
        longer, w = stretched(c)
        limits = (question.velocity, question.acceleration)
        inside = reachable(question.steps, w[:-1], w[1:], longer[:, None], *limits)
        return bool(inside.all() and (longer <= question.upper * (1 + TOLERANCE)).all())

    if keeps(1.0):
        return stretched(1.0)
    low, high = 0.0, 1e-15
    while not keeps(1.0 + high):
        low, high = high, 4.0 * high
        if high > 1e-6:  # no repair of a solver's tolerance
            return None
    for _ in range(6):
        middle = (low + high) / 2
        low, high = (low, middle) if keeps(1.0 + middle) else (middle, high)
    return stretched(1.0 + high)
