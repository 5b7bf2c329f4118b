"""Curves and kinematics of the four papers, written once more from their equations as scalars."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray
from trajgap.problem import (
    ClampedBSpline,
    clamped_control_points,
    control_vertices,
    extrema,
    fit,
    forward_kinematics,
    jtraj,
    load_case,
    load_robot,
    three_five_three,
    uniform_cubic_b_spline,
)

Numbers = list[float]
Array = NDArray[np.float64]
PUMA, IRB = "puma560-mnam-pso-353", "irb460-pso-353"
POLISH = "irb1600-ga-cubic-bspline"


# --- 3-5-3 polynomials: puma560 (1)-(9), irb460 (20)-(23) -----------------------------------------


def coefficients(t1: float, t2: float, t3: float, q: Numbers) -> Array:
    """A a = b, a = A⁻¹ b: a13..a10, a25..a20, a33..a30, row by row as (22) of irb460 prints A.

    Rows whose entries the text has lost are those that the order of (23) leaves: the end of the
    third segment, its start, and the start of the first.
    """
    rows = [
        [t1**3, t1**2, t1, 1, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0],
        [3 * t1**2, 2 * t1, 1, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0],
        [6 * t1, 2, 0, 0, 0, 0, 0, -2, 0, 0, 0, 0, 0, 0],
        [0] * 4 + [t2**5, t2**4, t2**3, t2**2, t2, 1, 0, 0, 0, -1],
        [0] * 4 + [5 * t2**4, 4 * t2**3, 3 * t2**2, 2 * t2, 1, 0, 0, 0, -1, 0],
        [0] * 4 + [20 * t2**3, 12 * t2**2, 6 * t2, 2, 0, 0, 0, -2, 0, 0],
        [0] * 10 + [t3**3, t3**2, t3, 1],
        [0] * 10 + [3 * t3**2, 2 * t3, 1, 0],
        [0] * 10 + [6 * t3, 2, 0, 0],
        [0, 0, 0, 1] + [0] * 10,
        [0, 0, 1, 0] + [0] * 10,
        [0, 2, 0, 0] + [0] * 10,
        [0] * 13 + [1],
        [0] * 9 + [1] + [0] * 4,
    ]
    b = [0, 0, 0, 0, 0, 0, q[3], 0, 0, q[0], 0, 0, q[2], q[1]]
    found: Array = np.linalg.solve(np.array(rows, float), np.array(b, float))
    return found


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
    case = load_case(case_id)
    h = [number.value for number in case.claim(claim).durations]
    problem = case.problem(case.claim(claim).problem)
    motion = fit(three_five_three(), problem.waypoints, h)
    for joint, q in enumerate(problem.waypoints.T):
        a = coefficients(h[0], h[1], h[2], q.tolist())
        for t in np.linspace(0.0, sum(h) * (1 - 1e-12), 37):
            for order in range(3):
                value = value_353(a, h, float(t), order)
                assert motion([t], order)[0, joint] == pytest.approx(value, abs=1e-11)


# --- clamped B-splines: z1 (1)-(12) ---------------------------------------------------------------


def basis(i: int, p: int, u: float, knots: Numbers) -> float:
    """N_{i,p}(u), (2), by its recursion; where a denominator is 0 the term is 0."""
    if p == 0:
        return float(knots[i] <= u < knots[i + 1])
    left, right = knots[i + p] - knots[i], knots[i + p + 1] - knots[i + 1]
    return ((u - knots[i]) / left * basis(i, p - 1, u, knots) if left else 0.0) + (
        (knots[i + p + 1] - u) / right * basis(i + 1, p - 1, u, knots) if right else 0.0
    )


def derived(d: Numbers, p: int, knots: Numbers) -> tuple[Numbers, int, Numbers]:
    """Control points, degree and knots of the derivative, (7) and (8)."""
    fewer = [p / (knots[i + p + 1] - knots[i + 1]) * (d[i + 1] - d[i]) for i in range(len(d) - 1)]
    return fewer, p - 1, knots[1:-1]


@pytest.mark.parametrize("degree", [3, 4, 5, 6, 7])
def test_bases_derivatives_and_ends_of_the_b_spline(degree: int) -> None:
    rng = np.random.default_rng(degree)
    waypoints, h = rng.normal(size=(8, 2)), rng.uniform(0.9, 1.1, 7)
    curve = ClampedBSpline(8, degree, "averaged-continued", "times")
    control, vectors = clamped_control_points(curve, waypoints, h)
    motion, end = fit(curve, waypoints, h), float(h.sum())
    for joint in range(2):
        d, p, knots = control[:, joint].tolist(), degree, vectors[:, joint].tolist()
        assert len(knots) == len(d) + p + 1  # m = n + p + 1
        for order in range(3):
            for t in np.linspace(0.0, end * (1 - 1e-9), 23):
                value = sum(di * basis(i, p, t, knots) for i, di in enumerate(d))
                assert motion([t], order)[0, joint] == pytest.approx(value, abs=1e-8)
            d, p, knots = derived(d, p, knots)
        # (9) to (12) on [0, 1]; the text of (11) has lost the d1 of its middle term.
        d, p = control[:, joint].tolist(), degree
        u = [knot / end for knot in vectors[:, joint].tolist()]
        a, b, y, z = u[p + 1], u[p + 2], u[-p - 2], u[-p - 3]
        first = p / a * (d[1] - d[0])
        last = p / (1 - y) * (d[-1] - d[-2])
        bend = p * (p - 1) / a * (d[0] / a - (a + b) * d[1] / (a * b) + d[2] / b)
        slow = p * (p - 1) / (1 - y) * (
            d[-1] / (1 - y) - (2 - y - z) * d[-2] / ((1 - y) * (1 - z)) + d[-3] / (1 - z)
        )  # fmt: skip
        for at, order, value in ((0.0, 1, first), (end, 1, last), (0.0, 2, bend), (end, 2, slow)):
            assert motion([at], order)[0, joint] * end**order == pytest.approx(value, abs=1e-7)


# --- uniform cubic B-splines: irb1600 (1)-(9) -----------------------------------------------------


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
    curve = uniform_cubic_b_spline(10, "stretched")
    for claim in ("before", "after"):
        h = [number.value for number in case.claim(claim).durations]
        motion = fit(curve, q, h)
        for joint in range(6):
            v = vertices(q[:, joint].tolist())
            np.testing.assert_allclose(v, control_vertices(q)[:, joint], rtol=0, atol=1e-12)
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


# --- jtraj: the baseline of irb460 and z1 ---------------------------------------------------------


def test_the_quintic_at_rest_of_the_toolbox() -> None:
    """q(τ) = q0 + (10 τ³ − 15 τ⁴ + 6 τ⁵) (q1 − q0), from rest to rest on each segment."""
    q, h = np.random.default_rng(3).normal(size=(4, 2)), [0.7, 1.3, 0.4]
    motion, start = fit(jtraj(3), q, h), 0.0
    for i, length in enumerate(h):
        for x in np.linspace(0.0, 1.0 - 1e-12, 9):
            part = 10 * x**3 - 15 * x**4 + 6 * x**5
            place = q[i] + part * (q[i + 1] - q[i])
            np.testing.assert_allclose(motion([start + x * length])[0], place, rtol=0, atol=1e-12)
        start += length


# --- forward kinematics: Table 1 of z1 ------------------------------------------------------------


def test_the_standard_convention_of_the_z1() -> None:
    d, a = (0.1305, 0, 0, 0, 0, 0.0982), (0, 0.3500, 0.2253, 0.0720, 0, 0)
    twists = (pi / 2, 0, 0, pi / 2, pi / 2, 0)
    arm = load_robot("z1")
    for q in np.random.default_rng(5).uniform(-pi, pi, (20, 6)):
        pose = np.eye(4)
        for t, di, ai, al in zip(q, d, a, twists, strict=True):
            pose = pose @ np.array([
                [cos(t), -sin(t) * cos(al), sin(t) * sin(al), ai * cos(t)],
                [sin(t), cos(t) * cos(al), -cos(t) * sin(al), ai * sin(t)],
                [0, sin(al), cos(al), di],
                [0, 0, 0, 1],
            ])  # fmt: skip
        np.testing.assert_allclose(forward_kinematics(arm, q), pose, rtol=0, atol=1e-14)
    assert hypot(*pose[:3, 3]) <= arm.reach
