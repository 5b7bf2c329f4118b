"""The tree of a proof: boxes in ticks, what narrowed them, and the document of it all."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import Array, TrajgapError
from ....verify import (
    CUT,
    LEAF,
    MIX_DIGITS,
    MOST_INTEGER,
    MOST_POWER,
    OPEN,
    TICKS,
    Clock,
    StatedProblem,
    proof_kind,
)
from ..driver import regrow
from ..exact import decimal
from .bound import NOTHING, TOTAL, Target, Weights, least, multiplied
from .ranges import Side, a_priori, narrowed, with_rho
from .system import CubicRow, CubicSystem

Step = list[Any]
"""What is done to a box: a node of the document, whose conditions are not numbered yet.

["r"] narrows the ranges, ["t", coordinate, sign, value, …] sets a side (sign 1: its lower end),
["f", value, …] raises the floor of the total, [LEAF, …] shows the box to be empty, and
[CUT, coordinate, value] splits it; … stands for weights.
"""


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
    steps : list of Step
        What was done to it, in this order.
    children : tuple of TickBox
        After a cut.
    closed : bool
        Nothing below the cap is feasible in it.
    """

    low: list[int]
    high: list[int]
    ranges: tuple[Array, Array]
    floor: int
    steps: list[Step] = field(default_factory=list)
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


class Prover:
    """Carries out steps, each only if it is proved; the total is below the system's cap."""

    def __init__(self, system: CubicSystem) -> None:
        self.system, self.cap = system, system.cap

    def root(self) -> TickBox:
        """Box of everything feasible below the cap."""
        low, high = [], []
        for c in range(self.system.free):
            least_, most = self.system.exact.side(c)
            # No feasible total is below the cap where a side begins there.
            low.append(min(math.floor(least_ * TICKS), self.cap))
            high.append(min(math.ceil(most * TICKS), self.cap))
        shape = (self.system.exact.size, self.system.exact.joints)
        box = TickBox(low, high, (np.full(shape, -np.inf), np.full(shape, np.inf)), 0)
        self.trim(box)
        return box

    def side(self, box: TickBox) -> Side:
        """The box in floats, which hold ticks exactly."""
        low, high = (np.array(x, dtype=np.float64) / TICKS for x in (box.low, box.high))
        return with_rho(self.system, low, high)

    def trim(self, box: TickBox) -> None:
        """What the cap says about the spans, and a span about the piece in it."""
        spans = range(self.system.exact.m)
        total = sum(box.low[t] for t in spans)
        for t in spans:
            box.high[t] = min(box.high[t], self.cap - total + box.low[t])
        for h, t, _ in self.system.exact.rho():
            box.high[h] = min(box.high[h], box.high[t])
        box.floor = max(box.floor, total)
        empty = any(x > y for x, y in zip(box.low, box.high, strict=True))
        box.closed = box.closed or empty or box.floor >= self.cap

    def narrow(self, box: TickBox) -> bool:
        """Narrow the ranges of the unknowns; False if the box turns out to be empty."""
        side = self.side(box)
        low, high = a_priori(self.system, side)
        low, high = np.maximum(low, box.ranges[0]), np.minimum(high, box.ranges[1])
        found = narrowed(self.system, side, low, high)
        box.steps.append(["r"])
        if found is None:
            box.closed = True
            return False
        box.ranges = found
        return True

    def bound(self, box: TickBox, target: Target, weights: Weights) -> Fraction | None:
        """Proved bound of a target (of nothing: whether it is positive), in ticks."""
        if weights.scale < 1 and target.sign != 0:
            return None
        value = least(self.system, target, weights, self.side(box), box.ranges)
        if not np.isfinite(value):
            return None
        return Fraction(value) * TICKS / max(weights.scale, 1)

    def tighten(
        self, box: TickBox, coordinate: int, sign: int, weights: Weights, least_: int
    ) -> None:
        """Move a side inward, if by ``least_`` ticks at least."""
        bound = self.bound(box, Target(coordinate, sign), weights)
        if bound is None:
            return
        value = math.floor(bound) if sign > 0 else math.ceil(-bound)
        old = box.low[coordinate] if sign > 0 else box.high[coordinate]
        if (value - old) * sign < least_:
            return
        # One tick beyond the other side says that the box is empty, which is all there is to say.
        if sign > 0:
            box.low[coordinate] = value = min(value, box.high[coordinate] + 1)
        else:
            box.high[coordinate] = value = max(value, box.low[coordinate] - 1)
        box.steps.append(["t", coordinate, sign, value, weights.scale, *self._stated(weights)])
        self.trim(box)

    def lift(self, box: TickBox, weights: Weights) -> None:
        """Raise the floor."""
        bound = self.bound(box, TOTAL, weights)
        if bound is not None and math.floor(bound) > box.floor:
            box.floor = min(math.floor(bound), self.cap)
            box.steps.append(["f", box.floor, weights.scale, *self._stated(weights)])
            box.closed = box.floor >= self.cap

    def clear(self, box: TickBox, weights: Weights) -> None:
        """Close a box that is empty."""
        bound = self.bound(box, NOTHING, weights)
        if bound is not None and bound > 0:
            box.steps.append([LEAF, *self._stated(weights)])
            box.closed = True

    def _stated(self, weights: Weights) -> list[Any]:
        """Weights of conditions and equations, and the shares of the products, as in a node."""
        size = self.system.exact.size
        held = [x for pair in weights.rows.items() for x in pair]
        equations = [x for (j, i), w in weights.equations.items() for x in (j * size + i, w)]
        shares = weights.mix[multiplied(self.system, weights)]
        return [held, equations, "".join(MIX_DIGITS[x] for x in shares)]

    def halve(self, box: TickBox, coordinate: int) -> tuple[TickBox, TickBox]:
        """Halve a box."""
        at = (box.low[coordinate] + box.high[coordinate]) // 2
        lower = TickBox(list(box.low), list(box.high), box.ranges, box.floor)
        upper = TickBox(list(box.low), list(box.high), box.ranges, box.floor)
        lower.high[coordinate], upper.low[coordinate] = at, at
        for half in (lower, upper):
            self.trim(half)
        box.steps.append([CUT, coordinate, at])
        box.children = (lower, upper)
        return lower, upper


@dataclass(frozen=True, eq=False)
class Tree:
    """The proof of a lower bound, in ticks; unfinished: open boxes of it are proposed."""

    prover: Prover
    root: TickBox
    lower: int
    unfinished: bool = False

    @property
    def seconds(self) -> Fraction:
        """The lower bound, s."""
        return self.lower * self.prover.system.unit

    @property
    def proposed(self) -> Tree:
        """It, to go on from."""
        return replace(self, unfinished=True)

    def document(self) -> dict[str, Any]:
        """Kind "cubic" of docs/explanation/certificates-cubic.md."""
        system = self.prover.system
        rows: dict[CubicRow, int] = {}
        tree: list[Any] = []
        stack = [self.root]
        while stack:
            box = stack.pop()
            steps = [s for s in box.steps if s[0] != "f" or _serves(box, s)]
            tree += [_numbered(step, rows) for step in steps]
            if box.children:
                stack += reversed(box.children)
            elif not (steps and steps[-1][0] == LEAF):
                tree.append([OPEN if self.unfinished and not box.closed else LEAF])
        return {
            "kind": "cubic",
            "total": decimal(self.seconds),
            "powers": list(system.powers),
            "second": system.second,
            "cap": system.cap,
            "root": self.prover.root().low,
            "rows": [list(row) for row in rows],
            "tree": tree,
        }


def _serves(box: TickBox, step: Step) -> bool:
    """Whether a floor is needed: it closes the box, or something below it is open."""
    if box.closed:
        return step is box.steps[-1]
    last = [s for s in box.steps if s[0] == "f"][-1]
    return step is last and next(box.leaves(), None) is not None


def _numbered(step: Step, rows: dict[CubicRow, int]) -> Step:
    """A step with numbers for its conditions."""
    if len(step) < 4:
        return step
    *head, held, equations, shares = step
    own = [rows.setdefault(x, len(rows)) if isinstance(x, CubicRow) else x for x in held]
    return [*head, own, equations, shares]


def regrown(stated: StatedProblem, document: dict[str, Any], clock: Callable[[], None]) -> Tree:
    """The tree that a state proposes, each step proved again by the verifier's own kind.

    Parameters
    ----------
    stated : StatedProblem
    document : dict
        As `Tree.document` writes it; nothing in it is trusted.
    clock : callable
        Called before every step; ends it by raising.

    Raises
    ------
    TrajgapError, Refused
        If it is another kind of proof, or a step is not proved.
    """
    if document["kind"] != "cubic":
        raise TrajgapError("resume: the state proposes another kind of proof")
    kind = proof_kind("cubic")(stated, document, Fraction(0), Clock(math.inf))
    numbers = [*document["powers"], document["second"]]
    if not all(type(p) is int and abs(p) <= MOST_POWER for p in numbers):
        raise TrajgapError("resume: units are malformed")
    prover = Prover(CubicSystem(stated, document["powers"], document["second"], document["cap"]))
    known = [CubicRow(*row) for row in document["rows"]]
    judged: dict[TickBox, Any] = {}

    def taken(own: Any) -> TickBox:
        box = TickBox([], [], _floats(own), 0)
        _follow(box, own)
        judged[box] = own
        return box

    def cut(box: TickBox, k: int, at: int) -> tuple[TickBox, ...]:
        if box.closed:  # whatever was done to it once is not needed
            return box, box
        box.children = tuple(map(taken, kind.cut(judged[box], k, at)))
        box.steps.append([CUT, k, at])
        return box.children

    def named(step: Step) -> Step:
        if len(step) < 4:
            return step
        *head, held, equations, shares = step
        rows = [x for i, w in zip(held[::2], held[1::2], strict=True) for x in (known[i], w)]
        return [*head, rows, equations, shares]

    def step(box: TickBox, tag: str, data: list[Any]) -> None:
        clock()
        if not box.closed:
            kind.step(judged[box], tag, data)
            box.steps.append(named([tag, *data]))
            _follow(box, judged[box])

    def leaf(box: TickBox, data: list[Any]) -> None:
        if data and not box.closed:
            clock()
            kind.leaf(judged[box], data)
            box.steps.append(named([LEAF, *data]))
            box.closed = True

    root = taken(kind.root())
    regrow(document["tree"], root, cut, step, leaf)
    floor = min((box.floor for box in root.leaves()), default=prover.cap)
    return Tree(prover, root, min(floor, MOST_INTEGER))


def _follow(box: TickBox, own: Any) -> None:
    """Make a box what the verifier's is."""
    box.low, box.high, box.floor = list(own.low), list(own.high), own.floor
    box.ranges, box.closed = _floats(own), own.empty


def _floats(own: Any) -> tuple[Array, Array]:
    """The verifier's ranges, shape (unknowns, joints), rounded outward."""
    low, high = (
        np.array([[sign * np.inf if x is None else float(x[end]) for x in row] for row in own.x])
        for sign, end in ((-1, 0), (1, 1))
    )
    return np.nextafter(low.T, -np.inf), np.nextafter(high.T, np.inf)
