"""TG201, TG202, TG204 and TG206: printed durations rebuilt and judged in continuous time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....problem import QUANTITIES, Verdict
from ....problem.cases import (
    AnyClaim,
    DurationsClaim,
    MaximumClaim,
    StatementClaim,
    TimeClaim,
    TotalTimeClaim,
)
from ....verify import shown_bound
from ...documents import Basis, ClaimVerdict, Finding, Rounding, Severity
from ..roots import LIMITS
from ..row import Row, left_out, rows, rows_under
from ..stated import all_called, called_under
from ..study import Study
from .kept_limits import UNSAID, meant_to_keep, said_of, said_to_keep
from .linear_blends import BLENDS, blended, judge_row
from .peaks import JUMPING, box_reach, jump_size, jump_unit, largest, largest_of_each_kind


@dataclass(frozen=True)
class _Judged:
    """What the rounding box says of printed durations."""

    verdict: ClaimVerdict
    severity: Severity
    sentences: tuple[str, ...]
    kind: str


_VERDICTS = {
    Rounding.KEEPS: (ClaimVerdict.SUPPORTED, Severity.INFO),
    Rounding.CONSISTENT: (ClaimVerdict.SUPPORTED, Severity.INFO),
    Rounding.BREAKS: (ClaimVerdict.REFUTED, Severity.ERROR),
    Rounding.UNDECIDED: (ClaimVerdict.NOT_CHECKABLE, Severity.INFO),
}
"""What a rounding verdict says of the claim, and how much that weighs."""
_ELSEWHERE = "elsewhere"
"""Kind of what is said of durations that are not of the problem's curve."""
_NARROW = 0.01
"""Share of a limit above which rounding blurs a peak too much to call the limit reached."""


def judge_motions(study: Study) -> Iterator[Finding]:
    """Findings of TG201, TG202, TG204 and TG206."""
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


def _ratio(row: Row[AnyClaim]) -> str:
    worst = row.check.worst
    if worst is None:
        return "no limit applies"
    if worst.quantity == "curve":
        return "the printed durations define no curve"
    whose = f"joint {worst.joint}" if worst.joint is not None else f"segment {worst.segment + 1}"
    unit = row.unit(worst.quantity, worst.joint)
    value = row.in_units(worst.quantity, abs(worst.value), worst.joint)
    limit = row.in_units(worst.quantity, worst.limit, worst.joint)
    return f"the {worst.quantity} of {whose} reaches {value:.6g} {unit}, limit {limit:.6g} {unit}"


def _judged(row: Row[AnyClaim]) -> _Judged:
    if isinstance(row.claim, TotalTimeClaim):
        return _judged_total(row)
    rounding = row.rounding
    verdict, severity = _VERDICTS[rounding.verdict]
    at_print = _ratio(row)
    explained = {
        Rounding.KEEPS: "The printed numbers keep every limit for all t",
        Rounding.CONSISTENT: "Some values that round to the printed digits keep every limit for "
        "all t",
        Rounding.BREAKS: "A limit is broken however the digits were rounded",
        Rounding.UNDECIDED: "The printed digits do not decide whether the limits are kept",
    }[rounding.verdict]
    kind = str(rounding.verdict)
    found = row.check
    if found.verdict is Verdict.DISCONTINUOUS and rounding.verdict is Rounding.UNDECIDED:
        kind = str(found.verdict)
        jumps = sum(jump.order == 1 for jump in found.jumps)
        explained = (
            "The motion is discontinuous: the printed numbers keep every limit inside the "
            f"segments, and the velocity jumps {jumps} times between them, which takes an infinite "
            "acceleration"
        )
    said = [f"{explained}.", f"At the printed numbers {at_print}."]
    loose = row.statement.declaration.loose
    if rounding.verdict is Rounding.UNDECIDED and loose:
        said.append(f"{loose} are printed numbers, and no proof covers their rounding.")
    bound = rounding.lower_bound_of_worst
    if rounding.verdict is Rounding.BREAKS and bound is not None:
        said.append(
            f"Whatever the rounding, a limit is exceeded by a factor of at least "
            f"{shown_bound(bound, 'lower')}."
        )
    if rounding.verdict is Rounding.BREAKS:
        cut = row.cut.verdict
        if cut is not Rounding.BREAKS:
            kept = cut is not Rounding.UNDECIDED
            verdict = ClaimVerdict.SUPPORTED if kept else ClaimVerdict.NOT_CHECKABLE
            said.append(f"With digits cut off instead of rounded: {cut}.")
            return _Judged(verdict, Severity.WARNING, tuple(said), kind)
        said.append("The same holds with digits cut off instead of rounded.")
    return _Judged(verdict, severity, tuple(said), kind)


def _judged_total(row: Row[AnyClaim]) -> _Judged:
    """A total without its durations: refuted where no motion that short keeps the limits."""
    printed = row.study.total_digits(row.claim)
    if row.total_excluded:
        excluded = (
            f"No motion within the limits takes {printed} or less, however the digits were rounded "
            "or cut off."
        )
        return _Judged(ClaimVerdict.REFUTED, Severity.ERROR, (excluded,), "total excluded")
    said = (
        f"Only the total is printed, {printed}, and no durations: whether its motion keeps the "
        "limits cannot be computed.",
        "That none of that length does was not shown.",
    )
    return _Judged(ClaimVerdict.NOT_CHECKABLE, Severity.INFO, said, "total open")


def broken(row: Row[AnyClaim]) -> tuple[str, ...] | None:
    """What shows that a limit is broken, for all values rounded or cut off to the digits; or None.

    For a total without its durations: that no motion so short keeps the limits.
    """
    if not isinstance(row.claim, TimeClaim):
        return None
    if row.unmoved is not None:
        return None
    judged = _judged(row)
    return judged.sentences if judged.verdict is ClaimVerdict.REFUTED else None


def _limits(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    unsaid = "" if said_to_keep(study, claim) else UNSAID
    for row in rows(study, claim):
        judged = _judged(row)
        verdict, severity = said_of(study, claim, judged.verdict, judged.severity)
        yield Finding(
            rule="TG201",
            severity=severity,
            verdict=verdict,
            basis=Basis.ENCLOSURE,
            claim=claim.id,
            problem=row.problem,
            reading=row.reading,
            printed=study.durations_digits(claim),
            computed=_ratio(row),
            kind=judged.kind,
            sentences=(
                *judged.sentences,
                "" if verdict is ClaimVerdict.SUPPORTED else unsaid,
            ),
            decides=meant_to_keep(study, claim),
            root=f"{LIMITS} {claim.id}" if judged.verdict is ClaimVerdict.REFUTED else "",
        )


def _jumps(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """Name a motion that jumps under a reading; no word of the paper is judged by that."""
    for row in rows(study, claim):
        found = row.check.jumps
        velocity = [jump for jump in found if jump.order == 1]
        if not velocity:
            continue
        tops = largest_of_each_kind([(row, jump) for jump in velocity])
        sizes = [f"{abs(jump_size(row, top)):.6g} {jump_unit(row, top)}" for _, top in tops]
        most = " and ".join(
            f"in joint {top.joint} at t = {top.time:.6g} s by {size}"
            for (_, top), size in zip(tops, sizes, strict=True)
        )
        yield Finding(
            rule="TG202",
            basis=Basis.CHECK,
            claim=claim.id,
            problem=row.problem,
            reading=row.reading,
            printed=study.durations_digits(claim),
            computed=f"{len(velocity)} jumps of velocity, up to {' and '.join(sizes)}",
            kind="velocity jumps",
            sentences=(
                f"The motion is discontinuous under this reading: velocity jumps {len(velocity)} "
                f"times at the via-points, most {most}.",
                "Limits are judged apart from jumps.",
            ),
            decides=False,
        )


def _limits_statement(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    about = [study.case.claim(i) for i in claim.of]
    for reading in study.readings:
        judged: list[tuple[AnyClaim, str | None, _Judged]] = [
            (row.claim, row.problem, _judged(row)) for row in rows_under(study, about, reading)
        ]
        judged += [
            one for c in left_out(study, about, reading) for one in _elsewhere(study, c, reading)
        ]
        if not judged:
            continue
        breaking = [one for one in judged if one[2].verdict is ClaimVerdict.REFUTED]
        if breaking:
            verdict = ClaimVerdict.REFUTED
            sentences = [x for one in breaking for x in _placed(study, claim, *one)]
        elif all(one.verdict is ClaimVerdict.SUPPORTED for _, _, one in judged):
            verdict = ClaimVerdict.SUPPORTED
            every = all_called(c for c, _, _ in judged)
            which = (
                f"The printed durations ({every}) keep"
                if len(judged) == 1
                else f"Every printed set of durations ({every}) keeps"
            )
            sentences = [
                f"{which} the limits for all t, as printed or for some values that are rounded or "
                f"cut off to {'their' if len(judged) == 1 else 'its'} digits."
            ]
        else:
            verdict = ClaimVerdict.NOT_CHECKABLE
            undecided = [one for one in judged if one[2].verdict is ClaimVerdict.NOT_CHECKABLE]
            names = all_called(c for c, _, _ in undecided)
            sentences = [
                x
                for one in undecided
                if one[2].kind in (str(Verdict.DISCONTINUOUS), "total open", _ELSEWHERE)
                for x in _placed(study, claim, *one)
            ] or [f"The printed digits do not decide whether the limits are kept: {names}."]
        yield Finding(
            rule="TG201",
            verdict=verdict,
            basis=Basis.ENCLOSURE,
            claim=claim.id,
            reading=reading,
            kind=str(verdict),
            sentences=tuple(sentences),
            follows=tuple(f"{BLENDS if blended(c) else LIMITS} {c.id}" for c, _, _ in breaking),
        )


def _placed(
    study: Study, statement: StatementClaim, claim: AnyClaim, problem: str | None, judged: _Judged
) -> tuple[str, ...]:
    """What is said of durations, behind their place where the statement stands at another."""
    first, *others = judged.sentences
    where = called_under(study.case, claim, problem)
    return first if where == statement.where else f"{where}: {first}", *others


def _elsewhere(
    study: Study, claim: AnyClaim, reading: str
) -> Iterator[tuple[AnyClaim, str | None, _Judged]]:
    """What is known of the limits where no motion is built: rows with blends have a rule."""
    rows = [row for row in judge_row(study, claim) if row.reading == reading]
    for row in rows:
        if row.verdict is not None:
            judged = _Judged(row.verdict, row.severity, row.sentences, _ELSEWHERE)
            yield claim, str(row.problem), judged
    if not rows:
        said = "No motion is built from these durations here, so that they are not judged."
        judged = _Judged(ClaimVerdict.NOT_CHECKABLE, Severity.INFO, (said,), _ELSEWHERE)
        yield claim, claim.problem, judged


def _continuity(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    for reading in study.readings:
        jumps, built = [], True
        motions = rows_under(study, map(study.case.claim, claim.of), reading)
        for row in motions:
            curve = row.posed().curve
            built &= all(curve.smooth_order(k) >= 2 for k in range(1, curve.segments))
            jumps += [(row, jump) for jump in row.check.jumps]
        if not motions:
            continue
        count = len(motions)
        which = {1: "the motion", 2: "both motions"}.get(count, f"all {count} motions")
        verdict, kind, more = ClaimVerdict.SUPPORTED, "continuous", ""
        message = (
            f"In {which} rebuilt from the printed durations, position, velocity and acceleration "
            "agree on both sides of every via-point."
        )
        if others := left_out(study, map(study.case.claim, claim.of), reading):
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "in part"
            more = f"No motion is built from {all_called(others)}, which it names too."
        if jumps and all(map(_may_be_smooth, motions)):
            verdict, kind, more = ClaimVerdict.NOT_CHECKABLE, "may be smooth", ""
            message = (
                "The motion jumps at the printed durations; what rounds to them or is cut off to "
                "them may have the proportions of the parameters, with which it is smooth."
            )
        elif jumps:
            largest_ones = " and ".join(
                f"in {JUMPING[top.order]} of joint {top.joint} at t = {top.time:.6g} s by "
                f"{jump_size(row, top):.6g} {jump_unit(row, top)}"
                for row, top in largest_of_each_kind(jumps)
            )
            verdict, kind, more = ClaimVerdict.INCONSISTENT, "jumps", ""
            message = (
                f"The motion is discontinuous: {len(jumps)} jumps, the largest {largest_ones}."
            )
        yield Finding(
            rule="TG202",
            verdict=verdict,
            basis=Basis.CHECK,
            claim=claim.id,
            reading=reading,
            kind=kind,
            sentences=(message, more),
            built=built and verdict is ClaimVerdict.SUPPORTED,
        )


def _may_be_smooth(row: Row[AnyClaim]) -> bool:
    """Whether durations that round to the digits have the proportions with which nothing jumps."""
    problem = row.posed()
    shares = problem.curve.smooth_shares(problem.waypoints)
    if shares is None:
        return not row.check.jumps
    if row.statement.loose_ends:
        return True
    box = row.boxes[0].or_cut_off()
    return bool((box.lower / shares).max() <= (box.upper / shares).min())


def _said_to_jump(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    """A reading under which acceleration does not jump speaks against itself, not the paper."""
    for reading in study.readings:
        motions = rows_under(study, map(study.case.claim, claim.of), reading)
        jumps = [
            (row, jump)
            for row in motions
            for jump in row.check.jumps
            if jump.order == 2 and claim.joint in (None, jump.joint)
        ]
        if not motions:
            continue
        whose = "" if claim.joint is None else f" of joint {claim.joint}"
        if jumps:
            most = " and ".join(
                f"at t = {top.time:.6g} s by {jump_size(row, top):.6g} {jump_unit(row, top)}"
                for row, top in largest_of_each_kind(jumps)
            )
            verdict, kind = ClaimVerdict.SUPPORTED, "jumps"
            message = (
                f"Under this reading the acceleration{whose} jumps at {len(jumps)} breaks, most "
                f"{most}."
            )
        else:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "agrees"
            message = (
                f"Under this reading the acceleration{whose} agrees on both sides of every break; "
                "steep is not the same as discontinuous, and the figures are not in the text."
            )
        yield Finding(
            rule="TG206",
            verdict=verdict,
            basis=Basis.CHECK,
            claim=claim.id,
            reading=reading,
            kind=kind,
            sentences=(message,),
        )


def _used_up(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    for row in rows(study, claim):
        if not row.has_curve:
            continue
        problem = row.posed()
        tight = []
        for r, quantity in enumerate(QUANTITIES, start=1):
            limits = problem.limits.sides[:, :, r - 1]
            for top in largest(row, r):
                limit = float(limits[int(top.value > 0.0), top.joint])
                if not np.isfinite(limit):
                    continue
                reach = box_reach(row, top)
                if abs(abs(top.value) - limit) <= reach <= _NARROW * limit:
                    label = problem.joints[top.joint]
                    value, around, bound = (
                        row.in_units(quantity, x, label) for x in (abs(top.value), reach, limit)
                    )
                    tight.append(
                        f"joint {label} {quantity} {value:.6g} ± {around:.1g} "
                        f"at its limit {bound:.6g} {row.unit(quantity, label)}"
                    )
        if tight:
            yield Finding(
                rule="TG204",
                verdict=ClaimVerdict.SUPPORTED,
                basis=Basis.CHECK,
                claim=claim.id,
                problem=row.problem,
                reading=row.reading,
                printed=study.durations_digits(claim),
                computed="; ".join(tight),
                kind="reached",
                sentences=(
                    "To first order in the rounding of the printed inputs, a limit is reached: "
                    f"{'; '.join(tight)}.",
                ),
                decides=False,
            )
