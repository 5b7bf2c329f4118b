"""Reference: SCIP on the lifted form of C4 quintic problems (``pip install pyscipopt`` first).

``python benchmarks/quintic_scip.py [--seconds S] [--first F] [--every N]``. Unknowns: the inverse
durations and the velocities and accelerations at the way-points; C3 and C4 conditions are
polynomial equations, limits hold at nine places of a segment: a relaxation, whose lower bound SCIP
states in floating point, without proof. The answer of `solve` bounds the total from above.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from pyscipopt import Model, quicksum
from quintic_instances import instances
from quintic_lifted import derivative
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, quintic_spline
from trajgap.verify.quintic_bound import LOAD, LOAD_POWERS, POWERS, STIFFNESS


def small():
    """Three segments, two joints."""
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    return Problem(q, Limits([1.0, 0.9], [2.0, 1.5]), quintic_spline(3), name="three segments")


def lower_bound(problem, upper, seconds):
    """SCIP's lower bound and its number of nodes after some seconds of the processor."""
    n, joints = problem.segments, problem.waypoints.shape[1]
    step = np.diff(problem.waypoints, axis=0)
    limits = np.stack([problem.limits.velocity, problem.limits.acceleration], axis=1)
    shortest = np.maximum((np.abs(step) / limits[:, 0]).max(axis=1), 1e-3)
    model = Model()
    model.hideOutput()
    model.setParam("timing/clocktype", 1)
    model.setParam("limits/time", seconds)
    h = [model.addVar(lb=float(low), ub=upper) for low in shortest]
    r = [model.addVar(lb=1.0 / upper, ub=1.0 / float(low)) for low in shortest]
    for a, b in zip(h, r, strict=True):
        model.addCons(a * b == 1)
    model.addCons(quicksum(h) <= upper)
    model.setObjective(quicksum(h), "minimize")
    for j in range(joints):
        state = [
            [model.addVar(lb=-float(x), ub=float(x)) if 0 < k < n else 0.0 for x in limits[j]]
            for k in range(n + 1)
        ]
        rows = [[0.0, 0.0] for _ in range(n + 1)]
        for k in range(n):
            ends = [state[k][0], state[k + 1][0], state[k][1], state[k + 1][1]]
            for a in range(4):
                terms = [
                    float(STIFFNESS[a, b]) * r[k] ** int(POWERS[a, b]) * ends[b] for b in range(4)
                ]
                load = float(LOAD[a] * step[k, j]) * r[k] ** int(LOAD_POWERS[a])
                rows[k + a % 2][a // 2] += quicksum(terms) - load
            for order in (1, 2):
                for spot in range(9):
                    shape = derivative(order, spot / 8.0)
                    scaled = [step[k, j] * r[k] * r[k], r[k] * ends[0], r[k] * ends[1], *ends[2:]]
                    value = quicksum(float(c) * x for c, x in zip(shape, scaled, strict=True))
                    limit = float(limits[j, order - 1]) * (r[k] if order == 1 else 1.0)
                    model.addCons(value <= limit)
                    model.addCons(value >= -limit)
        for k in range(1, n):
            for row in rows[k]:
                model.addCons(row == 0)
    model.optimize()
    return model.getDualbound(), model.getNNodes()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--every", type=int, default=10)
    given = parser.parse_args()
    print(
        "| problem | upper | SCIP's lower | gap | nodes | processor s |\n|---|---|---|---|---|---|"
    )
    for problem in [small(), *instances()[given.first :: given.every]]:
        began = time.process_time()
        upper = float(solve(problem, seed=0).total_time)
        lower, nodes = lower_bound(problem, upper, given.seconds)
        spent = time.process_time() - began
        gap = 1.0 - lower / upper
        print(f"| {problem.name} | {upper:.4f} | {lower:.4f} | {gap:.3f} | {nodes} | {spent:.0f} |")


if __name__ == "__main__":
    main()
