"""A number in a document, or null with the reason beside it: JSON knows no infinity, no NaN."""

from __future__ import annotations

import math
from typing import Any


def number_or_why(key: str, value: float | None, why: str | None) -> dict[str, Any]:
    """Entries of a document for a number that may be undefined.

    Parameters
    ----------
    key : str
    value : float or None
    why : str or None
        Why there is none, where there is none.

    Returns
    -------
    dict
        ``{key: number}``, or ``{key: None, key_why: reason}``.
    """
    if value is not None and math.isfinite(value):
        return {key: float(value)}
    if value is not None:
        why = "beyond the range of floating point" if math.isnan(value) else "unbounded"
    return {key: None, f"{key}_why": why or "not computed"}
