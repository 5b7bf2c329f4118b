"""TG302 and TG303: printed totals beside the optimum of their formulation and the shared one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ....nlp import Evidence, Solution, Status, weakest
from ....problem import shown_bound
from ....problem.cases import AnyClaim, StatementClaim, TimeClaim, TotalTimeClaim
from ...documents import (
    Basis,
    ClaimVerdict,
    Finding,
    Gap,
    Reference,
    Rounding,
    Severity,
    Why,
    known,
    percent_ends,
    ranged,
)
from ...gaps import gap, reference_of
from ..digit_ranges import at_ratios, below_certified, off_ratios, optimum_called, planned_apart
from ..own_result import contradicting_lows, rounded_up_low, total_excludes
from ..printed_row import PrintedRow, named_rows, printed_rows
from ..rounding import ROUNDING, meet, rounds_to
from ..stated import RowClaim, called, called_under, other_objective
from ..study import Study, Total
from ..words import LIMITS, OPTIMAL, seconds
from .judged_rows import broken
from .rule_group import INFORMS, Explained, rule_group

_BELOW = (
    "The whole printed interval is below the best known total; a misprint or a better optimum may "
    "explain it."
)
"""What is said of a printed total below a best known one."""
_BELOW_BOUND = (
    "The whole printed interval lies below the proved lower bound of this problem; a misprinted "
    "total, limit or way-point, or another reading, may explain it."
)
"""What is said of a printed total below a proved bound."""


TG302 = Explained(
    "TG302",
    "Distance of a printed total from the optimum of its own formulation",
    "How far is a printed total from the optimum of the paper's own problem: its curve, "
    "its way-points, its limits?",
    "A distance alone supports and refutes nothing. “Optimal” is refuted by a shorter "
    "motion that keeps the limits however the digits were rounded.",
    "3.172 s is printed for joint 3, whose proven optimum is 3.126 s: 1.5 % above it.",
    basis=Basis.OPTIMUM,
)
TG303 = Explained(
    "TG303",
    "Distance of a printed total from the optimum with shared durations",
    "The same distance if all joints pass each way-point together, although the paper times "
    "each joint separately.",
    INFORMS,
    "Each joint is optimised separately, and each segment then takes the longest of their "
    "durations: 3.53 s. Optimised together, the joints need 3.30 s.",
    basis=Basis.OPTIMUM,
    decides=False,
)


@rule_group(TG302, TG303)
def judge_distances(study: Study) -> Iterator[Finding]:
    """Findings of TG302 and TG303."""
    for claim in study.claims:
        if isinstance(claim, RowClaim | TotalTimeClaim):
            for row in printed_rows(study, claim):
                yield from _beside_optimum(row)
        elif isinstance(claim, StatementClaim) and claim.checks == "optimal":
            yield from _optimal_statement(study, claim)


def _beside_optimum(row: PrintedRow[AnyClaim]) -> Iterator[Finding]:
    total = row.total
    if total is None:
        return
    problem = row.posed()
    procedure = len(problem.joints) > 1 and planned_apart(row.study.problem(row.pair))
    solution = row.optimum
    reference = reference_of(solution)
    other = off_ratios(row)
    if other is not None:
        yield TG302.finding(
            row,
            "other ratios",
            f"Printed are {other}.",
            "They answer a question other than the shortest total at these ratios, and are not "
            "compared with it.",
            basis=Basis.DIGITS,
            printed=total.shown,
            decides=False,
        )
        return
    if reference is not None:
        yield _distance(row, total, reference, procedure)
    if procedure:
        yield from _beside_procedure(row, total)


def _distance(
    row: PrintedRow[AnyClaim], total: Total, reference: Reference, shared: bool
) -> Finding:
    claim, solution = row.claim, row.optimum
    shown, interval = total
    kept = row.kept
    distance = gap(interval, reference, feasible=kept)
    whole = " with shared durations" if solution.problem.ratios is None else ""
    which = whole if shared or claim.joint is None else f" of joint {claim.joint}"
    said = [
        f"Printed {shown} {set_beside(distance)} the "
        f"{optimum_called(solution.problem, reference.evidence)}{which}, "
        f"{seconds(reference.upper, '.6f')}{_bounded(reference)}."
    ]
    minimised = other_objective(row.study.case, claim)
    informs = minimised is not None and distance.lowest > 0
    if informs:
        said = [
            f"The printed {shown} was not minimised for time alone ({minimised}); for information, "
            f"the shortest motion{which}{at_ratios(solution.problem)} takes "
            f"{seconds(reference.upper, '.6f')}, {reference.evidence}{_bounded(reference)}."
        ]
    timed = not isinstance(claim, TotalTimeClaim) and row.unmoved is None
    if timed and not informs:
        verdict = row.check
        if verdict.feasible_time is not None:
            repaired = gap(verdict.feasible_time, reference)
            said.append(
                f"Feasible time of the printed durations {seconds(verdict.feasible_time, '.6f')} "
                f"({repaired.percent})."
            )
    severity = Severity.INFO
    near = rounds_to(interval, solution.best)
    if distance.highest < 0 and not near:
        explained = _below(row, interval)
        if explained is not None:
            said.append(explained)
        else:
            before = isinstance(claim, TimeClaim) and claim.state == "before"
            severity = Severity.INFO if before else Severity.WARNING
            said.append(_BELOW if isinstance(reference.lower, Why) else _BELOW_BOUND)
    agrees = kept and near
    return (TG303 if shared else TG302).finding(
        row,
        "other objective" if informs else "distance",
        *said,
        severity=severity,
        verdict=ClaimVerdict.SUPPORTED if agrees else ClaimVerdict.NOT_CHECKABLE,
        evidence=solution.evidence,
        printed=shown,
        computed=seconds(reference.upper, ".6f"),
        gap=distance,
        decides=False,
    )


def _below(row: PrintedRow[AnyClaim], interval: tuple[float, float]) -> str | None:
    """Why a total may lie below the optimum of the problem as printed, if something explains it."""
    timed, solution = not isinstance(row.claim, TotalTimeClaim), row.optimum
    if timed and row.rounding.verdict is Rounding.CONSISTENT:
        return (
            "Rounding explains it: some values that round to the printed digits keep every limit "
            "with these durations."
        )
    if timed and broken(row) is not None:
        return (
            f"It is below the {solution.evidence} total because these durations break the limits."
        )
    if loose := row.statement.declaration.loose:
        return f"{loose} are rounded numbers, which may explain it."
    if solution.problem.ratios is not None:
        return (
            "The whole printed interval lies below it; other ratios of the durations, other "
            "limits, another reading or other digits may explain that."
        )
    share = _spread(row)
    if share is not None and interval[1] >= solution.best * (1.0 - share):
        return (
            "To first order the rounding of way-points and limits explains it: they move the "
            f"optimum by up to {shown_bound(100 * share, 'upper', digits=2)} %."
        )
    return None


def _spread(row: PrintedRow[AnyClaim]) -> float | None:
    """Share by which the rounding of way-points and limits moves the optimum, to first order.

    That it is at most so much longer for any of them is proved; so much shorter is its mirror.
    """
    solution = row.optimum
    if not solution.found or not solution.best > 0:
        return None
    reached = row.reachable(solution.durations)
    return None if reached is None else max(reached / solution.best - 1.0, 0.0)


def _bounded(reference: Reference) -> str:
    if isinstance(reference.lower, Why):
        return ""
    width = (reference.upper - reference.lower) / reference.upper
    return f" (proved, gap {width:.1e})"


def set_beside(distance: Gap) -> str:
    """How a printed total lies beside a reference, as the verb of a sentence."""
    low, high = 100 * distance.lowest, 100 * distance.highest
    if distance.many_times:
        return f"is {shown_bound(1 + distance.lowest, 'lower', digits=4)} times"
    if low <= 100 * ROUNDING and high >= -100 * ROUNDING:
        return "agrees within its rounding with"
    least, most = sorted((abs(low), abs(high)))
    share = f"{most:.3g}"
    if f"{least:.3g}" != share:
        share = " to ".join(percent_ends(least, most))
    return f"is {share} % {'longer' if low > 0 else 'shorter'} than"


def _beside_procedure(row: PrintedRow[AnyClaim], total: Total) -> Iterator[Finding]:
    answer = row.study.per_joint(row.pair)
    if not answer.ranges or answer.check is None:
        return
    wide = answer.ranges[0]
    shown, (low, high) = total
    inside = meet((low, high), (wide.lowest, wide.highest))
    tight = answer.check.tight_time
    message = (
        f"Each joint at its own {answer.joint_evidence} optimum, then the longest per segment, "
        f"gives {ranged(wide.lowest, wide.highest, '.4f')} s while every joint stays within "
        f"{seconds(wide.slack, 'g')} of its optimum, and {seconds(answer.total_time, '.4f')} at "
        "these optima"
        + (
            f" (free rescaling of that motion: {seconds(tight, '.4f')})"
            if tight is not None
            else ""
        )
        + f"; the printed {shown} lies {'inside' if inside else 'outside'} that range."
    )
    yield TG302.finding(
        row,
        "joint by joint",
        message,
        verdict=ClaimVerdict.SUPPORTED if inside else ClaimVerdict.NOT_CHECKABLE,
        evidence=answer.evidence,
        printed=shown,
        computed=f"{ranged(wide.lowest, wide.highest, '.6f')} s",
        decides=False,
    )


@dataclass
class _Sides:
    """What speaks for and against a statement that totals are optimal, under one reading."""

    longer: list[str] = field(default_factory=list)
    most: Gap | None = None
    farthest: str = ""
    breaking: list[str] = field(default_factory=list)
    roots: list[str] = field(default_factory=list)
    agreeing: list[str] = field(default_factory=list)
    summed: int = 0
    rounded_up: bool = False
    open: list[str] = field(default_factory=list)
    solutions: list[Solution] = field(default_factory=list)


def _weigh(row: PrintedRow[AnyClaim], sides: _Sides) -> None:
    """Set one printed total beside the optimum of its problem."""
    claim = row.claim
    total = row.total
    if total is None:
        return
    shown, interval = total
    name = called_under(row.study.case, claim, row.problem)
    other = off_ratios(row)
    if other is not None:
        sides.open.append(f"{name}: printed are {other}, which answer another question")
        return
    solution = row.optimum
    shorter = _shorter(row, total)
    apart = contradicting_lows(row)
    reached = 0.0 if shorter is None else shorter[1].reference.upper
    contradicted = bool(apart) and min(apart.values()) <= reached
    if shorter is not None and not contradicted:
        said, distance = shorter
        sides.longer.append(said)
        if sides.most is None or distance.highest > sides.most.highest:
            sides.most, sides.farthest = distance, claim.id
        return
    found = solution.found and solution.status is not Status.NOT_ATTAINED
    # Whether a bare total is too short takes a proof, which is tried only where it may succeed.
    bare = isinstance(claim, TotalTimeClaim) and found and interval[1] >= solution.best
    proof = None if bare else broken(row)
    below = None if apart else below_certified(row)
    if (shown_so := proof or below) is not None:
        first, *others = shown_so
        sides.breaking += [f"{name}: {first}", *others]
        sides.roots.append(f"{LIMITS} {claim.id}")
        return
    if apart:
        sides.open.append(
            f"{name}: printed {shown}, and also {' and '.join(apart)}; these contradict each "
            "other, and neither is used"
        )
        return
    if not found:
        sides.open.append(f"{name}: {_no_optimum(solution)}")
        return
    sides.solutions.append(solution)
    inside = rounds_to((rounded_up_low(row, interval), interval[1]), solution.best)
    if inside and not total_excludes(row, solution.best):
        sides.agreeing.append(name)
        sides.summed += isinstance(claim, RowClaim) and claim.total is None
        sides.rounded_up |= not interval[0] <= solution.best
        return
    reference = reference_of(solution)
    assert reference is not None
    distance = gap(interval, reference, feasible=False)
    sides.open.append(
        f"{name}: printed {shown} {set_beside(distance)} the "
        f"{optimum_called(solution.problem, solution.evidence)} {seconds(solution.best, '.6f')}, "
        "and no proof decides whether rounding explains the difference"
    )


def _no_optimum(solution: Solution) -> str:
    """Why there is no optimum to set a total beside."""
    why = f": {solution.why}" if solution.why else ""
    if solution.status is Status.NOT_ATTAINED:
        limits = solution.problem.limits
        free = not np.isfinite(limits.sides).any()
        said = "no limit is printed, so there is no shortest motion"
        return (said if free else "no shortest motion was found") + why
    if solution.status is Status.INFEASIBLE:
        of = at_ratios(solution.problem)
        return f"at the printed way-points no durations{of} keep the limits{why}"
    return f"no optimum was found ({solution.status}{why})"


def _optimal_statement(study: Study, statement: StatementClaim) -> Iterator[Finding]:
    """Refuted by a feasible shorter answer, or by durations that no rounding lets keep the limits.

    Shorter means: for every way-point and limit that rounds to the printed digits, the same checked
    durations, stretched as far as those may need, take less than the low end of the printed total.
    Durations that break the limits are not answers within them.
    """
    for reading, rows, others in named_rows(study, statement.of):
        sides = _Sides()
        for row in rows:
            minimised = other_objective(study.case, row.claim)
            if minimised is None:
                _weigh(row, sides)
            else:
                name = called_under(study.case, row.claim, row.problem)
                sides.open.append(
                    f"{name}: minimised for {minimised}, not for time alone, so a shorter "
                    "motion contradicts nothing"
                )
        if not (sides.longer or sides.breaking or sides.agreeing or sides.open):
            continue
        for one in others:
            sides.open.append(f"{called(one)}: on another curve, so the optimum does not apply")
        evidence = weakest(one.evidence for one in sides.solutions)
        longer, breaking = sides.longer, sides.breaking
        if longer or breaking:
            # What refutes is a motion or a broken limit: no optimum, known or certified, is needed.
            evidence, verdict = Evidence.NONE, ClaimVerdict.REFUTED
            every = "however the digits were rounded"
            said = [f"{one}." for one in longer]
            if longer:
                said[0] = f"Not the shortest, {every}: {said[0]}"
            said += ["The printed motion breaks a limit.", *breaking] if breaking else []
        elif sides.open:
            verdict = ClaimVerdict.NOT_CHECKABLE
            said = [f"Not decided: {'; '.join(sides.open)}."]
        else:
            verdict = ClaimVerdict.SUPPORTED
            called_so = {optimum_called(one.problem, evidence) for one in sides.solutions}
            rounded = " if digits were rounded up to keep the limits" if sides.rounded_up else ""
            which = " or the ".join(sorted(called_so))
            whose = _what_agrees(len(sides.agreeing), sides.summed)
            said = [f"{whose} the {which}{rounded}."]
        yield TG302.finding(
            statement,
            "longer" if longer else "breaks" if breaking else str(evidence),
            *said,
            verdict=verdict,
            evidence=evidence,
            basis=Basis.ENCLOSURE if breaking and not longer else Basis.OPTIMUM,
            reading=reading,
            gap=known(sides.most, "no time is compared with a motion"),
            farthest=sides.farthest,
            root=f"{OPTIMAL} {statement.id}" if longer else "",
            follows=() if longer else tuple(sides.roots),
        )


def _what_agrees(count: int, sums: int) -> str:
    """What agrees, up to the reference: printed totals, or sums of durations."""
    if not sums:
        return "Every printed total agrees with"
    if sums < count:
        whose = "Every printed total, or the sum of the printed durations if none is printed,"
        return f"{whose} agrees with"
    which = "the printed durations" if count == 1 else "the durations of each row"
    return f"The sum of {which} agrees with"


def _shorter(row: PrintedRow[AnyClaim], total: Total) -> tuple[str, Gap] | None:
    """A checked motion that is shorter whatever the digits stand for, if there is one.

    Where the solver proves that no motion is the shortest, none is set beside a printed total: that
    every motion can be shortened refutes no number.
    """
    solution = row.optimum
    if not solution.found or solution.status is Status.NOT_ATTAINED:
        return None
    shown, interval = total
    reached = row.reachable(solution.durations)
    if reached is None or rounded_up_low(row, interval) <= reached:
        return None
    distance = gap(interval, Reference(upper=reached), feasible=row.kept)
    jumps = solution.check is not None and any(j.order == 1 for j in solution.check.jumps)
    kind = " whose velocity may jump at the via-points under this reading" if jumps else ""
    said = (
        f"{called(row.claim)} prints {shown}, and a checked motion{kind}"
        f"{at_ratios(solution.problem)} takes at most {shown_bound(reached, 'upper', places=6)} s"
    )
    return said, distance
