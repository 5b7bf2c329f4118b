"""TG209: printed peaks beside the printed limits that they are said to keep."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....problem import QUANTITIES
from ....problem.cases import AnyClaim, Digits, PeakClaim, StatementClaim, motions_of
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..printed_row import PrintedRow, printed_rows
from ..stated import place
from ..study import Study
from .rule_group import Explained, rule_group

_ROUNDING = 1.0 + 1e-9
"""Factor by which a peak exceeds its limit at least: far above the rounding of units to floats."""


@rule_group(
    TG209=Explained(
        "Printed peaks lie within the limits that they keep",
        "Does a printed peak lie above the limit that its motion is said to keep?",
        "Inconsistent if no value that the digits of peak and limit stand for, rounded, raised or "
        "cut off, lies within. A number for several joints at once may be a norm and is left out.",
        "A table prints 3.665 rad/s² for the acceleration of joint 2, another the limit 3.6, and "
        "the abstract says that no limit is exceeded.",
    ),
)
def judge_peak_limits(study: Study) -> Iterator[Finding]:
    """Findings of TG209."""
    for claim in study.claims:
        if isinstance(claim, StatementClaim) and claim.checks == "within_limits":
            for peak in study.claims:
                if isinstance(peak, PeakClaim):
                    yield from _beyond(study, claim, peak)


def _beyond(study: Study, claim: StatementClaim, peak: PeakClaim) -> Iterator[Finding]:
    for motion in motions_of(study.case.claims, peak):
        if claim.of and motion.id not in claim.of:
            continue
        for row in printed_rows(study, motion):
            said = _above(row, peak)
            if said:
                yield Finding(
                    rule="TG209",
                    severity=Severity.ERROR,
                    verdict=ClaimVerdict.INCONSISTENT,
                    basis=Basis.DIGITS,
                    claim=claim.id,
                    problem=row.problem,
                    reading=row.reading,
                    printed=", ".join(map(str, peak.printed)),
                    kind="beyond",
                    sentences=(f"{place(peak)} prints {'; '.join(said)}.",),
                    root=f"peaks beyond limits {claim.id}",
                    between=(claim.id, peak.id),
                )


def _above(row: PrintedRow[AnyClaim], peak: PeakClaim) -> list[str]:
    """Printed peaks beyond their limits, whatever was rounded, raised or cut off in either.

    A number for several joints at once may be the norm over them, which no limit bounds.
    """
    loosest = row.posed(Digits.LOOSEST_CUT)
    order = QUANTITIES.index(peak.derivative)
    found = []
    for joint, number in row.study.printed_numbers(peak):
        if joint is None and len(loosest.joints) > 1:
            continue
        j = 0 if joint is None else loosest.joints.index(joint) if joint in loosest.joints else None
        if j is None:
            continue
        limit = float(loosest.limits.sides[:, j, order].max())
        label = loosest.joints[j]
        measured = row.measured(number, peak.derivative, label)
        least = measured.value - (measured.upper - measured.lower)
        if np.isfinite(limit) and least > limit * _ROUNDING:
            shown = row.in_units(peak.derivative, limit, label)
            unit = row.unit(peak.derivative, label)
            found.append(
                f"{number} {unit} for the {peak.derivative} of joint {label}, whose "
                f"limit is at most {shown:.6g} {unit}, however its digits are read"
            )
    return found
