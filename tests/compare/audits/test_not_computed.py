"""What an audit cannot compute says why in one line, and everything else is judged as usual."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support.case_texts import BASE
from support.findings import audited_text, study_of, verdicts
from support.made_up import claim, entry, one_joint, paper, readings, row, sentence
from trajgap.compare.audits import CaseAudit, Study, audit, case_audit
from trajgap.compare.audits.case_audit import AuditReport
from trajgap.compare.audits.rules import RuleGroup
from trajgap.compare.cli import main
from trajgap.compare.documents import ClaimVerdict, Finding, Why
from trajgap.compare.gaps import reference_of
from trajgap.compare.pages import write_report
from trajgap.nlp import Solution, Status, solve
from trajgap.problem import (
    CaseError,
    Interpolant,
    Limits,
    Problem,
    ProcessError,
    TrajgapError,
    parse_case,
    rest_to_rest,
)

OPEN = ClaimVerdict.NOT_CHECKABLE
SEPTIC = {"family": "rest-to-rest", "degree": 7}
FREE = {"family": "polynomials", "degrees": [5, 5, 5], "free": 4}
UNSOLVED = FREE | {"end_orders": [1], "continuity": 1, "free": 8}


def text(curve: Any = None, particles: int = 6, **limits: Any) -> str:
    """Two joints, a row, its algorithm, and what is said of it."""
    settings = {"particles": particles, "iterations": 8}
    return paper(
        ["0.10 0.90 -0.30 0.40", "1.0 0.2 0.3 -0.5"],
        entry("algorithms", id="pso", name="PSO", kind="pso", settings=settings),
        row("d", "0.91 1.02 0.93", total="2.86", algorithm="pso"),
        claim("by", "convergence", algorithm="pso", iterations=5),
        sentence("shortest", "optimal", "d"),
        curve=curve or {"family": "3-5-3"},
        velocity=[2.0, 1.5],
        acceleration=[9.0, 8.0],
        **limits,
    )


@pytest.fixture(scope="module")
def free() -> CaseAudit:
    return audited_text(text(FREE))


def replays(one: CaseAudit) -> dict[str, str]:
    return {f.rule: f.message for f in one.findings if f.rule in ("TG402", "TG403")}


def test_a_relaxed_family_that_is_not_solved_is_a_step_without_a_time(tmp_path: Path) -> None:
    one = audited_text(text(SEPTIC), Study)
    write_report(AuditReport((one,)), tmp_path)
    steps = {step.name: step for step in one.waterfalls[0].steps}
    assert steps["relaxed family"].time == Why(
        "the relaxed family has 8 free coefficients per joint, and derivatives at the way-points "
        "settle 6 of them"
    )
    assert isinstance(steps["optimum of the same curve, shared durations"].time, float)
    assert verdicts(one)["d"] is verdicts(one)["shortest"] is ClaimVerdict.REFUTED


def test_an_algorithm_is_replayed_under_position_limits() -> None:
    """Limits that no motion comes near change nothing of what is said."""
    far = audited_text(text(position_lower=-4.0, position_upper=4.0))
    assert replays(far) == replays(audited_text(text())) != {}
    assert "not replayed" not in " ".join(replays(far).values())


def test_an_algorithm_that_cannot_judge_a_curve_is_not_replayed(free: CaseAudit) -> None:
    why = "The PSO is not replayed: interpolant 5-5-5 polynomials, C2: leaves 4"
    assert replays(free)
    assert all(message.startswith(why) for message in replays(free).values())


def test_durations_with_free_coefficients_define_no_motion(free: CaseAudit, tmp_path: Path) -> None:
    (found,) = (f for f in free.findings if f.rule == "TG502")
    assert (found.claim, found.problem, found.reading) == ("d", "main", "as-printed")
    assert "leaves 4 coefficients per joint free" in found.message
    # The total is the sum of its durations.
    assert verdicts(free) == {"by": OPEN, "shortest": OPEN, "d": ClaimVerdict.SUPPORTED}
    distance = next(f for f in free.findings if f.rule == "TG302" and f.claim == "d")
    assert "2.86 s is 19.2 to 19.7 % longer than the best known" in distance.message
    write_report(AuditReport((free,)), tmp_path)
    page = (tmp_path / "made-up.html").read_text("utf-8")
    assert "are not drawn: the curve (5-5-5 polynomials, C2) leaves 4" in page


def test_a_curve_that_cannot_be_solved_leaves_the_digits_judged() -> None:
    one = audited_text(text(UNSOLVED))
    about = next(f for f in one.findings if f.claim == "shortest")
    assert "no optimum was found (failed: interpolant 5-5-5 polynomials" in about.message
    assert [f.verdict for f in one.findings if f.rule == "TG101"] == [ClaimVerdict.SUPPORTED]


def broken_rule(study: Study) -> Iterator[Finding]:
    """A rule that cannot judge one claim."""
    for one in study.claims:
        if one.id == "by":
            raise TrajgapError("nobody knows")
        yield Finding(rule="TG101", basis="check", claim=one.id, kind="seen", sentences=("Seen",))


def failing(error: TrajgapError) -> Any:
    def rule(study: Study) -> Iterator[Finding]:
        if len(study.claims) > 1:
            raise error
        yield from ()

    return rule


TOGETHER = failing(TrajgapError("only together."))
SEEN = {("TG101", "d", "Seen"), ("TG101", "shortest", "Seen")}


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        (broken_rule, {*SEEN, ("TG502", "by", "Not computed: nobody knows.")}),
        # What fails for no single claim is said all the same.
        (TOGETHER, {("TG502", None, "Not computed: only together.")}),
    ],
)
def test_one_claim_that_fails_takes_no_other_with_it(
    rule: Any, said: set[tuple[str, str | None, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(case_audit, "GROUPS", (RuleGroup(rule, {}),))
    found = audited_text(text()).findings
    assert {(f.rule, f.claim, f.message) for f in found} == said
    assert len(found) == len(said)


@pytest.mark.parametrize(
    "error", [CaseError("partly.toml", "x", "is wrong"), ProcessError("workers: gone")]
)
def test_audits_outlive_bad_input(error: TrajgapError, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(case_audit, "GROUPS", (RuleGroup(failing(error), {}),))
    with pytest.raises(type(error), match=r"is wrong|workers: gone"):
        audited_text(text())


def test_wrong_settings_of_an_algorithm_end_an_audit_before_it_begins() -> None:
    with pytest.raises(TrajgapError, match=r"made-up\.toml: algorithms\.pso: particles"):
        audit(study_of(text(particles=-6)).case, seeds=2, certify_seconds=0)


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ('kind = "psso"', ("PSO: algorithm kind: 'psso' is unknown; did you mean 'pso'?",)),
        ("", ("PSO: the case file names no algorithm that trajgap implements.",)),
        ('kind = "pso"', ()),
    ],
)
def test_an_algorithm_that_nothing_replays_is_named(kind: str, said: tuple[str, ...]) -> None:
    assert Study(parse_case(BASE.replace('kind = "pso"', kind), "b.toml")).not_replayed == said


def test_printed_points_that_define_no_curve_leave_the_rest_to_be_judged() -> None:
    """Paper 4414: two way-points were apart before they were rounded, and the curve needs that."""
    curve = {"family": "clamped-b-spline", "degree": 4, "knots": "averaged-continued"}
    together = paper(
        ["0.91 0.28 1.51 1.51 1.12"],
        row("fast", "2.820 4.246 2.575 2.085", total="11.727"),
        sentence("smooth", "continuous", "fast"),
        curve=curve | {"parameters": "chord", "time": "timed"},
        velocity=[0.73],
    )
    two = readings(printed={}, degrees={"units": {"velocity": "deg/s"}})
    assert audited_text(together + two).judgements
    found = audited_text(together)
    assert verdicts(found) == {"fast": ClaimVerdict.SUPPORTED, "smooth": OPEN}
    why = next(j.why for j in found.judgements if j.claim == "smooth")
    assert "2 and 3 coincide" in why


SAID = "without limits there is no shortest motion (not checkable)"


def test_terminal_pages_and_json_say_that_there_is_no_shortest_motion(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "free.toml"
    path.write_text(one_joint("0.3, 1.7", "inf", "2.5", "optimal"), "utf-8")
    assert main(["audit", str(path), "--out", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    assert f"No optimum: {SAID}." in shown
    assert "0.000000" not in shown
    page = (tmp_path / "out" / "fair.md").read_text("utf-8")
    assert f"No optimum: {SAID}." in page
    assert "0.000000 s" not in page
    assert "+0.0 %" not in page.replace("\N{NO-BREAK SPACE}", " ")
    document = json.loads((tmp_path / "out" / "fair.json").read_text("utf-8"))
    steps = document["cases"][0]["waterfalls"][0]["steps"]
    optimum = next(step for step in steps if step["name"].startswith("optimum of the same curve"))
    assert optimum["time"] is None
    assert optimum["time_why"] == SAID
    assert main(["solve", str(path)]) == 0
    shown = capsys.readouterr().out
    assert SAID in shown
    assert "0.000000" not in shown


@pytest.mark.parametrize("degree", [3, 5])
def test_ends_in_motion_need_no_time_either(degree: int) -> None:
    """A cubic is determined; a quintic has coefficients left, as the relaxed family does."""
    ends = ((1, -3.2),), (), ((1, 1.3),)
    curve = Interpolant((degree,) * 2, (2,), ends)
    free = solve(Problem([[1.2], [-0.8], [0.3]], Limits(), curve))
    assert free.boundless == SAID


def test_an_infimum_above_zero_keeps_its_number() -> None:
    """A segment in which nothing moves goes to 0 s; the other one is limited."""
    q = [[0.2], [1.2], [1.2]]
    limited = solve(Problem(q, Limits(velocity=2.0), rest_to_rest(2, 5)))
    assert limited.status is Status.NOT_ATTAINED
    assert limited.boundless is None
    assert limited.infimum == pytest.approx(15 / 16, rel=1e-9)


def test_limits_that_hold_nothing_back_are_not_called_missing() -> None:
    """The total of a motion found is 0.01 s, what it approaches is 0, and a limit is stated."""
    limits = Limits(velocity=float("inf"), acceleration=2.0)
    problem = Problem([[0.0], [1.0]], limits, rest_to_rest(1, 5))
    found = Solution(problem, Status.NOT_ATTAINED, vector=problem.duration_lower + 0.01)
    assert found.boundless is None
    none = Solution(problem, Status.NOT_ATTAINED, vector=problem.duration_lower + 0.01, infimum=0.0)
    assert "without limits" not in none.boundless


def test_no_total_is_set_beside_an_infimum_that_rounding_keeps_from_zero() -> None:
    problem = Problem([[0.0], [1.0]], Limits(velocity=float("inf")), rest_to_rest(1, 5))
    h = problem.duration_lower + 0.01
    found = Solution(problem, Status.NOT_ATTAINED, vector=h, infimum=3.3e-14)
    assert found.best == 0.0
    assert reference_of(found) is None
