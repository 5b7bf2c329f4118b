"""What `check` answers, about durations of a case and about a motion from elsewhere."""

from __future__ import annotations

from ...problem import Coupling, Verdict
from ...problem.motions import Interpolation, MotionForm
from .entry import Count, Document, Entry, OrLeftOut, OrWhy, Real
from .vocabulary import Limited, MotionQuantity, Rounding


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


class MotionPeakShown(Entry):
    """A quantity of a joint where it comes nearest to its limit, or furthest beyond."""

    joint: str
    quantity: MotionQuantity
    time: Real
    """s"""
    value: Real
    limit: Real
    ratio: Real
    """Above 1 the limit is exceeded."""
    ratio_at_least: Real
    """All errors included."""
    ratio_at_most: Real
    """All errors included."""
    source: str
    """Where the limit is stated: flags, or a file."""


class MotionJumpShown(Entry):
    """A derivative of a joint that jumps at breaks."""

    joint: str
    quantity: MotionQuantity
    time: Real
    """Of the largest jump, s."""
    size: Real
    breaks: Count
    """How many."""


class MotionFloor(Entry):
    """The shortest time over any motion between the same standstills: proven."""

    time: Real
    """s"""
    standstills: Count
    waiting: Real
    """s that the checked motion stands still; the floor has none."""
    above: Real
    """(total time − time)/time."""


class NotJudged(Entry):
    """A quantity of a joint that the verdict is silent about: no limit is stated."""

    joint: str
    quantity: MotionQuantity


class CheckedMotion(Entry):
    """What is true of a motion, or of every motion through its samples."""

    verdict: Verdict
    limits_verdict: Verdict
    """Jumps apart."""
    not_judged: tuple[NotJudged, ...]
    """What no limit is stated for: the verdict is about the others."""
    tolerance: Real
    """Relative excess that counts as kept."""
    total_time: Real
    """s"""
    worst: OrWhy[MotionPeakShown]
    slow_down: Real
    """Smallest factor on all durations that repairs; of samples alone no smaller one can."""
    feasible_time: OrWhy[float]
    """Total time after it, s."""
    floor: OrWhy[MotionFloor]
    peaks: tuple[MotionPeakShown, ...]
    jumps: tuple[MotionJumpShown, ...]
    concluded: tuple[str, ...]
    open: tuple[str, ...]
    """What does not follow from the file."""


class RepairedMotion(Entry):
    """The motion slowed down until it keeps its limits, in a file that was read back."""

    file: str
    form: MotionForm
    slow_down: Real
    """Factor on all durations."""
    result: CheckedMotion


class MotionCheckDocument(Document):
    """What `trajgap check FILE --json` prints for a motion."""

    file: str
    format: str
    joints: tuple[str, ...]
    units: tuple[str, ...]
    """Of the file's positions; numbers here are in rad or m, and s."""
    rows: Count
    """Samples, or breaks of polynomials."""
    interpolation: OrWhy[Interpolation]
    noise: tuple[float, ...]
    """What each joint's positions may be off by, rad or m: as stated, or by their digits."""
    time_noise: Real
    """What times may be off by, s."""
    result: CheckedMotion
    repaired: OrWhy[RepairedMotion]
    """What `--repair` wrote."""
    picture: OrLeftOut[str] = None
    """The file that `--plot` wrote."""


class WrittenMotion(Entry):
    """A motion that was written to a file, and what is true of the file when it is read back."""

    file: str
    form: MotionForm
    problem: str
    reading: str
    rate: Real
    """Samples a second; of polynomials it says nothing."""
    retimed: bool
    """Whether TOPPRA timed the path, under velocity and acceleration limits only."""
    result: CheckedMotion
