"""Ratios of the segment durations that a question fixes, so the total alone is chosen."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array
from .curves import Curve
from .errors import RatiosError

RatioWord = Literal["equal", "chord"]
"""Words for ratios that need no numbers."""
RATIO_WORDS: tuple[RatioWord, ...] = ("equal", "chord")
"""All of them: all durations alike, and in proportion to the distances of the way-points."""
_MOST_APART = 1e12
"""Largest quotient of two ratios: beyond it float64 loses the curve of the shorter segment."""


def ratio_word(given: object) -> RatioWord | None:
    """The word that something is, if it is one of them."""
    return next((word for word in RATIO_WORDS if word == given), None)


def chord_lengths(waypoints: Array) -> Array:
    """Euclidean lengths of the steps between way-points, all joints together.

    Parameters
    ----------
    waypoints : ndarray, shape (way-points, joints)
        rad.

    Returns
    -------
    ndarray, shape (way-points − 1,)
        rad.

    Raises
    ------
    RatiosError
        If two neighbours coincide: the segment between them would take no time.
    """
    lengths = np.hypot.reduce(np.diff(waypoints, axis=0), axis=1)
    if (lengths == 0).any():
        k = int(np.argmax(lengths == 0))
        raise RatiosError(
            f'"chord" gives the segment between way-points {k + 1} and {k + 2}, which '
            "coincide, no time; give numbers, or leave one of the two out"
        )
    return np.asarray(lengths)


def as_ratios(given: ArrayLike | RatioWord, waypoints: Array, segments: int) -> Array:
    """Ratios as numbers, one per segment, or a clear refusal.

    Parameters
    ----------
    given : array_like or {"equal", "chord"}
    waypoints : ndarray, shape (way-points, joints)
        rad.

    Returns
    -------
    ndarray, shape (segments,)
        Positive; read-only.

    Raises
    ------
    RatiosError
        If they are not positive numbers, one per segment.
    """
    if isinstance(given, str):
        found = _by_word(given, waypoints, segments)
    else:
        try:
            found = np.array(given, dtype=np.float64)
        except (TypeError, ValueError):
            raise RatiosError('not numbers; give one per segment, "equal" or "chord"') from None
        if found.shape != (segments,):
            raise RatiosError(f"expected {segments}, one per segment, got {found.size}")
    if not (np.isfinite(found) & (found > 0)).all():
        raise RatiosError("every one must be positive and finite")
    if found.max() > found.min() * _MOST_APART:
        raise RatiosError(
            f"the largest is more than {_MOST_APART:g} times the smallest; correct them"
        )
    found.setflags(write=False)
    return found


def _by_word(word: str, waypoints: Array, segments: int) -> Array:
    if word == "equal":
        return np.ones(segments)
    if word != "chord":
        raise RatiosError(f'{word!r} is unknown; give one number per segment, "equal" or "chord"')
    if len(waypoints) != segments + 1:
        raise RatiosError(
            f'"chord" needs a way-point at every end of the {segments} segments, '
            f"{len(waypoints)} are given; give numbers"
        )
    return chord_lengths(waypoints)


def no_formula(curve: Curve) -> str | None:
    """Why the shortest total at fixed ratios is not a formula for a curve; None if it is one.

    Returns
    -------
    str or None
        With what to do about it.
    """
    fix = "leave the ratios out, so each duration is free"
    if curve.free:
        return (
            f"ratios: {curve.name} leaves {curve.free} coefficients per joint free, so the total "
            f"is not the only unknown; add conditions, or {fix}"
        )
    if not curve.homogeneous:
        return (
            f"ratios: {curve.name} prescribes derivatives other than 0, which change with the "
            f"total; prescribe 0, or {fix}"
        )
    return None
