"""A problem laid over what a whole file states, and a reading over both."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from ..printed import Strict, UnitOrEach, is_linear
from ..problem import Coupling
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
