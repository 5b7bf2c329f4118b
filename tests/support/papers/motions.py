"""Curves of every family by scipy and plain linear algebra, and their true peaks."""

from collections.abc import Callable
from dataclasses import dataclass
from math import comb, factorial
from typing import Any

import numpy as np
from numpy.polynomial import polynomial as poly
from scipy.interpolate import BPoly, BSpline, CubicSpline, PPoly, make_interp_spline

Array = np.ndarray
FINE = 400
"""Points of a segment at which a curve that is not a polynomial in time is sampled, before a second
look around the largest."""


class NoCurveError(ValueError):
    """The durations and way-points define no curve of the family."""


@dataclass(frozen=True)
class Pieces:
    """Polynomials on pieces: coefficients (piece, power, joint) in the share of each piece."""

    lengths: Array
    coefficients: Array

    def derived(self, order: int) -> Array:
        """Coefficients of a derivative in time."""
        c = poly.polyder(self.coefficients, order, axis=1) if order else self.coefficients
        return c / self.lengths[:, None, None] ** order

    def ends(self, order: int) -> Array:
        """Least and largest value of a derivative, shape (2, joints)."""
        c = self.derived(order)
        sides = np.concatenate([c[:, 0, :], c.sum(axis=1)])
        found = np.stack([sides.min(axis=0), sides.max(axis=0)])
        slope = poly.polyder(c, axis=1)
        for piece, joint in np.ndindex(c.shape[0], c.shape[2]):
            own = np.trim_zeros(slope[piece, :, joint], "b")
            if own.size < 2:
                continue
            roots = poly.polyroots(own)
            inside = roots.real[(abs(roots.imag) < 1e-7) & (roots.real > 0) & (roots.real < 1)]
            if inside.size:
                values = poly.polyval(inside, c[piece, :, joint])
                found[0, joint] = min(found[0, joint], float(values.min()))
                found[1, joint] = max(found[1, joint], float(values.max()))
        return found

    def peaks(self, order: int) -> Array:
        """Largest absolute value of a derivative, for each joint."""
        return np.abs(self.ends(order)).max(axis=0)

    def at(self, times: Array, order: int) -> Array:
        """Values of a derivative (time, joint)."""
        breaks = np.concatenate([[0.0], np.cumsum(self.lengths)])
        piece = np.clip(np.searchsorted(breaks, times, side="right") - 1, 0, len(breaks) - 2)
        share = (times - breaks[piece]) / self.lengths[piece]
        c = self.derived(order)[piece]
        return np.sum(c * share[:, None, None] ** np.arange(c.shape[1])[None, :, None], axis=1)

    def jumps(self, order: int) -> Array:
        """Largest difference of a derivative between the sides of a break, for each joint."""
        c = self.derived(order)
        return np.abs(c.sum(axis=1)[:-1] - c[1:, 0, :]).max(axis=0, initial=0.0)

    @property
    def total(self) -> float:
        return float(self.lengths.sum())


@dataclass(frozen=True)
class Timed:
    """Joints and time both uniform cubic B-splines over one parameter."""

    joints: Pieces
    time: Pieces

    @property
    def total(self) -> float:
        return float(self.time.at(np.array([float(len(self.time.lengths))]), 0)[0, 0])

    def _in_time(self, at: Array, order: int) -> Array:
        q, t = ([one.at(at, k) for k in range(4)] for one in (self.joints, self.time))
        if order < 2:
            return q[order] / t[1] if order else q[0]
        turn = q[2] * t[1] - q[1] * t[2]
        if order == 2:
            return turn / t[1] ** 3
        return ((q[3] * t[1] - q[1] * t[3]) * t[1] - 3 * turn * t[2]) / t[1] ** 5

    def _parameters(self, each: int) -> Array:
        return np.linspace(0.0, float(len(self.time.lengths)), each * len(self.time.lengths) + 1)

    def ends(self, order: int) -> Array:
        """Least and largest value of a derivative, shape (2, joints)."""
        at = self._parameters(FINE)
        values = self._in_time(at, order)
        # The last power jumps at the breaks: both sides count.
        sides = self._in_time(np.arange(1, len(self.time.lengths)) - 1e-12, order)
        both = np.concatenate([values, sides])
        found = np.stack([both.min(axis=0), both.max(axis=0)])
        for side, (where, reach) in enumerate(((np.argmin, np.minimum), (np.argmax, np.maximum))):
            for joint, index in enumerate(where(values, axis=0)):
                low, high = at[max(index - 1, 0)], at[min(index + 1, len(at) - 1)]
                near = self._in_time(np.linspace(low, high, FINE), order)[:, joint]
                found[side, joint] = reach.reduce(near, initial=found[side, joint])
        return found

    def peaks(self, order: int) -> Array:
        """Largest absolute value of a derivative, for each joint."""
        return np.abs(self.ends(order)).max(axis=0)

    def at(self, times: Array, order: int) -> Array:
        grid = self._parameters(FINE)
        return self._in_time(np.interp(times, self.time.at(grid, 0)[:, 0], grid), order)


Motion = Pieces | Timed


def _of_ppoly(curve: PPoly) -> Pieces:
    lengths = np.diff(curve.x)
    kept = lengths > 1e-12 * lengths.sum()
    c = curve.c[::-1].transpose(1, 0, 2)[kept]
    powers = lengths[kept][:, None] ** np.arange(c.shape[1])
    return Pieces(lengths[kept], c * powers[:, :, None])


def nodes(h: Array) -> Array:
    """Times at which segments begin and end."""
    return np.concatenate([[0.0], np.cumsum(h)])


def declared(
    degrees: tuple[int, ...], h: Array, points: Array, ends: tuple[int, ...], free: tuple[int, ...]
) -> Pieces:
    """C2 polynomials of given degrees: one linear system per paper; ``free`` breaks pass no point.

    ``points`` holds a row for each break, which is not read where the break is free.
    """
    sizes = np.array(degrees) + 1
    first = np.concatenate([[0], np.cumsum(sizes)])
    rows: list[Array] = []
    right: list[Array] = []
    none = np.zeros(points.shape[1])
    scale = float(h.min())

    def row(piece: int, order: int, end: bool) -> Array:
        c = np.zeros(first[-1])
        for p in range(order, degrees[piece] + 1):
            value = factorial(p) / factorial(p - order) if end or p == order else 0.0
            c[first[piece] + p] = value * (scale / h[piece]) ** order
        return c

    count = len(degrees)
    for order in (0, *ends):
        rows += [row(0, order, False), row(count - 1, order, True)]
        right += [points[0], points[-1]] if order == 0 else [none, none]
    for k in range(1, count):
        if k in free:
            rows.append(row(k - 1, 0, True) - row(k, 0, False))
            right.append(none)
        else:
            rows += [row(k - 1, 0, True), row(k, 0, False)]
            right += [points[k], points[k]]
        for order in (1, 2):
            rows.append(row(k - 1, order, True) - row(k, order, False))
            right.append(none)
    x = np.linalg.solve(np.array(rows), np.array(right))
    c = np.zeros((count, max(sizes), points.shape[1]))
    for k in range(count):
        c[k, : sizes[k]] = x[first[k] : first[k + 1]]
    return Pieces(h, c)


def _virtual(points: Array, h: Array) -> Pieces:
    hole = np.zeros((1, points.shape[1]))
    rows = np.concatenate([points[:1], hole, points[1:-1], hole, points[-1:]])
    return declared((3,) * len(h), h, rows, (1, 2), (1, len(h) - 1))


def _rest(degree: int) -> Callable[[Array, Array], Pieces]:
    def fitted(points: Array, h: Array) -> Pieces:
        none = np.zeros_like(points)
        values = np.stack([points] + [none] * ((degree - 1) // 2), axis=1)
        return _of_ppoly(PPoly.from_bernstein_basis(BPoly.from_derivatives(nodes(h), values)))

    return fitted


def interpolated(at: Array, points: Array, degree: int, inner: Array) -> BSpline:
    """Through points at parameters, at rest at both ends, over clamped knots."""
    knots = np.concatenate([np.full(degree + 1, at[0]), inner, np.full(degree + 1, at[-1])])
    none = np.zeros(points.shape[1])
    still = [(1, none), (2, none)]
    try:
        return make_interp_spline(at, points, k=degree, t=knots, bc_type=(still, still))
    except (ValueError, np.linalg.LinAlgError) as error:
        raise NoCurveError(str(error)) from None


def _taylor(curve: BSpline, breaks: Array) -> Array:
    """Coefficients in the share of each piece, from its middle so that no side is mistaken."""
    ways, degree = np.diff(breaks), curve.k
    middle = breaks[:-1] + ways / 2
    c = np.stack([curve(middle, nu=k) / factorial(k) for k in range(degree + 1)], axis=1)
    c = c * (ways[:, None] ** np.arange(degree + 1))[:, :, None]
    moved = np.zeros_like(c)
    for k in range(degree + 1):
        for m in range(k + 1):
            moved[:, m] += c[:, k] * comb(k, m) * (-0.5) ** (k - m)
    return moved


def _of_spline(curve: BSpline) -> Pieces:
    breaks = np.unique(curve.t)
    return Pieces(np.diff(breaks), _taylor(curve, breaks))


def averaged(at: Array, degree: int, repeats: int = 2) -> Array:
    """Averages of so many parameters, whose ends count once more for each end condition."""
    every = np.concatenate([[at[0]] * repeats, at, [at[-1]] * repeats])
    return np.array([every[j : j + degree].mean() for j in range(1, len(every) - degree)])


def chords(points: Array) -> Array:
    """Shares of the way from way-point to way-point."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return nodes(lengths) / lengths.sum()


def clamped(
    degree: int, parameters: str, stretched: bool = False, knots: str = "averaged-continued"
) -> Callable[[Array, Array], Pieces]:
    """A clamped B-spline over the times, or over chords; these in proportion, or stretched."""

    def fitted(points: Array, h: Array) -> Pieces:
        at = nodes(h)
        own, scale = (at, 1.0) if parameters == "times" else (chords(points), float(at[-1]))
        inner = own[1:-1] if knots == "waypoints" else averaged(own, degree)
        if stretched:
            return _stretched(interpolated(own, points, degree, inner), own, h)
        return _of_spline(interpolated(at, points, degree, scale * inner))

    return fitted


def _stretched(curve: BSpline, at: Array, h: Array) -> Pieces:
    """A curve over parameters, each segment between two of them stretched to its duration."""
    breaks = np.unique(np.concatenate([curve.t, at]))
    breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-12])]
    ways = np.diff(breaks)
    segment = np.clip(np.searchsorted(at, breaks[:-1] + ways / 2) - 1, 0, len(h) - 1)
    return Pieces(h[segment] * ways / np.diff(at)[segment], _taylor(curve, breaks))


def vertices(points: Array) -> Array:
    """Control vertices of the uniform cubic B-spline through points, first and last two equal."""
    m = len(points)
    matrix = np.zeros((m, m))
    for i in range(m):
        for k, weight in ((i - 1, 1), (i, 4), (i + 1, 1)):
            matrix[i, min(max(k, 0), m - 1)] += weight / 6
    inner = np.linalg.solve(matrix, points)
    return np.concatenate([inner[:1], inner, inner[-1:]])


def _uniform(points: Array) -> Pieces:
    v = vertices(points)
    curve = BSpline(np.arange(-3.0, len(v) + 1.0), v, 3)
    return Pieces(np.ones(len(points) - 1), _taylor(curve, np.arange(float(len(points)))))


def uniform_stretched(points: Array, h: Array) -> Pieces:
    return Pieces(h, _uniform(points).coefficients)


def uniform_timed(points: Array, h: Array) -> Timed:
    time = _uniform(nodes(h)[:, None])
    c = time.derived(1)[:, :, 0]
    share = np.linspace(0, 1, 21)
    if (poly.polyval(share, c.T) <= 0.02 * h.mean()).any():
        raise NoCurveError("time turns back")
    return Timed(_uniform(points), time)


def _cubic(bc: str) -> Callable[[Array, Array], Pieces]:
    return lambda points, h: _of_ppoly(CubicSpline(nodes(h), points, bc_type=bc))


def _quintic(points: Array, h: Array) -> Pieces:
    at = nodes(h)
    return _of_spline(interpolated(at, points, 5, at[1:-1]))


@dataclass(frozen=True)
class Family:
    """A family of curves as a paper would state it.

    ``extra`` segments beside those between way-points; ``still`` orders vanish at both ends;
    ``smooth`` is the highest derivative that is continuous; ``apart`` says that each segment has
    its duration to itself, so the shortest is found segment by segment.
    """

    block: dict[str, Any]
    fit: Callable[[Array, Array], Motion]
    points: tuple[int, ...] = (3, 4, 5)
    extra: int = 0
    still: tuple[int, ...] = (1, 2)
    smooth: int = 2
    apart: bool = False
    degrees: Callable[[int], tuple[int, ...]] | None = None
    at_all: bool = False


def _degrees(degree: int) -> Callable[[int], tuple[int, ...]]:
    return lambda segments: (degree,) * segments


def _determined(block: dict[str, Any], *degrees: int) -> Family:
    """C2 polynomials at rest at both ends that way-points and durations determine."""
    return Family(
        block,
        lambda w, h: declared(degrees, h, w, (1, 2), ()),
        (len(degrees) + 1,),
        degrees=lambda n: degrees,
    )


FAMILIES = {
    "3-5-3": _determined({"family": "3-5-3"}, 3, 5, 3),
    **{
        "-".join(map(str, degrees)): _determined(
            {"family": "polynomials", "degrees": [*degrees]}, *degrees
        )
        for degrees in ((4, 3, 4), (4, 3, 3, 4))
    },
    "clamped cubic": Family(
        {"family": "cubic-spline"}, _cubic("clamped"), still=(1,), degrees=_degrees(3)
    ),
    "natural cubic": Family(
        {"family": "cubic-spline", "end_orders": [2]},
        _cubic("natural"),
        still=(2,),
        degrees=_degrees(3),
    ),
    "virtual cubic": Family({"family": "cubic-spline-virtual"}, _virtual, (3, 4), extra=2),
    "C4 quintic": Family({"family": "quintic-spline"}, _quintic, smooth=4, degrees=_degrees(5)),
    **{
        f"rest {degree}": Family(
            {"family": "rest-to-rest", "degree": degree},
            _rest(degree),
            (2, 3, 4),
            still=tuple(range(1, (degree + 1) // 2)),
            smooth=(degree - 1) // 2,
            apart=True,
            degrees=_degrees(degree),
            at_all=True,
        )
        for degree in (3, 5, 7, 9)
    },
    "jtraj": Family({"family": "jtraj"}, _rest(5), (2, 3, 4), apart=True, at_all=True),
    "stretched uniform": Family(
        {"family": "uniform-cubic-b-spline", "time": "stretched"},
        uniform_stretched,
        (4, 5),
        still=(),
        smooth=0,
        apart=True,
    ),
    "timed uniform": Family(
        {"family": "uniform-cubic-b-spline", "time": "timed"}, uniform_timed, (4, 5), still=(2,)
    ),
    **{
        f"clamped B-spline {degree} {parameters}": Family(
            {
                "family": "clamped-b-spline",
                "degree": degree,
                "knots": "averaged-continued",
                "parameters": said,
                "time": time,
            },
            clamped(degree, said, time == "stretched"),
            (4, 5),
            smooth=0 if time == "stretched" else min(degree - 1, 4),
            apart=time == "stretched",
        )
        for degree, parameters, said, time in (
            (3, "times", "times", "timed"),
            (4, "times", "times", "timed"),
            (5, "times", "times", "timed"),
            (4, "chord", "chord", "timed"),
            (5, "stretched", "chord", "stretched"),
        )
    },
}
"""Every family of case files, by a short name."""


def ratios(motion: Motion, limits: dict[int, Array]) -> dict[int, float]:
    """Largest peak over its limit, for each limited derivative."""
    return {order: float((motion.peaks(order) / limit).max()) for order, limit in limits.items()}


def stretch(motion: Motion, limits: dict[int, Array]) -> float:
    """The factor on all durations at which the motion just reaches its limits."""
    return max(ratio ** (1 / order) for order, ratio in ratios(motion, limits).items())


def shortest_apart(family: Family, points: Array, limits: dict[int, Array], segments: int) -> Array:
    """Shortest durations where each segment has its own: every peak scales with it alone."""
    motion = family.fit(points, np.ones(segments))
    assert isinstance(motion, Pieces)
    found = np.zeros(segments)
    whose = np.minimum(np.cumsum(motion.lengths) - motion.lengths / 2, segments - 0.5).astype(int)
    for k in range(segments):
        own = Pieces(motion.lengths[whose == k], motion.coefficients[whose == k])
        found[k] = stretch(own, limits)
    return found
