"""C2 cubic splines as equations that are bilinear in spans and nodal accelerations.

Unknowns of one joint are its accelerations at all breaks and its velocities at all way-points. The
coordinates y are the spans T between way-points and, with virtual way-points, the first and the
last duration h with ρ = h²/T. Equations and limits are affine in y and in the unknowns, apart from
1/T beside the known displacement of a span. Derivation: docs/explanation/certificates-cubic.md.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from fractions import Fraction

from ....problem import Interpolant, cubic_spline_virtual
from ..exact import ExactProblem

PLACES = 64
"""Velocity limits are looked at in multiples of 1/PLACES of a piece."""
_STARTING = (16, 32, 48)
"""Places of the first velocity rows, the quarters: `guide.peaks` adds others where they count."""
_EXPONENT = 3
"""The unit of time is a power of two for which the longest total is below 2^(_EXPONENT + 1)."""


@dataclass(frozen=True, order=True)
class CubicRow:
    """A condition ≤ 0.

    Attributes
    ----------
    kind : str
        "jerk" of a piece, "velocity" in a span, "lower" or "upper" bound of a piece's duration, or
        "total": the total is below the cap.
    joint : int
        −1 where no joint takes part.
    index : int
        Piece, or span for "velocity".
    sign : int
    place : int
        Of the velocity, in 1/PLACES of the piece of that span that no virtual way-point ends at.
    """

    kind: str
    joint: int = -1
    index: int = 0
    sign: int = 1
    place: int = 0


@dataclass(frozen=True, eq=False)
class SparseTerms:
    """Σ by·x + Σ product·y·x + Σ along·y + constant, sparse."""

    by: dict[int, float] = field(default_factory=dict)
    product: dict[tuple[int, int], float] = field(default_factory=dict)
    along: dict[int, Fraction] = field(default_factory=dict)
    constant: Fraction = Fraction(0)


def kind_of_ends(problem: ExactProblem) -> tuple[int, ...] | None:
    """Orders prescribed as 0 at both ends and whether virtual way-points are there, or None.

    None: it is no C2 cubic spline of the kinds covered. (1, 2, 1): clamped at the start, natural at
    the end, virtual.
    """
    curve = problem.curve
    if not isinstance(curve, Interpolant) or set(curve.degrees) != {3}:
        return None
    n = curve.segments
    if set(curve.continuity) - {2} or any(curve.prescribed[1:-1]):
        return None
    if n >= 4 and curve.virtual == (1, n - 1):
        same = curve.prescribed == cubic_spline_virtual(n - 1).prescribed
        return (0, 0, 1) if same else None
    ends = [dict(curve.prescribed[b]) for b in (0, n)]
    if curve.virtual or any(len(e) != 1 for e in ends):
        return None
    orders = [next(iter(e)) for e in ends]
    if any(e[r] != 0 for e, r in zip(ends, orders, strict=True)) or max(orders) > 2:
        return None
    return (*orders, 0)


@dataclass(frozen=True, eq=False)
class CubicSystem:
    """One problem in units in which angles and times are of order 1.

    Attributes
    ----------
    ends : tuple of int
        From `kind_of_ends`.
    powers : tuple of int
        Joint j is measured in 2**powers[j] of the problem's unit of angle.
    second : int
        Times are measured in 2**second s.
    steps : tuple, [span][joint]
        Displacements.
    limits : tuple, [joint][order − 1]
        Looser ends; None where there is none (or 0).
    shortest, longest : tuple, one per piece
    """

    ends: tuple[int, ...]
    powers: tuple[int, ...]
    second: int
    steps: tuple[tuple[Fraction, ...], ...]
    limits: tuple[tuple[Fraction | None, ...], ...]
    shortest: tuple[Fraction, ...]
    longest: tuple[Fraction | None, ...]

    @property
    def virtual(self) -> bool:
        """Whether the first and the last span hold a virtual way-point."""
        return bool(self.ends[2])

    @property
    def pieces(self) -> int:
        """Number of pieces n."""
        return len(self.shortest)

    @property
    def spans(self) -> int:
        """Number of spans between way-points m."""
        return len(self.steps)

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.powers)

    @property
    def free(self) -> int:
        """Number of coordinates that a box has sides for: spans, then first and last duration."""
        return self.spans + (2 if self.virtual else 0)

    @property
    def coordinates(self) -> int:
        """Number of all coordinates: those of a box, then both ρ."""
        return self.spans + (4 if self.virtual else 0)

    @property
    def breaks(self) -> list[int]:
        """Break of every way-point."""
        n = self.pieces
        return [0, *range(2, n - 1), n] if self.virtual else list(range(n + 1))

    @property
    def unknowns(self) -> int:
        """Number of unknowns N of one joint."""
        return self.pieces + 1 + self.spans + 1

    def speed(self, waypoint: int) -> int:
        """Unknown that is the velocity at a way-point."""
        return self.pieces + 1 + waypoint

    @property
    def curved(self) -> list[tuple[int, int, int]]:
        """(h, T, ρ) of both virtual ends as coordinates."""
        m = self.spans
        return [(m, 0, m + 2), (m + 1, m - 1, m + 3)] if self.virtual else []

    def piece(self, k: int) -> dict[int, int]:
        """Duration of a piece in the coordinates."""
        m, n = self.spans, self.pieces
        if not self.virtual:
            return {k: 1}
        special = {0: {m: 1}, 1: {0: 1, m: -1}, n - 2: {m - 1: 1, m + 1: -1}, n - 1: {m + 1: 1}}
        return special.get(k, {k - 1: 1})

    def equations(self) -> list[tuple[SparseTerms, tuple[int, int] | None]]:
        """Equations: their terms = 0, or = sign·6·displacement/T for (span, sign)."""
        n, m, breaks = self.pieces, self.spans, self.breaks
        out: list[tuple[SparseTerms, tuple[int, int] | None]] = []
        for break_, waypoint, order in ((0, 0, self.ends[0]), (n, m, self.ends[1])):
            if order != 2:
                out.append((SparseTerms(by={self.speed(waypoint): 1.0}), None))
            if order != 1:
                out.append((SparseTerms(by={break_: 1.0}), None))
        for t in range(m):
            left, right = breaks[t], breaks[t + 1]
            start, end = self.speed(t), self.speed(t + 1)
            if self.virtual and t in (0, m - 1):
                # From the end at rest: 2v = T(a + b) − h b, 6Δq/T = (2T − h)a + (T − 2h + ρ)b.
                near, far, speed, sign = (1, 2, end, 1) if t == 0 else (n - 1, n - 2, start, -1)
                h, _, rho = self.curved[0 if t == 0 else 1]
                out.append(
                    (
                        SparseTerms(
                            {speed: 2.0 * sign},
                            {(t, near): -1.0, (t, far): -1.0, (h, far): 1.0},
                        ),
                        None,
                    )
                )
                products = {(t, near): 2.0, (h, near): -1.0}
                products |= {(t, far): 1.0, (h, far): -2.0, (rho, far): 1.0}
                out.append((SparseTerms(product=products), (t, sign)))
                continue
            ends = {(t, left): -1.0, (t, right): -1.0}
            out.append((SparseTerms({end: 2.0, start: -2.0}, ends), None))
            out.append((SparseTerms({start: 6.0}, {(t, left): 2.0, (t, right): 1.0}), (t, 1)))
        return out

    def row(self, row: CubicRow, cap: Fraction) -> SparseTerms:
        """Left-hand side of a condition ≤ 0."""
        k, sign = row.index, float(row.sign)
        if row.kind == "total":
            return SparseTerms(along={t: Fraction(1) for t in range(self.spans)}, constant=-cap)
        if row.kind == "lower":
            along = {c: Fraction(-x) for c, x in self.piece(k).items()}
            return SparseTerms(along=along, constant=self.shortest[k])
        if row.kind == "upper":
            longest = self.longest[k]
            assert longest is not None
            return SparseTerms(
                along={c: Fraction(x) for c, x in self.piece(k).items()}, constant=-longest
            )
        if row.kind == "jerk":
            limit = self.limits[row.joint][2]
            assert limit is not None
            return SparseTerms(
                {k + 1: sign, k: -sign}, along={c: -limit * x for c, x in self.piece(k).items()}
            )
        limit = self.limits[row.joint][0]
        assert limit is not None
        n, m, s = self.pieces, self.spans, row.place / PLACES
        first, second = sign * (s - s * s / 2), sign * s * s / 2
        if self.virtual and k in (0, m - 1):
            near, far = (1, 2) if k == 0 else (n - 1, n - 2)
            h = m if k == 0 else m + 1
            products = {(k, near): first, (h, near): 0.5 * sign - first}
            products |= {(k, far): second, (h, far): -second}
            return SparseTerms(product={p: x for p, x in products.items() if x}, constant=-limit)
        left, right = self.breaks[k], self.breaks[k + 1]
        return SparseTerms(
            {self.speed(k): sign}, {(k, left): first, (k, right): second}, constant=-limit
        )

    def starting_rows(self) -> list[CubicRow]:
        """Conditions of a first relaxation."""
        rows = []
        for j, (velocity, _, jerk) in enumerate(self.limits):
            for sign in (1, -1):
                if jerk is not None:
                    rows += [CubicRow("jerk", j, k, sign) for k in range(self.pieces)]
                for t in range(self.spans if velocity is not None else 0):
                    rough = self.virtual and t in (0, self.spans - 1)
                    places = (0, *_STARTING) if rough else _STARTING
                    rows += [CubicRow("velocity", j, t, sign, place) for place in places]
        for k in range(self.pieces):
            if len(self.piece(k)) > 1:
                rows.append(CubicRow("lower", index=k))
            if self.longest[k] is not None:
                rows.append(CubicRow("upper", index=k))
        return rows


def cubic_system(problem: ExactProblem, longest: Fraction) -> CubicSystem:
    """The problem in units of order 1.

    Parameters
    ----------
    problem : ExactProblem
        Of a kind that `kind_of_ends` knows.
    longest : Fraction
        A total that is not exceeded, s.

    Returns
    -------
    CubicSystem
    """
    ends = kind_of_ends(problem)
    assert ends is not None
    second = math.frexp(float(longest))[1] - 1 - _EXPONENT
    steps = displacements(problem)
    ways = [float(sum(abs(step[j]) for step in steps)) for j in range(len(problem.joints))]
    powers = [math.frexp(way)[1] - _EXPONENT if way > 0 else 0 for way in ways]
    return scaled(problem, ends, powers, second)


def displacements(problem: ExactProblem) -> list[list[Fraction]]:
    """Way from each way-point to the next, [span][joint]."""
    return [
        [b - a for a, b in zip(row, after, strict=True)]
        for row, after in itertools.pairwise(problem.waypoints)
    ]


def scaled(
    problem: ExactProblem,
    ends: tuple[int, ...],
    powers: list[int],
    second: int,
) -> CubicSystem:
    """The system in given units."""
    steps = displacements(problem)
    two, unit = Fraction(2), Fraction(2) ** second
    return CubicSystem(
        ends,
        tuple(powers),
        second,
        tuple(tuple(x / two**p for x, p in zip(step, powers, strict=True)) for step in steps),
        tuple(
            tuple(
                None if x is None or x.high <= 0 else x.high * unit**r / two**p
                for r, x in enumerate(row, start=1)
            )
            for row, p in zip(problem.limits, powers, strict=True)
        ),
        tuple(x / unit for x in problem.duration_lower),
        tuple(None if x is None else x / unit for x in problem.duration_upper),
    )
