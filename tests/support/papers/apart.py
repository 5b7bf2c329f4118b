"""Honest papers that print totals which are not one: rivals, other curves, other experiments.

The truth is in closed form: a quintic from rest to rest over d in h peaks at 15 d/(8 h) and at
10 d/(√3 h²), and the trapezoidal profile of a joint takes d/V + V/A, or 2·√(d/A) where it does not
reach V.
"""

from typing import Any

import numpy as np
from support.made_up import algorithms, entry, paper, tables
from support.papers.printing import printed

_APART: tuple[dict[str, str], ...] = (
    {"algorithm": "old"},
    {},
    {"other_curve": "straight lines"},
    {"algorithm": "new", "table": "table-6"},
    {"state": "before"},
    {"objective": "time and jerk"},
    {"other_curve": "straight lines", "of": "fast"},
)
"""How a file may keep a total apart; by an improvement alone where it says nothing else."""


def apart(seed: int) -> str:
    """A case file whose every claim is true."""
    rng = np.random.default_rng([20261124, seed])
    count, joints, places = (int(rng.integers(low, high)) for low, high in ((3, 6), (1, 4), (1, 4)))
    texts = [[printed(x, places) for x in row] for row in rng.uniform(-170, 170, (joints, count))]
    ways = np.abs(np.diff(np.array(texts, dtype=float), axis=1))
    speeds, sizes = rng.uniform(40, 200, (2, joints)).round(1)
    v, a = speeds[:, None], sizes[:, None]
    least = np.maximum(15 / 8 * ways / v, np.sqrt(10 / np.sqrt(3) * ways / a)).max(axis=0)
    times = least * float(rng.choice([1, 1.1, 1.4]))
    shown = [printed(h, places, "up") for h in times]
    total = printed(sum(map(float, shown)), places)
    kept = _APART[seed % len(_APART)]
    other = float(total) * float(rng.uniform(1.05, 2.5))
    rival = {"id": "rival", "quantity": "total_time", "value": printed(other, places)} | kept
    named = {"algorithm": "new"} if rng.random() < 0.5 or kept.get("algorithm") else {}
    fast = {"id": "fast", "quantity": "durations", "durations": shown, "total": total} | named
    if "table" in kept or rng.random() < 0.5:
        fast["table"] = "table-2"
    claims: list[dict[str, Any]] = [fast, rival]
    if not kept or rng.random() < 0.5:
        gain = 100 * (1 - float(total) / float(rival["value"]))
        percent = printed(gain, int(rng.integers(0, 3)))
        claims.append({"id": "gain", "quantity": "improvement", "percent": percent})
        claims[-1] |= {"slower": "rival", "faster": "fast"}
    claims.append({"id": "abstract", "quantity": "total_time", "value": total, "of": "fast"})
    claims.append(_profile(rng, ways, speeds, sizes, places))
    claims.append({"id": "kept", "quantity": "statement", "checks": "within_limits"})
    claims[-1]["of"] = ["fast"]
    return _written(texts, claims, velocity=speeds.tolist(), acceleration=sizes.tolist())


def moving(seed: int) -> str:
    """A case file of a profile whose motion starts or ends at speed, so it takes less time."""
    rng = np.random.default_rng([20261125, seed])
    way, speed, size = float(rng.uniform(20, 90)), 60.0, float(rng.uniform(30, 300))
    at = float(rng.uniform(0.2, 0.9)) * min(speed, (2 * size * way) ** 0.5)
    # From the speed to the limit, on at the limit, and down to rest; or over a lower top.
    top = min(speed, ((2 * size * way + at**2) / 2) ** 0.5)
    ramps = (top**2 - at**2 + top**2) / (2 * size)
    total = (2 * top - at) / size + (way - ramps) / top
    where = str(rng.choice(["end", "finish"]))
    curve = {"family": "polynomials", "degrees": [3], "end_orders": [1]}
    curve["end_derivatives"] = [at if where == "end" else 0]
    curve["finish_derivatives"] = [0 if where == "end" else at]
    claim = {"id": "profile", "quantity": "total_time", "value": printed(total, 3)}
    claim |= {"other_curve": "trapezoid", "profile": "trapezoidal"}
    points = [["0.00", printed(way, 2)]]
    return _written(points, [claim], curve=curve, velocity=speed, acceleration=size)


def _profile(
    rng: np.random.Generator, ways: np.ndarray, speeds: np.ndarray, sizes: np.ndarray, places: int
) -> dict[str, Any]:
    """A true total of trapezoidal profiles, each segment as long as its slowest joint needs."""
    v, a = speeds[:, None], sizes[:, None]
    each = np.where(ways * a >= v**2, ways / v + v / a, 2 * np.sqrt(ways / a))
    value = printed(each.max(axis=0).sum(), places)
    claim = {"id": "profile", "quantity": "total_time", "value": value}
    return claim | {"other_curve": "trapezoids", "profile": "trapezoidal", "algorithm": "old"}


def _written(points: list[list[str]], claims: list[dict[str, Any]], **keys: Any) -> str:
    places = ("Table 2", "Figure 5", "conclusion", "abstract", "Table 6", "section 4")
    stated = (entry("claims", where=w, **c) for w, c in zip(places, claims, strict=False))
    return paper(points, algorithms("old", "new"), tables(2, 6), *stated, angle="deg", **keys)
