"""The word "certified": said of what was proved again, and of nothing else."""

import copy
from dataclasses import replace
from fractions import Fraction
from functools import cache
from importlib import import_module

import numpy as np
import pytest
from support.checkout import ROOT
from support.documents import assert_valid, plain
from support.shipped_problems import COVERED_PROBLEMS
from trajgap.compare.audits import Pair
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.study import Study, Total
from trajgap.compare.audits.waterfall import waterfalls
from trajgap.compare.documents import Gap, SolveDocument, Why, solve_result
from trajgap.nlp import (
    Evidence,
    ProvedInterval,
    Status,
    certificate,
    certify,
    estimate_any_curve,
    proved,
    shipped,
    solve as solve_and_prove,
    solve_per_joint,
    weakest,
    with_interval,
)
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.solution import WIDEST
from trajgap.nlp.proofs import interval_of, printed_problem_or_none
from trajgap.nlp.proofs.evidence import _proved_answer
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.problem import Limits, Problem, check, cubic_spline, load_case, rest_to_rest
from trajgap.verify import Subject

evidence_module = import_module("trajgap.nlp.proofs.evidence")
intervals_module = import_module("trajgap.compare.audits.intervals")
certificate_module = import_module("trajgap.nlp.proofs.document")
IRB, PUMA, GA = "irb460-pso-353", "puma560-mnam-pso-353", "irb1600-ga-cubic-bspline"
PAIR = Pair("limit-80", "waypoints-rad")
EXACT = COVERED_PROBLEMS[f"{IRB}.{PAIR[0]}.{PAIR[1]}"]
VERDICTS = (ROOT / "docs/explanation/verdicts.md").read_text("utf-8")


@pytest.fixture
def without_certificates(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (evidence_module, intervals_module):
        monkeypatch.setattr(module, "proved", lambda *_: None)


def one_study() -> Study:
    return Study(load_case(IRB), seeds=2, problem=PAIR[0], reading=PAIR[1], certify_seconds=0)


@cache
def known_study() -> Study:
    """One whose optimum and estimate are computed once; what is proved is asked each time."""
    return one_study()


def said(study: Study) -> tuple[list[str], set[Evidence]]:
    """Every sentence and every evidence word beside an optimum."""
    findings = list(judge_distances(study))
    steps = [step for waterfall in waterfalls(study) for step in waterfall.steps]
    texts = [f.message for f in findings] + [f"{s.name} {s.note}" for s in steps]
    return texts, {f.evidence for f in findings} | {s.evidence for s in steps}


def test_what_is_proved_is_called_certified() -> None:
    study = known_study()
    texts, words = said(study)
    assert Evidence.CERTIFIED in words
    assert any("certified optimum" in text and "proved, gap" in text for text in texts)
    answer = study.optimum(PAIR)
    interval = proved(printed_problem(study.case.statement(*PAIR)))
    assert Fraction(answer.lower_bound) <= interval.lower < answer.total_time
    (waterfall,) = waterfalls(study)
    step = next(s for s in waterfall.steps if s.name.startswith("optimum"))
    assert (step.low, step.high) == (answer.lower_bound, answer.total_time)
    assert "proved" in str(answer)


@pytest.mark.parametrize(("width", "word"), [(0.009, "certified"), (0.05, "best known")])
def test_a_proof_of_a_wide_interval_certifies_nothing(
    monkeypatch: pytest.MonkeyPatch, width: float, word: str
) -> None:
    assert f"at most {float(100 * WIDEST):g} % wide" in VERDICTS
    problem = replace(EXACT, name=f"width {width}")
    document = certificate(certify(problem, gap=width))
    monkeypatch.setattr(evidence_module, "shipped", lambda *_: document)
    answer = solve(known_study().problem(PAIR))
    evidence_module.proved.cache_clear()
    assert with_interval(answer, proved(problem)).evidence == word
    evidence_module.proved.cache_clear()


@pytest.mark.usefixtures("without_certificates")
def test_nothing_is_called_certified_without_a_certificate() -> None:
    study = one_study()
    texts, words = said(study)
    assert Evidence.CERTIFIED not in words
    assert not any("certified" in text for text in texts)
    assert any("best known optimum" in text for text in texts)
    document = plain(SolveDocument(results=(solve_result(IRB, *PAIR, study.optimum(PAIR)),)))
    assert_valid(document, "solve")
    assert document["results"][0]["lower_bound"] is None
    assert document["results"][0]["evidence"] == "best known"


def test_a_certificate_that_proves_no_claim_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = copy.deepcopy(shipped(EXACT))
    wrong["claim"]["lower"] = str(Fraction(wrong["claim"]["lower"]) * 2)
    monkeypatch.setattr(certificate_module, "all_shipped", lambda: (wrong,))
    assert shipped(EXACT) == wrong
    assert evidence_module.proved.__wrapped__(EXACT) is None


def test_a_certificate_of_another_problem_is_not_used() -> None:
    other = replace(EXACT, duration_lower=(Fraction(1, 10**9), *EXACT.duration_lower[1:]))
    assert proved(other) is None
    assert proved(EXACT, Subject.ANY) is None or shipped(EXACT, Subject.ANY) is not None
    assert proved(replace(EXACT, name="another name")) == proved(EXACT)


@pytest.mark.parametrize(
    "forged",
    [
        {"curve": "x", "ends": ["-1", "-1"]},
        {"curve": "x", "ends": ["-1", "-1"], "virtual": []},
        {"prescribed": [[[1, "-1"]], [], [], [[1, "-1"]]], "ends": ["0", "0"]},
    ],
)
def test_a_certificate_for_other_end_velocities_is_not_used(
    monkeypatch: pytest.MonkeyPatch, forged: dict[str, object]
) -> None:
    # The question and the verifier must read the ends in the same place.
    exact = COVERED_PROBLEMS[f"{PUMA}.six-joints.durations-positive"]
    document = shipped(exact, Subject.ANY)
    if "curve" in forged:
        for key in ("degrees", "continuity"):
            del document["problem"][key]
    document["problem"] |= forged
    monkeypatch.setattr(certificate_module, "all_shipped", lambda: (document,))
    assert shipped(exact, Subject.ANY) is None
    assert evidence_module.proved.__wrapped__(exact, Subject.ANY) is None


def test_every_shipped_reading_that_is_covered_is_certified() -> None:
    case = load_case(GA)
    words = {}
    for reading in case.readings:
        exact = printed_problem_or_none(case.statement("nine-segments", reading.id))
        words[reading.id] = exact is not None and proved(exact) is not None
    assert {name for name, found in words.items() if found} == {
        name for name in words if name.endswith("stretched") and "modulo" not in name
    }


def test_a_closed_form_needs_no_file() -> None:
    problem = Problem([[0.0], [1.0], [0.25]], Limits(1.0, 2.0), rest_to_rest(2, 5))
    assert shipped(exact_problem(problem)) is None
    answer = with_interval(solve(problem), proved(exact_problem(problem)))
    assert answer.evidence is Evidence.CERTIFIED
    assert answer.lower_bound == pytest.approx(answer.total_time, rel=1e-8)
    spline = Problem([[0.0], [1.0], [0.25]], Limits(1.0, 2.0), cubic_spline(2))
    bounds = proved(exact_problem(spline))
    assert with_interval(solve(spline), bounds).evidence is Evidence.BEST_KNOWN


@pytest.mark.parametrize(
    ("factor", "evidence"), [(0.99, Evidence.BEST_KNOWN), (1.2, Evidence.CERTIFIED)]
)
def test_an_answer_beyond_the_interval(factor: float, evidence: Evidence) -> None:
    """Below it it is not certified, and above it that of the certificate takes its place."""
    answer = known_study().optimum(PAIR)
    h = answer.durations * factor
    other = replace(answer, status=Status.CONVERGED, vector=h, lower_bound=None)
    found = with_interval(other, proved(EXACT))
    assert found.evidence is evidence
    if factor > 1.0:
        assert found.total_time == pytest.approx(answer.total_time, rel=1e-9)


def test_an_answer_that_rounding_puts_below_the_bound_takes_the_proved_durations() -> None:
    problem = Problem([[0.0], [1.0], [0.25]], Limits(1.0, 2.0), rest_to_rest(2, 5))
    exact = exact_problem(problem)
    found = proved(exact)
    answer = solve(problem)
    bound = float(found.lower)
    below = answer.durations * (bound / answer.durations.sum()) * (1 - 1e-14)
    kept = with_interval(replace(answer, vector=below, lower_bound=None), proved(exact))
    assert kept.evidence is Evidence.CERTIFIED
    assert sum(map(Fraction, kept.durations.tolist())) >= found.lower
    assert kept.check.peaks == check(problem, kept.durations).peaks
    farther = below * (1 - 1e-11)
    short = with_interval(replace(answer, vector=farther, lower_bound=None), proved(exact))
    assert short.evidence is Evidence.BEST_KNOWN


def test_the_output_of_a_procedure_is_not_certified() -> None:
    case = load_case(PUMA)
    pair = ("six-joints", "durations-positive")
    problem = case.problem(*pair)
    unaided = solve_per_joint(problem, slacks=())
    answer = solve_per_joint(problem, slacks=(), solver=solve_and_prove)
    # A proved bound saves descents; what they find agrees to rounding.
    for one, other in zip(unaided.joints, answer.joints, strict=True):
        assert one.total_time == pytest.approx(other.total_time, rel=1e-9)
        assert one.iterations >= other.iterations
    assert {s.status for s in answer.joints} == {Status.OPTIMAL}
    assert answer.status is Status.CONVERGED
    assert {s.evidence for s in answer.joints} == {Evidence.CERTIFIED}
    assert answer.joint_evidence is Evidence.CERTIFIED
    assert answer.evidence is Evidence.BEST_KNOWN
    document = plain(SolveDocument(results=(solve_result(PUMA, *pair, answer),)))
    assert_valid(document, "solve")
    result = document["results"][0]
    assert (result["evidence"], result["lower_bound"]) == ("best known", None)
    assert all(joint["evidence"] == "certified" for joint in result["joints"])
    assert all(joint["lower_bound"] < joint["total_time"] for joint in result["joints"])


def test_the_weakest_word_stands_for_all() -> None:
    C, B, N = Evidence.CERTIFIED, Evidence.BEST_KNOWN, Evidence.NONE
    assert weakest([C, B, C]) is B
    assert weakest([N, C]) is N
    assert weakest([C]) is C
    assert weakest([]) is N


def test_a_total_below_the_proved_bound_is_called_that(monkeypatch: pytest.MonkeyPatch) -> None:
    study = known_study()
    monkeypatch.setattr(Study, "claim_total", lambda *_: Total("1.5 s", (1.4995, 1.5005)))
    found = [f for f in judge_distances(study) if f.claim == "durations-80"]
    (message,) = (f.message for f in found if isinstance(f.gap, Gap))
    assert "below the proved lower bound of this problem" in message
    assert "best known" not in message


def only_any(bound: ProvedInterval, monkeypatch: pytest.MonkeyPatch) -> None:
    found = {Subject.ANY: bound}
    monkeypatch.setattr(intervals_module, "proved", lambda _, subject: found.get(subject))


@pytest.mark.parametrize("upper", [None, Fraction(1, 2)])
def test_a_bound_for_any_curve_stands_on_the_waterfall(
    monkeypatch: pytest.MonkeyPatch, upper: Fraction | None
) -> None:
    only_any(ProvedInterval(Fraction(2, 5), upper, None, False), monkeypatch)
    (waterfall,) = waterfalls(known_study())
    step = waterfall.steps[-1]
    # The nearest double lies above 2/5, and would be no lower bound.
    assert step.low == np.nextafter(0.4, 0.0)
    assert step.note.count("no motion within the limits is shorter than 0.4 s: certified") == 1
    if upper is None:
        assert step.evidence is Evidence.BEST_KNOWN
        assert isinstance(step.time, float)
        assert step.time > 0.5
    else:
        assert (step.time, step.evidence) == (0.5, Evidence.CERTIFIED)


@pytest.mark.parametrize(("above", "certified"), [(1e-15, True), (1e-6, False)])
def test_a_bound_for_any_curve_may_round_above_the_answer_and_no_more(
    monkeypatch: pytest.MonkeyPatch, above: float, certified: bool
) -> None:
    study = known_study()
    found = estimate_any_curve(study.problem(study.pairs[0])).total_time
    lower = Fraction(found) * Fraction(1 + above)
    only_any(ProvedInterval(lower, lower + Fraction(1, 10**9), None, False), monkeypatch)
    step = waterfalls(study)[0].steps[-1]
    assert (step.evidence is Evidence.CERTIFIED) == certified
    assert isinstance(step.time, float)
    assert isinstance(step.low, Why) or step.low <= step.time


def test_a_problem_that_no_certificate_can_state_is_not_certified() -> None:
    """1e-300 has more digits than a certificate may write."""
    tiny = Problem([[1e-300], [0.4], [0.9]], Limits(2.0), cubic_spline(2))
    exact = exact_problem(tiny)
    assert proved(exact) is None
    other = printed_problem_or_none(load_case("irb460-pso-353").statement("limit-80"))
    assert other is not None
    document = shipped(other)
    assert document is not None
    assert interval_of(document, exact) is None
    found = interval_of(document, other)
    assert found.upper is not None


def test_proved_durations_are_rounded_up_to_floats() -> None:
    """Rounded to the nearest float, some would be shorter than what is proved."""
    problem = Problem([[0.0], [1.0], [0.4], [0.9]], Limits(1.0, 2.0), rest_to_rest(3, 3))
    answer = solve(problem)
    durations = tuple(Fraction(h) for h in answer.durations.tolist())
    tiny = Fraction(1, 10**25)
    found = _proved_answer(answer, (durations[0] - tiny, durations[1], durations[2] + tiny))
    longer = np.nextafter(answer.durations[2], np.inf)
    assert found.durations.tolist() == [*answer.durations[:2].tolist(), longer]
