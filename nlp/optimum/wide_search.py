"""A search for basins over the whole box: differential evolution on exact totals, in batches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import Array, CurveError, Problem, evaluate, fit
from ...problem.curves import coefficients_of_many
from .clock import seconds_left, time_up
from .descent import LogBox
from .starts import stretching

MEMBERS, MOST_MEMBERS = 16, 128
"""Members of a population for each segment, and at most."""
GENERATIONS = 60
"""Generations: members of a basin then agree to a few per cent, which a descent ends."""
USUAL, WIDE = 2.3, 7.0
"""Spread of the first members' log durations: a factor of 10 usually, 1,000 for one in three."""
SHRUNKEN = 0.25
"""Chance that a segment of a wide member starts at its least duration."""
APART = 0.3
"""Log durations that lie further apart than this are other basins."""
PLACES = 17
"""Places of a piece at which positions are looked at; `check` judges what comes of it."""
REPAIRS = 3
"""Stretches, each put back into the box, that try to keep the limits."""
PART = 16
"""Members of a first population after which the clock is looked at: a quarter of a second where 25
segments of a curve are not evaluated by compiled code yet."""
HOPELESS = 10.0
"""Excess of a vector that defines no curve: worse than any that does."""


def _scaled(problem: Problem, h: Array) -> Array:
    """Coefficients of all vectors, shape (vectors, pieces, powers, joints); NaN without a curve."""
    curve = problem.curve
    if curve.piecewise is not None:
        return coefficients_of_many(curve.piecewise, problem.waypoints, h)
    found: list[Array | None] = []
    for one in h:
        try:
            found.append(fit(curve, problem.waypoints, one).scaled)
        except CurveError:
            found.append(None)
    shape = next((c.shape for c in found if c is not None), (1, 1, len(problem.joints)))
    return np.stack([np.full(shape, np.nan) if c is None else c for c in found])


def _outside(problem: Problem, h: Array) -> Array:
    """Excess over the position ranges of each vector, in spans of the joint."""
    limits, span = problem.limits, np.ptp(problem.waypoints, axis=0)
    span = np.where(span > 0, span, 1.0)
    scaled = _scaled(problem, h)
    powers = np.linspace(0.0, 1.0, PLACES)[:, None] ** np.arange(scaled.shape[2])
    q = powers @ scaled
    over = np.maximum((q - limits.position_upper) / span, (limits.position_lower - q) / span)
    worst = over.max(axis=(1, 2, 3))
    return np.asarray(np.where(np.isfinite(worst), worst, HOPELESS))


def _beyond_nothing(problem: Problem, h: Array) -> Array:
    """Excess over sides of 0 of each vector, in shares of a joint's mean rate."""
    span = np.ptp(problem.waypoints, axis=0)
    wanted = (problem.limits.sides == 0.0) & (span > 0)[:, None]
    peaks = problem.curve.batch_sides(problem.waypoints, h, wanted)
    times = h.sum(axis=1)[:, None] ** np.arange(1, 4)
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
    for _ in range(REPAIRS):
        wanted = h[left] * stretch[left, None]
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
        excess = np.maximum(excess, _outside(problem, h))
    if usable is not problem:
        excess = np.maximum(excess, _beyond_nothing(problem, h))
    return np.log(h), np.maximum(excess, 0.0), h.sum(axis=1)


def _worth(excess: Array, total: Array, scale: float) -> Array:
    """What is minimised: the total where the limits are kept, else the excess, above any total."""
    kept = excess <= 1e-9
    return np.where(kept, total / scale, 1e6 * (1.0 + excess))


def _first(problem: Problem, h: Array, box: LogBox) -> tuple[Array, Array, Array]:
    """`excess_and_total` of a first population, or of as many of it as the time is there for."""
    if seconds_left() == np.inf:
        return excess_and_total(problem, h, box)
    found = [excess_and_total(problem, h[:PART], box)]
    for k in range(PART, len(h), PART):
        if time_up():
            break
        found.append(excess_and_total(problem, h[k : k + PART], box))
    z, excess, total = zip(*found, strict=True)
    return np.concatenate(z), np.concatenate(excess), np.concatenate(total)


@dataclass(frozen=True, eq=False)
class Basin:
    """One of the mutually distant best members.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    excess : float
        0 if the limits are kept.
    total : float
        s.
    """

    durations: Array
    excess: float
    total: float


def basins(
    problem: Problem, base: Array, box: LogBox, count: int, generator: np.random.Generator
) -> list[Basin]:
    """The best mutually distant members of a differential evolution, best first.

    Parameters
    ----------
    problem : Problem
        With a determined curve of any kind.
    base : ndarray, shape (segments,)
        Usual durations, s, in the middle of the first population.
    box : LogBox
    count : int
        Most basins.
    generator : numpy.random.Generator

    Returns
    -------
    list of Basin
    """
    n = problem.segments
    size = min(MEMBERS * n, MOST_MEMBERS)
    z = np.log(base) + USUAL * generator.uniform(-1.0, 1.0, (size, n))
    wide = generator.random(size) < 1 / 3
    z[wide] = np.log(base) + WIDE * generator.uniform(-1.0, 0.3, (int(wide.sum()), n))
    shrunken = wide[:, None] & (generator.random((size, n)) < SHRUNKEN)
    z = np.where(shrunken, box.low, z)
    narrow = np.isfinite(box.high) & (box.high - box.low < 2.0 * USUAL)
    spread = generator.uniform(0.0, 1.0, (size, n))
    z[:, narrow] = box.low[narrow] + spread[:, narrow] * (box.high - box.low)[narrow]
    z[0] = np.log(base)
    z, excess, total = _first(problem, np.exp(z), box)
    size, took = len(z), 0.0
    scale = float(base.sum())
    worth = _worth(excess, total, scale)
    for _ in range(GENERATIONS):
        left = seconds_left()
        if left <= took:
            break
        a, b = generator.integers(size, size=(2, size))
        best = np.argsort(worth, kind="stable")[generator.integers(max(2, size // 4), size=size)]
        factor = generator.uniform(0.3, 0.9, (size, 1))
        mutant = z + factor * (z[best] - z) + factor * (z[a] - z[b])
        mixed = generator.random((size, n)) < 0.7
        mixed[np.arange(size), generator.integers(n, size=size)] = True
        trial, trial_excess, trial_total = excess_and_total(
            problem, np.exp(np.clip(np.where(mixed, mutant, z), box.low, box.high)), box
        )
        trial_worth = _worth(trial_excess, trial_total, scale)
        better = trial_worth <= worth
        z[better], worth[better] = trial[better], trial_worth[better]
        excess[better], total[better] = trial_excess[better], trial_total[better]
        took = max(took, left - seconds_left()) if left < np.inf else 0.0
    chosen: list[int] = []
    for i in np.argsort(worth, kind="stable"):
        if len(chosen) == count:
            break
        if all(np.abs(z[i] - z[c]).max() > APART for c in chosen):
            chosen.append(int(i))
    return [Basin(np.exp(z[i]), float(excess[i]), float(total[i])) for i in chosen]
