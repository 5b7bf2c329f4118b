"""Case files that tests change in a place: a small one, one of every field, one of a SCARA arm."""

import json
from pathlib import Path

from trajgap.problem import Case
from trajgap.problem.cases import parse_case


def case_text(
    points: str,
    curve: str = "",
    *,
    joints: str = "a b",
    robot: str = "",
    unit: str = "deg",
    limits: str = "velocity = 10",
    more: str = "",
) -> str:
    """Keys of way-points, curve, robot and limits in their blocks; ``more`` stands at the end.

    Without ``more``, keys of the curve can be written behind the text.
    """
    return f"""format = 1
id = "made-up"
title = "Made up"
[source]
title = "none"
[robot]
name = "arm"
joints = {json.dumps(joints.split())}
{robot}
[units]
position = "{unit}"
velocity = "{unit}/s"
acceleration = "{unit}/s^2"
time = "s"
[waypoints]
{points}
[limits]
{limits}
[interpolant]
{curve}
{more}"""


BASE = Path(__file__).with_name("base_case.toml").read_text("utf-8")

SCARA = Path(__file__).with_name("scara.toml").read_text("utf-8")
"""Its case file; way-points, limits and peaks in degrees, turns per minute, mm and m."""


def scara(*changes: tuple[str, str]) -> Case:
    """The case with parts of its text replaced, each of which occurs exactly once."""
    text = SCARA
    for old, new in changes:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    return parse_case(text, "scara.toml")
