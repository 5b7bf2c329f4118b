"""The readings of a case side by side, in words."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from math import log

from ...nlp import Evidence, weakest
from ..documents import (
    Excess,
    Gap,
    Keeping,
    Named,
    ReadingOutcome,
    ReadingsSummary,
    Scope,
    Why,
    under,
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
            f"Under none of {len(summary.admissible)} readings can limits, optimum or gap be "
            f"computed, since {summary.outcomes_why}."
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
        yield f"{called(claim, problem)}: the limits are {said}.{_of_gaps(own, summary)}"


def _names(summary: ReadingsSummary) -> Named:
    return Named(summary.labels, summary.implausible, summary.default)


def _of_gaps(own: Sequence[ReadingOutcome], summary: ReadingsSummary) -> str:
    """How far the printed total is from the optimum, where the limits are kept and where not."""
    plain = [o for o in own if o.reading not in summary.implausible]
    kept = [o for o in plain if o.keeping in (Keeping.KEEPS, Keeping.CONSISTENT)]
    parts = []
    for group, where in (
        (kept, " where the limits are kept"),
        ([o for o in plain if o not in kept], " elsewhere" if kept else ""),
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
    return f" Printed total beside the {beside}: {', and '.join(parts)}{without}." if parts else ""


def _away(low: float, high: float) -> str:
    """How far totals are from an optimum, as a share of it or as a multiple."""
    ends = [_end(low), _end(high)]
    numbers, words = zip(*ends, strict=True)
    if ends[0] == ends[1]:
        return " ".join(ends[0])
    if words[0] == words[1]:
        return f"{' to '.join(numbers)} {words[0]}"
    return " to ".join(" ".join(end) for end in ends)


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
    there = [
        *(
            ["as printed, they break the limits"]
            if any(o.keeping is Keeping.BREAKS for o in own)
            else []
        ),
        *(["the velocity jumps"] if any(o.jumps for o in own) else []),
    ]
    if len(nearest) == len(summary.fits):
        which = "The printed durations lie alike under every reading"
    else:
        best = under(nearest, summary.admissible, _names(summary), most=3)
        which = f"The printed durations fit best {best}"
    yield (
        f"{which}: multiplied by {worst:.4g}, those of {claim} would just reach the limits, as the "
        f"shortest motion does{''.join(f'; {x}' for x in there)}. This does not say which reading "
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
