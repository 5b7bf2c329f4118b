"""A table of way-points with limits from flags and files, as a case to solve."""

from __future__ import annotations

import sys
import tomllib
from decimal import Decimal
from typing import Any

import numpy as np

from ...problem import QUANTITIES, Case, CaseError, TrajgapError, is_linear, scaffold, visible
from ...problem.cases import check_case
from ...problem.motions import factors_of
from .motion_checking import MotionOptions, stated_limits, words

_POWERS = {"velocity": "/s", "acceleration": "/s^2", "jerk": "/s^3"}
"""What follows the unit of positions in that of a limit."""


def points_case(
    source: str, options: MotionOptions, family: str | None, degree: int | None
) -> Case:
    """A case without claims: the way-points of a table, and the limits that the options state.

    Parameters
    ----------
    source : str
        CSV, as `scaffold` reads it.
    options : MotionOptions
    family : str or None
    degree : int or None
        As in `scaffold`.

    Returns
    -------
    Case

    Raises
    ------
    CaseError
        If the table or an option cannot be used, or a joint has no limit that others have.
    """
    units = words(options.units) or ("rad",)
    given = {"position": ",".join(units), "jerk": "rad/s^3"}
    # The curve that is usual depends on whether jerk is limited: only that is asked of the number.
    raw = tomllib.loads(scaffold(source, given, family=family, degree=degree), parse_float=Decimal)
    joints = raw["robot"]["joints"]
    factors = factors_of(units, len(joints), "--units")
    try:
        stated = stated_limits(joints, factors, options)
        limits = stated.two_sided
    except CaseError:
        raise
    except TrajgapError as error:
        raise CaseError("limits", "", str(error)) from None
    if family is None and np.isfinite(limits.sides[:, :, 2]).any():
        text = scaffold(source, given, family=family, degree=degree, jerk="1")
        raw = tomllib.loads(text, parse_float=Decimal)
    slides = [is_linear(unit) for unit in units] * (len(joints) if len(units) == 1 else 1)
    raw["limits"] = block = {}
    for quantity in QUANTITIES:
        low, high = limits.ends(quantity)
        block[quantity] = [[_number(a), _number(b)] for a, b in zip(low, high, strict=True)]
        raw["units"][quantity] = [("m" if s else "rad") + _POWERS[quantity] for s in slides]
    for name in ("position_lower", "position_upper"):
        block[name] = [_number(x) for x in getattr(limits, name) / factors]
    case = check_case(raw, source)
    slower = [j for j, x in zip(joints, stated.deceleration, strict=True) if np.isfinite(x)]
    if slower:
        sys.stderr.write(
            f"trajgap: {visible(source)}: deceleration has its own limit at joint "
            f"{visible(', '.join(slower))}; here the smaller value limits acceleration and "
            "deceleration alike, so a motion that uses the larger one may be shorter\n"
        )
    return case


def _number(value: float) -> Any:
    """A number as TOML gives it, to the last bit."""
    return Decimal(repr(float(value))) if np.isfinite(value) else float(value)
