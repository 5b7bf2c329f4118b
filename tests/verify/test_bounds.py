"""What proofs lean on, against motions made here: no bound excludes one of them."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from support.forgeries.forgery import NO_ANSWER, altered, document
from trajgap.verify import read_problem
from trajgap.verify.any_curve import AnyCurve, _furthest, _Row
from trajgap.verify.problem import StatedProblem
from trajgap.verify.reading import Clock
from trajgap.verify.three_piece import SIZE, FourThreeFour, ThreeFiveThree, _covers

CLOCK = Clock(1e9)


def exact(values: Any) -> list[Fraction]:
    return [Fraction(float(x)) for x in values]


# --- any curve ------------------------------------------------------------------------------------


def motion(rng: np.random.Generator, v: float, a: float) -> tuple[float, float, float, float]:
    """Duration, way and end speeds of a motion within |v| and |a|, in some steps at random."""
    speeds, times = [rng.uniform(-v, v)], rng.uniform(0.05, 1.0, rng.integers(1, 5))
    for dt in times:
        step = rng.choice([-1.0, 1.0, rng.uniform(-1, 1)]) * a * dt
        speeds.append(float(np.clip(speeds[-1] + step, -v, v)))
    way = sum(dt * (x + y) / 2 for dt, x, y in zip(times, speeds[:-1], speeds[1:], strict=True))
    return float(times.sum()), float(way), speeds[0], speeds[-1]


@pytest.mark.parametrize("kind", ["change", "reach", "brake"])
@pytest.mark.parametrize("seed", range(25))
def test_a_row_holds_for_every_motion(kind: str, seed: int) -> None:
    rng = np.random.default_rng([seed, 5])
    v, a = rng.uniform(0.3, 3.0, 2)
    slack = np.inf
    for _ in range(40):
        h, way, first, last = motion(rng, v, a)
        m = rng.choice([0.0, 0.3, 0.5, 1.0, rng.uniform(-0.5, 2.0)], 2)
        n = rng.choice([0.0, 0.5, 1.0, rng.uniform(0.0, 2.0)])
        sign = 1 if kind == "change" and rng.random() < 0.5 else (1 if way >= 0 else -1)
        row = _Row(kind, 0, 0, sign, *(round(float(x) * 10**10) for x in (*m, n)))
        low, high = h * rng.uniform(0.5, 1.0), h * rng.uniform(1.0, 2.0)
        terms = row.terms(*exact((way, v, a)), (Fraction(low), Fraction(high)))
        time, one, two, right = map(float, terms)
        slack = min(slack, time * h + one * first + two * last - right)
    assert slack >= -1e-9


@pytest.mark.parametrize("seed", range(30))
def test_how_far_a_span_reaches(seed: int) -> None:
    rng = np.random.default_rng([seed, 6])
    h, bend, top = rng.uniform(0.5, 2.0, 3)
    a = rng.uniform(-top, top)
    b = float(np.clip(a + rng.uniform(-1, 1) * bend * h, -top, top))

    def speed(t: float, most: float) -> float:
        return float(min(a + bend * t, b + bend * (h - t), most))

    for most in (top, np.inf):
        own = float(
            _furthest(*exact((a, b, h)), None if most > top else Fraction(top), Fraction(bend))
        )
        assert own == pytest.approx(quad(speed, 0.0, h, args=(most,), limit=400)[0], abs=1e-6)


def any_curve() -> AnyCurve:
    data = document("any-curve")
    proof = data["proof"]
    return AnyCurve(read_problem(data["problem"]), proof, Fraction(proof["total"]), CLOCK)


@pytest.mark.parametrize("seed", range(8))
def test_weighted_rows_are_least_at_a_corner(seed: int) -> None:
    """Σh − Σ weight·(left − right) is linear: its least value is at one of the corners."""
    rng, kind = np.random.default_rng([seed, 7]), any_curve()
    every = product((0, 1), (0, 1), (1, -1))
    kind._rows += [_Row("change", k, j, s, 0, 0, 0) for k, j, s in every]
    box = [tuple(sorted(exact(rng.uniform(0.7, 2.0, 2)))) for _ in range(2)]
    chosen = rng.choice(len(kind._rows), 4)
    weighted = [(kind._rows[k], Fraction(int(rng.integers(0, 9)))) for k in chosen]
    asked, values = kind._asked, []
    for h in product(*box):
        for v in product(*[(-s, s) for s in map(Fraction, ("3", "1.5"))]):
            total = sum(h)
            for row, weight in weighted:
                bend = Fraction(("2", "4")[row.joint])
                fastest = Fraction(("3", "1.5")[row.joint])
                time, first, last, right = row.terms(
                    asked.steps[row.span][row.joint], fastest, bend, box[row.span]
                )
                # At rest at both ends; at the way-point between with speed v.
                x, y = (0, v[row.joint]) if row.span == 0 else (v[row.joint], 0)
                total -= weight * (time * h[row.span] + first * x + last * y - right)
            values.append(total)
    assert kind._least_total(box, weighted) == min(values)


def test_a_total_below_the_cap_bounds_the_durations_and_the_speed() -> None:
    kind = any_curve()
    cap = Fraction(document("any-curve")["proof"]["cap"])
    # 2/3 s at 1.5 rad/s; 2.75/3 s at 3 rad/s; what is left of the cap for the other.
    assert kind.root() == [(Fraction(2, 3), Fraction(2)), (Fraction(11, 12), Fraction("1.875"))]
    changes = {
        **NO_ANSWER,
        "problem.duration_upper": [None, None],
        "problem.limits.0.0": None,
        "problem.prescribed.0": [[1, "0.25"]],
        "problem.prescribed.2": [[1, "-0.5"]],
    }
    data = altered("any-curve", changes)
    free = AnyCurve(read_problem(data["problem"]), data["proof"], Fraction(3), CLOCK)
    low = [Fraction(2, 3), Fraction(data["problem"]["duration_lower"][1])]
    spare = cap - sum(low)
    assert free.root() == [(x, x + spare) for x in low]
    assert free._speeds == [Fraction(1, 4) + 2 * cap, Fraction("1.5")]


# --- squares --------------------------------------------------------------------------------------


def reference(problem: StatedProblem, h: np.ndarray, joint: int) -> Any:
    """The three pieces by a dense system in floats: values by (segment, place in [0, 1], order)."""
    degrees = problem.declaration.degrees if problem.declaration else []
    first = np.concatenate([[0], np.cumsum([d + 1 for d in degrees])])

    def line(k: int, s: float, order: int) -> np.ndarray:
        out = np.zeros(first[-1])
        for p in range(order, degrees[k] + 1):
            out[first[k] + p] = np.prod(np.arange(p - order + 1, p + 1)) * s ** (p - order)
        return out / h[k] ** order

    q = [float(row[joint]) for row in problem.waypoints]
    rows = [(line(k, s, 0), q[k + int(s)]) for k in range(3) for s in (0.0, 1.0)]
    rows += [(line(0, 0.0, r), 0.0) for r in (1, 2)] + [(line(2, 1.0, r), 0.0) for r in (1, 2)]
    rows += [(line(k, 1.0, r) - line(k + 1, 0.0, r), 0.0) for k in (0, 1) for r in (1, 2)]
    solved = np.linalg.solve(np.array([row for row, _ in rows]), [x for _, x in rows])
    return lambda k, s, order: float(line(k, s, order) @ solved)


SQUARES = {"three-piece": ThreeFiveThree, "four-three-four": FourThreeFour}


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", SQUARES)
def test_a_row_is_the_limit_it_stands_for(name: str, seed: int) -> None:
    """As docs/explanation/certificates.md states it, at random durations."""
    rng = np.random.default_rng([seed, 8])
    limits = [[["-1.1", "1"], ["-2.2", "2"], ["-9", "8.5"]], ["0.9", "1.5", "8"]]
    changes = {
        **NO_ANSWER,
        "problem.limits": limits,
        "problem.position_upper": ["1.25", "1.75"],
        "problem.position_lower": ["-1.5", "-1.75"],
    }
    problem = read_problem(altered(name, changes)["problem"])
    total, h = 13.7, rng.uniform(0.5, 4.0, 3)
    a, b = h[0] / (h[0] + h[1]), h[2] / (h[1] + h[2])
    m, s = np.array([a * (1 - b), (1 - a) * (1 - b), b * (1 - a)]), 1 - a * b
    spots = {"place": 1, "place-first": 0, "place-last": 2}
    kinds = [k for k in spots if k in SQUARES[name].divisors]
    entries: list[list[Any]] = [
        [kind, j, order, sign, int(rng.integers(0, 2**20 + 1)), cap]
        for kind, j, order, sign, cap in product(kinds, (0, 1), range(4), (1, -1), (-1, 1))
    ]
    ends_and_mean = product(("first", "last", "mean"), (0, 1), (1, 2, 3), (-1, 2))
    entries += [
        [kind, j, order, 1, 0, cap]
        for kind, j, order, cap in ends_and_mean
        if kind != "mean" or order == 1
    ]
    entries += [["lower", k, 0, 1, 0, cap] for k in range(3) for cap in (-1, 0)]
    proof = {"kind": name, "total": str(total), "rows": entries, "tree": []}
    kind = SQUARES[name](problem, proof, Fraction(total), CLOCK)
    longest = [float(x or 0) for x in problem.longest]
    for (word, j, order, sign, place, cap), (poly, unit) in zip(entries, kind._rows, strict=True):
        value = sum(float(x) / float(unit) * a**i * b**k for (i, k), x in poly.items())
        most, hold = (total, s) if cap < 0 else (longest[cap] * (1 + 2**-40), m[cap])
        if word == "lower":
            expected = float(problem.shortest[j]) / most * hold - m[j]
            assert value == pytest.approx(expected, rel=1e-9, abs=1e-12)
            continue
        curve = reference(problem, h, j)
        q = [float(row[j]) for row in problem.waypoints]
        if word in spots:
            g, at = spots[word], place / 2**20
            x, y = h[1] / h[0], h[1] / h[2]
            divisor = SQUARES[name].divisors[word][1]
            by = a * a * b * b * sum(c * x**i * y**k for (i, k), c in divisor.items())
            reached, side = sign * curve(g, at, order) * h[g] ** order, sign
        else:
            g, by = {"first": 0, "mean": 1, "last": 2}[word], 1.0
            way = q[g + 1] - q[g]
            least_of = {"mean": (1, 1, 1)}.get(
                word, (3, 6, 6) if name == "three-piece" else (1, 2, 6)
            )
            reached = abs(way) * least_of[order - 1]
            side = (1 if way >= 0 else -1) * (-1 if word == "last" and order == 2 else 1)
        ends = (
            problem.sides[(1 + side) // 2][j][order - 1]
            if order
            else problem.position[(1 + sign) // 2][j]
        )
        limit = float(ends[0])
        if order == 0:
            expected = by * (reached - sign * limit - 2**-40)
        else:
            expected = by * reached * hold**order / (limit * most**order) - by * m[g] ** order
        assert value == pytest.approx(expected, rel=1e-7, abs=1e-9), (word, j, order, sign, cap)


def test_a_polynomial_is_covered_only_where_it_is_nowhere_negative() -> None:
    rng, covered = np.random.default_rng(9), 0
    for _ in range(300):
        poly = {(i, j): int(rng.integers(-9, 10)) for i in range(SIZE) for j in range(SIZE)}
        poly[0, 0] += int(rng.integers(0, 60))
        at = rng.integers(0, 8, 2)
        sides = [[Fraction(int(k) + edge, 8) for edge in (0, 1)] for k in at]
        box = (*sides[0], *sides[1])
        grid = [np.linspace(float(low), float(high), 17) for low, high in sides]
        lowest = min(sum(c * x**i * y**j for (i, j), c in poly.items()) for x, y in product(*grid))
        if _covers(poly, box, CLOCK):
            covered += 1
            assert lowest >= -1e-9
        else:
            assert lowest < 5.0
    assert covered > 50
    with pytest.raises(IndexError):
        _covers({(SIZE, 0): 1}, (Fraction(0), Fraction(1), Fraction(0), Fraction(1)), CLOCK)
