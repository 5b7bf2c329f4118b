"""The conditions over every kind of number, against derivatives of the polynomials in time."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.exact_route import derived, value
from support.samples import DECLARATIONS, FREE
from trajgap.problem import Interpolant
from trajgap.problem.curves import ConditionKind, Conditions

CURVES = {**DECLARATIONS, **FREE}
each = pytest.mark.parametrize("name", CURVES)


def drawn(curve: Interpolant) -> tuple[list[Fraction], list[list[Fraction]]]:
    """Durations, and scaled coefficients of each segment, that meet no condition."""
    rng = np.random.default_rng(len(curve.name))
    h = [Fraction(int(x), 17) for x in rng.integers(3, 60, curve.segments)]
    c = [[Fraction(int(x), 8) for x in rng.integers(-40, 40, d + 1)] for d in curve.degrees]
    return h, c


def derivative(c: list[Fraction], h: Fraction, order: int, end: bool) -> Fraction:
    """Of a polynomial in t, at one of its ends."""
    in_time = [x / h**p for p, x in enumerate(c)]
    return value(derived(in_time, order), h if end else Fraction(0))


def stated(table: Conditions, h: list[Fraction], c: list[list[Fraction]]) -> list[Fraction]:
    """Left-hand sides: the derivative, or what both sides differ by, in the row's unit of time."""
    found = []
    rows = (table.kinds.tolist(), table.breaks.tolist(), table.orders.tolist())
    for kind, b, r in zip(*rows, strict=True):
        left = derivative(c[b - 1], h[b - 1], r, True) if b > 0 else Fraction(0)
        right = derivative(c[b], h[b], r, False) if b < len(h) else Fraction(0)
        found.append(
            {
                ConditionKind.LEFT_VALUE: h[b - 1] ** r * left if b > 0 else Fraction(0),
                ConditionKind.RIGHT_VALUE: h[b] ** r * right if b < len(h) else Fraction(0),
                ConditionKind.MATCH: h[b - 1] ** r * (left - right),
            }[kind]
        )
    return found


@each
def test_rows_are_derivatives_in_time_exactly(name: str) -> None:
    curve = CURVES[name]
    h, c = drawn(curve)
    exact = np.array(h, dtype=object)
    for table in (curve.table, curve.layout):
        rows = table.dense(table.matrix(exact)) @ np.array(
            [x for piece in c for x in piece], dtype=object
        )
        assert rows.tolist() == stated(table, h, c)
        powers = [k ** int(r) for k, r in zip(exact[table.segment], table.powers, strict=True)]
        assert table.rates(exact).tolist() == powers


@each
@pytest.mark.parametrize("kind", [np.float64, np.longdouble])
def test_floats_of_any_precision_round_the_fractions(name: str, kind: Any) -> None:
    plan = CURVES[name].layout
    h = drawn(CURVES[name])[0]
    exact = plan.matrix(np.array(h, dtype=object))
    wide = np.array([kind(x.numerator) / kind(x.denominator) for x in h])
    found = plan.matrix(wide)
    assert found.dtype == kind
    for one, other in zip(found.ravel(), exact.ravel(), strict=True):
        size = abs(other) * 40 * Fraction(float(np.finfo(kind).eps))
        assert abs(Fraction(*one.as_integer_ratio()) - other) <= size


@each
def test_unknowns_are_what_no_row_gives_at_once_and_the_band_holds_them(name: str) -> None:
    plan = CURVES[name].layout
    right = plan.kinds == ConditionKind.RIGHT_VALUE
    given = plan.first[plan.breaks[right]] + plan.orders[right]
    assert sorted(given) == np.flatnonzero(plan.unknown < 0).tolist()
    matrix = plan.dense(plan.entries[1])[~right][:, plan.unknown >= 0]
    assert matrix.shape == (plan.unknowns, plan.unknowns)
    equation, unknown = np.nonzero(matrix)
    assert (equation - unknown).max(initial=0) == plan.bandwidths[0]
    assert (unknown - equation).max(initial=0) == plan.bandwidths[1]
