"""Samples of a motion: what they say by themselves, and under a stated interpolation."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .motion import MOST_VALUES, Motion, check_joints, check_times, clock_error, numbered

_EPS = 2.0**-52
"""Spacing of float64 at 1."""


class Interpolation(StrEnum):
    """What is taken to happen between samples."""

    NONE = "none"
    """Nothing is: only what every motion through the samples does is concluded."""
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
    """Rows of time and position of every joint, with derivatives where they are given.

    Attributes
    ----------
    joints : tuple of str
    time : ndarray, shape (rows,)
        s, ascending.
    position : ndarray, shape (rows, joints)
        rad (m for sliding joints).
    velocity, acceleration : ndarray, shape (rows, joints), or None
        Where given; NaN in rows without them.
    noise : float or ndarray, shape (joints,)
        Each position is known to within this, rad.

    Raises
    ------
    TrajgapError
        If shapes disagree, a number is not finite, or times do not increase.
    """

    joints: tuple[str, ...]
    time: Array
    position: Array
    velocity: Array | None = None
    acceleration: Array | None = None
    noise: float | Array = 0.0

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
        if rows * count > MOST_VALUES:
            raise TrajgapError(
                f"{rows} samples of {count} joints; at most {MOST_VALUES:,} positions are read"
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
        if not np.isfinite(noise).all() or (noise < 0).any():
            raise TrajgapError("noise: is not a length; give what positions may be off by, or 0")
        object.__setattr__(self, "noise", np.array(noise))

    def _check_finite(
        self, name: str, values: Array, rows: NDArray[np.bool_] | None = None
    ) -> None:
        bad = ~np.isfinite(values)
        if rows is not None:
            bad &= rows[:, None]
        if bad.any():
            k, j = (int(x) for x in np.argwhere(bad)[0])
            raise TrajgapError(
                f"{name}: of joint {self.joints[j]} in sample {k + 1} is not finite; give a number"
            )

    @property
    def margin(self) -> Array:
        """What each joint's positions may be off by, shape (joints,), rad."""
        return np.asarray(self.noise)

    def has(self, order: int) -> NDArray[np.bool_]:
        """Rows that state a derivative, shape (rows,)."""
        given = (self.position, self.velocity, self.acceleration)[order]
        if given is None:
            return np.zeros(self.time.size, dtype=bool)
        return np.asarray(~np.isnan(given).any(axis=1))

    def natural(self) -> Interpolation:
        """The smoothest Hermite interpolation that the columns allow for every sample."""
        if self.has(1).all() and self.has(2).all():
            return Interpolation.QUINTIC
        return Interpolation.CUBIC if self.has(1).all() else Interpolation.LINEAR


def interpolated(samples: Samples, how: Interpolation) -> Motion:
    """The motion through samples under a stated interpolation.

    Parameters
    ----------
    samples : Samples
    how : Interpolation
        Any but ``none``.

    Returns
    -------
    Motion
        With bounds on what noise and rounding may change.

    Raises
    ------
    TrajgapError
        If the interpolation needs a derivative that is not given.
    """
    if how is Interpolation.NONE:
        raise TrajgapError("interpolation: 'none' is no motion; check_samples judges samples")
    if how is Interpolation.SPLINE:
        return _spline(samples)
    velocities, accelerations = samples.has(1), samples.has(2)
    pairs = samples.time.size - 1
    both = [velocities[1:] & velocities[:-1], accelerations[1:] & accelerations[:-1]]
    if how is Interpolation.CONTROLLER:
        if (both[1] & ~both[0]).any():
            k = int(np.argmax(both[1] & ~both[0]))
            raise TrajgapError(
                f"points {k + 1} and {k + 2}: accelerations without velocities; give velocities too"
            )
        degree = np.where(both[0], np.where(both[1], 5, 3), 1)
    else:
        degree = np.full(pairs, {"linear": 1, "cubic": 3, "quintic": 5}[how])
        for order, word, least in ((1, "velocity", 3), (2, "acceleration", 5)):
            missing = (degree >= least) & ~both[order - 1]
            if missing.any():
                raise TrajgapError(
                    f"interpolation {how}: sample {_first_without(samples, order)} has no {word}; "
                    "give it, or state another --interpolation"
                )
    return _hermite(samples, degree, _words(how, degree))


def _first_without(samples: Samples, order: int) -> int:
    return int(np.argmax(~samples.has(order))) + 1


def _words(how: Interpolation, degree: NDArray[np.int64]) -> str:
    names = {1: "straight lines", 3: "cubic Hermite", 5: "quintic Hermite"}
    used = [names[d] for d in (1, 3, 5) if (degree == d).any()]
    said = " and ".join(used) + " between samples"
    return f"{said}, as joint_trajectory_controller" if how is Interpolation.CONTROLLER else said


_WEIGHT = {1: 2.0, 3: 6.0, 5: 30.0}
"""How far a coefficient moves at most when both positions move by 1: 2·1, 2·3, 2·15."""


def _hermite(samples: Samples, degree: NDArray[np.int64], between: str) -> Motion:
    """Hermite polynomials between rows; ``degree`` 1, 3 or 5 for each pair."""
    h = np.diff(samples.time)[:, None]
    q = samples.position
    pairs, count = q.shape[0] - 1, q.shape[1]
    step = q[1:] - q[:-1]
    scaled = np.zeros((pairs, int(degree.max()) + 1, count))

    def rows(of: int) -> Any:
        # A slice where all pairs are alike: nothing is copied.
        return slice(None) if (degree == of).all() else degree == of

    scaled[:, 0] = q[:-1]
    size = np.abs(q[1:]) + np.abs(q[:-1])
    rounding = 4 * _EPS * size
    scaled[rows(1), 1] = step[rows(1)]
    if (degree > 1).any():
        assert samples.velocity is not None
        v0, v1 = h * samples.velocity[:-1], h * samples.velocity[1:]
        moves = np.abs(v0) + np.abs(v1)
    if (degree == 3).any():
        at = rows(3)
        scaled[at, 1] = v0[at]
        scaled[at, 2] = 3 * step[at] - 2 * v0[at] - v1[at]
        scaled[at, 3] = -2 * step[at] + v0[at] + v1[at]
        rounding[at] = 16 * _EPS * (size + moves)[at]
    if (degree == 5).any():
        assert samples.acceleration is not None
        a0, a1 = h * h * samples.acceleration[:-1], h * h * samples.acceleration[1:]
        at = rows(5)
        scaled[at, 1] = v0[at]
        scaled[at, 2] = a0[at] / 2
        scaled[at, 3] = (10 * step - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1)[at]
        scaled[at, 4] = (-15 * step + 8 * v0 + 7 * v1 + 1.5 * a0 - a1)[at]
        scaled[at, 5] = (6 * step - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1)[at]
        rounding[at] = 64 * _EPS * (size + moves + np.abs(a0) + np.abs(a1))[at]
    weights = np.select([degree == 1, degree == 3], [_WEIGHT[1], _WEIGHT[3]], _WEIGHT[5])
    noise = rounding + weights[:, None] * samples.margin
    return Motion(samples.joints, samples.time, scaled, noise, clock_error(samples.time), between)


def _spline(samples: Samples) -> Motion:
    from scipy.interpolate import CubicSpline

    if samples.margin.any():
        raise TrajgapError(
            "noise: a spline carries the noise of one sample to all; state another --interpolation"
        )
    if samples.time.size < 4:
        raise TrajgapError("interpolation spline: needs 4 samples or more; state another")
    spline = CubicSpline(samples.time, samples.position)
    return Motion.of_polynomial(
        spline, samples.joints, "the C2 cubic spline through the samples (not-a-knot ends)"
    )
