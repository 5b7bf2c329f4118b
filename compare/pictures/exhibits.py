"""Pictures of exhibits: velocity jumps, control polygons, and populations of the tent map."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from ...heuristics import TentCollapse, tent_collapse
from ...heuristics.algorithms import TentRule, exact_orbit, tent_population
from ...problem import Array, Jump, Problem, Trajectory, TrajgapError, check, fit
from ...problem.curves import StretchedUniformBSpline, control_vertices
from ..audits.rules import Vertex
from .drawing import (
    BLUE,
    GRID,
    INK,
    MUTED,
    ORANGE,
    PAPER,
    RED,
    Picture,
    Style,
    hollow,
    light_grid,
    picture,
    shown,
)
from .motion import shown_in
from .panels import Units, sampled


def _pairs(
    figure: Picture, joints: Sequence[str], x: str, above: float
) -> tuple[NDArray[np.object_], list[NDArray[np.object_]]]:
    """All panels of a figure, and those of each joint: a high one with its name, a low one."""
    columns = min(3, len(joints))
    rows = -(-len(joints) // columns)
    grid = figure.subplots(
        2 * rows, columns, squeeze=False, sharex="all", height_ratios=[above, 1.0] * rows
    )
    places = [
        grid[2 * row : 2 * row + 2, column] for row in range(rows) for column in range(columns)
    ]
    for axes in (one for pair in places[len(joints) :] for one in pair):
        axes.remove()
    for axes in grid[-1]:
        axes.set_xlabel(x)
    for pair, label in zip(places, joints, strict=False):
        pair[0].set_title(f"joint {shown(label, 12)}", weight="bold")
        pair[0].locator_params(axis="y", nbins=5)
        pair[1].locator_params(axis="y", nbins=3)
    return grid, places[: len(joints)]


def _height(joints: Sequence[str], each: float) -> float:
    """Inches of such a figure with three joints a row."""
    return 0.9 + each * -(-len(joints) // 3)


def velocity_jumps(problem: Problem, durations: ArrayLike) -> tuple[Jump, ...]:
    """Jumps of the velocity at the breaks, in order of joint and time.

    Empty if the velocity is continuous. `durations`: shape (segments,), s.
    """
    found = [j for j in check(problem, durations).jumps if j.order == 1]
    return tuple(sorted(found, key=lambda j: (problem.joints.index(j.joint), j.time)))


def jump_picture(
    problem: Problem, durations: ArrayLike, *, title: str, units: Units | None = None
) -> Picture:
    """Velocity of every joint over time; below it the size of each jump.

    The largest jump of each joint is dark, and named with its time and size. `durations`: shape
    (segments,), shared by all joints, s. `units`: those of the paper, as for `motion_picture`; SI
    by default.
    """
    h = np.asarray(durations, dtype=np.float64)
    if h.shape != (problem.segments,):
        raise TrajgapError(
            f"jump_picture: expected durations of shape ({problem.segments},), got {h.shape}"
        )
    own_units = [shown_in(units, problem, j, "velocity") for j in range(len(problem.joints))]
    motion = fit(problem.curve, problem.waypoints, h)
    jumps = velocity_jumps(problem, h)
    joints = problem.joints
    own = [[j for j in jumps if j.joint == label] for label in joints]
    description = "; ".join(
        f"joint {label}: {_named(found, unit)}"
        for label, found, unit in zip(joints, own, own_units, strict=True)
    )
    key = "○ before a jump   ● after it   vertical lines: way-points   bars: after less before"
    with picture(title, description, 9.9, _height(joints, 3.0), key) as figure:
        grid, pairs = _pairs(figure, joints, "time, s", 2.2)
        alike = len(set(own_units)) == 1
        for j, (upper, lower) in enumerate(pairs):
            written, one = own_units[j]
            _velocity(upper, motion, j, own[j], one)
            _sizes(lower, motion, own[j], one)
            lower.set_title(shown(_named(own[j], own_units[j]), 60), fontsize=8)
            if upper in grid[:, 0] or not alike:
                upper.set_ylabel(f"velocity, {written}")
                lower.set_ylabel(f"jump, {written}")
        figure.align_ylabels(grid[:, 0])
    return figure


def _named(jumps: list[Jump], unit: tuple[str, float]) -> str:
    if not jumps:
        return "no jump"
    top = max(jumps, key=lambda j: abs(j.size))
    size = f"{top.size / unit[1]:+#.3g}".replace("e-0", "e-").replace("-", "−")
    count = f"largest of {len(jumps)} jumps" if len(jumps) > 1 else "jump"
    return f"{count}: {size} {unit[0]} at {top.time:.2f} s"


def _velocity(axes: Axes, motion: Trajectory, joint: int, jumps: list[Jump], one: float) -> None:
    _ground(axes, motion)
    times, values = sampled(motion, joint, 1)
    axes.plot(times, values / one, color=BLUE, linewidth=1.4, zorder=2)
    for jump in jumps:
        before = motion.derivative(jump.break_index - 1, joint, 1)
        after = float(motion.derivative(jump.break_index, joint, 1)[0])
        sides = float(np.polynomial.polynomial.polyval(1.0, before)), after
        for value, colour in zip(sides, (PAPER, INK), strict=True):
            style = hollow(3.4, face=colour)
            axes.plot(jump.time, value / one, markeredgewidth=0.8, zorder=4, **style)
    axes.ticklabel_format(axis="y", scilimits=(-5, 5))


def _sizes(axes: Axes, motion: Trajectory, jumps: list[Jump], one: float) -> None:
    _ground(axes, motion)
    top = max((abs(j.size) for j in jumps), default=0.0)
    for jump in jumps:
        colour = INK if abs(jump.size) == top else ORANGE
        axes.vlines(jump.time, 0.0, jump.size / one, color=colour, linewidth=4.0, zorder=2)
    if not jumps:
        axes.set_ylim(-1.0, 1.0)
    axes.ticklabel_format(axis="y", scilimits=(-5, 5))


def _ground(axes: Axes, motion: Trajectory) -> None:
    for b in motion.breaks:
        axes.axvline(float(b), color=GRID, linewidth=0.7, zorder=0)
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    axes.margins(x=0.02, y=0.1)
    axes.locator_params(axis="x", nbins=7)


def polygon_picture(
    waypoints: ArrayLike, vertices: Sequence[Vertex], *, title: str, quantity: str = "angle"
) -> Picture:
    """Uniform cubic B-spline of every joint over its parameter, with its control polygon.

    Vertex V_k stands over the parameter k − 1, where its basis function is largest.

    Below each curve: printed less computed vertices, and how far rounding explains. `waypoints`:
    shape (way-points, joints), in the unit in which they are printed. `vertices`: printed vertices
    with the intervals that the way-points allow, joint after joint. `quantity`: what the way-points
    are: "position" where some joint slides.
    """
    w = np.asarray(waypoints, dtype=np.float64)
    joints = tuple(dict.fromkeys(v.joint for v in vertices))
    own = [[v for v in vertices if v.joint == label] for label in joints]
    if w.ndim != 2 or w.shape[1] != len(joints) or any(len(o) != len(w) + 2 for o in own):
        raise TrajgapError(
            f"polygon_picture: way-points of shape {w.shape} for {len(vertices)} vertices of "
            f"{len(joints)} joints; give two vertices more than way-points for each joint"
        )
    computed = control_vertices(w)
    description = "; ".join(
        f"joint {label}: {_words(found, computed[:, j])}"
        for j, (label, found) in enumerate(zip(joints, own, strict=True))
    )
    key = (
        "— curve   ○ way-point   + control vertex, computed   □ control vertex, printed   "
        "bars below: what rounding explains"
    )
    with picture(title, description, 9.9, _height(joints, 3.2), key) as figure:
        grid, pairs = _pairs(figure, joints, "parameter: way-point number + e", 2.6)
        curve = StretchedUniformBSpline(len(w))
        motion = fit(curve, w, np.ones(curve.segments))
        exponent = math.floor(math.log10(max(float(v.width) for v in vertices)))
        # Digits as exponents, for type without formulas.
        raised = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        for j, (upper, lower) in enumerate(pairs):
            upper.plot(*sampled(motion, j, 0), color=BLUE, linewidth=1.6, zorder=3)
            _polygon(upper, w[:, j], own[j], computed[:, j])
            _differences(lower, own[j], computed[:, j], exponent)
            lower.set_title(_words(own[j], computed[:, j]), fontsize=8)
        for upper, lower in zip(grid[::2, 0], grid[1::2, 0], strict=True):
            upper.set_ylabel(f"{quantity}, as printed")
            lower.set_ylabel(f"printed − comp.\n10{raised}")
        figure.align_ylabels(grid[:, 0])
    return figure


def _words(vertices: list[Vertex], computed: Array) -> str:
    far = max(abs(v.printed.value - c) for v, c in zip(vertices, computed, strict=True))
    inside = sum(v.inside for v in vertices)
    apart = f"{far:.1e}".replace("e-0", "e−")
    return f"{inside} of {len(vertices)} within rounding, at most {apart} apart"


def _polygon(axes: Axes, waypoints: Array, vertices: list[Vertex], computed: Array) -> None:
    at = np.arange(len(computed)) - 1.0
    axes.plot(at, computed, color=ORANGE, linewidth=0.9, linestyle=(0, (4, 2)), zorder=1)
    printed = [v.printed.value for v in vertices]
    square = hollow(6.5, face="none") | {"marker": "s"}
    axes.plot(at, printed, markeredgewidth=0.8, zorder=2, **square)
    axes.plot(at, computed, linestyle="none", marker="+", markersize=6, color=ORANGE, zorder=4)
    axes.plot(np.arange(len(waypoints)), waypoints, zorder=5, **hollow(4, BLUE))


def _differences(axes: Axes, vertices: list[Vertex], computed: Array, exponent: int) -> None:
    at = np.arange(len(computed)) - 1.0
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    low = [float(v.allowed.lower - v.printed.unit / 2) for v in vertices] - computed
    high = [float(v.allowed.upper + v.printed.unit / 2) for v in vertices] - computed
    unit = 10.0**exponent
    axes.vlines(at, low / unit, high / unit, color=MUTED, linewidth=3.5, alpha=0.35, zorder=1)
    apart = np.array([v.printed.value for v in vertices]) - computed
    colours = [INK if v.inside else RED for v in vertices]
    axes.scatter(at, apart / unit, marker="s", s=14, color=colours, zorder=2)
    axes.set_xticks(np.arange(-1, len(computed) - 1, max(1, len(computed) // 6)))


@dataclass(frozen=True, eq=False)
class TentScatter:
    """Populations of the tent map in exact and in double arithmetic."""

    start: str
    """Decimal digits of the first point, drawn from seed 0; the double orbit starts at the double
    beside it."""
    beta: Fraction
    lower: float
    upper: float
    """Range of every coordinate."""
    orbit: TentCollapse
    exact: Array
    doubles: Array
    """Filled by that one orbit, member by member; shape (members, dimensions)."""
    apart_exact: Array
    apart_doubles: Array
    """Filled by one orbit for each coordinate, starts drawn from seed 0; shape (members,
    dimensions)."""
    collapsed: dict[TentRule, int]
    """Members with a coordinate of exactly 0 before scaling, in double precision, under each rule
    of filling the population, starts from seed 0."""

    @property
    def at_zero(self) -> int:
        """Members whose first two coordinates collapse to 0 before scaling, in doubles."""
        return int((self.doubles[:, :2] == self.lower).all(axis=1).sum())

    @property
    def difference(self) -> float:
        """Largest difference of exact and double coordinates with an orbit for each of them."""
        return float(np.abs(self.apart_exact - self.apart_doubles).max())


def tent_scatter(
    members: int, dimensions: int, bounds: tuple[float, float], beta: float
) -> TentScatter:
    """Fill populations with orbits of the tent map (23) of `z1-woa-bspline`.

    `bounds`: range to which [0, 1] is scaled. `beta`: between 0 and 1; its shortest decimal is
    meant.
    """
    start = repr(float(np.random.default_rng(0).random()))
    share = Fraction(repr(beta))
    steps = members * dimensions - 1
    orbit = tent_collapse(start, max(steps, 1), share)
    apart = [
        exact_orbit(Fraction(repr(float(x))), members - 1, share)
        for x in np.random.default_rng(0).random(dimensions)
    ]
    lower, upper = bounds
    shape = (members, dimensions)

    def scaled(points: Array) -> Array:
        return lower + (upper - lower) * points

    filled = {
        rule: tent_population(np.random.default_rng(0), members, dimensions, rule, beta)
        for rule in TentRule
    }
    return TentScatter(
        start=start,
        beta=share,
        lower=lower,
        upper=upper,
        orbit=orbit,
        exact=scaled(np.array([float(x) for x in orbit.exact])[: steps + 1].reshape(shape)),
        doubles=scaled(orbit.doubles[: steps + 1].reshape(shape)),
        apart_exact=scaled(np.array([[float(x) for x in one] for one in apart]).T),
        apart_doubles=scaled(filled[TentRule.COORDINATE]),
        collapsed={rule: int((one == 0.0).any(axis=1).sum()) for rule, one in filled.items()},
    )


def tent_picture(scatter: TentScatter, *, unit: str, title: str) -> Picture:
    """First two coordinates of every member, exactly and in doubles, and one orbit by steps.

    `unit`: of the coordinates.
    """
    zero = scatter.orbit.zero_at
    rest = f"exactly 0 from step {zero} on" if zero is not None else "never exactly 0"
    members, orbit = len(scatter.exact), scatter.orbit
    exactly = f"neither 0 nor a repetition in {len(orbit.exact) - 1} steps"
    if orbit.exact_zero_at is not None:
        exactly = f"0 from step {orbit.exact_zero_at} on"
    elif orbit.period is not None:
        exactly = f"repeats every {orbit.period[1]} steps from step {orbit.period[0]} on"
    description = (
        f"Tent map, β = {float(scatter.beta):g}, start {scatter.start}, one orbit through "
        f"{members} members of {scatter.exact.shape[1]} coordinates. In double precision "
        f"{rest}; {scatter.at_zero} of {members} members begin with ({scatter.lower:g}, "
        f"{scatter.lower:g}). Exactly: {exactly}. With an orbit for each coordinate "
        f"exact and double coordinates agree within {scatter.difference:.1g} {unit}."
    )
    key = f"● exact   ◆ double precision   ·   β = {float(scatter.beta):g}, seed 0"
    key += f"   ·   one orbit from {scatter.start}: in doubles {rest}"
    with picture(title, description, 9.9, 3.15, key) as figure:
        apart, left, middle, right = figure.subplots(1, 4)
        _scatter(apart, scatter.apart_exact, scatter, unit, "orbit per coordinate")
        _scatter(apart, scatter.apart_doubles, scatter, unit, "orbit per coordinate", doubles=True)
        _scatter(left, scatter.exact, scatter, unit, "one orbit, exactly")
        _scatter(middle, scatter.doubles, scatter, unit, "one orbit, doubles", doubles=True)
        if scatter.at_zero:
            corner = (scatter.lower, scatter.lower)
            middle.plot(*corner, "o", markersize=12, markerfacecolor="none", color=RED, zorder=4)
            middle.annotate(
                f"{scatter.at_zero} of {members} begin here", corner, xytext=(14, 14),
                textcoords="offset points", color=RED, fontsize=8.5, weight="bold", zorder=5,
                arrowprops={"arrowstyle": "-", "color": RED, "linewidth": 0.8, "shrinkB": 7},
                bbox={"boxstyle": "round,pad=0.15", "facecolor": PAPER, "linewidth": 0},
            )  # fmt: skip
        _steps(right, scatter)
    return figure


def _scatter(
    axes: Axes, points: Array, scatter: TentScatter, unit: str, title: str, doubles: bool = False
) -> None:
    colour, marker, size = (ORANGE, "D", 2.8) if doubles else (BLUE, "o", 5.0)
    dots: Style = {"linestyle": "none", "marker": marker, "markersize": size, "color": colour}
    axes.plot(points[:, 0], points[:, 1], clip_on=False, zorder=3, **dots)
    axes.set_title(title, weight="bold")
    room = 0.04 * (scatter.upper - scatter.lower)
    axes.set_xlim(scatter.lower - room, scatter.upper + room)
    axes.set_ylim(scatter.lower - room, scatter.upper + room)
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel(f"first coordinate, {unit}")
    axes.set_ylabel(f"second coordinate, {unit}")
    light_grid(axes)


def _steps(axes: Axes, scatter: TentScatter) -> None:
    orbit = scatter.orbit
    zero = orbit.zero_at
    last = len(orbit.exact) - 1
    # Some steps more than it takes the double orbit to come to rest.
    shown = last if zero is None else min(last, zero + 12)
    at = np.arange(shown + 1)
    exact = [float(x) for x in orbit.exact[: shown + 1]]
    axes.plot(at, exact, color=BLUE, linewidth=1.0, marker="o", markersize=3.2, zorder=2)
    dashes: Style = {"linewidth": 1.0, "linestyle": (0, (3, 2)), "marker": "D", "markersize": 2.4}
    axes.plot(at, orbit.doubles[: shown + 1], color=ORANGE, zorder=3, **dashes)
    axes.set_title("by steps", weight="bold")
    if zero is not None and zero <= shown:
        axes.axvline(zero, color=RED, linewidth=1.0, zorder=1)
        axes.set_title(f"0 at step {zero}", color=RED, fontsize=8.5, loc="right")
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    axes.set_xlim(max(0, shown - 32) - 0.5, shown + 0.5)
    axes.set_ylim(-0.04, 1.04)
    axes.set_box_aspect(1)
    axes.set_xlabel("step")
    axes.set_ylabel("x, before scaling")
