"""Where the time goes: the steps from a printed total down to any curve at all."""

from __future__ import annotations

import math
from typing import Self

from ...nlp import Evidence
from ...problem import shown_bound
from .entry import Entry, OrLeftOut, OrWhy, Why, value_or_none
from .vocabulary import Keeping

EXACT = Why("a single value, not an interval")
"""Why a value has no interval."""
PUBLISHED = "published"
"""Name of the step that is the printed total."""
OWN_OPTIMA = "each joint at its optimum, longest per segment"
"""Name of the step that such a total is set beside where the paper plans each joint separately."""
SHARED_OPTIMUM = "optimum of the same curve, shared durations"
"""Name of the step that distances are counted from."""
STAND_IN_OPTIMUM = "optimum of the case file's curve, for which no time is printed"
"""Name of that step where every printed time is of a curve that a case file cannot name."""
RATIOS_OPTIMUM = "shortest total of the same curve at these ratios of the durations"
"""Name of that step where the question fixes the ratios, so the total alone is chosen."""
FREED_OPTIMUM = "the same curve, each duration chosen"
"""Name of the step below it: what fixing the ratios costs."""

ALONG_PATH = "shortest time along the path, from rest to rest"
"""Name of the step below a total along a fixed path."""
OPTIMUM_RETIMED = "TOPPRA on the path of that optimum"
"""Name of the step that cross-checks the optimum: no timing of its path is shorter."""
THIRD_ORDER = "the path of that optimum, timed anew with limited jerk"
"""Name of that step where jerk is limited, of which TOPPRA knows nothing."""
RELAXED_RETIMED = "TOPPRA on the path of the relaxed family"
"""Name of the same step below the relaxed family."""

OPTIMA_STEPS = (SHARED_OPTIMUM, STAND_IN_OPTIMUM, RATIOS_OPTIMUM)
"""Names that the optimum of the declared curve may have."""


class Step(Entry):
    """One value of a waterfall."""

    name: str
    time: OrWhy[float]
    """Total time, s."""
    low: OrWhy[float] = EXACT
    """Lower end of the value if it is an interval, s."""
    high: OrWhy[float] = EXACT
    evidence: Evidence = Evidence.NONE
    """Whether the value is best known or certified; none for printed and derived values."""
    note: str = ""
    keeping: OrLeftOut[Keeping] = None
    """Whether the motion of a printed total keeps the limits; left out if nothing was judged."""

    def total(self, ends: bool = True) -> str:
        """The value, with the ends of its interval where it is one.

        Parameters
        ----------
        ends : bool
            Whether there is room for them.

        Returns
        -------
        str
            Such as "3.3595 s (3.3324 to 3.4128)", or "not computed".
        """
        if isinstance(self.time, Why):
            return "not computed"
        digits = 4 if self.time >= 0.1 else 6
        text = f"{self.time:.{digits}f} s"
        low, high = self.low, self.high
        if ends and not isinstance(low, Why) and not isinstance(high, Why):
            width = high - low
            if width > 1e-9:
                digits = min(9, max(digits, math.ceil(1 - math.log10(width))))
                least = shown_bound(low, "lower", places=digits)
                text += f" ({least} to {shown_bound(high, 'upper', places=digits)})"
        return text

    @property
    def value(self) -> float:
        """The time of a step that has one, s."""
        assert not isinstance(self.time, Why)
        return self.time

    @property
    def ends(self) -> tuple[float, float]:
        """The ends of its interval, s; the value itself where it is none."""
        low, high = map(value_or_none, (self.low, self.high))
        return self.value if low is None else low, self.value if high is None else high

    @property
    def known(self) -> str:
        """What stands behind the value; empty for what is printed or derived."""
        return "" if self.evidence is Evidence.NONE else str(self.evidence)

    @classmethod
    def missing(cls, name: str, note: str) -> Self:
        """A step that was not computed, and why."""
        why = Why(note or "not computed")
        return cls(name=name, time=why, low=why, high=why, note=note)


class Waterfall(Entry):
    """Steps of one problem under one reading, starting from one claim."""

    problem: str
    reading: str
    claim: str | None
    """The printed durations for all joints of the problem; null if none are printed."""
    steps: tuple[Step, ...]
    longest_optimum: OrWhy[float] = Why("not bounded")
    """Longest optimum of all problems whose way-points and limits round to the digits, s."""

    @property
    def without_optimum(self) -> tuple[str, ...]:
        """Why the optimum has no time, or TOPPRA does not apply to it, in a sentence."""
        why = next((s.time for s in self.steps if s.name in OPTIMA_STEPS), None)
        if isinstance(why, Why):
            return (f"No optimum: {why}.",)
        beside = next((s.time for s in self.steps if s.name == OPTIMUM_RETIMED), None)
        return (f"TOPPRA is not run: {beside}.",) if isinstance(beside, Why) else ()
