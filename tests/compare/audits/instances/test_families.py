"""Families of instances: what is drawn, what is computed of it, and what is said of it."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
from support.checkout import ROOT
from trajgap.compare import audit
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.instances import study as family_study
from trajgap.compare.audits.instances.pose import printed_reduction
from trajgap.compare.audits.instances.result import (
    MIDDLE,
    InstancesResult,
    Optimum,
    Sample,
    distribution,
    percent_range,
    reproduced,
)
from trajgap.compare.audits.rules.on_instances import judge_instances
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Effect, Procedure, json_text
from trajgap.compare.pages.markdown_text import markdown
from trajgap.compare.pages.writer import case_page
from trajgap.compare.pictures.drawing import svg
from trajgap.compare.pictures.instances import instances_picture
from trajgap.nlp import Evidence
from trajgap.problem import (
    Case,
    CaseError,
    ClampedBSpline,
    Problem,
    TrajgapError,
    evaluate,
    forward_kinematics,
    jtraj,
    load_case,
    parse_case,
    quintic_spline,
)
from trajgap.problem.cases.instances import instance_waypoints

WHALE = "z1-woa-bspline"

SMALL = """
format = 1
id = "small"
title = "two joints"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1", "2"]
[robot.dh]
convention = "standard"
length_unit = "m"
angle_unit = "rad"
d = [0, 0]
a = [0.5, 0.3]
alpha = [0, 0]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
not_printed = "lost"
count = 3
[limits]
velocity = [1.5, 2.5]
acceleration = [4, 3]
[durations]
upper = 8
[[problems]]
id = "spline"
interpolant = { family = "quintic-spline" }
[[problems]]
id = "stops"
interpolant = { family = "jtraj" }
[[readings]]
id = "as-printed"
why = "as printed."
default = true
[[readings]]
id = "joined"
why = "the other curve."
interpolant_of = ["stops"]
interpolant = { family = "quintic-spline" }
[[algorithms]]
id = "plain"
name = "plain"
kind = "woa"
settings = { whales = 8, iterations = 12, position_initial = [0, 8] }
[[algorithms]]
id = "new"
name = "new"
kind = "improved-woa"
settings = { whales = 8, iterations = 12, position_initial = [0, 8] }
[[families]]
id = "drawn"
claim = "better"
why = "They are like the paper's."
kind = "joint"
steps = [0.3, 0.9]
instances = 2
seed = 5
samples = 50
[[claims]]
id = "old-total"
quantity = "total_time"
where = "Table 1"
problem = "stops"
algorithm = "plain"
value = "2.00"
[[claims]]
id = "new-total"
quantity = "total_time"
where = "Table 1"
problem = "spline"
algorithm = "new"
value = "1.50"
[[claims]]
id = "better"
quantity = "improvement"
where = "Table 1"
slower = "old-total"
faster = "new-total"
[[claims]]
id = "settles"
quantity = "convergence"
where = "Fig. 1"
problem = "spline"
algorithm = "new"
iterations = "10"
"""


def small(*changes: tuple[str, str]) -> Case:
    text = SMALL
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new)
    return parse_case(text, "small.toml")


def examined(*changes: tuple[str, str], workers: int = 1) -> InstancesResult:
    study = Study(small(*changes), seeds=2, workers=workers, certify_seconds=0)
    return study.instances(study.instance_blocks[0])


@pytest.fixture(scope="module")
def result() -> InstancesResult:
    return examined()


# --- what is drawn --------------------------------------------------------------------------------


def drawn(*changes: tuple[str, str]) -> np.ndarray:
    case = small(*changes)
    chain = case.chain()
    assert chain is not None
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
    assert chain is not None
    points = instance_waypoints(block, chain, case.robot.joints, 8)
    assert points.shape == (3, 1, 8, 6)
    ends = forward_kinematics(chain, points.reshape(-1, 6))[:, :3, 3].reshape(3, 8, 3)
    way = np.linalg.norm(np.diff(ends, axis=1), axis=2)
    np.testing.assert_allclose(way, np.array(block.lengths)[:, None] * np.ones(7), rtol=0.1001)


def test_a_step_that_nothing_reaches_is_named() -> None:
    case = small(('kind = "joint"', 'kind = "end"'), ("[0.3, 0.9]", "[5]"))
    study = Study(case, seeds=2, certify_seconds=0)
    with pytest.raises(TrajgapError, match=r"^small\.toml: families\.drawn: step: none of the 50"):
        study.instances(study.instance_blocks[0])


# --- what is computed -----------------------------------------------------------------------------


def test_same_bits_on_any_number_of_workers(result: InstancesResult) -> None:
    other = examined(workers=2)
    assert [(s.reading, s.step, s.index) for s in other.samples] == [
        (s.reading, s.step, s.index) for s in result.samples
    ]
    for one, two in zip(result.samples, other.samples, strict=True):
        np.testing.assert_array_equal(one.waypoints, two.waypoints)
        np.testing.assert_array_equal(one.totals, two.totals)
        np.testing.assert_array_equal(one.settled, two.settled)
        assert (one.slower, one.faster) == (two.slower, two.faster)


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
        np.testing.assert_array_equal(
            twice.reductions("as-printed", effect), result.reductions("as-printed", effect)
        )


def test_one_segment_by_hand() -> None:
    # Through two way-points both curves are one quintic from rest to rest: largest velocity
    # 15/8 Δ/T, largest acceleration (10/√3) Δ/T².
    found = examined(("count = 3", "count = 2"))
    for s in found.of("as-printed"):
        way = np.abs(s.waypoints[1] - s.waypoints[0])
        times = np.maximum(
            15 / 8 * way / [1.5, 2.5], np.sqrt(10 / np.sqrt(3) * way / np.array([4.0, 3.0]))
        )
        assert s.faster.total == pytest.approx(times.max(), rel=1e-9)
        assert s.slower.total == pytest.approx(times.max(), rel=1e-9)
        assert s.reductions(Effect.CURVE) == pytest.approx([0.0], abs=1e-9)
        assert (s.totals >= times.max() * (1 - 1e-8)).all()


def test_optima_against_a_scan_of_the_shares(result: InstancesResult) -> None:
    shares = np.linspace(0.02, 0.98, 4001)
    unit = np.stack([shares, 1 - shares], axis=1)
    case = small()
    for s in result.of("as-printed"):
        posed = {pid: case.statement(pid).problem_at(s.waypoints) for pid in ("spline", "stops")}
        spline = evaluate(posed["spline"], unit).stretch.min()
        assert s.faster.total == pytest.approx(spline, rel=1e-4)
        assert s.faster.total <= spline * (1 + 1e-9)
        way = np.abs(np.diff(s.waypoints, axis=0))
        each = np.maximum(15 / 8 * way / [1.5, 2.5], np.sqrt(10 / np.sqrt(3) * way / [4.0, 3.0]))
        assert s.slower.total == pytest.approx(each.max(axis=1).sum(), rel=1e-9)


def test_a_curve_beside_itself_saves_nothing(result: InstancesResult) -> None:
    assert result.reductions("joined", Effect.CURVE) == pytest.approx(np.zeros(4), abs=0.0)
    np.testing.assert_array_equal(
        result.reductions("joined", Effect.BOTH), result.reductions("joined", Effect.ALGORITHM)
    )
    np.testing.assert_array_equal(
        result.reductions("joined", Effect.ALGORITHM),
        result.reductions("as-printed", Effect.ALGORITHM),
    )


def test_no_answer_is_below_the_best_known_optimum_of_its_curve(result: InstancesResult) -> None:
    for s in result.samples:
        assert (s.totals[:, 0] >= s.slower.total * (1 - 1e-8)).all()
        assert (s.totals[:, 1:] >= s.faster.total * (1 - 1e-8)).all()


def test_the_faster_form_of_a_clamped_spline_is_the_same_curve() -> None:
    rng = np.random.default_rng(4)
    points, durations = rng.normal(size=(5, 2)), rng.uniform(0.4, 2.0, (9, 4))
    limits = small().statement("spline").data()[1]
    for degree, orders in ((5, (1, 2)), (3, (1,))):
        clamped = ClampedBSpline(5, degree, end_orders=orders)
        fast = clamped.polynomial_form()
        one, other = (evaluate(Problem(points, limits, c), durations) for c in (clamped, fast))
        np.testing.assert_allclose(other.ratios, one.ratios, rtol=1e-9)
    assert ClampedBSpline(5, 5).polynomial_form() == quintic_spline(4)
    averaged = ClampedBSpline(5, 5, "averaged-continued")
    assert averaged.polynomial_form() is averaged
    chord = ClampedBSpline(5, 5, "waypoints", "chord")
    assert chord.polynomial_form() is chord
    stops = jtraj(3)
    assert stops.polynomial_form() is stops


def test_failures_are_kept_and_counted() -> None:
    found = examined(("upper = 8", "upper = 0.05"), ("position_initial = [0, 8]",
                     "position_initial = [0, 0.05]"))  # fmt: skip
    assert np.isinf([s.totals for s in found.samples]).all()
    assert len(found.unsolved) == 2 * len(found.samples)
    assert "step 0.9, instance 2, joined: infeasible" in "; ".join(found.unsolved)
    assert found.failed("as-printed") == 4 * 3 * 2
    spread = distribution(found.reductions("as-printed", Effect.BOTH))
    assert (spread.pairs, spread.missing) == (16, 16)
    assert str(spread) == "no pair of answers in 16"
    assert np.isnan(spread.shorter)


def test_an_answer_that_the_checker_does_not_pass_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(family_study, "TOLERANCE", -2.0)
    found = examined(("instances = 2", "instances = 1"), ("[0.3, 0.9]", "[0.3]"))
    assert np.isinf([s.totals for s in found.samples]).all()


# --- what is said ---------------------------------------------------------------------------------


def made(before: list[float], after: list[float], printed: tuple[float, float]) -> InstancesResult:
    """One instance with given totals of the slower and the faster procedure."""
    totals = np.array([[before, before, after]] * 2)
    known = [Optimum(t, Evidence.BEST_KNOWN, "optimal") for t in (2.0, 1.0)]
    block = small().instances[0]
    sample = Sample(
        "as-printed", 0.3, 0, np.zeros((3, 2)), *known, totals, np.zeros(totals.shape, np.intp)
    )  # fmt: skip
    sides = [
        Procedure(problem="stops", algorithm="plain"),
        Procedure(problem="spline", algorithm="new"),
    ]
    return InstancesResult(block, *sides, printed, ("as-printed",), 12, (sample,))


def test_quantiles_of_every_pair_of_runs() -> None:
    found = made([2.0, 4.0], [1.0, np.inf], (0.4, 0.5))
    values = found.reductions("as-printed", Effect.BOTH)
    np.testing.assert_array_equal(values, [0.5, np.nan, 0.75, np.nan])
    spread = distribution(values)
    assert (spread.pairs, spread.missing, spread.shorter) == (4, 2, 1.0)
    assert (spread.lowest, spread.median, spread.highest) == (0.5, 0.625, 0.75)
    assert str(spread) == "median 62.5 % (50.0 to 75.0 %), 2 of 4 without answer"
    assert found.reductions("as-printed", Effect.CURVE).tolist() == [0.5]
    worse = distribution(np.array([-0.25, 0.0]))
    assert worse.shorter == 0.0
    assert str(worse) == "median −12.5 % (−25.0 to 0.0 %)"


@pytest.mark.parametrize(
    ("printed", "expected"),
    [((0.50, 0.51), True), ((0.3, 0.52), True), ((0.45, 0.49), False), ((0.76, 0.9), False)],
)
def test_reproduced_means_within_the_middle(printed: tuple[float, float], expected: bool) -> None:
    runs = made([2.0], [1.0], printed)
    assert reproduced(runs, "as-printed") is expected
    assert not reproduced(replace(runs, printed=None), "as-printed")


def test_the_printed_reduction_is_an_interval_of_the_digits() -> None:
    study = Study(load_case(WHALE), seeds=2, certify_seconds=0)
    # The design itself: to say that it can be examined, `instance_blocks` would examine it.
    low, high = printed_reduction(study, study.case.instances[0]) or (0, 0)
    assert low == pytest.approx(1 - 11.715 / 13.075, rel=1e-12)
    assert high == pytest.approx(1 - 11.705 / 13.085, rel=1e-12)
    printed = small(('slower = "old-total"', 'slower = "old-total"\npercent = "24.9"'))
    low, high = Study(printed, seeds=2, certify_seconds=0).instances(
        printed.instances[0]
    ).printed or (0, 0)
    assert (low, high) == (pytest.approx(0.2485), pytest.approx(0.2495))


def test_findings_inform_and_decide_nothing() -> None:
    study = Study(small(), seeds=2, certify_seconds=0)
    found = list(judge_instances(study))
    assert [(f.claim, f.reading) for f in found] == [
        ("better", None), ("better", "as-printed"), ("better", "joined"), ("settles", None),
    ]  # fmt: skip
    for f in found:
        assert (f.rule, str(f.severity), str(f.verdict)) == ("TG404", "info", "not checkable")
        assert not f.decides
        assert "refuted" not in f.message
    assert (
        "On 4 instances drawn from the robot's workspace the printed reduction" in found[0].message
    )
    assert "They are not the paper's instances and decide nothing" in found[0].message
    assert "4 instances at steps of 0.3, 0.9 rad, 2 runs each" in found[1].message
    assert "the curve alone is worth median 0.0 % (0.0 to 0.0 %)" in found[2].message
    assert "by iteration 10 of 12" in found[3].message
    one = audit_case(study)
    verdicts = {j.claim: str(j.verdict) for j in one.judgements}
    assert verdicts == {
        "old-total": "not checkable", "new-total": "not checkable", "better": "not checkable",
        "settles": "not checkable",
    }  # fmt: skip


def test_without_a_pair_of_answers_the_words_say_so() -> None:
    found = list(
        judge_instances(
            Study(
                small(
                    ("upper = 8", "upper = 0.05"),
                    ("position_initial = [0, 8]", "position_initial = [0, 0.05]"),
                    ("instances = 2", "instances = 1"),
                ),
                seeds=2,
            )
        )
    )
    assert "not reproduced in 2 (as-printed: no pair of answers" in found[0].message
    assert found[0].computed == "no pair of answers"
    assert "12 runs found nothing that keeps its limits" in found[1].message


def test_one_problem_or_reading_selects() -> None:
    assert Study(small(), seeds=2, problem="spline", certify_seconds=0).instance_blocks == ()
    study = Study(small(), seeds=2, reading="joined", certify_seconds=0)
    assert study.instances(study.instance_blocks[0]).readings == ("joined",)
    unknown = small(('kind = "woa"', 'kind = "not-written"'))
    assert Study(unknown, seeds=2, certify_seconds=0).instance_blocks == ()


# --- page, document, picture ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def report():
    return audit(small(), seeds=2, certify_seconds=0)


def test_the_page_has_the_comparison(report) -> None:
    page = case_page(report.cases[0])
    (section,) = (s for s in page.sections if s.id == "families")
    text = markdown(replace(page, sections=(section,)))
    assert "refuted" not in text
    assert "![Reduction of the total, better, on 4 instances]" in text
    assert "4 for each step" not in text
    assert "2 for each step of 0.3, 0.9 rad (largest change of any joint)" in text
    assert "| as-printed | 0.9 | 2 |" in text
    block = SMALL[SMALL.index("[[families]]") : SMALL.index("[[claims]]")]
    plain = audit(small((block, "")), seeds=2, certify_seconds=0)
    assert "families" not in [s.id for s in case_page(plain.cases[0]).sections]


def test_the_document_is_valid_and_whole(report) -> None:
    document = json.loads(json_text(report.document))
    schema = json.loads((ROOT / "docs" / "output.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(document, schema)
    (one,) = document["cases"][0]["families"]
    assert schema["$defs"]["effect"]["enum"] == [str(effect) for effect in Effect]
    assert set(one) <= set(schema["$defs"]["examined_instances"]["properties"])
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
    assert [t.get_text() for t in both.get_yticklabels()] == list(result.readings)
    assert sum(len(c.get_offsets()) for c in curve.collections) == len(result.samples)
    assert alone.get_title(loc="left") == "algorithm alone"
    assert "as-printed: both together median" in picture.description
    assert "printed: 24.56 to 25.44 %" in picture.description


# --- a user finds the way-points ------------------------------------------------------------------


def test_way_points_dropped_into_the_file_get_the_full_audit() -> None:
    text = (ROOT / "problem" / "published" / f"{WHALE}.toml").read_text(encoding="utf-8")
    start, end = text.index("not_printed = "), text.index("[limits]")
    angles = [
        [f"{0.31 * (j + 1) * (-1) ** k - 0.17 * j * k:.4f}" for k in range(4)] for j in range(6)
    ]
    table = "joint_rows = [\n" + ",\n".join(f"  {json.dumps(row)}" for row in angles) + "\n]\n\n"
    # Fewer way-points and moves than the paper's, for speed; nothing else is touched.
    text = (text[:start] + table + text[end:]).replace("iterations = 500", "iterations = 15")
    text = text.replace("steps = [0.1, 0.2, 0.3]\ninstances = 3", "steps = [0.2]\ninstances = 1")
    report = audit(
        parse_case(text, "found.toml"), seeds=2, reading="v-deg-a-deg", certify_seconds=0
    )
    (one,) = report.cases
    assert one.study.problems == ("b-spline", "quintic")
    rules = {(f.rule, f.claim) for f in one.findings}
    for claim in ("b-spline-total", "quintic-total"):
        assert {("TG302", claim), ("TG402", claim)} <= rules
        assert ("TG501", claim) not in rules
    assert {("TG103", "improvement"), ("TG403", "convergence"), ("TG404", "improvement")} <= rules
    assert [w.problem for w in one.waterfalls] == ["b-spline", "quintic"]
    assert all(w.steps[0].name for w in one.waterfalls)
    for pid in one.study.problems:
        assert one.study.optimum(pid, "v-deg-a-deg").check is not None
    (limits,) = (j for j in one.judgements if j.claim == "limits-kept")
    assert "and no durations: whether its motion keeps the limits" in limits.why
    assert [s.id for s in case_page(one).sections].count("families") == 1


# --- the page of the documentation ----------------------------------------------------------------


def test_the_documented_digits_are_those_of_the_case_and_the_rule() -> None:
    page = (ROOT / "docs" / "families.md").read_text(encoding="utf-8")
    study = Study(load_case(WHALE), seeds=2, certify_seconds=0)
    (block,) = study.case.instances
    claim = study.case.claim(block.claim)
    for side, name in ((claim.slower, "quintic"), (claim.faster, "b-spline")):
        total = study.case.claim(side)
        assert (total.problem, f"{total.value} s" in page) == (name, True)
    assert percent_range(*printed_reduction(study, block) or (0, 0)) in page
    assert f"{100 * MIDDLE:g} %" in page
    assert [f"`{reading}` |" in page for reading in block.readings] == [True] * 5


@pytest.mark.slow
def test_the_documented_medians_are_those_of_the_shipped_family() -> None:
    study = Study(load_case(WHALE), seeds=2, certify_seconds=0)
    found = study.instances(study.instance_blocks[0])
    columns = [(e, at) for e in (Effect.BOTH, Effect.ALGORITHM) for at in (0, 1)]
    columns.append((Effect.CURVE, 0))
    page = (ROOT / "docs" / "families.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([\w-]+)` \| (.*) \|$", page, re.MULTILINE)
    assert [reading for reading, _ in rows] == list(found.readings)
    for reading, cells in rows:
        printed = [float(cell.replace("−", "-")) for cell in cells.split(" | ")]
        computed = [100 * distribution(found.reductions(reading, *c)).median for c in columns]
        assert printed == pytest.approx(computed, abs=0.0501)
        assert abs(computed[3]) < 3
    missed = [r for r in found.readings if not reproduced(found, r)]
    assert missed == ["v-deg-a-deg", "v-rad-a-deg"]
    assert all(f"`{reading}`" in page.split("\n\n")[-1] for reading in missed)


# --- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('claim = "better"', 'claim = "bettr"',
         "families[0].claim: 'bettr' is not the id of any of the claims; did you mean 'better'?"),
        ('claim = "better"', 'claim = "settles"',
         "families[0].claim: 'settles' is a claim of quantity 'convergence'; name an improvement"),
        ('algorithm = "plain"\n', "",
         "families[0].claim: claim 'old-total' does not name its problem and its algorithm; add"),
        ("samples = 50", 'readings = ["joined", "x"]',
         "families[0].readings[1]: 'x' is not the id"),
        ("[0.3, 0.9]", "[0.3, 0]", "families[0].steps[1]: is 0; a step moves something, give more"),
        ("[0.3, 0.9]", "[0.3, 0.30]", "families[0].steps[1]: 0.30 is given twice; leave one out"),
        ("instances = 2", "instances = 0", "families[0].instances:"),
        ('kind = "joint"', 'kind = "wrist"', "families[0].kind:"),
        ("samples = 50", 'objectives = ["mercy"]', "families[0].objectives[0]:"),
        (SMALL[SMALL.index("[robot.dh]") : SMALL.index("[units]")], "",
         "families[0].id: way-points are drawn from the robot's workspace; add robot.dh"),
    ],
)  # fmt: skip
def test_faults_of_a_family(old: str, new: str, message: str) -> None:
    with pytest.raises(CaseError, match=re.escape(f"small.toml: {message}")):
        small((old, new))
