"""What is found over many pieces at once is what one extremum after another says."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from support.b_splines import uniform
from support.samples import DECLARATIONS, long_curves, long_problem, sample_problem
from trajgap.problem import Problem, check, extrema, fit, rest_to_rest
from trajgap.problem.curves import Trajectory, furthest, peak

NAMES = ("3-5-3", "cubic", "quintic", "rest 7", "4-2-3", "lines", "uneven")


@pytest.mark.parametrize("name", [*NAMES, "timed"])
def test_the_furthest_are_the_largest_of_all_extrema(name: str) -> None:
    """Errors differ between pieces, so another piece than that of the peak may count."""
    for seed in range(4):
        timed = name == "timed"
        problem, h = uniform(name, seed) if timed else sample_problem(DECLARATIONS[name], 11 + seed)
        found = problem.curve.enclosed(problem.waypoints, h)
        assert found.trajectory.polynomial_in_time != timed
        curve = found.trajectory
        error = found.error + np.random.default_rng(seed).random(found.error.shape)
        for j, r in itertools.product(range(3), range(4)):
            points, errors = extrema(curve, j, r), error[:, r]
            reach = furthest(curve, r, errors)
            assert reach.at(curve, 0, j) == min(points, key=lambda e: e.value)
            assert reach.at(curve, 1, j) == max(points, key=lambda e: e.value)
            value = np.array([e.value for e in points])
            blur = np.array([errors[e.segment, j] for e in points])
            low, high = value - blur, value + blur
            assert reach.outer[:, j].tolist() == [low.min(), high.max()]
            assert reach.inner[:, j].tolist() == [high.min(), low.max()]


def test_steps_are_those_of_the_pieces_on_both_sides() -> None:
    problem, h = sample_problem(DECLARATIONS["uneven"], 13)
    curve = fit(problem.curve, problem.waypoints, h)
    for order in range(4):
        left, right, scale = curve.steps(order)
        for b in range(1, 3):
            for j in range(3):
                before, after = (curve.derivative(b - i, j, order) for i in (1, 0))
                terms = np.abs(before).sum() + np.abs(after).sum()
                assert left[b - 1, j] == pytest.approx(before.sum(), abs=1e-14 * terms)
                assert right[b - 1, j] == after[0]
                assert scale[b - 1, j] == pytest.approx(terms, rel=1e-14)


@pytest.mark.parametrize("kind", ["cubic", "quintic"])
def test_pieces_that_are_left_out_do_nothing(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    walk = long_problem(long_curves(130)[kind])
    low = walk.waypoints.min(axis=0) - 0.1
    problem = replace(walk, limits=walk.limits.with_positions(low, [np.inf, 90.0]))
    h = np.random.default_rng(4).uniform(0.4, 1.7, 130)
    jumping = Problem(problem.waypoints, problem.limits, rest_to_rest(130, 3))
    found, jumps = check(problem, h), check(jumping, h)
    looked = []

    def every(trajectory: Trajectory, order: int, errors: np.ndarray) -> np.ndarray:
        looked.append(reaching(trajectory, order, errors).size)
        return np.arange(trajectory.durations.size)

    curve = problem.curve.fitted(problem.waypoints, h)
    errors = np.random.default_rng(2).lognormal(-2.0, 3.0, (130, 2))
    some = [furthest(curve, r, errors) for r in range(4)]
    reaching = peak._reaching
    monkeypatch.setattr(peak, "_reaching", every)
    assert check(problem, h).peaks == found.peaks
    assert check(jumping, h).jumps == jumps.jumps
    assert min(looked) < 20
    for one in some:  # a piece may count by its error alone
        every_piece = furthest(curve, one.order, errors)
        for key in ("pieces", "places", "values", "inner", "outer"):
            np.testing.assert_array_equal(getattr(one, key), getattr(every_piece, key))
        assert (errors[one.pieces, [0, 1]] < np.abs(one.outer - one.values)).any()
    assert len(jumps.jumps) > 200
    assert not found.jumps
