"""Two transcriptions of one paper: what differs is named, what only looks otherwise is not."""

from pathlib import Path

import pytest
from support.case_texts import BASE
from support.checkout import ROOT
from trajgap.problem import compare_transcriptions, load_case, parse_case
from trajgap.problem.cases import Difference

ROWS = 'joint_rows = [["0.0", "10.5", "-3.25", "4"], ["1", "2", "3", "4"]]'
POINTS = 'waypoint_rows = [["0.0", "1"], ["10.5", "2"], ["-3.25", "3"], ["4", "4"]]'


def differences(old: str, new: str, words: bool = False) -> list[Difference]:
    assert old in BASE
    first, second = parse_case(BASE, "a.toml"), parse_case(BASE.replace(old, new), "b.toml")
    return compare_transcriptions(first, second, words)


@pytest.mark.parametrize(
    ("old", "new", "field", "first", "second"),
    [
        ('"10.5"', '"10.50"', "waypoints.waypoint_rows[1][0]", '"10.5"', '"10.50"'),
        ('"10.5"', "10.5", "waypoints.waypoint_rows[1][0]", '"10.5"', "10.5"),
        ('[100, "95.0"]', '[100, "96.0"]', "limits.velocity[1]", '"95.0"', '"96.0"'),
        ("limits = { velocity = 50 }", "", "problems.two.limits.velocity", "50", "(absent)"),
        ('units = { position = "rad" }', "", "readings.rad.units.position", None, "(absent)"),
    ],
)
def test_each_difference(old: str, new: str, field: str, first: str | None, second: str) -> None:
    (found,) = differences(old, new)
    assert found.field == field
    assert found.second == second
    assert first is None or found.first == first


def test_layout_order_and_the_transcribers_own_words_do_not_count() -> None:
    assert differences(ROWS, POINTS) == []
    assert differences('title = "Base"', 'title = "The same paper"') == []
    assert differences('id = "base"', 'id = "other"') == []
    (found,) = differences('title = "Base"', 'title = "The same paper"', words=True)
    assert found == Difference("title", '"Base"', '"The same paper"')


def test_entries_are_matched_by_their_ids() -> None:
    swapped = '[[problems]]\nid = "two"\nlimits = { velocity = 50 }\njoints = ["b"]\n'
    before = '[[problems]]\nid = "one"\n\n'
    assert differences(before + swapped, swapped + "\n" + before) == []
    found = differences('id = "plain"', 'id = "planned"')
    assert [one.field for one in found] == ["readings.plain", "readings.planned"]
    assert found[0].second == found[1].first == "(absent)"


FIRST = ROOT / "docs/examples"
SECOND = sorted((ROOT / "tests/support/second_transcriptions").glob("*.toml"))

# Examples from before, whose numbers stand a second time in tests of their own.
IN_TESTS = {"fang2020-task1", "fang2020-task2"}


def test_every_other_example_is_typed_a_second_time() -> None:
    assert {path.stem for path in FIRST.glob("*.toml")} - IN_TESTS == {one.stem for one in SECOND}


@pytest.mark.parametrize("second", SECOND, ids=lambda path: path.stem)
def test_both_transcriptions_agree(second: Path) -> None:
    assert compare_transcriptions(load_case(FIRST / second.name), load_case(second)) == []


def test_a_digit_typed_wrongly_is_seen(tmp_path: Path) -> None:
    name = "robotics1-2017-07-11.toml"
    text = (FIRST / name).read_text("utf-8")
    assert text.count('value = "3.36"') == 1
    (tmp_path / name).write_text(text.replace('"3.36"', '"3.63"'), "utf-8")
    found = compare_transcriptions(load_case(FIRST / name), load_case(tmp_path / name))
    assert [(one.field, one.first, one.second) for one in found] == [
        ("claims.largest-acceleration-7.value", '"3.36"', '"3.63"')
    ]
