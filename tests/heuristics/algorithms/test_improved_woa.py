"""Improved WOA: (21)–(23) of z1-woa-bspline against steps worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, Script, off_centre
from trajgap.heuristics import WOA, Bounds, ImprovedWOA
from trajgap.heuristics.algorithms.improved_woa import inertia_weight
from trajgap.heuristics.algorithms.population import Population

# At I = 250 of 500, δ = 1 and, with s = 0, w = 0.5.
HALF = ImprovedWOA(whales=3, position_rule="free")
X = np.array([[3.0, 1.0], [0.0, 4.0], [-1.0, 2.5]])
BEST = np.array([2.0, 1.0])
# Whale 1 encircles, 2 spirals, 3 explores with whale 2 as target.
NUMBERS = ([0.75, 0.5, 0.0], [0.75, 0.5, 0.25], [0.5, 0.75, 0.5], [0.25, 0.5, 0.0], [0.0, 0.0, 0.5])


def step(record: ImprovedWOA | WOA, iteration: int = 250) -> np.ndarray:
    numbers = Script(*NUMBERS)
    pod = Population(iteration, X, off_centre(X), BEST, 4.0)
    after = record.step(pod, OPEN, numbers, off_centre)
    assert numbers.left == []
    return after.positions


def test_equation_21_by_hand() -> None:
    # 1: A = 0.5, C = 1.5, D = |(3, 1.5) − (3, 1)| = (0, 0.5): D without w; X' = 0.5 (2, 1) − 0.5 D
    # 2: g = 0.5, D' = |(2, 1) − (0, 4)| = (2, 3), X' = D' e^0.5 cos π + 0.5 (2, 1)
    # 3: A = −1, C = 0.5, X_r = (0, 4), D = |(0, 2) − (−1, 2.5)| = (1, 0.5), X' = X_r + D
    e = np.exp(0.5)
    expected = [[1.0, 0.25], [1 - 2 * e, 0.5 - 3 * e], [1.0, 4.5]]
    np.testing.assert_allclose(step(HALF), expected, rtol=1e-15)


@pytest.mark.parametrize(
    ("exploration", "third"),
    [
        ("kept", [1.0, 4.5]),
        ("weighted", [1.0, 2.5]),  # 0.5 (0, 4) + D
        # (21) to the letter: D = |(1, 0.5) − (−1, 2.5)| = (2, 2), X' = 0.5 (2, 1) + D
        ("dropped", [3.0, 2.5]),
    ],
)
def test_the_branch_that_21_leaves_out(exploration: str, third: list[float]) -> None:
    moved = step(replace(HALF, exploration=exploration))
    np.testing.assert_array_equal(moved[2], third)
    np.testing.assert_array_equal(moved[:2], step(HALF)[:2])


def test_equation_22() -> None:
    assert [inertia_weight(i, 500, 0.0) for i in (0, 125, 250, 500)] == [1.0, 0.75, 0.5, 0.0]
    # s = 2: 0.5/(1 + 1); s = −0.5: 0.5/(1 − 0.25)
    assert inertia_weight(250, 500, 2.0) == 0.25
    assert inertia_weight(250, 500, -0.5) == pytest.approx(2 / 3, rel=1e-15)
    for s in (-0.99, 0.0, 7.0):
        weights = [inertia_weight(i, 500, s) for i in range(501)]
        assert (weights[0], weights[-1]) == (1.0, 0.0)
        assert (np.diff(weights) < 0).all()


def test_the_weight_of_a_step() -> None:
    # w = 0.25 with s = 2: whale 1 lands on 0.25 (2, 1) − 0.5 (0, 0.5)
    np.testing.assert_array_equal(step(replace(HALF, s=2.0))[0], [0.5, 0.0])


def test_the_first_move_is_the_plain_one() -> None:
    plain = WOA(whales=3, position_rule="free")
    np.testing.assert_array_equal(step(HALF, 0), step(plain, 0))


def test_the_last_weight_is_zero_when_counted_from_one() -> None:
    """At I = T both A and w are 0: every encircling whale goes to 0 s."""
    last = replace(HALF, counter="one", exploration="dropped")
    np.testing.assert_array_equal(step(last, 499)[[0, 2]], np.zeros((2, 2)))
    assert (step(replace(last, counter="zero"), 499)[0] != 0).any()


@pytest.mark.parametrize("rule", ["coordinate", "member", "single"])
def test_initial_population_by_the_tent_map(rule: str) -> None:
    record = replace(HALF, tent_rule=rule, position_initial=(1.0, 3.0))
    starts = {"coordinate": [0.125, 0.75], "member": [0.125, 0.75, 0.5], "single": [0.125]}[rule]
    # Orbits: 0.125, 0.25, 0.5, 1, 0, 0; 0.75, 0.5, 1; 0.5, 1. Then 1 + 2 x.
    expected = {
        "coordinate": [[0.125, 0.75], [0.25, 0.5], [0.5, 1.0]],
        "member": [[0.125, 0.25], [0.75, 0.5], [0.5, 1.0]],
        "single": [[0.125, 0.25], [0.5, 1.0], [0.0, 0.0]],
    }[rule]
    numbers = Script(starts)
    first = record.init(OPEN, numbers, off_centre)
    np.testing.assert_array_equal(first.positions, 1 + 2 * np.array(expected))
    assert numbers.left == []


def test_uniform_initial_population() -> None:
    record = replace(HALF, initial="uniform")
    first = record.init(OPEN, np.random.default_rng(3), off_centre)
    plain = WOA(whales=3).init(OPEN, np.random.default_rng(3), off_centre)
    np.testing.assert_array_equal(first.positions, plain.positions)


@pytest.mark.parametrize(
    "changes",
    [
        {"coefficients": "coordinate"},
        {"coefficients": "coordinate", "threshold_rule": "length"},
        {"r_rule": "shared"},
        {"counter": "one"},
        {"replacement": "feasible"},
        {"replacement": "greedy"},
        {"position_rule": "bounds"},
        {"spiral": 0.5, "threshold": 0.75},
    ],
    ids=str,
)
def test_shared_choices_act_as_in_the_plain_algorithm(changes: dict[str, object]) -> None:
    """With a weight of 1 (no iteration made yet) both make the same step."""
    bounds = Bounds(np.array([0.5, 0.5]), np.array([2.5, 3.5]))
    counter = changes.get("counter", "zero")
    pod = Population(-1 if counter == "one" else 0, X, off_centre(X), BEST, 4.0)
    found = []
    for record in (WOA(whales=3, **changes), ImprovedWOA(whales=3, **changes)):
        found.append(record.step(pod, bounds, np.random.default_rng(8), off_centre).positions)
    np.testing.assert_array_equal(*found)
