"""WOA: (14)–(20) of z1-woa-bspline against steps worked by hand, and its pull towards 0."""

from dataclasses import replace

import numpy as np
import pytest
from support.scripted import OPEN, Script, off_centre, sphere
from trajgap.heuristics import PSO, WOA, Bounds, states
from trajgap.heuristics.algorithms.population import Population
from trajgap.heuristics.algorithms.woa import delta, encircled, spiralled

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


def test_the_spiral_constant() -> None:
    after = replace(HALF, spiral=2.0).step(pod(), OPEN, script(), off_centre)
    expected = [2 - 2 * np.e, 1 - 3 * np.e]
    np.testing.assert_allclose(after.positions[1], expected, rtol=1e-15)


def test_the_threshold_decides_who_explores() -> None:
    never = replace(HALF, threshold=np.inf).step(pod(), OPEN, script(), off_centre)
    # 3 now encircles: C = 0.5, D = |(1, 0.5) − (−1, 2.5)| = (2, 2), X' = (2, 1) + D
    np.testing.assert_array_equal(never.positions[2], [4.0, 3.0])
    always = replace(HALF, threshold=0.5).step(pod(), OPEN, script(), off_centre)
    # 1, with X_r = itself: D = |1.5 (3, 1) − (3, 1)| = (1.5, 0.5), X' = (3, 1) − 0.5 D
    np.testing.assert_array_equal(always.positions[0], [2.25, 0.75])
    # 4, with X_r = whale 3: D = |(−1, 2.5) − (6, −2)| = (7, 4.5), X' = (−1, 2.5) + 0.5 D
    np.testing.assert_array_equal(always.positions[3], [2.5, 4.75])


def test_delta_falls_linearly() -> None:
    assert [delta(i, 500) for i in (0, 125, 250, 500)] == [2.0, 1.5, 1.0, 0.0]
    # One whale, r of A = 1, C = 1, encircling from D = (1, 0): X' = (2 − δ, 1).
    one = replace(HALF, whales=1, threshold=np.inf, iterations=4)
    for counter, expected in (("zero", [0.0, 0.5, 1.0, 1.5]), ("one", [0.5, 1.0, 1.5, 2.0])):
        record = replace(one, counter=counter)
        for n in range(4):
            before = replace(pod(n), positions=X[:1], fitness=off_centre(X[:1]))
            after = record.step(before, OPEN, Script(1.0, 0.5, 0.5, 0.0, 0.0), off_centre)
            np.testing.assert_array_equal(after.positions, [[expected[n], 1.0]])


def test_one_r_for_a_and_c() -> None:
    record = replace(HALF, r_rule="shared", threshold=np.inf)
    numbers = Script(RA, G, CHANCE, MEMBER)
    after = record.step(pod(), OPEN, numbers, off_centre)
    # 4: A = −0.5, C = 0.5, D = |(1, 0.5) − (6, −2)| = (5, 2.5), X' = (2, 1) + 0.5 D
    np.testing.assert_array_equal(after.positions[3], [4.5, 2.25])
    assert numbers.left == []


@pytest.mark.parametrize(
    ("rule", "threshold", "expected"),
    [
        # A = (−1, 0.5), C = (1, 1.5): the first coordinate explores about X_r = (0, 4).
        ("coordinate", 1.0, [0.0 + 3.0, 1.0 - 0.25]),
        # |A| = √1.25 = 1.118: the whole whale explores, D = |(0, 6) − (3, 1)| = (3, 5).
        ("length", 1.118, [3.0, 4.0 - 2.5]),
        # Just not: it encircles, D = |(2, 1.5) − (3, 1)| = (1, 0.5).
        ("length", 1.119, [2.0 + 1.0, 1.0 - 0.25]),
    ],
)
def test_vector_coefficients(rule: str, threshold: float, expected: list[float]) -> None:
    record = replace(HALF, coefficients="coordinate", threshold_rule=rule, threshold=threshold)
    before = Population(250, X[:2], off_centre(X[:2]), np.array([2.0, 1.0]), 4.0)
    numbers = Script(
        [0.0, 0.75, 0.5, 0.5], [0.5, 0.75, 0.5, 0.5], [0.5, 0.5], [0.0, 0.0], [0.5] * 2
    )
    after = record.step(before, OPEN, numbers, off_centre)
    np.testing.assert_array_equal(after.positions[0], expected)
    assert numbers.left == []


def test_a_random_whale_is_any_whale() -> None:
    always = replace(HALF, threshold=0.0)
    # The second reads where the first was, not where it went.
    for members, targets in (
        ([0.0, 0.249, 0.25, 0.999], [0, 0, 1, 3]),
        ([0.75, 0, 0, 0], [3, 0, 0, 0]),
    ):
        numbers = Script([0.5] * 4, [0.5] * 4, [0.5] * 4, [0.0] * 4, members)
        after = always.step(pod(), OPEN, numbers, off_centre)  # A = 0: X' = X_r
        np.testing.assert_array_equal(after.positions, X[targets])


def test_the_best_is_replaced_by_what_is_strictly_better() -> None:
    after = HALF.step(pod(best=(2.5, 1.0)), OPEN, script(), off_centre)
    # 4: D = |(2.5, 1) − (6, −2)| = (3.5, 3), X' = (4.25, 2.5); 1: X' = (2.125, 0.75), 5.95
    assert after.best_fitness == 5.25
    near = HALF.step(pod(best=(1.5, 2.0)), OPEN, script(), off_centre)
    assert near.best_fitness == 0.25


@pytest.mark.parametrize(
    ("rule", "kept"),
    [("always", [0, 0, 0, 0]), ("feasible", [0, 1, 0, 0]), ("greedy", [0, 1, 1, 0])],
)
def test_replacement(rule: str, kept: list[int]) -> None:
    """0 marks a whale that takes its new position."""

    def penal(x: np.ndarray) -> np.ndarray:
        return np.where(x[:, 0] < -1, 1e6, off_centre(x))  # only whale 2 is sent there

    before = Population(250, X, penal(X), np.array([2.0, 1.0]), 4.0)
    free = replace(HALF, penalty=1e6).step(before, OPEN, script(), penal)
    assert free.fitness[1] == 1e6
    after = replace(HALF, penalty=1e6, replacement=rule).step(before, OPEN, script(), penal)
    stays = np.array(kept, dtype=bool)
    np.testing.assert_array_equal(after.positions, np.where(stays[:, None], X, free.positions))
    np.testing.assert_array_equal(after.fitness, penal(after.positions))


@pytest.mark.parametrize(
    ("rule", "third"),
    [("free", [10.0, 1.5]), ("bounds", [5.0, 2.0]), ("initial", [4.0, 1.5])],
)
def test_position_rules(rule: str, third: list[float]) -> None:
    bounds = Bounds(np.array([0.0, 2.0]), np.array([5.0, 3.0]))
    record = replace(HALF, position_rule=rule, position_initial=(-1.0, 4.0))
    after = record.step(pod(), bounds, script(), off_centre)
    np.testing.assert_array_equal(after.positions[2], third)


def test_a_whale_outside_the_printed_bounds_is_set_to_zero_seconds() -> None:
    bounds = Bounds(np.zeros(2), np.full(2, 5.0))
    after = replace(HALF, position_rule="bounds").step(pod(), bounds, script(), off_centre)
    np.testing.assert_array_equal(after.positions[1], [0.0, 0.0])


def test_initial_population() -> None:
    numbers = Script([0.25, 0.5, 0.75, 1.0])
    record = replace(HALF, whales=2, position_initial=(0.5, 2.5))
    first = record.init(OPEN, numbers, off_centre)
    np.testing.assert_array_equal(first.positions, [[1.0, 1.5], [2.0, 2.5]])
    np.testing.assert_array_equal(first.best, [1.0, 1.5])
    assert (first.best_fitness, first.iteration, numbers.left) == (0.75, 0, [])


def test_a_step_leaves_the_state_before_it_alone() -> None:
    before = pod()
    copies = {name: np.copy(getattr(before, name)) for name in Population.__dataclass_fields__}
    for rule in ("always", "greedy"):
        replace(HALF, replacement=rule).step(before, OPEN, script(), off_centre)
    for name, copy in copies.items():
        np.testing.assert_array_equal(getattr(before, name), copy)


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
