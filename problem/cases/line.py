"""Way-points of a straight move of the robot's end, from the joint angles at both of its ends."""

from __future__ import annotations

import numpy as np

from ..errors import CaseError, TrajgapError
from ..printed import from_si, read_number, to_si
from ..robots import Chain, JointKind, ctraj, forward_kinematics
from .schema import Waypoints


def on_line(
    waypoints: Waypoints, unit: str | tuple[str, ...], chain: Chain, file: str, selected: str
) -> Waypoints:
    """The same block with one row per pose of its line, instead of the line.

    Parameters
    ----------
    file, selected : str
        Name of the file, and problem and reading in words, for messages.

    Returns
    -------
    Waypoints
        Exact numbers: those of the ends as stated, the others to the last bit.

    Raises
    ------
    CaseError
        If the line does not fit the robot, or the robot cannot follow it.
    """
    line = waypoints.line
    assert line is not None

    def fail(field: str, reason: str) -> CaseError:
        return CaseError(file, f"waypoints.{field}", reason + selected)

    if any(kind is JointKind.PRISMATIC for kind in chain.kinds):
        raise fail("line", "the robot has a sliding joint; give rows of way-points instead")
    units = unit if isinstance(unit, tuple) else (unit,) * chain.joints
    ends = []
    for name in ("first", "last"):
        given = getattr(line, name)
        if len(given) != chain.joints:
            reason = f"{len(given)} angles for the {chain.joints} joints of the robot"
            raise fail(f"line.{name}", f"{reason}; give one each")
        if not all(number.exact for number in given):
            reason = "angles between the ends follow from exact numbers only"
            raise fail(f"line.{name}", f"{reason}; leave out the quotes, or give rows")
        ends.append(
            np.array([to_si(number, one).value for number, one in zip(given, units, strict=True)])
        )
    poses = forward_kinematics(chain, np.array(ends))
    try:
        found = ctraj(chain, poses[0], poses[1], line.points, guess=ends[0]).waypoints
    except TrajgapError as error:
        raise fail("line", str(error).removeprefix("ctraj: ")) from None
    # On another branch joints differ by far more; the residual itself is a thousand times less.
    if np.abs(found[[0, -1]] - ends).max() > 1e-6:
        reason = "the robot cannot go straight from the first angles to the last on one branch"
        raise fail("line", f"{reason} of its inverse kinematics; give other angles, or rows")
    inner = [
        [read_number(from_si(float(q), one)) for q, one in zip(row, units, strict=True)]
        for row in found[1:-1]
    ]
    rows = (line.first, *(tuple(row) for row in inner), line.last)
    return waypoints.model_copy(update={"line": None, "waypoint_rows": rows})
