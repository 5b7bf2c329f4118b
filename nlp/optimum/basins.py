"""Where descents begin, and where they end: a search for basins over the whole box, then descents.

Differential evolution on exact totals, in batches, looks everywhere; beside it a grid of ratios
where durations are few, and a search in each decade of a segment between near way-points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...problem import TOLERANCE, Array, Problem, TrajgapError, evaluate
from ..clock import time_up
from .decided import Local
from .descent import Descent, descend
from .judgement import on_floor
from .starts import LogBox, box_above, equal_start, stretching

HOPELESS = 10.0
"""Excess of a vector that defines no curve: worse than any that does."""


@dataclass(frozen=True)
class Evolution:
    """Settings of the wide search; lengths are in log durations."""

    members: int = 16
    """Members of a population for each segment."""
    most_members: int = 128
    generations: int = 60
    agreed: float = 0.03
    """Spread of all members at which a search ends before that: a descent does the rest."""
    usual: float = 2.3
    """Spread of the first members: a factor of 10."""
    wide: float = 7.0
    """Spread of one in three: a factor of 1,000."""
    shrunken: float = 0.25
    """Chance that a segment of such a member starts at its least duration."""
    apart: float = 0.3
    """Members that lie further apart than this are in other basins."""
    repairs: int = 3
    """Stretches, each put back into the box, that try to keep the limits."""
    ratios: float = 4.5
    """Up to which the grid reaches: a factor of 90."""

    def axis(self, segments: int) -> Array:
        """Log ratios to the first duration of which a grid is made; empty if it is too large.

        Basins that are narrower than the members of a population lie apart are found there.
        """
        return np.linspace(-self.ratios, self.ratios, {2: 400, 3: 50}.get(segments, 0))


EVOLUTION = Evolution()
"""What every wide search is made with."""


def _beyond_nothing(problem: Problem, h: Array) -> Array:
    """Excess over sides of 0 of each vector, in shares of a joint's mean rate."""
    span = np.ptp(problem.waypoints, axis=0)
    wanted = (problem.limits.sides == 0.0) & (span > 0)[:, None]
    peaks = problem.curve.batch_sides(problem.waypoints, h, wanted)
    times = h.sum(axis=1)[:, None] ** np.arange(1, 1 + peaks.shape[-1])
    rates = np.where(span > 0, span, 1.0)[:, None] / times[:, None]
    worst = np.where(wanted[:, None], peaks / rates, 0.0).max(axis=(0, 2, 3))
    return np.asarray(np.where(np.isfinite(worst), worst, HOPELESS))


def excess_and_total(problem: Problem, h: Array, box: LogBox) -> tuple[Array, Array, Array]:
    """Vectors stretched towards the limits within the box: log durations, excess and total."""
    low, high = np.exp(box.low), np.exp(box.high)
    h = np.clip(h, low, high)
    usable = stretching(problem)
    stretch = evaluate(usable, h).stretch
    excess = np.where(np.isfinite(stretch), 0.0, HOPELESS)
    left = np.flatnonzero(np.isfinite(stretch) & (stretch > 0))
    # What a prescribed motion takes of a limit, no shorter time uses up: it would break others.
    least = 0.0 if problem.curve.homogeneous else 1.0
    for _ in range(EVOLUTION.repairs):
        wanted = h[left] * np.maximum(stretch[left, None], least)
        h[left] = np.clip(wanted, low, high)
        # Where the whole stretch fits and time can be stretched, the limits are met exactly.
        bent = (h[left] != wanted).any(axis=1) | (not problem.curve.homogeneous)
        left = left[bent]
        if left.size == 0:
            break
        stretch[left] = evaluate(usable, h[left]).stretch
        lost = ~(np.isfinite(stretch[left]) & (stretch[left] > 0))
        excess[left[lost]] = HOPELESS
        left = left[~lost]
        excess[left] = np.log(stretch[left])
    if problem.limits.limits_position:
        outside = evaluate(problem, h).positions.max(axis=1) - 1.0
        excess = np.maximum(excess, np.where(np.isfinite(outside), outside, HOPELESS))
    if usable is not problem:
        excess = np.maximum(excess, _beyond_nothing(problem, h))
    return np.log(h), np.maximum(excess, 0.0), h.sum(axis=1)


def _worth(excess: Array, total: Array, scale: float) -> Array:
    """What is minimised: the total where the limits are kept, else the excess, above any total."""
    return np.where(excess <= 1e-9, total / scale, 1e6 * (1.0 + excess))


def basins(problem: Problem, count: int, seed: int, floor: Array) -> Array:
    """The best mutually distant members of a differential evolution, best first, s.

    At most ``count``, shape (members, segments), none below the least durations of ``floor``, s.
    """
    base, box, of = equal_start(problem), box_above(problem, floor), EVOLUTION
    generator = np.random.default_rng(seed)
    n = problem.segments
    size = min(of.members * n, of.most_members)
    z = np.log(base) + of.usual * generator.uniform(-1.0, 1.0, (size, n))
    wide = generator.random(size) < 1 / 3
    z[wide] = np.log(base) + of.wide * generator.uniform(-1.0, 0.3, (int(wide.sum()), n))
    shrunken = wide[:, None] & (generator.random((size, n)) < of.shrunken)
    z = np.where(shrunken, box.low, z)
    narrow = np.isfinite(box.high) & (box.high - box.low < 2.0 * of.usual)
    spread = generator.uniform(0.0, 1.0, (size, n))
    z[:, narrow] = box.low[narrow] + spread[:, narrow] * (box.high - box.low)[narrow]
    z[0] = np.log(base)
    minima = _grid_minima(problem, base, box)[: size // 2]
    z[1 : 1 + len(minima)] = minima
    z, excess, total = excess_and_total(problem, np.exp(z), box)
    scale = float(base.sum())
    worth = _worth(excess, total, scale)
    for _ in range(of.generations):
        if time_up() or np.ptp(z, axis=0).max() < of.agreed:
            break
        a, b = generator.integers(size, size=(2, size))
        best = np.argsort(worth, kind="stable")[generator.integers(max(2, size // 4), size=size)]
        factor = generator.uniform(0.3, 0.9, (size, 1))
        mutant = z + factor * (z[best] - z) + factor * (z[a] - z[b])
        mixed = generator.random((size, n)) < 0.7
        mixed[np.arange(size), generator.integers(n, size=size)] = True
        trial, excess, total = excess_and_total(
            problem, np.exp(np.clip(np.where(mixed, mutant, z), box.low, box.high)), box
        )
        trial_worth = _worth(excess, total, scale)
        better = trial_worth <= worth
        z[better], worth[better] = trial[better], trial_worth[better]
    chosen: list[int] = []
    for i in np.argsort(worth, kind="stable"):
        if len(chosen) == count:
            break
        if all(np.abs(z[i] - z[c]).max() > of.apart for c in chosen):
            chosen.append(int(i))
    return np.exp(z[chosen])


def _grid_minima(problem: Problem, base: Array, box: LogBox) -> Array:
    """Local minima over a grid of log ratios to the first duration, best first, log durations."""
    n = problem.segments
    axis = EVOLUTION.axis(n)
    if not axis.size:
        return np.empty((0, n))
    ratios = np.stack(np.meshgrid(*[axis] * (n - 1), indexing="ij"), axis=-1)
    logs = np.concatenate([np.zeros((*ratios.shape[:-1], 1)), ratios], axis=-1)
    logs += np.log(base.sum()) - np.log(np.exp(logs).sum(axis=-1, keepdims=True))
    z, excess, total = excess_and_total(problem, np.exp(logs.reshape(-1, n)), box)
    worth = _worth(excess, total, float(base.sum())).reshape(ratios.shape[:-1])
    padded = np.pad(worth, 1, constant_values=np.inf)
    lowest = np.ones(worth.shape, dtype=bool)
    for shift in np.ndindex(*(3,) * (n - 1)):
        window = tuple(slice(s, s + axis.size) for s in shift)
        lowest &= worth <= padded[window]
    at = np.flatnonzero(lowest.ravel())
    return z[at[np.argsort(worth.ravel()[at], kind="stable")]]


def as_local(problem: Problem, found: Descent) -> Local | None:
    """The end of a descent, judged by the checker; None where float64 has lost the curve.

    It has where a segment at a virtual break shrinks towards 0: the system is singular to rounding.
    """
    low, high = problem.duration_lower, problem.duration_upper
    try:
        local = Local.of(problem, np.clip(found.durations, low, high))
        stretch = local.verdict.stretch
        if found.feasible and 1.0 < stretch < 1.0 + TOLERANCE and problem.curve.homogeneous:
            local = Local.of(problem, np.clip(local.durations * stretch, low, high))
    except TrajgapError:
        return None
    return replace(local, converged=found.converged, iterations=found.steps)


def exact_search(problem: Problem, points: Array, floor: Array) -> list[Local]:
    """Local optima of all starts, above the floors; starts that end together are kept apart."""
    box = box_above(problem, floor)
    ends: dict[Descent, Local] = {}
    found: list[Local] = []
    for start in points:
        if found and time_up():
            break
        end = descend(problem, start, box, ends, EVOLUTION.apart)
        local = replace(ends[end], iterations=0) if end in ends else as_local(problem, end)
        if local is not None:
            found.append(local)
            if end.converged and not on_floor(end.durations, floor).any():
                ends[end] = local
    return found


SHORT = 0.02
"""Largest way of a segment, in what each joint covers in all, at which its duration may have two
optima that lie decades apart: with random way-points all that were found had less than 1e-3."""


def _reaches(problem: Problem) -> Array:
    """What each joint covers: the span of its way-points, or what its prescribed ends bring it to.

    A joint that is in motion at an end covers |q⁽ʳ⁾|·hʳ/r! of the segment there, of the usual
    duration h.
    """
    curve, way = problem.curve, np.ptp(problem.waypoints, axis=0)
    usual = equal_start(problem)
    for b, h in ((0, usual[0]), (curve.segments, usual[-1])):
        for r, value in curve.prescribed_at(b):
            way = np.maximum(way, np.abs(np.asarray(value)) * h**r / math.factorial(r))
    return np.where(way > 0, way, 1.0)


def short_ways(problem: Problem) -> list[int]:
    """Segments in which every joint moves by little of what it covers in all.

    Of curves with virtual breaks, only those between two neighbouring way-points.
    """
    way = np.abs(np.diff(problem.waypoints, axis=0)) / _reaches(problem)
    breaks = problem.curve.waypoint_breaks
    return [
        breaks[w]
        for w in np.flatnonzero(way.max(axis=1) <= SHORT)
        if breaks[w + 1] == breaks[w] + 1
    ]


def shortened(problem: Problem, durations: Array, floor: Array) -> Array:
    """Motions in which a segment of a short way is shorter by powers of ten, s.

    A descent that goes down in a basin reaches over a decade. A wide search over the whole box
    seldom ends in such a basin: it is decades away in one duration, and a few per cent deep.
    """
    found = []
    low = np.exp(box_above(problem, floor).low)
    for segment in short_ways(problem):
        shorter = durations[segment] / 10.0
        while shorter > low[segment]:
            found.append(durations.copy())
            found[-1][segment] = shorter
            shorter /= 10.0
    return np.array(found).reshape(-1, problem.segments)
