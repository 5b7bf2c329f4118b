"""Numbers in the paper's own unit, with SI in brackets."""

from __future__ import annotations

from collections.abc import Sequence

from ...problem import Printed
from ...problem.cases import Statement
from ..documents import UNITS

_SHOWN = {"deg": "°", "deg/s": "°/s", "deg/s^2": "°/s²", "deg/s^3": "°/s³"}
"""How units of case files are written on a page; others as SI has them."""


def paper_units(statement: Statement) -> dict[str, tuple[str, float]]:
    """The paper's units where they are not SI, as pictures take them: as written, and in SI.

    Parameters
    ----------
    statement : Statement
        The problem under the reading whose units count.
    """
    found = {}
    for quantity in UNITS:
        unit = getattr(statement.units, quantity, None)
        if unit in _SHOWN:
            found[quantity] = (_SHOWN[unit], statement.si(Printed("1"), quantity).value)  # type: ignore[arg-type]
    return found


def both_units(statement: Statement, quantity: str, values: Sequence[float], form: str) -> str:
    """Values in the paper's unit of a quantity, with SI in brackets where that is another.

    Parameters
    ----------
    statement : Statement
        The problem under the reading whose units count.
    quantity : str
        Such as "velocity".
    values : sequence of float
        In SI.
    form : str
        Format of each number, such as "+.6g".
    """
    si = ", ".join(f"{v:{form}}" for v in values) + f" {UNITS[quantity]}"
    unit = getattr(statement.units, quantity, None)
    if unit is None or unit not in _SHOWN:
        return si
    one = statement.si(Printed("1"), quantity).value  # type: ignore[arg-type]
    own = ", ".join(f"{round(v / one, 10):{form}}" for v in values)
    return f"{own} {_SHOWN[unit]} ({si})"
