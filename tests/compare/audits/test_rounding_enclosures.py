"""Enclosures of coefficients over a box of inputs, against exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.exact_route import fitted
from support.rounding_boxes import MOVING_ENDS, rounded_problem
from trajgap.nlp.enclosure import balls as interval
from trajgap.nlp.enclosure.balls import Ball, enclose_spline
from trajgap.problem import Interpolant, cubic_spline_virtual, quintic_spline, three_five_three


def exact_coefficients(
    interpolant: Interpolant, durations: list[Fraction], waypoints: list[Fraction]
) -> list[Fraction]:
    """One joint's coefficients in the share of each segment."""
    rows = fitted(interpolant, waypoints, durations)
    return [c * h**p for piece, h in zip(rows, durations, strict=True) for p, c in enumerate(piece)]


def escaped(ball: Ball, exact: list[Fraction]) -> float:
    """How far numbers lie outside a ball, in radii; 1 or less is inside."""
    return max(
        float(abs(x - Fraction(float(m))) / Fraction(float(r)))
        for x, m, r in zip(exact, ball.mid, ball.rad, strict=True)
    )


def worst_escape(interpolant: Interpolant, half: float, seed: int, corners: int = 3) -> float:
    """Largest escape of coefficients and of their derivatives at points of a box."""
    rng = np.random.default_rng(seed)
    problem, h = rounded_problem(seed, interpolant, joints=2)
    q = problem.waypoints
    ball_h, ball_q = Ball.between(h - half, h + half), Ball.between(q - half, q + half)
    found = enclose_spline(interpolant, ball_h, ball_q)
    worst = 0.0
    for way in [rng.uniform(-1, 1, h.size), *rng.choice([-1.0, 1.0], (corners, h.size))]:
        at = [Fraction(x) for x in np.clip(h + half * way, h - half, h + half).tolist()]
        shift = rng.choice([-1.0, 1.0], q.shape)
        there = np.clip(q + half * shift, q - half, q + half)
        for j in range(2):
            angles = [Fraction(x) for x in there[:, j].tolist()]
            exact = exact_coefficients(interpolant, at, angles)
            worst = max(worst, escaped(found.coefficients[:, j], exact))
            step = Fraction(1, 10**30)
            for m in range(interpolant.segments):
                ends = [
                    exact_coefficients(interpolant, [*at[:m], at[m] + d, *at[m + 1 :]], angles)
                    for d in (-step, step)
                ]
                slope = [(b - a) / (2 * step) for a, b in zip(*ends, strict=True)]
                worst = max(worst, escaped(found.by_duration[:, m, j], slope))
            w = int(rng.integers(len(angles)))
            moved = [*angles[:w], angles[w] + 1, *angles[w + 1 :]]
            other = exact_coefficients(interpolant, at, moved)
            slope = [b - a for a, b in zip(exact, other, strict=True)]
            worst = max(worst, escaped(found.by_waypoint[:, w], slope))
    return worst


@pytest.mark.parametrize(
    "interpolant",
    [three_five_three(), quintic_spline(3), cubic_spline_virtual(3), MOVING_ENDS],
    ids=lambda i: i.name,
)
@pytest.mark.parametrize("half", [0.0, 5e-4, 1e-2])
def test_enclosure_holds_the_exact_coefficients(interpolant, half):
    assert worst_escape(interpolant, half, seed=3) <= 1.0


def test_enclosure_is_not_far_too_wide():
    # At a corner the exact coefficients use a fair part of the radius.
    assert worst_escape(three_five_three(), 5e-4, seed=3) > 0.1
    problem, h = rounded_problem(3, quintic_spline(3))
    found = enclose_spline(problem.curve, Ball.exact(h), Ball.exact(problem.waypoints))
    assert found.coefficients.rad.max() < 1e-12


def test_a_wide_box_is_not_enclosed():
    problem, h = rounded_problem(0, quintic_spline(3))
    wide = Ball.between(0.3 * h, 1.7 * h)
    assert enclose_spline(problem.curve, wide, Ball.exact(problem.waypoints)) is None
    zero = Ball.between(0.0 * h, 1.7 * h)
    assert enclose_spline(problem.curve, zero, Ball.exact(problem.waypoints)) is None


def test_rounding_is_part_of_the_radius():
    # 1/3 and its powers are not floats: an enclosure without rounding would miss them.
    third = interval.quotient_power(
        Ball.exact(np.ones(3)), Ball.exact(np.full(3, 3.0)), np.array([1, 2, 5])
    )
    exact = [Fraction(1, 3), Fraction(1, 9), Fraction(1, 243)]
    assert 0.0 < escaped(third, exact) <= 1.0
    rng = np.random.default_rng(5)
    a, b = rng.normal(size=(3, 40)), rng.normal(size=(40, 2))
    product = Ball.exact(a) @ Ball.exact(b)
    for i in range(3):
        exact = [
            sum(
                (Fraction(x) * Fraction(y) for x, y in zip(a[i].tolist(), col, strict=True)),
                Fraction(0),
            )
            for col in b.T.tolist()
        ]
        assert escaped(product[i], exact) <= 1.0


@given(st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 4), min_size=1, max_size=5))
@settings(max_examples=60, deadline=None)
def test_ball_arithmetic_holds_every_result(numbers):
    a, b, c, d = (np.array(column) for column in zip(*numbers, strict=True))
    x = Ball.between(np.minimum(a, b), np.maximum(a, b))
    y = Ball.between(np.minimum(c, d), np.maximum(c, d))
    for left, right in ((a, c), (a, d), (b, c), (b, d)):
        pairs = [(Fraction(p), Fraction(q)) for p, q in zip(left, right, strict=True)]
        for ball, exact in (
            (x + y, [p + q for p, q in pairs]),
            (x - y, [p - q for p, q in pairs]),
            (x * y, [p * q for p, q in pairs]),
        ):
            assert escaped(ball, exact) <= 1.0
            least, most = ball.least().tolist(), ball.magnitude().tolist()
            for low, high, e in zip(least, most, exact, strict=True):
                assert Fraction(low) <= e <= abs(e) <= Fraction(high)
