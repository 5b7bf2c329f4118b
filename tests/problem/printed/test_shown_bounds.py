"""Bounds in few digits are bounds as well."""

from fractions import Fraction

import pytest
from hypothesis import given, strategies as st
from trajgap.problem import shown_bound

VALUES = st.one_of(st.fractions(-(10**6), 10**6), st.floats(allow_nan=False, allow_infinity=False))


@given(VALUES, st.sampled_from(["lower", "upper"]), st.integers(1, 12))
def test_a_bound_in_few_digits_is_nearest(value: Fraction | float, side: str, digits: int) -> None:
    exact = Fraction(repr(value)) if isinstance(value, float) else value
    sign = 1 if side == "lower" else -1
    short = shown_bound(value, side, digits=digits)
    assert len(short.replace("-", "").replace(".", "").strip("0")) <= digits
    off = sign * (exact - Fraction(short))
    assert 0 <= off <= Fraction(10) ** (1 - digits) * abs(exact)
    fixed = shown_bound(value, side, places=digits)
    assert 0 <= sign * (exact - Fraction(fixed)) < Fraction(10) ** -digits
    assert len(fixed.partition(".")[2]) == digits


@pytest.mark.parametrize(
    ("value", "side", "how", "text"),
    [
        (4.0604, "lower", {"places": 1}, "4.0"),
        (4.0604, "upper", {"places": 1}, "4.1"),
        (-0.04, "lower", {"places": 1}, "-0.1"),
        (-0.04, "upper", {"places": 1}, "0.0"),
        (Fraction(2, 3), "upper", {"digits": 3}, "0.667"),
        (2.5, "lower", {}, "2.5"),
        (123456.7, "lower", {"digits": 3}, "123000"),
        (float("inf"), "upper", {"places": 2}, "inf"),
        (0.0, "lower", {"digits": 2}, "0"),
    ],
)
def test_a_bound_as_it_is_read(value: float, side: str, how: dict[str, int], text: str) -> None:
    assert shown_bound(value, side, **how) == text
