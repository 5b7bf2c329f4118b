"""
The curves of a paper, drawn again
==================================

Figures 5 to 7 of the PUMA 560 paper show how its two swarms converge on joints 1 to 3; the text
that the case was read from contains no figures. Here both are run again with the printed settings
and 200 iterations, on each joint separately, as in the paper. Figures 8 to 10, the motion with the
longest printed time of each segment, follow from the printed numbers alone.
"""

from trajgap.compare.pictures import convergence, motion_picture
from trajgap.heuristics import from_settings, run_many
from trajgap.nlp import solve
from trajgap.problem import load_case

case = load_case("puma560-mnam-pso-353")
problem = case.problem()

# %%
# Figures 5, 6 and 7: fitness over the iterations, joints 1 to 3.


def figure(joint, printed):
    """Both swarms on one joint, beside its optimum and the printed total."""
    alone = problem.joint(joint)
    runs = {
        paper.name: run_many(from_settings(paper.kind, paper.parameters), alone, seeds=range(10))
        for paper in case.algorithms
    }
    best = solve(alone).total_time
    return convergence(runs, best, {"printed": printed}, title=f"Joint {joint + 1} by itself")


figure_5, figure_6, figure_7 = figure(0, 3.298), figure(1, 2.289), figure(2, 3.172)

# %%
# Figures 8, 9 and 10: angles, velocities and accelerations of all joints.

motion_picture(problem, [1.044, 1.258, 1.225], title="Figures 8 to 10: the printed motion")
