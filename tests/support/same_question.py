"""The same question in another dress: what every judge has to answer alike."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from trajgap.problem import Array, Curve, Interpolant, Problem

DRESSES = ("as it is", "mirror", "reverse", "slower", "permute", "degrees")
SLOWER = 2.7
OWN_UNITS = "each joint in a unit of its own"


def same_question(name: str, problem: Problem, h: Array) -> tuple[Problem, Array]:
    """The problem mirrored, backwards, slower, its joints in another order, or in other units.

    Bounds and ratios of durations go with it.
    """
    limits, q = problem.limits, problem.waypoints
    sides, low, high = limits.sides, limits.position_lower, limits.position_upper
    if name == "mirror":
        turned = limits.with_sides(sides[::-1]).with_positions(-high, -low)
        curve = ends_of(problem.curve, lambda r, v: -v)
        return replace(problem, waypoints=-q, limits=turned, curve=curve), h
    if name == "reverse":
        # Derivatives of odd order change their sign.
        back = sides.copy()
        back[:, :, ::2] = sides[::-1, :, ::2]
        curve = ends_of(problem.curve, lambda r, v: (-1) ** r * v, back=True)
        turned = limits.with_sides(back)
        ends = {
            key: None if given is None else given[::-1]
            for key in ("duration_lower", "duration_upper", "ratios")
            for given in (getattr(problem, key),)
        }
        return replace(problem, waypoints=q[::-1], limits=turned, curve=curve, **ends), h[::-1]
    if name == "slower":
        slow = limits.with_sides(sides / SLOWER ** np.arange(1, 1 + sides.shape[2]))
        curve = ends_of(problem.curve, lambda r, v: v / SLOWER**r)
        ends = {key: SLOWER * getattr(problem, key) for key in ("duration_lower", "duration_upper")}
        return replace(problem, limits=slow, curve=curve, **ends), SLOWER * h
    if name == "permute":
        order = np.arange(q.shape[1])[::-1]
        turned = limits.with_sides(sides[:, order]).with_positions(low[order], high[order])
        curve = ends_of(problem.curve, lambda r, v: v[order] if v.ndim else v)
        return replace(problem, waypoints=q[:, order], limits=turned, curve=curve), h
    if name in ("degrees", OWN_UNITS):
        first = 180.0 / np.pi if name == "degrees" else 0.8
        scale = np.linspace(first, 180.0 / np.pi, q.shape[1])
        wide = limits.with_sides(sides * scale[:, None]).with_positions(low * scale, high * scale)
        curve = ends_of(problem.curve, lambda r, v: scale * v)
        return replace(problem, waypoints=q * scale, limits=wide, curve=curve), h
    return problem, h


def ends_of(curve: Curve, change: Callable[[int, Array], Array], back: bool = False) -> Curve:
    """The curve with its prescribed derivatives changed, and backwards if asked."""
    if not isinstance(curve, Interpolant):
        return curve

    def changed(order: int, value: object) -> object:
        found = change(order, np.asarray(value, dtype=np.float64))
        return tuple(found.tolist()) if found.ndim else float(found)

    prescribed = tuple(tuple((r, changed(r, v)) for r, v in one) for one in curve.prescribed)
    if not back:
        return replace(curve, prescribed=prescribed)
    count = len(curve.degrees)
    return replace(
        curve,
        degrees=curve.degrees[::-1],
        continuity=curve.continuity[::-1],
        prescribed=prescribed[::-1],
        virtual=tuple(sorted(count - b for b in curve.virtual)),
    )
