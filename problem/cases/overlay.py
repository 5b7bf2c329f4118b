"""A problem laid over what a whole file states, a reading over both, and way-points on a line."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from ..errors import CaseError, TrajgapError
from ..printed import Strict, UnitOrEach, from_si, is_linear, read_number, to_si
from ..problem import Coupling
from ..robots import Chain, JointKind, ctraj, forward_kinematics
from .faults import Faults
from .joint_units import OF_JOINTS, Units, units_of
from .schema import CaseFile, Override, ProblemBlock, Reading, Waypoints
from .statement import Statement

Block = TypeVar("Block", bound=Strict)


def overlaid(
    document: CaseFile,
    file: str,
    problem: ProblemBlock,
    reading: Reading,
    drawn: Callable[[Waypoints, UnitOrEach, str], Waypoints],
) -> Statement:
    """Lay a problem over the file's own statements, and a reading over both.

    Parameters
    ----------
    drawn : callable
        From way-points that are a line, their unit or units, and words for messages to rows.

    Raises
    ------
    CaseError
        If way-points or interpolant are missing, an unknown joint is selected, or units do not fit
        the joints.
    """
    selected = f" (problem {problem.id!r}, reading {reading.id!r})"
    if not document.problems and not document.readings:
        selected = ""
    layers: tuple[Override, ...] = (problem, reading)
    waypoints, interpolant = document.waypoints, document.interpolant
    coupling, chosen = document.coupling, None
    turns: Mapping[str, tuple[int, ...]] = {}
    for layer in layers:
        turns = layer.turns or turns
        waypoints = layer.waypoints or waypoints
        if not isinstance(layer, Reading) or problem.id in (layer.interpolant_of or (problem.id,)):
            interpolant = layer.interpolant or interpolant
        coupling = layer.coupling or coupling
        chosen = layer.joints or chosen
    faults = Faults(file)
    if waypoints is None:
        faults.add("waypoints", f"is missing; add the table of way-points{selected}")
    if interpolant is None:
        faults.add("interpolant", f'is missing; add family = "3-5-3" or another{selected}')
    labels = document.robot.joints
    for label in chosen or ():
        if label not in labels:
            why = f"joint {label!r} is unknown; robot.joints lists {', '.join(labels)}"
            faults.add("joints", why + selected)
    units = _merged(document.units, *(layer.units for layer in layers))
    _check_units(units, labels, faults, selected)
    faults.refuse()
    assert waypoints is not None
    assert interpolant is not None
    taken = labels if chosen is None else chosen
    if waypoints.line is not None:
        waypoints = drawn(waypoints, units.position, selected)
    return Statement(
        file=file,
        name=f"{document.id}, {problem.id}, {reading.id}",
        selected=selected,
        labels=labels,
        joints=tuple(j for j, label in enumerate(labels) if label in taken),
        units=units,
        waypoints=waypoints,
        limits=_merged(document.limits, *(layer.limits for layer in layers)),
        declaration=interpolant,
        durations=_merged(document.durations, *(layer.durations for layer in layers)),
        coupling=coupling or Coupling.SHARED,
        turns=turns,
    )


def _merged(base: Block, *changes: Block) -> Block:
    for change in changes:
        base = base.model_copy(
            update={key: getattr(change, key) for key in change.model_fields_set}
        )
    return base


def _check_units(units: Units, labels: Sequence[str], faults: Faults, selected: str) -> None:
    """Check that lists have one unit per joint, and no joint is an angle and a length at once."""
    before = len(faults.found)
    for quantity in OF_JOINTS:
        each = getattr(units, quantity)
        if isinstance(each, tuple) and len(each) != len(labels):
            faults.add(
                f"units.{quantity}",
                f"{len(each)} units for {len(labels)} joints; give one for all, or one each"
                + selected,
            )
    if len(faults.found) > before:
        return
    for joint, label in enumerate(labels):
        (first, own), *others = [*units_of(units, joint)] or [("", "")]
        for quantity, unit in others:
            if is_linear(unit) != is_linear(own):
                which = f"[{joint}]" if isinstance(getattr(units, quantity), tuple) else ""
                fix = "give both as an angle or both as a length"
                if not which and len(labels) > 1:
                    fix = f"list one unit per joint in units.{quantity}"
                faults.add(
                    f"units.{quantity}{which}",
                    f"joint {label!r} has {unit!r} here and {own!r} in units.{first}; {fix}"
                    + selected,
                )


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
