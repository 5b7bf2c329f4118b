"""TG208: printed means and integrals of a derivative beside those of the printed motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....problem import QUANTITIES, Array, Printed, Trajectory, fit
from ....problem.cases import AnyClaim, MeasureClaim
from ..printed_row import PrintedRow
from .beside import SAMPLES, Beside, nearest_number

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
"""Gauss-Legendre on -1..1: exact up to degree 19, and squares of declared polynomials have 18."""
_PARTS = 8
"""Parts of each piece beside its zeros: norms, and curves that are no polynomial in time, are
smooth enough there."""
_POWERS = {"mean": (1, 0), "rms": (1, 0), "integral": (1, 1), "integral-square": (2, 1)}
"""Powers of the derivative's unit and of time in each measure."""


NAMES = {
    "mean": "mean absolute value",
    "rms": "root mean square",
    "integral": "integral of the absolute value",
    "integral-square": "integral of the square",
}
"""Each measure in words."""


@dataclass(frozen=True)
class MotionMeasure:
    """A measure of each joint, and of their Euclidean norm."""

    joints: Array
    norm: float

    def meant(self, joint: int | None) -> dict[str, float]:
        """What one printed number may be, in words: that of a joint, or of the robot."""
        if joint is not None:
            return {"": float(self.joints[joint])}
        if len(self.joints) == 1:
            return {"": float(self.joints[0])}
        return {
            " of the norm over the joints": self.norm,
            " of the largest joint": float(self.joints.max()),
            " of the joints in the mean": float(self.joints.mean()),
        }


def measured(trajectory: Trajectory, order: int, measure: str) -> MotionMeasure:
    """A mean or an integral of a derivative of a motion.

    Of each joint it is exact up to float rounding where the pieces are polynomials in time, since
    they are split where the derivative changes its sign.

    Parameters
    ----------
    order : int
        1 for velocity, 2 for acceleration, 3 for jerk.
    measure : str
        A key of `NAMES`.

    Returns
    -------
    MotionMeasure
        rad or m, and s.
    """
    first, square, norm = np.zeros(trajectory.joints), np.zeros(trajectory.joints), 0.0
    for piece in range(len(trajectory.durations)):
        places, shares = _nodes(trajectory, piece, order)
        values = np.array(
            [trajectory.values(piece, j, order, places) for j in range(trajectory.joints)]
        )
        first += np.abs(values) @ shares
        square += values**2 @ shares
        norm += float(np.linalg.norm(values, axis=0) @ shares)
    total = float(trajectory.breaks[-1] - trajectory.breaks[0])
    return _finished(first, square, norm, total, measure)


def _finished(
    first: Array, square: Array, norm: float, total: float, measure: str
) -> MotionMeasure:
    match measure:
        case "mean":
            return MotionMeasure(first / total, norm / total)
        case "rms":
            return MotionMeasure(np.sqrt(square / total), float(np.sqrt(square.sum() / total)))
        case "integral":
            return MotionMeasure(first, norm)
    return MotionMeasure(square, float(square.sum()))


def _nodes(trajectory: Trajectory, piece: int, order: int) -> tuple[Array, Array]:
    """Places of a piece and the time that each stands for."""
    cuts = [np.linspace(0.0, 1.0, _PARTS + 1)]
    for joint in range(trajectory.joints):
        level = np.trim_zeros(trajectory.level(piece, joint, order, 0.0), "b")
        if level.size > 1:
            cuts.append(np.polynomial.polynomial.polyroots(level).real)
    ends = np.unique(np.clip(np.concatenate(cuts), 0.0, 1.0))
    middle, half = (ends[1:] + ends[:-1]) / 2, (ends[1:] - ends[:-1]) / 2
    places = (middle[:, None] + half[:, None] * _NODES).ravel()
    # Time is a polynomial of degree 3 at most over a piece.
    four = np.linspace(0.0, 1.0, 4)
    clock = np.polynomial.Polynomial.fit(four, trajectory.times(piece, four), 3)
    return places, (half[:, None] * _WEIGHTS).ravel() * clock.deriv()(places)


def sampled(trajectory: Trajectory, order: int, measure: str) -> list[MotionMeasure]:
    """The same from samples, as programs take it: one for each number of samples."""
    start, end = trajectory.breaks[0], trajectory.breaks[-1]
    found = []
    for count in SAMPLES:
        for whole in (True, False):
            times = np.linspace(start, end, count, endpoint=whole)
            values = trajectory(times, order)
            total = float(end - start)
            first, square = (x.mean(axis=0) * total for x in (np.abs(values), values**2))
            norm = float(np.linalg.norm(values, axis=1).mean()) * total
            found.append(_finished(first, square, norm, total, measure))
    return found


def measure_beside(
    row: PrintedRow[AnyClaim], claim: MeasureClaim, printed: Printed, joint: str | None
) -> Beside | None:
    """A printed number beside the measure that it is nearest to, of those that it may be."""
    problem = row.posed()
    if joint is not None and joint not in problem.joints:
        return None
    order = QUANTITIES.index(claim.derivative) + 1
    index = None if joint is None else problem.joints.index(joint)
    own, by_time = _POWERS[claim.measure]
    unit = row.in_units(claim.derivative, 1.0, joint) ** own
    unit *= row.in_units("time", 1.0) ** by_time
    shown = row.unit(claim.derivative, joint)
    shown = shown if own == 1 else f"({shown})²"
    shown += f"·{row.study.time_unit}" if by_time else ""

    def meant(waypoints: Array, durations: Array) -> dict[str, float]:
        trajectory = fit(problem.curve, waypoints, durations)
        found = measured(trajectory, order, claim.measure).meant(index)
        return {words: unit * value for words, value in found.items()}

    coarse = sampled(row.motion, order, claim.measure)
    samples = [{words: unit * x for words, x in one.meant(index).items()} for one in coarse]
    return nearest_number(printed, shown, joint, meant, samples, row.boxes)


def measure_described(row: PrintedRow[AnyClaim], claim: MeasureClaim, one: Beside) -> str:
    """One printed measure beside that of the motion."""
    whose = one.meaning if one.joint is None else f" of joint {one.joint}"
    return one.told(f"the {NAMES[claim.measure]} of {claim.derivative}{whose}")
