"""A row of a paper under a reading: one claim, asked about one problem of its case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from ...nlp import Solution
from ...problem import (
    Array,
    CaseError,
    Check,
    Measured,
    Printed,
    Problem,
    Quantity,
    Trajectory,
    TrajgapError,
    Verdict,
    check,
    fit,
    from_si,
    reachable_total,
    shown_unit,
)
from ...problem.cases import AnyClaim, Claim, Digits, RoundingBox, Statement
from ..documents import UNITS, Keeping, Rounding, noted, si_unit
from .rounding import BOXES, RoundingVerdict, excludes_total, judge_rounding
from .stated import RowClaim, in_words, in_words_among, own_total, place
from .study import Pair, Study, Total

C = TypeVar("C", bound=Claim, covariant=True)
T = TypeVar("T")


@dataclass(frozen=True)
class PrintedRow(Generic[C]):
    """A claim under a problem and a reading; its study keeps what is computed for it.

    Attributes
    ----------
    claim : Claim
        A claim with durations or a total, for methods that return a motion or a time.
    """

    study: Study
    claim: C
    pair: Pair

    @property
    def problem(self) -> str:
        """Id of the problem."""
        return self.pair.problem

    @property
    def reading(self) -> str:
        """Id of the reading."""
        return self.pair.reading

    @property
    def words(self) -> str:
        """The problem and the reading in words."""
        return in_words(self.study.case, *self.pair)

    @property
    def statement(self) -> Statement:
        """The problem under the reading, in printed digits."""
        return self.study.case.statement(*self.pair)

    def once(self, what: str, compute: Callable[[], T], *more: object) -> T:
        """A value that the study keeps for this row under a name, computed on first use."""
        return self.study.once((what, self.claim.id, self.pair, *more), compute)

    def measured(self, number: Printed, quantity: Quantity, joint: str | None = None) -> Measured:
        """A printed number in the SI unit, with the interval that rounds to its digits."""
        place = None if joint is None else self.statement.labels.index(joint)
        return self.statement.si(number, quantity, joint=place)

    def _unit(self, quantity: str, joint: str | None) -> tuple[str | None, bool]:
        """The unit that a quantity is printed in, if one is stated; whether the joint slides."""
        statement = self.statement
        if quantity not in UNITS:
            return (statement.units.time if quantity in ("duration", "time") else None), False
        place = None if joint is None else statement.labels.index(joint)
        linear = statement.linear[statement.joints[0] if place is None else place]
        return statement.unit(quantity, place), linear  # type: ignore[arg-type]

    def unit(self, quantity: str, joint: str | None = None) -> str:
        """The printed unit of a quantity, as a sentence writes it; SI if none is stated.

        Parameters
        ----------
        quantity : str
            "position", "velocity", "acceleration", "jerk" or "time".
        joint : str, optional
            Label of the joint; needed if units differ.
        """
        unit, linear = self._unit(quantity, joint)
        if unit is not None:
            return shown_unit(unit)
        return si_unit(quantity, linear) if quantity in UNITS else "s"

    def in_units(self, quantity: str, value: float, joint: str | None = None) -> float:
        """A number in rad or m and s, converted to the printed unit of its quantity; see `unit`."""
        unit, _ = self._unit(quantity, joint)
        return value if unit is None else from_si(value, unit)

    def shown(
        self, quantity: str, value: float, joint: str | None = None, form: str = ".6g"
    ) -> str:
        """The same as a sentence writes it, with its unit."""
        return f"{self.in_units(quantity, value, joint):{form}} {self.unit(quantity, joint)}"

    def time(self, number: Printed) -> Measured:
        """A printed time of the claim, s, with the interval that rounds to its digits."""
        return self.study.time(number, self.claim, self.reading)

    def posed(self, digits: Digits = Digits.PRINTED) -> Problem:
        """The problem of the claim's durations: that of one joint, or of all joints."""
        study, label = self.study, self.claim.joint
        problem = study.problem(self.pair)
        if digits is not Digits.PRINTED:
            problem = study.once(
                ("problem", self.pair, digits), lambda: self.statement.problem(digits)
            )
        if label is None or label not in problem.joints:
            return problem
        return problem.joint(problem.joints.index(label))

    @property
    def durations(self) -> RoundingBox:
        """The printed durations, s, with the intervals that round to them."""
        return self.study.case.claim_durations(self.claim, self.reading)

    @property
    def motion(self) -> Trajectory:
        """The motion of the printed durations, at the printed way-points."""
        problem = self.posed()
        return fit(problem.curve, problem.waypoints, self.durations.value)

    @property
    def total(self) -> Total | None:
        """The total as printed, or as summed, and its interval in seconds."""
        return self.study.claim_total(self.claim, self.reading)

    @property
    def longest_total(self) -> float:
        """The longest total (s) from which the digits may have been rounded or cut off.

        Each number is treated separately: durations may be cut off although the total is rounded.
        """
        found, number = [], own_total(self.claim)
        if isinstance(self.claim, RowClaim):
            found.append(float(self.durations.or_cut_off().upper.sum()))
        if number is not None:
            found.append(self.time(number).cut_off().upper)
        return min(found, default=float("inf"))

    @property
    def optimum(self) -> Solution:
        """Best known answer of `posed`."""
        return self.study.optimum(self.pair, self.claim.joint)

    @property
    def unmoved(self) -> str | None:
        """Why durations alone define no motion; None if they do."""
        curve = self.posed().curve
        printed = self.study.case.printed_durations(self.claim)
        if printed and len(printed) != curve.segments:
            return (
                f"the curve ({curve.name}) has {curve.segments} segments, but {len(printed)} "
                "durations are printed"
            )
        if not curve.free:
            return None
        many = f"{curve.free} coefficient{'s' if curve.free > 1 else ''}"
        return (
            f"the curve ({curve.name}) leaves {many} per joint free, so durations alone define no "
            "motion"
        )

    def _determined(self) -> Problem:
        """`posed`, whose curve durations settle; raises if they do not."""
        why = self.unmoved
        if why is not None:
            raise TrajgapError(why)
        return self.posed()

    @property
    def check(self) -> Check:
        """The printed durations judged at the printed point."""
        return self.once("check", lambda: check(self._determined(), self.durations.value))

    @property
    def check_or_none(self) -> Check | None:
        """`check`; None if the printed numbers define no motion, which a finding reports."""
        try:
            return self.check
        except TrajgapError:
            return None

    @property
    def has_curve(self) -> bool:
        """Whether the printed durations define a curve under the reading."""
        worst = self.check.worst
        return worst is None or worst.quantity != "curve"

    @property
    def rounding(self) -> RoundingVerdict:
        """The printed durations judged over the box of all inputs that round to the digits."""
        return self.once("rounding", lambda: self._judged_box(cut=False))

    @property
    def kept(self) -> bool:
        """Whether the printed durations keep the limits, as printed or within rounding."""
        if not isinstance(self.claim, RowClaim) or self.unmoved is not None:
            return False
        return self.rounding.verdict in (Rounding.KEEPS, Rounding.CONSISTENT)

    @property
    def cut(self) -> RoundingVerdict:
        """The same over the wider box of inputs whose digits were rounded or cut off."""
        return self.once("cut", lambda: self._judged_box(cut=True))

    @property
    def keeping(self) -> Keeping:
        """Whether the motion keeps the limits, with digits rounded or cut off."""
        verdict = self.rounding.verdict
        if verdict is Rounding.BREAKS:
            verdict = self.cut.verdict
        found = self.check
        jumping = any(jump.order == 1 for jump in found.jumps)
        if verdict is Rounding.UNDECIDED and jumping and found.limits is Verdict.PASS:
            return Keeping.DISCONTINUOUS
        return Keeping(str(verdict))

    def _judged_box(self, cut: bool) -> RoundingVerdict:
        self._progress("rounding")
        problem = self._determined()
        durations, waypoints = self.boxes
        if cut:
            durations, waypoints = durations.or_cut_off(), waypoints.or_cut_off()
        return judge_rounding(
            problem,
            durations,
            waypoints,
            loosest=self.posed(Digits.LOOSEST_CUT if cut else Digits.LOOSEST),
            loose_ends=self.statement.loose_ends,
        )

    def _progress(self, what: str) -> None:
        self.study.progress(f"{what} of {place(self.claim)}; {self.words}")

    def waypoint_box(self, problem: Problem) -> RoundingBox:
        """The way-points of ``problem``, for all joints or one, and the box that rounds to them."""
        lower, upper = self.study.case.waypoint_box(*self.pair)
        labels = self.study.problem(self.pair).joints
        columns = [labels.index(label) for label in problem.joints]
        return RoundingBox(problem.waypoints, lower[:, columns], upper[:, columns])

    @property
    def boxes(self) -> tuple[RoundingBox, RoundingBox]:
        """Durations and way-points of the claim's motion, and the boxes that round to them."""
        return self.durations, self.waypoint_box(self.posed())

    def reachable(self, durations: Array) -> float | None:
        """A total (s) at which stretched ``durations`` keep the limits, however they were rounded.

        It holds for every way-point that rounds to the printed digits or is cut off to them, and
        every limit that rounds to them; None if there is no such stretch, if durations alone
        define no motion, or if the curve itself is printed in rounded numbers. If exact ratios are
        fixed, the durations take them first.
        """
        try:
            problem = self.posed(Digits.TIGHTEST)
        except CaseError:  # the tightest ranges are empty
            return None
        if problem.shares is not None:
            if self.statement.loose_ratios:
                return None  # other ratios, which the digits stand for too, may take longer
            durations = problem.shares * float(np.sum(durations))
        if problem.curve.free or self.statement.loose_ends:
            return None
        box = self.waypoint_box(problem).or_cut_off()
        return reachable_total(problem, durations, box.lower, box.upper)

    @property
    def total_excluded(self) -> bool:
        """Whether no motion within the limits takes the claim's total or less.

        Proved however the digits were rounded or cut off.
        """
        return self.once("excluded", self._excludes_total)

    def _excludes_total(self) -> bool:
        total = self.total
        if total is None or self.statement.loose_ends:
            return False
        low, high = total.interval
        longest = high + (high - low)
        best = self.optimum
        if best.found and best.best <= longest:
            return False  # a motion within the limits takes no longer
        self._progress("total")
        problem = self.posed(Digits.LOOSEST_CUT)
        excluded = excludes_total(problem, longest, self.waypoint_box(problem).or_cut_off())
        if excluded is None:
            asked = in_words_among(self.study.case, *self.pair)
            self.study.intervals.left_out.append(
                noted(f"whether any motion takes {total.shown} or less", asked)
                + f", tried with {BOXES} boxes"
            )
        return excluded is True


def printed_rows(study: Study, claim: C) -> Iterator[PrintedRow[C]]:  # type: ignore[misc]
    """A claim under each problem and reading that it fits; none if it fits none."""
    return (PrintedRow(study, claim, pair) for pair in study.pairs if study.fits(claim, pair))


def rows_under(study: Study, claims: Iterable[C], reading: str) -> list[PrintedRow[C]]:
    """Claims with each problem that they speak about under a reading."""
    return [row for one in claims for row in printed_rows(study, one) if row.reading == reading]


def named_rows(
    study: Study, named: Iterable[str]
) -> Iterator[tuple[str, list[PrintedRow[AnyClaim]], list[AnyClaim]]]:
    """For each reading the rows of claims that a statement names, and the claims that have none.

    From those no motion is built: they are of another curve, or have another number of durations
    than the curve has segments.
    """
    chosen = (None, *study.problems)
    claims = [study.case.claim(one) for one in named]
    for reading in study.readings:
        rows = rows_under(study, claims, reading)
        with_rows = {row.claim.id for row in rows}
        others = [c for c in claims if c.problem in chosen and c.id not in with_rows]
        yield reading, rows, others
