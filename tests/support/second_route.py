"""3-5-3 optima by a route that shares no code with the package.

Unscaled 14 × 14 systems in each segment's own time (as puma560 (6)–(9) writes them), peaks by
dense sampling and Newton's method, scipy's SLSQP on the three durations.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize


def _rows(t1: float, t2: float, t3: float) -> np.ndarray:
    def power(t: float, degree: int, order: int) -> np.ndarray:
        row = np.zeros(degree + 1)
        for p in range(order, degree + 1):
            row[p] = np.prod(np.arange(p, p - order, -1.0)) * t ** (p - order)
        return row

    rows = []

    def add(first: np.ndarray | None, second: np.ndarray | None, third: np.ndarray | None) -> None:
        blocks = [first, second, third]
        sizes = (4, 6, 4)
        rows.append(
            np.concatenate(
                [np.zeros(n) if b is None else b for b, n in zip(blocks, sizes, strict=True)]
            )
        )

    add(power(0, 3, 0), None, None)
    add(power(0, 3, 1), None, None)
    add(power(0, 3, 2), None, None)
    add(power(t1, 3, 0), None, None)
    add(None, power(0, 5, 0), None)
    add(power(t1, 3, 1), -power(0, 5, 1), None)
    add(power(t1, 3, 2), -power(0, 5, 2), None)
    add(None, power(t2, 5, 0), None)
    add(None, None, power(0, 3, 0))
    add(None, power(t2, 5, 1), -power(0, 3, 1))
    add(None, power(t2, 5, 2), -power(0, 3, 2))
    add(None, None, power(t3, 3, 0))
    add(None, None, power(t3, 3, 1))
    add(None, None, power(t3, 3, 2))
    return np.array(rows)


def curves(durations: np.ndarray, waypoints: np.ndarray) -> list[list[np.ndarray]]:
    """Ascending coefficients in time, per joint and segment."""
    matrix = _rows(*durations)
    found = []
    for q in waypoints.T:
        right = np.array([q[0], 0, 0, q[1], q[1], 0, 0, q[2], q[2], 0, 0, q[3], 0, 0])
        x = np.linalg.solve(matrix, right)
        found.append([x[:4], x[4:10], x[10:]])
    return found


def signed_peak(polynomial: np.ndarray, duration: float, order: int) -> float:
    """Largest absolute value of a derivative on one segment: 401 samples, then Newton."""
    value = np.polynomial.Polynomial(polynomial).deriv(order)
    slope, bend = value.deriv(), value.deriv(2)
    t = np.linspace(0.0, duration, 401)
    best = float(t[np.argmax(np.abs(value(t)))])
    x = best
    for _ in range(50):
        if bend(x) == 0:
            break
        last, x = x, float(np.clip(x - slope(x) / bend(x), 0.0, duration))
        if x == last:
            break
    return max(abs(float(value(x))), abs(float(value(best))))


def ratios(
    durations: np.ndarray, waypoints: np.ndarray, velocity: float, acceleration: float
) -> np.ndarray:
    """Largest |v|/V and |a|/A of every joint and segment."""
    out = []
    for joint in curves(durations, waypoints):
        for polynomial, duration in zip(joint, durations, strict=True):
            for order, limit in ((1, velocity), (2, acceleration)):
                if np.isfinite(limit):
                    out.append(signed_peak(polynomial, duration, order) / limit)
    return np.array(out)


def shortest(
    waypoints: np.ndarray,
    velocity: float,
    acceleration: float,
    lower: float,
    starts: np.ndarray,
) -> tuple[float, np.ndarray]:
    """Best total over the starts, and its durations."""
    best, at = np.inf, starts[0]
    for start in starts:
        answer = minimize(
            np.sum,
            start,
            jac=lambda h: np.ones_like(h),
            bounds=[(max(lower, 1e-3), None)] * 3,
            constraints={
                "type": "ineq",
                "fun": lambda h: 1.0 - ratios(h, waypoints, velocity, acceleration),
                "jac": lambda h: -_jacobian(h, waypoints, velocity, acceleration),
            },
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 300},
        )
        worst = ratios(answer.x, waypoints, velocity, acceleration).max()
        if worst <= 1 + 1e-9 and answer.fun < best:
            best, at = float(answer.fun), answer.x
    return best, at


def _jacobian(
    h: np.ndarray, waypoints: np.ndarray, velocity: float, acceleration: float
) -> np.ndarray:
    columns = []
    for k in range(3):
        step = np.zeros(3)
        step[k] = 1e-6 * h[k]
        ahead = ratios(h + step, waypoints, velocity, acceleration)
        behind = ratios(h - step, waypoints, velocity, acceleration)
        columns.append((ahead - behind) / (2 * step[k]))
    return np.array(columns).T
