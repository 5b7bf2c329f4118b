"""Accelerations that limits of acceleration and deceleration compare, and how they change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..curves import Extremum, Places, Trajectory, valued
from ..problem import Problem
from .evaluation import peak_gradients
from .one_sided import signed_parts

_AT_REST = 1e-13
"""Share of a piece's terms of speed below which it is at a root: rounding."""


@dataclass(frozen=True, eq=False)
class SidedPeaks:
    """Accelerations of joints whose deceleration has a limit of its own, as far as near it.

    One row for each stretch on which speed, acceleration and jerk keep their signs: at the end
    where the acceleration is larger.
    """

    places: Places
    value: Array
    braking: NDArray[np.bool_]
    ratio: Array
    turning: NDArray[np.bool_]
    """Whether the place is a root of the speed inside a piece, and moves with it."""

    @classmethod
    def of(cls, problem: Problem, trajectory: Trajectory, near: float) -> SidedPeaks:
        """Those above a share of their limit; the first of equal neighbours counts."""
        limits, found = problem.limits, [np.zeros((7, 0))]
        for j in np.flatnonzero(limits.braking).tolist():
            v, a = (trajectory.derivatives(r)[:, :, j] for r in (1, 2))
            low, high, _, growth = signed_parts(v, a)
            ends = np.stack([low, high])
            values = valued(a[:, None, None], ends)
            last = (np.abs(values[1]) > np.abs(values[0]))[None].astype(np.int64)
            place, value = (np.take_along_axis(of, last, 0)[0] for of in (ends, values))
            size = np.where(growth > 0.0, limits.ends("acceleration")[1][j], limits.deceleration[j])
            ratio = np.abs(value) / size
            i, k = np.nonzero((low < high) & (growth != 0.0) & (ratio > near))
            s, falls = place[i, k], growth[i, k] < 0.0
            slow = np.abs(valued(v[:, k], s)) <= _AT_REST * np.abs(v[:, k]).sum(axis=0)
            turning = slow & (s > 0.0) & (s < 1.0)
            rows = np.array([np.full(i.size, j), k, s, value[i, k], falls, ratio[i, k], turning])
            # What ends one stretch or piece and begins the next is one row of each kind.
            at = np.round(trajectory.times(k, s) / trajectory.total_time, 9)
            _, first = np.unique(np.stack([at, falls]), axis=1, return_index=True)
            found.append(rows[:, np.sort(first)])
        j, k, s, value, falls, ratio, turning = np.hstack(found)
        order = np.full(j.size, 2)
        places = Places(j.astype(np.int64), k.astype(np.int64), order, s)
        return cls(places, value, falls > 0.0, ratio, turning > 0.0)

    def points(self, trajectory: Trajectory) -> list[Extremum]:
        """The same as extrema."""
        return extrema_at(trajectory, self.places, self.value)

    def moved(
        self, problem: Problem, h: Array, trajectory: Trajectory, nodal: Array | None
    ) -> Array:
        """What gradients at a fixed place lack at roots of the speed: jerk/a times the speed's own.

        The root moves in time by −dv/a. Shape (turning ones, segments), to be subtracted.
        """
        turning = np.flatnonzero(self.turning)
        every = self.points(trajectory)
        roots = [replace(every[i], order=1, value=0.0) for i in turning]
        jerks = [trajectory.values(e.segment, e.joint, 3, np.array(e.s)) for e in roots]
        share = np.array(jerks) / self.value[turning]
        return np.asarray(share[:, None] * peak_gradients(problem, h, roots, nodal).durations)


def extrema_at(trajectory: Trajectory, at: Places, value: Array) -> list[Extremum]:
    """Values at places of a trajectory as extrema."""
    columns = at.joint, at.segment, at.order, at.s, trajectory.times(at.segment, at.s), value
    return [Extremum(*row) for row in zip(*(c.tolist() for c in columns), strict=True)]
