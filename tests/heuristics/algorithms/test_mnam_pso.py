"""MNAM-PSO: inertia (12), niches and mutation of puma560-mnam-pso-353, worked by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, R1, R2, Script
from trajgap.heuristics import MNAMPSO, PSO
from trajgap.heuristics.algorithms.swarm import Swarm

NO_MOVE = np.array([0.5, 0.5])


def total(x: np.ndarray) -> np.ndarray:
    """Sum of the coordinates, infeasible where one is below 1/4."""
    return np.where((x >= 0.25).all(axis=1), x.sum(axis=1), np.inf)


def swarm(best: list[float]) -> Swarm:
    x = np.array([[3.0, 1.0], [1.0, 4.0]])
    return Swarm(
        iteration=0,
        positions=x,
        velocities=np.zeros((2, 2)),
        fitness=total(x),
        personal=x,
        personal_fitness=total(x),
        best=np.array(best),
        best_fitness=float(sum(best)),
    )


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


def test_budget_is_the_length_of_the_inertia_schedule() -> None:
    assert MNAMPSO(iterations=20).inertia(20) == MNAMPSO(iterations=200).inertia(200)


def test_step_by_hand() -> None:
    record = MNAMPSO(
        particles=2, iterations=2, niches=1, velocity_rule="free", position_rule="free"
    )
    before = replace(swarm([2.0, 1.0]), velocities=np.array([[1.0, -2.0], [0.5, 0.0]]))
    script = Script(R1, R2, [0.75, 0.0])
    after = record.step(before, OPEN, script, total)
    w = 0.9 - 0.5 * (1 - math.exp(-1.0))
    # v11 = w·1    + 2·0.25 ·(3−3) + 2·0.5  ·(2−3)
    # v12 = w·(−2) + 2·0.5  ·(1−1) + 2·0.25 ·(1−1)
    # v21 = w·0.5  + 2·0.75 ·(1−1) + 2·0.125·(2−1)
    # v22 = w·0    + 2·0.125·(4−4) + 2·1    ·(1−4)
    v = np.array([[w - 1.0, -2 * w], [0.5 * w + 0.25, -6.0]])
    np.testing.assert_allclose(after.velocities, v, rtol=1e-15)
    np.testing.assert_allclose(after.positions, before.positions + v, rtol=1e-15)
    # Both particles left the feasible set; the mutant (2 + 1·0.5, 1 − 1·1) did, too.
    np.testing.assert_array_equal(after.fitness, [np.inf, np.inf])
    np.testing.assert_array_equal(after.best, [2.0, 1.0])
    assert (after.iteration, after.best_fitness, script.left) == (1, 3.0, [])


def test_mutation_bounds_are_the_smallest_coordinate() -> None:
    best = np.array([2.0, 0.5, 1.25])
    draws = np.array([1.0, 0.25, 0.5])
    mutant = MNAMPSO(niches=1).mutant(best, Script(draws))
    np.testing.assert_array_equal(mutant, [2.5, 0.25, 1.25])
    half = MNAMPSO(niches=1, mutation_scale=0.5).mutant(best, Script(draws))
    np.testing.assert_array_equal(half, [2.25, 0.375, 1.25])
    np.testing.assert_array_equal(best, [2.0, 0.5, 1.25])


def test_mutation_of_one_coordinate() -> None:
    record = MNAMPSO(mutated="one")
    best = np.array([2.0, 0.5, 1.25])
    for where, index in ((0.0, 0), (0.34, 1), (0.999, 2)):
        mutant = record.mutant(best, Script([where, 0.0]))
        expected = best.copy()
        expected[index] -= 0.5
        np.testing.assert_array_equal(mutant, expected)


@pytest.mark.parametrize(
    ("draw", "best", "why"),
    [
        ([0.25, 0.25], [1.5, 0.5], "feasible and better"),
        ([0.75, 0.5], [2.0, 1.0], "worse"),
        ([0.75, 0.25], [2.0, 1.0], "equally good"),
        ([0.5, 0.0], [2.0, 1.0], "infeasible"),
    ],
)
def test_mutant_is_kept_only_if_feasible_and_better(
    draw: list[float], best: list[float], why: str
) -> None:
    record = MNAMPSO(particles=2, niches=1, c1=0.0, c2=0.0)
    before = swarm([2.0, 1.0])
    after = record.step(before, OPEN, Script(R1, R2, draw), total)
    np.testing.assert_array_equal(after.best, best, err_msg=why)
    assert after.best_fitness == sum(best)
    np.testing.assert_array_equal(after.personal, before.personal)
    np.testing.assert_array_equal(after.positions, before.positions)


def test_a_kept_mutant_leads_until_a_particle_beats_it() -> None:
    record = MNAMPSO(particles=2, niches=1, c1=0.0, c2=0.0)
    after = record.step(swarm([2.0, 1.0]), OPEN, Script(R1, R2, [0.25, 0.25]), total)
    after = record.step(after, OPEN, Script(R1, R2, NO_MOVE), total)
    np.testing.assert_array_equal(after.best, [1.5, 0.5])


def test_initial_best_is_mutated() -> None:
    record = MNAMPSO(particles=2, niches=1, niches_rule="diagonal", position_initial=(1.0, 3.0))
    script = Script([0.0, 0.5, 0.5, 1.0], np.full(4, 0.5), [0.5, 0.25])
    first = record.init(OPEN, script, total)
    np.testing.assert_array_equal(first.personal, [[1.0, 2.0], [2.0, 3.0]])
    np.testing.assert_array_equal(first.best, [1.0, 1.5])
    assert (first.best_fitness, first.iteration, script.left) == (2.5, 0, [])


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


def test_stratified_niches_by_hand() -> None:
    record = MNAMPSO(particles=2, niches=2, position_initial=(1.0, 3.0))
    x = record.scatter(Script([0.9, 0.1, 0.2, 0.8], [0.5, 0.25, 0.75, 0.0]), 2)
    np.testing.assert_array_equal(x, [[2.5, 1.25], [1.75, 2.0]])


def test_diagonal_niches_take_one_sub_range_each() -> None:
    record = MNAMPSO(particles=6, niches_rule="diagonal", position_initial=(1.0, 4.0))
    x = record.scatter(np.random.default_rng(2), 3)
    niche = np.repeat([0, 0, 1, 1, 2, 2], 3).reshape(6, 3)
    np.testing.assert_array_equal(np.floor(x) - 1, niche)


def test_clusters_lie_around_centres_within_the_range() -> None:
    record = MNAMPSO(particles=4, niches=2, niches_rule="clusters", position_initial=(1.0, 3.0))
    centres = [0.25, 0.5, 1.0, 0.0]
    around = [0.5, 0.5, 0.0, 1.0, 0.5, 0.25, 1.0, 1.0]
    x = record.scatter(Script(centres, around), 2)
    np.testing.assert_array_equal(x, [[1.5, 2.0], [1.0, 2.5], [3.0, 1.0], [3.0, 1.5]])


def test_without_its_three_changes_it_is_standard_pso() -> None:
    record = MNAMPSO(
        particles=5, niches=1, niches_rule="diagonal", inertia_max=0.65, inertia_min=0.65,
        mutation_scale=0.0,
    )  # fmt: skip
    plain = PSO(particles=5, inertia=0.65)
    rng, same = np.random.default_rng(4), np.random.default_rng(4)
    a, b = record.init(OPEN, rng, total), plain.init(OPEN, same, total)
    same.random(2)
    for _ in range(10):
        np.testing.assert_array_equal(a.positions, b.positions)
        np.testing.assert_array_equal(a.best, b.best)
        a, b = record.step(a, OPEN, rng, total), plain.step(b, OPEN, same, total)
        same.random(2)
