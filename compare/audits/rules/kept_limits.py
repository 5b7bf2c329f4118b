"""Which printed durations are said to keep the limits, and which are meant to."""

from __future__ import annotations

from ....problem import Case
from ....problem.cases import (
    AnyClaim,
    ImprovementClaim,
    StatementClaim,
    TimeClaim,
    TotalTimeClaim,
)
from ...documents import ClaimVerdict, Severity
from ..study import Study

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
