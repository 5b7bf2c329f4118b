"""TG201 to TG204: printed durations rebuilt and judged in continuous time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....problem import QUANTITIES, Extremum, Verdict, extrema, fit, peak_gradients
from ....problem.cases import (
    AnyClaim,
    DurationsClaim,
    MaximumClaim,
    PeakClaim,
    StatementClaim,
)
from ...documents import UNITS, Basis, ClaimVerdict, Finding, Rounding, Severity
from ..explanations import LIMITS
from ..study import Study


@dataclass(frozen=True)
class _Judged:
    """What the rounding box says of printed durations."""

    verdict: ClaimVerdict
    severity: Severity
    message: str
    kind: str


_VERDICTS = {
    Rounding.KEEPS: (ClaimVerdict.SUPPORTED, Severity.INFO),
    Rounding.CONSISTENT: (ClaimVerdict.SUPPORTED, Severity.INFO),
    Rounding.BREAKS: (ClaimVerdict.REFUTED, Severity.ERROR),
    Rounding.UNDECIDED: (ClaimVerdict.NOT_CHECKABLE, Severity.INFO),
}
"""What a rounding verdict says of the claim, and how much that weighs."""
_NARROW = 0.01
"""Share of a limit above which rounding blurs a peak too much to call the limit reached."""


def judge_motions(study: Study) -> Iterator[Finding]:
    """Findings of TG201 to TG204."""
    for claim in study.claims:
        if isinstance(claim, DurationsClaim | MaximumClaim):
            yield from _limits(study, claim)
            yield from _jumps(study, claim)
            yield from _used_up(study, claim)
        elif isinstance(claim, StatementClaim) and claim.checks == "within_limits":
            yield from _limits_statement(study, claim)
        elif isinstance(claim, StatementClaim) and claim.checks == "continuous":
            yield from _continuity(study, claim)
        elif isinstance(claim, StatementClaim) and claim.checks == "jumps":
            yield from _said_to_jump(study, claim)
        elif isinstance(claim, PeakClaim):
            yield from _peak(study, claim)


def _durations_text(claim: AnyClaim) -> str:
    durations = claim.durations if isinstance(claim, DurationsClaim | MaximumClaim) else ()
    return ", ".join(str(d) for d in durations)


def _ratio(study: Study, claim: AnyClaim, pid: str, rid: str) -> str:
    worst = study.claim_check(claim, pid, rid).worst
    if worst is None:
        return "nothing is limited"
    if worst.quantity == "curve":
        return "the printed durations define no curve"
    where = f"joint {worst.joint} " if worst.joint is not None else f"segment {worst.segment + 1} "
    unit = "s" if worst.quantity == "duration" else UNITS[worst.quantity]
    return f"{where}{worst.quantity} {abs(worst.value):.6g} against {worst.limit:.6g} {unit}"


def _judged(study: Study, claim: AnyClaim, pid: str, rid: str) -> _Judged:
    rounding = study.claim_rounding(claim, pid, rid)
    verdict, severity = _VERDICTS[rounding.verdict]
    at_print = _ratio(study, claim, pid, rid)
    explained = {
        Rounding.KEEPS: "The printed point keeps every limit for all t",
        Rounding.CONSISTENT: "Some input that prints alike keeps every limit for all t",
        Rounding.BREAKS: "Every input that prints alike breaks a limit",
        Rounding.UNDECIDED: "The printed digits do not decide whether the limits are kept",
    }[rounding.verdict]
    kind = str(rounding.verdict)
    found = study.claim_check(claim, pid, rid)
    if found.verdict is Verdict.DISCONTINUOUS and rounding.verdict is Rounding.UNDECIDED:
        kind = str(found.verdict)
        jumps = sum(jump.order == 1 for jump in found.jumps)
        explained = (
            "discontinuous: the printed point keeps every limit inside the segments, and the "
            f"velocity jumps {jumps} times between them, which no finite acceleration does"
        )
    message = f"{explained} ({rounding.verdict}); largest at the printed point: {at_print}."
    bound = rounding.lower_bound_of_worst
    if rounding.verdict is Rounding.BREAKS and bound is not None:
        message += f" Over the whole rounding box the ratio is at least {bound:.6g}."
    if rounding.verdict is Rounding.BREAKS:
        cut = study.claim_cut(claim, pid, rid).verdict
        if cut is not Rounding.BREAKS:
            kept = cut is not Rounding.UNDECIDED
            verdict = ClaimVerdict.SUPPORTED if kept else ClaimVerdict.NOT_CHECKABLE
            message += f" With digits cut off instead of rounded: {cut}."
            return _Judged(verdict, Severity.WARNING, message, kind)
        message += " So does every input with digits cut off instead of rounded."
    return _Judged(verdict, severity, message, kind)


def broken(study: Study, claim: AnyClaim, pid: str, rid: str) -> str | None:
    """What shows that every input printing alike, rounded or cut off, breaks a limit; or None."""
    if not isinstance(claim, DurationsClaim | MaximumClaim):
        return None
    if study.unmoved(claim, pid, rid) is not None:
        return None
    judged = _judged(study, claim, pid, rid)
    return judged.message if judged.verdict is ClaimVerdict.REFUTED else None


def said_to_keep(study: Study, claim: AnyClaim) -> bool:
    """Whether durations are meant as an answer within the limits.

    They are if an algorithm found them, or a statement about limits or optimality names them; a
    paper that says of other durations that they keep the limits says nothing of these.
    """
    about = [
        c.of
        for c in study.case.claims
        if isinstance(c, StatementClaim) and c.checks in ("within_limits", "optimal")
    ]
    return claim.algorithm is not None or not about or any(claim.id in named for named in about)


def _limits(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    said = said_to_keep(study, claim)
    for pid, rid in study.claim_pairs(claim):
        judged = _judged(study, claim, pid, rid)
        unsaid = "" if said else " Nothing printed says that these durations keep the limits."
        yield Finding(
            rule="TG201",
            severity=judged.severity if said else Severity.INFO,
            verdict=judged.verdict if said else ClaimVerdict.NOT_CHECKABLE,
            basis=Basis.ENCLOSURE,
            claim=claim.id,
            problem=pid,
            reading=rid,
            printed=f"{_durations_text(claim)} s",
            computed=_ratio(study, claim, pid, rid),
            message=judged.message + unsaid,
            decides=said,
            kind=judged.kind,
            root=f"{LIMITS} {claim.id}" if judged.verdict is ClaimVerdict.REFUTED else "",
        )


def _jumps(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """Name a motion that jumps under a reading; no word of the paper is judged by that."""
    for pid, rid in study.claim_pairs(claim):
        found = study.claim_check(claim, pid, rid).jumps
        velocity = [jump for jump in found if jump.order == 1]
        if not velocity:
            continue
        top = max(velocity, key=lambda jump: abs(jump.size))
        yield Finding(
            rule="TG202",
            basis=Basis.CHECK,
            claim=claim.id,
            problem=pid,
            reading=rid,
            printed=f"{_durations_text(claim)} s",
            computed=f"{len(velocity)} jumps of velocity, up to {abs(top.size):.6g} rad/s",
            message=(
                f"discontinuous under this reading: the velocity jumps {len(velocity)} times at "
                f"the via-points, most in joint {top.joint} at t = {top.time:.6g} s by "
                f"{top.size:.6g} rad/s. Limits are judged apart from jumps."
            ),
            decides=False,
        )


def _limits_statement(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    about = [study.case.claim(i) for i in claim.of]
    for rid in study.readings:
        judged = [
            (c, pid, _judged(study, c, pid, rid))
            for c in about
            for pid, reading in study.claim_pairs(c)
            if reading == rid
        ]
        if not judged:
            continue
        breaking = [one for one in judged if one[2].verdict is ClaimVerdict.REFUTED]
        if breaking:
            verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
            message = " ".join(f"{c.id} ({pid}): {one.message}" for c, pid, one in breaking)
        elif all(one.verdict is ClaimVerdict.SUPPORTED for _, _, one in judged):
            verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
            every = ", ".join(dict.fromkeys(c.id for c, _, _ in judged))
            message = (
                f"Every printed set of durations ({every}) keeps the limits for all t, or some "
                "input that prints alike does."
            )
        else:
            verdict, severity = ClaimVerdict.NOT_CHECKABLE, Severity.INFO
            undecided = [one for one in judged if one[2].verdict is ClaimVerdict.NOT_CHECKABLE]
            names = ", ".join(c.id for c, _, _ in undecided)
            message = f"The printed digits do not decide {names}."
            jumping = [
                f"{c.id} ({pid}): {one.message}"
                for c, pid, one in undecided
                if study.claim_check(c, pid, rid).verdict is Verdict.DISCONTINUOUS
            ]
            message = " ".join(jumping) or message
        yield Finding(
            rule="TG201",
            severity=severity,
            verdict=verdict,
            basis=Basis.ENCLOSURE,
            claim=claim.id,
            reading=rid,
            message=message,
            kind=str(verdict),
            follows=tuple(f"{LIMITS} {c.id}" for c, _, _ in breaking),
        )


def _continuity(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    for rid in study.readings:
        jumps = []
        judged = 0
        for other in (study.case.claim(i) for i in claim.of):
            for pid, reading in study.claim_pairs(other):
                if reading == rid:
                    judged += 1
                    jumps += list(study.claim_check(other, pid, rid).jumps)
        if not judged:
            continue
        message = (
            f"Rebuilt from the printed durations, position, velocity and acceleration of "
            f"{judged} motion(s) agree on both sides of every via-point."
        )
        verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
        if jumps:
            top = max(jumps, key=lambda j: abs(j.size))
            names = ("position", "velocity", "acceleration")
            verdict, severity = ClaimVerdict.INCONSISTENT, Severity.WARNING
            message = (
                f"discontinuous: {len(jumps)} jumps, the largest in {names[top.order]} of joint "
                f"{top.joint} at t = {top.time:.6g} s by {top.size:.6g}."
            )
        yield Finding(
            rule="TG202",
            severity=severity,
            verdict=verdict,
            basis=Basis.CHECK,
            claim=claim.id,
            reading=rid,
            message=message,
        )


def _said_to_jump(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    """A reading under which acceleration does not jump speaks against itself, not the paper."""
    for rid in study.readings:
        jumps, judged = [], 0
        for other in (study.case.claim(i) for i in claim.of):
            for pid, reading in study.claim_pairs(other):
                if reading == rid:
                    judged += 1
                    found = study.claim_check(other, pid, rid).jumps
                    jumps += [j for j in found if j.order == 2 and claim.joint in (None, j.joint)]
        if not judged:
            continue
        whose = "" if claim.joint is None else f" of joint {claim.joint}"
        if jumps:
            top = max(jumps, key=lambda j: abs(j.size))
            verdict = ClaimVerdict.SUPPORTED
            message = (
                f"Under this reading the acceleration{whose} jumps at {len(jumps)} breaks, most at "
                f"t = {top.time:.6g} s by {top.size:.6g} rad/s²."
            )
        else:
            verdict = ClaimVerdict.NOT_CHECKABLE
            message = (
                f"Under this reading the acceleration{whose} agrees on both sides of every break; "
                "steep is not the same as discontinuous, and the figures are not in the text."
            )
        yield Finding(
            rule="TG206",
            verdict=verdict,
            basis=Basis.CHECK,
            claim=claim.id,
            reading=rid,
            message=message,
        )


def _box_reach(study: Study, claim: AnyClaim, pid: str, rid: str, point: Extremum) -> float:
    """First-order change of an extremum over the rounding box."""
    problem = study.claim_problem(claim, pid, rid)
    box = study.case.claim_durations(claim, rid)
    lower, upper = study.case.waypoint_box(pid, rid)
    joint = study.problem(pid, rid).joints.index(problem.joints[point.joint])
    g = peak_gradients(problem, box.value, [point])
    by_time = np.abs(g.durations[0]) @ (box.upper - box.lower) / 2
    by_angle = np.abs(g.waypoints[0]) @ (upper[:, joint] - lower[:, joint]) / 2
    return float(by_time + by_angle)


def _largest(study: Study, claim: AnyClaim, pid: str, rid: str, order: int) -> list[Extremum]:
    """Largest extremum of each joint of the claim's problem, at the printed point."""
    problem = study.claim_problem(claim, pid, rid)
    durations = study.case.claim_durations(claim, rid).value
    trajectory = fit(problem.curve, problem.waypoints, durations)
    return [
        max(extrema(trajectory, j, order), key=lambda e: abs(e.value))
        for j in range(len(problem.joints))
    ]


def _has_curve(study: Study, claim: AnyClaim, pid: str, rid: str) -> bool:
    """Whether the printed durations define a curve under a reading."""
    worst = study.claim_check(claim, pid, rid).worst
    return worst is None or worst.quantity != "curve"


def _used_up(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    for pid, rid in study.claim_pairs(claim):
        if not _has_curve(study, claim, pid, rid):
            continue
        problem = study.claim_problem(claim, pid, rid)
        tight = []
        for r, quantity in enumerate(QUANTITIES, start=1):
            limits = problem.limits.derivatives[:, r - 1]
            for top in _largest(study, claim, pid, rid, r):
                limit = float(limits[top.joint])
                if not np.isfinite(limit):
                    continue
                reach = _box_reach(study, claim, pid, rid, top)
                if abs(abs(top.value) - limit) <= reach <= _NARROW * limit:
                    tight.append(
                        f"joint {problem.joints[top.joint]} {quantity} {abs(top.value):.6g} "
                        f"± {reach:.1g} at its limit {limit:.6g} {UNITS[quantity]}"
                    )
        if tight:
            yield Finding(
                rule="TG204",
                verdict=ClaimVerdict.SUPPORTED,
                basis=Basis.CHECK,
                claim=claim.id,
                problem=pid,
                reading=rid,
                printed=f"{_durations_text(claim)} s",
                computed="; ".join(tight),
                message="To first order in the rounding of the printed inputs, a limit is reached: "
                + "; ".join(tight)
                + ".",
                decides=False,
            )


def _peak(study: Study, claim: PeakClaim) -> Iterator[Finding]:
    sources = [
        c
        for c in study.case.claims
        if isinstance(c, DurationsClaim | MaximumClaim)
        and c.algorithm == claim.algorithm
        and c.problem == claim.problem
        and c.joint in (None, claim.joint)
    ]
    order = QUANTITIES.index(claim.derivative) + 1
    for pid, rid in study.claim_pairs(claim):
        for source in (s for s in sources[:1] if _has_curve(study, s, pid, rid)):
            problem = study.claim_problem(source, pid, rid)
            tops = _largest(study, source, pid, rid, order)
            if claim.joint is not None and claim.joint in problem.joints:
                tops = [tops[problem.joints.index(claim.joint)]]
            top = max(tops, key=lambda e: abs(e.value))
            reach = _box_reach(study, source, pid, rid, top)
            printed = study.case.measured(claim.value, claim.derivative, pid, rid)
            near = printed.lower - reach <= abs(top.value) <= printed.upper + reach
            unit = UNITS[claim.derivative]
            yield Finding(
                rule="TG203",
                severity=Severity.INFO if near else Severity.WARNING,
                verdict=ClaimVerdict.SUPPORTED if near else ClaimVerdict.INCONSISTENT,
                basis=Basis.CHECK,
                claim=claim.id,
                problem=pid,
                reading=rid,
                printed=f"{claim.value}",
                computed=f"{abs(top.value):.6g} ± {reach:.1g} {unit}",
                message=(
                    f"The printed durations of {source.id} have the peak {abs(top.value):.6g} "
                    f"± {reach:.1g} {unit} (first order in the rounding of the inputs); printed "
                    f"is {claim.value}."
                ),
                root="" if near else f"peaks of {source.id}",
                between=() if near else (claim.id, source.id),
            )
