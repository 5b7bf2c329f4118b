"""
Compare optimisers with the optimum
===================================

How near do optimisers come to the proven optimum of a published problem, and how soon?
"""

# %%
# The problem of a published case, and its optimum:

import trajgap as tg
from trajgap.compare import measure_gaps

problem = tg.load_case("puma560-mnam-pso-353").problem()
optimum = tg.solve(problem)
print(optimum)

# %%
# Your optimiser is a function. ``fun`` takes durations and returns the total time, with a penalty
# if a limit is broken. ``rng`` is the only source of randomness. The result is the best vector
# that ``fun`` has judged.


def evolve(fun, bounds, budget, rng):
    """Step from the best so far, further after a success and less far after a failure."""
    lower, upper = bounds.T
    best = rng.uniform(lower, upper)
    total, step = fun(best), 0.3
    for _ in range(budget - 1):
        moved = best + step * (upper - lower) * rng.normal(size=len(best))
        found = fun(moved.clip(lower, upper))
        step *= 1.5 if found < total else 0.92
        if found <= total:
            best, total = moved.clip(lower, upper), found


# %%
# It runs ten times, beside a swarm, differential evolution of scipy, and simple baselines. Every
# optimiser has 1000 evaluations for each run.

optimizers = [evolve, "pso", "scipy:differential_evolution"]
runs = tg.bench(problem, optimizers, seeds=10, budget=1000)
print(measure_gaps(runs, optimum))

# %%
# Gaps to the optimum over the evaluations, and the share of runs that come within 1 %:

tg.plot(runs, optimum)
