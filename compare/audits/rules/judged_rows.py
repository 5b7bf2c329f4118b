"""Whether a row keeps the limits whatever its digits stand for, in sentences (TG201)."""

from __future__ import annotations

from typing import Any

from ....problem import Verdict, shown_bound
from ....problem.cases import AnyClaim, TimeClaim, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding, Rounding, Severity
from ..printed_row import PrintedRow
from ..words import LIMITS
from .rule_group import Explained

TG201 = Explained(
    "TG201",
    "Printed durations keep the limits for all t, over the rounding box",
    "Do the printed durations keep the printed limits at every instant? The motion is rebuilt "
    "from the printed durations and way-points, and its extrema are exact.",
    "Supported if the limits are kept by the printed numbers, or by some values that "
    "round to them. Refuted only if a limit is broken however the digits were rounded, and "
    "however they were cut off.",
    "A velocity of 2.0004 rad/s against a limit of 2 rad/s is not a fault if durations "
    "printed with two decimals explain it; 2.6 rad/s is one.",
    basis=Basis.ENCLOSURE,
)
_VERDICTS = {
    Rounding.KEEPS: (ClaimVerdict.SUPPORTED, "The printed numbers keep every limit for all t"),
    Rounding.CONSISTENT: (
        ClaimVerdict.SUPPORTED,
        "Some values that round to the printed digits keep every limit for all t",
    ),
    Rounding.BREAKS: (ClaimVerdict.REFUTED, "A limit is broken however the digits were rounded"),
    Rounding.UNDECIDED: (
        ClaimVerdict.NOT_CHECKABLE,
        "The printed digits do not decide whether the limits are kept",
    ),
}
"""What a rounding verdict says of the claim."""


def ratio_at_print(row: PrintedRow[AnyClaim]) -> str:
    """The largest ratio to a limit at the printed numbers, in words."""
    worst = row.check.worst
    if worst is None:
        return "no limit applies"
    if worst.quantity == "curve":
        return "the printed durations define no curve"
    whose = f"joint {worst.joint}" if worst.joint is not None else f"segment {worst.segment + 1}"
    value, limit = (
        row.shown(worst.quantity, one, worst.joint) for one in (abs(worst.value), worst.limit)
    )
    return f"the {worst.quantity} of {whose} reaches {value}, limit {limit}"


def judged_row(row: PrintedRow[AnyClaim]) -> Finding:
    """Whether the durations, or the total, of a row keep the limits, with the reasons (TG201)."""
    if isinstance(row.claim, TotalTimeClaim):
        return _judged_total(row)
    rounding, found, cut = row.rounding, row.check, ""
    verdict, explained = _VERDICTS[rounding.verdict]
    severity = Severity.INFO
    kind = str(rounding.verdict)
    if found.verdict is Verdict.DISCONTINUOUS and rounding.verdict is Rounding.UNDECIDED:
        kind = str(found.verdict)
        jumps = sum(jump.order == 1 for jump in found.jumps)
        explained = (
            "The motion is discontinuous: the printed numbers keep every limit inside the "
            f"segments, but the velocity jumps {jumps} times between them, which requires "
            "infinite acceleration"
        )
    said = [f"{explained}.", f"At the printed numbers {ratio_at_print(row)}."]
    loose, bound = row.statement.declaration.loose, rounding.lower_bound_of_worst
    if rounding.verdict is Rounding.UNDECIDED and loose:
        said.append(f"{loose} are printed numbers, and no proof covers their rounding.")
    if rounding.verdict is Rounding.BREAKS:
        if bound is not None:
            least = shown_bound(bound, "lower")
            said.append(f"In every case, a limit is exceeded by a factor of at least {least}.")
        severity, cut = Severity.ERROR, "The same holds if digits were cut off instead of rounded."
        if row.cut.verdict is not Rounding.BREAKS:
            severity, (verdict, _) = Severity.WARNING, _VERDICTS[row.cut.verdict]
            cut = f"If digits were cut off instead of rounded: {row.cut.verdict}."
    return _found(row, kind, *said, cut, verdict=verdict, severity=severity)


def _judged_total(row: PrintedRow[AnyClaim]) -> Finding:
    """A total without its durations: refuted where no motion that short keeps the limits."""
    printed = row.study.total_digits(row.claim)
    if row.total_excluded:
        excluded = (
            f"No motion within the limits takes {printed} or less, however the digits were rounded "
            "or cut off."
        )
        return _found(row, "total excluded", excluded, verdict=ClaimVerdict.REFUTED)
    return _found(
        row,
        "total open",
        f"Only the total is printed, {printed}, without durations, so it cannot be computed "
        "whether the motion keeps the limits.",
        "No proof shows that every motion of that length breaks them.",
    )


def _found(row: PrintedRow[AnyClaim], kind: str, *said: str, **facts: Any) -> Finding:
    refuted = facts.get("verdict") is ClaimVerdict.REFUTED
    root = f"{LIMITS} {row.claim.id}" if refuted else ""
    return TG201.finding(row, kind, *said, root=root, **facts)


def broken(row: PrintedRow[AnyClaim]) -> tuple[str, ...] | None:
    """What shows that a limit is broken, for all values rounded or cut off to the digits; or None.

    For a total without its durations: that no motion so short keeps the limits.
    """
    if not isinstance(row.claim, TimeClaim) or row.unmoved is not None:
        return None
    judged = judged_row(row)
    return judged.sentences if judged.verdict is ClaimVerdict.REFUTED else None
