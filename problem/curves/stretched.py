"""Curves of a fixed shape in a parameter, each segment stretched linearly in time."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import TrajgapError
from .kind import (
    Asked,
    Curve,
    Enclosed,
    Shape,
    are_durations,
    as_batch,
    as_waypoints,
    masked,
    value_errors,
)
from .peak import Extremum
from .polynomials import derived, tops
from .trajectory import Trajectory


def shape_of(curve: Curve, waypoints: Array) -> Shape:
    """`Curve.shape`, refused where segments are not stretched."""
    form = curve.shape(waypoints)
    if form is None:
        raise TrajgapError(
            f"curve: the segments of {curve.name} are not stretched in time separately, which is "
            "required here"
        )
    return form


def _segment_sides(curve: Curve, waypoints: Array) -> Array:
    """How far q and its derivatives go below 0 and above, shape (segments, 2, 5, joints)."""
    form = shape_of(curve, waypoints - waypoints[0])
    found = np.zeros((curve.segments, 2, 5, waypoints.shape[1]))
    a = form.scaled[:, : form.degree + 1].transpose(1, 0, 2)[:, :, None]
    for r in range(5):
        part = derived(a, r) / form.share[:, None, None] ** r
        for side, sign in enumerate((-1.0, 1.0)):
            np.maximum.at(found[:, side, r], form.segment, tops(part, sign))
    return found


def solve_in_closed_form(curve: Curve, waypoints: ArrayLike, limits: ArrayLike) -> Array:
    """Shortest durations of a stretched curve within limits of derivatives, without a solver.

    With t linear in a segment, v = q′/l, a = q″/l² and so on, and no duration enters another
    segment: the total is least when each is, l = max over joints and orders r of the r-th root of
    max|q⁽ʳ⁾|/limit. Jumps of the velocity between segments are not
    limited by limits inside the segments, and are ignored here.

    Parameters
    ----------
    curve : Curve
        One whose segments are stretched.
    waypoints : array_like, shape (way-points, joints)
        rad.
    limits : array_like, shape (joints, orders)
        Like `Limits.derivatives`; infinite for no limit.

    Returns
    -------
    ndarray, shape (segments,)
        s; 0 for a segment in which nothing that is limited moves, infinite if a joint with
        limit 0 moves.
    """
    bound = np.asarray(limits, dtype=np.float64)
    orders = np.arange(1, 1 + bound.shape[1])
    # Largest |q⁽ʳ⁾| of every segment when its duration is 1 s.
    sides = _segment_sides(curve, as_waypoints(curve, waypoints))[:, :, orders]
    peaks = sides.max(axis=1).transpose(0, 2, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(peaks > 0.0, peaks / bound, 0.0)
    return np.asarray((ratios ** (1.0 / orders)).max(axis=(1, 2)))


class StretchedCurve(Curve):
    """A curve that is known by its `Curve.shape`: a subclass provides that, and these follow."""

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """Pieces of the shape, each over its share of the segment's duration."""
        form = shape_of(self, waypoints)
        lengths = durations[form.segment] * form.share
        found = Trajectory(lengths, form.scaled, (form.degree,) * lengths.size)
        return Enclosed(found, lambda: value_errors(found, form.error))

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """How far each segment goes when its duration is 1 s, which is all that a batch needs."""
        return _segment_sides(self, waypoints)

    def batch_reach(self, values: Array, durations: Array, asked: Asked) -> Array:
        """By one division a segment."""
        h, least, sides = as_batch(self, durations), asked.least, asked.sides
        valid = are_durations(h)
        rate = 1.0 / np.where(valid[:, None], h, 1.0)
        found = asked.room(len(h))
        own = {-1.0: values[:, 0], 1.0: values[:, 1], 0.0: values.max(axis=1)}
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(self.segments):
                for i in range(asked.wanted.shape[1]):
                    scale = rate[:, k, None] ** (least + i)
                    for side, sign in enumerate(sides):
                        top = scale * own[sign][k, least + i]
                        np.fmax(found[:, side, :, i], top, out=found[:, side, :, i])
        return masked(found, asked, valid)

    def by_durations(self, waypoints: Array, durations: Array, points: list[Extremum]) -> Array:
        """Of D/hʳ, which only the segment's own duration h enters."""
        form = shape_of(self, waypoints)
        found = np.zeros((len(points), self.segments))
        for i, e in enumerate(points):
            k = form.segment[e.segment]
            found[i, k] = -e.order * e.value / durations[k]
        return found
