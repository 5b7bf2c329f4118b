"""ROS: a trajectory_msgs/JointTrajectory as YAML or JSON, of ROS 1 or 2."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..fields import MOST_JOINTS
from .motion import MOST_VALUES
from .samples import Samples

_INSIDE = ("joint_trajectory", "trajectory", "goal", "request", "action_goal", "planned_trajectory")
"""Keys under which other messages hold a JointTrajectory: RobotTrajectory, FollowJointTrajectory,
DisplayTrajectory, and the results of planning."""
_DERIVATIVES = ("positions", "velocities", "accelerations")
"""Fields of a JointTrajectoryPoint for derivatives 0 to 2."""


def trajectories(found: Any, depth: int = 6) -> Iterator[Mapping[str, Any]]:
    """Every JointTrajectory in a message, however it is wrapped."""
    if isinstance(found, Mapping):
        if "points" in found and "joint_names" in found:
            yield found
        elif depth:
            for key in _INSIDE:
                if key in found:
                    yield from trajectories(found[key], depth - 1)
    elif isinstance(found, list) and depth and len(found) <= MOST_JOINTS:
        for one in found:
            yield from trajectories(one, depth - 1)


def samples_of_message(
    message: Mapping[str, Any], name: str, noise: float | Array = 0.0
) -> Samples:
    """Samples of a JointTrajectory, derivatives where points have them.

    Parameters
    ----------
    message : mapping
        ``joint_names`` and ``points``; a point has ``positions`` and ``time_from_start`` (``sec``
        and ``nanosec``, in ROS 1 ``secs`` and ``nsecs``; a number of seconds too), and may have
        ``velocities`` and ``accelerations``.
    name : str
        The file, for messages.
    noise : float or ndarray
        See `Samples`.

    Returns
    -------
    Samples

    Raises
    ------
    CaseError
        If a field is missing or of another length.
    """
    joints, points = message["joint_names"], message["points"]
    if not isinstance(joints, list) or not all(isinstance(x, str) and x for x in joints):
        raise CaseError(name, "joint_names", "is no list of names; give the joints' names")
    if not 1 <= len(joints) <= MOST_JOINTS:
        raise CaseError(name, "joint_names", f"{len(joints)} names; give 1 to {MOST_JOINTS}")
    if not isinstance(points, list) or len(points) < 2:
        raise CaseError(name, "points", "fewer than two points; a motion needs two or more")
    if len(points) * len(joints) > MOST_VALUES:
        raise CaseError(name, "points", f"{len(points)} points are more than is read; keep fewer")
    times = np.empty(len(points))
    values = np.full((3, len(points), len(joints)), np.nan)
    for k, point in enumerate(points):
        field = f"points[{k}]"
        if not isinstance(point, Mapping):
            raise CaseError(name, field, "is no point; give positions and time_from_start")
        times[k] = _seconds(point.get("time_from_start"), name, f"{field}.time_from_start")
        for order, key in enumerate(_DERIVATIVES):
            given = point.get(key)
            if given is None or (isinstance(given, list) and not given):
                if order == 0:
                    raise CaseError(
                        name,
                        f"{field}.positions",
                        "is empty; give positions",
                    )
                continue
            if not isinstance(given, list) or len(given) != len(joints):
                count = len(given) if isinstance(given, list) else 1
                raise CaseError(
                    name,
                    f"{field}.{key}",
                    f"{count} for {len(joints)} joints; give one each",
                )
            for j, value in enumerate(given):
                values[order, k, j] = _number(value, name, f"{field}.{key}[{j}]")
    try:
        return Samples(tuple(joints), times, values[0], values[1], values[2], noise)
    except TrajgapError as error:
        raise CaseError(name, "points", str(error)) from None


def _number(value: Any, name: str, field: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CaseError(name, field, f"{str(value)[:40]!r} is no number; fix it")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise CaseError(name, field, "is not finite; give a number")
    return found


def _seconds(given: Any, name: str, field: str) -> float:
    if isinstance(given, Mapping):
        for whole, part in (("sec", "nanosec"), ("secs", "nsecs")):
            if whole in given:
                seconds = _number(given[whole], name, f"{field}.{whole}")
                return seconds + 1e-9 * _number(given.get(part, 0), name, f"{field}.{part}")
        raise CaseError(name, field, "has no sec; give sec and nanosec")
    if given is None:
        raise CaseError(name, field, "is missing; give sec and nanosec")
    return _number(given, name, field)


def message_of_samples(samples: Samples) -> dict[str, Any]:
    """A JointTrajectory of ROS 2 as plain values, rad and s."""
    rows = []
    for k, time in enumerate(samples.time):
        nanoseconds = round(float(time) * 1e9)
        row: dict[str, Any] = {"positions": samples.position[k].tolist()}
        for key, given in (
            ("velocities", samples.velocity),
            ("accelerations", samples.acceleration),
        ):
            row[key] = [] if given is None else given[k].tolist()
        row["effort"] = []
        row["time_from_start"] = {
            "sec": nanoseconds // 10**9,
            "nanosec": nanoseconds % 10**9,
        }
        rows.append(row)
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": list(samples.joints),
        "points": rows,
    }
