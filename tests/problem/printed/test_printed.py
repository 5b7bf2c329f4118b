"""Printed digits against decimal rounding as the second route."""

import math
import re
from decimal import ROUND_DOWN, ROUND_HALF_DOWN, ROUND_HALF_UP, Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st
from trajgap.problem.errors import CaseError, TrajgapError
from trajgap.problem.printed.rounded import Printed, down, read_float, up
from trajgap.problem.printed.units import (
    CHOICES,
    Scale,
    check_unit,
    from_si,
    is_linear,
    scale,
    to_si,
)

decimals = st.decimals(-1000, 1000, allow_nan=False, allow_infinity=False, places=9)
places = st.integers(min_value=0, max_value=6)


@given(decimals, places, st.sampled_from([ROUND_HALF_UP, ROUND_HALF_DOWN]))
def test_whatever_rounds_to_the_digits_lies_in_the_interval(number, digits, rounding):
    printed = Printed(str(number.quantize(Decimal(1).scaleb(-digits), rounding)))
    lower, upper = printed.interval
    assert lower <= Fraction(number) <= upper
    assert printed.lower <= float(number) <= printed.upper


@given(decimals, places)
def test_nothing_beyond_the_interval_rounds_to_the_digits(number, digits):
    step = Decimal(1).scaleb(-digits)
    rounded = number.quantize(step, ROUND_HALF_UP)
    lower, upper = Printed(str(rounded)).interval
    for outside in (lower - Fraction(1, 10**12), upper + Fraction(1, 10**12)):
        decimal = Decimal(outside.numerator) / Decimal(outside.denominator)
        assert decimal.quantize(step, ROUND_HALF_UP) != rounded


@given(decimals, places)
def test_whatever_is_cut_to_the_digits_lies_in_the_truncated_interval(number, digits):
    printed = Printed(str(number.quantize(Decimal(1).scaleb(-digits), ROUND_DOWN)))
    lower, upper = printed.truncated
    assert lower <= Fraction(number) <= upper


@given(st.fractions(min_value=-(10**6), max_value=10**6))
def test_directed_rounding_brackets_within_one_float(number):
    assert Fraction(down(number)) <= number <= Fraction(up(number))
    assert up(number) in (down(number), math.nextafter(down(number), math.inf))


def test_trailing_zeros_and_exponents_count():
    assert Printed("0.66") != Printed("0.660")
    assert Printed("0.660").places == 3
    for text, half in (("0.660", "0.0005"), ("0.66", "0.005"), ("1.5e3", "50"), ("80", "0.5")):
        value, half = Fraction(text), Fraction(half)
        assert Printed(text).interval == (value - half, value + half)
        assert Printed(text).truncated == (value, value + 2 * half)
    assert Printed("0.0").truncated == (Fraction(-1, 10), Fraction(1, 10))


@pytest.mark.parametrize("minus", ["-", "−", "–", "﹣", "－"])
def test_any_minus_sign_is_read(minus):
    printed = Printed(f" {minus}1.6336 ")
    assert printed == Printed("-1.6336")
    assert printed.value == -1.6336
    assert printed.lower == down(Fraction(-163365, 100000))
    assert printed.upper == up(Fraction(-163355, 100000))


def test_an_exact_number_has_no_width():
    printed = Printed.number(Decimal("0.30"))
    assert printed.text == "0.30"
    assert printed.lower == printed.value == printed.upper == 0.3
    assert printed.interval == printed.truncated == (Fraction(3, 10), Fraction(3, 10))
    assert Printed.number(80).value == 80.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        *((text, "is empty; write the printed digits") for text in ("", " ")),
        *(
            (text, "not a finite decimal number")
            for text in ("nan", "inf", "-inf", "1,5", "1_0", "0x1", "1 2", "1.2.3", "e5", "٣", ".")
        ),
        *(
            (text, "out of range; magnitudes from 1e-300 to 1e300")
            for text in ("1e301", "1e-301", "1e999999999999", "9" * 60 + "e299")
        ),
        ("1" * 65, "a number of 65 characters; at most 64"),
        pytest.param(10**400, "an integer of more than 300 digits is out of range", id="huge"),
        (Decimal("nan"), "'NaN' is not a finite decimal number"),
        (1.5, r"1\.5 is not text"),
    ],
)
def test_what_is_no_printed_number_is_refused(given, message):
    read = Printed.number if isinstance(given, int | Decimal) else Printed
    with pytest.raises(TrajgapError, match=message):
        read(given)


def test_a_case_error_is_one_line_with_its_evidence():
    error = CaseError("a.toml", "limits.velocity", "is\nnegative;  give more")
    assert str(error) == "a.toml: limits.velocity: is negative; give more"
    assert (error.file, error.field) == ("a.toml", "limits.velocity")
    assert str(CaseError("a.toml", "", "is empty")) == "a.toml: is empty"
    assert isinstance(error, TrajgapError)
    assert isinstance(error, ValueError)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("1.5", 1.5),
        (" -2e3 ", -2000.0),
        ("\u22121.25", -1.25),
        (".5", 0.5),
        ("1e-400", 0.0),
        ("Inf", math.inf),
        ("-infinity", -math.inf),
        ("1e400", "'1e400' is beyond the range of float64"),
        ("-1e309", "beyond the range"),
        ("9" * 65, "a number of 65 characters"),
        *(
            (text, "is not a number")
            for text in ("", "nan", "1_000", "0x10", "1,5", "\u0663", "1e", "+")
        ),
    ],
)
def test_a_float_is_what_its_digits_say(text: str, wanted: float | str) -> None:
    if isinstance(wanted, float):
        assert read_float(text) == wanted
        return
    with pytest.raises(TrajgapError, match=wanted):
        read_float(text)


@pytest.mark.parametrize(
    ("text", "more"),
    [
        ("1258", {"12580", "125.8", "12.58", "1.258", "-1258"}),
        ("0.854", {"8.54", "0.0854", "-0.854"}),
        ("-12.50", {"-125.0", "-1.250", "12.50"}),
        ("0.00", set()),
        ("1e3", set()),
    ],
)
def test_a_slip_is_a_digit_the_point_or_the_sign(text, more):
    number = Printed(text)
    one_off = {other.text for other in number.one_digit_off()}
    assert {other.text for other in number.slips()} - one_off == more


texts = st.decimals(min_value=-400, max_value=400, places=4).map(str)
every_unit = st.sampled_from([unit for choices in CHOICES.values() for unit in choices])


@given(texts, st.sampled_from(["deg", "deg/s", "deg/s^2", "deg/s^3"]))
def test_degrees_agree_with_numpy(text, unit):
    measured = to_si(Printed(text), unit)
    assert measured.value == pytest.approx(np.deg2rad(float(text)), rel=4e-16, abs=1e-300)
    assert measured.upper - measured.lower == pytest.approx(np.deg2rad(1e-4), rel=1e-9)


@given(texts, every_unit)
def test_the_value_lies_in_its_interval_and_returns(text, unit):
    exact = to_si(Printed(text, exact=True), unit)
    assert exact.lower == exact.value == exact.upper
    measured = to_si(Printed(text), unit)
    assert measured.value == exact.value
    assert measured.lower <= measured.value <= measured.upper
    assert from_si(measured.value, unit) == pytest.approx(float(text), rel=4e-16, abs=1e-300)


@given(texts, every_unit)
def test_the_interval_is_rounded_outwards(text, unit):
    printed = Printed(text)
    measured = to_si(printed, unit)
    below, above = scale(unit).bounds
    for end in printed.interval:
        for bound in (below, above):
            assert Fraction(measured.lower) <= end * bound <= Fraction(measured.upper)


@given(texts, every_unit)
def test_what_was_cut_off_lies_in_an_interval_that_is_wider_away_from_0(text, unit):
    printed = Printed(text)
    measured = to_si(printed, unit)
    cut, (low, high) = measured.cut_off(), printed.truncated
    for bound in scale(unit).bounds:
        assert Fraction(cut.lower) <= low * bound
        assert high * bound <= Fraction(cut.upper)
    assert cut.lower == measured.lower or measured.value <= 0
    assert cut.upper == measured.upper or measured.value >= 0


def test_known_values():
    assert to_si(Printed("180", exact=True), "deg").value == math.pi
    assert to_si(Printed("0.3", exact=True), "s").value == 0.3
    assert to_si(Printed("250", exact=True), "ms").value == 0.25
    assert scale("rad/s^3").bounds == (1, 1)
    low, high = scale("deg").bounds
    assert Fraction(math.pi) / 180 - low < Fraction(1, 10**17)
    assert 0 < high - low < Fraction(1, 10**51)
    assert from_si(math.inf, "deg/s") == math.inf


def test_every_choice_has_a_scale():
    for quantity, choices in CHOICES.items():
        for unit in choices:
            assert check_unit(unit, quantity) == unit
            assert scale(unit).rational > 0


def test_rates_per_minute_are_exact():
    for unit, rational, pi in (
        ("rpm", Fraction(1, 30), 1),
        ("deg/min", Fraction(1, 10800), 1),
        ("rad/min", Fraction(1, 60), 0),
        ("m/min", Fraction(1, 60), 0),
        ("mm/min", Fraction(1, 60000), 0),
        ("cm/s^2", Fraction(1, 100), 0),
        ("mm/s^3", Fraction(1, 1000), 0),
        ("min", Fraction(60), 0),
    ):
        assert scale(unit) == Scale(rational, pi), unit
    assert to_si(Printed("60", exact=True), "rpm").value == 2 * math.pi
    assert [u for u in CHOICES["velocity"] if is_linear(u)] == [
        "m/s", "cm/s", "mm/s", "m/min", "cm/min", "mm/min",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("quantity", "written", "meant"),
    [
        ("velocity", "rev/min", "rpm"),
        ("velocity", "r.p.m.", "rpm"),
        ("velocity", "°/s", "deg/s"),
        ("velocity", "degrees per second", "deg/s"),
        ("velocity", "mm·s⁻¹", "mm/s"),
        ("velocity", "metres/minute", "m/min"),
        ("acceleration", "rad/s²", "rad/s^2"),
        ("acceleration", "m/s2", "m/s^2"),
        ("jerk", "deg s^-3", "deg/s^3"),
        ("position", "degree", "deg"),
        ("position", "millimeters", "mm"),
        ("time", "minutes", "min"),
        ("time", "sec", "s"),
    ],
)
def test_what_papers_write_is_answered(quantity, written, meant):
    said = re.escape(f"{written!r} for {quantity}; write it as {meant!r}")
    with pytest.raises(TrajgapError, match=said):
        check_unit(written, quantity)


def test_unknown_units_are_refused():
    with pytest.raises(TrajgapError, match="unknown unit 'grad'; use one of rad, deg"):
        scale("grad")
    with pytest.raises(TrajgapError, match="unknown unit 'rps' for velocity; use one of rad/s"):
        check_unit("rps", "velocity")
    with pytest.raises(TrajgapError, match="'deg' measures position, not velocity; use one of"):
        check_unit("deg", "velocity")
    with pytest.raises(TrajgapError, match="the number is too large"):
        to_si(Printed("9e300"), "s")
