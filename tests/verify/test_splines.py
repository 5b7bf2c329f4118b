"""Splines that the verifier reads, and what bounds them, against splines by scipy."""

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from support.forgeries.forgery import NO_ANSWER, altered, document
from support.papers.motions import FAMILIES, Motion, nodes, vertices
from trajgap.verify import read_problem
from trajgap.verify.cubic import FINE, Box, Cubic, box as box_module, least
from trajgap.verify.curve import pieces, value_at
from trajgap.verify.reading import Clock

CLOCK = Clock(1e9)


def exact(values: Any) -> list[Fraction]:
    return [Fraction(float(x)) for x in values]


def spline(data: dict[str, Any], h: np.ndarray) -> Motion:
    """The declared spline, by another route."""
    p = data["problem"]
    ends = {1: "clamped cubic", 2: "natural cubic"}[p["prescribed"][0][0][0]]
    name = "C4 quintic" if p["degrees"][0] == 5 else "virtual cubic" if p["virtual"] else ends
    q = [[float(Fraction(x)) for x in row] for row in p["waypoints"]]
    return FAMILIES[name].fit(np.array(q), h)


@pytest.mark.parametrize("kind", ["cubic", "cubic-virtual", "quintic-spline"])
def test_a_declared_spline_is_that_of_scipy(kind: str) -> None:
    data = document(kind)
    problem, rng = read_problem(data["problem"]), np.random.default_rng(3)
    for _ in range(4):
        h = rng.uniform(0.4, 2.0, problem.segments)
        found = pieces(problem, exact(h), CLOCK)
        curve, t = spline(data, h), nodes(h)
        for k, s in product(range(problem.segments), (0.0, 0.3, 1.0)):
            own = [float(value_at(one[k], Fraction(s))) for one in found]
            assert own == pytest.approx(curve.at(t[[k]] + s * h[k], 0)[0], abs=1e-9)


def test_a_uniform_b_spline_goes_through_its_points_with_two_equal_vertices_at_each_end() -> None:
    problem = read_problem(document("stretched")["problem"])
    for j, curve in enumerate(pieces(problem, [Fraction(7)] * problem.segments, CLOCK)):
        v = vertices(np.array([[float(row[j])] for row in problem.waypoints]))[:, 0]
        for k, piece in enumerate(curve):
            a, b, c, d = v[k : k + 4]
            power = [(a + 4 * b + c) / 6, (c - a) / 2, (a + c) / 2 - b, (d - a) / 6 + (b - c) / 2]
            assert [float(x) for x in piece] == pytest.approx(power, abs=1e-12)


def state(data: dict[str, Any], cubic: Cubic, h: np.ndarray) -> tuple[list[Any], list[Any]]:
    """Coordinates and each joint's unknowns of the true spline, in the units of the proof."""
    second = float(cubic.second)
    t, curve = nodes(h), spline(data, h)
    ends = t if not cubic.virtual else np.delete(t, (1, len(t) - 2))
    spans = np.diff(ends) / second
    y = [*spans]
    if cubic.virtual:
        y += [h[0] / second, h[-1] / second]
        y += [y[-2] ** 2 / spans[0], y[-1] ** 2 / spans[-1]]
    x = []
    for j in range(cubic.joints):
        angle = 2.0 ** data["proof"]["powers"][j]
        bends = curve.at(t, 2)[:, j] * second**2 / angle
        x.append([*bends, *(curve.at(ends, 1)[:, j] * second / angle)])
    return y, x


def drawn(name: str, seed: int, width: float) -> Any:
    """A system, a box around random durations, and true splines within."""
    rng = np.random.default_rng([seed, 10])
    natural = {"problem.prescribed": [[[2, "0"]], [], [], [[2, "0"]]]} if seed % 2 else {}
    if name == "cubic-virtual":
        natural = {}
    data = altered(
        name,
        {**NO_ANSWER, **natural, "problem.limits": [["30", "200", "4000"]] * 2, "proof.cap": 2**28},
    )
    cubic = Cubic(read_problem(data["problem"]), data["proof"])
    h = rng.uniform(0.3, 1.2, cubic.n)
    inside = [h * (1 + width * rng.uniform(-0.4, 0.4, cubic.n)) for _ in range(12)]
    found = [state(data, cubic, each) for each in (h, *inside)]
    ys = np.array([y[: cubic.free] for y, _ in found]) * 2**24
    box = Box(
        [int(v) for v in ys.min(axis=0)],
        [int(v) + 1 for v in ys.max(axis=0)],
        [[None] * cubic.size for _ in range(2)],
    )
    box.trim(cubic)
    return rng, data, cubic, box, found


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", ["cubic", "cubic-virtual"])
def test_ranges_hold_every_spline_of_a_box(name: str, seed: int) -> None:
    for width in (0.0, 0.02, 0.3):
        _, _, cubic, box, found = drawn(name, seed, width)
        box.narrow(cubic, CLOCK)
        assert not box.empty
        for y, x in found:
            for side, value in zip(box.sides(cubic), y, strict=True):
                assert float(side[0]) - 1e-7 <= value <= float(side[1]) + 1e-7
            for j, v in product(range(2), range(cubic.size)):
                low, high = (end / FINE for end in box.x[j][v])
                slack = 1e-7 * (1 + abs(x[j][v]))
                assert float(low) - slack <= x[j][v] <= float(high) + slack
                if width == 0.0:  # and they are worth something
                    assert float(high - low) < 1e-3 * (1 + abs(x[j][v]))


@pytest.mark.parametrize("seed", range(4))
def test_ranges_of_a_small_span_are_narrow(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    # Coincident way-points and a velocity limit alone: nothing keeps the span from 0.
    same = {"problem.waypoints.1": document("cubic-virtual")["problem"]["waypoints"][0]}
    limits = {"problem.limits": [["1", None, None]] * 2, "proof.cap": 2**28}
    data = altered("cubic-virtual", {**NO_ANSWER, **same, **limits})
    cubic, rng = Cubic(read_problem(data["problem"]), data["proof"]), np.random.default_rng(seed)
    y = rng.uniform(1.0, 3.0, cubic.free)
    y[0] = rng.uniform(1e-6, 4e-6)
    y[cubic.m], y[cubic.m + 1] = 0.7 * y[0], 0.6 * y[cubic.m - 1]
    found = []
    for digits in (2**80, 2**200):
        monkeypatch.setattr(box_module, "_INNER", digits)
        low, high = ([int(z * w * 2**24) for z in y] for w in (0.999, 1.001))
        box = Box(low, [z + 1 for z in high], [[None] * cubic.size for _ in range(2)])
        box.trim(cubic)
        box.narrow(cubic, CLOCK)
        found.append(np.array(box.x, dtype=np.float64) / FINE)
    assert np.isfinite(found[1]).all()
    assert found[0] == pytest.approx(found[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("name", ["cubic", "cubic-virtual"])
def test_weights_bound_every_spline_of_a_box(name: str, seed: int) -> None:
    """Conditions and equations with weights, at true splines: never below what is called least."""
    for width in (0.0, 0.05):
        rng, _, cubic, box, found = drawn(name, seed, width)
        box.narrow(cubic, CLOCK)
        rows = [
            ["total", -1, 0, 1, 0],
            ["lower", -1, 1, 1, 0],
            ["upper", -1, 2, 1, 0],
            ["jerk", 0, 1, 1, 0],
            ["jerk", 1, 0, -1, 0],
            ["velocity", 0, 0, 1, 40],
            ["velocity", 1, cubic.m - 1, -1, 9],
            ["velocity", 0, 1, -1, 64],
            ["jerk", 1, cubic.n - 1, 1, 0],
            ["upper", -1, 0, 1, 0],
        ]
        known = [cubic.condition(row) for row in rows]
        held = [z for k in range(len(rows)) for z in (k, int(rng.integers(0, 9)))]
        count = 2 * cubic.size
        equations = [z for k in range(count) for z in (k, int(rng.integers(-5, 6)))]
        target = {k: int(rng.integers(-3, 8)) for k in range(cubic.free)}
        terms: dict[Any, Fraction] = {}
        for k, w in zip(held[::2], held[1::2], strict=True):
            for key, z in known[k][1].items():
                terms[known[k][0], key] = terms.get((known[k][0], key), 0) + w * z
        for k, w in zip(equations[::2], equations[1::2], strict=True):
            j, i = divmod(k, cubic.size)
            for key, z in cubic.equations[i].items():
                terms[j, key] = terms.get((j, key), 0) + w * z
        length = sum(type(key) is not int and z != 0 for (_, key), z in terms.items())
        mix = "".join(rng.choice(list("0g7wm"), length))
        bound = float(least(cubic, box, known, target, held, equations, lambda _, mix=mix: mix))
        values = []
        for y, x in found:
            value = sum(w * y[k] for k, w in target.items())
            for k, w in zip(held[::2], held[1::2], strict=True):
                joint, own, along, rest = known[k]
                value += w * float(rest) + w * sum(float(z) * y[c] for c, z in along.items())
                value += w * sum(
                    float(z) * (x[joint][key] if type(key) is int else y[key[0]] * x[joint][key[1]])
                    for key, z in own.items()
                )
            values.append(value)
        scale = 1 + max(map(abs, values))
        assert bound <= min(values) + 1e-6 * scale
        if width == 0.0:
            assert bound >= min(values) - 2e-2 * scale


def test_a_condition_is_the_limit_it_stands_for() -> None:
    for name in ("cubic", "cubic-virtual"):
        for seed in range(4):
            _, data, cubic, _, found = drawn(name, seed, 0.4)
            second = float(cubic.second)
            for y, x in found:
                for joint, k, sign, place in product((0, 1), range(cubic.m), (1, -1), (0, 13, 64)):
                    own = cubic.condition(["velocity", joint, k, sign, place])
                    angle = 2.0 ** data["proof"]["powers"][joint]
                    value = float(own[3]) + sum(
                        float(z)
                        * (x[joint][key] if type(key) is int else y[key[0]] * x[joint][key[1]])
                        for key, z in own[1].items()
                    )
                    length, start = y[k], x[joint][cubic.n + 1 + k]
                    a, b = x[joint][cubic.breaks[k]], x[joint][cubic.breaks[k + 1]]
                    if cubic.virtual and k in (0, cubic.m - 1):
                        h = y[cubic.m] if k == 0 else y[cubic.m + 1]
                        length -= h
                        a = x[joint][1 if k == 0 else cubic.n - 1]
                        b = x[joint][2 if k == 0 else cubic.n - 2]
                        start = h * a / 2
                    s = place / 64
                    speed = start + length * (a * (s - s * s / 2) + b * s * s / 2)
                    limit = 30 * second / angle
                    assert value == pytest.approx(sign * speed - limit, abs=1e-6 * limit)


@pytest.mark.parametrize("sides", [((0.4, 0.5), (1.0, 1.2)), ((0.0, 0.5), (0.0, 1.0))])
def test_squares_of_a_length_over_a_span_lie_in_their_range(sides: Any) -> None:
    data = altered("cubic-virtual", {**NO_ANSWER, "proof.cap": 2**28})
    cubic = Cubic(read_problem(data["problem"]), data["proof"])
    low, high = [2**22] * 5, [2**25] * 5
    for k, (a, b) in ((3, sides[0]), (0, sides[1])):
        low[k], high[k] = int(a * 2**24), int(b * 2**24)
    box = Box(low, high, [[None] * cubic.size for _ in range(2)])
    box.trim(cubic)
    found = tuple(map(float, box.sides(cubic)[5]))
    (h0, h1), (t0, t1) = sides
    # A piece is no longer than its span.
    assert found[0] == pytest.approx(h0 * h0 / t1, abs=1e-6)
    assert found[1] == pytest.approx(h1 * h1 / t0 if t0 else h1, abs=1e-6)
