"""Where the time goes: the steps from a printed total down to any curve at all."""

from __future__ import annotations

from typing import Self

from ...nlp import Evidence
from .entry import Entry, OrLeftOut, OrWhy, Why
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
