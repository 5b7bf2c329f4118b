"""WOA and improved WOA a second time: one whale and one coordinate after another, in plain Python.

Written from (14)–(23) and from Mirjalili & Lewis (2016), apart from the arrays of the package, with
another generator and another order of draws: only distributions can be compared.
"""

import math
import random
from collections.abc import Callable

Vector = list[float]


def minimise(
    function: Callable[[Vector], float],
    low: float,
    high: float,
    dimensions: int,
    seed: int,
    whales: int = 30,
    iterations: int = 100,
    improved: bool = False,
    s: float = 0.0,
) -> float:
    """Best value found; the improved form has an inertia weight and starts on tent orbits."""
    rng = random.Random(seed)
    if improved:
        pod = [[0.0] * dimensions for _ in range(whales)]
        for d in range(dimensions):
            x = rng.random()
            for whale in pod:
                whale[d] = low + (high - low) * x
                x = x / 0.5 if x <= 0.5 else (1 - x) / (1 - 0.5)
    else:
        pod = [[rng.uniform(low, high) for _ in range(dimensions)] for _ in range(whales)]
    values = [function(whale) for whale in pod]
    best_value = min(values)
    best = list(pod[values.index(best_value)])
    for i in range(iterations):
        delta = 2 - 2 * i / iterations
        w = (1 - i / iterations) / (1 + s * i / iterations) if improved else 1.0
        moved = []
        for whale in pod:
            big_a = 2 * delta * rng.random() - delta
            big_c = 2 * rng.random()
            new = []
            if rng.random() < 0.5:
                explore = abs(big_a) >= 1
                target = rng.choice(pod) if explore else best
                weight = 1.0 if explore else w
                for x, t in zip(whale, target, strict=True):
                    new.append(weight * t - big_a * abs(big_c * t - x))
            else:
                g = rng.uniform(-1, 1)
                for x, t in zip(whale, best, strict=True):
                    new.append(abs(t - x) * math.exp(g) * math.cos(2 * math.pi * g) + w * t)
            moved.append([min(max(x, low), high) for x in new])
        pod = moved
        for whale in pod:
            value = function(whale)
            if value < best_value:
                best_value, best = value, list(whale)
    return best_value
