"""Algorithms by the name that case files give them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from ...problem import TrajgapError
from ..algorithm import Algorithm
from ..settings import nearest
from .constrained_pso import ConstrainedPSO
from .ga import GA
from .improved_ga import ImprovedGA
from .improved_woa import ImprovedWOA
from .mnam_pso import MNAMPSO
from .pso import PSO
from .woa import WOA

_RECORDS: dict[str, Any] = {
    record.kind: record
    for record in (PSO, MNAMPSO, ConstrainedPSO, WOA, ImprovedWOA, GA, ImprovedGA)
}
"""Record of settings by kind, in the order of the papers; a new algorithm adds a line here."""

KINDS: tuple[str, ...] = tuple(_RECORDS)
"""Kinds of algorithm that are implemented."""


MOST_COUNT = 100_000
"""Largest whole number in the settings of an algorithm, such as its population or iterations.

A hundred times what papers print; a population of that size still fits into memory.
"""


def _record(kind: str) -> Any:
    if kind not in _RECORDS:
        raise TrajgapError(f"algorithm kind: {kind!r} is unknown; {nearest(str(kind), KINDS)}")
    return _RECORDS[kind]


def from_settings(kind: str, settings: Mapping[str, object]) -> Algorithm[Any]:
    """Algorithm of a kind, with its settings; what is left out takes its documented default.

    Parameters
    ----------
    kind : str
        One of `KINDS`, such as "pso" or "improved-woa".
    settings : mapping
        Field of the algorithm's record to value; enumerations by their words.

    Raises
    ------
    TrajgapError
        One line if the kind or a key is unknown (it names the nearest), or a value is invalid.

    Examples
    --------
    >>> from_settings("pso", {"particles": 20}).particles
    20
    """
    record = _record(kind)
    known = [field.name for field in fields(record)]
    for key in settings:
        if key not in known:
            said = nearest(str(key), known)
            raise TrajgapError(f"{kind}: {key}: unknown setting; {said} known: {', '.join(known)}")
    made: Algorithm[Any] = record(**settings)
    for key in settings:
        value = getattr(made, key)
        # Clean by now: a whole number is a count, whatever else may be large is a float.
        if isinstance(value, int) and value > MOST_COUNT:
            raise TrajgapError(f"{kind}: {key}: {value} is more than {MOST_COUNT}; give less")
    return made


def open_choices(kind: str) -> tuple[str, ...]:
    """List what the paper of an algorithm leaves open, and what was chosen.

    Raises
    ------
    TrajgapError
        If the kind is unknown.
    """
    choices: tuple[str, ...] = _record(kind).open_choices
    return choices
