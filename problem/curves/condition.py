"""The linear conditions on the coefficients of a piecewise polynomial, one by one or as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class ConditionKind(IntEnum):
    """What one linear condition on the coefficients states."""

    LEFT_VALUE = 0
    """A derivative of the segment that ends at the break takes a given value."""
    RIGHT_VALUE = 1
    """A derivative of the segment that starts at the break takes a given value."""
    MATCH = 2
    """A derivative is the same on both sides of the break."""


@dataclass(frozen=True)
class Condition:
    """One condition: at break ``at``, derivative ``order``, of the kind ``kind``."""

    kind: ConditionKind
    at: int
    order: int


@dataclass(frozen=True, eq=False)
class ConditionTable:
    """The conditions of a declaration in order, as arrays of shape (conditions,)."""

    kinds: NDArray[np.int64]
    breaks: NDArray[np.int64]
    orders: NDArray[np.int64]

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """The same, one by one."""
        columns = (self.kinds.tolist(), self.breaks.tolist(), self.orders.tolist())
        return tuple(
            Condition(ConditionKind(kind), at, order)
            for kind, at, order in zip(*columns, strict=True)
        )


def counts_in_words(conditions: int, unknowns: int, of: str = "coefficients") -> str:
    """Both counts, such as "18 conditions, but only 14 coefficients"."""
    but = ", but only" if conditions > unknowns else " for"
    return f"{conditions} conditions{but} {unknowns} {of}"


def condition_table(given: Sequence[frozenset[int]], continuity: Sequence[int]) -> ConditionTable:
    """The conditions of a declaration, ordered by break: left values, right values, matches.

    Breaks that state the same share one template, so that long declarations take no loop over
    conditions.

    Parameters
    ----------
    given : sequence of frozenset of int, one per break
        Orders whose values are given there; 0 is the position.
    continuity : sequence of int, one per interior break

    Returns
    -------
    ConditionTable
    """
    last = len(given) - 1
    templates: dict[tuple[frozenset[int], int], int] = {}
    inner = (
        templates.setdefault(key, len(templates))
        for key in zip(given[1:-1], continuity, strict=True)
    )
    number = np.array([-1, *inner, -2])
    parts: list[tuple[NDArray[np.int64], ...]] = []

    def place(at: NDArray[np.int64], kinds: list[ConditionKind], orders: list[int]) -> None:
        rank = np.tile(np.arange(len(kinds)), at.size)
        breaks = np.repeat(at, len(kinds))
        parts.append((breaks, rank, np.tile(kinds, at.size), np.tile(orders, at.size)))

    for edge, kind in ((0, ConditionKind.RIGHT_VALUE), (last, ConditionKind.LEFT_VALUE)):
        orders = sorted(given[edge])
        place(np.array([edge]), [kind] * len(orders), orders)
    for (orders_given, smooth), i in templates.items():
        values = sorted(orders_given)
        matches = [order for order in range(smooth + 1) if order not in orders_given]
        kinds = [
            *[ConditionKind.LEFT_VALUE] * len(values),
            *[ConditionKind.RIGHT_VALUE] * len(values),
            *[ConditionKind.MATCH] * len(matches),
        ]
        place(np.flatnonzero(number == i), kinds, [*values, *values, *matches])
    breaks, rank, kinds_, orders_ = (
        np.concatenate([part[i] for part in parts]).astype(np.int64) for i in range(4)
    )
    order = np.lexsort((rank, breaks))
    return ConditionTable(kinds_[order], breaks[order], orders_[order])
