"""What a leaf of a quintic proof bounds, and how a tree of them is read."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BPoly, make_interp_spline
from scipy.optimize import minimize
from support.forgeries.forgery import NO_ANSWER, altered
from trajgap.verify import read_problem
from trajgap.verify.boxes import most_of_cubes
from trajgap.verify.quintic import QuinticSpline
from trajgap.verify.quintic_bound import Centre, Part, Task
from trajgap.verify.reading import Clock

CLOCK = Clock(1e9)
SPLINE_ENDS = [(1, 0.0), (2, 0.0)]


@pytest.mark.parametrize("seed", range(12))
def test_a_leaf_is_below_every_sampled_quintic(seed: int) -> None:
    rng = np.random.default_rng([seed, 11])
    n, joints, count = int(rng.integers(2, 6)), 2, 6
    h0, width = np.exp(rng.uniform(-0.5, 0.5, n)), [0.0, 0.02, 0.08, 0.15][seed % 4]
    q = rng.uniform(-1.0, 1.0, (n + 1, joints))
    limits = rng.uniform(0.5, 3.0, (joints, 3))
    tops = (n, joints, 1, 2, 1025)
    rows = [[int(x) for x in rng.integers(0, tops)] for _ in range(count)]
    rows = [[k, j, 1 + i % 3, 2 * sign - 1, at] for i, (k, j, _, sign, at) in enumerate(rows)]
    weights = [int(w) for w in rng.integers(1, 10, count)]
    tau, total = int(rng.integers(-9, 10)), float(h0.sum())

    def value(h: np.ndarray) -> float:
        t = np.concatenate([[0.0], np.cumsum(h)])
        found = tau * (h.sum() - total)
        for (k, j, order, sign, place), w in zip(rows, weights, strict=True):
            curve = make_interp_spline(t, q[:, j], k=5, bc_type=(SPLINE_ENDS, SPLINE_ENDS))
            reached = sign * float(curve(t[k] + place / 1024 * h[k], order))
            found += w * (reached - limits[j, order - 1]) * h[k] ** (order - 2)
        return float(found)

    task = Task(np.diff(q, axis=0), limits, total)
    leaf = np.array([tau]), np.array([rows]), np.array([weights], float)
    low, high = h0 * np.exp(-width), h0 * np.exp(width)
    proved = float(Centre(task, low[None], high[None]).least(*leaf)[0])
    spread = [np.exp(width * rng.uniform(-1, 1, n)) for _ in range(25)]
    corners = (np.ones(n), np.exp([-width] * n), np.exp([width] * n))
    found = [h0 * x for x in (*corners, *spread)]
    values = [value(h) for h in found]
    lowest = found[int(np.argmin(values))]
    within = list(zip(low, high, strict=True))
    assert proved <= min(*values, minimize(value, lowest, bounds=within).fun) + 1e-9
    if width == 0.0:
        assert proved == pytest.approx(values[0], abs=1e-5 * (1 + abs(values[0])))
    else:
        # Of second order in the width.
        assert values[0] - proved < 400 * width * (1 + np.ptp(values))


@pytest.mark.parametrize("order", [1, 2, 3])
def test_where_nothing_moves_a_leaf_is_off_by_its_allowance_for_rounding_alone(order: int) -> None:
    """There the weighted sum is −Σ w·limit·h^(order − 2): in rationals never below what is said."""
    h, limit, count = np.array([0.7, 1.1, 2.3]), 3219.7, 3
    rows = np.array([[k, 0, order, 1, 300] for k in range(count)])
    task = Task(np.zeros((count, 1)), np.full((1, 3), limit), float(h.sum()))
    leaf = np.zeros(1), rows[None], np.full((1, count), 3.0)
    proved = Fraction(float(Centre(task, h[None], h[None]).least(*leaf)[0]))
    value = -sum(3 * Fraction(limit) * Fraction(x) ** (order - 2) for x in h.tolist())
    assert value * (1 + Fraction(2, 10**11)) <= proved <= value


def test_what_a_leaf_allows_for_rounding_is_the_most_of_each_term_in_its_box() -> None:
    """Jumps of snap and jerk at way-points, of the steps alone and of one velocity or acceleration
    alone: each is largest where the segment is shortest, whatever its sign."""
    low, high, count = np.array([0.7, 1.1, 2.3]), np.array([0.8, 1.2, 2.5]), 3
    unknowns = [(way, order) for way in (1, 2) for order in (1, 2)]
    load, stiffness = np.zeros((count, 4)), np.zeros((4, 4))

    def jumps(k: int, way: int, position: int, ends: np.ndarray) -> tuple[float, float]:
        """Snap and jerk of a segment at a way-point, from position and derivatives at its ends."""
        own = BPoly.from_derivatives([0.0, low[k]], [[0.0, *ends[0]], [position, *ends[1]]])
        at = low[k] * (way - k)
        return abs(float(own(at, 4))), abs(float(own(at, 3)))

    for k in range(count):
        for row, (way, order) in enumerate(unknowns):
            if way in (k, k + 1):
                load[k, row] = jumps(k, way, 1, np.zeros((2, 2)))[order - 1]
                for column, (place, other) in enumerate(unknowns):
                    if place in (k, k + 1):
                        ends = np.zeros((2, 2))
                        ends[place - k, other - 1] = 1.0
                        stiffness[row, column] += jumps(k, way, 0, ends)[order - 1]
    task = Task(np.ones((count, 1)), np.full((1, 3), 9.0), 4.0)
    centre = Centre(task, low[None], high[None])
    np.testing.assert_allclose(centre.load_top[0], load, rtol=1e-9)
    np.testing.assert_allclose(centre.stiff_top[0], stiffness, rtol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_a_window_is_below_every_sampled_motion(seed: int) -> None:
    """Σ cΔ/h − A Σ m h − V Σ|c + ψ'h| + τ(Σh − T), m the mean of |ψ|, is what a window bounds."""
    rng = np.random.default_rng([seed, 12])
    data = altered("quintic-spline", {**NO_ANSWER, "proof.rows": []})
    n, j = 3, int(rng.integers(0, 2))
    numbers = [int(x) for x in rng.integers(-(2**16), 2**16, 2 * n + 1)]
    proof = data["proof"] | {"tree": [["."]], "windows": [[j, *numbers]]}
    kind = QuinticSpline(read_problem(data["problem"]), proof, Fraction(proof["total"]), CLOCK)
    psi, c = np.array(numbers[: n + 1]) / 2**16, np.array(numbers[n + 1 :]) / 2**16
    tau = float(rng.choice([0.0, rng.uniform(-1, 1), rng.uniform(0, 3)]))
    low = rng.uniform(0.2, 1.0, n)
    high = low * rng.uniform(1.0, 3.0, n)
    step, (v, a) = kind.task.steps[:, j], kind.task.limits[j, :2]
    found = float(kind.over_windows(np.array(0), np.array(tau), low, high))

    def value(h: np.ndarray) -> float:
        mean = [np.abs(np.linspace(x, y, 4001)).mean() for x, y in pairwise(psi)]
        left = np.abs(c + np.diff(psi)).sum()
        return float((c * step / h).sum() - a * (mean * h).sum() - v * left
                     + tau * (h.sum() - kind.task.total))  # fmt: skip

    lowest = [np.linspace(x, y, 400) for x, y in zip(low, high, strict=True)]
    values = [value(rng.uniform(low, high)) for _ in range(50)]
    # Each term hangs on one duration: the least is found side by side.
    base = value(low)
    best = base + sum(
        min(value(np.where(np.arange(n) == k, x, low)) for x in lowest[k]) - base for k in range(n)
    )
    assert found <= min(values) + 1e-9
    assert found == pytest.approx(best, abs=2e-3 * (1 + abs(best)))


@pytest.mark.parametrize("seed", range(6))
def test_products_of_parts_hold_for_all_factors(seed: int) -> None:
    """‖x‖ and |xᵀy| beyond both lowest orders, for factors in [−1, 1] and remainders at random."""
    rng = np.random.default_rng([seed, 13])

    def drawn() -> tuple[Part, list[np.ndarray]]:
        leading, following = rng.normal(size=(1, 3, 4)), rng.normal(size=(1, 2, 4))
        part = Part(leading, following, rng.uniform(0.1, 2.0, 1))
        rest = rng.normal(size=4)
        rest *= part.later[0] / np.linalg.norm(rest)
        low = rng.choice([-1.0, 1.0], 3) @ leading[0]
        high = rng.choice([-1.0, 1.0], 2) @ following[0]
        return part, [low, high, rest]

    for _ in range(60):
        (one, x), (other, y) = drawn(), drawn()
        assert np.linalg.norm(sum(x)) <= one.most[0]
        beyond = sum(x) @ sum(y) - x[0] @ y[0]
        assert abs(beyond) <= one.beyond(other)[0]
    aligned = np.ones((1, 2, 1))
    both = [Part(c * aligned, d * aligned, np.array([e])) for c, d, e in ((1, 2, 3), (5, 7, 11))]
    # (2c + 2d + e)(2c′ + 2d′ + e′) − 2c·2c′
    assert both[0].beyond(both[1])[0] == pytest.approx(9 * 35 - 2 * 10)
    assert both[0].most[0] == pytest.approx(9)


@pytest.mark.parametrize("n", [1, 2, 4])
def test_a_product_of_three_variables_counts_once(n: int) -> None:
    cubes = np.random.default_rng(n).normal(size=(2, n, n, n))
    for box, found in zip(cubes, most_of_cubes(cubes), strict=True):
        sums: dict[tuple[int, ...], float] = {}
        for at in np.ndindex(n, n, n):
            one = tuple(sorted(at))
            sums[one] = sums.get(one, 0.0) + box[at]
        assert found == pytest.approx(sum(map(abs, sums.values())))
