"""Objects of other libraries, read exactly: the libraries themselves say what they are."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import BPoly, PPoly, make_interp_spline
from trajgap.problem import Verdict
from trajgap.problem.motions import JointLimits, Motion, as_motion, check_motion

WAYS = np.array([[0.3, 1.0], [1.0, -0.5], [0.2, 0.4], [1.5, 2.0]])


def same(motion, truth, orders=(0, 1, 2), loose=1e-7, start=0.0):
    at = np.linspace(motion.breaks[0], motion.breaks[-1], 501)[1:-1]
    for order in orders:
        wanted = np.array([truth(float(t) + start, order) for t in at])
        np.testing.assert_allclose(motion(at, order), wanted, rtol=loose, atol=loose)


def test_scipys_bernstein_polynomials():
    rng = np.random.default_rng(1)
    held = BPoly(rng.normal(size=(4, 3, 2)), [1.0, 1.5, 3.0, 3.2])
    same(as_motion(held), lambda t, order: held(t, nu=order))


def test_one_joint_of_scipy_needs_no_second_axis():
    one = as_motion(PPoly([[1.0], [2.0]], [0.0, 1.0]), ("a",))
    assert one(0.5).tolist() == [2.5]
    assert as_motion(one) is one
    spline = make_interp_spline(np.arange(6.0), np.arange(6.0) ** 2, k=3)
    assert as_motion(spline)(2.5)[0] == pytest.approx(6.25)


def path():
    import toppra

    return toppra.SplineInterpolator([0.0, 0.4, 0.7, 1.3], WAYS)


def test_toppras_path():
    same(as_motion(path()), path())


@pytest.mark.parametrize("how", ["ParametrizeConstAccel", "ParametrizeSpline"])
def test_toppras_answers_are_read_as_they_are(how):
    import toppra
    from toppra import algorithm, constraint

    limits = [
        constraint.JointVelocityConstraint([2.0, 3.0]),
        constraint.JointAccelerationConstraint([5.0, 9.0]),
    ]
    toppra.setup_logging("ERROR")
    answer = algorithm.TOPPRA(
        limits, path(), gridpoints=np.linspace(0, 1.3, 60), parametrizer=how
    ).compute_trajectory(0.0, 0.0)
    motion = as_motion(answer)
    assert motion.total_time == pytest.approx(answer.duration)
    same(motion, answer, orders=(0, 1), loose=1e-6)
    found = check_motion(motion, JointLimits.from_values(motion.joints, [2.0, 3.0], [5.0, 9.0]))
    # Its constraints hold at grid points: between them the acceleration is larger.
    at = np.linspace(1e-6, answer.duration - 1e-6, 4001)
    seen = np.abs(answer(at, 2)).max(axis=0) / [5.0, 9.0]
    assert found.worst.ratio >= seen.max() * (1 - 1e-9)
    assert found.verdict is Verdict.VIOLATED


def test_toppras_grid_may_meet_knots_up_to_rounding():
    """1/3 as a knot and as a grid point differ by rounding: no step of that length arises."""
    from toppra import SplineInterpolator
    from toppra.parametrizer import ParametrizeConstAccel

    knots = np.array([0.0, 1.0, 2.0, 3.0]) / 3.0
    grid = np.linspace(0.0, 1.0, 151)
    grid[50], grid[100] = np.nextafter(knots[1], 0.0), np.nextafter(knots[2], 1.0)
    speeds = np.sqrt(grid * (1.0 - grid))
    answer = ParametrizeConstAccel(SplineInterpolator(knots, WAYS), grid, speeds)
    motion = as_motion(answer)
    assert motion.durations.size == 150
    same(motion, answer, orders=(0, 1, 2))


def test_ruckigs_profiles():
    ruckig = pytest.importorskip("ruckig")
    rng = np.random.default_rng(5)
    for _ in range(20):
        asked = ruckig.InputParameter(3)
        asked.current_position, asked.target_position = rng.normal(size=(2, 3)).tolist()
        asked.current_velocity = rng.uniform(-0.5, 0.5, 3).tolist()
        limits = rng.uniform(0.6, 3.0, (3, 3)) * [[1.0], [3.0], [20.0]]
        asked.max_velocity, asked.max_acceleration, asked.max_jerk = limits.tolist()
        answer = ruckig.Trajectory(3)
        ruckig.Ruckig(3).calculate(asked, answer)
        motion = as_motion(answer, ("a", "b", "c"))
        assert motion.total_time == pytest.approx(answer.duration)
        same(motion, lambda t, order, a=answer: a.at_time(t)[order], loose=1e-6)
        found = check_motion(motion, JointLimits.from_values(motion.joints, *limits))
        assert found.verdict is Verdict.PASS, str(found)
        assert found.worst.ratio == pytest.approx(1.0, abs=1e-6)


def drake_polynomial(held):
    """What pydrake's PiecewisePolynomial offers: ascending coefficients from each break."""

    def matrix(k):
        rows = [[SimpleNamespace(GetCoefficients=lambda j=j: held.c[::-1, k, j])] for j in range(2)]
        return np.array(rows, dtype=object)

    return SimpleNamespace(get_segment_times=lambda: held.x.tolist(), getPolynomialMatrix=matrix)


def test_drakes_polynomials_and_splines():
    held = PPoly(np.random.default_rng(2).normal(size=(4, 3, 2)), [0.0, 0.5, 2.0, 2.4])
    same(as_motion(drake_polynomial(held)), lambda t, order: held(t, nu=order))
    spline = make_interp_spline([0.0, 0.4, 0.7, 1.3], WAYS, k=3)
    basis = SimpleNamespace(knots=lambda: spline.t.tolist(), degree=lambda: 3)
    given = SimpleNamespace(
        basis=lambda: basis, control_points=lambda: [c[:, None] for c in spline.c]
    )
    motion = as_motion(given, ("x", "y"))
    assert isinstance(motion, Motion)
    same(motion, lambda t, order: spline(t, nu=order))
