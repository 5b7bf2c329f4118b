"""Runs that are moved side by side: each gives the bits that it gives alone."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from support.drawn_settings import drawn
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
def test_questions_of_all_sorts_and_every_choice_together(kind: str) -> None:
    for seed in range(13):
        algorithm = drawn(kind, np.random.default_rng(seed)) if seed else from_settings(kind, {})
        algorithm = replace(algorithm, iterations=12)
        assert moves_together(algorithm) == (kind != "constrained-pso")
        questions = [
            AskedRun(problem, at, (), handling)
            for problem in (PROBLEM, SLOWER, STOPPING)
            for handling in HANDLINGS
            for at in (3, 8)
        ]
        for one, found in zip(questions, run_asked(algorithm, questions), strict=True):
            same(found, run(algorithm, one.problem, one.seed, None, one.handling))


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
