"""TG203: printed peaks beside the exact peaks of the motion that they describe."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import TypeVar

import numpy as np

from ....problem import (
    QUANTITIES,
    Array,
    Extremum,
    Printed,
    extrema,
    fit,
    peak_gradients,
)
from ....problem.cases import AnyClaim, MotionValueClaim, PeakClaim, motions_of, profile_of
from ...documents import Basis, ClaimVerdict, Finding
from ..rounding import RoundingBox
from ..study import Study
from .corners import Look, largest_change
from .loose_curves import FITTING, misfit
from .norms import largest_norm
from .unit_factors import meant_by_ratio
from .wording import UNEXPLAINED, called, in_units, unit_shown

_Value = TypeVar("_Value", bound=MotionValueClaim)
_SAMPLES = 50
"""Samples of a motion at the coarsest: fewer would show corners in a printed figure."""
_PHASES = 8
"""Offsets at which those samples are tried: the worst of so many comes near the worst of all."""
_ROOTS = (2, 3, 5)
"""Numbers whose square roots closed forms of peaks hold, such as 10/√3 of degree 5 and 84√5/25 of
degree 7: one that is lost in print is named as an explanation."""
_WIDE = 0.05
"""Share of a peak above which the room that digits leave is said: what then fits tells little."""
_NO_MOTION = "No durations are printed whose motion could have this peak."
"""Said of a peak where nothing defines a motion."""


class Class(StrEnum):
    """How a printed peak lies beside the exact one."""

    ROUNDING = "rounding"
    CUT_OFF = "cut off"
    SAMPLING = "sampling"
    NORM = "norm over the joints"
    UNIT = "other unit"
    ROOT = "root left out"
    OFF = "off"


FITS = (Class.ROUNDING, Class.CUT_OFF, Class.SAMPLING, Class.NORM)
"""The classes that accuse of nothing."""


@dataclass(frozen=True, eq=False)
class Beside:
    """A printed peak beside the exact one of a motion.

    Attributes
    ----------
    printed : Printed
    lower, upper, cut_lower, cut_upper : float
        What the digits stand for, rounded or cut off, in the SI unit.
    exact : float
        The exact peak, at the printed durations and way-points.
    reach : float
        Its change over all values that round to the printed digits: of first order, and where that
        does not reach the printed peak the largest that is found, if it is larger.
    far : float
        The same over values that are cut off to the printed digits, which lie up to a whole last
        place away.
    sampled : float
        The least peak that coarse sampling of that motion finds.
    norm : Beside, optional
        The same beside the largest norm over the joints, where one number speaks of several.
    linear : bool
        Whether it is that of a joint that slides.
    """

    printed: Printed
    value: float
    lower: float
    upper: float
    cut_lower: float
    cut_upper: float
    exact: float
    reach: float
    far: float
    sampled: float
    norm: Beside | None = None
    linear: bool = False

    @property
    def met(self) -> bool:
        """Whether the exact peak rounds to the printed digits, the other numbers as printed."""
        return self.lower <= self.exact <= self.upper

    @property
    def distance(self) -> float:
        """Relative distance of the printed peak from the exact one."""
        if self.exact == 0.0:
            return 0.0 if self.value == 0.0 else np.inf
        return (self.value - self.exact) / self.exact

    @cached_property
    def kind(self) -> Class:
        """How the two lie beside each other, the most charitable first."""
        low, high = self.exact - self.reach, self.exact + self.reach
        if self.lower <= high and low <= self.upper:
            return Class.ROUNDING
        low, high = self.exact - self.far, self.exact + self.far
        widest = max(self.upper, self.cut_upper)
        if min(self.lower, self.cut_lower) <= high and low <= widest:
            return Class.CUT_OFF
        if self.sampled - self.far <= widest and self.value < self.exact:
            return Class.SAMPLING
        if self.norm is not None and self.norm.kind in FITS:
            return Class.NORM
        if self.root is not None:
            return Class.ROOT
        return Class.OFF if self.factor is None else Class.UNIT

    @property
    def root(self) -> int | None:
        """Whose square root a printed peak lacks, if with it the two agree within rounding."""
        low, high = self.exact - self.reach, self.exact + self.reach
        fitting = (n for n in _ROOTS if n**0.5 * self.lower <= high and low <= n**0.5 * self.upper)
        return next(fitting, None)

    @property
    def factor(self) -> str | None:
        """What a ratio near that of two units would mean, if it is near one."""
        if not (self.exact > 0 and self.value > 0):
            return None
        return meant_by_ratio(self.value / self.exact, self.linear)


def box_reach(study: Study, claim: AnyClaim, pid: str, rid: str, point: Extremum) -> float:
    """First-order change of an extremum over the rounding box."""
    problem = study.claim_problem(claim, pid, rid)
    durations, waypoints = study.claim_boxes(claim, pid, rid)
    g = peak_gradients(problem, durations.value, [point])
    by_time = np.abs(g.durations[0]) @ (durations.upper - durations.lower) / 2
    half = (waypoints.upper - waypoints.lower)[:, point.joint] / 2
    return float(by_time + np.abs(g.waypoints[0]) @ half)


def farthest(
    study: Study, claim: AnyClaim, pid: str, rid: str, top: Extremum, alone: bool, share: float
) -> float:
    """Largest change of a peak that is found in the rounding box.

    Parameters
    ----------
    study : Study
    claim : AnyClaim
        A claim of durations.
    pid, rid : str
        Problem and reading.
    top : Extremum
        The peak at the printed numbers.
    alone : bool
        Whether it is that of its own joint, and not of all.
    share : float
        How wide the box is: 1 for rounded digits, 2 for digits that may be cut off.

    Returns
    -------
    float
        In the SI unit of the peak.
    """
    problem = study.claim_problem(claim, pid, rid)
    joints = [top.joint] if alone else range(len(problem.joints))

    def look(h: RoundingBox, q: RoundingBox) -> Look:
        moved = fit(problem.curve, q.value, h.value)
        ends = (e for j in joints for e in extrema(moved, j, top.order))
        here = max(ends, key=lambda e: abs(e.value))
        g = peak_gradients(replace(problem, waypoints=q.value), h.value, [here])
        by_angle = np.zeros_like(q.value)
        by_angle[:, here.joint] = g.waypoints[0]
        slopes = np.sign(here.value) * np.append(g.durations[0], by_angle)
        down, up = (
            slopes * np.append(getattr(h, end) - h.value, getattr(q, end) - q.value)
            for end in ("lower", "upper")
        )
        return Look(abs(here.value), down, up)

    return largest_change(*study.claim_boxes(claim, pid, rid), share, look)


def largest(study: Study, claim: AnyClaim, pid: str, rid: str, order: int) -> list[Extremum]:
    """Largest extremum of each joint of the claim's problem, at the printed point."""

    def compute() -> list[Extremum]:
        problem = study.claim_problem(claim, pid, rid)
        durations = study.case.claim_durations(claim, rid).value
        trajectory = fit(problem.curve, problem.waypoints, durations)
        return [
            max(extrema(trajectory, j, order), key=lambda e: abs(e.value))
            for j in range(len(problem.joints))
        ]

    return study.once(("largest", claim.id, pid, rid, order), compute)


def has_curve(study: Study, claim: AnyClaim, pid: str, rid: str) -> bool:
    """Whether the printed durations define a curve under a reading."""
    worst = study.claim_check(claim, pid, rid).worst
    return worst is None or worst.quantity != "curve"


def beside(
    study: Study,
    claim: PeakClaim,
    printed: Printed,
    motion: AnyClaim,
    joint: str | None,
    pid: str,
    rid: str,
) -> Beside | None:
    """A printed peak set beside the exact one of a motion.

    Parameters
    ----------
    study : Study
    claim : PeakClaim
        Says which derivative.
    printed : Printed
        One of its numbers.
    motion : AnyClaim
        A claim of durations.
    joint : str or None
        Label of the joint; the largest over all joints if None.
    pid, rid : str
        Problem and reading.

    Returns
    -------
    Beside or None
        None where the joint is not in that motion, or it has no curve.
    """
    if not has_curve(study, motion, pid, rid):
        return None
    problem = study.claim_problem(motion, pid, rid)
    if joint is not None and joint not in problem.joints:
        return None
    order = QUANTITIES.index(claim.derivative) + 1
    tops = largest(study, motion, pid, rid, order)
    if joint is not None:
        tops = [tops[problem.joints.index(joint)]]
    top = max(tops, key=lambda e: abs(e.value))
    measured = study.case.measured(printed, claim.derivative, pid, rid, joint)
    cut = measured.cut_off()
    samples = _samples(study, motion, pid, rid, order)
    reach = box_reach(study, motion, pid, rid, top)
    found = Beside(
        printed,
        measured.value,
        measured.lower,
        measured.upper,
        cut.lower,
        cut.upper,
        abs(top.value),
        reach,
        2 * reach,
        min(float((v if joint is None else v[:, top.joint]).max()) for v in samples),
        linear=problem.linear[top.joint],
    )
    if found.kind not in FITS:
        near, far = (
            farthest(study, motion, pid, rid, top, joint is not None, share) for share in (1.0, 2.0)
        )
        found = replace(found, reach=max(reach, near), far=max(2 * reach, far))
    if joint is not None or len(tops) == 1 or found.kind in FITS:
        return found
    whole = largest_norm(study, motion, pid, rid, order)
    sampled = min(float(np.linalg.norm(v, axis=1).max()) for v in samples)
    norm = replace(
        found, exact=whole.largest, reach=whole.reach, far=2 * whole.reach, sampled=sampled
    )
    return replace(found, norm=norm)


def _samples(study: Study, motion: AnyClaim, pid: str, rid: str, order: int) -> list[Array]:
    """Absolute values at evenly spaced times, for each offset that these may have."""

    def compute() -> list[Array]:
        problem = study.claim_problem(motion, pid, rid)
        durations = study.case.claim_durations(motion, rid).value
        trajectory = fit(problem.curve, problem.waypoints, durations)
        step = float(durations.sum()) / _SAMPLES
        offsets = np.arange(_PHASES)[:, None] / _PHASES
        times = (np.arange(_SAMPLES) + offsets) * step
        found = np.abs(trajectory(times.ravel(), order))
        return list(found.reshape(_PHASES, _SAMPLES, -1))

    return study.once(("samples", motion.id, pid, rid, order), compute)


def peak_numbers(study: Study, claim: MotionValueClaim) -> list[tuple[str | None, Printed]]:
    """Each printed number of a claim of a derivative with the joint that it belongs to."""
    if claim.values is None:
        return [(claim.joint, number) for number in claim.printed]
    return list(zip(study.case.robot.joints, claim.values, strict=True))


def each_motion(
    study: Study,
    kind: type[_Value],
    judge: Callable[[Study, _Value, AnyClaim], Iterator[Finding]],
    rule: str,
    without: str,
) -> Iterator[Finding]:
    """Findings on each claim of a kind beside each motion that it may describe.

    ``without`` is said of a claim where nothing printed defines such a motion.
    """
    for claim in study.claims:
        # TG304 judges numbers of a profile.
        if isinstance(claim, kind) and profile_of(study.case.claims, claim) is None:
            meant = motions_of(study.case.claims, claim)
            for motion in meant:
                yield from judge(study, claim, motion)
            if not meant:
                yield Finding(
                    rule=rule,
                    basis=Basis.TEXT,
                    claim=claim.id,
                    kind="no motion",
                    sentences=(without,),
                )


def judge_peaks(study: Study) -> Iterator[Finding]:
    """Findings of TG203."""
    return each_motion(study, PeakClaim, _peaks, "TG203", _NO_MOTION)


def _peaks(study: Study, claim: PeakClaim, motion: AnyClaim) -> Iterator[Finding]:
    for pid, rid in study.claim_pairs(motion):
        if claim.problem not in (None, pid):
            continue
        taking_part = study.claim_problem(motion, pid, rid).joints
        found = [
            (joint, one)
            for joint, number in peak_numbers(study, claim)
            if joint is None or joint in taking_part
            for one in (beside(study, claim, number, motion, joint, pid, rid),)
            if one is not None
        ]
        if not found:
            continue
        wrong = [(joint, one) for joint, one in found if one.kind not in FITS]
        said = [described(study, claim, joint, one, pid, rid) for joint, one in (wrong or found)]
        verdict, note = misfit(study, pid, rid) if wrong else FITTING
        yield Finding(
            rule="TG203",
            verdict=verdict,
            basis=Basis.CHECK if all(one.met for _, one in found) else Basis.COMPUTED,
            claim=claim.id,
            problem=pid,
            reading=rid,
            printed=", ".join(map(str, claim.printed)),
            computed="; ".join(_exact(study, claim, joint, one, pid, rid) for joint, one in found),
            kind=", ".join(one.kind for _, one in (wrong or found)),
            sentences=(f"Of the printed durations ({called(motion)}): {'; '.join(said)}.", note),
            root=f"peaks of {motion.id}" if verdict is ClaimVerdict.INCONSISTENT else "",
            between=(claim.id, motion.id) if verdict is ClaimVerdict.INCONSISTENT else (),
        )


def _exact(
    study: Study, claim: PeakClaim, joint: str | None, one: Beside, pid: str, rid: str
) -> str:
    quantity = claim.derivative
    value, reach = (in_units(study, pid, rid, quantity, x, joint) for x in (one.exact, one.reach))
    return f"{value:.6g} ± {reach:.1g} {unit_shown(study, pid, rid, quantity, joint)}"


def described(
    study: Study, claim: PeakClaim, joint: str | None, one: Beside, pid: str, rid: str
) -> str:
    """One printed peak beside the exact one, with the class of their distance."""
    whose = "" if joint is None else f"joint {joint}: "
    exact = _exact(study, claim, joint, one, pid, rid)
    said = f"{whose}the exact peak of {claim.derivative} is {exact}, printed is {one.printed}"
    room = ""
    if one.exact and one.reach > _WIDE * one.exact:
        room = f", which leaves {100 * one.reach / one.exact:.2g} % either way"
    norm = "" if one.norm is None else _of_norm(study, claim, one.norm, pid, rid)
    away = f"{100 * one.distance:+.2g} %"
    return (
        said
        + {
            Class.ROUNDING: f", equal within the rounding of the printed digits{room}",
            Class.CUT_OFF: f" ({away}), as digits that are cut off instead of rounded give it",
            Class.SAMPLING: f" ({away}), slightly below it, as sampling the motion gives it",
            Class.NORM: f" ({away}), {norm}",
            Class.UNIT: f" ({away}); their ratio is near {one.factor}",
            Class.ROOT: f" ({away}); a factor √{one.root} may have been lost in print",
            Class.OFF: f" ({away}), {UNEXPLAINED}",
        }[one.kind]
    )


def _of_norm(study: Study, claim: PeakClaim, one: Beside, pid: str, rid: str) -> str:
    """How a printed peak that is not that of a joint is the norm over the joints."""
    norm = f"the largest norm over the joints, {_exact(study, claim, None, one, pid, rid)}"
    return {
        Class.CUT_OFF: f"as {norm}, cut off instead of rounded gives it",
        Class.SAMPLING: f"slightly below {norm}, as sampling the motion gives it",
    }.get(one.kind, f"equal to {norm}, within rounding")
