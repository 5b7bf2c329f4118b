"""Every algorithm beside its equations written once more: one member, one coordinate at a time.

The loops take random numbers from a generator of the same seed in the order that each docstring
states. Every open choice is drawn; a coarse objective makes ties, an edge makes some infeasible.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from support.drawn_settings import drawn
from trajgap.heuristics import KINDS, Bounds

Vector = list[float]
Judge = Callable[[Vector], float]
LOWER, UPPER = [-0.6, -0.2, 0.1], [1.9, 2.4, 2.8]
BOUNDS = Bounds(np.array(LOWER), np.array(UPPER))
INF = math.inf


def coarse(x: np.ndarray, penalty: float) -> np.ndarray:
    """Steps of a quarter around a shifted point, above 0; infeasible far to the left."""
    total = 0.5 + np.floor(4 * np.abs(x - [0.713, 1.329, 0.851]).sum(axis=-1)) / 4
    return np.where(x[..., 0] < -0.417, penalty, total)


def clamp(x: float, low: float, high: float) -> float:
    return min(max(x, low), high)


def leader(many: list[Vector], fitness: Vector, best: Any, least: float) -> tuple[Vector, float]:
    for x, f in zip(many, fitness, strict=True):
        if f < least:
            best, least = x, f
    return best, least


def held(record: Any, x: Vector) -> Vector:
    initial = getattr(record, "position_initial", (0, 0))
    low, high = {
        "bounds": (LOWER, UPPER), "initial": ([initial[0]] * 3, [initial[1]] * 3),
        "free": ([-INF] * 3, [INF] * 3),
        "symmetric": ([-getattr(record, "position_max", 0)] * 3,
                      [getattr(record, "position_max", 0)] * 3),
    }[record.position_rule]  # fmt: skip
    return list(map(clamp, x, low, high))


def inertia(record: Any, n: int, fitness: Vector, i: int) -> float:
    if record.kind == "pso":
        return float(record.inertia)
    low, high = record.inertia_min, record.inertia_max
    if record.kind == "mnam-pso":
        passed = 1 - math.exp(-((2 * n / record.iterations) ** 2))
        rises = record.inertia_reading == "rises"
        return float(low + (high - low) * (passed if rises else 1 - passed))
    if record.inertia_rule == "linear":
        return float(high - (high - low) * n / record.iterations)
    least, mean = min(fitness), sum(fitness) / len(fitness)
    if record.inertia_rule == "fixed" or not least < mean < INF or fitness[i] > mean:
        return float(high)
    return float(low + (high - low) * (fitness[i] - least) / (mean - least))


def led(record: Any, rng: Any, judge: Judge, after: dict[str, Any], best: Any, f: float) -> Any:
    """The global best: MNAM-PSO mutates it, the constrained one draws among equals."""
    personal, fits = after["personal"], after["personal_fitness"]
    best, f = leader(personal, fits, best, f)
    if record.kind == "constrained-pso":
        equal = [x for x, one in zip(personal, fits, strict=True) if one == min(fits)]
        best = equal[int(rng.random() * len(equal)) if record.ties == "random" else 0]
        f = min(fits)
    if record.kind == "mnam-pso":
        reach, mutant = record.mutation_scale * min(best), list(best)
        if record.mutated == "one":
            where, size = rng.random(2)
            mutant[int(where * 3)] += reach * (2 * size - 1)
        else:
            mutant = [x + reach * (2 * u - 1) for x, u in zip(best, rng.random(3), strict=True)]
        best, f = leader([mutant], [judge(mutant)], best, f)
    return {**after, "best": best, "best_fitness": f}


def first_positions(record: Any, rng: Any) -> list[Vector]:
    low, high = record.position_initial
    count, width = record.particles, (high - low) / getattr(record, "niches", 1)
    niche = [i * getattr(record, "niches", 1) // count for i in range(count)]
    rule = getattr(record, "niches_rule", "diagonal")
    if rule == "clusters":
        centres = low + (high - low) * rng.random((record.niches, 3))
        u = rng.random((count, 3))
        return [
            [clamp(centres[niche[i]][d] + width * (u[i][d] - 0.5), low, high) for d in range(3)]
            for i in range(count)
        ]
    columns = [list(range(count))] * 3
    if rule == "stratified":
        u = rng.random((count, 3))
        columns = [sorted(range(count), key=list(u[:, d]).__getitem__) for d in range(3)]
    u = rng.random((count, 3))
    x = [[low + width * (niche[columns[d][i]] + u[i][d]) for d in range(3)] for i in range(count)]
    return [held(record, one) for one in x] if record.kind == "constrained-pso" else x


def swarm(record: Any, before: Any, rng: Any, judge: Judge) -> dict[str, Any]:
    span = getattr(record, "velocity_initial", None)
    low, high = span or (-record.velocity_max, record.velocity_max)
    if before is None:
        x = first_positions(record, rng)
        v = (low + (high - low) * rng.random((record.particles, 3))).tolist()
        fits = [judge(one) for one in x]
        first = {"positions": x, "velocities": v, "fitness": fits}
        first |= {"personal": x, "personal_fitness": fits}
        return led(record, rng, judge, first, x[0], INF)
    count = record.particles
    rows, columns = {"coordinate": (count, 3), "particle": (count, 1), "iteration": (1, 1)}[
        record.draws
    ]
    r1, r2 = rng.random((2, rows, columns))
    if getattr(record, "velocity_rule", "clamp") == "free":
        low, high = -INF, INF
    after: dict[str, Any] = {name: [] for name in ("positions", "velocities", "fitness")}
    for i in range(count):
        v = []
        for d in range(3):
            own, x = before.personal[i][d], before.positions[i][d]
            a, b = r1[i % rows][d % columns], r2[i % rows][d % columns]
            w = inertia(record, before.iteration + 1, list(before.fitness), i)
            pull = record.c1 * a * (own - x) + record.c2 * b * (before.best[d] - x)
            v.append(clamp(w * before.velocities[i][d] + pull, low, high))
        x = held(record, [a + b for a, b in zip(before.positions[i], v, strict=True)])
        after["positions"].append(x)
        after["velocities"].append(v)
        after["fitness"].append(judge(x))
    coins = rng.random(count) if getattr(record, "ties", "keep") == "random" else [1.0] * count
    after |= {"personal": [], "personal_fitness": []}
    for i in range(count):
        new, old = after["fitness"][i], before.personal_fitness[i]
        taken = new < old or (new == old and coins[i] < 0.5)
        after["personal"].append(after["positions"][i] if taken else list(before.personal[i]))
        after["personal_fitness"].append(new if taken else old)
    return led(record, rng, judge, after, before.best, before.best_fitness)  # type: ignore[no-any-return]


def whales(record: Any, before: Any, rng: Any, judge: Judge) -> dict[str, Any]:
    count, improved = record.whales, record.kind == "improved-woa"
    if before is None:
        low, high = record.position_initial
        share = rng.random((count, 3)) if not improved or record.initial == "uniform" else None
        if share is None:
            share = np.zeros((count, 3))
            where = {
                "coordinate": [[(i, d) for i in range(count)] for d in range(3)],
                "member": [[(i, d) for d in range(3)] for i in range(count)],
                "single": [[(i, d) for i in range(count) for d in range(3)]],
            }[record.tent_rule]
            for orbit, x in zip(where, rng.random(len(where)), strict=True):
                for place in orbit:
                    share[place] = x
                    x = x / record.beta if x <= record.beta else (1 - x) / (1 - record.beta)
        x = (low + (high - low) * share).tolist()
        fits = [judge(one) for one in x]
        best, f = leader(x, fits, x[0], INF)
        return {"positions": x, "fitness": fits, "best": best, "best_fitness": f}
    columns = 3 if record.coefficients == "coordinate" else 1
    u = rng.random((count, columns))
    c = u if record.r_rule == "shared" else rng.random((count, columns))
    g, chance, member = rng.random(count), rng.random(count), rng.random(count)
    part = (before.iteration + (record.counter == "one")) / record.iterations
    delta = 2 - 2 * part
    w = (1 - part) / (1 + record.s * part) if improved else 1.0
    exploration = record.exploration if improved else "kept"
    positions, fits = [], []
    for i in range(count):
        a = [delta * (2 * one - 1) for one in u[i]] * (3 // columns)
        far = [abs(one) >= record.threshold for one in a]
        if record.threshold_rule == "length":
            far = [math.hypot(*a[:columns]) >= record.threshold] * 3
        new = []
        for d in range(3):
            x, best = before.positions[i][d], before.best[d]
            target, weight = best, w
            if far[d] and exploration != "dropped":
                target = before.positions[int(count * member[i])][d]
                weight = w if exploration == "weighted" else 1.0
            if chance[i] < 0.5:
                new.append(weight * target - a[d] * abs(2 * c[i][d % columns] * target - x))
            else:
                turn = 2 * g[i] - 1
                size = abs(best - x) * math.exp(record.spiral * turn)
                new.append(size * math.cos(2 * math.pi * turn) + w * best)
        new = held(record, new)
        f, old = judge(new), before.fitness[i]
        limit = {"always": INF, "feasible": record.penalty, "greedy": old}[record.replacement]
        stays = f >= limit and record.replacement != "always"
        positions.append(list(before.positions[i]) if stays else new)
        fits.append(old if stays else f)
    best, f = leader(positions, fits, before.best, before.best_fitness)
    return {"positions": positions, "fitness": fits, "best": best, "best_fitness": f}


def wheel(weights: Vector, place: float) -> int:
    weights = weights if any(weights) else [1.0] * len(weights)
    at, place = 0.0, place * sum(weights)
    for k, weight in enumerate(weights):
        at += weight
        if place < at:
            return k
    return len(weights) - 1


def mating(record: Any, before: Any, fitness: Vector, rng: Any) -> list[int]:
    size = record.population
    if record.kind == "ga" and record.selection == "roulette":
        return [wheel(fitness, u) for u in rng.random(size)]
    if record.kind == "ga":
        first, second = (size * rng.random((2, size))).astype(int)
        pairs = zip(first, second, strict=True)
        return [b if fitness[b] > fitness[a] else a for a, b in pairs]
    order = sorted(range(size), key=list(before.fitness).__getitem__)
    best, middle = order[: size // 4], order[size // 4 : 3 * size // 4]
    share = before.iteration / max(1, record.iterations - 1)
    q = record.q_best - (record.q_best - record.q_worst) * share
    chances = [q * (1 - q) ** a for a in range(len(middle))]
    pool = best * (2 if record.pool_rule == "double-best" else 1)
    return pool + [middle[wheel(chances, u)] for u in rng.random(size - len(pool))]


def rates(record: Any, fitness: Vector) -> Vector:
    if record.kind == "ga":
        return [record.crossover_rate, record.mutation_rate]
    ratio = sum(fitness) / len(fitness) / max(fitness) if any(fitness) else 1.0
    at = math.asin(min(ratio, 1.0)) / (math.pi / 2)
    crossing = record.k1 * (1 - at) if ratio >= 0.5 else record.k4 * at
    mutating = record.k2 * at if ratio >= 0.5 else record.k3 * (1 - at)
    return [
        crossing if record.adaptive_crossover else record.crossover_fixed,
        mutating if record.adaptive_mutation else record.mutation_fixed,
    ]


def bits_of(record: Any) -> tuple[int, float]:
    low, high = record.position_range
    bits = next(b for b in range(1, 60) if (high - low) / (2**b - 1) <= record.resolution)
    return bits, (high - low) / (2**bits - 1)


def encoded(record: Any, x: Vector) -> Vector:
    low, high = record.position_range
    bits, step = bits_of(record)
    text = "".join(f"{round((clamp(one, low, high) - low) / step):0{bits}b}" for one in x)
    return [float(one) for one in text]


def decoded(record: Any, genes: Vector) -> Vector:
    bits, step = bits_of(record)
    text = "".join(str(int(one)) for one in genes)
    return [record.position_range[0] + int(text[k : k + bits], 2) * step
            for k in range(0, len(text), bits)]  # fmt: skip


def generation(record: Any, before: Any, rng: Any, judge: Judge) -> dict[str, Any]:
    low, high = record.position_range
    binary, size = record.encoding == "binary", record.population
    if before is None:
        x = (low + (high - low) * rng.random((size, 3))).tolist()
        x = [decoded(record, encoded(record, one)) for one in x] if binary else x
        fits = [judge(one) for one in x]
        best, f = leader(x, fits, x[0], INF)
        return {"positions": x, "fitness": fits, "best": best, "best_fitness": f}
    known = [f for f in before.fitness if f < record.penalty]
    worst = max(known, default=0.0)
    turned = record.fitness_rule == "inverse"
    fitness = [
        0.0 if f >= record.penalty else 1 / f if turned else worst - f for f in before.fitness
    ]
    crossing, mutating = rates(record, fitness)
    pool = [list(before.positions[k]) for k in mating(record, before, fitness, rng)]
    pool = [pool[k] for k in sorted(range(size), key=list(rng.random(size)).__getitem__)]
    rule = record.crossover
    if binary and rule != "arithmetic":
        pool = [encoded(record, one) for one in pool]
    genes = len(pool[0])
    mates = rng.random(size // 2) < crossing
    numbers = rng.random((size // 2, genes if rule == "uniform" else 1))
    for k in np.flatnonzero(mates):
        one, two, u = pool[2 * k], pool[2 * k + 1], numbers[k]
        for d in range(genes):
            a, b = one[d], two[d]
            if rule == "arithmetic":
                one[d], two[d] = u[0] * a + (1 - u[0]) * b, (1 - u[0]) * a + u[0] * b
            elif d >= 1 + int(u[0] * (genes - 1)) if rule == "one-point" else u[d] < 0.5:
                one[d], two[d] = b, a
    if binary and rule == "arithmetic":
        pool = [encoded(record, one) for one in pool]
    genes = len(pool[0])
    if record.mutated == "gene":
        hits = rng.random((size, genes)) < mutating
    else:
        which, place = rng.random((2, size))
        hits = [[which[i] < mutating and d == int(place[i] * genes) for d in range(genes)]
                for i in range(size)]  # fmt: skip
    sizes = rng.random((size, genes)) if not binary else None
    for i, d in np.argwhere(hits):
        if binary:
            pool[i][d] = 1 - pool[i][d]
        elif record.mutation == "creep":
            reach = record.mutation_reach * (high - low)
            pool[i][d] = clamp(pool[i][d] + reach * (2 * sizes[i][d] - 1), low, high)
        else:
            pool[i][d] = low + (high - low) * sizes[i][d]
    pool = [decoded(record, one) for one in pool] if binary else pool
    fits = [judge(one) for one in pool]
    survivors = getattr(record, "elite", 0)
    if getattr(record, "best_quarter", "") == "survives":
        survivors = size // 4
    old = sorted(range(size), key=list(before.fitness).__getitem__)[:survivors]
    out = sorted(range(size), key=fits.__getitem__)[size - survivors :]
    for a, b in zip(old, out, strict=True):
        pool[b], fits[b] = list(before.positions[a]), before.fitness[a]
    best, f = leader(pool, fits, before.best, before.best_fitness)
    return {"positions": pool, "fitness": fits, "best": best, "best_fitness": f}


LOOPS = {"pso": swarm, "mnam-pso": swarm, "constrained-pso": swarm, "woa": whales,
         "improved-woa": whales, "ga": generation, "improved-ga": generation}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_each_step_is_that_of_the_loop(kind: str) -> None:
    for seed in range(150):
        record = drawn(kind, np.random.default_rng((1, seed)))
        own, other = np.random.default_rng(seed), np.random.default_rng(seed)

        def many(x: np.ndarray, penalty: float = record.penalty) -> np.ndarray:
            return coarse(x, penalty)

        def judge(x: Vector, penalty: float = record.penalty) -> float:
            return float(coarse(np.array(x), penalty))

        before, known = None, {}
        for _ in range(7):
            wanted = LOOPS[kind](record, before, other, judge)
            after = record.step(before, BOUNDS, own, many) if before else record.init(
                BOUNDS, own, many
            )  # fmt: skip
            for name, values in wanted.items():
                np.testing.assert_allclose(
                    getattr(after, name), values, rtol=1e-9, atol=1e-12, err_msg=f"{name} {record}"
                )
            assert after.iteration == (before.iteration + 1 if before else 0)
            for name, values in known.items():  # what was before is left alone
                np.testing.assert_array_equal(getattr(before, name), values)
            before, known = after, {name: np.copy(getattr(after, name)) for name in wanted}
        assert own.random() == other.random()
