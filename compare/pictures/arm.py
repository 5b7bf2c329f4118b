"""Picture of an arm that follows motions side by side: steps of time, vectors, no network."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import InitVar, dataclass
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Chain, TrajgapError, forward_kinematics, link_frames, visible
from .drawing import BLUE, GREEN, ORANGE, RED

_COLOURS = {ORANGE: "orange", BLUE: "blue", GREEN: "green", RED: "red"}
"""Of the motions, in order, with the variables of a theme that replace them."""


@dataclass(frozen=True, eq=False)
class ArmMotion:
    """A motion as samples over time."""

    label: str
    """Such as "as printed"."""
    times: Array
    """Ascending from 0, s; the last one is the total; shape (samples,)."""
    angles: Array
    """rad; shape (samples, joints)."""

    def at(self, times: Array) -> Array:
        """Angles at some times, shape (times, joints); after its end the arm stands still."""
        return np.column_stack([np.interp(times, self.times, a) for a in self.angles.T])


def arm_picture(
    chain: Chain, motions: Sequence[ArmMotion], waypoints: ArrayLike, *, name: str, title: str
) -> str:
    """Panels in which one arm follows each motion, with a slider over time, as HTML.

    SVG, its own style and a script for the slider. Without the script the arms stand at the start,
    with the ways of their ends.

    `chain`: joints of links are drawn at the origins of its frames. `motions`: one to four; the
    panels share the clock, so the fastest arm waits at its end. `waypoints`: shape (way-points,
    joints), rad; drawn where the end of the arm stands. `name`: unique in the page: letters, digits
    and dashes.
    """
    if not 1 <= len(motions) <= len(_COLOURS):
        raise TrajgapError(f"arm_picture: {len(motions)} motions; give one to {len(_COLOURS)}")
    for one in motions:
        if one.angles.shape != (one.times.size, chain.joints):
            raise TrajgapError(
                f"arm_picture: {one.label}: angles of shape {one.angles.shape} for "
                f"{one.times.size} times and {chain.joints} joints"
            )
    longest = max(float(one.times[-1]) for one in motions)
    clock = np.linspace(0.0, longest, 73)  # 20 steps a second for three or four seconds
    # Origins of base and links, shape (times, joints + 1, 3).
    arms = [
        np.pad(link_frames(chain, one.at(clock))[..., :3, 3], ((0, 0), (1, 0), (0, 0)))
        for one in motions
    ]
    # The way of each end, a curve to the eye, shape (points, 3).
    ways = [
        forward_kinematics(chain, one.at(np.linspace(0.0, float(one.times[-1]), 161)))[..., :3, 3]
        for one in motions
    ]
    marks = forward_kinematics(chain, np.asarray(waypoints, dtype=np.float64))[..., :3, 3]
    view = _View(np.vstack([*(a.reshape(-1, 3) for a in arms), marks]))
    panels = "".join(
        _panel(one, arm, way, view, marks, colour, f"{name}-{k}")
        for k, (one, arm, way, colour) in enumerate(
            zip(motions, arms, ways, _COLOURS, strict=False)
        )
    )
    frames = [[view.line(pose) for pose in arm] for arm in arms]
    floors = [[view.line(pose * (1, 1, 0)) for pose in arm] for arm in arms]
    data = json.dumps(
        {
            "clock": [round(float(t), 3) for t in clock],
            "totals": [round(float(one.times[-1]), 4) for one in motions],
            "arms": frames,
            "floors": floors,
        },
        separators=(",", ":"),
    )
    static = Path(__file__).parent / "static"
    names = ("arm.css", "arm_controls.html", "arm.js")
    style, controls, script = ((static / one).read_text(encoding="utf-8") for one in names)
    return (
        f'<figure class="trajgap-arm" id="{name}">\n<style>\n{style}</style>\n'
        f"<figcaption>{escape(visible(title))}</figcaption>\n"
        f'<div class="trajgap-arm-panels">\n{panels}</div>\n{controls}'
        f'<script type="application/json">{data}</script>\n<script>\n{script}</script>\n</figure>\n'
    )


@dataclass
class _View:
    """Parallel projection that fits all points into a panel, of which three stand side by side."""

    points: InitVar[Array]
    turn: float = np.deg2rad(-55.0)
    tilt: float = np.deg2rad(22.0)
    """The eye stands beside the arm and a little above, so no axis points at it."""
    wide: float = 300.0
    high: float = 280.0
    room: float = 14.0
    """Size of a panel and its margin, in its own units."""

    def __post_init__(self, points: Array) -> None:
        plane = self._projected(np.vstack([points, points * (1, 1, 0)]))
        self.low = plane.min(axis=0)
        inside = np.array([self.wide, self.high]) - 2 * self.room
        self.scale = float((inside / np.maximum(np.ptp(plane, axis=0), 1e-9)).min())

    def __call__(self, points: Array) -> Array:
        plane = (self._projected(points) - self.low) * self.scale
        return np.column_stack([plane[:, 0] + self.room, self.high - self.room - plane[:, 1]])

    def line(self, points: Array) -> str:
        """Points of a polyline; a tenth of a unit is far below what a screen shows."""
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in self(points))

    def _projected(self, points: Array) -> Array:
        x, y, z = points.T
        across = x * np.cos(self.turn) - y * np.sin(self.turn)
        depth = x * np.sin(self.turn) + y * np.cos(self.turn)
        return np.column_stack([across, z * np.cos(self.tilt) + depth * np.sin(self.tilt)])


def _panel(
    motion: ArmMotion, arm: Array, way: Array, view: _View, marks: Array, colour: str, name: str
) -> str:
    total = f"{float(motion.times[-1]):.4g} s"
    label = escape(visible(motion.label))
    dots = "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5"/>' for x, y in view(marks))
    dark = f"var(--{_COLOURS[colour]}, {colour})"
    return (
        f'<div>\n<p><strong>{label}</strong> <span class="now">0.00 of {total}</span></p>\n'
        f'<svg viewBox="0 0 {view.wide:g} {view.high:g}" role="img" '
        f'aria-labelledby="{name}-title {name}-desc">\n'
        f'<title id="{name}-title">{label}, {total}</title>\n'
        f'<desc id="{name}-desc">The arm with joints at the origins of its frames, the way of its '
        f"end through {len(marks)} way-points, and its shadow on the floor.</desc>\n"
        f'<polyline class="floor" points="{view.line(arm[0] * (1, 1, 0))}"/>\n'
        f'<polyline class="way" style="stroke:{dark}" points="{view.line(way)}"/>\n'
        f'<g class="marks">{dots}</g>\n'
        f'<polyline class="links" style="stroke:{dark}" points="{view.line(arm[0])}"/>\n'
        f"</svg>\n</div>\n"
    )
