"""A file with a motion of whatever format, known by its ending and its keys."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..printed import is_linear, scale
from .digits import HalfUnits
from .motion import Motion
from .parquet_file import read_parquet
from .plain_data import read_json, read_yaml
from .polynomial_file import motion_of_json, polynomial_json
from .ros import message_of_samples, samples_of_message, trajectories
from .samples import Samples
from .tables import read_csv
from .written import MotionForm, csv_text

UNITS = ("rad", "deg", "m", "cm", "mm")
"""Units of positions in a file without units of its own."""


_GRADUAL = 0.2 * np.pi
"""Largest step of an angle between two samples, rad, that a log has: 36°."""


@dataclass(frozen=True, eq=False)
class ForeignFile:
    """The content of a file."""

    format: str
    content: Samples | Motion
    """rad (m), s."""
    units: tuple[str, ...]
    """Unit of each joint, in the file and in output."""
    controller: bool = False
    """Whether a controller's interpolation is known: ROS trajectories."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Labels of the joints."""
        return self.content.joints

    @property
    def form(self) -> MotionForm:
        """The format for writing the same content; CSV for every table."""
        if isinstance(self.content, Motion):
            return MotionForm.PPOLY
        return MotionForm.ROS if self.controller else MotionForm.CSV

    def slowed(self, factor: float) -> ForeignFile:
        """The same path, slower by a factor from its start.

        The numbers of the slower motion count as exact, because none of its digits was rounded.
        """
        return replace(self, content=self.content.slowed(factor))

    def written(self) -> str:
        """Text of a file with this motion: `read_motion` reads it with the same units and joints.

        Returns
        -------
        str
            Tables are in `units`, messages and polynomials in rad and m.
        """
        content = self.content
        if isinstance(content, Motion):
            slides = [is_linear(one) for one in self.units]
            return json.dumps(polynomial_json(content, slides)) + "\n"
        if self.controller:
            return json.dumps(message_of_samples(content), indent=1) + "\n"
        return csv_text(content, factors_of(self.units, len(self.joints), "--units"))


def read_motion(
    path: Path,
    units: Sequence[str] = (),
    noise: Sequence[float] | None = None,
    joints: Sequence[str] = (),
    topic: str | None = None,
    time_noise: float | None = None,
) -> ForeignFile:
    """Read a motion from a file.

    Parameters
    ----------
    path : Path
        CSV or text, ``.parquet``, ``.json`` (polynomials, or a JointTrajectory), ``.yaml``
        (JointTrajectory), ``.bag``, ``.mcap``, ``.db3`` or the folder of a rosbag.
    units : sequence of str
        One for all joints, or one each: of tables, and of polynomials that state none; rad by
        default. ROS has rad and m.
    noise : sequence of float, optional
        Uncertainty of the positions, in those units; one number, or one per joint. 0 means that
        positions, velocities and accelerations are exact; by default the uncertainty follows from
        their digits.
    joints : sequence of str, optional
        Names, for a table without a header.
    topic : str, optional
        Topic to read from a rosbag with several trajectories.
    time_noise : float, optional
        Uncertainty of the times, s; by default it follows from their digits.
    """
    for one in units:
        if one not in UNITS:
            raise CaseError("--units", "", f"{one!r} is unknown; use {', '.join(UNITS)}")
    asked = _Asked(str(path), tuple(units), noise, time_noise)
    ending = path.suffix.lower()
    if ending in (".bag", ".mcap", ".db3") or path.is_dir():
        from .rosbag import read_rosbag

        return asked.ros(read_rosbag(path, topic), "ROS bag")
    if ending in (".yaml", ".yml"):
        return asked.message(read_yaml(path), "ROS JointTrajectory, YAML")
    if ending == ".json":
        found = read_json(path)
        keys = found.keys() if isinstance(found, Mapping) else ()
        if "coefficients" in keys or ("c" in keys and "x" in keys):
            return asked.polynomials(found)
        return asked.message(found, "ROS JointTrajectory, JSON")
    if ending in (".parquet", ".pq"):
        return asked.samples(read_parquet(path, joints), "Parquet")
    return asked.samples(read_csv(path, joints), "CSV")


def factors_of(units: Sequence[str], count: int, name: str) -> Array:
    """Size of each joint's unit in rad or m.

    Raises
    ------
    CaseError
        If the number of units is neither one nor that of the joints.
    """
    if len(units) not in (1, count):
        raise CaseError(
            name, "--units", f"{len(units)} units for {count} joints; give 1 or {count}"
        )
    return np.array([float(scale(one).bounds[0]) for one in _each(units, count)])


def _each(units: Sequence[str], count: int) -> tuple[str, ...]:
    return tuple(units) * (count if len(units) == 1 else 1)


@dataclass(frozen=True)
class _Asked:
    """A file, with what is said of its units and its noise; None where its digits say it."""

    name: str
    units: tuple[str, ...]
    noise: Sequence[float] | None
    time_noise: float | None

    def samples(self, samples: Samples, words: str, controller: bool = False) -> ForeignFile:
        """Samples in rad and m."""
        count, units = len(samples.joints), self.units or ("rad",)
        factors = factors_of(units, count, self.name)
        noise = np.array((0.0,) if self.noise is None else self.noise, dtype=np.float64)
        if noise.size not in (1, count):
            raise CaseError(
                self.name, "--noise", f"{noise.size} numbers for {count} joints; give 1 or {count}"
            )
        given = (samples.position, samples.velocity, samples.acceleration)
        position, velocity, acceleration = (x if x is None else x * factors for x in given)
        assert position is not None
        if not controller:
            self._refuse_wrapped(samples, position, [is_linear(u) for u in _each(units, count)])
        rounded = np.array([samples.rounding.of(order, count) * factors for order in range(3)])
        if self.noise is not None:
            rounded[0] = 0.0
            rounded[:, np.broadcast_to(noise == 0.0, (count,))] = 0.0
        clock = samples.rounding.time if self.time_noise is None else 0.0
        try:
            found = replace(
                samples,
                position=position,
                velocity=velocity,
                acceleration=acceleration,
                noise=noise * factors,
                time_noise=self.time_noise or 0.0,
                rounding=HalfUnits(clock, rounded),
            )
        except TrajgapError as error:
            raise CaseError(self.name, "", str(error)) from None
        return ForeignFile(words, found, _each(units, count), controller)

    def _refuse_wrapped(self, samples: Samples, angles: Array, slides: list[bool]) -> None:
        """Refuse angles of a log that step by a turn, which no joint makes between two samples."""
        steps = np.diff(angles, axis=0)
        turns = np.abs(steps) > np.pi
        # Without the turns it moves gradually, and with them within one turn.
        turns &= np.abs(np.diff(np.unwrap(angles, axis=0), axis=0)).max(axis=0) < _GRADUAL
        turns &= np.ptp(angles, axis=0) <= 2.0 * np.pi * (1.0 + 1e-6)
        turns[:, slides] = False
        if len(steps) > 4 and turns.any():
            k, j = (int(x) for x in np.argwhere(turns)[0])
            raise CaseError(
                self.name,
                f"joint {samples.joints[j]}",
                f"steps by a turn at {samples.time[k + 1]:g} s; if its angles are kept within "
                "±180°, unwrap them (numpy.unwrap)",
            )

    def polynomials(self, found: Mapping[str, Any]) -> ForeignFile:
        """A motion in rad and m."""
        if any(self.noise or ()) or self.time_noise:
            option = "--noise" if any(self.noise or ()) else "--time-noise"
            why = "applies to samples only; polynomials are the motion itself"
            raise CaseError(self.name, option, why)
        motion = motion_of_json(found, self.name)
        in_file, count = _stated_units(self.name, found.get("units", {})), len(motion.joints)
        if in_file and self.units and _each(in_file, count) != _each(self.units, count):
            raise CaseError(
                self.name, "--units", f"the file itself states {', '.join(in_file)}; leave it out"
            )
        units = in_file or self.units or ("rad",)
        factors = factors_of(units, count, self.name)
        motion = replace(motion, scaled=motion.scaled * factors, error=motion.error * factors)
        return ForeignFile("piecewise polynomials", motion, _each(units, count))

    def message(self, found: Any, words: str) -> ForeignFile:
        """The only trajectory of a message."""
        held = list(trajectories(found))
        if not held:
            why = "contains no trajectory; give joint_names and points, or breaks and coefficients"
            raise CaseError(self.name, "", why)
        if len(held) > 1:
            raise CaseError(self.name, "", f"contains {len(held)} trajectories; keep one")
        return self.ros(samples_of_message(held[0], self.name), words)

    def ros(self, samples: Samples, words: str) -> ForeignFile:
        """A trajectory of ROS, which states rad and m."""
        if any(one in ("deg", "cm", "mm") for one in self.units):
            why = "a ROS trajectory is in rad and m; leave --units out"
            raise CaseError(self.name, "--units", why)
        return self.samples(samples, words, controller=True)


def _stated_units(name: str, stated: Any) -> tuple[str, ...]:
    """Units of positions that a file of polynomials states itself."""
    if not isinstance(stated, Mapping) or stated.get("time", "s") != "s":
        raise CaseError(name, "units", 'time is in s; give {"time": "s", "position": ...}')
    position = stated.get("position", [])
    each = position if isinstance(position, list) else [position]
    if not all(isinstance(one, str) and one in UNITS for one in each):
        raise CaseError(name, "units.position", f"is unknown; use {', '.join(UNITS)}")
    return tuple(each)
