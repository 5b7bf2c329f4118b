"""The readings of a case side by side: what each makes of the printed answers."""

from __future__ import annotations

from ...nlp import Evidence
from .entry import Count, Entry, OrLeftOut, OrWhy, Real
from .finding import Gap
from .vocabulary import ClaimVerdict, Keeping, Limited, Scope


class Excess(Entry):
    """Where the printed point exceeds a limit most, in one segment."""

    segment: Count
    joint: str | None
    """Null for a duration outside its bounds."""
    quantity: Limited
    ratio: Real
    """Of the value to its limit."""


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


class ReadingsSummary(Entry):
    """The readings of a case side by side."""

    admissible: tuple[str, ...]
    """Every reading of the case."""
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
