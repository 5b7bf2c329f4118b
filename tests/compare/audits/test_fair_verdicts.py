"""Cases on which a careless rule would accuse a sound paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.one_joint import HEAD, UNITS
from trajgap.compare import audit
from trajgap.compare.documents import Basis, ClaimVerdict, Scope, Severity
from trajgap.nlp import Evidence, Status, solve
from trajgap.problem import Limits, Problem, cubic_spline, load_case, parse_case


def verdicts(points: str, limit: str, time: str, checks: str) -> dict[str, ClaimVerdict]:
    text = HEAD.format(points=points, limit=limit, time=time, checks=checks)
    one = audit(parse_case(text, "fair.toml"), seeds=2).cases[0]
    assert not [f for f in one.findings if f.severity is Severity.ERROR]
    return {j.claim: j.verdict for j in one.judgements}


def test_an_optimum_of_waypoints_that_print_alike_is_not_refuted() -> None:
    """7.125 s is exactly optimal from -0.4 to 3.4, which print as 0 and 3."""
    found = verdicts('"0", "3"', "1", "7.125", "optimal")
    assert found["s"] is ClaimVerdict.NOT_CHECKABLE


def test_durations_with_digits_cut_off_break_nothing() -> None:
    """The optimum 0.961736 s printed as 0.961."""
    found = verdicts("0, 1", "1.9496", "0.961", "within_limits")
    assert found == {"d": ClaimVerdict.SUPPORTED, "s": ClaimVerdict.SUPPORTED}


def test_what_is_plainly_broken_is_still_refuted() -> None:
    text = HEAD.format(points="0, 1", limit="1.9496", time="0.95", checks="within_limits")
    one = audit(parse_case(text, "fair.toml"), seeds=2).cases[0]
    assert {j.verdict for j in one.judgements} == {ClaimVerdict.REFUTED}
    slow = HEAD.format(points="0, 1", limit="1.9496", time="1.2", checks="optimal")
    one = audit(parse_case(slow, "fair.toml"), seeds=2).cases[0]
    assert {j.claim: j.verdict for j in one.judgements}["s"] is ClaimVerdict.REFUTED


OTHER = """
[[claims]]
id = "other"
quantity = "durations"
where = "Table 2"
durations = ["0.5"]
"""


def test_durations_of_which_nothing_is_said_break_nothing() -> None:
    """Equal durations before an optimisation are no answer, and nobody says they keep a limit."""
    text = HEAD.format(points="0, 1", limit="1.9496", time="0.962", checks="within_limits") + OTHER
    one = audit(parse_case(text, "fair.toml"), seeds=2).cases[0]
    assert {f.severity for f in one.findings} == {Severity.INFO}
    judged = {j.claim: j.verdict for j in one.judgements}
    assert judged == dict.fromkeys(("d", "s"), ClaimVerdict.SUPPORTED) | {
        "other": ClaimVerdict.NOT_CHECKABLE
    }
    (beside,) = [f for f in one.findings if f.rule == "TG201" and f.claim == "other"]
    assert not beside.decides
    assert "A limit is broken" in beside.message
    assert beside.message.endswith("Nothing printed says that these durations keep the limits.")
    named = text.replace('of = ["d"]', 'of = ["d", "other"]')
    one = audit(parse_case(named, "fair.toml"), seeds=2).cases[0]
    assert {j.claim: j.verdict for j in one.judgements}["other"] is ClaimVerdict.REFUTED


def test_a_percentage_of_a_refuted_total_says_why_it_is_not_checkable() -> None:
    """0.962 s beside a total of 0.99 s; 1.2 s is 17.5 % longer than that."""
    text = HEAD.format(points="0, 1", limit="1.9496", time="0.962", checks="within_limits")
    text = text.replace('["0.962"]', '["0.962"]\ntotal = "0.990"') + (
        '[[claims]]\nid = "old"\nquantity = "total_time"\nwhere = "Table 3"\n'
        'other_curve = "straight lines"\nvalue = "1.200"\n'
        '[[claims]]\nid = "gain"\nquantity = "improvement"\nwhere = "abstract"\n'
        'slower = "old"\nfaster = "d"\npercent = "17.5"\n'
    )
    one = audit(parse_case(text, "fair.toml"), seeds=2).cases[0]
    (gain,) = [j for j in one.judgements if j.claim == "gain"]
    assert gain.verdict is ClaimVerdict.NOT_CHECKABLE
    assert gain.why.startswith("It rests on what Table 2 prints, which is refuted. ")


@pytest.mark.parametrize(
    ("time", "severity", "scope"),
    [("0.962", Severity.WARNING, Scope.SOME), ("0.95", Severity.ERROR, Scope.ALL)],
)
def test_a_proof_is_an_error_only_where_every_reading_is_against_the_claim(
    time: str, severity: Severity, scope: Scope
) -> None:
    text = HEAD.format(points="0, 1", limit="1.9496", time=time, checks="within_limits") + UNITS
    one = audit(parse_case(text, "fair.toml"), seeds=2).cases[0]
    against = [f for f in one.findings if f.verdict is ClaimVerdict.REFUTED]
    assert {f.claim for f in against} == {"d", "s"}
    assert {f.severity for f in against} == {severity}
    assert {f.scope for f in against} == {scope}
    assert one.errors == (1 if severity is Severity.ERROR else 0)


def test_what_breaks_the_limits_is_not_optimal_within_them() -> None:
    """0.95 s is shorter than the shortest answer, 0.961736 s, and keeps no limit."""
    text = HEAD.format(points="0, 1", limit="1.9496", time="0.95", checks="optimal")
    one = audit(parse_case(text, "fair.toml"), seeds=2).cases[0]
    (found,) = [f for f in one.findings if f.claim == "s"]
    assert found.verdict is ClaimVerdict.REFUTED
    assert (found.basis, found.evidence) == (Basis.ENCLOSURE, Evidence.NONE)
    assert found.message.startswith(
        "Not an answer within the limits. Table 2: A limit is broken for every value"
    )
    beside = next(f for f in one.findings if f.rule == "TG302" and f.claim == "d")
    assert beside.severity is Severity.INFO
    assert beside.message.endswith("which keeps the limits; these durations do not.")


def test_the_order_of_two_totals_that_cannot_be_computed_supports_nothing() -> None:
    whale = load_case("z1-woa-bspline")
    alone = replace(whale, document=whale.document.model_copy(update={"families": ()}))
    one = audit(alone, seeds=2).cases[0]
    better = next(j for j in one.judgements if j.claim == "improvement")
    assert better.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "13.08 and 11.71 s, in the order that is claimed" in better.why


def test_a_selected_reading_does_not_speak_for_all() -> None:
    one = audit("irb460-pso-353", seeds=2, reading="waypoints-rad").cases[0]
    kept = next(j for j in one.judgements if j.claim == "limits-kept")
    assert (kept.verdict, kept.scope) == (ClaimVerdict.REFUTED, Scope.SOME)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_bounds_above_the_unbounded_optimum_are_the_optimum(seed: int) -> None:
    """A repair once shrank durations below their bounds, and the solver was given an empty box."""
    q = np.array([[-1.84], [-0.2], [-0.35], [0.27]])
    lower = [2.87, 2.847, 1.655]
    solution = solve(Problem(q, Limits(4.0, joints=1), cubic_spline(3), lower), seed=seed)
    assert solution.status is Status.OPTIMAL
    assert solution.total_time == pytest.approx(sum(lower), rel=1e-9)
