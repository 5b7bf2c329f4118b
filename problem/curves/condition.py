"""The linear conditions on the coefficients of a piecewise polynomial, stated once as numbers.

A condition on derivative r at break b is an equation of one segment k, the one that ends at b, or
starts there where only that side is meant. Its unit of time is h_k, so its entries are

    Σ_p p!/(p − r)! c[k, p]                 at the end of the segment,  r! c[k, r]  at its start,
    − r! (h_k/h_b)ʳ c[b, r]                 where both sides match,
    = h_kʳ · value                          where one is given.

Rows, columns, whole factors and powers of h stand in `Conditions`; whoever needs the system takes
them from there, over any kind of number that can be divided and multiplied.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .polynomials import MAX_COEFFICIENTS, PERM

Indices = NDArray[np.int64]


class ConditionKind(IntEnum):
    """What one linear condition on the coefficients states."""

    LEFT_VALUE = 0
    """A derivative of the segment that ends at the break takes a given value."""
    RIGHT_VALUE = 1
    """A derivative of the segment that starts at the break takes a given value."""
    MATCH = 2
    """A derivative is the same on both sides of the break."""


@dataclass(frozen=True, eq=False)
class Conditions:
    """Conditions in order, ordered by break, so their linear system is banded.

    Attributes
    ----------
    kinds, breaks, orders : ndarray of int, shape (conditions,)
    degrees : ndarray of int, shape (segments,)
    """

    kinds: Indices
    breaks: Indices
    orders: Indices
    degrees: Indices

    @cached_property
    def first(self) -> Indices:
        """Column of each segment's constant coefficient, and their number; (segments + 1,)."""
        return np.concatenate([[0], np.cumsum(self.degrees + 1)])

    @cached_property
    def segment(self) -> Indices:
        """Segment in whose unit of time each condition is written."""
        return np.where(self.kinds == ConditionKind.RIGHT_VALUE, self.breaks, self.breaks - 1)

    @cached_property
    def powers(self) -> Indices:
        """Power of that segment's duration on the right-hand side; 0 where nothing is given."""
        return np.where(self.kinds == ConditionKind.MATCH, 0, self.orders)

    @cached_property
    def entries(self) -> tuple[Indices, Indices]:
        """Columns and whole factors, each (conditions, widest); a factor of 0 fills up a row."""
        last, r = MAX_COEFFICIENTS - 1, self.orders[:, None]
        power, degree = r + np.arange(int(self.degrees.max()) + 2), self.degrees[self.segment]
        # At the start of a segment one coefficient alone is met.
        alone = (self.kinds == ConditionKind.RIGHT_VALUE) & (self.orders < degree)
        there = power <= np.where(alone, self.orders, degree)[:, None]
        columns = np.where(there, self.first[self.segment, None] + power, 0)
        whole = PERM.astype(np.int64)[np.minimum(power, last), np.minimum(r, last)]
        factors, r = np.where(there, whole, 0), self.orders
        i, slot = self.links
        b = self.breaks[i]
        columns[i, slot] = self.first[b] + r[i]
        factors[i, slot] = -PERM[r[i], r[i]]
        return columns, factors

    @cached_property
    def links(self) -> tuple[Indices, Indices]:
        """Where the entries across a break stand: they alone hold durations, (h_{b−1}/h_b)ʳ."""
        i = np.flatnonzero(self.kinds == ConditionKind.MATCH)
        i = i[self.orders[i] <= self.degrees[self.breaks[i]]]
        return i, np.maximum(self.degrees[self.segment[i]] - self.orders[i] + 1, 0)

    @cached_property
    def alone(self) -> tuple[Indices, Indices]:
        """Rows of one entry, which gives a coefficient at once, and the column of that."""
        rows = np.flatnonzero(np.count_nonzero(self.entries[1], axis=1) == 1)
        return rows, self.entries[0][rows, 0]

    def matrix(self, durations: NDArray[Any]) -> NDArray[Any]:
        """Entries of all rows, shape (conditions, widest), over the durations' kind of number.

        They may be floats of any precision, or objects: fractions, symbols.
        """
        values = self.entries[1].astype(durations.dtype)
        i, slot = self.links
        b = self.breaks[i]
        values[i, slot] = values[i, slot] * (durations[b - 1] / durations[b]) ** self.orders[i]
        return values

    def rates(self, durations: NDArray[Any]) -> NDArray[Any]:
        """What multiplies the given values, h_kʳ, shape (conditions,)."""
        found = np.ones(self.kinds.size, dtype=durations.dtype)
        i = np.flatnonzero(self.powers)
        found[i] = durations[self.segment[i]] ** self.powers[i]
        return found

    def dense(self, values: NDArray[Any]) -> NDArray[Any]:
        """Entries, as from `matrix`, in a full matrix of shape (conditions, coefficients)."""
        out = np.zeros((self.kinds.size, int(self.first[-1])), dtype=values.dtype)
        columns, factors = self.entries
        row, slot = np.nonzero(factors)
        out[row, columns[row, slot]] = values[row, slot]
        return out


@dataclass(frozen=True, eq=False)
class Layout(Conditions):
    """The conditions of a determined declaration, what they give, and the unknowns' numbers.

    Attributes
    ----------
    name : str
        The declaration's, for messages.
    prescribed : ndarray, shape (conditions, joints or 1)
        Given derivatives, rad/sᵒʳᵈᵉʳ.
    waypoint, nodal : ndarray of int, shape (conditions,)
        Way-point, or free derivative, that a condition gives; −1 for none.
    """

    name: str
    prescribed: Array
    waypoint: Indices
    nodal: Indices

    @property
    def segments(self) -> int:
        """Number of segments."""
        return self.degrees.size

    @cached_property
    def places(self) -> tuple[Indices, Indices]:
        """Segment and power of each coefficient."""
        segment = np.repeat(np.arange(self.segments), np.diff(self.first))
        return segment, np.arange(self.first[-1]) - self.first[segment]

    @cached_property
    def unknown(self) -> Indices:
        """Number of each coefficient among those that no condition gives at once; else −1."""
        open_ = np.ones(self.first[-1], dtype=bool)
        right = self.kinds == ConditionKind.RIGHT_VALUE
        open_[self.first[self.breaks[right]] + self.orders[right]] = False
        return np.where(open_, np.cumsum(open_) - 1, -1)

    @property
    def unknowns(self) -> int:
        """How many."""
        return int(self.unknown.max()) + 1

    @cached_property
    def bandwidths(self) -> tuple[int, int]:
        """Of the system of the unknowns: below and above the diagonal."""
        columns, factors = self.entries
        equations = self.kinds != ConditionKind.RIGHT_VALUE
        at = np.where(factors != 0, self.unknown[columns], -1)[equations]
        away = at - np.arange(len(at))[:, None]
        used = at >= 0
        return int((-away)[used].max(initial=0)), int(away[used].max(initial=0))

    @cached_property
    def order(self) -> tuple[Indices, int, int]:
        """Row that stands at the place of each coefficient, and the bandwidths of that order.

        A condition that gives a coefficient at once stands at its place; the others follow each
        other between them, so those of a break are divided between its two segments.
        """
        at = np.empty(self.unknown.size, dtype=np.int64)
        right = self.kinds == ConditionKind.RIGHT_VALUE
        at[self.unknown < 0] = np.flatnonzero(right)
        at[self.unknown >= 0] = np.flatnonzero(~right)
        columns, factors = self.entries
        away = (columns[at] - np.arange(at.size)[:, None])[factors[at] != 0]
        return at, int(max(0, -away.min())), int(max(0, away.max()))

    @cached_property
    def rows(self) -> tuple[Any, ...]:
        """What the kernel takes of it, in its order."""
        columns, factors = self.entries
        shared = (self.kinds, self.breaks, self.orders, columns, factors.astype(np.float64))
        return (*shared, self.unknown, self.first, *self.bandwidths)

    def flat(self, scaled: Array) -> Array:
        """Coefficients in one axis, from those by segment and power."""
        return np.asarray(scaled[self.places])

    def unflat(self, flat: Array, powers: int = MAX_COEFFICIENTS) -> Array:
        """Coefficients by segment and power, shape (segments, powers, joints)."""
        size = len(flat) // self.segments
        if (self.degrees == size - 1).all():
            out = flat.reshape(self.segments, size, -1)
            return out if size == powers else np.pad(out, ((0, 0), (0, powers - size), (0, 0)))
        out = np.zeros((self.segments, powers, flat.shape[-1]))
        out[self.places] = flat
        return out


def counts_in_words(conditions: int, unknowns: int, of: str = "coefficients") -> str:
    """Both counts, such as "18 conditions, but only 14 coefficients"."""
    but = ", but only" if conditions > unknowns else " for"
    return f"{conditions} conditions{but} {unknowns} {of}"


def conditions_of(
    given: Sequence[frozenset[int]], continuity: Sequence[int], degrees: Sequence[int]
) -> Conditions:
    """The conditions of a declaration, ordered by break: left values, right values, matches.

    At each break the orders are given whose values are prescribed there; 0 is the position. Breaks
    that state the same share one template, so long declarations take no loop over conditions.
    """
    last = len(given) - 1
    sets = {orders: i for i, orders in enumerate(dict.fromkeys(given))}
    smooth, base = np.array(continuity, dtype=np.int64), max(continuity, default=0) + 1
    stated = np.array([sets[orders] for orders in given[1:-1]], dtype=np.int64) * base + smooth
    templates, inner = np.unique(stated, return_inverse=True)
    number = np.concatenate([[-1], inner, [-2]])
    parts: list[tuple[NDArray[np.int64], ...]] = []

    def place(at: NDArray[np.int64], kinds: list[ConditionKind], orders: list[int]) -> None:
        rank = np.tile(np.arange(len(kinds)), at.size)
        breaks = np.repeat(at, len(kinds))
        parts.append((breaks, rank, np.tile(kinds, at.size), np.tile(orders, at.size)))

    for edge, kind in ((0, ConditionKind.RIGHT_VALUE), (last, ConditionKind.LEFT_VALUE)):
        orders = sorted(given[edge])
        place(np.array([edge]), [kind] * len(orders), orders)
    for i, template in enumerate(templates.tolist()):
        values = sorted(list(sets)[template // base])
        matches = [order for order in range(template % base + 1) if order not in values]
        kinds = [
            *[ConditionKind.LEFT_VALUE] * len(values),
            *[ConditionKind.RIGHT_VALUE] * len(values),
            *[ConditionKind.MATCH] * len(matches),
        ]
        place(np.flatnonzero(number == i), kinds, [*values, *values, *matches])
    breaks, rank, kinds_, orders_ = (
        np.concatenate([part[i] for part in parts]).astype(np.int64) for i in range(4)
    )
    order = np.argsort(breaks * (rank.max() + 1) + rank, kind="stable")
    whole = np.array(degrees, dtype=np.int64)
    return Conditions(kinds_[order], breaks[order], orders_[order], whole)
