"""Case files drawn from their grammar, with what each of their questions means in rad and s."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from support.toml_text import Bare, toml_text

Rng = np.random.Generator
Array = NDArray[np.float64]
Ends = dict[int, Array]
"""Derivatives at one end by order, in rad and s, one for each joint."""
FAMILIES = (
    "3-5-3",
    "polynomials",
    "cubic-spline",
    "quintic-spline",
    "septic-spline",
    "cubic-spline-virtual",
    "quintic-spline-virtual",
    "rest-to-rest",
    "jtraj",
    "uniform-cubic-b-spline",
    "clamped-b-spline",
)
"""Every family that a case file may name; a test compares with the schema."""
_LATER = ("septic-spline", "quintic-spline-virtual")
"""Families drawn instead of some quintic splines, so the seeds of other draws keep theirs."""
CLAIMS = (
    "durations",
    "maximum",
    "total_time",
    "improvement",
    "peak",
    "measure",
    "value",
    "convergence",
    "conditions",
    "control_vertices",
    "statement",
)
"""Every quantity that a claim may state; a test compares with the schema."""
MEASURES = ("mean", "rms", "integral", "integral-square")
"""Every measure of a motion."""
PLACES = ("start", "finish", "largest", "smallest")
"""Places of a motion that every case has."""
DERIVATIVES = ("velocity", "acceleration", "jerk")
"""Quantities by order of derivative, from 1."""
UNITS = {
    "position": ("rad", "deg"),
    "velocity": ("rad/s", "deg/s"),
    "acceleration": ("rad/s^2", "deg/s^2"),
    "jerk": ("rad/s^3", "deg/s^3"),
    "time": ("s", "ms"),
}
"""Units of each quantity; the first is the one that everything is computed in."""
_DETERMINED: tuple[tuple[tuple[int, ...], int, tuple[int, ...]], ...] = (
    ((4, 3, 4), 2, (1, 2)),
    ((3, 5, 3), 2, (1, 2)),
    ((4, 2, 3), 1, (1,)),
    ((5,), 2, (1, 2)),
    ((3,), 2, (1,)),
    ((4, 4), 2, (1, 2)),
    ((4, 4), 3, (1,)),
    ((3, 3, 3), 2, (1,)),
    ((3, 3), 2, (2,)),
    ((1, 1), 0, ()),
    ((5, 4, 3, 4), 3, (1, 2)),
    ((7,), 2, (1, 2, 3)),
)
"""Degrees, continuity and end orders; what does not count out right is a drawn bad declaration."""


class NoCurve(Exception):
    """The durations define no curve."""


@dataclass(frozen=True)
class Asked:
    """One question in rad and s, as the attacks understand it.

    ``block`` is the interpolant as a case file declares it, its end derivatives in rad and s;
    ``sides`` has the sizes of the limits below 0 and above 0, shape (2, joints, 3), absent ones
    inf. ``ends`` and ``finish`` have the derivatives of the first and the last way-point by order,
    shape (joints,) each.
    """

    block: dict[str, Any]
    waypoints: Array
    sides: Array
    position_lower: Array
    position_upper: Array
    duration_lower: Array
    duration_upper: Array
    labels: tuple[str, ...]
    coupling: str
    ends: Ends
    finish: Ends

    @property
    def segments(self) -> int:
        return len(self.duration_lower)

    @property
    def moving(self) -> bool:
        """Whether some joint has a derivative other than 0 at an end."""
        return any(np.any(v) for v in (*self.ends.values(), *self.finish.values()))


def segments_of(block: dict[str, Any], points: int) -> int:
    """How many durations a family takes for a number of way-points."""
    return points + 1 if block["family"].endswith("-virtual") else points - 1


@dataclass(frozen=True)
class Drawn:
    """A case file, and its questions by (problem, reading) as they were drawn."""

    raw: dict[str, Any]
    asked: dict[tuple[str, str], Asked]

    @property
    def text(self) -> str:
        return toml_text(self.raw)

    @property
    def first(self) -> Asked:
        return next(iter(self.asked.values()))


def draw_family(rng: Rng) -> str:
    """One of all families."""
    name = str(rng.choice([one for one in FAMILIES if one not in _LATER]))
    if name == "quintic-spline" and rng.random() < 0.6:
        name = str(rng.choice(_LATER))
    return name


def draw_block(rng: Rng, family: str, points: int) -> tuple[dict[str, Any], int]:
    """Interpolant of a family, and the number of way-points that it takes."""
    block: dict[str, Any] = {"family": family}
    if family == "3-5-3":
        return block, 4
    if family == "polynomials":
        degrees, continuity, orders = _DETERMINED[rng.integers(len(_DETERMINED))]
        if sum(d + 1 for d in degrees) == _conditions(degrees, continuity, orders):
            block |= {"degrees": list(degrees), "continuity": continuity}
            return block | {"end_orders": list(orders)}, len(degrees) + 1
        block |= {"degrees": [4, 3, 4], "continuity": 2, "end_orders": [1, 2]}
        return block, 4
    if family == "cubic-spline" and rng.random() < 0.3:
        block["end_orders"] = [2]
    if family in ("quintic-spline", "septic-spline"):
        points = max(points, 3)
    if family == "rest-to-rest":
        block["degree"] = int(rng.choice([3, 5, 7, 9]))
    if family == "uniform-cubic-b-spline":
        block["time"] = str(rng.choice(["stretched", "timed"]))
    if family == "clamped-b-spline":
        points = max(points, 4)
        block["knots"] = "averaged-continued" if rng.random() < 0.7 else "waypoints"
        block["degree"] = 5 if block["knots"] == "waypoints" else int(rng.integers(3, 6))
        block["parameters"] = str(rng.choice(["times", "chord", "joint-chord"]))
        if block["parameters"] != "times" and rng.random() < 0.5:
            block["time"] = "stretched"
    return block, points


def _conditions(degrees: tuple[int, ...], continuity: int, orders: tuple[int, ...]) -> int:
    return 2 * len(degrees) + continuity * (len(degrees) - 1) + 2 * len(orders)


def draw_asked(
    rng: Rng,
    family: str | None = None,
    most_points: int = 6,
    most_joints: int = 3,
    bounds: float = 0.3,
    odd: float = 0.25,
    scale: float = 0.0,
) -> Asked:
    """A question in rad and s; ``bounds`` and ``odd`` are chances of bounds and of degeneracy.

    ``scale`` is the largest power of ten by which way-points and limits are off from 1.
    """
    name = family or draw_family(rng)
    block, points = draw_block(rng, name, int(rng.integers(2, most_points + 1)))
    joints = int(rng.integers(1, most_joints + 1))
    segments = segments_of(block, points)
    size = 10 ** rng.uniform(-scale, scale)
    way = rng.uniform(-2, 2, joints) + rng.normal(size=(points, joints)) * rng.uniform(0.3, 2)
    way *= size
    if rng.random() < odd:
        way[:, rng.integers(joints)] = way[0, 0]
    if rng.random() < odd and points > 2:
        k = int(rng.integers(points - 1))
        way[k + 1] = way[k] + (0.0 if rng.random() < 0.5 else 1e-6 * size)
    way = _rounded(way)
    pace = size * 10 ** rng.uniform(-scale, scale)
    kinds = rng.random(3) < (0.8, 0.6, 0.3)
    if not kinds.any():
        kinds[0] = True
    limits = []
    for r, wanted in enumerate(kinds, start=1):
        value = _rounded(pace * rng.uniform(0.5, 3, joints) * 2.0**r)
        if rng.random() < 0.1:
            value[rng.integers(joints)] = np.inf
        limits.append(value if wanted else np.full(joints, np.inf))
    if name == "cubic-spline" and "end_orders" not in block and rng.random() < 0.2:
        block["end_derivatives"] = [float(_rounded(np.array(rng.uniform(-0.3, 0.3) * pace)))]
    # A stream of their own: the trials that draw none of it are the ones that they were.
    own = rng.spawn(1)[0]
    _draw_ends(own, block, joints, pace)
    sides = _draw_sides(own, np.stack(limits, axis=1))
    none = np.full(joints, np.inf)
    asked = Asked(
        block,
        way,
        sides,
        -none,
        none,
        np.zeros(segments),
        np.full(segments, np.inf),
        tuple(str(j + 1) for j in range(joints)),
        str(rng.choice(["shared", "per-joint"])),
        *ends_in(block, joints),
    )
    if rng.random() < bounds:
        asked = _bounded(rng, asked)
    return half_bounded(own, asked)


MOVING = ("polynomials", "cubic-spline", "quintic-spline")
"""Families whose ends may be in motion."""
_OTHER_ORDERS = {(1,): (2,), (2,): (1,), (1, 2): (1, 3), (1, 2, 3): (1, 2, 4)}
"""As many derivatives at the finish, but not the same ones."""


def _draw_ends(rng: Rng, block: dict[str, Any], joints: int, pace: float) -> None:
    """Ends in motion, sometimes: for each joint or for all, at both ends or at one of them."""
    if block["family"] not in MOVING or rng.random() > 0.3:
        return
    orders = tuple(block.get("end_orders", [1] if block["family"] == "cubic-spline" else [1, 2]))

    def values(wanted: tuple[int, ...]) -> list[Any]:
        drawn: list[Any] = []
        for r in wanted:
            size = joints if rng.random() < 0.6 else 1
            each = _rounded(rng.uniform(-0.3, 0.3, size) * pace * 2.0**r * (r < 4))
            each[rng.random(size) < 0.2] = 0.0
            drawn.append(each.tolist() if size == joints and rng.random() < 0.9 else each[0])
        return [x if isinstance(x, list) else float(x) for x in drawn]

    if orders:
        block["end_derivatives"] = values(orders)
    if block["family"] != "quintic-spline" and orders and rng.random() < 0.2:
        block["finish_orders"] = list(_OTHER_ORDERS[orders])
    if rng.random() < 0.5:
        block["finish_derivatives"] = values(tuple(block.get("finish_orders", orders)))


def ends_in(block: dict[str, Any], joints: int) -> tuple[Ends, Ends]:
    """Derivatives of each joint at the first and at the last way-point, in units of the block."""
    orders = block.get("end_orders", [1] if block["family"] == "cubic-spline" else [1, 2])
    start = block.get("end_derivatives", [])
    own = "finish_orders" in block or "finish_derivatives" in block
    last = block.get("finish_derivatives", []) if own else start
    found = (
        {
            r: np.array(np.broadcast_to(np.asarray(v, dtype=float), (joints,)))
            for r, v in zip(which, values, strict=False)
        }
        for which, values in ((orders, start), (block.get("finish_orders", orders), last))
    )
    return next(found), next(found)


def _draw_sides(rng: Rng, limits: Array) -> Array:
    """Sizes of lower limits, which differ from the upper ones sometimes, and of these."""
    if rng.random() > 0.25:
        return np.stack([limits, limits])
    drawn = np.where(np.isfinite(limits), limits, 1.0) * rng.uniform(0.3, 2.0, limits.shape)
    drawn[rng.random(limits.shape) < 0.1] = np.inf
    kept = rng.random(limits.shape) < 0.4
    # No side of a derivative that nothing limits: the file leaves its key out.
    kept |= ~np.isfinite(limits).any(axis=0)
    return np.stack([np.where(kept, limits, _rounded(drawn)), limits])


def half_bounded(rng: Rng, asked: Asked) -> Asked:
    """Position limits of some joints alone, or on one side alone, sometimes."""
    low, high = asked.position_lower.copy(), asked.position_upper.copy()
    low[rng.random(len(low)) < 0.2] = -np.inf
    high[rng.random(len(high)) < 0.2] = np.inf
    if rng.random() < 0.7:
        return asked
    return replace(asked, position_lower=low, position_upper=high)


def _bounded(rng: Rng, asked: Asked) -> Asked:
    if rng.random() < 0.5:
        return fenced(rng, asked)
    try:
        h = near_limits(rng, problem_of(alone(asked)), 1.0)
    except NoCurve:
        return asked
    lower = _rounded(h * rng.uniform(0.2, 1.0, len(h)))
    upper = _rounded(h * rng.uniform(1.0, 3.0, len(h)))
    if rng.random() < 0.4:
        lower = np.zeros(len(h))
    return replace(asked, duration_lower=lower, duration_upper=upper)


def fenced(rng: Rng, asked: Asked) -> Asked:
    """The question with position limits around its way-points."""
    span = np.ptp(asked.waypoints, axis=0) + 0.1
    wide = span * rng.uniform(0.0, 0.5)
    return replace(
        asked,
        position_lower=_rounded(asked.waypoints.min(axis=0) - wide),
        position_upper=_rounded(asked.waypoints.max(axis=0) + wide),
    )


def problem_of(drawn: Drawn, pair: tuple[str, str] = ("main", "as-printed")) -> Any:
    """What the case file poses."""
    from trajgap.problem import parse_case

    return parse_case(drawn.text, "case.toml").problem(*pair)


def near_limits(rng: Rng, problem: Any, spread: float, ratio: float = 1.0) -> Array:
    """Random durations, stretched so that the largest ratio to a limit is about ``ratio``."""
    from trajgap.problem import TrajgapError, evaluate

    for _ in range(8):
        h = 2.0 ** rng.uniform(-spread, spread, problem.curve.segments)
        try:
            for _ in range(3):
                stretch = float(evaluate(problem, h[None]).stretch[0])
                # Nothing that is limited moves: any duration does.
                h = h * (stretch or 1.0) / ratio ** (1 / 2)
        except TrajgapError:
            continue
        if np.isfinite(h).all() and (h > 0).all() and 1e-9 < h.min() <= h.max() < 1e9:
            return _rounded(h)
    raise NoCurve


def _rounded(values: Array) -> Array:
    """The same numbers with six digits, so text and float mean one number."""
    return np.array([float(f"{x:.6g}") for x in np.ravel(values)]).reshape(np.shape(values))


def raw_of(asked: Asked, name: str = "drawn") -> dict[str, Any]:
    """A case file that poses one question and nothing else, every number exact."""

    def exact(values: Array) -> Any:
        return [Bare(repr(float(x))) for x in values]

    limits: dict[str, Any] = {}
    for r, key in enumerate(DERIVATIVES):
        low, high = asked.sides[:, :, r]
        if np.isfinite([low, high]).any():
            pairs = zip(exact(-low), exact(high), low != high, strict=True)
            limits[key] = [[a, b] if uneven else b for a, b, uneven in pairs]
    for key in ("position_lower", "position_upper"):
        if np.isfinite(getattr(asked, key)).any():
            limits[key] = exact(getattr(asked, key))
    durations: dict[str, Any] = {}
    if asked.duration_lower.any():
        durations["lower"] = exact(asked.duration_lower)
    if np.isfinite(asked.duration_upper).any():
        durations["upper"] = exact(asked.duration_upper)
    return {
        "format": 1,
        "id": name,
        "title": "drawn",
        "coupling": asked.coupling,
        "source": {},
        "robot": {"name": "r", "joints": list(asked.labels)},
        "units": {key: words[0] for key, words in UNITS.items()},
        "waypoints": {"joint_rows": [exact(row) for row in asked.waypoints.T]},
        "limits": limits,
        "durations": durations,
        "interpolant": asked.block,
    }


def alone(asked: Asked, name: str = "drawn") -> Drawn:
    """A case file with one question."""
    return Drawn(raw_of(asked, name), {("main", "as-printed"): asked})
