"""The motion that TOPPRA makes of a path, and another package's third-order timing beside ours."""

import sys
from pathlib import Path

import numpy as np
import pytest
from trajgap.nlp import retime, retimed_motion
from trajgap.problem import Limits, TrajgapError, fit, three_five_three
from trajgap.problem.motions import JointLimits, check_motion
from trajgap.problem.suite import load_instance

WAYPOINTS = np.array([[0.1, -2.0], [0.9, -1.2], [1.4, 0.4], [0.7, 1.0]])
MOTION = fit(three_five_three(), WAYPOINTS, [0.9, 1.1, 0.8])
LIMITS = Limits([2.0, 3.0], [6.0, 9.0])


def test_it_is_as_long_and_on_the_path():
    motion = retimed_motion(MOTION, LIMITS, ("a", "b"), cells=1000)
    retiming = retime(MOTION, LIMITS)
    assert motion.total_time == pytest.approx(retiming.durations[1], rel=1e-3)
    assert motion.total_time == pytest.approx(retiming.extrapolated, rel=5e-3)
    dense = MOTION(np.linspace(0.0, MOTION.total_time, 200_001))
    for place in motion(np.linspace(0.0, motion.total_time, 60)):
        assert np.linalg.norm(dense - place, axis=1).min() < 5e-5
    found = check_motion(motion, JointLimits.of(LIMITS, ("a", "b")))
    assert found.worst.ratio < 1.2  # of the first and last cells, where curvature is largest
    velocity = [p.ratio for p in found.peaks if p.quantity == "velocity"]
    assert max(velocity) < 1.001


def test_a_finer_grid_is_nearer_to_the_limits():
    limits = JointLimits.of(LIMITS, ("1", "2"))
    over = []
    for cells in (250, 2000):
        motion = retimed_motion(MOTION, LIMITS, cells=cells)
        at = np.linspace(0.05, motion.total_time - 0.05, 4001)
        over.append((np.abs(motion(at, 2)) / limits.upper[:, 2]).max() - 1.0)
    assert over[1] < over[0] + 1e-9
    assert over[1] < 0.02


def test_where_toppra_does_not_apply():
    with pytest.raises(TrajgapError, match="jerk is limited"):
        retimed_motion(MOTION, Limits(2.0, 6.0, 50.0, joints=2))


sys.path.insert(0, str(Path(__file__).parents[3] / "benchmarks"))


def test_topp3_is_not_slower_on_the_path_of_an_optimum():
    copp = pytest.importorskip("copp_py")
    from third_order_retiming import SOLVER, path_of, retimed

    instance = load_instance("quintic-gasparetto2008")
    problem = instance.problem()
    motion = fit(problem.curve, problem.waypoints, np.asarray(instance.durations))
    times = np.linspace(0.0, motion.total_time, 101)[1:-1]
    for order in range(4):
        np.testing.assert_allclose(path_of(motion)(times, order), motion(times, order), atol=1e-9)
    limits = problem.limits.derivatives
    for cells in (10, 20, 40):
        assert retimed(motion, limits, cells).time <= motion.total_time * (1 + SOLVER)
    # Jerk is at its limit at the ends of this optimum: a lower limit leaves TOPP3 no timing.
    with pytest.raises(copp.CoppError):
        retimed(motion, limits * [1.0, 1.0, 0.9], 25)
