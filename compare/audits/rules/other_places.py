"""TG108: printed numbers that fit another row, column or table better than their own."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import inf, isfinite, log

from ....problem import check
from ....problem.cases import AnyClaim, DurationsClaim, PeakClaim, TimeClaim, motions_of
from ...documents import Basis, Finding
from ..printed_row import PrintedRow, printed_rows
from ..stated import RowClaim, called
from ..study import Study
from ..words import percent
from .judged_rows import broken
from .peaks import peak_beside
from .printed_tables import doubted
from .rule_group import INFORMS, Explained, rule_group

TG108 = Explained(
    "TG108",
    "Printed numbers fit their own row, column or table best",
    "Would printed numbers fit another row, column or table better than their own?",
    "Information, with both distances. It does not say that anything was exchanged. " + INFORMS,
    "The peak printed for joint 2 differs by 40 % from that of its motion and by 0.1 % from "
    "that of joint 3, and vice versa.",
    basis=Basis.CHECK,
    decides=False,
)


@rule_group(TG108)
def judge_places(study: Study) -> Iterator[Finding]:
    """Findings of TG108. They decide nothing: a slip of the printer is no fault of the numbers."""
    for claim in study.claims:
        if isinstance(claim, PeakClaim):
            for motion in motions_of(study.case.claims, claim):
                yield from _peaks_elsewhere(study, claim, motion)
        elif isinstance(claim, DurationsClaim) and claim.joint is not None:
            yield from _row_elsewhere(study, claim)
    yield from _equal_rows(study)


def _peaks_elsewhere(study: Study, claim: PeakClaim, own: AnyClaim) -> Iterator[Finding]:
    motions = [c for c in study.case.claims if isinstance(c, RowClaim)]
    for row in printed_rows(study, own):
        joints = study.problem(row.pair).joints
        said = []
        for joint, number in study.printed_numbers(claim):
            mine = peak_beside(row, claim, number, joint)
            if mine is None or mine.fits:
                continue
            found = []
            for motion in motions:
                if not study.fits(motion, row.pair):
                    continue
                elsewhere = PrintedRow(study, motion, row.pair)
                for other in joints if joint is not None else (None,):
                    if (motion.id, other) == (own.id, joint):
                        continue
                    there = peak_beside(elsewhere, claim, number, other)
                    if there is not None and there.printed_there:
                        found.append((abs(there.distance), motion, other))
            if found:
                distance, motion, other = min(found, key=lambda one: one[0])
                whose = "" if other is None else f", joint {other}"
                said.append(
                    f"{number} lies {percent(mine.distance, '+.2g')} from the peak of its own "
                    f"motion and {percent(distance, '.2g')} from that of {called(motion)}{whose}"
                )
        if said:
            yield TG108.finding(
                row,
                "peaks",
                "Printed peaks fit another place better than their own, as if numbers had been "
                f"exchanged in print: {'; '.join(said)}.",
                claim=claim.id,
                printed=", ".join(map(str, claim.printed)),
            )


def _row_elsewhere(study: Study, claim: DurationsClaim) -> Iterator[Finding]:
    """A joint's durations that break its limits and just use up those of another joint."""
    for row in printed_rows(study, claim):
        problem = study.problem(row.pair)
        if claim.joint not in problem.joints or len(problem.joints) == 1:
            continue
        if broken(row) is None:
            continue
        durations = row.durations.value
        own = _misses(row.check.stretch)
        best, joint = min(
            (_misses(check(problem.joint(j), durations).stretch), label)
            for j, label in enumerate(problem.joints)
            if label != claim.joint
        )
        # Within one per cent a row is said to fit the limits of another.
        if best <= 0.01:
            yield TG108.finding(
                row,
                "rows",
                f"The durations printed for joint {claim.joint} ({called(claim)}) would have "
                f"to be stretched by {percent(own, '.2g')} for its own limits and fit those of "
                f"joint {joint} within {percent(best, '.2g')}, as if rows had been exchanged in "
                "print.",
            )


def _misses(stretch: float) -> float:
    """How far a motion is from just reaching its limits, up or down."""
    return abs(log(stretch)) if isfinite(stretch) and stretch > 0 else inf


def _equal_rows(study: Study) -> Iterator[Finding]:
    """Equal durations under two names that are not part of whole tables alike."""
    rows = [c for c in study.case.claims if isinstance(c, DurationsClaim)]
    for first, second in combinations(rows, 2):
        texts = [[d.text for d in c.durations] for c in (first, second)]
        # Two equal durations may be equal by chance.
        if len(texts[0]) < 3 or texts[0] != texts[1] or len(set(texts[0])) == 1:
            continue
        tables = [set(doubted(study, [one])) for one in (first, second)]
        if _named(first) == _named(second) or tables[0] & tables[1]:
            continue
        yield TG108.finding(
            second,
            "equal rows",
            f"{called(first)} and {called(second)} print the same {len(texts[0])} durations "
            "for different things.",
            basis=Basis.DIGITS,
            printed=", ".join(texts[1]),
        )


def _named(claim: TimeClaim) -> tuple[object, ...]:
    return claim.algorithm, claim.problem, claim.joint, claim.state, claim.other_curve
