"""Joint limits on position, velocity, acceleration and jerk."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array
from .errors import TrajgapError

QUANTITIES = ("velocity", "acceleration", "jerk")
"""The limited derivatives of the joint angle, in order of differentiation."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Symmetric limits on the derivatives of every joint, and a position range.

    Parameters
    ----------
    velocity, acceleration, jerk : array_like, shape (joints,) or scalar
        Largest absolute value, rad/s, rad/s², rad/s³. ``inf`` means no limit; 0 means that the
        joint must not move.
    position_lower, position_upper : array_like, shape (joints,) or scalar
        Position range, rad; infinite where there is none.
    joints : int, optional
        Number of joints; needed only when everything given is a scalar.

    Raises
    ------
    TrajgapError
        If a limit is not a number, NaN or negative, the range is empty, or the lengths differ.
    """

    velocity: Array = field(default_factory=lambda: np.array(np.inf))
    acceleration: Array = field(default_factory=lambda: np.array(np.inf))
    jerk: Array = field(default_factory=lambda: np.array(np.inf))
    position_lower: Array = field(default_factory=lambda: np.array(-np.inf))
    position_upper: Array = field(default_factory=lambda: np.array(np.inf))
    joints: int | None = None

    def __post_init__(self) -> None:
        names = (*QUANTITIES, "position_lower", "position_upper")
        arrays = {}
        for name in names:
            try:
                arrays[name] = np.asarray(getattr(self, name), dtype=np.float64)
            except (TypeError, ValueError):
                raise TrajgapError(
                    f"limits.{name}: not numbers; give one value, or one per joint"
                ) from None
        sizes = {a.size for a in arrays.values() if a.ndim} | (
            {self.joints} if self.joints is not None else set()
        )
        count = max(sizes, default=1)
        for name, array in arrays.items():
            if array.ndim > 1 or (array.ndim == 1 and array.size != count):
                raise TrajgapError(
                    f"limits.{name}: expected one value or {count} (one per joint), "
                    f"got shape {array.shape}"
                )
            if np.isnan(array).any():
                raise TrajgapError(f"limits.{name}: is NaN; write inf where there is no limit")
            if name in QUANTITIES and (array < 0).any():
                raise TrajgapError(
                    f"limits.{name}: is negative; give the largest absolute value, 0 or more"
                )
            full = np.array(np.broadcast_to(array, (count,)))
            full.setflags(write=False)
            object.__setattr__(self, name, full)
        object.__setattr__(self, "joints", count)
        if (self.position_lower > self.position_upper).any():
            raise TrajgapError("limits.position_lower: lies above limits.position_upper")

    @property
    def derivatives(self) -> Array:
        """Velocity, acceleration and jerk limits stacked, shape (joints, 3)."""
        return np.stack([self.velocity, self.acceleration, self.jerk], axis=1)

    @property
    def limits_position(self) -> bool:
        """Whether any joint has a finite position limit."""
        return bool(
            np.isfinite(self.position_lower).any() or np.isfinite(self.position_upper).any()
        )

    def joint(self, index: int) -> Limits:
        """Limits of one joint alone."""
        one = slice(index, index + 1)
        return Limits(
            self.velocity[one],
            self.acceleration[one],
            self.jerk[one],
            self.position_lower[one],
            self.position_upper[one],
        )

    def with_derivatives(self, values: ArrayLike) -> Limits:
        """Copy with the derivative limits replaced by ``values``, shape (joints, 3)."""
        v = np.asarray(values, dtype=np.float64)
        return replace(self, velocity=v[:, 0], acceleration=v[:, 1], jerk=v[:, 2])


def half_range(low: float, high: float, limit: float) -> float:
    """What an excess of position is set beside, so that its ratio is 1 at the limit."""
    return float((high - low) / 2) if np.isfinite(high - low) else max(1.0, abs(limit))
