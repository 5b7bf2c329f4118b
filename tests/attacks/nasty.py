"""Valid problems that are nasty: scales, coincidences, bounds and sides where solvers give up."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from support.benchmarks import loaded

from attacks.attack import Attack, demand, keep
from attacks.cases import Array, Rng

BEATEN = 1e-4
"""By how much, relative, known durations must beat an answer before that counts."""
OFFSPRING, ROUNDS = 48, 25
"""Random steps from the durations that are known, and how often, in batches on exact totals."""
FAMILIES = (
    "3-5-3",
    "4-3-4",
    "cubic",
    "natural",
    "quintic",
    "septic",
    "cubic-virtual",
    "quintic-virtual",
    "rest",
    "5-3-5",
)
"""Curves whose derivatives are all determined."""


def _curve(rng: Rng, family: str, points: int, moving: bool, joints: int) -> Any:
    """A curve through so many way-points; of some families, with ends in motion."""
    from trajgap import problem as p

    n = points - 1
    first = tuple(rng.normal(size=joints).tolist()) if moving else 0.0
    ends = ((1, first), (2, 0.0))
    match family:
        case "3-5-3":
            return p.three_five_three()
        case "4-3-4":
            return p.piecewise((4, *(3,) * (n - 2), 4))
        case "5-3-5":
            return p.piecewise((5, *(3,) * (n - 2), 5), 2, ((1, 0.0), (2, 0.0), (3, 0.0)))
        case "cubic":
            return p.cubic_spline(n, ((1, first),), ((1, 0.0),))
        case "natural":
            return p.cubic_spline(n, ((2, 0.0),))
        case "quintic":
            return p.quintic_spline(n, ends, ((1, 0.0), (2, 0.0)))
        case "septic":
            return p.septic_spline(n)
        case "cubic-virtual":
            return p.cubic_spline_virtual(points)
        case "quintic-virtual":
            return p.quintic_spline_virtual(points)
    return p.rest_to_rest(n, int(rng.choice([3, 5, 7])))


def _way(rng: Rng, points: int, joints: int) -> tuple[Array, list[int]]:
    """Way-points of size 1, and the segments that are far shorter than the others."""
    q = rng.normal(size=(points, joints))
    kind = rng.choice(["plain", "near", "same", "monotone", "twin", "still", "line"])
    short: list[int] = []
    if kind in ("near", "same") and points > 2:
        k = int(rng.integers(points - 1))
        gap = 0.0 if kind == "same" else 10.0 ** -rng.uniform(2, 9)
        q[k + 1] = q[k] + gap * rng.normal(size=joints)
        short = [k]
    elif kind == "monotone":
        q = np.cumsum(np.abs(q), axis=0)
    elif kind == "twin":
        q[:, -1] = q[:, 0] + rng.choice([0.0, 1e-9])
    elif kind == "still":
        q[:, 0] = q[0, 0]
        if rng.random() < 0.2:
            q[:] = q[0]
    elif kind == "line":
        q = np.linspace(0.0, 1.0, points)[:, None] * q[-1]
    return q, short


def reached(bare: Any, h: Array) -> tuple[Array, Array, Array]:
    """Peaks to each side of these durations, shape (2, joints, 3), and the range of positions."""
    from trajgap.problem import extrema, fit

    joints = bare.waypoints.shape[1]
    motion = fit(bare.curve, bare.waypoints, h)
    tops = np.zeros((2, joints, 3))
    low, high = np.empty(joints), np.empty(joints)
    for j in range(joints):
        for r in range(4):
            values = [e.value for e in extrema(motion, j, r)]
            if r:
                tops[:, j, r - 1] = max(0.0, -min(values)), max(0.0, *values)
            else:
                low[j] = min(*values, *bare.waypoints[:, j])
                high[j] = max(*values, *bare.waypoints[:, j])
    return tops, low, high


def draw(rng: Rng) -> tuple[Any, Array] | None:
    """A valid problem, and durations that `check` passes; None if none were drawn."""
    from trajgap.problem import Limits, Problem, TrajgapError, check

    family = str(rng.choice(FAMILIES))
    points = 4 if family == "3-5-3" else int(rng.integers(2, 6))
    if family in ("4-3-4", "5-3-5"):
        points = max(points, 4)
    if family.endswith("virtual"):
        points = max(points, 3)
    joints = int(rng.integers(1, 4))
    q, short = _way(rng, points, joints)
    moving = bool(family in ("cubic", "quintic") and rng.random() < 0.3)
    curve = _curve(rng, family, points, moving, joints)
    size, pace = 10.0 ** rng.choice([0, 0, 0, -4, 4, 7]), 10.0 ** rng.choice([0, 0, 0, -5, 5])
    if moving:
        size = pace = 1.0
    n = curve.segments
    h = np.exp(rng.normal(size=n) * rng.choice([0.3, 1.0]))
    if short and n == points - 1:
        h[short] *= 10.0 ** -rng.uniform(0, 6)
    q, h = q * size, h * pace
    bare = Problem(q, Limits(joints=joints), curve)
    try:
        tops, low, high = reached(bare, h)
        limits = _limits(rng, tops, low, high, np.ptp(q, axis=0))
        lower, upper = np.zeros(n), np.full(n, np.inf)
        if rng.random() < 0.45:
            width = float(rng.choice([0.0, 1e-9, 1e-3, 0.03, 0.5]))
            if rng.random() < 0.7:
                lower = h * (1.0 - width * rng.random(n))
            if rng.random() < 0.7:
                upper = h * (1.0 + width * rng.random(n))
        problem = Problem(q, limits, curve, duration_lower=lower, duration_upper=upper)
        passes = check(problem, h).verdict == "pass"
    except (TrajgapError, OverflowError):
        return None
    return (problem, h) if passes else None


def _limits(rng: Rng, tops: Array, low: Array, high: Array, span: Array) -> Any:
    """Limits that a motion with these peaks keeps: of some orders, of some sides, with ranges."""
    from trajgap.problem import Limits

    joints = len(low)
    sides = np.full((2, joints, 3), np.inf)
    orders = rng.permutation(3)[: rng.integers(1, 4)]
    room = 1.0 + rng.choice([1e-6, 0.05, 1.0]) * rng.random((2, joints, 3))
    floor = np.where(span > 0, span, 1.0)[:, None]
    wanted = np.where(tops > 1e-12 * floor, tops * room, floor)
    sides[:, :, orders] = wanted[:, :, orders]
    odd = rng.random()
    if odd < 0.55:
        sides[:] = sides.max(axis=0)
    elif odd < 0.7:
        sides[int(rng.integers(2)), :, orders] = np.inf
    # A joint that never goes back may be forbidden to.
    if rng.random() < 0.3:
        sides[(tops == 0.0) & np.isfinite(sides)] = 0.0
    limits = Limits(joints=joints).with_sides(sides)
    if rng.random() < 0.35:
        slack = float(rng.choice([0.0, 1e-9, 1e-3, 0.3])) * np.where(high > low, high - low, 0.0)
        below = np.where(rng.random(joints) < 0.8, low - slack, -np.inf)
        above = np.where(rng.random(joints) < 0.8, high + slack, np.inf)
        limits = limits.with_positions(below, above)
    return limits


def keeps_all(problem: Any, h: Array) -> bool:
    """Whether `check` passes durations, and their path lies within its range to the last digit.

    No stretch mends a path: what the tolerance lets pass there may be worth far more in time.
    """
    from trajgap.problem import check

    found = check(problem, h)
    within = all(peak.ratio <= 1.0 for peak in found.peaks if peak.quantity == "position")
    return found.verdict == "pass" and within


def shorter(rng: Rng, problem: Any, h: Array) -> Array:
    """The shortest durations near these that random steps find and that keep all."""
    from trajgap.problem import evaluate

    best, width = h, 0.3
    for _ in range(ROUNDS):
        trial = best * np.exp(width * rng.normal(size=(OFFSPRING, len(h))))
        trial = np.clip(trial, problem.duration_lower, problem.duration_upper)
        found = evaluate(problem, trial)
        stretch = found.stretch
        if problem.curve.homogeneous:
            with np.errstate(invalid="ignore"):
                trial = trial * np.where(np.isfinite(stretch), stretch, 1.0)[:, None]
            trial = np.clip(trial, problem.duration_lower, problem.duration_upper)
        totals = np.where((trial > 0).all(axis=1), trial.sum(axis=1), np.inf)
        gained = False
        for k in np.argsort(totals)[:6]:
            if totals[k] < best.sum() * (1 - 1e-12) and keeps_all(problem, trial[k]):
                best, gained = trial[k], True
                break
        width = min(1.3 * width, 1.0) if gained else 0.6 * width
    return best


def searched(rng: Rng, problem: Any, h: Array) -> Array:
    """The shorter of these and of what brute force finds that keeps all."""
    found = loaded("solver_errors").brute_force(problem, int(rng.integers(2**31)))
    better = found.total < h.sum() and keeps_all(problem, found.durations)
    return found.durations if better else h


def written(problem: Any, h: Array) -> str:
    """What it takes to build the problem again."""
    curve, limits = problem.curve, problem.limits
    return json.dumps(
        {
            "degrees": curve.degrees,
            "continuity": curve.continuity,
            "prescribed": [[[r, np.asarray(v).tolist()] for r, v in at] for at in curve.prescribed],
            "virtual": sorted(curve.virtual),
            "q": problem.waypoints.tolist(),
            "sides": limits.sides.tolist(),
            "position": [limits.position_lower.tolist(), limits.position_upper.tolist()],
            "bounds": [problem.duration_lower.tolist(), problem.duration_upper.tolist()],
            "h": h.tolist(),
        }
    )


def rebuilt(kept: dict[str, Any]) -> tuple[Any, Array]:
    """The problem that `written` wrote, and its durations."""
    from trajgap.problem import Interpolant, Limits, Problem

    prescribed = tuple(
        tuple((r, v if np.ndim(v) == 0 else tuple(v)) for r, v in at) for at in kept["prescribed"]
    )
    curve = Interpolant(
        tuple(kept["degrees"]),
        tuple(kept["continuity"]),
        prescribed,
        virtual=tuple(kept["virtual"]),
    )
    limits = Limits(joints=len(kept["q"][0])).with_sides(np.array(kept["sides"]))
    limits = limits.with_positions(*map(np.array, kept["position"]))
    lower, upper = kept["bounds"]
    problem = Problem(kept["q"], limits, curve, duration_lower=lower, duration_upper=upper)
    return problem, np.array(kept["h"])


def answered(problem: Any, h: Array) -> str:
    """Break unless `solve` gives an answer that passes and is no worse than known durations."""
    from trajgap.nlp import solve
    from trajgap.problem import check

    try:
        answer = solve(problem)
    except Exception as slip:
        demand(False, f"solve raises {type(slip).__name__}: {slip}")
        raise
    known = float(h.sum())
    said = f"{answer.status} ({answer.why})"
    demand(answer.status != "infeasible", f"{said}, but durations of {known:.9g} s keep all")
    demand(answer.found, f"{said}, but durations of {known:.9g} s keep all")
    verdict = check(problem, answer.durations).verdict
    demand(verdict == "pass", f"{said}, but its durations are {verdict}")
    worse = answer.best > known * (1 + BEATEN)
    demand(not worse, f"{said}: {answer.best:.9g} s, but {known:.9g} s keep all")
    return str(answer.status)


def nasty(rng: Rng, folder: Path) -> str | None:
    """`solve` on a nasty problem, against durations that keep every limit."""
    return _beside(rng, folder, shorter)


def optima(rng: Rng, folder: Path) -> str | None:
    """The same against brute force."""
    return _beside(rng, folder, searched)


def _beside(rng: Rng, folder: Path, search: Callable[[Rng, Any, Array], Array]) -> str | None:
    drawn = draw(rng)
    if drawn is None:
        return None
    problem, h = drawn
    keep(folder, problem=written(problem, h))
    best = search(rng, problem, h)
    keep(folder, problem=written(problem, best))
    return answered(problem, best)


ATTACKS = (
    Attack(
        "nasty problems",
        "`solve` on problems of every determined curve, scales 1e-5 to 1e7, way-points that "
        "coincide nearly, exactly or on a line, bounds and ranges without room, limits of one "
        "side; random steps from known durations",
        "an answer that passes; no known durations beat it by more than 1e-4; never infeasible",
        nasty,
        share=4.0,
        quick=6,
        inside=True,
    ),
    Attack(
        "optima",
        "the same; differential evolution and the simplex method, as benchmarks/solver_errors",
        "the same",
        optima,
        share=3.0,
        quick=3,
        inside=True,
    ),
)
