"""
The landscape that a swarm searches
===================================

Three segments leave two ratios free, so all problems of this kind fit into a triangle.
Height is the least total of durations in that ratio. Dots show where ten runs of a swarm ended.
"""

from trajgap.compare.pictures import landscape
from trajgap.heuristics import PSO, run_many
from trajgap.nlp import solve
from trajgap.problem import load_case

problem = load_case("puma560-mnam-pso-353").problem()
runs = run_many(PSO(particles=20, iterations=60), problem, seeds=range(10))
ends = {"PSO": [run.durations for run in runs]}
printed = [("Table 3, last row", [1.044, 1.258, 1.225])]
landscape(problem, solve(problem), printed, ends, title="PUMA 560, 3-5-3 polynomials")
