"""TG301: two totals of one path under two velocity limits obey a scaling law, without a solver."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

import numpy as np

from ....problem import CaseError, Problem
from ....problem.cases import AnyClaim, Digits, StatementClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..digit_ranges import off_ratios
from ..printed_row import rows_under
from ..rounding import FEW_ROUNDINGS, ROUNDING
from ..stated import RowClaim, called_under, other_objective
from ..study import Study
from ..words import OPTIMAL, seconds
from .rule_group import Explained, rule_group

TG301 = Explained(
    "TG301",
    "Totals of one path under two velocity limits obey the scaling law",
    "If one path is timed under two velocity limits and nothing else is limited, the shortest "
    "time multiplied by the limit is constant. Do the two printed totals obey this law?",
    "Refuted if both are called optimal and one is longer than the law allows, with the "
    "rounding of way-points, limits and durations taken into account.",
    "At 80 °/s the total is 1.87 s. At 110 °/s the same motion, run faster, takes 1.36 s. "
    "A printed optimum of 1.60 s at 110 °/s is therefore not the shortest.",
    basis=Basis.IDENTITY,
    decides=False,
)


@rule_group(TG301)
def judge_scaling(study: Study) -> Iterator[Finding]:
    """Stretch one claim's durations to another's limits: a feasible total the other can meet."""
    claims = [c for c in study.claims if isinstance(c, RowClaim)]
    statements = study.statements("optimal")
    for slow, fast in permutations(claims, 2):
        if slow.problem == fast.problem or slow.joint != fast.joint:
            continue
        if other_objective(study.case, fast) is not None:
            continue  # its total is not the shortest one, and need not scale
        for reading in study.readings:
            yield from _stretched(study, slow, fast, reading, statements)


def velocity_factor(one: Problem, other: Problem) -> float | None:
    """Factor c that maps feasible durations of ``one`` to feasible ones of ``other``, or None.

    With velocity limits of equal sides only, equal curves and no duration bound in force,
    stretching time by c = V_one/V_other divides every velocity by c: optimum times limit is a
    constant.
    """
    if any(problem.limits.uneven for problem in (one, other)):
        return None
    a, b = one.limits.velocity, other.limits.velocity
    finite = np.isfinite(a)
    same = (
        one.curve == other.curve
        and one.curve.homogeneous
        and np.array_equal(one.waypoints, other.waypoints)
        and np.array_equal(np.array(one.shares), np.array(other.shares))
        and np.array_equal(finite, np.isfinite(b))
    )
    if not same or not (_only_velocity(one) and _only_velocity(other)):
        return None
    if not finite.any() or (b[finite] == 0).any():
        return None
    factors = a[finite] / b[finite]
    return float(factors[0]) if np.ptp(factors) <= FEW_ROUNDINGS * factors[0] else None


def _only_velocity(problem: Problem) -> bool:
    """Whether nothing but the velocity is limited."""
    limits = problem.limits
    return bool(
        not limits.limited[:, 1:].any()
        and not limits.limits_position
        and not (problem.duration_lower > 0).any()
        and not np.isfinite(problem.duration_upper).any()
    )


def _stretched(
    study: Study, source: AnyClaim, target: AnyClaim, reading: str, statements: list[StatementClaim]
) -> Iterator[Finding]:
    posed = [rows_under(study, [c], reading)[:1] for c in (source, target)]
    if not posed[0] or not posed[1]:
        return
    (slow,), (fast,) = posed
    if off_ratios(slow) or off_ratios(fast):
        return  # they are not durations of these questions
    try:
        # Where the digits of the limits allow least, so it holds for all that round to them.
        one = slow.posed(Digits.TIGHTEST)
        other = fast.posed(Digits.TIGHTEST)
    except CaseError:
        return
    factor = velocity_factor(one, other)
    total = fast.total
    durations = slow.durations.value
    feasible = slow.reachable(durations)
    if factor is None or total is None or feasible is None:
        return
    reachable = feasible * factor
    shown, (low, _) = total
    if low <= reachable * (1 + ROUNDING):
        return
    summed = float(durations.sum())
    exact = seconds(summed * factor)
    allowed = seconds(reachable)
    if allowed != exact:
        exact += (
            f", or {allowed} with the rounding of way-points, limits and durations taken into "
            "account"
        )
    places = [called_under(study.case, row.claim, row.problem) for row in (slow, fast)]
    beside = TG301.finding(
        target,
        "not both shortest",
        "With velocity limits only, the shortest time multiplied by the limit is constant, so "
        "the two printed results cannot both be the shortest.",
        f"The durations in {places[0]} sum to {seconds(summed)}.",
        f"Multiplied by {factor:.6g}, the ratio of the two limits, that is {exact}.",
        f"Scaled in this way, they keep the limit of {places[1]}; the {shown} printed there is "
        "longer.",
        verdict=ClaimVerdict.INCONSISTENT,
        problem=fast.problem,
        reading=reading,
        printed=shown,
        computed=seconds(reachable),
        follows=tuple(f"{OPTIMAL} {s.id}" for s in statements if target.id in s.of),
    )
    yield beside
    proof = {"severity": Severity.ERROR, "verdict": ClaimVerdict.REFUTED, "decides": True}
    for statement in statements:
        if target.id in statement.of:
            own = {"claim": statement.id, "root": f"{OPTIMAL} {statement.id}", "follows": ()}
            yield beside.model_copy(update=proof | own)
