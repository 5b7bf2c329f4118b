"""What `check` answers about a motion from elsewhere."""

from __future__ import annotations

from ...problem import Verdict
from ...problem.motions import Interpolation, MotionForm
from .entry import Count, Document, Entry, OrWhy, Real
from .vocabulary import MotionQuantity


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
