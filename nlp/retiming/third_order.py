"""A path timed anew with limited jerk: a cross-check where TOPPRA says nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...problem import Array, Limits, Trajectory
from .path import jump

CELLS = 240
"""Cells of a path, shared out evenly over its segments: twice as many change the time by less than
0.2 %, and take three times as long."""
_AT_REST = 1e-9
"""Speed at an end, beside the largest on the path, below which the motion is at rest there."""
_STRATEGIES = ("adaptive", "monotone")
"""Of IPOPT's barrier, one after the other. Alone the second ends nowhere on one random path in
twelve; on which paths either does depends on the last bits, and so on the processor."""


def retime_third_order(
    trajectory: Trajectory, limits: Limits, cells: int = CELLS
) -> tuple[float | None, int]:
    """A locally shortest time along a path, s(t), with limits of velocity, acceleration and jerk.

    The path is q(s) by the trajectory's own time s. On each cell s''' is constant; with v = s' and
    a = s'' at its ends and its duration h

        v₁ = v₀ + (a₀ + a₁) h/2,    Δs = v₀ h + (2 a₀ + a₁) h²/6,

    and the limits hold at the ends of the cells, from inside:

        |q′ v| ≤ V,   |q′ a + q″ v²| ≤ A,   |q′ s''' + 3 q″ v a + q‴ v³| ≤ J.

    The search begins at s(t) = t, which is one of the timings that it chooses from wherever the
    trajectory keeps its limits. An end in motion keeps its speed and acceleration.

    Parameters
    ----------
    trajectory : Trajectory
        Polynomial in time, shared by all joints, without jumps of position and velocity.
    limits : Limits
    cells : int

    Returns
    -------
    time : float or None
        A local optimum, s; None where IPOPT finds none.
    cells : int
        How many there are.

    Notes
    -----
    Between the ends of cells limits may be exceeded: the time informs and proves nothing.
    """
    import casadi as ca  # few need it, and it takes a while

    each = max(2, cells // trajectory.durations.size)
    count = each * trajectory.durations.size
    sizes = np.repeat(trajectory.durations / each, each)
    v, a = (ca.SX.sym(name, count + 1) for name in "va")
    h = ca.SX.sym("h", count)
    jerk = (a[1:] - a[:-1]) / h
    rows = [
        v[1:] - v[:-1] - (a[:-1] + a[1:]) * h / 2,
        (v[:-1] * h + (2 * a[:-1] + a[1:]) * h**2 / 6 - sizes) / sizes,
    ]
    equal = 2 * count
    for first, second, third, at in _sides(trajectory, each):
        v_, a_ = v[at : at + count], a[at : at + count]
        for j in range(trajectory.joints):
            q1, q2, q3 = (ca.DM(one[:, j]) for one in (first, second, third))
            values = (q1 * v_, q1 * a_ + q2 * v_**2, q1 * jerk + 3 * q2 * v_ * a_ + q3 * v_**3)
            pairs = zip(values, limits.derivatives[j], strict=True)
            rows += [value / cap for value, cap in pairs if np.isfinite(cap)]
    g = ca.vertcat(*rows)
    bound = np.concatenate([np.zeros(equal), np.ones(g.numel() - equal)])
    asked = {"x": ca.vertcat(v, a, h), "f": ca.sum1(h) / trajectory.total_time, "g": g}
    lower, upper = _bounds(trajectory, count)
    start = np.concatenate([np.ones(count + 1), np.zeros(count + 1), sizes])
    for strategy in _STRATEGIES:
        solver = ca.nlpsol("third_order", "ipopt", asked, _options(strategy))
        found = solver(x0=start, lbx=lower, ubx=upper, lbg=-bound, ubg=bound)
        if solver.stats()["success"]:
            return float(found["f"]) * trajectory.total_time, count
    return None, count


def _options(strategy: str) -> dict[str, Any]:
    return {
        "ipopt.print_level": 0,
        "print_time": False,
        "ipopt.sb": "yes",
        "ipopt.max_iter": 500,
        "ipopt.mu_strategy": strategy,
    }


def jerk_limited_path(trajectory: Trajectory, limits: Limits) -> bool:
    """Whether a path can be timed so: equal limits of jerk, none of snap, and no jump."""
    return bool(
        not limits.uneven
        and limits.quantities[-1] == "jerk"
        and np.isfinite(limits.jerk).any()
        and (limits.derivatives > 0).all()
        and trajectory.polynomial_in_time
        and trajectory.scaled[:, 1:].any()
        and jump(trajectory) is None
    )


def _sides(trajectory: Trajectory, each: int) -> Iterator[tuple[Array, Array, Array, int]]:
    """Derivatives by the path's parameter at the left and the right ends of all cells."""
    edges = np.linspace(0.0, 1.0, each + 1)
    for at, places in ((0, edges[:-1]), (1, edges[1:])):
        by_order = [
            np.concatenate(
                [
                    np.stack(
                        [trajectory.values(k, j, r, places) for j in range(trajectory.joints)],
                        axis=1,
                    )
                    for k in range(trajectory.durations.size)
                ]
            )
            for r in (1, 2, 3)
        ]
        yield by_order[0], by_order[1], by_order[2], at


def _bounds(trajectory: Trajectory, count: int) -> tuple[Array, Array]:
    """Bounds of speeds, accelerations and durations; a moving end keeps v = 1 and a = 0."""
    size = 2 * (count + 1) + count
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    lower[: count + 1] = 0.0
    lower[2 * (count + 1) :] = 1e-6 * trajectory.total_time / count
    speeds = np.abs(trajectory([0.0, trajectory.total_time], order=1)).max(axis=1)
    top = max(float(np.abs(trajectory.derivatives(1)).sum(axis=0).max()), 1e-300)
    for at, speed in ((0, speeds[0]), (count, speeds[1])):
        if speed > _AT_REST * top:
            lower[at] = upper[at] = 1.0
            lower[count + 1 + at] = upper[count + 1 + at] = 0.0
    return lower, upper
