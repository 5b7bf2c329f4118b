"""The palletiser's constrained PSO: (24)(25) of irb460-pso-353 against steps worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, R1, R2, Script
from trajgap.heuristics import Bounds, ConstrainedPSO
from trajgap.heuristics.algorithms.swarm import Swarm

C = 1e6
WIDE = ConstrainedPSO(
    particles=2,
    inertia_rule="fixed",
    inertia_max=0.5,
    position_max=50.0,
    velocity_max=50.0,
    ties="keep",
)


def total(x: np.ndarray) -> np.ndarray:
    """Sum of the coordinates, the constant where one is below 1/4."""
    return np.where((x >= 0.25).all(axis=1), x.sum(axis=1), C)


def swarm(velocities: list[list[float]], best: int = 0) -> Swarm:
    x = np.array([[3.0, 1.0], [1.0, 4.0]])
    p = np.array([[2.0, 1.0], [1.0, 3.0]])
    return Swarm(
        iteration=0,
        positions=x,
        velocities=np.array(velocities),
        fitness=total(x),
        personal=p,
        personal_fitness=total(p),
        best=p[best],
        best_fitness=float(total(p)[best]),
    )


def test_equations_24_and_25_by_hand() -> None:
    after = WIDE.step(swarm([[1.0, -2.0], [0.5, 0.0]]), OPEN, Script(R1, R2), total)
    # v11 = 0.5·1    + 2·0.25 ·(2−3) + 2·0.5  ·(2−3) = −1
    # v12 = 0.5·(−2) + 2·0.5  ·(1−1) + 2·0.25 ·(1−1) = −1
    # v21 = 0.5·0.5  + 2·0.75 ·(1−1) + 2·0.125·(2−1) = 0.5
    # v22 = 0.5·0    + 2·0.125·(3−4) + 2·1    ·(1−4) = −6.25
    np.testing.assert_array_equal(after.velocities, [[-1.0, -1.0], [0.5, -6.25]])
    # (25) read as x + v; as extracted, x + x, it would be twice the position.
    np.testing.assert_array_equal(after.positions, [[2.0, 0.0], [1.5, -2.25]])
    np.testing.assert_array_equal(after.fitness, [C, C])
    np.testing.assert_array_equal(after.personal, [[2.0, 1.0], [1.0, 3.0]])
    np.testing.assert_array_equal(after.best, [2.0, 1.0])
    assert (after.iteration, after.best_fitness) == (1, 3.0)


def test_positions_and_velocities_over_their_bounds_are_set_to_them() -> None:
    held = replace(WIDE, velocity_max=0.75, position_max=2.0)
    after = held.step(swarm([[1.0, -2.0], [0.5, 0.0]]), OPEN, Script(R1, R2), total)
    np.testing.assert_array_equal(after.velocities, [[-0.75, -0.75], [0.5, -0.75]])
    np.testing.assert_array_equal(after.positions, [[2.0, 0.25], [1.5, 2.0]])
    low = replace(WIDE, position_max=2.0)
    after = low.step(swarm([[-50.0, 0.0], [0.0, 0.0]]), OPEN, Script(R1, R2), total)
    assert after.positions[0, 0] == -2.0


def test_positions_held_in_the_duration_bounds() -> None:
    bounds = Bounds(np.array([0.5, 0.75]), np.array([1.25, 2.0]))
    record = replace(WIDE, position_rule="bounds")
    after = record.step(swarm([[1.0, -2.0], [0.5, 0.0]]), bounds, Script(R1, R2), total)
    np.testing.assert_array_equal(after.positions, [[1.25, 0.75], [1.25, 0.75]])


def test_personal_best_by_dominance_and_global_best() -> None:
    record = replace(WIDE, c1=0.0, c2=0.0, inertia_max=1.0)
    after = record.step(swarm([[-0.5, 1.0], [0.5, -3.5]]), OPEN, Script(R1, R2), total)
    np.testing.assert_array_equal(after.personal, [[2.0, 1.0], [1.5, 0.5]])
    np.testing.assert_array_equal(after.personal_fitness, [3.0, 2.0])
    np.testing.assert_array_equal(after.best, [1.5, 0.5])
    assert after.best_fitness == 2.0


@pytest.mark.parametrize(("coin", "kept"), [(0.49, [0.5, 2.5]), (0.51, [2.0, 1.0])])
def test_either_of_two_equal_positions_becomes_the_personal_best(
    coin: float, kept: list[float]
) -> None:
    record = replace(WIDE, c1=0.0, c2=0.0, inertia_max=1.0, ties="random")
    script = Script(R1, R2, [coin, 0.0], 0.0)
    # (0.5, 2.5) is as long as (2, 1); particle 2 stays at (1, 4), worse than its best.
    after = record.step(swarm([[-2.5, 1.5], [0.0, 0.0]]), OPEN, script, total)
    np.testing.assert_array_equal(after.personal, [kept, [1.0, 3.0]])
    assert script.left == []


@pytest.mark.parametrize(("pick", "leader"), [(0.49, 0), (0.51, 1)])
def test_global_best_is_drawn_from_the_equally_good(pick: float, leader: int) -> None:
    record = replace(WIDE, ties="random", position_initial=(0.0, 4.0))
    script = Script([0.25, 0.5, 0.5, 0.25], np.full(4, 0.5), pick)
    first = record.init(OPEN, script, total)
    np.testing.assert_array_equal(first.positions, [[1.0, 2.0], [2.0, 1.0]])
    np.testing.assert_array_equal(first.velocities, np.zeros((2, 2)))
    np.testing.assert_array_equal(first.best, first.positions[leader])
    assert script.left == []


def test_global_best_is_never_drawn_from_worse_ones() -> None:
    record = replace(WIDE, ties="random", position_initial=(0.0, 4.0))
    first = record.init(OPEN, Script([0.5, 0.5, 0.5, 0.25], np.full(4, 0.5), 0.0), total)
    np.testing.assert_array_equal(first.best, [2.0, 1.0])


def test_with_ties_kept_the_first_leads_and_nothing_is_drawn() -> None:
    record = replace(WIDE, position_initial=(0.0, 4.0))
    script = Script([0.25, 0.5, 0.5, 0.25], np.full(4, 0.5))
    np.testing.assert_array_equal(record.init(OPEN, script, total).best, [1.0, 2.0])
    assert script.left == []


def test_initial_velocities_fill_their_range_and_positions_are_held() -> None:
    record = replace(WIDE, velocity_max=0.5, position_max=2.0, position_initial=(0.0, 4.0))
    first = record.init(OPEN, Script([0.25, 0.5, 0.75, 1.0], [0.0, 0.25, 0.75, 1.0]), total)
    np.testing.assert_array_equal(first.positions, [[1.0, 2.0], [2.0, 2.0]])
    np.testing.assert_array_equal(first.velocities, [[-0.5, -0.25], [0.25, 0.5]])


def test_inertia_by_fitness() -> None:
    record = ConstrainedPSO()
    # Mean 4: at the least 0.4, half-way to the mean 0.65, at the mean and above 0.9.
    weights = record.inertia(1, np.array([2.0, 3.0, 4.0, 7.0]))
    np.testing.assert_allclose(weights, [[0.4], [0.65], [0.9], [0.9]], rtol=1e-15)


def test_inertia_by_fitness_in_a_step() -> None:
    record = replace(WIDE, inertia_rule="fitness", inertia_min=0.25, c1=0.0, c2=0.0)
    # Fitness 4 and 5: the better one takes ω_min, the one above the mean ω_max.
    after = record.step(swarm([[1.0, -2.0], [0.5, 1.0]]), OPEN, Script(R1, R2), total)
    np.testing.assert_array_equal(after.velocities, [[0.25, -0.5], [0.25, 0.5]])


@pytest.mark.parametrize("fitness", [[3.0, 3.0], [C, C], [np.inf, np.inf], [3.0, np.inf]])
def test_inertia_without_a_finite_spread(fitness: list[float]) -> None:
    assert ConstrainedPSO().inertia(1, np.array(fitness)) == 0.9


def test_inertia_falls_linearly() -> None:
    record = ConstrainedPSO(inertia_rule="linear")
    ends = [record.inertia(n, np.ones(2)) for n in (1, 50, 100)]
    np.testing.assert_allclose(ends, [0.895, 0.65, 0.4], rtol=1e-15)
