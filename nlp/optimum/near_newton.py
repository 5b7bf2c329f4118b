"""Durations near an optimum that are as long or as short as their cap allows, by Newton steps.

In front of the way by IPOPT: the limits and their curvature are those of the descents of `newton`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...problem import Array, Problem
from . import newton_curve as kernel
from .descent import KEPT, least_point
from .newton import Descents, covered

STEPS = 40
"""Most steps; six to twelve suffice."""
SETTLED = 1e-9
"""Step in log durations at which the search ends: the next one would be its square."""
FIRST = 2.0
"""Trust region at the start, in square roots of the slack: where an optimum is flat, a slack is
used up as far away as its square root."""
SMALLEST = 1e-10
"""Trust region at which the search gives up."""
HEAVY, HEAVIEST = 10.0, 1e8
"""Weight of the worst excess, at the start and where the search gives up."""
GOOD = 0.4
"""Share of the expected gain from which the trust region grows: as in `newton_kernel`."""
BEND = 0.05
"""Least curvature of the quadratic programs: less would not be felt inside the trust region."""
_curve_at = kernel.curve_at
"""The curve of one vector; compiling it takes some seconds."""
_rows_at = kernel.rows_at
"""Its extrema; compiling it takes some seconds."""
_add_curvature = kernel.add_curvature
"""The curvature of one of them; compiling it takes some seconds."""


class _Joint:
    """The limits of one joint near its optimum, and the cap on its total."""

    def __init__(self, problem: Problem, cap: float) -> None:
        arrays: tuple[Any, ...] = Descents(problem).arrays
        (
            self.values, self.kinds, self.breaks, self.orders, self.degrees, self.column,
            self.smooth, self.inverse_limits, self.ranges, self.span, self.perm, self.places, _,
            self.system, self.right, self.work, *_,
        ) = arrays  # fmt: skip
        with np.errstate(divide="ignore"):
            self.low, self.high = np.log(problem.duration_lower), np.log(problem.duration_upper)
        self.cap = cap

    def rows(self, z: Array) -> tuple[Array, Array] | None:
        """Excess and gradient of every limit near it, the cap last; None without a curve."""
        x, slopes, inverse, excess, gradient, s_of, place = self.places
        regular = _curve_at(
            z, self.values, self.kinds, self.breaks, self.orders, self.degrees, self.column,
            self.perm, inverse, x, slopes, True, self.system, self.right,
        )  # fmt: skip
        if not regular:
            return None
        count, _, _ = _rows_at(
            z, self.degrees, self.smooth, self.inverse_limits, self.ranges, self.span, self.perm,
            x, slopes, True, excess, gradient, place, s_of, kernel.NEAR, self.work,
        )  # fmt: skip
        h = np.exp(z)
        total = float(h.sum())
        over = np.append(excess[:count], np.log(total / self.cap))
        return over, np.vstack([gradient[:count], h / total])

    def curvature(self, z: Array, weights: Array) -> Array:
        """Second derivatives of the weighted excesses of the last `rows`, which were at ``z``."""
        x, slopes, inverse, _, _, s_of, place = self.places
        n = z.size
        share = np.exp(z) / np.exp(z).sum()
        bent: Array = weights[-1] * (np.diag(share) - np.outer(share, share))
        for i in np.flatnonzero(weights[:-1] > 0.0):
            _add_curvature(
                z, *place[i].tolist(), s_of[i], weights[i], self.values, self.kinds, self.breaks,
                self.orders, self.degrees, self.column, self.perm, self.span, inverse, x, slopes,
                bent, self.work[13], self.work[14], np.empty(n), np.empty(n), np.empty((n, n)),
            )  # fmt: skip
        return bent


def applies(problems: list[Problem]) -> bool:
    """Whether these steps know the curves and the limits of all problems."""
    return all(covered(problem) for problem in problems)


class _Program:
    """One objective over the durations of some joints, in log durations.

    Without weights the longest log duration of each segment comes last, and their sum of durations
    is made small; with weights that of the one joint's weighted durations.
    """

    def __init__(self, problems: list[Problem], caps: list[float], weights: Array | None) -> None:
        self.joints = [_Joint(p, cap) for p, cap in zip(problems, caps, strict=True)]
        self.n, self.weights, self.unit = problems[0].segments, weights, max(caps)
        own = len(problems) * self.n
        self.size = own if weights is not None else own + self.n
        self.counts: list[int] = []
        self.ties = np.zeros((self.size - self.n, self.size))
        if weights is None:
            self.ties[:, :own] = np.eye(own)
            self.ties[:, own:] = -np.tile(np.eye(self.n), (len(problems), 1))
        walls = np.full(self.size - own, np.inf)
        self.low = np.concatenate([*(joint.low for joint in self.joints), -walls])
        self.high = np.concatenate([*(joint.high for joint in self.joints), walls])

    def parts(self, z: Array) -> list[Array]:
        """Log durations of each joint."""
        return [z[i * self.n : (i + 1) * self.n].copy() for i in range(len(self.joints))]

    def slope(self, z: Array) -> Array:
        """Of the objective; its curvature is the same numbers on the diagonal."""
        slope = np.zeros(self.size)
        weights = np.ones(self.n) if self.weights is None else self.weights
        slope[-self.n :] = weights * np.exp(z[-self.n :]) / self.unit
        return slope

    def rows(self, z: Array) -> tuple[Array, Array] | None:
        """Excess and gradient of all limits and caps, of one joint after the other, then ties."""
        over, gradient, self.counts = [], [], []
        for i, (joint, own) in enumerate(zip(self.joints, self.parts(z), strict=True)):
            found = joint.rows(own)
            if found is None:
                return None
            wide = np.zeros((len(found[0]), self.size))
            wide[:, i * self.n : (i + 1) * self.n] = found[1]
            over.append(found[0])
            gradient.append(wide)
            self.counts.append(len(found[0]))
        return np.concatenate([*over, self.ties @ z]), np.vstack([*gradient, self.ties])

    def curvature(self, z: Array, gradient: Array, weights: Array) -> Array:
        """Of the Lagrangian at the last `rows`; where it is not convex, made so."""
        bent, at = np.diag(self.slope(z)), 0
        for i, (joint, own) in enumerate(zip(self.joints, self.parts(z), strict=True)):
            here = slice(i * self.n, (i + 1) * self.n)
            bent[here, here] += joint.curvature(own, weights[at : at + self.counts[i]])
            at += self.counts[i]
        # On rows that stay active this changes the multipliers alone.
        active = gradient[weights > 0.0]
        bent += active.T @ active
        values, vectors = np.linalg.eigh(bent)
        return np.asarray((vectors * np.maximum(values, BEND)) @ vectors.T)

    def step(
        self, bent: Array, z: Array, rows: tuple[Array, Array], radius: float, heavy: float
    ) -> tuple[Array, float, Array] | None:
        """The step of one quadratic program, the excess that it leaves, and its multipliers."""
        over, gradient = rows
        one = np.eye(self.size)
        up, down = np.minimum(self.high - z, radius), np.minimum(z - self.low, radius)
        matrix = np.zeros((len(over) + 2 * self.size + 1, self.size + 1))
        matrix[:-1, :-1] = np.vstack([gradient, one, -one])
        matrix[: sum(self.counts), -1] = matrix[-1, -1] = -1.0
        room = np.concatenate([-over, np.maximum(up, 0.0), np.maximum(down, 0.0), [0.0]])
        elastic = heavy * np.eye(self.size + 1)
        elastic[:-1, :-1] = bent
        found = least_point(elastic, np.append(self.slope(z), heavy), matrix, room)
        if found is None:
            return None
        return found[0][:-1], max(0.0, float(found[0][-1])), found[1][: len(over)]


def reached(
    problems: list[Problem], starts: list[Array], caps: list[float], weights: Array | None
) -> list[Array] | None:
    """Durations of each joint that optimise an objective near feasible ``starts``.

    Parameters
    ----------
    problems : list of Problem
        For which `applies` holds.
    starts : list of ndarray, shape (segments,)
        s, within the limits.
    caps : list of float
        Most total of each joint, s.
    weights : ndarray, shape (segments,), or None
        Of the durations of the one joint, in a sum that is made small; without them it is the sum
        over segments of the longest duration.

    Returns
    -------
    list of ndarray or None
        None where the steps do not settle at a point that meets the conditions of an optimum.
    """
    program = _Program(problems, caps, weights)
    z = np.log(np.concatenate([*starts, *([np.max(starts, axis=0)] if weights is None else [])]))
    rows = program.rows(z)
    if rows is None:
        return None
    price = np.zeros(len(rows[0]))
    slack = -max(rows[0][np.cumsum(program.counts) - 1])
    radius, heavy = FIRST * np.sqrt(max(slack, SMALLEST)), HEAVY
    for _ in range(STEPS):
        over, slope = rows[0], program.slope(z)
        step, left, bent = np.zeros(program.size), 0.0, np.empty(0)
        price = price if len(price) == len(over) else np.zeros(len(over))
        for _ in range(2):  # the second program has the curvature of the first one's multipliers
            bent = program.curvature(z, rows[1], price)
            found = program.step(bent, z, rows, radius, heavy)
            if found is None:
                return None
            step, left, price = found
        reach, worst = float(np.abs(step).max()), max(0.0, float(over.max()))
        if reach < min(SETTLED, 0.5 * radius) and worst <= KEPT:
            return [np.exp(own) for own in program.parts(z)]
        if left > 1e-10 and left > 0.9 * worst:
            heavy *= 10.0  # the weight is too small for the limits, here at least
            continue
        before = float(slope.sum()) + heavy * worst
        expected = heavy * (worst - left) - float(slope @ step)
        tried, best, gain = z + step, z, 0.0
        for turn in range(2):
            trial = program.rows(tried)
            if trial is None:
                break
            excess = max(0.0, float(trial[0].max()))
            after = before - float(program.slope(tried).sum()) - heavy * excess
            if after > gain:
                best, gain, rows = tried, after, trial
            if gain > GOOD * expected or turn:
                break
            # Limits bend: a second step from beyond them follows the valley.
            second = program.step(bent, tried, trial, reach, heavy)
            if second is None:
                break
            tried = tried + second[0]
        if gain > GOOD * expected:
            radius = min(1.0, max(radius, 2.0 * reach))
        elif gain < 0.1 * expected:
            radius = 0.5 * reach
        if radius < SMALLEST or heavy > HEAVIEST:
            return None
        z = best
        again = program.rows(z) if best is not tried else rows
        if again is None:
            return None
        rows = again
    return None
