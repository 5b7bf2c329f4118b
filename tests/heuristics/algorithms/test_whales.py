"""Whales: (14)–(22) of z1-woa-bspline by hand, and their pull towards 0.

Every choice of every step: test_one_by_one.
"""

from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, Script, off_centre, sphere
from trajgap.heuristics import PSO, WOA, Bounds, ImprovedWOA, states
from trajgap.heuristics.algorithms.improved_woa import inertia_weight
from trajgap.heuristics.algorithms.population import Population
from trajgap.heuristics.algorithms.woa import encircled, spiralled

# At I = 250 of 500, δ = 1: then A = 2 r − 1.
HALF = WOA(whales=4, position_rule="free")
X = np.array([[3.0, 1.0], [0.0, 4.0], [-1.0, 2.5], [6.0, -2.0]])
# Whale 1 encircles, 2 spirals, 3 explores with whale 4 as target, 4 encircles.
RA, RC = [0.75, 0.5, 0.0, 0.25], [0.75, 0.5, 0.25, 0.5]
G, CHANCE, MEMBER = [0.5, 0.75, 0.0, 0.0], [0.25, 0.5, 0.0, 0.49], [0.0, 0.3, 0.75, 0.5]


def pod(iteration: int = 250, best: tuple[float, float] = (2.0, 1.0)) -> Population:
    x = np.array(best)
    return Population(iteration, X, off_centre(X), x, float(off_centre(x[None])[0]))


def script() -> Script:
    return Script(RA, RC, G, CHANCE, MEMBER)


def test_equations_14_to_20_by_hand() -> None:
    numbers = script()
    after = HALF.step(pod(), OPEN, numbers, off_centre)
    # 1: A = 0.5, C = 1.5, D = |(3, 1.5) − (3, 1)| = (0, 0.5), X' = (2, 1) − 0.5 D
    # 2: g = 0.5, D' = |(2, 1) − (0, 4)| = (2, 3), X' = D' e^0.5 cos π + (2, 1)
    # 3: A = −1, C = 0.5, X_r = (6, −2), D = |(3, −1) − (−1, 2.5)| = (4, 3.5), X' = X_r + D
    # 4: A = −0.5, C = 1, D = |(2, 1) − (6, −2)| = (4, 3), X' = (2, 1) + 0.5 D
    e = np.exp(0.5)
    moved = np.array([[2.0, 0.75], [2 - 2 * e, 1 - 3 * e], [10.0, 1.5], [4.0, 2.5]])
    np.testing.assert_allclose(after.positions, moved, rtol=1e-15)
    np.testing.assert_array_equal(after.fitness, off_centre(after.positions))
    np.testing.assert_array_equal(after.best, [2.0, 1.0])
    assert (after.iteration, after.best_fitness, numbers.left) == (251, 4.0, [])


def test_equation_21_by_hand() -> None:
    numbers = script()
    record = ImprovedWOA(whales=4, position_rule="free")
    after = record.step(pod(), OPEN, numbers, off_centre)
    # As above, with w = 0.5: D and D' without w, targets (1, 0.5) but for whale 3, which explores.
    e = np.exp(0.5)
    moved = [[1.0, 0.25], [1 - 2 * e, 0.5 - 3 * e], [10.0, 1.5], [3.0, 2.0]]
    np.testing.assert_allclose(after.positions, moved, rtol=1e-15)
    assert numbers.left == []


def test_equation_22() -> None:
    assert [inertia_weight(i, 500, 0.0) for i in (0, 125, 250, 500)] == [1.0, 0.75, 0.5, 0.0]
    # s = 2: 0.5/(1 + 1); s = −0.5: 0.5/(1 − 0.25)
    assert inertia_weight(250, 500, 2.0) == 0.25
    assert inertia_weight(250, 500, -0.5) == pytest.approx(2 / 3, rel=1e-15)
    for s in (-0.99, 0.0, 7.0):
        weights = [inertia_weight(i, 500, s) for i in range(501)]
        assert (weights[0], weights[-1]) == (1.0, 0.0)
        assert (np.diff(weights) < 0).all()


# --- not shift-invariant --------------------------------------------------------------------------

SHIFT = np.array([4.0, -2.0])


def moved_by(c: float) -> float:
    """How far a shift of the whole question changes a step beyond the shift itself."""
    x, best, a = X, np.array([2.0, 1.0]), np.full((4, 1), 0.5)
    c = np.full((4, 1), c)
    shifted = encircled(x + SHIFT, best + SHIFT, a, c) - SHIFT
    return float(np.abs(shifted - encircled(x, best, a, c)).max())


def test_encircling_is_shift_invariant_only_without_c() -> None:
    assert moved_by(1.0) == 0.0
    assert moved_by(1.5) == 1.0
    g = np.full((4, 1), 0.25)
    best = np.array([2.0, 1.0])
    spiral = spiralled(X + SHIFT, best + SHIFT, g, 1.0) - SHIFT
    np.testing.assert_allclose(spiral, spiralled(X, best, g, 1.0), atol=1e-15)


def finals(record: WOA | PSO, shift: float) -> np.ndarray:
    """Final values on a sphere; the box is shifted together with its centre."""
    low, high = shift - 5.0, shift + 5.0
    record = replace(record, position_initial=(low, high), iterations=150)
    box = Bounds(np.full(5, low), np.full(5, high))

    def bowl(x: np.ndarray) -> np.ndarray:
        return sphere(x - shift)

    found = []
    for seed in range(12):
        *_, last = states(record, bowl, box, np.random.default_rng(seed))
        found.append(last.best_fitness)
    return np.array(found)


def test_what_woa_finds_depends_on_where_zero_is() -> None:
    """The same question, shifted by 3: WOA loses more than ten digits, PSO none."""
    assert finals(WOA(), 0.0).max() < 1e-15
    assert finals(WOA(), 3.0).min() > 1e-4
    pso = PSO(velocity_initial=(-2.0, 2.0))
    ratio = np.median(finals(pso, 3.0)) / np.median(finals(pso, 0.0))
    assert 0.1 < ratio < 10
