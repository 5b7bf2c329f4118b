"""The text of a small case file, of which tests state what they are about."""

from __future__ import annotations

import json


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
