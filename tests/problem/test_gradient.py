"""Gradients of peaks: finite differences, and Euler's identity of the time scaling."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.samples import DECLARATIONS, FREE, sample_problem
from trajgap.problem import Extremum, Problem, evaluate, extrema, fit, peak_gradients

SEEDS = st.integers(0, 10**6)


def interior(
    problem: Problem, h: np.ndarray, nodal: np.ndarray | None, orders: range = range(4)
) -> list[Extremum]:
    """Extrema that a small change moves a little: not flat, and not about to leave the segment."""
    curve = fit(problem.curve, problem.waypoints, h, nodal)
    found = []
    for j in range(len(problem.joints)):
        for order in orders:
            for e in extrema(curve, j, order):
                bend = curve.derivative(e.segment, j, order + 2)
                curved = abs(bend @ e.s ** np.arange(bend.size)) > 1.0
                if e.s in (0.0, 1.0) or (curved and 0.01 < e.s < 0.99):
                    found.append(e)
    return found


def moved(
    problem: Problem, h: np.ndarray, nodal: np.ndarray | None, points: list[Extremum]
) -> np.ndarray:
    """Values of the same extrema after a small change: nearest of the same kind."""
    curve = fit(problem.curve, problem.waypoints, h, nodal)
    values = []
    for e in points:
        near = [
            x
            for x in extrema(curve, e.joint, e.order)
            if x.segment == e.segment and (x.s in (0.0, 1.0)) == (e.s in (0.0, 1.0))
        ]
        nearest = min(near, key=lambda x: abs(x.s - e.s))
        assert abs(nearest.s - e.s) < 0.005
        values.append(nearest.value)
    return np.array(values)


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
def test_against_finite_differences(name: str) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, h = sample_problem(interpolant, 41, joints=2)
    rng = np.random.default_rng(3)
    nodal = rng.normal(size=(interpolant.free, 2)) if interpolant.free else None
    points = interior(problem, h, nodal)
    gradient = peak_gradients(problem, h, points, nodal)
    step = 1e-5
    size = 1.0 + np.abs([e.value for e in points])

    def close(mine: np.ndarray, ahead: np.ndarray, behind: np.ndarray) -> None:
        difference = (ahead - behind) / (2 * step)
        room = 1e-6 * (size + np.abs(difference))
        assert (np.abs(mine - difference) <= room).all()

    for k in range(interpolant.segments):
        change = step * np.eye(interpolant.segments)[k]
        close(
            gradient.durations[:, k],
            moved(problem, h + change, nodal, points),
            moved(problem, h - change, nodal, points),
        )
    owner = np.array([e.joint for e in points])
    for i in range(problem.waypoints.shape[0]):
        for j in range(2):
            change = np.zeros_like(problem.waypoints)
            change[i, j] = step
            ahead, behind = (
                moved(
                    dataclasses.replace(problem, waypoints=problem.waypoints + sign * change),
                    h,
                    nodal,
                    points,
                )
                for sign in (1, -1)
            )
            close(np.where(owner == j, gradient.waypoints[:, i], 0.0), ahead, behind)
    for i in range(interpolant.free):
        for j in range(2):
            change = np.zeros((interpolant.free, 2))
            change[i, j] = step
            assert nodal is not None
            ahead = moved(problem, h, nodal + change, points)
            behind = moved(problem, h, nodal - change, points)
            close(np.where(owner == j, gradient.nodal[:, i], 0.0), ahead, behind)
    assert gradient.nodal.shape == (len(points), interpolant.free)


@given(st.sampled_from([n for n, i in DECLARATIONS.items() if i.homogeneous]), SEEDS)
def test_euler_identity(name: str, seed: int) -> None:
    # f(c·h) = f(h)/cʳ, so h · ∂f/∂h = −r f; f is linear in the way-points, and blind to a shift
    problem, h = sample_problem(DECLARATIONS[name], seed)
    curve = fit(problem.curve, problem.waypoints, h)
    points = [e for j in range(3) for r in (1, 2, 3) for e in extrema(curve, j, r)]
    gradient = peak_gradients(problem, h, points)
    values = np.array([e.value for e in points])
    orders = np.array([e.order for e in points])
    room = 1e-9 * (1 + np.abs(gradient.durations).max(axis=1) + np.abs(values))
    assert (np.abs(gradient.durations @ h + orders * values) <= room).all()
    own = problem.waypoints[:, [e.joint for e in points]].T
    room = 1e-9 * (1 + np.abs(gradient.waypoints).max(axis=1) * np.abs(own).max(axis=1))
    assert (np.abs((gradient.waypoints * own).sum(axis=1) - values) <= room).all()
    assert (np.abs(gradient.waypoints.sum(axis=1)) <= room).all()


def test_position_extrema_move_with_a_shift() -> None:
    problem, h = sample_problem(DECLARATIONS["3-5-3"], 2)
    curve = fit(problem.curve, problem.waypoints, h)
    points = [e for j in range(3) for e in extrema(curve, j, 0)]
    gradient = peak_gradients(problem, h, points)
    np.testing.assert_allclose(gradient.waypoints.sum(axis=1), 1.0, atol=1e-12)


def test_gradient_predicts_the_batched_peaks() -> None:
    problem, h = sample_problem(DECLARATIONS["quintic"], 77)
    curve = fit(problem.curve, problem.waypoints, h)
    tops = [
        max(extrema(curve, j, r), key=lambda e: abs(e.value)) for j in range(3) for r in (1, 2, 3)
    ]
    gradient = peak_gradients(problem, h, tops)
    limits = problem.limits.derivatives.ravel()
    slope = np.array([np.sign(e.value) for e in tops])[:, None] * gradient.durations
    slope /= limits[:, None]
    step = 1e-6
    for k in range(3):
        change = step * np.eye(3)[k]
        ahead, behind = evaluate(problem, [h + change, h - change]).ratios
        difference = (ahead - behind).ravel() / (2 * step)
        np.testing.assert_allclose(slope[:, k], difference, rtol=1e-6, atol=1e-6)


def test_no_points_no_rows() -> None:
    problem, h = sample_problem(DECLARATIONS["3-5-3"], 2)
    gradient = peak_gradients(problem, h, [])
    assert gradient.durations.shape == (0, 3)
    assert gradient.waypoints.shape == (0, 4)
    assert gradient.nodal.shape == (0, 0)
