"""Fixtures that several tests here share."""

from dataclasses import replace

import numpy as np
import pytest
from support.drawn import DURATIONS, PROBLEM, STEPS, fall
from trajgap.compare.pictures.drawing import Picture
from trajgap.compare.pictures.gap_bands import waterfall_picture
from trajgap.compare.pictures.motion import motion_picture
from trajgap.compare.pictures.searches import convergence, endings
from trajgap.compare.pictures.totals_map import landscape
from trajgap.heuristics import PSO, JointRuns, Run, run, run_per_joint
from trajgap.nlp import Solution, solve
from trajgap.problem import Limits, Problem, check


@pytest.fixture(scope="session")
def problem() -> Problem:
    return PROBLEM


@pytest.fixture(scope="session")
def optimum(problem: Problem) -> Solution:
    return solve(problem, starts=2)


@pytest.fixture(scope="session")
def runs(problem: Problem) -> dict[str, list[Run]]:
    small = PSO(particles=8, iterations=12)
    return {
        "swarm": [run(small, problem, seed) for seed in range(4)],
        "other": [run(replace(small, inertia=0.4), problem, seed) for seed in range(4)],
    }


@pytest.fixture(scope="session")
def joint_runs(problem: Problem) -> dict[str, list[JointRuns]]:
    small = PSO(particles=8, iterations=12)
    return {"swarm": [run_per_joint(small, problem, seed) for seed in range(3)]}


@pytest.fixture(scope="session")
def pictures(
    problem: Problem,
    optimum: Solution,
    runs: dict[str, list[Run]],
    joint_runs: dict[str, list[JointRuns]],
) -> dict[str, Picture]:
    total = optimum.total_time
    jerk = replace(problem, limits=Limits([3.0, 5.0], [9.0, 14.0], [80.0, 200.0]))
    totals = {name: np.array([r.reported_time for r in many]) for name, many in runs.items()}
    ends = {name: np.array([r.durations for r in many]) for name, many in runs.items()}
    return {
        "curves": motion_picture(
            problem, DURATIONS, title="Motion", check=check(problem, DURATIONS)
        ),
        "jerk": motion_picture(jerk, DURATIONS, title="Motion with jerk", note="a note"),
        "waterfall": waterfall_picture(fall(*STEPS), title="Where the time goes"),
        "convergence": convergence(
            runs, total, {"a": 1.1 * total, "b": 0.99 * total}, title="Runs"
        ),
        "joints": convergence(joint_runs, [1.2, 1.3], {"t": [1.4, np.nan]}, title="Joints"),
        "endings": endings(
            totals, {"optimum": total}, {"a": 1.3 * total, "b": 2 * total}, title="E"
        ),
        "landscape": landscape(problem, optimum, [("t", DURATIONS)], ends, title="Shares"),
    }
