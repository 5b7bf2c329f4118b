"""Units against numpy's conversion as the second route."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from trajgap.problem.errors import TrajgapError
from trajgap.problem.printed import Printed
from trajgap.problem.units import (
    CHOICES,
    Scale,
    check_unit,
    from_si,
    is_linear,
    scale,
    to_si,
)

digits = st.decimals(min_value=-400, max_value=400, places=4).map(str)
every_unit = st.sampled_from([unit for choices in CHOICES.values() for unit in choices])


@given(digits, st.sampled_from(["deg", "deg/s", "deg/s^2", "deg/s^3"]))
def test_degrees_agree_with_numpy(text, unit):
    measured = to_si(Printed(text), unit)
    assert measured.value == pytest.approx(np.deg2rad(float(text)), rel=4e-16, abs=1e-300)
    assert measured.upper - measured.lower == pytest.approx(np.deg2rad(1e-4), rel=1e-9)


@given(digits, every_unit)
def test_the_value_lies_in_its_interval_and_returns(text, unit):
    measured = to_si(Printed(text), unit)
    assert measured.lower <= measured.value <= measured.upper
    assert from_si(measured.value, unit) == pytest.approx(float(text), rel=4e-16, abs=1e-300)


@given(digits, every_unit)
def test_the_interval_is_rounded_outwards(text, unit):
    printed = Printed(text)
    measured = to_si(printed, unit)
    below, above = scale(unit).bounds
    for end in printed.interval:
        for bound in (below, above):
            assert Fraction(measured.lower) <= end * bound <= Fraction(measured.upper)


@given(digits, every_unit)
def test_an_exact_number_keeps_no_width(text, unit):
    measured = to_si(Printed(text, exact=True), unit)
    assert measured.lower == measured.value == measured.upper


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
