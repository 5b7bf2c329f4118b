"""TG210: printed durations of linear segments with parabolic blends beside the limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeGuard

import numpy as np

from ....problem import Array, CaseError, Measured, Printed, Problem
from ....problem.cases import AnyClaim, Claim, Digits, DurationsClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..parabolic_blends import Blended, EndBlends, by_blend_accelerations, by_blend_times
from ..printed_row import PrintedRow
from ..rounding import RoundingBox
from ..study import Study
from .kept_limits import UNSAID, meant_to_keep, said_of
from .rule_group import Explained, rule_group

BLENDS = "blends"
"""Root of what follows from a row that breaks a limit."""
_SLACK = 1e-9
"""Relative margin that a limit is exceeded by at least: far above the rounding of a few quotients
to floats, far below what digits leave open."""


@dataclass(frozen=True)
class _Found:
    """What one convention says: broken for all digits, kept for all, and what is worst at print."""

    breaks: bool
    keeps: bool
    worst: str


@rule_group(
    TG210=Explained(
        "Linear segments with parabolic blends keep the limits",
        "Do linear segments with parabolic blends keep the limits with the printed durations and "
        "blends?",
        "Refuted if a speed or an acceleration exceeds its limit, or blends overlap, however the "
        "digits were rounded and wherever the end blends lie. No optimum stands "
        "beside such a motion: it does not pass its via-points.",
        "Durations of 2, 1 and 3 s and blends of 0.4 s turn joint 1 from 12.5 to -10 °/s at the "
        "first via-point, which takes 56 °/s². The limit is 50 °/s².",
    ),
)
def judge_blends(study: Study) -> Iterator[Finding]:
    """Findings of TG210."""
    for claim in study.claims:
        yield from judge_row(study, claim)


def judge_row(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """Findings of TG210 on one claim: none unless it prints blends."""
    if blended(claim):
        for pair in study.pairs:
            if claim.problem in (None, pair.problem):
                yield _beside(PrintedRow(study, claim, pair))


def blended(claim: AnyClaim) -> TypeGuard[DurationsClaim]:
    """Whether a claim prints durations of linear segments with parabolic blends."""
    if not isinstance(claim, DurationsClaim):
        return False
    return claim.blends is not None or claim.blend_acceleration is not None


def _beside(row: PrintedRow[DurationsClaim]) -> Finding:
    study, claim = row.study, row.claim
    problem = row.posed()
    segments = len(problem.waypoints) - 1
    verdict, severity = ClaimVerdict.NOT_CHECKABLE, Severity.INFO
    computed, at_print, passes = "", "", ""
    if len(claim.durations) != segments:
        message = (
            f"{len(claim.durations)} durations are printed, and {segments} straight segments join "
            "the way-points, so no motion can be built from them."
        )
    else:
        asked = [EndBlends(claim.end_blends)] if claim.end_blends else [*EndBlends]
        found = [_judged(row, problem, ends) for ends in asked]
        worst = list(dict.fromkeys(one.worst for one in found))
        computed = "; ".join(worst)
        at_print = f"At the printed numbers {worst[0]}."
        passes = (
            "Such a motion passes via-points at a distance, so that no optimum of a curve through "
            "them is set beside it, and its acceleration steps, so that its jerk is not judged."
        )
        if len(worst) > 1:
            at_print = (
                f"At the printed numbers, with end blends that reach beyond the durations, "
                f"{worst[0]}; with end blends within them, {worst[1]}."
            )
        wherever = "" if claim.end_blends else ", wherever the end blends lie"
        if all(one.breaks for one in found):
            verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
            message = (
                "Linear segments with parabolic blends break a limit with these durations"
                f"{wherever}, however the digits were rounded or cut off."
            )
        elif all(one.keeps for one in found):
            verdict = ClaimVerdict.SUPPORTED
            message = (
                "Linear segments with parabolic blends keep the limits on velocity and "
                f"acceleration with these durations{wherever}."
            )
        elif any(one.breaks for one in found):
            message = (
                "Whether linear segments with parabolic blends keep the limits with these "
                "durations depends on where the end blends lie."
            )
        else:
            message = (
                "The printed digits do not decide whether linear segments with parabolic blends "
                "keep the limits with these durations."
            )
    found_verdict = verdict
    verdict, severity = said_of(study, claim, verdict, severity)
    return Finding(
        rule="TG210",
        severity=severity,
        verdict=verdict,
        basis=Basis.ENCLOSURE,
        claim=claim.id,
        problem=row.problem,
        reading=row.reading,
        printed=study.durations_digits(claim),
        computed=computed,
        kind=str(found_verdict),
        sentences=(message, at_print, passes, UNSAID if verdict is not found_verdict else ""),
        decides=meant_to_keep(study, claim),
        root=f"{BLENDS} {claim.id}" if verdict is ClaimVerdict.REFUTED else "",
    )


def _judged(row: PrintedRow[DurationsClaim], problem: Problem, ends: EndBlends) -> _Found:
    box = row.waypoint_box(problem)
    claimed = row.durations
    durations = RoundingBox(claimed.value, claimed.lower, claimed.upper)
    wide = _blended(row, problem, box, durations, ends, as_printed=False)
    plain = _blended(row, problem, box, durations, ends, as_printed=True)
    loose = row.posed(Digits.LOOSEST_CUT).limits.sides.max(axis=0)
    most = loose[:, :2] * (1.0 + _SLACK)
    breaks = (
        bool((wide.velocity.size.low > most[:, 0]).any())
        or bool((wide.acceleration.low > most[:, 1]).any())
        or bool((wide.room.high < -_SLACK * durations.value[:, None]).any())
    )
    try:
        tight = row.posed(Digits.TIGHTEST).limits.sides.min(axis=0)
        keeps = (
            bool((wide.velocity.size.high <= tight[:, 0]).all())
            and bool((wide.acceleration.high <= tight[:, 1]).all())
            and bool((wide.room.low >= 0).all())
        )
    except CaseError:  # the tightest ranges are empty
        keeps = False
    return _Found(breaks, keeps, _worst(row, problem, plain))


def _blended(
    row: PrintedRow[DurationsClaim],
    problem: Problem,
    waypoints: RoundingBox,
    durations: RoundingBox,
    ends: EndBlends,
    as_printed: bool,
) -> Blended:
    """What the motion asks for at the printed numbers, or for all rounded or cut off to them."""
    claim = row.claim
    waypoints, durations = (_taken(box, as_printed) for box in (waypoints, durations))
    if claim.blends is not None:
        numbers = _each(claim.blends, len(durations.value) + 1)
        times = [row.time(n) for n in numbers]
        return by_blend_times(waypoints, durations, _taken(_box(times), as_printed), ends)
    assert claim.blend_acceleration is not None
    labels = row.study.case.robot.joints
    given = dict(zip(labels, _each(claim.blend_acceleration, len(labels)), strict=True))
    sizes = [row.measured(given[label], "acceleration", label) for label in problem.joints]
    return by_blend_accelerations(waypoints, durations, _taken(_box(sizes), as_printed), ends)


def _each(given: Printed | tuple[Printed, ...], count: int) -> tuple[Printed, ...]:
    return given if isinstance(given, tuple) else (given,) * count


def _box(measured: Sequence[Measured]) -> RoundingBox:
    ends: list[Array] = [
        np.array([getattr(m, end) for m in measured]) for end in ("value", "lower", "upper")
    ]
    return RoundingBox(*ends)


def _taken(box: RoundingBox, as_printed: bool) -> RoundingBox:
    return RoundingBox.exact(box.value) if as_printed else box.or_cut_off()


def _worst(row: PrintedRow[Claim], problem: Problem, plain: Blended) -> str:
    """The largest ratio to a limit at the printed numbers, in words; or that blends overlap."""
    k, j = np.unravel_index(int(np.argmin(plain.room.low)), plain.room.low.shape)
    if plain.room.low[k, j] < 0:
        return f"the blends need more time than segment {k + 1} has"
    best: tuple[float, str] = (0.0, "no limit applies")
    sizes = (("velocity", plain.velocity.size.high), ("acceleration", plain.acceleration.high))
    limits = problem.limits.sides.min(axis=0)
    for order, (quantity, size) in enumerate(sizes):
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(size > 0, size / limits[:, order], 0.0)
        at = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
        if ratio[at] > best[0]:
            joint = problem.joints[at[1]]
            if np.isinf(size[at]):
                return f"the speed of joint {joint} jumps, for a blend printed as 0"
            unit = row.unit(quantity, joint)
            value = row.in_units(quantity, float(size[at]), joint)
            limit = row.in_units(quantity, float(limits[at[1], order]), joint)
            best = (
                float(ratio[at]),
                f"the {quantity} of joint {joint} reaches {value:.6g} {unit}, "
                f"limit {limit:.6g} {unit}",
            )
    return best[1]
