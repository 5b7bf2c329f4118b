"""TG401 to TG403: claims about algorithms beside seeded replays under the listed choices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np

from ....heuristics import JointRuns, Run
from ....problem.cases import (
    AnyClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    TotalTimeClaim,
)
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ...gaps import SETTLED, settled_at, share_of_luck, share_of_pairs, spread
from ..study import Study


def judge_replays(study: Study) -> Iterator[Finding]:
    """Findings of TG401 to TG403. None of them decides: operators and seeds are not printed."""
    for claim in study.claims:
        if isinstance(claim, ImprovementClaim) and claim.joint is None:
            yield from _improvement(study, claim)
        elif isinstance(claim, MaximumClaim | DurationsClaim | TotalTimeClaim):
            yield from _total(study, claim)
        elif isinstance(claim, ConvergenceClaim):
            yield from _convergence(study, claim)


def _improvement(study: Study, claim: ImprovementClaim) -> Iterator[Finding]:
    names = [study.case.claim(i).algorithm for i in (claim.slower, claim.faster)]
    if None in names or claim.percent is None:
        return
    least = claim.percent.lower / 100
    rid = study.main_reading
    for pid in study.problems:
        if claim.problem not in (None, pid):
            continue
        why = (study.unreplayed(str(name), pid, rid) for name in dict.fromkeys(names))
        if missing := " ".join(reason for reason in why if reason is not None):
            yield _not_replayed("TG401", claim, pid, rid, missing)
            continue
        totals = [study.variant_totals(str(name), pid, rid) for name in names]
        slower, faster = (t["as listed"] for t in totals)
        shows = share_of_pairs(slower, faster, least)
        luck = share_of_luck(slower, least)
        readings = [
            share_of_pairs(a, b, least) for a in totals[0].values() for b in totals[1].values()
        ]
        missed = sum(not share >= 0.5 for share in readings)
        reproduced = missed == 0
        message = (
            f"Over {study.seeds} seeds {names[0]} reaches {spread(slower)} and {names[1]} "
            f"{spread(faster)}. One run against one run shows a reduction of at least "
            f"{100 * least:.4g} % in {100 * shows:.3g} % of the pairs; two runs of {names[0]} "
            f"against each other in {100 * luck:.3g} %. "
        )
        message += (
            "The printed improvement is reproduced in most pairs of every reading."
            if reproduced
            else f"Not reproduced in {missed} of {len(readings)} readings of the algorithms' open "
            "choices (most pairs of runs would have to show it)."
        )
        median = 1 - spread(faster).median / spread(slower).median
        yield Finding(
            rule="TG401",
            severity=Severity.INFO if reproduced else Severity.WARNING,
            verdict=ClaimVerdict.SUPPORTED if reproduced else ClaimVerdict.NOT_CHECKABLE,
            basis=Basis.REPLAY,
            decides=False,
            claim=claim.id,
            problem=pid,
            reading=rid,
            printed=f"{claim.percent} %",
            computed=f"median {100 * median:.3g} %",
            message=message,
        )


def _total(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """The printed total beside the totals of all seeds and variants."""
    rid = study.main_reading
    total = study.claim_total(claim, rid)
    if claim.algorithm is None or total is None:
        return
    shown, (low, high) = total
    for pid, reading in study.claim_pairs(claim):
        problem = study.problem(pid, rid)
        alone = claim.joint is not None and len(problem.joints) > 1
        if reading != rid or alone:
            continue
        missing = study.unreplayed(claim.algorithm, pid, rid)
        if missing is not None:
            yield _not_replayed("TG402", claim, pid, rid, missing, shown)
            continue
        variants = study.variant_totals(claim.algorithm, pid, rid)
        reached = [bool(((t >= low) & (t <= high)).any()) for t in variants.values()]
        beyond = [bool(np.nanmin(t) <= high and np.nanmax(t) >= low) for t in variants.values()]
        missed = sum(not (a or b) for a, b in zip(reached, beyond, strict=True))
        listed = spread(variants["as listed"])
        runs = sum(t.size for t in variants.values())
        message = (
            f"{claim.algorithm} under the listed choices reaches {listed} over {listed.runs} "
            f"seeds; printed is {shown}. "
        )
        message += (
            "The printed total lies within the spread of every reading of the open choices."
            if missed == 0
            else f"Not reproduced in {missed} of {len(variants)} readings of the open choices "
            f"({runs} runs): it lies outside the spread of their totals."
        )
        yield Finding(
            rule="TG402",
            verdict=ClaimVerdict.SUPPORTED if missed == 0 else ClaimVerdict.NOT_CHECKABLE,
            basis=Basis.REPLAY,
            decides=False,
            claim=claim.id,
            problem=pid,
            reading=rid,
            printed=shown,
            computed=f"{listed.lowest:.6f} to {listed.highest:.6f} s",
            message=message,
        )


def _not_replayed(
    rule: str, claim: AnyClaim, pid: str, rid: str, why: str, printed: str | None = None
) -> Finding:
    return Finding(
        rule=rule,
        basis=Basis.REPLAY,
        decides=False,
        claim=claim.id,
        problem=pid,
        reading=rid,
        printed=printed,
        message=why,
    )


def _traces(runs: Sequence[Run] | Sequence[JointRuns]) -> list[Run]:
    return list(chain.from_iterable(r.runs if isinstance(r, JointRuns) else (r,) for r in runs))


def _convergence(study: Study, claim: ConvergenceClaim) -> Iterator[Finding]:
    rid = study.main_reading
    if claim.algorithm is None:
        return
    for pid in study.problems:
        if claim.problem not in (None, pid):
            continue
        missing = study.unreplayed(claim.algorithm, pid, rid)
        if missing is not None:
            yield _not_replayed("TG403", claim, pid, rid, missing)
            continue
        runs = _traces(study.runs(claim.algorithm, pid, rid))
        settled = np.array([settled_at(r.trace, SETTLED * r.trace[-1]) for r in runs])
        within = float((settled <= claim.iterations.value).mean())
        supported = within >= 0.5
        message = (
            f"In {100 * within:.3g} % of {len(runs)} replays under the listed choices the "
            f"best-so-far is within {100 * SETTLED:g} % of its final value by iteration "
            f"{claim.iterations} (median {np.median(settled):.0f})."
        )
        if not supported:
            message += " Not reproduced in the listed reading."
        yield Finding(
            rule="TG403",
            verdict=ClaimVerdict.SUPPORTED if supported else ClaimVerdict.NOT_CHECKABLE,
            basis=Basis.REPLAY,
            decides=False,
            claim=claim.id,
            problem=pid,
            reading=rid,
            printed=f"{claim.iterations} iterations",
            computed=f"median {np.median(settled):.0f} iterations",
            message=message,
        )
