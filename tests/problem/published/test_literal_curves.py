"""Curves of the four papers, written once more from their equations as scalars."""

from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray
from support.benchmarks import benchmark
from trajgap.problem import curves, extrema, fit, load_case

Numbers = list[float]
Array = NDArray[np.float64]
PUMA, IRB = "puma560-mnam-pso-353", "irb460-pso-353"
POLISH = "irb1600-ga-cubic-bspline"


def value_353(a: Array, h: Numbers, t: float, order: int) -> float:
    """A derivative of the three segments, each in its own time."""
    start = 0.0
    for part, length in zip((a[:4], a[4:10], a[10:]), h, strict=True):
        if t <= start + length:
            return float(np.polyval(np.polyder(part, order) if order else part, t - start))
        start += length
    raise AssertionError(t)


@pytest.mark.parametrize(
    ("case_id", "claim"), [(PUMA, "mnam-longest"), (IRB, "durations-80"), (IRB, "durations-110")]
)
def test_the_14_conditions_give_the_curve(case_id: str, claim: str) -> None:
    """A a = b as (22) of irb460 prints A; rows that the text has lost are those of (23)."""
    coefficients = benchmark("author_code")["coefficients"]
    case = load_case(case_id)
    h = [number.value for number in case.claim(claim).durations]
    problem = case.problem(case.claim(claim).problem)
    motion = fit(curves.three_five_three(), problem.waypoints, h)
    for joint, q in enumerate(problem.waypoints.T):
        a = np.concatenate(coefficients(q, *h))
        for t in np.linspace(0.0, sum(h) * (1 - 1e-12), 37):
            for order in range(3):
                value = value_353(a, h, float(t), order)
                assert motion([t], order)[0, joint] == pytest.approx(value, abs=1e-11)


def vertices(w: Numbers) -> Numbers:
    """V0..V11 from (2), (V[i-1] + 4 V[i] + V[i+1])/6 = W, and (3), V1 = V0 and V[m+1] = V[m]."""
    m = len(w)
    rows = np.zeros((m + 2, m + 2))
    for i in range(m):
        rows[i, i : i + 3] = 1 / 6, 4 / 6, 1 / 6
    rows[m, :2] = rows[m + 1, -2:] = 1, -1
    found: Numbers = np.linalg.solve(rows, np.array([*w, 0.0, 0.0])).tolist()
    return found


def segment(v: Numbers, e: float, order: int) -> float:
    """θ_i(e) of (1) and its derivatives by e, from V[i-1] to V[i+2]."""
    a, b, c, d = v
    third, second, first = -a + 3 * b - 3 * c + d, a - 2 * b + c, (c - a) / 2
    return [
        (a + 4 * b + c) / 6 + e * (first + e * (second / 2 + e * third / 6)),
        first + e * (second + e * third / 2),
        second + e * third,
    ][order]


def golden_section(f: object, low: float = 0.0, high: float = 1.0) -> float:
    """Largest value inside (0, 1), as the text names it for (5) and (8)."""
    share = (sqrt(5) - 1) / 2
    for _ in range(80):
        one, two = high - share * (high - low), low + share * (high - low)
        low, high = (low, two) if f(one) >= f(two) else (one, high)  # type: ignore[operator]
    return float(f((low + high) / 2))  # type: ignore[operator]


def test_vertices_speeds_and_the_golden_section() -> None:
    """Peaks here are exact; those of the printed search never exceed them, and meet them."""
    case = load_case(POLISH)
    q = case.problem().waypoints
    curve = curves.uniform_cubic_b_spline(10, "stretched")
    for claim in ("before", "after"):
        h = [number.value for number in case.claim(claim).durations]
        motion = fit(curve, q, h)
        for joint in range(6):
            v = vertices(q[:, joint].tolist())
            np.testing.assert_allclose(v, curves.control_vertices(q)[:, joint], rtol=0, atol=1e-12)
            for order in (1, 2):
                found = []
                for i, length in enumerate(h):
                    part = v[i : i + 4]

                    def size(
                        e: float, v: Numbers = part, h: float = length, k: int = order
                    ) -> float:
                        return abs(segment(v, e, k) / h**k)  # (7): t' = l, t'' = 0

                    found.append(max(size(0.0), size(1.0), golden_section(size)))
                    at = sum(h[:i]) + 0.37 * length
                    assert abs(motion([at], order)[0, joint]) == pytest.approx(size(0.37), rel=1e-9)
                exact = [0.0] * 9
                for one in extrema(motion, joint, order):
                    exact[one.segment] = max(exact[one.segment], abs(one.value))
                np.testing.assert_array_less(found, np.array(exact) * (1 + 1e-9) + 1e-12)
                assert max(found) == pytest.approx(max(exact), rel=1e-9)


def test_the_quintic_at_rest_of_the_toolbox() -> None:
    """q(τ) = q0 + (10 τ³ − 15 τ⁴ + 6 τ⁵) (q1 − q0), from rest to rest on each segment."""
    q, h = np.random.default_rng(3).normal(size=(4, 2)), [0.7, 1.3, 0.4]
    motion, start = fit(curves.jtraj(3), q, h), 0.0
    for i, length in enumerate(h):
        for x in np.linspace(0.0, 1.0 - 1e-12, 9):
            part = 10 * x**3 - 15 * x**4 + 6 * x**5
            place = q[i] + part * (q[i + 1] - q[i])
            np.testing.assert_allclose(motion([start + x * length])[0], place, rtol=0, atol=1e-12)
        start += length
