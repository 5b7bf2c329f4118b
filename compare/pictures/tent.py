"""Picture of an initial population of the tent map: exactly, and in double precision."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from matplotlib.axes import Axes

from ...heuristics import TentCollapse, tent_collapse
from ...heuristics.algorithms import TentRule, exact_orbit, tent_population
from ...problem import Array
from .drawing import BLUE, GRID, ORANGE, PAPER, RED, Picture, Style, drawing, finish, light_grid


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
    members = len(scatter.exact)
    description = (
        f"Tent map, β = {float(scatter.beta):g}, start {scatter.start}, one orbit through "
        f"{members} members of {scatter.exact.shape[1]} coordinates. In double precision "
        f"{rest}; {scatter.at_zero} of {members} members begin with ({scatter.lower:g}, "
        f"{scatter.lower:g}). Exactly: {_exactly(scatter)}. With an orbit for each coordinate "
        f"exact and double coordinates agree within {scatter.difference:.1g} {unit}."
    )
    with drawing():
        figure = Picture(title, description, 9.9, 3.15)
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
        key = f"● exact   ◆ double precision   ·   β = {float(scatter.beta):g}, seed 0"
        finish(figure, f"{key}   ·   one orbit from {scatter.start}: in doubles {rest}")
    return figure


def _exactly(scatter: TentScatter) -> str:
    orbit = scatter.orbit
    steps = len(orbit.exact) - 1
    if orbit.exact_zero_at is not None:
        return f"0 from step {orbit.exact_zero_at} on"
    if orbit.period is not None:
        return f"repeats every {orbit.period[1]} steps from step {orbit.period[0]} on"
    return f"neither 0 nor a repetition in {steps} steps"


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
