"""Numbers in the paper's own unit, with SI in brackets."""

from __future__ import annotations

from collections.abc import Sequence

from ...problem import Printed, shown_unit, to_si
from ...problem.cases import Statement
from ..documents import UNITS, si_unit


def paper_units(statement: Statement) -> dict[tuple[str, str], tuple[str, float]]:
    """The paper's units where they are not SI, as pictures take them: as written, and in SI.

    By joint and quantity.

    `statement`: the problem under the reading whose units count.
    """
    found = {}
    for joint in statement.joints:
        for quantity in UNITS:
            own = _own(statement, quantity, joint)
            if own is not None:
                found[statement.labels[joint], quantity] = own
    return found


def _own(statement: Statement, quantity: str, joint: int) -> tuple[str, float] | None:
    """The paper's unit of a joint where it is not SI, and how much of SI one of it is."""
    unit = statement.unit(quantity, joint)  # type: ignore[arg-type]
    if unit is None or shown_unit(unit) == si_unit(quantity, statement.linear[joint]):
        return None
    return shown_unit(unit), to_si(Printed("1", exact=True), unit).value


def both_units(
    statement: Statement,
    quantity: str,
    values: Sequence[float],
    form: str,
    joints: Sequence[int] | None = None,
) -> str:
    """Values in the paper's unit of a quantity, with SI in brackets where that is another.

    `quantity`: such as "velocity". `values`: in SI. `form`: format of each number, such as "+.6g".
    `joints`: position of each value's joint in the robot's list; those that take part by default,
    where one value may stand for all that have one unit.
    """
    places = list(statement.joints if joints is None else joints)
    places = places[: len(values)]
    if not one_unit(statement, quantity, places):
        each = zip(values, places, strict=True)
        return ", ".join(both_units(statement, quantity, [v], form, [j]) for v, j in each)
    si = ", ".join(f"{v:{form}}" for v in values)
    si += f" {si_unit(quantity, statement.linear[places[0]])}"
    unit = _own(statement, quantity, places[0])
    if unit is None:
        return si
    own = ", ".join(f"{round(v / unit[1], 10):{form}}" for v in values)
    return f"{own} {unit[0]} ({si})"


def one_unit(statement: Statement, quantity: str, joints: Sequence[int]) -> bool:
    """Whether some joints have a quantity in the same unit, stated or not."""
    found = {(statement.unit(quantity, j), statement.linear[j]) for j in joints}  # type: ignore[arg-type]
    return len(found) == 1
