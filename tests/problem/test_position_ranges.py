"""How far positions go, for batches: the checker's numbers, dense samples, scipy, identities."""

from dataclasses import replace

import numpy as np
import pytest
from support.positions import CURVES, limited
from trajgap.problem import (
    Array,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    keeps_limits,
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
