"""TG401 to TG403: claims about algorithms beside seeded replays under the listed choices."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from ....heuristics import JointRuns
from ....problem import Array
from ....problem.cases import (
    AnyClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    StatementClaim,
    TotalTimeClaim,
)
from ...documents import Basis, Finding, capital, ranged
from ...gaps import (
    SETTLED,
    Spread,
    settled_at,
    share_interval,
    share_of_luck,
    share_of_pairs,
    spread,
)
from ..kept_answers import Replays
from ..printed_row import PrintedRow, rows_under
from ..replay_settings import LISTED
from ..stated import other_objective
from ..study import Pair, Study
from ..words import percent, seconds
from .rule_group import INFORMS, Explained, rule_group

_TOLERANCES = (SETTLED, 5 * SETTLED)
"""Shares of the final total within which a run counts as converged; a claim names none."""


TG401 = Explained(
    "TG401",
    "An improvement compared with the spread over seeds",
    "How likely is a printed improvement if each algorithm is run once? Both are run "
    "again with many seeds.",
    INFORMS + " Operators, seeds and some settings are not printed, so a replay is never a proof.",
    "In 100 runs each, one run of B beats one run of A by at least 10 % in 4 % of the pairs.",
    basis=Basis.REPLAY,
    decides=False,
)
TG402 = Explained(
    "TG402",
    "A printed total compared with replays of its algorithm",
    "Where does a printed total lie among runs of the algorithm that found it?",
    INFORMS + " The report names the settings under which the printed total is typical.",
    "3.53 s is printed. With an inertia weight of 0.65 the median is 3.30 s, with 1.0 it "
    "is 3.51 s.",
    basis=Basis.REPLAY,
    decides=False,
)
TG403 = Explained(
    "TG403",
    "Convergence within a number of iterations, compared with replays",
    "Do runs of the algorithm settle within the printed number of iterations?",
    INFORMS + " The share of runs is given at two tolerances, because papers name none.",
    "By iteration 60, 27 % of the runs are within 0.1 % of their final value, and 86 % "
    "within 0.5 %.",
    basis=Basis.REPLAY,
    decides=False,
)


@rule_group(TG401, TG402, TG403)
def judge_replays(study: Study) -> Iterator[Finding]:
    """Findings of TG401 to TG403: information, for operators and seeds are not printed."""
    for claim in study.claims:
        if isinstance(claim, ImprovementClaim) and claim.joint is None:
            yield from _improvement(study, claim)
        elif isinstance(claim, MaximumClaim | DurationsClaim | TotalTimeClaim):
            yield from _total(study, claim)
        elif isinstance(claim, ConvergenceClaim):
            yield from _convergence(study, claim)
        elif isinstance(claim, StatementClaim) and claim.against is not None:
            yield from _compared(study, claim, claim.against)


def _pairs(study: Study, claim: AnyClaim) -> list[Pair]:
    """The problems that a claim may speak about, under the main reading."""
    return [pair for pair in study.main_pairs if claim.problem in (None, pair.problem)]


def _totals(runs: Replays) -> Array:
    return np.array([r.reported_time for r in runs])


def _improvement(study: Study, claim: ImprovementClaim) -> Iterator[Finding]:
    """How likely one run against one run shows the printed improvement, and at which settings."""
    names = [study.case.claim(i).algorithm for i in (claim.slower, claim.faster)]
    if None in names or claim.percent is None:
        return
    least = claim.percent.lower / 100
    for pair in _pairs(study, claim):
        spreads = [study.spread_runs(str(name), pair) for name in names]
        if not spreads[0] or not spreads[1]:
            continue
        one, other = (study.called(str(name)) for name in names)
        totals = [{name: _totals(runs) for name, runs in each.items()} for each in spreads]
        slower, faster = (t[LISTED] for t in totals)
        shows = share_of_pairs(slower, faster, least)
        low, high = share_interval(slower, faster, least)
        # Resampling the same runs shows no event that none of them shows.
        sure = interval_words(low, high)
        sure = f"in none of the {slower.size * faster.size} pairs" if shows == 0 else sure
        luck = share_of_luck(slower, least)
        each = {
            (a, b): share_of_pairs(x, y, least)
            for a, x in totals[0].items()
            for b, y in totals[1].items()
        }
        most = max(each, key=lambda pair: -1.0 if np.isnan(each[pair]) else each[pair])
        said = [
            f"In {study.options.seeds} independent runs each, {one} reaches {spread(slower)} and "
            f"{other} reaches {spread(faster)} under the listed choices.",
            f"One run of {other} is at least {percent(least, '.4g')} shorter than one of {one} "
            f"with probability {percent(shows)} ({sure}). For two runs of {one}, this probability "
            f"is {percent(luck)}.",
        ]
        if len(each) > 1:
            said.append(
                f"With everything that the text leaves open varied together ({len(totals[0])} and "
                f"{len(totals[1])} settings), the probability is at most {percent(each[most])}: "
                f"at {_at(one, most[0])}; {_at(other, most[1])}."
            )
        median = 1 - spread(faster).median / spread(slower).median
        known = {"printed": f"{claim.percent} %", "computed": f"median {percent(median)}"}
        yield TG401.finding(PrintedRow(study, claim, pair), "runs", *said, **known)


def interval_words(low: float, high: float) -> str:
    """A 95 % interval of a probability, or that there is none."""
    if np.isnan(low) or np.isnan(high):
        return "too few runs with an answer for an interval"
    return f"95 % interval {percent(low)} to {percent(high)}"


def _at(name: str, setting: str) -> str:
    return f"{name} {setting}" if setting == LISTED else f"{name} with {setting}"


def _compared(study: Study, claim: StatementClaim, against: str) -> Iterator[Finding]:
    """Two algorithms that a sentence compares: totals, and how soon a run has settled."""
    own, other = study.called(str(claim.algorithm)), study.called(against)
    seeds = study.options.seeds
    for pair in _pairs(study, claim):
        each = (str(claim.algorithm), against)
        runs = {study.called(one): study.runs(one, pair) for one in each}
        if not all(runs.values()):
            continue
        totals = {name: _totals(found) for name, found in runs.items()}
        shorter = share_of_pairs(totals[other], totals[own], 0.0)
        low, high = share_interval(totals[other], totals[own], 0.0)
        settled = "; ".join(
            f"{name} stays within {percent(tolerance, 'g')} of its final total from iteration "
            f"{int(np.median(_settled(found, tolerance)))} onwards (median)"
            for tolerance in _TOLERANCES
            for name, found in runs.items()
        )
        yield TG401.finding(
            PrintedRow(study, claim, pair),
            "runs",
            f"In {seeds} independent runs each under the listed choices, {own} reaches "
            f"{spread(totals[own])} and {other} reaches {spread(totals[other])}; one run "
            f"of {own} is no longer than one of {other} with probability {percent(shorter)} "
            f"({interval_words(low, high)}): {settled}.",
            computed=f"shorter in {percent(shorter)} of the pairs",
        )


def _total(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """The printed total beside the runs under the listed choices and under spread settings."""
    total = study.claim_total(claim, study.main_reading)
    assert total is not None
    if claim.algorithm is None:
        return
    shown, (low, high) = total
    for row in rows_under(study, [claim], study.main_reading):
        pair = row.pair
        if claim.joint is not None and len(study.problem(pair).joints) > 1:
            continue
        found = partial(TG402.finding, row, printed=shown)
        runs = study.spread_runs(claim.algorithm, pair)
        if not runs:
            yield found("not replayed", study.unreplayed(claim.algorithm, pair) or "")
            continue
        minimised = other_objective(study.case, claim)
        if minimised is not None:
            yield found(
                "other objective",
                f"A replay minimises time alone, but {shown} was minimised for {minimised}, so the "
                "two are not compared.",
            )
            continue
        spreads = {name: spread(_totals(one)) for name, one in runs.items()}
        listed = spreads[LISTED]
        yield found(
            "runs",
            f"{capital(study.called(claim.algorithm))} under the listed choices reaches "
            f"{listed} in {listed.runs} independent runs; the printed total is {shown}.",
            *_typical(spreads, low, high),
            computed=f"{ranged(listed.lowest, listed.highest, '.6f')} s",
        )


def _typical(spreads: dict[str, Spread], low: float, high: float) -> Iterator[str]:
    """For which settings a printed total is typical: those an author would point at."""
    medians = {name: s.median for name, s in spreads.items() if np.isfinite(s.median)}
    if len(medians) < 2:
        return
    off = {name: max(low - m, m - high, 0.0) for name, m in medians.items()}
    nearest = min(off, key=lambda name: off[name])
    inside = [n for n, s in spreads.items() if s.lowest <= high and s.highest >= low]
    yield (
        f"With everything that the text leaves open varied together ({len(medians)} settings), "
        f"medians are {ranged(min(medians.values()), max(medians.values()), '.4f')} s; the nearest "
        f"to the printed total is {seconds(medians[nearest], '.4f')}, with {nearest}."
    )
    if inside:
        return
    answered = [s for s in spreads.values() if np.isfinite(s.lowest)]
    if all(s.lowest > high for s in answered):
        yield "Every run under every one of these settings is longer."
    elif all(s.highest < low for s in answered):
        yield "Every run under every one of these settings is shorter."
    else:
        yield (
            "Under each of these settings, all runs are shorter or all are longer than the "
            "printed total."
        )


def _settled(runs: Replays, tolerance: float) -> NDArray[np.intp]:
    """The iteration from which each run stays within a share of its final value."""
    each = chain.from_iterable(r.runs if isinstance(r, JointRuns) else (r,) for r in runs)
    return np.array([settled_at(r.trace, tolerance * r.trace[-1]) for r in each])


def _convergence(study: Study, claim: ConvergenceClaim) -> Iterator[Finding]:
    """How many runs settle in time, under every setting, and how much the tolerance changes it."""
    if claim.algorithm is None:
        return
    for pair in _pairs(study, claim):
        row = PrintedRow(study, claim, pair)
        found = partial(TG403.finding, row, printed=f"{claim.iterations} iterations")
        runs = study.spread_runs(claim.algorithm, pair)
        if not runs:
            yield found("not replayed", study.unreplayed(claim.algorithm, pair) or "")
            continue
        parts: list[str] = []
        spans: list[str] = []
        for tolerance in _TOLERANCES:
            within = {
                name: float((_settled(one, tolerance) <= claim.iterations.value).mean())
                for name, one in runs.items()
            }
            share = f"{percent(within[LISTED])}{'' if parts else ' of the runs'}"
            parts.append(f"{share} lie within {percent(tolerance, 'g')}")
            spans.append(f"{percent(min(within.values()))} to {percent(max(within.values()))}")
        varied = ""
        if len(runs) > 1:
            varied = (
                f"Over {len(runs)} settings of what the text leaves open these shares "
                f"range from {' and from '.join(spans)}."
            )
        settled = _settled(runs[LISTED], SETTLED)
        yield found(
            "runs",
            f"After {claim.iterations} iterations {parts[0]} of their final value, and "
            f"{parts[1]}, counted over {settled.size} runs under the listed choices.",
            varied,
            "The text names no tolerance.",
            computed=f"median {np.median(settled):.0f} iterations",
        )
