"""Optimality gap of a time against a reference, as an interval and never clipped."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from ...nlp import Evidence, Solution
from ...problem import TrajgapError


class GapKind(StrEnum):
    """What a gap is a gap of."""

    OPTIMALITY = "optimality gap"
    """Of a time whose trajectory keeps the limits."""
    REPORTED = "difference of reported time"
    """Of a printed or reported time whose trajectory is not shown to keep them."""


@dataclass(frozen=True)
class Reference:
    """A reference time: the best known value, and a certified lower bound where there is one.

    Attributes
    ----------
    upper : float
        Total of a feasible trajectory, s.
    lower : float or None
        Certified lower bound on the optimum, s.
    """

    upper: float
    lower: float | None = None

    @property
    def evidence(self) -> Evidence:
        """Certified if there is a lower bound, else best known."""
        return Evidence.BEST_KNOWN if self.lower is None else Evidence.CERTIFIED


@dataclass(frozen=True)
class Gap:
    """Relative distance of a time from the optimum.

    Attributes
    ----------
    lowest : float
        (T − U)/U at the low end of the time's interval; negative where T lies below the reference.
    highest : float
        (T − U)/U at its high end; against the lower bound instead, where one is certified.
    kind : GapKind
    reference : Reference
    """

    lowest: float
    highest: float
    kind: GapKind
    reference: Reference

    @property
    def percent(self) -> str:
        """The interval in percent; a factor instead where the time is many times the reference."""
        if self.lowest > 10:
            return f"{1 + self.lowest:.4g} times the reference"
        low, high = 100 * self.lowest, 100 * self.highest
        narrow = high - low < max(0.005 * abs(low), 5e-4)
        return f"{low:+.3g} %" if narrow else f"{low:+.3g} to {high:+.3g} %"

    def __str__(self) -> str:
        return f"{self.percent} ({self.kind}, reference {self.reference.evidence})"


def gap(
    time: float | tuple[float, float],
    reference: Reference | Solution | float,
    *,
    feasible: bool = True,
) -> Gap:
    """Gap of a time, or of the interval of a printed time, against a reference.

    Parameters
    ----------
    time : float or (float, float)
        Total time, or the interval that its printed digits stand for, s.
    reference : Reference, Solution or float
        The exact side's answer, or its value in s.
    feasible : bool
        Whether the trajectory behind the time keeps its limits; otherwise the number is a
        difference of reported time.

    Returns
    -------
    Gap
        Negative values are kept: a time below the best known value is news.

    Raises
    ------
    TrajgapError
        If the reference is not a positive finite time.
    """
    if isinstance(reference, Solution):
        reference = Reference(reference.best, reference.lower_bound)
    elif not isinstance(reference, Reference):
        reference = Reference(float(reference))
    if not 0 < reference.upper < float("inf"):
        raise TrajgapError(f"gap: the reference {reference.upper} s is not a positive finite time")
    low, high = time if isinstance(time, tuple) else (float(time), float(time))
    base = reference.upper if reference.lower is None else reference.lower
    return Gap(
        lowest=(low - reference.upper) / reference.upper,
        highest=(high - base) / base,
        kind=GapKind.OPTIMALITY if feasible else GapKind.REPORTED,
        reference=reference,
    )
