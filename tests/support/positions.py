"""Problems whose paths swing beyond their way-points, by every kind of curve."""

import numpy as np
from trajgap.problem import Array, Curve, Knots, Limits, Problem, Timing, clamped_readings, curves

WAYPOINTS = np.array([[0.3, -1.0, 2.1], [0.9, -0.55, 2.6], [0.2, 0.35, 1.4], [-0.45, 0.1, 1.9]])
"""Four of three joints, none at 0, each turning at another place."""
_CLAMPED = ((4, Knots.CONTINUED), (5, Knots.WAYPOINTS))
"""Degrees and knots of clamped B-splines: with either, every way to place and to time them."""
CURVES: dict[str, Curve] = {
    "3-5-3": curves.three_five_three(),
    "4-3-4": curves.piecewise((4, 3, 4)),
    "cubic": curves.cubic_spline(3),
    "natural cubic": curves.cubic_spline(3, ((2, 0.0),)),
    "cubic that starts and ends moving": curves.cubic_spline(
        3, ((1, (0.4, -0.3, 0.1)),), ((1, 0.2),)
    ),
    "cubic with virtual way-points": curves.cubic_spline_virtual(4),
    "quintic": curves.quintic_spline(3),
    "rest-to-rest 3": curves.rest_to_rest(3, 3),
    "rest-to-rest 9": curves.rest_to_rest(3, 9),
    "straight lines": curves.piecewise((1, 1, 1), 0, ()),
    "B-spline, stretched": curves.uniform_cubic_b_spline(4, Timing.STRETCHED),
    "B-spline, timed": curves.uniform_cubic_b_spline(4, Timing.TIMED),
    "B-spline, timed, natural": curves.uniform_cubic_b_spline(4, Timing.TIMED, True),
    **{
        one.curve.name: one.curve
        for one in clamped_readings(4)
        if one.curve is not None and (one.curve.degree, one.knots) in _CLAMPED
    },
}
"""Every kind of curve that a case file can declare, through four way-points."""


def limited(curve: Curve, room: float, limits: Limits | None = None) -> Problem:
    """A problem that leaves ``room`` beyond the way-points: joint 1 above, 2 below, 3 on both."""
    low, high = WAYPOINTS.min(axis=0) - room, WAYPOINTS.max(axis=0) + room
    within = (limits or Limits([1.5, 1.8, 2.4], [6.0, 7.0, 9.0])).with_positions(
        [-np.inf, low[1], low[2]], [high[0], np.inf, high[2]]
    )
    return Problem(WAYPOINTS, within, curve, 0.05, 6.0)


_RANGED = Limits([1.1, 1.7], [3.0, 2.2], position_upper=[0.92, 0.38])
SWINGING = Problem(WAYPOINTS[:, :2], _RANGED, curves.cubic_spline(3), 0.05, 6.0)
"""Left beyond the way-points: the shortest cubic spline swings further, some others do not."""


def over(reach: Array, limit: Array) -> Array:
    """Ratios to limits: 0 where nothing moves, inf if a limit of 0 is passed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(reach > 0, reach / limit, 0.0))


def position_ratios(ends: Array, low: Array, high: Array) -> Array:
    """1 at a limit and more beyond, in half ranges; −inf if there is none.

    ``ends`` has the least and the largest position of each joint, shape (joints, 2).
    """
    found = np.full(len(low), -np.inf)
    for limit, excess in ((low, low - ends[:, 0]), (high, ends[:, 1] - high)):
        half = np.where(np.isfinite(high - low), (high - low) / 2, np.maximum(1.0, np.abs(limit)))
        there = np.isfinite(limit)
        beyond = np.sign(excess[there]) * over(np.abs(excess[there]), half[there])
        found[there] = np.maximum(found[there], 1.0 + beyond)
    return found
