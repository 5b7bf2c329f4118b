"""What `check` answers: durations judged under each problem and reading."""

from __future__ import annotations

from ...problem import Coupling, Verdict
from .entry import Count, Document, Entry, OrLeftOut, OrWhy, Real
from .vocabulary import Limited, Rounding


class WorstPeak(Entry):
    """The largest ratio to a limit."""

    joint: str | None
    """Null for a duration."""
    quantity: Limited
    segment: Count
    time: OrWhy[float]
    """s"""
    value: Real
    """SI: rad and s, m of joints that slide."""
    limit: Real
    """In the same unit."""
    ratio: Real


class PassingPoint(Entry):
    """A point of the box that passes."""

    segment_durations: tuple[float, ...]
    """s"""
    waypoints: tuple[tuple[float, ...], ...]
    """One row per way-point, rad; m of joints that slide."""


class BrokenPlace(Entry):
    """Where every point of the box exceeds a limit."""

    joint: str | None
    quantity: Limited
    segment: Count


class RoundingExhibit(Entry):
    """What stands behind a rounding verdict: a point that passes, or a bound that none does."""

    exhibit: PassingPoint | BrokenPlace | None
    worst_ratio_at_least: OrWhy[float]
    """Rigorous lower bound over the whole box."""


class Judged(Entry):
    """What is said of durations, for all joints or for one."""

    verdict: Verdict
    """Of the printed point."""
    rounding_verdict: Rounding
    """However the printed digits were rounded."""
    total_time: Real
    """s"""
    worst: OrWhy[WorstPeak]
    feasible_time: OrWhy[float]
    """Total after the uniform stretch that repairs, s."""
    tight_time: OrWhy[float]
    """Total after the free rescaling that uses the limits up, s."""
    rounding: RoundingExhibit


class CheckedJoint(Judged):
    """The same for one joint by itself."""

    joint: str


class _Asked(Entry):
    case: str
    problem: str
    reading: str
    coupling: Coupling
    segment_durations: tuple[float, ...]
    """s"""


class CheckResult(Judged, _Asked):
    """One problem under one reading; `joints` is there under per-joint coupling."""

    joints: OrLeftOut[tuple[CheckedJoint, ...]] = None


class CheckDocument(Document):
    """What `trajgap check --json` prints."""

    results: tuple[CheckResult, ...]
