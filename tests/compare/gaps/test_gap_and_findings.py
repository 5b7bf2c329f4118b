from dataclasses import replace

import numpy as np
import pytest
from support.findings import made_finding as finding
from trajgap.compare.audits.causes import judge, weigh
from trajgap.compare.documents import ClaimVerdict, GapKind, Reference, Scope, Severity
from trajgap.compare.gaps.optimality_gap import gap
from trajgap.compare.gaps.statistics import settled_at, share_of_luck, share_of_pairs, spread
from trajgap.nlp import Evidence, solve
from trajgap.problem import TrajgapError, load_case


@pytest.mark.parametrize(
    ("time", "reference", "lowest", "highest", "percent"),
    [
        ((3.5, 3.6), Reference(upper=3.2, lower=3.0), 0.09375, 0.2, "+9.3 to +20.1 %"),
        (3.0, 3.2, 3.0 / 3.2 - 1, 3.0 / 3.2 - 1, "-6.25 %"),  # below it, with its sign
        (5.0, 0.1, 49.0, 49.0, "50 times the reference"),
        # Both ends have the decimals of the one further from 0, and lie outwards.
        ((1.0019007, 1.0020368), 1.0, 0.0019007, 0.0020368, "+0.190 to +0.204 %"),
        ((1.09552, 1.12341), 1.0, 0.09552, 0.12341, "+9.5 to +12.4 %"),
        ((0.998126, 1.0011004), 1.0, -0.001874, 0.0011004, "-0.188 to +0.111 %"),
    ],
)
def test_a_gap_is_an_interval_against_both_ends_of_the_reference(
    time: object, reference: object, lowest: float, highest: float, percent: str
) -> None:
    found = gap(time, reference)
    assert (found.lowest, found.highest) == pytest.approx((lowest, highest))
    assert found.percent.endswith(percent)
    # An infeasible time has a difference, and no optimality gap.
    assert found.kind is GapKind.OPTIMALITY
    assert gap(time, reference, feasible=False).kind is GapKind.REPORTED


def test_a_solution_is_a_reference() -> None:
    solution = solve(load_case("irb460-pso-353").problem("limit-80"))
    for one, evidence in (
        (solution, Evidence.CERTIFIED),
        (replace(solution, lower_bound=None), Evidence.BEST_KNOWN),
    ):
        found = gap(one.total_time, one)
        assert (found.lowest, found.reference.evidence) == (0, evidence)


def test_no_time_is_negative_or_below_a_proven_bound_without_a_word() -> None:
    for time in (-3.0, float("nan"), (2.0, 1.0)):
        with pytest.raises(TrajgapError, match="is no time"):
            gap(time, 2.0)
    proven = Reference(upper=1.5, lower=1.499, evidence=Evidence.CERTIFIED)
    assert str(gap(1.2, proven)).endswith("no motion within the limits is that short")
    assert "that short" not in str(gap(1.2, 1.5)) + str(gap(1.6, proven))


@pytest.mark.parametrize("reference", [0.0, -1.0, float("inf"), float("nan")])
def test_a_reference_must_be_a_positive_finite_time(reference: float) -> None:
    with pytest.raises(TrajgapError, match="is not a positive finite time"):
        gap(1.0, reference)


S, R, X, N, D = (
    ClaimVerdict.SUPPORTED,
    ClaimVerdict.REFUTED,
    ClaimVerdict.INCONSISTENT,
    ClaimVerdict.NOT_CHECKABLE,
    ClaimVerdict.DEPENDS,
)


@pytest.mark.parametrize(
    ("found", "verdict", "scope"),
    [
        ([(S, "a"), (S, "b")], S, Scope.ALL),
        ([(R, "a"), (R, "b")], R, Scope.ALL),
        ([(R, "a"), (S, "b")], D, Scope.SOME),
        ([(R, "a"), (N, "b")], D, Scope.SOME),
        ([(R, "a"), (X, "b")], D, Scope.SOME),
        ([(S, "a")], D, Scope.SOME),
        ([(N, "a"), (N, "b")], N, Scope.NO),
        ([], N, Scope.NO),
        ([(S, None), (R, "a"), (R, "b")], R, Scope.ALL),
        ([(S, None), (X, None)], X, Scope.ALL),
        ([(S, None)], S, Scope.ALL),
    ],
)
def test_a_claim_is_judged_reading_by_reading(found, verdict, scope) -> None:
    findings = [finding(v, reading) for v, reading in found]
    # Findings about other claims, or beside the point, do not decide.
    beside = [finding(R, None, claim="other"), finding(R, None, decides=False)]
    judged = judge("c", beside + findings, ["a", "b"])
    assert (judged.verdict, judged.scope) == (verdict, scope)


def test_what_leaves_a_reading_open_is_no_reason_for_what_another_decides() -> None:
    undecided = finding(N, "b", sentences=("Nothing is known.",), evidence=Evidence.CERTIFIED)
    judged = judge("c", [finding(R, "a"), undecided], ["a", "b"])
    assert judged.verdict is D
    assert "Nothing is known" not in judged.why
    assert judged.evidence is Evidence.NONE


def test_a_verdict_speaks_of_the_readings_that_were_computed() -> None:
    judged = judge("c", [finding(R, "a")], ["a", "b"], ["a"])
    assert (judged.verdict, judged.scope, judged.readings) == (R, Scope.SOME, {"a": R})
    error = finding(R, "a", severity=Severity.ERROR)
    (weighed,) = weigh([error], [judged], ["a", "b"])
    assert weighed.severity is Severity.WARNING


def test_a_claim_that_nothing_decides_names_what_stands_beside_it() -> None:
    beside = finding(S, None, decides=False, rule="TG403")
    judged = judge("c", [beside], ["a"])
    assert judged.verdict is N
    assert "TG403" in judged.why


@pytest.mark.parametrize(
    ("found", "errors"),
    [
        ([(R, "a"), (R, "b")], 2),
        ([(R, "a"), (X, "b")], 2),
        ([(R, "a"), (N, "b")], 0),
        ([(R, "a"), (S, "b")], 0),
        ([(R, "a")], 0),
        ([(R, None)], 1),
        ([(R, None), (S, "a")], 1),
    ],
)
def test_a_severity_fits_the_verdict_on_the_claim(found, errors) -> None:
    findings = [
        finding(v, reading, severity=Severity.ERROR if v in (R, X) else Severity.INFO)
        for v, reading in found
    ]
    weighed = weigh(findings, [judge("c", findings, ["a", "b"])], ["a", "b"])
    assert sum(f.severity is Severity.ERROR for f in weighed) == errors
    softened = sum(f.severity is Severity.WARNING for f in weighed)
    assert errors + softened == sum(v in (R, X) for v, _ in found)


def test_shares_count_pairs_and_never_a_run_against_itself() -> None:
    slower, faster = np.array([2.0, 4.0]), np.array([1.0, 3.0])
    assert share_of_pairs(slower, faster, 0.25) == 3 / 4
    assert share_of_luck(slower, 0.5) == 1 / 2
    assert np.isnan(share_of_pairs(np.array([np.inf]), faster, 0.1))


def test_a_spread_counts_failures_apart() -> None:
    found = spread(np.array([np.inf, 3.0, 1.0, 2.0]))
    assert (found.runs, found.failed, found.lowest, found.median, found.highest) == (4, 1, 1, 2, 3)
    assert "1 of 4 without answer" in str(found)
    assert "no feasible answer" in str(spread(np.array([np.inf])))


def test_a_run_settles_when_it_stays_near_its_end() -> None:
    assert settled_at(np.array([9.0, 5.0, 1.05, 1.0, 1.0]), 0.1) == 2
    assert settled_at(np.array([np.inf, np.inf]), 0.1) == 2
