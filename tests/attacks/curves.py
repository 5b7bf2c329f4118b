"""Brute force: the curves of every family by scipy, sampled densely; nothing here is the judge's.

Peaks of a polynomial of degree d sampled at M Chebyshev points are at most 1/cos(dπ/2M) above the
largest sample (Ehlich and Zeller, Math. Z. 86, 1964), so that the samples bound them on both sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly, BSpline, CubicSpline, PPoly, make_interp_spline

from attacks.declared import Ends, coefficients, declared

Array = NDArray[np.float64]
Derivatives = Callable[[Array], tuple[Array, Array, Array, Array]]
"""Position, velocity, acceleration and jerk of one piece at places in [0, 1]."""

SAMPLES = 601
"""Chebyshev points a piece: for degree 9 the factor above is 1 + 2.8e-4."""
RATIONAL = 1.002
"""The same factor where velocity is a quotient (timed B-splines): no theorem, a wide margin."""
_PLACES = (1.0 - np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)) / 2.0
"""Chebyshev points of [0, 1]."""


class NoCurve(Exception):
    """The durations define no curve."""


@dataclass(frozen=True)
class Asked:
    """One question in rad and s, as the attacks understand it.

    ``block`` is the interpolant as a case file declares it, its end derivatives in rad and s;
    limits have shape (joints,), absent ones are inf. ``below`` has the sizes of the lower limits
    where they differ from the upper ones, shape (joints, 3). ``ends`` and ``finish`` have the
    derivatives of the first and the last way-point by order, shape (joints,) each.
    """

    block: dict[str, Any]
    waypoints: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    position_lower: Array
    position_upper: Array
    duration_lower: Array
    duration_upper: Array
    labels: tuple[str, ...] = ()
    coupling: str = "shared"
    ends: Ends = field(default_factory=dict)
    finish: Ends = field(default_factory=dict)
    below: Array | None = None

    @property
    def family(self) -> str:
        return str(self.block["family"])

    @property
    def segments(self) -> int:
        return len(self.duration_lower)

    @property
    def limits(self) -> Array:
        """Upper limits, and sizes of the lower ones unless ``below`` says more, (joints, 3)."""
        return np.stack([self.velocity, self.acceleration, self.jerk], axis=1)

    @property
    def sides(self) -> Array:
        """Sizes of the limits below 0 and above 0, shape (2, joints, 3)."""
        return np.stack([self.limits if self.below is None else self.below, self.limits])

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Which joints have some derivative other than 0 at an end, shape (joints,)."""
        found = np.zeros(self.waypoints.shape[1], dtype=bool)
        for values in (*self.ends.values(), *self.finish.values()):
            found |= np.broadcast_to(values, found.shape) != 0
        return found

    @property
    def free_of_bounds(self) -> bool:
        """Whether stretching all durations alone repairs every excess."""
        return (
            not self.duration_lower.any()
            and not np.isfinite(self.duration_upper).any()
            and not np.isfinite([self.position_lower, self.position_upper]).any()
            and not self.moving.any()
        )

    def joint(self, j: int) -> Asked:
        """The question of one joint by itself."""
        names = ("velocity", "acceleration", "jerk", "position_lower", "position_upper")
        limits = {name: getattr(self, name)[j : j + 1] for name in names}
        below = None if self.below is None else self.below[j : j + 1]
        return replace(
            self,
            waypoints=self.waypoints[:, j : j + 1],
            labels=self.labels[j : j + 1],
            below=below,
            ends={r: v[j : j + 1] for r, v in self.ends.items()},
            finish={r: v[j : j + 1] for r, v in self.finish.items()},
            **limits,
        )


@dataclass(frozen=True)
class Piece:
    """A stretch of the motion of one joint; ``excess`` bounds what lies between the samples."""

    at: Derivatives
    excess: float
    near: Array = field(default_factory=lambda: np.empty(0))
    """Places beside the Chebyshev points, where derivatives change faster than these tell."""

    @property
    def samples(self) -> tuple[Array, Array, Array, Array]:
        """Position, velocity, acceleration and jerk at all its places."""
        return self.at(np.concatenate([_PLACES, self.near]))


@dataclass(frozen=True)
class Peaks:
    """Bounds on the true peaks of each joint: ``low`` ≤ peak ≤ ``high``, and the range of q.

    ``sided_low`` and ``sided_high`` are those below 0 and above 0, shape (2, joints, 3).
    """

    low: Array
    high: Array
    bottom: Array
    top: Array
    jumps: Array
    """Largest jump of velocity and of acceleration at a break, relative, shape (joints, 2)."""
    sided_low: Array
    sided_high: Array


def segments_of(block: dict[str, Any], points: int) -> int:
    """How many durations a family takes for a number of way-points."""
    if block["family"] in ("cubic-spline-virtual", "quintic-spline-virtual"):
        return points + 1
    return points - 1


def pieces(asked: Asked, h: Array) -> list[list[Piece]]:
    """The motion of every joint, piece by piece."""
    if not (np.isfinite(h).all() and (h > 0).all()):
        raise NoCurve
    make = _MAKERS[asked.family]
    return [make(asked, j, asked.waypoints[:, j], h) for j in range(asked.waypoints.shape[1])]


def peaks(asked: Asked, h: Array) -> Peaks:
    """Peaks of every joint, bounded from both sides."""
    low, high, bottom, top, jumps = [], [], [], [], []
    # A joint whose way-points are all one stands still: what the splines show is rounding.
    still = (np.ptp(asked.waypoints, axis=0) == 0) & ~asked.moving
    sided = np.zeros((2, 2, len(still), 3))
    for index, (joint, stands) in enumerate(zip(pieces(asked, h), still, strict=True)):
        sampled = [p.samples for p in joint]
        signed = [np.stack(x[1:]) * (not stands) for x in sampled]
        values = [np.abs(x).max(axis=1) for x in signed]
        sided[:, :, index] = _sided(joint, signed)
        own = asked.waypoints[:, index]
        positions = own if stands else np.concatenate([x[0] for x in sampled])
        low.append(np.max(values, axis=0))
        high.append(np.max([v * p.excess for v, p in zip(values, joint, strict=True)], axis=0))
        bottom.append(positions.min())
        top.append(positions.max())
        jumps.append(_jumps(joint, low[-1]))
    return Peaks(*(np.array(x) for x in (low, high, bottom, top, jumps)), *sided)


def _sided(joint: list[Piece], signed: list[Array]) -> Array:
    """Least and largest possible reach below 0 and above 0, shape (2 bounds, 2 sides, 3)."""
    found = np.zeros((2, 2, 3))
    for piece, x in zip(joint, signed, strict=True):
        for side, values in enumerate((-x, x)):
            top = values.max(axis=1)
            # The theorem, on the polynomial less the middle of its samples.
            more = (piece.excess - 1) * (top - values.min(axis=1)) / 2
            found[:, side] = np.maximum(found[:, side], [top, top + more])
    return found


def _jumps(joint: list[Piece], scale: Array) -> Array:
    worst = np.zeros(2)
    for left, right in pairwise(joint):
        a, b = left.at(np.ones(1)), right.at(np.zeros(1))
        for r in (1, 2):
            size = abs(float(b[r][0] - a[r][0]))
            worst[r - 1] = max(worst[r - 1], size / scale[r - 1] if scale[r - 1] else 0.0)
    return worst


def excess(asked: Asked, h: Array) -> tuple[float, float]:
    """Bounds on the largest ratio of any peak to its limit, duration bounds included."""
    found = peaks(asked, h)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = (found.sided_low, found.sided_high)
        ratios = [np.where(x > 0, x / asked.sides, 0.0) for x in reach]
    least, most = (float(r.max(initial=0.0)) for r in ratios)
    half = np.where(
        np.isfinite(asked.position_upper - asked.position_lower),
        (asked.position_upper - asked.position_lower) / 2,
        1.0,
    )
    # An extremum inside lies half a step from a sample, an end far less.
    step = (np.pi / (2 * SAMPLES)) ** 2
    slack = (found.high[:, 1] * h.max() + found.high[:, 0]) * h.max() * step
    for side in (asked.position_lower - found.bottom, found.top - asked.position_upper):
        with np.errstate(divide="ignore", invalid="ignore"):
            over = np.where(np.isfinite(side), side / half, -1.0)
            wide = np.where(np.isfinite(side), slack / half, 0.0)
        least = max(least, float(1.0 + np.nan_to_num(over, nan=0.0).max(initial=-1.0)))
        most = max(most, float(1.0 + np.nan_to_num(over + wide, nan=0.0).max(initial=-1.0)))
    bounds = max((asked.duration_lower / h).max(), (h / asked.duration_upper).max())
    return max(least, float(bounds)), max(most, float(bounds))


def _polynomial(c: Array, length: float) -> Piece:
    """Powers of s, lowest first, on a segment of that length."""
    own = [np.polynomial.Polynomial(c)]
    own += [own[0].deriv(r) for r in (1, 2, 3)]

    def at(s: Array) -> tuple[Array, Array, Array, Array]:
        q, v, a, j = (p(s) / length**r for r, p in enumerate(own))
        return q, v, a, j

    return Piece(at, _factor(len(c) - 1))


def _factor(degree: int) -> float:
    return float(1.0 / np.cos(degree * np.pi / (2 * SAMPLES)))


def _of_spline(curve: Any, degree: int, breaks: Array, scales: Array | None = None) -> list[Piece]:
    """Pieces of anything with derivatives, between breaks; time runs ``scales`` times faster."""
    orders = [curve, *(curve.derivative(r) for r in (1, 2, 3))]
    scales = np.ones(len(breaks) - 1) if scales is None else scales
    made = []
    for a, b, rate in zip(breaks, breaks[1:], scales, strict=False):
        # Both ends belong to this piece, though scipy gives a break to the piece on its right.
        inset = (b - a) * 1e-13

        def at(
            s: Array, a: float = a, b: float = b, rate: float = rate, inset: float = inset
        ) -> tuple[Array, Array, Array, Array]:
            u = np.clip(a + (b - a) * s, a + inset, b - inset)
            q, v, acc, j = (f(u) * rate**r for r, f in enumerate(orders))
            return q, v, acc, j

        made.append(Piece(at, _factor(degree)))
    return made


def _times(h: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(h)])


def _joined(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    """Piecewise polynomials by one dense linear system in powers of s."""
    form = declared(asked.block, len(h), asked.ends, asked.finish)
    assert form is not None
    try:
        c, starts = coefficients(form.joint(j), q[:, None], h[None])
    except np.linalg.LinAlgError:
        raise NoCurve from None
    return [_polynomial(c[0, a:b, 0], h[k]) for k, (a, b) in enumerate(pairwise(starts))]


def _cubic(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    (order,) = asked.block.get("end_orders", [1])
    (last,) = asked.block.get("finish_orders", [order])
    ends = [
        (r, float(values[r][j]) if r in values else 0.0)
        for r, values in ((order, asked.ends), (last, asked.finish))
    ]
    t = _times(h)
    if len(h) == 1:  # scipy's two-point spline, by Hermite's formula or as declared
        if order == last == 1:
            rows = [[x, v] for x, (_, v) in zip(q, ends, strict=True)]
            return _of_spline(BPoly.from_derivatives(t, rows), 3, t)
        return _joined(asked, j, q, h)
    return _of_spline(CubicSpline(t, q, bc_type=tuple(ends)), 3, t)


def _quintic(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    t = _times(h)
    ends = [
        [(r, float(values[r][j]) if r in values else 0.0) for r in (1, 2)]
        for values in (asked.ends, asked.finish)
    ]
    return _of_spline(make_interp_spline(t, q, k=5, bc_type=tuple(ends)), 5, t)


def _still(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    """Splines at rest to the third order at both ends; two breaks of the quintic are no sites."""
    t, virtual = _times(h), asked.family == "quintic-spline-virtual"
    degree, sites = (5, np.delete(t, [1, len(t) - 2])) if virtual else (7, t)
    knots = np.concatenate([[0.0] * (degree + 1), t[1:-1], [t[-1]] * (degree + 1)])
    rest = [(r, 0.0) for r in (1, 2, 3)]
    curve = make_interp_spline(sites, q, k=degree, t=knots, bc_type=(rest, rest))
    return _of_spline(curve, degree, t)


def _virtual(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    t = _times(h)

    def through(x: float, y: float) -> CubicSpline:
        # The first and the last inner break carry no way-point.
        points = np.concatenate([[q[0], x], q[1:-1], [y, q[-1]]])
        return CubicSpline(t, points, bc_type=((1, 0.0), (1, 0.0)))

    def ends(x: float, y: float) -> Array:
        return np.asarray(through(x, y)(t[[0, -1]], 2))

    base = ends(0.0, 0.0)
    matrix = np.stack([ends(1.0, 0.0) - base, ends(0.0, 1.0) - base], axis=1)
    x, y = np.linalg.solve(matrix, -base)
    return _of_spline(through(float(x), float(y)), 3, t)


def _rest(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    degree = 5 if asked.family == "jtraj" else asked.block["degree"]
    still = [0.0] * ((degree - 1) // 2)
    t = _times(h)
    curve = BPoly.from_derivatives(t, [[x, *still] for x in q])
    powers = PPoly.from_bernstein_basis(curve)
    # Where nothing moves, the powers are rounding, and a short segment would make a jerk of it.
    powers.c[:-1, np.diff(q) == 0.0] = 0.0
    return _of_spline(powers, degree, t)


def _vertices(q: Array) -> Array:
    """V_0 … V_{m+1} from (V_{i−1} + 4V_i + V_{i+1})/6 = W_i, V_1 = V_0, V_{m+1} = V_m."""
    m = len(q)
    matrix = np.zeros((m + 2, m + 2))
    for i in range(m):
        matrix[i, i : i + 3] = 1 / 6, 4 / 6, 1 / 6
    matrix[m, :2] = 1.0, -1.0
    matrix[m + 1, -2:] = 1.0, -1.0
    return np.asarray(np.linalg.solve(matrix, np.concatenate([q, [0.0, 0.0]])))


def _uniform(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    count = len(q)
    knots = np.arange(-3.0, count + 3.0)
    breaks = np.arange(0.0, count)
    curve = BSpline(knots, _vertices(q), 3)
    if asked.block["time"] == "stretched":
        return _of_spline(curve, 3, breaks, 1.0 / h)
    clock = BSpline(knots, _vertices(_times(h)), 3)
    return [
        _by_clock(x, t)
        for x, t in zip(_of_spline(curve, 3, breaks), _of_spline(clock, 3, breaks), strict=True)
    ]


def _by_clock(curve: Piece, clock: Piece) -> Piece:
    # dt/de is a quadratic: its least value lies at an end or at its turning point.
    _, first, second, third = clock.at(np.array([0.0, 1.0]))
    turning = -second[0] / third[0] if third[0] else -1.0
    inner = clock.at(np.array([np.clip(turning, 0.0, 1.0)]))[1]
    if min(first.min(), inner.min()) <= 0:
        raise NoCurve

    def at(s: Array) -> tuple[Array, Array, Array, Array]:
        q, q1, q2, q3 = curve.at(s)
        _, t1, t2, t3 = clock.at(s)
        turn = q2 * t1 - q1 * t2
        turned = q3 * t1 - q1 * t3
        return q, q1 / t1, turn / t1**3, (turned * t1 - 3 * turn * t2) / t1**5

    # About its least value dt/de is m + c (e − e₀)²: jerk, with its fifth power below, peaks on a
    # stretch of √(m/c), which may be far narrower than the points between which it lies.
    width = np.sqrt(2.0 * inner.min() / abs(third[0])) if third[0] else 0.0
    near = np.clip(turning + width * np.linspace(-5.0, 5.0, 2001), 0.0, 1.0)
    return Piece(at, RATIONAL, near if 0.0 < turning < 1.0 else np.empty(0))


def _clamped(asked: Asked, j: int, q: Array, h: Array) -> list[Piece]:
    block, t = asked.block, _times(h)
    degree, orders = block["degree"], block.get("end_orders", [1, 2])
    total, stretched = float(t[-1]), block.get("time") == "stretched"
    along = t / total
    if block["parameters"] == "times":
        own = along
    else:
        way = asked.waypoints if block["parameters"] == "chord" else q[:, None]
        chords = np.linalg.norm(np.diff(way, axis=0), axis=1)
        if not (chords > 0).all():
            raise NoCurve
        own = np.concatenate([[0.0], np.cumsum(chords)]) / chords.sum()
        own[-1] = 1.0
    sites = np.concatenate([np.zeros(len(orders)), own, np.ones(len(orders))])
    if block["knots"] == "waypoints":
        inner = own[1:-1]
    else:
        count = len(sites) - degree - 1
        inner = np.array([sites[i : i + degree].mean() for i in range(1, count + 1)])
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    number = len(knots) - degree - 1
    passed = own if stretched else along
    basis = [BSpline(knots, np.eye(number)[i], degree) for i in range(number)]
    rows = [[b(x) for b in basis] for x in passed[1:-1]]
    for x in (0.0, 1.0):
        rows += [[float(b(x, r)) for b in basis] for r in (0, *orders)]
    right = [*q[1:-1], q[0], *np.zeros(len(orders)), q[-1], *np.zeros(len(orders))]
    matrix = np.array(rows, dtype=float)
    if matrix.shape[0] != number or np.linalg.cond(matrix) > 1e9:
        raise NoCurve
    curve = BSpline(knots, np.linalg.solve(matrix, right), degree)
    if stretched:
        cuts = np.unique(np.concatenate([own, inner]))
        middle = (cuts[1:] + cuts[:-1]) / 2
        segment = np.clip(np.searchsorted(own, middle) - 1, 0, len(h) - 1)
        return _of_spline(curve, degree, cuts, np.diff(own)[segment] / h[segment])
    cuts = np.unique(np.concatenate([along, knots]))
    keep = np.concatenate([[True], np.diff(cuts) > 1e-9])
    cuts = cuts[keep]
    return _of_spline(curve, degree, cuts, np.full(len(cuts) - 1, 1.0 / total))


_MAKERS: dict[str, Callable[[Asked, int, Array, Array], list[Piece]]] = {
    "3-5-3": _joined,
    "polynomials": _joined,
    "stated": _joined,
    "cubic-spline": _cubic,
    "quintic-spline": _quintic,
    "septic-spline": _still,
    "cubic-spline-virtual": _virtual,
    "quintic-spline-virtual": _still,
    "rest-to-rest": _rest,
    "jtraj": _rest,
    "uniform-cubic-b-spline": _uniform,
    "clamped-b-spline": _clamped,
}
