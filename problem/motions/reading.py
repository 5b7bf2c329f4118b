"""A file with a motion of whatever format, known by its ending and its keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..units import scale
from .motion import Motion
from .plain_data import read_json, read_yaml
from .polynomial_file import motion_of_json
from .ros import samples_of_message, trajectories
from .samples import Samples
from .tables import read_csv, read_parquet

UNITS = ("rad", "deg", "m", "cm", "mm")
"""Units of positions in a file without units of its own."""


@dataclass(frozen=True, eq=False)
class ForeignFile:
    """What a file holds.

    Attributes
    ----------
    format : str
        In words.
    content : Samples or Motion
        rad (m), s.
    units : tuple of str
        Of each joint, in the file and for what is printed.
    controller : bool
        Whether a controller's interpolation is known: ROS trajectories.
    """

    format: str
    content: Samples | Motion
    units: tuple[str, ...]
    controller: bool = False

    @property
    def joints(self) -> tuple[str, ...]:
        """Labels of the joints."""
        return self.content.joints


def read_motion(
    path: Path,
    units: Sequence[str] = ("rad",),
    noise: Sequence[float] = (0.0,),
    joints: Sequence[str] = (),
    topic: str | None = None,
) -> ForeignFile:
    """Read a motion from a file.

    Parameters
    ----------
    path : Path
        CSV or text, ``.parquet``, ``.json`` (polynomials, or a JointTrajectory), ``.yaml``
        (JointTrajectory), ``.bag``, ``.mcap``, ``.db3`` or the folder of a rosbag.
    units : sequence of str
        One for all joints, or one each: of tables and polynomials. ROS has rad and m.
    noise : sequence of float
        What positions may be off by, in those units; one, or one each.
    joints : sequence of str, optional
        Names, for a table without a header.
    topic : str, optional
        Of a rosbag with several trajectories.

    Returns
    -------
    ForeignFile

    Raises
    ------
    CaseError
        If it cannot be read as a motion.
    """
    name, ending = str(path), path.suffix.lower()
    for one in units:
        if one not in UNITS:
            raise CaseError("--units", "", f"{one!r} is unknown; use {', '.join(UNITS)}")
    if ending in (".bag", ".mcap", ".db3") or path.is_dir():
        from .rosbag import read_rosbag

        return _ros(name, read_rosbag(path, topic), units, noise, "ROS bag")
    if ending in (".yaml", ".yml"):
        return _message(name, read_yaml(path), units, noise, "ROS JointTrajectory, YAML")
    if ending == ".json":
        found = read_json(path)
        if isinstance(found, Mapping) and (
            "coefficients" in found or ("c" in found and "x" in found)
        ):
            return _polynomials(name, found, units, noise)
        return _message(name, found, units, noise, "ROS JointTrajectory, JSON")
    parquet = ending in (".parquet", ".pq")
    samples = (read_parquet if parquet else read_csv)(path, joints)
    factors = factors_of(units, len(samples.joints), name)
    return ForeignFile(
        "Parquet" if parquet else "CSV",
        _scaled(name, samples, factors, noise),
        _each(units, len(samples.joints)),
    )


def factors_of(units: Sequence[str], count: int, name: str) -> Array:
    """What a number of each joint is in rad or m.

    Raises
    ------
    CaseError
        If there are neither one nor as many units as joints.
    """
    if len(units) not in (1, count):
        raise CaseError(
            name, "--units", f"{len(units)} units for {count} joints; give 1 or {count}"
        )
    return np.array([float(scale(one).bounds[0]) for one in _each(units, count)])


def _each(units: Sequence[str], count: int) -> tuple[str, ...]:
    return tuple(units) * (count if len(units) == 1 else 1)


def _scaled(name: str, samples: Samples, factors: Array, noise: Sequence[float]) -> Samples:
    count = len(samples.joints)
    if len(noise) not in (1, count):
        raise CaseError(
            name, "--noise", f"{len(noise)} numbers for {count} joints; give 1 or {count}"
        )
    given = (samples.position, samples.velocity, samples.acceleration)
    position, velocity, acceleration = (x if x is None else x * factors for x in given)
    assert position is not None
    try:
        return replace(
            samples,
            position=position,
            velocity=velocity,
            acceleration=acceleration,
            noise=np.asarray(noise, dtype=np.float64) * factors,
        )
    except TrajgapError as error:
        raise CaseError(name, "", str(error)) from None


def _polynomials(
    name: str, found: Mapping[str, Any], units: Sequence[str], noise: Sequence[float]
) -> ForeignFile:
    if any(noise):
        raise CaseError(name, "--noise", "is of samples; polynomials are the motion itself")
    stated = found.get("units", {})
    position = stated.get("position") if isinstance(stated, Mapping) else None
    each: list[Any] = position if isinstance(position, list) else [position]
    if each and all(one in UNITS for one in each):
        units = tuple(each)
    motion = motion_of_json(found, name)
    factors = factors_of(units, len(motion.joints), name)
    return ForeignFile(
        "piecewise polynomials",
        replace(motion, scaled=motion.scaled * factors),
        _each(units, len(motion.joints)),
    )


def _message(
    name: str, found: Any, units: Sequence[str], noise: Sequence[float], words: str
) -> ForeignFile:
    held = list(trajectories(found))
    if not held:
        raise CaseError(
            name, "", "holds no trajectory; give joint_names and points, or breaks and coefficients"
        )
    if len(held) > 1:
        raise CaseError(name, "", f"holds {len(held)} trajectories; keep one")
    return _ros(name, samples_of_message(held[0], name), units, noise, words)


def _ros(
    name: str, samples: Samples, units: Sequence[str], noise: Sequence[float], words: str
) -> ForeignFile:
    if any(one in ("deg", "cm", "mm") for one in units):
        raise CaseError(name, "--units", "a ROS trajectory is in rad and m; leave --units out")
    count = len(samples.joints)
    return ForeignFile(
        words,
        _scaled(name, samples, factors_of(units, count, name), noise),
        _each(units, count),
        True,
    )
