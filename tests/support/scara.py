"""A made-up paper on a SCARA arm: two joints turn, one slides, and each has units of its own."""

from __future__ import annotations

from trajgap.problem import Case
from trajgap.problem.cases import parse_case

SCARA = """
format = 1
id = "scara"
title = "Time-optimal cubic splines for a SCARA arm"

[source]
note = "made up"

[robot]
name = "SCARA"
joints = ["1", "2", "d3"]

[robot.dh]
convention = "standard"
length_unit = "mm"
angle_unit = "deg"
kinds = ["revolute", "revolute", "prismatic"]
d = [400, 0, 0]
a = [325, 225, 0]
alpha = [0, 180, 0]
lower = [-150, -140, 0]
upper = [150, 140, 150]

[units]
position = ["deg", "deg", "mm"]
velocity = ["rpm", "deg/s", "mm/s"]
acceleration = ["deg/s^2", "deg/s^2", "m/s^2"]
time = "s"

[waypoints]
where = "Table 1"
labels = ["A", "B", "C", "D"]
waypoint_rows = [
  ["10.5", "-20.3", "12.0"],
  ["60.1", "15.2", "85.0"],
  ["95.7", "40.9", "140.0"],
  ["120.3", "95.5", "30.0"],
]

[limits]
where = "Table 1"
velocity = [30, 150, 120]
acceleration = [400, 380, 0.5]
position_lower = [-150, -140, 0]
position_upper = [150, 140, 150]

[interpolant]
family = "cubic-spline"

[[readings]]
id = "rpm"
why = "the head of the column says r/min for joint 1"
default = true

[[readings]]
id = "deg-s"
why = "the text says degrees per second for joint 1"
units = { velocity = ["deg/s", "deg/s", "mm/s"] }

[[claims]]
id = "durations"
where = "Table 2"
quantity = "durations"
durations = ["0.980", "0.860", "1.500"]
total = "3.340"

[[claims]]
id = "fast"
where = "Table 4"
quantity = "durations"
durations = ["0.45", "0.40", "0.70"]
total = "1.55"

[[claims]]
id = "velocities"
where = "Table 3"
quantity = "peak"
of = "durations"
derivative = "velocity"
values = ["11.4", "48.5", "107.6"]

[[claims]]
id = "slide-velocity"
where = "Section 5"
quantity = "peak"
of = "fast"
derivative = "velocity"
joint = "d3"
value = "0.2332"

[[claims]]
id = "accelerations"
where = "Table 3"
quantity = "peak"
of = "durations"
derivative = "acceleration"
values = ["185.8", "140.7", "0.276"]

[[claims]]
id = "means"
where = "Section 5"
quantity = "measure"
of = "durations"
measure = "rms"
derivative = "velocity"
values = ["6.42", "36.7", "78.3"]

[[claims]]
id = "kept"
where = "Section 6"
quantity = "statement"
checks = "within_limits"
of = ["durations", "fast"]

[[claims]]
id = "rest"
where = "Section 4"
quantity = "conditions"
rest_at = "ends"
orders = [1, 2]
degrees = [3, 3, 3]
of = ["durations"]

[[claims]]
id = "smooth"
where = "Section 4"
quantity = "statement"
checks = "continuous"
of = ["durations"]

[[claims]]
id = "most"
where = "Section 6"
quantity = "statement"
checks = "varies_most"
joint = "d3"

[[claims]]
id = "poses"
where = "Table 5"
quantity = "statement"
checks = "kinematics"

[[clues]]
id = "figure"
kind = "axis"
where = "Fig. 3"
text = "The axis of joint d3 runs to 150 mm/s."
quantity = "velocity"
unit = "mm/s"
ticks = [0, 50, 100, 150]
of = ["durations"]
joint = "d3"

[[clues]]
id = "sheet"
kind = "data-sheet"
where = "data sheet"
text = "Speeds of the arm."
quantity = "velocity"
unit = ["deg/s", "rpm", "m/min"]
values = [180, 25, 7.2]

[[cartesian]]
id = "a"
where = "Table 5"
waypoint = "A"
unit = "mm"
values = ["541.3", "20.9", "388.0"]

[[cartesian]]
id = "d"
where = "Table 5"
waypoint = "D"
unit = "mm"
values = ["-346.1", "148.7", "370.0"]
"""
"""Its case file; way-points, limits and peaks in degrees, turns per minute, mm and m."""


def scara(*changes: tuple[str, str]) -> Case:
    """The case with parts of its text replaced, each of which occurs exactly once."""
    text = SCARA
    for old, new in changes:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    return parse_case(text, "scara.toml")
