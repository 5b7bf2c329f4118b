"""Ratios of durations in case files: what they pose, whom they override, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.case_texts import case_text
from support.refusals import Refusal, each_refusal
from trajgap.problem import CaseError, case_schema, compare_transcriptions, parse_case
from trajgap.problem.cases import ratio_words

CASE = case_text(
    "waypoint_rows = [[0, 10], [30, 50], [90, 130]]",
    'family = "cubic-spline"',
    more="""
[durations]
lower = 0
ratios = RATIOS

[[problems]]
id = "first"

[[problems]]
id = "second"
joints = ["b"]
durations = { ratios = [2, "1.50"] }

[[readings]]
id = "total-chosen"
why = "one factor"

[[readings]]
id = "each-chosen"
why = "shortest"
durations = { ratios = "free" }
""",
)


def case(ratios: str, text: str = CASE):
    return parse_case(text.replace("RATIOS", ratios), "made-up.toml")


@pytest.mark.parametrize(
    ("ratios", "shares", "loose"),
    [
        ('"chord"', [1 / 3, 2 / 3], False),
        ('"equal"', [0.5, 0.5], False),
        ("[3, 1]", [0.75, 0.25], False),
        ('["3.0", 1]', [0.75, 0.25], True),
        ('"free"', None, False),
    ],
)
def test_readings_are_laid_over_problems_over_the_file(ratios, shares, loose) -> None:
    one = case(ratios)
    first = one.problem("first", "total-chosen")
    if shares is None:
        assert first.ratios is None
    else:
        np.testing.assert_allclose(first.shares, shares, rtol=1e-12)
    assert one.statement("first", "total-chosen").loose_ratios is loose
    np.testing.assert_allclose(one.problem("second", "total-chosen").shares, [4 / 7, 3 / 7])
    assert one.statement("second", "total-chosen").loose_ratios
    for pid in ("first", "second"):
        assert one.problem(pid, "each-chosen").ratios is None
        assert not one.statement(pid, "each-chosen").loose_ratios


def test_chord_lengths_are_those_of_the_joints_that_take_part() -> None:
    text = CASE.replace("[30, 50]", '["30", 40]')
    own = case('"chord"', text.replace('ratios = [2, "1.50"]', 'ratios = "chord"'))
    together, alone = (own.problem(pid, "total-chosen").shares for pid in ("first", "second"))
    lengths = np.hypot([30, 60], [30, 90])
    np.testing.assert_allclose(together, lengths / lengths.sum())
    np.testing.assert_allclose(alone, [0.25, 0.75])
    # The angle of the other joint is a printed number, those of this one are exact.
    assert own.statement("first", "total-chosen").loose_ratios
    assert not own.statement("second", "total-chosen").loose_ratios


@each_refusal("ratios")
def test_what_is_no_ratio_is_refused(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(CASE), "ratios.toml"), "ratios.toml: ")


def test_neighbours_that_coincide_have_no_chord() -> None:
    with pytest.raises(CaseError, match=r"durations\.ratios: .*way-points 2 and 3, which coincide"):
        case('"chord"', CASE.replace("[90, 130]", "[30, 50]"))


def test_the_words_are_those_of_the_schema() -> None:
    ratios = case_schema()["$defs"]["Durations"]["properties"]["ratios"]
    assert '"enum": ["equal", "chord", "free"]' in json.dumps(ratios)


def test_readings_are_called_by_their_ratios() -> None:
    assert ratio_words((1,) * 7) == "durations in the ratios as listed"
    # Where problems say it, a reading that is silent says nothing of its own.
    assert "total-chosen" in case('"equal"').labels["total-chosen"]


def test_two_transcriptions_differ_in_their_ratios() -> None:
    first, second = case("[1, 2]"), case('[1, "2.0"]')
    assert not compare_transcriptions(first, first)
    assert any("durations" in str(one) for one in compare_transcriptions(first, second))
