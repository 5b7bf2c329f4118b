"""The shortest time along a fixed path, for all paths that printed points leave open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...nlp.retiming import PathTime, bound_along, largest_derivatives
from ...problem import Array, CaseError, Trajectory, fit
from ...problem.cases import AnyClaim, Digits, TotalTimeClaim
from .printed_row import PrintedRow
from .study import Study

GRID = 0.01
"""Share of a time that a planner's grid or sampling may explain, and up to which two bounds are
near each other: on its usual grids TOPPRA misses the shortest time by up to 0.4 %."""
_FEWEST = 20
"""Sampled points from which two interpolations differ by little on a smooth path."""
_RESERVE = 2.0
"""How many times as far as a quintic spline the sampled path may lie from the cubic one."""


def path_time(row: PrintedRow[TotalTimeClaim]) -> PathTime:
    """Bounds on the shortest time along the path of a claim, however the digits were rounded."""
    return row.study.once(("along path", row.pair, row.claim.path), lambda: _bounded(row))


def close(row: PrintedRow[TotalTimeClaim]) -> bool:
    """Whether both bounds are near each other, or as far apart as the digits of limits open them.

    Times scale as the inverse of a factor on all velocities whose square is on all accelerations.
    """
    plain, loose, tight = (
        row.posed(digits).limits.derivatives[:, :2]
        for digits in (Digits.PRINTED, Digits.LOOSEST_CUT, Digits.TIGHTEST)
    )
    with np.errstate(invalid="ignore"):
        factors = [np.nanmax((a / b) ** [1.0, 0.5]) for a, b in ((loose, plain), (plain, tight))]
    best = path_time(row)
    return best.upper <= (1.0 + GRID) * float(np.prod(factors)) * best.lower


def outside(row: PrintedRow[TotalTimeClaim]) -> float:
    """How far a printed total lies outside the bounds, as a share; below 0 if it is shorter."""
    best, number = path_time(row), row.time(row.claim.value)
    ends = number.cut_off()
    if ends.upper < best.lower:
        return number.value / best.lower - 1.0
    if ends.lower > best.upper:
        return number.value / best.upper - 1.0
    return 0.0


def along_paths(study: Study, claims: Sequence[AnyClaim]) -> str:
    """How far the shortest printed total along each path is from the shortest time."""
    parts = []
    along = [c for c in claims if isinstance(c, TotalTimeClaim) and c.along_path]
    for pair in study.pairs:
        own = [c for c in along if c.problem in (None, pair.problem)]
        rows = [PrintedRow(study, c, pair) for c in own if pair.reading == study.main_reading]
        if rows and path_time(rows[0]).why is None:
            row = min(rows, key=lambda one: one.time(one.claim.value).value)
            away = outside(row)
            far = f"{100 * abs(away):.2f} % {'below' if away < 0 else 'above'}" if away else "near"
            parts.append(f"{row.claim.value} {study.time_unit} is {far}")
    where = "their paths" if len(parts) > 1 else "the path"
    return f"Along {where}, {' and '.join(parts)} the shortest time." if parts else ""


def _bounded(row: PrintedRow[TotalTimeClaim]) -> PathTime:
    problem, statement = row.study.problem(row.pair), row.statement
    shares = problem.shares
    assert shares is not None  # the case file states ratios, or is refused
    if statement.loose_ratios or not problem.curve.homogeneous or problem.curve.free:
        return PathTime(why="ratios, way-points and ends at rest do not settle the path")
    row.study.progress("the shortest time along a path")
    trajectory = fit(problem.curve, problem.waypoints, shares)
    box = row.waypoint_box(problem).or_cut_off()
    reach = np.maximum(box.upper - box.value, box.value - box.lower)
    sampled = row.claim.path == "sampled"
    if sampled and len(reach) < _FEWEST:
        return PathTime(why=f"fewer than {_FEWEST} points sample the path")
    size = trajectory.path.durations.size
    plain = trajectory.polynomial_in_time and size == problem.segments
    if not plain and (sampled or reach.any()):
        return PathTime(why="the curve has other pieces than segments between way-points")
    radius = np.zeros((2, size, trajectory.joints))
    if reach.any():
        # By how much a way-point moves q′ and q″: those of the curve through 0 and a single 1.
        single = fit(problem.curve, np.eye(len(reach)), shares)
        radius += [each @ reach for each in largest_derivatives(single)]
    if sampled:
        away = _less_other(trajectory, problem.waypoints)
        radius += [_RESERVE * each for each in largest_derivatives(away)]
    try:
        tightest = row.posed(Digits.TIGHTEST).limits
    except CaseError as error:
        return PathTime(why=str(error))
    loosest = row.posed(Digits.LOOSEST_CUT).limits
    return bound_along(trajectory, loosest, tightest, (radius[0], radius[1]))


def _less_other(trajectory: Trajectory, waypoints: Array) -> Trajectory:
    """The difference to a spline of another degree through the same points at the same times."""
    from scipy.interpolate import make_interp_spline  # half a second, and few need it

    degree = 3 if max(trajectory.degrees) > 3 else 5
    other = make_interp_spline(trajectory.breaks, waypoints, k=degree)
    scaled = np.zeros(
        (trajectory.durations.size, max(6, trajectory.scaled.shape[1]), trajectory.joints)
    )
    scaled[:, : trajectory.scaled.shape[1]] = trajectory.scaled
    scale = np.ones((trajectory.durations.size, 1))
    for p in range(degree + 1):
        scaled[:, p] -= other(trajectory.breaks[:-1], nu=p) * scale
        scale = scale * trajectory.durations[:, None] / (p + 1)
    return Trajectory(trajectory.durations, scaled, trajectory.degrees)
