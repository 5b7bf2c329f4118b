"""What a ratio near that of two units would mean."""

from __future__ import annotations

from math import pi

_FACTORS = {
    180 / pi: "as between degrees and radians",
    1000.0: "as a thousandth of the unit",
    100.0: "as a hundredth of the unit",
    60.0: "as per minute instead of per second",
    2 * pi: "as turns instead of radians",
    30 / pi: "as turns per minute instead of radians per second",
}
"""Ratios between units that are mixed up, and what that would mean; their inverses count too."""
_LENGTH_FACTORS = {
    1000.0: "as a thousandth of the unit",
    100.0: "as a hundredth of the unit",
    10.0: "as between millimetres and centimetres",
    60.0: "as per minute instead of per second",
}
"""The same of joints that slide, whose numbers are no angles."""
_NEAR_FACTOR = 0.01
"""Relative distance from such a ratio below which the unit is named as an explanation."""


def meant_by_ratio(ratio: float, linear: bool) -> str | None:
    """The factor between two units that a ratio is near, and what it would mean.

    Parameters
    ----------
    ratio : float
        Positive.
    linear : bool
        Whether the numbers are those of a joint that slides.

    Returns
    -------
    str or None
        None where it is near none.
    """
    for factor, meaning in (_LENGTH_FACTORS if linear else _FACTORS).items():
        for one in (factor, 1 / factor):
            if abs(ratio / one - 1) <= _NEAR_FACTOR:
                return f"{one:.6g}, {meaning}"
    return None
