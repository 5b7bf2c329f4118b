"""TOPPRA's motion: on the path, as long as TOPPRA says, and within limits to the grid's order."""

import numpy as np
import pytest
from trajgap.nlp import retime, retimed_motion
from trajgap.problem import Limits, TrajgapError, fit, three_five_three
from trajgap.problem.motions import JointLimits, check_motion

WAYPOINTS = np.array([[0.1, -2.0], [0.9, -1.2], [1.4, 0.4], [0.7, 1.0]])
LIMITS = Limits([2.0, 3.0], [6.0, 9.0])


def test_it_is_as_long_and_on_the_path():
    trajectory = fit(three_five_three(), WAYPOINTS, [0.9, 1.1, 0.8])
    motion = retimed_motion(trajectory, LIMITS, ("a", "b"), cells=1000)
    retiming = retime(trajectory, LIMITS)
    assert motion.total_time == pytest.approx(retiming.durations[1], rel=1e-3)
    assert motion.total_time == pytest.approx(retiming.extrapolated, rel=5e-3)
    dense = trajectory(np.linspace(0.0, trajectory.total_time, 200_001))
    for place in motion(np.linspace(0.0, motion.total_time, 60)):
        assert np.linalg.norm(dense - place, axis=1).min() < 5e-5
    found = check_motion(motion, JointLimits.of(LIMITS, ("a", "b")))
    assert found.worst.ratio < 1.2  # of the first and last cells, where curvature is largest
    velocity = [p.ratio for p in found.peaks if p.quantity == "velocity"]
    assert max(velocity) < 1.001


def test_a_finer_grid_is_nearer_to_the_limits():
    trajectory = fit(three_five_three(), WAYPOINTS, [0.9, 1.1, 0.8])
    limits = JointLimits.of(LIMITS, ("1", "2"))
    over = []
    for cells in (250, 2000):
        motion = retimed_motion(trajectory, LIMITS, cells=cells)
        at = np.linspace(0.05, motion.total_time - 0.05, 4001)
        over.append((np.abs(motion(at, 2)) / limits.upper[:, 2]).max() - 1.0)
    assert over[1] < over[0] + 1e-9
    assert over[1] < 0.02


def test_where_toppra_does_not_apply():
    trajectory = fit(three_five_three(), WAYPOINTS, [0.9, 1.1, 0.8])
    with pytest.raises(TrajgapError, match="jerk is limited"):
        retimed_motion(trajectory, Limits(2.0, 6.0, 50.0, joints=2))
