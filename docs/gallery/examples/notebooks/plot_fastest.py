"""
Find the fastest motion
=======================

The shortest time through four way-points of two joints under limits on velocity, acceleration and
jerk, and the file that a controller follows.
"""

# %%
# Angles are in rad, times in s. The curve is a quintic spline whose first four derivatives are
# continuous.

import trajgap as tg
from trajgap.problem.motions import JointLimits, as_motion, check_motion, csv_text

waypoints = [[0.0, 0.2], [0.6, 0.9], [1.1, 0.4], [0.8, -0.1]]
limits = tg.Limits(velocity=2.0, acceleration=6.0, jerk=40.0)
problem = tg.Problem(waypoints, limits, tg.quintic_spline(3), joints=("shoulder", "elbow"))
best = tg.solve(problem)
print(best)

# %%
# Every limit is kept at every instant, not only at samples:

print(tg.check(problem, best.durations))

# %%
# The motion touches the limits that decide its time:

tg.plot(best)

# %%
# The same motion with equal durations, as short as the limits allow, takes longer. ``gap`` says by
# how much:

equal = tg.check(problem, [1.0, 1.0, 1.0])
if equal.tight_time is not None:
    print(tg.gap(equal.tight_time, best))

# %%
# 500 rows a second with velocities and accelerations, as a table:

samples = best.sample(0.002)
lines = csv_text(samples).splitlines()
print(lines[0], f"and {len(lines) - 1} rows", sep="\n")

# %%
# A motion from elsewhere is judged and drawn in the same way. Here the limits of velocity are
# lower:

lower = JointLimits.from_values(problem.joints, velocity=[1.2, 1.5], acceleration=6.0, jerk=40.0)
motion = as_motion(best.trajectory, problem.joints)
found = check_motion(motion, lower)
print(found)

# %%
# What breaks a limit is red:

tg.plot(motion, lower)

# %%
# Slowed down by the factor of the verdict, the motion keeps them:

print(check_motion(motion.slowed(found.stretch), lower).verdict)
