"""Numbers in the paper's own units, and claims called by their place in the paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ....problem import Jump, from_si, shown_unit
from ....problem.cases import AnyClaim, Claim
from ...documents import UNITS, noted, si_unit
from ..row import Row, rows_under
from ..study import Study

_Jump = tuple[Row[Claim], Jump]
"""A jump with the row whose motion it is of."""
JUMPING = ("position", "velocity", "acceleration")
"""What jumps, by its order."""
UNEXPLAINED = "off by more than rounding, cut-off or sampling was found to explain"
"""Said of a printed value of a motion that is not that of the printed durations."""


def unit_shown(row: Row[Claim], quantity: str, joint: str | None = None) -> str:
    """The unit that a quantity is printed in, as a sentence writes it; SI where none is stated.

    Parameters
    ----------
    row : Row
    quantity : str
        "position", "velocity", "acceleration", "jerk" or "time".
    joint : str, optional
        Label of the joint whose unit it is; needed where units differ.
    """
    unit, linear = _unit(row, quantity, joint)
    if unit is not None:
        return shown_unit(unit)
    return si_unit(quantity, linear) if quantity in UNITS else "s"


def in_units(row: Row[Claim], quantity: str, value: float, joint: str | None = None) -> float:
    """A number in rad or m and s, in the unit that its quantity is printed in.

    Parameters
    ----------
    row : Row
    quantity : str
        "position", "velocity", "acceleration", "jerk" or "time".
    value : float
    joint : str, optional
        As for `unit_shown`.
    """
    unit, _ = _unit(row, quantity, joint)
    return value if unit is None else from_si(value, unit)


def _unit(row: Row[Claim], quantity: str, joint: str | None) -> tuple[str | None, bool]:
    """The unit that a quantity is printed in, if one is stated, and whether the joint slides."""
    statement = row.statement
    if quantity not in UNITS:
        return (statement.units.time if quantity in ("duration", "time") else None), False
    place = None if joint is None else statement.labels.index(joint)
    linear = statement.linear[statement.joints[0] if place is None else place]
    return statement.unit(quantity, place), linear  # type: ignore[arg-type]


def largest_of_each_kind(jumps: Sequence[_Jump]) -> list[_Jump]:
    """The largest jump of joints that turn and that of joints that slide, where there are any.

    The kind of the first one stands first.
    """
    found: dict[bool, _Jump] = {}
    for row, jump in jumps:
        statement = row.statement
        linear = statement.linear[statement.labels.index(jump.joint)]
        if linear not in found or abs(jump.size) > abs(found[linear][1].size):
            found[linear] = row, jump
    return list(found.values())


def jump_size(row: Row[Claim], jump: Jump) -> float:
    """Size of a jump in the unit of its joint."""
    return in_units(row, JUMPING[jump.order], jump.size, jump.joint)


def jump_unit(row: Row[Claim], jump: Jump) -> str:
    """The unit of a jump, as a sentence writes it."""
    return unit_shown(row, JUMPING[jump.order], jump.joint)


def called(claim: AnyClaim) -> str:
    """What a sentence calls a claim: the place where it stands, the first where there are more."""
    return claim.where.split(";")[0].strip()


def called_under(study: Study, claim: AnyClaim, problem: str | None) -> str:
    """A claim by its place, and the problem in brackets where the claim is about several."""
    problems = {one.id: one.title or one.id for one in study.case.problems}
    several = len(problems) > 1 and problem != claim.problem
    return noted(called(claim), problems[str(problem)] if several else "")


def all_called(claims: Iterable[AnyClaim]) -> str:
    """Several claims, each once."""
    return "; ".join(dict.fromkeys(called(claim) for claim in claims))


def durations_text(study: Study, claim: AnyClaim) -> str:
    """The printed durations with their unit."""
    durations = ", ".join(map(str, study.case.printed_durations(claim)))
    return f"{durations} {study.time_unit}"


def left_out(study: Study, named: Iterable[AnyClaim], reading: str) -> list[AnyClaim]:
    """Claims that a statement names and from which no motion is built under a reading.

    They are of another curve, or have another number of durations than the curve has segments.
    """
    chosen = (None, *study.problems)
    return [c for c in named if c.problem in chosen and not rows_under(study, [c], reading)]
