"""What `check`, `verify` and `solve --certify` answer: durations, motions and proofs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from ...nlp import Certified, Outcome
from ...nlp.proofs import decimal
from ...problem import Coupling, Verdict
from ...problem.motions import Interpolation, MotionForm
from ...verify import CertificateVerdict, CertifiedQuestion, Subject
from .entry import Count, Document, Entry, OrLeftOut, OrWhy, Real, Why, known
from .vocabulary import Limited, MotionQuantity, Rounding, Uncovered, Worth


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


class CertifiedResult(Entry):
    """What was proved of one problem under one reading."""

    case: str
    problem: str
    reading: str
    joint: str | None
    """The joint that was optimised by itself; null for all together."""
    subject: Subject
    """Curves that the interval covers."""
    outcome: Outcome | Uncovered
    outcome_why: str | None
    lower: OrWhy[float]
    """No feasible total is below it, s; rounded down."""
    upper: OrWhy[float]
    """Total of durations proved feasible, s; rounded up."""
    gap: OrWhy[float]
    """(upper - lower)/upper"""
    nodes: OrWhy[Count]
    """Boxes visited."""
    open_nodes: OrWhy[Count]
    """Boxes not yet proved."""
    seconds: OrWhy[float]
    lower_exact: str | None
    """Decimal or quotient."""
    upper_exact: str | None
    segment_durations: OrWhy[tuple[float, ...]]
    """Of `upper`, s."""
    certificate: str | None
    """File."""
    state: str | None
    """File to go on from."""


class CertifyDocument(Document):
    """What `trajgap solve --certify --json` prints."""

    intervals: tuple[CertifiedResult, ...]


def certify_result(
    asked: CertifiedQuestion,
    subject: Subject,
    found: Certified | str,
    certificate: str | None,
    state: str | None,
    why: str | None = None,
) -> CertifiedResult:
    """What was proved of a question, or why it is not covered; with the files that were written.

    `why`: why the outcome is what it is, where that needs to be said.
    """
    same: dict[str, Any] = {
        "case": asked.case, "problem": asked.problem, "reading": asked.reading,
        "joint": asked.joint, "subject": subject, "certificate": certificate, "state": state,
    }  # fmt: skip
    if isinstance(found, str):
        missing = ("lower", "upper", "gap", "nodes", "open_nodes", "seconds", "segment_durations")
        same |= dict.fromkeys(missing, Why(found)) | {"lower_exact": None, "upper_exact": None}
        return CertifiedResult(**same, outcome=Uncovered.NOT_COVERED, outcome_why=found)
    lower, upper = found.lower if found.proof is not None else None, found.upper
    none = (
        "infeasible" if found.outcome is Outcome.INFEASIBLE else "no feasible durations were found"
    )
    unproved = "nothing is proved yet"
    wide = lower is None or not math.isfinite(found.gap)
    return CertifiedResult.of(
        found,
        **same,
        outcome_why=why,
        lower=outwards(lower, unproved, -1),
        upper=outwards(upper, none, 1),
        gap=Why(none if upper is None else unproved) if wide else found.gap,
        open_nodes=found.open_boxes,
        lower_exact=None if lower is None else decimal(lower),
        upper_exact=None if upper is None else decimal(upper),
        segment_durations=known(
            None if found.durations is None else tuple(map(float, found.durations)), none
        ),
    )


def outwards(value: Fraction | None, why: str, side: int) -> float | Why:
    """A bound in floats, rounded down (side -1) or up (1), or why there is none."""
    if value is None:
        return Why(why)
    try:
        rounded = float(value)
    except OverflowError:
        return Why("beyond the range of floating point")
    if side * (Fraction(rounded) - value) < 0:
        rounded = math.nextafter(rounded, side * math.inf)
    return rounded


UNNAMED = "no case was named"
"""Why a certificate is compared with no case."""

JudgedFile = tuple[str, CertificateVerdict, CertifiedQuestion | str | None]
"""A file, its verdict, and the question of a case that it is about, or why there is none; None
where no case was named."""


class AskedQuestion(Entry):
    """Where a problem comes from."""

    case: str | None
    problem: str | None
    reading: str | None
    joint: str | None
    """Null for all joints together."""
    case_sha256: str | None
    """Hash of the case file."""


class VerifiedFile(Entry):
    """One file."""

    file: str
    worth: Worth
    reason: str
    subject: Subject | None
    """Null where the file is refused."""
    infeasible: bool
    lower: OrWhy[float]
    """s, rounded down."""
    upper: OrWhy[float]
    """s, rounded up."""
    question: AskedQuestion
    """As the file names it; nothing proves it."""
    problem_hash: str | None
    """SHA-256 of the problem in the file, computed anew."""
    in_case: OrWhy[AskedQuestion]
    """With `--case`: the question of the case that has exactly this problem."""


class VerifyDocument(Document):
    """What `trajgap verify --json` prints."""

    verified: tuple[VerifiedFile, ...]


def verify_document(verdicts: Iterable[JudgedFile]) -> VerifyDocument:
    """Document of `verify`: one verdict per file."""
    return VerifyDocument(verified=tuple(_verified(*one) for one in verdicts))


def worth(verdict: CertificateVerdict) -> Worth:
    """The words for a verdict."""
    if verdict.out_of_time:
        return Worth.OUT_OF_TIME
    if not verdict.proves:
        return Worth.REFUSED
    return Worth.ALTERED if verdict.altered else Worth.PROVES


def _verified(
    file: str, verdict: CertificateVerdict, about: CertifiedQuestion | str | None
) -> VerifiedFile:
    why = "none is claimed" if verdict.proves else str(worth(verdict))
    return VerifiedFile.of(
        verdict,
        file=file,
        worth=worth(verdict),
        subject=verdict.subject if verdict.proves else None,
        lower=outwards(verdict.lower, why, -1),
        upper=outwards(verdict.upper, why, 1),
        question=AskedQuestion.of(verdict.question),
        in_case=AskedQuestion.of(about)
        if isinstance(about, CertifiedQuestion)
        else Why(about or UNNAMED),
    )
