"""Picture of the total time over the simplex of three duration shares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Polygon
from matplotlib.tri import Triangulation, UniformTriRefiner
from numpy.typing import ArrayLike, NDArray

from ...nlp import Solution
from ...problem import TOLERANCE, Array, Problem, TrajgapError, evaluate
from .drawing import INK, MUTED, ORANGE, PURPLE, RED, SKY, Picture, Style, picture, shown

_CORNERS: Array = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(3) / 2]])
"""Of the triangle of shares, each where one duration is all of the total."""
# On the map, whose colours do not follow the page's theme, neither may these; none of them is a
# colour of the theme, which a page would replace.
_DARK = "#101418"  # on the light part of the map
_LIGHT = "#fefefe"  # on its dark part


def landscape(
    problem: Problem,
    optimum: Solution,
    printed: Sequence[tuple[str, ArrayLike]],
    ends: Mapping[str, ArrayLike],
    *,
    title: str,
    levels: Sequence[float] = (0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0),
) -> Picture:
    """Least total over the shares of three durations: all shares, and the part that matters.

    Every point is a ratio h₁ : h₂ : h₃; its height is T·c*, the total of the durations of that
    ratio stretched until a limit is reached, from the checker's exact peaks.

    Where a bound on the durations or a position limit forbids the tight total, the map is hatched.
    `problem`: with three segments. `optimum`: reference of the contours. `printed`: label and
    printed durations, shape (3,), s. `ends`: durations that each heuristic ended with, shape (runs,
    3), s. `levels`: of the contours, percent above the reference total.
    """
    if problem.segments != 3:
        raise TrajgapError(f"landscape: drawn for 3 segments, the problem has {problem.segments}")
    if problem.ratios is not None:
        raise TrajgapError("landscape: the ratios of the durations are fixed: there is one share")
    if not optimum.found:
        raise TrajgapError("landscape: the problem has no optimum to compare with")
    best = optimum.total_time if optimum.infimum is None else optimum.infimum
    if not best > 0:
        raise TrajgapError("landscape: the totals approach 0, and nothing is a share above that")
    points = [(label, _shares(h)) for label, h in printed]
    runs = {name: _shares(h) for name, h in ends.items()}
    centre = _shares(optimum.durations)
    every = np.vstack([centre, *(p for _, p in points), *runs.values()])
    every = every[np.isfinite(every).all(axis=1)]
    parts = [f"optimum {best:.6g} s at shares {', '.join(f'{100 * s:.1f} %' for s in centre[0])}"]
    for label, h in printed:
        total = float(tight_total(problem, _shares(h))[0])
        far = f"{100 * (total / best - 1):+.3g} % after free rescaling"
        parts.append(f"{label}: {'no rescaling keeps the limits' if np.isinf(total) else far}")
    parts += [f"{name}: {len(s)} end points" for name, s in runs.items()]
    with picture(title, "; ".join(parts), 9.6, 5.0) as figure:
        whole, part = figure.subplots(1, 2)
        colours = matplotlib.colormaps["cividis_r"](np.linspace(0, 1, len(levels)))
        window, below = _window(every), False
        for axes, corner in ((whole, np.zeros(3)), (part, window)):
            below |= _map(axes, problem, corner, best, levels, colours)
            _mark(axes, corner, centre, points, runs)
        inner = window + (1 - window.sum()) * np.eye(3)
        edge = Polygon(inner @ _CORNERS, fill=False, edgecolor=_DARK, linewidth=1.1, zorder=4)
        whole.add_patch(edge)
        whole.set_title("all shares of the total", loc="center", pad=2)
        part.set_title("enlarged", loc="center", pad=2)
        _key(figure, levels, colours, best)
        note = "Each point: durations of these shares, stretched until a limit is reached (tight "
        note += "total)."
        note += f" Hatched: {_forbids(problem)} forbids it." if _forbids(problem) else ""
        note += " White: below the optimum." if below else ""
        handles, labels = part.get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside lower left", ncols=2, title=note,
            title_fontsize=8, alignment="left",
        )  # fmt: skip
    return figure


def _shares(durations: ArrayLike) -> Array:
    h = np.atleast_2d(np.asarray(durations, dtype=np.float64))
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = h / h.sum(axis=1, keepdims=True)
    shares[~(h > 0).all(axis=1)] = np.nan
    return np.asarray(shares)


def _window(shares: Array) -> Array:
    """Lower ends of the three shares of a triangle that holds all points with some room."""
    low = shares.min(axis=0)
    side = 1 - low.sum()
    # At least a fifth of the simplex, so a tight cloud still shows its surroundings.
    room = max(0.12 * side, (0.2 - side) / 3, 0.02)
    return np.asarray(np.maximum(low - room, 0.0))


def tight_total(problem: Problem, shares: Array) -> Array:
    """Total after free rescaling of durations with the given shares.

    Shape (points,): T·c* in s; inf if a joint with limit 0 moves, or the path leaves a position
    range. `shares`: shape (points, segments), positive, summing to 1.
    """
    found = evaluate(problem, shares)
    if not found.positions_limited:
        return found.stretch
    outside = (found.positions > 1 + TOLERANCE).any(axis=1)
    return np.where(outside, np.inf, found.stretch)


def _grid(corner: Array) -> tuple[Array, NDArray[np.int64]]:
    """Shares on a triangular grid just inside a sub-triangle, and the triangles between them.

    128 points on each side: 8,385 totals, a second or so, and contours without corners.
    """
    whole = Triangulation([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [[0, 1, 2]])
    fine = UniformTriRefiner(whole).refine_triangulation(subdiv=7)
    local = np.column_stack([fine.x, fine.y, 1 - fine.x - fine.y]) * (1 - 3e-4) + 1e-4
    return corner + (1 - corner.sum()) * local, np.asarray(fine.triangles)


def _place(corner: Array, shares: Array) -> Array:
    """Shares to the plane: the sub-triangle fills the unit triangle."""
    return np.asarray(((shares - corner) / (1 - corner.sum())) @ _CORNERS)


def _map(
    axes: Axes,
    problem: Problem,
    corner: Array,
    best: float,
    levels: Sequence[float],
    colours: Array,
) -> bool:
    """Draw the contours; whether some point lies below the optimum."""
    shares, triangles = _grid(corner)
    total = tight_total(problem, shares)
    x, y = _place(corner, shares).T
    mesh = Triangulation(x, y, triangles)
    top = 10 * best
    excess = 100 * (np.minimum(total, top) / best - 1)
    bands = axes.tricontourf(mesh, excess, levels=[-101.0, *levels[1:], 1e9], colors=list(colours))
    bands.set_edgecolor(_DARK)
    bands.set_linewidth(0.4)
    # What lies 0.01 % below the optimum is drawn apart: it needs an explanation.
    below = bool(excess.min() < -0.01)
    if below:
        axes.tricontourf(mesh, excess, levels=[-101.0, -0.01], colors=_LIGHT)
    low, high = problem.duration_lower, problem.duration_upper
    if _forbids(problem):
        # An infinite total, which no factor could stand before, counts as very long.
        tight = shares * np.minimum(total, 1e100)[:, None]
        margin = np.min(np.hstack([tight / np.maximum(low, 1e-12), high / tight]), axis=1)
        margin = np.where(np.isinf(total), 0.0, np.minimum(margin, 2.0))
        axes.tricontourf(mesh, margin, levels=[-1.0, 1.0], colors="none", hatches=["xx"])
        edge: Style = {"colors": _DARK, "linewidths": 1.2, "linestyles": "dashed"}
        axes.tricontour(mesh, margin, levels=[1.0], **edge)
    axes.add_patch(Polygon(_CORNERS, fill=False, edgecolor=MUTED, linewidth=0.9, zorder=4))
    _ticks(axes, corner)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(-0.12, 1.12)
    axes.set_ylim(-0.14, 0.98)
    return below


def _ticks(axes: Axes, corner: Array) -> None:
    """Label the edges with the shares of the three durations, in percent."""
    side = 1 - corner.sum()
    step = next(s for s in (0.01, 0.02, 0.05, 0.1, 0.2) if side / s <= 5.5)
    places = (("right", "center"), ("center", "top"), ("left", "center"))
    shifts = ((-0.03, 0.0), (0.0, -0.025), (0.03, 0.0))
    for k in range(3):
        first = (k + 1) % 3
        start = step * np.ceil(corner[k] / step - 1e-9)
        for value in np.arange(start, corner[k] + side + 1e-9, step):
            # Share k grows from the edge opposite its corner; its labels stand on one edge.
            share = corner.copy()
            share[k] = value
            share[first] += corner[k] + side - value
            x, y = _place(corner, share)
            dx, dy = shifts[(k + 1) % 3]
            ha, va = places[(k + 1) % 3]
            axes.plot([x, x + 0.5 * dx], [y, y + 0.5 * dy], color=MUTED, linewidth=0.8)
            label = f"{abs(round(100 * value, 6)):g}"
            axes.text(x + 0.7 * dx, y + 0.7 * dy, label, ha=ha, va=va, fontsize=7.5)
    corners = ((-0.07, -0.06), (1.07, -0.06), (0.5, 0.93))
    edges = ((0.5, -0.12, 0), (0.87, 0.47, -60), (0.13, 0.47, 60))
    for k, name in enumerate(("h₁", "h₂", "h₃")):
        x, y = corners[k]
        axes.text(x, y, name, ha="center", va="center", fontsize=10, weight="bold")
        x, y, angle = edges[k]
        axes.text(
            x, y, f"{name}, %", ha="center", va="center", rotation=angle, fontsize=8, color=MUTED
        )


def _mark(
    axes: Axes,
    corner: Array,
    centre: Array,
    printed: Sequence[tuple[str, Array]],
    runs: Mapping[str, Array],
) -> None:
    ends = ("o", SKY), ("^", PURPLE), ("v", _LIGHT), ("<", ORANGE)
    for i, (name, shares) in enumerate(runs.items()):
        marker, colour = ends[i % len(ends)]
        dots: Style = {"s": 20, "marker": marker, "facecolors": colour, "edgecolors": _DARK}
        label = f"{len(shares)} runs of {shown(name, 40)}"
        axes.scatter(*_place(corner, shares).T, linewidths=0.5, zorder=5, label=label, **dots)
    for i, (name, shares) in enumerate(printed):
        dots = {"s": 52, "marker": "DsPX"[i % 4], "facecolors": RED, "edgecolors": _LIGHT}
        label = f"printed: {shown(name, 44)}"
        axes.scatter(*_place(corner, shares).T, linewidths=1.0, zorder=6, label=label, **dots)
    star: Style = {"s": 130, "marker": "*", "facecolors": _LIGHT, "edgecolors": _DARK}
    axes.scatter(*_place(corner, centre).T, linewidths=1.0, zorder=7, label="optimum", **star)


def _forbids(problem: Problem) -> str:
    """What a tight total may break, in words; empty if it keeps all."""
    bounded = (problem.duration_lower > 0).any() or np.isfinite(problem.duration_upper).any()
    words = ["a bound on the durations"] if bounded else []
    return " or ".join(words + ["a position limit"] * problem.limits.limits_position)


def _key(figure: Picture, levels: Sequence[float], colours: Array, best: float) -> None:
    edges = list(range(len(levels) + 1))
    mapping = matplotlib.cm.ScalarMappable(
        BoundaryNorm(edges, len(levels)), ListedColormap(colours)
    )
    bar = figure.colorbar(mapping, ax=figure.axes, shrink=0.75, aspect=24, pad=0.02)
    bar.set_ticks(edges[:-1], labels=[f"+{v:g} %" if v else f"{best:.4f} s" for v in levels])
    bar.ax.tick_params(length=0)
    bar.outline.set_edgecolor(INK)
    bar.set_label("tight total, above the optimum")
