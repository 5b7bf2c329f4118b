"""What an audit cannot compute says why in one line, and everything else is judged as usual."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.base_case import BASE
from trajgap.compare.audits import CaseAudit, Study, audit, case_audit
from trajgap.compare.audits.rules.registry import RuleGroup
from trajgap.compare.documents import ClaimVerdict, Finding, Why
from trajgap.compare.pages import write_report
from trajgap.problem import CaseError, ProcessError, TrajgapError, parse_case

CASE = """format = 1
id = "partly"
title = "Two joints, some of which cannot be computed"
[source]
[robot]
name = "r"
joints = ["1", "2"]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
joint_rows = [["0.10", "0.90", "-0.30", "0.40"], ["1.0", "0.2", "0.3", "-0.5"]]
[limits]
velocity = [2.0, 1.5]
acceleration = [9.0, 8.0]
{limits}
[interpolant]
{interpolant}
[[algorithms]]
id = "pso"
name = "PSO"
kind = "pso"
settings = {{ particles = 6, iterations = 8 }}
[[claims]]
id = "d"
quantity = "durations"
where = "Table 1"
algorithm = "pso"
durations = ["0.91", "1.02", "0.93"]
total = "2.86"
[[claims]]
id = "by"
quantity = "convergence"
where = "Fig. 1"
algorithm = "pso"
iterations = 5
[[claims]]
id = "shortest"
quantity = "statement"
where = "abstract"
checks = "optimal"
of = ["d"]
"""
SEPTIC = 'family = "rest-to-rest"\ndegree = 7'
SPLINE = 'family = "3-5-3"'
POSITIONS = "position_lower = -4.0\nposition_upper = 4.0"
FREE = 'family = "polynomials"\ndegrees = [5, 5, 5]\nfree = 4'
UNSOLVED = 'family = "polynomials"\ndegrees = [5, 5, 5]\nend_orders = [1]\ncontinuity = 1\nfree = 8'


def audited(folder: Path, interpolant: str, limits: str = "") -> CaseAudit:
    case = parse_case(CASE.format(interpolant=interpolant, limits=limits), "partly.toml")
    report = audit(case, seeds=2, certify_seconds=0)
    write_report(report, folder / "pages")
    return report.cases[0]


def verdict(one: CaseAudit, claim: str) -> ClaimVerdict:
    return next(j.verdict for j in one.judgements if j.claim == claim)


def test_a_relaxed_family_that_is_not_solved_is_a_step_without_a_time(tmp_path: Path) -> None:
    one = audited(tmp_path, SEPTIC)
    steps = {step.name: step for step in one.waterfalls[0].steps}
    assert steps["relaxed family"].time == Why(
        "the relaxed family has 8 free coefficients per joint, and derivatives at the way-points "
        "settle 6 of them"
    )
    assert isinstance(steps["optimum of the same curve, shared durations"].time, float)
    assert verdict(one, "d") is verdict(one, "shortest") is ClaimVerdict.REFUTED


def test_an_algorithm_is_replayed_under_position_limits(tmp_path: Path) -> None:
    """Limits that no motion comes near change nothing of what is said."""
    one, other = audited(tmp_path / "with", SPLINE, POSITIONS), audited(tmp_path / "free", SPLINE)
    said = [
        {f.rule: f.message for f in each.findings if f.rule in ("TG402", "TG403")}
        for each in (one, other)
    ]
    assert said[0] == said[1] != {}
    assert "not replayed" not in " ".join(said[0].values())


def test_an_algorithm_that_cannot_judge_a_curve_is_not_replayed(tmp_path: Path) -> None:
    one = audited(tmp_path, FREE)
    said = {f.rule: f.message for f in one.findings if f.rule in ("TG402", "TG403")}
    why = "The PSO is not replayed: interpolant 5-5-5 polynomials, C2: leaves 4"
    assert said
    assert all(message.startswith(why) for message in said.values())
    assert verdict(one, "by") is ClaimVerdict.NOT_CHECKABLE


def test_durations_of_a_curve_that_leaves_coefficients_free_define_no_motion(
    tmp_path: Path,
) -> None:
    one = audited(tmp_path, FREE)
    (found,) = (f for f in one.findings if f.rule == "TG502")
    assert (found.claim, found.problem, found.reading) == ("d", "main", "as-printed")
    assert found.message == (
        "Not computed: the curve (5-5-5 polynomials, C2) leaves 4 coefficients per joint free, so "
        "that durations alone define no motion."
    )
    assert verdict(one, "by") is verdict(one, "shortest") is ClaimVerdict.NOT_CHECKABLE
    assert verdict(one, "d") is ClaimVerdict.SUPPORTED, "its total is the sum of its durations"
    distance = next(f for f in one.findings if f.rule == "TG302" and f.claim == "d")
    assert distance.message.startswith(
        "Printed 2.86 s is 19.2 to 19.7 % longer than the best known"
    )
    page = (tmp_path / "pages" / "partly.html").read_text("utf-8")
    assert "are not drawn: the curve (5-5-5 polynomials, C2) leaves 4" in page


def test_a_curve_that_cannot_be_solved_leaves_the_digits_judged(tmp_path: Path) -> None:
    one = audited(tmp_path, UNSOLVED)
    about = next(f for f in one.findings if f.claim == "shortest")
    assert "no optimum was found (failed: interpolant 5-5-5 polynomials" in about.message
    assert [f.verdict for f in one.findings if f.rule == "TG101"] == [ClaimVerdict.SUPPORTED]


def broken_rule(study: Study):
    """A rule that cannot judge one claim."""
    for claim in study.claims:
        if claim.id == "by":
            raise TrajgapError("nobody knows")
        yield Finding(rule="TG101", basis="check", claim=claim.id, message="Seen")


def test_one_claim_that_fails_takes_no_other_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(case_audit, "GROUPS", (RuleGroup(broken_rule, {}),))
    case = parse_case(CASE.format(interpolant=SPLINE, limits=""), "partly.toml")
    one = case_audit.audit_case(Study(case, seeds=2, certify_seconds=0))
    assert {(f.rule, f.claim, f.message) for f in one.findings} == {
        ("TG101", "d", "Seen"),
        ("TG101", "shortest", "Seen"),
        ("TG502", "by", "Not computed: nobody knows."),
    }


def failing(error: TrajgapError):
    def rule(study: Study):
        if len(study.claims) > 1:
            raise error
        yield from ()

    return rule


def test_what_fails_for_no_single_claim_is_said_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    group = RuleGroup(failing(TrajgapError("only together.")), {})
    monkeypatch.setattr(case_audit, "GROUPS", (group,))
    case = parse_case(CASE.format(interpolant=SPLINE, limits=""), "partly.toml")
    one = case_audit.audit_case(Study(case, seeds=2, certify_seconds=0))
    assert [(f.claim, f.message) for f in one.findings] == [(None, "Not computed: only together.")]


@pytest.mark.parametrize(
    "error", [CaseError("partly.toml", "x", "is wrong"), ProcessError("workers: gone")]
)
def test_bad_input_and_dead_processes_still_end_an_audit(
    error: TrajgapError, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(case_audit, "GROUPS", (RuleGroup(failing(error), {}),))
    case = parse_case(CASE.format(interpolant=SPLINE, limits=""), "partly.toml")
    with pytest.raises(type(error), match=r"is wrong|workers: gone"):
        case_audit.audit_case(Study(case, seeds=2, certify_seconds=0))


def test_wrong_settings_of_an_algorithm_end_an_audit_before_it_begins() -> None:
    text = CASE.format(interpolant=SPLINE, limits="").replace("particles = 6", "particles = -6")
    with pytest.raises(TrajgapError, match=r"partly\.toml: algorithms\.pso: particles"):
        audit(parse_case(text, "partly.toml"), seeds=2, certify_seconds=0)


def test_an_algorithm_that_nothing_replays_is_named_with_the_nearest_kind() -> None:
    named = parse_case(BASE.replace('kind = "pso"', 'kind = "psso"'), "base.toml")
    assert Study(named).not_replayed == (
        "PSO: algorithm kind: 'psso' is unknown; did you mean 'pso'?",
    )
    unnamed = parse_case(BASE.replace('kind = "pso"\n', ""), "base.toml")
    assert Study(unnamed).not_replayed == (
        "PSO: the case file names no algorithm that trajgap has.",
    )
    assert Study(parse_case(BASE, "base.toml")).not_replayed == ()


def test_printed_points_that_define_no_curve_leave_the_rest_to_be_judged() -> None:
    """Paper 4414: two way-points were apart before they were rounded, and the curve needs that."""
    text = """format = 1
id = "rounded-together"
title = "Two way-points that rounding put together"
[source]
[robot]
name = "arm"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
joint_rows = [["0.91", "0.28", "1.51", "1.51", "1.12"]]
[limits]
velocity = [0.73]
[interpolant]
family = "clamped-b-spline"
degree = 4
knots = "averaged-continued"
parameters = "chord"
time = "timed"
[[claims]]
id = "fast"
quantity = "durations"
where = "Table 1"
durations = ["2.820", "4.246", "2.575", "2.085"]
total = "11.727"
[[claims]]
id = "smooth"
quantity = "statement"
where = "text"
checks = "continuous"
of = ["fast"]
"""
    two = """[[readings]]
id = "as-printed"
why = "the header"
[[readings]]
id = "degrees"
why = "another table"
units = { velocity = "deg/s" }
"""
    assert audit(parse_case(text + two, "together.toml"), certify_seconds=0).cases[0].judgements
    found = audit(parse_case(text, "together.toml"), certify_seconds=0).cases[0]
    words = {j.claim: j.verdict for j in found.judgements}
    assert words == {"fast": ClaimVerdict.SUPPORTED, "smooth": ClaimVerdict.NOT_CHECKABLE}
    why = next(j.why for j in found.judgements if j.claim == "smooth")
    assert "2 and 3 coincide" in why
