"""Where the time goes: from a printed total down to what no spline family could beat."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from ...nlp import Evidence, Route, Solution, Status, printed_problem_or_none
from ...nlp.proofs import bound_any_curve
from ...nlp.proofs.any_curve import estimate_any_curve
from ...nlp.retiming import jerk_limited_path, retime, retime_third_order
from ...problem import down, fit, shown_bound, up
from ...problem.cases import AnyClaim, TimeClaim, TotalTimeClaim
from ..documents import (
    ALONG_PATH,
    EXACT,
    FREED_OPTIMUM,
    OPTIMUM_RETIMED,
    OWN_OPTIMA,
    PUBLISHED,
    RATIOS_OPTIMUM,
    RELAXED_RETIMED,
    SHARED_OPTIMUM,
    STAND_IN_OPTIMUM,
    THIRD_ORDER,
    Step,
    Waterfall,
    Why,
    enumerated,
    known,
)
from .digit_ranges import off_ratios, optimum_range, planned_apart
from .own_result import bare_totals, own_result
from .path_times import path_time
from .printed_row import PrintedRow
from .rounding import FEW_ROUNDINGS
from .stated import RowClaim, other_objective, timed_along_path
from .study import Pair, Study
from .words import seconds


def waterfalls(study: Study) -> tuple[Waterfall, ...]:
    """One waterfall per problem and reading of the study."""
    return tuple(_waterfall(study, pair) for pair in study.pairs)


def _starting_claim(study: Study, problem: str) -> AnyClaim | None:
    """The printed time of all joints that the paper calls its result.

    Durations where they are printed of a result; else a bare total, which says nothing of limits.
    """
    pair = Pair(problem, study.main_reading)
    whole = [
        c
        for c in study.case.claims
        if isinstance(c, RowClaim)
        and study.fits(c, pair)
        and (c.joint is None or len(study.problem(pair).joints) == 1)
    ]
    found = own_result(study.case, whole)
    if found is not None and found.state != "before":
        return found
    bare = [c for c in bare_totals(study.case, problem) if c.state is None and c.of is None]
    return own_result(study.case, bare) or found


def _known(name: str, solution: Solution, note: str = "") -> Step:
    if not solution.found:
        return Step.missing(name, solution.why or str(solution.status))
    if solution.boundless is not None:
        return Step.missing(name, solution.boundless)
    notes = [n for n in (note, solution.why, *routes(solution)) if n]
    if solution.infimum is not None:
        notes.append("approached, not attained")
    low, best = solution.lower_bound, solution.best
    ends: dict[str, Any] = {}
    if low is not None:
        notes.append(f"proved, gap {(best - low) / best:.1e}")
        ends = {"low": low, "high": best}
    evidence = solution.evidence
    return Step(name=name, time=best, evidence=evidence, note="; ".join(notes), **ends)


_FOUND = {Route.NLP: "the NLP (IPOPT)", Route.DESCENT: "descents", Route.CLOSED_FORM: "a formula"}
"""Words for what found a total."""


def routes(solution: Solution) -> tuple[str, ...]:
    """What found the total, and by how much the total of the other route differs."""
    if solution.route is None:
        return ()
    found = f"by {_FOUND[solution.route]}"
    if solution.other_total is None:
        return (found,)
    other = Route.DESCENT if solution.route is Route.NLP else Route.NLP
    longer = solution.other_total / solution.total_time - 1.0  # below 0 where it is shorter
    return found, f"{_FOUND[other]}: {longer:+.0e} of it"


def _waterfall(study: Study, pair: Pair) -> Waterfall:
    problem = study.problem(pair)
    if timed_along_path(study.case, pair.problem):
        return _along_path(study, pair)
    claim = _starting_claim(study, pair.problem)
    steps: list[Step] = []
    if claim is not None:
        steps += _published(PrintedRow(study, claim, pair))
    if planned_apart(problem):
        steps.append(_procedure(study, pair))
    shared = study.optimum(pair)
    own = SHARED_OPTIMUM if problem.ratios is None else RATIOS_OPTIMUM
    steps.append(_known(STAND_IN_OPTIMUM if stands_in(study) else own, shared))
    steps.append(_retimed(OPTIMUM_RETIMED, shared))
    if problem.ratios is not None:
        steps.append(_known(FREED_OPTIMUM, _converged(study.freed(pair))))
    relaxed = _converged(study.relaxed(pair))
    note = "degree 5 or more in every segment, C2, remaining freedom optimised"
    steps.append(_known("relaxed family", relaxed, note))
    steps.append(_retimed(RELAXED_RETIMED, relaxed))
    steps.append(_free(study, pair))
    longest = None if claim is None else optimum_range(PrintedRow(study, claim, pair)).upper
    return Waterfall(
        problem=pair.problem,
        reading=pair.reading,
        claim=claim.id if claim is not None else None,
        steps=tuple(steps),
        longest_optimum=known(longest, "not bounded"),
    )


def _along_path(study: Study, pair: Pair) -> Waterfall:
    """The first printed total along a path, and the shortest time on it."""
    along = [c for c in study.case.claims if isinstance(c, TotalTimeClaim) and c.along_path]
    claim = next(c for c in along if c.problem in (None, pair.problem))
    row = PrintedRow(study, claim, pair)
    best = path_time(row)
    shortest = Step.missing(ALONG_PATH, best.why or "no motion was found")
    if np.isfinite(best.upper):
        shortest = Step(
            name=ALONG_PATH,
            time=best.upper,
            low=best.lower,
            high=best.upper,
            evidence=Evidence.BEST_KNOWN,
            note="a checked motion; no motion is shorter than the lower end",
        )
    return Waterfall(
        problem=pair.problem,
        reading=pair.reading,
        claim=claim.id,
        steps=(*_published(row), shortest),
        longest_optimum=known(best.upper if np.isfinite(best.upper) else None, "not bounded"),
    )


def stands_in(study: Study) -> bool:
    """Whether times are printed, and none of them is of the curve that the case file declares."""
    timed = [c for c in study.case.claims if isinstance(c, TimeClaim)]
    return bool(timed) and all(
        c.other_curve is not None or getattr(c, "profile", None) is not None for c in timed
    )


def _converged(solution: Solution) -> Solution:
    """The solution, without its answer if the search did not converge."""
    if solution.evidence is not Evidence.UNCONVERGED:
        return solution
    why = f"the search did not converge ({solution.why}): no optimum of this family is known"
    return Solution(solution.problem, Status.FAILED, why)


def _published(row: PrintedRow[AnyClaim]) -> list[Step]:
    claim = row.claim
    total = row.total
    assert total is not None
    shown, (low, high) = total
    if isinstance(claim, TotalTimeClaim):
        time = row.measured(claim.value, "time").value
        note = f"printed {shown} without durations{_beside(row)}"
        return [Step(name=PUBLISHED, time=time, low=low, high=high, note=note)]
    number = claim.total if isinstance(claim, RowClaim) else None
    value = None if number is None else row.measured(number, "time").value
    why = row.unmoved
    if why is not None:
        time = row.durations.value.sum() if value is None else value
        note = f"printed {shown}{_beside(row)}"
        alone = Step(name=PUBLISHED, time=time, low=low, high=high, note=note)
        return [alone, Step.missing("feasible after repair", why)]
    verdict = row.check
    rounding = row.rounding
    printed = Step(
        name=PUBLISHED,
        time=verdict.total_time if value is None else value,
        low=low,
        high=high,
        note=f"printed {shown}{_beside(row)}; limits, however "
        f"the digits were rounded: {rounding.verdict}",
        keeping=row.keeping,
    )
    if verdict.feasible_time is None:
        note = verdict.feasible_why or ""
        return [printed, Step.missing("feasible after repair", note)]
    stretch = verdict.feasible_time / verdict.total_time
    if stretch > 1:
        note = f"stretched by {stretch:.6g}"
        return [printed, Step(name="feasible after repair", time=verdict.feasible_time, note=note)]
    # A total that is printed beside its parts may be another one, within their rounding.
    if value is None or abs(verdict.total_time - value) <= FEW_ROUNDINGS * value:
        return [printed]
    summed = Step(
        name="sum of the printed durations", time=verdict.total_time, note="no repair needed"
    )
    return [printed, summed]


def _beside(row: PrintedRow[AnyClaim]) -> str:
    """Why a printed total is not one of the steps below it, where it is not."""
    objective = other_objective(row.study.case, row.claim)
    said = "" if objective is None else f", not minimised for time alone: {objective}"
    other = off_ratios(row)
    return said if other is None else f"{said}; {other}"


def _procedure(study: Study, pair: Pair) -> Step:
    answer = study.per_joint(pair)
    name = OWN_OPTIMA
    if answer.check is None:
        return Step.missing(name, answer.why or "")
    boundless = [joint.boundless for joint in answer.joints]
    if boundless[0] is not None and None not in boundless:
        return Step.missing(name, boundless[0])
    note = f"check: {answer.check.verdict}; " + (
        "the search of some joint did not converge"
        if answer.joint_evidence is Evidence.UNCONVERGED
        else f"the optimum of each joint is {answer.joint_evidence}"
    )
    low: float | Why = EXACT
    high: float | Why = EXACT
    if answer.ranges:
        low, high = answer.ranges[0].lowest, answer.ranges[0].highest
        note += (
            f"; the range holds while each joint stays within "
            f"{seconds(answer.ranges[0].slack, 'g')} of its optimum"
        )
    return Step(
        name=name, time=answer.total_time, low=low, high=high, evidence=answer.evidence, note=note
    )


def _retimed(name: str, solution: Solution) -> Step:
    """The shortest time along the path of a solution, whatever curve times it."""
    if not solution.found:
        return Step.missing(name, "no path")
    if solution.boundless is not None:
        return Step.missing(name, "there is no shortest motion, so no path")
    problem = solution.problem
    trajectory = fit(problem.curve, problem.waypoints, solution.durations, solution.nodal)
    if name == OPTIMUM_RETIMED and jerk_limited_path(trajectory, problem.limits):
        time, cells = retime_third_order(trajectory, problem.limits)
        if time is None:
            return Step.missing(name, "jerk is limited, and no timing of its path was found")
        return Step(
            name=THIRD_ORDER,
            time=time,
            note=f"an estimate: limits hold at the ends of {cells} cells, but not necessarily "
            "between them",
        )
    answer = retime(trajectory, problem.limits)
    if not answer.applicable or answer.extrapolated is None:
        return Step.missing(name, answer.why or "")
    error = answer.error or 0.0
    value = answer.extrapolated
    return Step(
        name=name,
        time=value,
        low=value - error,
        high=value + error,
        evidence=Evidence.BEST_KNOWN,
        note="velocity and acceleration only; extrapolated from grids of "
        f"{enumerated(answer.gridpoints)} points",
    )


def _free(study: Study, pair: Pair) -> Step:
    name = "any curve through the way-points"
    answer = estimate_any_curve(study.problem(pair))
    exact = printed_problem_or_none(study.case.statement(*pair))
    bound = None if exact is None else study.intervals.any_curve(exact)
    lower, how, optimum = Fraction(0), "certified", study.optimum(pair)
    if bound is not None:
        lower = bound.lower
    elif exact is not None and optimum.found:
        lower, how = bound_any_curve(optimum, exact), "proved"
    least = shown_bound(lower, "lower")
    shown = f"; no motion within the limits is shorter than {least} s: {how}" if lower > 0 else ""
    if answer.total_time is None:
        return Step.missing(name, f"{answer.why or 'no estimate'}{shown}")
    also = f"; {answer.why}" if answer.why else ""
    note, low, high = f"upper estimate{also}", down(lower), answer.total_time
    # An infimum that is met to the last digit may round to either side of its bound.
    if not 0 < lower <= high * (1 + FEW_ROUNDINGS):
        return Step(name=name, time=high, evidence=answer.evidence, note=note)
    known, high, note = Evidence.BEST_KNOWN, max(low, high), f"{note}{shown}"
    if bound is not None and bound.upper is not None:
        known, high = Evidence.CERTIFIED, up(bound.upper)
        note = f"{shown[2:]}, gap {(high - low) / high:.1e}{also}"
    return Step(name=name, time=high, low=low, high=high, evidence=known, note=note)
