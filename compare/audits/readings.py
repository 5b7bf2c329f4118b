"""What each reading of a case makes of the printed answers, and what holds whatever the reading."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from math import exp, isfinite, log

import numpy as np

from ...nlp import Evidence
from ...problem import QUANTITIES, Verdict, extrema, fit
from ...problem.cases import AnyClaim
from ..gaps import Gap, gap
from .finding import ClaimVerdict, Judgement, Scope
from .rounding import Rounding
from .rules import reference_of
from .study import Study
from .waterfall import Waterfall

SAME = 1e-6
"""Relative difference below which two readings are called alike."""


class Keeping(StrEnum):
    """What holds of printed durations under one reading, over everything that prints alike."""

    KEEPS = "keeps"
    """The printed point itself keeps every limit, and nothing jumps."""
    CONSISTENT = "consistent"
    """Some input that prints alike does, digits rounded or cut off."""
    DISCONTINUOUS = "discontinuous"
    """The printed point keeps every limit inside the segments; its velocity jumps between them."""
    BREAKS = "breaks"
    """No input that prints alike keeps every limit, digits rounded or cut off."""
    UNDECIDED = "undecided"
    """None of these was shown."""


@dataclass(frozen=True)
class Excess:
    """Where the printed point exceeds a limit most, in one segment.

    Attributes
    ----------
    segment : int
        From 0.
    joint : str or None
        None for a duration outside its bounds.
    quantity : str
    ratio : float
        |value|/limit.
    """

    segment: int
    joint: str | None
    quantity: str
    ratio: float


@dataclass(frozen=True)
class Outcome:
    """One printed answer under one reading.

    Attributes
    ----------
    reading, problem : str
    claim : str or None
        The printed durations for all joints of the problem; None if none are printed.
    keeping : Keeping or None
        None without printed durations.
    jumps : int
        Jumps of velocity at the printed point.
    excesses : tuple of Excess
        Segments in which the printed point exceeds a limit, where ``keeping`` is "breaks".
    stretch : float or None
        c: all durations times c just reach the limits, jumps apart; None where no c does.
    optimum : float or None
        Best known shortest time with shared durations, s; None if there is none.
    evidence : Evidence
        Of the optimum.
    gap : Gap or None
        Of the printed total against it.
    """

    reading: str
    problem: str
    claim: str | None
    keeping: Keeping | None
    jumps: int
    excesses: tuple[Excess, ...]
    stretch: float | None
    optimum: float | None
    evidence: Evidence
    gap: Gap | None


@dataclass(frozen=True)
class Tally:
    """In how many admissible readings each verdict on a claim holds."""

    claim: str
    verdict: ClaimVerdict
    scope: Scope
    counts: tuple[tuple[ClaimVerdict, int], ...]


@dataclass(frozen=True)
class ReadingsSummary:
    """The readings of one case side by side.

    Attributes
    ----------
    admissible : tuple of str
        Every reading of the case.
    outcomes : tuple of Outcome
        One per problem and reading that was computed.
    tallies : tuple of Tally
        One per claim, over all admissible readings.
    fits : tuple of (str, float)
        Readings by how nearly the printed durations use the limits up: the factor, 1 or more, by
        which all of them would have to be lengthened or shortened to just reach the limits, the
        largest over the problems; ascending. A shortest time uses a limit up.
    why : str or None
        Why there are no outcomes.
    """

    admissible: tuple[str, ...]
    outcomes: tuple[Outcome, ...]
    tallies: tuple[Tally, ...]
    fits: tuple[tuple[str, float], ...]
    why: str | None

    @property
    def nearest(self) -> tuple[str, ...]:
        """Readings under which the printed durations most nearly use the limits up."""
        least = self.fits[0][1] if self.fits else 0.0
        return tuple(reading for reading, factor in self.fits if factor <= least * (1 + SAME))


def readings_summary(
    study: Study, falls: Iterable[Waterfall], judgements: Iterable[Judgement]
) -> ReadingsSummary | None:
    """Set the readings of a case side by side; None if there is only one.

    Parameters
    ----------
    study : Study
    falls : iterable of Waterfall
        They name the printed answer of each problem.
    judgements : iterable of Judgement
        Of the claims, over all admissible readings.

    Returns
    -------
    ReadingsSummary or None
    """
    admissible = tuple(reading.id for reading in study.case.readings)
    if len(admissible) < 2:
        return None
    outcomes = tuple(_outcome(study, fall) for fall in falls)
    why = None
    if not outcomes:
        missing = study.case.statement().waypoints.not_printed
        why = f"no way-points are printed: {missing}" if missing else "no problem is posed"
    tallies = tuple(
        Tally(j.claim, j.verdict, j.scope, tuple(Counter(v for _, v in j.readings).items()))
        for j in judgements
    )
    return ReadingsSummary(admissible, outcomes, tallies, _fits(outcomes), why)


def _outcome(study: Study, fall: Waterfall) -> Outcome:
    pid, rid = fall.problem, fall.reading
    solution = study.optimum(pid, rid)
    reference = reference_of(solution)
    best = None if reference is None else reference.upper
    if fall.claim is None:
        return Outcome(rid, pid, None, None, 0, (), None, best, solution.evidence, None)
    claim = study.case.claim(fall.claim)
    found = study.claim_check(claim, pid, rid)
    keeping = _keeping(study, claim, pid, rid)
    total = study.claim_total(claim, rid)
    distance = None
    if total is not None and reference is not None:
        kept = keeping in (Keeping.KEEPS, Keeping.CONSISTENT)
        distance = gap(total[1], reference, feasible=kept)
    return Outcome(
        rid,
        pid,
        claim.id,
        keeping,
        sum(jump.order == 1 for jump in found.jumps),
        _excesses(study, claim, pid, rid) if keeping is Keeping.BREAKS else (),
        found.stretch if isfinite(found.stretch) and found.stretch > 0 else None,
        best,
        solution.evidence,
        distance,
    )


def _keeping(study: Study, claim: AnyClaim, pid: str, rid: str) -> Keeping:
    verdict = study.claim_rounding(claim, pid, rid).verdict
    if verdict is Rounding.BREAKS:
        verdict = study.claim_cut(claim, pid, rid).verdict
    found = study.claim_check(claim, pid, rid)
    jumping = any(jump.order == 1 for jump in found.jumps)
    if verdict is Rounding.UNDECIDED and jumping and found.limits is Verdict.PASS:
        return Keeping.DISCONTINUOUS
    return Keeping(str(verdict))


def _excesses(study: Study, claim: AnyClaim, pid: str, rid: str) -> tuple[Excess, ...]:
    """The largest excess of each segment at the printed point, by exact extrema."""
    problem = study.claim_problem(claim, pid, rid)
    checked = study.claim_check(claim, pid, rid)
    over = [Excess(p.segment, p.joint, p.quantity, float(p.ratio)) for p in checked.peaks]
    if not any(p.quantity == "curve" for p in checked.peaks):
        durations = study.case.claim_durations(claim, rid).value
        trajectory = fit(problem.curve, problem.waypoints, durations)
        over += [
            Excess(
                problem.curve.segment_of(durations, e),
                problem.joints[j],
                name,
                float(abs(e.value) / limit),
            )
            for order, name in enumerate(QUANTITIES, start=1)
            for j, limit in enumerate(problem.limits.derivatives[:, order - 1])
            if np.isfinite(limit) and limit > 0
            for e in extrema(trajectory, j, order)
        ]
    found: dict[int, Excess] = {}
    for excess in over:
        known = found.get(excess.segment)
        if excess.ratio > 1.0 + checked.tolerance and (known is None or excess.ratio > known.ratio):
            found[excess.segment] = excess
    return tuple(found[segment] for segment in sorted(found))


def _fits(outcomes: Iterable[Outcome]) -> tuple[tuple[str, float], ...]:
    """Factor to the limits of each reading; a reading without one for every answer is left out."""
    logs: defaultdict[str, list[float]] = defaultdict(list)
    lost = set()
    for outcome in outcomes:
        if outcome.claim is not None and outcome.stretch is None:
            lost.add(outcome.reading)
        elif outcome.stretch is not None:
            logs[outcome.reading].append(abs(log(outcome.stretch)))
    factors = {reading: exp(max(each)) for reading, each in logs.items() if reading not in lost}
    return tuple(sorted(factors.items(), key=lambda item: item[1]))
