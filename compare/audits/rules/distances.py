"""TG302 and TG303: printed totals beside the optimum of their formulation and the shared one."""

from __future__ import annotations

from collections.abc import Iterator

from ....nlp import Evidence, Solution, Status, weakest
from ....problem import Coupling
from ....problem.cases import (
    AnyClaim,
    DurationsClaim,
    MaximumClaim,
    StatementClaim,
    TotalTimeClaim,
)
from ...documents import (
    Basis,
    ClaimVerdict,
    Finding,
    Gap,
    GapKind,
    Reference,
    Rounding,
    Severity,
    Why,
)
from ...gaps import gap, reference_of
from ..explanations import LIMITS, OPTIMAL
from ..study import Study
from .continuous_time import broken

_BELOW = (
    " The whole printed interval lies below the best known total. That value is not a proven "
    "bound; the limits, the reading or the printed digits differ, or a better optimum exists."
)
"""What is said of a printed total below a best known one."""
_BELOW_BOUND = (
    " The whole printed interval lies below the proved lower bound of this problem as printed: "
    "the limits, the reading or the digits of the way-points differ."
)
"""What is said of a printed total below a proved bound."""


def judge_distances(study: Study) -> Iterator[Finding]:
    """Findings of TG302 and TG303."""
    for claim in study.claims:
        if isinstance(claim, DurationsClaim | MaximumClaim | TotalTimeClaim):
            for pid, rid in study.claim_pairs(claim):
                yield from _beside_optimum(study, claim, pid, rid)
        elif isinstance(claim, StatementClaim) and claim.checks == "optimal":
            yield from _optimal_statement(study, claim)


def _kept(study: Study, claim: AnyClaim, pid: str, rid: str) -> bool:
    if isinstance(claim, TotalTimeClaim) or study.unmoved(claim, pid, rid) is not None:
        return False
    return study.claim_rounding(claim, pid, rid).verdict in (Rounding.KEEPS, Rounding.CONSISTENT)


def _beside_optimum(study: Study, claim: AnyClaim, pid: str, rid: str) -> Iterator[Finding]:
    total = study.claim_total(claim, rid)
    if total is None:
        return
    problem = study.claim_problem(claim, pid, rid)
    procedure = len(problem.joints) > 1 and study.problem(pid, rid).coupling is Coupling.PER_JOINT
    solution = study.claim_optimum(claim, pid, rid)
    reference = reference_of(solution)
    if reference is not None:
        yield _distance(study, claim, pid, rid, total, solution, reference, procedure)
    if procedure:
        yield from _beside_procedure(study, claim, pid, rid, total)


def _distance(
    study: Study,
    claim: AnyClaim,
    pid: str,
    rid: str,
    total: tuple[str, tuple[float, float]],
    solution: Solution,
    reference: Reference,
    shared: bool,
) -> Finding:
    shown, interval = total
    kept = _kept(study, claim, pid, rid)
    distance = gap(interval, reference, feasible=kept)
    which = "with shared durations" if shared or claim.joint is None else f"of joint {claim.joint}"
    message = (
        f"Printed {shown}; {reference.evidence} optimum {which} {reference.upper:.6f} s"
        f"{_bounded(reference)}: {_named(distance)}."
    )
    if not isinstance(claim, TotalTimeClaim) and study.unmoved(claim, pid, rid) is None:
        verdict = study.claim_check(claim, pid, rid)
        if verdict.feasible_time is not None:
            repaired = gap(verdict.feasible_time, reference)
            message += (
                f" Feasible time of the printed durations {verdict.feasible_time:.6f} s "
                f"({repaired.percent})."
            )
    severity = Severity.INFO
    if distance.highest < 0 and broken(study, claim, pid, rid) is not None:
        message += (
            f" Below the {reference.evidence} total, which keeps the limits; these durations do "
            "not."
        )
    elif distance.highest < 0:
        severity = Severity.WARNING
        message += _BELOW if isinstance(reference.lower, Why) else _BELOW_BOUND
    return Finding(
        rule="TG303" if shared else "TG302",
        severity=severity,
        verdict=ClaimVerdict.SUPPORTED if kept else ClaimVerdict.NOT_CHECKABLE,
        evidence=solution.evidence,
        basis=Basis.OPTIMUM,
        claim=claim.id,
        problem=pid,
        reading=rid,
        printed=shown,
        computed=f"{reference.upper:.6f} s",
        gap=distance,
        message=message,
        decides=False,
    )


def _bounded(reference: Reference) -> str:
    if isinstance(reference.lower, Why):
        return ""
    width = (reference.upper - reference.lower) / reference.upper
    return f" (proved, gap {width:.1e})"


def _named(distance: Gap) -> str:
    if distance.many_times:
        return distance.percent
    name = "gap" if distance.kind is GapKind.OPTIMALITY else str(distance.kind)
    return f"{name} {distance.percent}"


def _beside_procedure(
    study: Study, claim: AnyClaim, pid: str, rid: str, total: tuple[str, tuple[float, float]]
) -> Iterator[Finding]:
    answer = study.per_joint(pid, rid)
    if not answer.ranges or answer.check is None:
        return
    wide = answer.ranges[0]
    shown, (low, high) = total
    inside = low <= wide.highest and high >= wide.lowest
    tight = answer.check.tight_time
    message = (
        f"Each joint at its own {answer.joint_evidence} optimum, then the longest per segment, "
        f"gives {wide.lowest:.4f} to {wide.highest:.4f} s while every joint stays within "
        f"{wide.slack:g} s of its optimum, and {answer.total_time:.4f} s at the optima found"
        + (f" (free rescaling of that motion: {tight:.4f} s)" if tight is not None else "")
        + f"; printed is {shown}, {'inside' if inside else 'outside'} that range."
    )
    yield Finding(
        rule="TG302",
        verdict=ClaimVerdict.SUPPORTED if inside else ClaimVerdict.NOT_CHECKABLE,
        evidence=answer.evidence,
        basis=Basis.OPTIMUM,
        claim=claim.id,
        problem=pid,
        reading=rid,
        printed=shown,
        computed=f"{wide.lowest:.6f} to {wide.highest:.6f} s",
        message=message,
        decides=False,
    )


def _optimal_statement(study: Study, statement: StatementClaim) -> Iterator[Finding]:
    """Refuted by a feasible shorter answer, or by durations that no rounding lets keep the limits.

    Shorter means: for every way-point that prints alike, the same checked durations, stretched as
    far as those way-points may need, take less than the low end of the printed total. The shortest
    answer within the limits is within the limits, so that durations which break them are not it.
    """
    for rid in study.readings:
        longer, breaking, judged, open_ = [], [], 0, 0
        roots: list[str] = []
        failed: list[str] = []
        evidence: list[Evidence] = []
        for claim in (study.case.claim(i) for i in statement.of):
            for pid, reading in study.claim_pairs(claim):
                total = study.claim_total(claim, rid)
                solution = study.claim_optimum(claim, pid, rid) if reading == rid else None
                if solution is not None and solution.status is Status.FAILED:
                    failed.append(f"{claim.id} ({pid}): {solution.why or solution.status}")
                if total is None or solution is None or solution.durations is None:
                    continue
                judged += 1
                evidence.append(solution.evidence)
                interval = total[1]
                shorter = _shorter(study, claim, pid, rid, solution, total)
                proof = broken(study, claim, pid, rid)
                best = solution.best
                if shorter is not None:
                    longer.append(shorter)
                elif proof is not None:
                    breaking.append(f"{claim.id} ({pid}): {proof}")
                    roots.append(f"{LIMITS} {claim.id}")
                elif not interval[0] <= best <= interval[1]:
                    open_ += 1
        if not judged and failed:
            yield Finding(
                rule="TG302",
                basis=Basis.OPTIMUM,
                claim=statement.id,
                reading=rid,
                message=f"No optimum to compare with: {'; '.join(failed)}.",
            )
        if not judged:
            continue
        known = weakest(evidence)
        if longer or breaking:
            # What refutes is a motion or a broken limit: no optimum, known or certified, is needed.
            known = Evidence.NONE
            verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
            said = [f"Not the shortest: {'; '.join(longer)}."] if longer else []
            said += [f"Not an answer within the limits: {' '.join(breaking)}"] if breaking else []
            message = " ".join(said)
        elif open_:
            verdict, severity = ClaimVerdict.NOT_CHECKABLE, Severity.INFO
            message = (
                f"{open_} of {judged} printed totals differ from the {known} optimum by no "
                "more than the rounding of the inputs explains, or lie below it."
            )
        else:
            verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
            message = f"Every printed total agrees with the {known} optimum."
        yield Finding(
            rule="TG302",
            severity=severity,
            verdict=verdict,
            evidence=known,
            basis=Basis.ENCLOSURE if breaking and not longer else Basis.OPTIMUM,
            claim=statement.id,
            reading=rid,
            message=message,
            kind="longer" if longer else "breaks" if breaking else str(known),
            root=f"{OPTIMAL} {statement.id}" if longer else "",
            follows=() if longer else tuple(roots),
        )


def _shorter(
    study: Study,
    claim: AnyClaim,
    pid: str,
    rid: str,
    solution: Solution,
    total: tuple[str, tuple[float, float]],
) -> str | None:
    """A checked motion that is shorter whatever the way-points round from, if there is one."""
    assert solution.durations is not None
    shown, interval = total
    problem = study.claim_problem(claim, pid, rid)
    reached = study.reachable(problem, solution.durations, pid, rid)
    if reached is None or interval[0] <= reached:
        return None
    distance = gap(interval, Reference(upper=reached), feasible=_kept(study, claim, pid, rid))
    jumps = solution.check is not None and any(j.order == 1 for j in solution.check.jumps)
    kind = "a checked motion, whose velocity may jump at the via-points under this reading,"
    return (
        f"{claim.id} ({pid}): printed {shown}; {kind if jumps else 'a checked motion'} takes "
        f"{reached:.6f} s for every way-point that prints alike ({_named(distance)})"
    )
