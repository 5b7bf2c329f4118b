"""What `solve` answers: the exact optimum of each problem under each reading."""

from __future__ import annotations

from collections.abc import Sequence

from ...nlp import Evidence, PerJointSolution, Route, Solution, Status
from ...nlp.optimum import Active
from ...nlp.retiming import Retiming
from ...problem import Coupling, Verdict
from .checked import WrittenMotion
from .entry import Count, Document, Entry, OrLeftOut, OrWhy, Real, Why, known
from .finding import UNCERTIFIED
from .vocabulary import Limited

NOT_ASKED = "not asked for"
"""Why a path is not retimed, where nobody wanted it."""


class ActiveLimit(Entry):
    """A limit that is reached."""

    joint: str | None
    """Null for a bound on a duration."""
    quantity: Limited
    segment: Count
    time: OrWhy[float]
    """s"""
    multiplier: Real
    """s"""
    sensitivity: Real
    """First-order change of the total time for 10 % more of this limit, s; of a position limit, for
    a range wider by 10 % of the limit's size."""


class RetimedPath(Entry):
    """The path of the answer retimed on one grid, under velocity and acceleration limits only."""

    duration: float
    """s"""
    gridpoints: Count


class Extrapolated(Entry):
    """Retimed durations on an infinitely fine grid."""

    duration: OrWhy[float]
    """s"""
    error: OrWhy[float]
    """s"""
    order: OrWhy[float]
    at_most_total_time: bool | None
    """Null where it need not hold."""
    why: str | None


class Answer(Entry):
    """What one solve says, whether of all joints or of one."""

    status: Status
    status_why: str | None
    total_time: OrWhy[float]
    """s"""
    segment_durations: OrWhy[tuple[float, ...]]
    """s"""
    infimum: OrWhy[float]
    """Value that the totals found approach where no shortest motion was found, s."""
    lower_bound: OrWhy[float]
    """Certified, s."""
    evidence: Evidence
    """What stands behind `total_time`."""
    max_violation: OrWhy[float]
    """Largest relative excess over a limit, 0 if none."""
    kkt_residual: OrWhy[float]
    """Scaled, of the reduced problem, every active peak found again."""
    route: OrWhy[Route]
    """How the answer was found."""
    other_route_total: OrWhy[float]
    """What the other route ends at from a motion ten per cent longer, s: the NLP beside a descent
    or a formula, a descent beside the NLP."""
    active: tuple[ActiveLimit, ...]
    starts: Count
    starts_at_best: Count
    """Starts that ended at the best total, or came near one that did."""
    build_seconds: float
    solve_seconds: float
    toppra: OrWhy[tuple[RetimedPath, ...]]
    toppra_extrapolated: OrLeftOut[Extrapolated] = None
    """Left out where `toppra` is null."""


class SolvedJoint(Answer):
    """The answer for one joint by itself."""

    joint: str


class Span(Entry):
    """The total while each joint stays within `slack` s of its own optimum."""

    slack: float
    lowest: float
    highest: float


class LongestPerSegment(Entry):
    """What the procedure makes of the joints' own optima: an output, not an optimum."""

    segment_durations: OrWhy[tuple[float, ...]]
    """s"""
    verdict: OrWhy[Verdict]
    total_time: OrWhy[float]
    feasible_time: OrWhy[float]
    tight_time: OrWhy[float]
    ranges: tuple[Span, ...]
    ranges_why: str | None


class _Asked(Entry):
    case: str
    problem: str
    reading: str
    coupling: Coupling


class SolveResult(Answer, _Asked):
    """One problem under one reading.

    Under per-joint coupling `segment_durations` is null, and `joints`, `longest_per_segment` and
    `shared` are there.
    """

    joints: OrLeftOut[tuple[SolvedJoint, ...]] = None
    longest_per_segment: OrLeftOut[LongestPerSegment] = None
    shared: OrLeftOut[Answer] = None
    """The optimum with durations that all joints share, which Python's `solve` answers."""


class SolveDocument(Document):
    """What `trajgap solve --json` prints."""

    results: tuple[SolveResult, ...]
    written: OrLeftOut[WrittenMotion] = None
    """With `--samples`: the motion of the first result, in a file."""


def solve_result(
    case: str,
    problem: str,
    reading: str,
    answer: Solution | PerJointSolution,
    retimings: Sequence[Retiming | str] = (),
    shared: Solution | None = None,
) -> SolveResult:
    """Result of `solve` for one problem under one reading.

    `answer`: the latter for joints that do not share their durations. `retimings`: TOPPRA on the
    path of the answer, or why there is none; for a PerJointSolution one per joint. `shared`: of
    joints that do not share their durations: the optimum if they did.
    """
    ids = _Asked(case=case, problem=problem, reading=reading, coupling=Coupling.SHARED)
    if isinstance(answer, Solution):
        return SolveResult(**dict(ids), **dict(_solution(answer, *retimings[:1])))
    paths = retimings or [NOT_ASKED] * len(answer.joints)
    singles = zip(answer.problem.joints, answer.joints, paths, strict=True)
    return SolveResult(
        **dict(ids) | {"coupling": Coupling.PER_JOINT},
        **dict(_procedure(answer)),
        joints=tuple(SolvedJoint(joint=j, **dict(_solution(s, path))) for j, s, path in singles),
        longest_per_segment=_longest(answer),
        shared=None if shared is None else _solution(shared),
    )


def _solution(answer: Solution, path: Retiming | str = NOT_ASKED) -> Answer:
    none = answer.why or str(answer.status)
    boundless = answer.boundless
    none = boundless or none
    there = answer.found and boundless is None
    toppra, extrapolated = _toppra(path)
    alone = "no second route handles this curve with this many durations"
    return Answer.of(
        answer,
        status_why=boundless or answer.why,
        total_time=answer.total_time if there else Why(none),
        segment_durations=_durations(answer, none) if there else Why(none),
        infimum=known(
            answer.infimum if boundless is None else 0.0,
            "the total time is attained" if there else none,
        ),
        lower_bound=known(answer.lower_bound, UNCERTIFIED.reason),
        evidence=answer.evidence if there else Evidence.NONE,
        max_violation=answer.check.max_violation if there and answer.check else Why(none),
        kkt_residual=known(answer.kkt_residual if there else None, none),
        route=known(answer.route if there else None, none),
        other_route_total=known(answer.other_total if there else None, alone if there else none),
        active=tuple(map(_active, answer.active)),
        toppra=toppra,
        toppra_extrapolated=extrapolated,
    )


def _procedure(answer: PerJointSolution) -> Answer:
    joints = answer.joints
    none = answer.why or str(answer.status)
    named = zip(answer.problem.joints, joints, strict=True)
    unsettled = [f"joint {label}: {s.why}" for label, s in named if s.why]
    residuals = [s.kkt_residual for s in joints if s.kkt_residual is not None]
    return Answer.of(
        answer,
        status_why="; ".join(unsettled)
        or "of the joints' own optima; the total is the sum of their longest durations",
        total_time=answer.total_time if answer.check else Why(none),
        segment_durations=Why("each joint has its own durations, see joints"),
        infimum=Why("the longest durations of a procedure, not an optimum"),
        lower_bound=UNCERTIFIED,
        max_violation=answer.check.max_violation if answer.check else Why(none),
        kkt_residual=max(residuals) if len(residuals) == len(joints) else Why(none),
        route=Why("each joint has its own route, see joints"),
        other_route_total=Why("each joint has its own route, see joints"),
        active=tuple(_active(a) for s in joints for a in s.active),
        starts=sum(s.starts for s in joints),
        starts_at_best=sum(s.starts_at_best for s in joints),
        # Joints of one kind share one NLP, which is built once.
        build_seconds=max(s.build_seconds for s in joints),
        solve_seconds=sum(s.solve_seconds for s in joints),
        toppra=Why("each joint has its own path, see joints"),
    )


def _durations(answer: Solution | PerJointSolution, none: str) -> tuple[float, ...] | Why:
    return Why(none) if not answer.found else tuple(map(float, answer.durations))


def _longest(answer: PerJointSolution) -> LongestPerSegment:
    """The procedure's output: the longest duration of each segment, judged with all joints."""
    none = answer.why or str(answer.status)
    found = answer.check
    return LongestPerSegment(
        segment_durations=_durations(answer, none) if found else Why(none),
        verdict=found.verdict if found else Why(none),
        total_time=found.total_time if found else Why(none),
        feasible_time=known(found.feasible_time, found.feasible_why) if found else Why(none),
        tight_time=known(found.tight_time, found.tight_why) if found else Why(none),
        ranges=tuple(map(Span.of, answer.ranges)),
        ranges_why=None if answer.ranges else none,
    )


def _active(active: Active) -> ActiveLimit:
    return ActiveLimit.of(active, time=known(active.time, "a bound on the whole duration"))


def _toppra(retiming: Retiming | str) -> tuple[tuple[RetimedPath, ...] | Why, Extrapolated | None]:
    if isinstance(retiming, str):
        return Why(retiming), None
    if not retiming.applicable:
        return Why(retiming.why or "not applicable"), None
    runs = zip(retiming.durations, retiming.gridpoints, strict=True)
    order = "the durations agree within the solver's accuracy, or show no single order"
    return tuple(RetimedPath(duration=d, gridpoints=n) for d, n in runs), Extrapolated(
        duration=known(retiming.extrapolated, retiming.why),
        error=known(retiming.error, retiming.why),
        order=known(retiming.order, order),
        at_most_total_time=retiming.inequality_holds,
        why=retiming.why,
    )
