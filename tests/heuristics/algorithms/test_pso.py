"""Standard PSO: (10)(11) of puma560-mnam-pso-353 against steps worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, R1, R2, Script, off_centre
from trajgap.heuristics import PSO, Bounds
from trajgap.heuristics.algorithms.swarm import Swarm

FREE = PSO(particles=2, inertia=0.5, velocity_rule="free", position_rule="free")


def swarm() -> Swarm:
    x = np.array([[3.0, 1.0], [0.0, 4.0]])
    p = np.array([[2.0, 1.0], [0.0, 3.0]])
    return Swarm(
        iteration=4,
        positions=x,
        velocities=np.array([[1.0, -2.0], [0.5, 0.0]]),
        fitness=off_centre(x),
        personal=p,
        personal_fitness=off_centre(p),
        best=np.array([2.0, 1.0]),
        best_fitness=4.0,
    )


def test_equations_10_and_11_by_hand() -> None:
    after = FREE.step(swarm(), OPEN, Script(R1, R2), off_centre)
    # v11 = 0.5·1    + 2·0.25 ·(2−3) + 2·0.5  ·(2−3) = −1
    # v12 = 0.5·(−2) + 2·0.5  ·(1−1) + 2·0.25 ·(1−1) = −1
    # v21 = 0.5·0.5  + 2·0.75 ·(0−0) + 2·0.125·(2−0) = 0.75
    # v22 = 0.5·0    + 2·0.125·(3−4) + 2·1    ·(1−4) = −6.25
    v = np.array([[-1.0, -1.0], [0.75, -6.25]])
    x = np.array([[2.0, 0.0], [0.75, -2.25]])
    np.testing.assert_array_equal(after.velocities, v)
    np.testing.assert_array_equal(after.positions, x)
    np.testing.assert_array_equal(after.fitness, [13.0, 0.0625 + 3 * 4.25**2])
    np.testing.assert_array_equal(after.personal, swarm().personal)
    np.testing.assert_array_equal(after.best, [2.0, 1.0])
    assert after.best_fitness == 4.0
    assert after.iteration == 5


def test_learning_factors_are_not_swapped() -> None:
    towards = replace(FREE, c1=1.0, c2=0.0, inertia=0.0)
    after = towards.step(swarm(), OPEN, Script(np.ones(4), np.ones(4)), off_centre)
    np.testing.assert_array_equal(after.positions, swarm().personal)
    towards = replace(FREE, c1=0.0, c2=1.0, inertia=0.0)
    after = towards.step(swarm(), OPEN, Script(np.ones(4), np.ones(4)), off_centre)
    np.testing.assert_array_equal(after.positions, [[2.0, 1.0], [2.0, 1.0]])


def test_bests_are_renewed_by_what_is_strictly_better() -> None:
    still = replace(FREE, c1=0.0, c2=0.0, inertia=1.0)
    before = replace(swarm(), velocities=np.array([[-1.0, 0.0], [1.5, -2.5]]))
    after = still.step(before, OPEN, Script(R1, R2), off_centre)
    # Particle 1 lands on its personal best, particle 2 on (1.5, 1.5) with fitness 1.
    np.testing.assert_array_equal(after.personal, [[2.0, 1.0], [1.5, 1.5]])
    np.testing.assert_array_equal(after.personal_fitness, [4.0, 1.0])
    np.testing.assert_array_equal(after.best, [1.5, 1.5])
    assert after.best_fitness == 1.0


def test_an_equally_good_position_replaces_nothing() -> None:
    still = replace(FREE, c1=0.0, c2=0.0, inertia=1.0)
    # (2, 3) is as far from (1, 2) as the personal best (2, 1).
    before = replace(swarm(), velocities=np.array([[-1.0, 2.0], [0.0, 0.0]]))
    after = still.step(before, OPEN, Script(R1, R2), off_centre)
    np.testing.assert_array_equal(after.positions[0], [2.0, 3.0])
    np.testing.assert_array_equal(after.personal, before.personal)
    np.testing.assert_array_equal(after.best, [2.0, 1.0])


def test_an_equally_good_particle_does_not_take_the_lead() -> None:
    still = replace(FREE, c1=0.0, c2=0.0, inertia=0.0)
    before = replace(swarm(), best=np.array([2.0, 3.0]))
    after = still.step(before, OPEN, Script(R1, R2), off_centre)
    np.testing.assert_array_equal(after.best, [2.0, 3.0])


def test_velocities_are_held_in_their_initial_range() -> None:
    held = replace(FREE, velocity_rule="clamp", velocity_initial=(-1.5, 0.5))
    after = held.step(swarm(), OPEN, Script(R1, R2), off_centre)
    np.testing.assert_array_equal(after.velocities, [[-1.0, -1.0], [0.5, -1.5]])
    np.testing.assert_array_equal(after.positions, [[2.0, 0.0], [0.5, 2.5]])


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ("free", [[2.0, 0.0], [0.75, -2.25]]),
        ("bounds", [[2.0, 0.25], [1.0, 0.25]]),
        ("initial", [[1.5, 0.5], [0.75, 0.5]]),
    ],
)
def test_position_rules(rule: str, expected: list[list[float]]) -> None:
    bounds = Bounds(np.array([1.0, 0.25]), np.array([2.5, 2.0]))
    record = replace(FREE, position_rule=rule, position_initial=(0.5, 1.5))
    after = record.step(swarm(), bounds, Script(R1, R2), off_centre)
    np.testing.assert_array_equal(after.positions, expected)
    np.testing.assert_array_equal(after.velocities, [[-1.0, -1.0], [0.75, -6.25]])


@pytest.mark.parametrize(
    ("draws", "numbers", "r1", "r2"),
    [
        ("particle", [0.25, 0.75, 0.5, 0.125], [[0.25] * 2, [0.75] * 2], [[0.5] * 2, [0.125] * 2]),
        ("iteration", [0.25, 0.5], [[0.25] * 2] * 2, [[0.5] * 2] * 2),
    ],
)
def test_shared_random_numbers(
    draws: str, numbers: list[float], r1: list[list[float]], r2: list[list[float]]
) -> None:
    each = FREE.step(swarm(), OPEN, Script(np.array(r1), np.array(r2)), off_centre)
    script = Script(np.array(numbers))
    shared = replace(FREE, draws=draws).step(swarm(), OPEN, script, off_centre)
    np.testing.assert_array_equal(shared.positions, each.positions)
    assert script.left == []


def test_initial_swarm_draws_positions_then_velocities() -> None:
    record = replace(FREE, position_initial=(0.5, 2.5), velocity_initial=(-1.0, 3.0))
    script = Script(np.array([0.25, 0.5, 0.75, 1.0]), np.array([0.0, 0.25, 0.5, 0.75]))
    first = record.init(OPEN, script, off_centre)
    np.testing.assert_array_equal(first.positions, [[1.0, 1.5], [2.0, 2.5]])
    np.testing.assert_array_equal(first.velocities, [[-1.0, 0.0], [1.0, 2.0]])
    np.testing.assert_array_equal(first.personal, first.positions)
    np.testing.assert_array_equal(first.fitness, [0.75, 1.75])
    np.testing.assert_array_equal(first.best, [1.0, 1.5])
    assert (first.best_fitness, first.iteration, script.left) == (0.75, 0, [])


def test_a_step_leaves_the_state_before_it_alone() -> None:
    before = swarm()
    copies = {name: np.copy(getattr(before, name)) for name in Swarm.__dataclass_fields__}
    FREE.step(before, OPEN, Script(R1, R2), off_centre)
    for name, copy in copies.items():
        np.testing.assert_array_equal(getattr(before, name), copy)
