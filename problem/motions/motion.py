"""A motion from elsewhere: piecewise polynomials over time, with bounds on what is not exact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..curves import MAX_COEFFICIENTS, PERM
from ..errors import TrajgapError
from ..files import MOST

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

LARGEST = 1e100
"""Size of a position, derivative, coefficient or limit, rad and s; a limit above 0 is at least its
inverse. Divided by the cube of the shortest step, 1e-30 s, and by a limit, it is still within
float64, which would overflow to inf and NaN."""
EPS = 2.0**-52
"""Spacing of float64 at 1."""
ROUNDED_UP = 1.0 + 2.0**12 * EPS
"""Covers the rounding of a bound's own sums, products and powers."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Joint values over time, from any source.

    Raises
    ------
    TrajgapError
        If shapes disagree, a number is not finite or out of range, times do not increase, the
        degree is above 9, or a derivative is beyond float64.
    """

    joints: tuple[str, ...]
    breaks: Array
    """Shape (pieces + 1,). Times at which the pieces meet, s, ascending."""
    scaled: Array
    """Shape (pieces, powers, joints). Ascending coefficients in s = (t − t_k)/h_k, rad (m for
    sliding joints)."""
    error: Array
    """Shape (pieces, 4, joints). Bound on the error of derivatives 0 to 3 anywhere on a piece,
    rad/sᵒʳᵈᵉʳ, apart from rounding errors of the evaluation; inf if nothing is known."""
    between: str
    """The assumption about the motion between the points of the file, in words."""
    smooth: int = -1
    """Derivatives up to this one are continuous by construction; −1 if none is known to be."""
    assumed: str = ""
    """Uncertainty of the numbers in the file, in words; empty if they are exact."""
    advice: str = ""
    """Advice if this leaves the verdict open."""

    def __post_init__(self) -> None:
        pieces, powers, joints = self.scaled.shape
        check_joints(self.joints, joints)
        _check_degree(powers - 1)
        # NaN compares as neither larger nor smaller: in a search for peaks it would be skipped.
        if not (np.abs(self.scaled) <= LARGEST).all():
            raise TrajgapError(
                f"polynomials: a coefficient is not finite, or moves a joint by more than "
                f"{LARGEST:g}; give finite numbers, rad and s"
            )
        if self.breaks.shape != (pieces + 1,):
            raise TrajgapError(
                f"breaks: {self.breaks.size} for {pieces} pieces; give one more than pieces"
            )
        check_times(self.breaks, "breaks")
        with np.errstate(over="ignore"):
            if not np.isfinite(derivative_terms(self.scaled, self.durations)).all():
                raise TrajgapError(
                    "polynomials: a derivative is beyond the range of float64; give rad and s"
                )

    def slowed(self, factor: float) -> Motion:
        """The same path, slower by a factor."""
        start = self.breaks[0]
        powers = factor ** -np.arange(4.0)
        return replace(
            self,
            breaks=start + factor * (self.breaks - start),
            error=self.error * powers[:, None],
        )

    @classmethod
    def of_polynomial(
        cls,
        polynomial: PPoly,
        joints: Sequence[str] = (),
        between: str = "the polynomials of the file",
    ) -> Motion:
        """A motion from scipy's ``PPoly`` of values of shape (joints,) or numbers.

        Parameters
        ----------
        polynomial : scipy.interpolate.PPoly
            rad over s.
        joints : sequence of str, optional
            Labels; "1", "2", ... by default.

        Raises
        ------
        TrajgapError
            As the class, or if values have more than one axis.
        """
        c, breaks = np.asarray(polynomial.c), np.asarray(polynomial.x, dtype=np.float64)
        if c.ndim == 2:
            c = c[:, :, None]
        if c.ndim != 3:
            raise TrajgapError("polynomials: give one value per joint, not a table of them")
        if np.iscomplexobj(c):
            raise TrajgapError("polynomials: coefficients are complex; give real ones")
        c = np.asarray(c, dtype=np.float64)
        while c.shape[0] > MAX_COEFFICIENTS and not c[0].any():
            c = c[1:]
        _check_degree(c.shape[0] - 1)
        check_times(breaks, "breaks")
        h = np.diff(breaks)
        powers = np.arange(c.shape[0])
        with np.errstate(over="ignore", invalid="ignore"):  # refused by the class
            scaled = (
                np.ascontiguousarray(np.moveaxis(c[::-1], 0, 1))
                * (h[:, None] ** powers)[:, :, None]
            )
            # The breaks are rounded to float64: (1 − c)⁻ʳ ≤ 1 + 1.25 r c for c up to 1e-3.
            clock = 1.25 * clock_error(breaks)[:, None] * np.arange(4)
            error = clock[:, :, None] * derivative_terms(scaled, h)
        labels = tuple(joints) or numbered(c.shape[2])
        return cls(labels, breaks, scaled, error, between)

    @property
    def durations(self) -> Array:
        """Durations of the pieces, s."""
        return np.diff(self.breaks)

    @property
    def pieces(self) -> int:
        """Number of pieces."""
        return int(self.scaled.shape[0])

    @property
    def total_time(self) -> float:
        """From the first to the last time, s."""
        return float(self.breaks[-1] - self.breaks[0])

    @cached_property
    def polynomial(self) -> PPoly:
        """The motion as scipy's ``PPoly``, values of shape (joints,), rad over s."""
        from scipy.interpolate import PPoly

        powers = np.arange(self.scaled.shape[1])
        plain = self.scaled / (self.durations[:, None] ** powers)[:, :, None]
        return PPoly(np.moveaxis(plain, 1, 0)[::-1], self.breaks)

    def __call__(self, time: ArrayLike, order: int = 0) -> Array:
        """Derivative ``order`` at ``time`` (s); shape of ``time`` plus (joints,)."""
        return np.asarray(self.polynomial(time, nu=order), dtype=np.float64)

    def at_ends(self, order: int) -> tuple[Array, Array]:
        """A derivative at the start and at the end of every piece, each (pieces, joints)."""
        weights = PERM[: self.scaled.shape[1], order]
        shown = (self.durations**-order)[:, None]
        if order >= self.scaled.shape[1]:
            none = np.zeros((self.pieces, len(self.joints)))
            return none, none
        first = weights[order] * self.scaled[:, order] * shown
        return first, np.einsum("p,kpj->kj", weights, self.scaled) * shown


def _check_degree(degree: int) -> None:
    if degree >= MAX_COEFFICIENTS:
        raise TrajgapError(
            f"polynomials: degree {degree}, but at most {MAX_COEFFICIENTS - 1} is supported; "
            "split them into pieces of a lower degree"
        )


def derivative_terms(scaled: Array, durations: Array) -> Array:
    """What no term-by-term sum of a derivative exceeds on a piece, shape (pieces, 4, joints)."""
    sizes = np.abs(scaled)
    weights = PERM[: scaled.shape[1], :4]
    terms = np.empty((scaled.shape[0], 4, scaled.shape[2]))
    for order in range(4):
        terms[:, order] = np.tensordot(sizes, weights[:, order], axes=(1, 0))
        terms[:, order] *= (durations**-order)[:, None]
    return terms


def numbered(count: int) -> tuple[str, ...]:
    """Labels of joints without names: "1", "2", ..."""
    return tuple(str(j + 1) for j in range(count))


def clock_error(times: Array) -> Array:
    """Relative error of the steps between times that were rounded to float64."""
    sizes = np.abs(times[1:]) + np.abs(times[:-1])
    return np.asarray(EPS * (1.0 + sizes / np.diff(times)), dtype=np.float64)


def check_joints(labels: Sequence[str], count: int) -> None:
    """Refuse labels that do not fit their joints, and more joints than any arm has."""
    if not 1 <= count <= MOST.joints:
        raise TrajgapError(f"joints: {count} of them; give 1 to {MOST.joints}")
    if len(labels) != count:
        raise TrajgapError(f"joints: {len(labels)} names for {count} joints; give one each")
    if len(set(labels)) < count:
        twice = next(one for one in labels if list(labels).count(one) > 1)
        raise TrajgapError(f"joints: {twice!r} occurs twice; name each joint once")


def check_times(times: Array, field: str) -> None:
    """Refuse times that do not increase, or whose steps are too short for float64."""
    if times.size < 2:
        raise TrajgapError(f"{field}: {times.size} of them; a motion needs 2 or more")
    bad = ~np.isfinite(times)
    if bad.any():
        raise TrajgapError(f"{field}: number {int(np.argmax(bad)) + 1} is not finite; give seconds")
    steps = np.diff(times)
    if (steps <= 0).any():
        k = int(np.argmax(steps <= 0))
        raise TrajgapError(
            f"{field}: number {k + 2} is {times[k + 1]:.17g} after {times[k]:.17g}; "
            "times must increase"
        )
    if steps.min() < 1e-30 or np.abs(times).max() > 1e30:
        raise TrajgapError(f"{field}: a step or a time is out of range; give seconds")
    if clock_error(times).max() > 1e-3:
        raise TrajgapError(
            f"{field}: a step is too small for the digits of its time; let time start near 0"
        )
