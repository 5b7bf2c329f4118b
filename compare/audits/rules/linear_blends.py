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

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeGuard

import numpy as np

from ....problem import Array, CaseError, Measured, Printed, Problem
from ....problem.cases import AnyClaim, Claim, Digits, DurationsClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..own_result import UNSAID, meant_to_keep, said_of
from ..printed_row import PrintedRow
from ..rounding import ROUNDING, RoundingBox
from ..study import Study
from .rule_group import Explained, rule_group

BLENDS = "blends"
"""Root of what follows from a row that breaks a limit."""


_NO_SPEED = 1e300
"""Stands for the speed where none is high enough: no limit allows it, and sums of two stay
numbers."""


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
        "digits were rounded and wherever the end blends lie. Such a motion is not compared with "
        "an optimum, because it does not pass its via-points.",
        "Durations of 2, 1 and 3 s and blends of 0.4 s turn joint 1 from 12.5 to -10 °/s at the "
        "first via-point, which takes 56 °/s². The limit is 50 °/s².",
    )
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
    verdict, severity = said_of(study.case, claim, verdict, severity)
    return row.finding(
        "TG210",
        str(found_verdict),
        message,
        at_print,
        passes,
        UNSAID if verdict is not found_verdict else "",
        severity=severity,
        verdict=verdict,
        basis=Basis.ENCLOSURE,
        printed=study.durations_digits(claim),
        computed=computed,
        decides=meant_to_keep(study.case, claim),
        root=f"{BLENDS} {claim.id}" if verdict is ClaimVerdict.REFUTED else "",
    )


def _judged(row: PrintedRow[DurationsClaim], problem: Problem, ends: EndBlends) -> _Found:
    box = row.waypoint_box(problem)
    claimed = row.durations
    durations = RoundingBox(claimed.value, claimed.lower, claimed.upper)
    wide = _blended(row, problem, box, durations, ends, as_printed=False)
    plain = _blended(row, problem, box, durations, ends, as_printed=True)
    loose = row.posed(Digits.LOOSEST_CUT).limits.sides.max(axis=0)
    most = loose[:, :2] * (1.0 + ROUNDING)
    breaks = (
        bool((wide.velocity.size.low > most[:, 0]).any())
        or bool((wide.acceleration.low > most[:, 1]).any())
        or bool((wide.room.high < -ROUNDING * durations.value[:, None]).any())
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
        found = _taken(_box(times), as_printed)
        return blended_motion(waypoints, durations, ends, times=found)
    assert claim.blend_acceleration is not None
    labels = row.study.case.robot.joints
    given = dict(zip(labels, _each(claim.blend_acceleration, len(labels)), strict=True))
    sizes = [row.measured(given[label], "acceleration", label) for label in problem.joints]
    found = _taken(_box(sizes), as_printed)
    return blended_motion(waypoints, durations, ends, accelerations=found)


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

    def times(self, factor: float) -> Between:
        """Bounds of a multiple, the factor not negative."""
        return Between(factor * self.low, factor * self.high)

    def over(self, divisor: Between) -> Between:
        """Bounds of all quotients by numbers that are positive; none are known where some is not.

        A divisor that may be 0 or less leaves infinite bounds; what is 0 stays 0.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack(np.broadcast_arrays(
                self.low / divisor.low, self.low / divisor.high,
                self.high / divisor.low, self.high / divisor.high,
            ))  # fmt: skip
        sure = np.broadcast_to(divisor.low > 0, ends.shape[1:])
        low = np.where(sure, ends.min(axis=0), -np.inf)
        high = np.where(sure, ends.max(axis=0), np.inf)
        nothing = np.broadcast_to((self.low == 0) & (self.high == 0), ends.shape[1:])
        return Between(np.where(nothing, 0.0, low), np.where(nothing, 0.0, high))

    @property
    def size(self) -> Between:
        """Bounds of the absolute values."""
        through = (self.low <= 0) & (self.high >= 0)
        ends = np.abs(np.stack([self.low, self.high]))
        return Between(np.where(through, 0.0, ends.min(axis=0)), ends.max(axis=0))

    def __getitem__(self, key: int | slice) -> Between:
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
    q, h = _ranges(waypoints), _ranges(durations)
    step, n = q[1:] - q[:-1], len(durations.value)
    within = ends is EndBlends.WITHIN
    # Shares of the blends on both sides that a segment holds; half of each is a turn of speed.
    shares = [(1.0 if within and k == 0 else 0.5, 1.0 if within and k == n - 1 else 0.5)
              for k in range(n)]  # fmt: skip
    if times is not None:
        tau = _ranges(times)
        speeds = [
            step[k].over(h[k] - tau[k].times(first - 0.5) - tau[k + 1].times(last - 0.5))
            for k, (first, last) in enumerate(shares)
        ]
        changes = _changes(speeds)
        blends = [tau[k] for k in range(n + 1)]
        sizes = [change.over(blend) for change, blend in zip(changes, blends, strict=True)]
    else:
        assert accelerations is not None
        a = _ranges(accelerations)
        speeds = [
            _with_blend(step[k], h[k], a, both=n == 1)
            if within and k in (0, n - 1)
            else step[k].over(h[k])
            for k in range(n)
        ]
        changes = _changes(speeds)
        blends = [change.over(a) for change in changes]
        # Where the speed of a joint does not change, there is no acceleration.
        sizes = [
            Between(np.where(change.low > 0, a.low, 0.0), np.where(change.high > 0, a.high, 0.0))
            for change in changes
        ]
    rooms = [
        h[k] - blends[k].times(first) - blends[k + 1].times(last)
        for k, (first, last) in enumerate(shares)
    ]
    shape = step.low.shape[1:]
    wide = [Between(*(np.broadcast_to(end, shape) for end in (r.low, r.high))) for r in rooms]
    return Blended(_stacked(speeds), _stacked(sizes), _stacked(wide))


def _stacked(parts: Sequence[Between]) -> Between:
    return Between(np.stack([p.low for p in parts]), np.stack([p.high for p in parts]))


def _ranges(box: RoundingBox) -> Between:
    return Between(box.lower, box.upper)


def _changes(speeds: Sequence[Between]) -> list[Between]:
    """Sizes of the changes of speed at each way-point, from rest and to rest."""
    inner = [after - before for before, after in itertools.pairwise(speeds)]
    return [change.size for change in (speeds[0], *inner, speeds[-1])]


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
            c = 4.0 if both else 2.0
            root = np.sqrt(length**2 - c * ways / size)
            found = size * (length - root) * (0.5 if both else 1.0)
        return np.where(ways > 0, found, 0.0)

    least = speed(way.low, h.high, a.high)
    most = speed(way.high, h.low, a.low)
    # No root: no motion with these numbers, whatever its speed.
    size = Between(
        np.where(np.isnan(least), _NO_SPEED, least), np.where(np.isnan(most), _NO_SPEED, most)
    )
    forward, backward = step.low > 0, step.high < 0
    return Between(
        np.where(forward, size.low, -size.high), np.where(backward, -size.low, size.high)
    )
