"""TG203, TG208 and TG211: printed peaks, means and values beside those of the printed motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from ....problem import Printed
from ....problem.cases import (
    AnyClaim,
    Claim,
    MeasureClaim,
    PeakClaim,
    ValueClaim,
    motions_of,
    profile_of,
)
from ...documents import Basis, ClaimVerdict, Finding
from ..printed_row import PrintedRow, printed_rows
from ..stated import called
from ..study import Study
from .beside import Beside
from .measures import measure_beside, measure_described
from .peaks import beside, peak_described
from .rule_group import Explained, rule_group
from .values import value_beside, value_described

_Value = TypeVar("_Value", PeakClaim, MeasureClaim, ValueClaim)
_FITTING = ClaimVerdict.SUPPORTED, ""
"""What it says that a printed number fits: verdict and no note."""


def _misfit(row: PrintedRow[Claim]) -> tuple[ClaimVerdict, str]:
    """What it says that a printed number does not fit the motion: a verdict, and a note or "".

    What rounds to derivatives at the ends, knots and parameters is not looked at, and may be why.
    """
    loose = row.statement.declaration.loose
    if not loose:
        return ClaimVerdict.INCONSISTENT, ""
    return ClaimVerdict.NOT_CHECKABLE, f"{loose} are rounded numbers, which may explain it."


@dataclass(frozen=True)
class MotionNumbers(Generic[_Value]):
    """A rule on printed numbers that follow from a motion.

    Attributes
    ----------
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
    beside: Callable[[PrintedRow[AnyClaim], _Value, Printed, str | None], Beside | None]
    described: Callable[[PrintedRow[AnyClaim], _Value, Beside], str]
    without: str

    def judge(self, study: Study) -> Iterator[Finding]:
        """Findings on each claim of the kind beside each motion that it may describe."""
        for claim in study.claims:
            # TG304 judges numbers of a profile.
            if not isinstance(claim, self.kind) or profile_of(study.case.claims, claim) is not None:
                continue
            meant = motions_of(study.case.claims, claim)
            for row in (row for motion in meant for row in printed_rows(study, motion)):
                if claim.problem in (None, row.problem) and row.has_curve:
                    each = study.printed_numbers(claim)
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

    def _finding(
        self, row: PrintedRow[AnyClaim], claim: _Value, found: Sequence[Beside]
    ) -> Finding:
        """It tells what does not fit, or everything where all of it does."""
        wrong = [one for one in found if not one.fits]
        said = [self.described(row, claim, one) for one in wrong or found]
        verdict, note = _misfit(row) if wrong else _FITTING
        clash = verdict is ClaimVerdict.INCONSISTENT
        return Finding(
            rule=self.rule,
            verdict=verdict,
            basis=Basis.CHECK if all(one.met for one in found) else Basis.COMPUTED,
            claim=claim.id,
            problem=row.problem,
            reading=row.reading,
            printed=", ".join(map(str, claim.printed)),
            computed="; ".join(one.around for one in found),
            kind=", ".join(_word(one) for one in wrong or found),
            sentences=(
                f"For the printed durations ({called(row.claim)}): {'; '.join(said)}.",
                note,
            ),
            root=f"{claim.quantity}s of {row.claim.id}" if clash else "",
            between=(claim.id, row.claim.id) if clash else (),
        )


def _word(one: Beside) -> str:
    """The class of a peak; of other numbers whether they fit."""
    return str(one.kind) if one.linear is not None else "fits" if one.fits else "off"


judge_peaks = rule_group(
    TG203=Explained(
        "Printed peaks are those of the printed durations",
        "Is a printed peak that of the motion it describes?",
        "Supported within rounding, with digits cut off, or slightly below, as sampling gives "
        "it; one number for all joints may be the largest of them or their largest norm. "
        "Inconsistent if none of these explains it. A factor between two units is named.",
        "The exact peak is 21.351 rad/s². Printed 21.35 is rounding, 21.34 is sampling, and "
        "1223 is the same number in degrees.",
    ),
)(
    MotionNumbers(
        "TG203",
        PeakClaim,
        beside,
        peak_described,
        "No durations are printed whose motion could have this peak.",
    ).judge
)
"""Findings of TG203."""
judge_measures = rule_group(
    TG208=Explained(
        "Printed means and integrals are those of the printed durations",
        "Is a printed mean, root mean square or integral of velocity, acceleration or jerk that of "
        "the motion it describes?",
        "Supported within rounding, with digits cut off, or as 50 samples or more give it; one "
        "number for all joints may be of their norm, of the largest joint, or their mean. "
        "Inconsistent if none of these explains it.",
        "The root mean square of jerk is 5.1920 rad/s³, and 1000 samples give the printed 5.1908.",
    ),
)(
    MotionNumbers(
        "TG208",
        MeasureClaim,
        measure_beside,
        measure_described,
        "Without durations, this cannot be computed.",
    ).judge
)
"""Findings of TG208."""
judge_values = rule_group(
    TG211=Explained(
        "Printed values at one place are those of the printed durations",
        "Is a printed position or derivative at a way-point, at an instant or at its largest that "
        "of the printed durations?",
        "Inconsistent if it differs by more than the printed digits allow. Where a derivative "
        "jumps, either side may be meant; of a largest or smallest value, samples too.",
        "At the second way-point a table prints -175.7 °/s. The spline through the way-points in "
        "the printed times passes it at -175.71 °/s.",
    ),
)(
    MotionNumbers(
        "TG211",
        ValueClaim,
        value_beside,
        value_described,
        "Without durations, this cannot be computed.",
    ).judge
)
"""Findings of TG211."""
