"""A small family of instances, and its examination."""

from __future__ import annotations

from trajgap.compare.audits.instances.result import (
    InstancesResult,
)
from trajgap.compare.audits.study import Study
from trajgap.problem import (
    Case,
    parse_case,
)

WHALE = "z1-woa-bspline"


SMALL = """
format = 1
id = "small"
title = "two joints"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1", "2"]
[robot.dh]
convention = "standard"
length_unit = "m"
angle_unit = "rad"
d = [0, 0]
a = [0.5, 0.3]
alpha = [0, 0]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
not_printed = "lost"
count = 3
[limits]
velocity = [1.5, 2.5]
acceleration = [4, 3]
[durations]
upper = 8
[[problems]]
id = "spline"
interpolant = { family = "quintic-spline" }
[[problems]]
id = "stops"
interpolant = { family = "jtraj" }
[[readings]]
id = "as-printed"
why = "as printed."
default = true
[[readings]]
id = "joined"
why = "the other curve."
interpolant_of = ["stops"]
interpolant = { family = "quintic-spline" }
[[algorithms]]
id = "plain"
name = "plain"
kind = "woa"
settings = { whales = 8, iterations = 12, position_initial = [0, 8] }
[[algorithms]]
id = "new"
name = "new"
kind = "improved-woa"
settings = { whales = 8, iterations = 12, position_initial = [0, 8] }
[[families]]
id = "drawn"
claim = "better"
why = "They are like the paper's."
kind = "joint"
steps = [0.3, 0.9]
instances = 2
seed = 5
samples = 50
[[claims]]
id = "old-total"
quantity = "total_time"
where = "Table 1"
problem = "stops"
algorithm = "plain"
value = "2.00"
[[claims]]
id = "new-total"
quantity = "total_time"
where = "Table 1"
problem = "spline"
algorithm = "new"
value = "1.50"
[[claims]]
id = "better"
quantity = "improvement"
where = "Table 1"
slower = "old-total"
faster = "new-total"
[[claims]]
id = "settles"
quantity = "convergence"
where = "Fig. 1"
problem = "spline"
algorithm = "new"
iterations = "10"
"""


UNSOLVED = (
    ("upper = 8", "upper = 0.05"),
    ("position_initial = [0, 8]", "position_initial = [0, 0.05]"),
)
"""Changes after which nothing keeps its limits."""


def small(*changes: tuple[str, str]) -> Case:
    text = SMALL
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new)
    return parse_case(text, "small.toml")


def examined(*changes: tuple[str, str], workers: int = 1) -> InstancesResult:
    study = Study(small(*changes), seeds=2, workers=workers, certify_seconds=0)
    return study.instances(study.instance_blocks[0])
