"""The tree of a proof: boxes in ticks, what narrowed them, and the document of it all."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import Array
from ....verify import CUT, LEAF, MIX_DIGITS, OPEN, TICKS
from ..exact import decimal
from .proof import NOTHING, TOTAL, Target, Weights, least, multiplied
from .ranges import Side, a_priori, implied, narrowed, with_rho
from .system import CubicRow, CubicSystem


@dataclass(frozen=True, eq=False)
class BoxStep:
    """What is done to a box.

    ``kind``: "r" narrows the ranges, "t" sets a side (``sign`` 1: its lower end) to ``value``, "f"
    raises the floor of the total to ``value``, "e" shows the box to be empty, "s" halves it.
    """

    kind: str
    coordinate: int = -1
    sign: int = 0
    value: int = 0
    weights: Weights | None = None


@dataclass(eq=False)
class TickBox:
    """A box of the tree.

    Attributes
    ----------
    low, high : list of int
        Sides in ticks, of the free coordinates.
    ranges : tuple of ndarray
        Of the unknowns.
    floor : int
        The total is at least this many ticks.
    steps : list of BoxStep
        What was done to it, in this order.
    children : tuple of TickBox
        After a step "s".
    closed : bool
        Nothing below the cap is feasible in it.
    """

    low: list[int]
    high: list[int]
    ranges: tuple[Array, Array]
    floor: int
    steps: list[BoxStep] = field(default_factory=list)
    children: tuple[TickBox, ...] = ()
    closed: bool = False

    def take(self, other: TickBox) -> None:
        """Take over what was done to a copy; wherever an interrupt strikes, steps stand for it."""
        if other is not self:
            self.steps = other.steps
            self.low, self.high, self.ranges = other.low, other.high, other.ranges
            self.floor, self.closed = other.floor, other.closed

    def leaves(self) -> Iterator[TickBox]:
        """Open leaves below it, itself included."""
        stack = [self]
        while stack:
            box = stack.pop()
            if box.children:
                stack += reversed(box.children)
            elif not box.closed:
                yield box

    def worked(self) -> Iterator[TickBox]:
        """Boxes that something was done to, itself included."""
        stack = [self]
        while stack:
            box = stack.pop()
            stack += box.children
            if box.steps:
                yield box


class Prover:
    """Carries out steps, each only if it is proved; the total is below ``cap`` ticks."""

    def __init__(self, system: CubicSystem, cap: int) -> None:
        self.system, self.cap = system, cap

    @property
    def total(self) -> Fraction:
        """The cap in units of time."""
        return Fraction(self.cap, TICKS)

    def root(self) -> TickBox:
        """Box of everything feasible below the cap."""
        system = self.system
        low = [0] * system.free
        high = [self.cap] * system.free
        fastest = [v for v, _ in implied(system, self.total)]
        for t, steps in enumerate(system.steps):
            held = [k for k in range(system.pieces) if t in system.piece(k)]
            if system.virtual and t in (0, system.spans - 1):
                held.append(0 if t == 0 else system.pieces - 1)
            shortest = sum((system.shortest[k] for k in held), Fraction(0))
            for step, v in zip(steps, fastest, strict=True):
                if math.isfinite(v) and v > 0:
                    shortest = max(shortest, abs(step) / Fraction(v))
            # No feasible total is below the cap where a side begins there.
            low[t] = min(math.floor(shortest * TICKS), self.cap)
            longest = [x for x in (system.longest[k] for k in held) if x is not None]
            if len(longest) == len(held):
                high[t] = min(high[t], math.ceil(sum(longest) * TICKS))
        for (h, _, _), k in zip(system.curved, (0, system.pieces - 1), strict=False):
            low[h] = min(math.floor(system.shortest[k] * TICKS), self.cap)
            longest_piece = system.longest[k]
            if longest_piece is not None:
                high[h] = min(high[h], math.ceil(longest_piece * TICKS))
        box = TickBox(low, high, self._widest(), 0)
        self.trim(box)
        return box

    def _widest(self) -> tuple[Array, Array]:
        shape = (self.system.unknowns, self.system.joints)
        return np.full(shape, -np.inf), np.full(shape, np.inf)

    def side(self, box: TickBox) -> Side:
        """The box in floats, which hold ticks exactly."""
        low, high = (np.array(x, dtype=np.float64) / TICKS for x in (box.low, box.high))
        return with_rho(self.system, low, high)

    def trim(self, box: TickBox) -> None:
        """What the cap says about the spans, and a span about the piece in it."""
        spans = range(self.system.spans)
        total = sum(box.low[t] for t in spans)
        for t in spans:
            box.high[t] = min(box.high[t], self.cap - total + box.low[t])
        for h, t, _ in self.system.curved:
            box.high[h] = min(box.high[h], box.high[t])
        box.floor = max(box.floor, total)
        empty = any(x > y for x, y in zip(box.low, box.high, strict=True))
        box.closed = box.closed or empty or box.floor >= self.cap

    def narrow(self, box: TickBox) -> bool:
        """Narrow the ranges of the unknowns; False if the box turns out to be empty."""
        side = self.side(box)
        low, high = a_priori(self.system, side, self.total)
        low, high = np.maximum(low, box.ranges[0]), np.minimum(high, box.ranges[1])
        found = narrowed(self.system, side, low, high)
        box.steps.append(BoxStep("r"))
        if found is None:
            box.closed = True
            return False
        box.ranges = found
        return True

    def bound(self, box: TickBox, target: Target, weights: Weights) -> Fraction | None:
        """Proved bound of a target (of nothing: whether it is positive), in ticks."""
        if weights.scale < 1 and target.sign != 0:
            return None
        value = least(self.system, self.total, target, weights, self.side(box), box.ranges)
        if not np.isfinite(value):
            return None
        return Fraction(value) * TICKS / max(weights.scale, 1)

    def tighten(
        self, box: TickBox, coordinate: int, sign: int, weights: Weights, least_: int
    ) -> bool:
        """Move a side inward, if by ``least_`` ticks at least."""
        bound = self.bound(box, Target(coordinate, sign), weights)
        if bound is None:
            return False
        value = math.floor(bound) if sign > 0 else math.ceil(-bound)
        old = box.low[coordinate] if sign > 0 else box.high[coordinate]
        if (value - old) * sign < least_:
            return False
        # One tick beyond the other side says that the box is empty, which is all there is to say.
        if sign > 0:
            value = min(value, box.high[coordinate] + 1)
        else:
            value = max(value, box.low[coordinate] - 1)
        self.set(box, BoxStep("t", coordinate, sign, value, weights))
        return True

    def set(self, box: TickBox, step: BoxStep) -> None:
        """Carry out a step "t" that is proved."""
        box.steps.append(step)
        k = step.coordinate
        if step.sign > 0:
            box.low[k] = max(box.low[k], step.value)
        else:
            box.high[k] = min(box.high[k], step.value)
        self.trim(box)

    def lift(self, box: TickBox, weights: Weights) -> None:
        """Raise the floor."""
        bound = self.bound(box, TOTAL, weights)
        if bound is not None and math.floor(bound) > box.floor:
            box.floor = min(math.floor(bound), self.cap)
            box.steps.append(BoxStep("f", value=box.floor, weights=weights))
            box.closed = box.floor >= self.cap

    def clear(self, box: TickBox, weights: Weights) -> bool:
        """Close a box that is empty."""
        bound = self.bound(box, NOTHING, weights)
        if bound is None or bound <= 0:
            return False
        box.steps.append(BoxStep("e", weights=weights))
        box.closed = True
        return True

    def halve(self, box: TickBox, coordinate: int) -> tuple[TickBox, TickBox]:
        """Halve a box."""
        at = (box.low[coordinate] + box.high[coordinate]) // 2
        return self.split(box, coordinate, at)

    def split(self, box: TickBox, coordinate: int, at: int) -> tuple[TickBox, TickBox]:
        """Split a box at a place."""
        lower = TickBox(list(box.low), list(box.high), box.ranges, box.floor)
        upper = TickBox(list(box.low), list(box.high), box.ranges, box.floor)
        lower.high[coordinate] = min(at, box.high[coordinate])
        upper.low[coordinate] = max(at, box.low[coordinate])
        for half in (lower, upper):
            self.trim(half)
        box.steps.append(BoxStep("s", coordinate, value=at))
        box.children = (lower, upper)
        return lower, upper


def proof_document(prover: Prover, root: TickBox, lower: int, unfinished: bool) -> dict[str, Any]:
    """The proof that the total is at least ``lower`` ticks.

    It is derived in docs/explanation/certificates-cubic.md.
    With ``unfinished``, boxes that are not closed are open leaves: a proposal to go on from.
    """
    system = prover.system
    rows: dict[CubicRow, int] = {}
    tree: list[Any] = []
    stack = [root]
    while stack:
        box = stack.pop()
        steps = [s for s in box.steps if s.kind != "f" or _serves(box, s)]
        tree += [_step(system, step, rows) for step in steps]
        if box.children:
            stack += reversed(box.children)
        elif not (steps and steps[-1].kind == "e"):
            tree.append([OPEN if unfinished and not box.closed else LEAF])
    return {
        "kind": "cubic",
        "total": decimal(Fraction(lower, TICKS) * Fraction(2) ** system.second),
        "powers": list(system.powers),
        "second": system.second,
        "cap": prover.cap,
        "root": prover.root().low,
        "rows": [[r.kind, r.joint, r.index, r.sign, r.place] for r in rows],
        "tree": tree,
    }


def _serves(box: TickBox, step: BoxStep) -> bool:
    """Whether a floor is needed: it closes the box, or something below it is open."""
    if box.closed:
        return step is box.steps[-1]
    last = [s for s in box.steps if s.kind == "f"][-1]
    return step is last and next(box.leaves(), None) is not None


def _step(system: CubicSystem, step: BoxStep, rows: dict[CubicRow, int]) -> Any:
    if step.kind == "r":
        return ["r"]
    if step.kind == "s":
        return [CUT, step.coordinate, step.value]
    weights = step.weights
    assert weights is not None
    held = [x for row, w in weights.rows.items() for x in (rows.setdefault(row, len(rows)), w)]
    equations = [x for (j, i), w in weights.equations.items() for x in (j * system.unknowns + i, w)]
    alphabet = "".join(MIX_DIGITS[x] for x in weights.mix[multiplied(system, weights)])
    tail = [held, equations, alphabet]
    if step.kind == "e":
        return [LEAF, *tail]
    if step.kind == "f":
        return ["f", step.value, weights.scale, *tail]
    return ["t", step.coordinate, step.sign, step.value, weights.scale, *tail]
