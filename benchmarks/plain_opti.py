"""What a user would write for the puma560 problem in plain CasADi Opti, for comparison.

Durations and coefficients as variables, conditions as equalities, limits on a grid of 21 points a
segment, IPOPT with its defaults. Pinned: not to be improved.
"""

import casadi as ca
import numpy as np

DEGREES = (3, 5, 3)
POINTS = 21


def solve(waypoints, velocity, acceleration, lower):
    """Build and solve once; returns the durations."""
    opti = ca.Opti()
    joints = waypoints.shape[1]
    h = opti.variable(3)
    opti.set_initial(h, 1.2)
    opti.minimize(ca.sum1(h))
    opti.subject_to(h >= lower)
    for j in range(joints):
        coefficients = [opti.variable(d + 1) for d in DEGREES]

        def value(k, s, order, coefficients=coefficients):
            total = 0
            for p in range(order, DEGREES[k] + 1):
                factor = float(np.prod(np.arange(p, p - order, -1.0)))
                total += factor * s ** (p - order) * coefficients[k][p]
            return total / h[k] ** order

        for k in range(3):
            opti.subject_to(value(k, 0.0, 0) == waypoints[k, j])
            opti.subject_to(value(k, 1.0, 0) == waypoints[k + 1, j])
            for s in np.linspace(0, 1, POINTS):
                opti.subject_to(opti.bounded(-velocity, value(k, s, 1), velocity))
                opti.subject_to(opti.bounded(-acceleration, value(k, s, 2), acceleration))
        for order in (1, 2):
            opti.subject_to(value(0, 0.0, order) == 0)
            opti.subject_to(value(2, 1.0, order) == 0)
            for k in (0, 1):
                opti.subject_to(value(k, 1.0, order) == value(k + 1, 0.0, order))
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    return np.asarray(opti.solve().value(h))
