"""Made-up papers that print profiles: totals, phases, peaks and values, true of what they are."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from profile_truth import Array, Inputs, UnfitError

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.made_up import claim, paper, sentence
from support.papers.printing import (
    ANGLES,
    ORDERS,
    TIMES,
    last_place,
    moved,
    places_for,
    printed,
)
from support.toml_text import Bare

KINDS = ("trapezoidal", "s-curve", "braking", "sine-jerk", "fourth-order", "straight", "apart")
"""What a paper prints: a profile of one joint, or how several go together."""
FAULTS = ("number of a profile", "input of a profile")
"""What is misprinted: a claimed number, or one that the profile follows from."""


@dataclass
class ProfilePaper:
    """What is printed, with the truth behind it."""

    seed: int
    name: str
    units: dict[str, str]
    true: Inputs
    texts: dict[str, NDArray[Any]]
    """Printed digits of each input, in the shape of the true ones."""
    exact: bool
    """Whether inputs are meant exactly."""
    claims: list[dict[str, Any]] = field(default_factory=list)
    numbers: dict[tuple[str, int], Callable[[Inputs], float]] = field(default_factory=dict)
    """How each printed number follows from the inputs, by claim and position in it."""

    def unit(self, order: int) -> float:
        """Of a derivative in SI units; of time if the order is -1, of snap if it is 4."""
        if order == 4:
            return self.unit(3) / self.unit(-1)
        return (
            TIMES[self.units["time"]]
            if order < 0
            else ANGLES[self.units[ORDERS[order]].split("/")[0]]
        )

    def si(self) -> dict[str, Array]:
        """Units of inputs in SI units, in the shape of each."""
        orders = [1, 2, 3, 2 if self.true.profile == "braking" else 4]
        return {
            "points": np.full(self.true.points.shape, self.unit(0)),
            "ends": np.tile([self.unit(1), self.unit(2)], (*self.true.ends.shape[:2], 1)),
            "limits": np.tile([self.unit(o) for o in orders], (len(self.true.limits), 1)),
        }

    def read(self) -> Inputs:
        """Inputs as printed."""
        return replace(
            self.true,
            **{k: self.texts[k].astype(float) * unit for k, unit in self.si().items()},
        )

    def room(self, key: tuple[str, int]) -> tuple[float, float]:
        """How far a printed number is from that of the printed inputs, and what digits hide."""
        of, own = self.numbers[key], self.read()
        name, at = key
        entry = next(c for c in self.claims if c["id"] == name)
        text = next(v for k, v in entry.items() if k in ("value", "phases", "ramps"))
        text = (
            [*entry.get("phases", ()), *entry.get("ramps", ())][at] if "phases" in entry else text
        )
        unit = self.unit(
            -1
            if entry["quantity"] in ("total_time", "phases")
            else ORDERS.index(entry["derivative"])
        )
        plain, reach = of(own), last_place(text) * unit
        if not self.exact:
            for field_, unit_ in self.si().items():
                for index in np.ndindex(unit_.shape):
                    if self.texts[field_][index] != "0":
                        values = getattr(own, field_).copy()
                        values[index] += last_place(self.texts[field_][index]) * unit_[index]
                        reach += abs(of(replace(own, **{field_: values})) - plain)
        return abs(float(text) * unit - plain), reach

    def text(self) -> str:
        """The case file."""

        def wrap(text: str) -> str:
            return Bare(text) if self.exact or text == "0" else text

        own = self.true
        moving = bool(own.ends.any())
        curve: dict[str, Any] = {"family": "rest-to-rest", "degree": 5}
        if moving:
            orders = 1 if own.profile in ("trapezoidal", "braking") else 2
            curve = {
                "family": "polynomials",
                "degrees": [2 * orders + 1],
                "end_orders": [*range(1, orders + 1)],
            }
            for key, row in zip(("end", "finish"), self.texts["ends"], strict=True):
                curve[f"{key}_derivatives"] = [wrap(t) for t in row[0][:orders]]
        limits = [[wrap(t) for t in column] for column in self.texts["limits"].T]
        profile = "trapezoidal" if own.profile == "braking" else own.profile
        of: dict[str, Any] = {"other_curve": "profile", "profile": profile}
        if own.profile == "braking":
            of["deceleration"] = limits[3]
        if own.profile == "fourth-order":
            of["snap"] = limits[3]
        if own.together == "straight":
            of["path"] = "straight"
        given = {"velocity": limits[0], "acceleration": limits[1]}
        if own.profile not in ("trapezoidal", "braking"):
            given["jerk"] = limits[2]
        parts = [
            claim(
                **{
                    "name": c["id"],
                    **{k: v for k, v in c.items() if k != "id"},
                    **(of if c["quantity"] in ("total_time", "phases") else {}),
                }
            )
            for c in self.claims
        ]
        return paper(
            [[wrap(t) for t in row] for row in self.texts["points"].T],
            *parts,
            sentence("optimal", "optimal", "total"),
            curve=curve,
            units=self.units,
            head={"id": f"paper-{self.seed}", "title": self.name},
            **given,
        )


def draw(seed: int) -> ProfilePaper:
    """A clean paper."""
    rng = np.random.default_rng([20261128, seed])
    while True:
        try:
            return _draw(rng, seed)
        except UnfitError:
            continue


def _draw(rng: np.random.Generator, seed: int) -> ProfilePaper:
    kind = str(rng.choice(KINDS))
    several = kind in ("straight", "apart")
    joints, count = (int(rng.integers(2, 4)) if several else 1), int(rng.choice([2, 2, 2, 3]))
    profile = str(rng.choice(["trapezoidal", "s-curve"])) if several else kind
    moving = profile in ("trapezoidal", "s-curve", "braking") and not several and rng.random() < 0.6
    count = 2 if moving else count
    main = str(rng.choice(["deg", "rad"]))
    units = {"position": main, "time": "ms" if rng.random() < 0.15 else "s"}
    for order, suffix in ((1, "/s"), (2, "/s^2"), (3, "/s^3")):
        units[ORDERS[order]] = (
            main if rng.random() < 0.8 else str(rng.choice(["deg", "rad"]))
        ) + suffix
    exact = bool(rng.random() < 0.5)
    one = ProfilePaper(
        seed,
        f"profile, {kind}",
        units,
        Inputs(profile, kind if several else "", *(np.zeros(0),) * 3),
        {},
        exact,
    )
    degree = math.pi / 180
    points = (
        np.cumsum(
            rng.uniform(5, 90, (count, joints)) * rng.choice([-1, 1], (count, joints)), axis=0
        )
        * degree
    )
    v, a = rng.uniform(20, 150, joints), rng.uniform(30, 400, joints)
    last = (
        a * rng.uniform(0.3, 3, joints) if profile == "braking" else rng.uniform(1e3, 1e5, joints)
    )
    limits = np.column_stack([v, a, rng.uniform(100, 3000, joints), last]) * degree
    ends = np.zeros((2, joints, 2))
    if moving:
        share = rng.uniform(-0.95, 0.95, (2, joints)) * rng.choice([0, 1, 1], (2, joints))
        ends[..., 0] = share * limits[:, 0]
        if profile == "s-curve" and rng.random() < 0.5:
            # A velocity that an acceleration still changes must not pass its limit.
            most = np.sqrt(2 * (1 - np.abs(share)) * limits[:, 0] * limits[:, 2])
            ends[..., 1] = rng.uniform(-0.9, 0.9, (2, joints)) * np.minimum(most, limits[:, 1])
    one.true = replace(one.true, points=points, ends=ends, limits=limits)
    _printed_inputs(rng, one)
    _claims(rng, one)
    return one


def _printed_inputs(rng: np.random.Generator, one: ProfilePaper) -> None:
    """Print the inputs, and put the truth where the digits leave it."""
    how = str(rng.choice(["round", "round", "cut"]))
    digits = int(rng.choice([2, 3, 4]))
    true = {}
    for name, unit in one.si().items():
        values = getattr(one.true, name) / unit
        texts = np.array(
            [printed(float(x), places_for(float(x), digits), how) for x in values.flat],
            dtype=object,
        )
        one.texts[name] = texts.reshape(values.shape)
        nominal = one.texts[name].astype(float)
        if one.exact:
            values = nominal
        still = getattr(one.true, name) == 0
        one.texts[name][still] = "0" if rng.random() < 0.7 else printed(0.0, digits - 1)
        true[name] = values * unit
    if (np.diff(one.texts["points"].astype(float), axis=0) == 0).any():
        raise UnfitError
    one.true = replace(one.true, **true)


def _claims(rng: np.random.Generator, one: ProfilePaper) -> None:
    how = str(rng.choice(["round", "round", "round", "cut"]))
    true, digits = one.true, int(rng.choice([3, 4, 5]))

    def text(value: float, order: int) -> str:
        if abs(value) < 1e-6:
            raise UnfitError
        return printed(value / one.unit(order), places_for(value / one.unit(order), digits), how)

    def state_(
        name: str, quantity: str, truth: Callable[[Inputs], float], order: int, **keys: Any
    ) -> None:
        one.numbers[name, 0] = truth
        one.claims.append(
            {"id": name, "quantity": quantity, "value": text(truth(true), order)} | keys
        )

    state_("total", "total_time", lambda i: i.total, -1)
    whole = true.profile in ("trapezoidal", "s-curve", "braking")
    if whole and not true.together and len(true.points) == 2 and rng.random() < 0.6:
        try:
            parts = true.parts[
                : 5 if true.profile == "s-curve" and not true.ends[..., 1].any() else 3
            ]
            for k in range(len(parts)):
                one.numbers["phases", k] = lambda i, k=k: i.parts[k]
            texts = [text(p, -1) if p else "0.000" for p in parts]
            ramps = {"ramps": texts[3:]} if len(texts) == 5 else {}
            one.claims.append({"id": "phases", "quantity": "phases", "phases": texts[:3]} | ramps)
        except UnfitError:
            pass
    if not whole or true.together == "apart":
        return
    joints = true.points.shape[1]
    for order in (1, 2):
        joint = int(rng.integers(joints))
        label = {"joint": str(joint + 1), "derivative": ORDERS[order], "of": "total"}
        if rng.random() < 0.5:

            def most(i: Inputs, order: int = order, joint: int = joint) -> float:
                return max(abs(i.extreme(order, joint, max)), abs(i.extreme(order, joint, min)))

            state_(f"peak-{order}", "peak", most, order, **label)
        if rng.random() < 0.4:
            place = str(rng.choice(["largest", "smallest"]))
            which = max if place == "largest" else min
            state_(
                f"size-{order}",
                "value",
                lambda i, o=order, j=joint, w=which: i.extreme(o, j, w),
                order,
                place=place,
                **label,
            )
    for k in range(int(rng.integers(3))):
        order, joint = int(rng.integers(3)), int(rng.integers(joints))
        unit = one.unit(-1)
        when = printed(rng.uniform(0.05, 0.95) * true.total / unit, int(rng.choice([1, 2])))
        if 0 < float(when) * unit < true.total:
            state_(
                f"value-{k}",
                "value",
                lambda i, o=order, j=joint, t=float(when) * unit: float(i.at(t, j)[o]),
                order,
                time=Bare(when),
                derivative=ORDERS[order],
                of="total",
                joint=str(joint + 1),
            )


@dataclass(frozen=True)
class Planted:
    """A paper with a fault, how large it is, and what its digits could hide."""

    draft: ProfilePaper
    size: float
    room: float


def planted(fault: str, seed: int) -> Planted:
    """A paper with a fault."""
    rng = np.random.default_rng([20261128, FAULTS.index(fault) + 1, seed])
    while True:
        one = draw(int(rng.integers(2**40)))
        one.seed = seed
        try:
            _spoil(rng, one, fault)
            shown = [one.room(key) for key in one.numbers]
        except (UnfitError, ValueError, ZeroDivisionError):
            continue
        size, room = max(shown, key=lambda both: both[0] / both[1])
        return Planted(one, size, room)


def _spoil(rng: np.random.Generator, one: ProfilePaper, fault: str) -> None:
    steps = round(float(np.exp(rng.uniform(0, np.log(300))))) * int(rng.choice([-1, 1]))
    if fault == FAULTS[0]:
        entry = one.claims[int(rng.integers(len(one.claims)))]
        if "phases" in entry:
            at = int(rng.integers(3))
            entry["phases"][at] = moved(entry["phases"][at], steps)
            if float(entry["phases"][at]) < 0:
                raise UnfitError
        else:
            entry["value"] = moved(entry["value"], steps)
            if entry["quantity"] != "value" and float(entry["value"]) <= 0:
                raise UnfitError
        return
    name = str(rng.choice(["points", "ends", "limits"]))
    texts = one.texts[name]
    index = tuple(int(rng.integers(n)) for n in texts.shape)
    if float(texts[index]) == 0:
        raise UnfitError
    texts[index] = moved(texts[index], steps)
    if name == "limits" and float(texts[index]) <= 0:
        raise UnfitError
    if name == "points" and (np.diff(texts.astype(float), axis=0) == 0).any():
        raise UnfitError
