"""Which printed durations are said to keep the limits."""

from __future__ import annotations

from ....problem.cases import AnyClaim, ImprovementClaim, StatementClaim, TimeClaim
from ..study import Study


def said_to_keep(study: Study, claim: AnyClaim) -> bool:
    """Whether durations are meant as an answer within the limits.

    They are if a statement about limits or optimality names them, or an algorithm found them and
    they are not the state before an optimisation. Where no statement names any durations, they are
    too, unless they are what an improvement starts from.
    """
    about = [
        c.of
        for c in study.case.claims
        if isinstance(c, StatementClaim) and c.checks in ("within_limits", "optimal")
    ]
    if any(claim.id in named for named in about):
        return True
    if isinstance(claim, TimeClaim) and claim.state == "before":
        return False
    improved = any(
        isinstance(c, ImprovementClaim) and c.slower == claim.id for c in study.case.claims
    )
    return claim.algorithm is not None or not (about or improved)
