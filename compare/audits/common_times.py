"""The shortest common time of several axes between states: all arrive at the same instant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from .axis_profile import AxisProfile, AxisState, Phase, Sizes, s_curves, trapezoids
from .rounding import ROUNDING

Axis = tuple[AxisState, AxisState, Sizes]
"""Start, finish and limits of an axis."""
FARTHEST: dict[str, Callable[..., list[AxisProfile]]] = {
    "trapezoidal": trapezoids,
    "s-curve": s_curves,
}
"""The motions of one axis that come farthest in their time, by the name of the profile."""


def synchronised(profile: str, axes: Sequence[Axis]) -> tuple[AxisProfile, ...] | None:
    """Motions of all axes that take the shortest common time; None if there is none.

    An axis in motion may be able to arrive at some times and not at later ones: it is too late to
    arrive slowly, and too early to have turned back. The ways that it can take in a time, from
    one state to another velocity and acceleration, are all between a least and a largest one.
    So the times at which it can arrive end where its way is one of these two, and the shortest
    common time is the time of such a motion of one of the axes.

    Parameters
    ----------
    profile : str
        A key of `FARTHEST`.
    axes : sequence of Axis
        Start, finish and limits of each axis.

    Returns
    -------
    tuple of AxisProfile or None
        One for each axis: that of the axis which decides is its only one, that of others is one of
        many.
    """
    own = [FARTHEST[profile](*axis) for axis in axes]
    times = [[one.total_time for one in every] for every in own]
    if not all(times):
        return None
    earliest = max(map(min, times))
    for time in sorted(one for every in times for one in every if one >= earliest):
        found = [_taking(profile, axis, time, every) for axis, every in zip(axes, own, strict=True)]
        if all(found):
            return tuple(one for one in found if one is not None)
    return None


def _taking(
    profile: str, axis: Axis, time: float, own: Sequence[AxisProfile]
) -> AxisProfile | None:
    """A motion of one axis in a given time; None if it cannot arrive then."""
    for one in own:
        if abs(one.total_time - time) <= ROUNDING * time:
            return one
    start, finish, sizes = axis
    every = FARTHEST[profile](start, finish, sizes, time)
    ends = [one.at(np.inf).position for one in every]
    if not ends or not min(ends) <= finish.position <= max(ends):
        return None
    low, high = every[int(np.argmin(ends))], every[int(np.argmax(ends))]
    share = (finish.position - min(ends)) / (max(ends) - min(ends))
    return _mixed(low, high, share)


def _mixed(low: AxisProfile, high: AxisProfile, share: float) -> AxisProfile:
    """A weighted mean of two motions of the same length from one state."""
    ends = [np.cumsum([0.0, *(phase.time for phase in one.phases)]) for one in (low, high)]
    phases = []
    for begin, until in pairwise(np.unique(np.concatenate(ends))):
        acceleration, jerk = 0.0, 0.0
        for one, times, weight in zip((low, high), ends, (1.0 - share, share), strict=True):
            at = min(int(np.searchsorted(times, (begin + until) / 2.0)), len(one.phases)) - 1
            phase = one.phases[at]
            acceleration += weight * (phase.acceleration + phase.jerk * (begin - times[at]))
            jerk += weight * phase.jerk
        phases.append(Phase(until - begin, acceleration, jerk))
    return AxisProfile(low.start, tuple(phases))
