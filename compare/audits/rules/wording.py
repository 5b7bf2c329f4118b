"""Numbers in the paper's own units, and claims called by their place in the paper."""

from __future__ import annotations

from collections.abc import Iterable

from ....problem import from_si
from ....problem.cases import AnyClaim
from ...documents import UNITS
from ..study import Study

_SIGNS = (("deg", "°"), ("^2", "²"), ("^3", "³"))
"""How units of case files are written in a sentence."""
UNEXPLAINED = "off by more than rounding, cut-off or sampling was found to explain"
"""Said of a printed value of a motion that is not that of the printed durations."""


def unit_shown(study: Study, pid: str, rid: str, quantity: str) -> str:
    """The unit that a quantity is printed in, as a sentence writes it; SI where none is stated.

    Parameters
    ----------
    study : Study
    pid, rid : str
        Problem and reading.
    quantity : str
        "position", "velocity", "acceleration", "jerk" or "time".
    """
    if quantity == "duration":
        quantity = "time"
    unit = getattr(study.case.statement(pid, rid).units, quantity, None)
    if unit is None:
        return UNITS.get(quantity, "s")
    for plain, sign in _SIGNS:
        unit = unit.replace(plain, sign)
    return str(unit)


def in_units(study: Study, pid: str, rid: str, quantity: str, value: float) -> float:
    """A number in rad and s, in the unit that its quantity is printed in.

    Parameters
    ----------
    study : Study
    pid, rid : str
        Problem and reading.
    quantity : str
        "position", "velocity", "acceleration", "jerk" or "time".
    value : float
    """
    if quantity == "duration":
        quantity = "time"
    unit = getattr(study.case.statement(pid, rid).units, quantity, None)
    return value if unit is None else from_si(value, unit)


def called(claim: AnyClaim) -> str:
    """What a sentence calls a claim: the place where it stands, the first where there are more."""
    return claim.where.split(";")[0].strip()


def called_under(claim: AnyClaim, pid: str) -> str:
    """A claim by its place, and the problem in brackets where the claim is about several."""
    return called(claim) if claim.problem == pid else f"{called(claim)} ({pid})"


def all_called(claims: Iterable[AnyClaim]) -> str:
    """Several claims, each once."""
    return "; ".join(dict.fromkeys(called(claim) for claim in claims))
