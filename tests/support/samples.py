"""Shifted, unequal problems: of every declaration, of sizes that papers pose, of many segments."""

from collections.abc import Callable

import numpy as np
from trajgap.problem import Interpolant, Limits, Problem, curves

DECLARATIONS: dict[str, Interpolant] = {
    "3-5-3": curves.three_five_three(),
    "4-3-4": curves.piecewise((4, 3, 4)),
    "cubic": curves.cubic_spline(4),
    "cubic, moving ends": curves.cubic_spline(3, ((1, 0.25),)),
    "cubic, virtual": curves.cubic_spline_virtual(3),
    "quintic": curves.quintic_spline(3),
    "rest 3": curves.rest_to_rest(2, 3),
    "rest 5": curves.rest_to_rest(2, 5),
    "rest 7": curves.rest_to_rest(1, 7),
    "4-2-3": curves.piecewise((4, 2, 3), 1),
    "3-1-3": curves.piecewise((3, 1, 3), 1, ((1, 0.0),)),
    "4-1-4": curves.piecewise((4, 1, 4), 2, ((1, 0.0),)),
    "lines": curves.piecewise((1, 1), 0, ()),
    "uneven": Interpolant(
        (4, 6, 3), (3, 2), (((1, 0.0), (2, 0.0)), ((1, -0.3),), (), ((1, 0.2), (2, 0.5)))
    ),
}
"""Determined declarations, one of each kind, and some that nobody prints."""

FREE: dict[str, Interpolant] = {
    "5-5-5 C2": curves.piecewise((5, 5, 5), 2),
    "5-4-5 C2": curves.piecewise((5, 4, 5), 2),
    "6-6 C3": curves.piecewise((6, 6), 3),
    "virtual quintics": Interpolant(
        (5, 5, 5), (4, 4), (((1, 0.0),), (), (), ((1, 0.0),)), virtual=(1,)
    ),
}
"""Under-determined declarations, completed by nodal derivatives."""


def drawn_limits(rng: np.random.Generator, joints: int) -> Limits:
    return Limits(*(rng.uniform(*span, joints) for span in ((1, 4), (2, 9), (20, 90))))


def sample_problem(
    interpolant: Interpolant,
    seed: int,
    joints: int = 3,
    limits: Limits | None = None,
    **changes: object,
) -> tuple[Problem, np.ndarray]:
    """Random problem with offsets and unequal joints, and a random duration vector."""
    rng = np.random.default_rng(seed)
    count = len(interpolant.waypoint_breaks)
    spread = rng.uniform(0.2, 2.0, joints)
    waypoints = rng.normal(size=(count, joints)) * spread + rng.uniform(-3, 3, joints)
    if limits is None:
        limits = drawn_limits(rng, joints)
    durations = rng.uniform(0.3, 2.0, interpolant.segments)
    return Problem(waypoints, limits, interpolant, **changes), durations  # type: ignore[arg-type]


FAMILIES: dict[str, Callable[[int], Interpolant]] = {
    "3-5-3": lambda n: curves.three_five_three(),
    "4-3-4": lambda n: curves.piecewise((4, 3, 4), 2),
    "C2 cubic": curves.cubic_spline,
    "C4 quintic": curves.quintic_spline,
    "septic": lambda n: curves.rest_to_rest(n, 7),
}
"""Declarations by name, for a number of segments where it is theirs to choose."""


def small_problem(family: str, seed: int) -> Problem:
    """A problem of a family; some have a position range or bounds on the durations."""
    generator = np.random.default_rng([seed, len(family)])
    curve = FAMILIES[family](int(generator.integers(2, 5)))
    joints = int(generator.integers(1, 5))
    q = generator.normal(size=(curve.segments + 1, joints))
    limits = generator.uniform(0.5, 3.0, (3, joints)) * np.array([[1.0], [2.0], [8.0]])
    limits[generator.integers(3)] = np.inf
    low, high = -np.inf, np.inf
    if generator.random() < 0.3:
        span = np.ptp(q, axis=0)
        low, high = q.min(axis=0) - 0.2 * span, q.max(axis=0) + 0.2 * span
    lower = generator.uniform(0.2, 1.0) if generator.random() < 0.4 else 0.0
    return Problem(q, Limits(*limits, low, high, joints=joints), curve, duration_lower=lower)


WALK_LIMITS = Limits([1.5, 3.0], [6.0, 15.0], [np.inf, 90.0])


def long_curves(segments: int) -> dict[str, Interpolant]:
    return {
        "cubic": curves.cubic_spline(segments),
        "quintic": curves.quintic_spline(segments),
        "virtual": curves.cubic_spline_virtual(segments - 1),
        "degrees of two kinds": curves.piecewise((4, *(3,) * (segments - 2), 4), 2),
        "moving ends": curves.cubic_spline(segments, ((1, 0.25),)),
        "ends apart": curves.cubic_spline(segments, ((1, (0.25, -0.4)),), ((1, (-0.1, 0.3)),)),
    }


def long_problem(
    curve: Interpolant, seed: int = 3, limits: Limits = WALK_LIMITS, **bounds: object
) -> Problem:
    rng = np.random.default_rng(seed)
    count = len(curve.waypoint_breaks)
    q = np.cumsum(rng.normal(size=(count, 2)) * [0.4, 0.9], axis=0) - 5.0
    return Problem(q, limits, curve, **bounds)  # type: ignore[arg-type]
