"""A printed number of a motion beside what the motion gives, and beside what digits leave open."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np

from ....problem import Array, Printed, TrajgapError
from ....problem.cases import (
    AnyClaim,
    Claim,
    MeasureClaim,
    MotionValueClaim,
    PeakClaim,
    ValueClaim,
    motions_of,
)
from ...documents import Basis, ClaimVerdict, Finding
from ..rounding import RoundingBox
from ..row import Row, rows
from ..study import Study
from .corners import Look, largest_change
from .loose_curves import FITTING, misfit
from .printed_digits import hull
from .unit_factors import meant_by_ratio
from .wording import UNEXPLAINED, called, unit_shown

Meant = Callable[[Array, Array], dict[str, float]]
"""From way-points and durations to what a number may be, each in words."""
SAMPLES = (50, 100, 200, 500, 1000)
"""Numbers of samples of which a paper may have taken a mean, with or without the last instant."""
POWERS = {"mean": (1, 0), "rms": (1, 0), "integral": (1, 1), "integral-square": (2, 1)}
"""Powers of the derivative's unit and of time in each measure."""


_ROOTS = (2, 3, 5)
"""Numbers whose square roots closed forms of peaks hold, such as 10/√3 of degree 5 and 84√5/25 of
degree 7: one that is lost in print is named as an explanation."""
_Value = TypeVar("_Value", PeakClaim, MeasureClaim, ValueClaim)


class Class(StrEnum):
    """How a printed number lies beside that of the motion."""

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
    """A printed number beside one of the motion, all in the unit of the paper.

    Attributes
    ----------
    printed : Printed
    rounded, wide : tuple of float
        Ends of what the digits stand for, if they were rounded, and if they may be cut off.
    exact : float
        The motion's number, at the printed durations and way-points.
    reach : float
        Its change over all values that round to the printed digits: of first order, and where that
        does not reach the printed number the largest that is found, if it is larger.
    far : float
        The same over values that are cut off to the printed digits, which lie up to a whole last
        place away.
    sampled : tuple of float
        The least and the most that samples of that motion give.
    joint : str or None
        Whose number it is; that of the robot if None.
    meaning : str
        Which of several numbers it may be, in words.
    norm : Beside, optional
        The same beside the largest norm over the joints, where one number speaks of several.
    linear : bool, optional
        Of a peak: whether its joint slides, so that units explain a factor between the two.
    """

    printed: Printed
    rounded: tuple[float, float]
    wide: tuple[float, float]
    exact: float
    reach: float
    far: float
    sampled: tuple[float, float]
    joint: str | None = None
    meaning: str = ""
    norm: Beside | None = None
    linear: bool | None = None

    @property
    def met(self) -> bool:
        """Whether the motion's number rounds to the printed digits, all others as printed."""
        return self.rounded[0] <= self.exact <= self.rounded[1]

    @property
    def distance(self) -> float:
        """Relative distance of the printed number from that of the motion."""
        value = float(self.printed.fraction)
        if self.exact == 0.0:
            return 0.0 if value == 0.0 else np.inf
        return (value - self.exact) / self.exact

    def _meets(self, ends: tuple[float, float], low: float, high: float, factor: float = 1) -> bool:
        return factor * ends[0] <= high and low <= factor * ends[1]

    @cached_property
    def kind(self) -> Class:
        """How the two lie beside each other, the most charitable first."""
        exact, reach, far = self.exact, self.reach, self.far
        if self._meets(self.rounded, exact - reach, exact + reach):
            return Class.ROUNDING
        if self._meets(self.wide, exact - far, exact + far):
            return Class.CUT_OFF
        if self._meets(self.wide, self.sampled[0] - far, self.sampled[1] + far):
            return Class.SAMPLING
        if self.norm is not None and self.norm.fits:
            return Class.NORM
        if self.root is not None:
            return Class.ROOT
        return Class.OFF if self.factor is None else Class.UNIT

    @property
    def fits(self) -> bool:
        """Whether nothing speaks against the printed number."""
        return self.kind in FITS

    @property
    def root(self) -> int | None:
        """Whose square root a printed peak lacks, if with it the two agree within rounding."""
        if self.linear is None:
            return None
        low, high = self.exact - self.reach, self.exact + self.reach
        return next((n for n in _ROOTS if self._meets(self.rounded, low, high, n**0.5)), None)

    @property
    def factor(self) -> str | None:
        """What a ratio of peaks near that of two units would mean, if it is near one."""
        value = float(self.printed.fraction)
        if self.linear is None or not (self.exact > 0 and value > 0):
            return None
        return meant_by_ratio(value / self.exact, self.linear)


def nearest_number(
    printed: Printed,
    meant: Meant,
    samples: Sequence[Mapping[str, float]],
    durations: RoundingBox,
    waypoints: RoundingBox,
    joint: str | None,
    spread: float = 0.0,
) -> Beside:
    """A printed number beside the one that it is nearest to, of those that it may be.

    Parameters
    ----------
    printed : Printed
    meant : callable
        In the unit of the paper.
    samples : sequence of dict
        What samples of the printed motion give instead, in the same words; may be empty.
    durations : RoundingBox, shape (segments,)
    waypoints : RoundingBox, shape (way-points, joints)
    joint : str or None
        Whose number it is.
    spread : float
        Further change that rounding allows, in the unit of the paper.

    Returns
    -------
    Beside
    """
    at_print = meant(waypoints.value, durations.value)
    reach = dict.fromkeys(at_print, 0.0)
    for moved in _each_moved(durations, waypoints, "upper"):
        for words, value in meant(*moved).items():
            reach[words] += abs(value - at_print[words])
    rounded, wide = (
        (float(one.lower), float(one.upper)) for one in (printed.interval, hull(printed))
    )
    tried = []
    for words, value in at_print.items():
        sampled = [one[words] for one in samples] or [value]
        near, far = reach[words] + spread, 2 * (reach[words] + spread)
        ends = min(sampled), max(sampled)
        tried.append(Beside(printed, rounded, wide, value, near, far, ends, joint, words))
    fitting = [one for one in tried if one.fits]
    if not fitting:
        for i, one in enumerate(tried):
            near, far = (
                _farthest(meant, one.meaning, durations, waypoints, share) for share in (1.0, 2.0)
            )
            near, far = near + spread, far + 2 * spread
            tried[i] = replace(one, reach=max(one.reach, near), far=max(one.far, far))
        fitting = [one for one in tried if one.fits]
    return min(fitting or tried, key=lambda one: abs(one.exact - float(printed.fraction)))


def _farthest(
    meant: Meant,
    words: str,
    durations: RoundingBox,
    waypoints: RoundingBox,
    share: float,
) -> float:
    """Largest change of a number that is found in the rounding box, ``share`` as wide."""

    def look(h: RoundingBox, q: RoundingBox) -> Look:
        here = meant(q.value, h.value)[words]

        def changes(end: str) -> Array:
            found = []
            for moved in _each_moved(h, q, end):
                try:
                    found.append(meant(*moved)[words] - here)
                except TrajgapError:  # a duration that is not positive, or no curve
                    found.append(np.nan)
            return np.array(found)

        return Look(here, changes("lower"), changes("upper"))

    return largest_change(durations, waypoints, share, look)


def _each_moved(h: RoundingBox, q: RoundingBox, end: str) -> Iterator[tuple[Array, Array]]:
    """Way-points and durations with one number at an end: the durations first, row by row."""
    for k in np.ndindex(h.value.shape):
        yield q.value, _with(h.value, k, getattr(h, end))
    for k in np.ndindex(q.value.shape):
        yield _with(q.value, k, getattr(q, end)), h.value


def _with(values: Array, k: tuple[int, ...], others: Array) -> Array:
    found = values.copy()
    found[k] = others[k]
    return found


def printed_numbers(study: Study, claim: MotionValueClaim) -> list[tuple[str | None, Printed]]:
    """Each printed number of a claim of a derivative with the joint that it belongs to."""
    if claim.values is None:
        return [(claim.joint, number) for number in claim.printed]
    return list(zip(study.case.robot.joints, claim.values, strict=True))


@dataclass(frozen=True)
class MotionNumbers(Generic[_Value]):
    """A rule on printed numbers that follow from a motion.

    Attributes
    ----------
    rule : str
    kind : type
        The claims that print such numbers.
    beside : callable
        From a row of durations, a claim, one of its numbers and its joint; None where the motion
        has no such number.
    described : callable
        One number beside the motion's, as a part of a sentence.
    without : str
        What is said of a claim where nothing printed defines such a motion.
    """

    rule: str
    kind: type[_Value]
    beside: Callable[[Row[AnyClaim], _Value, Printed, str | None], Beside | None]
    described: Callable[[Row[AnyClaim], _Value, Beside], str]
    without: str

    def judge(self, study: Study) -> Iterator[Finding]:
        """Findings on each claim of the kind beside each motion that it may describe."""
        for claim in study.claims:
            if not isinstance(claim, self.kind):
                continue
            meant = motions_of(study.case.claims, claim)
            for row in (row for motion in meant for row in rows(study, motion)):
                if claim.problem in (None, row.problem) and row.has_curve:
                    each = printed_numbers(study, claim)
                    found = [self.beside(row, claim, number, joint) for joint, number in each]
                    if known := [one for one in found if one is not None]:
                        yield self._finding(row, claim, known)
            if not meant:
                yield Finding(
                    rule=self.rule,
                    basis=Basis.TEXT,
                    claim=claim.id,
                    kind="no motion",
                    sentences=(self.without,),
                )

    def _finding(self, row: Row[AnyClaim], claim: _Value, found: Sequence[Beside]) -> Finding:
        """It tells what does not fit, or everything where all of it does."""
        wrong = [one for one in found if not one.fits]
        said = [self.described(row, claim, one) for one in wrong or found]
        verdict, note = misfit(row) if wrong else FITTING
        clash = verdict is ClaimVerdict.INCONSISTENT
        return Finding(
            rule=self.rule,
            verdict=verdict,
            basis=Basis.CHECK if all(one.met for one in found) else Basis.COMPUTED,
            claim=claim.id,
            problem=row.problem,
            reading=row.reading,
            printed=", ".join(map(str, claim.printed)),
            computed="; ".join(around(row, claim, one) for one in found),
            kind=", ".join(_word(one) for one in wrong or found),
            sentences=(f"Of the printed durations ({called(row.claim)}): {'; '.join(said)}.", note),
            root=f"{claim.quantity}s of {row.claim.id}" if clash else "",
            between=(claim.id, row.claim.id) if clash else (),
        )


def _word(one: Beside) -> str:
    """The class of a peak; of other numbers whether they fit."""
    return str(one.kind) if one.linear is not None else "fits" if one.fits else "off"


def unit_of(row: Row[Claim], claim: MotionValueClaim, joint: str | None) -> str:
    """The unit of a claim's number, as a sentence writes it."""
    unit = unit_shown(row, claim.derivative, joint)
    if not isinstance(claim, MeasureClaim):
        return unit
    own, by_time = POWERS[claim.measure]
    shown = unit if own == 1 else f"({unit})²"
    return f"{shown}·{row.study.time_unit}" if by_time else shown


def around(row: Row[Claim], claim: MotionValueClaim, one: Beside) -> str:
    """The motion's number with what rounding may change of it."""
    return f"{one.exact:.6g} ± {one.reach:.1g} {unit_of(row, claim, one.joint)}"


def told(row: Row[Claim], claim: MotionValueClaim, name: str, one: Beside) -> str:
    """A number of a motion by its name, with what is printed and how the two agree."""
    how = {
        Class.ROUNDING: "equal within the rounding of the printed digits",
        Class.CUT_OFF: "as digits that are cut off instead of rounded give it",
        Class.SAMPLING: f"as {SAMPLES[0]} or more samples of the motion give it",
    }.get(one.kind, UNEXPLAINED)
    unit = unit_of(row, claim, one.joint)
    return f"{name} is {one.exact:.6g} {unit}, printed is {one.printed}, {how}"
