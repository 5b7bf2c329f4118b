"""ROS: a trajectory_msgs/JointTrajectory as YAML or JSON, of ROS 1 or 2."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..files import MOST
from ..printed import spelt_like
from .digits import HalfUnits, digits_of_values, half_units
from .plain_data import check_names, number_of
from .samples import Samples

_INSIDE = ("joint_trajectory", "trajectory", "goal", "request", "action_goal", "planned_trajectory")
"""Keys under which other messages hold a JointTrajectory: RobotTrajectory, FollowJointTrajectory,
DisplayTrajectory, and the results of planning."""
_DERIVATIVES = ("positions", "velocities", "accelerations")
"""Fields of a JointTrajectoryPoint for derivatives 0 to 2."""
_POINT = (*_DERIVATIVES, "effort", "time_from_start")
"""Fields of a JointTrajectoryPoint."""
_CLOCKS = (("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec"))
"""Fields of a Duration in ROS 2, in ROS 1, and as Foxglove writes both."""
_LATEST = 2**31 - 1
"""Largest whole second of a Duration, whose field has 32 bits; nanoseconds are below 10⁹."""


def trajectories(found: Any, depth: int = 6) -> Iterator[Mapping[str, Any]]:
    """Every JointTrajectory in a message, however it is wrapped."""
    if isinstance(found, Mapping):
        if "points" in found and "joint_names" in found:
            yield found
        elif depth:
            for key in _INSIDE:
                if key in found:
                    yield from trajectories(found[key], depth - 1)
    elif isinstance(found, list) and depth and len(found) <= MOST.joints:
        for one in found:
            yield from trajectories(one, depth - 1)


def plain_message(message: Any) -> dict[str, Any]:
    """A JointTrajectory as Python has it in ROS 1 or 2, or read by rosbags, as plain values.

    Parameters
    ----------
    message : object
        With ``joint_names`` and ``points``. What it lacks is left out.
    """
    points = []
    for one in message.points:
        row: dict[str, Any] = {
            key: np.asarray(getattr(one, key)).tolist() for key in _DERIVATIVES if hasattr(one, key)
        }
        clock = getattr(one, "time_from_start", None)
        for names in _CLOCKS:
            if all(hasattr(clock, name) for name in names):
                row["time_from_start"] = {name: int(getattr(clock, name)) for name in names}
        points.append(row)
    return {"joint_names": list(message.joint_names), "points": points}


def samples_of_message(message: Mapping[str, Any], name: str, text: bool = True) -> Samples:
    """Samples of a JointTrajectory, derivatives where points have them.

    Parameters
    ----------
    message : mapping
        ``joint_names`` and ``points``; a point has ``positions`` and ``time_from_start`` (``sec``
        and ``nanosec``, in ROS 1 ``secs`` and ``nsecs``; a number of seconds too), and may have
        ``velocities`` and ``accelerations``.
    text : bool
        Whether the message was written as text, so its digits say what was rounded.

    Raises
    ------
    CaseError
        If a field is missing or of another length.
    """
    joints, points = message["joint_names"], message["points"]
    check_names(joints, name, "joint_names")
    if not 1 <= len(joints) <= MOST.joints:
        raise CaseError(name, "joint_names", f"{len(joints)} names; give 1 to {MOST.joints}")
    if not isinstance(points, list) or len(points) < 2:
        raise CaseError(name, "points", "fewer than two points; a motion needs two or more")
    if len(points) * len(joints) > MOST.positions:
        raise CaseError(name, "points", f"{len(points)} points are too many; keep fewer")
    times = np.empty(len(points))
    values = np.full((3, len(points), len(joints)), np.nan)
    for k, point in enumerate(points):
        field = f"points[{k}]"
        if not isinstance(point, Mapping):
            raise CaseError(name, field, "is not a point; give positions and time_from_start")
        for key in point:
            near = None if key in _POINT else spelt_like(str(key), _POINT)
            if near:
                raise CaseError(name, f"{field}.{str(key)[:40]}", f"did you mean {near!r}?")
        times[k] = _seconds(point.get("time_from_start"), name, f"{field}.time_from_start")
        for order, key in enumerate(_DERIVATIVES):
            given = point.get(key)
            if given is None or (isinstance(given, list) and not given):
                if order == 0:
                    raise CaseError(name, f"{field}.positions", "is empty; give positions")
                continue
            if not isinstance(given, list) or len(given) != len(joints):
                count = len(given) if isinstance(given, list) else 1
                why = f"{count} for {len(joints)} joints; give one each"
                raise CaseError(name, f"{field}.{key}", why)
            for j, value in enumerate(given):
                values[order, k, j] = number_of(value, name, f"{field}.{key}[{j}]")
    try:
        q, v, a = values
        rounding = _rounding(times, values, text)
        return Samples(tuple(joints), times, q, v, a, rounding=rounding)
    except TrajgapError as error:
        raise CaseError(name, "points", str(error)) from None


def _rounding(times: Array, values: Array, text: bool) -> HalfUnits:
    """Whole nanoseconds, and the digits of numbers that were written as text."""
    rounded = np.zeros(values[:, 0].shape)
    for order, one in enumerate(values):
        if text and not np.isnan(one).all():
            rounded[order] = half_units(one, digits_of_values(one))
    nanoseconds = half_units(times[:, None], np.array([[9, 0]]))
    return HalfUnits(float(nanoseconds[0]), rounded)


def _seconds(given: Any, name: str, field: str) -> float:
    if isinstance(given, Mapping):
        for whole, part in _CLOCKS:
            if whole in given and set(given) <= {whole, part}:
                part_of = _whole(given.get(part, 0), name, f"{field}.{part}", 10**9 - 1)
                return _whole(given[whole], name, f"{field}.{whole}", _LATEST) + 1e-9 * part_of
        raise CaseError(name, field, "has no sec or other fields; give sec and nanosec alone")
    if given is None:
        raise CaseError(name, field, "is missing; give sec and nanosec")
    seconds = number_of(given, name, field)
    if not 0 <= seconds <= _LATEST:
        raise CaseError(name, field, f"is {seconds:g}; give seconds from 0 to {_LATEST}")
    return seconds


def _whole(value: Any, name: str, field: str, most: int) -> int:
    if type(value) is not int or not 0 <= value <= most:
        raise CaseError(name, field, f"is {str(value)[:40]}; give a whole number from 0 to {most}")
    return value


def message_of_samples(samples: Samples) -> dict[str, Any]:
    """A JointTrajectory of ROS 2 as plain values, rad and s."""
    rows = []
    for k, time in enumerate(samples.time):
        row: dict[str, Any] = {}
        for order, key in enumerate(_DERIVATIVES):
            given = samples.given(order)
            row[key] = [] if given is None or np.isnan(given[k]).any() else given[k].tolist()
        seconds, part = divmod(round(float(time) * 1e9), 10**9)
        row |= {"effort": [], "time_from_start": {"sec": seconds, "nanosec": part}}
        rows.append(row)
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": list(samples.joints),
        "points": rows,
    }
