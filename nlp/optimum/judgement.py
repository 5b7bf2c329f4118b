"""From local optima to an answer: the checker's word, the optimality conditions, the status."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...problem import QUANTITIES, TOLERANCE, Array, Problem, Verdict, check
from .decided import Local, decided, stretched
from .optimality import KKT, KKT_TOLERANCE, SHARP, UNKNOWN, kkt, sharpened
from .solution import Route, Solution, Status
from .starts import DENSE

BETTER = 1e-7
"""Relative gain from which a basin or a known motion is worth a further descent."""


def better_of(one: Solution, other: Solution) -> Solution:
    """The first of two answers, unless the second is shorter, or as short and better founded.

    The time to build of the first, and iterations of both, go with the second.
    """
    if not other.found:
        return one
    shorter = other.best < one.best * (1 - BETTER)
    founded = other.best <= one.best * (1 + BETTER) and other.settled and not one.settled
    if one.found and not shorter and not founded:
        return one
    iterations = one.iterations + other.iterations
    return replace(other, build_seconds=one.build_seconds, iterations=iterations)


SAME_TOTAL = 1e-6
"""Relative difference below which two totals count as the same."""
ROUNDED = 2.0 * TOLERANCE
"""Relative difference of totals that the checker's tolerance makes: of both ends at most."""
HIDDEN = 1e-4
"""Excess over a limit that rounding hides from a search where durations differ by many powers of
ten: 2e-5 was seen. What exceeds its limits by more was not searched to its end."""
_ON_FLOOR = 1.01
"""Durations over a made-up least one up to which it counts as met: interior points end beside it,
and floors lie orders of magnitude below durations that any limit asks for."""


def judged(
    problem: Problem, found: list[Local], floor: Array, starts: int, route: Route = Route.DESCENT
) -> Solution:
    """The best of the ends of all starts that the checker passes, with its optimality conditions.

    The floor, s, is the least durations that the search made up; 0 where the problem sets one.
    """
    iterations = sum(local.iterations for local in found)
    found = [_past_rounding(problem, local) for local in found]
    feasible = [local for local in found if local.feasible]
    if not feasible:
        status, why = _nothing_found(found)
        return Solution(problem, status, why, starts=starts, iterations=iterations)
    shortest = min(local.total for local in feasible)
    # Of ends that are the same to rounding, one that met its conditions.
    alike = [local for local in feasible if local.total <= shortest * (1 + ROUNDED)]
    best = min(alike, key=lambda local: (not local.converged, local.total))
    # Where rounding decides, the conditions hold at the tight motion, and a longer one passes.
    tight, nodal = best.tight or (best.durations, best.nodal)
    report = best.report if best.tight is None else None
    dense, fixed = problem.segments <= DENSE, problem.ratios is not None
    if report is None:
        report = kkt(problem, tight, nodal) if dense or fixed else UNKNOWN
    answer = best
    if report.residual > SHARP and dense and not (problem.curve.free or fixed):
        answer, report = _sharper(problem, tight, report) or (best, report)
    beyond = 0.0 if answer.tight is None else max(0.0, answer.total / float(tight.sum()) - 1.0)
    notes = [] if report.unmet is None else [report.unmet]
    status = Status.FEASIBLE if notes or beyond > SAME_TOTAL else Status.CONVERGED
    if beyond > KKT_TOLERANCE:
        longer = f"longer by {beyond:.1e} (relative) than a tight motion"
        notes += [f"{longer}, within rounding errors"]
    if answer.verdict.verdict is Verdict.DISCONTINUOUS:
        orders = [jump.order for jump in answer.verdict.jumps]
        lowest = max(1, min(orders))
        jumps = f"{sum(r <= lowest for r in orders)} jumps of {QUANTITIES[lowest - 1]}"
        notes += [f"limits kept inside the segments; {jumps} between them"]
    falling = still_falling(answer.durations, floor)
    if falling is not None:
        status, notes = Status.NOT_ATTAINED, [falling]
    return Solution(
        problem,
        status,
        "; ".join(notes) or None,
        vector=answer.durations,
        nodal=answer.nodal,
        check=answer.verdict,
        route=route,
        kkt_residual=report.residual if np.isfinite(report.residual) else None,
        active=report.active,
        starts=starts,
        starts_at_best=sum(local.total <= best.total * (1 + SAME_TOTAL) for local in feasible),
        iterations=iterations,
        build_seconds=sum(local.build_seconds for local in found),
        totals=tuple(local.total if local.feasible else float("inf") for local in found),
    )


def _sharper(problem: Problem, durations: Array, report: KKT) -> tuple[Local, KKT] | None:
    """An answer sharpened by Newton steps, where it stays as short, within limits, and smooth."""
    h = sharpened(problem, durations)
    stretch = np.inf if h is None else check(problem, h).stretch
    if h is None or not stretch <= 1 + ROUNDED:
        return None
    h = np.clip(h * max(1.0, stretch), problem.duration_lower, problem.duration_upper)
    passing = stretched(problem, h, None)  # rounding may blur the very optimum
    if passing is None or passing.total > durations.sum() * (1 + ROUNDED):
        return None
    better = kkt(problem, passing.durations)
    return (passing, better) if better.residual < report.residual else None


def on_floor(durations: Array, floor: Array) -> NDArray[np.bool_]:
    """Which durations, s, lie on a least one that the search made up, shape (segments,)."""
    return (floor > 0) & (durations <= _ON_FLOOR * floor)


def still_falling(durations: Array, floor: Array) -> str | None:
    """Why an answer is not the shortest motion, if a duration lies on a least one of the search."""
    names = ", ".join(str(k + 1) for k in np.flatnonzero(on_floor(durations, floor)).tolist())
    return f"the total falls as the duration of segment {names} goes to 0" if names else None


def _past_rounding(problem: Problem, local: Local) -> Local:
    """The end of a search, moved inside limits that rounding hid from it, if that makes it pass."""
    verdict = local.verdict
    hidden = verdict.limits is Verdict.UNDECIDED or verdict.max_violation <= HIDDEN
    if local.feasible or not hidden:
        return local
    found = decided(problem, local.durations, local.nodal)
    if found is None:
        return local
    return replace(found, converged=local.converged, iterations=local.iterations)


def _nothing_found(found: list[Local]) -> tuple[Status, str]:
    judgements = [local.verdict for local in found]
    least = min(judgements, key=lambda one: one.max_violation, default=None)
    worst = float("inf") if least is None else least.max_violation
    why = (
        f"no feasible durations found from {len(found)} starts; the least excess over a limit was "
        f"{worst:.3g} (relative). This is local evidence, not a proof"
    )
    if any(one.limits is Verdict.PASS for one in judgements):
        why = "the limits can be kept inside the segments, but between them the motion jumps; "
        why += f"no durations without a jump found from {len(found)} starts"
    return Status.NONE_FOUND, why
