"""What searches judge by: the reach of positions, the penalty and the stretch, against samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from attacks.attack import demand, keep
from attacks.cases import Rng, alone, fenced, half_bounded
from attacks.curves import SAMPLES, Array, Asked, NoCurve, Peaks, excess, peaks

ROUNDING = 1e-6
"""What the splines of scipy may be off by, relative: durations differ by at most 1:300 here."""


def judged_alike(asked: Asked, h: Array, rng: Rng, folder: Path) -> None:
    """Break where a search judges durations around these otherwise than samples, in fences too."""
    from trajgap.heuristics import DeathPenalty, Stretch
    from trajgap.problem import evaluate, parse_case

    if rng.random() < 0.7:
        asked = half_bounded(rng, fenced(rng, asked))
    drawn = alone(asked)
    keep(folder, case=drawn.text)
    problem = parse_case(drawn.text, "case.toml").problem()
    some = h * rng.choice([0.97, 1.0, 1.03, 1.3], 6)[:, None] ** rng.random((6, len(h)))
    reached = evaluate(problem, some).positions
    fitness = DeathPenalty(problem)(some)
    longer = np.full(len(some), np.inf)
    if not asked.moving.any():
        stretch = Stretch(problem)
        longer, repaired = stretch(some), stretch.decode(some)
    for k, one in enumerate(some):
        # Where rounding of the way-points alone moves a derivative, samples are no judge.
        noise = 1e-13 * np.abs(asked.waypoints).max() / one.min() ** np.array([1, 2, 3])
        if (noise > ROUNDING * asked.sides).any():
            continue
        try:
            seen, (least, most) = peaks(asked, one), excess(asked, one)
        except NoCurve:
            demand(not np.isfinite(fitness[k]), "a search keeps what is no curve")
            continue
        low, high = _reaches(asked, seen, one)
        inside = (low - ROUNDING <= reached[k]) & (reached[k] <= high + ROUNDING)
        demand(bool(inside.all()), f"positions reach {low} to {high}, the batch says {reached[k]}")
        said = f"samples say {least:.9g} to {most:.9g}"
        if np.isfinite(fitness[k]):
            demand(least <= 1 + ROUNDING, f"a search keeps what breaks a limit: {said}")
            demand(abs(fitness[k] - one.sum()) <= 1e-12 * one.sum(), f"its time is {fitness[k]}")
        else:
            demand(most >= 1 - ROUNDING, f"a search drops what keeps all limits: {said}")
        if np.isfinite(longer[k]):
            try:
                least, _ = excess(asked, repaired[k])
            except NoCurve:
                continue
            demand(least <= 1 + ROUNDING, f"a stretched motion breaks a limit: {least:.9g}")


def _reaches(asked: Asked, seen: Peaks, h: Array) -> tuple[Array, Array]:
    """Bounds on how far each joint goes towards its position limits, 1 at a limit."""
    low = np.full(len(seen.top), -np.inf)
    high = low.copy()
    span = asked.position_upper - asked.position_lower
    # An extremum lies half a step from a sample, as in `excess`.
    slack = (seen.high[:, 1] * h.max() + seen.high[:, 0]) * h.max() * (np.pi / (2 * SAMPLES)) ** 2
    for limit, over in (
        (asked.position_lower, asked.position_lower - seen.bottom),
        (asked.position_upper, seen.top - asked.position_upper),
    ):
        there = np.isfinite(limit)
        half = np.where(np.isfinite(span), span / 2, np.maximum(1.0, np.abs(limit)))[there]
        least, most = (_share(room[there], half) for room in (over, over + slack))
        low[there], high[there] = np.maximum(low[there], least), np.maximum(high[there], most)
    # In a range of no width a joint that stands there is somewhere up to its limits.
    point = (span == 0.0) & ~np.isposinf(low)
    return np.where(point, -np.inf, low), np.where(point, 1.0, high)


def _share(over: Array, half: Array) -> Array:
    """1 at a limit, in half ranges."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(1.0 + np.nan_to_num(over / half, nan=0.0, posinf=np.inf, neginf=-np.inf))
