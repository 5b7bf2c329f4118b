"""True ranges of a motion: polynomials in fractions, B-splines by scipy; no code of the judge."""

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import accumulate
from typing import Any

import numpy as np
from support import exact_route
from support.exact_motions import Curve
from support.papers import motions
from support.positions import over, position_ratios

from attacks.cases import Array, Asked, NoCurve

ROUNDING = 1e-6
"""What scipy's B-splines may be off by, relative."""
_NEAREST = 1e-4
"""Share of a chord length below which scipy's equations of a B-spline are too ill-conditioned."""


@dataclass(frozen=True)
class Truth:
    """Least and largest value of each derivative, what they may be off by, and jumps at breaks.

    ``ends`` has shape (orders 0 to 3, joints, 2); ``jumps`` of velocity and of acceleration are
    shares of the joint's peak, shape (2, joints).
    """

    ends: Array
    jumps: Array
    error: float

    @property
    def reach(self) -> Array:
        """How far each derivative goes below 0 and above 0, shape (2, joints, 3)."""
        return np.moveaxis(np.maximum(self.ends[1:] * [-1.0, 1.0], 0.0), 0, 1).transpose(2, 0, 1)

    def worst(self, asked: Asked, h: Array) -> float:
        """The largest ratio to a limit; of positions and durations too."""
        bounds = max((asked.duration_lower / h).max(), (h / asked.duration_upper).max())
        return float(max(bounds, over(self.reach, asked.sides).max(), self.positions(asked).max()))

    def positions(self, asked: Asked) -> Array:
        """Ratios to position limits, (joints,)."""
        return position_ratios(self.ends[0], asked.position_lower, asked.position_upper)


def truth(asked: Asked, curve: Any, h: Array) -> Truth:
    """The motion of durations; of a ``curve`` that is declared polynomials, to every digit."""
    from trajgap.problem import as_piecewise

    if not (np.isfinite(h).all() and (h > 0).all()):
        raise NoCurve
    declared = as_piecewise(curve)
    if declared is not None:
        return _exact(asked, declared, h)
    try:
        return _by_scipy(asked, h)
    except motions.NoCurveError:
        raise NoCurve from None


def _exact(asked: Asked, form: Any, h: Array) -> Truth:
    lengths = h.tolist()
    ends, jumps = [], []
    for j, q in enumerate(asked.waypoints.T):
        own = tuple(
            tuple((r, float(np.broadcast_to(v, len(asked.waypoints.T))[j])) for r, v in at)
            for at in form.prescribed
        )
        try:
            pieces = exact_route.fitted(replace(form, prescribed=own), q.tolist(), lengths)
        except StopIteration:
            raise NoCurve from None
        motion = Curve([Fraction(0), *accumulate(map(Fraction, lengths))], pieces)
        ends.append(motion.ranges)
        jumps.append([float(motion.jumps(r)) for r in (1, 2)])
    found = np.array(ends, dtype=float).transpose(1, 0, 2)
    size = np.abs(found[1:3]).max(axis=2)
    return Truth(found, over(np.array(jumps).T, size), 0.0)


def _by_scipy(asked: Asked, h: Array) -> Truth:
    block, way = asked.block, asked.waypoints
    stretched = block.get("time") == "stretched"
    points = [way]
    if block["family"] == "uniform-cubic-b-spline":
        fit = motions.uniform_stretched if stretched else motions.uniform_timed
    else:
        said = block["parameters"]
        if said == "joint-chord":
            points, said = list(way.T[:, :, None]), "chord"
        steps = [h[:, None]] if said == "times" else [np.diff(one, axis=0) for one in points]
        lengths = [np.linalg.norm(one, axis=1) for one in steps]
        if any(one.min() <= _NEAREST * one.sum() for one in lengths):
            raise NoCurve
        fit = motions.clamped(block["degree"], said, stretched, block["knots"])
    found = [fit(one, h) for one in points]
    ends = np.stack([np.concatenate([m.ends(r) for m in found], axis=1).T for r in range(4)])
    # A joint whose way-points are all one stands still: what splines show is rounding.
    still = np.ptp(way, axis=0) == 0
    ends[1:, still] = 0.0
    ends[0, still] = way[0, still][:, None]
    jumps = np.zeros((2, way.shape[1]))
    if stretched:
        own = np.stack([np.concatenate([m.jumps(r) for m in found]) for r in (1, 2)])
        jumps = over(own * ~still, np.abs(ends[1:3]).max(axis=2))
    return Truth(ends, jumps, ROUNDING)
