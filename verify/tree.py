"""The one walk through the tree of a proof, and what a kind of proof supplies to it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from enum import StrEnum
from fractions import Fraction
from typing import Any, ClassVar, Generic, NoReturn, TypeVar

from .problem import StatedProblem
from .ranges import MOST_DEPTH, MOST_NODES, MOST_SEGMENTS
from .reading import Clock, Refused, listed, need, shown, text, whole

B = TypeVar("B")

CUT, LEAF, OPEN = "/", ".", "?"
"""Tags of a cut at a stated place, of a leaf, and of a leaf that nothing proves yet.

The last one stands in the proposals of a state only: no proof has it.
"""


class Subject(StrEnum):
    """What a certificate speaks about."""

    DECLARED = "the declared curve"
    """Curves of the declared kind through the way-points."""
    ANY = "any curve"
    """All curves through the way-points that keep the limits."""


class ProofKind(ABC, Generic[B]):
    """One kind of proof that no feasible total is below ``total``; B is its kind of box.

    Parameters
    ----------
    problem : StatedProblem
    proof : dict
        With the keys ``kind``, ``total``, ``tree`` and those in `keys`.
    total : Fraction
        s.
    clock : Clock
        For whatever takes long.

    Raises
    ------
    Refused
        If the problem is not covered, or the tables of the proof make no sense.
    """

    subject: ClassVar[Subject] = Subject.DECLARED
    keys: ClassVar[tuple[str, ...]] = ()
    """Of ``proof``, besides the three that all have."""

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        self.problem, self.total, self.clock = problem, total, clock

    @abstractmethod
    def root(self) -> B:
        """The box that holds every feasible answer with a total below ``total``."""

    @abstractmethod
    def cut(self, box: B, coordinate: int, place: Any) -> tuple[B, B]:
        """Both parts of a box, the lower one first; None is the place that the kind sets."""

    def step(self, box: B, tag: str, data: list[Any]) -> B:
        """A smaller box in which all is that is feasible in this one; most kinds have no steps."""
        raise Refused(f"the tree has an unknown tag {shown(repr(tag))}")

    @abstractmethod
    def leaf(self, box: B, data: list[Any]) -> None:
        """Refuse a box unless nothing in it is feasible with a total below ``total``."""

    def end(self) -> None:
        """Refuse what was put off until the walk is over."""
        return

    @property
    def infeasible(self) -> bool:
        """Whether the proof shows that nothing is feasible, whatever its total."""
        return False


def walk(kind: ProofKind[B], tree: Any, clock: Clock) -> None:
    """Walk through a tree in preorder, and refuse it unless every leaf is proved.

    Parameters
    ----------
    kind : ProofKind
    tree : Any
        List of nodes: an integer k or ``["/", k, place]`` cuts a box across coordinate k, and the
        lower part comes first; ``[".", ...]`` is a leaf; a list with another tag is a step, after
        which the smaller box comes.
    clock : Clock

    Raises
    ------
    Refused
        At the first node that is not proved.
    """
    nodes = listed(tree, "tree", MOST_NODES, 1)
    waiting = [kind.root()]
    for count, node in enumerate(nodes):
        clock.check()
        need(bool(waiting), "the tree has too many nodes")
        box = waiting.pop()
        if type(node) is int:
            waiting += reversed(kind.cut(box, whole(node, 0, MOST_SEGMENTS), None))
            need(len(waiting) <= MOST_DEPTH, "the tree is too deep")
            continue
        need(type(node) is list and len(node) > 0, f"malformed: node {count} of the tree")
        tag, data = text(node[0], "a tag of the tree"), node[1:]
        if tag == LEAF:
            try:
                kind.leaf(box, data)
            except Refused as error:
                raise Refused(f"leaf at node {count}: {error}") from None
        elif tag == CUT:
            coordinate, place = listed(data, "a cut", 2, 2)
            waiting += reversed(kind.cut(box, whole(coordinate, 0, MOST_SEGMENTS), place))
            need(len(waiting) <= MOST_DEPTH, "the tree is too deep")
        elif tag == OPEN:
            _open(count)
        else:
            waiting.append(kind.step(box, tag, data))
    need(not waiting, "the tree leaves a part open")
    kind.end()


def _open(count: int) -> NoReturn:
    raise Refused(f"the tree leaves a part open: node {count}")
