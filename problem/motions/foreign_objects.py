"""Motions held by objects of other libraries, known by what they offer: nothing is imported."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import TrajgapError
from .interpolation import interpolated
from .motion import Motion
from .ros import plain_message, samples_of_message, trajectories
from .samples import Interpolation


def as_motion(given: Any, joints: Sequence[str] = ()) -> Motion:
    """The exact motion of an object of scipy, TOPPRA, Ruckig, Drake or ROS, or of a `Trajectory`.

    Parameters
    ----------
    given : object
        scipy's ``PPoly``, ``CubicSpline``, ``BPoly`` or ``BSpline``; TOPPRA's
        ``SplineInterpolator``, ``ParametrizeSpline`` or ``ParametrizeConstAccel``; Ruckig's
        ``Trajectory``; Drake's ``PiecewisePolynomial`` or ``BsplineTrajectory``; a message
        ``JointTrajectory`` of ROS, or any message with one as plain values, as the controller
        follows it; or the result of `fit`.
    joints : sequence of str, optional
        Labels; "1", "2", ... by default. A message contains its own names.

    Raises
    ------
    TrajgapError
        If it is none of them, or not a polynomial in time on each piece.
    """
    if isinstance(given, Motion):
        return given
    for applies, read in _KINDS:
        if applies(given):
            return read(given, joints)
    raise TrajgapError(
        f"{type(given).__name__} is not a motion known here; give scipy's PPoly, or Samples of it"
    )


def _has(*names: str) -> Callable[[Any], bool]:
    return lambda one: all(hasattr(one, name) for name in names)


def _ppoly(given: Any, joints: Sequence[str]) -> Motion:
    return Motion.of_polynomial(given, joints, f"the polynomials of {type(given).__name__}")


def _bernstein(given: Any, joints: Sequence[str]) -> Motion:
    from scipy.interpolate import PPoly

    return _ppoly(PPoly.from_bernstein_basis(given), joints)


def _b_spline(given: Any, joints: Sequence[str]) -> Motion:
    """From a B-spline: its own interval alone, and no piece of length 0."""
    from scipy.interpolate import BSpline, PPoly

    if np.ndim(given.c) > 2:
        raise TrajgapError("B-spline: give one value per joint, not a table of them")
    spline = BSpline(given.t, np.asarray(given.c, dtype=np.float64), int(given.k))
    degree, knots = int(given.k), np.asarray(given.t, dtype=np.float64)
    inside = np.unique(knots[degree : knots.size - degree])
    columns = spline.c.reshape(spline.c.shape[0], -1)
    parts = [PPoly.from_spline((knots, columns[:, j], degree)) for j in range(columns.shape[1])]
    kept = np.searchsorted(parts[0].x, inside[:-1], side="right") - 1
    coefficients = np.stack([part.c[:, kept] for part in parts], axis=2)
    return Motion.of_polynomial(
        PPoly(coefficients, inside), joints, f"the B-spline of {type(given).__name__}"
    )


def _trajectory(given: Any, joints: Sequence[str]) -> Motion:
    if not given.polynomial_in_time:
        raise TrajgapError("its pieces are not polynomials in time; sample it and give Samples")
    return Motion.of_polynomial(given.polynomial, joints, "the curve of trajgap")


def _toppra_spline(given: Any, joints: Sequence[str]) -> Motion:
    return Motion.of_polynomial(given.cspl, joints, f"the spline of {type(given).__name__}")


def _toppra_steps(given: Any, joints: Sequence[str]) -> Motion:
    """TOPPRA's constant path acceleration: a path's spline of s(t), parabolic between grid points.

    Cut at the grid and at the knots of the path; on each part q(s(t)) is a polynomial of twice the
    degree of the path, at most 6.
    """
    from scipy.interpolate import PPoly

    path = getattr(given._path, "cspl", None)
    if path is None:
        raise TrajgapError("ParametrizeConstAccel: its path is not a spline; sample it")
    grid, clock = np.asarray(given._ss, float), np.asarray(given._ts, float)
    speeds = np.asarray(given._velocities, float)
    powers = path.c.shape[0]
    times, rows = [], []
    for k in range(grid.size - 1):
        length, time = grid[k + 1] - grid[k], clock[k + 1] - clock[k]
        if time <= 0:
            continue
        push = (speeds[k + 1] ** 2 - speeds[k] ** 2) / (2 * length)
        cuts = [0.0]
        # A knot that differs from a grid point by rounding, as 1/3 does, is that grid point: 1e-9
        # is far above rounding, and its cube, by which the motion is off there, far below.
        near = 1e-9 * length
        for knot in path.x[(path.x > grid[k] + near) & (path.x < grid[k + 1] - near)]:
            way = knot - grid[k]
            root = np.sqrt(max(0.0, speeds[k] ** 2 + 2 * push * way))
            at = 2 * way / (speeds[k] + root)
            if cuts[-1] < at < time:
                cuts.append(at)
        for at in cuts:
            place = grid[k] + speeds[k] * at + 0.5 * push * at * at
            middle = place + 2 * near
            piece = int(
                np.clip(np.searchsorted(path.x, middle, side="right") - 1, 0, len(path.x) - 2)
            )
            inner = np.array([place - path.x[piece], speeds[k] + push * at, 0.5 * push])
            rows.append(_composed(path.c[:, piece].reshape(powers, -1), inner))
            times.append(clock[k] + at)
    c = np.stack(rows, axis=1)[::-1]
    return Motion.of_polynomial(
        PPoly(c, np.append(times, clock[-1])), joints, "TOPPRA's constant path acceleration"
    )


def _composed(outer: Array, inner: Array) -> Array:
    """Ascending coefficients of p(u(t)); ``outer`` descending by joint, ``inner`` ascending."""
    size = (outer.shape[0] - 1) * (inner.size - 1) + 1
    total = np.zeros((size, outer.shape[1]))
    power = np.array([1.0])
    for row in outer[::-1]:
        total[: power.size] += power[:, None] * row
        power = np.convolve(power, inner)
    return total


def _ruckig(given: Any, joints: Sequence[str]) -> Motion:
    """Ruckig's profiles: constant jerk on each step, cut where any joint begins a step."""
    from scipy.interpolate import PPoly

    profiles = [list(section) for section in given.profiles]
    ends = [float(x) for x in getattr(given, "intermediate_durations", [])] or [given.duration]
    begins = [0.0, *ends[:-1]]
    cuts = {0.0, float(given.duration)}
    for section, begin, end in zip(profiles, begins, ends, strict=True):
        for one in section:
            steps = [*one.brake.t, *one.t] if hasattr(one, "brake") else list(one.t)
            found = begin + np.cumsum(steps)
            cuts |= {float(x) for x in found if begin < x < end}
        cuts.add(float(end))
    times = np.array(sorted(cuts))
    # Steps of rounding's length would be pieces of no meaning.
    short = 1e-12 * max(1.0, times[-1])
    inner = times[:-1][np.append(True, np.diff(times[:-1]) > short)]
    times = np.append(inner[(inner == 0.0) | (times[-1] - inner > short)], times[-1])
    rows = []
    for begin, end in pairwise(times.tolist()):
        middle = 0.5 * (begin + end)
        position, velocity, acceleration, *more = given.at_time(float(middle))
        jerk = more[0] if more and np.ndim(more[0]) else _jerk(given, middle, end)
        q, v, a, j = (
            np.asarray(x, dtype=np.float64) for x in (position, velocity, acceleration, jerk)
        )
        d = begin - middle
        rows.append(
            np.stack(
                [
                    j / 6,
                    a / 2 + j * d / 2,
                    v + a * d + j * d * d / 2,
                    q + v * d + a * d * d / 2 + j * d**3 / 6,
                ]
            )
        )
    return Motion.of_polynomial(PPoly(np.stack(rows, axis=1), times), joints, "Ruckig's profiles")


def _jerk(given: Any, middle: float, end: float) -> Array:
    """Acceleration is linear on a step: its slope."""
    other = middle + 0.25 * (end - middle)
    there, here = given.at_time(float(other))[2], given.at_time(float(middle))[2]
    return np.asarray((np.asarray(there) - np.asarray(here)) / (other - middle), dtype=np.float64)


def _drake_polynomial(given: Any, joints: Sequence[str]) -> Motion:
    from scipy.interpolate import PPoly

    times = np.asarray(given.get_segment_times(), dtype=np.float64)
    rows = []
    for k in range(times.size - 1):
        matrix = np.asarray(given.getPolynomialMatrix(k), dtype=object).reshape(-1)
        rows.append([np.asarray(one.GetCoefficients(), dtype=np.float64) for one in matrix])
    powers = max(one.size for row in rows for one in row)
    c = np.zeros((powers, times.size - 1, len(rows[0])))
    for k, row in enumerate(rows):
        for j, one in enumerate(row):
            c[powers - one.size :, k, j] = one[::-1]
    return Motion.of_polynomial(PPoly(c, times), joints, "Drake's piecewise polynomial")


def _drake_spline(given: Any, joints: Sequence[str]) -> Motion:
    from scipy.interpolate import BSpline

    basis = given.basis()
    points = np.stack([np.asarray(p, dtype=np.float64).reshape(-1) for p in given.control_points()])
    spline = BSpline(np.asarray(basis.knots(), dtype=np.float64), points, int(basis.degree()))
    return _b_spline(spline, joints)


def _message(given: Any, joints: Sequence[str]) -> Motion:
    """A JointTrajectory of ROS: a message, or its plain values, as its controller follows it."""
    held = list(trajectories(given if isinstance(given, Mapping) else plain_message(given)))
    if len(held) != 1:
        raise TrajgapError(f"the message contains {len(held)} trajectories; give one")
    samples = samples_of_message(held[0], "JointTrajectory", text=False)
    if joints and tuple(joints) != samples.joints:
        raise TrajgapError(
            f"joints: the message itself names {', '.join(samples.joints)}; leave them out"
        )
    return interpolated(samples, Interpolation.CONTROLLER)


_KINDS: tuple[tuple[Callable[[Any], bool], Callable[[Any, Sequence[str]], Motion]], ...] = (
    (_has("polynomial", "polynomial_in_time", "scaled"), _trajectory),
    (_has("_path", "_ss", "_velocities", "_ts"), _toppra_steps),
    (_has("cspl"), _toppra_spline),
    (_has("profiles", "at_time", "duration"), _ruckig),
    (_has("getPolynomialMatrix", "get_segment_times"), _drake_polynomial),
    (_has("control_points", "basis"), _drake_spline),
    (_has("c", "t", "k"), _b_spline),
    (lambda one: _has("c", "x")(one) and type(one).__name__ == "BPoly", _bernstein),
    (_has("c", "x"), _ppoly),
    (lambda one: isinstance(one, Mapping) or _has("joint_names", "points")(one), _message),
)
"""What an object offers, to what reads it; the first that fits."""
