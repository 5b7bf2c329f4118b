"""What each reading of a case makes of the printed answers, and what holds whatever the reading."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from math import exp, isfinite, log

import numpy as np

from ...problem import QUANTITIES, extrema, fit
from ...problem.cases import AnyClaim, TotalTimeClaim
from ..documents import (
    Excess,
    Fit,
    Gap,
    HeldOtherwise,
    Judgement,
    Keeping,
    Limited,
    ReadingOutcome,
    ReadingsSummary,
    Tally,
    Waterfall,
    Why,
    known,
)
from ..gaps import gap, reference_of
from .chosen_case import Pair
from .fixed_ratios import off_ratios
from .plausibility import implausible
from .reading_words import answers, holding
from .row import Row
from .rules import held_otherwise, reading_clues
from .stated import other_objective
from .study import Study

SAME = 1e-6
"""Relative difference below which two readings are called alike."""


def readings_summary(
    study: Study, waterfalls: Iterable[Waterfall], judgements: Iterable[Judgement]
) -> ReadingsSummary | None:
    """Set the readings of a case side by side; None if there is only one.

    Parameters
    ----------
    study : Study
    waterfalls : iterable of Waterfall
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
    outcomes = tuple(_outcome(study, one) for one in waterfalls)
    why = None
    if not outcomes:
        missing = study.case.statement().waypoints.not_printed
        why = f"no way-points are printed: {missing}" if missing else "no problem is posed"
    fits = _fits(one for one in outcomes if _shortest(study, one))
    least = fits[0].factor if fits else 0.0
    nearest = tuple(fit.reading for fit in fits if fit.factor <= least * (1 + SAME))
    tallies = tuple(
        Tally(
            claim=j.claim,
            verdict=j.verdict,
            scope=j.scope,
            readings=dict(Counter(j.readings.values())),
        )
        for j in judgements
    )
    summary = ReadingsSummary(
        admissible=admissible,
        labels=study.case.labels,
        implausible=implausible(study),
        default=study.case.default_reading.id,
        default_why=known(
            study.case.default_reading.default_why, "the case file gives no reason of its own"
        ),
        clues=reading_clues(study),
        answers=(),
        holding=(),
        nearest=nearest,
        fits=fits,
        outcomes=outcomes,
        outcomes_why=why,
        claims=tallies,
    )
    return summary.model_copy(update={"answers": answers(summary), "holding": holding(summary)})


def _outcome(study: Study, waterfall: Waterfall) -> ReadingOutcome:
    pair = Pair(waterfall.problem, waterfall.reading)
    solution = study.optimum(pair)
    reference = reference_of(solution)
    keeping: Keeping | Why = Why("no durations are printed for all joints of this problem")
    distance: Gap | Why = Why("no printed total stands beside an optimum")
    held: HeldOtherwise | Why = Why("no durations are printed for all joints of this problem")
    stretch: float | None = None
    excesses: tuple[Excess, ...] = ()
    jumps = 0
    if waterfall.claim is not None:
        claim = study.case.claim(waterfall.claim)
        row = Row(study, claim, pair)
        unmoved = row.unmoved
        if unmoved is not None:
            keeping, held = Why(unmoved), Why(unmoved)
        elif not isinstance(claim, TotalTimeClaim):  # a total alone is no motion
            found = row.check
            keeping = row.keeping
            jumps = sum(jump.order == 1 for jump in found.jumps)
            held = held_otherwise(row)
            stretch = found.stretch if isfinite(found.stretch) and found.stretch > 0 else None
        if keeping is Keeping.BREAKS:
            excesses = _excesses(row)
        total = row.total
        if off_ratios(row) is not None:
            distance = Why("the printed durations have other ratios than this reading fixes")
        elif total is not None and reference is not None:
            kept = keeping in (Keeping.KEEPS, Keeping.CONSISTENT)
            distance = gap(total[1], reference, feasible=kept)
    return ReadingOutcome(
        reading=waterfall.reading,
        problem=waterfall.problem,
        claim=waterfall.claim,
        keeping=keeping,
        jumps=jumps,
        held=held,
        excesses=excesses,
        stretch=known(stretch, "no uniform stretch reaches the limits"),
        optimum=known(None if reference is None else reference.upper, "no positive time is known"),
        evidence=solution.evidence,
        gap=distance,
    )


def _shortest(study: Study, outcome: ReadingOutcome) -> bool:
    """Whether a printed answer is meant as a shortest one, which uses a limit up."""
    claim = None if outcome.claim is None else study.case.claim(outcome.claim)
    return claim is None or other_objective(study.case, claim) is None


def _excesses(row: Row[AnyClaim]) -> tuple[Excess, ...]:
    """The largest excess of each segment at the printed point, by exact extrema."""
    problem = row.posed()
    checked = row.check
    over = [
        Excess(segment=p.segment, joint=p.joint, quantity=Limited(p.quantity), ratio=float(p.ratio))
        for p in checked.peaks
    ]
    if not any(p.quantity == "curve" for p in checked.peaks):
        durations = row.durations.value
        trajectory = fit(problem.curve, problem.waypoints, durations)
        over += [
            Excess(
                segment=problem.curve.segment_of(durations, e),
                joint=problem.joints[j],
                quantity=Limited(name),
                ratio=float(abs(e.value) / limit),
            )
            for order, name in enumerate(QUANTITIES, start=1)
            for j, sizes in enumerate(problem.limits.sides[:, :, order - 1].T)
            if np.isfinite(sizes).any()
            for e in extrema(trajectory, j, order)
            for limit in (sizes[int(e.value > 0.0)],)
            if np.isfinite(limit) and limit > 0
        ]
    found: dict[int, Excess] = {}
    for excess in over:
        known = found.get(excess.segment)
        if excess.ratio > 1.0 + checked.tolerance and (known is None or excess.ratio > known.ratio):
            found[excess.segment] = excess
    return tuple(found[segment] for segment in sorted(found))


def _fits(outcomes: Iterable[ReadingOutcome]) -> tuple[Fit, ...]:
    """Factor to the limits of each reading; a reading without one for every answer is left out."""
    logs: defaultdict[str, list[float]] = defaultdict(list)
    lost = set()
    for outcome in outcomes:
        if not isinstance(outcome.stretch, Why):
            logs[outcome.reading].append(abs(log(outcome.stretch)))
        elif outcome.claim is not None:
            lost.add(outcome.reading)
    factors = {reading: exp(max(each)) for reading, each in logs.items() if reading not in lost}
    return tuple(
        Fit(reading=reading, factor=factor)
        for reading, factor in sorted(factors.items(), key=lambda item: item[1])
    )
