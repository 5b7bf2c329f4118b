"""The largest Euclidean norm over the joints: what some papers print as the peak of a motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....problem import Array, Extremum, Trajectory, fit, peak_gradients
from ....problem.cases import Claim
from ..row import Row

_PLACES = 65
"""Places of a piece at which the norm is computed before the largest is refined, where it is no
polynomial in time: many for a curve that turns a few times."""


@dataclass(frozen=True)
class Norm:
    """Largest norm of a derivative over the joints.

    Attributes
    ----------
    largest : float
        At the printed durations and way-points: the true maximum where pieces are polynomials in
        time, else the largest of `_PLACES` values a piece, refined.
    reach : float
        Its first-order change over all values that round to the printed digits.
    """

    largest: float
    reach: float


def largest_norm(row: Row[Claim], order: int) -> Norm:
    """Largest norm of a derivative on a printed motion.

    Parameters
    ----------
    row : Row
    order : int
        1 for velocity, 2 for acceleration, 3 for jerk.

    Returns
    -------
    Norm
    """
    problem = row.posed()
    durations, waypoints = row.boxes
    trajectory = fit(problem.curve, problem.waypoints, durations.value)
    top, piece, s = max(_top(trajectory, k, order) for k in range(len(trajectory.durations)))
    values = _values(trajectory, piece, order, np.array([s]))[:, 0]
    points = [Extremum(j, piece, order, s, 0.0, float(v)) for j, v in enumerate(values)]
    g = peak_gradients(problem, durations.value, points)
    # The norm's gradient weighs each joint's by its share; at the top its place does not count.
    share = values / top if top else np.zeros_like(values)
    by_time = np.abs(share @ g.durations) @ (durations.upper - durations.lower) / 2
    half = (waypoints.upper - waypoints.lower).T / 2
    by_angle = np.sum(np.abs(share[:, None] * g.waypoints) * half)
    return Norm(top, float(by_time + by_angle))


def _values(trajectory: Trajectory, piece: int, order: int, places: Array) -> Array:
    """A derivative at places of a piece, one row per joint."""
    each = [trajectory.values(piece, j, order, places) for j in range(trajectory.joints)]
    return np.asarray(each, dtype=np.float64)


def _top(trajectory: Trajectory, piece: int, order: int) -> tuple[float, int, float]:
    """Largest norm on a piece, and where it is."""

    def norm(places: Array) -> Array:
        found = np.linalg.norm(_values(trajectory, piece, order, places), axis=0)
        return np.asarray(found, dtype=np.float64)

    if trajectory.polynomial_in_time:
        places = _turning(trajectory, piece, order)
    else:
        places = np.linspace(0.0, 1.0, _PLACES)
        k = int(norm(places).argmax())
        around = (places[max(k - 1, 0)], places[min(k + 1, _PLACES - 1)])
        from scipy.optimize import minimize_scalar  # a quarter of a second, and few need it

        best = minimize_scalar(lambda s: -float(norm(np.array([s]))[0]), bounds=around)
        places = np.append(places, best.x)
    values = norm(places)
    k = int(values.argmax())
    return float(values[k]), piece, float(places[k])


def _turning(trajectory: Trajectory, piece: int, order: int) -> Array:
    """Both ends, and every place where the norm can turn: roots of the derivative of its square.

    The square Σ_j q_j² is a polynomial. Real parts of all roots, since rounding moves double ones
    off the axis; a place too many changes no largest value.
    """
    square = np.polynomial.Polynomial([0.0])
    for joint in range(trajectory.joints):
        square += np.polynomial.Polynomial(trajectory.derivative(piece, joint, order)) ** 2
    turns = np.clip(square.deriv().roots().real, 0.0, 1.0)
    return np.concatenate([[0.0, 1.0], turns])
