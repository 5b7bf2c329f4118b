"""Which printed durations are said to keep the limits, and whether they do, in sentences."""

from __future__ import annotations

from dataclasses import dataclass

from ....problem import Case, Verdict, shown_bound
from ....problem.cases import AnyClaim, ImprovementClaim, StatementClaim, TimeClaim, TotalTimeClaim
from ...documents import ClaimVerdict, Rounding, Severity
from ..printed_row import PrintedRow
from ..study import Study


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
            f"segments, and the velocity jumps {jumps} times between them, which takes an infinite "
            "acceleration"
        )
    said = [f"{explained}.", f"At the printed numbers {at_print}."]
    loose = row.statement.declaration.loose
    if rounding.verdict is Rounding.UNDECIDED and loose:
        said.append(f"{loose} are printed numbers, and no proof covers their rounding.")
    bound = rounding.lower_bound_of_worst
    if rounding.verdict is Rounding.BREAKS and bound is not None:
        said.append(
            f"Whatever the rounding, a limit is exceeded by a factor of at least "
            f"{shown_bound(bound, 'lower')}."
        )
    if rounding.verdict is Rounding.BREAKS:
        cut = row.cut.verdict
        if cut is not Rounding.BREAKS:
            kept = cut is not Rounding.UNDECIDED
            verdict = ClaimVerdict.SUPPORTED if kept else ClaimVerdict.NOT_CHECKABLE
            said.append(f"With digits cut off instead of rounded: {cut}.")
            return JudgedRow(verdict, Severity.WARNING, tuple(said), kind)
        said.append("The same holds with digits cut off instead of rounded.")
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
        f"Only the total is printed, {printed}, and no durations, so that whether its motion keeps "
        "the limits cannot be computed.",
        "It was not shown that every motion of that length breaks them.",
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


UNSAID = "Nothing printed says that these durations keep the limits."
"""What follows a broken limit where no word of the paper is contradicted by it."""


def said_to_keep(study: Study, claim: AnyClaim) -> bool:
    """Whether the paper says that these durations keep the limits.

    It does where a statement about limits or optimality names them, or the total that is printed of
    them. Nothing else does: a table of limits, a named algorithm or a row of a comparison says what
    was asked, not that this row answers it.
    """
    case = study.case
    totals = {c.id for c in case.claims if isinstance(c, TotalTimeClaim) and c.of == claim.id}
    return any({claim.id, *totals}.intersection(c.of) for c in _statements(case))


def meant_to_keep(study: Study, claim: AnyClaim) -> bool:
    """Whether durations are meant as an answer within the limits, said or not.

    They are if the paper says so, or an algorithm found them and they are not the state before an
    optimisation. Where no statement names any durations, they are too, unless they are what an
    improvement starts from.
    """
    case = study.case
    if said_to_keep(study, claim):
        return True
    if isinstance(claim, TimeClaim) and claim.state == "before":
        return False
    improved = any(isinstance(c, ImprovementClaim) and c.slower == claim.id for c in case.claims)
    return claim.algorithm is not None or not (_statements(case) or improved)


def said_of(
    study: Study, claim: AnyClaim, verdict: ClaimVerdict, severity: Severity
) -> tuple[ClaimVerdict, Severity]:
    """What a verdict on the limits means for the claim of the durations.

    A broken limit refutes only what is said to keep it.
    """
    if said_to_keep(study, claim):
        return verdict, severity
    supported = verdict is ClaimVerdict.SUPPORTED and severity is Severity.INFO
    if supported and meant_to_keep(study, claim):
        return verdict, severity
    return ClaimVerdict.NOT_CHECKABLE, Severity.INFO


def _statements(case: Case) -> list[StatementClaim]:
    """Statements about limits or optimality that name what they speak of."""
    about = ("within_limits", "optimal")
    found = [c for c in case.claims if isinstance(c, StatementClaim) and c.checks in about]
    return [c for c in found if c.of]
