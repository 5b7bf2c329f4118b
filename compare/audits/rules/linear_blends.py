"""TG210: printed durations of linear segments with parabolic blends beside the limits.

A joint moves at constant speed along each segment; around each way-point its speed changes at
constant acceleration, so it passes via-points at a distance (Craig, *Introduction to
Robotics*, section 7.3). With steps Δ_k, durations h_k and blends τ_k around way-point k:

    v_k = Δ_k / h_k,    a_k = (v_{k+1} − v_k) / τ_k,    τ_{k−1}/2 + τ_k/2 ≤ h_k

At the ends two conventions are in use. Either the blends reach half beyond the first and the last
duration, and this is all; or they lie within them, and v_1 = Δ_1 / (h_1 − τ_0/2), likewise at the
finish, where the whole blend takes its part of the segment.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeGuard

import numpy as np

from ....problem import Array, CaseError, Printed, Problem
from ....problem.cases import AnyClaim, Claim, Digits, DurationsClaim, RoundingBox
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..own_result import UNSAID, meant_to_keep, said_of
from ..printed_row import PrintedRow
from ..rounding import ROUNDING
from ..study import Study
from .rule_group import Explained, rule_group

BLENDS = "blends"
"""Root of what follows from a row that breaks a limit."""


@dataclass(frozen=True)
class _Found:
    """What one convention says: broken for all digits, kept for all, and what is worst at print."""

    breaks: bool
    keeps: bool
    worst: str


TG210 = Explained(
    "TG210",
    "Linear segments with parabolic blends keep the limits",
    "Do linear segments with parabolic blends keep the limits with the printed durations and "
    "blends?",
    "Refuted if a speed or an acceleration exceeds its limit, or blends overlap, however the "
    "digits were rounded and wherever the end blends lie. Such a motion is not compared with "
    "an optimum, because it does not pass its via-points.",
    "Durations of 2, 1 and 3 s and blends of 0.4 s turn joint 1 from 12.5 to -10 °/s at the "
    "first via-point, which takes 56 °/s². The limit is 50 °/s².",
    basis=Basis.ENCLOSURE,
)


@rule_group(TG210)
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
    meant = ClaimVerdict.NOT_CHECKABLE
    computed, at_print, passes = "", "", ""
    if len(claim.durations) != segments:
        message = (
            f"{len(claim.durations)} durations are printed, but {segments} straight segments join "
            "the way-points, so no motion can be built from them."
        )
    else:
        asked = [EndBlends(claim.end_blends)] if claim.end_blends else [*EndBlends]
        found = [_judged(row, problem, ends) for ends in asked]
        worst = list(dict.fromkeys(one.worst for one in found))
        computed = "; ".join(worst)
        at_print = f"At the printed numbers {worst[0]}."
        passes = (
            "Such a motion misses its via-points, so it is not compared with the optimum of a "
            "curve through them. Its acceleration jumps, so its jerk is not judged."
        )
        if len(worst) > 1:
            at_print = (
                f"At the printed numbers, with end blends that reach beyond the durations, "
                f"{worst[0]}; with end blends within them, {worst[1]}."
            )
        wherever = "" if claim.end_blends else ", wherever the end blends lie"
        if all(one.breaks for one in found):
            meant = ClaimVerdict.REFUTED
            message = (
                "Linear segments with parabolic blends break a limit with these durations"
                f"{wherever}, however the digits were rounded or cut off."
            )
        elif all(one.keeps for one in found):
            meant = ClaimVerdict.SUPPORTED
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
    verdict, _ = said_of(study.case, claim, meant, Severity.INFO)
    return TG210.finding(
        row,
        str(meant),
        message,
        at_print,
        passes,
        UNSAID if verdict is not meant else "",
        verdict=verdict,
        printed=study.durations_digits(claim),
        computed=computed,
        decides=meant_to_keep(study.case, claim),
        root=f"{BLENDS} {claim.id}" if verdict is ClaimVerdict.REFUTED else "",
    )


def _judged(row: PrintedRow[DurationsClaim], problem: Problem, ends: EndBlends) -> _Found:
    wide = _blended(row, problem, ends, as_printed=False)
    plain = _blended(row, problem, ends, as_printed=True)
    most = row.posed(Digits.LOOSEST_CUT).limits.sides.max(axis=0) * (1.0 + ROUNDING)
    breaks = (
        (wide.velocity.size.low > most[:, 0]).any()
        or (wide.acceleration.low > most[:, 1]).any()
        or (wide.room.high < -ROUNDING * row.durations.value[:, None]).any()
    )
    keeps = False
    with suppress(CaseError):  # the tightest ranges may be empty
        tight = row.posed(Digits.TIGHTEST).limits.sides.min(axis=0)
        keeps = bool(
            (wide.velocity.size.high <= tight[:, 0]).all()
            and (wide.acceleration.high <= tight[:, 1]).all()
            and (wide.room.low >= 0).all()
        )
    return _Found(bool(breaks), keeps, _worst(row, problem, plain))


def _blended(
    row: PrintedRow[DurationsClaim], problem: Problem, ends: EndBlends, as_printed: bool
) -> Blended:
    """What the motion asks for at the printed numbers, or for all rounded or cut off to them."""
    claim, labels = row.claim, row.study.case.robot.joints
    durations, waypoints = row.boxes
    if claim.blends is not None:
        printed = RoundingBox.of(map(row.time, _each(claim.blends, len(waypoints.value))))
    else:
        assert claim.blend_acceleration is not None
        given = dict(zip(labels, _each(claim.blend_acceleration, len(labels)), strict=True))
        printed = RoundingBox.of(
            row.measured(given[label], "acceleration", label) for label in problem.joints
        )
    q, h, blends = (
        RoundingBox.exact(box.value) if as_printed else box.or_cut_off()
        for box in (waypoints, durations, printed)
    )
    if claim.blends is not None:
        return blended_motion(q, h, ends, times=blends)
    return blended_motion(q, h, ends, accelerations=blends)


def _each(given: Printed | tuple[Printed, ...], count: int) -> tuple[Printed, ...]:
    return given if isinstance(given, tuple) else (given,) * count


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
            value = row.shown(quantity, float(size[at]), joint)
            limit = row.shown(quantity, float(limits[at[1], order]), joint)
            best = (
                float(ratio[at]),
                f"the {quantity} of joint {joint} reaches {value}, limit {limit}",
            )
    return best[1]


# --- what the motion asks for ---------------------------------------------------------------------


class EndBlends(StrEnum):
    """Where the first and the last blend lie."""

    BEYOND = "beyond"
    """Half of each before the first duration begins, and after the last one has ended."""
    WITHIN = "within"
    """Within the first and the last duration."""


@dataclass(frozen=True, eq=False)
class Between:
    """Bounds of numbers, in arrays of one shape; not rounded outwards."""

    low: Array
    high: Array

    def __sub__(self, other: Between) -> Between:
        """Bounds of all differences, as if the numbers were independent."""
        return Between(self.low - other.high, self.high - other.low)

    def times(self, factor: Array) -> Between:
        """Bounds of multiples, the factors not negative."""
        return Between(factor * self.low, factor * self.high)

    def over(self, divisor: Between) -> Between:
        """Bounds of all quotients by numbers that are positive; none are known where some is not.

        A divisor that may be 0 or less leaves infinite bounds; what is 0 stays 0.
        """
        pairs = [(x, y) for x in (self.low, self.high) for y in (divisor.low, divisor.high)]
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.stack([x / y for x, y in pairs])
        nothing, sure = (self.low == 0) & (self.high == 0), divisor.low > 0
        low = np.where(sure, found.min(axis=0), -np.inf)
        high = np.where(sure, found.max(axis=0), np.inf)
        return Between(np.where(nothing, 0.0, low), np.where(nothing, 0.0, high))

    @property
    def size(self) -> Between:
        """Bounds of the absolute values."""
        through = (self.low <= 0) & (self.high >= 0)
        ends = np.abs(np.stack([self.low, self.high]))
        return Between(np.where(through, 0.0, ends.min(axis=0)), ends.max(axis=0))

    def __getitem__(self, key: Any) -> Between:
        """Bounds of some of the numbers."""
        return Between(self.low[key], self.high[key])


@dataclass(frozen=True, eq=False)
class Blended:
    """What a motion of linear segments with parabolic blends asks for.

    Attributes
    ----------
    velocity : Between, shape (segments, joints)
        Speeds along the segments, rad/s.
    acceleration : Between, shape (way-points, joints)
        Sizes within the blends, rad/s².
    room : Between, shape (segments, joints)
        What the blends leave of each segment, s; no such motion exists where it is negative.
    """

    velocity: Between
    acceleration: Between
    room: Between


def blended_motion(
    waypoints: RoundingBox,
    durations: RoundingBox,
    ends: EndBlends,
    *,
    times: RoundingBox | None = None,
    accelerations: RoundingBox | None = None,
) -> Blended:
    """Bounds on what printed durations ask for, over all values in the boxes.

    Either the durations of the blends are printed, or the acceleration within them: then a blend
    takes what its change of speed needs. Within the first duration that is the shorter solution τ
    of a τ (h − τ/2) = |Δ|, and of a τ (h − τ) = |Δ| where there is one segment only.

    Parameters
    ----------
    waypoints : RoundingBox, shape (way-points, joints)
        rad.
    durations : RoundingBox, shape (segments,)
        s.
    times : RoundingBox, shape (way-points,), optional
        s.
    accelerations : RoundingBox, shape (joints,), optional
        rad/s², sizes; those of joints that move are positive.
    """
    q, h, n = _ranges(waypoints), _ranges(durations)[:, None], len(durations.value)
    step = q[1:] - q[:-1]
    # Shares of the blends on both sides that a segment holds; half of each is a turn of speed.
    first, last = np.full((n, 1), 0.5), np.full((n, 1), 0.5)
    if ends is EndBlends.WITHIN:
        first[0] = last[-1] = 1.0
    if times is not None:
        tau = _ranges(times)[:, None]
        speeds = step.over(h - tau[:-1].times(first - 0.5) - tau[1:].times(last - 0.5))
        changes = _changes(speeds)
        blends, sizes = tau, changes.over(tau)
    else:
        assert accelerations is not None
        a = _ranges(accelerations)
        at_end, free = _with_blend(step, h, a, both=n == 1), step.over(h)
        ending = (first > 0.5) | (last > 0.5)
        speeds = Between(
            np.where(ending, at_end.low, free.low), np.where(ending, at_end.high, free.high)
        )
        changes = _changes(speeds)
        # Where the speed of a joint does not change, there is no acceleration.
        least, most = np.where(changes.low > 0, a.low, 0.0), np.where(changes.high > 0, a.high, 0.0)
        blends, sizes = changes.over(a), Between(least, most)
    room = h - blends[:-1].times(first) - blends[1:].times(last)
    low, high = (np.broadcast_to(end, step.low.shape) for end in (room.low, room.high))
    return Blended(speeds, sizes, Between(low, high))


def _ranges(box: RoundingBox) -> Between:
    return Between(box.lower, box.upper)


def _changes(speeds: Between) -> Between:
    """Sizes of the changes of speed at each way-point, from rest and to rest."""
    low, high = (np.pad(end, ((1, 1), (0, 0))) for end in (speeds.low, speeds.high))
    return (Between(low[1:], high[1:]) - Between(low[:-1], high[:-1])).size


def _with_blend(step: Between, h: Between, a: Between, both: bool) -> Between:
    """Speed along an end segment whose blend, or both, lie within its duration.

    With r = √(h² − c|Δ|/a), c = 2 or 4, the blend takes h − r, or half of that, and the speed is a
    times it: more for a longer way, and less for a longer duration or a larger acceleration, since
    the speed is |Δ| over what remains of the duration. Where no speed is high enough, none is
    known.
    """
    way = step.size

    def speed(ways: Array, length: Array, size: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(length**2 - (4.0 if both else 2.0) * ways / size)
            found = size * (length - root) * (0.5 if both else 1.0)
        # No root: no motion with these numbers, whatever its speed. No limit allows 1e300, and
        # sums of two stay numbers.
        return np.where(ways > 0, np.nan_to_num(found, nan=1e300, posinf=np.inf), 0.0)

    low, high = speed(way.low, h.high, a.high), speed(way.high, h.low, a.low)
    forward, backward = step.low > 0, step.high < 0
    return Between(np.where(forward, low, -high), np.where(backward, -low, high))
