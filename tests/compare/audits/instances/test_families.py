"""Families of instances: what is drawn, what is computed of it, and what is said of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.families import UNSOLVED, WHALE, examined, small
from trajgap.compare.audits.instances import study as family_study
from trajgap.compare.audits.instances.drawn import printed_reduction
from trajgap.compare.audits.instances.result import (
    InstancesResult,
    Optimum,
    Sample,
    distribution,
    reproduced,
)
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Effect, Procedure
from trajgap.nlp import Evidence
from trajgap.problem import (
    ClampedBSpline,
    Problem,
    TrajgapError,
    evaluate,
    forward_kinematics,
    jtraj,
    load_case,
    quintic_spline,
)
from trajgap.problem.cases.instances import instance_waypoints

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


@pytest.mark.slow
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


@pytest.mark.slow
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
    study = Study(printed, seeds=2, certify_seconds=0)
    assert study.instances(printed.instances[0]).printed == pytest.approx((0.2485, 0.2495))
