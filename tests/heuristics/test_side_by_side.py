"""Runs that are moved side by side: each gives the bits that it gives alone."""

from dataclasses import dataclass, replace

import pytest
from support.two_joints import WAYPOINTS, two_joints
from trajgap.heuristics import (
    KINDS,
    MNAMPSO,
    PSO,
    AskedRun,
    Run,
    from_settings,
    run,
    run_asked,
    run_many_per_joint,
    run_per_joint,
)
from trajgap.heuristics.side_by_side import TOGETHER, moves_together
from trajgap.problem import Limits, Problem, quintic_spline, rest_to_rest

PROBLEM = two_joints(duration_lower=0.3, duration_upper=3.0)
SLOWER = Problem(WAYPOINTS, Limits([2.0, 1.5], [8.0, 3.0]), quintic_spline(3), 0.1, 4.0)
STOPPING = Problem(WAYPOINTS, Limits([2.0, 1.5], [8.0, 3.0]), rest_to_rest(3, 5), 0.1, 4.0)
HANDLINGS = ("death-penalty", "stretch", "rescale")


def same(a: Run, b: Run) -> None:
    for name in ("durations", "trace", "position"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes(), name
    for name in ("seed", "stream", "problem", "objective", "evaluations", "feasible", "settings"):
        assert getattr(a, name) == getattr(b, name)


@pytest.mark.parametrize("kind", KINDS)
def test_questions_of_all_sorts_together(kind: str) -> None:
    algorithm = replace(from_settings(kind, {}), iterations=25)
    questions = [
        AskedRun(problem, seed, (), handling)
        for problem in (PROBLEM, SLOWER, STOPPING)
        for handling in HANDLINGS
        for seed in (3, 8)
    ]
    for one, found in zip(questions, run_asked(algorithm, questions), strict=True):
        same(found, run(algorithm, one.problem, one.seed, None, one.handling))


OPEN = [
    ("pso", {"draws": "particle", "velocity_rule": "free", "position_rule": "free"}),
    ("pso", {"draws": "iteration", "position_rule": "initial", "penalty": 1e6}),
    ("mnam-pso", {"mutated": "one", "niches_rule": "clusters"}),
    ("mnam-pso", {"niches_rule": "diagonal", "inertia_reading": "rises", "mutation_scale": 2.0}),
    ("woa", {"coefficients": "coordinate", "threshold_rule": "length", "replacement": "greedy"}),
    ("woa", {"r_rule": "shared", "counter": "one", "replacement": "feasible", "penalty": 1e6}),
    ("improved-woa", {"exploration": "weighted", "tent_rule": "member"}),
    ("improved-woa", {"exploration": "dropped", "replacement": "greedy", "position_rule": "free"}),
    ("ga", {"selection": "tournament", "crossover": "one-point", "elite": 3, "penalty": 1e6}),
    ("ga", {"fitness_rule": "complement", "mutation": "creep", "mutated": "individual"}),
    ("ga", {"encoding": "binary", "crossover": "uniform", "mutated": "individual"}),
    ("ga", {"position_range": (0.1, 0.3), "fitness_rule": "complement"}),  # often none is feasible
    ("improved-ga", {"pool_rule": "double-best", "best_quarter": "survives"}),
    ("improved-ga", {"encoding": "binary", "adaptive_crossover": False, "penalty": 1e6}),
    ("improved-ga", {"fitness_rule": "complement", "adaptive_mutation": False}),
]


@pytest.mark.parametrize(("kind", "settings"), OPEN)
def test_every_branch_takes_runs_side_by_side(kind: str, settings: dict[str, object]) -> None:
    algorithm = from_settings(kind, {**settings, "iterations": 25})
    assert moves_together(algorithm)
    questions = [AskedRun(p, seed) for p in (PROBLEM, SLOWER) for seed in range(3)]
    for one, found in zip(questions, run_asked(algorithm, questions), strict=True):
        same(found, run(algorithm, one.problem, one.seed))


def test_joints_and_more_seeds_than_are_moved_at_once() -> None:
    algorithm = MNAMPSO(particles=6, iterations=3)
    seeds = range(TOGETHER // 2 + 2)
    for seed, found in zip(seeds, run_many_per_joint(algorithm, PROBLEM, seeds), strict=True):
        alone = run_per_joint(algorithm, PROBLEM, seed)
        assert found.durations.tobytes() == alone.durations.tobytes()
        for j, (a, b) in enumerate(zip(found.runs, alone.runs, strict=True)):
            same(a, b)
            same(a, run_asked(algorithm, [AskedRun(PROBLEM.joint(j), seed, (j,))])[0])


def test_a_subclass_that_says_nothing_is_moved_by_itself() -> None:
    @dataclass(frozen=True)
    class Own(PSO):
        """Whose step may know of single swarms only."""

    assert moves_together(PSO())
    assert not moves_together(Own())
    questions = [AskedRun(PROBLEM, seed) for seed in (1, 2)]
    for a, b in zip(
        run_asked(Own(iterations=4), questions),
        run_asked(PSO(iterations=4), questions),
        strict=True,
    ):
        assert a.trace.tobytes() == b.trace.tobytes()
