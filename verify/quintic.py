"""Proof of a lower bound for C4 quintic splines: boxes, windows, and batches of leaves.

The argument is that of docs/explanation/certificates-quintic.md.
"""

from __future__ import annotations

from fractions import Fraction
from math import sqrt
from typing import Any

import numpy as np

from . import ranges
from .boxes import Array, Boxes, Rows, Sides
from .floors import least_durations
from .problem import Declaration, in_own_units
from .quintic_bound import ROUND, Centre, Task
from .reading import listed, need, number, whole


class QuinticSpline(Boxes):
    """Boxes in the simplex of durations whose sum is the total; windows beside weighted limits."""

    keys = ("powers", "second", "low", "windows", "rows")
    centres = Centre

    def read(self, proof: dict[str, Any]) -> None:
        """Steps and limits in units of the proof, least durations, windows, and rows."""
        super().read(proof)
        problem, total, clock = self.problem, self.total, self.clock
        n, joints = problem.segments, problem.joints
        rest = {order: [Fraction(0)] * joints for order in (1, 2)}
        spline = Declaration([5] * n, [4] * (n - 1), [rest, *[{}] * (n - 1), rest], [])
        need(
            n > 1 and problem.declaration == spline,
            "declaration not covered: no C4 quintic spline at rest at the ends",
        )
        longest, most = ranges.MOST_QUINTIC_SEGMENTS, ranges.MOST_QUINTIC_JOINTS
        need(n <= longest, f"more than {longest} segments")
        need(joints <= most, f"more than {most} joints")
        second, steps, limits = in_own_units(problem, proof)
        own = total / second
        need(
            ranges.within(own, ranges.SHORTEST_TOTAL) and Fraction(float(own)) == own,
            "a total that is not a float of usual size is not proved",
        )
        sizes = [abs(d) for row in steps for d in row if d]
        sizes += [x for row in limits for x in row if x is not None]
        usual = all(ranges.within(x, ranges.SMALLEST) for x in sizes)
        need(usual, "a number is of unusual size")
        self.most = float(own)
        self.task = Task(
            np.array([[float(x) for x in row] for row in steps]),
            np.array([[np.inf if x is None else float(x) for x in row] for row in limits]),
            self.most,
        )
        windows = listed(proof["windows"], "windows", ranges.MOST_WINDOWS)
        self.windows = self._terms([_window(w, n, joints) for w in clock.each(windows)])
        self.rows = self.read_rows(proof["rows"], 1, ranges.QUINTIC_PLACES)
        self.shortest, self.longest = [], [self.most] * n
        proved = least_durations(problem, total)
        for k, stated in enumerate(listed(proof["low"], "low", n, n)):
            x = number(stated)
            need(
                Fraction(float(x / second)) == x / second >= 0 and x <= proved[k],
                f"segment {k + 1}: its least duration is not proved",
            )
            self.shortest.append(float(x / second))
        self.together(16 * n**3)

    @staticmethod
    def middle(low: float, high: float) -> float:
        """The geometric mean, or nearer to 0 where the side may begin there."""
        return sqrt(low * high) if 0.0 < 0.1 * high < low else 0.3 * high

    def leaf(self, box: Sides, data: list[Any]) -> None:
        """[window, τ], or as any kind has it."""
        if len(data) == 2:
            which, exact = whole(data[0], 0, len(self.windows[0]) - 1), number(data[1])
            usual = exact == 0 or ranges.within(abs(exact), ranges.LEAST_TAU)
            need(usual, "a window's tau is of unusual size")
            data = [which, float(exact)]
        super().leaf(box, data)

    def end(self) -> None:
        """Judge the leaves with windows that wait, then those with limits."""
        waiting, self._waiting = self._waiting, [x for x in self._waiting if len(x[1]) != 2]
        windows = [(box, *data) for box, data in waiting if len(data) == 2]
        if windows:
            boxes, which, tau = map(np.array, zip(*windows, strict=True))
            least = self.over_windows(which, tau, boxes[:, 0], boxes[:, 1])
            need(bool((least > 0.0).all()), "it is not proved by its window")
        super().end()

    def _terms(self, windows: list[list[int]]) -> tuple[Array, Array, Array]:
        """p, q and d of windows Σ (p_k/h_k − q_k h_k) − d ≤ 0: Σ cΔ/h − A Σ m h − V Σ|c + ψ' h|."""
        n = self.problem.segments
        each = np.array(windows, np.float64).reshape(-1, 2 * n + 2)
        psi, c = each[:, 1 : n + 2] / ranges.WINDOW_UNIT, each[:, n + 2 :] / ranges.WINDOW_UNIT
        joint = each[:, 0].astype(np.int64)
        a, b = np.abs(psi[:, :-1]), np.abs(psi[:, 1:])
        squares = (a * a + b * b) / np.maximum(2.0 * (a + b), 1e-300)
        mean = np.where(psi[:, :-1] * psi[:, 1:] < 0.0, squares, 0.5 * (a + b))
        left = np.abs(c + np.diff(psi)).sum(axis=1)
        velocity, acceleration = self.task.limits[joint, :2].T
        there = np.isfinite(acceleration) | ~mean.any(axis=1)
        need(
            bool((there & (np.isfinite(velocity) | (left == 0.0))).all()),
            "a window leans on a limit that is not there",
        )
        pay = np.where(mean.any(axis=1), acceleration, 0.0)[:, None] * mean
        return c * self.task.steps[:, joint].T, pay, np.where(left > 0.0, velocity, 0.0) * left

    def over_windows(self, which: Rows, tau: Array, low: Array, high: Array) -> Array:
        """Least of Σ (p/h − q h) − d + tau (Σ h − total) over boxes; arrays lead alike."""
        total, (p, pay, fixed) = self.task.total, (x[which] for x in self.windows)
        q = tau[..., None] - pay
        with np.errstate(all="ignore"):  # what is not finite fails every comparison
            start = np.where(low > 0.0, p / low + q * low, np.where(p > 0.0, np.inf, 0.0))
            start = np.where((low <= 0.0) & (p < 0.0), -np.inf, start)
            turn = np.where((p > 0.0) & (q > 0.0), np.sqrt(p / q), -1.0)
            bottom = 2.0 * np.sqrt(np.maximum(p * q, 0.0)) * (1.0 - 1e-12)
            least = np.minimum(start, p / high + q * high)
            least = np.where((low < turn) & (turn < high), np.minimum(least, bottom), least)
            size = np.abs(tau) * (2.0 * total + high.sum(axis=-1)) + (pay * high).sum(axis=-1)
            size += fixed + np.abs(least).sum(axis=-1)
            return np.asarray(least.sum(axis=-1) - fixed - tau * total - 10.0 * ROUND * size)


def _window(entry: Any, n: int, joints: int) -> list[int]:
    """Joint, the n + 1 numbers ψ, and the n numbers c."""
    joint, *rest = listed(entry, "a window", 2 * n + 2, 2 * n + 2)
    most = ranges.MOST_WINDOW
    return [whole(joint, 0, joints - 1), *(whole(x, -most, most) for x in rest)]
