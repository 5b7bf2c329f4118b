"""A case file of one joint that moves from rest to rest, with places to fill in."""

QUESTION = """
format = 1
id = "fair"
title = "one joint from rest to rest"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
where = "Table 1"
joint_rows = [[{points}]]
[limits]
velocity = {limit}
[interpolant]
family = "rest-to-rest"
degree = 5
"""
HEAD = (
    QUESTION
    + """[[claims]]
id = "d"
quantity = "durations"
where = "Table 2"
durations = ["{time}"]
[[claims]]
id = "s"
quantity = "statement"
where = "abstract"
checks = "{checks}"
of = ["d"]
"""
)
UNITS = """
[[readings]]
id = "header"
why = "as printed"
[[readings]]
id = "degrees"
why = "a number usual in degrees"
units = { velocity = "deg/s" }
"""


def one_joint(points: str, limit: str, time: str, checks: str, tail: str = "") -> str:
    return HEAD.format(points=points, limit=limit, time=time, checks=checks) + tail
