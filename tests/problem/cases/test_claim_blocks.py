"""Blocks of claims that `trajgap new` writes load as they stand once blanks are filled in."""

from __future__ import annotations

import re

import pytest
from trajgap.problem.cases.load import parse_case
from trajgap.problem.cases.scaffolding import scaffold
from trajgap.problem.errors import CaseError

RAD = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s^2"}
PRINTED = {
    "durations and total": {"durations": "1.0,2.0,3.0", "total": "6.0", "where": "Table 3"},
    "durations": {"durations": "1.0,2.0,3.0", "where": "Table 3"},
    "total": {"total": "6.0", "where": "Table 3"},
    "nothing": {},
}
"""What a paper prints of times, as `trajgap new` is told."""


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("1,2\n0.11,0.5\n0.21,1.5\n0.31,2.5\n0.41,0.5\n", encoding="utf-8")
    return path


def blocks(text):
    """Paragraphs of commented blocks, the prose above each left out of none."""
    return [part for part in text.split("\n\n") if re.search(r"^# \[\[claims\]\]", part, re.M)]


def uncommented(block):
    """A block as an editor uncomments it: one mark off every line, the prose above it too."""
    return "\n".join(re.sub("^# ?", "", line, count=1) for line in block.splitlines())


def filled(block):
    """Its blanks filled in: digits of numbers, words of places."""
    block = block.replace('durations = [""]', 'durations = ["1.0", "2.0", "3.0"]')
    block = re.sub(r'^(value|percent) = ""', r'\1 = "7.98"', block, flags=re.M)
    return re.sub(r'= ""', '= "section 4"', block)


@pytest.mark.parametrize("printed", PRINTED.values(), ids=PRINTED)
@pytest.mark.parametrize("units", [RAD, {"position": "rad"}], ids=["units", "no units"])
def test_each_block_loads_by_itself(table, printed, units):
    text = scaffold(table, units, **printed)
    found = blocks(text)
    assert len(found) >= 7
    if not printed:  # then the first is what all others are about
        first = filled(uncommented(found[0]))
        assert parse_case(text.replace(found[0], first), "x").claims[0].quantity == "durations"
        text = text.replace(found.pop(0), first)
    for block in found:
        whole = text.replace(block, filled(uncommented(block)))
        if "derivative" in block and "velocity" not in units:
            assert "its unit under [units]" in block
            whole = whole.replace('# velocity = "rad/s"', 'velocity = "rad/s"')
        case = parse_case(whole, "x")
        assert len(case.claims) > 1, block


@pytest.mark.parametrize("printed", PRINTED.values(), ids=PRINTED)
def test_all_blocks_load_together(table, printed):
    text = scaffold(table, RAD, **printed)
    for block in blocks(text):
        text = text.replace(block, filled(uncommented(block)))
    quantities = {claim.quantity for claim in parse_case(text, "x").claims}
    assert {
        "durations",
        "total_time",
        "improvement",
        "peak",
        "measure",
        "value",
        "statement",
    } <= quantities


def test_a_peak_and_a_mean_name_durations_and_never_a_total(table):
    def of(printed):
        text = scaffold(table, RAD, **printed)
        return [b.count('# of = "durations"') for b in blocks(text) if "derivative" in b]

    assert of(PRINTED["durations"]) == [1, 1, 1]
    assert of(PRINTED["total"]) == [0, 0, 0]


@pytest.mark.parametrize("printed", PRINTED.values(), ids=PRINTED)
def test_a_blank_that_is_left_is_refused_in_its_place(table, printed):
    """A number or a place that nobody typed must never stand in a case as if the paper had it."""
    text = scaffold(table, RAD, **printed)
    found = blocks(text)
    if not printed:
        text = text.replace(found[0], filled(uncommented(found[0])))
    for block in found[0 if printed else 1 :]:
        with pytest.raises(CaseError, match=r"claims\[\d\]\.(where|value|durations)"):
            parse_case(text.replace(block, uncommented(block)), "x")


def test_a_place_that_is_not_given_is_said_to_be_none_and_no_number_made_up(table):
    for printed in ({"durations": "1.0,2.0,3.0"}, {"total": "6.0"}, PRINTED["durations and total"]):
        text = scaffold(table, RAD, **{k: v for k, v in printed.items() if k != "where"})
        (claim,) = parse_case(text, "x").claims
        assert claim.where == "a place not stated"
        assert re.findall(r'^#? ?where = "([^"]+)"', text, re.M) == ["a place not stated"]
        for block in blocks(text):
            assert not re.search(r"[0-9]\.[0-9]", block), block


def test_a_row_is_as_long_as_the_curve_has_segments(table):
    """Two virtual way-points make two segments more than the way-points have ways between them."""
    assert 'durations = [""]  # 5 numbers' in scaffold(table, RAD, family="cubic-spline-virtual")
    assert 'durations = [""]  # 3 numbers' in scaffold(table, RAD, family="3-5-3")


def test_a_blank_number_is_called_one(table):
    text = scaffold(table, RAD, where="Table 2", total="6.0").replace('"6.0"', '""')
    with pytest.raises(CaseError, match=r"value: is empty; write the printed digits, such as"):
        parse_case(text, "x")
