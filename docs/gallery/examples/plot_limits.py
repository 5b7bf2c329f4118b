"""
Where a motion meets its limits
===============================

The fastest motion through four way-points under limits on velocity, acceleration and jerk. Every
row is a joint, every column a derivative. The largest value of each is exact, at whatever instant
it occurs.
"""

from trajgap.compare.pictures import motion_picture
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, check, quintic_spline

waypoints = [[0.0, 0.2], [0.6, 0.9], [1.1, 0.4], [0.8, -0.1]]  # rad
problem = Problem(waypoints, Limits(2.0, 6.0, 40.0), quintic_spline(3))  # rad/s, rad/s², rad/s³
best = solve(problem)
motion_picture(
    problem, best.durations, title="C4 quintic spline", check=check(problem, best.durations)
)
