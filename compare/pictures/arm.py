"""Picture of an arm that follows motions side by side: steps of time, vectors, no network."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Chain, TrajgapError, forward_kinematics, link_frames, visible
from .drawing import BLUE, GREEN, GRID, INK, MUTED, ORANGE, RED

_STEPS = 72
"""Steps of time of the slowest motion: 20 a second for motions of three or four seconds."""
_TURN, _TILT = np.deg2rad(-55.0), np.deg2rad(22.0)
"""Where the eye stands: beside the arm and a little above, so no axis points at it."""
_WIDE, _HIGH, _ROOM = 300.0, 280.0, 14.0
"""Size of one panel and its margin, in its own units: three stand side by side on a page."""
_WAY = 160
"""Points on the way of the end: a curve to the eye."""
_COLOURS = (ORANGE, BLUE, GREEN, RED)
"""Of the motions, in order."""


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
    chain: Chain,
    motions: Sequence[ArmMotion],
    waypoints: ArrayLike,
    *,
    name: str,
    title: str,
) -> str:
    """Panels in which one arm follows each motion, with a slider over time.

    Parameters
    ----------
    chain : Chain
        The arm; joints of links are drawn at the origins of its frames.
    motions : sequence of ArmMotion
        One to four; the panels share the clock, so the fastest arm waits at its end.
    waypoints : array_like, shape (way-points, joints)
        rad; drawn where the end of the arm stands.
    name : str
        Unique in the page: letters, digits and dashes.

    Returns
    -------
    str
        HTML: SVG, its own style and a script for the slider. Without the script the arms stand at
        the start, with the ways of their ends.

    Raises
    ------
    TrajgapError
        If there are no motions or more than four, or one is not sampled for every joint.
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
    clock = np.linspace(0.0, longest, _STEPS + 1)
    arms = [_points(chain, one.at(clock)) for one in motions]
    marks = forward_kinematics(chain, np.asarray(waypoints, dtype=np.float64))[..., :3, 3]
    view = _View(np.vstack([*(a.reshape(-1, 3) for a in arms), marks]))
    panels = "".join(
        _panel(one, arm, _way(chain, one), view, marks, colour, f"{name}-{k}")
        for k, (one, arm, colour) in enumerate(zip(motions, arms, _COLOURS, strict=False))
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
    return (
        f'<figure class="trajgap-arm" id="{name}">\n<style>{_STYLE}</style>\n'
        f"<figcaption>{escape(visible(title))}</figcaption>\n"
        f'<div class="trajgap-arm-panels">\n{panels}</div>\n{_CONTROLS}'
        f'<script type="application/json">{data}</script>\n<script>{_SCRIPT}</script>\n</figure>\n'
    )


def _points(chain: Chain, angles: Array) -> Array:
    """Origins of base and links, shape (times, joints + 1, 3)."""
    origins = link_frames(chain, angles)[..., :3, 3]
    return np.concatenate([np.zeros((len(angles), 1, 3)), origins], axis=1)


def _way(chain: Chain, motion: ArmMotion) -> Array:
    """Positions of the end on the whole motion, shape (points, 3)."""
    times = np.linspace(0.0, float(motion.times[-1]), _WAY + 1)
    return forward_kinematics(chain, motion.at(times))[..., :3, 3]


class _View:
    """Parallel projection that fits all points into a panel."""

    def __init__(self, points: Array) -> None:
        both = np.vstack([points, points * (1, 1, 0)])
        plane = _projected(both)
        self.low = plane.min(axis=0)
        size = np.maximum(plane.max(axis=0) - self.low, 1e-9)
        self.scale = float(min((_WIDE - 2 * _ROOM) / size[0], (_HIGH - 2 * _ROOM) / size[1]))

    def __call__(self, points: Array) -> Array:
        plane = (_projected(points) - self.low) * self.scale
        return np.column_stack([plane[:, 0] + _ROOM, _HIGH - _ROOM - plane[:, 1]])

    def line(self, points: Array) -> str:
        """Points of a polyline; a tenth of a unit is far below what a screen shows."""
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in self(points))


def _projected(points: Array) -> Array:
    x, y, z = points.T
    across = x * np.cos(_TURN) - y * np.sin(_TURN)
    depth = x * np.sin(_TURN) + y * np.cos(_TURN)
    return np.column_stack([across, z * np.cos(_TILT) + depth * np.sin(_TILT)])


def _panel(
    motion: ArmMotion, arm: Array, way: Array, view: _View, marks: Array, colour: str, name: str
) -> str:
    total = f"{float(motion.times[-1]):.4g} s"
    label = escape(visible(motion.label))
    dots = "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5"/>' for x, y in view(marks))
    dark = _variable(colour)
    return (
        f'<div>\n<p><strong>{label}</strong> <span class="now">0.00 of {total}</span></p>\n'
        f'<svg viewBox="0 0 {_WIDE:g} {_HIGH:g}" role="img" '
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


def _variable(colour: str) -> str:
    names = {BLUE: "blue", ORANGE: "orange", GREEN: "green", RED: "red", INK: "ink"}
    return f"var(--{names[colour]}, {colour})"


_STYLE = f"""
.trajgap-arm {{ margin: 1rem 0; }}
.trajgap-arm-panels {{ display: grid; gap: 0.5rem;
  grid-template-columns: repeat(auto-fit, minmax(min(11rem, 100%), 1fr)); }}
.trajgap-arm svg {{ width: 100%; height: auto; border: 1px solid var(--grid, {GRID});
  border-radius: 0.3rem; }}
.trajgap-arm polyline {{ fill: none; stroke-linejoin: round; stroke-linecap: round; }}
.trajgap-arm .links {{ stroke-width: 5; }}
.trajgap-arm .way {{ stroke-width: 1.2; stroke-dasharray: 3 2; }}
.trajgap-arm .floor {{ stroke: var(--grid, {GRID}); stroke-width: 4; }}
.trajgap-arm .marks {{ fill: var(--ink, {INK}); }}
.trajgap-arm p {{ margin: 0.4rem 0 0.2rem; line-height: 1.3; }}
.trajgap-arm .now {{ display: block; color: var(--muted, {MUTED});
  font-variant-numeric: tabular-nums; }}
.trajgap-arm-controls {{ display: flex; gap: 0.5rem; align-items: center; margin-top: 0.5rem; }}
.trajgap-arm-controls[hidden] {{ display: none; }}
.trajgap-arm-controls input {{ flex: 1; min-width: 6rem; }}
.trajgap-arm-controls button {{ min-width: 2.6rem; min-height: 2rem; }}
"""
"""Colours follow the page's theme where it has these variables."""

_CONTROLS = """<div class="trajgap-arm-controls" hidden>
<button type="button" data-step="-1" aria-label="One step back">◀</button>
<button type="button" data-play aria-pressed="false">Play</button>
<button type="button" data-step="1" aria-label="One step on">▶</button>
<input type="range" min="0" value="0" step="1" aria-label="Time">
<output>0.00 s</output>
</div>
"""
"""Shown by the script, for without it they would do nothing."""

_SCRIPT = """
{
  const figure = document.currentScript.closest("figure");
  const data = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
  const panels = [...figure.querySelectorAll(".trajgap-arm-panels > div")];
  const controls = figure.querySelector(".trajgap-arm-controls");
  const slider = controls.querySelector("input"), said = controls.querySelector("output");
  const play = controls.querySelector("[data-play]");
  slider.max = data.clock.length - 1;
  controls.hidden = false;
  let timer = null;
  const show = (k) => {
    const now = data.clock[k];
    slider.value = k;
    said.textContent = now.toFixed(2) + " s";
    slider.setAttribute("aria-valuetext", said.textContent);
    panels.forEach((panel, i) => {
      panel.querySelector(".links").setAttribute("points", data.arms[i][k]);
      panel.querySelector(".floor").setAttribute("points", data.floors[i][k]);
      const total = data.totals[i], done = Math.min(now, total);
      panel.querySelector(".now").textContent =
        done.toFixed(2) + " of " + total + " s" + (now >= total ? ", there" : "");
    });
  };
  const stop = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
    play.setAttribute("aria-pressed", "false");
  };
  const last = data.clock.length - 1;
  slider.addEventListener("input", () => { stop(); show(+slider.value); });
  controls.querySelectorAll("[data-step]").forEach((button) =>
    button.addEventListener("click", () => {
      stop();
      show(Math.max(0, Math.min(last, +slider.value + +button.dataset.step)));
    }));
  play.addEventListener("click", () => {
    if (timer) return stop();
    if (+slider.value === last) show(0);
    play.textContent = "Stop";
    play.setAttribute("aria-pressed", "true");
    const step = 1000 * data.clock[1];
    timer = setInterval(() => {
      const next = +slider.value + 1;
      if (next > last) return stop();
      show(next);
    }, step);
  });
  show(0);
}
"""
"""Nothing moves before somebody asks for it."""
