"""The table of the suite on a page: the same words for a curve as on the command line."""

from __future__ import annotations

import pytest
from trajgap.compare.sphinx.suite import instances_of
from trajgap.problem import TrajgapError
from trajgap.problem.suite import list_instances, select_curve


@pytest.mark.parametrize("word", ["quintic", "Septic", "353", "virtual", "septic-c6-"])
def test_a_word_chooses_what_the_command_line_lists(word: str) -> None:
    chosen = instances_of(word)
    assert 0 < len(chosen) < len(list_instances())
    assert list(chosen) == list(select_curve(word))


def test_a_whole_name_keeps_to_that_curve() -> None:
    assert {one.curve for one in instances_of("C2 cubic")} == {"C2 cubic"}
    assert {one.curve for one in select_curve("C2 cubic")} > {"C2 cubic"}
    assert instances_of(None) == list_instances()


def test_a_curve_that_no_instance_has_is_an_error_with_those_that_there_are() -> None:
    with pytest.raises(TrajgapError, match=r"no curve is called 'nonic'; known: .*C4 quintic"):
        instances_of("nonic")
