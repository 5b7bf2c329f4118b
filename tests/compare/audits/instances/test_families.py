"""Families of instances: what is drawn, computed, said and shown of them, and what is refused."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from support.checkout import ROOT
from support.documents import SCHEMA, validator
from support.findings import verdicts
from trajgap.compare import audit
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.instances import (
    drawn as family_study,
    examinable,
    examined as examine_once,
)
from trajgap.compare.audits.instances.drawn import printed_reduction
from trajgap.compare.audits.instances.result import (
    MIDDLE,
    InstancesResult,
    Optimum,
    Sample,
    distribution,
    reproduced,
)
from trajgap.compare.audits.rules.on_instances import _under, judge_instances
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Effect, Procedure, json_text
from trajgap.compare.pages.rendering import markdown
from trajgap.compare.pages.writer import case_page
from trajgap.compare.pictures.drawing import svg
from trajgap.compare.pictures.searches import instances_picture
from trajgap.nlp import Evidence
from trajgap.problem import Case, TrajgapError, evaluate, forward_kinematics, load_case, parse_case
from trajgap.problem.cases.instances import instance_waypoints

WHALE = "z1-woa-bspline"

SMALL = (ROOT / "tests/support/family.toml").read_text("utf-8")

UNSOLVED = (("upper = 8", "upper = 0.05"), ("initial = [0, 8]", "initial = [0, 0.05]"))
"""Changes after which nothing keeps its limits."""


def small(*changes: tuple[str, str]) -> Case:
    text = SMALL
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new)
    return parse_case(text, "small.toml")


def examined(*changes: tuple[str, str]) -> InstancesResult:
    study = Study(small(*changes), seeds=2, certify_seconds=0)
    return examine_once(study, examinable(study)[0])


@pytest.fixture(scope="module")
def result() -> InstancesResult:
    return examined()


def drawn(*changes: tuple[str, str]) -> np.ndarray:
    case = small(*changes)
    chain = case.chain()
    return instance_waypoints(case.instances[0], chain, case.robot.joints, 3)


def test_steps_of_joints_keep_their_length_and_every_step_has_its_own_stream() -> None:
    points = drawn()
    assert points.shape == (2, 2, 3, 2)
    change = np.abs(np.diff(points, axis=2)).max(axis=(1, 2, 3))
    assert (change <= [0.3, 0.9]).all()
    assert (change > [0.15, 0.45]).all()
    np.testing.assert_array_equal(drawn(("[0.3, 0.9]", "[0.9]"))[0], points[1])
    np.testing.assert_array_equal(drawn(("instances = 2", "instances = 5"))[:, :2], points)
    assert not np.array_equal(drawn(("seed = 5", "seed = 6")), points)


def test_steps_of_the_end_are_measured_at_the_end() -> None:
    case = load_case(WHALE)
    block = case.instances[0].model_copy(update={"instances": 1, "samples": 5000})
    chain = case.chain()
    points = instance_waypoints(block, chain, case.robot.joints, 8)
    assert points.shape == (3, 1, 8, 6)
    ends = forward_kinematics(chain, points.reshape(-1, 6))[:, :3, 3].reshape(3, 8, 3)
    way = np.linalg.norm(np.diff(ends, axis=1), axis=2)
    np.testing.assert_allclose(way, np.array(block.lengths)[:, None] * np.ones(7), rtol=0.1001)


def test_a_step_that_nothing_reaches_is_named() -> None:
    case = small(('kind = "joint"', 'kind = "end"'), ("[0.3, 0.9]", "[5]"))
    study = Study(case, seeds=2, certify_seconds=0)
    with pytest.raises(TrajgapError, match=r"^small\.toml: families\.drawn: step: none of the 50"):
        examine_once(study, examinable(study)[0])


def test_time_scaled_by_two_leaves_every_reduction_as_it_was(result: InstancesResult) -> None:
    # Powers of two are exact, so the runs themselves agree to the last bit.
    twice = examined(
        ("velocity = [1.5, 2.5]", "velocity = [3, 5]"),
        ("acceleration = [4, 3]", "acceleration = [16, 12]"),
        ("upper = 8", "upper = 4"),
        ("position_initial = [0, 8]", "position_initial = [0, 4]"),
    )
    for one, two in zip(result.samples, twice.samples, strict=True):
        np.testing.assert_array_equal(two.totals, one.totals / 2)
        assert two.slower.total == pytest.approx(one.slower.total / 2, rel=1e-9)
        assert two.faster.total == pytest.approx(one.faster.total / 2, rel=1e-9)
    for effect in (Effect.BOTH, Effect.ALGORITHM):
        one, two = (runs.reductions("as-printed", effect) for runs in (result, twice))
        np.testing.assert_array_equal(two, one)


def test_optima_against_a_scan_of_the_shares(result: InstancesResult) -> None:
    shares = np.linspace(0.02, 0.98, 4001)
    unit = np.stack([shares, 1 - shares], axis=1)
    case = small()
    for s in result.of("as-printed"):
        asked = {pid: case.statement(pid).problem_at(s.waypoints) for pid in ("spline", "stops")}
        spline = evaluate(asked["spline"], unit).stretch.min()
        assert s.faster.total == pytest.approx(spline, rel=1e-4)
        assert s.faster.total <= spline * (1 + 1e-9)
        way = np.abs(np.diff(s.waypoints, axis=0))
        each = np.maximum(15 / 8 * way / [1.5, 2.5], np.sqrt(10 / np.sqrt(3) * way / [4.0, 3.0]))
        assert s.slower.total == pytest.approx(each.max(axis=1).sum(), rel=1e-9)


def test_a_curve_beside_itself_saves_nothing(result: InstancesResult) -> None:
    assert result.reductions("joined", Effect.CURVE) == pytest.approx(np.zeros(4), abs=0.0)
    alone = result.reductions("joined", Effect.ALGORITHM)
    np.testing.assert_array_equal(result.reductions("joined", Effect.BOTH), alone)
    np.testing.assert_array_equal(result.reductions("as-printed", Effect.ALGORITHM), alone)


def test_no_answer_is_below_the_best_known_optimum_of_its_curve(result: InstancesResult) -> None:
    for s in result.samples:
        assert (s.totals[:, 0] >= s.slower.total * (1 - 1e-8)).all()
        assert (s.totals[:, 1:] >= s.faster.total * (1 - 1e-8)).all()


def test_failures_are_kept_and_counted() -> None:
    found = examined(*UNSOLVED)
    assert np.isinf([s.totals for s in found.samples]).all()
    assert len(found.unsolved) == 2 * len(found.samples)
    assert "step 0.9, instance 2, quintic spline: infeasible" in "; ".join(found.unsolved)
    assert found.failed("as-printed") == 4 * 3 * 2
    spread = distribution(found.reductions("as-printed", Effect.BOTH))
    assert (spread.pairs, spread.missing) == (16, 16)
    assert str(spread) == "no pair of answers in 16"
    assert np.isnan(spread.shorter)


def test_an_answer_that_the_checker_does_not_pass_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(family_study, "TOLERANCE", -2.0)
    found = examined(("instances = 2", "instances = 1"), ("[0.3, 0.9]", "[0.3]"))
    assert np.isinf([s.totals for s in found.samples]).all()


def made(before: list[float], after: list[float], printed: tuple[float, float]) -> InstancesResult:
    """One instance with given totals of the slower and the faster procedure."""
    totals = np.array([[before, before, after]] * 2)
    known = [Optimum(t, Evidence.BEST_KNOWN, "optimal") for t in (2.0, 1.0)]
    block = small().instances[0]
    sample = Sample(
        "as-printed", 0.3, 0, np.zeros((3, 2)), *known, totals, np.zeros(totals.shape, np.intp)
    )  # fmt: skip
    asked = (("stops", "plain"), ("spline", "new"))
    sides = [Procedure(problem=problem, algorithm=name) for problem, name in asked]
    return InstancesResult(block, *sides, printed, ("as-printed",), 12, (sample,))


def test_quantiles_of_every_pair_of_runs() -> None:
    found = made([2.0, 4.0], [1.0, np.inf], (0.4, 0.5))
    values = found.reductions("as-printed", Effect.BOTH)
    np.testing.assert_array_equal(values, [0.5, np.nan, 0.75, np.nan])
    spread = distribution(values)
    assert (spread.pairs, spread.missing, spread.shorter) == (4, 2, 1.0)
    assert (spread.lowest, spread.median, spread.highest) == (0.5, 0.625, 0.75)
    assert (spread.lower_quarter, spread.upper_quarter) == (0.5625, 0.6875)
    assert str(spread) == "median 62.5 % (50.0 to 75.0 %), 2 of 4 without answer"
    assert found.reductions("as-printed", Effect.CURVE).tolist() == [0.5]
    worse = distribution(np.array([-0.25, 0.0]))
    assert worse.shorter == 0.0
    assert str(worse) == "median −12.5 % (−25.0 to 0.0 %)"


def test_the_sentences_of_a_reading_hold_its_numbers() -> None:
    """Totals of 2 and 4 s beside 1 s: reductions of 50 and 75 %, of which one reaches 51 %."""
    runs = made([2.0, 4.0], [1.0, 1.0], (0.51, 0.52))
    told = _under(replace(runs, printed_totals=(None, "1.2 s")), "as-printed").message
    assert "is usual here: it lies within the middle" in told
    assert "50 % of them are at least as large." in told
    assert "The paper prints 1.2 s; the procedure of the paper takes 1 s at the median" in told
    assert "compared with the paper's" not in told


@pytest.mark.parametrize(
    ("printed", "expected"),
    [((0.50, 0.51), True), ((0.3, 0.52), True), ((0.45, 0.49), False), ((0.76, 0.9), False)],
)
def test_reproduced_means_within_the_middle(printed: tuple[float, float], expected: bool) -> None:
    runs = made([2.0], [1.0], printed)
    assert reproduced(runs, "as-printed") is expected
    said = "usual here: it lies within" if expected else "unusual here: it lies outside"
    assert f" is {said} the middle" in _under(runs, "as-printed").message
    assert not reproduced(replace(runs, printed=None), "as-printed")


def test_the_printed_reduction_is_an_interval_of_the_digits() -> None:
    study = Study(load_case(WHALE), seeds=2, certify_seconds=0)
    # The design itself: to say that it can be examined, `examinable` would examine it.
    low, high = printed_reduction(study, study.case.instances[0]) or (0, 0)
    assert low == pytest.approx(1 - 11.715 / 13.075, rel=1e-12)
    assert high == pytest.approx(1 - 11.705 / 13.085, rel=1e-12)
    printed = small(('slower = "old-total"', 'slower = "old-total"\npercent = "24.9"'))
    study = Study(printed, seeds=2, certify_seconds=0)
    assert examine_once(study, printed.instances[0]).printed == pytest.approx((0.2485, 0.2495))


def test_findings_inform_and_decide_nothing() -> None:
    study = Study(small(), seeds=2, certify_seconds=0)
    found = list(judge_instances(study))
    readings = [("better", None), ("better", "as-printed"), ("better", "joined"), ("settles", None)]
    assert [(f.claim, f.reading) for f in found] == readings
    for f in found:
        assert (f.rule, f.severity, f.verdict) == ("TG404", "info", "not checkable")
        assert not f.decides
    words = verdicts(audit_case(study))
    names = ("old-total", "new-total", "better", "settles")
    assert words == dict.fromkeys(names, ClaimVerdict.NOT_CHECKABLE)


def test_without_a_pair_of_answers_nothing_is_computed() -> None:
    case = small(*UNSOLVED, ("instances = 2", "instances = 1"))
    found = list(judge_instances(Study(case, seeds=2)))
    assert found[0].computed == "no pair of answers"
    assert "12 runs found no motion" in found[1].message


def test_one_problem_or_reading_selects() -> None:
    assert examinable(Study(small(), seeds=2, problem="spline", certify_seconds=0)) == ()
    study = Study(small(), seeds=2, reading="joined", certify_seconds=0)
    assert examine_once(study, examinable(study)[0]).readings == ("joined",)
    unknown = small(('kind = "woa"', 'kind = "not-written"'))
    assert examinable(Study(unknown, seeds=2, certify_seconds=0)) == ()


@pytest.fixture(scope="module")
def report():
    return audit(small(), seeds=2, certify_seconds=0)


def test_the_page_has_the_comparison(report) -> None:
    page = case_page(report.cases[0])
    (section,) = (s for s in page.sections if s.id == "families")
    text = markdown(replace(page, sections=(section,)))
    assert "refuted" not in text
    assert "![Reduction of the total, Table 1, on 4 instances]" in text
    assert "4 for each step" not in text
    assert "2 for each step of 0.3, 0.9 rad (largest change of any joint)" in text
    assert "| as-printed | 0.9 | 2 |" in text
    block = SMALL[SMALL.index("[[families]]") : SMALL.index("[[claims]]")]
    plain = audit(small((block, "")), seeds=2, certify_seconds=0)
    assert "families" not in [s.id for s in case_page(plain.cases[0]).sections]


def test_the_document_is_valid_and_whole(report) -> None:
    document = json.loads(json_text(report.document))
    validator().validate(document)
    (one,) = document["cases"][0]["families"]
    assert SCHEMA["$defs"]["effect"]["enum"] == [str(effect) for effect in Effect]
    assert set(one) <= set(SCHEMA["$defs"]["examined_instances"]["properties"])
    whole = [r for r in one["reductions"] if r["step"] is None]
    assert len(whole) == 2 * (2 + 2 + 1)
    assert len(one["instances"]) == 4
    assert all(len(i["readings"]) == 2 for i in one["instances"])
    totals = one["instances"][0]["readings"][0]["totals"]
    assert [t["objective"] for t in totals] == ["death-penalty", "stretch"]
    assert len(totals[0]["faster"]) == 2
    assert one["printed_lowest"] == pytest.approx(1 - 1.505 / 1.995)


def test_the_picture_shows_every_pair(result: InstancesResult) -> None:
    picture = instances_picture(result, title="saved")
    assert svg(picture) == svg(instances_picture(result, title="saved"))
    both, alone, curve = picture.axes
    points = np.concatenate([c.get_offsets() for c in both.collections if len(c.get_offsets())])
    shown = np.sort(points[:, 0])
    values = [result.reductions(r, Effect.BOTH, at) for r in result.readings for at in (0, 1)]
    np.testing.assert_allclose(shown, np.sort(100 * np.concatenate(values)), rtol=1e-12)
    labels = [result.label(reading) for reading in result.readings]
    assert [t.get_text() for t in both.get_yticklabels()] == labels
    assert sum(len(c.get_offsets()) for c in curve.collections) == len(result.samples)
    assert alone.get_title(loc="left") == "algorithm alone"
    assert "as-printed: both together median" in picture.description
    assert "printed: 24.56 to 25.44 %" in picture.description


def test_the_page_names_the_readings_and_the_share_of_the_rule() -> None:
    page = (ROOT / "docs/measurements/families.md").read_text("utf-8")
    page, _, _ = page.partition("\n\n## Sixty instances")
    (block,) = load_case(WHALE).instances
    assert f"{100 * MIDDLE:g} %" in page
    assert re.findall(r"^\| `([\w-]+)` \| ", page, re.MULTILINE) == list(block.readings)


def test_instances_are_resampled_and_not_pairs_of_runs(result: InstancesResult) -> None:
    reading = result.readings[0]
    each = [distribution(s.reductions(Effect.BOTH)).median for s in result.of(reading)]
    low, high = result.median_interval(reading, Effect.BOTH)
    assert min(each) <= low <= np.median(each) <= high <= max(each)
    # With two instances, half of all samples draw one of them twice: the ends are the two.
    two = replace(result, samples=result.of(reading)[:2])
    ends = sorted(distribution(s.reductions(Effect.BOTH)).median for s in two.samples)
    assert two.median_interval(reading, Effect.BOTH) == pytest.approx(ends)
    alone = replace(result, samples=result.of(reading)[:1])
    assert np.isnan(alone.median_interval(reading, Effect.BOTH)[0])
    # The same runs twice on each instance tell nothing new.
    twice = (replace(s, totals=np.concatenate([s.totals] * 2, axis=2)) for s in result.samples)
    doubled = replace(result, samples=tuple(twice))
    assert doubled.median_interval(reading, Effect.BOTH) == pytest.approx((low, high))
