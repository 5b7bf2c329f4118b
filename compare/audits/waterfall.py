"""Where the time goes: from a printed total down to what no spline family could beat."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context, Decimal, localcontext
from fractions import Fraction

from ...nlp import Evidence, Solution, proved, stated_exactly
from ...nlp.proofs.any_curve import estimate_any_curve
from ...nlp.retiming import retime
from ...problem import Coupling, down, fit, up
from ...problem.cases import AnyClaim, DurationsClaim, MaximumClaim
from ...verify import Subject
from .study import Study

_ROUNDING = 1e-12


@dataclass(frozen=True)
class Step:
    """One value on the way down.

    Attributes
    ----------
    name : str
    time : float or None
        Total time, s; None if it was not computed, with the reason in ``note``.
    low, high : float or None
        Interval of the value, where it is one.
    evidence : Evidence
        Of the value: best known or certified; none for printed and derived values.
    note : str
    """

    name: str
    time: float | None
    low: float | None
    high: float | None
    evidence: Evidence
    note: str


@dataclass(frozen=True)
class Waterfall:
    """Steps of one problem under one reading, starting from one claim."""

    problem: str
    reading: str
    claim: str | None
    steps: tuple[Step, ...]


def waterfalls(study: Study) -> tuple[Waterfall, ...]:
    """One waterfall per problem and reading of the study."""
    return tuple(_waterfall(study, pid, rid) for pid, rid in study.pairs)


def _starting_claim(study: Study, pid: str) -> AnyClaim | None:
    """The last printed set of durations for all joints of the problem."""
    whole = [
        c
        for c in study.case.claims
        if isinstance(c, DurationsClaim | MaximumClaim)
        and c.problem in (None, pid)
        and (c.joint is None or len(study.problem(pid, study.main_reading).joints) == 1)
    ]
    return whole[-1] if whole else None


def _known(name: str, solution: Solution, note: str = "") -> Step:
    if solution.durations is None:
        return Step(name, None, None, None, Evidence.NONE, solution.why or str(solution.status))
    notes = [n for n in (note, solution.why) if n]
    if solution.infimum is not None:
        notes.append("approached, not attained")
    low = solution.lower_bound
    if low is None:
        return Step(name, solution.best, None, None, solution.evidence, "; ".join(notes))
    notes.append(f"proved, gap {(solution.best - low) / solution.best:.1e}")
    return Step(name, solution.best, low, solution.best, solution.evidence, "; ".join(notes))


def _waterfall(study: Study, pid: str, rid: str) -> Waterfall:
    problem = study.problem(pid, rid)
    claim = _starting_claim(study, pid)
    steps: list[Step] = []
    if claim is not None:
        steps += _published(study, claim, pid, rid)
    if len(problem.joints) > 1 and problem.coupling is Coupling.PER_JOINT:
        steps.append(_procedure(study, pid, rid))
    shared = study.optimum(pid, rid)
    steps.append(_known("optimum of the same curve, shared durations", shared))
    relaxed = study.relaxed(pid, rid)
    steps.append(
        _known("relaxed family", relaxed, "degree 5 or more in every segment, C2, freedom used")
    )
    steps.append(_retimed(relaxed))
    steps.append(_free(study, pid, rid))
    return Waterfall(pid, rid, claim.id if claim is not None else None, tuple(steps))


def _published(study: Study, claim: AnyClaim, pid: str, rid: str) -> list[Step]:
    total = study.claim_total(claim, rid)
    assert total is not None
    shown, (low, high) = total
    number = claim.total if isinstance(claim, DurationsClaim | MaximumClaim) else None
    value = None if number is None else study.case.measured(number, "time", pid, rid).value
    verdict = study.claim_check(claim, pid, rid)
    rounding = study.claim_rounding(claim, pid, rid)
    printed = Step(
        "published",
        verdict.total_time if value is None else value,
        low,
        high,
        Evidence.NONE,
        f"printed {shown}; limits over the rounding box: {rounding.verdict}",
    )
    if verdict.feasible_time is None:
        note = verdict.feasible_why or ""
        return [printed, Step("feasible after repair", None, None, None, Evidence.NONE, note)]
    stretch = verdict.feasible_time / verdict.total_time
    note = f"stretched by {stretch:.6g}" if stretch > 1 else "no repair needed"
    repaired = Step("feasible after repair", verdict.feasible_time, None, None, Evidence.NONE, note)
    return [printed, repaired]


def _procedure(study: Study, pid: str, rid: str) -> Step:
    answer = study.per_joint(pid, rid)
    name = "each joint at its optimum, longest per segment"
    if answer.check is None:
        return Step(name, None, None, None, Evidence.NONE, answer.why or "")
    low = answer.ranges[0].lowest if answer.ranges else None
    high = answer.ranges[0].highest if answer.ranges else None
    note = f"check: {answer.check.verdict}; each joint's optimum {answer.joint_evidence}"
    if answer.ranges:
        note += f"; range while each joint is within {answer.ranges[0].slack:g} s of its optimum"
    return Step(name, answer.total_time, low, high, answer.evidence, note)


def _retimed(relaxed: Solution) -> Step:
    name = "TOPPRA on the path of the relaxed family"
    if relaxed.durations is None:
        return Step(name, None, None, None, Evidence.NONE, "no path")
    problem = relaxed.problem
    trajectory = fit(problem.curve, problem.waypoints, relaxed.durations, relaxed.nodal)
    answer = retime(trajectory, problem.limits)
    if not answer.applicable or answer.extrapolated is None:
        return Step(name, None, None, None, Evidence.NONE, answer.why or "")
    error = answer.error or 0.0
    value = answer.extrapolated
    return Step(
        name,
        value,
        value - error,
        value + error,
        Evidence.BEST_KNOWN,
        f"velocity and acceleration only; extrapolated from {answer.gridpoints} grid points",
    )


def _free(study: Study, pid: str, rid: str) -> Step:
    name = "any curve through the way-points"
    answer = estimate_any_curve(study.problem(pid, rid))
    if answer.total_time is None:
        return Step(name, None, None, None, Evidence.NONE, answer.why or "")
    note = "upper estimate" + (f"; {answer.why}" if answer.why else "")
    exact = stated_exactly(study.case.statement(pid, rid))
    bound = None if exact is None else proved(exact, Subject.ANY)
    # An infimum that is met to the last digit may round to either side of its bound.
    if bound is None or not 0 < bound.lower <= answer.total_time * (1 + _ROUNDING):
        return Step(name, answer.total_time, None, None, answer.evidence, note)
    low = down(bound.lower)
    shown = f"no motion within the limits is shorter than {_below(bound.lower)} s: certified"
    if bound.upper is not None:
        high = up(bound.upper)
        note = f"{shown}, gap {(high - low) / high:.1e}" + (f"; {answer.why}" if answer.why else "")
        return Step(name, high, low, high, Evidence.CERTIFIED, note)
    note += f"; {shown}"
    high = max(low, answer.total_time)
    return Step(name, high, low, high, Evidence.BEST_KNOWN, note)


def _below(value: Fraction) -> str:
    """Six significant digits, rounded down."""
    with localcontext(Context(prec=6, rounding=ROUND_FLOOR)):
        return str(Decimal(value.numerator) / Decimal(value.denominator))
