"""The checker and the batched evaluation: identities, known answers, every verdict and reason."""

import os
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support import exact_route
from support.checked import one_joint, table
from support.positions import CURVES, limited
from support.samples import DECLARATIONS, FREE, sample_problem
from trajgap.problem import (
    QUANTITIES,
    Array,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    evaluate,
    keeps_limits,
    rest_to_rest,
    three_five_three,
)
from trajgap.problem.curves import spline as spline_module


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


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
def test_values_lie_within_the_stated_error(name: str) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = sample_problem(interpolant, 31, joints=2)
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
            batch = evaluate(problem, [h], nodal).ratios[0, j, order - 1]
            assert batch == pytest.approx(float(truth) / p.limit, rel=1e-10)


# --- the batched evaluation beside the checker ---------------------------------------------------


@pytest.mark.parametrize("name", ["3-5-3", "quintic", "cubic, virtual", "rest 7"])
def test_same_bits_in_any_company(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = sample_problem(DECLARATIONS[name], 6)
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


def test_evaluate_overflow_is_infinite() -> None:
    problem, _ = sample_problem(three_five_three(), 1)
    ratios = evaluate(problem, [[1e-200, 1.0, 1.0], [1.0, 1e-300, 1.0], [5e-324, 1.0, 1.0]]).ratios
    assert np.isinf(ratios[:, :, 2]).all()
    assert not np.isnan(ratios).any()


def test_evaluate_shapes() -> None:
    problem, h = sample_problem(three_five_three(), 1)
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
    free, _ = sample_problem(FREE["5-5-5 C2"], 1)
    with pytest.raises(TrajgapError, match="give nodal derivatives of shape"):
        evaluate(free, [h])


# --- positions ------------------------------------------------------------------------------------


UNLIMITED = Limits(joints=3)


def drawn(problem: Problem, count: int, seed: int = 3, spread: float = 1.5) -> Array:
    return np.exp(np.random.default_rng(seed).uniform(-spread, spread, (count, problem.segments)))


def position_ratios(problem: Problem, h: Array) -> list[float]:
    """The checker's, the larger one of each joint."""
    peaks = [p for p in check(problem, h).peaks if p.quantity == "position"]
    return [max(p.ratio for p in peaks if p.joint == joint) for joint in problem.joints]


@pytest.mark.parametrize("name", CURVES)
def test_the_batch_says_what_the_checker_says(name: str) -> None:
    """Verdicts and ratios, on both sides of the limits wherever durations move the path."""
    for room in (0.003, 0.05, 0.4):
        problem = limited(CURVES[name], room, UNLIMITED)
        h = drawn(problem, 8)
        found, kept = evaluate(problem, h).positions, keeps_limits(problem, h, 5e-10)
        for one, ratios, inside in zip(h, found, kept, strict=True):
            own = check(problem, one)
            if own.worst is not None and own.worst.quantity == "curve":
                assert np.isinf(ratios).all()
                assert not inside
                continue
            assert ratios == pytest.approx(position_ratios(problem, one), rel=1e-7, abs=1e-9)
            assert inside == (own.limits is Verdict.PASS)


def test_ratios_of_derivatives_do_not_depend_on_position_limits() -> None:
    problem = limited(three_five_three(), 0.1)
    h = drawn(problem, 50)
    free = replace(problem, limits=problem.limits.with_positions([-np.inf] * 3, [np.inf] * 3))
    np.testing.assert_array_equal(evaluate(problem, h).ratios, evaluate(free, h).ratios)
    assert (evaluate(free, h).positions == -np.inf).all()
    (beyond,) = np.nonzero((evaluate(problem, h).positions > 1 + 1e-9).any(axis=1))
    np.testing.assert_array_equal(
        np.flatnonzero(keeps_limits(free, h, 1e-9) & ~keeps_limits(problem, h, 1e-9)),
        np.flatnonzero(keeps_limits(free, h, 1e-9) & np.isin(np.arange(50), beyond)),
    )
