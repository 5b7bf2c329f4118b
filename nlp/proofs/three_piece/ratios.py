"""Pieces of 3-5-3 and 4-3-4 curves as quotients of polynomials in two ratios of the durations.

With x = h₂/h₁, y = h₂/h₃ and s from 0 to 1 along a piece, q(s) is Σ xⁱyʲ·c(s) over a positive
polynomial of x and y, all of degree at most 2 in x and in y. The derivation is in
docs/explanation/certificates.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ....problem import Curve, Interpolant

Ratios = tuple[int, int]
"""Exponents of x and y."""
Powers = tuple[Fraction, ...]
"""Ascending coefficients in s."""

POWERS = 6
"""Coefficients in s that hold every piece."""

_HALF = Fraction(1, 2)
"""Exact: the basis holds halves."""
# Hermite basis on [0, 1], ascending: blend of the positions, velocities and accelerations.
_QUINTIC: tuple[tuple[int | Fraction, ...], ...] = (
    (0, 0, 0, 10, -15, 6),
    (0, 1, 0, -6, 8, -3),
    (0, 0, _HALF, -3 * _HALF, 3 * _HALF, -_HALF),
    (0, 0, 0, -4, 7, -3),
    (0, 0, 0, _HALF, -1, _HALF),
)


@dataclass(frozen=True)
class Piece:
    """A piece whose limits are rows.

    Attributes
    ----------
    kind : str
        Of its rows.
    segment : int
    below : mapping
        The divisor: coefficients of xⁱyʲ, none negative.
    above : callable
        From the four angles of a joint to the coefficients in s for each xⁱyʲ.
    """

    kind: str
    segment: int
    below: Mapping[Ratios, int]
    above: Callable[[Sequence[Fraction]], dict[Ratios, Powers]]


@dataclass(frozen=True)
class ThreePieces:
    """One kind of curve of three pieces.

    Attributes
    ----------
    proof : str
        Kind of its proofs in a certificate.
    degrees : tuple of int
    pieces : tuple of Piece
    ends : tuple of int
        Per order: an end piece of length d and duration h has |q⁽ʳ⁾| ≥ ends·|d|/hʳ somewhere.
    monomials : tuple of (int, int)
        The xⁱyʲ that occur.
    """

    proof: str
    degrees: tuple[int, int, int]
    pieces: tuple[Piece, ...]
    ends: tuple[int, int, int]
    monomials: tuple[Ratios, ...]

    @property
    def kinds(self) -> dict[str, int]:
        """Segment of each kind of row that speaks about a joint."""
        return {"first": 0, "mean": 1, "last": 2, **{p.kind: p.segment for p in self.pieces}}


def derivative(powers: Powers, order: int, s: Fraction) -> Fraction:
    """Derivative of a polynomial with ascending coefficients, at s."""
    total = Fraction(0)
    for p in range(len(powers) - 1, order - 1, -1):
        total = total * s + powers[p] * math.perm(p, order)
    return total


def _spread(*parts: tuple[Mapping[Ratios, Fraction | int], Sequence[int]]) -> dict[Ratios, Powers]:
    """Sum of products of a polynomial in x, y and one in s."""
    found: dict[Ratios, list[Fraction]] = {}
    for ratios, powers in parts:
        for key, factor in ratios.items():
            into = found.setdefault(key, [Fraction(0)] * POWERS)
            for p, c in enumerate(powers):
                into[p] += factor * c
    return {key: tuple(values) for key, values in found.items()}


def _steps(q: Sequence[Fraction]) -> tuple[Fraction, Fraction, Fraction]:
    return q[1] - q[0], q[2] - q[1], q[3] - q[2]


def _by(factor: Fraction, ratios: Mapping[Ratios, int]) -> dict[Ratios, Fraction]:
    return {key: factor * c for key, c in ratios.items()}


def _middle_quintic(q: Sequence[Fraction]) -> dict[Ratios, Powers]:
    """The quintic between the cubics q₀ + d₁s³ and q₃ − d₃(1 − s)³.

    They end and begin with velocity 3d₁/h₁ and 3d₃/h₃, acceleration 6d₁/h₁² and −6d₃/h₃²: in the
    quintic's own time 3d₁x, 3d₃y, 6d₁x², −6d₃y².
    """
    d1, d2, d3 = _steps(q)
    ends: tuple[tuple[Ratios, Fraction], ...] = (
        ((0, 0), d2),
        ((1, 0), 3 * d1),
        ((2, 0), 6 * d1),
        ((0, 1), 3 * d3),
        ((0, 2), -6 * d3),
    )
    found = {
        key: tuple(factor * c for c in basis)
        for (key, factor), basis in zip(ends, _QUINTIC, strict=True)
    }
    start = found[0, 0]
    return {**found, (0, 0): (q[1] + start[0], *start[1:])}


_D = {(0, 0): 1, (1, 0): 2, (0, 1): 2, (1, 1): 3}
"""D = 1 + 2x + 2y + 3xy, by which the middle cubic of 4-3-4 is multiplied to be a polynomial."""
_XD = {(i + 1, j): c for (i, j), c in _D.items()}
"""x·D, for the first piece."""
_YD = {(i, j + 1): c for (i, j), c in _D.items()}
"""y·D, for the last piece."""


def _turned(ratios: Mapping[Ratios, Fraction]) -> dict[Ratios, Fraction]:
    return {(j, i): c for (i, j), c in ratios.items()}


def _bulge(d1: Fraction, d2: Fraction, d3: Fraction) -> dict[Ratios, Fraction]:
    """x·D·u for the first piece q₀ + d₁s³ + u(s³ − s⁴).

    Equal accelerations at both ends of the middle cubic are two equations in u and w (of the last
    piece); by Cramer's rule x·D·u = d₁x(3xy + 2x + 6y + 3) + 2d₃y² − d₂(3y + 1).
    """
    return {
        (2, 1): 3 * d1,
        (2, 0): 2 * d1,
        (1, 1): 6 * d1,
        (1, 0): 3 * d1,
        (0, 2): 2 * d3,
        (0, 1): -3 * d2,
        (0, 0): -d2,
    }


def _first_quartic(q: Sequence[Fraction]) -> dict[Ratios, Powers]:
    d1, d2, d3 = _steps(q)
    return _spread(
        (_by(q[0], _XD), (1,)),
        (_by(d1, _XD), (0, 0, 0, 1)),
        (_bulge(d1, d2, d3), (0, 0, 0, 1, -1)),
    )


def _last_quartic(q: Sequence[Fraction]) -> dict[Ratios, Powers]:
    d1, d2, d3 = _steps(q)
    return _spread(
        (_by(q[3], _YD), (1,)),
        (_by(d3, _YD), (-1, 3, -3, 1)),
        (_turned(_bulge(d3, d2, d1)), (0, -1, 3, -3, 1)),
    )


def _middle_cubic(q: Sequence[Fraction]) -> dict[Ratios, Powers]:
    d1, d2, d3 = _steps(q)

    def speed(near: Fraction, far: Fraction) -> dict[Ratios, Fraction]:
        """Scaled velocity at the beginning of the cubic, times D: D·x(3d₁ − u)."""
        return {
            (2, 1): 6 * near,
            (2, 0): 4 * near,
            (0, 2): -2 * far,
            (0, 1): 3 * d2,
            (0, 0): d2,
        }

    return _spread(
        (_by(q[1], _D), (1,)),
        (_by(d2, _D), (0, 0, 3, -2)),
        (speed(d1, d3), (0, 1, -2, 1)),
        (_turned(speed(d3, d1)), (0, 0, -1, 1)),
    )


SHAPES = (
    ThreePieces(
        "three-piece",
        (3, 5, 3),
        (Piece("place", 1, {(0, 0): 1}, _middle_quintic),),
        (3, 6, 6),
        ((0, 0), (1, 0), (2, 0), (0, 1), (0, 2)),
    ),
    ThreePieces(
        "four-three-four",
        (4, 3, 4),
        (
            Piece("place", 1, _D, _middle_cubic),
            Piece("place-first", 0, _XD, _first_quartic),
            Piece("place-last", 2, _YD, _last_quartic),
        ),
        (1, 2, 6),
        ((0, 0), (1, 0), (2, 0), (0, 1), (0, 2), (1, 1), (2, 1), (1, 2)),
    ),
)
"""The two curves that have this form: docs/explanation/certificates.md derives it for each."""


def shape_of(curve: Curve) -> ThreePieces | None:
    """Shape of a curve, if it is C2 and at rest with zero acceleration at both ends.

    Parameters
    ----------
    curve : Curve

    Returns
    -------
    ThreePieces or None
    """
    rest = ((1, 0.0), (2, 0.0))
    if (
        not isinstance(curve, Interpolant)
        or curve.continuity != (2, 2)
        or curve.prescribed != (rest, (), (), rest)
        or curve.virtual
    ):
        return None
    return next((shape for shape in SHAPES if shape.degrees == curve.degrees), None)
