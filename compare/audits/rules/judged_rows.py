"""Whether a row keeps the limits whatever its digits stand for, in sentences."""

from __future__ import annotations

from dataclasses import dataclass

from ....problem import Verdict, shown_bound
from ....problem.cases import AnyClaim, TimeClaim, TotalTimeClaim
from ...documents import ClaimVerdict, Rounding, Severity
from ..printed_row import PrintedRow


@dataclass(frozen=True)
class JudgedRow:
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


def ratio_at_print(row: PrintedRow[AnyClaim]) -> str:
    """The largest ratio to a limit at the printed numbers, in words."""
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


def judged_row(row: PrintedRow[AnyClaim]) -> JudgedRow:
    """Whether the durations, or the total, of a row keep the limits, with the reasons."""
    if isinstance(row.claim, TotalTimeClaim):
        return _judged_total(row)
    rounding = row.rounding
    verdict, severity = _VERDICTS[rounding.verdict]
    at_print = ratio_at_print(row)
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
            f"segments, but the velocity jumps {jumps} times between them, which requires "
            "infinite acceleration"
        )
    said = [f"{explained}.", f"At the printed numbers {at_print}."]
    loose = row.statement.declaration.loose
    if rounding.verdict is Rounding.UNDECIDED and loose:
        said.append(f"{loose} are printed numbers, and no proof covers their rounding.")
    bound = rounding.lower_bound_of_worst
    if rounding.verdict is Rounding.BREAKS and bound is not None:
        said.append(
            f"In every case, a limit is exceeded by a factor of at least "
            f"{shown_bound(bound, 'lower')}."
        )
    if rounding.verdict is Rounding.BREAKS:
        cut = row.cut.verdict
        if cut is not Rounding.BREAKS:
            kept = cut is not Rounding.UNDECIDED
            verdict = ClaimVerdict.SUPPORTED if kept else ClaimVerdict.NOT_CHECKABLE
            said.append(f"If digits were cut off instead of rounded: {cut}.")
            return JudgedRow(verdict, Severity.WARNING, tuple(said), kind)
        said.append("The same holds if digits were cut off instead of rounded.")
    return JudgedRow(verdict, severity, tuple(said), kind)


def _judged_total(row: PrintedRow[AnyClaim]) -> JudgedRow:
    """A total without its durations: refuted where no motion that short keeps the limits."""
    printed = row.study.total_digits(row.claim)
    if row.total_excluded:
        excluded = (
            f"No motion within the limits takes {printed} or less, however the digits were rounded "
            "or cut off."
        )
        return JudgedRow(ClaimVerdict.REFUTED, Severity.ERROR, (excluded,), "total excluded")
    said = (
        f"Only the total is printed, {printed}, without durations, so it cannot be computed "
        "whether the motion keeps the limits.",
        "No proof shows that every motion of that length breaks them.",
    )
    return JudgedRow(ClaimVerdict.NOT_CHECKABLE, Severity.INFO, said, "total open")


def broken(row: PrintedRow[AnyClaim]) -> tuple[str, ...] | None:
    """What shows that a limit is broken, for all values rounded or cut off to the digits; or None.

    For a total without its durations: that no motion so short keeps the limits.
    """
    if not isinstance(row.claim, TimeClaim):
        return None
    if row.unmoved is not None:
        return None
    judged = judged_row(row)
    return judged.sentences if judged.verdict is ClaimVerdict.REFUTED else None
