"""What a run says of itself, for every search, objective and kind of problem: a product."""

import numpy as np
import pytest
from support.positions import SWINGING
from support.two_joints import PROBLEM, WAYPOINTS, two_joints
from trajgap.heuristics import (
    GA,
    MNAMPSO,
    PSO,
    WOA,
    ConstrainedPSO,
    DeathPenalty,
    Handling,
    ImprovedGA,
    ImprovedWOA,
    Search,
    differential_evolution,
    dual_annealing,
    run,
    shgo,
)
from trajgap.heuristics.repair import judge_of
from trajgap.problem import Limits, Problem, Verdict, check, cubic_spline, quintic_spline

JERKY = two_joints(
    Limits([4.0, 5.0], [8.0, 9.0], [60.0, 80.0]), duration_lower=0.1, duration_upper=9.0
)
SPLINE = Problem(WAYPOINTS[:, 0], Limits(2.5, 6.0), cubic_spline(3), 0.05, 2.5)
LONG = Problem(
    np.random.default_rng(31).uniform(-2, 2, (10, 3)),
    Limits([2.0, 3.0, 2.5], [6.0, 5.0, 9.0]),
    quintic_spline(9),
    0.0,
    6.0,
    name="nine segments",
)
SEARCHES = (
    PSO(),
    MNAMPSO(),
    ConstrainedPSO(position_rule="bounds", position_max=9.0),
    WOA(position_initial=(0.3, 3.0)),
    ImprovedWOA(position_initial=(0.3, 3.0)),
    GA(population=32, position_range=(0.05, 3.0)),
    ImprovedGA(population=32, position_range=(0.05, 3.0)),
    differential_evolution(),
    dual_annealing(),
    shgo(),
)
PENAL = Handling.DEATH_PENALTY


@pytest.mark.parametrize("handling", Handling)
@pytest.mark.parametrize("search", SEARCHES, ids=lambda s: s.kind)
def test_the_account_of_a_run(search: Search, handling: Handling) -> None:
    for problem in (PROBLEM, JERKY, SPLINE, LONG, SWINGING):
        found = run(search, problem, 3, 60, objective=handling)
        assert (found.algorithm, found.objective) == (search.kind, handling)
        assert found.iterations == found.settings.iterations == 60
        assert found.trace.shape == (61,)
        assert (found.trace[1:] <= found.trace[:-1]).all()
        judge = judge_of(problem, np.inf, handling)
        np.testing.assert_array_equal(judge.decode(found.position[None])[0], found.durations)
        mutants = 61 if search.kind == "mnam-pso" else 0
        most = 61 * (32 if "ga" in search.kind.split("-") else 30) + mutants
        assert found.evaluations == most if search in SEARCHES[:7] else found.evaluations <= most
        assert found.feasible or handling is PENAL
        if found.feasible:
            assert found.reported_time == found.trace[-1] == found.durations.sum()
            assert check(problem, found.durations).verdict is Verdict.PASS
            assert DeathPenalty(problem)(found.durations[None])[0] == found.reported_time


@pytest.mark.parametrize("search", SEARCHES, ids=lambda s: s.kind)
def test_same_seed_same_bits(search: Search) -> None:
    a, b, other = (run(search, PROBLEM, seed, 20) for seed in (7, 7, 8))
    assert a.durations.tobytes() == b.durations.tobytes()
    assert a.trace.tobytes() == b.trace.tobytes()
    same = a.trace.tobytes() == other.trace.tobytes()
    assert same == (search.kind == "shgo")  # which draws nothing
