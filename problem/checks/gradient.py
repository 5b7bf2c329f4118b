"""Gradients of exact peaks by the envelope theorem: the extremum's place does not contribute."""

from __future__ import annotations

from ..arrays import Array
from ..curves import Extremum, PeakGradients
from ..problem import Problem


def peak_gradients(
    problem: Problem,
    durations: Array,
    points: list[Extremum],
    nodal: Array | None = None,
) -> PeakGradients:
    """Gradients of the values at ``points``, extrema of the trajectory of these durations.

    Parameters
    ----------
    durations : ndarray, shape (segments,)
    points : list of Extremum
        Local extrema or end points, as `extrema` returns them.
    nodal : ndarray, shape (free, joints), optional

    Returns
    -------
    PeakGradients
        With respect to the way-points, with everything else fixed, including parameters from
        chords.
    """
    return problem.curve.value_gradients(problem.waypoints, durations, points, nodal)
