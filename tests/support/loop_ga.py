"""Standard and improved GA a second time: one individual and one gene after another.

Plain Python with another generator and another order of draws: only distributions can be compared.
Real genes, arithmetic crossover, a mutated gene drawn anew, fitness 1/T, no elite.
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
    population: int = 40,
    generations: int = 100,
    improved: bool = False,
) -> float:
    """Best value found; values must be positive."""
    rng = random.Random(seed)
    people = [[rng.uniform(low, high) for _ in range(dimensions)] for _ in range(population)]
    best = math.inf
    for generation in range(1, generations + 2):
        values = [function(one) for one in people]
        best = min(best, *values)
        if generation > generations:
            return best
        fitness = [1 / value for value in values]
        if improved:
            parents = ranked(people, values, generation, generations, rng)
            crossing, mutating = rates(fitness)
        else:
            parents = rng.choices(people, fitness, k=population)
            crossing, mutating = 0.8, 0.05
        rng.shuffle(parents)
        children = []
        while parents:
            one, two = list(parents.pop()), list(parents.pop())
            if rng.random() < crossing:
                share = rng.random()
                pairs = list(zip(one, two, strict=True))
                one = [share * a + (1 - share) * b for a, b in pairs]
                two = [(1 - share) * a + share * b for a, b in pairs]
            children += [one, two]
        people = [
            [rng.uniform(low, high) if rng.random() < mutating else gene for gene in child]
            for child in children
        ]
    return best


def ranked(
    people: list[Vector], values: list[float], generation: int, generations: int, rng: random.Random
) -> list[Vector]:
    """Best quarter, and a roulette by (12)(13) on the middle half."""
    order = sorted(range(len(people)), key=values.__getitem__)
    quarter = len(people) // 4
    q = 0.2 - (0.2 - 0.05) * (generation - 1) / (generations - 1)
    middle = order[quarter : 3 * quarter]
    chances = [(1 - q) ** a for a in range(len(middle))]
    drawn = rng.choices(middle, chances, k=3 * quarter)
    return [people[i] for i in order[:quarter] + drawn]


def rates(fitness: list[float]) -> tuple[float, float]:
    """P_c and P_z by (14)(15)."""
    angle = math.asin(min(1.0, sum(fitness) / len(fitness) / max(fitness)))
    part = angle / (math.pi / 2)
    if angle >= math.pi / 6:
        return 1.00 * (1 - part), 0.05 * part
    return 2.00 * part, 0.02 * (1 - part)
