"""TG107: stated conditions counted against the number of coefficients."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....problem.cases import ConditionsClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..study import Study


def judge_counts(study: Study) -> Iterator[Finding]:
    """Count what each statement about boundary conditions asks for."""
    for claim in study.claims:
        if isinstance(claim, ConditionsClaim):
            yield _counted(study, claim)


def conditions(claim: ConditionsClaim) -> int:
    """Number of conditions that a statement asks for on one joint.

    Positions at both ends of every segment, continuity at the via-points, and the derivatives
    said to vanish: on both sides of a via-point where it is said of all way-points.
    """
    n = len(claim.degrees)
    rest = len(claim.orders)
    positions, ends = 2 * n, 2 * rest
    if claim.rest_at == "all":
        others = [r for r in range(1, claim.continuity + 1) if r not in claim.orders]
        return positions + ends + (n - 1) * (2 * rest + len(others))
    return positions + ends + (n - 1) * claim.continuity


def _counted(study: Study, claim: ConditionsClaim) -> Finding:
    wanted = conditions(claim)
    available = sum(d + 1 for d in claim.degrees)
    degrees = "-".join(map(str, claim.degrees))
    computed = f"{wanted} conditions on {available} coefficients"
    printed = None if claim.count is None else str(claim.count)
    verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
    message = f"{degrees} polynomials: {computed} per joint."
    if claim.count is not None and claim.count.fraction != wanted:
        verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
        message = f"{degrees} polynomials: {computed} per joint, where {printed} is printed."
    elif wanted > available:
        impossible = _impossible_segments(study, claim)
        if impossible:
            verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
            message = (
                f"{degrees} polynomials: {computed} per joint. No polynomial of that degree meets "
                f"them in segment {', '.join(map(str, impossible))}, where the way-points differ."
            )
        else:
            verdict, severity = ClaimVerdict.NOT_CHECKABLE, Severity.WARNING
            message += " They can hold together only for special way-points."
    return Finding(
        rule="TG107",
        severity=severity,
        verdict=verdict,
        basis=Basis.COUNT,
        claim=claim.id,
        printed=printed,
        computed=computed,
        message=message,
    )


def _impossible_segments(study: Study, claim: ConditionsClaim) -> list[int]:
    """Segments (from 1) between different way-points whose end conditions exceed their degree.

    A polynomial of degree d on a segment at rest at both ends in r derivatives meets 2 + 2r
    Hermite conditions, which are independent; with d + 1 < 2 + 2r coefficients they hold only
    for a constant.
    """
    found = set()
    for pid in study.problems:
        points = study.problem(pid, study.main_reading).waypoints
        if points.shape[0] != len(claim.degrees) + 1:
            continue
        moves = np.abs(np.diff(points, axis=0)).max(axis=1) > 0
        orders = set(claim.orders) == set(range(1, len(claim.orders) + 1))
        for k, degree in enumerate(claim.degrees):
            rests = 2 if claim.rest_at == "all" else 0
            if rests and orders and moves[k] and degree + 1 < 2 + rests * len(claim.orders):
                found.add(k + 1)
    return sorted(found)
