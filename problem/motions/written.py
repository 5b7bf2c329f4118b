"""Motions written for others: samples as CSV, a JointTrajectory, or polynomials; read back."""

from __future__ import annotations

import io
import json
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import TrajgapError
from ..files import MOST
from .interpolation import interpolated
from .motion import Motion
from .plain_data import parse_json
from .polynomial_file import motion_of_json, polynomial_json
from .ros import message_of_samples, samples_of_message
from .samples import Interpolation, Samples
from .tables import parse_csv


class MotionForm(StrEnum):
    """Formats that motions are written in."""

    CSV = "csv"
    """Rows at a fixed rate: time, position, velocity and acceleration of each joint."""
    ROS = "ros"
    """A JointTrajectory of ROS 2 as JSON, which is YAML too."""
    PPOLY = "ppoly"
    """The polynomials themselves, as JSON."""


class Evaluated(Protocol):
    """A motion that can be evaluated: a `Trajectory`, or a `Motion`."""

    @property
    def breaks(self) -> Array: ...  # noqa: D102
    def __call__(self, time: ArrayLike, order: int = 0) -> Array: ...  # noqa: D102


def sampled(
    motion: Evaluated,
    step: float,
    joints: tuple[str, ...] = (),
    breaks: bool = False,
    whole_nanoseconds: bool = False,
) -> Samples:
    """Samples of a motion: position, velocity and acceleration from its start at 0 s to its end.

    Parameters
    ----------
    step : float
        Step between rows, s; the last row is the end, which may be nearer.
    joints : tuple of str, optional
        Labels; those of the motion, or "1", "2", ....
    breaks : bool
        Whether the motion's breaks are rows too, so quintic Hermite interpolation reproduces a
        motion of degree 5 or less exactly.
    whole_nanoseconds : bool
        Whether times are rounded to whole nanoseconds, as in ROS messages.

    Raises
    ------
    TrajgapError
        If the step is not positive, or the rows are too many.
    """
    begin, end = float(motion.breaks[0]), float(motion.breaks[-1])
    total = end - begin
    if not (np.isfinite(step) and step > 0):
        raise TrajgapError(f"step: {step} is not a time between samples; give seconds, more than 0")
    if total / step > MOST.positions:
        raise TrajgapError(f"step: {total / step:.3g} samples are too many; take a longer step")
    times = _rows(np.asarray(motion.breaks) - begin, step, breaks)
    if whole_nanoseconds:
        # At rest, below 1e-9 rad/s, the end may come a part of a nanosecond late; a motion that
        # continues may not.
        still = not np.abs(np.asarray(motion(end, 1))).max() > 1e-9
        last = (np.ceil if still else np.floor)(total * 1e9)
        whole = np.unique(np.minimum(np.append(np.round(times[:-1] * 1e9), last), last))
        times = whole // 10**9 + 1e-9 * (whole % 10**9)
    at = np.clip(begin + times, begin, end)
    values = [np.asarray(motion(at, order), dtype=np.float64) for order in range(3)]
    if values[0].size > MOST.positions:
        raise TrajgapError(f"step: {times.size} samples are too many; take a longer step")
    named = getattr(motion, "joints", ())
    labels = joints or (named if isinstance(named, tuple) else ())
    return Samples(labels, times, values[0], values[1], values[2])


def _rows(breaks: Array, step: float, all_breaks: bool) -> Array:
    """Times of rows: a grid from 0, its points apart from the times that must be rows."""
    total = float(breaks[-1])
    grid = step * np.arange(int(np.floor(total / step)) + 1)
    fixed = np.unique(np.append(breaks if all_breaks else [], [0.0, total]))
    # Derivatives over a step much shorter than the others drown in the digits of the positions.
    after = np.searchsorted(fixed, grid)
    near = np.minimum(
        np.abs(fixed[np.minimum(after, fixed.size - 1)] - grid),
        np.abs(grid - fixed[np.maximum(after - 1, 0)]),
    )
    return np.asarray(np.unique(np.append(fixed, grid[near > 0.3 * step])))


def csv_text(samples: Samples, units: Array | float = 1.0) -> str:
    """Samples as CSV with the 17 digits that determine a float64.

    Trailing zeros are written too, because the digits of a file determine its uncertainty.

    Parameters
    ----------
    units : float or ndarray, shape (joints,)
        Unit of the written positions, in rad or m; times are in s.

    Raises
    ------
    TrajgapError
        If the name of a joint contains a separator.
    """
    given = [("", samples.position), (" velocity", samples.velocity)]
    given.append((" acceleration", samples.acceleration))
    there = [(word, values) for word, values in given if values is not None]
    head = ["time", *(f"{joint}{word}" for word, _ in there for joint in samples.joints)]
    if any(sign in "".join(head) for sign in ',;\t\n\r#"'):
        raise TrajgapError("joints: a name contains a separator; rename it for CSV")
    table = np.column_stack([samples.time, *(values / units for _, values in there)])
    stream = io.StringIO()
    stream.write(",".join(head) + "\n")
    for row in table.tolist():
        stream.write(",".join(f"{x:.16e}" for x in row) + "\n")
    return stream.getvalue()


def motion_text(
    motion: Evaluated,
    form: MotionForm,
    step: float,
    joints: tuple[str, ...] = (),
    linear: tuple[bool, ...] = (),
) -> str:
    """A motion as the text of a file.

    Parameters
    ----------
    form : MotionForm
        CSV has uniform rows, ROS has the breaks as points too, polynomials need no step.
    step : float
        s.
    linear : tuple of bool, optional
        Whether each joint slides, so polynomials state its positions in m; none by default.

    Raises
    ------
    TrajgapError
        As `sampled`; for polynomials also if the motion is not polynomial.
    """
    if form is MotionForm.CSV:
        return csv_text(sampled(motion, step, joints))
    if form is MotionForm.ROS:
        samples = sampled(motion, step, joints, breaks=True, whole_nanoseconds=True)
        return json.dumps(message_of_samples(samples), indent=1) + "\n"
    from .foreign_objects import as_motion

    return json.dumps(polynomial_json(as_motion(motion, joints), linear)) + "\n"


def read_back(text: str, form: MotionForm, name: str) -> Motion:
    """The motion that a reader obtains from a file, by quintic Hermite polynomials."""
    if form is MotionForm.PPOLY:
        return motion_of_json(parse_json(text.encode(), name), name)
    if form is MotionForm.ROS:
        samples = samples_of_message(parse_json(text.encode(), name), name)
        return interpolated(samples, Interpolation.CONTROLLER)
    return interpolated(parse_csv(text, name), Interpolation.QUINTIC)
