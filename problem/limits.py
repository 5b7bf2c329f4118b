"""Joint limits on position and its first four derivatives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import Array
from .errors import TrajgapError

QUANTITIES = ("velocity", "acceleration", "jerk", "snap")
"""The limited derivatives of the joint angle, in order of differentiation."""
USUAL = 3
"""Derivatives that arrays of limits always cover; snap is added where a joint has a limit of it."""
ORDERS = ("position", *QUANTITIES[:USUAL])
"""Words for derivatives 0 to 3."""
BRAKING = "deceleration"
"""Acceleration while the speed falls, where it has a limit of its own."""


class _Size:
    """Sizes of one quantity's limits, shape (joints,); refused where the two sides differ.

    Code that knows sizes alone would be wrong about a joint whose sides differ, and wrong without
    a sign of it: here it meets an error. What knows sides reads `Limits.sides`.
    """

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, limits: None, owner: type) -> float: ...

    @overload
    def __get__(self, limits: Limits, owner: type) -> Array: ...

    def __get__(self, limits: Limits | None, owner: type) -> Array | float:
        if limits is None:
            return np.inf  # the field's default
        given: Array = limits.__dict__[self._name]
        if self._name == "acceleration" and limits.braking.any():
            raise TrajgapError(
                "limits.deceleration: a limit of its own is not supported here; give the smaller "
                "of both as the acceleration"
            )
        if given.ndim == 2:
            raise TrajgapError(
                f"limits.{self._name}: the lower and the upper limit of a joint differ in size, "
                "which is not supported here; give one size, such as the smaller one"
            )
        return given

    def __set__(self, limits: Limits, value: ArrayLike) -> None:
        limits.__dict__[self._name] = value


@dataclass(frozen=True, eq=False, repr=False)
class Limits:
    """Limits on the derivatives of every joint, and a position range.

    Parameters
    ----------
    velocity, acceleration, jerk, snap : array_like, shape (joints,), (joints, 2) or scalar
        Largest absolute value, rad/s, rad/s², rad/s³, rad/s⁴; or a pair of the least and the
        largest value for each joint, the least at most 0 and the largest at least 0. ``inf`` means
        no limit; 0 means that the joint must not move, or not to that side.
    deceleration : array_like, shape (joints,) or scalar
        Largest |acceleration| while the joint's speed falls, rad/s², in either direction of motion;
        the acceleration limit, one finite size, then applies only while the speed grows. ``inf``
        means that the acceleration limit applies throughout.
    position_lower, position_upper : array_like, shape (joints,) or scalar
        Position range, rad; infinite if there is none.
    joints : int, optional
        Number of joints; needed only when everything given is a scalar.

    Raises
    ------
    TrajgapError
        If a limit is not a number, NaN or negative, a range leaves out 0 or is empty, or the
        lengths differ. Also on reading ``velocity`` or another derivative if the two sides of a
        joint differ: there is then no single size, and `sides` gives both.

    Notes
    -----
    Pairs of equal size are the same limits as that size, to the last bit.
    """

    velocity: _Size = _Size()
    acceleration: _Size = _Size()
    jerk: _Size = _Size()
    position_lower: Array = field(default_factory=lambda: np.array(-np.inf))
    position_upper: Array = field(default_factory=lambda: np.array(np.inf))
    joints: int | None = None
    snap: _Size = _Size()
    deceleration: Array = field(default_factory=lambda: np.array(np.inf))

    def __post_init__(self) -> None:
        arrays = {}
        for name in _NAMES:
            try:
                arrays[name] = np.asarray(self.__dict__[name], dtype=np.float64)
            except (TypeError, ValueError):
                raise TrajgapError(
                    f"limits.{name}: not numbers; give one value, or one per joint"
                ) from None
        sizes = {len(a) for a in arrays.values() if a.ndim} | (
            {self.joints} if self.joints is not None else set()
        )
        count = max(sizes, default=1)
        for name, array in arrays.items():
            paired = name in QUANTITIES and array.shape == (count, 2)
            if not paired and (array.ndim > 1 or (array.ndim == 1 and array.size != count)):
                raise TrajgapError(
                    f"limits.{name}: expected one value or {count} (one per joint), "
                    f"got shape {array.shape}"
                )
            if np.isnan(array).any():
                raise TrajgapError(f"limits.{name}: is NaN; write inf for no limit")
            if paired:
                full = _paired(name, array)
            else:
                if name in _SIZED and (array < 0).any():
                    raise TrajgapError(
                        f"limits.{name}: is negative; give the largest absolute value, 0 or more"
                    )
                full = np.array(np.broadcast_to(array, (count,)))
            full.setflags(write=False)
            object.__setattr__(self, name, full)
        object.__setattr__(self, "joints", count)
        self._check_deceleration()
        if (self.position_lower > self.position_upper).any():
            raise TrajgapError("limits.position_lower: lies above limits.position_upper")

    def _check_deceleration(self) -> None:
        """Refuse what goes with no size of acceleration; a size equal to it is none of its own."""
        low, high = self.ends("acceleration")
        own = np.where(self.deceleration == high, np.inf, self.deceleration)
        with_one = np.isfinite(high) & (-low == high)
        if (np.isfinite(own) & ~(with_one & (own > 0))).any():
            raise TrajgapError(
                "limits.deceleration: must be positive, and go with one finite size of the joint's "
                "acceleration; give both"
            )
        own.setflags(write=False)
        object.__setattr__(self, "deceleration", own)

    def __repr__(self) -> str:
        braking = (BRAKING,) if self.braking.any() else ()
        names = (*self.quantities, *braking, "position_lower", "position_upper", "joints")
        return f"Limits({', '.join(f'{name}={self.__dict__[name]!r}' for name in names)})"

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        """Words for the derivatives that arrays of limits cover: with snap where it is limited."""
        limited = np.isfinite(self.__dict__["snap"]).any()
        return QUANTITIES if limited else QUANTITIES[:USUAL]

    @cached_property
    def sides(self) -> Array:
        """Sizes of the limits to both sides, shape (2, joints, orders): below 0, then above 0.

        The derivatives in `quantities` must lie between ``-sides[0]`` and ``sides[1]``: an
        acceleration within the larger size, where deceleration has a limit of its own.
        """
        found = np.empty((2, int(self.joints or 1), len(self.quantities)))
        for r, name in enumerate(self.quantities):
            low, high = self.ends(name)
            found[0, :, r], found[1, :, r] = np.abs(low), high
        at = self.braking
        found[:, at, 1] = np.maximum(found[:, at, 1], self.deceleration[at])
        found.flags.writeable = False  # all readers share it
        return found

    def same(self, other: Limits) -> bool:
        """Whether all limits are equal."""
        return all(np.array_equal(vars(self)[name], vars(other)[name]) for name in _NAMES)

    @property
    def uneven(self) -> bool:
        """Whether some limit of a derivative is not one size, both sides and all signs of speed."""
        return any(map(self.is_uneven, QUANTITIES))

    @property
    def braking(self) -> NDArray[np.bool_]:
        """Joints whose deceleration has a limit of its own."""
        found: NDArray[np.bool_] = np.isfinite(self.deceleration)
        return found

    def ends(self, quantity: str) -> tuple[Array, Array]:
        """Stated least and largest value of a derivative, shape (joints,) each, signed."""
        given = self.__dict__[quantity]
        return (-given, given) if given.ndim == 1 else (given[:, 0], given[:, 1])

    def is_uneven(self, quantity: str) -> bool:
        """Whether the limit of a derivative is not one size, as `uneven` says of all."""
        braking = quantity == "acceleration" and self.braking.any()
        return bool(self.__dict__[quantity].ndim == 2 or braking)

    @property
    def derivatives(self) -> Array:
        """Limits of the derivatives in `quantities` stacked, shape (joints, orders).

        Raises
        ------
        TrajgapError
            If some are `uneven`.
        """
        return np.stack([getattr(self, name) for name in self.quantities], axis=1)

    @property
    def widest(self) -> Array:
        """The larger size of both sides, which no motion within them exceeds; (joints, orders)."""
        return np.asarray(self.sides.max(axis=0))

    @property
    def limited(self) -> NDArray[np.bool_]:
        """Which derivatives have a limit on some side, shape (joints, orders)."""
        found: NDArray[np.bool_] = np.isfinite(self.sides.min(axis=0))
        return found

    @property
    def smooth_orders(self) -> NDArray[np.int64]:
        """Order up to which a joint's derivatives must not jump, shape (joints,).

        It is 1, or one below the highest order with a limit where that is more: a step of
        acceleration is an unbounded jerk, one of jerk an unbounded snap.
        """
        above = self.limited * np.arange(len(self.quantities))
        return np.asarray(np.maximum(1, above.max(axis=1)))

    @property
    def unproved(self) -> tuple[str, ...]:
        """Quantities whose limits proofs leave out; a lower bound holds all the same."""
        return ((BRAKING,) if self.braking.any() else ()) + self.quantities[USUAL:]

    @property
    def narrow(self) -> Limits:
        """The widest limits of one size each that imply these."""
        sizes = self.sides.min(axis=0)
        at = self.braking
        sizes[at, 1] = np.minimum(self.ends("acceleration")[1][at], self.deceleration[at])
        return self.with_derivatives(sizes)

    @property
    def hull(self) -> Limits:
        """The narrowest symmetric limits that contain these.

        Every motion within these limits is within the hull, so a lower bound for the hull is also
        one here. Without uneven limits they are these limits themselves.
        """
        return self.with_derivatives(self.widest) if self.uneven else self

    @property
    def limits_position(self) -> bool:
        """Whether any joint has a finite position limit."""
        return bool(
            np.isfinite(self.position_lower).any() or np.isfinite(self.position_upper).any()
        )

    def joint(self, index: int) -> Limits:
        """Limits of one joint alone."""
        return self._remade(lambda values: values[index : index + 1])

    def with_derivatives(self, values: ArrayLike) -> Limits:
        """Copy with the derivative limits replaced by ``values``, shape (joints, orders)."""
        return self._with(np.asarray(values, dtype=np.float64))

    def with_sides(self, values: ArrayLike) -> Limits:
        """Copy with the derivative limits replaced, shape (2, joints, orders) as `sides`."""
        low, high = np.asarray(values, dtype=np.float64)
        return self._with(np.stack([-low, high], axis=-1))

    def _with(self, values: Array) -> Limits:
        """Derivatives that no column is given for are not limited, nor is deceleration apart."""
        names = QUANTITIES[: values.shape[1]]
        given: dict[str, Any] = {name: values[:, r] for r, name in enumerate(names)}
        return self._replaced(**dict.fromkeys(_SIZED, np.inf) | given)

    def with_deceleration(self, values: ArrayLike) -> Limits:
        """Copy with the limits of deceleration replaced, shape (joints,), rad/s²."""
        return self._replaced(deceleration=np.asarray(values))

    def with_positions(self, lower: ArrayLike, upper: ArrayLike) -> Limits:
        """Copy with the position range replaced, shape (joints,) each, rad."""
        return self._replaced(position_lower=np.asarray(lower), position_upper=np.asarray(upper))

    def _replaced(self, **changes: Any) -> Limits:
        return Limits(**{name: self.__dict__[name] for name in (*_NAMES, "joints")} | changes)

    def of_joints(self, count: int) -> Limits:
        """The limits of the one joint that these are given for, for each of ``count`` joints."""
        return self._remade(lambda values: np.repeat(values, count, axis=0))

    def _remade(self, change: Callable[[Array], Array]) -> Limits:
        changed: dict[str, Any] = {name: change(self.__dict__[name]) for name in _NAMES}
        return Limits(**changed)


_SIZED = (*QUANTITIES, BRAKING)
"""Limits that are sizes, or pairs of ends."""
_NAMES = (*_SIZED, "position_lower", "position_upper")
"""Every array of `Limits`."""


def _paired(name: str, pairs: Array) -> Array:
    """Checked pairs of one quantity; sizes, shape (joints,), where all sides are equal."""
    wrong = np.argwhere((pairs[:, 0] > 0) | (pairs[:, 1] < 0))
    if wrong.size:
        low, high = pairs[wrong[0, 0]]
        raise TrajgapError(
            f"limits.{name}: {low:g} to {high:g} leaves out 0; give the least value, 0 or less, "
            "and the largest, 0 or more"
        )
    if (-pairs[:, 0] == pairs[:, 1]).all():
        return np.array(pairs[:, 1])
    return np.array(pairs)


def half_range(low: float, high: float, limit: float) -> float:
    """Scale for an excess of position, so its ratio is 1 at the limit."""
    return float((high - low) / 2) if np.isfinite(high - low) else max(1.0, abs(limit))
