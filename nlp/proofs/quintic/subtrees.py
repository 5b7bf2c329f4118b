"""One search in parts that anybody may run, joined in the order in which one core goes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ....problem import Array
from ....verify import OutOfTime
from ...optimum import time_up
from ..crew import Common
from ..driver import Branching
from .leaves import Leaves
from .search import DEEP, FULL, PAUSED, SHORTER, search

Place = tuple[int, ...]
"""Where a part begins: sorted, places are in preorder."""


@dataclass(frozen=True, eq=False)
class Stage:
    """What all parts of one stage share, in the units of the proof.

    Attributes
    ----------
    steps : ndarray, shape (segments, joints)
    limits : ndarray, shape (joints, 3)
    total : float
        No durations are to add up to it.
    windows : ndarray
        Conditions of all motions.
    look : float
        A direction whose total seems to be below it ends a part; 0 for none.
    part : int
        Boxes of a part: about a second, beside which handing it out costs nothing.
    stack : int
        Boxes that wait: depth first, more than the deepest tree that the verifier takes.
    """

    steps: Array
    limits: Array
    total: float
    windows: Array
    look: float
    part: int = 5_000
    stack: int = 600

    @property
    def between_looks(self) -> int:
        """Boxes between two looks at the clock, which take less than a tenth of a second.

        To 8 segments 500 do; beyond, a box takes time of the third power.
        """
        return min(self.part, max(1, int(500 * min(1.0, 8 / len(self.steps)) ** 3)))


@dataclass(frozen=True, eq=False)
class Root:
    """A box to go on from.

    Attributes
    ----------
    low, high : ndarray, shape (segments,)
    place : tuple of int
    height : int
        Boxes that wait below it.
    seen : bool
        Its own direction was looked at already.
    wary : bool
        Whether directions are looked at.
    """

    low: Array
    high: Array
    place: Place = ()
    height: int = 0
    seen: bool = False
    wary: bool = True


@dataclass(frozen=True, eq=False)
class Part:
    """What was done below a root: leaves in preorder, then what is left, the next box first.

    Attributes
    ----------
    leaves : Leaves
    rest : tuple of Root
    boxes : int
        Visited.
    code : int
        Why it ended: `DONE`, `PAUSED`, `SHORTER` (at the first of ``rest``) or `DEEP`.
    """

    leaves: Leaves
    rest: tuple[Root, ...]
    boxes: int
    code: int


def search_part(stage: Stage, root: Root) -> Part:
    """Search below a box until it is empty, a part's boxes are visited or time is up.

    Returns
    -------
    Part
        But for the clock, a function of stage and root alone.
    """
    n, joints = stage.steps.shape
    low, high = (np.zeros((stage.stack - root.height, n)) for _ in range(2))
    low[0], high[0] = root.low, root.high
    depth, counts = np.array([1]), np.zeros(3, np.int64)
    leaves, seen = Leaves.empty(), root.seen
    while True:
        look = stage.look if root.wary and not seen else 0.0
        code = search(
            n, joints, stage.steps, stage.limits, stage.total, stage.windows,
            low, high, depth, 1 if seen else stage.between_looks, look, *leaves.arrays, counts,
        )  # fmt: skip
        if code == FULL:
            leaves = leaves.larger()
            continue
        seen = False
        if code != PAUSED or counts[0] >= stage.part or time_up():
            break
    top = int(depth[0]) - 1
    rest = tuple(
        Root(
            low[i], high[i], (*root.place, top - i), root.height + i,
            code == SHORTER and i == top, root.wary,
        )
        for i in range(top, -1, -1)
    )  # fmt: skip
    return Part(leaves.trimmed(), rest, int(counts[0]), int(code))


class Parts(Branching[Root]):
    """Search below boxes, part by part.

    Parameters
    ----------
    stage : Stage
    look : callable
        Given durations whose total seems to be below ``stage.look``: whether to go on looking.
        It raises `Shorter` where they are what they seem to be.
    watch : callable
        Given the roots that wait and the boxes visited.
    """

    ahead = 8
    work = staticmethod(search_part)

    def __init__(
        self, stage: Stage, look: Callable[[Array], bool], watch: Callable[[int, int], None]
    ) -> None:
        self.common, self._look, self._watch = Common(stage), look, watch
        self._found: dict[Place, Leaves] = {}
        self._boxes = 0

    @property
    def leaves(self) -> Leaves:
        """Those of all parts."""
        return Leaves.joined([self._found[place] for place in sorted(self._found)])

    def order(self, box: Root) -> Place:
        """In preorder."""
        return box.place

    def wanted(self, box: Root) -> bool:
        """Every box is."""
        return True

    def given(self, box: Root) -> tuple[Root]:
        """The box."""
        return (box,)

    def taken(self, box: Root, found: Part) -> tuple[Root, ...]:
        """What is left of a part, once the direction that ended it was looked at."""
        self._boxes += found.boxes
        self._found[box.place] = found.leaves
        if found.code == DEEP:
            raise OutOfTime
        first = found.rest[0] if found.code == SHORTER else None
        if first is None or self._look(2.0 / (1.0 / first.low + 1.0 / first.high)):
            return found.rest
        return tuple(replace(one, wary=False) for one in found.rest)

    def look(self, waiting: int) -> None:
        """Report."""
        self._watch(waiting, self._boxes)
