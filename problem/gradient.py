"""Gradients of exact peaks by the envelope theorem: the extremum's place does not contribute."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .peak import Extremum
from .problem import Problem
from .spline import PERM, coefficient_gradient


@dataclass(frozen=True, eq=False)
class PeakGradients:
    """Gradients of the values of some extrema.

    Attributes
    ----------
    durations : ndarray, shape (extrema, segments)
        d value / d duration.
    waypoints : ndarray, shape (extrema, way-points)
        d value / d way-point of the extremum's own joint.
    nodal : ndarray, shape (extrema, free)
        d value / d free derivative of the extremum's own joint.
    """

    durations: NDArray[np.float64]
    waypoints: NDArray[np.float64]
    nodal: NDArray[np.float64]


def peak_gradients(
    problem: Problem,
    durations: NDArray[np.float64],
    points: list[Extremum],
    nodal: NDArray[np.float64] | None = None,
) -> PeakGradients:
    """Gradients of the values at ``points``, extrema of the trajectory of these durations.

    Parameters
    ----------
    problem : Problem
    durations : ndarray, shape (segments,)
    points : list of Extremum
        Local extrema or end points, as `extrema` returns them.
    nodal : ndarray, shape (free, joints), optional

    Returns
    -------
    PeakGradients
    """
    g = coefficient_gradient(problem.interpolant, problem.waypoints, durations, nodal)
    n = problem.segments
    by_duration = np.empty((len(points), n))
    by_waypoint = np.empty((len(points), problem.waypoints.shape[0]))
    by_nodal = np.empty((len(points), problem.interpolant.free))
    powers = np.arange(PERM.shape[0])
    for i, e in enumerate(points):
        basis = PERM[:, e.order] * np.where(
            powers >= e.order, e.s ** np.maximum(powers - e.order, 0), 0.0
        )
        basis = basis / durations[e.segment] ** e.order
        by_duration[i] = g.durations[:, e.segment, :, e.joint] @ basis
        by_duration[i, e.segment] -= e.order * e.value / durations[e.segment]
        by_waypoint[i] = g.waypoints[:, e.segment] @ basis
        by_nodal[i] = g.nodal[:, e.segment] @ basis
    return PeakGradients(by_duration, by_waypoint, by_nodal)
