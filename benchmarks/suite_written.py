"""An instance of the suite as its case file is written: curve, titles, limits, numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

CURVES = {
    "353": ("3-5-3", {}),
    "434": ("polynomials", {"degrees": [4, 3, 4], "continuity": 2, "end_orders": [1, 2]}),
    "cubic": ("cubic-spline", {}),
    "natural": ("cubic-spline", {"end_orders": [2]}),
    "virtual": ("cubic-spline-virtual", {}),
    "quintic": ("quintic-spline", {}),
    "septic": ("rest-to-rest", {"degree": 7}),
    "septic-c6": ("polynomials", {}),
}
"""First part of a name: family of the case file and its keys."""

TITLES = {
    "353": "3-5-3 polynomials",
    "434": "4-3-4 polynomials",
    "cubic": "C2 cubic spline, at rest at both ends",
    "natural": "natural C2 cubic spline",
    "virtual": "C2 cubic spline with two virtual way-points",
    "quintic": "C4 quintic spline",
    "septic": "septic polynomials from rest to rest",
    "septic-c6": "C6 septic spline",
}
"""First part of a name in words."""

WORDS = {
    "353": "3-5-3",
    "434": "4-3-4",
    "cubic": "C2 cubic",
    "natural": "natural C2 cubic",
    "virtual": "C2 cubic, virtual points",
    "quintic": "C4 quintic",
    "septic": "septic at rest",
    "septic-c6": "C6 septic",
}
"""The same, as short as a table wants it."""

LIMITS = {
    # velocity, acceleration, jerk of a joint before its own factor; rad, s. The way-points lie
    # within ±1.5 rad, so a segment takes about a second.
    "v": (1.5, 40.0, 600.0),
    "a": (8.0, 4.0, 200.0),
    "j": (8.0, 20.0, 20.0),
    "vaj": (1.5, 4.0, 20.0),
    "v-only": (1.5, None, None),
    "va-only": (1.5, 4.0, None),
}
"""Which limit is meant to decide: limits of a joint before its own factor."""

REACH = 1.5
"""Way-points lie within ± this angle, rad."""


@dataclass(frozen=True)
class Written:
    """What a case file of the suite says."""

    name: str
    curve: str
    waypoints: tuple[tuple[float, ...], ...]
    velocity: tuple[float, ...] | None
    acceleration: tuple[float, ...] | None
    jerk: tuple[float, ...] | None
    unit: str
    source: str
    note: str
    year: int | None = None
    lower: float | None = None
    """Lower bound of the durations where it belongs to the instance, s."""

    @property
    def segments(self) -> int:
        """Between the way-points."""
        return len(self.waypoints) - 1

    def box(self) -> tuple[float, float]:
        """Bounds of every duration, s: wide enough that none is active unless it is meant to be.

        A segment from rest to rest by a quintic polynomial needs h; the box goes from 1/20 of the
        shortest h to three times the longest, two digits each.
        """
        steps = []
        for before, after in pairwise(self.waypoints):
            needed = 0.0
            for j, (p, q) in enumerate(zip(before, after, strict=True)):
                d = abs(q - p)
                for limits, factor, order in (
                    (self.velocity, 1.875, 1),
                    (self.acceleration, 5.7736, 2),
                    (self.jerk, 60.0, 3),
                ):
                    if limits is not None:
                        needed = max(needed, (factor * d / limits[j]) ** (1 / order))
            steps.append(needed)
        moving = [h for h in steps if h > 0]
        least = self.lower if self.lower is not None else _two_digits(min(moving) / 20, math.floor)
        return least, _two_digits(3 * max(moving), math.ceil)

    def text(self) -> str:
        """The case file."""
        family, keys = CURVES[self.curve]
        keys = dict(keys)
        if self.curve == "septic-c6":
            keys = {"degrees": [7] * self.segments, "continuity": 6, "end_orders": [1, 2, 3]}
        low, high = self.box()
        joints = len(self.waypoints[0])
        title = f"{TITLES[self.curve]}, {self.segments} segments, {joints} joints: {self.note}"
        lines = [
            "# An instance of the suite: written by benchmarks/make_suite.py, not by hand.",
            "# Every number is meant exactly.",
            "format = 1",
            f'id = "{self.name}"',
            f'title = "{title}"',
            "",
            "[source]",
            f'title = "{self.source}"',
            *([f"year = {self.year}"] if self.year else []),
            "",
            "[robot]",
            'name = "none: seeded"' if self.source.startswith("Seeded") else 'name = "as there"',
            f"joints = [{', '.join(repr(str(j + 1)) for j in range(joints))}]".replace("'", '"'),
            "",
            "[units]",
            f'position = "{self.unit}"',
            f'velocity = "{self.unit}/s"',
            f'acceleration = "{self.unit}/s^2"',
            f'jerk = "{self.unit}/s^3"',
            'time = "s"',
            "",
            "[waypoints]",
            "waypoint_rows = [",
            *(f"  [{_row(row)}]," for row in self.waypoints),
            "]",
            "",
            "[limits]",
        ]
        for name in ("velocity", "acceleration", "jerk"):
            values = getattr(self, name)
            if values is not None:
                lines.append(f"{name} = [{_row(values)}]")
        lines += ["", "[interpolant]", f'family = "{family}"']
        lines += [f"{key} = {value}" for key, value in keys.items()]
        lines += ["", "[durations]", f"lower = {_number(low)}", f"upper = {_number(high)}"]
        return "\n".join(lines) + "\n"


def _two_digits(x: float, rounded: type[int] | object) -> float:
    power = math.floor(math.log10(x)) - 1
    digits = rounded(x / 10.0**power)  # type: ignore[operator]
    return float(f"{digits}e{power}")


def _number(x: float) -> str:
    return f"{x:g}" if x == int(x) else repr(x)


def _row(values: tuple[float, ...]) -> str:
    return ", ".join(map(_number, values))
