"""Calls of a solver that were made before, up to rounding: readings in other units ask the same."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from ...problem import Array

SAME = 1e-12
"""Difference, relative to a number or to 1, that is rounding: NLPs are written in units in which
their numbers are of order 1, and solved to 1e-9."""
CALLS = 256
"""Calls that are kept: an audit makes some hundred, and twins follow each other within these."""

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class _Call:
    """One call of a solver, with what it was given and what it answered."""

    solver: Any
    given: tuple[Array, ...]
    answer: Any

    def equals(self, solver: Any, given: Sequence[Array]) -> bool:
        """Whether another call asks the same."""
        if solver is not self.solver or len(given) != len(self.given):
            return False
        return all(_alike(one, other) for one, other in zip(given, self.given, strict=True))


_CALLS: ContextVar[deque[_Call] | None] = ContextVar("_CALLS", default=None)
"""The last calls that succeeded, inside of `kept_calls`."""


@contextmanager
def kept_calls() -> Iterator[None]:
    """Keep what solvers answer inside: for many problems of which some are others in new units.

    Elsewhere every call is made, so that no answer depends on what was asked before.
    """
    before = _CALLS.set(deque(maxlen=CALLS))
    try:
        yield
    finally:
        _CALLS.reset(before)


def _alike(one: Array, other: Array) -> bool:
    if one.shape != other.shape:
        return False
    with np.errstate(invalid="ignore"):  # two that are infinite
        near = np.abs(one - other) <= SAME * np.maximum(1.0, np.abs(other))
    return bool(((near & np.isfinite(other)) | (one == other)).all())


def solved_before(
    solver: Any, given: Sequence[Array], solve: Callable[[], T], succeeded: Callable[[T], bool]
) -> T:
    """The answer of an earlier call with the same numbers, or else that of ``solve``.

    Parameters
    ----------
    solver : Any
        Numbers given to another one ask something else.
    given : sequence of ndarray
        All numbers that the answer depends on.
    solve : callable
        Calls the solver.
    succeeded : callable
        Whether an answer is kept: one that the clock cut short is not.

    Returns
    -------
    Any
        It belongs to all who asked: nobody may alter it.
    """
    calls = _CALLS.get()
    if calls is None:
        return solve()
    for call in calls:
        if call.equals(solver, given):
            found: T = call.answer
            return found
    answer = solve()
    if succeeded(answer):
        calls.append(_Call(solver, tuple(np.array(part) for part in given), answer))
    return answer
