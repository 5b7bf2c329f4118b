"""Cases on which a careless rule would accuse a sound paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.findings import audited_text, verdicts
from support.made_up import gain, paper, row, sentence, total
from support.one_joint import UNITS, one_joint
from trajgap.compare import audit
from trajgap.compare.documents import Basis, ClaimVerdict, Scope, Severity
from trajgap.nlp import Evidence, Status, solve
from trajgap.problem import Limits, Problem, cubic_spline, load_case

SUPPORTED, REFUTED, OPEN = (
    ClaimVerdict.SUPPORTED,
    ClaimVerdict.REFUTED,
    ClaimVerdict.NOT_CHECKABLE,
)


@pytest.mark.parametrize(
    ("points", "limit", "time", "checks", "verdict"),
    [
        # 7.125 s is exactly optimal from -0.4 to 3.4, which print as 0 and 3.
        ('"0", "3"', "1", "7.125", "optimal", OPEN),
        # The optimum 0.961736 s with its digits cut off.
        ("0, 1", "1.9496", "0.961", "within_limits", SUPPORTED),
        # What is plainly broken is still refuted.
        ("0, 1", "1.9496", "0.95", "within_limits", REFUTED),
        ("0, 1", "1.9496", "1.2", "optimal", REFUTED),
    ],
)
def test_digits_are_given_their_due_and_no_more(
    points: str, limit: str, time: str, checks: str, verdict: ClaimVerdict
) -> None:
    one = audited_text(one_joint(points, limit, time, checks))
    assert verdicts(one)["s"] is verdict
    assert (verdicts(one)["d"] is REFUTED) == (time == "0.95")
    assert any(f.severity is Severity.ERROR for f in one.findings) == (verdict is REFUTED)


def test_durations_of_which_nothing_is_said_break_nothing() -> None:
    """Equal durations before an optimisation are no answer, and nobody says they keep a limit."""
    text = one_joint("0, 1", "1.9496", "0.962", "within_limits", row("other", "0.5"))
    one = audited_text(text)
    assert {f.severity for f in one.findings} == {Severity.INFO}
    assert verdicts(one) == {"d": SUPPORTED, "s": SUPPORTED, "other": OPEN}
    (beside,) = [f for f in one.findings if f.rule == "TG201" and f.claim == "other"]
    assert not beside.decides
    assert "A limit is broken" in beside.message
    assert beside.message.endswith("Nothing printed says that these durations keep the limits.")
    named = audited_text(text.replace('of = ["d"]', 'of = ["d", "other"]'))
    assert verdicts(named)["other"] is REFUTED


def test_a_percentage_of_a_refuted_total_says_why_it_is_not_checkable() -> None:
    """0.962 s beside a total of 0.99 s; 1.2 s is 17.5 % longer than that."""
    parts = (
        row("d", "0.962", total="0.990", where="Table 2"),
        sentence("s", "within_limits", "d"),
        total("old", "1.200", other_curve="straight lines"),
        gain("old", "d", percent="17.5"),
    )
    one = audited_text(paper([[0, 1]], *parts, velocity=1.9496))
    assert verdicts(one)["gain"] is OPEN
    (why,) = [j.why for j in one.judgements if j.claim == "gain"]
    assert why.startswith("It rests on what Table 2 prints, which is refuted. ")


@pytest.mark.parametrize(
    ("time", "severity", "scope"),
    [("0.962", Severity.WARNING, Scope.SOME), ("0.95", Severity.ERROR, Scope.ALL)],
)
def test_a_proof_is_an_error_only_where_every_reading_is_against_the_claim(
    time: str, severity: Severity, scope: Scope
) -> None:
    one = audited_text(one_joint("0, 1", "1.9496", time, "within_limits", UNITS))
    against = [f for f in one.findings if f.verdict is REFUTED]
    assert {f.claim for f in against} == {"d", "s"}
    assert {(f.severity, f.scope) for f in against} == {(severity, scope)}
    assert one.errors == (1 if severity is Severity.ERROR else 0)


def test_what_breaks_the_limits_is_not_optimal_within_them() -> None:
    """0.95 s is shorter than the shortest answer, 0.961736 s, and keeps no limit."""
    one = audited_text(one_joint("0, 1", "1.9496", "0.95", "optimal"))
    (found,) = [f for f in one.findings if f.claim == "s"]
    assert found.verdict is REFUTED
    assert (found.basis, found.evidence) == (Basis.ENCLOSURE, Evidence.NONE)
    assert found.message.startswith("Not an answer within the limits. Table 2: A limit is broken")
    beside = next(f for f in one.findings if f.rule == "TG302" and f.claim == "d")
    assert beside.severity is Severity.INFO
    assert beside.message.endswith("which keeps the limits; these durations do not.")


def test_the_order_of_two_totals_that_cannot_be_computed_supports_nothing() -> None:
    whale = load_case("z1-woa-bspline")
    alone = replace(whale, document=whale.document.model_copy(update={"families": ()}))
    one = audit(alone, seeds=2).cases[0]
    better = next(j for j in one.judgements if j.claim == "improvement")
    assert better.verdict is OPEN
    assert "13.08 and 11.71 s, in the order that is claimed" in better.why


def test_a_selected_reading_does_not_speak_for_all() -> None:
    one = audit("irb460-pso-353", seeds=2, reading="waypoints-rad").cases[0]
    kept = next(j for j in one.judgements if j.claim == "limits-kept")
    assert (kept.verdict, kept.scope) == (REFUTED, Scope.SOME)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_bounds_above_the_unbounded_optimum_are_the_optimum(seed: int) -> None:
    """A repair once shrank durations below their bounds, and the solver was given an empty box."""
    q = np.array([[-1.84], [-0.2], [-0.35], [0.27]])
    lower = [2.87, 2.847, 1.655]
    solution = solve(Problem(q, Limits(4.0, joints=1), cubic_spline(3), lower), seed=seed)
    assert solution.status is Status.OPTIMAL
    assert solution.total_time == pytest.approx(sum(lower), rel=1e-9)
