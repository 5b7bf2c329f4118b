"""Every rule on a shipped case, and on one with a place of its file changed."""

import pytest
from support.findings import judged
from support.studies import changed
from trajgap.compare.audits.case_audit import audit
from trajgap.compare.audits.rules.distances import _optimal_statement
from trajgap.compare.audits.rules.stated_curve import count_conditions, judge_counts
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Finding, Severity
from trajgap.nlp import Evidence
from trajgap.problem import TrajgapError, load_case

PUMA = "puma560-mnam-pso-353"
IRB = "irb460-pso-353"
AGAINST = ("refuted", "inconsistent")
Swap = tuple[str, str]
SLOW = 'durations = ["0.6445", "0.5858", "0.6387"]'
FAST = 'durations = ["0.7615", "0.3854", "0.4572"]'
OPTIMA = (
    (SLOW, 'durations = ["0.6403", "0.6652", "0.5120"]'),
    (FAST, 'durations = ["0.4656", "0.4838", "0.3724"]'),
)


def of(study: Study, rule: str, claim: str | None = None) -> list[Finding]:
    return [f for f in judged(study, rule) if claim is None or f.claim == claim]


NOT_ALIKE = ('["-1.0392", 0, 0]', '["-1.0391", 0, 0]')
SCALED = (FAST, 'durations = ["0.46873", "0.42604", "0.46451"]')
BOUNDED = ("lower = 0\n", "lower = 0.1\n")
ACCELERATED = (
    ("velocity = 80 }", "velocity = 80, acceleration = 900 }"),
    ('velocity = "deg/s"\ntime', 'velocity = "deg/s"\nacceleration = "deg/s^2"\ntime'),
)


@pytest.mark.parametrize(
    ("case", "swaps", "id_", "claim", "verdict"),
    [
        (PUMA, (), "TG104", None, "inconsistent"),
        (PUMA, (), "TG105", "pso-total", "inconsistent"),
        # Digits that stand in an unrelated column are mentioned.
        (IRB, (), "TG106", None, "not checkable"),
        (IRB, (NOT_ALIKE,), "TG106", None, ""),
        # The table of the Puma paper is reproduced and never broken.
        (PUMA, (), "TG201", None, "supported"),
        # The law of scaling needs velocity limits alone.
        (IRB, (), "TG301", "time-optimal", "refuted"),
        (IRB, (SCALED,), "TG301", None, ""),
        (IRB, (BOUNDED,), "TG301", None, ""),
        (IRB, ACCELERATED, "TG301", None, ""),
    ],
)
def test_a_rule_on_a_case_and_on_the_case_changed(
    case: str, swaps: tuple[Swap, ...], id_: str, claim: str | None, verdict: str
) -> None:
    found = of(changed(case, *swaps), id_, claim)
    assert {str(f.verdict) for f in found} == ({verdict} if verdict else set())
    assert all((f.severity is Severity.ERROR) == (verdict in AGAINST) for f in found)


@pytest.mark.parametrize(
    ("swap", "claim", "verdict"),
    [
        (None, "rest-at-all-points", "refuted"),
        (None, "conditions-14", "supported"),
        (("degrees = [3, 5, 3]", "degrees = [5, 5, 5]"), "rest-at-all-points", "supported"),
        (('count = "14"', 'count = "16"'), "conditions-14", "refuted"),
    ],
)
def test_eighteen_conditions_do_not_fit_fourteen_coefficients(
    swap: Swap | None, claim: str, verdict: str
) -> None:
    study = changed(IRB, *([swap] if swap else []))
    claims = {c.id: c for c in study.case.claims}
    assert count_conditions(study, claims["rest-at-all-points"]) == 18
    assert count_conditions(study, claims["conditions-14"]) == 14
    assert {f.claim: f.verdict for f in judge_counts(study)}[claim] == verdict


def test_what_just_reaches_its_limit_is_said_to() -> None:
    tight = {f.claim for f in of(changed(PUMA), "TG204")}
    assert {f"mnam-joint-{j}" for j in (1, 3, 4, 5, 6)} <= tight
    (digits,) = of(changed(IRB), "TG106")
    assert (digits.printed, digits.decides) == ("-1.0392, -0.5196", False)


def test_only_an_enclosure_breaks_and_only_under_its_reading() -> None:
    found = of(changed(IRB), "TG201", "durations-110")
    verdicts = {f.reading: f.verdict for f in found}
    assert verdicts == {"waypoints-rad": "refuted", "waypoints-deg": "supported"}
    law = of(changed(IRB), "TG301", "time-optimal")
    assert {f.reading for f in law} == set(verdicts), "it needs no solver and no reading"


@pytest.mark.parametrize(
    ("swaps", "verdict", "evidence"),
    [
        ((), ClaimVerdict.REFUTED, Evidence.NONE),  # a shorter motion needs no optimum
        (OPTIMA, ClaimVerdict.SUPPORTED, Evidence.CERTIFIED),
    ],
)
def test_optimal_is_refuted_by_a_shorter_checked_motion_and_supported_by_its_digits(
    swaps: tuple[Swap, ...], verdict: ClaimVerdict, evidence: Evidence
) -> None:
    found = of(changed(IRB, *swaps), "TG302", "time-optimal")
    (one,) = [f for f in found if f.reading == "waypoints-rad"]
    assert (one.verdict, one.evidence) == (verdict, evidence)


@pytest.mark.parametrize(
    ("swap", "id_", "claim", "severity"),
    [
        (('value = "3.528"', 'value = "3.1"'), "TG303", "mnam-total", Severity.WARNING),
        # No warning where limits are broken.
        (
            (
                'durations = ["0.961", "1.258", "1.078"]\ntotal = "3.298"',
                'durations = ["0.861", "1.258", "1.078"]\ntotal = "3.198"',
            ),
            "TG302",
            "mnam-joint-1",
            Severity.INFO,
        ),
    ],
)
def test_a_total_below_the_best_known(swap: Swap, id_: str, claim: str, severity: Severity) -> None:
    found = of(changed(PUMA, swap), id_, claim)
    assert {f.severity for f in found} == {severity}
    assert all(f.gap.highest < 0 for f in found)
    assert not any(f.verdict is ClaimVerdict.REFUTED for f in found)
    broken = ["because these durations break" in f.message for f in found]
    assert all(broken) if severity is Severity.INFO else not any(broken)


def test_an_audit_keeps_to_a_chosen_problem_and_reading() -> None:
    report = audit(IRB, seeds=2, problem="limit-80", reading="waypoints-rad")
    assert {f.problem for f in report.cases[0].findings} <= {"limit-80", None}
    assert {f.reading for f in report.cases[0].findings} <= {"waypoints-rad", None}


def test_of_a_problem_that_is_not_chosen_nothing_is_called_optimal() -> None:
    study = Study(load_case(IRB), seeds=2, certify_seconds=0, problem="limit-80")
    elsewhere = study.case.claim("time-optimal").model_copy(update={"of": ("durations-110",)})
    assert list(_optimal_statement(study, elsewhere)) == []


def test_a_replay_needs_a_spread() -> None:
    with pytest.raises(TrajgapError, match="show no spread"):
        Study(load_case(IRB), seeds=1)
