"""TG201 of a total that is printed without its durations, where the paper says what it keeps."""

from __future__ import annotations

from collections.abc import Iterator

from ....problem.cases import TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..roots import LIMITS
from ..study import Study
from .continuous_time import broken
from .distances import below_certified
from .kept_limits import said_to_keep


def judge_bare_totals(study: Study) -> Iterator[Finding]:
    """Refute totals that no motion within the limits takes, and that a statement says one does."""
    for claim in study.claims:
        if not (isinstance(claim, TotalTimeClaim) and said_to_keep(study, claim)):
            continue
        for pid, rid in study.claim_pairs(claim):
            solution = study.claim_optimum(claim, pid, rid)
            proof = broken(study, claim, pid, rid) or below_certified(
                study, claim, pid, rid, solution
            )
            if proof is not None:
                yield Finding(
                    rule="TG201",
                    verdict=ClaimVerdict.REFUTED,
                    basis=Basis.ENCLOSURE,
                    claim=claim.id,
                    problem=pid,
                    reading=rid,
                    printed=f"{claim.value} {study.time_unit}",
                    sentences=proof,
                    kind="total excluded",
                    root=f"{LIMITS} {claim.id}",
                )
