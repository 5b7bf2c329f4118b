"""Piecewise polynomials as JSON: ``breaks`` and coefficients as scipy's PPoly has them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np

from ..arrays import Array
from ..curves import MAX_COEFFICIENTS
from ..errors import CaseError, TrajgapError
from ..files import MOST
from .motion import Motion
from .plain_data import check_names

POLYNOMIAL_FORMAT = "trajgap-motion/1"
"""Key `format` of such a file, so a later form can be told from this one."""


def motion_of_json(found: Any, name: str, factors: Array | float = 1.0) -> Motion:
    """The motion of a file of polynomials.

    Parameters
    ----------
    found : object
        ``{"breaks": [t0, ..., tn], "coefficients": [[[...], ...], ...], "joints": [...]}``:
        coefficients by piece, then by power of t − t_k **descending**, then by joint; or, as
        scipy's arrays ``x`` and ``c``, by power, piece and joint.
    factors : float or ndarray, shape (joints,)
        What a number of the file is in rad.
    """
    from scipy.interpolate import PPoly

    form = found.get("format", POLYNOMIAL_FORMAT)
    if isinstance(form, str) and form.startswith("trajgap-motion/") and form != POLYNOMIAL_FORMAT:
        raise CaseError(
            name, "format", f"{form!r} is not known here; {POLYNOMIAL_FORMAT!r} is read"
        )
    if "coefficients" in found:
        key, axes = "coefficients", (1, 0, 2)
    else:
        key, axes = "c", (0, 1, 2)
    breaks = _array(name, "breaks" if "breaks" in found else "x", found, 1)
    c = _array(name, key, found, 3)
    if c.size > 10 * MOST.positions:
        raise CaseError(name, key, f"{c.size} coefficients are too many; keep fewer")
    labels = found.get("joints") or ()
    check_names(labels, name, "joints")
    c = c.transpose(axes)
    if c.shape[0] == 0 or c.shape[1] != breaks.size - 1:
        raise CaseError(
            name, key, f"{c.shape[1]} pieces for {breaks.size} breaks; give one break more"
        )
    if c.shape[0] > MAX_COEFFICIENTS and c[: c.shape[0] - MAX_COEFFICIENTS].any():
        raise CaseError(name, key, f"degree {c.shape[0] - 1}; at most 9 is judged")
    try:
        with np.errstate(over="ignore"):  # refused by the motion
            return Motion.of_polynomial(PPoly(c * factors, breaks), tuple(labels))
    except (TrajgapError, ValueError) as error:
        raise CaseError(name, "", str(error)) from None


def _array(name: str, key: str, found: Any, axes: int) -> Array:
    value = found.get(key)
    if value is None:
        raise CaseError(name, key, "is missing; give breaks and coefficients")
    level = [value]
    for depth in range(axes):
        if not all(isinstance(one, list) for one in level):
            raise CaseError(name, key, f"{depth} levels of lists, {axes} are needed; see the guide")
        level = list(chain.from_iterable(level))
    # numpy would read "1" and true as numbers.
    for kind in set(map(type, level)) - {int, float}:
        odd = next(one for one in level if type(one) is kind)
        raise CaseError(name, key, f"holds {str(odd)[:40]!r}, which is not a number; give numbers")
    try:
        array = np.array(value, dtype=np.float64)
    except (ValueError, OverflowError):
        raise CaseError(name, key, "is ragged or out of range; give a full table") from None
    if not np.isfinite(array).all():
        raise CaseError(name, key, "holds a number that is not finite; give finite ones")
    return array


def polynomial_json(motion: Motion, linear: Sequence[bool] = ()) -> dict[str, Any]:
    """A motion in the form that `motion_of_json` reads, rad and s; m of joints that slide."""
    position = ["m" if slides else "rad" for slides in linear] if any(linear) else "rad"
    plain = np.asarray(motion.polynomial.c).transpose(1, 0, 2)
    return {
        "format": POLYNOMIAL_FORMAT,
        "joints": list(motion.joints),
        "units": {"time": "s", "position": position},
        "breaks": motion.breaks.tolist(),
        "coefficients": plain.tolist(),
    }
