"""How far positions go, for batches: the checker's numbers, dense samples, scipy, identities."""

from dataclasses import replace

import numpy as np
import pytest
from support.positions import CURVES, limited, sampled_range
from trajgap.problem import (
    Array,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    keeps_limits,
    piecewise,
    three_five_three,
)

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


@pytest.mark.parametrize("name", CURVES)
def test_verdicts_with_all_limits_are_the_checkers(name: str) -> None:
    problem = limited(CURVES[name], 0.1)
    h = 3.0 * drawn(problem, 12, spread=0.7)
    kept = keeps_limits(problem, h, 5e-10)
    within = (h <= problem.duration_upper).all(axis=1)
    for one, inside in zip(h[within], kept[within], strict=True):
        assert inside == (check(problem, one).limits is Verdict.PASS)


@pytest.mark.parametrize("name", CURVES)
def test_ratios_are_those_of_dense_samples(name: str) -> None:
    problem = limited(CURVES[name], 0.1)
    for one in drawn(problem, 2, spread=0.4):
        (least, most), low, high = (
            sampled_range(problem, one).T,
            problem.limits.position_lower,
            problem.limits.position_upper,
        )
        half = np.where(np.isfinite(high - low), (high - low) / 2, np.maximum(1.0, np.abs(low)))
        half[0] = max(1.0, abs(high[0]))
        dense = 1 + np.maximum((low - least), (most - high)) / half
        assert evaluate(problem, one[None]).positions[0] == pytest.approx(dense, abs=2e-4)


@pytest.mark.parametrize("name", [n for n, c in CURVES.items() if c.homogeneous])
def test_a_uniform_stretch_moves_no_path(name: str) -> None:
    problem = limited(CURVES[name], 0.1)
    h = drawn(problem, 20, spread=0.8)
    one, other = evaluate(problem, h), evaluate(problem, 3.7 * h)
    np.testing.assert_allclose(other.positions, one.positions, rtol=1e-8, atol=1e-9)
    finite = np.isfinite(one.stretch)
    assert (other.stretch[finite] < one.stretch[finite]).all()


@pytest.mark.parametrize("name", CURVES)
def test_what_is_no_duration_keeps_no_position(name: str) -> None:
    problem = limited(CURVES[name], 9.0)
    h = np.ones((5, problem.segments))
    h[0, 0], h[1, -1], h[2, 0], h[3, -1] = np.nan, np.inf, 0.0, -1.0
    found = evaluate(problem, h).positions
    assert (found[:4] == np.inf).all()
    assert np.isfinite(found[4]).all()
    assert not keeps_limits(problem, h, 1e-9)[:4].any()


def test_a_batch_is_its_members_on_any_number_of_threads() -> None:
    problem = limited(cubic_spline(3), 0.1)
    h = drawn(problem, 5000)
    together = evaluate(problem, h).positions
    np.testing.assert_array_equal(evaluate(problem, h[::-1]).positions[::-1], together)
    alone = np.concatenate([evaluate(problem, one[None]).positions for one in h[:50]])
    np.testing.assert_array_equal(together[:50], alone)
    assert evaluate(problem, np.empty((0, 3))).positions.shape == (0, 3)


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


def test_free_derivatives_move_the_path() -> None:
    curve = piecewise((5, 5, 5), 2, ((1, 0.0), (2, 0.0)))
    problem = limited(curve, 0.2)
    h = np.array([[0.9, 1.3, 0.7]])
    for scale in (0.5, 4.0):
        nodal = scale * np.random.default_rng(6).normal(size=(curve.free, 3))
        peaks = [p for p in check(problem, h[0], nodal).peaks if p.quantity == "position"]
        own = [max(p.ratio for p in peaks if p.joint == joint) for joint in problem.joints]
        assert evaluate(problem, h, nodal).positions[0] == pytest.approx(own, rel=1e-9)
