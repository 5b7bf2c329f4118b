"""TG201, TG202, TG204 and TG206: printed durations rebuilt and judged in continuous time."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ....problem import USUAL, Verdict
from ....problem.cases import AnyClaim, StatementClaim, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..digit_ranges import below_certified
from ..own_result import UNSAID, meant_to_keep, said_of, said_to_keep
from ..printed_row import PrintedRow, named_rows, printed_rows
from ..stated import DERIVATIVES, RowClaim, all_called, called_under
from ..study import Study
from ..words import LIMITS, seconds
from .judged_rows import TG201, broken, judged_row, ratio_at_print
from .linear_blends import judge_row
from .peaks import box_reach, jump_shown, jumps_shown, largest, largest_of_each_kind
from .rule_group import INFORMS, Explained, rule_group

_ELSEWHERE = "elsewhere"
"""Kind of what is said of durations that are not of the problem's curve."""


TG202 = Explained(
    "TG202",
    "Position, velocity and acceleration are continuous",
    "Are position, velocity and acceleration continuous, as the paper says?",
    "Supported if the motion built from the printed numbers is continuous under the "
    "reading, inconsistent if it jumps. If only acceleration jumps and the claim does not name "
    "acceleration, it is not checkable: a trajectory is also called continuous if position and "
    "velocity are. Limits are judged separately from jumps.",
    "Cubic segments that are stretched one by one have equal slopes only if neighbouring "
    "durations are equal; otherwise the velocity jumps at the via-points.",
    basis=Basis.CHECK,
)
TG204 = Explained(
    "TG204",
    "The printed durations reach the limits",
    "Which limits do the printed durations reach? The shortest motion reaches at least one.",
    INFORMS + " A motion that reaches no limit could be shorter.",
    "The largest velocity is 62 % of its limit and the largest acceleration 71 %: all "
    "durations could be shortened by the same factor.",
    basis=Basis.CHECK,
    decides=False,
)
TG206 = Explained(
    "TG206",
    "Acceleration jumps where it is said to",
    "Does the acceleration jump if the paper says that a method makes it jump?",
    "Supported if it does. If it does not jump under a reading, that speaks against the reading.",
    "“The acceleration of the 3-5-3 curve changes suddenly at the via-points” is compared "
    "with the accelerations on both sides of each via-point.",
    basis=Basis.CHECK,
)


@rule_group(TG201, TG202, TG204, TG206)
def judge_motions(study: Study) -> Iterator[Finding]:
    """Findings of TG201, TG202, TG204 and TG206."""
    judges: dict[str, Callable[[Study, StatementClaim], Iterator[Finding]]]
    judges = {"within_limits": _limits_statement, "continuous": _continuity, "jumps": _said_to_jump}
    for claim in study.claims:
        if isinstance(claim, RowClaim):
            yield from _limits(study, claim)
            yield from _jumps(study, claim)
            yield from _used_up(study, claim)
        elif isinstance(claim, StatementClaim) and claim.checks in judges:
            yield from judges[claim.checks](study, claim)


@rule_group()  # it finds what TG201 finds
def judge_bare_totals(study: Study) -> Iterator[Finding]:
    """Refute totals that no motion within the limits takes, and that a statement says one does."""
    for claim in study.claims:
        if not (isinstance(claim, TotalTimeClaim) and said_to_keep(study.case, claim)):
            continue
        for row in printed_rows(study, claim):
            proof = broken(row) or below_certified(row)
            if proof is not None:
                yield TG201.finding(
                    row,
                    "total excluded",
                    *proof,
                    verdict=ClaimVerdict.REFUTED,
                    printed=f"{claim.value} {study.time_unit}",
                    root=f"{LIMITS} {claim.id}",
                )


def _limits(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    unsaid = "" if said_to_keep(study.case, claim) else UNSAID
    for row in printed_rows(study, claim):
        judged = judged_row(row)
        verdict, severity = said_of(study.case, claim, judged.verdict, judged.severity)
        yield TG201.finding(
            row,
            judged.kind,
            *judged.sentences,
            "" if verdict is ClaimVerdict.SUPPORTED else unsaid,
            severity=severity,
            verdict=verdict,
            basis=judged.basis,
            printed=study.durations_digits(claim),
            computed=ratio_at_print(row),
            decides=meant_to_keep(study.case, claim),
            root=judged.root,
        )


def _jumps(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """Name a motion that jumps under a reading; no word of the paper is judged by that."""
    for row in printed_rows(study, claim):
        velocity = [(row, jump) for jump in row.check.jumps if jump.order == 1]
        if not velocity:
            continue
        tops, sizes = largest_of_each_kind(velocity), jumps_shown(velocity)
        most = " and ".join(
            f"in joint {top.joint} at t = {seconds(top.time)} by {size}"
            for (_, top), size in zip(tops, sizes, strict=True)
        )
        yield TG202.finding(
            row,
            "velocity jumps",
            f"The motion is discontinuous under this reading: velocity jumps {len(velocity)} "
            f"times at the via-points, the largest jump {most}.",
            "Limits are judged separately from jumps.",
            printed=study.durations_digits(claim),
            computed=f"{len(velocity)} jumps of velocity, up to {' and '.join(sizes)}",
            decides=False,
        )


def _limits_statement(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    for reading, rows, others in named_rows(study, claim.of):
        judged = [judged_row(row) for row in rows]
        judged += [one for other in others for one in _elsewhere(study, other, reading)]
        if not judged:
            continue
        breaking = [one for one in judged if one.verdict is ClaimVerdict.REFUTED]
        if breaking:
            verdict = ClaimVerdict.REFUTED
            sentences = [x for one in breaking for x in _placed(study, claim, one)]
        elif all(one.verdict is ClaimVerdict.SUPPORTED for one in judged):
            verdict = ClaimVerdict.SUPPORTED
            every = all_called(study.case.claim(str(one.claim)) for one in judged)
            which = (
                f"The printed durations ({every}) keep"
                if len(judged) == 1
                else f"Every printed set of durations ({every}) keeps"
            )
            sentences = [
                f"{which} the limits for all t, as printed or for some values that are rounded or "
                "cut off to give the printed digits."
            ]
        else:
            verdict = ClaimVerdict.NOT_CHECKABLE
            undecided = [one for one in judged if one.verdict is ClaimVerdict.NOT_CHECKABLE]
            names = all_called(study.case.claim(str(one.claim)) for one in undecided)
            sentences = [
                x
                for one in undecided
                if one.kind in (str(Verdict.DISCONTINUOUS), "total open", _ELSEWHERE)
                for x in _placed(study, claim, one)
            ] or [f"The printed digits do not decide whether the limits are kept: {names}."]
        yield TG201.finding(
            claim,
            str(verdict),
            *sentences,
            verdict=verdict,
            reading=reading,
            follows=tuple(one.root for one in breaking),
        )


def _placed(study: Study, statement: StatementClaim, judged: Finding) -> tuple[str, ...]:
    """What is said of durations, behind their place where the statement stands at another."""
    first, *others = judged.sentences
    where = called_under(study.case, study.case.claim(str(judged.claim)), judged.problem)
    return first if where == statement.where else f"{where}: {first}", *others


def _elsewhere(study: Study, claim: AnyClaim, reading: str) -> list[Finding]:
    """What is known of the limits where no motion is built: rows with blends have a rule."""
    rows = [row for row in judge_row(study, claim) if row.reading == reading]
    if not rows:
        said = "No motion is built from these durations here, so they are not judged."
        problem = claim.problem
        return [TG201.finding(claim, _ELSEWHERE, said, basis=Basis.TEXT, problem=problem)]
    return [row.model_copy(update={"kind": _ELSEWHERE}) for row in rows]


def _continuity(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    for reading, motions, others in named_rows(study, claim.of):
        jumps, built = [], True
        for row in motions:
            curve = row.posed().curve
            built &= all(curve.smooth_order(k) >= 2 for k in range(1, curve.segments))
            # A step of jerk forbids a limit of snap alone.
            jumps += [(row, jump) for jump in row.check.jumps if jump.order < USUAL]
        if not motions:
            continue
        count = len(motions)
        which = {1: "the motion", 2: "both motions"}.get(count, f"all {count} motions")
        verdict, kind, more = ClaimVerdict.SUPPORTED, "continuous", ""
        message = (
            f"In {which} rebuilt from the printed durations, position, velocity and acceleration "
            "agree on both sides of every via-point."
        )
        if others:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "in part"
            more = f"No motion is built from {all_called(others)}, which it names too."
        if jumps and all(map(_may_be_smooth, motions)):
            verdict, kind, more = ClaimVerdict.NOT_CHECKABLE, "may be smooth", ""
            message = (
                "The motion jumps at the printed durations; what rounds to them or is cut off to "
                "them may have the proportions of the parameters, with which it is smooth."
            )
        elif jumps and claim.derivative != "acceleration" and all(j.order > 1 for _, j in jumps):
            said = f"Position and velocity are continuous in {which} rebuilt from the printed "
            message = f"{said}durations; acceleration jumps {len(jumps)} times."
            if claim.derivative is None:
                verdict, kind = ClaimVerdict.NOT_CHECKABLE, "acceleration jumps"
                more = "The claim does not name acceleration."
        elif jumps:
            largest_ones = " and ".join(
                f"in {DERIVATIVES[top.order]} of joint {top.joint} at t = {seconds(top.time)} by "
                f"{jump_shown(row, top)}"
                for row, top in largest_of_each_kind(jumps)
            )
            verdict, kind, more = ClaimVerdict.INCONSISTENT, "jumps", ""
            message = (
                f"The motion is discontinuous: {len(jumps)} jumps, the largest {largest_ones}."
            )
        yield TG202.finding(
            claim,
            kind,
            message,
            more,
            verdict=verdict,
            reading=reading,
            built=built and verdict is ClaimVerdict.SUPPORTED,
        )


def _may_be_smooth(row: PrintedRow[AnyClaim]) -> bool:
    """Whether durations that round to the digits have the proportions with which nothing jumps."""
    problem = row.posed()
    shares = problem.curve.smooth_shares(problem.waypoints)
    if shares is None:
        return not any(jump.order < USUAL for jump in row.check.jumps)
    if row.statement.loose_ends:
        return True
    box = row.boxes[0].or_cut_off()
    return bool((box.lower / shares).max() <= (box.upper / shares).min())


def _said_to_jump(study: Study, claim: StatementClaim) -> Iterator[Finding]:
    """A reading under which acceleration does not jump speaks against itself, not the paper."""
    for reading, motions, _ in named_rows(study, claim.of):
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
                f"at t = {seconds(top.time)} by {jump_shown(row, top)}"
                for row, top in largest_of_each_kind(jumps)
            )
            verdict, kind = ClaimVerdict.SUPPORTED, "jumps"
            message = (
                f"Under this reading the acceleration{whose} jumps at {len(jumps)} breaks, the "
                f"largest jump {most}."
            )
        else:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "agrees"
            message = (
                f"Under this reading the acceleration{whose} agrees on both sides of every break; "
                "a steep change is not a discontinuity, and the figures are not in the text."
            )
        yield TG206.finding(claim, kind, message, verdict=verdict, reading=reading)


def _used_up(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    for row in printed_rows(study, claim):
        if not row.has_curve:
            continue
        problem = row.posed()
        tight = []
        for r, quantity in enumerate(problem.limits.quantities, start=1):
            limits = problem.limits.sides[:, :, r - 1]
            for top in largest(row, r):
                limit = float(limits[int(top.value > 0.0), top.joint])
                if not np.isfinite(limit):
                    continue
                reach = box_reach(row, top)
                # Rounding by more than one per cent blurs a peak too much to call a limit reached.
                if abs(abs(top.value) - limit) <= reach <= 0.01 * limit:
                    label = problem.joints[top.joint]
                    value, around = (
                        row.in_units(quantity, x, label) for x in (abs(top.value), reach)
                    )
                    tight.append(
                        f"joint {label} {quantity} {value:.6g} ± {around:.1g} "
                        f"at its limit {row.shown(quantity, limit, label)}"
                    )
        if tight:
            yield TG204.finding(
                row,
                "reached",
                "To first order in the rounding of the printed inputs, a limit is reached: "
                f"{'; '.join(tight)}.",
                verdict=ClaimVerdict.SUPPORTED,
                printed=study.durations_digits(claim),
                computed="; ".join(tight),
            )
