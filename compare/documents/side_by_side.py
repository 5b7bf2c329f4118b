"""The readings of a case side by side: what each makes of the printed answers."""

from __future__ import annotations

from ...nlp import Evidence
from .entry import Count, Entry, OrLeftOut, OrWhy, Real
from .finding import Gap
from .vocabulary import ClaimVerdict, Keeping, Limited, Scope, Speaks


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
