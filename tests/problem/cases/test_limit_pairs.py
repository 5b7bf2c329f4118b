"""Limits of a case file that differ by side: digits, rounding, units and refusals."""

from pathlib import Path

import numpy as np
import pytest
from support.base_case import BASE
from trajgap.problem import case_schema, compare_transcriptions, parse_case
from trajgap.problem.cases import Digits

PAIRED = BASE.replace('velocity = [100, "95.0"]', 'velocity = [["-90.0", "100.0"], 95]').replace(
    "acceleration = 60", "acceleration = [[-inf, 60], [-40, 40]]"
)


def test_each_side_has_its_own_digits() -> None:
    case = parse_case(PAIRED, "f")
    limits = case.problem("one", "plain").limits
    np.testing.assert_allclose(
        np.degrees(limits.ends("velocity")), [[-90, -95], [100, 95]], rtol=1e-15
    )
    np.testing.assert_allclose(
        np.degrees(limits.ends("acceleration")), [[-np.inf, -40], [60, 40]], rtol=1e-15
    )
    tight = case.statement("one", "plain").problem(Digits.TIGHTEST).limits
    loose = case.statement("one", "plain").problem(Digits.LOOSEST).limits
    np.testing.assert_allclose(
        np.degrees(tight.ends("velocity")), [[-89.95, -95], [99.95, 95]], rtol=1e-12
    )
    np.testing.assert_allclose(
        np.degrees(loose.ends("velocity")), [[-90.05, -95], [100.05, 95]], rtol=1e-12
    )
    cut = case.statement("one", "plain").problem(Digits.LOOSEST_CUT).limits
    assert np.degrees(cut.ends("velocity")[0][0]) == pytest.approx(-90.1, rel=1e-6)
    assert np.degrees(cut.ends("velocity")[1][0]) == pytest.approx(100.1, rel=1e-6)


def test_joints_that_take_part_keep_their_own() -> None:
    both = parse_case(PAIRED.replace("limits = { velocity = 50 }", ""), "f")
    limits = both.problem("two", "plain").limits
    assert not limits.uneven
    np.testing.assert_allclose(np.degrees(limits.velocity), [95], rtol=1e-15)


def test_pairs_of_equal_size_are_sizes_to_the_last_bit() -> None:
    sizes = parse_case(BASE, "f").problem("one", "plain").limits
    pairs = BASE.replace(
        'velocity = [100, "95.0"]', 'velocity = [[-100, 100], ["-95.0", "95.0"]]'
    ).replace("acceleration = 60", "acceleration = [[-60, 60], [-60, 60]]")
    limits = parse_case(pairs, "f").problem("one", "plain").limits
    assert not limits.uneven
    np.testing.assert_array_equal(limits.derivatives, sizes.derivatives)


def test_transcriptions_are_compared_side_by_side() -> None:
    one = parse_case(PAIRED, "f")
    other = parse_case(PAIRED.replace('"-90.0"', '"-91.0"'), "f")
    assert compare_transcriptions(one, parse_case(PAIRED, "f")) == []
    found = compare_transcriptions(one, other)
    assert [d.field for d in found] == ["limits.velocity[0][0]"]


def test_the_schema_knows_pairs() -> None:
    assert '"minItems": 2' in Path("docs/reference/case.schema.json").read_text(encoding="utf-8")
    assert "LimitsBlock" in str(case_schema())
