"""
Where three searches end
========================

Ten runs each of a swarm, a genetic algorithm and whales, at the settings that papers print: every
dot is the total that a run reports, beside the optimum and the printed total.
"""

from trajgap.compare.pictures import endings
from trajgap.heuristics import GA, PSO, WOA, run_many
from trajgap.nlp import solve
from trajgap.problem import load_case

problem = load_case("puma560-mnam-pso-353").problem()
best = solve(problem)
runs = {
    name: run_many(search, problem, seeds=range(10))
    for name, search in {
        "PSO": PSO(particles=20, iterations=60),
        "GA": GA(iterations=60),
        "WOA": WOA(iterations=60),
    }.items()
}
endings(runs, {"optimum": best.total_time}, {"Table 3": 3.528}, title="Where ten runs end")
