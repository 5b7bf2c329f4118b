"""
A swarm against the optimum
===========================

The best total so far of twenty seeds, with median and quartiles, beside the optimum. A search
that repairs an answer by stretching it ends closer than one that penalises it.
"""

from trajgap.compare.pictures import convergence
from trajgap.heuristics import PSO, run_many
from trajgap.nlp import solve
from trajgap.problem import load_case

problem = load_case("puma560-mnam-pso-353").problem()
swarm = PSO(particles=20, iterations=60)
runs = {
    "penalty": run_many(swarm, problem, seeds=range(20)),
    "stretched": run_many(swarm, problem, seeds=range(20), objective="stretch"),
}
convergence(runs, solve(problem).total_time, {"printed": 3.528}, title="PSO, 20 particles")
