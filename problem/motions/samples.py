"""Samples of a motion: what they say by themselves, and under a stated interpolation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from ..files import MOST
from .digits import HalfUnits
from .motion import EPS, LARGEST, check_joints, check_times, numbered


class Interpolation(StrEnum):
    """The assumption about the motion between samples."""

    NONE = "none"
    """Nothing is assumed; conclusions hold for every motion through the samples."""
    LINEAR = "linear"
    """Straight lines; velocity jumps at the samples."""
    CUBIC = "cubic"
    """Cubic Hermite polynomials from positions and velocities."""
    QUINTIC = "quintic"
    """Quintic Hermite polynomials from positions, velocities and accelerations."""
    SPLINE = "spline"
    """The C2 cubic spline through the positions, not-a-knot ends (scipy's CubicSpline)."""
    CONTROLLER = "controller"
    """As ROS's joint_trajectory_controller does: between two points quintic if both have
    velocities and accelerations, cubic if both have velocities, else linear."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Rows of time and position of every joint, with derivatives if they are given.

    Raises
    ------
    TrajgapError
        If shapes disagree, a number is not finite, or times do not increase.
    """

    joints: tuple[str, ...]
    time: Array
    """Shape (rows,); s, ascending."""
    position: Array
    """Shape (rows, joints); rad (m for sliding joints)."""
    velocity: Array | None = None
    acceleration: Array | None = None
    """Shape (rows, joints). Derivatives, if given; NaN in rows without them."""
    noise: float | Array = 0.0
    """One number, or shape (joints,). Each position is measured to within this, rad."""
    time_noise: float = 0.0
    """Each time is measured to within this, s."""
    rounding: HalfUnits = field(default_factory=HalfUnits)
    """Uncertainty of all numbers from rounding when they were written, in addition to the noise."""

    def __post_init__(self) -> None:
        for name in ("time", "position", "velocity", "acceleration"):
            given = getattr(self, name)
            if given is None:
                continue
            try:
                array = np.array(given, dtype=np.float64)
            except (TypeError, ValueError):
                raise TrajgapError(f"{name}: not numbers; give one row per time") from None
            if name != "time" and array.ndim == 1:
                array = array[:, None]
            object.__setattr__(self, name, array)
        rows, count = self.position.shape if self.position.ndim == 2 else (0, 0)
        object.__setattr__(self, "joints", tuple(self.joints) or numbered(count))
        check_joints(self.joints, count)
        if self.time.shape != (rows,):
            raise TrajgapError(f"time: {self.time.size} times for {rows} rows; give one a row")
        if rows * count > MOST.positions:
            raise TrajgapError(
                f"{rows} samples of {count} joints; at most {MOST.positions:,} positions are read"
            )
        check_times(self.time, "time")
        self._check_finite("position", self.position)
        for name in ("velocity", "acceleration"):
            given = getattr(self, name)
            if given is None:
                continue
            if given.shape != self.position.shape:
                raise TrajgapError(
                    f"{name}: shape {given.shape}, positions have {self.position.shape}"
                )
            there = ~np.isnan(given).all(axis=1)
            self._check_finite(name, given, there)
            if not there.any():
                object.__setattr__(self, name, None)
        noise = np.broadcast_to(np.asarray(self.noise, dtype=np.float64), (count,))
        if not ((noise >= 0) & (noise <= LARGEST)).all():
            raise TrajgapError(
                "noise: is not a length; give the uncertainty of the positions, or 0"
            )
        object.__setattr__(self, "noise", np.array(noise))
        for clock in (self.time_noise, self.rounding.time):
            if not (np.isfinite(clock) and clock >= 0):
                raise TrajgapError(
                    "time noise: is not a time; give the uncertainty of the times, or 0"
                )

    def _check_finite(
        self, name: str, values: Array, rows: NDArray[np.bool_] | None = None
    ) -> None:
        bad = ~(np.abs(values) <= LARGEST)
        if rows is not None:
            bad &= rows[:, None]
        if bad.any():
            k, j = (int(x) for x in np.argwhere(bad)[0])
            raise TrajgapError(
                f"{name}: of joint {self.joints[j]} in sample {k + 1} is not finite, or beyond "
                f"{LARGEST:g}; give a number"
            )

    @property
    def margin(self) -> Array:
        """Uncertainty of each joint's positions, shape (joints,), rad."""
        return np.asarray(self.noise + self.rounding.of(0, len(self.joints)))

    @property
    def clock(self) -> float:
        """Uncertainty of each time, s."""
        return self.time_noise + self.rounding.time

    @property
    def time_error(self) -> Array:
        """The same with the rounding of each time to float64, shape (rows,)."""
        return np.asarray(self.clock + EPS * np.abs(self.time))

    def error(self, order: int) -> Array:
        """Uncertainty of stated values, rounding to float64 included, (rows, joints)."""
        given = self.given(order)
        assert given is not None
        return np.asarray(self.doubt(order) + EPS * np.abs(given))

    def doubt(self, order: int) -> Array:
        """Uncertainty of the values of derivative ``order``, shape (joints,)."""
        return self.margin if order == 0 else self.rounding.of(order, len(self.joints))

    def given(self, order: int) -> Array | None:
        """Positions, velocities or accelerations, shape (rows, joints), if there are any."""
        return (self.position, self.velocity, self.acceleration)[order]

    def has(self, order: int) -> NDArray[np.bool_]:
        """Rows that state a derivative, shape (rows,)."""
        given = self.given(order)
        if given is None:
            return np.zeros(self.time.size, dtype=bool)
        return np.asarray(~np.isnan(given).any(axis=1))

    def slowed(self, factor: float) -> Samples:
        """The same path, slower by a factor; numbers count as exact, apart from stated noise."""
        start = self.time[0]
        return replace(
            self,
            time=start + factor * (self.time - start),
            velocity=None if self.velocity is None else self.velocity / factor,
            acceleration=None if self.acceleration is None else self.acceleration / factor**2,
            rounding=HalfUnits(),
        )

    @property
    def assumed(self) -> str:
        """Uncertainty of the numbers, in a sentence; empty if they count as exact."""
        parts = []
        if self.clock:
            parts.append(f"times to {self.clock:.3g} s")
        for order, word in enumerate(("positions", "velocities", "accelerations")):
            doubt = self.doubt(order)
            if self.given(order) is not None and doubt.any():
                low, high = f"{doubt.min():.3g}", f"{doubt.max():.3g}"
                power = ("", "/s", "/s²")[order]
                span = high if low == high else f"{low} to {high}"
                parts.append(f"{word} to {span} rad{power}")
        if not parts:
            return ""
        stated = bool(np.any(self.noise)) or self.time_noise > 0
        rounded = bool(np.any(self.rounding.values)) or self.rounding.time > 0
        why = " and ".join(
            word
            for word, holds in (
                ("as stated", stated),
                ("half a unit of the last digit in the file", rounded),
            )
            if holds
        )
        return f"Uncertainty of the numbers: {', '.join(parts)} ({why})."

    @property
    def advice(self) -> str:
        """Advice if this leaves a verdict open."""
        rounded = bool(np.any(self.rounding.values)) or self.rounding.time > 0
        return (
            "Write more digits, also for the times, or state --noise 0 and --time-noise 0 if the "
            "numbers in the file are exact."
            if rounded
            else "State a smaller noise if the numbers are more precise."
            if self.assumed
            else ""
        )
