"""Two joints over three segments, shifted and unequal: what searches are tried on."""

import numpy as np
from trajgap.problem import Limits, Problem, three_five_three

WAYPOINTS = np.array([[0.19, -1.63], [0.82, -2.01], [0.13, -1.07], [-0.88, -1.31]])
LIMITS = Limits([6.0, 5.0], [8.0, 9.0])
WITH_JERK = Limits([5.0, 3.0], [8.0, 11.0], [np.inf, 90.0])


def two_joints(limits: Limits = LIMITS, **changes: object) -> Problem:
    """The problem within other limits, on another curve, between other bounds of durations."""
    given = {"waypoints": WAYPOINTS, "limits": limits, "curve": three_five_three()}
    return Problem(**{**given, **changes})


PROBLEM = two_joints(duration_lower=0.1, duration_upper=3.0, name="two joints")
OPEN = two_joints()
_TURNING = [[0.3, 1.0], [0.9, 0.2], [0.5, 0.4], [1.4, 0.8]]
TURNING = two_joints(Limits([1.0, 2.0], 3.0), waypoints=_TURNING)
"""Joint 1 turns twice."""
