"""What an expert writes for a population: exact extrema, in whole numpy arrays or compiled.

Both know the curve by heart, so no linear system is solved for 3-5-3 polynomials. The roots of the
acceleration of a quintic are those of a cubic in closed form. Nothing bounds rounding errors, and a
quintic whose leading coefficients vanish loses digits.
"""

import math

import numba
import numpy as np


def quintic(q0, q1, v0, v1, a0, a1, h):
    """Coefficients c1 to c5 in s = t/h of the quintic between two states."""
    v0, v1, a0, a1 = v0 * h, v1 * h, a0 * h * h, a1 * h * h
    d, v, a = q1 - q0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    return v0, a0 / 2, 10 * d - 4 * v + a / 2, -15 * d + 7 * v - a, 6 * d - 3 * v + a / 2


def inside(s):
    """Places in [0, 1]; others become the left end, which is looked at anyway."""
    return np.where((s > 0.0) & (s < 1.0), s, 0.0)


def cubic_roots(a, b, c, d):
    """Real roots of a s³ + b s² + c s + d; of complex ones, whatever real part comes out."""
    shift, p = b / (3 * a), (3 * a * c - b * b) / (9 * a * a)
    q = (2 * b**3 - 9 * a * b * c + 27 * a * a * d) / (54 * a**3)
    square = q * q + p**3
    size = 2 * np.sqrt(np.maximum(-p, 0.0))
    angle = np.arccos(np.clip(-8 * q / np.maximum(size**3, 1e-300), -1.0, 1.0)) / 3
    root = np.sqrt(np.maximum(square, 0.0))
    alone = np.cbrt(-q + root) + np.cbrt(-q - root)
    three = [size * np.cos(angle - 2 * math.pi * k / 3) for k in range(3)]
    return [np.where(square > 0, alone, one) - shift for one in three]


def quintic_peaks(c1, c2, c3, c4, c5, h, orders):
    """Largest |derivative| of quintics, of orders 1 to ``orders``; its last axis."""
    turns = cubic_roots(20 * c5, 12 * c4, 6 * c3, 2 * c2)
    bends = np.sqrt(np.maximum(576 * c4 * c4 - 1440 * c5 * c3, 0.0))
    places = [turns, [(-24 * c4 + sign * bends) / (120 * c5) for sign in (1, -1)], [-c4 / (5 * c5)]]
    tops = []
    for r in range(1, orders + 1):
        factors = [math.perm(p, r) for p in range(6)]
        weighted = [f * c for f, c in zip(factors[r:], [c1, c2, c3, c4, c5][r - 1 :], strict=True)]
        top = np.maximum(np.abs(weighted[0]), np.abs(sum(weighted)))
        for place in places[r - 1]:
            s, value = inside(place), weighted[-1]
            for one in weighted[-2::-1]:
                value = value * s + one
            top = np.maximum(top, np.abs(value))
        tops.append(top / h**r)
    return np.stack(tops, axis=-1)


def three_five_three(waypoints, population, limits):
    """Peaks of |v| and |a| by their limits, shape (particle, joint, 2), in whole arrays."""
    (h1, h2, h3), steps = population.T[:, :, None], np.diff(waypoints, axis=0)
    v1, v2 = 3 * steps[0] / h1, 3 * steps[2] / h3
    a1, a2 = 2 * v1 / h1, -2 * v2 / h3
    c = quintic(waypoints[1], waypoints[2], v1, v2, a1, a2, h2)
    return quintic_peaks(*c, h2, 2) / limits


def quintic_spline(waypoints, population, limits):
    """Peaks of C4 quintic splines at rest by their limits, shape (particle, joint, 3).

    Velocities and accelerations at the inner way-points make jerk and snap continuous there.
    """
    particles, n = population.shape
    h, inner = population, n - 1
    system = np.zeros((particles, 2 * inner, 2 * inner))
    right = np.zeros((particles, 2 * inner, waypoints.shape[1]))
    steps = np.diff(waypoints, axis=0)
    for b in range(inner):
        one, two = h[:, b], h[:, b + 1]
        # jerk at the end of a piece: 60 Δ/h³ − 24 v₀/h² − 36 v₁/h² − 3 a₀/h + 9 a₁/h; at its start
        # 60 Δ/h³ − 36 v₀/h² − 24 v₁/h² − 9 a₀/h + 3 a₁/h. Snap, likewise, at both.
        for row, before, after in (
            (2 * b, (-24, -36, -3, 9, 60, 2), (-36, -24, -9, 3, 60, 2)),
            (2 * b + 1, (-168, -192, -24, 36, 360, 3), (192, 168, 36, -24, -360, 3)),
        ):
            for sign, k, size, (u0, u1, w0, w1, way, power) in (
                (1, b, one, before), (-1, b + 1, two, after)
            ):  # fmt: skip
                right[:, row] -= (sign * way / size ** (power + 1))[:, None] * steps[k]
                for at, u, w in ((k - 1, u0, w0), (k, u1, w1)):
                    if 0 <= at < inner:
                        system[:, row, 2 * at] += sign * u / size**power
                        system[:, row, 2 * at + 1] += sign * w / size ** (power - 1)
    x = np.linalg.solve(system, right).reshape(particles, inner, 2, -1)
    state = np.zeros((particles, n + 1, 2, waypoints.shape[1]))
    state[:, 1:-1] = x
    v, a = state[:, :, 0], state[:, :, 1]
    wide = h[:, :, None]
    c = quintic(waypoints[:-1], waypoints[1:], v[:, :-1], v[:, 1:], a[:, :-1], a[:, 1:], wide)
    return quintic_peaks(*c, wide, 3).max(axis=1) / limits


@numba.njit(error_model="numpy")
def compiled_three_five_three(waypoints, population, limits):
    """`three_five_three` in loops over particles and joints."""
    particles, joints = population.shape[0], waypoints.shape[1]
    found = np.empty((particles, joints, 2))
    for i in range(particles):
        h1, h, h3 = population[i]
        for j in range(joints):
            v0, v1 = (
                3 * (waypoints[1, j] - waypoints[0, j]) / h1,
                3 * (waypoints[3, j] - waypoints[2, j]) / h3,
            )
            u0, u1, w0, w1 = v0 * h, v1 * h, 2 * v0 / h1 * h * h, -2 * v1 / h3 * h * h
            d = waypoints[2, j] - waypoints[1, j] - u0 - w0 / 2
            v, w = u1 - u0 - w0, w1 - w0
            c2, c3 = w0 / 2, 10 * d - 4 * v + w / 2
            c4, c5 = -15 * d + 7 * v - w, 6 * d - 3 * v + w / 2
            fast, hard = max(abs(u0), abs(u1)), max(abs(w0), abs(w1))
            bend = 576 * c4 * c4 - 1440 * c5 * c3
            if bend > 0:
                for sign in (1.0, -1.0):
                    s = (-24 * c4 + sign * math.sqrt(bend)) / (120 * c5)
                    if 0 < s < 1:
                        hard = max(hard, abs(2 * c2 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))))
            b, c, e = 0.6 * c4 / c5, 0.3 * c3 / c5, 0.1 * c2 / c5
            p, q = c / 3 - b * b / 9, b**3 / 27 - b * c / 6 + e / 2
            square = q * q + p**3
            if square > 0:
                root = math.sqrt(square)
                places = (np.cbrt(-q + root) + np.cbrt(-q - root) - b / 3, 0.0, 0.0)
            else:
                size = 2 * math.sqrt(-p)
                angle = math.acos(max(-1.0, min(1.0, -8 * q / size**3))) / 3
                places = (
                    size * math.cos(angle) - b / 3,
                    size * math.cos(angle - 2 * math.pi / 3) - b / 3,
                    size * math.cos(angle - 4 * math.pi / 3) - b / 3,
                )
            for s in places:
                if 0 < s < 1:
                    value = u0 + s * (2 * c2 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))
                    fast = max(fast, abs(value))
            found[i, j, 0] = fast / h / limits[0]
            found[i, j, 1] = hard / h**2 / limits[1]
    return found
