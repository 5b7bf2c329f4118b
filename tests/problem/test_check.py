"""The checker and the batched evaluation: identities, known answers, every verdict and reason."""

import dataclasses
import os
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import exact_route
from support.samples import DECLARATIONS, FREE, posed
from trajgap.problem import (
    QUANTITIES,
    Check,
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    extrema,
    fit,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from trajgap.problem.curves import spline as spline_module

PUMA = np.array(
    [
        [0.1885, -1.6336, 0.2513, 0.3142, 0.1885, 0.3142],
        [0.8168, -2.0071, -0.3770, -0.0628, -0.1257, -0.1257],
        [0.1257, -1.0681, -1.0681, 0.4398, 0.2513, -0.1885],
        [-0.8796, -1.0053, -0.3142, 0.8796, 0.5027, -0.2513],
    ]
)  # rad: mos.2024.136535, Table 1

HOMOGENEOUS = [name for name, i in DECLARATIONS.items() if i.homogeneous]
SEEDS = st.integers(0, 10**6)
NAMES = st.sampled_from(HOMOGENEOUS)


def table(result: Check, joints: tuple[str, ...], field: str = "ratio") -> np.ndarray:
    """A field of the derivative peaks, shape (joints, 3); 0 where there is no limit."""
    found = {(p.joint, p.quantity): getattr(p, field) for p in result.peaks}
    return np.array([[found.get((label, q), 0.0) for q in QUANTITIES] for label in joints])


def one_joint(
    waypoints: list[float], interpolant: Interpolant, **limits: float | np.ndarray
) -> Problem:
    return Problem(np.array(waypoints)[:, None], Limits(**limits, joints=1), interpolant)


# --- known answers -------------------------------------------------------------------------------


def test_rest_to_rest_cubic_has_its_textbook_peaks() -> None:
    # over d in T: v = 1.5 d/T in the middle, a = ±6 d/T² at the ends, j = −12 d/T³ throughout
    d, duration = 0.7, 0.4
    problem = one_joint([1.2, 1.9], rest_to_rest(1, 3), velocity=2.0, acceleration=30, jerk=90)
    result = check(problem, [duration])
    np.testing.assert_allclose(
        table(result, problem.joints, "value")[0],
        [1.5 * d / duration, 6 * d / duration**2, -12 * d / duration**3],
        rtol=1e-13,
    )
    speed, acceleration, _ = result.peaks
    assert speed.time == pytest.approx(0.2, rel=1e-12)
    assert acceleration.time in (0.0, pytest.approx(0.4))
    assert (speed.joint, speed.quantity, speed.segment, speed.limit) == ("1", "velocity", 0, 2.0)
    assert speed.margin == pytest.approx(1 - 2.625 / 2)
    assert result.verdict is Verdict.VIOLATED
    assert result.worst is not None
    assert result.worst.quantity == "jerk"
    assert result.max_violation == pytest.approx(131.25 / 90 - 1)
    roots = (2.625 / 2, np.sqrt(26.25 / 30), np.cbrt(131.25 / 90))
    assert result.stretch == pytest.approx(max(roots), rel=1e-13)
    assert result.feasible_time == result.tight_time == pytest.approx(0.4 * max(roots))


def test_puma_joint_one_at_its_printed_durations() -> None:
    # Table 3, joint 1: its peak acceleration sits at 8 rad/s² to the printed precision
    problem = Problem(PUMA, Limits(6, 8), three_five_three(), duration_lower=0.3)
    result = check(problem.joint(0), [0.961, 1.258, 1.078])
    assert result.worst is not None
    assert result.worst.quantity == "acceleration"
    assert abs(result.worst.value) == pytest.approx(8.0033, abs=5e-5)


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
def test_values_lie_within_the_stated_error(name: str) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = posed(interpolant, 31, joints=2)
    rng = np.random.default_rng(7)
    for spread in (0.3, 1.2):
        h = 10.0 ** rng.uniform(-spread, spread, interpolant.segments)
        nodal = rng.normal(size=(interpolant.free, 2)) if interpolant.free else None
        for p in check(problem, h, nodal).peaks:
            j, order = problem.joints.index(str(p.joint)), QUANTITIES.index(p.quantity) + 1
            extra = {}
            if nodal is not None:
                extra = dict(zip(interpolant.free_derivatives, nodal[:, j], strict=True))
            pieces = exact_route.fitted(interpolant, problem.waypoints[:, j], h, extra)
            truth = Fraction(exact_route.peak(pieces, h, order))
            assert abs(Fraction(abs(p.value)) - truth) <= Fraction(p.error)
            assert p.error <= 1e-9 * max(1.0, abs(p.value))


# --- identities ----------------------------------------------------------------------------------


@given(NAMES, SEEDS, st.floats(0.05, 20.0))
def test_stretching_time(name: str, seed: int, c: float) -> None:
    problem, h = posed(DECLARATIONS[name], seed)
    before, after = check(problem, h), check(problem, c * h)
    expected = table(before, problem.joints) / [c, c**2, c**3]
    np.testing.assert_allclose(table(after, problem.joints), expected, rtol=1e-10, atol=1e-12)
    assert after.stretch == pytest.approx(before.stretch / c, rel=1e-10)
    if after.tight_time is not None:
        assert after.tight_time == pytest.approx(before.tight_time, rel=1e-10)


@given(NAMES, SEEDS)
def test_stretch_makes_it_tight(name: str, seed: int) -> None:
    problem, h = posed(DECLARATIONS[name], seed)
    loose = check(problem, h)
    if any(jump.order < 2 for jump in loose.jumps):
        return
    tight = check(problem, loose.stretch * h)
    assert tight.worst is not None
    assert tight.worst.ratio == pytest.approx(1.0, abs=1e-11 if name == "rest 7" else 1e-12)
    if not tight.jumps:
        assert tight.verdict is Verdict.PASS
    if loose.tight_time is not None:
        assert loose.tight_time == pytest.approx(tight.total_time, rel=1e-14)
        assert loose.feasible_time == max(loose.tight_time, loose.total_time)


@given(st.sampled_from(list(DECLARATIONS)), SEEDS)
def test_permuted_joints(name: str, seed: int) -> None:
    problem, h = posed(DECLARATIONS[name], seed)
    order = np.random.default_rng(seed).permutation(3)
    other = Problem(
        problem.waypoints[:, order],
        Limits(*problem.limits.derivatives[order].T),
        problem.curve,
        joints=tuple(problem.joints[i] for i in order),
    )
    mine, theirs = check(problem, h), check(other, h)
    np.testing.assert_array_equal(table(mine, problem.joints), table(theirs, problem.joints))
    assert mine.stretch == theirs.stretch
    np.testing.assert_array_equal(
        evaluate(other, [h]).ratios, evaluate(problem, [h]).ratios[:, order]
    )


@given(NAMES, SEEDS, st.floats(-50, 50))
def test_mirror_and_shift(name: str, seed: int, shift: float) -> None:
    problem, h = posed(DECLARATIONS[name], seed)
    mirrored = dataclasses.replace(problem, waypoints=shift - problem.waypoints)
    np.testing.assert_allclose(
        table(check(mirrored, h), problem.joints),
        table(check(problem, h), problem.joints),
        rtol=1e-9,
        atol=1e-9,
    )


def backwards(interpolant: Interpolant) -> Interpolant:
    n = interpolant.segments
    return Interpolant(
        interpolant.degrees[::-1],
        interpolant.continuity[::-1],
        tuple(
            tuple((order, (-1) ** order * value) for order, value in entries)
            for entries in interpolant.prescribed[::-1]
        ),
        tuple(n - b for b in interpolant.virtual),
    )


@given(st.sampled_from(list(DECLARATIONS)), SEEDS)
def test_time_reversal(name: str, seed: int) -> None:
    problem, h = posed(DECLARATIONS[name], seed)
    other = Problem(problem.waypoints[::-1], problem.limits, backwards(problem.curve))
    forth, back = check(problem, h), check(other, h[::-1])
    np.testing.assert_allclose(
        table(back, problem.joints), table(forth, problem.joints), rtol=1e-9, atol=1e-12
    )
    np.testing.assert_allclose(
        evaluate(other, [h[::-1]]).ratios, evaluate(problem, [h]).ratios, rtol=1e-9, atol=1e-12
    )


@given(st.sampled_from(list(DECLARATIONS)), SEEDS)
def test_degrees_or_radians(name: str, seed: int) -> None:
    if not DECLARATIONS[name].homogeneous:
        return
    problem, h = posed(DECLARATIONS[name], seed)
    in_degrees = Problem(
        np.degrees(problem.waypoints),
        Limits(*np.degrees(problem.limits.derivatives).T),
        problem.curve,
    )
    np.testing.assert_allclose(
        table(check(in_degrees, h), problem.joints),
        table(check(problem, h), problem.joints),
        rtol=1e-10,
        atol=1e-13,
    )


@given(SEEDS, st.floats(0.2, 5.0))
def test_limits_enter_as_ratios(seed: int, factor: float) -> None:
    problem, h = posed(three_five_three(), seed)
    wider = dataclasses.replace(
        problem, limits=problem.limits.with_derivatives(factor * problem.limits.derivatives)
    )
    np.testing.assert_allclose(
        table(check(wider, h), problem.joints) * factor,
        table(check(problem, h), problem.joints),
        rtol=1e-12,
    )


# --- the batched evaluation beside the checker ---------------------------------------------------


@given(st.sampled_from([*DECLARATIONS, *FREE]), SEEDS, st.floats(0.1, 1.0))
def test_evaluate_agrees_with_check(name: str, seed: int, spread: float) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = posed(interpolant, seed)
    rng = np.random.default_rng(seed)
    batch = 10.0 ** rng.uniform(-spread, spread, (3, interpolant.segments))
    nodal = rng.normal(size=(interpolant.free, 3)) if interpolant.free else None
    result = evaluate(problem, batch, nodal)
    assert result.ratios.shape == (3, 3, 3)
    for i, h in enumerate(batch):
        one = check(problem, h, nodal)
        room = 1e-9 * table(one, problem.joints).max(axis=1, keepdims=True)
        assert (np.abs(result.ratios[i] - table(one, problem.joints)) <= room).all()
        assert result.stretch[i] == pytest.approx(one.stretch, rel=1e-9)


@pytest.mark.parametrize("name", ["3-5-3", "quintic", "cubic, virtual", "rest 7"])
def test_same_bits_in_any_company(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = posed(DECLARATIONS[name], 6)
    rng = np.random.default_rng(0)
    batch = rng.uniform(0.1, 3.0, (1500, problem.segments))
    together = evaluate(problem, batch)
    backward = evaluate(problem, batch[::-1])
    np.testing.assert_array_equal(backward.ratios[::-1], together.ratios)
    alone = np.concatenate([evaluate(problem, h[None]).ratios for h in batch[:70]])
    np.testing.assert_array_equal(alone, together.ratios[:70])
    odd = evaluate(problem, batch[3:34])
    np.testing.assert_array_equal(odd.ratios, together.ratios[3:34])
    for threads in (1, 2, 5):
        monkeypatch.setattr(os, "cpu_count", lambda threads=threads: threads)
        monkeypatch.setattr(spline_module, "_THREAD_WORK", 100)
        threaded = evaluate(problem, batch)
        np.testing.assert_array_equal(threaded.ratios, together.ratios)
        np.testing.assert_array_equal(threaded.stretch, together.stretch)
    single = np.stack([evaluate(problem.joint(j), batch).ratios[:, 0] for j in range(3)], axis=1)
    np.testing.assert_array_equal(single, together.ratios)


def test_evaluate_bad_durations_are_infinite_and_nothing_else() -> None:
    problem, h = posed(three_five_three(), 1, limits=Limits(2, [np.inf, 3, 4], joints=3))
    good = evaluate(problem, [h])
    bad = [0.0, -1.0, np.nan, np.inf, -np.inf]
    batch = np.tile(h, (2 * len(bad) + 1, 1))
    for i, value in enumerate(bad):
        batch[2 * i + 1, i % 3] = value
    result = evaluate(problem, batch)
    assert np.isinf(result.ratios[1::2]).all()
    assert np.isinf(result.stretch[1::2]).all()
    for i in range(0, len(batch), 2):
        np.testing.assert_array_equal(result.ratios[i], good.ratios[0])
        assert result.stretch[i] == good.stretch[0]
    assert (good.ratios[0, :, 2] == 0).all()
    assert good.ratios[0, 0, 1] == 0


def test_evaluate_overflow_is_infinite() -> None:
    problem, _ = posed(three_five_three(), 1)
    ratios = evaluate(problem, [[1e-200, 1.0, 1.0], [1.0, 1e-300, 1.0], [5e-324, 1.0, 1.0]]).ratios
    assert np.isinf(ratios[:, :, 2]).all()
    assert not np.isnan(ratios).any()


def test_evaluate_shapes() -> None:
    problem, h = posed(three_five_three(), 1)
    empty = evaluate(problem, np.empty((0, 3)))
    assert (empty.ratios.shape, empty.stretch.shape) == ((0, 3, 3), (0,))
    np.testing.assert_array_equal(
        evaluate(problem, np.asfortranarray(np.stack([h, 2 * h]))).ratios,
        evaluate(problem, np.stack([h, 2 * h])).ratios,
    )
    np.testing.assert_array_equal(
        evaluate(problem, [[1, 2, 3]]).ratios, evaluate(problem, [[1.0, 2.0, 3.0]]).ratios
    )
    for wrong in (h, [[1.0, 2.0]], np.ones((2, 2, 3)), np.ones((2, 4))):
        with pytest.raises(TrajgapError, match=r"durations: a batch has shape \(vectors, 3\), got"):
            evaluate(problem, wrong)
    for wrong in ("abc", [[1.0, "x", 2.0]], [[1.0, 2.0, 3.0], [1.0]]):
        with pytest.raises(TrajgapError, match=r"durations: not numbers; give seconds"):
            evaluate(problem, wrong)
    free, _ = posed(FREE["5-5-5 C2"], 1)
    with pytest.raises(TrajgapError, match="give nodal derivatives of shape"):
        evaluate(free, [h])


# --- verdicts ------------------------------------------------------------------------------------


def test_tolerance_decides() -> None:
    problem = one_joint([0.2, 1.2], rest_to_rest(1, 3), velocity=1.5)
    for factor, verdict in (
        (1.0, Verdict.PASS),
        (1 + 2e-9, Verdict.PASS),
        (1 - 0.9e-9, Verdict.PASS),
        (1 - 1.1e-9, Verdict.VIOLATED),
        (0.5, Verdict.VIOLATED),
    ):
        assert check(problem, [factor]).verdict is verdict
    assert check(problem, [1 - 1e-4], tolerance=1e-3).verdict is Verdict.PASS
    assert check(problem, [1 - 1e-12], tolerance=0.0).verdict is Verdict.VIOLATED
    assert check(problem, [1.0], tolerance=0.0).verdict is Verdict.UNDECIDED
    # what is violated stays violated, whatever is undecided beside it
    pair = Problem([[0.2, 0.2], [1.4, 1.2]], Limits(1.5), rest_to_rest(1, 3))
    assert check(pair, [1.0], tolerance=0.0).verdict is Verdict.VIOLATED


def test_rounding_that_hides_the_limit_is_undecided() -> None:
    # Near 2 : 3 this system is singular; 1e-12 from there its coefficients have four digits.
    quartics = Interpolant((4, 4), (3,), (((3, 0.0),), ((2, 0.0),), ((1, 0.0),)))
    h = [2.0, 3.0 * (1 + 1e-12)]
    peak = check(one_joint([0.3, 1.1, -0.4], quartics, velocity=1.0), h).peaks[0]
    assert peak.error > 1e-6 * abs(peak.value)
    for factor, verdict in (
        (1.0, Verdict.UNDECIDED),
        (0.5, Verdict.VIOLATED),
        (2.0, Verdict.PASS),
    ):
        problem = one_joint([0.3, 1.1, -0.4], quartics, velocity=factor * abs(peak.value))
        assert check(problem, h).verdict is verdict


def test_velocity_jump_is_discontinuous() -> None:
    lines = piecewise((1, 1, 1), 0, ())
    problem = one_joint([0.3, 1.0, 0.6, 0.8], lines, velocity=5.0, acceleration=7.0)
    result = check(problem, [0.5, 0.4, 1.0])
    assert result.verdict is Verdict.DISCONTINUOUS
    assert [(j.order, j.break_index, j.joint) for j in result.jumps] == [(1, 1, "1"), (1, 2, "1")]
    # speeds 1.4, −1.0, 0.2
    np.testing.assert_allclose([j.size for j in result.jumps], [-2.4, 1.2], rtol=1e-12)
    np.testing.assert_allclose([j.time for j in result.jumps], [0.5, 0.9], rtol=1e-12)
    assert result.feasible_time is result.tight_time is None
    assert result.feasible_why == "the motion jumps at a break; stretching does not repair that"
    assert result.tight_why == result.feasible_why
    # a limit that is exceeded is said first
    slow = one_joint([0.3, 1.0, 0.6, 0.8], lines, velocity=1.0)
    assert check(slow, [0.5, 0.4, 1.0]).verdict is Verdict.VIOLATED
    # equal slopes: no jump
    straight = one_joint([0.3, 0.5, 0.9, 1.0], lines, velocity=5.0)
    assert check(straight, [0.2, 0.4, 0.1]).verdict is Verdict.PASS


def test_acceleration_jump_counts_where_jerk_is_limited() -> None:
    rest = rest_to_rest(2, 3)
    free = Limits([5, 5], [20, 20])
    limited = Limits([5, 5], [20, 20], [np.inf, 900])
    waypoints = np.array([[0.1, 0.4], [0.5, 1.0], [0.3, 1.9]])
    result = check(Problem(waypoints, free, rest), [0.8, 0.9])
    assert result.verdict is Verdict.PASS
    assert {(j.order, j.joint) for j in result.jumps} == {(2, "1"), (2, "2")}
    assert check(Problem(waypoints, limited, rest), [0.8, 0.9]).verdict is Verdict.DISCONTINUOUS
    still = waypoints.copy()
    still[:, 1] = 0.4
    assert check(Problem(still, limited, rest), [0.8, 0.9]).verdict is Verdict.PASS


def test_joint_that_must_not_move() -> None:
    for interpolant in (three_five_three(), cubic_spline(3), rest_to_rest(3, 5)):
        q = np.array([[0.3, 61.7], [0.9, 61.7], [0.4, 61.7], [-0.2, 61.7]])
        limits = Limits([9, 0], [90, 0], [900, 0])
        still = Problem(q, limits, interpolant)
        result = check(still, [1.0, 1.3, 0.8])
        assert result.verdict in (Verdict.PASS, Verdict.DISCONTINUOUS)
        assert not table(result, still.joints)[1].any()
        assert not evaluate(still, [[1.0, 1.3, 0.8]]).ratios[0, 1].any()
        moving = Problem(q[:, ::-1], limits, interpolant)
        result = check(moving, [1.0, 1.3, 0.8])
        assert result.verdict is Verdict.VIOLATED
        assert np.isinf(result.stretch)
        assert np.isinf(evaluate(moving, [[1.0, 1.3, 0.8]]).stretch[0])
        if not any(j.order < 2 for j in result.jumps) and interpolant.continuity[0] > 1:
            assert result.feasible_time is None
            assert result.feasible_why == "a joint with limit 0 moves; no stretch repairs that"


def test_at_rest_between_virtual_waypoints() -> None:
    problem = Problem(
        np.array([[0.3, 61.7], [0.9, 61.7], [0.4, 61.7]]),
        Limits([9, 0], [90, 0], [900, 0]),
        cubic_spline_virtual(3),
    )
    h = [0.4, 0.9, 1.3, 0.7]
    assert not evaluate(problem, [h]).ratios[0, 1].any()
    assert check(problem, h).verdict is Verdict.PASS


def test_nothing_limited() -> None:
    problem, h = posed(three_five_three(), 1, limits=Limits(joints=3))
    result = check(problem, h)
    assert result.verdict is Verdict.PASS
    assert result.worst is None
    assert (result.peaks, result.stretch, result.max_violation) == ((), 0.0, 0.0)
    assert result.feasible_time == pytest.approx(h.sum())
    assert result.tight_time is None
    assert result.tight_why == "nothing moves or nothing is limited; the total time can shrink to 0"
    assert not evaluate(problem, [h]).ratios.any()
    assert "tight time      none: nothing moves" in str(result)


def test_nothing_moves() -> None:
    problem = Problem(np.full((4, 2), 0.7), Limits(1, 2, 3, joints=2), three_five_three())
    result = check(problem, [1.0, 1.0, 1.0])
    assert result.verdict is Verdict.PASS
    assert result.tight_why == "nothing moves or nothing is limited; the total time can shrink to 0"
    assert not evaluate(problem, [[0.1, 0.2, 0.3]]).ratios.any()


def test_repeated_waypoints() -> None:
    q = np.array([[0.3, 1.0], [0.9, 1.4], [0.9, 1.4], [-0.2, 0.8]])
    problem = Problem(q, Limits(2, 6, joints=2), three_five_three())
    result = check(problem, [0.9, 0.4, 1.1])
    for p in result.peaks:
        j, order = problem.joints.index(str(p.joint)), QUANTITIES.index(p.quantity) + 1
        pieces = exact_route.fitted(problem.curve, q[:, j], [0.9, 0.4, 1.1])
        truth = float(exact_route.peak(pieces, [0.9, 0.4, 1.1], order))
        assert abs(p.value) == pytest.approx(truth, rel=1e-12)
    # rest-to-rest stands still between equal way-points
    rest = Problem(q, Limits(2, 6, joints=2), rest_to_rest(3, 5))
    assert {p.segment for p in check(rest, [0.9, 1e-3, 1.1]).peaks} <= {0, 2}


def test_one_segment() -> None:
    problem = one_joint([0.4, -0.6], quintic_spline(1), velocity=1.875, acceleration=20.0)
    # minimum-jerk: |v| = 15/8 d/T, |a| = 10/√3 d/T²
    result = check(problem, 1.0)
    np.testing.assert_allclose(
        np.abs(table(result, ("1",), "value")[0, :2]), [1.875, 10 / np.sqrt(3)], rtol=1e-12
    )
    assert result.stretch == pytest.approx(1.0, abs=1e-13)


# --- repairs and their reasons -------------------------------------------------------------------


def test_prescribed_velocity_has_no_repair() -> None:
    problem = one_joint([0.2, 0.9, 0.5], cubic_spline(2, ((1, 0.25),)), velocity=1.0)
    broken = check(problem, [0.3, 0.3])
    assert broken.verdict is Verdict.VIOLATED
    assert broken.feasible_time is broken.tight_time is None
    assert broken.feasible_why == "a prescribed end derivative is not 0; stretching would change it"
    kept = check(problem, [2.0, 2.0])
    assert kept.verdict is Verdict.PASS
    assert kept.feasible_time == pytest.approx(4.0)
    assert kept.tight_time is None


def test_position_limits() -> None:
    # q overshoots its way-points: a clamped cubic with a turning point inside
    q = np.array([[0.2], [1.0], [0.9]])
    wide = Problem(q, Limits(9, position_lower=0.0, position_upper=1.2), cubic_spline(2))
    result = check(wide, [1.0, 0.5])
    top = next(p for p in result.peaks if p.quantity == "position" and p.limit == 1.2)
    pieces = exact_route.fitted(wide.curve, q[:, 0], [1.0, 0.5])
    peak = float(exact_route.peak(pieces, [1.0, 0.5], 0))
    assert top.value == pytest.approx(peak, rel=1e-13)
    assert 1.0 < peak < 1.2
    assert top.ratio == pytest.approx(1 + (peak - 1.2) / 0.6, rel=1e-12)
    assert result.verdict is Verdict.PASS
    assert result.feasible_time == pytest.approx(1.5)
    low = next(p for p in result.peaks if p.quantity == "position" and p.limit == 0.0)
    assert low.value == pytest.approx(0.2)
    tight = Problem(q, Limits(9, position_lower=0.0, position_upper=1.0), cubic_spline(2))
    broken = check(tight, [1.0, 0.5])
    assert broken.verdict is Verdict.VIOLATED
    assert broken.worst is not None
    assert (broken.worst.quantity, broken.worst.limit) == ("position", 1.0)
    assert broken.feasible_time is broken.tight_time is None
    assert broken.feasible_why == "a position limit is exceeded; stretching does not move the path"
    one_sided = Problem(q, Limits(9, position_lower=0.21), cubic_spline(2))
    assert check(one_sided, [1.0, 0.5]).verdict is Verdict.VIOLATED
    # the derivative limits alone make c*
    assert broken.stretch == pytest.approx(result.stretch)


def test_joint_fixed_in_place() -> None:
    limits = Limits(9, position_lower=[-9, 0.7], position_upper=[9, 0.7])
    q = np.array([[0.2, 0.7], [1.0, 0.7], [0.9, 0.7]])
    assert check(Problem(q, limits, cubic_spline(2)), [1.0, 1.0]).verdict is Verdict.PASS
    moved = q + np.array([[0, 0], [0, 1e-3], [0, 0]])
    assert check(Problem(moved, limits, cubic_spline(2)), [1.0, 1.0]).verdict is Verdict.VIOLATED


def test_position_within_one_ulp_of_its_limit_is_undecided() -> None:
    bump = Interpolant((3,), (), (((1, 1e-8),), ((1, 0.0),)))
    q = np.array([[300.0], [300.0]])
    top = max(e.value for e in extrema(fit(bump, q, [1.0]), 0, 0))
    assert top > 300.0
    limits = Limits(9, position_lower=300.0 - 1e-8, position_upper=np.nextafter(top, 0.0), joints=1)
    result = check(Problem(q, limits, bump), [1.0])
    assert result.worst is not None
    assert result.worst.ratio > 1 + 1e-9
    assert result.verdict is Verdict.UNDECIDED


def test_duration_bounds() -> None:
    problem, h = posed(three_five_three(), 3)
    c = check(problem, h).stretch
    tight = h * c

    def judged(
        lower: np.ndarray | float, upper: np.ndarray | float, at: np.ndarray = tight
    ) -> Check:
        return check(dataclasses.replace(problem, duration_lower=lower, duration_upper=upper), at)

    assert judged(0.0, np.inf).verdict is Verdict.PASS
    # exactly at a bound is inside, and not the worst peak
    at_bound = judged(tight, tight)
    assert at_bound.verdict is Verdict.PASS
    assert at_bound.worst is not None
    assert at_bound.worst.quantity in QUANTITIES
    slow = judged(2 * tight, 2 * tight, 2 * tight)
    assert slow.worst is not None
    assert slow.worst.quantity in QUANTITIES
    assert slow.worst.ratio < 0.6
    short = judged(tight * [1, 1.25, 1], np.inf)
    assert short.verdict is Verdict.VIOLATED
    assert short.worst is not None
    assert (short.worst.quantity, short.worst.segment, short.worst.joint) == ("duration", 1, None)
    assert short.worst.ratio == pytest.approx(1.25)
    assert short.worst.time is None
    assert "segment 2 duration" in str(short)
    assert short.feasible_why == "a stretched duration falls below its lower bound"
    long = judged(0.0, tight * [1, 1, 0.5])
    assert long.worst is not None
    assert (long.worst.segment, long.worst.ratio) == (2, pytest.approx(2.0))
    assert long.feasible_why == "a stretched duration exceeds its upper bound"
    # too fast, and the repair would be too slow
    half = judged(0.0, 0.8 * tight.max(), 0.5 * tight)
    assert half.verdict is Verdict.VIOLATED
    assert half.feasible_time is None
    assert half.feasible_why == "a stretched duration exceeds its upper bound"
    # feasible, but the free rescaling would be too fast
    slow = judged(1.5 * tight, np.inf, 2.0 * tight)
    assert slow.verdict is Verdict.PASS
    assert slow.feasible_time == pytest.approx(2 * tight.sum())
    assert slow.tight_time is None
    assert slow.tight_why == "a stretched duration falls below its lower bound"


def test_free_derivatives_are_taken_as_given() -> None:
    quintics = FREE["5-5-5 C2"]
    problem, h = posed(quintics, 12, joints=1)
    nodal = np.array([[0.4], [-0.3], [1.1], [0.7]])
    given_values = Interpolant(
        (5, 5, 5),
        (2, 2),
        (
            ((1, 0.0), (2, 0.0)),
            ((1, 0.4), (2, 1.1)),
            ((1, -0.3), (2, 0.7)),
            ((1, 0.0), (2, 0.0)),
        ),
    )
    other = Problem(problem.waypoints, problem.limits, given_values)
    np.testing.assert_allclose(
        table(check(problem, h, nodal), ("1",)), table(check(other, h), ("1",)), rtol=1e-12
    )
    np.testing.assert_allclose(
        evaluate(problem, [h], nodal).ratios, evaluate(other, [h]).ratios, rtol=1e-12
    )
    with pytest.raises(TrajgapError, match="give nodal derivatives of shape"):
        check(problem, h)


def test_summary_reads_on_one_screen() -> None:
    problem = one_joint([1.2, 1.9], rest_to_rest(1, 3), velocity=2.0)
    text = str(check(problem, [0.4]))
    assert text.splitlines() == [
        "violated (for all t, relative tolerance 1e-09)",
        "total time      0.400000 s",
        "worst           joint 1 velocity 2.625 against 2 (ratio 1.312500000) at t = 0.200000 s",
        "feasible time   0.525000 s",
        "tight time      0.525000 s",
    ]


def test_check_refuses_durations() -> None:
    problem, _ = posed(three_five_three(), 3)
    for wrong, message in (
        ([1.0, 1.0], r"durations: expected 3 \(one per segment\), got 2"),
        ([1.0, -1.0, 1.0], "must all be positive and finite"),
        ("x", "durations: not numbers"),
    ):
        with pytest.raises(TrajgapError, match=message):
            check(problem, wrong)


def test_a_reachable_total_holds_for_every_waypoint_of_the_box() -> None:
    from trajgap.problem import reachable_total

    rng = np.random.default_rng(11)
    q = np.array([[0.2, -1.0], [0.9, 0.3], [0.4, 1.1], [1.3, 0.6]])
    limits = Limits([1.5, 2.0], [4.0, 6.0], [60.0, 90.0])
    h = np.array([0.8, 0.9, 1.1])
    for interpolant in (three_five_three(), quintic_spline(3)):
        problem = Problem(q, limits, interpolant)
        total = reachable_total(problem, h, q - 0.03, q + 0.05)
        assert total is not None
        stretched = h * total / h.sum()
        for _ in range(300):
            other = Problem(q + rng.uniform(-0.03, 0.05, q.shape), limits, interpolant)
            assert check(other, stretched).verdict is Verdict.PASS
        exact = reachable_total(problem, h, q, q)
        assert exact == pytest.approx(check(problem, h).feasible_time, rel=1e-8)
    bounded = Problem(q, limits, three_five_three(), 0.0, 0.5)
    assert reachable_total(bounded, h, q, q) is None
    ranged = Problem(q, Limits(1.5, 4.0, np.inf, -2.0, 2.0, joints=2), three_five_three())
    assert reachable_total(ranged, h, q, q) is None


def test_a_still_segment_of_any_length_does_not_blur_the_peak_of_another() -> None:
    """Errors grow as 1/h³: with a still segment of 1e-5 s they once hid a limit that is met."""
    q = np.array([[0.10379], [-0.035097], [-0.035097], [0.009476]])
    problem = Problem(q, Limits(jerk=2813.87), rest_to_rest(3, 5))
    h = np.array([0.2, 1e-5, 0.2])
    h[[0, 2]] *= check(problem, h).stretch
    verdict = check(problem, h)
    assert verdict.verdict is Verdict.PASS
    assert verdict.worst.error < 1e-12 * verdict.worst.limit
    assert check(problem, [h[0] * (1 - 1e-8), *h[1:]]).verdict is Verdict.VIOLATED
