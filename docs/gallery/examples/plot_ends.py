"""
Where two searches end
======================

Ten runs each of the paper's own two swarms, with the settings and the 200 iterations that it
prints: every dot is the total that a run reports, beside the optimum of six joints that share their
durations and the total that the paper prints.
"""

import numpy as np
from trajgap.compare.pictures import endings
from trajgap.heuristics import from_settings, run_many
from trajgap.nlp import solve
from trajgap.problem import load_case

case = load_case("puma560-mnam-pso-353")
problem = case.problem()
best = solve(problem)
ends = {}
for paper in case.algorithms:
    runs = run_many(from_settings(paper.kind, paper.parameters), problem, seeds=range(10))
    ends[paper.name] = np.array([run.reported_time for run in runs])
endings(ends, {"optimum": best.total_time}, {"Table 3": 3.528}, title="Where ten runs end")
