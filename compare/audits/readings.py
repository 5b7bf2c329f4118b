"""What each reading of a case makes of the printed answers, and what holds whatever the reading."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from math import exp, isfinite, log

import numpy as np

from ...nlp import Evidence, weakest
from ...problem import extrema
from ...problem.cases import AnyClaim, TotalTimeClaim
from ..documents import (
    Excess,
    Fit,
    Gap,
    HeldOtherwise,
    Judgement,
    Keeping,
    Limited,
    Named,
    ReadingOutcome,
    ReadingsSummary,
    Scope,
    Tally,
    Waterfall,
    Why,
    known,
    under,
)
from ..gaps import gap, reference_of
from .digit_ranges import implausible, off_ratios
from .printed_row import PrintedRow
from .rules import held_otherwise, reading_clues
from .stated import other_objective
from .study import Pair, Study

ALIKE_READINGS = 1e-6
"""Relative difference below which two readings are called alike."""


def readings_summary(
    study: Study, waterfalls: Iterable[Waterfall], judgements: Iterable[Judgement]
) -> ReadingsSummary | None:
    """Set the readings of a case side by side; None if there is only one."""
    admissible = tuple(reading.id for reading in study.case.readings)
    if len(admissible) < 2:
        return None
    outcomes = tuple(_outcome(study, one) for one in waterfalls)
    why = None
    if not outcomes:
        missing = study.case.statement().waypoints.not_printed
        why = f"no way-points are printed: {missing}" if missing else "no problem is posed"
    # A printed answer that is meant as a shortest one uses a limit up.
    other = {c.id for c in study.case.claims if other_objective(study.case, c) is not None}
    fits = _fits(one for one in outcomes if one.claim not in other)
    least = fits[0].factor if fits else 0.0
    nearest = tuple(fit.reading for fit in fits if fit.factor <= least * (1 + ALIKE_READINGS))
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
        default_why=known(study.case.default_reading.default_why, "the case file gives no reason"),
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
    none = Why("no durations are printed for all joints of this problem")
    keeping: Keeping | Why = none
    held: HeldOtherwise | Why = none
    distance: Gap | Why = Why("no printed total can be compared with an optimum")
    stretch: float | None = None
    excesses: tuple[Excess, ...] = ()
    jumps = 0
    if waterfall.claim is not None:
        claim = study.case.claim(waterfall.claim)
        row = PrintedRow(study, claim, pair)
        unmoved = row.unmoved
        if unmoved is not None:
            keeping, held = Why(unmoved), Why(unmoved)
        elif not isinstance(claim, TotalTimeClaim):  # a total alone is not a motion
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
            distance = gap(total.interval, reference, feasible=kept)
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


def _excesses(row: PrintedRow[AnyClaim]) -> tuple[Excess, ...]:
    """The largest excess of each segment at the printed point, by exact extrema."""
    problem = row.posed()
    checked = row.check
    over = [
        Excess(segment=p.segment, joint=p.joint, quantity=Limited(p.quantity), ratio=float(p.ratio))
        for p in checked.peaks
    ]
    if not any(p.quantity == "curve" for p in checked.peaks):
        durations = row.durations.value
        over += [
            Excess(
                segment=problem.curve.segment_of(durations, e),
                joint=problem.joints[j],
                quantity=Limited(name),
                ratio=float(abs(e.value) / limit),
            )
            for order, name in enumerate(problem.limits.quantities, start=1)
            for j, sizes in enumerate(problem.limits.sides[:, :, order - 1].T)
            if np.isfinite(sizes).any()
            for e in extrema(row.motion, j, order)
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


KEPT = {
    Keeping.KEEPS: "kept",
    Keeping.CONSISTENT: "kept by some values that round to the digits",
    Keeping.DISCONTINUOUS: "not checkable (velocity jumps)",
    Keeping.BREAKS: "broken",
    Keeping.UNDECIDED: "not checkable",
}
"""What the words say of limits, within a sentence; what is open has the word that the claim has."""


def answers(
    summary: ReadingsSummary, called: Callable[[str, str], str] = "{} ({})".format
) -> tuple[str, ...]:
    """What the readings make of the printed answers, called by their ids, and which fit best."""
    return (*_of_answers(summary, called), *_of_fit(summary, called))


def holding(summary: ReadingsSummary) -> tuple[str, ...]:
    """What holds of the claims under all, some and no readings."""
    return tuple(_of_claims(summary))


def segments(excesses: Sequence[Excess]) -> str:
    """Numbers of segments, from 1, with runs drawn together."""
    numbers = [e.segment + 1 for e in excesses]
    runs: list[list[int]] = []
    for n in numbers:
        if runs and n == runs[-1][-1] + 1:
            runs[-1].append(n)
        else:
            runs.append([n])
    return ", ".join(f"{r[0]}–{r[-1]}" if len(r) > 2 else ", ".join(map(str, r)) for r in runs)


def _of_answers(summary: ReadingsSummary, called: Callable[[str, str], str]) -> Iterable[str]:
    if not summary.outcomes:
        yield (
            f"Limits, optimum and gap cannot be computed under any of the "
            f"{len(summary.admissible)} readings, because {summary.outcomes_why}."
        )
        return
    by_answer: defaultdict[tuple[str, str], list[ReadingOutcome]] = defaultdict(list)
    for outcome in summary.outcomes:
        if outcome.claim is not None:
            by_answer[outcome.claim, outcome.problem].append(outcome)
    for (claim, problem), own in by_answer.items():
        found = {k: [o.reading for o in own if o.keeping is k] for k in Keeping}
        # What is named as implausible does not lead the sentence.
        words = sorted(
            (k for k in Keeping if found[k]),
            key=lambda k: all(r in summary.implausible for r in found[k]),
        )
        named = _names(summary)
        said = ", ".join(
            f"{KEPT[k]} {under(found[k], summary.admissible, named, why=True)}" for k in words
        )
        limits = f"the limits are {said}" if said else "the limits cannot be judged"
        yield f"{called(claim, problem)}: {limits}.{_of_gaps(own, summary)}"


def _names(summary: ReadingsSummary) -> Named:
    return Named(summary.labels, summary.implausible, summary.default)


def _of_gaps(own: Sequence[ReadingOutcome], summary: ReadingsSummary) -> str:
    """How far the printed total is from the optimum, where the limits are kept and where not."""
    plain = [o for o in own if o.reading not in summary.implausible]
    kept = [o for o in plain if o.keeping in (Keeping.KEEPS, Keeping.CONSISTENT)]
    parts = []
    for group, where in (
        (kept, " where the limits are kept"),
        ([o for o in plain if o not in kept], " otherwise" if kept else ""),
    ):
        gaps = [o.gap for o in group if isinstance(o.gap, Gap)]
        if gaps:
            low, high = min(g.lowest for g in gaps), max(g.highest for g in gaps)
            parts.append(f"{_away(low, high)}{where}")
    evidence = weakest(o.evidence for o in plain if o.evidence is not Evidence.NONE)
    beside = {
        Evidence.CERTIFIED: "certified optimum",
        Evidence.UNCONVERGED: "total at which the search stopped",
    }.get(evidence, "best known total")
    left = len(own) - len(plain)
    without = f" ({left} implausible reading{'s' * (left > 1)} left out)" if left else ""
    if not parts:
        return ""
    return f" Printed total compared with the {beside}: {', and '.join(parts)}{without}."


def _away(low: float, high: float) -> str:
    """How far totals are from an optimum, as a share of it or as a multiple."""
    (least, side), (most, other) = ends = _end(low), _end(high)
    if ends[0] == ends[1]:
        return f"{least} {side}"
    return f"{least} to {most} {side}" if side == other else f"{least} {side} to {most} {other}"


def _end(gap: float) -> tuple[str, str]:
    """A distance as a number, and what it is."""
    if gap >= 1:
        return f"{1 + gap:.3g}", "times as long"
    return f"{100 * abs(gap):.1f}", f"% {'below' if gap < 0 else 'above'} it"


def _of_fit(summary: ReadingsSummary, called: Callable[[str, str], str]) -> Iterable[str]:
    nearest = summary.nearest
    if len(summary.fits) < 2:
        return
    own = [o for o in summary.outcomes if o.reading == nearest[0]]
    stretches = [
        (o.stretch, called(str(o.claim), o.problem)) for o in own if not isinstance(o.stretch, Why)
    ]
    worst, claim = max(stretches, key=lambda one: abs(log(one[0])))
    breaks = any(o.keeping is Keeping.BREAKS for o in own)
    there = "; as printed, they break the limits" if breaks else ""
    there += "; the velocity jumps" if any(o.jumps for o in own) else ""
    if len(nearest) == len(summary.fits):
        which = "The printed durations are equally far from the limits under every reading"
    else:
        best = under(nearest, summary.admissible, _names(summary), most=3)
        which = f"The printed durations fit best {best}"
    yield (
        f"{which}: multiplied by {worst:.4g}, those of {claim} would just reach the limits, as the "
        f"shortest motion does{there}. This does not say which reading "
        "was meant."
    )


def _of_claims(summary: ReadingsSummary) -> Iterable[str]:
    every = defaultdict(list)
    for tally in summary.claims:
        if tally.scope is Scope.ALL:
            every[tally.verdict].append(tally.claim)
    if every:
        said = "; ".join(f"{verdict} {', '.join(claims)}" for verdict, claims in every.items())
        yield f"Under every reading: {said}."
    some = [
        f"{t.claim} ({', '.join(f'{verdict} {n}' for verdict, n in t.readings.items())})"
        for t in summary.claims
        if t.scope is Scope.SOME
    ]
    if some:
        yield f"Under some: {', '.join(some)}."
    no = [t.claim for t in summary.claims if t.scope is Scope.NO]
    if no:
        yield f"Decided under none: {', '.join(no)}."
