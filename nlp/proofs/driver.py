"""The one search through a tree of boxes, whatever the kind of proof: order, workers, clock."""

from __future__ import annotations

import heapq
import itertools
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from ...problem import TrajgapError
from ...verify import CUT, LEAF, OPEN
from .crew import Common, ProofPiece

if TYPE_CHECKING:
    from .session import Session

B = TypeVar("B")


class Branching(ABC, Generic[B]):
    """What a kind of proof says of its boxes; B is its kind of box.

    Boxes are worked on by a function of a module, anywhere; what comes of them is taken here.
    """

    ahead: ClassVar[int]
    """Boxes that are under way at a time. It does not depend on the number of workers, and what
    comes of the boxes is taken in the order in which they were taken up: so the tree does not
    depend on who worked on them."""
    work: ClassVar[Callable[..., Any]]
    """Of ``common.value`` and what `given` says; a static method of the class."""
    common: Common

    @abstractmethod
    def order(self, box: B) -> Any:
        """The least one is taken up next."""

    @abstractmethod
    def wanted(self, box: B) -> bool:
        """Whether a box that is next is to be worked on; if not, none is."""

    @abstractmethod
    def given(self, box: B) -> tuple[Any, ...]:
        """What is told of a box that is taken up."""

    @abstractmethod
    def taken(self, box: B, found: Any) -> Iterable[B]:
        """Take what came of a box; returns the boxes that are left of it."""

    @abstractmethod
    def look(self, waiting: int) -> None:
        """Report before each box; with the number of those that wait or are under way."""


def grow(branching: Branching[B], boxes: Iterable[B], session: Session) -> None:
    """Work on boxes until none is wanted any more.

    Raises
    ------
    OutOfTime
        When the time, or the boxes that are allowed, are over.
    """
    number, crew = itertools.count(), session.crew
    heap = [(branching.order(box), next(number), box) for box in boxes]
    heapq.heapify(heap)
    under_way: deque[tuple[B, ProofPiece]] = deque()
    try:
        with session.searching():
            while True:
                branching.look(len(heap) + len(under_way))
                session.check_clock()
                while heap and len(under_way) < branching.ahead and branching.wanted(heap[0][2]):
                    box = heapq.heappop(heap)[2]
                    piece = crew.begin(branching.work, branching.common, *branching.given(box))
                    under_way.append((box, piece))
                if not under_way:
                    return
                box, piece = under_way[0]
                found = crew.value(piece, session.check_clock)
                under_way.popleft()
                for part in branching.taken(box, found):
                    heapq.heappush(heap, (branching.order(part), next(number), part))
    finally:
        crew.drop(piece for _, piece in under_way)


def regrow(
    nodes: Iterable[Any],
    root: B,
    cut: Callable[..., tuple[B, ...]],
    step: Callable[[B, str, list[Any]], None],
    leaf: Callable[[B, list[Any]], None],
) -> None:
    """Grow the tree that a state proposes again, in preorder; nothing in it is trusted.

    Parameters
    ----------
    nodes : iterable of list
        As in documents.
    root : B
    cut : callable
        Given a box and the rest of the node: both parts.
    step : callable
        Given a box, the tag and the rest of the node; changes the box.
    leaf : callable
        Given a box and the rest of the node; of open leaves nothing is left.

    Raises
    ------
    TrajgapError
        If the nodes are not those of a tree.
    """
    waiting = [root]
    for node in nodes:
        if not waiting or not isinstance(node, list) or not node:
            raise TrajgapError("resume: the tree is malformed")
        box, tag, data = waiting.pop(), node[0], node[1:]
        if tag == CUT:
            waiting += reversed(cut(box, *data))
        elif tag in (LEAF, OPEN):
            leaf(box, data)
        else:
            step(box, tag, data)
            waiting.append(box)
    if waiting:
        raise TrajgapError("resume: the tree leaves a part open")
