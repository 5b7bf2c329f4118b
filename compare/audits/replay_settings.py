"""The settings under which an algorithm is replayed: as listed, and spread over what is open."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import fields, replace
from enum import StrEnum
from typing import Any, cast

import numpy as np

from ...heuristics import Algorithm
from ...problem import Array, TrajgapError

LISTED = "as listed"
"""Name of the settings that the case lists."""
DESIGN = 16
"""Settings drawn over everything open at once: each open number in 16 different places."""
_OPEN_NUMBERS = {
    "inertia": (0.4, 1.0),
    "inertia_max": (0.7, 1.0),
    "inertia_min": (0.2, 0.6),
    "c1": (1.0, 2.5),
    "c2": (1.0, 2.5),
    "particles": (20, 60),
    "population": (20, 80),
    "whales": (20, 60),
    "velocity_max": (0.1, 1.0),
    "mutation_scale": (0.25, 2.0),
    "crossover_rate": (0.6, 0.95),
    "mutation_rate": (0.01, 0.2),
    "mutation_reach": (0.05, 0.3),
    "elite": (0, 2),
    "q_best": (0.1, 0.3),
    "q_worst": (0.02, 0.1),
    "s": (-0.5, 1.0),
    "spiral": (0.5, 2.0),
}
"""Ranges of numbers that papers leave unprinted, as textbooks and the field's software use them.
The number of iterations is not among them: it is the budget."""
_GROUPS = {"population": 4, "particles": 6}
"""Sizes are drawn as multiples of these: genetic algorithms pair and quarter a population, and a
niche swarm splits its particles evenly. Drawn otherwise, most settings would be refused."""


def spread_settings(
    algorithm: Algorithm[Any], printed: Collection[str]
) -> dict[str, Algorithm[Any]]:
    """An algorithm under settings that fill the space of what a paper leaves open.

    Words and numbers are varied together, by a Latin hypercube with a fixed seed: the same
    settings for the same algorithm, whatever else is computed.

    Each algorithm stands under what is set, in words; the listed choices come first.

    Parameters
    ----------
    algorithm : Algorithm
        Under the listed choices.
    printed : collection of str
        Names of the settings that the paper prints: these are held.
    """
    found: dict[str, Algorithm[Any]] = {LISTED: algorithm}
    open_: list[tuple[str, Any]] = []
    for one in fields(cast(Any, algorithm)):
        current = getattr(algorithm, one.name)
        if one.name in printed:
            continue
        if isinstance(current, StrEnum):
            open_.append((one.name, tuple(type(current))))
        elif one.name in _OPEN_NUMBERS:
            open_.append((one.name, _OPEN_NUMBERS[one.name]))
    if not open_:
        return found
    for row in latin_hypercube(len(open_)):
        changes = {
            name: _drawn(name, getattr(algorithm, name), of, share)
            for (name, of), share in zip(open_, row, strict=True)
        }
        try:
            changed = replace(cast(Any, algorithm), **changes)
        except TrajgapError:
            continue  # these values exclude each other, such as a least weight above the largest
        said = ", ".join(
            f"{name} = {value if isinstance(value, StrEnum) else format(value, 'g')}"
            for name, value in changes.items()
        )
        found[said] = cast(Algorithm[Any], changed)
    return found


def latin_hypercube(dimensions: int) -> Array:
    """Places in the unit cube, shape (`DESIGN`, dimensions): each part of an axis holds one.

    They are those of ``scipy.stats.qmc.LatinHypercube`` with seed 0, which takes half a second to
    import.
    """
    (rng,) = np.random.default_rng(0).spawn(1)
    inside = rng.uniform(size=(DESIGN, dimensions))
    parts = np.array([rng.permutation(DESIGN) for _ in range(dimensions)])
    return np.asarray((parts.T + 1 - inside) / DESIGN)


def _drawn(name: str, current: Any, of: tuple[Any, ...], share: float) -> Any:
    if isinstance(current, StrEnum):
        return of[int(share * len(of))]
    low, high = of
    value = low + share * (high - low)
    group = _GROUPS.get(name, 1)
    return group * round(value / group) if isinstance(current, int) else round(value, 3)
