"""Examples of others' numbers are typed twice, and the two files agree digit by digit."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.checkout import ROOT
from trajgap.problem import compare_transcriptions, load_case

FIRST = ROOT / "docs" / "examples"
SECOND = sorted((ROOT / "tests" / "support" / "second_transcriptions").glob("*.toml"))

# Examples from before, whose numbers stand a second time in tests of their own.
IN_TESTS = {
    "fang2020-task1",
    "fang2020-task2",
    "gasparetto-zanotto2008",
    "two-joint-arm-c4-quintic",
    "two-joint-arm-natural-cubic",
}


def test_every_other_example_is_typed_a_second_time() -> None:
    assert {path.stem for path in FIRST.glob("*.toml")} - IN_TESTS == {one.stem for one in SECOND}


@pytest.mark.parametrize("second", SECOND, ids=lambda path: path.stem)
def test_both_transcriptions_agree(second: Path) -> None:
    assert compare_transcriptions(load_case(FIRST / second.name), load_case(second)) == []


def test_a_digit_typed_wrongly_is_seen(tmp_path: Path) -> None:
    name = "robotics1-2017-07-11.toml"
    text = (FIRST / name).read_text("utf-8")
    assert text.count('value = "3.36"') == 1
    (tmp_path / name).write_text(text.replace('"3.36"', '"3.63"'), encoding="utf-8")
    found = compare_transcriptions(load_case(FIRST / name), load_case(tmp_path / name))
    assert [(one.field, one.first, one.second) for one in found] == [
        ("claims.largest-acceleration-7.value", '"3.36"', '"3.63"')
    ]
