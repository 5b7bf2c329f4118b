"""Every rule on a case built to trip it, and on one that must not."""

from __future__ import annotations

import pytest
from support.studies import SEEDS, audited, changed, hurried
from trajgap.compare.audits.case_audit import audit
from trajgap.compare.audits.rules.condition_count import count_conditions, judge_counts
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.improvements import judge_improvements
from trajgap.compare.audits.rules.open_points import list_open_points
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.audits.rules.printed_digits import judge_digits
from trajgap.compare.audits.rules.printed_tables import judge_tables
from trajgap.compare.audits.rules.replays import judge_replays
from trajgap.compare.audits.rules.scaling_law import judge_scaling
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Basis, ClaimVerdict, Finding, Gap, Severity
from trajgap.nlp import Evidence
from trajgap.problem import TrajgapError, load_case

PUMA = "puma560-mnam-pso-353"
IRB = "irb460-pso-353"


def of(findings, rule: str, claim: str | None = None) -> list[Finding]:
    return [f for f in findings if f.rule == rule and (claim is None or f.claim == claim)]


def test_shipped_sums_maxima_and_percentages_hold() -> None:
    for rule in ("TG101", "TG102"):
        found = of(judge_digits(changed(PUMA)), rule)
        assert found
        assert {f.verdict for f in found} == {ClaimVerdict.SUPPORTED}


def test_a_total_beyond_the_rounding_of_its_parts_is_refuted() -> None:
    study = changed(PUMA, ('total = "3.298"', 'total = "3.301"'))
    (found,) = of(judge_digits(study), "TG101", "mnam-joint-1")
    assert found.verdict is ClaimVerdict.REFUTED
    assert found.severity is Severity.ERROR


def test_a_total_that_fits_only_cut_off_digits_says_so() -> None:
    swaps = [
        (
            'durations = ["0.739", "0.822", "0.467"]\ntotal = "2.028"',
            'durations = ["0.739", "0.822", "0.467"]\ntotal = "2.031"',
        )
    ]
    (found,) = of(judge_digits(changed(PUMA, *swaps)), "TG101", "mnam-joint-5")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert found.severity is Severity.WARNING
    assert "cut off" in found.message


def test_a_longest_duration_that_no_row_has_is_refuted() -> None:
    study = changed(
        PUMA, ('durations = ["1.044", "1.258", "1.225"]', 'durations = ["1.047", "1.258", "1.225"]')
    )
    assert {f.verdict for f in of(judge_digits(study), "TG102")} == {ClaimVerdict.REFUTED}


@pytest.mark.parametrize(
    ("percent", "verdict"),
    [
        ("10.9", ClaimVerdict.SUPPORTED),
        ("11", ClaimVerdict.SUPPORTED),
        ("11.9", ClaimVerdict.REFUTED),
    ],
)
def test_a_percentage_is_compared_as_an_interval(percent: str, verdict: ClaimVerdict) -> None:
    study = changed(PUMA, ('percent = "10.9"', f'percent = "{percent}"'))
    assert verdict in {f.verdict for f in of(judge_improvements(study), "TG103", "improvement")}


def test_tables_printed_alike_are_found_and_one_other_digit_clears_them() -> None:
    (found,) = of(judge_tables(changed(PUMA)), "TG104")
    assert found.verdict is ClaimVerdict.INCONSISTENT
    assert "28" in found.message
    source = ('id = "pso-joint-5"', 'id = "pso-joint-5"')
    study = changed(PUMA, source)
    claims = study.case.table_claims("table-2")
    assert len(claims) == 7
    first = 'table = "table-2"\ndurations = ["0.739", "0.822", "0.467"]'
    other = 'table = "table-2"\ndurations = ["0.739", "0.822", "0.468"]'
    assert not of(judge_tables(changed(PUMA, (first, other))), "TG104")


def test_two_totals_of_one_run_must_agree() -> None:
    (found,) = of(judge_tables(changed(PUMA)), "TG105", "pso-total")
    assert found.verdict is ClaimVerdict.INCONSISTENT
    study = changed(PUMA, ('value = "3.961"', 'value = "3.53"'))
    (found,) = of(judge_tables(study), "TG105", "pso-total")
    assert found.verdict is ClaimVerdict.SUPPORTED


def test_digits_that_stand_in_an_unrelated_column_are_mentioned_and_decide_nothing() -> None:
    (found,) = of(judge_digits(changed(IRB)), "TG106")
    assert found.printed == "-1.0392, -0.5196"
    assert not found.decides
    assert not of(
        judge_digits(changed(IRB, ('values = ["-1.0392", 0, 0]', 'values = ["-1.0391", 0, 0]'))),
        "TG106",
    )


def test_eighteen_conditions_do_not_fit_fourteen_coefficients() -> None:
    study = changed(IRB)
    claims = {c.id: c for c in study.case.claims}
    assert count_conditions(study, claims["rest-at-all-points"]) == 18
    assert count_conditions(study, claims["conditions-14"]) == 14
    found = {f.claim: f.verdict for f in judge_counts(study)}
    assert found["rest-at-all-points"] is ClaimVerdict.REFUTED
    assert found["conditions-14"] is ClaimVerdict.SUPPORTED
    quintics = changed(
        IRB,
        (
            'rest_at = "all"\norders = [1, 2]\ndegrees = [3, 5, 3]',
            'rest_at = "all"\norders = [1, 2]\ndegrees = [5, 5, 5]',
        ),
    )
    found = {f.claim: f.verdict for f in judge_counts(quintics)}
    assert found["rest-at-all-points"] is ClaimVerdict.SUPPORTED
    miscounted = changed(IRB, ('count = "14"', 'count = "16"'))
    assert {f.claim: f.verdict for f in judge_counts(miscounted)}[
        "conditions-14"
    ] is ClaimVerdict.REFUTED


def test_the_table_of_the_puma_paper_is_reproduced_and_never_broken() -> None:
    found = of(judge_motions(changed(PUMA)), "TG201")
    assert {f.verdict for f in found} == {ClaimVerdict.SUPPORTED}
    tight = {f.claim for f in of(judge_motions(changed(PUMA)), "TG204")}
    assert {f"mnam-joint-{j}" for j in (1, 3, 4, 5, 6)} <= tight


def test_only_an_enclosure_breaks_and_only_under_its_reading() -> None:
    found = of(judge_motions(changed(IRB)), "TG201", "durations-110")
    verdicts = {f.reading: f.verdict for f in found}
    assert verdicts["waypoints-rad"] is ClaimVerdict.REFUTED
    assert verdicts["waypoints-deg"] is ClaimVerdict.SUPPORTED


def test_a_printed_peak_is_compared_with_the_rebuilt_one() -> None:
    claim = """
[[claims]]
id = "peak"
quantity = "peak"
where = "test"
problem = "limit-110"
joint = "5"
algorithm = "constrained-pso"
derivative = "velocity"
value = "{}"
"""
    for value, verdict in (("119", ClaimVerdict.SUPPORTED), ("110", ClaimVerdict.INCONSISTENT)):
        study = changed(IRB, tail=claim.format(value))
        found = {f.reading: f.verdict for f in of(judge_peaks(study), "TG203")}
        assert found["waypoints-rad"] is verdict


def test_the_scaling_law_needs_no_solver_and_no_reading() -> None:
    found = of(judge_scaling(changed(IRB)), "TG301", "time-optimal")
    assert {f.reading for f in found} == {"waypoints-rad", "waypoints-deg"}
    assert {f.verdict for f in found} == {ClaimVerdict.REFUTED}
    consistent = changed(
        IRB,
        (
            'durations = ["0.7615", "0.3854", "0.4572"]',
            'durations = ["0.46873", "0.42604", "0.46451"]',
        ),
    )
    assert not of(judge_scaling(consistent), "TG301")


def test_the_scaling_law_is_not_used_where_a_duration_bound_or_acceleration_limit_holds() -> None:
    assert not list(judge_scaling(changed(IRB, ("lower = 0\n", "lower = 0.1\n"))))
    bounded = changed(
        IRB,
        ("velocity = 80 }", "velocity = 80, acceleration = 900 }"),
        ('velocity = "deg/s"\ntime', 'velocity = "deg/s"\nacceleration = "deg/s^2"\ntime'),
    )
    assert not list(judge_scaling(bounded))


def test_optimal_is_refuted_by_a_shorter_checked_motion_and_supported_by_its_digits() -> None:
    found = {f.reading: f for f in of(judge_distances(changed(IRB)), "TG302", "time-optimal")}
    assert found["waypoints-rad"].verdict is ClaimVerdict.REFUTED
    assert found["waypoints-rad"].evidence is Evidence.NONE, "a shorter motion needs no optimum"
    optimal = changed(
        IRB,
        (
            'durations = ["0.6445", "0.5858", "0.6387"]',
            'durations = ["0.6403", "0.6652", "0.5120"]',
        ),
        (
            'durations = ["0.7615", "0.3854", "0.4572"]',
            'durations = ["0.4656", "0.4838", "0.3724"]',
        ),
    )
    found = {f.reading: f for f in of(judge_distances(optimal), "TG302", "time-optimal")}
    assert found["waypoints-rad"].verdict is ClaimVerdict.SUPPORTED
    assert found["waypoints-rad"].evidence is Evidence.CERTIFIED


@pytest.mark.slow
def test_a_claim_stands_beside_its_own_optimum_the_shared_one_and_the_procedure() -> None:
    study = changed(PUMA)
    found = [f for f in judge_distances(study) if f.reading == "durations-at-least-0.3"]
    (shared,) = of(found, "TG303", "mnam-longest")
    assert isinstance(shared.gap, Gap)
    assert shared.gap.lowest == pytest.approx(3.5275 / shared.gap.reference.upper - 1, rel=1e-6)
    assert any("longest per segment" in f.message for f in of(found, "TG302", "mnam-longest"))
    (below,) = of(found, "TG302", "mnam-joint-5")
    assert below.severity is Severity.INFO
    assert not any(f.decides for f in found if f.claim != "time-optimal")


def test_a_total_below_the_best_known_one_is_a_warning_and_refutes_nothing() -> None:
    study = changed(PUMA, ('value = "3.528"', 'value = "3.1"'))
    found = of(judge_distances(study), "TG303", "mnam-total")
    assert {f.severity for f in found} == {Severity.WARNING}
    assert all(f.gap.highest < 0 for f in found)
    assert not any(f.verdict is ClaimVerdict.REFUTED for f in found)


def test_a_total_below_the_optimum_needs_no_warning_where_limits_are_broken() -> None:
    study = changed(
        PUMA,
        (
            'durations = ["0.961", "1.258", "1.078"]\ntotal = "3.298"',
            'durations = ["0.861", "1.258", "1.078"]\ntotal = "3.198"',
        ),
    )
    found = of(judge_distances(study), "TG302", "mnam-joint-1")
    assert {f.severity for f in found} == {Severity.INFO}
    assert all(f.gap.highest < 0 for f in found)
    assert all("these durations do not" in f.message for f in found)


def test_replays_never_refute() -> None:
    found = list(judge_replays(changed(IRB)))
    assert {f.rule for f in found} == {"TG402", "TG403"}
    assert ClaimVerdict.REFUTED not in {f.verdict for f in found}
    assert Severity.ERROR not in {f.severity for f in found}


def test_an_algorithm_of_unknown_kind_is_not_replayed() -> None:
    study = changed(IRB, ('kind = "constrained-pso"', 'kind = "firefly"'))
    found = list(judge_replays(study))
    assert found
    assert all("not implemented" in f.message for f in found if f.rule == "TG402")


def test_what_the_extraction_damaged_is_listed_and_never_refuted() -> None:
    for case in (PUMA, IRB):
        found = list(list_open_points(changed(case)))
        assert {f.verdict for f in found} == {ClaimVerdict.NOT_CHECKABLE}
        assert len(found) >= len(load_case(case).not_checkable)


@pytest.mark.slow
def test_no_error_rests_on_the_plain_check() -> None:
    for case in (PUMA, IRB):
        for finding in audited(case).findings:
            if finding.severity is Severity.ERROR:
                assert finding.basis is not Basis.CHECK


def test_an_audit_keeps_to_a_chosen_problem_and_reading() -> None:
    report = audit(IRB, seeds=2, problem="limit-80", reading="waypoints-rad")
    assert {f.problem for f in report.cases[0].findings} <= {"limit-80", None}
    assert {f.reading for f in report.cases[0].findings} <= {"waypoints-rad", None}


def test_the_same_seeds_give_the_same_findings() -> None:
    second = audit(hurried(IRB), seeds=SEEDS).cases[0]
    assert [f.message for f in audited(IRB).findings] == [f.message for f in second.findings]


def test_a_replay_needs_a_spread() -> None:
    with pytest.raises(TrajgapError, match="show no spread"):
        Study(load_case(IRB), seeds=1)
