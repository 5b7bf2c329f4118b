"""Positions of virtual breaks as decision variables: an optimum by a route without our code."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.optimize import minimize
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.problem import Limits, Problem, Verdict, check, curves, fit

Q = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
LIMITS = Limits([1.1, 1.7], [3.0, 2.2], [20.0, 15.0])
LOW, HIGH = np.array([-0.62, -1.02]), np.array([0.915, 0.36])
SAMPLES = 41
"""Of each segment: limits are asked for there alone, so scipy's total is a little short."""


def by_scipy(problem: Problem, ranges: bool) -> float:
    """Shortest total over durations and positions of virtual breaks, limits held at samples."""
    curve = problem.piecewise
    n, k, joints = curve.segments, curve.degrees[0], Q.shape[1]
    virtual, given = list(curve.virtual), list(curve.waypoint_breaks)
    rest = [(order, np.zeros(joints)) for order, _ in curve.prescribed[0]]
    limits = problem.limits.derivatives

    def room(z: np.ndarray) -> np.ndarray:
        t = np.concatenate([[0.0], np.cumsum(z[:n])])
        points = np.empty((n + 1, joints))
        points[given], points[virtual] = Q, z[n:].reshape(-1, joints)
        knots = np.concatenate([[0.0] * (k + 1), t[1:-1], [t[-1]] * (k + 1)])
        spline = make_interp_spline(t, points, k=k, t=knots, bc_type=(rest, rest))
        at = (t[:-1, None] + z[:n, None] * np.linspace(0.0, 1.0, SAMPLES)).ravel()
        left = [
            1.0 + sign * spline(at, r) / limits[:, r - 1] for r in (1, 2, 3) for sign in (-1, 1)
        ]
        left += [HIGH - spline(at), spline(at) - LOW] if ranges else []
        return np.concatenate([part.ravel() for part in left])

    chords = [np.interp(b, given, column) for b in virtual for column in Q.T]
    found = minimize(
        lambda z: z[:n].sum(),
        np.concatenate([np.full(n, 1.5), chords]),
        method="SLSQP",
        constraints=[{"type": "ineq", "fun": room}],
        bounds=[(0.2, None)] * n + [(None, None)] * len(chords),
        options={"maxiter": 400, "ftol": 1e-10},
    )
    assert found.success
    return float(found.fun)


@pytest.mark.parametrize("virtual", [(2,), (2, 3)])
def test_the_optimum_agrees_with_slsqp(virtual: tuple[int, ...]) -> None:
    curve = curves.quintic_spline(3 + len(virtual), virtual=virtual)
    asked = Problem(Q, LIMITS, curve, duration_lower=0.2)
    solution = solve(asked)
    assert solution.status is Status.CONVERGED
    assert solution.nodal.shape == (len(virtual), 2)
    theirs = by_scipy(asked, ranges=False)
    # Held at samples alone, limits allow a little more.
    assert theirs * (1 - 1e-6) <= solution.total_time <= theirs * (1 + 1e-3)
    # A way-point that may lie anywhere costs nothing: it may lie where the spline goes anyway.
    settled = solve(Problem(Q, LIMITS, curves.quintic_spline(3), duration_lower=0.2))
    assert solution.total_time < settled.total_time + 0.2 * len(virtual)


def test_position_limits_hold_for_virtual_breaks_and_between() -> None:
    curve = curves.quintic_spline(5, virtual=(1, 3))
    wide = Problem(Q, LIMITS, curve, duration_lower=0.2)
    tight = Problem(Q, LIMITS.with_positions(LOW, HIGH), curve, duration_lower=0.2)
    free, held = solve(wide), solve(tight)
    assert held.found
    assert free.nodal is not None
    beyond = check(tight, free.durations, free.nodal)
    assert beyond.verdict is Verdict.VIOLATED
    assert beyond.worst.quantity == "position"
    assert held.check.verdict is Verdict.PASS
    assert held.total_time > free.total_time * (1 + 1e-6)
    path = fit(curve, Q, held.durations, held.nodal)(np.linspace(0, held.total_time, 2001))
    assert (path >= LOW - 1e-9).all()
    assert (path <= HIGH + 1e-9).all()
    theirs = by_scipy(tight, ranges=True)
    assert theirs * (1 - 1e-6) <= held.total_time <= theirs * (1 + 2e-3)


def test_a_virtual_break_out_of_range_is_a_violated_position() -> None:
    curve = curves.cubic_spline(4, ((1, 0.0), (2, 0.0)), virtual=(1, 2, 3))
    assert curve.free == 1
    problem = Problem(Q[:2], LIMITS.with_positions(-1.5, 1.5), curve)
    found = check(problem, [2.0, 2.0, 2.0, 2.0], [[1.9, 0.0]])
    assert found.verdict is Verdict.VIOLATED
    assert (found.worst.quantity, found.worst.joint) == ("position", problem.joints[0])
    assert found.worst.value >= 1.9


def test_a_segment_at_a_virtual_break_that_shrinks_is_no_optimum() -> None:
    """Jerk is limited and snap is not: both ends may shrink until float64 loses the curve."""
    curve = curves.quintic_spline_virtual(3)
    solution = solve(Problem(Q[:3, :1], Limits(1.1, 3.0, 20.0), curve), starts=2)
    assert solution.found
    assert solution.check.verdict is Verdict.PASS
    assert solution.status is Status.NOT_ATTAINED
    assert solution.why == "the total falls as the duration of segment 1, 4 goes to 0"
    bounded = Problem(Q[:3, :1], Limits(1.1, 3.0, 20.0), curve, duration_lower=0.2)
    longer = solve(bounded, starts=2)
    assert longer.status is Status.CONVERGED
    assert longer.total_time > solution.total_time
