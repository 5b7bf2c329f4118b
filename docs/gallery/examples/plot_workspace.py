"""
Where an arm can reach
======================

Positions of the end for joint angles drawn at random within their ranges, from three sides.
"""

from trajgap.compare.pictures import workspace_picture
from trajgap.problem import forward_kinematics, load_case, load_robot, sample_workspace

arm = load_robot("puma560")
angles = load_case("puma560-mnam-pso-353").problem().waypoints
points = forward_kinematics(arm, angles)[:, :3, 3]
workspace_picture(sample_workspace(arm, 2000, seed=1), waypoints=points, labels=list("ABCD"))
