"""Motions whose limits rounding errors blur: `solve` answers a motion that passes beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from trajgap.nlp import Solution, Status, solve
from trajgap.nlp.optimum.decided import decided
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    piecewise,
    quintic_spline,
    rest_to_rest,
)

NEAR_QUINTIC = Problem(
    np.array([[-0.394038, 2.80925], [-0.394038023162454, 2.809249937965431], [-2.52596, 2.12646]]),
    Limits([5.14295, 4.66445]),
    quintic_spline(2),
)
"""Tight, its velocity is known to 1.3e-7 only."""
NEAR_REST = Problem(
    np.array([[-3.08589], [-3.0858899778318474], [-1.21865]]),
    Limits(2.43707, 8.27705, 10.201, joints=1),
    rest_to_rest(2, 5),
)
"""The first segment moves by 2.2e-8: its jerk is known to 2.8e-8."""
NEAR_SLOW = Problem(
    np.array([[0.00168312783469821], [0.00251930784423248], [0.00251930779740281]]),
    Limits(2.1137213420343702e-05, 2.757546657639957e-07, joints=1),
    rest_to_rest(2, 3),
)
"""The second segment moves by 4.7e-11."""
NEAR_FIVE = Problem(
    np.array(
        [
            [0.02641919780979038, -0.05700448060931738],
            [-0.00631502113016282, 0.02240755551189397],
            [0.00652073455840059, 0.03352738393464709],
            [0.0065207544991108, 0.0335274146687773],
            [0.15895292051981613, 0.00249910148870389],
        ]
    ),
    Limits(
        [1.086840655163135, 0.22097923251188928],
        [7.368688674971463, 1.5888442219157457],
        [65.07287923439381, 24.72364296814572],
        [-0.04583593782741489, -0.0786535884520687],
        [0.20667036201780242, 0.05966648540146378],
    ),
    quintic_spline(4),
)
"""The third segment moves by 4e-8."""


@pytest.mark.parametrize(
    ("problem", "passes"),
    [
        (NEAR_QUINTIC, [4.9419900922386256e-05, 0.71683133566835033]),
        (NEAR_REST, [0.0050712534971524368, 2.2229969394083788]),
        pytest.param(
            NEAR_FIVE,
            [5.57461316053e-01, 9.62392269288e-02, 2.6287550645156e-07, 5.16148513876e-01],
            marks=pytest.mark.slow,
        ),
    ],
)
def test_no_search_beats_an_answer_that_rounding_blurs(
    problem: Problem, passes: list[float]
) -> None:
    """The searches of the attacks and of the benchmark found these motions."""
    assert check(problem, passes).verdict is Verdict.PASS
    solution = solve(problem)
    assert solution.status is Status.CONVERGED
    assert solution.kkt_residual < 1e-8
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
    assert solution.best <= sum(passes) * (1 + 1e-6)


@pytest.mark.parametrize(("problem", "factors"), [(NEAR_REST, None), (NEAR_SLOW, (1.5, 6.0))])
def test_blurred_rest_to_rest_answers_are_those_in_closed_form(
    problem: Problem, factors: tuple[float, float] | None
) -> None:
    way = np.abs(np.diff(problem.waypoints, axis=0))[:, 0]
    speed, bend = factors or (1.875, 10.0 / np.sqrt(3.0))
    v, a, j = problem.limits.derivatives[0]
    least = np.maximum(speed * way / v, np.sqrt(bend * way / a))
    if np.isfinite(j):
        least = np.maximum(least, np.cbrt(60.0 * way / j))
    assert solve(problem).best == pytest.approx(least.sum(), rel=1e-7)


def test_a_stretch_past_rounding_is_said_and_small() -> None:
    solution = solve(NEAR_QUINTIC)
    assert "than a tight motion, which rounding errors blur" in str(solution.why)
    shorter = solution.durations / (1 + 2e-7)
    assert check(NEAR_QUINTIC, shorter).verdict is not Verdict.PASS


def test_a_motion_at_its_duration_bound_is_decided_by_a_descent() -> None:
    h = np.array([4.99108e-05, 0.7166245])
    h *= check(NEAR_QUINTIC, h).stretch
    bounded = replace(NEAR_QUINTIC, duration_upper=[h[0], 2.0])
    assert check(bounded, h).verdict is Verdict.UNDECIDED
    found = decided(bounded, h)
    assert found is not None
    assert found.durations[0] <= h[0]
    assert found.total < h.sum()
    assert check(bounded, found.durations).verdict is Verdict.PASS
    assert decided(replace(NEAR_REST, duration_upper=[9.0, 2.0]), np.array([1.0, 2.0])) is None


@pytest.mark.parametrize("curve", [rest_to_rest(2, 5), piecewise((5, 5), 2)])
def test_where_a_stretch_gives_a_feasible_motion_it_is_the_answer(
    monkeypatch: pytest.MonkeyPatch, curve: Interpolant
) -> None:
    from trajgap.nlp.optimum import solver

    def lost(one: Problem, *_: object) -> Solution:
        return Solution(one, Status.FAILED, "lost")

    monkeypatch.setattr(solver, "_tracked", lost)
    monkeypatch.setattr(solver, "_searched", lost)
    monkeypatch.setattr(solver, "_challenged", lambda one, *_: lost(one))
    monkeypatch.setattr(solver, "_after_restoration", lambda one, *_: lost(one))
    problem = Problem(np.array([[0.3], [1.1], [0.2]]), Limits(1.0, 2.0, joints=1), curve)
    solution = solve(problem)
    assert solution.status is not Status.FAILED
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
