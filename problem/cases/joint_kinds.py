"""Whether units say of each joint what the robot's table and the clues say: turning or sliding."""

from __future__ import annotations

from collections.abc import Sequence

from ..printed import is_linear
from ..robots import Chain, JointKind
from .clue import AnyClue, AxisClue, DataSheetClue, HalfTurnsClue
from .faults import Faults
from .joint_units import units_of
from .schema import CaseFile
from .statement import Statement


def check_kinds(statement: Statement, chain: Chain | None) -> None:
    """Check that units say of each joint what the robot's table says: that it turns or slides."""
    if chain is None:
        return
    for joint, label in enumerate(statement.labels):
        if label not in chain.labels:
            continue  # refused elsewhere
        slides = chain.kinds[chain.labels.index(label)] is JointKind.PRISMATIC
        quantity, unit = next(units_of(statement.units, joint), ("", ""))
        if unit and is_linear(unit) != slides:
            named = "prismatic" if slides else "revolute"
            fix = "a length such as mm" if slides else "an angle such as deg"
            raise statement.fail(
                f"units.{quantity}",
                f"joint {label!r} is in {unit}, but the robot's table calls it {named}; "
                f"give its unit as {fix}, or correct robot.dh.kinds",
            )


def check_clues(document: CaseFile, faults: Faults, statements: Sequence[Statement]) -> None:
    """Check that the unit of each clue fits the joints that it is about."""
    kinds = dict.fromkeys(statement.linear for statement in statements)
    for index, clue in enumerate(document.clues):
        for linear in kinds:
            misfit = _misfit(clue, document.robot.joints, linear)
            if misfit is not None:
                faults.add(f"clues[{index}].{misfit[0]}", misfit[1])


def _misfit(clue: AnyClue, labels: Sequence[str], linear: Sequence[bool]) -> tuple[str, str] | None:
    """Field and reason where a clue's unit is not that of its joints."""
    slides = dict(zip(labels, linear, strict=True))
    if isinstance(clue, HalfTurnsClue) and slides.get(clue.joint, False):
        return "joint", f"joint {clue.joint!r} slides, but half turns apply to angles; name another"
    if isinstance(clue, AxisClue):
        meant = slides.values() if clue.joint is None else [slides.get(clue.joint)]
        if None not in meant and is_linear(clue.unit) not in meant:
            what = "the joints" if clue.joint is None else f"joint {clue.joint!r}"
            return "unit", f"{clue.unit!r} does not fit {what}; {_FIX[is_linear(clue.unit)]}"
    if isinstance(clue, DataSheetClue):
        each = clue.units(len(labels))
        if len(each) != len(labels):
            why = f"{len(each)} units for {len(labels)} joints; give one for all, or one each"
            return "unit", why
        for place, (label, unit) in enumerate(zip(labels, each, strict=True)):
            if is_linear(unit) != slides[label]:
                at = f"unit[{place}]" if isinstance(clue.unit, tuple) else "unit"
                fix = "list one unit per joint" if len(labels) > 1 else _FIX[is_linear(unit)]
                return at, f"{unit!r} does not fit joint {label!r}; {fix}"
    return None


_FIX = {True: "give a unit of angle", False: "give a unit of length"}
"""What to give instead, by whether a unit is one of length."""
