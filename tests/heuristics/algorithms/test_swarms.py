"""Swarms: (10)–(12) of puma560-mnam-pso-353 by hand, niches, and the inertia of irb460-pso-353.

Every choice of every step: test_one_by_one.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, R1, R2, Script, off_centre
from trajgap.heuristics import MNAMPSO, PSO, ConstrainedPSO
from trajgap.heuristics.algorithms.swarm import Swarm


def test_equations_10_and_11_by_hand() -> None:
    x = np.array([[3.0, 1.0], [0.0, 4.0]])
    p = np.array([[2.0, 1.0], [0.0, 3.0]])
    v = np.array([[1.0, -2.0], [0.5, 0.0]])
    before = Swarm(4, x, v, off_centre(x), p, off_centre(p), np.array([2.0, 1.0]), 4.0)
    free = PSO(particles=2, inertia=0.5, velocity_rule="free", position_rule="free")
    after = free.step(before, OPEN, Script(R1, R2), off_centre)
    # v11 = 0.5·1    + 2·0.25 ·(2−3) + 2·0.5  ·(2−3) = −1
    # v12 = 0.5·(−2) + 2·0.5  ·(1−1) + 2·0.25 ·(1−1) = −1
    # v21 = 0.5·0.5  + 2·0.75 ·(0−0) + 2·0.125·(2−0) = 0.75
    # v22 = 0.5·0    + 2·0.125·(3−4) + 2·1    ·(1−4) = −6.25
    np.testing.assert_array_equal(after.velocities, [[-1.0, -1.0], [0.75, -6.25]])
    np.testing.assert_array_equal(after.positions, [[2.0, 0.0], [0.75, -2.25]])
    np.testing.assert_array_equal(after.fitness, [13.0, 0.0625 + 3 * 4.25**2])
    np.testing.assert_array_equal(after.personal, p)
    np.testing.assert_array_equal(after.best, [2.0, 1.0])
    assert after.best_fitness == 4.0
    assert after.iteration == 5


@pytest.mark.parametrize(
    ("n", "falling"),
    [
        (50, 0.9 - 0.5 * (1 - math.exp(-0.25))),
        (100, 0.9 - 0.5 * (1 - math.exp(-1.0))),
        (200, 0.9 - 0.5 * (1 - math.exp(-4.0))),
    ],
)
def test_inertia_12(n: int, falling: float) -> None:
    assert MNAMPSO().inertia(n) == pytest.approx(falling, rel=1e-15)
    rising = replace(MNAMPSO(), inertia_reading="rises")
    assert rising.inertia(n) == pytest.approx(0.9 + 0.4 - falling, rel=1e-15)


def test_mutation_bounds_are_the_smallest_coordinate() -> None:
    best = np.array([2.0, 0.5, 1.25])
    draws = np.array([1.0, 0.25, 0.5])
    mutant = MNAMPSO(niches=1).mutant(best, Script(draws))
    np.testing.assert_array_equal(mutant, [2.5, 0.25, 1.25])
    half = MNAMPSO(niches=1, mutation_scale=0.5).mutant(best, Script(draws))
    np.testing.assert_array_equal(half, [2.25, 0.375, 1.25])
    np.testing.assert_array_equal(best, [2.0, 0.5, 1.25])


@pytest.mark.parametrize("particles", [3, 30, 31])
def test_stratified_niches_share_every_coordinate(particles: int) -> None:
    record = MNAMPSO(particles=particles, position_initial=(0.3, 3.0))
    x = record.scatter(np.random.default_rng(1), 4)
    cell = np.floor((x - 0.3) / 0.9).astype(int)
    for column in cell.T:
        counts = np.bincount(column, minlength=3)
        assert counts.sum() == particles
        assert counts.max() - counts.min() <= 1
    if particles == 30:
        assert len(np.unique(cell, axis=0)) > 9


C = 1e6


def test_inertia_by_fitness() -> None:
    record = ConstrainedPSO()
    # Mean 4: at the least 0.4, half-way to the mean 0.65, at the mean and above 0.9.
    weights = record.inertia(1, np.array([2.0, 3.0, 4.0, 7.0]))
    np.testing.assert_allclose(weights, [[0.4], [0.65], [0.9], [0.9]], rtol=1e-15)


@pytest.mark.parametrize("fitness", [[3.0, 3.0], [C, C], [np.inf, np.inf], [3.0, np.inf]])
def test_inertia_without_a_finite_spread(fitness: list[float]) -> None:
    assert ConstrainedPSO().inertia(1, np.array(fitness)) == 0.9
