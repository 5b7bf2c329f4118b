"""The curves to choose from, each with a small picture of its angle and acceleration."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from markupsafe import Markup

from ...problem import Array, fit
from .submitted import case_of

_WIDTH, _HEIGHT = 160.0, 84.0
"""Size of a picture; two stand beside each other at 390 px."""


@dataclass(frozen=True)
class OfferedCurve:
    """A curve of the form: family, name, what tells it apart, and its picture."""

    family: str
    name: str
    trait: str
    picture: Markup


@cache
def offered_curves() -> tuple[OfferedCurve, ...]:
    """The curves of the form, drawn once a process."""
    # Family, as case files name it, its name, and what tells it apart.
    offered = (
        ("", "Usual for the table", "3-5-3 for four way-points, else C2 cubics"),
        ("3-5-3", "3-5-3 polynomials", "acceleration continuous; four way-points"),
        ("cubic-spline", "Cubic spline", "acceleration continuous, not 0 at the ends"),
        ("cubic-spline-virtual", "Cubic spline, two virtual points", "acceleration 0 at the ends"),
        ("quintic-spline", "Quintic spline", "jerk and snap continuous"),
        ("rest-to-rest", "Quintic, at rest at each way-point", "stops at every way-point"),
    )
    return tuple(OfferedCurve(*one, _picture(one[0]) if one[0] else Markup()) for one in offered)


def _picture(family: str) -> Markup:
    units = {"position_unit": "rad", "jerk": "1", "jerk_unit": "rad/s^3"}
    # Way-points of the pictures, rad: unequal steps and a reversal.
    points = "a\n0\n0.7\n1.2\n0.5"
    _, case = case_of({"table": points, "family": family, **units})
    problem = case.problem()
    motion = fit(problem.curve, problem.waypoints, np.full(problem.segments, 1.0))
    times = np.linspace(0.0, motion.total_time, 161)[1:-1]
    angle, acceleration = motion(times)[:, 0], motion(times, 2)[:, 0]
    breaks = motion.breaks
    marks = zip(breaks / breaks[-1], motion(breaks)[:, 0], strict=True)
    low, high = float(angle.min()), float(angle.max())
    dots = "".join(
        f'<circle cx="{x * _WIDTH:.1f}" cy="{_place(y, low, high):.1f}" r="2.4"/>' for x, y in marks
    )
    return Markup(
        f'<svg viewBox="-4 -4 {_WIDTH + 8:g} {_HEIGHT + 8:g}" role="img" aria-hidden="true">'
        f'<polyline class="second" points="{_line(times, acceleration, motion.total_time)}"/>'
        f'<polyline class="first" points="{_line(times, angle, motion.total_time)}"/>{dots}</svg>'
    )


def _line(times: Array, values: Array, total: float) -> str:
    low, high = float(values.min()), float(values.max())
    return " ".join(
        f"{_WIDTH * t / total:.1f},{_place(v, low, high):.1f}"
        for t, v in zip(times, values, strict=True)
    )


def _place(value: float, low: float, high: float) -> float:
    return _HEIGHT * (high - value) / (high - low)
