"""One search in parts that any executor may run, joined in the order in which one core goes."""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, replace

import numpy as np

from ....problem import Array
from ..session import OutOfTime, Shorter
from .leaves import Leaves
from .search import DEEP, FULL, PAUSED, SHORTER, search

_PART = 5_000
"""Boxes of a part: about a second, beside which handing it out costs nothing."""
_CHUNK = 500
"""Boxes between two looks at the clock, to `_USUAL` segments: less than a tenth of a second."""
_USUAL = 8
"""Segments up to which that holds; beyond, a box takes time of the third power."""
_AHEAD = 2
"""Parts handed out for each worker: the next one is there when it ends one."""
_STACK = 600
"""Boxes that wait: depth first, more than the deepest tree that the verifier takes."""
_LOOK = 0.1
"""Seconds between two looks at the clock while parts run elsewhere."""

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
    """

    steps: Array
    limits: Array
    total: float
    windows: Array
    look: float


@dataclass(frozen=True, eq=False)
class Root:
    """A box to go on from.

    Attributes
    ----------
    low, high : ndarray, shape (segments,)
    height : int
        Boxes that wait below it.
    seen : bool
        Its own direction was looked at already.
    wary : bool
        Whether directions are looked at.
    """

    low: Array
    high: Array
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


def between_looks(segments: int) -> int:
    """Boxes of a spline of so many segments that are searched without a look at the clock."""
    return max(1, int(_CHUNK * min(1.0, _USUAL / segments) ** 3))


def search_part(stage: Stage, root: Root, seconds: float, until: float = math.inf) -> Part:
    """Search below a box until it is empty, `_PART` boxes are visited or time is up.

    Parameters
    ----------
    stage : Stage
    root : Root
    seconds : float
        From now.
    until : float
        And no longer than this, by `time.time`: a part may have waited for its turn.

    Returns
    -------
    Part
        But for the clock, a function of stage and root alone.
    """
    ends = time.monotonic() + min(seconds, until - time.time())
    n, joints = stage.steps.shape
    low, high = (np.zeros((_STACK - root.height, n)) for _ in range(2))
    low[0], high[0] = root.low, root.high
    depth, counts = np.array([1]), np.zeros(3, np.int64)
    leaves, seen = Leaves.empty(), root.seen
    chunk = between_looks(n)
    while True:
        look = stage.look if root.wary and not seen else 0.0
        code = search(
            n, joints, stage.steps, stage.limits, stage.total, stage.windows,
            low, high, depth, 1 if seen else chunk, look, *leaves.arrays, counts,
        )  # fmt: skip
        if code == FULL:
            leaves = leaves.larger()
            continue
        seen = False
        if code != PAUSED or counts[0] >= _PART or time.monotonic() > ends:
            break
    top = int(depth[0]) - 1
    rest = tuple(
        Root(low[i], high[i], root.height + i, code == SHORTER and i == top, root.wary)
        for i in range(top, -1, -1)
    )
    return Part(leaves.trimmed(), rest, int(counts[0]), int(code))


def search_all(
    stage: Stage,
    root: Root,
    look: Callable[[Array], bool],
    watch: Callable[[int, int], float],
    executor: Executor,
    workers: int,
) -> Leaves:
    """Search below a box, part by part; the same tree on any number of workers.

    Parameters
    ----------
    stage : Stage
    root : Root
    look : callable
        Given durations whose total seems to be below ``stage.look``: whether to go on looking.
        It raises `Shorter` where they are what they seem to be.
    watch : callable
        Given the roots that wait and the boxes visited since it was last asked: the seconds left.
        It raises when time is up.
    executor : concurrent.futures.Executor
    workers : int
        Parts that it runs at a time.

    Returns
    -------
    Leaves

    Raises
    ------
    Shorter, OutOfTime
        What ends the search first in preorder, so that the order in which parts come back is
        nowhere seen. `OutOfTime` says that the tree is too deep.
    """
    waiting: list[tuple[Place, Root]] = [((), root)]
    running: dict[Future[Part], Place] = {}
    found: dict[Place, Leaves] = {}
    ended: tuple[Place, Exception] | None = None
    boxes = 0
    try:
        while waiting or running:
            left = watch(len(waiting) + len(running), boxes)
            boxes, until = 0, time.time() + left
            while waiting and len(running) < _AHEAD * workers:
                place, one = heapq.heappop(waiting)
                if ended is None or place < ended[0]:
                    running[executor.submit(search_part, stage, one, left, until)] = place
            for future in wait(running, _LOOK, FIRST_COMPLETED).done:
                place, part = running.pop(future), future.result()
                boxes += part.boxes
                found[place] = part.leaves
                try:
                    rest = _going_on(part, look)
                except (Shorter, OutOfTime) as error:
                    if ended is None or place < ended[0]:
                        ended = place, error
                else:
                    for i, one in enumerate(rest):
                        heapq.heappush(waiting, ((*place, i), one))
    finally:
        for future in running:
            future.cancel()
    if ended is not None:
        raise ended[1]
    return Leaves.joined([found[place] for place in sorted(found)])


def _going_on(part: Part, look: Callable[[Array], bool]) -> tuple[Root, ...]:
    """What is left of a part, once the direction that ended it was looked at."""
    if part.code == DEEP:
        raise OutOfTime
    if part.code != SHORTER or look(2.0 / (1.0 / part.rest[0].low + 1.0 / part.rest[0].high)):
        return part.rest
    return tuple(replace(one, wary=False) for one in part.rest)
