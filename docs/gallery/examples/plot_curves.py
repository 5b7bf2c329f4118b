"""
What the choice of the curve costs
==================================

The same way-points and limits, four kinds of curve: smoothness costs seconds. The last
curve stands still at every way-point.
"""

import matplotlib.pyplot as plt
import numpy as np
from trajgap.nlp import solve
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline,
    fit,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)

waypoints = [[0.0], [0.6], [1.1], [0.8]]  # rad
limits = Limits(2.0, 6.0)  # rad/s, rad/s²
curves = {
    "C2 cubic spline": cubic_spline(3),
    "3-5-3 polynomials": three_five_three(),
    "C4 quintic spline": quintic_spline(3),
    "quintic, at rest": rest_to_rest(3, degree=5),
}
figure, axes = plt.subplots(figsize=(8, 3.4), layout="constrained")
for (name, curve), line in zip(curves.items(), ("-", "--", "-.", ":"), strict=True):
    problem = Problem(waypoints, limits, curve)
    motion = fit(curve, problem.waypoints, solve(problem).durations)
    times = np.linspace(0.0, motion.total_time, 300)
    axes.plot(times, motion(times)[:, 0], line, label=f"{name}: {motion.total_time:.3f} s")
axes.set_xlabel("time, s")
axes.set_ylabel("angle, rad")
axes.legend()
plt.show()
