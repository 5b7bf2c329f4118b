"""A problem drawn at random, true answers to it, and a draft that holds what a paper prints."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar
from support.made_up import algorithms, entry, paper, readings
from support.papers import motions
from support.papers.printing import ANGLES, ORDERS, TIMES, last_place, places_for, printed
from support.toml_text import Bare

TIGHT = 1e-9
"""Share by which answers that use a limit up stay below it: what floats may be off."""


@dataclass
class Answer:
    """Durations in seconds and their motion, all joints together or one alone."""

    durations: motions.Array
    motion: motions.Motion
    joint: int | None = None

    @property
    def total(self) -> float:
        return float(self.durations.sum())


@dataclass
class Draft:
    """What a paper prints, with the truth behind it.

    ``points``, ``limits`` and ``claims`` hold what is printed; the other fields the truth in
    radians and seconds.
    """

    seed: int
    name: str
    family: motions.Family
    units: dict[str, str]
    points: list[list[str]]
    true_points: motions.Array
    limits: dict[int, list[str]]
    exact_points: bool
    exact_limits: bool
    true_limits: dict[int, motions.Array]
    places: int
    how: str
    coupling: str = "shared"
    other_reading: bool = False
    answers: dict[str, Answer] = field(default_factory=dict)
    claims: list[dict[str, Any]] = field(default_factory=list)

    @property
    def joints(self) -> int:
        return self.true_points.shape[1]

    @property
    def segments(self) -> int:
        return len(self.true_points) - 1 + self.family.extra

    def claim(self, name: str) -> dict[str, Any]:
        """A claim by its id."""
        return next(c for c in self.claims if c["id"] == name)

    def has(self, name: str) -> bool:
        return any(c["id"] == name for c in self.claims)

    def state(self, name: str, quantity: str, **keys: Any) -> None:
        self.claims.append({"id": name, "quantity": quantity} | keys)

    def say(self, name: str, checks: str, *of: str, **more: Any) -> None:
        """Claim a statement about some of the durations."""
        about = {"of": list(of)} if of else {}
        self.state(name, "statement", checks=checks, **about, **more)

    def si(self, order: int) -> float:
        """A unit of a derivative in SI units; of time if the order is -1."""
        if order < 0:
            return TIMES[self.units["time"]]
        return ANGLES[self.units[ORDERS[order]].split("/")[0]]

    def text(self) -> str:
        """The case file."""
        wrap, limit = (Bare if exact else str for exact in (self.exact_points, self.exact_limits))
        tables = {c["table"]: c.get("algorithm") for c in self.claims if "table" in c}
        parts = [algorithms("old", "new")]
        for name, algorithm in tables.items():
            named = {} if algorithm is None else {"algorithm": algorithm}
            parts.append(entry("tables", id=name, where=name, title=name, **named))
        parts += (entry("claims", **{"where": "text"} | c) for c in self.claims)
        if self.other_reading:
            other = "deg" if self.units["velocity"].startswith("rad") else "rad"
            parts.append(
                readings(printed={"default": True}, other={"units": {"velocity": f"{other}/s"}})
            )
        return paper(
            [[wrap(t) for t in row] for row in self.points],
            *parts,
            curve=self.family.block,
            units=self.units,
            waypoints={"where": "Table 1"},
            head={"id": f"paper-{self.seed}", "title": self.name, "coupling": self.coupling},
            where="Table 2",
            **{ORDERS[o]: [limit(t) for t in row] for o, row in self.limits.items()},
        )


def problem(rng: np.random.Generator, seed: int, name: str) -> Draft:
    family = motions.FAMILIES[name]
    count, joints = int(rng.choice(family.points)), int(rng.integers(1, 4))
    main = str(rng.choice(["deg", "rad"]))
    units = {"position": main}
    for order, suffix in ((1, "/s"), (2, "/s^2"), (3, "/s^3")):
        angle = main if rng.random() < 0.75 else str(rng.choice(["deg", "rad"]))
        units[ORDERS[order]] = angle + suffix
    units["time"] = "ms" if rng.random() < 0.15 else "s"

    steps = rng.uniform(8, 80, (count, joints)) * rng.choice([-1, 1], (count, joints))
    if rng.random() < 0.1:
        steps[rng.integers(1, count), rng.integers(joints)] *= 0.02
    true = np.cumsum(steps, axis=0) * np.pi / 180 / ANGLES[main]
    places = int(rng.choice([0, 1, 2, 3])) if main == "deg" else int(rng.choice([2, 3, 4]))
    how = str(rng.choice(["exact", "round", "round", "cut"]))
    rows = [[printed(x, places, "round" if how == "exact" else how) for x in row] for row in true.T]
    if how == "exact":
        true = np.array([[float(t) for t in row] for row in rows]).T
    if (np.ptp(np.array([[float(t) for t in row] for row in rows]), axis=1) == 0).any():
        raise motions.NoCurveError("a joint stands still")

    orders = [(1, 2), (1, 2), (1, 2, 3), (2,), (1,), (1, 3)][int(rng.integers(6))]
    if family.smooth < 2:
        orders = tuple(o for o in orders if o < 3) or (1,)
    limits: dict[int, list[str]] = {}
    true_limits: dict[int, motions.Array] = {}
    exact_limits = bool(rng.random() < 0.6)
    off = not exact_limits and rng.random() < 0.5
    for order in orders:
        unit = ANGLES[units[ORDERS[order]].split("/")[0]]
        low, high = ((20, 150), (30, 300), (100, 2000))[order - 1]
        values = rng.uniform(low, high, joints) * np.pi / 180 / unit
        if rng.random() < 0.3:
            values[:] = values[0]
        texts = [printed(x, places_for(x, int(rng.choice([2, 3])))) for x in values]
        limits[order] = texts
        exact = np.array([float(t) for t in texts])
        if off:
            exact = exact + np.array([last_place(t) for t in texts]) * rng.uniform(-0.49, 0.49)
        true_limits[order] = exact * unit
    duration_places = int(rng.choice([0, 1] if units["time"] == "ms" else [2, 3, 4]))
    return Draft(
        seed=seed,
        name=name,
        family=family,
        units=units,
        points=rows,
        true_points=true * ANGLES[main],
        limits=limits,
        exact_points=bool(how == "exact" and rng.random() < 0.5),
        exact_limits=exact_limits,
        true_limits=true_limits,
        places=duration_places,
        how=str(rng.choice(["round", "round", "round", "cut", "up"])),
        other_reading=bool(rng.random() < 0.1 and 1 in limits),
    )


def fitted(draft: Draft, durations: motions.Array, joint: int | None = None) -> motions.Motion:
    """The true motion of durations, of all joints or of one."""
    points = draft.true_points if joint is None else draft.true_points[:, [joint]]
    return draft.family.fit(points, durations)


def limits_of(draft: Draft, joint: int | None) -> dict[int, motions.Array]:
    """True limits, of all joints or of one."""
    if joint is None:
        return draft.true_limits
    return {order: row[[joint]] for order, row in draft.true_limits.items()}


def answer(draft: Draft, shape: motions.Array, slack: float, joint: int | None = None) -> Answer:
    """Durations in given proportions that keep the limits and nearly reach one."""
    factor = motions.stretch(fitted(draft, shape, joint), limits_of(draft, joint)) * (1 + slack)
    durations = shape * factor
    return Answer(durations, fitted(draft, durations, joint), joint)


def keeps(draft: Draft, durations: motions.Array, joint: int | None = None) -> bool:
    """Whether a motion keeps its limits."""
    motion = fitted(draft, durations, joint)
    return max(motions.ratios(motion, limits_of(draft, joint)).values()) <= 1.0


def shortest(draft: Draft, joint: int | None = None) -> Answer | None:
    """The shortest answer, where this route is sure of it: segments apart, or two of them."""
    points = draft.true_points if joint is None else draft.true_points[:, [joint]]
    limits = limits_of(draft, joint)
    if draft.family.apart:
        durations = motions.shortest_apart(draft.family, points, limits, draft.segments) * (
            1 + TIGHT
        )
        return Answer(durations, fitted(draft, durations, joint), joint)
    if draft.segments != 2:
        return None

    def total(logarithm: float) -> float:
        shape = np.array([1.0, np.exp(logarithm)])
        try:
            return float(shape.sum() * motions.stretch(draft.family.fit(points, shape), limits))
        except motions.NoCurveError:
            return np.inf

    grid = np.linspace(-2.5, 2.5, 26)
    values = np.array([total(x) for x in grid])
    best = np.inf, 0.0
    for k in range(1, len(grid) - 1):
        if values[k] <= min(values[k - 1], values[k + 1]) and values[k] < 1.1 * values.min():
            around = (grid[k - 1], grid[k + 1])
            found = minimize_scalar(total, bounds=around, method="bounded", options={"xatol": 1e-9})
            best = min(best, (float(found.fun), float(found.x)))
    if not np.isfinite(best[0]):
        return None
    return answer(draft, np.array([1.0, np.exp(best[1])]), TIGHT, joint)


def some_shape(rng: np.random.Generator, draft: Draft) -> motions.Array:
    """Proportions of durations."""
    return np.exp(rng.normal(0, 0.2, draft.segments))


def some_slack(rng: np.random.Generator) -> float:
    """Share by which an answer is longer than its limits ask."""
    return [TIGHT, float(rng.uniform(0, 0.02)), float(rng.uniform(0, 0.3))][int(rng.integers(3))]
