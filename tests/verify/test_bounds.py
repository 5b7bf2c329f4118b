"""What proofs lean on, against motions made here: no bound excludes one of them."""

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from support.forgeries.forgery import NO_ANSWER, altered, document
from trajgap.verify import read_problem
from trajgap.verify.any_curve import AnyCurve, _furthest, _Row
from trajgap.verify.reading import Clock

CLOCK = Clock(1e9)


def exact(values: Any) -> list[Fraction]:
    return [Fraction(float(x)) for x in values]


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
    assert kind.least_total(box, weighted) == min(values)


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
    assert free.speeds == [Fraction(1, 4) + 2 * cap, Fraction("1.5")]
