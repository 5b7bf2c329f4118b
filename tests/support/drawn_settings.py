"""Algorithms whose open choices and numbers are drawn."""

from dataclasses import fields, replace
from enum import Enum
from typing import Any

import numpy as np
from trajgap.heuristics import from_settings

SIZES = {"particles": 6, "whales": 5, "population": 8, "niches": 3, "iterations": 6}
SPANS = {
    "c1": (0, 2.5), "c2": (0, 2.5), "inertia": (0, 1.2), "inertia_max": (0.6, 1.2),
    "inertia_min": (0.1, 0.6), "mutation_scale": (0.2, 1.5), "position_max": (0.8, 2.0),
    "velocity_max": (0.2, 1.0), "s": (-0.9, 3.0), "beta": (0.2, 0.8), "spiral": (0.3, 2.0),
    "threshold": (0.0, 1.6), "crossover_rate": (0.3, 1.0), "mutation_rate": (0.1, 0.6),
    "mutation_reach": (0.1, 0.9), "resolution": (0.01, 0.4), "elite": (0, 3.99),
    "q_best": (0.3, 0.8), "q_worst": (0.05, 0.3), "k1": (0.3, 1.0), "k2": (0.1, 0.6),
    "k3": (0.1, 0.6), "k4": (0.5, 2.0), "crossover_fixed": (0, 1), "mutation_fixed": (0, 1),
}  # fmt: skip


def drawn(kind: str, rng: np.random.Generator) -> Any:
    """An algorithm with every open choice and every number drawn."""
    record = from_settings(kind, {})
    changes: dict[str, Any] = {"penalty": [np.inf, 1e6][rng.integers(2)]}
    for name in (field.name for field in fields(record)):
        value = getattr(record, name)
        if isinstance(value, Enum | bool):
            options = list(type(value)) if isinstance(value, Enum) else [False, True]
            changes[name] = options[rng.integers(len(options))]
        elif name in SIZES:
            changes[name] = SIZES[name]
        elif name in SPANS:
            changes[name] = type(value)(rng.uniform(*SPANS[name]))
        elif name.endswith(("initial", "range")):
            changes[name] = tuple(rng.uniform((-1.0, 1.5), (0.0, 3.0)))
    return replace(record, **changes)
