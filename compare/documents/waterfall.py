"""Where the time goes, step by step, and what each reading makes of the printed answers."""

from __future__ import annotations

import math
from typing import Self

from ...nlp import Evidence
from ...problem import shown_bound
from .entry import Count, Entry, OrLeftOut, OrWhy, Real, Why, value_or_none
from .finding import Gap
from .vocabulary import ClaimVerdict, Keeping, Limited, Scope, Speaks

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


class Excess(Entry):
    """Where the printed point exceeds a limit most, in one segment."""

    segment: Count
    joint: str | None
    """Null for a duration outside its bounds."""
    quantity: Limited
    ratio: Real
    """Of the value to its limit."""


class HeldOtherwise(Entry):
    """Largest ratio to a limit at the printed point, by where the limits are held."""

    everywhere: Real
    """For all t, which every verdict means."""
    steps: Count
    """Steps a segment that the samples make."""
    sampled: Real
    """At those samples only; what lies between them may exceed it."""
    vertices: OrWhy[float]
    """On the control vertices of velocity and acceleration, which bound the curve from outside."""


class ReadingOutcome(Entry):
    """One printed answer under one reading."""

    reading: str
    problem: str
    claim: str | None
    """The printed durations for all joints of the problem; null if none are printed."""
    keeping: OrWhy[Keeping]
    jumps: Count
    """Jumps of velocity at the printed point."""
    excesses: tuple[Excess, ...]
    """Segments in which the printed point exceeds a limit, where `keeping` is "breaks"."""
    held: OrWhy[HeldOtherwise]
    """What limits held at samples or on control vertices would make of the printed point."""
    stretch: OrWhy[float]
    """All durations times this just reach the limits, jumps apart."""
    optimum: OrWhy[float]
    """Best known shortest time with shared durations, s."""
    evidence: Evidence
    """Of the optimum."""
    gap: OrWhy[Gap]
    """Of the printed total against it."""


class Fit(Entry):
    """How nearly the printed durations use the limits up under one reading."""

    reading: str
    factor: Real
    """1 or more: by this all durations would have to be lengthened or shortened to just reach the
    limits, the largest over the problems."""


class Tally(Entry):
    """In how many admissible readings each verdict on a claim holds."""

    claim: str
    verdict: ClaimVerdict
    scope: Scope
    readings: dict[ClaimVerdict, int]
    """How many admissible readings give each verdict."""


class ReadingClue(Entry):
    """What a figure, a data sheet or words of the paper say for or against one reading."""

    clue: str
    """Its id in the case file."""
    where: str
    text: str
    """What is printed or known there."""
    reading: str
    speaks: Speaks
    computed: str
    """What was computed under the reading."""


class ReadingsSummary(Entry):
    """The readings of a case side by side."""

    admissible: tuple[str, ...]
    """Every reading of the case."""
    labels: dict[str, str]
    """What each of them means in words; people read these, and keys name the ids."""
    implausible: dict[str, str]
    """Readings that leave the printed durations far from the limits while another does not, each
    with what was computed. They are admissible still."""
    default: str
    default_why: OrWhy[str]
    """Why it is the default."""
    clues: tuple[ReadingClue, ...]
    """What speaks for and against each reading; none of it decides a verdict."""
    answers: tuple[str, ...]
    """What the readings make of the printed answers, in words."""
    holding: tuple[str, ...]
    """What holds of the claims under all, some and no readings, in words."""
    nearest: tuple[str, ...]
    """Readings with the smallest factor."""
    fits: tuple[Fit, ...]
    """Ascending by the factor: a shortest time uses a limit up."""
    outcomes: tuple[ReadingOutcome, ...]
    """One for each problem and reading that was computed."""
    outcomes_why: OrLeftOut[str] = None
    """Why there are none."""
    claims: tuple[Tally, ...]
    """One for each claim, over all admissible readings."""
