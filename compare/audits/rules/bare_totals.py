"""TG201 of a total that is printed without its durations, where the paper says what it keeps."""

from __future__ import annotations

from collections.abc import Iterator

from ....problem.cases import TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..roots import LIMITS
from ..row import rows
from ..study import Study
from .continuous_time import broken
from .distances import below_certified
from .kept_limits import said_to_keep


def judge_bare_totals(study: Study) -> Iterator[Finding]:
    """Refute totals that no motion within the limits takes, and that a statement says one does."""
    for claim in study.claims:
        if not (isinstance(claim, TotalTimeClaim) and said_to_keep(study, claim)):
            continue
        for row in rows(study, claim):
            solution = row.optimum
            proof = broken(row) or below_certified(row, solution)
            if proof is not None:
                yield Finding(
                    rule="TG201",
                    verdict=ClaimVerdict.REFUTED,
                    basis=Basis.ENCLOSURE,
                    claim=claim.id,
                    problem=row.problem,
                    reading=row.reading,
                    printed=f"{claim.value} {study.time_unit}",
                    sentences=proof,
                    kind="total excluded",
                    root=f"{LIMITS} {claim.id}",
                )
