"""The one walk through the tree of a proof, and what a kind of proof supplies to it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from copy import copy
from enum import StrEnum
from fractions import Fraction
from typing import Any, ClassVar, Generic, Self, TypeVar

from .problem import StatedProblem
from .ranges import MOST_DEPTH, MOST_NODES, MOST_SEGMENTS
from .reading import Clock, Refused, listed, need, shown, text, whole

B = TypeVar("B")

Spread = Callable[[Callable[..., Any], Any, Iterable[tuple[Any, ...]]], Iterable[Any]]
"""Calls a function with something in common and each of the tuples, and gives what it returns."""

_PARTS = 12
"""Parts of a tree, about: some for each of a few cores. One process walks what is above them, so
more would keep the others waiting."""
CUT, LEAF, OPEN = "/", ".", "?"
"""Tags of a cut at a stated place, of a leaf, and of a leaf that nothing proves yet.

The last one stands in the proposals of a state only: no proof has it.
"""


class Subject(StrEnum):
    """The motions that a certificate is about."""

    DECLARED = "the declared curve"
    """Curves of the declared kind through the way-points."""
    ANY = "any curve"
    """All curves through the way-points that keep the limits."""


class ProofKind(ABC, Generic[B]):
    """One kind of proof that no feasible total is below ``total``; B is its kind of box.

    Parameters
    ----------
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
    apart: ClassVar[int] = 0
    """Nodes of a part at least where what is below a box is judged by itself, so parts of a
    tree may be judged in any order and elsewhere: fewer are not worth handing out. 0 without."""

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        self.problem, self.total, self.clock = problem, total, clock
        self.read(proof)

    @abstractmethod
    def read(self, proof: dict[str, Any]) -> None:
        """Read what ``proof`` states beside its tree, and refuse a problem that is not covered."""

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

    def alone(self) -> Self:
        """A copy for one part of the tree, which shares nothing that changes with other parts."""
        return copy(self)

    def end(self) -> None:
        """Refuse what was put off until the walk is over."""
        return

    @property
    def infeasible(self) -> bool:
        """Whether the proof shows that nothing is feasible, whatever its total."""
        return False


def walk(kind: ProofKind[B], tree: Any, clock: Clock, spread: Spread | None = None) -> None:
    """Walk through a tree in preorder, and refuse it unless every leaf is proved.

    Parameters
    ----------
    tree : Any
        List of nodes: an integer k or ``["/", k, place]`` cuts a box across coordinate k, and the
        lower part comes first; ``[".", ...]`` is a leaf; a list with another tag is a step, after
        which the smaller box comes.
    spread : callable, optional
        Where parts of the tree are walked, if its kind has parts; see `verify_certificate`.

    Raises
    ------
    Refused
        At a node that is not proved; the first one, unless parts are walked elsewhere.
    """
    nodes = listed(tree, "tree", MOST_NODES, 1)
    sizes = _sizes(nodes) if spread is not None and kind.apart else None
    every, handed, judged = _walked(kind, kind.root(), nodes, clock, sizes), 0, 0

    def parts() -> Iterator[tuple[B, list[Any], int, float]]:
        nonlocal handed
        for part in every:
            handed += 1
            yield part

    # Whoever judges the parts proves nothing by leaving one out.
    for why in (spread or _here)(_walked_part, kind, parts()):
        clock.check()
        need(why is None, why or "")
        judged += 1
    need(next(every, None) is None and judged == handed, "a part of the tree was not judged")
    kind.end()


def _here(work: Callable[..., Any], common: Any, items: Iterable[tuple[Any, ...]]) -> Iterable[Any]:
    return (work(common, *item) for item in items)


def _walked(
    kind: ProofKind[B],
    root: B,
    nodes: list[Any],
    clock: Clock,
    sizes: list[int] | None = None,
    first: int = 0,
) -> Iterator[tuple[B, list[Any], int, float]]:
    """Walk through the nodes below a box, the first of which has a place among all.

    Where the sizes of subtrees are given, those that are small are left out: each is given with its
    box, its place and the seconds that are left.
    """
    waiting, at, most = [root], 0, max(kind.apart, len(nodes) // _PARTS)
    while at < len(nodes):
        clock.check()
        need(bool(waiting), "the tree has too many nodes")
        box, size = waiting.pop(), 1
        if sizes is not None and sizes[at] <= most:
            size = sizes[at]
            yield box, nodes[at : at + size], at, clock.left
        else:
            waiting += reversed(_below(kind, box, nodes[at], first + at))
            need(len(waiting) <= MOST_DEPTH, "the tree is too deep")
        at += size
    need(not waiting, "the tree leaves a part open")


def _below(kind: ProofKind[B], box: B, node: Any, count: int) -> tuple[B, ...]:
    """The boxes that a node leaves of a box: none where it is proved."""
    if type(node) is int:
        return kind.cut(box, whole(node, 0, MOST_SEGMENTS), None)
    need(type(node) is list and len(node) > 0, f"malformed: node {count} of the tree")
    tag, data = text(node[0], "a tag of the tree"), node[1:]
    if tag == LEAF:
        try:
            kind.leaf(box, data)
        except Refused as error:
            raise Refused(f"leaf at node {count}: {error}") from None
        return ()
    if tag == CUT:
        coordinate, place = listed(data, "a cut", 2, 2)
        return kind.cut(box, whole(coordinate, 0, MOST_SEGMENTS), place)
    if tag == OPEN:
        raise Refused(f"the tree leaves a part open: node {count}")
    return (kind.step(box, tag, data),)


def _sizes(nodes: list[Any]) -> list[int] | None:
    """How many nodes the subtree of each node has; None if they are not those of one tree."""
    sizes, waiting = [0] * len(nodes), list[int]()
    for at in range(len(nodes) - 1, -1, -1):
        node = nodes[at]
        tag = node[0] if type(node) is list and node else CUT
        below = 2 if tag == CUT else 0 if tag in (LEAF, OPEN) else 1
        if len(waiting) < below:
            return None
        sizes[at] = 1 + sum(waiting.pop() for _ in range(below))
        waiting.append(sizes[at])
    return sizes if len(waiting) == 1 else None


def _walked_part(
    kind: ProofKind[B], box: B, nodes: list[Any], first: int, left: float
) -> str | None:
    """Why a part of a tree is refused; None if it is proved."""
    own = kind.alone()
    own.clock.shorten(left)
    try:
        for _ in _walked(own, box, nodes, own.clock, first=first):
            pass
        own.end()
    except Refused as error:
        return str(error)
    return None
