"""Optima where the ends move differently: identities, brute force, conditions, refusals."""

import numpy as np
import pytest
from trajgap.heuristics import PSO, run, run_per_joint
from trajgap.nlp import Status, certify, problem_seal, solve
from trajgap.nlp.optimum.optimality import kkt
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    keeps_limits,
    piecewise,
    quintic_spline,
)
from trajgap.verify import Subject

WAYPOINTS = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
LIMITS = Limits([1.1, 1.7], [3.0, 2.2])
CURVES = {
    "cubic": cubic_spline(3, ((1, (0.5, -0.2)),), ((1, (-0.3, 0.4)),)),
    "velocity, then acceleration": cubic_spline(3, ((1, (0.5, -0.2)),), ((2, (0.0, 1.5)),)),
    "quintic": quintic_spline(3, ((1, (0.5, -0.2)), (2, 0.3)), ((1, (-0.3, 0.4)), (2, 0.0))),
    "4-3-4": piecewise((4, 3, 4), 2, ((1, (0.5, -0.2)), (2, 0.0)), None, ((1, 0.1), (2, 0.0))),
}


def problem_of(curve: Interpolant, limits: Limits = LIMITS, **more: object) -> Problem:
    return Problem(WAYPOINTS, limits, curve, 0.05, 6.0, **more)


@pytest.mark.parametrize("name", CURVES)
def test_the_optimum_is_one(name: str) -> None:
    problem = problem_of(CURVES[name])
    found = solve(problem)
    assert found.status is Status.OPTIMAL
    assert found.durations is not None
    assert check(problem, found.durations).verdict is Verdict.PASS
    assert kkt(problem, found.durations).residual <= 1e-8
    rng = np.random.default_rng(1)
    near = found.durations * np.exp(
        rng.normal(0.0, rng.choice([0.003, 0.1, 0.6], (30000, 1)), (30000, 3))
    )
    near = near[keeps_limits(problem, near, 0.0) & (near <= 6.0).all(axis=1)]
    assert len(near) > 50
    assert near.sum(axis=1).min() >= found.total_time * (1 - 1e-9)
    assert near.sum(axis=1).min() <= found.total_time * 1.02


def test_a_straight_line_has_a_closed_form() -> None:
    """One cubic, v₀ to v₁: with v alone limited by its peak; joint 2 stands and never decides."""
    curve = piecewise((3,), 2, ((1, (0.4, 0.0)),), finish=((1, (0.9, 0.0)),))
    found = solve(Problem([[0.0, 0.2], [1.0, 0.2]], Limits(1.0, joints=2), curve))
    # v(s) = v₀ + (6d/h − 4v₀ − 2v₁)s + (3(v₀ + v₁) − 6d/h)s², and its peak is 1.
    total = found.total_time
    a, b = 6 / total - 4 * 0.4 - 2 * 0.9, 3 * (0.4 + 0.9) - 6 / total
    assert 0.4 - a * a / (4 * b) == pytest.approx(1.0, abs=1e-9)


def test_a_velocity_beyond_one_joints_limit_is_proved_infeasible() -> None:
    curve = cubic_spline(3, ((1, 0.0),), ((1, (0.1, -1.8)),))
    found = solve(problem_of(curve))
    assert found.status is Status.INFEASIBLE
    assert "velocity prescribed at break 3 exceeds the limit of joint 2" in found.why
    one_way = Limits([1.1, 1.7], [[-3.0, 3.0], [-1.0, 2.2]])
    bent = cubic_spline(3, ((1, 0.0),), ((2, (0.0, -1.5)),))
    assert solve(problem_of(bent, one_way)).status is Status.INFEASIBLE
    assert "exceeds" not in str(solve(problem_of(bent)).why)


def test_searches_know_them() -> None:
    problem = problem_of(CURVES["cubic"])
    best = solve(problem).total_time
    swarm = PSO(particles=20, iterations=80, position_initial=(0.2, 3.0))
    found = run(swarm, problem, 2)
    assert check(problem, found.durations).verdict is Verdict.PASS
    assert best * (1 - 1e-9) <= found.reported_time <= 1.3 * best
    for j, one in enumerate(run_per_joint(swarm, problem, 2).runs):
        assert check(problem.joint(j), one.durations).verdict is Verdict.PASS
    with pytest.raises(TrajgapError, match="a prescribed derivative is not 0"):
        run(swarm, problem, 2, objective="stretch")


def test_the_declared_curve_has_no_proof_and_any_curve_a_bound() -> None:
    problem = problem_of(CURVES["cubic"])
    with pytest.raises(TrajgapError, match="no proof covers such a curve yet"):
        certify(problem, seconds=1.0)
    found = certify(problem, subject=Subject.ANY, gap=0.5, seconds=20.0)
    assert 0 < found.lower <= solve(problem).total_time
    # Problems that differ in one joint's end alone are told apart.
    other = problem_of(cubic_spline(3, ((1, (0.5, -0.2)),), ((1, (-0.3, 0.5)),)))
    assert problem_seal(problem) != problem_seal(other)
