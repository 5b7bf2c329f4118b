"""C2 cubic splines below one cap: the verifier's kind of proof, and its equations in floats.

Floats only propose: what is proved is computed by the verifier.

Unknowns of one joint are its accelerations at all breaks and its velocities at all way-points. The
coordinates y are the spans T between way-points and, with virtual way-points, the first and the
last duration h with ρ = h²/T. Equations and limits are affine in y and in the unknowns, apart from
1/T beside the known displacement of a span. Derivation: docs/explanation/certificates-cubic.md.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ....verify import TICKS, Clock, Refused, StatedProblem
from ....verify.cubic import Condition, Cubic, CubicSpline, kind_of_ends
from ..document import stated_problem
from ..exact import ExactProblem


class CubicRow(NamedTuple):
    """A condition ≤ 0, as a certificate has it.

    ``kind`` is "jerk" of a piece, "velocity" in a span, "lower" or "upper" bound of a piece's
    duration, or "total"; ``joint`` is −1 where no joint takes part, and ``at`` a piece, or a
    span for "velocity", whose ``place`` counts in 64ths.
    """

    kind: str
    joint: int = -1
    at: int = 0
    sign: int = 1
    place: int = 0


class DenseTerms(NamedTuple):
    """Σ alone·x + Σ product·y·x + Σ along·y + constant."""

    alone: Array
    product: Array
    along: Array
    constant: float


def declares(problem: ExactProblem) -> bool:
    """Whether the curve is a C2 cubic spline of the kinds covered."""
    try:
        declaration = stated_problem(problem).declaration
        return declaration is not None and bool(kind_of_ends(declaration))
    except Refused:
        return False


class CubicSystem:
    """One problem in units in which angles and times are of order 1, with a total below a cap.

    Parameters
    ----------
    stated : StatedProblem
    units : dict
        ``powers``, ``second``, ``cap`` and ``root`` of the proof.
    rows : list
        Those that a state states.

    Attributes
    ----------
    kind : CubicSpline
        The verifier's kind of proof.
    exact : Cubic
        Its equations and conditions.
    fixed : ndarray, shape (unknowns, unknowns)
    linear : ndarray, shape (coordinates, unknowns, unknowns)
        M(y) = fixed + Σ y_k linear[k].
    steps : ndarray, shape (spans, joints)
        6·displacements with sign: what stands over T on the other side.
    which : ndarray of int, shape (spans,)
        The equation that it stands in; −1 where nothing moves.
    total : dict
        Weights of the coordinates in the total.
    """

    def __init__(
        self, stated: StatedProblem, units: dict[str, Any], rows: Sequence[Any] = ()
    ) -> None:
        self.units = units
        proof = {**units, "rows": list(rows)}
        self.kind = CubicSpline(stated, proof, Fraction(0), Clock(math.inf))
        self.exact = exact = self.kind.cubic
        dense = [_dense(exact, equation) for equation in exact.equations]
        self.fixed = np.array([alone for alone, _ in dense])
        self.linear = np.stack([product for _, product in dense], axis=1)
        self.steps = np.zeros((exact.m, exact.joints))
        self.which = np.full(exact.m, -1)
        for i, (t, sign) in exact.moving.items():
            self.steps[t] = [6 * sign * float(x) for x in exact.steps[t]]
            self.which[t] = i
        self.total = dict.fromkeys(range(exact.m), 1)
        self._terms: dict[CubicRow, tuple[Condition, DenseTerms]] = {}

    @property
    def cap(self) -> int:
        """Ticks."""
        return int(self.units["cap"])

    @property
    def unit(self) -> Fraction:
        """A tick, s."""
        return self.exact.second / TICKS

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Spans in which something moves."""
        return np.asarray(self.which >= 0)

    def terms(self, row: CubicRow) -> tuple[Condition, DenseTerms]:
        """Left-hand side of a condition ≤ 0."""
        if row not in self._terms:
            condition = self.exact.condition(list(row))
            _, own, along, constant = condition
            alone, product = _dense(self.exact, own)
            lengths = np.zeros(self.exact.coordinates)
            for k, x in along.items():
                lengths[k] = x
            self._terms[row] = condition, DenseTerms(alone, product, lengths, float(constant))
        return self._terms[row]

    def starting_rows(self) -> list[CubicRow]:
        """Conditions of a first relaxation: velocities at the quarters, and all others.

        `guide.peaks` adds velocities elsewhere where they count.
        """
        exact, rows = self.exact, []
        for j, (velocity, _, jerk) in enumerate(exact.limits):
            for sign in (1, -1):
                if jerk is not None:
                    rows += [CubicRow("jerk", j, k, sign) for k in range(exact.n)]
                for t in range(exact.m if velocity is not None else 0):
                    places = (0, 16, 32, 48) if t in exact.rough else (16, 32, 48)
                    rows += [CubicRow("velocity", j, t, sign, place) for place in places]
        for k in range(exact.n):
            if len(exact.lengths[k]) > 1:
                rows.append(CubicRow("lower", at=k))
            if exact.longest[k] is not None:
                rows.append(CubicRow("upper", at=k))
        return rows


def _dense(exact: Cubic, terms: dict[Any, Any]) -> tuple[Array, Array]:
    """Factors of the unknowns, and of their products with the coordinates."""
    alone, product = np.zeros(exact.size), np.zeros((exact.coordinates, exact.size))
    for key, x in terms.items():
        if isinstance(key, int):
            alone[key] = x
        else:
            product[key] = x
    return alone, product


def cubic_system(stated: StatedProblem, longest: Fraction, more: int = 0) -> CubicSystem:
    """The problem below a total, in units in which that total is between 8 and 16.

    Parameters
    ----------
    stated : StatedProblem
        Of a kind that `declares` knows.
    longest : Fraction
        s.
    more : int
        Ticks beyond it that the cap has.

    Returns
    -------
    CubicSystem
    """
    columns = zip(*stated.waypoints, strict=True)
    ways = [float(sum(abs(b - a) for a, b in pairwise(column))) for column in columns]
    powers = [math.frexp(way)[1] - 3 if way > 0 else 0 for way in ways]
    second = _second(longest)
    cap = math.floor(longest / Fraction(2) ** second * TICKS) + more
    return CubicSystem(stated, capped(stated, powers, second, cap))


def in_ticks(total: Fraction) -> Fraction:
    """A total rounded down to ticks of the units in which it is between 8 and 16, s."""
    unit = Fraction(2) ** _second(total) / TICKS
    return math.floor(total / unit) * unit


def _second(total: Fraction) -> int:
    return math.frexp(float(total))[1] - 4


def capped(stated: StatedProblem, powers: list[int], second: int, cap: int) -> dict[str, Any]:
    """Units of a proof, with the lower sides of its outermost box.

    No feasible total is below the cap where a side begins there.
    """
    units = {"powers": powers, "second": second, "cap": cap}
    exact = Cubic(stated, units)
    sides = [math.floor(exact.side(c)[0] * TICKS) for c in range(exact.free)]
    return {**units, "root": [min(side, cap) for side in sides]}
