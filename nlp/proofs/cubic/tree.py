"""The tree of a proof: the verifier's boxes, what narrowed them, and the document of it all."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from ....problem import TrajgapError
from ....verify import CUT, LEAF, MIX_DIGITS, MOST_INTEGER, OPEN, TICKS, Refused, StatedProblem
from ....verify.cubic import Box, Spot, least
from ..driver import regrow
from ..exact import decimal
from .relaxation import Proposal
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

    Wherever an interrupt strikes, steps stand for what was done: each is written down before it is
    taken.

    Attributes
    ----------
    own : Box
        The verifier's.
    steps : list of Step
        What was done to it, in this order.
    children : tuple of TickBox
        After a cut.
    """

    own: Box
    steps: list[Step] = field(default_factory=list)
    children: tuple[TickBox, ...] = ()

    @property
    def closed(self) -> bool:
        """Whether nothing below the cap is feasible in it."""
        return self.own.empty

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
    """Carries out steps, each only if it is proved, by the verifier's own arithmetic."""

    def __init__(self, system: CubicSystem) -> None:
        self.system, self.exact, self.kind = system, system.exact, system.kind

    def root(self) -> TickBox:
        """Box of everything feasible below the cap."""
        return TickBox(self.kind.root())

    def narrow(self, box: TickBox) -> None:
        """Narrow the ranges of the unknowns."""
        box.steps.append(["r"])
        box.own.narrow(self.exact, self.kind.clock)

    def bound(self, box: TickBox, proposal: Proposal) -> tuple[Fraction, int, list[Any]] | None:
        """Proved bound of the target, in ticks, with its weight and all others, as in a node.

        Without a target, whether the bound is positive says that the box is empty.
        """
        system, target = self.system, proposal.target
        scale = max((abs(w) for w in target.values()), default=1)
        if scale < 1:
            return None
        held, equations = proposal.weights
        known = [system.terms(row)[0] for row in proposal.rows]
        mix = ""

        def shares(spots: list[Spot]) -> str:
            nonlocal mix
            mix = "".join(MIX_DIGITS[proposal.mix[spot]] for spot in spots)
            return mix

        try:
            value = least(self.exact, box.own, known, target, held, equations, shares)
        except Refused:
            return None
        weights = _renamed([held, equations, mix], proposal.rows.__getitem__)
        return Fraction(value) * TICKS / scale, scale, weights

    def tighten(
        self, box: TickBox, coordinate: int, sign: int, proposal: Proposal, worth: int
    ) -> None:
        """Move a side inward, if by ``worth`` ticks at least."""
        own = box.own
        low, high = own.low[coordinate], own.high[coordinate]
        old = low if sign > 0 else -high
        # A program has few tangents: more than its bound may be proved.
        if proposal.value * TICKS < old:
            return
        found = self.bound(box, proposal)
        if found is None or math.floor(found[0]) - old < worth:
            return
        # One tick beyond the other side says that the box is empty, which is all there is to say.
        value = min(math.floor(found[0]), high + 1 if sign > 0 else 1 - low) * sign
        box.steps.append(["t", coordinate, sign, value, found[1], *found[2]])
        own.move(self.exact, coordinate, sign, value)

    def lift(self, box: TickBox, proposal: Proposal) -> None:
        """Raise the floor."""
        found = self.bound(box, proposal)
        if found is not None and math.floor(found[0]) > box.own.floor:
            value = min(math.floor(found[0]), self.system.cap)
            box.steps.append(["f", value, found[1], *found[2]])
            box.own.floor = value
            box.own.trim(self.exact)

    def clear(self, box: TickBox, proposal: Proposal) -> None:
        """Close a box that is empty."""
        found = self.bound(box, proposal)
        if found is not None and found[0] > 0:
            box.steps.append([LEAF, *found[2]])
            box.own.empty = True

    def halve(self, box: TickBox, coordinate: int) -> tuple[TickBox, ...]:
        """Halve a box."""
        return self.cut(box, coordinate, (box.own.low[coordinate] + box.own.high[coordinate]) // 2)

    def cut(self, box: TickBox, coordinate: int, at: int) -> tuple[TickBox, ...]:
        """Cut a box."""
        halves = tuple(TickBox(own) for own in self.kind.cut(box.own, coordinate, at))
        box.steps.append([CUT, coordinate, at])
        box.children = halves
        return halves


@dataclass(frozen=True, eq=False)
class Tree:
    """The proof of a lower bound, in ticks; unfinished: open boxes of it are proposed."""

    prover: Prover
    root: TickBox
    lower: int = 0
    unfinished: bool = False

    @property
    def grown(self) -> Tree:
        """It, with the bound that its open leaves prove by now."""
        cap = self.prover.system.cap
        lower = min((box.own.floor for box in self.root.leaves()), default=cap)
        return replace(self, lower=min(lower, MOST_INTEGER))

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
            tree += [_renamed(step, lambda row: rows.setdefault(row, len(rows))) for step in steps]
            if box.children:
                stack += reversed(box.children)
            elif not (steps and steps[-1][0] == LEAF):
                tree.append([OPEN if self.unfinished and not box.closed else LEAF])
        return {
            "kind": "cubic",
            "total": decimal(self.seconds),
            **system.units,
            "rows": [list(row) for row in rows],
            "tree": tree,
        }


def _serves(box: TickBox, step: Step) -> bool:
    """Whether a floor is needed: it closes the box, or something below it is open."""
    if box.closed:
        return step is box.steps[-1]
    last = [s for s in box.steps if s[0] == "f"][-1]
    return step is last and next(box.leaves(), None) is not None


def _renamed(step: Step, name: Callable[[Any], Any]) -> Step:
    """A step, or weights, with other names for the conditions."""
    if len(step) < 3 or step[0] == CUT:
        return step
    *head, held, equations, shares = step
    pairs = zip(held[::2], held[1::2], strict=True)
    return [*head, [x for row, w in pairs for x in (name(row), w)], equations, shares]


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
    units = {key: document[key] for key in ("powers", "second", "cap", "root")}
    prover = Prover(CubicSystem(stated, units, document["rows"]))
    kind = prover.kind
    known = [CubicRow(*row) for row in document["rows"]]

    def cut(box: TickBox, k: int, at: int) -> tuple[TickBox, ...]:
        # Whatever was done to a closed box once is not needed.
        return (box, box) if box.closed else prover.cut(box, k, at)

    def step(box: TickBox, tag: str, data: list[Any]) -> None:
        clock()
        if not box.closed:
            kind.step(box.own, tag, data)
            box.steps.append(_renamed([tag, *data], known.__getitem__))

    def leaf(box: TickBox, data: list[Any]) -> None:
        if data and not box.closed:
            clock()
            kind.leaf(box.own, data)
            box.steps.append(_renamed([LEAF, *data], known.__getitem__))
            box.own.empty = True

    root = prover.root()
    regrow(document["tree"], root, cut, step, leaf)
    return Tree(prover, root).grown
